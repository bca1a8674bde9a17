//! Bodies that a host has stopped: pairs of them keep their contacts and cost nothing.

use super::DeformablePart;
use super::body::SoftBody;
use super::pair::SoftPair;
use super::state::Sleep;
use crate::contact::BodyId;
use crate::deform::side::Side;

impl DeformablePart {
    /// Whether a deformable body is awake; `false` for one that does not exist.
    pub fn is_awake(&self, body: u32) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.sleep == Sleep::Awake)
    }

    /// Wakes a deformable body or puts it to sleep. The next update reads the state of a sleeping body once
    /// more, which should be at rest; after that it must not move until it is woken. Pairs of two sleeping
    /// bodies, and of a sleeping deformable body and a wall, are then no longer evaluated: their contacts
    /// stay as they are. A host that moves a wall must wake the bodies that touch it. A body that does not
    /// exist is ignored.
    pub fn set_awake(&mut self, body: u32, awake: bool) {
        let body = self.bodies.get_mut(body as usize);
        if let Some(body) = body.filter(|body| body.is_there) {
            body.sleep.set(awake);
        }
    }

    /// The same for a rigid body.
    pub fn set_rigid_awake(&mut self, body: BodyId, awake: bool) {
        if let Some(sleep) = self.rigid_sleep.get_mut(body as usize) {
            sleep.set(awake);
        }
    }

    /// Rigid bodies that touch an awake deformable body, in ascending order.
    pub fn rigid_beside_awake(&self) -> Vec<BodyId> {
        let touching = self.pairs.with_rigid().filter_map(|(i, pair)| {
            let touches = !pair.outcome.contacts.is_empty();
            (touches && self.is_awake(pair.b)).then_some(i)
        });
        // Pairs are sorted.
        let mut found: Vec<BodyId> = touching.collect();
        found.dedup();
        found
    }

    /// Whether the forces on a deformable body may have changed in the last update: not if it sleeps among
    /// sleepers. `false` for a body that does not exist.
    pub fn is_stirred(&self, body: u32) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.stirred)
    }

    /// Ends an update: all stopped bodies have been evaluated at rest.
    pub(super) fn settle(&mut self) {
        self.sleeps().for_each(Sleep::settle);
    }

    pub(super) fn sleeps(&mut self) -> impl Iterator<Item = &mut Sleep> {
        let bodies = self.bodies.iter_mut().map(|body| &mut body.sleep);
        bodies.chain(&mut self.rigid_sleep)
    }
}

/// Whether all bodies of a pair are frozen, so that it need not be evaluated.
pub(super) fn rests(pair: &SoftPair, bodies: &[SoftBody], rigid: &[Sleep]) -> bool {
    let frozen = |i: u32| {
        let body = bodies.get(i as usize);
        body.is_some_and(|body| body.sleep == Sleep::Frozen)
    };
    frozen(pair.b)
        && match pair.a {
            Side::Deformable(i) => frozen(i),
            Side::Rigid(i) => rigid.get(i as usize) == Some(&Sleep::Frozen),
            Side::Wall(_) => true,
        }
}
