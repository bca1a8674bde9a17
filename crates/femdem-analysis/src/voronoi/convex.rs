//! Signed distance to a convex body of few faces.

use std::collections::BTreeMap;
use std::ops::Range;

use femdem_mesh::{Point3, Polyhedron, Vector3};

/// A convex body, prepared for many questions of distance; body frame.
#[derive(Clone, Debug)]
pub(super) struct ConvexField {
    faces: Vec<Face>,
    /// In-plane outward normals of the faces' sides, and their offsets.
    sides: Vec<(Vector3, f64)>,
    edges: Vec<Edge>,
}

#[derive(Clone, Debug)]
struct Face {
    normal: Vector3,
    offset: f64,
    sides: Range<usize>,
}

#[derive(Clone, Debug)]
struct Edge {
    start: Point3,
    along: Vector3,
    /// `1 / along²`.
    scale: f64,
    faces: [usize; 2],
}

impl ConvexField {
    pub(super) fn new(shape: &Polyhedron) -> Self {
        let place = |v: u32| shape.vertices()[v as usize];
        let mut sides = Vec::new();
        let mut faces_at: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        let faces = (0..shape.face_count()).map(|k| {
            let normal = shape.face_normal(k);
            let start = sides.len();
            let corners = shape.face(k);
            for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let outward = (place(b) - place(a)).cross(&normal);
                sides.push((outward, outward.dot(&place(a).coords)));
                faces_at.entry([a.min(b), a.max(b)]).or_default().push(k);
            }
            Face {
                normal,
                offset: shape.face_offset(k),
                sides: start..sides.len(),
            }
        });
        let faces = faces.collect();
        let edge = |(ends, faces): (&[u32; 2], &Vec<usize>)| {
            let [start, end] = ends.map(place);
            let along = end - start;
            let first = faces.first().copied()?;
            Some(Edge {
                start,
                along,
                scale: 1.0 / along.norm_squared(),
                faces: [first, faces.get(1).copied().unwrap_or(first)],
            })
        };
        let edges = faces_at.iter().filter_map(edge).collect();
        Self {
            faces,
            sides,
            edges,
        }
    }

    /// Distance of `point` from the surface, below zero inside, and its gradient; `None` when it is
    /// known to be above `limit`.
    ///
    /// The largest distance from a face's plane is the distance itself inside, and a lower bound outside,
    /// which is reached when the foot lies on that face. Otherwise the nearest point is on an edge of a face that
    /// the point can see.
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
        let mut sides = self.sides[face.sides.clone()].iter();
        if sides.all(|(outward, offset)| outward.dot(&foot.coords) <= *offset) {
            return Some((height, face.normal));
        }
        let mut nearest = Vector3::repeat(f64::INFINITY);
        let mut square = f64::INFINITY;
        let sees = |edge: &&Edge| edge.faces.iter().any(|&f| memory[f] > 0.0);
        for edge in self.edges.iter().filter(sees) {
            let from_start = point - edge.start;
            let t = (from_start.dot(&edge.along) * edge.scale).clamp(0.0, 1.0);
            let apart = from_start - t * edge.along;
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

    /// Distance from a triangle by Ericson, Real-Time Collision Detection (2005), section 5.1.5: another way.
    fn brute(shape: &Polyhedron, p: &Point3) -> f64 {
        let mut least = f64::INFINITY;
        for t in shape.triangles() {
            let [a, b, c] = t.map(|v| shape.vertices()[v as usize]);
            let closest = crate::triangle::closest_point(&[a, b, c], p);
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
