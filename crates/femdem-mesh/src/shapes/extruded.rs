//! Prisms: cylinder, hollow cylinder, pellet with several holes, lobed extrudate.

use super::family::family;
use super::planar::{Point2, triangulate};
use super::weld::surface;
use crate::{MeshError, Point3, Polyhedron};
use std::f64::consts::{PI, TAU};

family! {
    /// A circular cylinder along z, as a prism with its vertices on the circle.
    ///
    /// The section has `sin(t)/t` of the circle's area, t = 2 pi / `sides`: 0.64 % less for 32 sides.
    Cylinder = "cylinder", "circular cylinder along z", size: "the diameter" {
        /// Height over diameter.
        aspect: f64 = 1.0, in 0.02, 50.0;
        /// Sides of the polygon that stands for the circle.
        sides: u32 = 32, in 3, 256;
    }
}

family! {
    /// A hollow cylinder along z (Raschig ring), as a prism with its vertices on the two circles.
    HollowCylinder = "hollow_cylinder", "hollow cylinder along z (Raschig ring)", size: "the outer diameter" {
        /// Height over outer diameter.
        aspect: f64 = 1.0, in 0.02, 50.0;
        /// Inner over outer diameter.
        bore: f64 = 0.5, in 0.05, 0.95;
        /// Sides of each of the two polygons.
        sides: u32 = 32, in 6, 256;
    }
}

family! {
    /// A catalyst pellet: a cylinder along z with `holes` holes on a circle, and one in the middle
    /// if `centre` is true.
    ///
    /// Walls must be at least 1 % of the diameter thick. The body has the symmetry of its holes if
    /// `sides` is a multiple of their number.
    Pellet = "pellet", "catalyst pellet: cylinder along z with several holes", size: "the outer diameter" {
        /// Height over diameter.
        aspect: f64 = 1.0, in 0.02, 50.0;
        /// Number of holes on the circle.
        holes: u32 = 6, in 2, 18;
        /// Diameter of a hole over that of the pellet.
        hole: f64 = 0.18, in 0.02, 0.45;
        /// Diameter of the circle of the holes' axes over that of the pellet.
        pitch: f64 = 0.6, in 0.05, 0.95;
        /// Whether there is a hole in the middle, too.
        centre: bool = true, in false, true;
        /// Sides of the outer polygon.
        sides: u32 = 36, in 6, 144;
        /// Sides of the polygon of each hole.
        hole_sides: u32 = 12, in 4, 48;
    }
}

family! {
    /// A lobed extrudate along z: the union of equal cylinders around the axis and of the prism
    /// between their axes. Three lobes make a trilobe, four a quadrilobe.
    ///
    /// Neighbouring lobes overlap; they would touch at a `spacing` of 1.
    Lobed = "lobed", "lobed extrudate along z (trilobe, quadrilobe)", size: "the diameter of the circumscribed circle" {
        /// Number of lobes.
        lobes: u32 = 3, in 2, 8;
        /// Distance of the axes of neighbouring lobes over the diameter of a lobe.
        spacing: f64 = 0.85, in 0.3, 0.97;
        /// Height over the diameter of the circumscribed circle.
        aspect: f64 = 2.0, in 0.02, 50.0;
        /// Facets of the arc of each lobe.
        segments: u32 = 12, in 3, 64;
    }
}

/// A polygon on a circle, counter-clockwise, the first vertex in the direction `start` \[rad\].
fn circle(centre: Point2, radius: f64, sides: u32, start: f64) -> Vec<Point2> {
    (0..sides)
        .map(|i| {
            let (sin, cos) = (start + TAU * f64::from(i) / f64::from(sides)).sin_cos();
            Point2 {
                x: centre.x + radius * cos,
                y: centre.y + radius * sin,
            }
        })
        .collect()
}

const ORIGIN: Point2 = Point2 { x: 0.0, y: 0.0 };

/// Faces between two loops of corresponding points, the upper one above a counter-clockwise lower
/// one.
pub(super) fn band(lower: &[Point3], upper: &[Point3]) -> Vec<Vec<Point3>> {
    (0..lower.len())
        .map(|i| {
            let j = (i + 1) % lower.len();
            vec![lower[i], lower[j], upper[j], upper[i]]
        })
        .collect()
}

