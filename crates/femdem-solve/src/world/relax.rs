//! Bringing a world to rest: dynamic relaxation with kinetic damping, first of the bodies as wholes, then of
//! their elements.
//!
//! For bodies much stiffer than their contacts there are two time scales: an element oscillates thousands of
//! times while the body oscillates once on its contacts. So bodies are first moved as wholes, with a step
//! that the contacts allow, and then with all their nodes, which by then hardly changes the contacts.

mod residual;

use super::World;
use super::deformables::{Deformables, State, centroid, foundation, inertia};
use super::periodic::check_rests;
use crate::error::{SolveError, check};
use femdem_contact::{ContactBatch, stable_step};
use femdem_mesh::{Matrix3, Rotation, Vector3};
use serde::{Deserialize, Serialize};

/// Kinetic damping is stable up to half the critical step (physics of a leapfrog that is stopped and
/// restarted at peaks of its energy).
const SAFETY: f64 = 0.5;

/// Bodies as wholes are relaxed to this fraction of the tolerance, which leaves the rest to their elements.
const MARGIN: f64 = 0.3;

/// Most that a point of a body moved as a whole moves in a step, over the depth of the body's contact field.
const NEAR: f64 = 0.02;

/// The residual is computed every so many steps.
const LOOK: u64 = 20;

/// After this many residuals of the element phase, bodies are moved as wholes again if their net forces are
/// what remains.
const ROUNDS: u64 = 10;

/// Options for bringing a world to rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldRelaxation {
    /// Largest residual force on a node or on a body as a whole, over the mean contact force. If nothing
    /// touches, the reference force is, for each body, the larger of sum |gravity and loads| and sum
    /// |reactions|; the smallest positive one over the bodies is used, or 1 N if all are zero. A body that touches
    /// nothing is measured by what gravity and loads do to it, so that a light one does not hang in the air beside
    /// large forces.
    pub tolerance: f64,
    /// Largest number of steps, of bodies as wholes and of elements together.
    pub steps: u64,
}

impl Default for WorldRelaxation {
    fn default() -> Self {
        Self {
            tolerance: 1e-4,
            steps: 200_000,
        }
    }
}

/// Report of bringing a world to rest.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WorldRelaxed {
    /// Largest residual force on a node or a body, over the reference force of
    /// [`WorldRelaxation::tolerance`].
    pub residual: f64,
    /// The same for bodies as wholes only.
    pub body_residual: f64,
    /// Mean normal force of the contacts, or the reference force in its place, N.
    pub mean_contact_force: f64,
    /// Steps of bodies as wholes, and of elements.
    pub steps: [u64; 2],
    /// How often all motion was stopped.
    pub stops: u64,
}

/// A body moved as a whole.
#[derive(Debug, Clone, Copy, Default)]
struct Whole {
    mass: f64,
    inverse_inertia: Matrix3,
    /// Largest inverse moment of inertia, 1/(kg m^2).
    easiest: f64,
    velocity: Vector3,
    turning: Vector3,
    /// Stiffness of a contact of half of its skin, N/m.
    stiffest: f64,
}

impl Whole {
    /// Squared frequency, 1/s^2, that a spring k (N/m) at the squared distance `arm2` (m^2) from the centre adds at most:
    /// it resists translation and rotation. Twice for the motion of the other side.
    fn square(&self, k: f64, arm2: f64) -> f64 {
        2.0 * k * (1.0 / self.mass + arm2 * self.easiest)
    }

    /// The time in which no point within `arm` (m) of the centre moves farther than `way` (m) under a force and a torque, s.
    fn time_for(&self, way: f64, [force, torque]: &[Vector3; 2], arm: f64) -> f64 {
        let speed = self.velocity.norm() + self.turning.norm() * arm;
        let turning = (self.inverse_inertia * torque).norm();
        let acceleration = force.norm() / self.mass + turning * arm;
        // The root of speed t + acceleration t^2 = way.
        let half = 0.5 * speed;
        way / (half + (half * half + acceleration * way).sqrt())
    }
}

