//! Winding numbers of a closed surface.

use super::distance::Triangles;
use crate::{Point3, Vector3};
use std::f64::consts::PI;

/// Groups of triangles farther away than this many of their radii are treated as one dipole: the error is of
/// the order of the inverse square, while the winding numbers to be distinguished are 0 and 1.
const FAR: f64 = 4.0;

/// A closed surface in groups of neighbouring triangles.
pub(crate) struct Winding {
    groups: Vec<Group>,
}

struct Group {
    triangles: Vec<[Point3; 3]>,
    area: Vector3,
    center: Point3,
    radius: f64,
}

impl Winding {
    /// Makes about as many groups as there are triangles in each.
    pub(crate) fn new(triangles: &Triangles) -> Self {
        let order = triangles.order();
        let size = (order.len() as f64).sqrt().ceil().max(1.0) as usize;
        let members = |group: &[u32]| {
            let corners = group.iter().map(|&i| triangles.corners[i as usize]);
            Group::new(corners.collect())
        };
        Self {
            groups: order.chunks(size).map(members).collect(),
        }
    }

    /// The solid angle of the surface over that of the sphere: 1 inside, 0 outside
    /// (A. Jacobson, L. Kavan and O. Sorkine-Hornung, ACM Trans. Graph. 32 (2013) 33). Far groups
    /// as dipoles, after G. Barill et al., ACM Trans. Graph. 37 (2018) 43.
    pub(crate) fn number(&self, p: &Point3) -> f64 {
        let angles = self.groups.iter().map(|group| group.solid_angle(p));
        angles.sum::<f64>() / (4.0 * PI)
    }
}

impl Group {
    fn new(triangles: Vec<[Point3; 3]>) -> Self {
        let mean = |t: &[Point3; 3]| (t[0].coords + t[1].coords + t[2].coords) / 3.0;
        let count = triangles.len() as f64;
        let center = Point3::from(triangles.iter().map(mean).sum::<Vector3>() / count);
        let reach = triangles.iter().flatten().map(|p| (p - center).norm());
        Self {
            radius: reach.fold(0.0, f64::max),
            area: triangles
                .iter()
                .map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)))
                .sum(),
            center,
            triangles,
        }
    }

    fn solid_angle(&self, p: &Point3) -> f64 {
        let way = self.center - p;
        let distance = way.norm();
        if distance > FAR * self.radius {
            self.area.dot(&way) / distance.powi(3)
        } else {
            self.triangles.iter().map(|t| solid_angle(t, p)).sum()
        }
    }
}

/// Signed solid angle of a triangle seen from a point; positive if seen from behind
/// (A. Van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125-126).
fn solid_angle(triangle: &[Point3; 3], p: &Point3) -> f64 {
    let [a, b, c] = triangle.map(|q| q - p);
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let numerator = a.dot(&b.cross(&c));
    let denominator = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
    2.0 * numerator.atan2(denominator)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{CatalogueShape, Solid};

    #[test]
    fn one_inside_and_zero_outside_a_ball_of_many_facets() {
        let body = CatalogueShape::from(Solid::A6).polyhedron(2.0).unwrap();
        let vertices = body.vertices();
        let corners = body.triangles();
        let corners = corners.iter().map(|t| t.map(|i| vertices[i as usize]));
        let winding = Winding::new(&Triangles::new(corners));
        // Along lines through the centre, up to the surface and beyond it.
        for face in 0..body.face_count() {
            let normal = body.face_normal(face);
            let depth = body.face_offset(face);
            for part in [0.0, 0.5, 0.99, 0.999_999, 1.000_001, 1.01, 1.5, 4.0, 1e3] {
                let number = winding.number(&Point3::from(normal * depth * part));
                let expected = if part < 1.0 { 1.0 } else { 0.0 };
                assert!((number - expected).abs() < 0.02, "{face} {part}: {number}");
            }
        }
    }
}
