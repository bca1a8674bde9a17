//! The active set: which bodies are frozen, and when they wake.
//!
//! [One rule](crate::rest) says of rigid and deformable bodies whether they rest as wholes. A rigid one is frozen when
//! it has rested for a number of steps and the frozen bodies that it touches balance their loads; a deformable one when it also
//! [rests within itself](super::deformables). Frozen bodies beside awake ones
//! are re-examined at fixed step numbers from the recorded forces, and wake if they have lost their balance. A body that is
//! struck, or has lost a supporting contact, wakes at once. All decisions are functions of the state, so they are the same in
//! every run.
//!
//! What a frozen body is out of balance by is missing from the forces on the walls. Measured by its load it may be
//! many weights deep in a pack or under a piston. Where walls or bodies are driven the load may be anything, and
//! nothing is frozen until all are at rest after it. Bonded bodies are frozen and woken together.

use super::World;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::parameters::{SleepParameters, WorldParameters};
use crate::rest::{RestRecord, Whole};
use femdem_contact::{Load, Partner, PeriodicCell};
use femdem_mesh::Vector3;
use std::collections::BTreeSet;

/// A contact strikes a sleeping body if its force exceeds the load scale by this factor. At rest no contact
/// can carry more than twice the scale.
const STRUCK: f64 = 2.0;

impl World {
    /// Freezes and wakes bodies; called after every step. Over ranks it tells the others which bodies are awake.
    pub(super) fn update_active_set(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let rigid = self.rest_rigid(halo)?;
        let deformable = self.rest_deformables()?;
        if rigid || deformable {
            self.tell_rest(halo)?;
        }
        Ok(())
    }

    /// Freezes and wakes rigid bodies. Whether any may have been.
    fn rest_rigid(&mut self, halo: &mut dyn Halo) -> Result<bool, SolveError> {
        // Also where sleep is forbidden, so that bodies at rest sleep at once when it is
        // allowed again.
        self.count_quiet_steps();
        if self.is_driven(0.0) {
            // All are awake. A body that is carried slowly would count as resting and be stopped while its
            // support moves on.
            for &i in &self.awake {
                self.bodies[i as usize].rest.quiet_steps = 0;
            }
            self.unsettled = true;
        }
        if self.unsettled {
            let rule = self.parameters.sleeping;
            let mut awake = self.awake.iter().map(|&i| &self.bodies[i as usize]);
            let rest = awake.all(|body| body.rest.has_rested(&rule));
            self.unsettled = is_any(!rest, halo)?;
        }
        if self.unsettled || !self.parameters.sleeping.enabled {
            return Ok(false);
        }
        let struck = self.struck_bodies();
        self.wake(&struck);
        self.wake_left();
        let recheck = u64::from(self.parameters.sleeping.recheck());
        if self.steps.is_multiple_of(recheck) {
            self.tell_rest(halo)?;
            let sleepers = self.with_all_bonded(self.bodies_to_freeze(), halo)?;
            let wakers = self.bodies_to_wake();
            self.freeze(&sleepers);
            self.wake(&wakers);
        }
        Ok(true)
    }

    /// Wakes sleepers that have lost a contact without which they are not balanced. They are no longer beside
    /// any awake body, and would not be re-examined.
    pub(super) fn wake_left(&mut self) {
        let mut left = self.batch.left_sleepers();
        left.retain(|&i| !self.is_guest(i) && !self.holds(i));
        self.wake(&left);
    }

    /// Whether anything moves as prescribed, now or within `ahead` (s): a wall, a rigid body, nodes or the periodic cell.
    pub fn is_driven(&self, ahead: f64) -> bool {
        let time = self.time;
        let mut walls = self.wall_drives.iter();
        let bodies = || match self.share.as_deref() {
            Some(share) => share.is_driven(time, ahead),
            None => self.has_driven_bodies(ahead),
        };
        self.cell().is_some_and(PeriodicCell::moves)
            || walls.any(|(guide, _)| guide.is_active(time, ahead))
            || bodies()
    }

