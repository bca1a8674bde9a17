//! Tetrahedra with their stresses, in a file for ParaView.
//!
//! Deformable bodies are tetrahedra (VTK type 10) or quadratic tetrahedra (24), all in one grid.
//! Point data: `displacement` (m, from where the body was placed), `velocity` (m/s). Cell data: `body`
//! (number among the members), `region`, `von_mises`, `pressure` (Pa, positive in compression),
//! `principal_stress` (Pa, three components, largest first), `stress` (Pa, the components xx, yy, zz, xy, yz
//! and xz, tension positive), `volume_ratio`, `sleeping` (1 where the body is frozen), `plastic_strain` where a material has
//! one, and where bodies may break `fragment` (the row of `fragments.csv`, −1 of others) and `damage` (the largest of the facets).

use std::borrow::Cow;
use std::io::{self, Write};

use femdem_fem::{DeformableModel, ElementStress};
use femdem_mesh::{Pose, Vector3};
use femdem_view::output::vtk::Document;

const VTK_TETRA: u8 = 10;
const VTK_QUADRATIC_TETRA: u8 = 24;

/// A body with its stresses.
pub(crate) struct GridBody<'a> {
    /// Its number in the file.
    pub number: usize,
    /// Where it was placed: from the coordinates of the model's mesh to the world.
    pub placed: Pose,
    pub model: &'a DeformableModel,
    pub positions: Cow<'a, [Vector3]>,
    /// Written if all bodies have them.
    pub velocities: Option<&'a [Vector3]>,
    /// One for each element.
    pub stresses: &'a [ElementStress],
    pub is_asleep: bool,
    /// If a material has one.
    pub plastic_strains: Option<&'a [f64]>,
}

/// Writes bodies as a VTU file, with the cell data that `more` adds.
///
/// # Errors
///
/// If writing fails.
pub(crate) fn write_grid<'a>(
    bodies: &'a [GridBody],
    writer: impl Write,
    more: impl FnOnce(&mut Document<'a>),
) -> io::Result<()> {
    let points: usize = bodies.iter().map(|b| b.positions.len()).sum();
    let cells: usize = bodies.iter().map(|b| b.stresses.len()).sum();
    let mut out = Document::new("UnstructuredGrid");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<Points>"
    ));
    let positions = bodies.iter().flat_map(|b| b.positions.iter());
    out.floats("points", 3, positions.flat_map(|x| <[f64; 3]>::from(*x)));
    out.line("</Points>\n<Cells>");
    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    let mut first = 0;
    for body in bodies {
        let model = body.model;
        let kind = if model.element().is_quadratic() {
            VTK_QUADRATIC_TETRA
        } else {
            VTK_TETRA
        };
        for nodes in model.elements() {
            // The order of the nodes is VTK's.
            connectivity.extend(nodes.iter().map(|&node| first + i64::from(node)));
            offsets.push(connectivity.len() as i64);
            types.push(kind);
        }
        first += model.nodes().len() as i64;
    }
    out.integers("connectivity", connectivity);
    out.integers("offsets", offsets);
    out.bytes("types", types);
    out.line("</Cells>\n<PointData Vectors=\"displacement\">");
    point_data(&mut out, bodies);
    out.line("</PointData>\n<CellData Scalars=\"von_mises\">");
    cell_data(&mut out, bodies);
    more(&mut out);
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

fn point_data<'a>(out: &mut Document<'a>, bodies: &'a [GridBody]) {
    let displacement = |b: &GridBody| -> Vec<f64> {
        let pose = b.placed;
        let nodes = b.positions.iter().zip(b.model.nodes());
        let moved =
            nodes.map(|(x, reference)| x - (pose.rotation * reference + pose.translation.vector));
        moved.flat_map(<[f64; 3]>::from).collect()
    };
    out.floats("displacement", 3, bodies.iter().flat_map(displacement));
    if bodies.iter().all(|b| b.velocities.is_some()) {
        let velocities = bodies.iter().filter_map(|b| b.velocities).flatten();
        out.floats("velocity", 3, velocities.flat_map(|v| <[f64; 3]>::from(*v)));
    }
}

fn cell_data<'a>(out: &mut Document<'a>, bodies: &'a [GridBody]) {
    let number = |b: &GridBody| vec![b.number as i64; b.stresses.len()];
    out.integers("body", bodies.iter().flat_map(number));
    let regions = bodies.iter().flat_map(|b| b.model.region_of_tet());
    out.integers("region", regions.map(|r| i64::from(*r)));
    let stresses = || bodies.iter().flat_map(|b| b.stresses);
    out.floats("von_mises", 1, stresses().map(ElementStress::von_mises));
    out.floats("pressure", 1, stresses().map(ElementStress::pressure));
    out.floats(
        "principal_stress",
        3,
        stresses().flat_map(ElementStress::principal),
    );
    out.floats("stress", 6, stresses().flat_map(components));
    out.floats("volume_ratio", 1, stresses().map(|s| s.volume_ratio));
    let asleep = |b: &GridBody| vec![u8::from(b.is_asleep); b.stresses.len()];
    out.bytes("sleeping", bodies.iter().flat_map(asleep));
    if bodies.iter().any(|b| b.plastic_strains.is_some()) {
        let strains = |b: &GridBody| {
            let zero = || vec![0.0; b.stresses.len()];
            b.plastic_strains.map_or_else(zero, <[f64]>::to_vec)
        };
        out.floats("plastic_strain", 1, bodies.iter().flat_map(strains));
    }
}

/// The stress in VTK's order of a symmetric tensor.
fn components(stress: &ElementStress) -> [f64; 6] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|place| stress.cauchy[place])
}
