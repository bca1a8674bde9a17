//! The contacts that a rigid body would have if it were deformable.

use super::super::State;
use super::AdaptiveBody;
use crate::error::SolveError;
use crate::world::World;
use femdem_contact::deform::NodalState;
use femdem_contact::{BodyId, Contact, ContactBatch, Motion, Partner};
use femdem_mesh::Vector3;
use std::collections::BTreeSet;

impl World {
    /// The forces (N) on the nodes of a rigid body, in its coordinates, that its contacts would exert if it were deformable: those that it
    /// gets when it [becomes so](super::soften). They are found in a batch of the body and of what it touches.
    pub(super) fn nodal_forces_of(
        &self,
        id: BodyId,
        own: &AdaptiveBody,
        contacts: &[&Contact],
    ) -> Result<Option<Vec<Vector3>>, SolveError> {
        let model = self.deformables.as_deref().map(|d| &d.models);
        let model = model.and_then(|models| models.get(own.adaptive.model as usize));
        let (Some(solid), Some(model)) = (self.solid(id, own), model) else {
            return Ok(None);
        };
        let (positions, velocities) = solid.nodes(model.model.masses())?;
        let inverse_masses: Vec<f64> = model.model.masses().iter().map(|m| 1.0 / m).collect();
        let shape = &self.batch.deformable_shapes()[own.adaptive.model as usize];
        let mut trial = ContactBatch::new(self.batch.laws().clone());
        let number = trial.add_deformable_shape(shape.clone());
        let body = trial.add_deformable(number, self.modulus_of(id))?;
        trial.set_frequency(body, model.frequency(shape))?;
        trial.set_material(body, self.batch.material(id).unwrap_or_default())?;
        let mut nodes = vec![NodalState {
            positions: &positions,
            velocities: &velocities,
            inverse_masses: &inverse_masses,
        }];
        let (mut bodies, mut walls) = (vec![self.motion_now(id)], Vec::new());
        let partners: BTreeSet<Partner> = contacts.iter().map(|c| other(c, id)).collect();
        let friction = self.friction_of(id);
        for partner in partners {
            let new = match partner {
                Partner::Body(other) => {
                    let known = self.add_to(&mut trial, other)?;
                    let state = self.nodes_of(other);
                    nodes.push(state.map_or(NodalState::default(), State::nodes));
                    bodies.push(self.motion_now(other));
                    Partner::Body(known)
                }
                Partner::Wall(wall) => {
                    let Some(shape) = self.batch.wall(wall) else {
                        continue;
                    };
                    let known = trial.add_wall(shape.clone());
                    let material = self.batch.wall_material(wall).unwrap_or_default();
                    trial.set_wall_material(known, material)?;
                    walls.push(self.wall_motions[wall as usize]);
                    Partner::Wall(known)
                }
            };
            friction.begin(&mut trial, (partner, id), (new, body))?;
        }
        trial.update_deformables(&nodes, &bodies, &walls, 0.0)?;
        let back = solid.pose.rotation.inverse();
        let forces = trial.nodal_loads(body).forces.iter();
        Ok(Some(forces.map(|f| back * f).collect()))
    }

    /// The motion of a body with its present velocity: that on record is the one with which the contacts were evaluated last.
    fn motion_now(&self, id: BodyId) -> Motion {
        let motion = self.motions[id as usize];
        let body = &self.bodies[id as usize];
        match body.driven {
            None if self.batch.is_rigid(id) => Motion {
                velocity: body.velocity,
                angular_velocity: body.angular_velocity(),
                ..motion
            },
            _ => motion,
        }
    }

    /// Adds a body as it is to another batch, and returns its number there.
    fn add_to(&self, batch: &mut ContactBatch, id: BodyId) -> Result<BodyId, SolveError> {
        let new = if let Some(shape) = self.batch.shape_index(id) {
            let shape = batch.add_shape(self.batch.shapes()[shape as usize].clone());
            batch.add_body(shape)?
        } else {
            let known = self.deformables.as_deref().zip(self.batch.modulus(id));
            let (deformables, modulus) = known.ok_or(SolveError::NoSuch {
                what: "deformable body",
                index: id as usize,
                count: self.batch.deformable_count(),
            })?;
            let model = deformables.bodies[id as usize].model as usize;
            let shape = &self.batch.deformable_shapes()[model];
            let number = batch.add_deformable_shape(shape.clone());
            let new = batch.add_deformable(number, modulus)?;
            batch.set_frequency(new, deformables.models[model].frequency(shape))?;
            new
        };
        batch.set_material(new, self.batch.material(id).unwrap_or_default())?;
        Ok(new)
    }
}

/// What body `id` touches in a contact.
fn other(contact: &Contact, id: BodyId) -> Partner {
    match contact.a {
        a if contact.b == id => a,
        _ => Partner::Body(contact.b),
    }
}
