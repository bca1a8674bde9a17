//! Local packing density for ParaView: a regular grid of cells as image data.
//!
//! Cell data: `density` (1), `volume` (of the cell's part in the region, m³).

use std::io::{self, Write};

use femdem_analysis::DensityMap;

use super::vtk::Document;

/// Writes a density map.
///
/// # Errors
///
/// If writing fails.
pub fn write(map: &DensityMap, writer: impl Write) -> io::Result<()> {
    let [nx, ny, nz] = map.counts;
    let extent = format!("0 {nx} 0 {ny} 0 {nz}");
    let words = |numbers: [f64; 3]| numbers.map(|x| x.to_string()).join(" ");
    let attributes = format!(
        " WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\"",
        words(map.origin.into()),
        words(map.spacing)
    );
    let mut out = Document::new("ImageData").with_attributes(attributes);
    out.line(&format!(
        "<Piece Extent=\"{extent}\">\n<CellData Scalars=\"density\">"
    ));
    out.floats("density", 1, map.densities.iter().copied());
    out.floats("volume", 1, map.volumes.iter().copied());
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Body;
    use crate::testing::two_cubes;
    use femdem_analysis::{DensityMapOptions, Pack, PosedBody, density_map};

    #[test]
    fn cells_and_extent_agree() {
        let snapshot = two_cubes();
        let shapes = [snapshot.shapes[0].polyhedron.clone()];
        let posed = |b: &Body| PosedBody {
            shape: b.shape,
            pose: b.pose,
        };
        let bodies: Vec<_> = snapshot.bodies.iter().map(posed).collect();
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let container = snapshot.container.unwrap();
        let map = density_map(&pack, &container, &DensityMapOptions::default()).unwrap();
        let mut bytes = Vec::new();
        write(&map, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let cells: usize = map.counts.iter().product();
        assert_eq!(map.densities.len(), cells);
        let [nx, ny, nz] = map.counts;
        assert!(text.contains(&format!("<Piece Extent=\"0 {nx} 0 {ny} 0 {nz}\">")));
        assert!(text.contains("<ImageData WholeExtent=") && text.contains("Origin=\"-1 -1 0\""));
        // Eight bytes of length before the numbers, in base64.
        let coded = (8 + 8 * cells).div_ceil(3) * 4;
        assert!(text.contains(&format!(
            "Name=\"volume\" NumberOfComponents=\"1\" format=\"appended\" offset=\"{coded}\""
        )));
    }
}
