//! The extent of points.

use crate::{MeshError, Point3};

/// Diagonal of the bounding box, after checking that the arithmetic can hold the coordinates.
pub(crate) fn check_coordinates(points: &[Point3]) -> Result<f64, MeshError> {
    let not_finite = points.iter().position(|p| !p.iter().all(|x| x.is_finite()));
    if let Some(vertex) = not_finite {
        let p = points[vertex];
        return Err(MeshError::NotFinite {
            vertex,
            x: p.x,
            y: p.y,
            z: p.z,
        });
    }
    let (low, high) = bounding_box(points);
    let extent = (high - low).norm();
    if !(1e-30..=1e30).contains(&extent) {
        // Squares may have left the range of numbers: the length itself need not have.
        let longest = (high - low).amax();
        let extent = if longest > 0.0 && longest.is_finite() {
            longest * ((high - low) / longest).norm()
        } else {
            longest
        };
        return Err(MeshError::Size { extent });
    }
    let distance = low.coords.amax().max(high.coords.amax());
    if extent < 1e-9 * distance {
        return Err(MeshError::TooFarFromOrigin { extent, distance });
    }
    Ok(extent)
}

/// Lowest and highest corner of the box around points; both the origin if there are none.
pub(crate) fn bounding_box(points: &[Point3]) -> (Point3, Point3) {
    let first = points.first().copied().unwrap_or_default();
    points
        .iter()
        .fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)))
}
