//! The drawn objects: the bodies' surfaces as coloured triangles, and the floor.

use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

use super::colour::{Light, Srgb, viridis};
use crate::{BodyValues, Snapshot};

/// Bodies without a value.
pub(super) const UNKNOWN: Srgb = Srgb([0x96; 3]);

const FLOOR: Srgb = Srgb([0xef, 0xee, 0xea]);

/// A flat piece of surface of one colour.
#[derive(Clone, Copy)]
pub(super) struct Facet {
    pub normal: Vector3,
    pub colour: Light,
    /// The body it belongs to; `None` for the floor.
    pub body: Option<u32>,
}

/// A triangle of a facet.
#[derive(Clone, Copy)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    pub facet: u32,
}

/// Triangles with shared points. Bodies are kept as shapes with poses, not point by point.
#[derive(Default)]
pub(super) struct Mesh<'a> {
    shapes: Vec<Surface<'a>>,
    bodies: Vec<Placed>,
    /// Everything that is not a body; its facets are numbered after those of the bodies.
    pub rest: Rest,
    /// Facets of the bodies.
    placed: u32,
}

/// Triangles that are listed one by one.
#[derive(Default)]
pub(super) struct Rest {
    pub points: Vec<Point3>,
    pub facets: Vec<Facet>,
    pub triangles: Vec<Triangle>,
}

/// A shape in its own coordinates; triangles name its faces.
struct Surface<'a> {
    polyhedron: &'a Polyhedron,
    triangles: Vec<Triangle>,
}

/// A body with its colour.
struct Placed {
    shape: u32,
    first_facet: u32,
    colour: Light,
    pose: Pose,
}

impl<'a> Surface<'a> {
    fn new(polyhedron: &'a Polyhedron) -> Self {
        let corners = polyhedron.triangles();
        let mut corners = corners.into_iter();
        let mut triangles = Vec::new();
        for (face, facet) in polyhedron.faces().zip(0..) {
            // A face of n corners has n - 2 triangles, listed face by face.
            let of_face = corners.by_ref().take(face.len() - 2);
            triangles.extend(of_face.map(|corners| Triangle { corners, facet }));
        }
        Self {
            polyhedron,
            triangles,
        }
    }
}

impl<'a> Mesh<'a> {
    /// The bodies, coloured by `values`.
    pub fn of_bodies(snapshot: &'a Snapshot, values: &BodyValues) -> Self {
        let shapes = snapshot.shapes.iter();
        let mut mesh = Self {
            shapes: shapes.map(|s| Surface::new(&s.polyhedron)).collect(),
            ..Self::default()
        };
        for (i, body) in snapshot.bodies.iter().enumerate() {
            let value = values.values.get(i).copied().unwrap_or(f64::NAN);
            mesh.bodies.push(Placed {
                shape: body.shape,
                first_facet: mesh.placed,
                colour: values.place(value).map_or(UNKNOWN, viridis).to_light(),
                pose: body.pose,
            });
            mesh.placed += snapshot.shape_of(body).polyhedron.face_count() as u32;
        }
        mesh
    }

    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty() && self.rest.triangles.is_empty()
    }

    fn of(&self, body: &Placed) -> &Surface<'a> {
        &self.shapes[body.shape as usize]
    }

    /// All points, body by body.
    pub fn points(&self) -> impl Iterator<Item = Point3> {
        let bodies = self.bodies.iter().flat_map(|body| {
            let vertices = self.of(body).polyhedron.vertices();
            vertices.iter().map(|v| body.pose * v)
        });
        bodies.chain(self.rest.points.iter().copied())
    }

    /// A facet by number; `None` if there is none.
    pub fn facet(&self, number: u32) -> Option<Facet> {
        if number >= self.placed {
            let rest = self.rest.facets.get((number - self.placed) as usize);
            return rest.copied();
        }
        let after = self.bodies.partition_point(|b| b.first_facet <= number);
        let id = after.checked_sub(1)?;
        let body = self.bodies.get(id)?;
        let face = (number - body.first_facet) as usize;
        Some(Facet {
            normal: body.pose.rotation * self.of(body).polyhedron.face_normal(face),
            colour: body.colour,
            body: Some(id as u32),
        })
    }

    /// Calls `draw` with the points of each body in turn, its triangles, the number of its first facet and
    /// the normals of its facets.
    pub fn for_each_part(&self, mut draw: impl FnMut(&[Point3], &[Triangle], u32, &[Vector3])) {
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for body in &self.bodies {
            let surface = self.of(body);
            let polyhedron = surface.polyhedron;
            points.clear();
            points.extend(polyhedron.vertices().iter().map(|v| body.pose * v));
            normals.clear();
            let faces = 0..polyhedron.face_count();
            normals.extend(faces.map(|i| body.pose.rotation * polyhedron.face_normal(i)));
            draw(&points, &surface.triangles, body.first_facet, &normals);
        }
        normals.clear();
        normals.extend(self.rest.facets.iter().map(|facet| facet.normal));
        let Rest {
            points, triangles, ..
        } = &self.rest;
        draw(points, triangles, self.placed, &normals);
    }

    /// Adds a floor: a flat polygon, counter-clockwise seen from above.
    pub fn add_floor(&mut self, outline: &[Point3]) {
        let Rest {
            points,
            facets,
            triangles,
        } = &mut self.rest;
        let first = points.len() as u32;
        let facet = facets.len() as u32;
        let normal = match outline {
            [a, b, c, ..] => (b - a).cross(&(c - a)).try_normalize(0.0),
            _ => None,
        };
        facets.push(Facet {
            normal: normal.unwrap_or_else(Vector3::z),
            colour: FLOOR.to_light(),
            body: None,
        });
        points.extend_from_slice(outline);
        for i in 2..outline.len() as u32 {
            triangles.push(Triangle {
                corners: [first, first + i - 1, first + i],
                facet,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{by_sequence, two_cubes};

    #[test]
    fn a_cube_is_6_facets_of_2_triangles_with_normals_outward() {
        let snapshot = two_cubes();
        let mesh = Mesh::of_bodies(&snapshot, &by_sequence(&snapshot));
        assert_eq!(mesh.points().count(), 16);
        let (mut seen, mut parts) = (0, 0);
        mesh.for_each_part(|points, triangles, first, normals| {
            for triangle in triangles {
                let normal = normals[triangle.facet as usize];
                let [a, b, c] = triangle.corners.map(|i| points[i as usize]);
                assert!((b - a).cross(&(c - a)).normalize().dot(&normal) > 0.999_999);
                let facet = mesh.facet(first + triangle.facet).unwrap();
                assert_eq!((facet.normal, facet.body), (normal, Some(parts)));
                seen += 1;
            }
            parts += 1;
        });
        // Two cubes, and the rest, which is empty.
        assert_eq!((seen, parts), (24, 3));
        assert!(mesh.facet(11).is_some() && mesh.facet(12).is_none());
    }
}
