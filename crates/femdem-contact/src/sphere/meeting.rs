//! A sphere and whatever it meets, in either order.

use super::convex;
use super::kernel::{SphereKernel, area_in, place};
use super::shape::Sphere;
use super::wall;
use crate::adhesion::{Round, VectorArea};
use crate::body_shape::BodyShape;
use crate::general::{FieldMesh, Patch, SolidWall};
use crate::kernel::Overlap;
use crate::shape::{ConvexShape, Frame};
use crate::walls::Wall;
use femdem_mesh::Vector3;

/// A sphere beside something, of bodies and walls A and B in either order.
#[derive(Debug, Clone, Copy)]
struct Beside<'a> {
    /// Of what it meets.
    frame: &'a Frame,
    sphere: &'a Sphere,
    centre: &'a Vector3,
    /// Whether the sphere is side A.
    reversed: bool,
}

impl<'a> Beside<'a> {
    /// Of bodies A and B, with the shape that the sphere meets; `None` without a sphere.
    fn body(shapes: [&'a BodyShape; 2], frames: [&'a Frame; 2]) -> Option<(Self, &'a BodyShape)> {
        let reversed = shapes[1].sphere().is_none();
        let (own, its) = if reversed { (0, 1) } else { (1, 0) };
        let beside = Self {
            frame: frames[its],
            sphere: shapes[own].sphere()?,
            centre: &frames[own].position,
            reversed,
        };
        Some((beside, shapes[its]))
    }

