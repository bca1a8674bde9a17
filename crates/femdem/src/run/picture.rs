//! The picture of a run.

use femdem_contact::WallShape;
use femdem_mesh::{Point3, Pose, Vector3};
use femdem_view::picture::{Image, PictureOptions, Skin, draw_skins, sides};
use femdem_view::sharp_edges;

use super::control::BoxWalls;
use super::{PlaneEntry, Run, Scenario, Simulation};
use crate::{BodyValues, Drawing, Error, Spacing};

impl Run {
    /// Draws the bodies in their present state: deformable ones coloured by von Mises stress, rigid ones grey;
    /// without deformable bodies, the rigid ones by their number. Without a body the walls alone.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] if an element has no stress, [`Error::View`] if there is neither a body nor a wall with an outline.
    pub fn picture(&self, options: &PictureOptions) -> Result<Image, Error> {
        // A scene that starts from a pack need not describe its container.
        let of_pack = || self.simulation().snapshot().ok()?.outline();
        let place = |skins: &[Skin]| {
            let own = self.scenario().drawing(skins, self.simulation());
            own.or_else(of_pack)
        };
        self.simulation()
            .picture_in(place, Spacing::Linear, options)
    }
}

/// Decades of stress that a picture in logarithmic colours shows.
const DECADES: i32 = 3;

impl Simulation {
    /// Draws the bodies in a container, deformable ones coloured by von Mises stress over three
    /// decades.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] if an element has no stress.
    pub fn picture(&self, container: Option<&Drawing>) -> Result<Image, Error> {
        let options = PictureOptions::default();
        self.picture_in(|_| container.cloned(), Spacing::Log, &options)
    }

    fn picture_in(
        &self,
        place: impl Fn(&[Skin]) -> Option<Drawing>,
        spacing: Spacing,
        options: &PictureOptions,
    ) -> Result<Image, Error> {
        let mut skins = self.skins()?;
        let all_rigid = skins.is_empty();
        skins.extend(self.rigid_skins(all_rigid));
        let scale = if all_rigid {
            let last = self.members.len().saturating_sub(1).max(1) as f64;
            scale("body", "Number of the body.", [0.0, last], Spacing::Linear)
        } else {
            let values = skins.iter().flat_map(|skin| &skin.values).copied();
            let most = values.fold(0.0, f64::max);
            let (unit, name) = unit_of(most);
            for value in skins.iter_mut().flat_map(|skin| &mut skin.values) {
                *value /= unit;
            }
            let title = format!("von Mises stress / {name}");
            let most = if most > 0.0 { most / unit } else { 1.0 };
            let least = match spacing {
                Spacing::Log => most * 10_f64.powi(-DECADES),
                _ => 0.0,
            };
            let note = "von Mises stress of the skin's elements.";
            scale(&title, note, [least, most], spacing)
        };
        let drawing = place(&skins);
        Ok(draw_skins(&skins, drawing.as_ref(), &scale, options)?)
    }
}

fn scale(title: &str, note: &str, range: [f64; 2], spacing: Spacing) -> BodyValues {
    BodyValues {
        title: title.to_owned(),
        note: note.to_owned(),
        values: Vec::new(),
        range,
        spacing,
    }
}

/// A unit of stress \[Pa\] that makes numbers up to `most` easy to read.
pub(crate) fn unit_of(most: f64) -> (f64, &'static str) {
    match most {
        m if m >= 2e9 => (1e9, "GPa"),
        m if m >= 2e6 => (1e6, "MPa"),
        m if m >= 2e3 => (1e3, "kPa"),
        _ => (1.0, "Pa"),
    }
}

impl Simulation {
    /// Skins of the deformable bodies, with the von Mises stress \[Pa\] of the element behind each
    /// triangle.
    fn skins(&self) -> Result<Vec<Skin>, Error> {
        let skin = |strained: &super::frame::Strained| {
            let mesh = strained.body.model().mesh();
            let positions = strained.body.positions();
            let mut skin = Skin::default();
            for ((tet, neighbours), stress) in mesh
                .tets()
                .iter()
                .zip(mesh.neighbours())
                .zip(&strained.stresses)
            {
                let value = stress.von_mises();
                for (face, neighbour) in femdem_mesh::tet::FACES.iter().zip(neighbours) {
                    if neighbour.is_none() {
                        skin.triangles.push(face.map(|i| tet[i]));
                        skin.values.push(value);
                    }
                }
            }
            let corners = positions.iter().take(mesh.points().len());
            skin.points = corners.map(|x| Point3::from(*x)).collect();
            skin
        };
        Ok(self.strained()?.iter().map(skin).collect())
    }

