//! The active set: which bodies are frozen, and when they wake.
//!
//! A body rests when the running means of its net force, net moment and velocities are
//! small against its load scale, the larger of its weight and half the sum of its normal
//! forces. It is frozen when it and all it touches have rested for a number of steps.
//! Frozen bodies beside awake ones are examined again at fixed step numbers from the
//! forces on record; one that has lost a contact or much of its balance wakes then, one that
//! is struck at once.
//! All decisions are functions of the state, so they are the same in every run.

use super::World;
use femdem_contact::{Load, Partner};
use femdem_mesh::Vector3;

/// A sleeping body is struck by a contact that exceeds its load scale this many times. At
/// rest no contact can carry more than twice the scale.
const STRUCK: f64 = 2.0;

impl World {
    /// Freezes and wakes bodies; called after every step.
    pub(super) fn update_active_set(&mut self) {
        // Also where sleep is forbidden, so that bodies at rest sleep at once when it is
        // allowed again.
        self.count_quiet_steps();
        if !self.parameters.sleeping.enabled {
            return;
        }
        let struck = self.struck_bodies();
        self.wake(&struck);
        let recheck = u64::from(self.parameters.sleeping.recheck);
        if self.steps.is_multiple_of(recheck) {
            let sleepers = self.bodies_to_freeze();
            let wakers = self.bodies_to_wake();
            self.freeze(&sleepers);
            self.wake(&wakers);
        }
    }

    /// Wakes everything when a wall or driven body is about to move.
    pub(super) fn wake_for_drives(&mut self, ahead: f64) {
        let moves = self
            .wall_drives
            .iter()
            .any(|(d, _)| d.is_active(self.time, ahead))
            || self
                .awake
                .iter()
                .filter_map(|&i| self.bodies[i as usize].driven)
                .any(|(d, _)| d.is_active(self.time, ahead));
        if moves && self.awake.len() < self.bodies.len() {
            self.wake_all();
        }
    }

    /// Load scale of a body, N.
    fn scale(&self, i: usize, load: &Load) -> f64 {
        let weight = self.bodies[i].mass * self.parameters.gravity.norm();
        weight.max(0.5 * load.normal_sum)
    }

    /// Net force with gravity, N.
    pub(super) fn net_force(&self, i: usize, load: &Load) -> Vector3 {
        load.total.force + self.parameters.gravity * self.bodies[i].mass
    }

    /// Whether the mean force and moment are below `tolerance` of the load scale.
    fn is_balanced(&self, i: usize, load: &Load, tolerance: f64) -> bool {
        let bound = tolerance * self.scale(i, load);
        let body = &self.bodies[i];
        load.contacts > 0
            && body.means.force.norm() < bound
            && body.means.moment.norm() < bound * 2.0 * body.radius
    }

    /// Mixes a load into a body's running means with a weight.
    fn mix(&mut self, i: usize, load: &Load, share: f64) {
        let net = self.net_force(i, load);
        let body = &mut self.bodies[i];
        let turn = body.angular_velocity();
        let means = &mut body.means;
        means.force += (net - means.force) * share;
        means.moment += (load.total.torque - means.moment) * share;
        means.velocity += (body.velocity - means.velocity) * share;
        means.angular_velocity += (turn - means.angular_velocity) * share;
    }

    fn count_quiet_steps(&mut self) {
        let rule = self.parameters.sleeping;
        let share = 1.0 / f64::from(rule.window);
        for k in 0..self.awake.len() {
            let i = self.awake[k] as usize;
            let load = self.batch.loads()[i];
            self.mix(i, &load, share);
            let body = &self.bodies[i];
            let scale = self.scale(i, &load) * 2.0 * body.radius;
            let means = &body.means;
            let creep = 0.5
                * (body.mass * means.velocity.norm_squared()
                    + body.moments.max() * means.angular_velocity.norm_squared());
            let quiet = body.driven.is_some()
                || (creep < rule.creep * scale
                    && body.kinetic_energy() < rule.ringing * scale
                    && self.is_balanced(i, &load, rule.tolerance));
            let body = &mut self.bodies[i];
            body.means.contacts = load.contacts;
            body.quiet_steps = if quiet { body.quiet_steps + 1 } else { 0 };
        }
    }

