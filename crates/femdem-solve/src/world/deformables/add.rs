//! Adding models and deformable bodies to a world.

use super::fracture::Breakable;
use super::nodal_bound::NodalBound;
use super::{ContactStiffness, DeformableSpec, Deformables, Model, ModelId, State};
use crate::body::{Body, check_velocities};
use crate::error::{SolveError, check};
use crate::world::World;
use crate::world::build::meets_deformables;
use crate::world::lists::place;
use crate::world::periodic::apart;
use crate::world::stored::inconsistent;
use crate::world::time_step::USUAL_MOVE;
use femdem_contact::deform::DeformableShape;
use femdem_contact::deform::Modulus;
use femdem_contact::{BodyId, ContactBatch, Field, Frame, Motion, Partner};
use femdem_fem::material::{Deformation, Material};
use femdem_fem::{Boundary, DeformableModel};
use femdem_mesh::nalgebra::Matrix6;
use femdem_mesh::{Matrix3, Vector3, checked_pose};
use std::sync::Arc;

impl World {
    /// Adds a model of deformable bodies, with the stiffness of their contacts, and returns its
    /// index. Rigid bodies, deformable ones and walls then share one step and one ledger.
    ///
    /// # Errors
    /// [`SolveError::Contact`] if the mesh carries no contact field, [`SolveError::Parameter`] for a
    /// stiffness that is not positive.
    pub fn add_model(
        &mut self,
        name: &str,
        model: DeformableModel,
        stiffness: ContactStiffness,
    ) -> Result<ModelId, SolveError> {
        self.add_model_with_field(name, model, stiffness, Field::Body)
    }

    /// As [`World::add_model`], with a choice of the field. With the field and the penalty of a rigid body,
    /// contacts have the same forces as those of that body.
    ///
    /// # Errors
    /// As [`World::add_model`].
    pub fn add_model_with_field(
        &mut self,
        name: &str,
        model: DeformableModel,
        stiffness: ContactStiffness,
        field: Field,
    ) -> Result<ModelId, SolveError> {
        if let ContactStiffness::Penalty(x) | ContactStiffness::Ratio(x) = stiffness {
            check("contact stiffness", x, x > 0.0, "positive and finite")?;
        }
        let young = stiffest(&model);
        check(
            "Young's modulus of the stiffest material",
            young,
            young > 0.0,
            "positive and finite",
        )?;
        let model = Model {
            name: name.to_owned(),
            model,
            stiffness,
            field,
            young,
            edge: None,
        };
        let shape = model.shape()?;
        self.restored()?;
        if self.deformables.is_none() {
            self.batch.shapes().iter().try_for_each(meets_deformables)?;
        }
        let numbers = self.batch.slots()[0];
        let deformables = self.deformables.get_or_insert_default();
        deformables.reach(numbers);
        deformables.models.push(model);
        Ok(self.batch.add_deformable_shape(shape))
    }

    /// Adds a deformable body and returns its index: that of a [removed](Self::remove_body) body, the lowest, or else a
    /// new one. Motions of its boundary count from its pose at this
    /// moment, like those of walls and driven bodies. It may [touch itself](Self::set_self_contact).
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown model, [`SolveError::Parameter`] for the model that a body which has cracked has alone, and
    /// for a pose or velocity that is not finite, [`SolveError::BodyFailed`] if an element has no stress; for a body with a
    /// [`fracture`](DeformableSpec::fracture) also [`SolveError::TooCoarse`] and [`SolveError::CannotBreak`].
    pub fn add_deformable(&mut self, spec: DeformableSpec) -> Result<BodyId, SolveError> {
        let gravity = self.parameters.gravity;
        let laws = self.batch.laws().clone();
        let (time, step) = (self.time, self.steps);
        self.restored()?;
        self.not_shared("adding bodies")?;
        let models = self.deformables.as_deref().map_or(&[][..], |d| &d.models);
        let count = models.len();
        let Some(model) = models.get(spec.model as usize) else {
            return Err(SolveError::NoSuch {
                what: "model",
                index: spec.model as usize,
                count,
            });
        };
        if model.edge.is_some() {
            return Err(SolveError::Parameter {
                name: "the model of a new body",
                value: f64::from(spec.model),
                allowed: "one that was added: a body that has cracked has this one alone",
            });
        }
        let mut state = State::new(&spec, &model.model, time)?;
        let body = self.batch.len();
        state.bound = model
            .model
            .stable_frequency2(&state.positions, &state.history)
            .map_err(|failure| SolveError::from(failure).in_body(body, step, time))?;
        if let Some(fracture) = &spec.fracture {
            model.may_break(fracture)?;
            if self.cell().is_some() {
                return Err(apart());
            }
        }
        let masses = model.model.masses();
        let energy = state.kinetic_energy(masses) + state.potential(masses, &gravity);
        let shape = &self.batch.deformable_shapes()[spec.model as usize];
        let launch = USUAL_MOVE * shape.inradius() / state.fastest;
        let modulus = model.modulus(shape, &laws, spec.material);
        state.contact_step = model.contact_step(shape, modulus);
        let bound = state.bound.critical_step().min(state.contact_step);
        let frequency = model.frequency(shape);
        let id = self.batch.add_deformable(spec.model, modulus)?;
        self.batch.set_frequency(id, frequency)?;
        self.batch.set_material(id, spec.material)?;
        self.batch.set_self_contact(id, true)?;
        place(&mut self.bodies, id, Body::vacant());
        place(&mut self.motions, id, Motion::fixed(Frame::identity()));
        if let Some(deformables) = &mut self.deformables {
            place(&mut deformables.bodies, id, state);
            if let Some(fracture) = spec.fracture {
                let (model, state) = deformables.parts(id);
                state.breakable = Some(Box::new(Breakable::new(model, fracture, id)));
            }
        }
        self.newcomers.added.bodies.insert(id);
        self.initial_energy += energy;
        self.step_control.see_elements(bound);
        self.step_control.see_launch(launch);
        self.loaded = false;
        Ok(id)
    }

