//! The stored state of every deformable body of the batch.

use super::bend::Bend;
use super::each::on_each;
use super::pair::SoftPair;
use super::state::Sleep;
use super::touching::{Part, Touching};
use crate::deform::operand::Operand;
use crate::deform::outcome::NodeLoad;
use crate::deform::record::{NodalLoads, NodalState};
use crate::deform::shape::{DeformableShape, Modulus};
use crate::deform::turning::Turning;
use crate::error::ContactError;
use femdem_mesh::Vector3;
use femdem_mesh::bvh::{Aabb, Bvh};
use serde::{Deserialize, Serialize};

/// The reach of a body over the largest distance of its nodes from their mean: margin for stretching.
const STRETCH: f64 = 1.5;

/// Bodies that a thread works on in one go.
pub(super) const GRAIN: usize = 4;

/// A deformable body of the batch.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SoftBody {
    /// Whether it is there: its number may stand for a rigid body, or for none.
    pub is_there: bool,
    /// Whether it belongs to another batch: see [`share`](super::share).
    pub is_guest: bool,
    pub shape: u32,
    pub modulus: Modulus,
    /// Slowest elastic oscillation, rad/s; 0 if not known.
    pub frequency: f64,
    pub sleep: Sleep,
    /// Running bound of the distance that any node has travelled, m.
    pub travelled: f64,
    /// How far its parts have moved towards each other, if it may touch itself.
    pub bend: Option<Bend>,
    /// Positions of the nodes at the last update, m.
    before: Vec<Vector3>,
    /// Mean position of the nodes, m.
    pub centre: Vector3,
    /// The nodes stay within this distance of `centre` until the next search for pairs, m.
    pub reach: f64,
    /// Its rotation as a whole, if anything may touch it.
    pub turning: Option<Turning>,
    /// The tree over the tetrahedra, as of its last refit.
    #[serde(skip)]
    pub tree: Option<Box<(Bvh, Vec<Aabb>)>>,
    #[serde(skip)]
    forces: Vec<Vector3>,
    #[serde(skip)]
    damping: Vec<Vector3>,
    #[serde(skip)]
    friction: Vec<Vector3>,
    #[serde(skip)]
    stiffness: Vec<f64>,
    #[serde(skip)]
    rates: Vec<f64>,
    /// Force and moment about the centre on the body as a whole, N and N m, and their rate, 1/s.
    #[serde(skip)]
    whole: ([Vector3; 2], f64),
    /// Whether any of these is not zero.
    #[serde(skip)]
    pub loaded: bool,
    /// Whether they may have changed in the last update.
    #[serde(skip)]
    pub stirred: bool,
}

impl SoftBody {
    pub fn new(index: u32, shape: &DeformableShape, modulus: Modulus) -> Self {
        let mut body = Self {
            is_there: true,
            shape: index,
            modulus,
            sleep: Sleep::Awake,
            reach: STRETCH * shape.radius(),
            ..Self::vacant()
        };
        body.restore(shape);
        body
    }

    /// What stands for a number that is not a deformable body's.
    pub fn vacant() -> Self {
        Self {
            is_there: false,
            is_guest: false,
            shape: 0,
            modulus: Modulus::Penalty(1.0),
            frequency: 0.0,
            sleep: Sleep::Frozen,
            travelled: 0.0,
            bend: None,
            before: Vec::new(),
            centre: Vector3::zeros(),
            reach: 0.0,
            turning: None,
            tree: None,
            forces: Vec::new(),
            damping: Vec::new(),
            friction: Vec::new(),
            stiffness: Vec::new(),
            rates: Vec::new(),
            whole: Default::default(),
            loaded: false,
            stirred: false,
        }
    }

    /// Rebuilds the data that is not stored.
    pub fn restore(&mut self, shape: &DeformableShape) {
        let count = shape.node_count();
        self.tree = Some(Box::new((shape.tree().clone(), Vec::new())));
        self.forces = vec![Vector3::zeros(); count];
        self.damping = self.forces.clone();
        self.friction = self.forces.clone();
        self.stiffness = vec![0.0; count];
        self.rates = vec![0.0; count];
        self.loaded = false;
    }

    /// Forgets where its nodes were.
    pub fn displaced(&mut self) {
        self.before = Vec::new();
        self.turning = None;
        if let Some(bend) = &mut self.bend {
            bend.forget();
        }
    }

