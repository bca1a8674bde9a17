//! Convex hulls with polygon faces.

mod quickhull;

use crate::polyhedron::check_coordinates;
use crate::{MeshError, Point3, Polyhedron, merge};

/// Features smaller than this part of the bounding box's diagonal are not resolved.
const RESOLUTION: f64 = 1e-9;

/// The convex hull of points \[m\], with coplanar triangles merged into polygon faces.
///
/// Vertices keep the order of the points; loops start at their first vertex, and faces are sorted by their
/// loops. Points within 1e-9 of the bounding box's diagonal (plus the rounding of the coordinates) from the
/// hull of the others may be left out, so that points on a face or an edge do not become vertices. If the faces
/// are not clean then, 1e-8 and 1e-7 are tried. Orientation is decided by exact predicates (J. R. Shewchuk,
/// Discrete Comput. Geom. 18 (1997) 305-363, through the `robust` crate), in a quickhull after Barber, Dobkin
/// and Huhdanpaa (ACM Trans. Math. Softw. 22 (1996) 469-483).
///
/// # Errors
///
/// If there are fewer than four points, a coordinate is not finite, the points span no volume, or they are too small, too large or
/// too far from the origin for the arithmetic.
pub fn convex_hull(points: &[Point3]) -> Result<Polyhedron, MeshError> {
    if points.len() < 4 {
        return Err(MeshError::TooFewPoints {
            points: points.len(),
        });
    }
    if u32::try_from(points.len()).is_err() {
        return Err(MeshError::TooMany {
            what: "points",
            count: points.len(),
            allowed: u32::MAX as usize,
        });
    }
    let extent = check_coordinates(points).map_err(|problem| match problem {
        MeshError::Size { extent: 0.0 } => MeshError::FlatPoints {
            points: points.len(),
            span: "coincide",
            tolerance: 0.0,
        },
        other => other,
    })?;
    let largest = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let resolution = RESOLUTION * extent + 2.0 * f64::EPSILON * largest;

    // A coarser resolution clears up features that lie just at the limit of a finer one.
    for factor in [1.0, 10.0, 100.0] {
        let tolerance = factor * resolution;
        let triangles = quickhull::triangles(points, tolerance)?;
        let clean = merge::merge_coplanar(points, &triangles, tolerance).and_then(
            |(vertices, mut faces)| {
                // The order of the triangles depends on the search; that of sorted loops does not.
                faces.sort_unstable();
                Polyhedron::new(vertices, faces)
            },
        );
        if let Ok(hull) = clean
            && hull.is_convex()
        {
            return Ok(hull);
        }
    }
    Err(MeshError::HullUnresolved {
        points: points.len(),
        tolerance: 100.0 * resolution,
    })
}

#[cfg(test)]
mod tests;
