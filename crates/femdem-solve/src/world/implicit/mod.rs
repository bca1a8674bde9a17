//! A linearly implicit step: all contacts at once, with the velocities at its end.
//!
//! One Newton step of the backward Euler method (after Baraff & Witkin 1998, "Large steps in cloth
//! simulation"). Existing contacts that do not become much harder are linearised at the present positions,
//! the others at the positions predicted from the present velocities. So contacts are detected before they
//! close, and a body that falls or tips over is stopped at the surface and not inside it. With x the change
//! of the velocities, (M/dt + C + dt K) x = f, where f are the forces there with the dashpots at the present
//! velocities, and K and C the springs and dashpots of every contact ([`Link`]). Friction beyond its bound,
//! rocking moments that would move the pressure out of the patch, and contacts that would pull, are corrected
//! in further solutions. The applied forces respect their bounds in any case, and act in opposite pairs.

mod link;
mod system;
mod twist;

use super::World;
use super::medium::relaxation;
use super::periodic::check_rests;
use super::time_step::LARGEST_MOVE;
use crate::body::Body;
use crate::clock::Stopwatch;
use crate::error::{SolveError, check};
use crate::halo::Halo;
use crate::ledger::{Flows, Pending};
use crate::parameters::ImplicitStep;
use crate::rotation;
use femdem_contact::{BodyId, ContactForce, Motion, Partner, RigidContact, Snapshot, Wrench};
use femdem_fem::Driven;
use femdem_mesh::{Matrix3, Rotation, Vector3};
use link::Link;
use system::{Inertia, System};
use twist::Twist;

/// Most that a body may move in a step, over its bounding diameter.
const REACH: f64 = 0.03;

/// Relative tolerance of the linear systems: of those that only decide which contacts stick, slide or open, and of the last. With more
/// than 0.01 bodies fly apart.
const TOLERANCES: [f64; 2] = [3.0 * 3e-3, 3e-3];

/// Most rounds of conjugate gradients for a system.
const ROUNDS: u32 = 100;

/// Most systems in a step: after each the friction follows its bound, and contacts that would pull are left out. More follow
/// where one left out closes.
const SYSTEMS: u32 = 3;

/// A free body before the step.
struct Before {
    position: Vector3,
    orientation: Rotation,
    velocity: Vector3,
    momentum: Vector3,
    turning: Vector3,
}

impl Before {
    fn of(body: &Body) -> Self {
        Self {
            position: body.position,
            orientation: body.orientation,
            velocity: body.velocity,
            momentum: body.momentum,
            turning: body.angular_velocity(),
        }
    }
}

impl World {
    /// Over ranks the first one has all bodies meanwhile: the system of all contacts is one.
    pub(super) fn step_implicit(
        &mut self,
        rule: &ImplicitStep,
        host: &mut dyn FnMut(Partner, f64) -> Option<Driven>,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        let deformable = self.deformable_count();
        check(
            "deformable bodies with time_step.implicit",
            deformable as f64,
            deformable == 0,
            "0: implicit steps are for rigid bodies",
        )?;
        self.refuse_bonds("bonds with time_step.implicit")?;
        self.refuse_adaptive(None, "explicit steps", "implicit steps")?;
        self.cell().map_or(Ok(()), check_rests)?;
        self.deal_to_first(halo)?;
        self.meet_newcomers()?;
        let since = std::mem::take(&mut self.behind);
        let mut dt = self.choose_implicit_step(rule, halo)?;
        self.ask(self.time + dt, host)?;
        if self.wake_for_drives(dt, halo)? {
            dt = self.choose_implicit_step(rule, halo)?;
            self.ask(self.time + dt, host)?;
        }
        self.check_step(dt)?;
        let before = self.look_ahead(since, dt, halo)?;
        let wrenches = self.answer_contacts(dt, &before)?;
        for (k, (before, wrench)) in before.iter().zip(&wrenches).enumerate() {
            let i = self.awake[k] as usize;
            if self.bodies[i].driven.is_none() {
                self.move_on(i, dt, before, wrench)?;
            } else {
                self.motions[i] = self.ahead[i];
            }
        }
        self.book_driven(dt);
        self.time += dt;
        self.arrive();
        self.steps += 1;
        // The recorded contacts do not belong to the present positions.
        self.loaded = false;
        self.behind = dt;
        self.book_exchange(0.0);
        self.counters.body_steps += self.awake.len() as u64;
        self.update_active_set(halo)
    }

