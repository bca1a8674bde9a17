//! Where two bodies are bonded.

use crate::axes::complete;
use crate::error::{ContactError, check};
use femdem_mesh::Vector3;
use std::f64::consts::PI;

/// Corners of the polygon that stands for a disc: its second moment is 0.8 % above the disc's.
const CORNERS: u32 = 6;

/// Largest distance of a corner from the plane, over the size.
const FLAT: f64 = 1e-6;

/// A flat polygon, with a normal from body A to body B, in world coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct BondSection {
    corners: Vec<Vector3>,
    centre: Vector3,
    normal: Vector3,
    area: f64,
}

impl BondSection {
    /// A polygon by its corners (m) in order, either way round, whose normal is on the side of `towards`: the direction from body
    /// A to body B.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] for fewer than three corners, corners that are not finite or not in a plane to 1e-6 of its
    /// size, and where the triangles from the centroid to the edges are not all positive: the polygon must be convex, or nearly
    /// so.
    pub fn polygon(corners: &[Vector3], towards: Vector3) -> Result<Self, ContactError> {
        let count = corners.len();
        let allowed = "3 or more";
        check(
            "number of corners of a bond",
            count as f64,
            count >= 3,
            allowed,
        )?;
        let pairs = || (0..count).map(|i| (corners[i], corners[(i + 1) % count]));
        let first = corners[0];
        let double: Vector3 = pairs().map(|(p, q)| (p - first).cross(&(q - first))).sum();
        let unit = double.try_normalize(0.0);
        let size = double.norm().sqrt();
        let area = 0.5 * double.norm();
        let turned = unit.map_or(0.0, |n| n.dot(&towards));
        let allowed =
            "above 0 and finite, in m^2, and its normal not across the direction from A to B";
        check(
            "area of a bond",
            area,
            area > 0.0 && turned.abs() > 0.0 && turned.is_finite(),
            allowed,
        )?;
        let normal = unit.unwrap_or_default();
        let off = corners.iter().map(|p| normal.dot(&(p - first)).abs());
        let off = off.fold(0.0, f64::max) / size;
        let allowed = "at most 1e-6 of its size: give a flat polygon";
        check(
            "distance of corners of a bond from its plane",
            off,
            off <= FLAT,
            allowed,
        )?;
        let third = |(p, q): (Vector3, Vector3)| {
            let part = normal.dot(&(p - first).cross(&(q - first)));
            (p + q - 2.0 * first) * part
        };
        let centre = first + pairs().map(third).sum::<Vector3>() / (6.0 * area);
        let least = pairs()
            .map(|(p, q)| normal.dot(&(p - centre).cross(&(q - centre))))
            .fold(f64::INFINITY, f64::min);
        let allowed = "above 0: give the corners in order, of a convex polygon, each once";
        check(
            "smallest triangle of a bond, over its area",
            least / (2.0 * area),
            least > 1e-12 * area,
            allowed,
        )?;
        let mut corners = corners.to_vec();
        if turned < 0.0 {
            corners.reverse();
        }
        Ok(Self {
            corners,
            centre,
            normal: normal * turned.signum(),
            area,
        })
    }

    /// A disc, as a hexagon of its exact area.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] for a radius that is not positive and a normal of length 0.
    pub fn disc(centre: Vector3, normal: Vector3, radius: f64) -> Result<Self, ContactError> {
        check(
            "radius of a bond",
            radius,
            radius > 0.0,
            "above 0 and finite, in m",
        )?;
        let length = normal.norm();
        check(
            "length of the normal of a bond",
            length,
            length > 0.0,
            "above 0 and finite",
        )?;
        let [_, one, two] = complete(&(normal / length));
        let part = 2.0 * PI / f64::from(CORNERS);
        // n/2 r^2 sin(2 pi/n) is the area of a regular n-gon.
        let reach = radius * (part / part.sin()).sqrt();
        let corner = |i: u32| {
            let (sin, cos) = (part * f64::from(i)).sin_cos();
            centre + (one * cos + two * sin) * reach
        };
        let corners: Vec<Vector3> = (0..CORNERS).map(corner).collect();
        Self::polygon(&corners, normal)
    }

    /// Its corners, counter-clockwise seen from body B, m.
    #[must_use]
    pub fn corners(&self) -> &[Vector3] {
        &self.corners
    }

    /// Its centroid, m.
    #[must_use]
    pub fn centre(&self) -> Vector3 {
        self.centre
    }

    /// Unit normal from A to B.
    #[must_use]
    pub fn normal(&self) -> Vector3 {
        self.normal
    }

    /// Area, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The middles of the edges of the triangles from the centroid to the edges of the polygon, counter-clockwise from B, and
    /// the areas of the triangles.
    pub(super) fn triangles(&self) -> impl Iterator<Item = ([Vector3; 3], f64)> {
        let count = self.corners.len();
        (0..count).map(move |i| {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % count]);
            let area = 0.5 * (p - self.centre).cross(&(q - self.centre)).norm();
            let middle = |x: &Vector3, y: &Vector3| (x + y) * 0.5;
            let points = [
                middle(&self.centre, &p),
                middle(&p, &q),
                middle(&q, &self.centre),
            ];
            (points, area)
        })
    }
}
