//! A frame of a simulation, in files for ParaView.
//!
//! Deformable bodies are tetrahedra (VTK type 10) or quadratic tetrahedra (24), all in one grid.
//! Point data: `displacement` (m, from where the body was placed), `velocity` (m/s). Cell data: `body`
//! (number among the members), `region`, `von_mises`, `pressure` (Pa, positive in compression),
//! `principal_stress` (Pa, three components, largest first), `stress` (Pa, the components xx, yy, zz, xy, yz
//! and xz, tension positive), `volume_ratio`, `sleeping` (1 where the body is frozen), `plastic_strain` where a material has
//! one, and where bodies may break `fragment` (the row of `fragments.csv`, −1 of others) and `damage` (the largest of the facets).

use std::io::{self, Write};

use femdem_fem::ElementStress;
use femdem_mesh::Vector3;
use femdem_solve::{Deformable, SolveError};
use femdem_view::output::vtk::Document;
use femdem_view::output::vtu;

use super::contacts::{ContactLine, Side};
use super::{Member, Simulation};
use crate::{Body, Error, NamedShape, Snapshot};

const VTK_TETRA: u8 = 10;
const VTK_QUADRATIC_TETRA: u8 = 24;

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
        write_grid(&bodies, cracks.as_ref(), writer)
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

fn write_grid(
    bodies: &[Strained],
    cracks: Option<&CracksOfTets>,
    writer: impl Write,
) -> io::Result<()> {
    let points: usize = bodies.iter().map(|b| b.body.positions().len()).sum();
    let cells: usize = bodies.iter().map(|b| b.stresses.len()).sum();
    let mut out = Document::new("UnstructuredGrid");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<Points>"
    ));
    let positions = bodies.iter().flat_map(|b| b.body.positions());
    out.floats("points", 3, positions.flat_map(|x| <[f64; 3]>::from(*x)));
    out.line("</Points>\n<Cells>");
    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    let mut first = 0;
    for body in bodies {
        let model = body.body.model();
        let kind = if model.element().is_quadratic() {
            VTK_QUADRATIC_TETRA
        } else {
            VTK_TETRA
        };
        for nodes in model.elements() {
            // The order of the nodes is VTK's.
            connectivity.extend(nodes.iter().map(|&node| first + i64::from(node)));
            offsets.push(connectivity.len() as i64);
            types.push(kind);
        }
        first += model.nodes().len() as i64;
    }
    out.integers("connectivity", connectivity);
    out.integers("offsets", offsets);
    out.bytes("types", types);
    out.line("</Cells>\n<PointData Vectors=\"displacement\">");
    point_data(&mut out, bodies);
    out.line("</PointData>\n<CellData Scalars=\"von_mises\">");
    cell_data(&mut out, bodies);
    if let Some(CracksOfTets { fragment, damage }) = cracks {
        out.integers("fragment", fragment.iter().copied());
        out.floats("damage", 1, damage.iter().copied());
    }
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

fn point_data<'a>(out: &mut Document<'a>, bodies: &'a [Strained]) {
    let displacement = |b: &Strained| -> Vec<f64> {
        let pose = b.entry.placed;
        let nodes = b.body.positions().iter().zip(b.body.model().nodes());
        let moved =
            nodes.map(|(x, reference)| x - (pose.rotation * reference + pose.translation.vector));
        moved.flat_map(<[f64; 3]>::from).collect()
    };
    out.floats("displacement", 3, bodies.iter().flat_map(displacement));
    let velocities = bodies.iter().flat_map(|b| b.body.velocities());
    out.floats("velocity", 3, velocities.flat_map(|v| <[f64; 3]>::from(*v)));
}

fn cell_data<'a>(out: &mut Document<'a>, bodies: &'a [Strained]) {
    let number = |b: &Strained| vec![b.member as i64; b.stresses.len()];
    out.integers("body", bodies.iter().flat_map(number));
    let regions = bodies.iter().flat_map(|b| b.body.model().region_of_tet());
    out.integers("region", regions.map(|r| i64::from(*r)));
    let stresses = || bodies.iter().flat_map(|b| &b.stresses);
    out.floats("von_mises", 1, stresses().map(ElementStress::von_mises));
    out.floats("pressure", 1, stresses().map(ElementStress::pressure));
    out.floats(
        "principal_stress",
        3,
        stresses().flat_map(ElementStress::principal),
    );
    out.floats("stress", 6, stresses().flat_map(components));
    out.floats("volume_ratio", 1, stresses().map(|s| s.volume_ratio));
    let asleep = |b: &Strained| vec![u8::from(b.body.is_asleep()); b.stresses.len()];
    out.bytes("sleeping", bodies.iter().flat_map(asleep));
    if bodies.iter().any(|b| b.plastic_strains.is_some()) {
        let strains = |b: &Strained| {
            let zero = || vec![0.0; b.stresses.len()];
            b.plastic_strains.clone().unwrap_or_else(zero)
        };
        out.floats("plastic_strain", 1, bodies.iter().flat_map(strains));
    }
}

/// The stress in VTK's order of a symmetric tensor.
fn components(stress: &ElementStress) -> [f64; 6] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|place| stress.cauchy[place])
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