    fn has_driven_bodies(&self, ahead: f64) -> bool {
        let time = self.time;
        let bodies = self.awake.iter().map(|&i| &self.bodies[i as usize]);
        let mut guides = bodies.filter_map(|body| body.driven.as_deref());
        let deformables = self.deformables.as_deref();
        let mut boundaries = deformables.into_iter().flat_map(|d| d.boundaries());
        guides.any(|(guide, _)| guide.is_active(time, ahead))
            || boundaries.any(|boundary| boundary.is_driven(time, ahead))
    }

    /// Wakes everything before anything moves as prescribed. Returns whether something slept: the step was
    /// not chosen for it.
    pub(super) fn wake_for_drives(
        &mut self,
        ahead: f64,
        halo: &mut dyn Halo,
    ) -> Result<bool, SolveError> {
        if !self.is_driven(ahead) {
            return Ok(false);
        }
        let asleep = !self.batch.body_ids().all(|i| self.batch.is_awake(i));
        let wakes = is_any(asleep, halo)?;
        if wakes {
            self.wake_all();
        }
        Ok(wakes)
    }

    /// A rigid body as the rule of rest sees it.
    fn whole(&self, i: usize, load: &Load) -> Whole {
        let body = &self.bodies[i];
        Whole {
            mass: body.mass,
            moment_of_inertia: body.moments.max(),
            diameter: 2.0 * body.radius,
            weight: body.mass * self.parameters.gravity.norm(),
            measure: self.parameters.sleeping.measure,
            contacts: load.contacts,
            borne: load.normal_sum,
            force: self.net_force(i, load),
            moment: self.net_torque(i, load),
            velocity: body.velocity,
            angular_velocity: body.angular_velocity(),
            kinetic_energy: body.kinetic_energy(),
        }
    }

    /// Net force with gravity and external load, N, without dashpots: a body that dashpots alone hold is not at rest.
    pub(super) fn net_force(&self, i: usize, load: &Load) -> Vector3 {
        let body = &self.bodies[i];
        load.static_part().force + self.parameters.gravity * body.mass + body.applied().force
    }

    /// Net torque with the external load, N m, without dashpots.
    pub(super) fn net_torque(&self, i: usize, load: &Load) -> Vector3 {
        load.static_part().torque + self.bodies[i].applied().torque
    }

    fn count_quiet_steps(&mut self) {
        let rule = self.parameters.sleeping;
        let beside = self.batch.rigid_beside_awake();
        for k in 0..self.awake.len() {
            let i = self.awake[k];
            let whole = self.whole(i as usize, &self.batch.loads()[i as usize]);
            let body = &mut self.bodies[i as usize];
            let before = body.rest.quiet_steps;
            body.rest
                .count(&whole, &rule, beside.binary_search(&i).is_err());
            if body.driven.is_some() {
                body.rest.quiet_steps = before.saturating_add(1);
            }
        }
    }

    fn bodies_to_freeze(&self) -> Vec<u32> {
        let rule = &self.parameters.sleeping;
        let rested = |i: u32| self.bodies[i as usize].rest.has_rested(rule);
        let settled = |p: Partner| match p {
            Partner::Body(j) => self.batch.is_awake(j) || self.stays_balanced(j),
            Partner::Wall(_) => true,
        };
        self.awake
            .iter()
            .copied()
            .filter(|&i| {
                rested(i)
                    && self.bodies[i as usize].driven.is_none()
                    && self
                        .batch
                        .rigid_contacts_of(i)
                        .all(|c| settled(c.a) && settled(Partner::Body(c.b)))
            })
            .collect()
    }

    /// Whether the recorded forces of a frozen body balance well enough for it to stay asleep. Its means
    /// follow them with a delay, and are not updated once nothing near it is awake.
    pub(super) fn holds(&self, i: u32) -> bool {
        let load = self.batch.load_of(i);
        self.whole(i as usize, &load)
            .holds(&self.parameters.sleeping)
    }

