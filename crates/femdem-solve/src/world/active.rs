//! The active set: which bodies are frozen, and when they wake.
//!
//! A body rests when the means of its net force, net moment and velocities over the steps since it last
//! moved, at most a window, are small: the forces against its weight or its load scale, as the rule has it, the
//! energy of its motion against its load scale, the larger of its weight and half the sum of its normal forces. It is frozen when
//! it has rested for a number of steps and the frozen bodies that it touches balance their loads. Frozen bodies beside awake ones
//! are re-examined at fixed step numbers from the recorded forces, and wake if they have lost their balance. A body that is
//! struck, or has lost a supporting contact, wakes at once. All decisions are functions of the state, so they are the same in
//! every run.
//!
//! What a frozen body is out of balance by is missing from the forces on the walls. Measured by its load it may be
//! many weights deep in a pack or under a piston. Where walls or bodies are driven the load may be anything, and
//! nothing is frozen until all are at rest after it. Bonded bodies are frozen and woken together.

use super::World;
use crate::body::Means;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::parameters::{SleepMeasure, SleepParameters, WorldParameters};
use femdem_contact::{Load, Partner, PeriodicCell};
use femdem_mesh::Vector3;
use std::collections::BTreeSet;

/// A contact strikes a sleeping body if its force exceeds the load scale by this factor. At rest no contact
/// can carry more than twice the scale.
const STRUCK: f64 = 2.0;

/// By its load a body whose load scale is more than this many times its weight is confined: an imbalance presses
/// it against its neighbours but hardly turns it over.
const CONFINED: f64 = 2.0;

/// A confined body sleeps under a larger share, in proportion to its load scale, up to this factor.
const LARGEST_SHARE: f64 = 2.0;

impl Means {
    /// Counts a step and returns its weight in the means. The means restart with every motion: the forces
    /// before the body came to rest say nothing about its balance.
    fn count(&mut self, moves: bool, window: u32) -> f64 {
        let before = if moves { 0 } else { self.samples };
        self.samples = window.min(before.saturating_add(1)).max(1);
        1.0 / f64::from(self.samples)
    }
}

