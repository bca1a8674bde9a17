//! Voxel images as plain numbers with a text header (MetaImage): read by ITK, ParaView, Fiji and any script.

use std::io::{self, Write};

use femdem_analysis::pores::{OUTSIDE, VOID, VoxelImage};

/// What is written for each voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Voxels {
    /// The label, as an unsigned 32-bit integer, little endian.
    Labels,
    /// One byte: 0 in the void, 1 in a body, 2 outside a round region.
    Phases,
}

/// Writes the header of an image whose numbers are in the file `numbers` beside it.
///
/// # Errors
///
/// If writing fails.
pub fn write_header(
    image: &VoxelImage,
    voxels: Voxels,
    numbers: &str,
    mut writer: impl Write,
) -> io::Result<()> {
    let grid = &image.grid;
    let spacing = grid.spacing.map(|x| x.to_string()).join(" ");
    let counts = grid.counts.map(|n| n.to_string()).join(" ");
    // MetaImage places the centre of the first voxel.
    let first: [f64; 3] = grid.centre([0; 3]).into();
    let offset = first.map(|x| x.to_string()).join(" ");
    let kind = match voxels {
        Voxels::Labels => "MET_UINT",
        Voxels::Phases => "MET_UCHAR",
    };
    write!(
        writer,
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n\
         CompressedData = False\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = {offset}\n\
         CenterOfRotation = 0 0 0\nElementSpacing = {spacing}\nDimSize = {counts}\n\
         ElementType = {kind}\nElementDataFile = {numbers}\n"
    )
}

/// Writes the numbers: x runs fastest, then y, then z.
///
/// # Errors
///
/// If writing fails.
pub fn write_numbers(image: &VoxelImage, voxels: Voxels, mut writer: impl Write) -> io::Result<()> {
    for label in &image.labels {
        match voxels {
            Voxels::Labels => writer.write_all(&label.to_le_bytes())?,
            Voxels::Phases => writer.write_all(&[match *label {
                VOID => 0,
                OUTSIDE => 2,
                _ => 1,
            }])?,
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_analysis::Region;
    use femdem_analysis::pores::VoxelGrid;
    use femdem_mesh::Point3;

    #[test]
    fn header_and_numbers_agree() {
        let image = VoxelImage {
            region: Region::Box {
                min: Point3::origin(),
                max: Point3::new(3.0, 0.5, 0.5),
            },
            grid: VoxelGrid {
                origin: Point3::origin(),
                spacing: [1.0, 0.5, 0.5],
                counts: [3, 1, 1],
            },
            repeats: [false; 3],
            labels: vec![VOID, 258, OUTSIDE],
        };
        let mut header = Vec::new();
        write_header(&image, Voxels::Labels, "a.raw", &mut header).unwrap();
        let header = String::from_utf8(header).unwrap();
        for line in [
            "DimSize = 3 1 1",
            "ElementSpacing = 1 0.5 0.5",
            "Offset = 0.5 0.25 0.25",
            "ElementType = MET_UINT",
            "ElementDataFile = a.raw",
        ] {
            assert!(header.lines().any(|l| l == line), "{line}: {header}");
        }
        let mut bytes = Vec::new();
        write_numbers(&image, Voxels::Labels, &mut bytes).unwrap();
        assert_eq!(bytes, [0, 0, 0, 0, 2, 1, 0, 0, 255, 255, 255, 255]);
        let mut bytes = Vec::new();
        write_numbers(&image, Voxels::Phases, &mut bytes).unwrap();
        assert_eq!(bytes, [0, 1, 2]);
    }
}
