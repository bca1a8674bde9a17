//! A pack at one moment, as plain data: the source of every output file and picture.
//!
//! It may come from a simulation, from a checkpoint, or from another code.

use std::fmt;

use femdem_analysis::{
    ContactClass, PeriodicSpace, PosedBody, Region, Touch, Vessel, WithImages, contact_counts,
};
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

use crate::{Drawing, ViewError};

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
    /// Transforms the shape's coordinates to world coordinates.
    pub pose: Pose,
    /// Number in the order of placement, from 0.
    pub sequence: u32,
    /// Whether the body is frozen.
    pub sleeping: bool,
}

/// The partner of a body in a contact.
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
    /// Moment on `partner` about the centre of pressure \[N m\], torsion and damping of rocking included.
    pub moment: Vector3,
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
///
/// ```
/// use femdem_mesh::{Pose, catalogue::CatalogueShape};
/// use femdem_view::{Body, Gaps, NamedShape, Snapshot};
///
/// let polyhedron = "P5".parse::<CatalogueShape>()?.polyhedron(0.02)?;
/// let at = |x: f64| Body { shape: 0, pose: Pose::translation(x, 0.0, 0.0), sequence: 0, sleeping: false };
/// let mut snapshot = Snapshot {
///     shapes: vec![NamedShape { name: "cube".to_owned(), polyhedron }],
///     bodies: vec![at(0.0), at(0.1)],
///     gaps: Gaps { contacts: true, ..Gaps::default() },
///     ..Snapshot::default()
/// };
/// snapshot.check()?;
/// // A shape that is not there is named.
/// snapshot.bodies[1].shape = 7;
/// assert!(snapshot.check().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// The shapes.
    pub shapes: Vec<NamedShape>,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The contacts, each once.
    pub contacts: Vec<ContactRow>,
    /// Inside of the container: where the pack is measured, and how pictures show the container.
    pub container: Option<Region>,
    /// Periodic space, if the pack lies in it: bodies and contacts are told once, in the box of its cell, which
    /// [`container`](Self::container) then is along the axes that repeat themselves.
    pub space: Option<PeriodicSpace>,
    /// What the bed lies in, if that is more than the container's region tells: a silo with its cone, or a solid.
    pub vessel: Option<Vessel>,
    /// How pictures show the container instead, if a region does not describe it completely.
    pub drawing: Option<Drawing>,
    /// Masses of the bodies \[kg\], one each; empty if unknown.
    pub masses: Vec<f64>,
    /// Velocities of the centres of mass \[m/s\], one for each body; empty if unknown.
    pub velocities: Vec<Vector3>,
    /// Gravity along −z \[m/s²\]; 0 if there is none or it is unknown.
    pub gravity: f64,
    /// Data that the source of the snapshot did not contain.
    pub gaps: Gaps,
}

/// Data that the source of a snapshot did not contain: the fields hold placeholders that no result may depend
/// on. All `false` for a snapshot of a simulation of rigid bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gaps {
    /// There is no list of contacts.
    pub contacts: bool,
    /// The contacts have no friction vectors; they are zero.
    pub friction: bool,
    /// The contacts have no classes; they are points.
    pub classes: bool,
    /// The contacts are those of overlaps: their forces are nominal, above zero.
    pub forces: bool,
}

/// Effect of the contacts on one body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyLoad {
    /// Bodies and walls that touch it: each counts once.
    pub coordination: u32,
    /// Sum of the sizes of the normal forces \[N\].
    pub force_sum: f64,
}

impl Snapshot {
    /// The surfaces of the shapes and the bodies, as [`Pack::new`](femdem_analysis::Pack::new) takes them.
    pub fn posed(&self) -> (Vec<Polyhedron>, Vec<PosedBody>) {
        let shapes = self.shapes.iter().map(|shape| shape.polyhedron.clone());
        let bodies = self.bodies.iter().map(|body| PosedBody {
            shape: body.shape,
            pose: body.pose,
        });
        (shapes.collect(), bodies.collect())
    }

    /// The same with the images that come within `reach` \[m\] of a region, if the pack lies in periodic space.
    ///
    /// # Errors
    ///
    /// [`ViewError::Analysis`] for a pose or a region that means nothing.
    pub fn with_images(
        &self,
        region: &Region,
        reach: f64,
    ) -> Result<(Vec<Polyhedron>, WithImages), ViewError> {
        let (shapes, bodies) = self.posed();
        let images = match &self.space {
            Some(space) => WithImages::new(&shapes, &bodies, space, region, reach)?,
            None => WithImages::none(bodies),
        };
        Ok((shapes, images))
    }