impl World {
    /// Freezes and wakes bodies; called after every step.
    pub(super) fn update_active_set(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        // Also where sleep is forbidden, so that bodies at rest sleep at once when it is
        // allowed again.
        self.count_quiet_steps();
        if self.is_driven(0.0) {
            // All are awake. A body that is carried slowly would count as resting and be stopped while its
            // support moves on.
            for &i in &self.awake {
                self.bodies[i as usize].quiet_steps = 0;
            }
            self.unsettled = true;
        }
        if self.unsettled {
            let needed = self.parameters.sleeping.steps();
            let mut awake = self.awake.iter().map(|&i| &self.bodies[i as usize]);
            let rest = awake.all(|body| body.quiet_steps >= needed);
            self.unsettled = is_any(!rest, halo)?;
        }
        if self.unsettled || !self.parameters.sleeping.enabled {
            return Ok(());
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
        if self.may_rest_deformables() {
            // They are told when these have been judged too.
            return Ok(());
        }
        self.tell_rest(halo)
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

    /// Load scale of a body, N.
    fn scale(&self, i: usize, load: &Load) -> f64 {
        let weight = self.bodies[i].mass * self.parameters.gravity.norm();
        weight.max(0.5 * load.normal_sum)
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

    /// What the net force of a body is compared with, N.
    fn measure_of_balance(&self, i: usize, load: &Load) -> f64 {
        let weight = self.bodies[i].mass * self.parameters.gravity.norm();
        match self.parameters.sleeping.measure {
            SleepMeasure::Weight if weight > 0.0 => weight,
            SleepMeasure::Weight | SleepMeasure::Load => self.scale(i, load),
        }
    }

    /// Imbalance over its measure at which a frozen body wakes.
    fn wake_share(&self, i: usize, load: &Load) -> f64 {
        let rule = &self.parameters.sleeping;
        let weight = self.bodies[i].mass * self.parameters.gravity.norm();
        let (scale, limit) = (self.scale(i, load), CONFINED * weight);
        let factor = match rule.measure {
            SleepMeasure::Load if scale > limit => scale / limit,
            SleepMeasure::Load | SleepMeasure::Weight => 1.0,
        };
        rule.wake() * factor.min(LARGEST_SHARE)
    }

    /// Whether the mean force, and the mean moment over the diameter, are below `tolerance` of the measure.
    fn is_balanced(&self, i: usize, load: &Load, tolerance: f64) -> bool {
        let bound = tolerance * self.measure_of_balance(i, load);
        let body = &self.bodies[i];
        load.contacts > 0
            && body.means.force.norm() < bound
            && body.means.moment.norm() < bound * 2.0 * body.radius
    }

    /// Mixes a load into a body's means with a weight.
    fn mix(&mut self, i: usize, load: &Load, share: f64) {
        let (net, moment) = (self.net_force(i, load), self.net_torque(i, load));
        let body = &mut self.bodies[i];
        let turn = body.angular_velocity();
        let means = &mut body.means;
        means.force += (net - means.force) * share;
        means.moment += (moment - means.moment) * share;
        means.velocity += (body.velocity - means.velocity) * share;
        means.angular_velocity += (turn - means.angular_velocity) * share;
    }

    fn count_quiet_steps(&mut self) {
        let rule = self.parameters.sleeping;
        let beside = self.batch.rigid_beside_awake();
        for k in 0..self.awake.len() {
            let i = self.awake[k] as usize;
            let load = self.batch.loads()[i];
            let scale = self.scale(i, &load) * 2.0 * self.bodies[i].radius;
            let rings = self.bodies[i].kinetic_energy() >= rule.ringing() * scale;
            let share = self.bodies[i].means.count(rings, rule.window);
            self.mix(i, &load, share);
            let body = &self.bodies[i];
            let means = &body.means;
            let creep = 0.5
                * (body.mass * means.velocity.norm_squared()
                    + body.moments.max() * means.angular_velocity.norm_squared());
            let quiet = body.driven.is_some()
                || (!rings
                    && beside.binary_search(&(i as u32)).is_err()
                    && means.samples >= rule.window
                    && creep < rule.creep() * scale
                    && self.is_balanced(i, &load, rule.tolerance));
            let body = &mut self.bodies[i];
            body.means.contacts = load.contacts;
            body.quiet_steps = if quiet {
                body.quiet_steps.saturating_add(1)
            } else {
                0
            };
        }
    }

    fn bodies_to_freeze(&self) -> Vec<u32> {
        let needed = self.parameters.sleeping.steps();
        let rested = |i: u32| self.bodies[i as usize].quiet_steps >= needed;
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
        let share = self.wake_share(i as usize, &load);
        let bound = share * self.measure_of_balance(i as usize, &load);
        let diameter = 2.0 * self.bodies[i as usize].radius;
        self.net_force(i as usize, &load).norm() < bound
            && self.net_torque(i as usize, &load).norm() < bound * diameter
    }

    /// Frozen neighbours of awake bodies whose recorded forces no longer balance: in the mean, or at once for
    /// a body that has lost a contact.
    fn bodies_to_wake(&mut self) -> Vec<u32> {
        let rule = self.parameters.sleeping;
        let share = f64::from(rule.recheck()) / f64::from(rule.window);
        let mut list = self.batch.sleeping_neighbours();
        list.retain(|&i| !self.is_guest(i));
        list.retain(|&i| {
            let load = self.batch.load_of(i);
            self.mix(i as usize, &load, share);
            let lost = load.contacts < self.bodies[i as usize].means.contacts;
            self.bodies[i as usize].means.contacts = load.contacts;
            (lost && !self.holds(i))
                || !self.is_balanced(i as usize, &load, self.wake_share(i as usize, &load))
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
            !self.is_guest(i) && force > STRUCK * self.scale(i as usize, &loads[i as usize])
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
            let body = &mut self.bodies[i as usize];
            body.quiet_steps = 0;
            // The means of force and moment are kept. Restarted from zero they would let the body sleep again
            // before it has moved; restarted at an impact they would keep it awake for long.
            body.means.velocity = Vector3::zeros();
            body.means.angular_velocity = Vector3::zeros();
        }
        self.awake.extend_from_slice(list);
        self.awake.sort_unstable();
    }

    /// Judges bodies anew, and wakes those of them that are asleep: what holds them has changed.
    pub(super) fn stir(&mut self, list: &[u32]) {
        for &i in list {
            let body = &mut self.bodies[i as usize];
            body.quiet_steps = 0;
            body.means = Means::default();
        }
        let asleep = |i: &u32| !self.batch.is_awake(*i);
        let asleep: BTreeSet<u32> = list.iter().copied().filter(asleep).collect();
        self.wake(&Vec::from_iter(asleep));
    }

    fn stop_body(&mut self, i: usize) {
        let body = &mut self.bodies[i];
        self.flows.frozen += body.kinetic_energy();
        body.velocity = Vector3::zeros();
        body.momentum = Vector3::zeros();
        self.motions[i] = body.motion();
        if let Some(ahead) = self.ahead.get_mut(i) {
            *ahead = self.motions[i];
        }
    }

    /// Stops all awake rigid bodies except driven ones. Their kinetic energy is booked as
    /// [`Ledger::frozen`](crate::Ledger::frozen).
    ///
    /// Called whenever the bodies begin to [slow down](Self::is_slowing), this is kinetic damping (Barnes
    /// 1999, "Form finding and analysis of tension structures by dynamic relaxation"): each slow oscillation
    /// ends within a few quarters of its period, and steady motion is not resisted.
    pub fn stop(&mut self) {
        for k in 0..self.awake.len() {
            let i = self.awake[k] as usize;
            if self.bodies[i].driven.is_none() {
                self.stop_body(i);
            }
        }
        // The recorded dashpot forces belong to the earlier velocities.
        self.loaded = false;
    }

    /// Whether more of the awake rigid bodies are losing kinetic energy than gaining it; driven ones do not
    /// count. It counts bodies instead of comparing the total energy, so that a single body does not decide.
    pub fn is_slowing(&self) -> bool {
        let [losing, gaining] = self.slowing();
        losing > gaining
    }

    /// As [`is_slowing`](Self::is_slowing), of the bodies of all ranks.
    ///
    /// # Errors
    /// What `halo` reports.
    pub fn is_slowing_on(&self, halo: &mut dyn Halo) -> Result<bool, SolveError> {
        let mut counts = self.slowing();
        halo.sum(&mut counts)?;
        Ok(counts[0] > counts[1])
    }

    /// How many awake rigid bodies are losing kinetic energy, and how many are gaining it.
    fn slowing(&self) -> [u64; 2] {
        let loads = self.batch.loads();
        let mut counts = [0; 2];
        for &i in &self.awake {
            let (body, load) = (&self.bodies[i as usize], &loads[i as usize]);
            if body.driven.is_some() {
                continue;
            }
            let weight = self.parameters.gravity * body.mass;
            let mut wrench = load.total;
            wrench += &body.applied();
            let power = (wrench.force + weight).dot(&body.velocity)
                + wrench.torque.dot(&body.angular_velocity());
            counts[0] += u64::from(power < 0.0);
            counts[1] += u64::from(power > 0.0);
        }
        counts
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