    /// Of a wall A and a body B; `None` if that is no sphere.
    fn wall([wall, of_body]: [&'a Frame; 2], body: &'a BodyShape) -> Option<Self> {
        Some(Self {
            frame: wall,
            sphere: body.sphere()?,
            centre: &of_body.position,
            reversed: false,
        })
    }

    /// The centre from the origin of what it meets, in world axes and in the axes of that, m.
    fn place(&self) -> (Vector3, Vector3) {
        place(self.frame, self.centre)
    }

    /// The vector area of B's skin in A, where the sphere's skin has `of_sphere` in the other, about its centre.
    fn of_b(&self, of_sphere: VectorArea) -> VectorArea {
        if !self.reversed {
            return of_sphere;
        }
        let (between, area) = (self.place().0, -of_sphere.area);
        VectorArea {
            area,
            moment: between.cross(&area),
        }
    }
}

/// What a sphere meets in one patch at most.
#[derive(Debug, Clone, Copy)]
enum Other<'a> {
    Sphere(&'a Sphere),
    Convex(&'a ConvexShape),
    Wall(&'a Wall),
}

/// A pair with a sphere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting<'a> {
    other: Other<'a>,
    at: Beside<'a>,
}

impl<'a> Meeting<'a> {
    /// Of bodies A and B; `None` without a sphere, or with a mesh.
    pub fn of_bodies(shapes: [&'a BodyShape; 2], frames: [&'a Frame; 2]) -> Option<Self> {
        let (at, other) = Beside::body(shapes, frames)?;
        let other = match other {
            BodyShape::Sphere(sphere) => Other::Sphere(sphere),
            BodyShape::Convex(convex) => Other::Convex(convex),
            BodyShape::Mesh(_) => return None,
        };
        Some(Self { other, at })
    }

    /// Of a wall A and a body B; `None` if that is no sphere.
    pub fn with_wall(wall: &'a Wall, frames: [&'a Frame; 2], body: &'a BodyShape) -> Option<Self> {
        Some(Self {
            other: Other::Wall(wall),
            at: Beside::wall(frames, body)?,
        })
    }

    /// A lower bound of their distance, m, negative if they may touch; from bodies also a direction from A to B, in
    /// world axes, along which they are that far apart.
    pub fn gap(&self) -> (f64, Vector3) {
        let radius = self.at.sphere.radius();
        let (between, local) = self.at.place();
        let (gap, direction) = match self.other {
            Other::Sphere(other) => {
                let distance = between.norm();
                let direction = between / distance.max(f64::MIN_POSITIVE);
                (distance - radius - other.radius(), direction)
            }
            Other::Convex(body) => {
                let (gap, normal) = convex::gap(body, &local, radius);
                (gap, self.at.frame.rotation * normal)
            }
            Other::Wall(wall) => (wall.clearance(&local) - radius, Vector3::zeros()),
        };
        let sign = if self.at.reversed { -1.0 } else { 1.0 };
        (gap, direction * sign)
    }

    /// The vector area of B's skin in A in the contact that they have.
    pub fn vector_area(&self, overlap: &Overlap) -> VectorArea {
        let (_, local) = self.at.place();
        let radius = self.at.sphere.radius();
        let patch = match self.other {
            Other::Sphere(_) => {
                return VectorArea {
                    area: overlap.normal * -overlap.area,
                    moment: Vector3::zeros(),
                };
            }
            Other::Convex(body) => Some(convex::patch(body, &local, radius)),
            Other::Wall(wall) => wall::patch(wall, &local, radius),
        };
        let of_sphere = patch.map(|patch| area_in(&patch, &self.at.frame.rotation));
        self.at.of_b(of_sphere.unwrap_or_default())
    }

    /// Two balls, or a ball and the plane of a wall that it has gone into deepest; `None` for a polyhedron.
    pub fn round(&self) -> Option<Round> {
        let (_, local) = self.at.place();
        let own = self.at.sphere.radius();
        let (gap, direction) = self.gap();
        Some(match self.other {
            Other::Sphere(other) => Round {
                radius: own / (1.0 + own / other.radius()),
                depth: -gap,
                direction,
            },
            Other::Wall(wall) => {
                let planes = wall.planes().iter();
                let distances = planes.map(|p| (p.normal.dot(&local) - p.offset, p.normal));
                let nearest = distances.reduce(|least, x| if x.0 < least.0 { x } else { least })?;
                Round {
                    radius: own,
                    depth: -gap,
                    direction: self.at.frame.rotation * nearest.1,
                }
            }
            Other::Convex(_) => return None,
        })
    }

    /// Their contact.
    pub fn overlap(&self, kernel: &SphereKernel) -> Option<Overlap> {
        let (frame, sphere, centre) = (self.at.frame, self.at.sphere, self.at.centre);
        let found = match self.other {
            Other::Sphere(other) => kernel.evaluate(other, sphere, &(centre - frame.position)),
            Other::Convex(body) => kernel.evaluate_convex(body, frame, sphere, centre),
            Other::Wall(wall) => kernel.evaluate_wall(wall, frame, sphere, centre),
        }?;
        Some(if self.at.reversed {
            found.reversed()
        } else {
            found
        })
    }
}

/// A solid of tetrahedra that a sphere meets.
#[derive(Debug, Clone, Copy)]
enum Solid<'a> {
    Body(&'a FieldMesh),
    Wall(&'a SolidWall),
}

/// A pair of a sphere with a solid of tetrahedra, in either order.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SolidMeeting<'a> {
    solid: Solid<'a>,
    at: Beside<'a>,
}

impl<'a> SolidMeeting<'a> {
    /// Of bodies A and B; `None` unless one is a sphere and the other a mesh.
    pub fn of_bodies(shapes: [&'a BodyShape; 2], frames: [&'a Frame; 2]) -> Option<Self> {
        let (at, other) = Beside::body(shapes, frames)?;
        let BodyShape::Mesh(mesh) = other else {
            return None;
        };
        Some(Self {
            solid: Solid::Body(mesh),
            at,
        })
    }

    /// Of a wall A and a body B; `None` if that is no sphere.
    pub fn with_wall(
        wall: &'a SolidWall,
        frames: [&'a Frame; 2],
        body: &'a BodyShape,
    ) -> Option<Self> {
        Some(Self {
            solid: Solid::Wall(wall),
            at: Beside::wall(frames, body)?,
        })
    }

    /// A lower bound of their distance, m, negative if they may touch.
    pub fn gap(&self) -> f64 {
        let cells = match self.solid {
            Solid::Body(mesh) => &mesh.cells,
            Solid::Wall(wall) => &wall.cells,
        };
        let (_, local) = self.at.place();
        cells.distance(&local) - self.at.sphere.radius()
    }

    /// Their patches.
    pub fn patches(&self, kernel: &SphereKernel) -> Vec<Patch> {
        let (frame, sphere, centre) = (self.at.frame, self.at.sphere, self.at.centre);
        let mut patches = match self.solid {
            Solid::Body(mesh) => kernel.evaluate_mesh(mesh, frame, sphere, centre),
            Solid::Wall(wall) => kernel.evaluate_solid_wall(wall, frame, sphere, centre),
        };
        if self.at.reversed {
            for patch in &mut patches {
                patch.overlap = patch.overlap.reversed();
                patch.touching = self.at.of_b(patch.touching);
            }
        }
        patches
    }
}