    /// Tells the images of the bodies, and of their contacts, that lie in the box of the periodic cell; nothing if there is none.
    pub fn wrap(&mut self) {
        let Some(space) = self.space else {
            return;
        };
        for body in &mut self.bodies {
            let surface = &self.shapes[body.shape as usize].polyhedron;
            let centroid = body.pose * surface.mass_properties().centroid;
            body.pose.translation.vector += space.wrapped(&centroid) - centroid;
        }
        for row in &mut self.contacts {
            row.point = space.wrapped(&row.point);
        }
    }

    /// Checks that every index exists and every number is finite.
    ///
    /// # Errors
    ///
    /// [`ViewError::ShapeIndex`], [`ViewError::BodyIndex`], [`ViewError::Masses`], [`ViewError::Velocities`] or
    /// [`ViewError::NotFinite`], naming the first fault.
    pub fn check(&self) -> Result<(), ViewError> {
        for (body, row) in self.bodies.iter().enumerate() {
            if row.shape as usize >= self.shapes.len() {
                let (shape, shapes) = (row.shape, self.shapes.len());
                return Err(ViewError::ShapeIndex {
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
                return Err(ViewError::NotFinite {
                    what: "body",
                    index: body,
                });
            }
        }
        if !self.masses.is_empty() && self.masses.len() != self.bodies.len() {
            let (masses, bodies) = (self.masses.len(), self.bodies.len());
            return Err(ViewError::Masses { masses, bodies });
        }
        if let Some(index) = self.masses.iter().position(|mass| !mass.is_finite()) {
            return Err(ViewError::NotFinite {
                what: "the mass of body",
                index,
            });
        }
        if !self.velocities.is_empty() && self.velocities.len() != self.bodies.len() {
            let (velocities, bodies) = (self.velocities.len(), self.bodies.len());
            return Err(ViewError::Velocities { velocities, bodies });
        }
        let rests_or_moves = |velocity: &Vector3| velocity.iter().all(|x| x.is_finite());
        if let Some(index) = self.velocities.iter().position(|v| !rests_or_moves(v)) {
            return Err(ViewError::NotFinite {
                what: "the velocity of body",
                index,
            });
        }
        for (contact, row) in self.contacts.iter().enumerate() {
            for body in row.bodies() {
                if body as usize >= self.bodies.len() {
                    let bodies = self.bodies.len();
                    return Err(ViewError::BodyIndex {
                        contact,
                        body,
                        bodies,
                    });
                }
            }
            let vectors = [row.point.coords, row.normal, row.friction, row.moment];
            let scalars = [row.normal_force, row.area, row.volume];
            if vectors
                .iter()
                .flatten()
                .chain(&scalars)
                .any(|x| !x.is_finite())
            {
                return Err(ViewError::NotFinite {
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

    /// The drawing of the container in a picture: its own drawing, or the outline of its region up to the
    /// highest body. `None` without a container.
    #[must_use]
    pub fn outline(&self) -> Option<Drawing> {
        let reach = |body: &Body| {
            let shape = self.shapes.get(body.shape as usize)?;
            Some(body.pose.translation.z + shape.polyhedron.bounding_radius())
        };
        let highest = self.bodies.iter().filter_map(reach);
        let top = highest.fold(f64::NEG_INFINITY, f64::max);
        self.drawing.clone().or_else(|| {
            let container = self.container.as_ref()?;
            let height = container.corners().1.z.min(top);
            Some(Drawing::of_region(container, height))
        })
    }

    /// Coordination and force of each body.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check), and [`ViewError::Analysis`] for a body that touches itself.
    pub fn loads(&self) -> Result<Vec<BodyLoad>, ViewError> {
        self.check()?;
        let mut loads = vec![BodyLoad::default(); self.bodies.len()];
        for row in &self.contacts {
            for body in row.bodies() {
                loads[body as usize].force_sum += row.normal_force.abs();
            }
        }
        let counts = contact_counts(self.bodies.len(), &self.touches(), 0.0)?;
        for (load, count) in loads.iter_mut().zip(counts) {
            load.coordination = count.total();
        }
        Ok(loads)
    }

    /// The contacts in the form that the analysis takes: walls by number, in the order of their first contact.
    #[must_use]
    pub fn touches(&self) -> Vec<Touch> {
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
    /// The bodies of the contact: one or two.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = u32> + use<> {
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

#[cfg(test)]
mod tests {
    use crate::testing::two_cubes;

    /// The upper cube hangs from the lower one by attraction: they touch, and the force counts by its size.
    #[test]
    fn a_contact_that_pulls_is_a_contact() {
        let mut snapshot = two_cubes();
        snapshot.contacts[0].normal_force = -10.0;
        let loads = snapshot.loads().unwrap();
        assert_eq!([0, 1].map(|i| loads[i].coordination), [2, 1]);
        assert_eq!([0, 1].map(|i| loads[i].force_sum), [30.0, 10.0]);
    }
}
