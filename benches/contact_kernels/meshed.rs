//! The general kernel on bodies that are not convex, and its cost per pair of tetrahedra.

use femdem::contact::general::GeneralScratch;
use femdem::contact::{Field, FieldMesh, GeneralKernel};
use femdem::mesh::shapes::Shape;
use femdem::mesh::tet::{MeshOptions, mesh};
use femdem_benches::{DIAMETER, SetUpError, solid};

use super::pairs::{Convex, PENALTY, Pair, approached, counts, general_kernels};
use super::{fastest, print, row};

const PAIRS: u32 = 60;

fn body(name: &str) -> Result<FieldMesh, SetUpError> {
    let surface = name.parse::<Shape>()?.polyhedron(DIAMETER)?;
    let (tets, _) = mesh(&surface, &MeshOptions::default())?;
    let centroid = surface.mass_properties().centroid.coords;
    Ok(FieldMesh::new(&tets, centroid, Field::Body)?)
}

/// Touching pairs of a meshed body.
fn pairs(mesh: &FieldMesh) -> Result<Vec<Pair>, SetUpError> {
    let kernel = GeneralKernel::new(PENALTY)?;
    let touch = |[a, b]: &Pair| {
        let mut scratch = GeneralScratch::default();
        !kernel.evaluate(mesh, a, mesh, b, &mut scratch).is_empty()
    };
    Ok(approached(touch, mesh.radius(), PAIRS))
}

pub fn table(turns: u32) -> Result<(), SetUpError> {
    let (mut names, mut rows) = (Vec::new(), Vec::new());
    for name in ["tetrapod", "dolos", "hollow_cylinder", "P5", "A10"] {
        let mesh = match solid(name) {
            Ok(convex) => Convex::new(&convex)?.fan,
            Err(_) => body(name)?,
        };
        let pairs = pairs(&mesh)?;
        let [candidates, pieces] = counts(&mesh, &pairs)?;
        let mut kernels = general_kernels(&mesh, &pairs)?;
        names = kernels.iter().map(|k| k.name).collect();
        let times = fastest(&mut kernels, turns);
        let mut cells = row(name, &times);
        cells.insert(1, mesh.tet_count().to_string());
        cells.insert(2, format!("{candidates:.1}"));
        cells.insert(3, format!("{pieces:.1}"));
        cells.extend([candidates, pieces].map(|n| format!("{:.0}", times[0] / n)));
        rows.push(cells);
    }
    let head = [
        "shape",
        "tetrahedra",
        "candidates per pair",
        "overlaps per pair",
    ];
    let tail = ["warm, per candidate", "warm, per overlap"];
    let columns: Vec<&str> = head.into_iter().chain(names).chain(tail).collect();
    print(
        "ns per touching pair of meshes, 0.3 % deep:",
        &columns,
        &rows,
    );
    Ok(())
}
