//! Bonds in the results of a run.

use std::collections::BTreeSet;
use std::io::{self, Write};

use femdem_contact::bond::Bond;
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
    /// Whether the scene has bonds.
    pub(super) fn has_bonds(&self) -> bool {
        self.world.bonds().next().is_some()
    }

    /// Numbers of bonds that are not broken and that are.
    pub(super) fn bond_counts(&self) -> [usize; 2] {
        let broken = self.world.bonds().filter(|(_, b)| b.is_broken()).count();
        [self.world.bonds().count() - broken, broken]
    }

    /// The bodies that were ever bonded, by the pieces that bonds hold together, each ascending.
    #[must_use]
    pub fn bonded_pieces(&self) -> Vec<Vec<BodyId>> {
        let bonds = || self.world.bonds();
        let bodies: BTreeSet<BodyId> = bonds().flat_map(|(_, bond)| bond.bodies()).collect();
        let mut piece: Vec<(BodyId, usize)> = bodies.iter().copied().zip(0..).collect();
        let at = |body: BodyId, piece: &[(BodyId, usize)]| {
            piece.binary_search_by_key(&body, |entry| entry.0).ok()
        };
        for (_, bond) in bonds().filter(|(_, bond)| !bond.is_broken()) {
            let [a, b] = bond.bodies();
            if let (Some(a), Some(b)) = (at(a, &piece), at(b, &piece)) {
                let (to, from) = (piece[a].1.min(piece[b].1), piece[a].1.max(piece[b].1));
                for entry in piece.iter_mut().filter(|entry| entry.1 == from) {
                    entry.1 = to;
                }
            }
        }
        let numbers: BTreeSet<usize> = piece.iter().map(|entry| entry.1).collect();
        let of = |number: &usize| {
            let own = piece.iter().filter(|entry| entry.1 == *number);
            own.map(|entry| entry.0).collect()
        };
        numbers.iter().map(of).collect()
    }

    /// The bonds in numbers; `None` without any.
    #[must_use]
    pub fn bond_summary(&self) -> Option<BondSummary> {
        let bonds: Vec<&Bond> = self.world.bonds().map(|(_, bond)| bond).collect();
        let broken = || bonds.iter().filter(|bond| bond.is_broken());
        let mass = |piece: &Vec<BodyId>| -> f64 {
            piece.iter().filter_map(|id| self.world.mass(*id)).sum()
        };
        let pieces = self.bonded_pieces();
        let masses: Vec<f64> = pieces.iter().map(mass).collect();
        (!bonds.is_empty()).then(|| BondSummary {
            count: bonds.len(),
            whole: bonds.iter().filter(|bond| !bond.has_yielded()).count(),
            broken: broken().count(),
            broken_area: 0.0 + broken().map(|bond| bond.area()).sum::<f64>(),
            pieces: pieces.len(),
            largest_share: masses.iter().copied().fold(0.0, f64::max) / masses.iter().sum::<f64>(),
        })
    }

    /// Writes `bonds.csv`, one bond per line. Forces in N, moments in N m; `tension` is the largest normal traction, Pa.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_bonds(&self, mut writer: impl Write) -> io::Result<()> {
        writeln!(writer, "{}", BOND_COLUMNS.join(","))?;
        let pieces = self.bonded_pieces();
        for (id, bond) in self.world.bonds() {
            let [a, b] = bond.bodies().map(|id| quoted(&self.name_of_body(id)));
            let state = bond.state();
            let parts = |v: &femdem_mesh::Vector3| {
                let along = v.dot(&state.normal);
                [along, (v - state.normal * along).norm()]
            };
            let ([normal, shear], [twist, bend]) = (parts(&state.force), parts(&state.moment));
            let first = bond.bodies()[0];
            let piece = pieces.iter().position(|piece| piece.contains(&first));
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
                piece.unwrap_or_default(),
            )?;
        }
        Ok(())
    }

    fn name_of_body(&self, id: BodyId) -> String {
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
            let all = bond.facets(self.world.motions_of(bond));
            let facet = |(corners, [opening, slip], damage, area): ([_; 3], [f64; 2], f64, f64)| {
                CrackFacet {
                    body: id,
                    points: corners.map(Point3::from),
                    opening,
                    slip,
                    damage: damage.clamp(0.0, 1.0),
                    mode,
                    birth: 0.0,
                    dissipated: bond.lost().glue.max(0.0) * area / bond.area(),
                }
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
