//! Regular grids of cells for ParaView, as image data: local packing density, and voxels of the void space.
//!
//! Cell data of a density map: `density` (1), `volume` (of the cell's part in the region, m³). Of coarse-grained
//! fields: those of [`Fields`] by their names, tensors with nine components by rows ([`write_continuum`]). Of voxels:
//! `label` ([`write_labels`]), or fields by their names ([`write_fields`]).

use std::io::{self, Write};

use femdem_analysis::pores::{VoxelGrid, VoxelImage};
use femdem_analysis::{DensityMap, Fields, Tensor};

use super::vtk::Document;

/// Writes a density map.
///
/// # Errors
///
/// If writing fails.
pub fn write(map: &DensityMap, writer: impl Write) -> io::Result<()> {
    let grid = VoxelGrid {
        origin: map.origin,
        spacing: map.spacing,
        counts: map.counts,
    };
    let mut out = begun(&grid, "density");
    out.floats("density", 1, map.densities.iter().copied());
    out.floats("volume", 1, map.volumes.iter().copied());
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

/// Writes coarse-grained fields; those that are not known or empty are left out.
///
/// # Errors
///
/// If writing fails.
pub fn write_continuum(fields: &Fields, writer: impl Write) -> io::Result<()> {
    let grid = VoxelGrid {
        origin: fields.origin,
        spacing: [fields.spacing; 3],
        counts: fields.counts,
    };
    let mut out = begun(&grid, "solid_fraction");
    out.floats("solid_fraction", 1, fields.solid_fraction.iter().copied());
    if let Some(density) = &fields.density {
        out.floats("density", 1, density.iter().copied());
    }
    let vectors = [
        ("momentum", &fields.momentum),
        ("velocity", &fields.velocity),
    ];
    for (name, vectors) in vectors {
        if let Some(vectors) = vectors {
            out.floats(name, 3, vectors.iter().flatten().copied());
        }
    }
    let tensors: [(&str, &[Tensor]); 3] = [
        (
            "kinetic_stress",
            fields.kinetic_stress.as_deref().unwrap_or(&[]),
        ),
        ("contact_stress", &fields.contact_stress),
        ("fabric", &fields.fabric),
    ];
    for (name, tensors) in tensors.into_iter().filter(|(_, list)| !list.is_empty()) {
        out.floats(name, 9, tensors.iter().flatten().copied());
    }
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

/// Writes the labels of a voxel image: 0 in the void, the number of the body plus 1, 4294967295 outside a round
/// region.
///
/// # Errors
///
/// If writing fails.
pub fn write_labels(image: &VoxelImage, writer: impl Write) -> io::Result<()> {
    let mut out = begun(&image.grid, "label");
    out.counts("label", image.labels.iter().copied());
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

/// Writes fields over voxels, in single precision; infinite values as -1.
///
/// # Errors
///
/// If writing fails, or a field has another length than the grid (as [`io::ErrorKind::InvalidInput`]).
pub fn write_fields(
    grid: &VoxelGrid,
    fields: &[(&str, &[f64])],
    writer: impl Write,
) -> io::Result<()> {
    let mut out = begun(grid, fields.first().map_or("", |field| field.0));
    for (name, values) in fields {
        if values.len() != grid.len() {
            let text = format!(
                "{} values of {name} for {} voxels",
                values.len(),
                grid.len()
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
        }
        let single = |x: &f64| if x.is_finite() { *x as f32 } else { -1.0 };
        out.singles(name, values.iter().map(single));
    }
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

/// A document up to its first array of cell data.
fn begun<'a>(grid: &VoxelGrid, scalars: &str) -> Document<'a> {
    let [nx, ny, nz] = grid.counts;
    let extent = format!("0 {nx} 0 {ny} 0 {nz}");
    let words = |numbers: [f64; 3]| numbers.map(|x| x.to_string()).join(" ");
    let attributes = format!(
        " WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\"",
        words(grid.origin.into()),
        words(grid.spacing)
    );
    let mut out = Document::new("ImageData").with_attributes(attributes);
    out.line(&format!(
        "<Piece Extent=\"{extent}\">\n<CellData Scalars=\"{scalars}\">"
    ));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::testing::two_cubes;
    use femdem_analysis::{DensityMapOptions, Pack, density_map};
    use femdem_mesh::Point3;

    #[test]
    fn cells_and_extent_agree() {
        let snapshot = two_cubes();
        let (shapes, bodies) = snapshot.posed();
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

    #[test]
    fn fields_are_as_long_as_the_grid() {
        let grid = VoxelGrid {
            origin: Point3::origin(),
            spacing: [0.5; 3],
            counts: [2, 1, 1],
        };
        let mut bytes = Vec::new();
        write_fields(&grid, &[("depth", &[0.5, f64::INFINITY])], &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains("type=\"Float32\" Name=\"depth\""));
        // 8 as 64 bits, 0.5 and -1.
        assert!(text.contains("_CAAAAAAAAAAAAAA/AACAvw==\n"), "{text}");
        assert!(write_fields(&grid, &[("depth", &[0.5])], std::io::sink()).is_err());
    }
}
