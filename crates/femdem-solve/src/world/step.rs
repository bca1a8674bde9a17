//! One step: kick, drift, contacts, kick.

use super::World;
use super::medium::{relaxation, resist};
use super::periodic::Streaming;
use super::time_step::{LARGEST_MOVE, USUAL_MOVE};
use crate::body::Body;
use crate::clock::Stopwatch;
use crate::error::{SolveError, check};
use crate::guide::Guide;
use crate::halo::{Alone, Halo};
use crate::ledger::Flows;
use crate::parameters::{Medium, WorldParameters};
use femdem_contact::{ContactError, Load, Partner, Wrench};
use femdem_fem::Driven;
use femdem_mesh::{Pose, Vector3};
use std::time::Duration;

/// Part of the smaller of G_I/f_t and G_II/c by which a bond should open or slide in a step at most: a tenth of what breaks it
/// where its softening is linear, and less for other kinds.
const OPENING: f64 = 0.2;

/// Prescribed motions, as other bodies may meet them.
pub(super) struct Driving {
    walls: Vec<Driven>,
    /// Largest speed of a driven body, m/s.
    bodies: f64,
    /// Step that resolves their oscillations, s.
    pub step: f64,
}

impl Driving {
    /// Whether any body or wall that others may meet is driven.
    pub fn is_any(&self) -> bool {
        self.bodies > 0.0 || !self.walls.is_empty()
    }

    /// Largest speed of driven walls within `radius` of a point, and of driven bodies, m/s.
    pub fn met(&self, x: &Vector3, radius: f64) -> f64 {
        let speeds = self.walls.iter().map(|wall| wall.fastest_near(x, radius));
        speeds.fold(self.bodies, f64::max)
    }
}

impl World {
    /// Advances the world by one step; the world chooses its size.
    ///
    /// # Errors
    /// [`SolveError::BlowUp`] names the body, the step and the likely cause. The world is
    /// then of no further use; an earlier checkpoint is.
    pub fn step(&mut self) -> Result<(), SolveError> {
        self.step_with(|_, _| None)
    }

    /// As [`step`](Self::step), with a host that moves walls and bodies
    /// ([`drive_wall_by_host`](Self::drive_wall_by_host), [`drive_body_by_host`](Self::drive_body_by_host)):
    /// `host(thing, time)` is where such a thing will be at a time (s), the end of the step, and how fast, or `None` if it
    /// stays where it is. The walls are asked for first, each kind in ascending order; twice if the step is chosen anew
    /// because bodies wake. A host that swings limits the steps to a part of its period by
    /// [`TimeStepParameters::largest`](crate::TimeStepParameters::largest).
    ///
    /// # Errors
    /// As [`step`](Self::step), and [`SolveError::Parameter`] for a motion that is not finite, or whose axis changes while
    /// it is turned.
    pub fn step_with(
        &mut self,
        mut host: impl FnMut(Partner, f64) -> Option<Driven>,
    ) -> Result<(), SolveError> {
        self.not_shared("a step of one rank")?;
        self.advance(&mut host, &mut Alone)
    }

    /// A step of this rank.
    pub(super) fn advance(
        &mut self,
        host: &mut impl FnMut(Partner, f64) -> Option<Driven>,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.restored()?;
        if let Some(rule) = self.parameters.time_step.implicit {
            return self.step_implicit(&rule, host, halo);
        }
        self.evaluate_on(halo)?;
        let mut dt = self.choose_step(halo)?;
        self.ask(self.time + dt, host)?;
        if self.wake_for_drives(dt, halo)? {
            dt = self.choose_step(halo)?;
            self.ask(self.time + dt, host)?;
        }
        self.check_step(dt)?;
        self.begin_step(dt, halo)?;
        self.meet_guests(halo)?;
        let awake = self.awake.len();
        self.touch(dt)?;
        self.tell_woken(awake, halo)?;
        self.end_step(dt, halo)?;
        self.end_bonds(halo)?;
        self.update_active_set(halo)?;
        self.crack_deformables(halo)?;
        self.retire_cracks();
        self.adapt_bodies()
    }

