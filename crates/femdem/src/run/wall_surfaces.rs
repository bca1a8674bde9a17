//! The walls as surfaces, for ParaView.
//!
//! Of walls of planes the part that bounds the space for the bodies is drawn, within the box around the bodies and the other
//! walls; of others their whole surface. Cell data: `wall` (number in the scene), `force` (of the bodies on the wall, N).

use std::io::{self, Write};

use femdem_contact::WallShape;
use femdem_mesh::{Point3, Vector3};
use femdem_view::output::vtk::Document;

use super::control::BoxWalls;
use super::{Scenario, Simulation};

/// Part of the extent by which planes go beyond it.
const MARGIN: f64 = 0.05;

/// A half-space n·x ≥ offset.
type HalfSpace = (Vector3, f64);

/// Polygons of a wall, in the world.
struct Surface {
    wall: usize,
    points: Vec<Point3>,
    polygons: Vec<Vec<u32>>,
}

impl Simulation {
    /// Writes the walls that are there as a VTP file: polygons with `wall`, the number of the wall, and `force`, that of the
    /// bodies on it \[N\]. `scene` tells where boxes end.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_wall_surfaces(&self, scene: &Scenario, writer: impl Write) -> io::Result<()> {
        let forces = self.forces(&self.contacts()).walls;
        self.write_walls_around(self.extent_of_bodies(), &forces, scene, writer)
    }

    /// The same around bodies in a box, with these forces on the walls.
    pub(super) fn write_walls_around(
        &self,
        bodies: Option<[Vector3; 2]>,
        forces: &[Vector3],
        scene: &Scenario,
        writer: impl Write,
    ) -> io::Result<()> {
        let surfaces = self.surfaces(bodies, scene);
        let points: usize = surfaces.iter().map(|s| s.points.len()).sum();
        let polygons: usize = surfaces.iter().map(|s| s.polygons.len()).sum();
        let (mut connectivity, mut offsets, mut first) = (Vec::new(), Vec::new(), 0);
        for surface in &surfaces {
            for polygon in &surface.polygons {
                connectivity.extend(polygon.iter().map(|i| first + i64::from(*i)));
                offsets.push(connectivity.len() as i64);
            }
            first += surface.points.len() as i64;
        }
        let walls: Vec<usize> = surfaces
            .iter()
            .flat_map(|s| s.polygons.iter().map(|_| s.wall))
            .collect();
        let mut out = Document::new("PolyData");
        out.line(&format!(
            "<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{polygons}\">\n<Points>"
        ));
        let places = surfaces.iter().flat_map(|s| &s.points);
        out.floats("points", 3, places.flat_map(|p| <[f64; 3]>::from(*p)));
        out.line("</Points>\n<Polys>");
        out.integers("connectivity", connectivity);
        out.integers("offsets", offsets);
        out.line("</Polys>\n<CellData Scalars=\"wall\" Vectors=\"force\">");
        out.integers("wall", walls.iter().map(|wall| *wall as i64));
        let forces = walls.iter().map(|wall| forces[*wall] + Vector3::zeros());
        out.floats("force", 3, forces.flat_map(<[f64; 3]>::from));
        out.line("</CellData>\n</Piece>");
        out.finish(writer)
    }

    fn surfaces(&self, bodies: Option<[Vector3; 2]>, scene: &Scenario) -> Vec<Surface> {
        let world = &self.world;
        let there = || {
            let walls = self.walls.iter().enumerate();
            walls.filter_map(|(number, wall)| {
                Some((number, world.wall(wall.id)?, world.wall_pose(wall.id)?))
            })
        };
        let mut surfaces = Vec::new();
        let mut planes: Vec<(usize, HalfSpace)> = Vec::new();
        for (wall, shape, pose) in there() {
            match shape {
                WallShape::Mesh(mesh) => {
                    let (points, triangles) = mesh.surface();
                    surfaces.push(Surface {
                        wall,
                        points: points.iter().map(|p| pose * p).collect(),
                        polygons: triangles.iter().map(|corners| corners.to_vec()).collect(),
                    });
                }
                WallShape::Planes(own) => planes.extend(own.planes().iter().map(|plane| {
                    let normal = pose.rotation * plane.normal;
                    let offset = plane.offset + normal.dot(&pose.translation.vector);
                    (wall, (normal, offset))
                })),
            }
        }
        let Some([low, high]) = self.extent(bodies, scene, &surfaces) else {
            return surfaces;
        };
        for (k, (wall, plane)) in planes.iter().enumerate() {
            let mut polygon = across(plane, low, high);
            for (other, (_, half)) in planes.iter().enumerate() {
                if other != k {
                    polygon = clipped(&polygon, half);
                }
            }
            if polygon.len() > 2 {
                surfaces.push(Surface {
                    wall: *wall,
                    polygons: vec![(0..polygon.len() as u32).collect()],
                    points: polygon.into_iter().map(Point3::from).collect(),
                });
            }
        }
        surfaces.sort_by_key(|surface| surface.wall);
        surfaces
    }

    /// Lowest and highest corner of the box around the bodies \[m\]; `None` without any.
    pub(super) fn extent_of_bodies(&self) -> Option<[Vector3; 2]> {
        let snapshot = self.rigid_snapshot();
        let rigid = snapshot.bodies.iter().flat_map(|body| {
            let polyhedron = &snapshot.shapes[body.shape as usize].polyhedron;
            let (x, radius) = (body.pose.translation.vector, polyhedron.bounding_radius());
            [x.add_scalar(-radius), x.add_scalar(radius)]
        });
        let soft = self.deformables();
        let soft = soft.flat_map(|(_, _, body)| body.positions()).copied();
        box_around(rigid.chain(soft))
    }

    /// The box around the bodies, which lie in one, where they begin, the boxes of the scene and the walls with an end, with a
    /// margin.
    fn extent(
        &self,
        bodies: Option<[Vector3; 2]>,
        scene: &Scenario,
        surfaces: &[Surface],
    ) -> Option<[Vector3; 2]> {
        let world = &self.world;
        let mut points: Vec<Vector3> = bodies.into_iter().flatten().collect();
        points.extend(surfaces.iter().flat_map(|s| &s.points).map(|p| p.coords));
        for (entry, walls) in scene.wall.iter().zip(&self.origin.walls) {
            if let Some(space) = &entry.r#box {
                let corners = BoxWalls::new(space, walls, world).corners(world);
                points.extend(corners.map(Vector3::from));
            }
        }
        let [low, high] = box_around(self.beginnings().chain(points))?;
        let margin = MARGIN * (high - low).norm();
        Some([low.add_scalar(-margin), high.add_scalar(margin)])
    }
}

