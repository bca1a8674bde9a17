//! The files of a pack with stresses.

use std::fmt;
use std::io::Write as _;
use std::path::Path;

use femdem_analysis::{Cell, Table};
use femdem_fem::von_mises;
use femdem_solve::WorldRelaxed;
use femdem_view::output::write_file;
use serde::Serialize;

use super::{BodyMean, ResolveOptions, Resolved};
use crate::means::{COMPONENTS, median_and_largest};
use crate::{Drawing, Error};

/// The contents of `resolve.json`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ResolveSummary {
    /// Version of these keys.
    pub schema: u32,
    /// The options.
    pub options: ResolveOptions,
    /// Bodies, and their tetrahedra together.
    pub bodies: usize,
    /// See `bodies`.
    pub tetrahedra: usize,
    /// How the pack came to rest.
    pub relaxed: WorldRelaxed,
    /// Mean and largest displacement of the bodies' centroids by the relaxation \[m\].
    pub moves: [f64; 2],
    /// Mean over the bodies of the von Mises stress of the mean stress \[Pa\], and the largest of any
    /// element.
    pub von_mises: [f64; 2],
    /// Love-Weber with forces on nodes, compared with the elements: median and largest difference over the
    /// bodies.
    pub nodes_difference: [f64; 2],
    /// The same with forces at contact points.
    pub contacts_difference: [f64; 2],
}

impl Resolved {
    /// The summary.
    #[must_use]
    pub fn summary(&self, options: &ResolveOptions) -> ResolveSummary {
        let tetrahedra = |d: femdem_solve::Deformable| d.model().volumes().len();
        let count = self.bodies.len().max(1) as f64;
        let mean = self
            .bodies
            .iter()
            .map(|b| von_mises(&b.elements))
            .sum::<f64>()
            / count;
        let largest = self.bodies.iter().map(|b| b.largest_von_mises);
        let spread = |k: usize| median_and_largest(self.bodies.iter().map(|b| b.differences()[k]));
        ResolveSummary {
            schema: 1,
            options: *options,
            bodies: self.bodies.len(),
            tetrahedra: self.simulation.world.deformables().map(tetrahedra).sum(),
            relaxed: self.relaxed,
            moves: self.moves,
            von_mises: [mean, largest.fold(0.0, f64::max)],
            nodes_difference: spread(0),
            contacts_difference: spread(1),
        }
    }

    /// Writes `stress.vtu`, `contacts.vtp`, `stress.csv`, `stress.png` and `resolve.json` into a folder.
    ///
    /// # Errors
    ///
    /// [`Error::View`] for a file that cannot be written.
    pub fn write(
        &self,
        folder: &Path,
        options: &ResolveOptions,
        container: Option<&Drawing>,
    ) -> Result<ResolveSummary, Error> {
        let summary = self.summary(options);
        let simulation = &self.simulation;
        write_file(folder.join("stress.vtu"), |w| {
            simulation.write_deformables(w)
        })?;
        write_file(folder.join("contacts.vtp"), |w| {
            simulation.write_contacts(w)
        })?;
        write_file(folder.join("stress.csv"), |w| {
            BodyMeans(&self.bodies).write_csv(w)
        })?;
        let image = simulation.picture(container)?;
        write_file(folder.join("stress.png"), |w| image.write_png(w))?;
        write_file(folder.join("resolve.json"), |w| {
            serde_json::to_writer_pretty(&mut *w, &summary)?;
            writeln!(w)
        })?;
        Ok(summary)
    }
}

impl fmt::Display for ResolveSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let relaxed = &self.relaxed;
        let percent = |[median, most]: [f64; 2]| {
            format!(
                "median {:.2} %, largest {:.2} %",
                100.0 * median,
                100.0 * most
            )
        };
        let mut line = |name: &str, text: String| writeln!(f, "  {name:<20} {text}");
        line(
            "bodies",
            format!("{}, {} tetrahedra", self.bodies, self.tetrahedra),
        )?;
        line(
            "residual",
            format!(
                "{:.1e} of the mean contact force {:.3} N, after {} + {} steps",
                relaxed.residual, relaxed.mean_contact_force, relaxed.steps[0], relaxed.steps[1]
            ),
        )?;
        let [mean, largest] = self.moves;
        line(
            "moved",
            format!("{mean:.2e} m on average, {largest:.2e} m at most"),
        )?;
        line(
            "von Mises stress",
            format!(
                "mean {:.3e} Pa, largest of an element {:.3e} Pa",
                self.von_mises[0], self.von_mises[1]
            ),
        )?;
        line("Love-Weber, nodes", percent(self.nodes_difference))?;
        line("Love-Weber, points", percent(self.contacts_difference))
    }
}

/// The table of mean stresses.
struct BodyMeans<'a>(&'a [BodyMean]);

const COLUMNS: [&str; 21] = [
    "body",
    "volume_m3",
    "largest_von_mises_pa",
    "elements_xx_pa",
    "elements_yy_pa",
    "elements_zz_pa",
    "elements_yz_pa",
    "elements_zx_pa",
    "elements_xy_pa",
    "nodes_xx_pa",
    "nodes_yy_pa",
    "nodes_zz_pa",
    "nodes_yz_pa",
    "nodes_zx_pa",
    "nodes_xy_pa",
    "contacts_xx_pa",
    "contacts_yy_pa",
    "contacts_zz_pa",
    "contacts_yz_pa",
    "contacts_zx_pa",
    "contacts_xy_pa",
];

impl Table for BodyMeans<'_> {
    fn columns(&self) -> &'static [&'static str] {
        &COLUMNS
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.0.iter().enumerate().map(|(i, body)| {
            let mut row = vec![
                Cell::Count(i as u64),
                Cell::Number(body.volume),
                Cell::Number(body.largest_von_mises),
            ];
            for stress in [&body.elements, &body.nodes, &body.contacts] {
                row.extend(COMPONENTS.map(|place| Cell::Number(stress[place])));
            }
            row
        }))
    }
}
