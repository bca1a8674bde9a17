//! What is drawn: the bodies' surfaces as coloured triangles, and the floor.

use femdem_analysis::Region;
use femdem_mesh::{Point3, Vector3};

use super::colour::{Light, Srgb, viridis};
use crate::{BodyValues, Drawing, Snapshot};

/// Corners of a polygon that stands for a circle.
const CIRCLE_SIDES: usize = 96;

/// Bodies without a value.
pub(super) const UNKNOWN: Srgb = Srgb([0x96; 3]);

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
    /// The bodies, coloured by `values`.
    pub fn of_bodies(snapshot: &Snapshot, values: &BodyValues) -> Self {
        let surfaces: Vec<Vec<[u32; 3]>> = snapshot
            .shapes
            .iter()
            .map(|shape| shape.polyhedron.triangles())
            .collect();
        let mut mesh = Self::default();
        for (id, body) in (0..).zip(&snapshot.bodies) {
            let polyhedron = &snapshot.shape_of(body).polyhedron;
            let value = values.values.get(id as usize).copied().unwrap_or(f64::NAN);
            let colour = values.place(value).map_or(UNKNOWN, viridis).to_light();
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

    /// Adds a floor: a flat polygon, counter-clockwise seen from above.
    pub fn add_floor(&mut self, outline: &[Point3]) {
        let first = self.points.len() as u32;
        let facet = self.facets.len() as u32;
        let normal = match outline {
            [a, b, c, ..] => (b - a).cross(&(c - a)).try_normalize(0.0),
            _ => None,
        };
        self.facets.push(Facet {
            normal: normal.unwrap_or_else(Vector3::z),
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

/// Corners of a horizontal circle about the z axis of `centre`, counter-clockwise from above; the first
/// is in the direction `from` (radians).
pub(crate) fn circle(centre: Point3, radius: f64, from: f64) -> Vec<Point3> {
    (0..CIRCLE_SIDES)
        .map(|k| {
            let (sin, cos) =
                (std::f64::consts::TAU * k as f64 / CIRCLE_SIDES as f64 + from).sin_cos();
            centre + radius * Vector3::new(cos, sin, 0.0)
        })
        .collect()
}

/// The sides of a closed polygon.
pub(crate) fn sides(polygon: &[Point3]) -> impl Iterator<Item = [Point3; 2]> {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| [*a, *b])
}

/// The drawing of an upright container up to the height `top` \[m\], seen from `azimuth` (radians).
pub(super) fn outline(container: &Region, top: f64, azimuth: f64) -> Drawing {
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
    Drawing {
        lines: posts.chain(sides(&floor)).chain(sides(&rim)).collect(),
        floor,
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
        let outline = outline(&container, 2.0, 0.0);
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
