//! A pack of moving bodies for the tests of the batch, with prescribed motion.

use super::Stream;
use femdem_contact::{ConvexShape, Frame, Motion};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use std::sync::Arc;

/// A shape of the catalogue with circumscribed diameter `d`.
pub fn shape(id: &str, d: f64) -> Arc<ConvexShape> {
    let solid = id.parse::<CatalogueShape>().unwrap().polyhedron(d).unwrap();
    Arc::new(ConvexShape::new(&solid).unwrap())
}

/// The state of a body of unit density at a place, at rest.
pub fn placed(shape: &ConvexShape, position: Vector3<f64>, rotation: Matrix3<f64>) -> Motion {
    let r = shape.radius();
    Motion {
        inverse_mass: 1.0 / r.powi(3),
        inverse_inertia: Matrix3::identity() * (2.5 / r.powi(5)),
        inverse_inertia_max: 2.5 / r.powi(5),
        ..Motion::fixed(Frame { position, rotation })
    }
}

/// Moves a body by its velocities for `dt` and counts its travel.
pub fn advance(motion: &mut Motion, shape: &ConvexShape, dt: f64) {
    motion.frame.position += motion.velocity * dt;
    let turn = UnitQuaternion::from_scaled_axis(motion.angular_velocity * dt).to_rotation_matrix();
    motion.frame.rotation = turn.into_inner() * motion.frame.rotation;
    motion.travelled +=
        (motion.velocity.norm() + motion.angular_velocity.norm() * shape.radius()) * dt;
}

/// New random velocities: a few hundredths of the size per step of unit time.
pub fn stir(motion: &mut Motion, shape: &ConvexShape, stream: &mut Stream) {
    motion.velocity = stream.vector() * (0.06 * shape.radius());
    motion.angular_velocity = stream.vector() * 0.06;
}
