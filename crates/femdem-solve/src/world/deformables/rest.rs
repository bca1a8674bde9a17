//! The active set of deformable bodies: which are frozen, and when they wake.
//!
//! Whether a body rests as a whole is judged by the [rule](crate::rest) for all bodies. Its remaining oscillations are then removed
//! by kinetic damping: it is stopped whenever its kinetic energy begins to fall, which for a single mode of vibration is at
//! equilibrium. If the residual forces on its nodes are small then, it stays frozen: only its contacts with awake bodies are
//! computed. It wakes when these leave a residual of twice the tolerance. Smaller changes are not transferred.
//!
//! All decisions are functions of the state, so they are the same in every run.

use super::each::on_each_with;
use super::{Deformables, Scratch, State, centroid, inertia};
use crate::error::SolveError;
use crate::parameters::{SleepMeasure, WorldParameters};
use crate::rest::{RestRecord, Whole};
use crate::world::World;
use femdem_contact::ContactBatch;
use femdem_fem::{Boundary, DeformableModel};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// A frozen body wakes when its imbalance exceeds the tolerance by this factor.
const WAKE: f64 = 2.0;

/// State of a body's rest.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Rest {
    /// Whether it is frozen.
    pub asleep: bool,
    /// Whether it rests as a whole.
    whole: RestRecord,
    /// Kinetic energy at the end of the last step, J.
    energy: f64,
    /// When it moved no more, s, and where its nodes were then, m.
    since: f64,
    places: Vec<Vector3>,
}

/// Change of a body at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Change {
    None,
    /// Stopped, still awake; kinetic energy lost, J.
    Stopped(f64),
    /// Stopped and frozen; kinetic energy lost, J.
    Asleep(f64),
    Awake,
}

impl World {
    /// Whether deformable bodies may be frozen.
    fn may_rest_deformables(&self) -> bool {
        let rule = &self.parameters.sleeping;
        rule.enabled && rule.deformables && self.deformables.is_some()
    }

    /// Freezes and wakes deformable bodies. Whether any may have been.
    pub(in crate::world) fn rest_deformables(&mut self) -> Result<bool, SolveError> {
        if !self.may_rest_deformables() {
            return Ok(false);
        }
        let driven = self.is_driven(0.0);
        let (time, steps, parameters) = (self.time, self.steps, &self.parameters);
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(false);
        };
        let Deformables { models, bodies, .. } = &mut *deformables;
        let batch = &self.batch;
        let share = self.share.as_deref();
        let named = |i: usize| share.map_or(i, |share| share.named(i));
        let changes = on_each_with(bodies, Scratch::default, |scratch, i, body| {
            if batch.is_guest(i as u32) {
                return Ok(Change::None);
            }
            let judge = Judge {
                parameters,
                batch,
                body: i as u32,
                model: &models[body.model as usize].model,
                time,
                driven,
            };
            judge.judge(body, scratch)
        });
        for (i, change) in changes.into_iter().enumerate() {
            match change.map_err(|error| error.in_body(named(i), steps, time))? {
                Change::None => {}
                Change::Stopped(energy) => self.flows.frozen += energy,
                Change::Asleep(energy) => {
                    self.flows.frozen += energy;
                    self.batch.set_awake(i as u32, false);
                    // The bound included this body.
                    deformables.bound = None;
                }
                Change::Awake => deformables.wake(i, &mut self.batch),
            }
        }
        Ok(true)
    }

    /// Stops the deformable bodies that pass their equilibrium, but for what moves as prescribed, and returns their number.
    pub(in crate::world) fn stop_deformables_at_peaks(&mut self) -> u64 {
        self.stop_deformables_that(Rest::has_passed)
    }

    /// Stops all deformable bodies, but for what moves as prescribed.
    pub(in crate::world) fn stop_deformables(&mut self) {
        self.stop_deformables_that(|_, _| true);
    }

    /// Stops those for which a function of their kinetic energy, J, holds.
    fn stop_deformables_that(&mut self, holds: impl Fn(&mut Rest, f64) -> bool) -> u64 {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return 0;
        };
        let Deformables { models, bodies, .. } = deformables;
        let mut stops = 0;
        for body in bodies {
            let energy = body.kinetic_energy(models[body.model as usize].model.masses());
            if holds(&mut body.rest, energy) {
                self.flows.frozen += energy - body.held_energy;
                body.stop_free_nodes();
                body.rest.energy = 0.0;
                stops += 1;
            }
        }
        stops
    }

    /// Number of deformable bodies that are not frozen.
    #[must_use]
    pub fn awake_deformable_count(&self) -> usize {
        let own = self.own_nodes();
        own.filter(|(_, body, _)| !body.rest.asleep).count()
    }
}

