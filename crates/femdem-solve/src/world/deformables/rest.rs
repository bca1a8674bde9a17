//! The active set of deformable bodies: which are frozen, and when they wake.
//!
//! A body rests when over a spell its nodes have hardly moved, their kinetic energy stayed small, and the
//! means of net force and moment, taken from the changes of its momentum and angular momentum, were small.
//! Its remaining oscillations are then removed by kinetic damping: it is stopped whenever its kinetic energy
//! begins to fall, which for a single mode of vibration is at equilibrium. If the residual forces on its
//! nodes are small then, it stays frozen: only its contacts with awake bodies are computed. It wakes when
//! these leave a residual of twice the tolerance. Smaller changes are not transferred.
//!
//! All decisions are functions of the state, so they are the same in every run.

use super::each::on_each_with;
use super::{Deformables, Scratch, State, centroid};
use crate::error::SolveError;
use crate::halo::Halo;
use crate::parameters::WorldParameters;
use crate::world::World;
use femdem_contact::ContactBatch;
use femdem_fem::{Boundary, DeformableModel};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A frozen body wakes when its imbalance exceeds the tolerance by this factor.
const WAKE: f64 = 2.0;

/// State of a body's rest.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Rest {
    /// Whether it is frozen.
    pub asleep: bool,
    /// Steps of the present spell.
    steps: u32,
    /// Kinetic energy at the end of the last step, J.
    energy: f64,
    /// State of the body at the beginning of the present spell.
    start: Start,
}

/// A body at the beginning of a spell.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Start {
    /// s.
    time: f64,
    /// m; empty before the first spell.
    positions: Vec<Vector3>,
    centre: Vector3,
    /// kg m/s.
    momentum: Vector3,
    /// About the centre, kg m^2/s.
    angular_momentum: Vector3,
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
    pub(in crate::world) fn may_rest_deformables(&self) -> bool {
        let rule = &self.parameters.sleeping;
        rule.enabled && rule.deformables && self.deformables.is_some()
    }

    /// Freezes and wakes deformable bodies; called after every step. Over ranks it tells the others which bodies are awake.
    pub(in crate::world) fn rest_deformables(
        &mut self,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        if !self.may_rest_deformables() {
            return Ok(());
        }
        let driven = self.is_driven(0.0);
        let (time, steps, parameters) = (self.time, self.steps, &self.parameters);
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
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
        self.tell_rest(halo)
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

    /// Wakes all bodies; awake ones start a new spell.
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
        if is_stirred && self.imbalance(state) > limit {
            Change::Awake
        } else {
            Change::None
        }
    }

    /// The larger of the weight and half the sum of the contact forces, N.
    fn load_scale(&self, state: &State) -> f64 {
        let loads = state.contact_loads(self.batch, self.body);
        let borne: f64 = loads.forces.iter().map(Vector3::norm).sum();
        let mass: f64 = self.model.masses().iter().sum();
        f64::max(0.5 * borne, mass * self.parameters.gravity.norm())
    }

    /// m.
    fn diameter(&self, state: &State) -> f64 {
        2.0 * self.batch.deformable_shapes()[state.model as usize].radius()
    }

    /// Updates the spell of an awake body, and stops the body if it rests.
    fn settle(
        &self,
        rest: &mut Rest,
        state: &mut State,
        scratch: &mut Scratch,
    ) -> Result<Change, SolveError> {
        let rule = &self.parameters.sleeping;
        let spell = rule.window.saturating_add(rule.steps());
        let energy = state.kinetic_energy(self.model.masses());
        let before = std::mem::replace(&mut rest.energy, energy);
        let may_rest = !self.driven && self.batch.touches(self.body) && state.boundary.is_free();
        let scale = self.load_scale(state) * self.diameter(state);
        if !may_rest || energy.is_nan() || energy >= rule.ringing() * scale {
            rest.steps = 0;
            return Ok(Change::None);
        }
        rest.steps = rest.steps.saturating_add(1);
        let is_new = rest.steps == 1 || rest.steps > spell.saturating_mul(2);
        if is_new || (rest.steps == spell && !self.has_rested(&rest.start, state, scale)) {
            rest.steps = 1;
            rest.start = self.start(state);
            return Ok(Change::None);
        }
        if rest.steps < spell || energy >= before {
            return Ok(Change::None);
        }
        state.velocities.fill(Vector3::zeros());
        state.fastest = 0.0;
        state.strain(self.model, scratch, self.time, false)?;
        rest.energy = 0.0;
        if self.imbalance(state) < rule.tolerance {
            rest.asleep = true;
            state.internal.viscous_power = 0.0;
            state.internal.plastic_work = 0.0;
            return Ok(Change::Asleep(energy));
        }
        Ok(Change::Stopped(energy))
    }

    fn start(&self, state: &State) -> Start {
        let masses = self.model.masses();
        let centre = centroid(&state.positions, masses);
        Start {
            time: self.time,
            positions: state.positions.clone(),
            centre,
            momentum: state.momentum(masses),
            angular_momentum: state.angular_momentum(masses, &centre),
        }
    }

    /// Whether a body has rested since the beginning of a spell. `scale` is its load scale times its diameter, J.
    fn has_rested(&self, start: &Start, state: &State, scale: f64) -> bool {
        let (rule, masses) = (&self.parameters.sleeping, self.model.masses());
        let time = self.time - start.time;
        let nodes = state.positions.iter().zip(&start.positions);
        let creep: f64 = nodes
            .zip(masses)
            .map(|((x, y), m)| 0.5 * m * (x - y).norm_squared() / (time * time))
            .sum();
        let diameter = self.diameter(state);
        let force = (state.momentum(masses) - start.momentum).norm() / time;
        let turning = state.angular_momentum(masses, &start.centre);
        let moment = (turning - start.angular_momentum).norm() / time;
        let bound = rule.tolerance * scale;
        creep < rule.creep() * scale && force * diameter < bound && moment < bound
    }

    /// Imbalance of a body at rest, the largest of: the sum of |residual| over its nodes over the sum of
    /// |external force|; the net residual force over the load scale; its moment over the load scale times the
    /// diameter.
    fn imbalance(&self, state: &State) -> f64 {
        let (gravity, masses) = (self.parameters.gravity + state.pull, self.model.masses());
        let centre = centroid(&state.positions, masses);
        let loads = state.contact_loads(self.batch, self.body);
        let contacts = loads.forces.iter().zip(loads.damping);
        let nodes = state.strain_forces.iter().zip(masses).zip(&state.positions);
        let (mut left, mut borne) = (0.0, 0.0);
        let mut wrench = [Vector3::zeros(); 2];
        for ((all, damping), ((strain, m), x)) in contacts.zip(nodes) {
            let outer = all - damping + gravity * *m;
            let net = outer + strain;
            left += net.norm();
            borne += outer.norm();
            wrench[0] += net;
            wrench[1] += (x - centre).cross(&net);
        }
        let scale = self.load_scale(state);
        let [force, moment] = wrench.map(|part| part.norm() / scale);
        f64::max(left / borne, force).max(moment / self.diameter(state))
    }
}
