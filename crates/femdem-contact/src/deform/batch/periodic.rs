//! Pairs with a deformable body in periodic space: B meets the nearest image of A.

use super::DeformablePart;
use super::body::SoftBody;
use super::context::Context;
use super::pair::SoftPair;
use crate::deform::near::Candidates;
use crate::deform::record::NodalState;
use crate::deform::side::Side;
use crate::deform::turning::Turning;
use crate::motion::Motion;
use crate::periodic::EdgeLoad;
use femdem_mesh::{Matrix3, Vector3};

/// The first side of an evaluation where its image is, as it moves there.
pub(super) enum Seen {
    Nodes {
        positions: Vec<Vector3>,
        velocities: Vec<Vector3>,
        turning: Option<Turning>,
        way: Vector3,
    },
    Rigid(Motion),
}

impl Context<'_> {
    /// Chooses the image of A that B meets, that of the nearest centre. Another one is farther than half a cell away and does not
    /// touch, so that only what is known of distances ends with a change.
    pub(super) fn choose_image(&self, pair: &mut SoftPair, bodies: &[SoftBody]) {
        let Some(space) = self.around.space else {
            return;
        };
        let image = match self.centre(pair.a, bodies) {
            Some(a) if !pair.is_own() => {
                let b = bodies[pair.b as usize].centre;
                space.cell.minimum_image(&(b - a))
            }
            _ => [0; 3],
        };
        if image != pair.image {
            pair.image = image;
            pair.candidates = Candidates::default();
        }
    }

    /// Centre of a body, m.
    fn centre(&self, side: Side, bodies: &[SoftBody]) -> Option<Vector3> {
        match side {
            Side::Deformable(i) => Some(bodies[i as usize].centre),
            Side::Rigid(i) => Some(self.around.rigid[i as usize].frame.position),
            Side::Wall(_) => None,
        }
    }

    /// From the centre of the image of A to the centre of B, m; 0 for walls and for a body with itself.
    pub(super) fn branch(&self, pair: &SoftPair, bodies: &[SoftBody]) -> Vector3 {
        let Some(a) = self.centre(pair.a, bodies) else {
            return Vector3::zeros();
        };
        let away = self.around.space.map(|space| space.cell.offset(pair.image));
        bodies[pair.b as usize].centre - a - away.unwrap_or_default()
    }

    /// The first side of an evaluation, if it is met over an edge: A, or B if they have changed places.
    pub(super) fn seen(
        &self,
        first: Side,
        bodies: &[SoftBody],
        image: [i32; 3],
        swapped: bool,
    ) -> Option<Seen> {
        let space = self.around.space.filter(|_| image != [0; 3])?;
        let sign = if swapped { -1.0 } else { 1.0 };
        let way = space.cell.offset(image) * sign;
        let velocity = space.cell.velocity_of(image) * sign;
        match first {
            Side::Deformable(i) => {
                let NodalState {
                    positions,
                    velocities,
                    ..
                } = self.states.get(i as usize)?;
                let turning = bodies.get(i as usize)?.turning.as_ref();
                Some(Seen::Nodes {
                    positions: positions.iter().map(|x| x + way).collect(),
                    velocities: velocities.iter().map(|v| v + velocity).collect(),
                    turning: turning.map(|turning| turning.seen_from(&way, &velocity)),
                    way,
                })
            }
            Side::Rigid(i) => {
                let mut motion = *self.around.rigid.get(i as usize)?;
                motion.frame.position += way;
                motion.velocity += velocity;
                Some(Seen::Rigid(motion))
            }
            Side::Wall(_) => None,
        }
    }
}

impl SoftPair {
    /// What acts on A.
    pub(super) fn on_a(&self) -> EdgeLoad {
        let outcome = &self.outcome;
        let mut sum = EdgeLoad::default();
        if let Some((load, _)) = outcome.load.as_deref() {
            sum.total = load.total.force;
            sum.damping = load.damping.force;
            sum.friction = load.friction.force;
        }
        for node in &outcome.nodes[0] {
            sum.total += node.force;
            sum.damping += node.damping;
            sum.friction += node.friction;
        }
        sum.total += outcome.whole[0][0];
        sum.damping += outcome.whole[0][0];
        sum
    }
}

impl DeformablePart {
    /// Sums the forces of the pairs that meet over edges of the periodic cell.
    pub(super) fn sum_edges(&mut self) {
        let mut edges = <[EdgeLoad; 3]>::default();
        for pair in self.booked().filter(|pair| pair.image != [0; 3]) {
            EdgeLoad::add_over(&mut edges, pair.image, &pair.on_a());
        }
        self.edges = edges;
    }

    /// Forces over the edges of the periodic cell, from the contacts of deformable bodies.
    pub fn edges(&self) -> &[EdgeLoad; 3] {
        &self.edges
    }

    /// The pairs of two bodies whose B belongs to this batch.
    fn between_bodies(&self) -> impl Iterator<Item = &SoftPair> {
        let pairs = self.booked();
        pairs.filter(|pair| !matches!(pair.a, Side::Wall(_)) && !pair.is_own())
    }

    /// f lᵀ of the pairs of two bodies, with the force f on B without dashpots and the vector l from the centre of A to that
    /// of B, J.
    pub fn virials(&self) -> impl Iterator<Item = Matrix3> {
        self.between_bodies().map(|pair| {
            let on_a = pair.on_a();
            (on_a.damping - on_a.total) * pair.branch.transpose()
        })
    }

    /// Stiffness of the pairs of two bodies against a strain along an axis, J.
    pub fn stiffnesses_along(&self, axis: usize) -> impl Iterator<Item = f64> {
        self.between_bodies().map(move |pair| {
            let each = pair.outcome.contacts.iter().map(|contact| {
                let along = contact.normal[axis].powi(2);
                contact.stiffness * along + contact.tangential_stiffness * (1.0 - along)
            });
            each.sum::<f64>() * pair.branch[axis].powi(2)
        })
    }
}
