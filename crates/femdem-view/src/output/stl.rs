//! Parts of a surface as binary STL.

use std::io::{self, Write};

use femdem_mesh::Point3;

/// Length of the header, which says nothing.
const HEADER: usize = 80;

/// Writes triangles as binary STL \[m\], in single precision.
///
/// # Errors
///
/// If writing fails, or for more than 2³² - 1 triangles or a coordinate beyond single precision (as
/// [`io::ErrorKind::InvalidInput`]).
pub fn write_triangles(
    triangles: impl Iterator<Item = [Point3; 3]> + Clone,
    mut writer: impl Write,
) -> io::Result<()> {
    let refuse = |text: &str| Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    let Ok(count) = u32::try_from(triangles.clone().count()) else {
        return refuse("a binary STL holds at most 4294967295 triangles");
    };
    writer.write_all(&[0; HEADER])?;
    writer.write_all(&count.to_le_bytes())?;
    for corners in triangles {
        let [a, b, c] = corners;
        let across = (b - a).cross(&(c - a));
        // A triangle without area has no normal; readers compute their own.
        let normal = across.try_normalize(0.0).unwrap_or_default();
        let numbers = normal.iter().chain(corners.iter().flat_map(|p| p.iter()));
        for number in numbers {
            let single = *number as f32;
            if !single.is_finite() {
                return refuse("a coordinate is too large for single precision");
            }
            writer.write_all(&single.to_le_bytes())?;
        }
        writer.write_all(&[0; 2])?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_analysis::Region;
    use femdem_analysis::pores::{SurfacePatch, tube_surface};

    /// A box written in parts is read back as one closed body.
    #[test]
    fn parts_make_a_body() {
        let region = Region::Box {
            min: Point3::origin(),
            max: Point3::new(1.0, 2.0, 3.0),
        };
        let surface = tube_surface(&region, [false; 3]).unwrap();
        let parts = [SurfacePatch::Sides, SurfacePatch::Low, SurfacePatch::High];
        let all: Vec<_> = parts.into_iter().flat_map(|p| surface.part(p)).collect();
        let mut bytes = Vec::new();
        write_triangles(all.iter().copied(), &mut bytes).unwrap();
        assert_eq!(bytes.len(), 84 + 50 * all.len());
        let body = femdem_mesh::io::stl::parse(&bytes).unwrap();
        assert!((body.mass_properties().volume - 6.0).abs() < 1e-6);
        let far = [[Point3::new(1e300, 0.0, 0.0); 3]];
        assert!(write_triangles(far.into_iter(), io::sink()).is_err());
    }
}
