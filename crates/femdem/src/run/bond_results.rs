//! Bonds in the results of a run.

use std::collections::BTreeMap;
use std::io::{self, Write};

use femdem_contact::bond::{Bond, BondFacet};
use femdem_contact::{BodyId, BondId};
use femdem_mesh::Point3;
use femdem_view::output::{cracks, csv::quoted};
use femdem_view::{CrackFacet, CrackMode};
use serde::{Deserialize, Serialize};

use super::Simulation;
use super::contacts::Side;

/// Columns of `bonds.csv`.
pub const BOND_COLUMNS: [&str; 15] = [
    "bond",
    "body_a",
    "body_b",
    "area",
    "damage",
    "mode",
    "broken_at",
    "normal_force",
    "shear_force",
    "bending",
    "twisting",
    "tension",
    "energy",
    "dissipated",
    "piece",
];

/// The bonds of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondSummary {
    /// Number of bonds.
    pub count: usize,
    /// Those in which no point has given way.
    pub whole: usize,
    /// Those that nothing holds any more.
    pub broken: usize,
    /// Area of these \[m²\].
    pub broken_area: f64,
    /// Pieces of the bodies that were bonded: held together by bonds that are not broken.
    pub pieces: usize,
    /// Mass of the largest piece over that of all.
    pub largest_share: f64,
}

impl Simulation {
    /// Whether the scene has bonds; all of them may have left with their bodies.
    pub(super) fn has_bonds(&self) -> bool {
        self.world.bonds_added() > 0
    }

    /// Numbers of bonds that are not broken and that are.
    pub(super) fn bond_counts(&self) -> [usize; 2] {
        let broken = self.world.bonds().filter(|(_, b)| b.is_broken()).count();
        [self.world.bonds().count() - broken, broken]
    }

    /// The bonds in numbers; `None` in a scene without any. Those that left with their bodies do not count.
    #[must_use]
    pub fn bond_summary(&self) -> Option<BondSummary> {
        let bonds: Vec<&Bond> = self.world.bonds().map(|(_, bond)| bond).collect();
        let broken = || bonds.iter().filter(|bond| bond.is_broken());
        let mass = |piece: &Vec<BodyId>| -> f64 {
            piece.iter().filter_map(|id| self.world.mass(*id)).sum()
        };
        let pieces = self.world.bonded_pieces();
        let masses: Vec<f64> = pieces.iter().map(mass).collect();
        let all: f64 = masses.iter().sum();
        let largest = masses.iter().copied().fold(0.0, f64::max);
        self.has_bonds().then(|| BondSummary {
            count: bonds.len(),
            whole: bonds.iter().filter(|bond| !bond.has_yielded()).count(),
            broken: broken().count(),
            broken_area: 0.0 + broken().map(|bond| bond.area()).sum::<f64>(),
            pieces: pieces.len(),
            largest_share: if all > 0.0 { largest / all } else { 0.0 },
        })
    }

    /// Writes `bonds.csv`, one bond per line. Forces in N, moments in N m; `tension` is the largest normal traction, Pa.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_bonds(&self, mut writer: impl Write) -> io::Result<()> {
        writeln!(writer, "{}", BOND_COLUMNS.join(","))?;
        let pieces = self.world.bonded_pieces();
        let numbered = (0_usize..).zip(&pieces);
        let piece_of: BTreeMap<BodyId, usize> = numbered
            .flat_map(|(number, piece)| piece.iter().map(move |body| (*body, number)))
            .collect();
        let members = (0_usize..).zip(&self.members);
        let member_of: BTreeMap<BodyId, usize> = members
            .map(|(number, member)| (member.id, number))
            .collect();
        let name = |id: BodyId| {
            let member = member_of.get(&id);
            member.map_or_else(String::new, |member| self.name_of(Side::Member(*member)))
        };
        for (id, bond) in self.world.bonds() {
            let [a, b] = bond.bodies().map(|id| quoted(&name(id)));
            let state = bond.state();
            let parts = |v: &femdem_mesh::Vector3| {
                let along = v.dot(&state.normal);
                [along, (v - state.normal * along).norm()]
            };
            let ([normal, shear], [twist, bend]) = (parts(&state.force), parts(&state.moment));
            let piece = piece_of.get(&bond.bodies()[0]);
            let broken_at = bond.broken_at().map_or(String::new(), |t| t.to_string());
            writeln!(
                writer,
                "{id},{a},{b},{},{},{},{broken_at},{normal},{shear},{bend},{twist},{},{},{},{}",
                bond.area(),
                bond.damage(),
                bond.mode(),
                state.tension,
                state.energy,
                bond.lost().glue,
                piece.copied().unwrap_or_default(),
            )?;
        }
        Ok(())
    }

    pub(super) fn name_of_body(&self, id: BodyId) -> String {
        let member = self.members.iter().position(|member| member.id == id);
        member.map_or_else(String::new, |member| self.name_of(Side::Member(member)))
    }

    /// The triangles of the bonds that still act, as facets of cracks whose body is the number of the bond.
    #[must_use]
    pub fn bond_facets(&self) -> Vec<CrackFacet> {
        let alive = self.world.bonds().filter(|(_, bond)| !bond.has_ended());
        let facets = |(id, bond): (BondId, &Bond)| -> Vec<CrackFacet> {
            let mode = if bond.mode() > 0.5 {
                CrackMode::Shear
            } else {
                CrackMode::Tension
            };
            let motions = self.world.motions_of(id);
            let all = motions.map_or_else(Vec::new, |motions| bond.facets(motions));
            let facet = |facet: BondFacet| CrackFacet {
                body: id,
                points: facet.corners.map(Point3::from),
                opening: facet.opening,
                slip: facet.slip,
                damage: facet.damage.clamp(0.0, 1.0),
                mode,
                birth: 0.0,
                dissipated: bond.lost().glue.max(0.0) * facet.area / bond.area(),
            };
            all.into_iter().map(facet).collect()
        };
        alive.flat_map(facets).collect()
    }

    /// Writes them as a VTP file.
    ///
    /// # Errors
    ///
    /// If writing fails, or a number is not finite.
    pub fn write_bond_facets(&self, writer: impl Write) -> io::Result<()> {
        cracks::write(&self.bond_facets(), writer)
    }
}
