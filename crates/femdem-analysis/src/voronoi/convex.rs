//! Signed distance to a convex body of few faces.

use std::collections::BTreeMap;
use std::ops::Range;

use femdem_mesh::{Point3, Polyhedron, Vector3};

/// A convex body in the body frame, prepared for many distance queries.
#[derive(Clone, Debug)]
pub(super) struct ConvexField {
    faces: Vec<Face>,
    sides: Vec<Side>,
    edges: Vec<Edge>,
}

#[derive(Clone, Debug)]
struct Face {
    normal: Vector3,
    offset: f64,
    sides: Range<usize>,
}

/// An edge as a side of one of its faces.
#[derive(Clone, Debug)]
struct Side {
    line: Line,
    /// In-plane outward normal of the side and its offset.
    outward: Vector3,
    offset: f64,
    /// In-plane outward normal of the same edge in the face beyond it.
    beyond: Vector3,
}

#[derive(Clone, Debug)]
struct Edge {
    line: Line,
    faces: [usize; 2],
}

#[derive(Clone, Copy, Debug)]
struct Line {
    start: Point3,
    along: Vector3,
    /// `1 / along²`.
    scale: f64,
}

impl Line {
    fn new(start: Point3, end: Point3) -> Self {
        let along = end - start;
        Self {
            start,
            along,
            scale: 1.0 / along.norm_squared(),
        }
    }

    /// Position of a point's foot on the edge, 0 at the start and 1 at the end.
    fn foot(&self, point: &Point3) -> f64 {
        (point - self.start).dot(&self.along) * self.scale
    }

    /// From the position `t` on the line to a point.
    fn apart(&self, t: f64, point: &Point3) -> Vector3 {
        point - self.start - t * self.along
    }
}

impl ConvexField {
    pub(super) fn new(shape: &Polyhedron) -> Self {
        let place = |v: u32| shape.vertices()[v as usize];
        let ends = |k: usize| {
            let corners = shape.face(k);
            corners
                .iter()
                .copied()
                .zip(corners.iter().copied().cycle().skip(1))
        };
        let mut faces_at: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for k in 0..shape.face_count() {
            for (a, b) in ends(k) {
                faces_at.entry([a.min(b), a.max(b)]).or_default().push(k);
            }
        }
        let mut sides = Vec::new();
        let mut faces = Vec::new();
        for k in 0..shape.face_count() {
            let normal = shape.face_normal(k);
            let start = sides.len();
            for (a, b) in ends(k) {
                let line = Line::new(place(a), place(b));
                let outward = line.along.cross(&normal);
                let around = &faces_at[&[a.min(b), a.max(b)]];
                let other = around.iter().copied().find(|f| *f != k);
                debug_assert!(
                    other.is_some(),
                    "every edge of a closed surface has two faces"
                );
                sides.push(Side {
                    line,
                    outward,
                    offset: outward.dot(&line.start.coords),
                    beyond: -line.along.cross(&shape.face_normal(other.unwrap_or(k))),
                });
            }
            faces.push(Face {
                normal,
                offset: shape.face_offset(k),
                sides: start..sides.len(),
            });
        }
        let edge = |(ends, faces): (&[u32; 2], &Vec<usize>)| {
            debug_assert_eq!(
                faces.len(),
                2,
                "every edge of a closed surface has two faces"
            );
            Some(Edge {
                line: Line::new(place(ends[0]), place(ends[1])),
                faces: [*faces.first()?, *faces.last()?],
            })
        };
        Self {
            edges: faces_at.iter().filter_map(edge).collect(),
            faces,
            sides,
        }
    }

    /// Distance of `point` from the surface, below zero inside, and its gradient; `None` when it is
    /// known to be above `limit`.
    ///
    /// The largest distance from a face's plane is the distance itself inside, and a lower bound outside, which
    /// is attained if the foot lies on that face. Otherwise the nearest point is on an edge of a face that is
    /// visible from the point.
    pub(super) fn distance(
        &self,
        memory: &mut Vec<f64>,
        point: &Point3,
        limit: f64,
    ) -> Option<(f64, Vector3)> {
        memory.clear();
        let (mut best, mut height) = (0, f64::NEG_INFINITY);
        for (k, face) in self.faces.iter().enumerate() {
            let s = face.normal.dot(&point.coords) - face.offset;
            memory.push(s);
            if s > height {
                (best, height) = (k, s);
            }
        }
        if height > limit {
            return None;
        }
        let face = &self.faces[best];
        if height <= 0.0 {
            return Some((height, face.normal));
        }
        let foot = point - height * face.normal;
        let mut over_face = true;
        for side in &self.sides[face.sides.clone()] {
            if side.outward.dot(&foot.coords) <= side.offset {
                continue;
            }
            over_face = false;
            let t = side.line.foot(point);
            let apart = side.line.apart(t, point);
            // The foot is inside the edge and neither face is nearer: on a convex body this is the nearest
            // point.
            if t > 0.0 && t < 1.0 && apart.dot(&side.beyond) >= 0.0 {
                let distance = apart.norm();
                return (distance <= limit).then(|| (distance, apart / distance));
            }
        }
        if over_face {
            return Some((height, face.normal));
        }
        let mut nearest = Vector3::repeat(f64::INFINITY);
        let mut square = f64::INFINITY;
        let sees = |edge: &&Edge| edge.faces.iter().any(|&f| memory[f] > 0.0);
        for edge in self.edges.iter().filter(sees) {
            let t = edge.line.foot(point).clamp(0.0, 1.0);
            let apart = edge.line.apart(t, point);
            let found = apart.norm_squared();
            if found < square {
                (nearest, square) = (apart, found);
            }
        }
        let distance = square.sqrt();
        (distance <= limit).then(|| (distance, nearest / distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::catalogue::CatalogueShape;
    use proptest::prelude::*;

    /// Independent distance from a triangle, by Ericson, Real-Time Collision Detection (2005), section 5.1.5.
    fn brute(shape: &Polyhedron, p: &Point3) -> f64 {
        let mut least = f64::INFINITY;
        for t in shape.triangles() {
            let [a, b, c] = t.map(|v| shape.vertices()[v as usize]);
            let closest = femdem_mesh::closest_point(&[a, b, c], p);
            least = least.min((p - closest).norm());
        }
        least
    }

    proptest! {
        #[test]
        fn distance_is_that_of_the_nearest_triangle(
            id in prop::sample::select(vec!["P1", "P4", "P5", "A1", "A5", "A10", "A13"]),
            at in prop::array::uniform3(-1.5..1.5_f64),
        ) {
            let shape = id.parse::<CatalogueShape>().unwrap().polyhedron(2.0).unwrap();
            let point = Point3::from(at);
            let field = ConvexField::new(&shape);
            let (found, direction) = field.distance(&mut Vec::new(), &point, f64::INFINITY).unwrap();
            prop_assert!((found.abs() - brute(&shape, &point)).abs() < 1e-12);
            let outside = (0..shape.face_count())
                .any(|k| shape.face_normal(k).dot(&point.coords) > shape.face_offset(k));
            prop_assert_eq!(found > 0.0, outside);
            // A step along the gradient changes the distance by its length.
            let step = 1e-6;
            let moved = point + step * direction;
            let (further, _) = field.distance(&mut Vec::new(), &moved, f64::INFINITY).unwrap();
            prop_assert!((further - found - step).abs() < 1e-3 * step, "{} {}", found, further);
            prop_assert!(field.distance(&mut Vec::new(), &point, found - 1e-9).is_none());
        }
    }
}
