//! One deformable body in motion, without contacts.

use super::{BodyLedger, Boundary, DeformableModel, InternalState, Workspace};
use crate::error::{FemError, check};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The state of a deformable body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DeformableState {
    /// Positions of the nodes, m.
    pub x: Vec<Vector3>,
    /// Velocities of the nodes, m/s.
    pub v: Vec<Vector3>,
    /// History of the materials.
    pub history: Vec<f64>,
}

impl DeformableState {
    /// The reference state of a model, at rest.
    #[must_use]
    pub fn reference(model: &DeformableModel) -> Self {
        Self {
            x: model.nodes().to_vec(),
            v: vec![Vector3::zeros(); model.nodes().len()],
            history: vec![0.0; model.history_len()],
        }
    }
}

/// A single deformable body that is stepped separately: kick, drift, forces, kick, with a complete energy
/// ledger. A world with contacts uses the same parts.
///
/// ```
/// use femdem_mesh::{TetMesh, Vector3};
/// use femdem_fem::{
///     Boundary, DeformableBody, DeformableModel, MaterialRegion, Selection,
/// };
/// use femdem_fem::element::Element;
/// use femdem_fem::material::NeoHookean;
/// use std::sync::Arc;
///
/// // A bar held at one end falls into its own weight and swings about twice the static sag.
/// let mesh = TetMesh::block([1, 1, 8], &Vector3::new(0.1, 0.1, 0.8))?;
/// let soft = MaterialRegion { material: NeoHookean::new(1e6, 0.3)?.into(), density: 1000.0 };
/// let model = Arc::new(DeformableModel::new(&mesh, Element::T4, vec![soft], None)?);
/// let mut boundary = Boundary::new(Vector3::new(0.0, 0.0, -9.81))?;
/// let top = Selection::Plane { normal: Vector3::z(), offset: 0.8, tolerance: 1e-9 };
/// boundary.fix(&model, &top, [true; 3])?;
/// let mut body = DeformableBody::new(model, boundary)?;
/// let dt = 0.9 * body.critical_step()?;
/// while body.time() < 0.05 {
///     body.step(dt)?;
/// }
/// let lowest = body.state().x.iter().map(|x| x.z).fold(0.0, f64::min);
/// assert!(lowest < -0.003 && lowest > -0.007, "rho g L^2 / (2 E) = 3.1 mm");
/// assert!(body.ledger().error_relative().abs() < 1e-3);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DeformableBody {
    model: Arc<DeformableModel>,
    boundary: Boundary,
    state: DeformableState,
    time: f64,
    steps: u64,
    /// Of the materials, then of the loads, at the current time, N.
    internal: Vec<Vector3>,
    external: Vec<Vector3>,
    next_history: Vec<f64>,
    now: InternalState,
    ledger: BodyLedger,
    work: Workspace,
}

impl DeformableBody {
    /// A body at rest in its reference state at time 0.
    ///
    /// # Errors
    ///
    /// [`FemError::Element`] if the materials have no stress there.
    pub fn new(model: Arc<DeformableModel>, boundary: Boundary) -> Result<Self, FemError> {
        let state = DeformableState::reference(&model);
        Self::with_state(model, boundary, state, 0.0)
    }

    /// A body in a given state, at time `time` (s). Held nodes are moved to their places.
    ///
    /// # Errors
    ///
    /// [`FemError::Element`] if an array does not have the length that the model needs, or the materials
    /// have no stress in that state; [`FemError`] if the boundary belongs to a larger model or the time is
    /// not finite.
    pub fn with_state(
        model: Arc<DeformableModel>,
        boundary: Boundary,
        state: DeformableState,
        time: f64,
    ) -> Result<Self, FemError> {
        check("time", time, true, "finite, in s")?;
        boundary.check(&model)?;
        let count = model.nodes().len();
        let mut body = Self {
            internal: vec![Vector3::zeros(); count],
            external: vec![Vector3::zeros(); count],
            next_history: state.history.clone(),
            model,
            boundary,
            state,
            time,
            steps: 0,
            now: InternalState::default(),
            ledger: BodyLedger::default(),
            work: Workspace::default(),
        };
        body.check_lengths()?;
        for v in &body.state.v {
            check(
                "velocity of a node",
                v.norm(),
                true,
                "finite in every component, in m/s",
            )?;
        }
        let DeformableState { x, v, .. } = &mut body.state;
        body.boundary.for_held(time, |node, i, place, velocity| {
            x[node][i] = place;
            v[node][i] = velocity;
        });
        body.evaluate()?;
        let kinetic = body.kinetic_energy();
        body.ledger = BodyLedger {
            initial: kinetic + body.now.energy,
            kinetic,
            elastic: body.now.energy,
            ..BodyLedger::default()
        };
        Ok(body)
    }