    /// Evaluates the existing contacts, and those that would close within the step. Leaves free bodies at the
    /// poses predicted from their present velocities, and returns their earlier states.
    fn look_ahead(
        &mut self,
        since: f64,
        dt: f64,
        halo: &mut dyn Halo,
    ) -> Result<Vec<Before>, SolveError> {
        if self.ahead.len() != self.motions.len() {
            self.ahead = self.motions.clone();
        }
        let mut before = Vec::with_capacity(self.awake.len());
        for &i in &self.awake {
            let body = &self.bodies[i as usize];
            before.push(Before::of(body));
            let motion = &mut self.motions[i as usize];
            motion.velocity = body.velocity;
            motion.angular_velocity = body.angular_velocity();
        }
        let walls = self.wall_motions.clone();
        std::mem::swap(&mut self.motions, &mut self.ahead);
        let drifted = self.drift(dt, halo);
        std::mem::swap(&mut self.motions, &mut self.ahead);
        drifted?;
        let watch = Stopwatch::start();
        let now = Snapshot {
            bodies: &self.motions,
            walls: &walls,
            dt: since,
        };
        let ahead = Snapshot {
            bodies: &self.ahead,
            walls: &self.wall_motions,
            dt,
        };
        let result = self.batch.update_springs(now, ahead);
        self.count_contacts(Some(watch), result)?;
        Ok(before)
    }

    fn choose_implicit_step(
        &mut self,
        rule: &ImplicitStep,
        halo: &mut dyn Halo,
    ) -> Result<f64, SolveError> {
        self.renew_cap(halo)?;
        let mut most = self.parameters.time_step.largest.unwrap_or(f64::INFINITY);
        let gravity = self.parameters.gravity;
        let driving = self.driving();
        most = most.min(driving.step);
        for &i in &self.awake {
            let body = &self.bodies[i as usize];
            let pull = (gravity + body.applied().force / body.mass).norm();
            if pull > 0.0 {
                most = most.min(rule.fall * (2.0 * body.radius / pull).sqrt());
            }
            let turning = body.momentum.component_div(&body.moments).norm();
            let mut speed = body.velocity.norm().max(turning * body.radius);
            if driving.is_any() {
                speed += driving.met(&body.position, body.radius);
            }
            if body.driven.is_none() && speed * most > 2.0 * REACH * body.radius {
                most = 2.0 * REACH * body.radius / speed;
            }
        }
        halo.least(std::slice::from_mut(&mut most))?;
        Ok(self.step_control.choose_implicit(rule.multiple, most))
    }

