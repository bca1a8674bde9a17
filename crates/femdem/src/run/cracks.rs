//! Cracks of the bodies of a run: files, and a summary.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use femdem_mesh::{Point3, Vector3};
use femdem_solve::fem::fracture::FractureMode;
use femdem_view::output::cracks;
use femdem_view::{CrackEvent, CrackFacet, CrackMode, Fracture};
use serde::{Deserialize, Serialize};

use super::history::HISTORY_COLUMNS;
use super::pieces::BreakableBody;
use super::{Run, Simulation};
use crate::Error;

/// The breakable bodies of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FractureSummary {
    /// Number of breakable bodies.
    pub bodies: usize,
    /// Number of their pieces.
    pub fragments: usize,
    /// Mass of the largest piece over that of all.
    pub largest_share: f64,
    /// Area of the facets that are cut, broken ones included, without loads \[m²\].
    pub cut_area: f64,
    /// Area of the facets that nothing holds any more \[m²\].
    pub broken_area: f64,
    /// Largest stress over strength at the last look.
    pub highest: f64,
}

impl Simulation {
    /// The cracks of the breakable bodies now.
    #[must_use]
    pub fn crack_facets(&self) -> Vec<CrackFacet> {
        let bodies = self.breakable_bodies();
        bodies.flat_map(|body| body.facets()).collect()
    }

    /// The facets that have broken through, by time. The place is that in the body where the scene puts it.
    #[must_use]
    pub fn crack_events(&self) -> Vec<CrackEvent> {
        let bodies = self.breakable_bodies();
        let mut events: Vec<CrackEvent> = bodies.flat_map(|body| body.events()).collect();
        events.sort_by(|a, b| a.time.total_cmp(&b.time));
        events
    }

    /// Writes the cracks as a VTP file.
    ///
    /// # Errors
    ///
    /// If writing fails, or a number is not finite.
    pub fn write_cracks(&self, writer: impl Write) -> io::Result<()> {
        cracks::write(&self.crack_facets(), writer)
    }

    /// The breakable bodies in numbers; `None` without any.
    #[must_use]
    pub fn fracture_summary(&self) -> Option<FractureSummary> {
        let mut summary = FractureSummary {
            bodies: 0,
            fragments: 0,
            largest_share: 0.0,
            cut_area: 0.0,
            broken_area: 0.0,
            highest: 0.0,
        };
        let (mut mass, mut largest) = (0.0, 0.0_f64);
        for body in self.breakable_bodies() {
            summary.bodies += usize::from(body.entry.of.is_none());
            summary.highest = summary.highest.max(body.cracks.highest());
            for piece in body.pieces() {
                summary.fragments += 1;
                mass += piece.mass;
                largest = largest.max(piece.mass);
            }
            for facet in body.all() {
                let area = area(&facet);
                summary.cut_area += area;
                if facet.end.is_some() {
                    summary.broken_area += area;
                }
            }
        }
        for (_, member, _) in self.adaptive_rigid() {
            let own = self.world.mass(member.id).unwrap_or(0.0);
            summary.bodies += 1;
            summary.fragments += 1;
            mass += own;
            largest = largest.max(own);
        }
        summary.largest_share = largest / mass;
        (summary.bodies > 0).then_some(summary)
    }
}

impl BreakableBody<'_> {
    /// The facets that are cut, those whose sides have become skin first; those to another body at one of both.
    fn all(&self) -> impl Iterator<Item = femdem_solve::CrackFacet> {
        let own = |facet: &femdem_solve::CrackFacet| facet.tets[0].is_some();
        self.with_shared().filter(own)
    }

    /// The same at both bodies.
    fn with_shared(&self) -> impl Iterator<Item = femdem_solve::CrackFacet> {
        let spent = self.cracks.spent().iter().copied();
        spent.chain(self.cracks.facets())
    }

    fn facets(&self) -> Vec<CrackFacet> {
        let facet = |facet: femdem_solve::CrackFacet| CrackFacet {
            body: self.first,
            points: facet.corners.map(Point3::from),
            opening: facet.opening,
            slip: facet.slip,
            damage: facet.damage.clamp(0.0, 1.0),
            mode: mode(facet.mode),
            birth: facet.birth,
            dissipated: facet.taken.max(0.0),
        };
        self.all().map(facet).collect()
    }

    fn events(&self) -> Vec<CrackEvent> {
        let pose = self.entry.placed;
        let event = |facet: femdem_solve::CrackFacet| {
            Some(CrackEvent {
                time: facet.end?,
                point: pose * Point3::from(facet.place.iter().sum::<Vector3>() / 3.0),
                energy: facet.taken.max(0.0),
                mode: mode(facet.mode),
            })
        };
        self.all().filter_map(event).collect()
    }

    /// For each tetrahedron the largest damage of its facets.
    pub fn damage(&self) -> Vec<f64> {
        let mut damage = vec![0.0_f64; self.body.model().volumes().len()];
        for facet in self.with_shared() {
            for tet in facet.tets.into_iter().flatten() {
                let of_tet = &mut damage[tet as usize];
                *of_tet = of_tet.max(facet.damage.clamp(0.0, 1.0));
            }
        }
        damage
    }
}

/// Area of a facet without loads \[m²\].
fn area(facet: &femdem_solve::CrackFacet) -> f64 {
    let [a, b, c] = facet.place;
    0.5 * (b - a).cross(&(c - a)).norm()
}

fn mode(mode: FractureMode) -> CrackMode {
    match mode {
        FractureMode::Tension => CrackMode::Tension,
        FractureMode::Shear => CrackMode::Shear,
    }
}

impl Run {
    /// What a report shows of fracture; `None` without breakable bodies. The energy over time is what cracks have dissipated and
    /// hold, less what they were lent, from the `history.csv` of `folder`, and none without this file.
    ///
    /// # Errors
    ///
    /// [`Error::Analysis`] for a piece that cannot be measured.
    pub fn fracture(&self, folder: &Path) -> Result<Option<Fracture>, Error> {
        let Some(fragmentation) = self.simulation().fragmentation()? else {
            return Ok(None);
        };
        let history = fs::read_to_string(folder.join("history.csv")).unwrap_or_default();
        let column = |name: &str| HISTORY_COLUMNS.iter().position(|known| *known == name);
        let energy = |line: &str| {
            let fields: Vec<&str> = line.split(',').collect();
            let value = |name| fields.get(column(name)?)?.parse::<f64>().ok();
            // What cracks hold is given back or broken later.
            let taken = value("dissipated_fracture")? + value("cracks")? - value("lent")?;
            Some([value("time")?, taken])
        };
        Ok(Some(Fracture {
            fragmentation: Some(fragmentation),
            dissipated: history.lines().skip(1).filter_map(energy).collect(),
            cracks: self.simulation().crack_facets(),
        }))
    }
}