    fn check_lengths(&self) -> Result<(), FemError> {
        let (nodes, count) = (self.state.v.len(), self.model.nodes().len());
        check(
            "length of v",
            nodes as f64,
            nodes == count,
            "the number of nodes",
        )?;
        Ok(self
            .model
            .check_lengths(&self.state.x, &self.state.history)?)
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<DeformableModel> {
        &self.model
    }

    /// The boundary conditions.
    #[must_use]
    pub fn boundary(&self) -> &Boundary {
        &self.boundary
    }

    /// Positions, velocities and history.
    #[must_use]
    pub fn state(&self) -> &DeformableState {
        &self.state
    }

    /// Simulated time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps taken.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The energy ledger.
    #[must_use]
    pub fn ledger(&self) -> &BodyLedger {
        &self.ledger
    }

    /// Internal forces of the nodes now, N.
    #[must_use]
    pub fn internal_forces(&self) -> &[Vector3] {
        &self.internal
    }

    /// Loads and weight of the nodes now, N.
    #[must_use]
    pub fn external_forces(&self) -> &[Vector3] {
        &self.external
    }

    /// The largest stable step now, s: see [`super::FrequencyBound::critical_step`]. Use less, since
    /// stiffness changes with deformation: 0.9 of it as a rule, 0.5 for large strains.
    ///
    /// # Errors
    ///
    /// [`FemError::Element`] if the materials have no stress.
    pub fn critical_step(&self) -> Result<f64, FemError> {
        let bound = self
            .model
            .stable_frequency2(&self.state.x, &self.state.history)?;
        Ok(bound.critical_step())
    }

    /// One step of `dt` seconds.
    ///
    /// # Errors
    ///
    /// [`FemError::StepFailed`] with the step and the element if one is inverted, which a step that is too
    /// large eventually causes; the body is then unusable. [`FemError::Parameter`] if `dt` is not positive.
    pub fn step(&mut self, dt: f64) -> Result<(), FemError> {
        check("dt", dt, dt > 0.0, "positive, in s")?;
        let (half, end) = (0.5 * dt, self.time + dt);
        let before = self.driven_energy();
        self.kick(half);
        let DeformableState { x, v, .. } = &mut self.state;
        self.boundary.for_held(end, |node, i, place, _| {
            v[node][i] = (place - x[node][i]) / dt;
        });
        for (x, v) in x.iter_mut().zip(v.iter()) {
            *x += v * dt;
        }
        self.boundary
            .for_held(end, |node, i, place, _| x[node][i] = place);
        let mut work = self.half_work(half);
        self.time = end;
        self.steps += 1;
        let viscous_before = self.now.viscous_power;
        self.evaluate()
            .map_err(|error| error.at_step(self.steps, self.time))?;
        std::mem::swap(&mut self.state.history, &mut self.next_history);
        let second = self.half_work(half);
        work.0 += second.0;
        work.1 += second.1;
        self.kick(half);
        let v = &mut self.state.v;
        self.boundary
            .for_held(end, |node, i, _, velocity| v[node][i] = velocity);

        let ledger = &mut self.ledger;
        ledger.viscous += half * (viscous_before + self.now.viscous_power);
        ledger.plastic += self.now.plastic_work;
        ledger.external_work += work.0;
        ledger.elastic = self.now.energy;
        self.ledger.kinetic = self.kinetic_energy();
        self.ledger.support_work += self.driven_energy() - before - work.1;
        Ok(())
    }

    /// Adds half a step of force to the velocities. Held components then get theirs from the boundary.
    fn kick(&mut self, half: f64) {
        let forces = self.internal.iter().zip(&self.external);
        let nodes = self.state.v.iter_mut().zip(self.model.masses());
        for ((v, mass), (internal, external)) in nodes.zip(forces) {
            *v += (internal + external) * (half / mass);
        }
    }

    /// Work of the loads in half a step, and of all forces on held components, J.
    fn half_work(&self, half: f64) -> (f64, f64) {
        let each = self.external.iter().zip(&self.state.v);
        let external: f64 = each.map(|(f, v)| f.dot(v)).sum();
        let on_held = |(node, i): (u32, usize)| {
            let node = node as usize;
            (self.internal[node][i] + self.external[node][i]) * self.state.v[node][i]
        };
        let held: f64 = self.boundary.held().map(on_held).sum();
        (external * half, held * half)
    }

    /// Forces at the current positions; the new history goes to `next_history`.
    fn evaluate(&mut self) -> Result<(), FemError> {
        let DeformableState { x, v, history } = &self.state;
        self.now = self.model.internal_forces(
            x,
            v,
            history,
            &mut self.next_history,
            &mut self.internal,
            &mut self.work,
        )?;
        self.external.fill(Vector3::zeros());
        self.boundary
            .add_forces(&self.model, self.time, &self.state.x, &mut self.external)
    }

    fn kinetic_energy(&self) -> f64 {
        let each = self.state.v.iter().zip(self.model.masses());
        0.5 * each.map(|(v, m)| m * v.norm_squared()).sum::<f64>()
    }

    /// Kinetic energy of held components, J.
    fn driven_energy(&self) -> f64 {
        let of = |(node, i): (u32, usize)| {
            let node = node as usize;
            0.5 * self.model.masses()[node] * self.state.v[node][i].powi(2)
        };
        self.boundary.held().map(of).sum()
    }
}