    /// Solves for the forces of the contacts, records them, and returns their wrench on each awake body in
    /// the step, about its centroid; `None` for one without contact.
    fn answer_contacts(
        &mut self,
        dt: f64,
        before: &[Before],
    ) -> Result<Vec<Option<Wrench>>, SolveError> {
        let mut members = Vec::new();
        let mut bodies = Vec::new();
        for (k, &i) in self.awake.iter().enumerate() {
            let touches = self.batch.loads()[i as usize].contacts > 0;
            if touches && self.bodies[i as usize].driven.is_none() {
                members.push(k);
                bodies.push(i);
            }
        }
        let mut wrenches = vec![None; before.len()];
        if members.is_empty() {
            return Ok(wrenches);
        }
        let (decay, reach) = relaxation(self.parameters.medium.drag, dt);
        let mut system = System {
            inertias: Vec::with_capacity(members.len()),
            links: self
                .batch
                .evaluated()
                .map(|c| self.link(c, &bodies, dt))
                .collect(),
        };
        let mut others = Vec::with_capacity(members.len());
        for &k in &members {
            let (before, body) = (&before[k], &self.bodies[self.awake[k] as usize]);
            let inertia = inertia(before, body, reach);
            let applied = body.applied_at(&before.orientation);
            others.push(Twist {
                velocity: self.parameters.gravity * body.mass
                    + applied.force
                    + before.velocity * (inertia.mass * (decay - 1.0)),
                turning: inertia.turning * before.turning * (decay - 1.0) + applied.torque,
            });
            system.inertias.push(inertia);
        }
        let mut x = self.solve_contacts(&mut system, &others);
        let mut sums = vec![Twist::default(); members.len()];
        let answer = |link: &Link| link.answer(&x, &mut sums);
        let forces: Vec<ContactForce> = system.links.iter().map(answer).collect();
        // The velocity changes due to the forces within their bounds.
        for (((x, sum), other), inertia) in
            x.iter_mut().zip(&sums).zip(&others).zip(&system.inertias)
        {
            *x = inertia.response(sum, other);
        }
        let mut pending = Pending::default();
        for (link, forces) in system.links.iter().zip(&forces) {
            let works = link.works(forces, &x);
            self.flows.friction_work -= works.friction;
            pending.damping += works.damping;
            pending.taken += works.pressing;
        }
        self.flows.pending = Some(pending);
        self.batch.set_forces(&forces)?;
        for (&k, sum) in members.iter().zip(&sums) {
            wrenches[k] = Some(Wrench {
                force: sum.velocity,
                torque: sum.turning,
            });
        }
        Ok(wrenches)
    }

    /// Solves the system until friction, rocking and parting contacts agree with the solution, or up to the
    /// largest number of systems, and then until no excluded contact closes. Returns the changes of the
    /// velocities.
    fn solve_contacts(&mut self, system: &mut System, others: &[Twist]) -> Vec<Twist> {
        let [rough, last] = TOLERANCES;
        // Links that part later stay in the preconditioner, which need not be exact.
        let inverses = system.inverse_blocks();
        let mut x = vec![Twist::default(); others.len()];
        let mut solve = |system: &System, x: &mut [Twist], tolerance: f64| {
            let rounds = system.solve(&inverses, others.to_vec(), x, tolerance, ROUNDS);
            self.counters.linear_systems += 1;
            self.counters.linear_rounds += u64::from(rounds);
        };
        for _ in 1..SYSTEMS {
            solve(system, &mut x, rough);
            let mut changed = false;
            for link in &mut system.links {
                changed |= link.follow(&x);
            }
            if !changed {
                break;
            }
        }
        loop {
            solve(system, &mut x, last);
            // If an excluded contact closes, its spring would act explicitly, far beyond the stability limit.
            let mut closed = false;
            for link in &mut system.links {
                closed |= link.close_again(&x);
            }
            if !closed {
                return x;
            }
        }
    }

    /// The link of a contact, with both arms to the same point, so that the angular momentum of the two is
    /// conserved; for a foreseen contact that point follows the mean motion of both. `members` are the free
    /// bodies, ascending.
    fn link(&self, contact: &RigidContact, members: &[BodyId], dt: f64) -> Link {
        let place = |i: BodyId| members.binary_search(&i).ok().map(|k| k as u32);
        let (a, side_a): (&Motion, _) = match contact.a {
            Partner::Body(i) => (&self.ahead[i as usize], place(i)),
            Partner::Wall(w) => (&self.wall_motions[w as usize], None),
        };
        let (b, side_b) = (&self.ahead[contact.b as usize], place(contact.b));
        let before = Twist {
            velocity: b.velocity_at(&contact.arm_b) - a.velocity_at(&contact.arm_a),
            turning: b.angular_velocity - a.angular_velocity,
        };
        let mut arms = [contact.arm_a, contact.arm_b];
        if contact.foreseen && side_a.is_some() && side_b.is_some() {
            let half = (b.velocity - a.velocity) * (0.5 * dt);
            arms = [arms[0] - half, arms[1] + half];
        }
        let friction = self
            .batch
            .law_of(contact.a, contact.b)
            .map_or(0.0, |law| law.friction);
        Link::new(contact, [side_a, side_b], arms, before, friction, dt)
    }

