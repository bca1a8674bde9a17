//! Deformable bodies: elements against closed forms, differences and rigid motion.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod boundary;
mod bounds;
mod derivatives;
mod motion;
mod patch;
mod refusals;
mod same_forces;

use femdem_fem::element::Element;
use femdem_fem::material::{
    AnyMaterial, Deformation, Material, NeoHookean, Response, Tangent, difference_tangent,
};
use femdem_fem::{DeformableModel, InternalState, MaterialRegion, Workspace};
use femdem_mesh::{Matrix3, TetMesh, Vector3};
use std::sync::Arc;

const ELEMENTS: [Element; 4] = [
    Element::T4,
    Element::T4NodalPressure,
    Element::T10,
    Element::T10Fbar,
];

/// A second law, independent of the crate: W = mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2, with a viscous stress
/// eta J (d + d^T) F^-T where d = Fdot F^-1.
#[derive(Debug)]
struct Split {
    shear: f64,
    bulk: f64,
    viscosity: f64,
}

impl Material for Split {
    fn name(&self) -> &str {
        "split"
    }

    fn respond(&self, d: &Deformation, _old: &[f64], _new: &mut [f64]) -> Option<Response> {
        let (f, j) = (d.gradient, d.volume_ratio()?);
        let inverse = f.try_inverse()?;
        let inverse_t = inverse.transpose();
        let scaled = j.powf(-2.0 / 3.0);
        let i1 = f.norm_squared();
        let energy = 0.5 * self.shear * (scaled * i1 - 3.0) + 0.5 * self.bulk * (j - 1.0).powi(2);
        let rate = d.rate * inverse;
        let viscous = (rate + rate.transpose()) * inverse_t * (self.viscosity * j);
        let piola = (f - inverse_t * (i1 / 3.0)) * (self.shear * scaled)
            + inverse_t * (self.bulk * (j - 1.0) * j)
            + viscous;
        Some(Response {
            viscous_power: viscous.dot(&d.rate),
            ..Response::elastic(energy, piola)?
        })
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        difference_tangent(self, d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.bulk + 4.0 / 3.0 * self.shear
    }

    /// Valid for small strain.
    fn stiffness_bound(&self, d: &Deformation, _old: &[f64]) -> f64 {
        1.2 * self.wave_modulus() / d.smallest_stretch().powi(2)
    }

    fn viscosity(&self) -> f64 {
        2.0 * self.viscosity
    }
}

fn neo_hookean(young: f64, poisson: f64) -> AnyMaterial {
    NeoHookean::new(young, poisson).unwrap().into()
}

fn split(shear: f64, bulk: f64, viscosity: f64) -> AnyMaterial {
    AnyMaterial::custom(Arc::new(Split {
        shear,
        bulk,
        viscosity,
    }))
}

/// The two laws of these tests, of about E = 1e6 Pa.
fn laws() -> [AnyMaterial; 2] {
    [neo_hookean(1e6, 0.3), split(4e5, 2e6, 0.0)]
}

/// A number in [-1, 1] from an index.
fn noise(i: u64) -> f64 {
    let x = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((x >> 11) as f64 / (1u64 << 52) as f64) - 1.0
}

fn noisy(i: usize, seed: u64) -> Vector3 {
    let at = |c: u64| noise(seed * 1_000_003 + 3 * i as u64 + c);
    Vector3::new(at(0), at(1), at(2))
}

/// A block of 2 x 1 x 1 cells of a quarter metre with its points displaced, so that no two tetrahedra are
/// alike.
fn crooked() -> TetMesh {
    let block = TetMesh::block([2, 1, 1], &Vector3::new(0.5, 0.25, 0.25)).unwrap();
    let points = block.points().iter().enumerate();
    let moved = points.map(|(i, p)| p + noisy(i, 7) * 0.03).collect();
    TetMesh::new(moved, block.tets().to_vec()).unwrap()
}

fn model(mesh: &TetMesh, element: Element, material: AnyMaterial) -> DeformableModel {
    let region = MaterialRegion {
        material,
        density: 1000.0,
    };
    DeformableModel::new(mesh, element, vec![region], None).unwrap()
}

/// Half of the tetrahedra of one law, half of another.
fn two_regions(mesh: &TetMesh, element: Element) -> DeformableModel {
    let [first, second] = laws();
    let regions = [(first, 1000.0), (second, 3000.0)];
    let regions = regions.map(|(material, density)| MaterialRegion { material, density });
    let half = mesh.tets().len() / 2;
    let of = (0..mesh.tets().len())
        .map(|e| u32::from(e >= half))
        .collect();
    DeformableModel::new(mesh, element, regions.to_vec(), Some(of)).unwrap()
}

/// Positions after an affine map and a disturbance of the size `wobble`, m.
fn placed(model: &DeformableModel, map: &Matrix3, wobble: f64) -> Vec<Vector3> {
    let nodes = model.nodes().iter().enumerate();
    nodes.map(|(i, x)| map * x + noisy(i, 3) * wobble).collect()
}

fn strained() -> Matrix3 {
    Matrix3::new(1.1, 0.05, -0.02, 0.03, 0.93, 0.04, -0.06, 0.02, 1.02)
}

/// A rotation by 1 rad about (1, 2, 3), computed identically by any compiler.
fn turned() -> Matrix3 {
    let axis = Vector3::new(1.0, 2.0, 3.0).normalize();
    femdem_mesh::Rotation::from_scaled_axis(axis)
        .to_rotation_matrix()
        .into_inner()
}

/// Energy and forces at `x`, at rest.
fn forces(model: &DeformableModel, x: &[Vector3]) -> (InternalState, Vec<Vector3>) {
    forces_moving(model, x, &vec![Vector3::zeros(); x.len()])
}

fn forces_moving(
    model: &DeformableModel,
    x: &[Vector3],
    v: &[Vector3],
) -> (InternalState, Vec<Vector3>) {
    let mut f = vec![Vector3::repeat(f64::NAN); x.len()];
    let old = vec![0.0; model.history_len()];
    let mut new = old.clone();
    let state = model
        .internal_forces(x, v, &old, &mut new, &mut f, &mut Workspace::default())
        .unwrap();
    (state, f)
}

fn largest(vectors: &[Vector3]) -> f64 {
    vectors.iter().map(|f| f.norm()).fold(0.0, f64::max)
}
