//! How pictures show a container: a floor and edges.

use femdem_analysis::Region;
use femdem_mesh::{Point3, Vector3};

/// Cosine of the smallest angle between faces of a surface whose edge is drawn.
const SHARP: f64 = 0.9;

/// Number of corners of the polygon that approximates a circle.
const CIRCLE_SIDES: usize = 96;

/// Azimuth of the eye in pictures, to the right of the front, where no other is asked for, degrees.
pub(crate) const AZIMUTH: f64 = 24.0;

/// The drawing of a container in a picture.
///
/// ```
/// use femdem_mesh::Point3;
/// use femdem_view::Drawing;
/// use femdem_view::analysis::Region;
///
/// // A tube up to 1 m: its floor, and rings and lines along its wall.
/// let tube = Region::Cylinder { centre: [0.0; 2], radius: 0.5, z_min: 0.0, z_max: 4.0 };
/// let drawing = Drawing::of_region(&tube, 1.0);
/// assert!(drawing.floor.iter().all(|p| p.z == 0.0 && (p - Point3::origin()).norm() < 0.5 + 1e-12));
/// assert!(drawing.lines.iter().flatten().all(|p| p.z <= 1.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The floor: corners of a convex polygon, counter-clockwise seen from above \[m\].
    pub floor: Vec<Point3>,
    /// The edges \[m\].
    pub lines: Vec<[Point3; 2]>,
}

impl Drawing {
    /// The drawing of an upright container up to the height `top` \[m\], for the usual point of view.
    #[must_use]
    pub fn of_region(container: &Region, top: f64) -> Self {
        Self::seen_from(AZIMUTH.to_radians(), container, top)
    }

    /// The same, for an eye at `azimuth` (radians).
    pub(crate) fn seen_from(azimuth: f64, container: &Region, top: f64) -> Self {
        let (floor, posts) = match *container {
            Region::Box { min, max } => {
                let corners = [
                    [min.x, min.y],
                    [max.x, min.y],
                    [max.x, max.y],
                    [min.x, max.y],
                ];
                let floor = corners.map(|[x, y]| Point3::new(x, y, min.z)).to_vec();
                (floor, vec![0, 1, 2, 3])
            }
            // The first corner is the one at the right edge as seen, so that the posts stand there.
            Region::Cylinder {
                centre: [x, y],
                radius,
                z_min,
                ..
            } => (
                circle(Point3::new(x, y, z_min), radius, azimuth),
                vec![0, CIRCLE_SIDES / 2],
            ),
            // Its circle on the ground; there are no posts.
            Region::Sphere { centre, radius } => {
                let lowest = Point3::new(centre.x, centre.y, centre.z - radius);
                (circle(lowest, radius, azimuth), Vec::new())
            }
        };
        let rim: Vec<Point3> = floor.iter().map(|p| Point3::new(p.x, p.y, top)).collect();
        let posts = posts.into_iter().map(|i| [floor[i], rim[i]]);
        Self {
            lines: posts.chain(sides(&floor)).chain(sides(&rim)).collect(),
            floor,
        }
    }
}

/// Corners of a horizontal circle about the z axis of `centre`, counter-clockwise from above; the first
/// is in the direction `from` (radians).
#[must_use]
pub fn circle(centre: Point3, radius: f64, from: f64) -> Vec<Point3> {
    (0..CIRCLE_SIDES)
        .map(|k| {
            let (sin, cos) =
                (std::f64::consts::TAU * k as f64 / CIRCLE_SIDES as f64 + from).sin_cos();
            centre + radius * Vector3::new(cos, sin, 0.0)
        })
        .collect()
}

/// The sides of a closed polygon, as lines of a [`Drawing`].
pub fn sides(polygon: &[Point3]) -> impl Iterator<Item = [Point3; 2]> {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| [*a, *b])
}

/// The edges of a closed surface at which its faces meet at 26 degrees or more, as lines of a [`Drawing`]. Triangles are of
/// the points' numbers; those with a number beyond the points have no edges.
///
/// ```
/// use femdem_mesh::{TetMesh, Vector3};
/// use femdem_view::sharp_edges;
///
/// let block = TetMesh::block([2, 1, 1], &Vector3::new(2.0, 1.0, 1.0))?;
/// // Those along x have two parts.
/// assert_eq!(sharp_edges(block.points(), block.skin()).len(), 16);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[must_use]
pub fn sharp_edges(points: &[Point3], triangles: &[[u32; 3]]) -> Vec<[Point3; 2]> {
    let mut edges: Vec<([u32; 2], Vector3)> = Vec::new();
    for corners in triangles {
        let [Some(a), Some(b), Some(c)] = corners.map(|i| points.get(i as usize)) else {
            continue;
        };
        let normal = (b - a).cross(&(c - a)).normalize();
        let next = corners.iter().cycle().skip(1);
        let edge = |(a, b): (&u32, &u32)| ([*a.min(b), *a.max(b)], normal);
        edges.extend(corners.iter().zip(next).map(edge));
    }
    // A stable order: the two faces of an edge come one after the other.
    edges.sort_by_key(|(edge, _)| *edge);
    let is_sharp = |pair: &&[([u32; 2], Vector3)]| pair[0].1.dot(&pair[1].1) < SHARP;
    let both = edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|same| same.len() == 2);
    let line = |pair: &[([u32; 2], Vector3)]| pair[0].0.map(|i| points[i as usize]);
    both.filter(is_sharp).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    #[test]
    fn outline_of_a_box_has_12_lines_and_stops_at_the_top() {
        let container = two_cubes().container.unwrap();
        let outline = Drawing::seen_from(0.0, &container, 2.0);
        assert_eq!((outline.floor.len(), outline.lines.len()), (4, 12));
        assert!(
            outline
                .lines
                .iter()
                .flatten()
                .all(|p| p.z == 0.0 || p.z == 2.0)
        );
    }
}