impl World {
    /// Brings the world to rest under its walls, its gravity and what is prescribed. Friction acts as in
    /// motion: springs that slide at their limit. Frozen bodies wake. Time advances. The ledger books the
    /// removed kinetic energy as frozen, and with it all losses while bodies are moved as wholes, including
    /// friction. Bodies that supports hold and that touch nothing are found much faster by
    /// [`solve_single_bodies`](Self::solve_single_bodies), to be called before.
    ///
    /// # Errors
    /// [`SolveError::NotConverged`] if the steps do not suffice, and the errors of
    /// [`World::step`].
    pub fn relax(&mut self, options: &WorldRelaxation) -> Result<WorldRelaxed, SolveError> {
        check(
            "tolerance",
            options.tolerance,
            options.tolerance > 0.0,
            "positive and finite",
        )?;
        self.not_shared("a relaxation")?;
        self.refuse_bonds("bonds in a relaxation")?;
        self.refuse_adaptive(None, "steps of time", "a relaxation")?;
        self.cell().map_or(Ok(()), check_rests)?;
        let kept = self.parameters;
        let mut elastic = kept;
        elastic.time_step.implicit = None;
        elastic.time_step.safety = kept.time_step.safety.min(SAFETY);
        let laws = self.batch.laws().clone();
        let undamped = laws.clone().without_dashpots();
        elastic.contact = *undamped.usual();
        elastic.sleeping.enabled = false;
        self.wake_all();
        self.replace_laws(elastic, &undamped)?;
        self.halt();
        let result = self.relax_in_turns(options);
        self.halt();
        self.replace_laws(kept, &laws)?;
        result
    }

    fn relax_in_turns(&mut self, options: &WorldRelaxation) -> Result<WorldRelaxed, SolveError> {
        let mut report = WorldRelaxed::default();
        self.evaluate_if_due()?;
        loop {
            self.relax_wholes(options, &mut report)?;
            self.relax_elements(options, &mut report)?;
            self.measure(&mut report);
            if report.residual <= options.tolerance {
                return Ok(report);
            }
            if report.steps.iter().sum::<u64>() >= options.steps {
                return Err(SolveError::NotConverged {
                    method: "relaxation of the world",
                    iterations: options.steps as usize,
                    residual: report.residual,
                    tolerance: options.tolerance,
                    advice: "allow more steps, or loosen the tolerance".to_owned(),
                });
            }
        }
    }
}

impl World {
    /// Moves the deformable bodies as wholes until their net forces are small; rigid ones stay.
    fn relax_wholes(
        &mut self,
        options: &WorldRelaxation,
        report: &mut WorldRelaxed,
    ) -> Result<(), SolveError> {
        let Some(d) = self.deformables.as_deref() else {
            return Ok(());
        };
        let held: Vec<bool> = (0..d.bodies.len()).map(|i| self.is_held(i)).collect();
        let whole = |i: usize| match d.bodies[i].is_vacant() {
            true => Whole::default(),
            false => d.whole(i, &self.batch),
        };
        let mut wholes: Vec<Whole> = (0..d.bodies.len()).map(whole).collect();
        if held.iter().all(|&h| h) {
            return Ok(());
        }
        let books = self.ledger().error();
        let mut before = 0.0;
        for step in 0.. {
            if step % LOOK == 0 {
                let residual = self.measure(report);
                let spent = report.steps.iter().sum::<u64>() >= options.steps;
                if residual <= MARGIN * options.tolerance || spent {
                    break;
                }
            }
            let energy = self.move_wholes(&mut wholes, &held)?;
            report.steps[0] += 1;
            if energy < before {
                for whole in &mut wholes {
                    whole.velocity = Vector3::zeros();
                    whole.turning = Vector3::zeros();
                }
                report.stops += 1;
                before = 0.0;
            } else {
                before = energy;
            }
        }
        self.halt();
        self.evaluate(0.0)?;
        // The removed kinetic energy, and the work of friction and loads meanwhile.
        self.flows.frozen += books - self.ledger().error();
        Ok(())
    }

