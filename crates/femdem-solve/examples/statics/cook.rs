//! Cook's membrane: a tapered panel, clamped on the left and sheared on the right, in plane strain.

use crate::loads::{hold, traction};
use crate::meshes;
use femdem_mesh::Vector3;
use femdem_solve::deformable::{DeformableModel, MaterialRegion};
use femdem_solve::element::Element;
use femdem_solve::material::NeoHookean;
use femdem_solve::statics::{Loading, StaticOptions, StaticSolution, solve_static};

const YOUNG: f64 = 70.0;
const SHEAR: f64 = 6.25;
const THICKNESS: f64 = 5.0;
/// Part of the load applied, for the linear theory; displacements are divided by it.
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
    let mesh = meshes::cook(cells, THICKNESS)?;
    let solid = MaterialRegion {
        material: NeoHookean::new(YOUNG, poisson)?.into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, element, vec![solid], None)?;
    let mut loading = Loading::free(&model);
    hold(&mut loading, &model, 0, |x| x.x == 0.0);
    hold(&mut loading, &model, 1, |x| x.x == 0.0);
    hold(&mut loading, &model, 2, |x| x.z == 0.0 || x.z == THICKNESS);
    traction(
        &mut loading,
        &model,
        |p| p.x == 48.0,
        |_| Vector3::new(0.0, SHEAR * PART, 0.0),
    );
    let solution = solve_static(&model, &loading, options)?;
    let corner = Vector3::new(48.0, 60.0, 0.0);
    let nodes = model.nodes().iter().zip(&solution.positions);
    let nearest = nodes.min_by(|(a, _), (b, _)| {
        let distance = |x: &Vector3| (x - corner).norm_squared();
        distance(a).total_cmp(&distance(b))
    });
    let (reference, x) = nearest.ok_or("the mesh has no nodes")?;
    Ok(((x.y - reference.y) / PART, solution))
}