    /// The first half kick, the drift, and the forces inside bodies.
    fn begin_step(&mut self, dt: f64, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let stream = self.resisting_stream(halo)?;
        self.kick(0.5 * dt, stream);
        self.drift(dt, halo)?;
        self.time += dt;
        self.arrive();
        self.steps += 1;
        let stream = self.resisting_stream(halo)?;
        self.advance_deformables(dt, stream)
    }

    /// The second half kick.
    fn end_step(&mut self, dt: f64, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let stream = self.resisting_stream(halo)?;
        self.kick(0.5 * dt, stream);
        let deformable = self.kick_deformables(0.5 * dt, stream);
        self.book_exchange(deformable);
        self.counters.body_steps += self.awake.len() as u64;
        Ok(())
    }

    /// Books the energy that the step exchanged. Frozen bodies have none in motion; deformable ones have `deformable`, J.
    pub(super) fn book_exchange(&mut self, deformable: f64) {
        let free = self.awake_bodies().filter(|body| body.driven.is_none());
        let rigid: f64 = free.map(Body::kinetic_energy).sum();
        self.flows.exchange(rigid + deformable);
    }

    /// Refuses a step that nothing bounds.
    pub(super) fn check_step(&self, dt: f64) -> Result<(), SolveError> {
        check(
            "the time after the step",
            self.time + dt,
            (self.time + dt).is_finite(),
            "finite: nothing bounds the step; give time_step.largest",
        )
    }

    /// Also deals the bodies anew if one of them may leave what its rank knows of.
    fn choose_step(&mut self, halo: &mut dyn Halo) -> Result<f64, SolveError> {
        self.renew_cap(halo)?;
        let bound = self.awake.iter().fold(self.deformable_bound(), |most, &i| {
            self.batch.largest_step(i, &self.motions[i as usize], most)
        });
        let bound = self.bound_at_touch(bound);
        // The bound at touch is the same on all ranks, and the least of the others.
        let mut least = [bound, self.usual_step(halo)?, self.slack()];
        halo.least(&mut least)?;
        let [bound, usual, slack] = least;
        if slack <= 0.0 {
            self.deal_again(halo)?;
        }
        let rule = &self.parameters.time_step;
        Ok(self.step_control.choose(bound, usual, rule))
    }

    /// The bound, lowered to that of a face contact if a body that no contact resists, bonded or not, may touch something in the
    /// step. A face contact has its full stiffness from the first touch on; a step that shrinks only after
    /// the touch does not resolve the impact.
    fn bound_at_touch(&self, bound: f64) -> f64 {
        let touch = self.step_control.touch();
        if bound <= touch {
            return bound;
        }
        let dt = self.step_control.top(&self.parameters.time_step);
        let comes = |&i: &u32| {
            let batch = &self.batch;
            !batch.is_resisted(i) && batch.may_touch(i, &self.motions, &self.wall_motions, dt)
        };
        if self.awake.iter().any(comes) {
            touch
        } else {
            bound
        }
    }

    /// The step in which nothing moves far relative to what it may meet, s.
    fn usual_step(&self, halo: &mut dyn Halo) -> Result<f64, SolveError> {
        let mut driving = self.driving();
        driving.bodies = self.fastest_driven(driving.bodies, halo)?;
        // The root of speed t + pulled t^2/2 = way.
        let usual = |body: &Body, met: f64| {
            let (way, speed, pulled) = (
                USUAL_MOVE * body.radius,
                body.fastest() + met,
                body.pulled(),
            );
            if pulled > 0.0 {
                2.0 * way / (speed + (speed * speed + 2.0 * pulled * way).sqrt())
            } else {
                way / speed
            }
        };
        let free = || self.awake_bodies().filter(|body| body.driven.is_none());
        let alone = free().map(|body| usual(body, 0.0));
        let bonds = self.batch.step_of_bonds(&self.motions, OPENING)?;
        let mut least = alone.fold(driving.step.min(bonds), f64::min);
        let met = |x: &Vector3, radius: f64| driving.met(x, radius);
        // Usually nothing is driven, and one pass over the bodies is enough.
        if driving.is_any() {
            let steps = free().map(|body| usual(body, met(&body.position, body.radius)));
            least = steps.fold(least, f64::min);
        }
        let deformables = self.deformables.as_deref();
        Ok(deformables.map_or(least, |d| d.usual_step(&self.batch, met).min(least)))
    }