/// Lowest and highest corner of the box around points.
fn box_around(points: impl Iterator<Item = Vector3>) -> Option<[Vector3; 2]> {
    let each = points.map(|point| [point, point]);
    each.reduce(|[low, high], [a, b]| [low.inf(&a), high.sup(&b)])
}

/// The part of a plane in a box, counter-clockwise seen from the side of the bodies.
fn across((normal, offset): &HalfSpace, low: Vector3, high: Vector3) -> Vec<Vector3> {
    let middle = 0.5 * (low + high);
    let reach = (high - low).norm();
    let at = middle + normal * (offset - normal.dot(&middle));
    let axis = normal.iamin();
    let u = normal.cross(&Vector3::ith(axis, 1.0)).normalize();
    let v = normal.cross(&u);
    let corner = |a: f64, b: f64| at + reach * (a * u + b * v);
    let mut polygon = vec![
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    for k in 0..3 {
        polygon = clipped(&polygon, &(Vector3::ith(k, 1.0), low[k]));
        polygon = clipped(&polygon, &(Vector3::ith(k, -1.0), -high[k]));
    }
    polygon
}

/// The part of a convex polygon in a half-space.
fn clipped(polygon: &[Vector3], (normal, offset): &HalfSpace) -> Vec<Vector3> {
    let height = |p: &Vector3| normal.dot(p) - offset;
    let next = polygon.iter().cycle().skip(1);
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (a, b) in polygon.iter().zip(next) {
        let (of_a, of_b) = (height(a), height(b));
        if of_a >= 0.0 {
            part.push(*a);
        }
        if (of_a > 0.0 && of_b < 0.0) || (of_a < 0.0 && of_b > 0.0) {
            part.push(a + (b - a) * (of_a / (of_a - of_b)));
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygon: &[Vector3], normal: &Vector3) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        let doubled = polygon.iter().zip(next).map(|(a, b)| a.cross(b));
        0.5 * doubled.sum::<Vector3>().dot(normal)
    }

    /// A level plane through a box, cut by a wall across a third of it.
    #[test]
    fn planes_end_at_the_box_and_at_each_other() {
        let up = (Vector3::z(), 0.5);
        let polygon = across(&up, Vector3::zeros(), Vector3::new(3.0, 2.0, 1.0));
        assert!((area(&polygon, &up.0) - 6.0).abs() < 1e-12);
        let part = clipped(&polygon, &(Vector3::x(), 1.0));
        assert!((area(&part, &up.0) - 4.0).abs() < 1e-12);
        assert!(clipped(&part, &(Vector3::x(), 4.0)).is_empty());
    }
}
