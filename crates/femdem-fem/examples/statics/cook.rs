//! Cook's membrane: a tapered panel, clamped on the left and sheared on the right, in plane strain.

use super::planes::plane;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::statics::{StaticOptions, StaticSolution, solve_static};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion};
use femdem_mesh::{MeshError, Point3, TetMesh, Vector3};

const YOUNG: f64 = 70.0;
const SHEAR: f64 = 6.25;
const THICKNESS: f64 = 5.0;
/// Fraction of the load applied, for the linear theory; displacements are divided by it.
const PART: f64 = 1e-5;

/// Vertical displacement of the upper corner on the right, and the solution.
///
/// # Errors
/// If the model or the solution fails.
pub fn run(
    element: Element,
    poisson: f64,
    cells: [u32; 3],
    options: &StaticOptions,
) -> Result<(f64, StaticSolution), Box<dyn std::error::Error>> {
    let mesh = mesh(cells)?;
    let solid = MaterialRegion {
        material: NeoHookean::new(YOUNG, poisson)?.into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, element, vec![solid], None)?;
    let mut boundary = Boundary::default();
    boundary.fix(&model, &plane(0, 0.0), [true, true, false])?;
    for z in [0.0, THICKNESS] {
        boundary.fix(&model, &plane(2, z), [false, false, true])?;
    }
    let shear = Vector3::new(0.0, SHEAR * PART, 0.0);
    boundary.pull(&model, &plane(0, 48.0), shear, 1.0)?;
    let solution = solve_static(&model, &boundary, options)?;
    let corner = Vector3::new(48.0, 60.0, 0.0);
    let nodes = model.nodes().iter().zip(&solution.state.x);
    let nearest = nodes.min_by(|(a, _), (b, _)| {
        let distance = |x: &Vector3| (x - corner).norm_squared();
        distance(a).total_cmp(&distance(b))
    });
    let (reference, x) = nearest.ok_or("the mesh has no nodes")?;
    Ok(((x.y - reference.y) / PART, solution))
}

/// The trapezium (0, 0), (48, 44), (48, 60), (0, 44): `cells` along its length, height and thickness.
fn mesh(cells: [u32; 3]) -> Result<TetMesh, MeshError> {
    let unit = TetMesh::block(cells, &Vector3::new(1.0, 1.0, 1.0))?;
    let map = |p: &Point3| {
        let y = 44.0 * p.x + p.y * (44.0 - 28.0 * p.x);
        Point3::new(48.0 * p.x, y, THICKNESS * p.z)
    };
    TetMesh::new(
        unit.points().iter().map(map).collect(),
        unit.tets().to_vec(),
    )
}