    /// The prescribed motions now.
    pub(super) fn driving(&self) -> Driving {
        let moving = |(guide, _): &&(Guide, Pose)| !guide.is_fixed();
        let walls = self.wall_drives.iter().filter(moving);
        let bodies = || self.awake_bodies().filter(|body| body.driven.is_some());
        let of_bodies = bodies().filter_map(|body| body.driven.as_deref());
        let guides = of_bodies.chain(&self.wall_drives).map(|(guide, _)| guide);
        // The next step may be larger than the last.
        let ahead = self
            .time_step()
            .max(self.step_control.top(&self.parameters.time_step));
        let steps = guides.map(|guide| guide.resolving_step(self.time, ahead));
        Driving {
            step: steps.fold(f64::INFINITY, f64::min),
            walls: walls.map(|(guide, _)| guide.now(self.time)).collect(),
            bodies: bodies().map(Body::fastest).fold(0.0, f64::max),
        }
    }

    fn awake_bodies(&self) -> impl Iterator<Item = &Body> {
        self.awake.iter().map(|&i| &self.bodies[i as usize])
    }

    /// Adds the impulse of half a step to all awake rigid bodies and books the work.
    fn kick(&mut self, h: f64, stream: Option<Streaming>) {
        let mut flows = Flows::default();
        self.book_edges(h, &mut flows);
        let loads = self.batch.loads();
        for &i in &self.awake {
            let (body, load) = (&mut self.bodies[i as usize], &loads[i as usize]);
            if body.driven.is_some() {
                let (v, w) = (body.velocity, body.angular_velocity());
                book_driven(load, &v, &w, h, &mut flows);
            } else {
                let streaming = stream.map(|s| s.at(&body.position)).unwrap_or_default();
                kick_body(body, load, &self.parameters, &streaming, h, &mut flows);
            }
        }
        let wall_loads = self.batch.wall_loads();
        for (load, (guide, base)) in wall_loads.iter().zip(&self.wall_drives) {
            if !guide.is_fixed() {
                let driven = guide.now(self.time);
                let v = driven.velocity_at(&driven.place(base).translation.vector);
                book_driven(load, &v, &driven.angular_velocity(), h, &mut flows);
            }
        }
        self.flows.work_in += flows.work_in;
        self.flows.damping_work += flows.damping_work;
        self.flows.friction_work += flows.friction_work;
        self.flows.medium_work += flows.medium_work;
        self.flows.load_work += flows.load_work;
    }

    /// All forces at the present positions. `dt` is the time since the last call.
    pub(super) fn evaluate(&mut self, dt: f64) -> Result<(), SolveError> {
        self.strain_deformables(dt)?;
        self.touch(dt)
    }

    /// Evaluates the loads at the present positions, if they are out of date: on all ranks or on none.
    pub(super) fn evaluate_on(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        if self.loaded {
            return Ok(());
        }
        self.meet_guests(halo)?;
        self.evaluate_if_due()?;
        self.tell_rest(halo)
    }

    /// Contacts at the present positions. `dt` is the time since the last call.
    pub(super) fn touch(&mut self, dt: f64) -> Result<(), SolveError> {
        // The contact stage gets the velocities of the half step.
        for &i in &self.awake {
            let body = &self.bodies[i as usize];
            let motion = &mut self.motions[i as usize];
            if body.driven.is_none() {
                motion.velocity = body.velocity;
                motion.angular_velocity = body.angular_velocity();
            }
        }
        // Without rigid bodies there is nothing to measure, and asking for the time takes longer than the update.
        let watch = (self.rigid_count() > 0).then(Stopwatch::start);
        let since = dt + std::mem::take(&mut self.behind);
        let result = self.batch.update(&self.motions, &self.wall_motions, since);
        self.count_contacts(watch, result)?;
        self.touch_deformables(dt)?;
        self.book_soft_newcomers();
        Ok(())
    }

