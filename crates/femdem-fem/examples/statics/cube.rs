//! A clamped rubber cube that is stretched and sheared: the convergence of Newton's method, and the cost of
//! its linear solvers.

use super::planes::plane;
use femdem_fem::Drive;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::statics::{StaticOptions, StaticSolution, solve_static};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion};
use femdem_mesh::{TetMesh, Vector3};

/// A unit cube of `cells`^3 cells at nu = 0.3; one face is moved by 10 % outwards and sideways.
///
/// # Errors
/// If the model or the solution fails.
pub fn run(
    element: Element,
    cells: u32,
    options: &StaticOptions,
) -> Result<StaticSolution, Box<dyn std::error::Error>> {
    let mesh = TetMesh::block([cells; 3], &Vector3::new(1.0, 1.0, 1.0))?;
    let rubber = MaterialRegion {
        material: NeoHookean::new(1e6, 0.3)?.into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, element, vec![rubber], None)?;
    let mut boundary = Boundary::default();
    boundary.fix(&model, &plane(0, 0.0), [true; 3])?;
    let drive = Drive::Linear {
        velocity: Vector3::new(0.1, 0.0, 0.1),
        start: 0.0,
        end: 1.0,
    };
    boundary.drive(&model, &plane(0, 1.0), [true; 3], drive)?;
    Ok(solve_static(&model, &boundary, options)?)
}
