//! Which adaptive bodies change, and when.
//!
//! Stress is linear in the forces, and the ratio of stress to strength is convex and grows in proportion: if r is used by the forces F now and
//! c is what a unit force uses, forces F' use about r + c Σ (|F' − F| + |M' − M|/d + |F| s), over the patches of contact, with their moments M
//! and the inscribed diameter d; s is by how much the patch has moved, in d, and its area has shrunk, in itself. Only where this exceeds the limit
//! is there another static solve. It is an estimate: c is found at some of the skin's nodes, and a force is spread otherwise than on one node.

use super::super::Deformables;
use super::basis::{Basis, nodal_means, worst};
use super::spin::Kept;
use super::{AdaptiveBody, Adaptives};
use crate::error::SolveError;
use crate::world::World;
use femdem_contact::{BodyId, Contact, Partner};
use femdem_fem::free_body::PatchLoad;
use femdem_mesh::{Pose, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A body is deformable from this part of its strength on.
const NEAR: f64 = 0.7;

/// A body that uses less than this part of its strength may become rigid.
const FAR: f64 = 0.3;

/// A body is at rest within itself if its kinetic energy, but for that of its motion as a whole, is at most this part of V f²/(2 E), with its
/// volume V, tensile strength f and Young's modulus E: of what it stores near its strength.
const QUIET: f64 = 1e-6;

/// Looks in a row at which a body has to be at rest within itself and far from its strength.
const WINDOW: u32 = 20;

/// The force of a patch is another one if its point has moved by more than this part of the inscribed diameter.
const MOVED: f64 = 0.05;

/// The last static solve of a rigid body.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Screen {
    /// The part of its strength that its stresses used.
    ratio: f64,
    /// The forces of its patches then.
    forces: Vec<Pressed>,
}

/// The force of a patch, in the coordinates of the body.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Pressed {
    by: Partner,
    /// N.
    force: Vector3,
    /// N m.
    moment: Vector3,
    /// m.
    point: Vector3,
    /// m^2.
    area: f64,
}

impl Screen {
    /// Sum of the changes of the forces, N: each patch of a partner is the nearest one that this had. `reach` is the inscribed diameter, m.
    fn change(&self, now: &[Pressed], reach: f64) -> f64 {
        let mut is_met = vec![false; self.forces.len()];
        let mut change = 0.0;
        for new in now {
            let way = |old: &Pressed| (old.point - new.point).norm();
            let own = (0..self.forces.len()).filter(|i| {
                let old = &self.forces[*i];
                !is_met[*i] && old.by == new.by && way(old) <= MOVED * reach
            });
            let nearest =
                own.min_by(|i, j| way(&self.forces[*i]).total_cmp(&way(&self.forces[*j])));
            change += match nearest {
                Some(i) => {
                    is_met[i] = true;
                    new.change_from(&self.forces[i], reach)
                }
                None => new.size(reach),
            };
        }
        let gone = self.forces.iter().zip(&is_met).filter(|(_, met)| !**met);
        change + gone.map(|(old, _)| old.size(reach)).sum::<f64>()
    }
}

impl Pressed {
    fn size(&self, reach: f64) -> f64 {
        self.force.norm() + self.moment.norm() / reach
    }

    fn change_from(&self, old: &Self, reach: f64) -> f64 {
        let other = (self.force - old.force).norm() + (self.moment - old.moment).norm() / reach;
        let moved = (self.point - old.point).norm() / reach;
        let shrunk = if self.area < old.area {
            1.0 - self.area / old.area
        } else {
            0.0
        };
        other + self.force.norm() * (moved + shrunk)
    }
}

/// The contacts of a body in its coordinates.
#[derive(Default)]
pub(super) struct Loads {
    pub patches: Vec<PatchLoad>,
    forces: Vec<Pressed>,
}

