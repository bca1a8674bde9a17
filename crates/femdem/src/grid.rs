//! Tetrahedra with their stresses, in a file for ParaView.
//!
//! Deformable bodies are tetrahedra (VTK type 10) or quadratic tetrahedra (24), all in one grid.
//! Point data: `displacement` (m, from where the body was placed), `velocity` (m/s). Cell data: `body`
//! (number among the members), `region`, `von_mises`, `pressure` (Pa, positive in compression),
//! `principal_stress` (Pa, three components, largest first), `stress` (Pa, the components xx, yy, zz, xy, yz
//! and xz, tension positive), `volume_ratio`, `sleeping` (1 where the body is frozen), `plastic_strain` where a material has
//! one, and where bodies may break `fragment` (the row of `fragments.csv`, −1 of others) and `damage` (the largest of the facets).

use std::borrow::Cow;
use std::io::{self, Write};

use femdem_fem::{DeformableModel, ElementStress};
use femdem_mesh::{Pose, Vector3};
use femdem_view::output::vtk::Document;
use serde::{Deserialize, Serialize};

const VTK_TETRA: u8 = 10;
const VTK_QUADRATIC_TETRA: u8 = 24;

/// A body with its stresses.
#[derive(Serialize, Deserialize)]
pub(crate) struct GridBody<'a> {
    /// Its number in the file.
    pub number: usize,
    /// Where it was placed: from the coordinates of the model's mesh to the world.
    pub placed: Pose,
    pub mesh: GridMesh<'a>,
    pub positions: Cow<'a, [Vector3]>,
    /// Written if all bodies have them.
    pub velocities: Option<Cow<'a, [Vector3]>>,
    /// One for each element.
    pub stresses: Cow<'a, [ElementStress]>,
    pub is_asleep: bool,
    /// If a material has one.
    pub plastic_strains: Option<Cow<'a, [f64]>>,
}

impl GridBody<'_> {
    pub fn into_owned(self) -> GridBody<'static> {
        let owned = |list: Cow<'_, [Vector3]>| Cow::Owned(list.into_owned());
        GridBody {
            number: self.number,
            placed: self.placed,
            mesh: GridMesh {
                is_quadratic: self.mesh.is_quadratic,
                nodes: owned(self.mesh.nodes),
                elements: self.mesh.elements,
                regions: Cow::Owned(self.mesh.regions.into_owned()),
            },
            positions: owned(self.positions),
            velocities: self.velocities.map(owned),
            stresses: Cow::Owned(self.stresses.into_owned()),
            is_asleep: self.is_asleep,
            plastic_strains: self.plastic_strains.map(|s| Cow::Owned(s.into_owned())),
        }
    }
}

/// The tetrahedra of a body.
#[derive(Serialize, Deserialize)]
pub(crate) struct GridMesh<'a> {
    is_quadratic: bool,
    /// Where the nodes are without displacements.
    nodes: Cow<'a, [Vector3]>,
    /// The nodes of the elements, one after another, whose order is VTK's.
    elements: Vec<u32>,
    regions: Cow<'a, [u32]>,
}

impl<'a> GridMesh<'a> {
    pub fn of(model: &'a DeformableModel) -> Self {
        Self {
            is_quadratic: model.element().is_quadratic(),
            nodes: model.nodes().into(),
            elements: model.elements().flatten().copied().collect(),
            regions: model.region_of_tet().into(),
        }
    }

    /// Number of nodes of an element.
    fn nodes_of_element(&self) -> usize {
        if self.is_quadratic { 10 } else { 4 }
    }

    fn element_count(&self) -> usize {
        self.elements.len() / self.nodes_of_element()
    }
}

