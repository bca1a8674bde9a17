//! A thick hollow sphere, a = 1 and b = 2, under a pressure inside.

use crate::loads::{hold, traction};
use femdem_mesh::TetMesh;
use femdem_solve::deformable::{DeformableModel, MaterialRegion};
use femdem_solve::element::Element;
use femdem_solve::material::NeoHookean;
use femdem_solve::statics::{Loading, StaticOptions, StaticSolution, solve_static};

const INNER: f64 = 1.0;
const OUTER: f64 = 2.0;
const YOUNG: f64 = 1000.0;
/// Small enough for the linear theory.
const PRESSURE: f64 = 0.01;

/// An eighth of the sphere: mean radial displacement of the corners of the elements inside, over that
/// of the exact solution, and the solution.
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
    let mut loading = Loading::free(&model);
    for axis in 0..3 {
        hold(&mut loading, &model, axis, |x| x[axis] == 0.0);
    }
    let is_inner = |r: f64| (r - INNER).abs() < 1e-9;
    traction(
        &mut loading,
        &model,
        |p| is_inner(p.coords.norm()),
        |normal| -PRESSURE * normal,
    );
    let solution = solve_static(&model, &loading, options)?;
    let nodes = model.nodes().iter().zip(&solution.positions);
    let moves: Vec<f64> = nodes
        .filter(|(reference, _)| is_inner(reference.norm()))
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
