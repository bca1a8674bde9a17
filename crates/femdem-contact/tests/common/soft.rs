//! Deformable bodies for the tests of their contacts.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "every test file uses its own part, and helpers of tests fail the test"
)]

use super::Stream;
use femdem_contact::Frame;
use femdem_contact::deform::DeformableShape;
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::Vector3;

/// A shape and the positions of its nodes.
#[derive(Clone)]
pub struct Soft {
    pub shape: DeformableShape,
    pub mesh: TetMesh,
    pub x: Vec<Vector3<f64>>,
}

/// The edges of a mesh, each once.
pub fn edges(mesh: &TetMesh) -> Vec<[u32; 2]> {
    let mut list = Vec::new();
    for t in mesh.tets() {
        for i in 0..4 {
            for j in i + 1..4 {
                list.push([t[i].min(t[j]), t[i].max(t[j])]);
            }
        }
    }
    list.sort_unstable();
    list.dedup();
    list
}

impl Soft {
    /// Linear tetrahedra about the centroid.
    pub fn linear(mesh: &TetMesh) -> Self {
        let centroid = mesh.mass_properties().centroid;
        Self {
            shape: DeformableShape::new(mesh).unwrap(),
            x: mesh.points().iter().map(|p| p - centroid).collect(),
            mesh: mesh.clone(),
        }
    }

    /// Quadratic ones.
    pub fn quadratic(mesh: &TetMesh) -> Self {
        let edges = edges(mesh);
        let mut soft = Self::linear(mesh);
        soft.shape = DeformableShape::quadratic(mesh, &edges).unwrap();
        for [i, j] in edges {
            soft.x.push((soft.x[i as usize] + soft.x[j as usize]) * 0.5);
        }
        soft
    }

    pub fn posed(&self, frame: &Frame) -> Self {
        let mut posed = self.clone();
        posed.x.iter_mut().for_each(|x| *x = frame.point(x));
        posed
    }

    /// Every node moved at random by at most `size` along each axis.
    pub fn shaken(mut self, stream: &mut Stream, size: f64) -> Self {
        for x in &mut self.x {
            *x += stream.vector() * (2.0 * size);
        }
        self
    }
}

/// A random place near another frame, turned at random.
pub fn near(frame: &Frame, stream: &mut Stream, distance: f64) -> Frame {
    Frame {
        position: frame.position + stream.vector().normalize() * distance,
        rotation: stream.rotation(),
    }
}
