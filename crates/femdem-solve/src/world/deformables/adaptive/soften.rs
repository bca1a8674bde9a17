//! A rigid body that becomes deformable.
//!
//! Its nodes stay where they are, at x, and so do its contacts, which now act on nodes. With the displacements u of the static solve under
//! these very forces its state without stress is x − u, so that its elements balance them. The
//! rigid shape stands for the loaded body, whose strains are those of its material near its strength: 10⁻⁴ to 10⁻³ for rock.

use super::super::fracture::Breakable;
use super::super::{ContactStiffness, DeformableSpec, Model, State};
use super::basis::worst;
use super::spin::Kept;
use super::{Adaptive, AdaptiveBody, Fidelity, FidelityChange};
use crate::Ledger;
use crate::body::Body;
use crate::error::SolveError;
use crate::world::World;
use crate::world::lists::place;
use crate::world::time_step::USUAL_MOVE;
use femdem_contact::deform::{DeformableShape, Modulus};
use femdem_contact::{BodyId, Field, Frame, Motion};
use femdem_fem::element::Element;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use std::sync::Arc;

/// A rigid body that is to become deformable.
pub(super) struct Solid {
    adaptive: Adaptive,
    mesh: TetMesh,
    pub pose: Pose,
    kept: Kept,
    /// Acceleration by its external load, m/s^2.
    pull: Vector3,
    /// The model that it had when it was deformable before.
    own_model: Option<u32>,
}

impl World {
    /// Makes a rigid body deformable.
    pub(super) fn soften(&mut self, id: BodyId) -> Result<(), SolveError> {
        let own = self.adaptives.as_deref();
        let own = own.and_then(|all| all.bodies.get(&id));
        let Some(solid) = own.and_then(|own| self.solid(id, own)) else {
            return Ok(());
        };
        let before = self.ledger();
        let friction = self.friction_of(id);
        let number = self.mesh_in_place(id, &solid)?;
        self.meet_with(&friction)?;
        let ratio = self.balance(id, &solid, number)?;
        let energy = self.book_fidelity(&before);
        self.note_change(
            id,
            Some(number),
            None,
            FidelityChange {
                body: id,
                to: Fidelity::Deformable,
                time: self.time,
                ratio,
                energy,
            },
        );
        Ok(())
    }

    /// A rigid body as it is now.
    pub(super) fn solid(&self, id: BodyId, own: &AdaptiveBody) -> Option<Solid> {
        let body = &self.bodies[id as usize];
        let shape = &self.shapes[body.shape as usize];
        Some(Solid {
            adaptive: own.adaptive,
            mesh: shape.mesh.as_ref()?.0.clone(),
            pose: body.pose(shape),
            kept: Kept::of_body(body),
            pull: body.applied().force / body.mass,
            own_model: own.own_model,
        })
    }

    /// Replaces a rigid body by its tetrahedra without strain, and returns the number of their model.
    fn mesh_in_place(&mut self, id: BodyId, solid: &Solid) -> Result<u32, SolveError> {
        let still = vec![Vector3::zeros(); solid.mesh.points().len()];
        let model = self.model_of(solid, &still)?;
        let shape = Arc::new(model.shape()?);
        let state = solid.state(&model, self.time)?;
        let launch = USUAL_MOVE * shape.inradius() / state.fastest;
        let (modulus, frequency) = (self.modulus_of(id), model.frequency(&shape));
        let number = self.own_model(solid.own_model, model, shape)?;
        self.batch.make_deformable(id, number, modulus)?;
        self.batch.set_frequency(id, frequency)?;
        self.batch.set_self_contact(id, true)?;
        self.bodies[id as usize] = Body::vacant();
        self.motions[id as usize] = Motion::fixed(Frame::identity());
        self.awake.retain(|&other| other != id);
        if let Some(deformables) = self.deformables.as_deref_mut() {
            let state = State {
                model: number,
                ..state
            };
            place(&mut deformables.bodies, id, state);
        }
        self.step_control.lose();
        self.step_control.see_launch(launch);
        Ok(number)
    }

    /// Strains a body in its place such that it balances its contacts, and returns its largest stress over its strength.
    fn balance(&mut self, id: BodyId, solid: &Solid, number: u32) -> Result<f64, SolveError> {
        let adaptives = self.adaptives.as_deref();
        let known = adaptives.and_then(|all| {
            let factors = &all.bodies.get(&id)?.factors;
            Some((all.bases.get(&solid.adaptive.model)?, factors))
        });
        let Some((basis, factors)) = known else {
            return Ok(0.0);
        };
        let back = solid.pose.rotation.inverse();
        let forces = self.batch.nodal_loads(id).forces.iter();
        let forces: Vec<Vector3> = forces.map(|f| back * f).collect();
        let solved = basis.solve(&forces)?;
        let strength = &solid.adaptive.fracture.strength;
        let ratio = worst(strength, solved.corners(), factors);
        let model = self.model_of(solid, solved.displacements())?;
        let shape = Arc::new(model.shape()?);
        let modulus = self.modulus_of(id);
        let mut state = solid.state(&model, self.time)?;
        state.model = number;
        state.contact_step = model.contact_step(&shape, modulus);
        let mut breakable = Breakable::new(&model, solid.adaptive.fracture, id);
        breakable.highest = ratio;
        state.breakable = Some(Box::new(breakable));
        let bound = state.bound.critical_step().min(state.contact_step);
        self.step_control.see_elements(bound);
        if let Some(deformables) = self.deformables.as_deref_mut() {
            deformables.models[number as usize] = model;
            deformables.bodies[id as usize] = state;
        }
        self.batch.crack_deformable(id, number, Some(shape))?;
        self.batch.set_modulus(id, modulus)?;
        self.touch(0.0)?;
        Ok(ratio)
    }