/// Passes on bodies.
pub(crate) type PassedBodies<'a> =
    dyn Fn(&mut dyn FnMut(&GridBody<'_>) -> io::Result<()>) -> io::Result<()> + 'a;

/// Writes bodies as a VTU file, with the cell data that `more` adds. They are passed on several times, and need not be in memory
/// together.
///
/// # Errors
///
/// If writing or passing on fails.
pub(crate) fn write_grid<'a>(
    bodies: &'a PassedBodies<'a>,
    writer: impl Write,
    more: impl FnOnce(&mut Document<'a>),
) -> io::Result<()> {
    let mut count = Counts::default();
    bodies(&mut |b| {
        count.points += b.positions.len();
        count.cells += b.stresses.len();
        count.corners += b.mesh.elements.len();
        count.still |= b.velocities.is_none();
        count.plastic |= b.plastic_strains.is_some();
        Ok(())
    })?;
    let (points, cells) = (count.points, count.cells);
    let mut out = Document::new("UnstructuredGrid");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<Points>"
    ));
    out.given_floats("points", 3, 3 * points, move |take| {
        bodies(&mut |b| vectors(b.positions.iter().copied(), take))
    });
    out.line("</Points>\n<Cells>");
    out.given_integers("connectivity", count.corners, move |take| {
        let mut first = 0;
        bodies(&mut |b| {
            let nodes = b.mesh.elements.iter();
            let (start, count) = (first, b.mesh.nodes.len() as i64);
            first += count;
            nodes
                .map(|node| start + i64::from(*node))
                .try_for_each(&mut *take)
        })
    });
    out.given_integers("offsets", cells, move |take| {
        let mut end = 0;
        bodies(&mut |b| {
            (0..b.mesh.element_count()).try_for_each(|_| {
                end += b.mesh.nodes_of_element();
                take(end as i64)
            })
        })
    });
    out.given_bytes("types", cells, move |take| {
        bodies(&mut |b| {
            let kind = match b.mesh.is_quadratic {
                true => VTK_QUADRATIC_TETRA,
                false => VTK_TETRA,
            };
            (0..b.mesh.element_count()).try_for_each(|_| take(kind))
        })
    });
    out.line("</Cells>\n<PointData Vectors=\"displacement\">");
    point_data(&mut out, bodies, &count);
    out.line("</PointData>\n<CellData Scalars=\"von_mises\">");
    cell_data(&mut out, bodies, &count);
    more(&mut out);
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

#[derive(Default)]
struct Counts {
    points: usize,
    cells: usize,
    /// Nodes of elements.
    corners: usize,
    /// Whether a body has no velocities, and whether one has plastic strains.
    still: bool,
    plastic: bool,
}

/// Takes a number.
type Take<'a> = dyn FnMut(f64) -> io::Result<()> + 'a;

fn vectors(vectors: impl Iterator<Item = Vector3>, take: &mut Take<'_>) -> io::Result<()> {
    vectors.flat_map(<[f64; 3]>::from).try_for_each(take)
}

fn point_data<'a>(out: &mut Document<'a>, bodies: &'a PassedBodies<'a>, count: &Counts) {
    out.given_floats("displacement", 3, 3 * count.points, move |take| {
        bodies(&mut |b| {
            let pose = b.placed;
            let nodes = b.positions.iter().zip(&*b.mesh.nodes);
            let moved = nodes
                .map(|(x, reference)| x - (pose.rotation * reference + pose.translation.vector));
            vectors(moved, take)
        })
    });
    if !count.still {
        out.given_floats("velocity", 3, 3 * count.points, move |take| {
            bodies(&mut |b| vectors(b.velocities.iter().flat_map(|v| v.iter()).copied(), take))
        });
    }
}

fn cell_data<'a>(out: &mut Document<'a>, bodies: &'a PassedBodies<'a>, count: &Counts) {
    let cells = count.cells;
    out.given_integers("body", cells, move |take| {
        bodies(&mut |b| b.stresses.iter().try_for_each(|_| take(b.number as i64)))
    });
    out.given_integers("region", cells, move |take| {
        bodies(&mut |b| b.mesh.regions.iter().try_for_each(|r| take(i64::from(*r))))
    });
    let mut of_stress = |name, of: fn(&ElementStress) -> f64| {
        out.given_floats(name, 1, cells, move |take| {
            bodies(&mut |b| b.stresses.iter().map(of).try_for_each(&mut *take))
        });
    };
    of_stress("von_mises", ElementStress::von_mises);
    of_stress("pressure", ElementStress::pressure);
    out.given_floats("principal_stress", 3, 3 * cells, move |take| {
        bodies(&mut |b| {
            let mut all = b.stresses.iter().flat_map(ElementStress::principal);
            all.try_for_each(&mut *take)
        })
    });
    out.given_floats("stress", 6, 6 * cells, move |take| {
        bodies(&mut |b| {
            b.stresses
                .iter()
                .flat_map(components)
                .try_for_each(&mut *take)
        })
    });
    out.given_floats("volume_ratio", 1, cells, move |take| {
        bodies(&mut |b| b.stresses.iter().try_for_each(|s| take(s.volume_ratio)))
    });
    out.given_bytes("sleeping", cells, move |take| {
        bodies(&mut |b| {
            b.stresses
                .iter()
                .try_for_each(|_| take(u8::from(b.is_asleep)))
        })
    });
    if count.plastic {
        out.given_floats("plastic_strain", 1, cells, move |take| {
            bodies(&mut |b| match &b.plastic_strains {
                Some(strains) => strains.iter().copied().try_for_each(&mut *take),
                None => b.stresses.iter().try_for_each(|_| take(0.0)),
            })
        });
    }
}

/// The stress in VTK's order of a symmetric tensor.
fn components(stress: &ElementStress) -> [f64; 6] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|place| stress.cauchy[place])
}
