//! Making a world, adding to it, and bringing it back from bytes.

use super::{Counters, World};
use crate::body::{Body, BodySpec, Shape, ShapeId};
use crate::checkpoint;
use crate::drive::Drive;
use crate::error::SolveError;
use crate::ledger::Flows;
use crate::parameters::WorldParameters;
use femdem_contact::{BodyId, ContactBatch, ContactParameters, ConvexShape, Frame, Motion, Wall};
use femdem_mesh::{Polyhedron, Vector3};
use std::sync::Arc;

impl World {
    /// An empty world.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] or [`SolveError::Contact`] name a parameter out of range.
    pub fn new(parameters: WorldParameters) -> Result<Self, SolveError> {
        let law = parameters.validate()?;
        Ok(Self {
            parameters,
            shapes: Vec::new(),
            bodies: Vec::new(),
            motions: Vec::new(),
            wall_drives: Vec::new(),
            wall_motions: Vec::new(),
            batch: ContactBatch::new(law),
            awake: Vec::new(),
            time: 0.0,
            steps: 0,
            step_control: super::time_step::StepControl::default(),
            loaded: false,
            initial_energy: 0.0,
            flows: Flows::default(),
            counters: Counters::default(),
        })
    }

    /// Replaces the contact law; contacts keep their friction history.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn set_contact(&mut self, contact: ContactParameters) -> Result<(), SolveError> {
        let parameters = WorldParameters {
            contact,
            ..self.parameters
        };
        self.replace(parameters)
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

    fn replace(&mut self, parameters: WorldParameters) -> Result<(), SolveError> {
        let law = parameters.validate()?;
        self.parameters = parameters;
        self.batch.set_law(law);
        self.loaded = false;
        self.step_control.forget();
        self.shapes_to_step_control()?;
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
        let shape = Shape::new(name, polyhedron);
        let convex = shape.convex()?;
        self.shapes.push(shape);
        Ok(self.batch.add_shape(Arc::new(convex)))
    }

    /// Adds a body and returns its index.
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
        let convex: &ConvexShape = &self.batch.shapes()[spec.shape as usize];
        let mut body = Body::new(&spec, shape, convex.radius())?;
        body.driven = drive.map(|d| (d, body.position));
        if body.driven.is_none() {
            self.step_control
                .see(convex, &body, &self.parameters.contact);
            let energy =
                body.kinetic_energy() - body.mass * self.parameters.gravity.dot(&body.position);
            self.initial_energy += energy;
        }
        let id = self.batch.add_body(spec.shape)?;
        self.motions.push(body.motion());
        self.bodies.push(body);
        self.awake.push(id);
        self.loaded = false;
        Ok(id)
    }

    /// Adds a wall that is fixed or moves as prescribed, and returns its index.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] for a drive out of range.
    pub fn add_wall(&mut self, wall: Wall, drive: Drive) -> Result<u32, SolveError> {
        drive.validate()?;
        self.wall_drives.push((drive, Vector3::zeros()));
        self.wall_motions.push(Motion::fixed(Frame::identity()));
        self.loaded = false;
        Ok(self.batch.add_wall(wall))
    }

    /// Gives a wall a new prescribed motion, counted from where it is now.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown wall, [`SolveError::Parameter`] for a drive out
    /// of range.
    pub fn drive_wall(&mut self, wall: u32, drive: Drive) -> Result<(), SolveError> {
        drive.validate()?;
        let count = self.wall_drives.len();
        let here = self
            .wall_motions
            .get(wall as usize)
            .map(|m| m.frame.position - drive.at(self.time).displacement);
        match (self.wall_drives.get_mut(wall as usize), here) {
            (Some(slot), Some(origin)) => {
                *slot = (drive, origin);
                Ok(())
            }
            _ => Err(SolveError::NoSuch {
                what: "wall",
                index: wall as usize,
                count,
            }),
        }
    }

    /// The whole state as bytes.
    ///
    /// # Errors
    /// [`SolveError::Encoding`] if it cannot be encoded.
    pub fn to_bytes(&self) -> Result<Vec<u8>, SolveError> {
        checkpoint::encode(self)
    }

    /// A world from the bytes of [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// [`SolveError::Encoding`] if the bytes hold no world.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SolveError> {
        let mut world: Self = checkpoint::decode(bytes)?;
        world.restore()?;
        Ok(world)
    }

    /// Rebuilds what is not stored, after a world was read as part of something larger.
    ///
    /// # Errors
    /// [`SolveError::Contact`] if a stored shape is no longer accepted.
    pub fn restore(&mut self) -> Result<(), SolveError> {
        let shapes = self
            .shapes
            .iter()
            .map(|s| s.convex().map(Arc::new))
            .collect::<Result<Vec<_>, _>>()?;
        self.batch.restore_shapes(shapes)?;
        Ok(())
    }

    /// Tells the step control about all bodies again.
    fn shapes_to_step_control(&mut self) -> Result<(), SolveError> {
        for body in self.bodies.iter().filter(|b| b.driven.is_none()) {
            let convex = &self.batch.shapes()[body.shape as usize];
            self.step_control
                .see(convex, body, &self.parameters.contact);
        }
        Ok(())
    }
}