    /// Starts the contact of a deformable body B with a friction force on B (N) and a moment about the normal
    /// (N m), such as those of the rigid bodies that it replaces: see [`ContactBatch::begin_friction`](femdem_contact::ContactBatch::begin_friction).
    ///
    /// # Errors
    /// [`SolveError::NotRestored`], [`SolveError::Ranks`] in a world that is [shared out](Self::share_out), and those of
    /// [`ContactBatch::begin_friction`](femdem_contact::ContactBatch::begin_friction).
    pub fn begin_friction(
        &mut self,
        a: Partner,
        b: BodyId,
        force: Vector3,
        torsion: f64,
    ) -> Result<(), SolveError> {
        self.restored()?;
        self.not_shared("beginning friction")?;
        Ok(self.batch.begin_friction(a, b, force, torsion)?)
    }
}

impl State {
    pub(super) fn new(
        spec: &DeformableSpec,
        model: &DeformableModel,
        time: f64,
    ) -> Result<Self, SolveError> {
        check_velocities(&spec.velocity, &spec.angular_velocity)?;
        let pose = checked_pose(&spec.pose)?;
        let place = |x: &Vector3| pose.rotation * x + pose.translation.vector;
        let positions: Vec<Vector3> = model.nodes().iter().map(place).collect();
        let centre = centroid(&positions, model.masses());
        let velocity = |x: &Vector3| spec.velocity + spec.angular_velocity.cross(&(x - centre));
        let mut velocities: Vec<Vector3> = positions.iter().map(velocity).collect();
        let boundary = spec.boundary.posed(&pose)?.counted_from(time);
        boundary.check(model)?;
        boundary.for_held(time, |a, i, _, velocity| velocities[a][i] = velocity);
        Ok(Self {
            model: spec.model,
            held_energy: held_energy(&boundary, model.masses(), &velocities),
            fastest: velocities.iter().map(Vector3::norm).fold(0.0, f64::max),
            velocities,
            inverse_masses: inverse_masses(model.masses(), &boundary),
            pull: Vector3::zeros(),
            history: vec![0.0; model.history_len()],
            strain_forces: vec![Vector3::zeros(); positions.len()],
            loads: vec![Vector3::zeros(); positions.len()],
            positions,
            boundary,
            internal: Default::default(),
            bound: Default::default(),
            contact_step: f64::INFINITY,
            nodal: NodalBound::new(model)?,
            rest: Default::default(),
            breakable: None,
        })
    }
}

/// Kinetic energy of the prescribed nodes and components, J.
pub(super) fn held_energy(boundary: &Boundary, masses: &[f64], velocities: &[Vector3]) -> f64 {
    let held = |(a, i): (u32, usize)| 0.5 * masses[a as usize] * velocities[a as usize][i].powi(2);
    boundary.held().map(held).sum()
}

/// Inverse masses of the nodes, 1/kg; 0 for those prescribed in all directions.
pub(super) fn inverse_masses(masses: &[f64], boundary: &Boundary) -> Vec<f64> {
    let mut held = vec![0_u8; masses.len()];
    for (node, _) in boundary.held() {
        held[node as usize] += 1;
    }
    let inverse = |(m, held): (&f64, u8)| if held == 3 { 0.0 } else { 1.0 / m };
    masses.iter().zip(held).map(inverse).collect()
}

