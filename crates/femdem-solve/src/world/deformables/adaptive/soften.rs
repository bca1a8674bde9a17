//! A rigid body that becomes deformable.
//!
//! With the displacements u of the static solve under its contact forces, its nodes stay where they are, at x, and its
//! state without stress is x − u: so its contacts do not change, and its elements balance them, as far as the linear solve with forces spread over discs does. The
//! rigid shape stands for the loaded body, whose strains are those of its material at its strength: 10⁻⁴ to 10⁻³ for rock.

use super::super::fracture::Breakable;
use super::super::{ContactStiffness, DeformableSpec, Model, State};
use super::spin::Kept;
use super::{Fidelity, FidelityChange};
use crate::body::Body;
use crate::error::SolveError;
use crate::world::World;
use crate::world::build::place;
use femdem_contact::deform::Modulus;
use femdem_contact::{BodyId, Field, Frame, Motion};
use femdem_fem::element::Element;
use femdem_fem::free_body::Solved;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use std::sync::Arc;

impl World {
    /// Makes a rigid body deformable that uses `ratio` of its strength, with the displacements `solved` of its contact forces.
    pub(super) fn soften(
        &mut self,
        id: BodyId,
        ratio: f64,
        solved: &Solved,
    ) -> Result<(), SolveError> {
        let Some(adaptives) = self.adaptives.as_deref() else {
            return Ok(());
        };
        let Some(own) = adaptives.bodies.get(&id) else {
            return Ok(());
        };
        let (adaptive, own_model) = (own.adaptive, own.own_model);
        let before = self.ledger();
        let friction = self.friction_of(id);
        let body = &self.bodies[id as usize];
        let shape = &self.shapes[body.shape as usize];
        let (pose, kept) = (body.pose(shape), Kept::of_body(body));
        let pull = body.applied().force / body.mass;
        let (Some((mesh, _)), Some(deformables)) = (&shape.mesh, self.deformables.as_deref())
        else {
            return Ok(());
        };
        let base = &deformables.models[adaptive.model as usize];
        let model = base.unloaded(mesh, solved.displacements(), kept.mass)?;
        let contact = Arc::new(model.shape()?);
        let material = self.batch.material(id).unwrap_or_default();
        let modulus = Modulus::Penalty(self.batch.laws().between([material; 2]).penalty);
        let places = mesh.points().iter();
        let places: Vec<Vector3> = places.map(|x| (pose * x).coords).collect();
        let velocities = kept.velocities(&places, model.model.masses());
        let velocities = velocities.ok_or(SolveError::CannotAdapt {
            needs: "nodes that turn with it",
            found: "nodes on a line",
        })?;
        let spec = DeformableSpec::at_rest(0, Pose::identity());
        let mut state = State::new(&spec, &model.model, self.time)?;
        state.put(&model, &places, &velocities, self.time)?;
        state.pull = pull;
        state.contact_step = model.contact_step(&contact, modulus);
        let mut breakable = Breakable::new(&model, adaptive.fracture, id);
        breakable.highest = ratio;
        state.breakable = Some(Box::new(breakable));
        let bound = state.bound.critical_step().min(state.contact_step);
        let launch = crate::world::time_step::USUAL_MOVE * contact.inradius() / state.fastest;
        let frequency = model.frequency(&contact);
        let number = self.own_model(own_model, model, contact)?;
        state.model = number;
        self.batch.make_deformable(id, number, modulus)?;
        self.batch.set_frequency(id, frequency)?;
        self.batch.set_self_contact(id, true)?;
        self.bodies[id as usize] = Body::vacant();
        self.motions[id as usize] = Motion::fixed(Frame::identity());
        self.awake.retain(|&other| other != id);
        if let Some(deformables) = self.deformables.as_deref_mut() {
            deformables.bound = None;
            place(&mut deformables.bodies, id, state);
        }
        self.step_control.lose();
        self.step_control.see_elements(bound);
        self.step_control.see_launch(launch);
        self.meet_with(&friction)?;
        let energy = self.book_fidelity(&before);
        self.note_change(id, Some(number), None, FidelityChange {
            body: id,
            to: Fidelity::Deformable,
            time: self.time,
            ratio,
            energy,
        });
        Ok(())
    }

    /// Puts a model and its contact shape in the place of the one that the body had alone, or in a new one.
    fn own_model(
        &mut self,
        own: Option<u32>,
        model: Model,
        shape: Arc<femdem_contact::deform::DeformableShape>,
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
    pub(super) fn book_fidelity(&mut self, before: &crate::Ledger) -> f64 {
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