    /// Updates the work counters after an update of the contacts, and names the body if it has failed.
    pub(super) fn count_contacts(
        &mut self,
        watch: Option<Stopwatch>,
        result: Result<(), ContactError>,
    ) -> Result<(), SolveError> {
        self.counters.contact_time += watch.map_or(Duration::ZERO, |watch| watch.elapsed());
        let totals = self.batch.totals();
        self.counters.pair_evaluations += totals.candidates as u64;
        self.counters.touching_evaluations += totals.touching as u64;
        let change = totals.energy_change;
        self.flows.broken += totals.broken;
        self.book_bonds();
        let brought = self.book_newcomers();
        self.flows.settle(change - brought);
        match result {
            Err(
                ContactError::NotFinite { body, .. } | ContactError::LoadNotFinite { body, .. },
            ) => Err(self.blow_up(body)),
            other => Ok(other?),
        }
    }

    pub(super) fn blow_up(&self, i: usize) -> SolveError {
        let body = &self.bodies[i];
        let contacts = self.batch.rigid_contacts_of(i as u32);
        let depths = contacts.map(|c| (c.penetration(), self.batch.law_of(c.a, c.b)));
        let (deepest, law) = depths.fold(
            (0.0, None),
            |most, next| if next.0 > most.0 { next } else { most },
        );
        let penalty = law.map_or(self.parameters.contact.penalty, |law| law.penalty);
        let ratio = self.step_control.current() / self.step_control.bound();
        let cause = if deepest > 0.1 * body.radius {
            format!(
                "a contact is {deepest:.3e} m deep, {:.0} % of the body's radius; bodies \
                 overlapped when they were added, or the penalty {:.3e} Pa is too small \
                 for the load: separate them or raise the penalty",
                100.0 * deepest / body.radius,
                penalty
            )
        } else {
            format!(
                "the step {:.3e} s is {ratio:.2} of the stability bound and moves the body by \
                 more than a quarter of its radius; lower time_step.safety, or, for a body that \
                 was launched or fell to this speed, set time_step.largest below {:.1e} s",
                self.step_control.current(),
                LARGEST_MOVE * body.radius / body.fastest()
            )
        };
        SolveError::BlowUp {
            body: self.number_in_whole(i as u32).map_or(i, |n| n as usize),
            step: self.steps,
            time: self.time,
            position: body.position.into(),
            speed: body.velocity.norm(),
            cause,
        }
    }
}

/// Work exchanged with something that moves as prescribed: the drive supplies the work of its contacts.
fn book_driven(load: &Load, velocity: &Vector3, turn: &Vector3, h: f64, flows: &mut Flows) {
    let power = |w: &Wrench| w.power(velocity, turn) * h;
    flows.work_in -= power(&load.total);
    flows.damping_work += power(&load.damping);
    flows.friction_work += power(&load.friction);
}

/// Half a kick of one body in a medium that moves with the velocity `streaming`. Works are the wrenches times the mean of the
/// velocities before and after, which is exactly the change of kinetic energy.
fn kick_body(
    body: &mut Body,
    load: &Load,
    parameters: &WorldParameters,
    streaming: &Vector3,
    h: f64,
    flows: &mut Flows,
) {
    let (v0, w0) = (body.velocity, body.angular_velocity());
    let applied = body.applied();
    let force = load.total.force + parameters.gravity * body.mass + applied.force;
    let torque = load.total.torque + applied.torque;
    let medium = &parameters.medium;
    let before = body.kinetic_energy();
    let in_body = |x: &Vector3| body.orientation.inverse_transform_vector(x);
    if *medium == Medium::default() {
        let turn = in_body(&torque);
        body.velocity += force * (h / body.mass);
        body.momentum += turn * h;
    } else {
        let through = v0 - streaming;
        let resisted = resist(&force, &through, medium.local_damping);
        let turn = in_body(&resist(&torque, &w0, medium.local_damping));
        let (decay, reach) = relaxation(medium.drag, h);
        body.velocity = streaming + through * decay + resisted * (reach / body.mass);
        body.momentum = body.momentum * decay + turn * reach;
    }
    let v = (v0 + body.velocity) * 0.5;
    let w = (w0 + body.angular_velocity()) * 0.5;
    flows.damping_work += load.damping.power(&v, &w) * h;
    flows.friction_work += load.friction.power(&v, &w) * h;
    flows.load_work += applied.power(&v, &w) * h;
    if *medium != Medium::default() {
        let work = (force.dot(&v) + torque.dot(&w)) * h;
        flows.medium_work += body.kinetic_energy() - before - work;
    }
}
