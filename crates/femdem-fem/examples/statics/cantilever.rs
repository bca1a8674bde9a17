//! A cantilever of 10 x 1 x 1 with a shear force at its end.

use super::planes::plane;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::statics::{StaticOptions, StaticSolution, solve_static};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion};
use femdem_mesh::{TetMesh, Vector3};

const LENGTH: f64 = 10.0;
const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;
/// Small enough for the linear theory: a deflection of 1e-4 of the length.
const FORCE: f64 = 0.25;

/// Mean deflection of the end over that of Timoshenko's beam, and the solution.
///
/// # Errors
/// If the model or the solution fails.
pub fn run(
    element: Element,
    cells: [u32; 3],
    options: &StaticOptions,
) -> Result<(f64, StaticSolution), Box<dyn std::error::Error>> {
    let mesh = TetMesh::block(cells, &Vector3::new(LENGTH, 1.0, 1.0))?;
    let solid = MaterialRegion {
        material: NeoHookean::new(YOUNG, POISSON)?.into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, element, vec![solid], None)?;
    let mut boundary = Boundary::default();
    boundary.fix(&model, &plane(0, 0.0), [true; 3])?;
    boundary.pull(
        &model,
        &plane(0, LENGTH),
        Vector3::new(0.0, 0.0, -FORCE),
        1.0,
    )?;
    let solution = solve_static(&model, &boundary, options)?;
    let ends = model.nodes().iter().zip(&solution.state.x);
    let falls: Vec<f64> = ends
        .filter(|(reference, _)| reference.x == LENGTH)
        .map(|(reference, x)| reference.z - x.z)
        .collect();
    let mean = falls.iter().sum::<f64>() / falls.len() as f64;
    Ok((mean / timoshenko(), solution))
}

/// F L^3 / (3 E I) + F L / (k G A) with k = 10 (1 + nu) / (12 + 11 nu) (Cowper, J. Appl. Mech. 33,
/// 335 (1966)).
fn timoshenko() -> f64 {
    let k = 10.0 * (1.0 + POISSON) / (12.0 + 11.0 * POISSON);
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    FORCE * LENGTH.powi(3) / (3.0 * YOUNG / 12.0) + FORCE * LENGTH / (k * shear)
}