    /// What the contacts do to its nodes.
    pub fn loads(&self) -> NodalLoads<'_> {
        NodalLoads {
            forces: &self.forces,
            damping: &self.damping,
            friction: &self.friction,
            stiffness: &self.stiffness,
            rates: &self.rates,
        }
    }

    fn clear(&mut self) {
        // Most bodies of a pack in flight touch nothing.
        if !std::mem::take(&mut self.loaded) {
            return;
        }
        for part in [&mut self.forces, &mut self.damping, &mut self.friction] {
            part.fill(Vector3::zeros());
        }
        self.stiffness.fill(0.0);
        self.rates.fill(0.0);
    }

    /// Adds the nodal loads of a pair.
    fn add(&mut self, nodes: &[NodeLoad]) {
        self.loaded |= !nodes.is_empty();
        for load in nodes {
            let at = load.node as usize;
            // All slices have the length of the nodes.
            if at < self.forces.len() {
                self.forces[at] += load.force;
                self.damping[at] += load.damping;
                self.friction[at] += load.friction;
                self.stiffness[at] += load.stiffness;
                self.rates[at] += load.rate;
            }
        }
    }

    /// Distributes what acts on the body as a whole to the nodes.
    fn spread(&mut self) {
        let (wrench, rate) = std::mem::take(&mut self.whole);
        let Some(turning) = &self.turning else {
            return;
        };
        if rate <= 0.0 && wrench == [Vector3::zeros(); 2] {
            return;
        }
        let forces = turning.forces(&wrench, &self.before);
        for ((total, damping), force) in self.forces.iter_mut().zip(&mut self.damping).zip(forces) {
            *total += force;
            *damping += force;
        }
        self.rates.iter_mut().for_each(|r| *r += rate);
    }

    /// Sums the loads of the pairs of a body, in their order.
    fn gather(&mut self, pairs: &[SoftPair], own: &[Part]) {
        self.clear();
        for part in own {
            let (outcome, side) = (&pairs[part.place as usize].outcome, usize::from(part.side));
            self.add(&outcome.nodes[side]);
            let (whole, rate) = &mut self.whole;
            for (total, part) in whole.iter_mut().zip(&outcome.whole[side]) {
                *total += part;
            }
            *rate += outcome.whole_rates[side];
        }
        self.spread();
    }

    /// Whether a state has the right number of nodes.
    fn check_counts(&self, body: usize, state: &NodalState) -> Result<(), ContactError> {
        let expected = self.forces.len();
        for given in [
            state.positions.len(),
            state.velocities.len(),
            state.inverse_masses.len(),
        ] {
            if given != expected {
                return Err(ContactError::NodeCount {
                    body,
                    given,
                    expected,
                });
            }
        }
        Ok(())
    }

    /// Takes over the present positions of the nodes.
    fn advance(&mut self, body: usize, state: &NodalState) -> Result<(), ContactError> {
        let NodalState {
            positions,
            velocities,
            inverse_masses,
        } = state;
        // Anything that is not finite makes this NaN, and a negative mass below 0.
        let mut probe = 0.0;
        let mut least = 0.0_f64;
        let mut sum = Vector3::zeros();
        for ((x, v), w) in positions.iter().zip(*velocities).zip(*inverse_masses) {
            probe += ((x.x + v.x) + (x.y + v.y) + (x.z + v.z) + w) * 0.0;
            least = if *w < least { *w } else { least };
            sum += x;
        }
        let fine = probe == 0.0 && least >= 0.0;
        if !fine {
            let usable = |((x, v), w): ((&Vector3, &Vector3), &f64)| {
                let finite = |v: &Vector3| v.iter().all(|x| x.is_finite());
                finite(x) && finite(v) && w.is_finite() && *w >= 0.0
            };
            let nodes = positions.iter().zip(*velocities).zip(*inverse_masses);
            if let Some(node) = nodes.map(usable).position(|fine| !fine) {
                return Err(ContactError::NodeState { body, node });
            }
        }
        self.centre = sum / positions.len().max(1) as f64;
        if self.before.len() == positions.len() {
            // All are finite, so a plain comparison serves; f64::max also handles NaN.
            let longest = |most: f64, (x, y): (&Vector3, &Vector3)| {
                let way = (x - y).norm_squared();
                if way > most { way } else { most }
            };
            let pairs = positions.iter().zip(&self.before);
            self.travelled += pairs.fold(0.0, longest).sqrt();
        }
        self.before.clear();
        self.before.extend_from_slice(positions);
        Ok(())
    }

    /// Measures how far its parts have moved towards each other, if they may have by `clear`, m.
    pub fn measure_bend(&mut self, clear: f64) {
        if let Some(bend) = &mut self.bend {
            bend.measure(&self.before, &self.centre, self.travelled, clear);
        }
    }

    /// The box and the largest distance from the centre of the nodes, m.
    pub fn extent(&self) -> (Aabb, f64) {
        let points = self.before.iter().map(|x| (*x).into());
        let square = |x: &Vector3| (x - self.centre).norm_squared();
        let radius = self.before.iter().map(square).fold(0.0, f64::max).sqrt();
        (Aabb::of_points(points), radius)
    }

    /// Adjusts the reach to the largest distance of the nodes from their mean. It may grow by `skin` before
    /// the next call (both m).
    pub fn stretch_to(&mut self, radius: f64, skin: f64) {
        if radius + skin > self.reach {
            self.reach = STRETCH * radius;
        }
    }

    pub fn refit(&mut self, operand: &Operand) {
        if let Some(tree) = &mut self.tree {
            let (tree, boxes) = tree.as_mut();
            operand.boxes(boxes);
            tree.refit(boxes);
        }
    }
}

/// Takes over the present positions of all nodes.
pub(crate) fn advance(bodies: &mut [SoftBody], states: &[NodalState]) -> Result<(), ContactError> {
    let advance = |i: usize, body: &mut SoftBody| {
        let Some(state) = states.get(i) else {
            return Ok(());
        };
        body.check_counts(i, state)?;
        match body.sleep {
            Sleep::Frozen => Ok(()),
            _ => body.advance(i, state),
        }
    };
    on_each(bodies, GRAIN, advance).into_iter().collect()
}

/// Sums the pairs' forces for every body of the batch whose forces may have changed; the others keep theirs. These are the bodies
/// that are not frozen, and those that are `stirred`.
pub(crate) fn gather(
    bodies: &mut [SoftBody],
    pairs: &[SoftPair],
    touching: &Touching,
    stirred: &[bool],
) {
    on_each(bodies, GRAIN, |i, body| {
        body.stirred = stirred[i] || body.sleep != Sleep::Frozen;
        if body.stirred && !body.is_guest {
            body.gather(pairs, touching.of(i));
        }
    });
}