    /// Moves a free body from where it was before the step to its end.
    fn move_on(
        &mut self,
        i: usize,
        dt: f64,
        before: &Before,
        wrench: &Option<Wrench>,
    ) -> Result<(), SolveError> {
        let (decay, reach) = relaxation(self.parameters.medium.drag, dt);
        let gravity = self.parameters.gravity;
        let body = &mut self.bodies[i];
        let applied = body.applied_at(&before.orientation);
        let contact = wrench.unwrap_or_default();
        let given = gravity * body.mass + applied.force;
        let force = contact.force + given;
        let torque = contact.torque + applied.torque;
        let energy = [before.kinetic_energy(body), {
            body.velocity = before.velocity * decay + force * (reach / body.mass);
            let turn = before.orientation.inverse_transform_vector(&torque);
            body.momentum = before.momentum * decay + turn * reach;
            body.orientation = before.orientation;
            body.kinetic_energy()
        }];
        let mean = (before.velocity + body.velocity) * 0.5;
        let turning = body.angular_velocity();
        let spin = (before.turning + turning) * 0.5;
        if self.parameters.medium.drag != 0.0 {
            let work = (force.dot(&mean) + torque.dot(&spin)) * dt;
            self.flows.medium_work += energy[1] - energy[0] - work;
        }
        // Free fall is exact with the mean velocity; contacts require the velocity at the end.
        let velocity = if wrench.is_some() {
            body.velocity
        } else {
            mean
        };
        self.flows.pending.get_or_insert_default().taken += given.dot(&(velocity - mean)) * dt;
        self.flows.load_work += applied.power(&velocity, &spin) * dt;
        body.position = before.position + velocity * dt;
        rotation::drift(&mut body.orientation, &mut body.momentum, &body.moments, dt);
        // Distance from the pose where the contacts were evaluated.
        let apart = (velocity - before.velocity).norm()
            + 1.5 * (turning - before.turning).norm() * body.radius;
        body.travelled += apart * dt;
        let moved = velocity.norm() * dt;
        if !moved.is_finite() || moved > LARGEST_MOVE * body.radius {
            return Err(self.blow_up(i));
        }
        self.motions[i] = self.bodies[i].motion();
        Ok(())
    }

    /// Work of driven bodies and walls.
    fn book_driven(&mut self, dt: f64) {
        let mut flows = Flows::default();
        let mut book = |wrench: &Wrench, motion: &Motion| {
            flows.work_in -= wrench.power(&motion.velocity, &motion.angular_velocity) * dt;
        };
        for &i in &self.awake {
            if self.bodies[i as usize].driven.is_some() {
                let load = &self.batch.loads()[i as usize];
                book(&load.total, &self.ahead[i as usize]);
            }
        }
        for (load, motion) in self.batch.wall_loads().iter().zip(&self.wall_motions) {
            book(&load.total, motion);
        }
        self.flows.work_in += flows.work_in;
    }
}

impl Before {
    fn kinetic_energy(&self, body: &Body) -> f64 {
        0.5 * (body.mass * self.velocity.norm_squared()
            + self
                .momentum
                .component_div(&body.moments)
                .dot(&self.momentum))
    }
}

/// Mass and inertia over the effective time of the forces.
fn inertia(before: &Before, body: &Body, reach: f64) -> Inertia {
    let axes = before.orientation.to_rotation_matrix().into_inner();
    let moments = Matrix3::from_diagonal(&(body.moments / reach));
    Inertia {
        mass: body.mass / reach,
        turning: axes * moments * axes.transpose(),
        inverse: axes
            * Matrix3::from_diagonal(&(body.moments / reach).map(|m| 1.0 / m))
            * axes.transpose(),
    }
}