    /// Surfaces of the rigid bodies, with their numbers as values or without values.
    fn rigid_skins(&self, numbered: bool) -> Vec<Skin> {
        let snapshot = self.rigid_snapshot();
        let skins = snapshot.bodies.iter().filter_map(|body| {
            let polyhedron = &snapshot.shapes.get(body.shape as usize)?.polyhedron;
            let triangles = polyhedron.triangles();
            let value = if numbered {
                f64::from(body.sequence)
            } else {
                f64::NAN
            };
            Some(Skin {
                points: polyhedron
                    .vertices()
                    .iter()
                    .map(|v| body.pose * v)
                    .collect(),
                values: vec![value; triangles.len()],
                triangles,
            })
        });
        skins.collect()
    }

    /// Places around the space for bodies that does not depend on where they are: those where they began, and corners of the
    /// boxes in which they come \[m\].
    pub(super) fn beginnings(&self) -> impl Iterator<Item = Vector3> {
        let placed = self.members.iter().map(|m| m.placed.translation.vector);
        placed.chain(self.flow.all_boxes().flatten())
    }
}

impl Scenario {
    /// The periodic cell, or the first plane that carries bodies, or the first box, around the drawn bodies or, without any, around
    /// where they began; all walls of revolution, and the sharp edges of walls from files.
    fn drawing(&self, skins: &[Skin], simulation: &Simulation) -> Option<Drawing> {
        let world = &simulation.world;
        if let Some([min, max]) = simulation
            .shown_cell()
            .map(|corners| corners.map(Point3::from))
        {
            let region = femdem_analysis::Region::Box { min, max };
            return Some(Drawing::of_region(&region, max.z));
        }
        let points = skins.iter().flat_map(|skin| &skin.points);
        let mut points: Vec<Vector3> = points.map(|p| p.coords).collect();
        if points.is_empty() {
            points.extend(simulation.beginnings());
        }
        let low = points.iter().copied().reduce(|a, b| a.inf(&b))?;
        let high = points.iter().copied().reduce(|a, b| a.sup(&b))?;
        let entries = || self.wall.iter().zip(&simulation.origin.walls);
        let is_there = |walls: &[u32]| walls.iter().any(|&wall| world.wall(wall).is_some());
        let there = entries().filter(|(_, walls)| is_there(walls));
        let first = there
            .into_iter()
            .find_map(|(wall, walls)| match (&wall.plane, &wall.r#box) {
                (Some(plane), None) => floor(plane, world.wall_pose(*walls.first()?)?, low, high),
                (None, Some(space)) => {
                    let [lower, upper] = BoxWalls::new(space, walls, world).corners(world);
                    let mut region_high = Vector3::from(upper);
                    if space.open {
                        region_high.z = region_high.z.min(high.z.max(lower[2]));
                    }
                    let region = femdem_analysis::Region::Box {
                        min: Point3::from(lower),
                        max: region_high.into(),
                    };
                    Some(Drawing::of_region(&region, region_high.z))
                }
                _ => None,
            });
        let outlines = entries().flat_map(|(entry, walls)| {
            let there = walls
                .iter()
                .filter_map(|&id| Some((world.wall(id)?, world.wall_pose(id)?)));
            there.flat_map(move |(shape, pose)| {
                let edges = match shape {
                    WallShape::Mesh(mesh) if entry.file.is_some() => {
                        let (points, triangles) = mesh.surface();
                        sharp_edges(points, triangles)
                    }
                    _ => entry.outline([low.z, high.z]),
                };
                edges.into_iter().map(move |line| line.map(|p| pose * p))
            })
        });
        let outlines: Vec<_> = outlines.collect();
        if first.is_none() && outlines.is_empty() {
            return None;
        }
        let mut drawing = first.unwrap_or_default();
        drawing.lines.extend(outlines);
        Some(drawing)
    }
}

/// The part of a plane that lies under the box between two corners, with a margin.
fn floor(plane: &PlaneEntry, pose: Pose, low: Vector3, high: Vector3) -> Option<Drawing> {
    let normal = pose * Vector3::from(plane.normal).try_normalize(0.0)?;
    let offset = plane.offset + normal.dot(&pose.translation.vector);
    if normal.z < 0.2 {
        return None;
    }
    let margin = 0.05 * (high - low).norm();
    let corner = |x: f64, y: f64| {
        let z = (offset - normal.x * x - normal.y * y) / normal.z;
        Point3::new(x, y, z)
    };
    let [left, right] = [low.x - margin, high.x + margin];
    let [front, back] = [low.y - margin, high.y + margin];
    let floor = vec![
        corner(left, front),
        corner(right, front),
        corner(right, back),
        corner(left, back),
    ];
    Some(Drawing {
        lines: sides(&floor).collect(),
        floor,
    })
}
