//! Settings common to all runs.

use crate::ball::Hertz;
use crate::law::Law;
use femdem_contact::deform::DeformableShape;
use femdem_fem::element::Element;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::nalgebra::{Matrix4, Vector4};
use femdem_mesh::{Pose, Rotation, TetMesh, Vector3};
use femdem_solve::SolveError;
use femdem_solve::WorldParameters;
use std::error::Error;

/// No gravity, no friction, no damping.
pub fn smooth(safety: f64) -> WorldParameters {
    let mut parameters = WorldParameters {
        gravity: Vector3::zeros(),
        ..WorldParameters::default()
    };
    parameters.contact.friction = 0.0;
    parameters.contact.damping_ratio = 0.0;
    parameters.time_step.safety = safety;
    parameters
}

pub fn model(
    mesh: &TetMesh,
    element: Element,
    material: &Hertz,
    density: f64,
    law: Law,
) -> Result<DeformableModel, SolveError> {
    let region = MaterialRegion {
        material: law.material(material.young, material.poisson)?,
        density,
    };
    Ok(DeformableModel::new(mesh, element, vec![region], None)?)
}

/// Turned by an angle about x, then moved.
pub fn turned(angle: f64, to: Vector3) -> Pose {
    Pose::from_parts(
        to.into(),
        Rotation::from_axis_angle(&Vector3::x_axis(), angle),
    )
}

/// The contact field of a body.
pub struct Setting {
    /// Penalty p, Pa.
    pub penalty: f64,
    values: Vec<f64>,
    tets: Vec<[u32; 4]>,
}

impl Setting {
    /// The field with a foundation modulus, Pa/m.
    pub fn new(model: &DeformableModel, foundation: f64) -> Result<Self, Box<dyn Error>> {
        let mesh = model.mesh();
        let shape =
            DeformableShape::with_field(mesh, model.mid_edges(), femdem_contact::Field::Body)?;
        let length = shape.inradius();
        let depths = mesh.distance_to_skin();
        Ok(Self {
            penalty: foundation * length,
            values: depths.iter().map(|d| (d / length).min(1.0)).collect(),
            tets: mesh.tets().to_vec(),
        })
    }

    /// p times the field at a height on the axis, Pa, of a body with its nodes at `x`.
    pub fn pressure_at(&self, x: &[Vector3], height: f64) -> f64 {
        let point = Vector4::new(0.0, 0.0, height, 1.0);
        let mut best = (f64::NEG_INFINITY, 0.0);
        for tet in &self.tets {
            let columns = tet.map(|i| x[i as usize].push(1.0));
            let Some(inverse) = Matrix4::from_columns(&columns).try_inverse() else {
                continue;
            };
            let weights = inverse * point;
            if weights.min() > best.0 {
                let values = tet.map(|i| self.values[i as usize]);
                best = (weights.min(), weights.dot(&Vector4::from(values)));
            }
        }
        self.penalty * best.1.max(0.0)
    }
}