    pub(super) fn modulus_of(&self, id: BodyId) -> Modulus {
        let material = self.batch.material(id).unwrap_or_default();
        Modulus::Penalty(self.batch.laws().between([material; 2]).penalty)
    }

    fn model_of(&self, solid: &Solid, displacements: &[Vector3]) -> Result<Model, SolveError> {
        let models = self.deformables.as_deref().map_or(&[][..], |d| &d.models);
        let missing = || SolveError::NoSuch {
            what: "model",
            index: solid.adaptive.model as usize,
            count: models.len(),
        };
        let base = models
            .get(solid.adaptive.model as usize)
            .ok_or_else(missing)?;
        base.unloaded(&solid.mesh, displacements, solid.kept.mass)
    }

    /// Puts a model and its contact shape in the place of the one that the body had alone, or in a new one.
    fn own_model(
        &mut self,
        own: Option<u32>,
        model: Model,
        shape: Arc<DeformableShape>,
    ) -> Result<u32, SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(0);
        };
        match own {
            Some(number) => {
                deformables.models[number as usize] = model;
                self.batch.replace_deformable_shape(number, shape)?;
                Ok(number)
            }
            None => {
                deformables.models.push(model);
                Ok(self.batch.add_deformable_shape(shape))
            }
        }
    }

    /// Books what a change has given to the world since the books were as `before`, and returns it, J.
    pub(super) fn book_fidelity(&mut self, before: &Ledger) -> f64 {
        let after = self.ledger();
        let energy = after.final_energy() - before.final_energy();
        self.flows.fidelity += energy;
        // What friction has dissipated is its work less what its springs hold.
        self.flows.friction_work -= after.friction_springs - before.friction_springs;
        energy
    }

    /// Notes a change, and what the body has of its own from now on.
    pub(super) fn note_change(
        &mut self,
        id: BodyId,
        model: Option<u32>,
        shape: Option<u32>,
        change: FidelityChange,
    ) {
        let Some(adaptives) = self.adaptives.as_deref_mut() else {
            return;
        };
        adaptives.changes.push(change);
        if let Some(own) = adaptives.bodies.get_mut(&id) {
            own.own_model = model.or(own.own_model);
            own.own_shape = shape.or(own.own_shape);
            own.screen = super::Screen::default();
            own.quiet = 0;
        }
    }
}

impl Solid {
    /// Positions (m) and velocities (m/s) of its nodes with these masses (kg).
    pub fn nodes(&self, masses: &[f64]) -> Result<(Vec<Vector3>, Vec<Vector3>), SolveError> {
        let places = self.mesh.points().iter();
        let places: Vec<Vector3> = places.map(|x| (self.pose * x).coords).collect();
        let velocities = self.kept.velocities(&places, masses);
        let velocities = velocities.ok_or(SolveError::CannotAdapt {
            needs: "nodes that turn with it",
            found: "nodes on a line",
        })?;
        Ok((places, velocities))
    }

    /// Its nodes where they are as a rigid body, moving as it does.
    fn state(&self, model: &Model, time: f64) -> Result<State, SolveError> {
        let (places, velocities) = self.nodes(model.model.masses())?;
        let spec = DeformableSpec::at_rest(0, Pose::identity());
        let mut state = State::new(&spec, &model.model, time)?;
        state.put(model, &places, &velocities, time)?;
        state.pull = self.pull;
        Ok(state)
    }
}

impl Model {
    /// The model of a body whose nodes lie at the points of `mesh` under loads that displace them by `displacements` (m): as heavy as
    /// `mass` (kg).
    fn unloaded(
        &self,
        mesh: &TetMesh,
        displacements: &[Vector3],
        mass: f64,
    ) -> Result<Self, SolveError> {
        let points = mesh.points().iter().zip(displacements);
        let points: Vec<Point3> = points.map(|(x, u)| x - u).collect();
        let mesh = TetMesh::new(points, mesh.tets().to_vec())?;
        let scale = mass / (mesh.volume() * self.model.regions()[0].density);
        let scaled = |region: &MaterialRegion| MaterialRegion {
            density: region.density * scale,
            ..region.clone()
        };
        let regions = self.model.regions().iter().map(scaled).collect();
        Ok(Self {
            name: self.name.clone(),
            model: DeformableModel::new(&mesh, Element::T4, regions, None)?,
            stiffness: ContactStiffness::Law,
            field: Field::Body,
            young: self.young,
            edge: None,
        })
    }
}