    /// One step of the bodies as wholes; returns their kinetic energy, J.
    fn move_wholes(&mut self, wholes: &mut [Whole], held: &[bool]) -> Result<f64, SolveError> {
        let gravity = self.parameters.gravity;
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(0.0);
        };
        let free = |i: &usize| !held[*i];
        let wrench = |i: usize| match held[i] {
            true => [Vector3::zeros(); 2],
            false => deformables.net_wrench(i, &self.batch, &gravity),
        };
        let wrenches: Vec<[Vector3; 2]> = (0..wholes.len()).map(wrench).collect();
        // A body that comes to touch has another stiffness in every step.
        let near = self.batch.have_neighbours();
        let dt = (0..wholes.len())
            .filter(free)
            .map(|i| {
                let step = deformables.whole_step(i, &self.batch, &wholes[i], &wrenches[i]);
                if near[i] {
                    let pull = deformables.bodies[i].pull;
                    let given = wholes[i].mass * (gravity + pull).norm();
                    let touching =
                        deformables.touching_step(i, &self.batch, &wholes[i], &wrenches[i], given);
                    step.min(touching)
                } else {
                    step
                }
            })
            .fold(f64::INFINITY, f64::min);
        if !dt.is_finite() {
            // Nothing touches, moves or weighs anything.
            return Ok(0.0);
        }
        let mut energy = 0.0;
        for i in (0..wholes.len()).filter(free) {
            let (whole, [force, torque]) = (&mut wholes[i], wrenches[i]);
            whole.velocity += force * (dt / whole.mass);
            whole.turning += whole.inverse_inertia * torque * dt;
            let load = deformables.bodies[i].pull * whole.mass;
            self.flows.load_work += load.dot(&whole.velocity) * dt;
            energy += deformables.carry(i, whole, dt);
        }
        self.meet_deformables(0.0)?;
        Ok(energy)
    }

    /// Steps of all nodes, with each body stopped at the peaks of its kinetic energy.
    fn relax_elements(
        &mut self,
        options: &WorldRelaxation,
        report: &mut WorldRelaxed,
    ) -> Result<(), SolveError> {
        let mut rigid = 0.0;
        for round in 1.. {
            for _ in 0..LOOK {
                self.step()?;
                report.steps[1] += 1;
                report.stops += self.stop_deformables_at_peaks();
                let bodies = self.free_bodies();
                let energy = bodies.map(|(_, body)| body.kinetic_energy()).sum();
                if energy < std::mem::replace(&mut rigid, energy) {
                    self.stop_rigid();
                    rigid = 0.0;
                    report.stops += 1;
                }
            }
            let of_wholes = self.measure(report);
            let spent = report.steps.iter().sum::<u64>() >= options.steps;
            let drifts = of_wholes > options.tolerance && round > ROUNDS;
            if report.residual <= options.tolerance || spent || drifts {
                break;
            }
        }
        Ok(())
    }

    /// Stops all free bodies and nodes.
    fn halt(&mut self) {
        self.stop_deformables();
        self.stop_rigid();
    }

    /// Whether anything of a deformable body is prescribed, or the body was removed.
    fn is_held(&self, i: usize) -> bool {
        let body = self.deformables.as_deref().and_then(|d| d.bodies.get(i));
        body.is_some_and(|b| b.is_vacant() || b.boundary.held().next().is_some())
    }
}

impl Deformables {
    fn masses(&self, body: &State) -> &[f64] {
        self.models[body.model as usize].model.masses()
    }

    fn centre(&self, body: &State) -> Vector3 {
        centroid(&body.positions, self.masses(body))
    }