/// Centre of mass, m.
pub(in crate::world) fn centroid(positions: &[Vector3], masses: &[f64]) -> Vector3 {
    let sum: Vector3 = positions.iter().zip(masses).map(|(x, m)| x * *m).sum();
    sum / masses.iter().sum::<f64>()
}

/// Tensor of inertia about the centre of mass, kg m^2.
pub(in crate::world) fn inertia(
    positions: &[Vector3],
    masses: &[f64],
    centre: &Vector3,
) -> Matrix3 {
    let mut inertia = Matrix3::zeros();
    for (x, m) in positions.iter().zip(masses) {
        let r = x - centre;
        inertia += (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * *m;
    }
    inertia
}

/// Young's modulus of the stiffest material at no strain, Pa; NaN if a law has no tangent there.
fn stiffest(model: &DeformableModel) -> f64 {
    let regions = model.regions().iter();
    regions.map(|r| young(&r.material)).fold(0.0, f64::max)
}

/// Young's modulus at no strain, from the tangent: the inverse of the compliance along x.
fn young(material: &dyn Material) -> f64 {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
    let rest = Deformation::at_rest(Matrix3::identity());
    let old = vec![0.0; material.history_len()];
    let Some(tangent) = material.tangent(&rest, &old) else {
        return f64::NAN;
    };
    let stiffness = Matrix6::from_fn(|r, c| {
        let ((i, j), (k, l)) = (PAIRS[r], PAIRS[c]);
        tangent[(3 * i + j, 3 * k + l)]
    });
    stiffness
        .try_inverse()
        .map_or(f64::NAN, |compliance| 1.0 / compliance[(0, 0)])
}

impl Deformables {
    /// Makes the list of bodies long enough for `count` numbers.
    pub(in crate::world) fn reach(&mut self, count: usize) {
        let count = count.max(self.bodies.len());
        self.bodies.resize_with(count, State::vacant);
    }

    /// Renews the stiffnesses that are given [by the law](super::ContactStiffness::Law), after the laws were replaced.
    pub(in crate::world) fn renew_moduli(
        &mut self,
        batch: &mut ContactBatch,
    ) -> Result<(), SolveError> {
        let ids: Vec<BodyId> = batch.deformable_ids().collect();
        ids.into_iter()
            .try_for_each(|id| self.renew_modulus(id, batch))
    }

    /// Sets the stiffness of the contact field of a body anew, when the laws or its material have changed.
    pub(in crate::world) fn renew_modulus(
        &mut self,
        id: BodyId,
        batch: &mut ContactBatch,
    ) -> Result<(), SolveError> {
        let body = &mut self.bodies[id as usize];
        let shape = &batch.deformable_shapes()[body.model as usize];
        let model = &self.models[body.model as usize];
        let material = batch.material(id).unwrap_or_default();
        let modulus = match (
            model.modulus(shape, batch.laws(), material),
            batch.modulus(id),
        ) {
            // The pressure over depth of a body that has cracked stays.
            (Modulus::Penalty(penalty), Some(Modulus::Kept { length, .. })) => {
                Modulus::Kept { penalty, length }
            }
            (modulus, _) => modulus,
        };
        body.contact_step = model.contact_step(shape, modulus);
        Ok(batch.set_modulus(id, modulus)?)
    }

    /// Refuses what does not fit together.
    pub(in crate::world) fn check_stored(&self, batch: &ContactBatch) -> Result<(), SolveError> {
        let (found, expected) = (self.bodies.len(), batch.slots()[0]);
        if found != expected {
            return Err(inconsistent(format!(
                "it has {found} states of deformable bodies where {expected} are right"
            )));
        }
        for (index, body) in self.bodies.iter().enumerate() {
            let count = self.models.len();
            let Some(model) = self.models.get(body.model as usize) else {
                return Err(inconsistent(format!(
                    "deformable body {index} has model {}, but there are {count}",
                    body.model
                )));
            };
            let nodes = if batch.is_deformable(index as u32) {
                model.model.nodes().len()
            } else {
                0
            };
            if !body.has_nodes(nodes) {
                return Err(inconsistent(format!(
                    "deformable body {index} has {nodes} nodes, but not as many of all that belongs to them"
                )));
            }
            body.boundary.check(&model.model)?;
            if let Some(breakable) = &body.breakable {
                breakable.check(model)?;
            }
        }
        Ok(())
    }

    /// The contact shapes of the models.
    pub(in crate::world) fn shapes(&self) -> Result<Vec<Arc<DeformableShape>>, SolveError> {
        let models = self.models.iter();
        models.map(|model| Ok(Arc::new(model.shape()?))).collect()
    }
}