impl Rest {
    /// That of a number without a body, which is left out as those asleep are.
    pub(super) fn of_none() -> Self {
        Self {
            asleep: true,
            ..Self::default()
        }
    }

    /// Whether the body passes its equilibrium: its kinetic energy, J, has fallen since it was last asked for.
    fn has_passed(&mut self, energy: f64) -> bool {
        energy < std::mem::replace(&mut self.energy, energy)
    }
}

impl Deformables {
    /// Wakes a body.
    pub(in crate::world) fn wake(&mut self, i: usize, batch: &mut ContactBatch) {
        if let Some(body) = self.bodies.get_mut(i).filter(|body| !body.is_vacant()) {
            body.rest = Rest::default();
            batch.set_awake(i as u32, true);
            // The bound did not include this body.
            self.bound = None;
        }
    }

    /// Wakes all bodies; awake ones are judged anew.
    pub(in crate::world) fn wake_all(&mut self, batch: &mut ContactBatch) {
        for i in 0..self.bodies.len() {
            self.wake(i, batch);
        }
    }

    pub(in crate::world) fn boundaries(&self) -> impl Iterator<Item = &Boundary> {
        self.bodies.iter().map(|body| &body.boundary)
    }
}

/// Data by which a body is judged.
struct Judge<'a> {
    parameters: &'a WorldParameters,
    batch: &'a ContactBatch,
    body: u32,
    model: &'a DeformableModel,
    /// s.
    time: f64,
    /// Whether anything moves as prescribed: a body that is carried slowly does not rest.
    driven: bool,
}

