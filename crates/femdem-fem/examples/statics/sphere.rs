//! A thick hollow sphere, a = 1 and b = 2, under a pressure inside.

use super::planes::plane;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::statics::{StaticOptions, StaticSolution, solve_static};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::{TetMesh, Vector3};

const INNER: f64 = 1.0;
const OUTER: f64 = 2.0;
const YOUNG: f64 = 1000.0;
/// Small enough for the linear theory.
const PRESSURE: f64 = 0.01;

/// An eighth of the sphere: mean radial displacement of the corners of the elements on the inner surface,
/// over that of the exact solution, and the solution.
///
/// # Errors
/// If the model or the solution fails.
pub fn run(
    element: Element,
    poisson: f64,
    around: u32,
    through: u32,
    options: &StaticOptions,
) -> Result<(f64, StaticSolution), Box<dyn std::error::Error>> {
    let mesh = TetMesh::shell_octant(INNER, OUTER, around, through)?;
    let solid = MaterialRegion {
        material: NeoHookean::new(YOUNG, poisson)?.into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, element, vec![solid], None)?;
    let mut boundary = Boundary::default();
    for axis in 0..3 {
        boundary.fix(&model, &plane(axis, 0.0), [0, 1, 2].map(|k| k == axis))?;
    }
    let inside = Selection::Sphere {
        centre: Vector3::zeros(),
        radius: INNER * (1.0 + 1e-9),
    };
    boundary.press(&model, &inside, PRESSURE)?;
    let solution = solve_static(&model, &boundary, options)?;
    let nodes = model.nodes().iter().zip(&solution.state.x);
    let moves: Vec<f64> = nodes
        .filter(|(reference, _)| (reference.norm() - INNER).abs() < 1e-9)
        .map(|(reference, x)| (x - reference).dot(&reference.normalize()))
        .collect();
    let mean = moves.iter().sum::<f64>() / moves.len() as f64;
    Ok((mean / exact(poisson), solution))
}

/// Lame's solution at the inner radius (Timoshenko and Goodier, Theory of Elasticity, art. 136).
fn exact(poisson: f64) -> f64 {
    let (a3, b3) = (INNER.powi(3), OUTER.powi(3));
    let linear = (1.0 - 2.0 * poisson) * a3 / (b3 - a3);
    let inverse = 0.5 * (1.0 + poisson) * b3 / (b3 - a3);
    PRESSURE * INNER / YOUNG * (linear + inverse)
}
