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
    frame: &'a Frame,
    sphere: &'a Sphere,
    centre: &'a Vector3,
    /// Whether the sphere is side A.
    reversed: bool,
}

impl<'a> Meeting<'a> {
    /// Of bodies A and B; `None` without a sphere, or with a mesh.
    pub fn of_bodies(shapes: [&'a BodyShape; 2], frames: [&'a Frame; 2]) -> Option<Self> {
        let reversed = shapes[1].sphere().is_none();
        let (own, its) = if reversed { (0, 1) } else { (1, 0) };
        let other = match shapes[its] {
            BodyShape::Sphere(sphere) => Other::Sphere(sphere),
            BodyShape::Convex(convex) => Other::Convex(convex),
            BodyShape::Mesh(_) => return None,
        };
        Some(Self {
            other,
            frame: frames[its],
            sphere: shapes[own].sphere()?,
            centre: &frames[own].position,
            reversed,
        })
    }

    /// Of a wall A and a body B; `None` if that is no sphere.
    pub fn with_wall(
        wall: &'a Wall,
        frame: &'a Frame,
        body: &'a BodyShape,
        of_body: &'a Frame,
    ) -> Option<Self> {
        Some(Self {
            other: Other::Wall(wall),
            frame,
            sphere: body.sphere()?,
            centre: &of_body.position,
            reversed: false,
        })
    }

    /// A lower bound of their distance, m, negative if they may touch; from bodies also a direction from A to B, in
    /// world axes, along which they are that far apart.
    pub fn gap(&self) -> (f64, Vector3) {
        let radius = self.sphere.radius();
        let (between, local) = place(self.frame, self.centre);
        let (gap, direction) = match self.other {
            Other::Sphere(other) => {
                let distance = between.norm();
                let direction = between / distance.max(f64::MIN_POSITIVE);
                (distance - radius - other.radius(), direction)
            }
            Other::Convex(body) => {
                let (gap, normal) = convex::gap(body, &local, radius);
                (gap, self.frame.rotation * normal)
            }
            Other::Wall(wall) => (wall.clearance(&local) - radius, Vector3::zeros()),
        };
        (gap, if self.reversed { -direction } else { direction })
    }

    /// The vector area of B's skin in A in the contact that they have.
    pub fn vector_area(&self, overlap: &Overlap) -> VectorArea {
        let (between, local) = place(self.frame, self.centre);
        let radius = self.sphere.radius();
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
        let of_sphere = patch.map(|patch| area_in(&patch, &self.frame.rotation));
        let of_sphere = of_sphere.unwrap_or_default();
        if self.reversed {
            VectorArea {
                area: -of_sphere.area,
                moment: between.cross(&-of_sphere.area),
            }
        } else {
            of_sphere
        }
    }

    /// Two balls, or a ball and the plane of a wall that it has gone into deepest; `None` for a polyhedron.
    pub fn round(&self) -> Option<Round> {
        let (_, local) = place(self.frame, self.centre);
        let own = self.sphere.radius();
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
                    direction: self.frame.rotation * nearest.1,
                }
            }
            Other::Convex(_) => return None,
        })
    }

    /// Their contact.
    pub fn overlap(&self, kernel: &SphereKernel) -> Option<Overlap> {
        let (frame, sphere, centre) = (self.frame, self.sphere, self.centre);
        let found = match self.other {
            Other::Sphere(other) => kernel.evaluate(other, sphere, &(centre - frame.position)),
            Other::Convex(body) => kernel.evaluate_convex(body, frame, sphere, centre),
            Other::Wall(wall) => kernel.evaluate_wall(wall, frame, sphere, centre),
        }?;
        Some(if self.reversed {
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
    frame: &'a Frame,
    sphere: &'a Sphere,
    centre: &'a Vector3,
    /// Whether the sphere is side A.
    reversed: bool,
}

impl<'a> SolidMeeting<'a> {
    /// Of bodies A and B; `None` unless one is a sphere and the other a mesh.
    pub fn of_bodies(shapes: [&'a BodyShape; 2], frames: [&'a Frame; 2]) -> Option<Self> {
        let reversed = shapes[1].sphere().is_none();
        let (own, its) = if reversed { (0, 1) } else { (1, 0) };
        let BodyShape::Mesh(mesh) = shapes[its] else {
            return None;
        };
        Some(Self {
            solid: Solid::Body(mesh),
            frame: frames[its],
            sphere: shapes[own].sphere()?,
            centre: &frames[own].position,
            reversed,
        })
    }

    /// Of a wall A and a body B; `None` if that is no sphere.
    pub fn with_wall(
        wall: &'a SolidWall,
        frame: &'a Frame,
        body: &'a BodyShape,
        of_body: &'a Frame,
    ) -> Option<Self> {
        Some(Self {
            solid: Solid::Wall(wall),
            frame,
            sphere: body.sphere()?,
            centre: &of_body.position,
            reversed: false,
        })
    }

    /// A lower bound of their distance, m, negative if they may touch.
    pub fn gap(&self) -> f64 {
        let cells = match self.solid {
            Solid::Body(mesh) => &mesh.cells,
            Solid::Wall(wall) => &wall.cells,
        };
        let (_, local) = place(self.frame, self.centre);
        cells.distance(&local) - self.sphere.radius()
    }

    /// Their patches.
    pub fn patches(&self, kernel: &SphereKernel) -> Vec<Patch> {
        let (frame, sphere, centre) = (self.frame, self.sphere, self.centre);
        let mut patches = match self.solid {
            Solid::Body(mesh) => kernel.evaluate_mesh(mesh, frame, sphere, centre),
            Solid::Wall(wall) => kernel.evaluate_solid_wall(wall, frame, sphere, centre),
        };
        if self.reversed {
            let between = centre - frame.position;
            for patch in &mut patches {
                patch.overlap = patch.overlap.reversed();
                let area = -patch.touching.area;
                let moment = between.cross(&area);
                patch.touching = VectorArea { area, moment };
            }
        }
        patches
    }
}