impl Loads {
    /// `pose` maps the coordinates of the body to the world; the contacts are those of body `id`.
    fn new<'a>(id: BodyId, pose: &Pose, contacts: impl Iterator<Item = &'a Contact>) -> Self {
        let mut loads = Self::default();
        for contact in contacts {
            let (sign, by) = match contact.a {
                a if contact.b == id => (1.0, a),
                _ => (-1.0, Partner::Body(contact.b)),
            };
            let patch = PatchLoad {
                point: contact.point.into(),
                normal: contact.normal * sign,
                area: contact.area,
                force: contact.force_on_b() * sign,
                moment: (contact.rocking + contact.rolling) * sign,
            };
            let patch = patch.seen_from(pose);
            loads.forces.push(Pressed {
                by,
                force: patch.force,
                moment: patch.moment,
                point: patch.point.coords,
                area: patch.area,
            });
            loads.patches.push(patch);
        }
        loads
    }
}

/// What becomes of a body.
pub(super) enum Verdict {
    Soften,
    Harden,
}

/// A body that changes, with its largest stress over its strength as found by forces on discs.
struct Change {
    id: BodyId,
    ratio: f64,
    verdict: Verdict,
}

impl World {
    /// Looks at the adaptive bodies, and makes those deformable or rigid that it is time for. Called after each step.
    pub(in crate::world) fn adapt_bodies(&mut self) -> Result<(), SolveError> {
        let Some(mut adaptives) = self.adaptives.take() else {
            return Ok(());
        };
        let found = self.look_at(&mut adaptives);
        self.adaptives = Some(adaptives);
        for Change { id, ratio, verdict } in found? {
            let (time, steps) = (self.time, self.steps);
            let changed = match verdict {
                Verdict::Soften => self.soften(id),
                Verdict::Harden => self.harden(id, ratio),
            };
            changed.map_err(|error| error.in_body(id as usize, steps, time))?;
        }
        Ok(())
    }

    fn look_at(&mut self, adaptives: &mut Adaptives) -> Result<Vec<Change>, SolveError> {
        let Adaptives { bodies, bases, .. } = adaptives;
        let steps = self.steps;
        let is_due = |body: &AdaptiveBody| {
            let every = u64::from(body.adaptive.fracture.every);
            steps.is_multiple_of(every)
        };
        if !bodies.values().any(is_due) {
            return Ok(Vec::new());
        }
        let contacts = self.batch.contacts();
        let mut of_bodies: BTreeMap<BodyId, Vec<&Contact>> = BTreeMap::new();
        for contact in &contacts {
            of_bodies.entry(contact.b).or_default().push(contact);
            if let Partner::Body(a) = contact.a
                && a != contact.b
            {
                of_bodies.entry(a).or_default().push(contact);
            }
        }
        let mut changes = Vec::new();
        for (&id, body) in bodies.iter_mut().filter(|(_, body)| is_due(body)) {
            if self.batch.is_deformable(id) {
                if let Some(ratio) = self.is_quiet(id, body)? {
                    let verdict = Verdict::Harden;
                    changes.push(Change { id, ratio, verdict });
                }
                continue;
            }
            let Some(own) = of_bodies.get(&id).filter(|_| self.batch.is_awake(id)) else {
                continue;
            };
            let basis = match bases.entry(body.adaptive.model) {
                std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
                std::collections::btree_map::Entry::Vacant(place) => {
                    place.insert(self.basis(body)?)
                }
            };
            let rigid = &self.bodies[id as usize];
            let pose = rigid.pose(&self.shapes[rigid.shape as usize]);
            let loads = Loads::new(id, &pose, own.iter().copied());
            if let Some(ratio) = body.screen(basis, loads)? {
                let verdict = Verdict::Soften;
                changes.push(Change { id, ratio, verdict });
            }
        }
        Ok(changes)
    }

    fn basis(&self, body: &AdaptiveBody) -> Result<Basis, SolveError> {
        let models = self.deformables.as_deref().map_or(&[][..], |d| &d.models);
        let number = body.adaptive.model as usize;
        let missing = || SolveError::NoSuch {
            what: "model",
            index: number,
            count: models.len(),
        };
        let model = models.get(number).ok_or_else(missing)?;
        Basis::new(model, &body.adaptive.fracture.strength)
    }

