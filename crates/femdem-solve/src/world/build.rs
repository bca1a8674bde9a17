//! Making a world, adding to it, and bringing it back from bytes.

use super::lists::place;
use super::ranks::Whose;
use super::{Counters, World};
use crate::body::{Body, BodySpec, Shape, ShapeId};
use crate::checkpoint;
use crate::error::SolveError;
use crate::guide::Guide;
use crate::halo::Halo;
use crate::ledger::Flows;
use crate::parameters::{TimeStepParameters, WorldParameters};
use femdem_contact::{
    BodyId, BodyShape, ContactBatch, ContactLaw, ContactLaws, Field, Frame, Motion, WallShape,
};
use femdem_fem::Drive;
use femdem_mesh::{Polyhedron, Pose, TetMesh};

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] or [`SolveError::Contact`] name a parameter out of range.
    pub fn new(parameters: WorldParameters) -> Result<Self, SolveError> {
        let laws = parameters.laws(&ContactLaw::new(parameters.contact)?.into())?;
        Ok(Self {
            parameters,
            shapes: Vec::new(),
            bodies: Vec::new(),
            motions: Vec::new(),
            ahead: Vec::new(),
            wall_drives: Vec::new(),
            wall_motions: Vec::new(),
            batch: ContactBatch::new(laws),
            awake: Vec::new(),
            time: 0.0,
            steps: 0,
            unsettled: false,
            step_control: super::time_step::StepControl::default(),
            loaded: false,
            newcomers: super::newcomers::Newcomers::default(),
            behind: 0.0,
            initial_energy: 0.0,
            flows: Flows::default(),
            deformables: None,
            adaptives: None,
            share: None,
            counters: Counters::default(),
        })
    }

    /// Replaces the control of the step size, and whether steps are implicit. As all changes of parameters, all ranks make it if
    /// the world is [shared out](Self::share_out).
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn set_time_step(&mut self, time_step: TimeStepParameters) -> Result<(), SolveError> {
        let parameters = WorldParameters {
            time_step,
            ..self.parameters
        };
        self.replace(parameters)
    }

    /// Ends [implicit](crate::ImplicitStep) steps; does nothing where steps are explicit.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn step_explicitly(&mut self) -> Result<(), SolveError> {
        let time_step = self.parameters.time_step;
        if time_step.implicit.is_none() {
            return Ok(());
        }
        self.set_time_step(TimeStepParameters {
            implicit: None,
            ..time_step
        })
    }

    /// Replaces the damping of the medium.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn set_medium(&mut self, medium: crate::Medium) -> Result<(), SolveError> {
        let parameters = WorldParameters {
            medium,
            ..self.parameters
        };
        self.replace(parameters)
    }

    pub(super) fn replace(&mut self, parameters: WorldParameters) -> Result<(), SolveError> {
        let laws = self.batch.laws().clone();
        self.replace_laws(parameters, &laws)
    }

    /// Replaces the parameters, and the laws of pairs of materials by those of `others`.
    pub(super) fn replace_laws(
        &mut self,
        parameters: WorldParameters,
        others: &ContactLaws,
    ) -> Result<(), SolveError> {
        let laws = parameters.laws(others)?;
        self.restored()?;
        self.check_adaptive_laws(&laws)?;
        self.parameters = parameters;
        self.batch.set_laws(laws);
        if let Some(deformables) = &mut self.deformables {
            deformables.renew_moduli(&mut self.batch)?;
        }
        self.loaded = false;
        self.step_control.forget();
        let mut control = self.step_control;
        for (_, body) in self.free_bodies() {
            control.launch(body);
        }
        self.step_control = control;
        self.step_control.lose();
        Ok(())
    }

    /// Adds a convex shape and returns its index.
    ///
    /// # Errors
    /// [`SolveError::Contact`] if it is not convex or too thin for the gauge field.
    pub fn add_shape(
        &mut self,
        name: &str,
        polyhedron: &Polyhedron,
    ) -> Result<ShapeId, SolveError> {
        self.insert_shape(Shape::new(name, polyhedron))
    }

    /// Adds a sphere of a radius in m, about the origin of its coordinates, and returns its index.
    ///
    /// Mass and inertia are those of the exact ball, and so are the contacts with spheres, walls of planes and convex
    /// shapes ([`Sphere`](femdem_contact::Sphere)); with meshes and deformable bodies they are those of the polyhedron that
    /// is drawn.
    ///
    /// # Errors
    /// [`SolveError::Contact`] unless the radius is between 1e-40 and 1e40 m.
    pub fn add_sphere(&mut self, name: &str, radius: f64) -> Result<ShapeId, SolveError> {
        self.insert_shape(Shape::sphere(name, radius)?)
    }

    /// Adds a shape of any form and returns its index: its surface, and tetrahedra that fill it,
    /// in the same coordinates, with the field that makes the contact forces.
    ///
    /// Mass, centroid and inertia are those of the surface; contacts are those of the mesh. A
    /// convex shape is cheaper by [`add_shape`](Self::add_shape).
    ///
    /// # Errors
    /// [`SolveError::Parameter`] if the volumes of the two differ by more than 10 %,
    /// [`SolveError::Contact`] if the mesh cannot carry the field.
    pub fn add_mesh_shape(
        &mut self,
        name: &str,
        polyhedron: &Polyhedron,
        mesh: &TetMesh,
        field: Field,
    ) -> Result<ShapeId, SolveError> {
        self.insert_shape(Shape::meshed(name, polyhedron, mesh, field)?)
    }

    fn insert_shape(&mut self, shape: Shape) -> Result<ShapeId, SolveError> {
        let contact = shape.contact()?;
        self.restored()?;
        self.not_shared("adding shapes")?;
        if self.deformables.is_some() {
            meets_deformables(&contact)?;
        }
        self.shapes.push(shape);
        Ok(self.batch.add_shape(contact))
    }

    /// Adds a body and returns its index: that of a [removed](Self::remove_body) body, the lowest, or else a new one.
    ///
    /// In a world that is [shared out](Self::share_out) all ranks add the same body. It is kept by its owner and those near it,
    /// and the index is its number in the whole. Other methods take that [here](Self::number_here).
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown shape, [`SolveError::Parameter`] for a density
    /// that is not positive or a pose or velocity that is not finite.
    pub fn add_body(&mut self, spec: BodySpec) -> Result<BodyId, SolveError> {
        self.insert(spec, None)
    }

    /// Adds a body that follows a prescribed motion from its pose, whatever touches it.
    ///
    /// # Errors
    /// As [`World::add_body`], and for a drive out of range.
    pub fn add_driven_body(&mut self, spec: BodySpec, drive: Drive) -> Result<BodyId, SolveError> {
        drive.validate()?;
        self.insert(spec, Some(drive))
    }

    fn insert(&mut self, spec: BodySpec, drive: Option<Drive>) -> Result<BodyId, SolveError> {
        let Some(shape) = self.shapes.get(spec.shape as usize) else {
            return Err(SolveError::NoSuch {
                what: "shape",
                index: spec.shape as usize,
                count: self.shapes.len(),
            });
        };
        self.restored()?;
        if drive.is_some() {
            self.not_shared("adding driven bodies")?;
        }
        let contact = &self.batch.shapes()[spec.shape as usize];
        let mut body = Body::new(&spec, shape, contact.radius())?;
        let whose = self.enlist(&body)?;
        let is_own = matches!(whose, Whose::Only | Whose::Own(_));
        let contact = &self.batch.shapes()[spec.shape as usize];
        let (shape, thinner) = (spec.shape, self.step_control.meet(contact));
        if let Some(drive) = drive {
            let (driven, place) = (drive.at(self.time), body.place());
            body.driven = Some(Box::new((Guide::Drive(drive), driven.base_of(&place))));
            body.follow(&driven, &place);
        } else {
            let laws = self.batch.laws().of(spec.material);
            self.step_control.see(contact, &body, laws);
            self.step_control.launch(&body);
            if is_own {
                self.initial_energy += body.energy(&self.parameters.gravity);
            }
        }
        self.loaded = false;
        if thinner {
            self.step_control.lose();
        }
        let id = match whose {
            Whose::Only => self.batch.add_body(shape)?,
            Whose::Own(id) | Whose::Guest(id) => {
                self.batch.add_body_as(id, shape, !is_own)?;
                id
            }
            Whose::Other(number) => return Ok(number),
        };
        self.batch.set_material(id, spec.material)?;
        if let Some(deformables) = &mut self.deformables {
            deformables.reach(id as usize + 1);
        }
        place(&mut self.motions, id, body.motion());
        place(&mut self.bodies, id, body);
        if is_own {
            let at = self.awake.partition_point(|&other| other < id);
            self.awake.insert(at, id);
        }
        self.newcomers.added.bodies.insert(id);
        Ok(self.number_in_whole(id).unwrap_or(id))
    }

    /// Adds a wall, of planes or a mesh, that is fixed or moves as prescribed, and returns its
    /// index. Its material is 0 until [another](Self::set_wall_material) is set. Frozen bodies wake: it may stand where one of them is.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] for a drive out of range.
    pub fn add_wall(
        &mut self,
        wall: impl Into<WallShape>,
        drive: Drive,
    ) -> Result<u32, SolveError> {
        drive.validate()?;
        let base = drive.at(self.time).base_of(&Pose::identity());
        self.wake_all();
        self.loaded = false;
        let id = self.batch.add_wall(wall);
        place(&mut self.wall_drives, id, (Guide::Drive(drive), base));
        place(&mut self.wall_motions, id, Motion::fixed(Frame::identity()));
        self.newcomers.added.walls.insert(id);
        Ok(id)
    }

    /// Gives a wall a new prescribed motion, counted from where it is now.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown wall, [`SolveError::Parameter`] for a drive out
    /// of range.
    pub fn drive_wall(&mut self, wall: u32, drive: Drive) -> Result<(), SolveError> {
        drive.validate()?;
        self.guide_wall(wall, Guide::Drive(drive))
    }

    /// The whole state as bytes, with a checksum.
    ///
    /// # Errors
    /// [`SolveError::Encoding`] if it cannot be encoded.
    pub fn to_bytes(&self) -> Result<Vec<u8>, SolveError> {
        checkpoint::encode(self)
    }

    /// A world from the bytes of [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// [`SolveError::Encoding`] if the bytes hold no world, or are not those that were made.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SolveError> {
        let mut world: Self = checkpoint::decode(bytes)?;
        world.restore()?;
        Ok(world)
    }

    /// Rebuilds what is not stored, after a world was read as part of something larger.
    ///
    /// # Errors
    /// [`SolveError::Encoding`] if its parts do not fit together, [`SolveError::Parameter`] for a drive out of range,
    /// [`SolveError::Contact`] if a stored shape is no longer accepted or the stored contacts do not fit.
    pub fn restore(&mut self) -> Result<(), SolveError> {
        self.check_stored()?;
        let shapes = self
            .shapes
            .iter()
            .map(Shape::contact)
            .collect::<Result<Vec<_>, _>>()?;
        let deformables = self.deformables.as_deref();
        let soft = deformables.map_or_else(|| Ok(Vec::new()), |d| d.shapes())?;
        Ok(self.batch.restore_shapes(shapes, soft)?)
    }

    /// A world that was read has no contact shapes before it is restored.
    pub(super) fn restored(&self) -> Result<(), SolveError> {
        let deformables = self.deformables.as_deref();
        let models = deformables.map_or(0, |d| d.models.len());
        let soft = (models, self.batch.deformable_shapes().len());
        let rigid = (self.shapes.len(), self.batch.shapes().len());
        if [rigid, soft].iter().all(|(all, made)| made >= all) {
            Ok(())
        } else {
            Err(SolveError::NotRestored)
        }
    }

    /// Tells the step control about all bodies again if it has [lost](super::time_step::StepControl::lose) one. This is done by a
    /// step alone, after forces and the bounds of elements are up to date, so that a world has the same cap alone and over ranks.
    pub(super) fn renew_cap(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let mut control = self.step_control;
        if !control.begins_anew() {
            return Ok(());
        }
        let contact = |body: &Body| &self.batch.shapes()[body.shape as usize];
        for (_, body) in self.live_bodies() {
            control.meet(contact(body));
        }
        control.share_lengths(halo)?;
        for (i, body) in self.free_bodies() {
            let material = self.batch.material(i as u32).unwrap_or_default();
            control.see(contact(body), body, self.batch.laws().of(material));
        }
        for (_, body, _) in self.own_nodes() {
            control.see_elements(body.bound.critical_step().min(body.contact_step));
        }
        control.share_steps(halo)?;
        self.step_control = control;
        Ok(())
    }
}

/// Refuses a shape that is too flat for the tetrahedra by which deformable bodies meet it.
pub(super) fn meets_deformables(shape: &BodyShape) -> Result<(), SolveError> {
    if let Some(convex) = shape.convex() {
        convex.fan()?;
    }
    Ok(())
}