    /// The mass and inertia of a body as a whole, at rest.
    fn whole(&self, i: usize, batch: &ContactBatch) -> Whole {
        let body = &self.bodies[i];
        let model = &self.models[body.model as usize];
        let shape = &batch.deformable_shapes()[body.model as usize];
        let (masses, centre) = (self.masses(body), self.centre(body));
        let inertia = inertia(&body.positions, masses, &centre);
        let modulus = batch.modulus(i as u32);
        let foundation = modulus.map_or(0.0, |modulus| foundation(shape, modulus));
        let inverse_inertia = inertia.try_inverse().unwrap_or_else(Matrix3::zeros);
        Whole {
            mass: masses.iter().sum(),
            inverse_inertia,
            easiest: inverse_inertia.symmetric_eigenvalues().max(),
            velocity: Vector3::zeros(),
            turning: Vector3::zeros(),
            stiffest: 2.0 * foundation * model.skin_area(shape),
        }
    }

    /// Force and torque about the centre of mass of contacts, loads and gravity on a body.
    fn net_wrench(&self, i: usize, batch: &ContactBatch, gravity: &Vector3) -> [Vector3; 2] {
        let body = &self.bodies[i];
        let (masses, centre) = (self.masses(body), self.centre(body));
        let contact = body.contact_loads(batch, i as u32).forces;
        let mut wrench = [Vector3::zeros(); 2];
        for (a, x) in body.positions.iter().enumerate() {
            let force = contact[a] + body.loads[a] + (gravity + body.pull) * masses[a];
            wrench[0] += force;
            wrench[1] += (x - centre).cross(&force);
        }
        wrench
    }

    /// The step of a body moved as a whole under a force and a torque, s: stable for its contacts, and so short that no
    /// point moves by more than [`NEAR`] of the depth of its contact field.
    fn whole_step(
        &self,
        i: usize,
        batch: &ContactBatch,
        whole: &Whole,
        wrench: &[Vector3; 2],
    ) -> f64 {
        let body = &self.bodies[i];
        let centre = self.centre(body);
        let springs = body
            .contact_loads(batch, i as u32)
            .stiffness
            .iter()
            .zip(&body.positions);
        let squares = springs.map(|(k, x)| whole.square(*k, (x - centre).norm_squared()));
        let stable = SAFETY * stable_step(squares.sum(), 0.0);
        let shape = &batch.deformable_shapes()[body.model as usize];
        let way = NEAR * shape.inradius();
        stable.min(whole.time_for(way, wrench, shape.radius()))
    }

    /// The step in which a body may come to touch something, s. It must not get deeper in it than its speed accounts for,
    /// or it is thrown back. So the step is stable for a contact of half of the skin, unless the body moves less in it
    /// than such a contact gives way under what now acts on the body: its contacts, and what is `given` (N).
    fn touching_step(
        &self,
        i: usize,
        batch: &ContactBatch,
        whole: &Whole,
        wrench: &[Vector3; 2],
        given: f64,
    ) -> f64 {
        let arm = batch.deformable_shapes()[self.bodies[i].model as usize].radius();
        let stable = SAFETY * stable_step(whole.square(whole.stiffest, arm * arm), 0.0);
        let forces = self.bodies[i].contact_loads(batch, i as u32).forces;
        let contacts: f64 = forces.iter().map(Vector3::norm).sum();
        let yielding = (contacts + given) / whole.stiffest;
        stable.max(whole.time_for(yielding, wrench, arm))
    }

    /// Moves the nodes of a body with it as a whole; returns its kinetic energy, J.
    fn carry(&mut self, i: usize, whole: &Whole, dt: f64) -> f64 {
        let centre = self.centre(&self.bodies[i]);
        let Self { models, bodies, .. } = self;
        let body = &mut bodies[i];
        let masses = models[body.model as usize].model.masses();
        let turn = Rotation::from_scaled_axis(whole.turning * dt);
        let to = centre + whole.velocity * dt;
        let nodes = body.positions.iter_mut().zip(&mut body.velocities);
        for (x, v) in nodes {
            let arm = turn * (*x - centre);
            *x = to + arm;
            *v = whole.velocity + whole.turning.cross(&arm);
        }
        body.kinetic_energy(masses)
    }
}
