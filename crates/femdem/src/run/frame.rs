//! A frame of a simulation, in files for ParaView.

use std::io::{self, Write};

use femdem_fem::ElementStress;
use femdem_mesh::Vector3;
use femdem_solve::{Deformable, SolveError};
use femdem_view::output::vtk::Document;
use femdem_view::output::vtu;

use super::contacts::{ContactLine, Side};
use super::{Member, Simulation};
use crate::grid::{GridBody, write_grid};
use crate::{Body, Error, NamedShape, Snapshot};

/// A deformable body with its stresses.
pub(super) struct Strained<'a> {
    /// Number among the members.
    pub member: usize,
    pub entry: &'a Member,
    pub body: Deformable<'a>,
    pub stresses: Vec<ElementStress>,
    /// If a material has one.
    pub plastic_strains: Option<Vec<f64>>,
}

impl Strained<'_> {
    fn in_grid(&self) -> GridBody<'_> {
        GridBody {
            number: self.member,
            placed: self.entry.placed,
            model: self.body.model(),
            positions: self.body.positions().into(),
            velocities: Some(self.body.velocities()),
            stresses: &self.stresses,
            is_asleep: self.body.is_asleep(),
            plastic_strains: self.plastic_strains.as_deref(),
        }
    }
}

impl Simulation {
    /// The deformable bodies with their stresses.
    pub(super) fn strained(&self) -> Result<Vec<Strained<'_>>, Error> {
        let bodies = self.deformables().map(|(member, entry, body)| {
            let plastic_strains = body.model().plastic_strains(body.history());
            Ok(Strained {
                member,
                entry,
                stresses: body.stresses().map_err(SolveError::from)?,
                plastic_strains: plastic_strains.map_err(SolveError::from)?,
                body,
            })
        });
        bodies.collect()
    }

    /// The rigid bodies alone; `sequence` is the number among the members.
    #[must_use]
    pub fn rigid_snapshot(&self) -> Snapshot {
        let world = &self.world;
        let shapes = world.shapes().iter().map(|shape| NamedShape {
            name: shape.name.clone(),
            polyhedron: shape.polyhedron.clone(),
        });
        let bodies = self
            .members
            .iter()
            .zip(0..)
            .filter_map(|(member, sequence)| {
                let id = member.id;
                Some(Body {
                    shape: world.shape_of(id)?,
                    pose: self.shown(id)?,
                    sequence,
                    sleeping: world.is_asleep(id),
                })
            });
        Snapshot {
            shapes: shapes.collect(),
            bodies: bodies.collect(),
            ..Snapshot::default()
        }
    }

    /// Writes the rigid bodies as a VTU file; `body` is their number in the scene.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_rigid(&self, writer: impl Write) -> io::Result<()> {
        let snapshot = self.rigid_snapshot();
        let bodies = snapshot.bodies.iter();
        let numbers: Vec<i64> = bodies.map(|body| i64::from(body.sequence)).collect();
        vtu::write_numbered(&snapshot, &numbers, writer)
    }

    /// Writes the deformable bodies as a VTU file.
    ///
    /// # Errors
    ///
    /// If writing fails, or an element has no stress (as [`io::ErrorKind::InvalidInput`]).
    pub fn write_deformables(&self, writer: impl Write) -> io::Result<()> {
        let bodies = self
            .strained()
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        let cracks = self.has_breakable().then(|| self.cracks_of_tets());
        let bodies: Vec<GridBody> = bodies.iter().map(Strained::in_grid).collect();
        write_grid(&bodies, writer, |out| {
            if let Some(CracksOfTets { fragment, damage }) = &cracks {
                out.integers("fragment", fragment.iter().copied());
                out.floats("damage", 1, damage.iter().copied());
            }
        })
    }

    /// Writes the contacts as a VTP file: a point for each, with `force` on B and `normal` from A to B,
    /// `normal_force`, `tangential_force` (N), `area` (m²), `penetration` (m), `a` and `b` (numbers
    /// among the members; −1 − w for wall w).
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_contacts(&self, writer: impl Write) -> io::Result<()> {
        let walls: Vec<usize> = self.walls.iter().map(|wall| wall.id as usize).collect();
        write_points(&self.contacts(), &walls, writer)
    }
}

/// By tetrahedron of all deformable bodies.
struct CracksOfTets {
    fragment: Vec<i64>,
    damage: Vec<f64>,
}

impl Simulation {
    fn cracks_of_tets(&self) -> CracksOfTets {
        let (mut fragment, mut damage) = (Vec::new(), Vec::new());
        let mut breakable = self.breakable_bodies().peekable();
        let mut first = 0;
        for (member, _, body) in self.deformables() {
            let count = body.model().volumes().len();
            let Some(own) = breakable.next_if(|own| own.member == member) else {
                fragment.extend(std::iter::repeat_n(-1, count));
                damage.extend(std::iter::repeat_n(0.0, count));
                continue;
            };
            let mut of_tet = vec![first; count];
            for piece in own.pieces() {
                for t in piece.tets {
                    of_tet[t as usize] = first;
                }
                first += 1;
            }
            fragment.extend(of_tet);
            damage.extend(own.damage());
        }
        CracksOfTets { fragment, damage }
    }
}

/// `walls` has the numbers of the walls, which have gaps where some were taken away; a wall is named by its place among them.
fn write_points(contacts: &[ContactLine], walls: &[usize], writer: impl Write) -> io::Result<()> {
    let count = contacts.len();
    let mut out = Document::new("PolyData");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>"
    ));
    let vectors = |of: fn(&ContactLine) -> Vector3| {
        contacts.iter().flat_map(move |c| <[f64; 3]>::from(of(c)))
    };
    out.floats("points", 3, vectors(|c| c.point));
    out.line("</Points>\n<Verts>");
    out.integers("connectivity", 0..count as i64);
    out.integers("offsets", 1..=count as i64);
    out.line("</Verts>\n<PointData Scalars=\"normal_force\" Vectors=\"force\">");
    out.floats("force", 3, vectors(ContactLine::force));
    out.floats("normal", 3, vectors(|c| c.normal));
    out.floats("normal_force", 1, contacts.iter().map(|c| c.normal_force));
    out.floats(
        "tangential_force",
        1,
        contacts.iter().map(|c| c.friction.norm()),
    );
    out.floats("area", 1, contacts.iter().map(|c| c.area));
    out.floats(
        "penetration",
        1,
        contacts.iter().map(ContactLine::penetration),
    );
    let place = |wall: usize| walls.partition_point(|other| *other < wall) as i64;
    let a = |c: &ContactLine| match c.a {
        Side::Member(member) => member as i64,
        Side::Wall(wall) => -1 - place(wall),
    };
    out.integers("a", contacts.iter().map(a));
    out.integers("b", contacts.iter().map(|c| c.b as i64));
    out.line("</PointData>\n</Piece>");
    out.finish(writer)
}
