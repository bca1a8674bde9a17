//! A corner that slides over a meshed body.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::tets;
use femdem_contact::general::GeneralScratch;
use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::{Rotation3, Unit, Vector3};
use femdem_mesh::tet::{MeshOptions, Method, mesh};

/// Slides the corner of a small cube, 20 mm deep, over the middle of the top of a unit cube.
/// Returns the relative variation of the normal force and the largest tangential force over it.
fn slide(body: &FieldMesh) -> (f64, f64) {
    let kernel = GeneralKernel::new(3.0).unwrap();
    let slider = tets::body(&tets::cubes(&[[0; 3]], 0.3), Field::Gauge);
    let down = Rotation3::rotation_between(&Vector3::repeat(-1.0), &-Vector3::z()).unwrap();
    let spin = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::z()), 0.4);
    let mut scratch = GeneralScratch::default();
    let (mut least, mut most, mut sideways) = (f64::INFINITY, 0.0_f64, 0.0_f64);
    // The corner is 0.15 sqrt 3 below the slider's centre; the cube's top is at 0.5.
    let height = 0.5 - 0.02 + 0.15 * 3_f64.sqrt();
    for k in 0..=200 {
        let s = f64::from(k) / 200.0 - 0.5;
        let frame = Frame {
            position: Vector3::new(0.3 * s, 0.05 + 0.11 * s, height),
            rotation: (spin * down).into_inner(),
        };
        let force =
            tets::total(kernel.evaluate(body, &Frame::identity(), &slider, &frame, &mut scratch))
                .force;
        least = least.min(force.z);
        most = most.max(force.z);
        sideways = sideways.max(force.xy().norm() / force.z);
    }
    assert!(least > 0.0);
    ((most - least) / least, sideways)
}

/// The field is the depth over h0 wherever no tetrahedron reaches another side; there the force does not
/// depend on the mesh, however fine it is.
#[test]
fn the_body_field_hides_the_mesh() {
    let mut meshes: Vec<TetMesh> = [1, 3, 4, 6].map(tets::cube).to_vec();
    let surface = tets::cube(1).surface().unwrap();
    for method in [Method::CentroidFan, Method::Stuffing] {
        let options = MeshOptions {
            method: Some(method),
            edge_length: Some(0.2),
            ..MeshOptions::default()
        };
        meshes.push(mesh(&surface, &options).unwrap().0);
    }
    for (n, mesh) in meshes.iter().enumerate() {
        let body = tets::body(mesh, Field::Body);
        let (variation, sideways) = slide(&body);
        assert!(
            variation < 1e-9 && sideways < 1e-9,
            "mesh {n}: {variation:e}, {sideways:e}"
        );
    }
}