/// The prism of height `height` about z = 0 over the region inside `outer` (counter-clockwise) and
/// outside the `holes` (counter-clockwise, too). Caps that are convex are single faces.
fn prism(
    outer: &[Point2],
    holes: &[Vec<Point2>],
    convex: bool,
    height: f64,
) -> Result<Polyhedron, MeshError> {
    let raised = |points: &[Point2], z: f64| -> Vec<Point3> {
        points.iter().map(|p| Point3::new(p.x, p.y, z)).collect()
    };
    let clockwise: Vec<Vec<Point2>> = holes
        .iter()
        .map(|hole| hole.iter().rev().copied().collect())
        .collect();
    let mut polygons = Vec::new();
    for points in [outer]
        .into_iter()
        .chain(clockwise.iter().map(Vec::as_slice))
    {
        polygons.extend(band(
            &raised(points, -0.5 * height),
            &raised(points, 0.5 * height),
        ));
    }
    let flat: Vec<Point2> = outer
        .iter()
        .chain(clockwise.iter().flatten())
        .copied()
        .collect();
    let cap: Vec<Vec<usize>> = if convex {
        vec![(0..outer.len()).collect()]
    } else {
        triangulate(outer, &clockwise)?
            .iter()
            .map(|t| t.to_vec())
            .collect()
    };
    for face in cap {
        let corners: Vec<Point2> = face.iter().map(|&i| flat[i]).collect();
        polygons.push(raised(&corners, 0.5 * height));
        polygons.push(raised(&corners, -0.5 * height).into_iter().rev().collect());
    }
    surface(&polygons)
}

impl Cylinder {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        prism(
            &circle(ORIGIN, 0.5, self.sides, 0.0),
            &[],
            true,
            self.aspect,
        )
    }
}

impl HollowCylinder {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let outer = circle(ORIGIN, 0.5, self.sides, 0.0);
        let inner = circle(ORIGIN, 0.5 * self.bore, self.sides, 0.0);
        prism(&outer, &[inner], false, self.aspect)
    }
}

impl Pellet {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let radius = 0.5 * self.hole;
        let pitch_radius = 0.5 * self.pitch;
        let sector = TAU / f64::from(self.holes);
        let inner_wall = if self.centre {
            pitch_radius - 2.0 * radius
        } else {
            0.5
        };
        let walls = [
            (
                "the wall between the holes and the outside of a pellet, over its diameter",
                0.5 * (PI / f64::from(self.sides)).cos() - pitch_radius - radius,
            ),
            (
                "the wall between neighbouring holes of a pellet, over its diameter",
                2.0 * pitch_radius * (0.5 * sector).sin() - 2.0 * radius,
            ),
            (
                "the wall between the middle hole of a pellet and the others, over its diameter",
                inner_wall,
            ),
        ];
        for (what, value) in walls {
            if value < 0.01 {
                return Err(MeshError::OutOfRange {
                    what,
                    value,
                    allowed: "at least 0.01: change hole, pitch or the number of holes",
                });
            }
        }
        let mut holes: Vec<Vec<Point2>> = (0..self.holes)
            .map(|i| {
                let direction = sector * f64::from(i);
                let (sin, cos) = direction.sin_cos();
                let centre = Point2 {
                    x: pitch_radius * cos,
                    y: pitch_radius * sin,
                };
                circle(centre, radius, self.hole_sides, direction)
            })
            .collect();
        if self.centre {
            holes.push(circle(ORIGIN, radius, self.hole_sides, 0.0));
        }
        prism(
            &circle(ORIGIN, 0.5, self.sides, 0.0),
            &holes,
            false,
            self.aspect,
        )
    }
}

impl Lobed {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let half_sector = PI / f64::from(self.lobes);
        let radius = 0.5 / (1.0 + self.spacing / half_sector.sin());
        let centre = 0.5 - radius;
        // Where neighbouring lobes meet, in the direction of the bisector.
        let half_distance = self.spacing * radius;
        let meeting =
            centre * half_sector.cos() + (radius * radius - half_distance * half_distance).sqrt();
        let end = (meeting * half_sector.sin()).atan2(meeting * half_sector.cos() - centre);
        let mut outline = Vec::new();
        for lobe in 0..self.lobes {
            let direction = 2.0 * half_sector * f64::from(lobe);
            let (sin, cos) = direction.sin_cos();
            // The end of each arc is the start of the next.
            for i in 0..self.segments {
                let angle = end * (2.0 * f64::from(i) / f64::from(self.segments) - 1.0);
                let along = centre + radius * angle.cos();
                let across = radius * angle.sin();
                outline.push(Point2 {
                    x: along * cos - across * sin,
                    y: along * sin + across * cos,
                });
            }
        }
        prism(&outline, &[], false, self.aspect)
    }
}
