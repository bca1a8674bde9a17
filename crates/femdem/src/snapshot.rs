//! A pack at one moment, as plain data: what every output file and picture is made from.
//!
//! It may come from a simulation, from a checkpoint, or from another code.

use std::fmt;

use femdem_analysis::{Region, Touch, contact_counts};
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

use crate::Error;

/// A shape and the name it has in tables and file names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedShape {
    /// Name, such as "A10".
    pub name: String,
    /// Surface, in the coordinates that the poses act on \[m\].
    pub polyhedron: Polyhedron,
}

/// A body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Index into the shapes.
    pub shape: u32,
    /// Takes the shape's coordinates to world coordinates.
    pub pose: Pose,
    /// Number in the order of placement, from 0.
    pub sequence: u32,
    /// Whether the body is frozen.
    pub sleeping: bool,
}

/// What a body touches.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Partner {
    /// Another body, by index.
    Body(u32),
    /// A wall, by name.
    Wall(String),
}

impl fmt::Display for Partner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Body(body) => write!(f, "{body}"),
            Self::Wall(name) => f.write_str(name),
        }
    }
}

/// How two surfaces meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactClass {
    /// A face on a face (or on a wall).
    FaceFace,
    /// An edge on a face, or two edges along each other.
    EdgeFace,
    /// A vertex on anything, or two edges across each other.
    Point,
}

impl ContactClass {
    /// Class of a patch, by two numbers that do not depend on how deep the bodies overlap.
    ///
    /// **Face or not**: q = A/(δ d) with the mean penetration δ = V/A. Two planes that meet at an
    /// angle θ along a length l overlap in a wedge with q = 2 (l/d)/tan θ; for l = d/2 the limit
    /// q = 8 is θ = 7°. An edge of a cube on a face has q = 2, blunt edges up to about 6.
    ///
    /// **Edge or point**: the exponent n of the force law F ~ δⁿ, 2 for an edge on a face, 3 for a
    /// vertex on a face or an edge across an edge. As U = F δ/(n + 1) and K = n F/δ,
    /// K U/F² = n/(n + 1). The limit is n = 2.5. Without a force it is a point.
    #[must_use]
    pub fn of_patch(patch: &Patch) -> Self {
        const FACE: f64 = 8.0;
        const EDGE: f64 = 2.5 / 3.5;
        let Patch {
            area,
            volume,
            energy,
            force,
            stiffness,
            diameter,
        } = *patch;
        if area * area >= FACE * volume * diameter && volume > 0.0 {
            Self::FaceFace
        } else if stiffness * energy <= EDGE * force * force && force > 0.0 {
            Self::EdgeFace
        } else {
            Self::Point
        }
    }

    /// "face-face", "edge-face" or "point".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FaceFace => "face-face",
            Self::EdgeFace => "edge-face",
            Self::Point => "point",
        }
    }

    /// 2 for a face, 1 for an edge, 0 for a point: the dimension of the patch.
    #[must_use]
    pub const fn dimension(self) -> u8 {
        match self {
            Self::FaceFace => 2,
            Self::EdgeFace => 1,
            Self::Point => 0,
        }
    }
}

/// What the class of a contact is found from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Contact area A \[m²\].
    pub area: f64,
    /// Overlap volume V \[m³\].
    pub volume: f64,
    /// Contact energy U \[J\].
    pub energy: f64,
    /// Elastic normal force F \[N\].
    pub force: f64,
    /// Normal stiffness K \[N/m\].
    pub stiffness: f64,
    /// Mean circumscribed diameter d of the bodies \[m\].
    pub diameter: f64,
}

/// A contact: one connected patch.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRow {
    /// One body.
    pub body: u32,
    /// The other body, or a wall.
    pub partner: Partner,
    /// Centre of pressure \[m\].
    pub point: Point3,
    /// Unit normal, from `body` towards `partner`.
    pub normal: Vector3,
    /// Normal force \[N\], positive when it pushes the two apart.
    pub normal_force: f64,
    /// Friction force on `partner` \[N\].
    pub friction: Vector3,
    /// Contact area \[m²\].
    pub area: f64,
    /// Overlap volume \[m³\].
    pub volume: f64,
    /// How the surfaces meet.
    pub class: ContactClass,
    /// Number of the patch within its pair, from 0: bodies that are not convex may touch in several.
    pub patch: u32,
}

/// A pack at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// The shapes.
    pub shapes: Vec<NamedShape>,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The contacts, each once.
    pub contacts: Vec<ContactRow>,
    /// Inside of the container: where the pack is measured, and what pictures show of the container.
    pub container: Option<Region>,
    /// What pictures show of the container instead, where a region does not tell all.
    pub drawing: Option<Drawing>,
}

