//! What is drawn: the bodies' surfaces as coloured triangles, and the floor.

use femdem_analysis::Region;
use femdem_mesh::{Point3, Vector3};

use super::colour::{Light, Srgb, viridis};
use crate::Snapshot;

/// Corners of a polygon that stands for a circle.
const CIRCLE_SIDES: usize = 96;

const FLOOR: Srgb = Srgb([0xef, 0xee, 0xea]);

/// A flat piece of surface of one colour.
pub(super) struct Facet {
    pub normal: Vector3,
    pub colour: Light,
    /// The body it belongs to; `None` for the floor.
    pub body: Option<u32>,
}

/// A triangle of a facet.
pub(super) struct Triangle {
    pub corners: [u32; 3],
    pub facet: u32,
}

/// Triangles with shared points.
#[derive(Default)]
pub(super) struct Mesh {
    pub points: Vec<Point3>,
    pub facets: Vec<Facet>,
    pub triangles: Vec<Triangle>,
}

impl Mesh {
    /// The bodies, coloured by sequence.
    pub fn of_bodies(snapshot: &Snapshot) -> Self {
        let last = last_sequence(snapshot);
        let surfaces: Vec<Vec<[u32; 3]>> = snapshot
            .shapes
            .iter()
            .map(|shape| shape.polyhedron.triangles())
            .collect();
        let mut mesh = Self::default();
        for (id, body) in (0..).zip(&snapshot.bodies) {
            let polyhedron = &snapshot.shape_of(body).polyhedron;
            let colour = viridis(f64::from(body.sequence) / f64::from(last.max(1))).to_light();
            let first = mesh.points.len() as u32;
            mesh.points
                .extend(polyhedron.vertices().iter().map(|v| body.pose * v));
            let mut triangles = surfaces[body.shape as usize].iter();
            for (i, face) in polyhedron.faces().enumerate() {
                let facet = mesh.facets.len() as u32;
                let normal = body.pose.rotation * polyhedron.face_normal(i);
                mesh.facets.push(Facet {
                    normal,
                    colour,
                    body: Some(id),
                });
                // A face of n corners has n - 2 triangles, listed face by face.
                for corners in triangles.by_ref().take(face.len() - 2) {
                    let corners = corners.map(|v| first + v);
                    mesh.triangles.push(Triangle { corners, facet });
                }
            }
        }
        mesh
    }

    /// The same with all facets of the colour `value`, 0 to 1.
    pub fn coloured(mut self, value: f64) -> Self {
        let colour = viridis(value).to_light();
        for facet in &mut self.facets {
            facet.colour = colour;
        }
        self
    }

    /// Adds a floor.
    pub fn add_floor(&mut self, outline: &[Point3]) {
        let first = self.points.len() as u32;
        let facet = self.facets.len() as u32;
        self.facets.push(Facet {
            normal: Vector3::z(),
            colour: FLOOR.to_light(),
            body: None,
        });
        self.points.extend_from_slice(outline);
        for i in 2..outline.len() as u32 {
            self.triangles.push(Triangle {
                corners: [first, first + i - 1, first + i],
                facet,
            });
        }
    }
}

/// The largest sequence number.
pub(super) fn last_sequence(snapshot: &Snapshot) -> u32 {
    snapshot
        .bodies
        .iter()
        .map(|body| body.sequence)
        .max()
        .unwrap_or(0)
}

/// The outline of a container: the rim of its floor and the same rim above.
pub(super) struct Outline {
    pub floor: Vec<Point3>,
    pub rim: Vec<Point3>,
    /// Which corners of the rims are joined by a line.
    pub posts: Vec<usize>,
}

impl Outline {
    /// The container up to the height `top` \[m\] at most, seen from `azimuth` (radians).
    pub fn of(container: &Region, top: f64, azimuth: f64) -> Self {
        let (min, max) = container.corners();
        let height = max.z.min(top);
        let (footprint, posts): (Vec<[f64; 2]>, Vec<usize>) = match *container {
            Region::Box { min, max } => (
                vec![
                    [min.x, min.y],
                    [max.x, min.y],
                    [max.x, max.y],
                    [min.x, max.y],
                ],
                (0..4).collect(),
            ),
            Region::Cylinder { centre, radius, .. } => {
                // The first corner is the one at the right edge as seen, so that the posts stand there.
                let circle = (0..CIRCLE_SIDES).map(|k| {
                    let angle = std::f64::consts::TAU * k as f64 / CIRCLE_SIDES as f64 + azimuth;
                    [
                        centre[0] + radius * angle.cos(),
                        centre[1] + radius * angle.sin(),
                    ]
                });
                (circle.collect(), vec![0, CIRCLE_SIDES / 2])
            }
        };
        let at = |z: f64| {
            footprint
                .iter()
                .map(|[x, y]| Point3::new(*x, *y, z))
                .collect()
        };
        Self {
            floor: at(min.z),
            rim: at(height),
            posts,
        }
    }

    /// The lines to draw.
    pub fn lines(&self) -> Vec<[Point3; 2]> {
        let around = |rim: &[Point3]| {
            let next = rim.iter().cycle().skip(1);
            rim.iter()
                .zip(next)
                .map(|(a, b)| [*a, *b])
                .collect::<Vec<_>>()
        };
        let posts = self.posts.iter().map(|&i| [self.floor[i], self.rim[i]]);
        posts
            .chain(around(&self.floor))
            .chain(around(&self.rim))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    #[test]
    fn a_cube_is_6_facets_of_2_triangles_with_normals_outward() {
        let snapshot = two_cubes();
        let mesh = Mesh::of_bodies(&snapshot);
        assert_eq!(
            (mesh.points.len(), mesh.facets.len(), mesh.triangles.len()),
            (16, 12, 24)
        );
        for triangle in &mesh.triangles {
            let facet = &mesh.facets[triangle.facet as usize];
            let [a, b, c] = triangle.corners.map(|i| mesh.points[i as usize]);
            assert!((b - a).cross(&(c - a)).normalize().dot(&facet.normal) > 0.999_999);
        }
    }

    #[test]
    fn outline_of_a_box_has_12_lines_and_stops_at_the_top() {
        let container = two_cubes().container.unwrap();
        let outline = Outline::of(&container, 2.0, 0.0);
        assert_eq!(outline.lines().len(), 12);
        assert!(
            outline
                .lines()
                .iter()
                .flatten()
                .all(|p| p.z == 0.0 || p.z == 2.0)
        );
    }
}
