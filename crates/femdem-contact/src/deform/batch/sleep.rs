//! Bodies that a host has stopped: what is between them stays as it is and costs nothing.

use super::DeformableBatch;
use super::body::SoftBody;
use super::pairs::SoftPair;
use crate::contact::BodyId;
use crate::deform::record::DeformablePartner;
use serde::{Deserialize, Serialize};

/// Whether a body may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Sleep {
    Awake,
    /// It was stopped since its contacts were evaluated.
    Stopped,
    /// Its contacts were evaluated with it at rest.
    Frozen,
}

impl Sleep {
    fn set(&mut self, awake: bool) {
        *self = match (awake, *self) {
            (true, _) => Self::Awake,
            (false, Self::Awake) => Self::Stopped,
            (false, asleep) => asleep,
        };
    }

    /// Has the next update evaluate all pairs that it is in, once more.
    pub fn stir(&mut self) {
        if *self == Self::Frozen {
            *self = Self::Stopped;
        }
    }

    /// Ends an update.
    fn settle(&mut self) {
        if *self == Self::Stopped {
            *self = Self::Frozen;
        }
    }
}

impl DeformableBatch {
    /// Whether a deformable body is awake; `false` for one that does not exist.
    pub fn is_awake(&self, body: u32) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.sleep == Sleep::Awake)
    }

    /// Wakes a deformable body or puts it to sleep. The next update sees a sleeping body as its state says, which
    /// should be at rest; after that it must not move until it is woken. Between two bodies that sleep, and
    /// between a deformable one and a wall, nothing is evaluated then: their contacts stay as they are. A host that moves a wall wakes
    /// what touches it. A body that does not exist is ignored.
    pub fn set_awake(&mut self, body: u32, awake: bool) {
        if let Some(body) = self.bodies.get_mut(body as usize) {
            body.sleep.set(awake);
        }
    }

    /// The same for a rigid body.
    pub fn set_rigid_awake(&mut self, body: BodyId, awake: bool) {
        if let Some(sleep) = self.rigid_sleep.get_mut(body as usize) {
            sleep.set(awake);
        }
    }

    /// Rigid bodies that deformable ones touch which are awake, in ascending order.
    pub fn rigid_beside_awake(&self) -> Vec<BodyId> {
        let touching = self.pairs.list().iter().filter_map(|pair| match pair.a {
            DeformablePartner::Rigid(i) if pair.outcome.contact.is_some() => {
                self.is_awake(pair.b).then_some(i)
            }
            _ => None,
        });
        // Pairs are sorted.
        let mut found: Vec<BodyId> = touching.collect();
        found.dedup();
        found
    }

    /// Whether the forces on a deformable body may be others than before the last update: not those on one that sleeps
    /// among sleepers. `false` for one that does not exist.
    pub fn is_stirred(&self, body: u32) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.stirred)
    }

    /// Has the next update evaluate the contacts of sleepers too.
    pub(super) fn evaluate_all(&mut self) {
        self.sleeps().for_each(Sleep::stir);
    }

    /// Ends an update: it has seen at rest all that was stopped.
    pub(super) fn settle(&mut self) {
        self.sleeps().for_each(Sleep::settle);
    }

    fn sleeps(&mut self) -> impl Iterator<Item = &mut Sleep> {
        let bodies = self.bodies.iter_mut().map(|body| &mut body.sleep);
        bodies.chain(&mut self.rigid_sleep)
    }
}

/// Notes which bodies' forces may have changed: those that are not frozen, and those in pairs that do not rest; or `all`.
pub(super) fn stir(bodies: &mut [SoftBody], rigid: &[Sleep], pairs: &[SoftPair], all: bool) {
    for body in bodies.iter_mut() {
        body.stirred = all || body.sleep != Sleep::Frozen;
    }
    for pair in pairs {
        if pair.rests(bodies, rigid) {
            continue;
        }
        for i in pair.deformables() {
            if let Some(body) = bodies.get_mut(i as usize) {
                body.stirred = true;
            }
        }
    }
}
