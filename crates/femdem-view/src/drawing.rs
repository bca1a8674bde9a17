//! How pictures show a container: a floor and edges.

use femdem_analysis::Region;
use femdem_mesh::{Point3, Vector3};

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