impl Judge<'_> {
    fn judge(&self, state: &mut State, scratch: &mut Scratch) -> Result<Change, SolveError> {
        let mut rest = std::mem::take(&mut state.rest);
        let change = if rest.asleep {
            Ok(self.watch(state))
        } else {
            self.settle(&mut rest, state, scratch)
        };
        state.rest = rest;
        change
    }

    /// Whether a frozen body wakes. Dashpot forces are excluded: oscillating neighbours push and pull
    /// alternately by them.
    fn watch(&self, state: &State) -> Change {
        let limit = WAKE * self.parameters.sleeping.tolerance;
        let is_stirred = !state.is_vacant() && self.batch.is_stirred(self.body);
        if is_stirred && self.imbalance(state, &self.whole(state, 0.0)) > limit {
            Change::Awake
        } else {
            Change::None
        }
    }

    /// The body as the rule of rest sees it. Its angular velocity is that of a rigid body of its shape and angular momentum.
    fn whole(&self, state: &State, kinetic_energy: f64) -> Whole {
        let masses = self.model.masses();
        let (mass, centre) = (masses.iter().sum(), centroid(&state.positions, masses));
        let loads = state.contact_loads(self.batch, self.body);
        let contacts = loads.forces.iter().zip(loads.damping);
        let gravity = self.parameters.gravity + state.pull;
        let (mut force, mut moment, mut borne) = (gravity * mass, Vector3::zeros(), 0.0);
        for ((all, damping), x) in contacts.zip(&state.positions) {
            let contact = all - damping;
            force += contact;
            moment += (x - centre).cross(&contact);
            borne += all.norm();
        }
        let inertia = inertia(&state.positions, masses, &centre);
        let turning = state.angular_momentum(masses, &centre);
        let inverse = inertia.try_inverse().unwrap_or_else(Matrix3::zeros);
        Whole {
            mass,
            moment_of_inertia: inertia.symmetric_eigenvalues().max(),
            diameter: 2.0 * self.batch.deformable_shapes()[state.model as usize].radius(),
            weight: mass * self.parameters.gravity.norm(),
            measure: SleepMeasure::Load,
            contacts: u32::from(self.batch.touches(self.body)),
            borne,
            force,
            moment,
            velocity: state.momentum(masses) / mass,
            angular_velocity: inverse * turning,
            kinetic_energy,
        }
    }

    /// Judges an awake body, and stops it where it passes its equilibrium if it rests as a whole.
    fn settle(
        &self,
        rest: &mut Rest,
        state: &mut State,
        scratch: &mut Scratch,
    ) -> Result<Change, SolveError> {
        let rule = &self.parameters.sleeping;
        let energy = state.kinetic_energy(self.model.masses());
        let has_passed = rest.has_passed(energy);
        let whole = self.whole(state, energy);
        let may_rest = !self.driven && state.boundary.is_free();
        rest.whole.count(&whole, rule, may_rest);
        if rest.whole.is_first_calm() {
            rest.since = self.time;
            rest.places.clone_from(&state.positions);
        }
        if !rest.whole.has_rested(rule) || !has_passed {
            return Ok(Change::None);
        }
        if self.creeps(rest, state, &whole) {
            rest.whole = RestRecord::default();
            return Ok(Change::None);
        }
        state.stop();
        state.strain(self.model, scratch, self.time, false)?;
        rest.energy = 0.0;
        if self.imbalance(state, &whole) < rule.tolerance {
            rest.asleep = true;
            state.internal.viscous_power = 0.0;
            state.internal.plastic_work = 0.0;
            return Ok(Change::Asleep(energy));
        }
        Ok(Change::Stopped(energy))
    }

    /// Whether its nodes have moved on: Σ ½ m |Δx|²/t² since they moved no more.
    fn creeps(&self, rest: &Rest, state: &State, whole: &Whole) -> bool {
        let time = self.time - rest.since;
        let nodes = state.positions.iter().zip(&rest.places);
        let energy: f64 = nodes
            .zip(self.model.masses())
            .map(|((x, y), m)| 0.5 * m * (x - y).norm_squared() / (time * time))
            .sum();
        energy >= self.parameters.sleeping.creep() * whole.scale() * whole.diameter
    }

    /// Imbalance of a body at rest, the largest of: the sum of |residual| over its nodes over the sum of
    /// |external force|; the net force over the load scale; its moment over the load scale times the diameter.
    fn imbalance(&self, state: &State, whole: &Whole) -> f64 {
        let (gravity, masses) = (self.parameters.gravity + state.pull, self.model.masses());
        let loads = state.contact_loads(self.batch, self.body);
        let contacts = loads.forces.iter().zip(loads.damping);
        let nodes = state.strain_forces.iter().zip(masses);
        let (mut left, mut borne) = (0.0, 0.0);
        for ((all, damping), (strain, m)) in contacts.zip(nodes) {
            let outer = all - damping + gravity * *m;
            left += (outer + strain).norm();
            borne += outer.norm();
        }
        let net = whole.force.norm().max(whole.moment.norm() / whole.diameter);
        f64::max(left / borne, net / whole.scale())
    }
}

impl State {
    /// Stops the nodes that are not prescribed.
    fn stop_free_nodes(&mut self) {
        let held: Vec<(u32, usize)> = self.boundary.held().collect();
        let kept: Vec<f64> = held
            .iter()
            .map(|&(a, i)| self.velocities[a as usize][i])
            .collect();
        self.velocities.fill(Vector3::zeros());
        for (&(a, i), v) in held.iter().zip(kept) {
            self.velocities[a as usize][i] = v;
        }
    }
}