    /// Frozen neighbours of awake bodies whose recorded forces no longer balance: in the mean, or at once for
    /// a body that has lost a contact.
    fn bodies_to_wake(&mut self) -> Vec<u32> {
        let rule = self.parameters.sleeping;
        let mut list = self.batch.sleeping_neighbours();
        list.retain(|&i| !self.is_guest(i));
        list.retain(|&i| {
            let whole = self.whole(i as usize, &self.batch.load_of(i));
            self.bodies[i as usize].rest.has_lost_balance(&whole, &rule)
        });
        list
    }

    /// Frozen bodies that an awake one has struck.
    fn struck_bodies(&self) -> Vec<u32> {
        if self.awake.len() == self.rigid_count() {
            return Vec::new();
        }
        let loads = self.batch.loads();
        self.batch.struck_sleepers(|i, force| {
            !self.is_guest(i) && force > STRUCK * self.whole(i as usize, &loads[i as usize]).scale()
        })
    }

    fn freeze(&mut self, list: &[u32]) {
        if list.is_empty() {
            return;
        }
        for &i in list {
            self.stop_body(i as usize);
            self.batch.set_awake(i, false);
        }
        self.awake.retain(|i| list.binary_search(i).is_err());
    }

    pub(super) fn wake(&mut self, list: &[u32]) {
        if list.is_empty() {
            return;
        }
        let list = &self.with_bonded_sleepers(list)[..];
        for &i in list {
            self.batch.wake_with_load(i);
            self.bodies[i as usize].rest.wake();
        }
        self.awake.extend_from_slice(list);
        self.awake.sort_unstable();
    }

    /// Judges bodies anew, and wakes those of them that are asleep: what holds them has changed.
    pub(super) fn stir(&mut self, list: &[u32]) {
        for &i in list {
            self.bodies[i as usize].rest = RestRecord::default();
        }
        let asleep = |i: &u32| !self.batch.is_awake(*i);
        let asleep: BTreeSet<u32> = list.iter().copied().filter(asleep).collect();
        self.wake(&Vec::from_iter(asleep));
    }

    /// Wakes all bodies.
    pub fn wake_all(&mut self) {
        let ids = self.rigid_ids();
        let asleep = ids.filter(|&i| !self.batch.is_awake(i));
        let (guests, own): (Vec<u32>, Vec<u32>) = asleep.partition(|&i| self.is_guest(i));
        self.wake(&own);
        for guest in guests {
            self.batch.set_awake(guest, true);
        }
        if let Some(deformables) = &mut self.deformables {
            deformables.wake_all(&mut self.batch);
        }
    }

    /// Allows or forbids sleep; forbidding it wakes all bodies.
    pub fn set_sleeping(&mut self, enabled: bool) {
        self.parameters.sleeping.enabled = enabled;
        if !enabled {
            self.wake_all();
        }
    }

    /// Replaces the rule by which bodies are frozen and woken; one that forbids sleep wakes all bodies.
    /// Deformable bodies wake in any case and are judged again.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] for a parameter out of range; the rule is then unchanged.
    pub fn set_sleep_rule(&mut self, rule: SleepParameters) -> Result<(), SolveError> {
        let parameters = WorldParameters {
            sleeping: rule,
            ..self.parameters
        };
        parameters.validate()?;
        self.parameters = parameters;
        self.set_sleeping(rule.enabled);
        if let Some(deformables) = &mut self.deformables {
            deformables.wake_all(&mut self.batch);
        }
        Ok(())
    }
}

/// Whether something is so on any rank.
pub(super) fn is_any(so: bool, halo: &mut dyn Halo) -> Result<bool, SolveError> {
    let mut least = [if so { 0.0 } else { 1.0 }];
    halo.least(&mut least)?;
    Ok(least[0] < 1.0)
}