    /// Whether a deformable body is to become rigid, with its largest stress over its strength then.
    fn is_quiet(&self, id: BodyId, body: &mut AdaptiveBody) -> Result<Option<f64>, SolveError> {
        let Some(Deformables { models, bodies, .. }) = self.deformables.as_deref() else {
            return Ok(None);
        };
        let state = &bodies[id as usize];
        let model = &models[state.model as usize];
        let masses = model.model.masses();
        let strength = &body.adaptive.fracture.strength;
        let kept = Kept {
            mass: masses.iter().sum(),
            momentum: state.momentum(masses),
            angular_momentum: state.angular_momentum(masses, &Vector3::zeros()),
        };
        let within = kept.rigid_energy(&state.positions, masses);
        let within = within.map(|rigid| state.kinetic_energy(masses) - rigid);
        let volume: f64 = model.model.volumes().iter().sum();
        let scale = volume * strength.tensile().powi(2) / (2.0 * model.young);
        let is_whole = state.breakable.as_deref().is_some_and(|breakable| {
            let same = breakable.factors.len() == body.factors.len();
            same && breakable.cracks.is_none() && breakable.spent.is_empty()
        });
        if !is_whole || within.is_none_or(|energy| energy > QUIET * scale) {
            body.quiet = 0;
            return Ok(None);
        }
        let stresses = model.model.stresses(&state.positions, &state.history)?;
        let ratio = worst(
            strength,
            &nodal_means(&model.model, &stresses),
            &body.factors,
        );
        body.quiet = if ratio < FAR { body.quiet + 1 } else { 0 };
        Ok((body.quiet >= WINDOW).then_some(ratio))
    }
}

impl AdaptiveBody {
    /// The largest stress of a rigid body over its strength, if that is near it.
    fn screen(&mut self, basis: &Basis, loads: Loads) -> Result<Option<f64>, SolveError> {
        let weakest = self.factors.iter().copied().fold(f64::INFINITY, f64::min);
        let change = self.screen.change(&loads.forces, basis.reach());
        if self.screen.ratio + basis.unit / weakest * change < NEAR {
            return Ok(None);
        }
        let solved = basis.solve(&loads.patches)?;
        let strength = &self.adaptive.fracture.strength;
        let ratio = worst(strength, solved.corners(), &self.factors);
        self.screen = Screen {
            ratio,
            forces: loads.forces,
        };
        Ok((ratio >= NEAR).then_some(ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed(by: Partner, x: f64, force: f64) -> Pressed {
        Pressed {
            by,
            force: Vector3::x() * force,
            moment: Vector3::zeros(),
            point: Vector3::x() * x,
            area: 1e-6,
        }
    }

    /// A body of 1 cm that is jammed in a wall which goes round it: the forces on its sides are opposite, and their sum is none.
    #[test]
    fn opposite_forces_of_one_partner_are_a_change() {
        let wall = Partner::Wall(0);
        let jam = |force: f64| [pressed(wall, -0.005, force), pressed(wall, 0.005, -force)];
        let screen = Screen {
            ratio: 0.0,
            forces: jam(10.0).to_vec(),
        };
        assert_eq!(screen.change(&jam(10.0), 0.01), 0.0);
        assert!((screen.change(&jam(35.0), 0.01) - 50.0).abs() < 1e-9);
        assert!((screen.change(&[], 0.01) - 20.0).abs() < 1e-9);
        // The other order of the same patches is no change.
        let [one, two] = jam(10.0);
        assert_eq!(screen.change(&[two, one], 0.01), 0.0);
    }

    #[test]
    fn moments_and_smaller_areas_are_changes() {
        let screen = Screen {
            ratio: 0.0,
            forces: vec![pressed(Partner::Wall(0), 0.0, 10.0)],
        };
        let mut now = screen.forces.clone();
        now[0].moment = Vector3::y() * 0.02;
        assert!((screen.change(&now, 0.01) - 2.0).abs() < 1e-12);
        let mut now = screen.forces.clone();
        now[0].area /= 4.0;
        assert!((screen.change(&now, 0.01) - 7.5).abs() < 1e-12);
    }
}
