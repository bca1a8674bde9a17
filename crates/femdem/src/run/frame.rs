//! A frame of a simulation, in files for ParaView.

use std::borrow::Cow;
use std::io::{self, Write};

use femdem_fem::ElementStress;
use femdem_mesh::Vector3;
use femdem_solve::{Deformable, SolveError};
use femdem_view::output::vtk::Document;
use femdem_view::output::vtu;

use super::contacts::{ContactLine, Side};
use super::{Member, Simulation};
use crate::grid::{GridBody, GridMesh, write_grid};
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
    pub fn in_grid(&self) -> GridBody<'_> {
        GridBody {
            number: self.member,
            placed: self.entry.placed,
            mesh: GridMesh::of(self.body.model()),
            positions: self.body.positions().into(),
            velocities: Some(self.body.velocities().into()),
            stresses: (&*self.stresses).into(),
            is_asleep: self.body.is_asleep(),
            plastic_strains: self.plastic_strains.as_deref().map(Cow::from),
        }
    }
}

impl Simulation {
    /// The deformable bodies with their stresses, but for those of other ranks.
    pub(super) fn strained(&self) -> Result<Vec<Strained<'_>>, Error> {
        let own = self.deformables();
        let own = own.filter(|(_, member, _)| !self.world.is_guest(member.id));
        let bodies = own.map(|(member, entry, body)| {
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
            shapes: self.named_shapes(),
            bodies: bodies.collect(),
            ..Snapshot::default()
        }
    }

    pub(super) fn named_shapes(&self) -> Vec<NamedShape> {
        let shapes = self.world.shapes().iter().map(|shape| NamedShape {
            name: shape.name.clone(),
            polyhedron: shape.polyhedron.clone(),
        });
        shapes.collect()
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
        write_grid(&|take| bodies.iter().try_for_each(take), writer, |out| {
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
        let contacts = self.contacts();
        self.write_passed_contacts(&|take| contacts.iter().try_for_each(take), writer)
    }

    /// The same of contacts that are passed on several times, in the order of the file.
    pub(super) fn write_passed_contacts(
        &self,
        contacts: &Passed<'_>,
        writer: impl Write,
    ) -> io::Result<()> {
        let walls: Vec<usize> = self.walls.iter().map(|wall| wall.id as usize).collect();
        write_points(contacts, &walls, writer)
    }
}

/// Passes on contacts.
pub(super) type Passed<'a> =
    dyn Fn(&mut dyn FnMut(&ContactLine) -> io::Result<()>) -> io::Result<()> + 'a;

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
fn write_points(contacts: &Passed<'_>, walls: &[usize], writer: impl Write) -> io::Result<()> {
    let mut count = 0;
    contacts(&mut |_| {
        count += 1;
        Ok(())
    })?;
    let place = |wall: usize| walls.partition_point(|other| *other < wall) as i64;
    let a = |c: &ContactLine| match c.a {
        Side::Member(member) => member as i64,
        Side::Wall(wall) => -1 - place(wall),
    };
    let mut out = Document::new("PolyData");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>"
    ));
    vectors(&mut out, contacts, count, "points", |c| c.point);
    out.line("</Points>\n<Verts>");
    out.integers("connectivity", 0..count as i64);
    out.integers("offsets", 1..=count as i64);
    out.line("</Verts>\n<PointData Scalars=\"normal_force\" Vectors=\"force\">");
    vectors(&mut out, contacts, count, "force", ContactLine::force);
    vectors(&mut out, contacts, count, "normal", |c| c.normal);
    numbers(&mut out, contacts, count, "normal_force", |c| {
        c.normal_force
    });
    numbers(&mut out, contacts, count, "tangential_force", |c| {
        c.friction.norm()
    });
    numbers(&mut out, contacts, count, "area", |c| c.area);
    numbers(
        &mut out,
        contacts,
        count,
        "penetration",
        ContactLine::penetration,
    );
    out.given_integers("a", count, |take| contacts(&mut |c| take(a(c))));
    out.given_integers("b", count, |take| contacts(&mut |c| take(c.b as i64)));
    out.line("</PointData>\n</Piece>");
    out.finish(writer)
}

fn vectors<'a>(
    out: &mut Document<'a>,
    contacts: &'a Passed<'a>,
    count: usize,
    name: &str,
    of: fn(&ContactLine) -> Vector3,
) {
    out.given_floats(name, 3, 3 * count, move |take| {
        contacts(&mut |c| <[f64; 3]>::from(of(c)).into_iter().try_for_each(&mut *take))
    });
}

fn numbers<'a>(
    out: &mut Document<'a>,
    contacts: &'a Passed<'a>,
    count: usize,
    name: &str,
    of: fn(&ContactLine) -> f64,
) {
    out.given_floats(name, 1, count, move |take| contacts(&mut |c| take(of(c))));
}