/// What a picture shows of a container.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The floor: corners of a convex polygon, counter-clockwise seen from above \[m\].
    pub floor: Vec<Point3>,
    /// The edges \[m\].
    pub lines: Vec<[Point3; 2]>,
}

/// What the contacts do to one body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyLoad {
    /// Bodies and walls that push on it: each counts once.
    pub coordination: u32,
    /// Sum of the normal forces \[N\].
    pub force_sum: f64,
}

impl Snapshot {
    /// Checks that every index exists and every number is finite.
    ///
    /// # Errors
    ///
    /// [`Error::ShapeIndex`], [`Error::BodyIndex`] or [`Error::NotFinite`], naming the first fault.
    pub fn check(&self) -> Result<(), Error> {
        for (body, row) in self.bodies.iter().enumerate() {
            if row.shape as usize >= self.shapes.len() {
                let (shape, shapes) = (row.shape, self.shapes.len());
                return Err(Error::ShapeIndex {
                    body,
                    shape,
                    shapes,
                });
            }
            let numbers = row
                .pose
                .translation
                .vector
                .iter()
                .chain(row.pose.rotation.coords.iter());
            if numbers.into_iter().any(|x| !x.is_finite()) {
                return Err(Error::NotFinite {
                    what: "body",
                    index: body,
                });
            }
        }
        for (contact, row) in self.contacts.iter().enumerate() {
            for body in row.bodies() {
                if body as usize >= self.bodies.len() {
                    let bodies = self.bodies.len();
                    return Err(Error::BodyIndex {
                        contact,
                        body,
                        bodies,
                    });
                }
            }
            let vectors = [row.point.coords, row.normal, row.friction];
            let scalars = [row.normal_force, row.area, row.volume];
            if vectors
                .iter()
                .flatten()
                .chain(&scalars)
                .any(|x| !x.is_finite())
            {
                return Err(Error::NotFinite {
                    what: "contact",
                    index: contact,
                });
            }
        }
        Ok(())
    }

    /// A body's shape; the snapshot must have passed [`check`](Self::check).
    pub(crate) fn shape_of(&self, body: &Body) -> &NamedShape {
        &self.shapes[body.shape as usize]
    }

    /// Coordination and force of each body.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check), and [`Error::Analysis`] for a body that touches itself.
    pub fn loads(&self) -> Result<Vec<BodyLoad>, Error> {
        self.check()?;
        let mut loads = vec![BodyLoad::default(); self.bodies.len()];
        for row in self.contacts.iter().filter(|row| row.normal_force > 0.0) {
            for body in row.bodies() {
                loads[body as usize].force_sum += row.normal_force;
            }
        }
        let counts = contact_counts(self.bodies.len(), &self.touches(), 0.0)?;
        for (load, count) in loads.iter_mut().zip(counts) {
            load.coordination = count.total();
        }
        Ok(loads)
    }

    /// The contacts as analysis counts them: walls by number, in the order of their first contact.
    pub(crate) fn touches(&self) -> Vec<Touch> {
        let mut walls = Vec::new();
        let touch = |row: &ContactRow| Touch {
            first: row.body,
            second: match &row.partner {
                Partner::Body(other) => femdem_analysis::Partner::Body(*other),
                Partner::Wall(name) => {
                    let known = walls.iter().position(|wall| wall == name);
                    femdem_analysis::Partner::Wall(known.unwrap_or_else(|| {
                        walls.push(name.clone());
                        walls.len() - 1
                    }) as u32)
                }
            },
            normal_force: row.normal_force,
        };
        self.contacts.iter().map(touch).collect()
    }

    /// Name of the shapes in tables: of the one shape, or "mixed".
    #[must_use]
    pub fn shape_name(&self) -> &str {
        match self.shapes.as_slice() {
            [one] => &one.name,
            _ => "mixed",
        }
    }
}

impl ContactRow {
    /// The bodies that take part: one or two.
    fn bodies(&self) -> impl Iterator<Item = u32> + use<> {
        let other = match self.partner {
            Partner::Body(other) => Some(other),
            Partner::Wall(_) => None,
        };
        [Some(self.body), other].into_iter().flatten()
    }

    /// Mean depth of the overlap \[m\]: its volume over its area, 0 without an area.
    #[must_use]
    pub fn penetration(&self) -> f64 {
        if self.area > 0.0 {
            self.volume / self.area
        } else {
            0.0
        }
    }
}