    fn bodies_to_freeze(&self) -> Vec<u32> {
        let needed = self.parameters.sleeping.steps;
        let rested = |i: u32| self.bodies[i as usize].quiet_steps >= needed;
        let settled = |p: Partner| match p {
            Partner::Body(j) if self.batch.is_awake(j) => rested(j),
            Partner::Body(j) => self.holds(j),
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
                        .contacts_of(i)
                        .all(|c| settled(c.a) && settled(Partner::Body(c.b)))
            })
            .collect()
    }

    /// Whether the forces on record of a frozen body balance well enough for it to sleep on. Its
    /// means follow them with a delay, and are not followed up once nothing near it is awake.
    fn holds(&self, i: u32) -> bool {
        let load = self.batch.load_of(i);
        let bound = self.parameters.sleeping.wake * self.scale(i as usize, &load);
        let diameter = 2.0 * self.bodies[i as usize].radius;
        self.net_force(i as usize, &load).norm() < bound
            && load.total.torque.norm() < bound * diameter
    }

    /// Frozen neighbours of awake bodies that have lost a contact or whose forces on record
    /// no longer balance.
    fn bodies_to_wake(&mut self) -> Vec<u32> {
        let rule = self.parameters.sleeping;
        let share = f64::from(rule.recheck) / f64::from(rule.window);
        let mut list = self.batch.sleeping_neighbours();
        list.retain(|&i| {
            let load = self.batch.load_of(i);
            self.mix(i as usize, &load, share);
            let lost = load.contacts < self.bodies[i as usize].means.contacts;
            lost || !self.is_balanced(i as usize, &load, rule.wake)
        });
        list
    }

    /// Frozen bodies that an awake one has hit.
    fn struck_bodies(&self) -> Vec<u32> {
        let loads = self.batch.loads();
        self.batch
            .struck_sleepers(|i, force| force > STRUCK * self.scale(i as usize, &loads[i as usize]))
    }

    fn freeze(&mut self, list: &[u32]) {
        if list.is_empty() {
            return;
        }
        for &i in list {
            let body = &mut self.bodies[i as usize];
            self.flows.frozen += body.kinetic_energy();
            body.velocity = Vector3::zeros();
            body.momentum = Vector3::zeros();
            self.motions[i as usize] = body.motion();
            self.batch.set_awake(i, false);
        }
        self.awake.retain(|i| list.binary_search(i).is_err());
    }

    pub(super) fn wake(&mut self, list: &[u32]) {
        if list.is_empty() {
            return;
        }
        for &i in list {
            self.batch.wake_with_load(i);
            let body = &mut self.bodies[i as usize];
            body.quiet_steps = 0;
            // The means of force and moment go on: begun at zero they would let the body sleep
            // again before it has moved, begun at an impact they would keep it awake for long.
            body.means.velocity = Vector3::zeros();
            body.means.angular_velocity = Vector3::zeros();
        }
        self.awake.extend_from_slice(list);
        self.awake.sort_unstable();
    }

    /// Wakes all bodies.
    pub fn wake_all(&mut self) {
        let asleep: Vec<u32> = (0..self.bodies.len() as u32)
            .filter(|&i| !self.batch.is_awake(i))
            .collect();
        self.wake(&asleep);
    }

    /// Allows or forbids sleep; forbidding it wakes all bodies.
    pub fn set_sleeping(&mut self, enabled: bool) {
        self.parameters.sleeping.enabled = enabled;
        if !enabled {
            self.wake_all();
        }
    }
}
