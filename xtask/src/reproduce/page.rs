//! What the pages of all studies have in common.

use anyhow::Result;

use super::case::{Found, cost};
use super::run::COLUMNS;
use super::runs::Runs;
use crate::validate::report::{Check, Report};

/// A page of packs: the text of a study, then cost, what is missing, and the table of runs.
pub(super) fn page(name: &'static str, title: String, text: String, found: &[Found]) -> Report {
    let missing: Vec<String> = found
        .iter()
        .filter(|f| f.missing > 0)
        .map(|f| format!("{} ({} of {})", f.case.label, f.missing, f.case.jobs.len()))
        .collect();
    let gaps = if missing.is_empty() {
        String::new()
    } else {
        format!("\n\nNot run: {}.", missing.join("; "))
    };
    Report {
        name,
        title,
        text: format!(
            "{text}\n\n{} Runs that were in the folder of runs already are used as they are; the last \
             column of the table of runs names the commit and the machine of each.{gaps}",
            cost(found)
        ),
        commands: found.iter().flat_map(|f| f.commands.clone()).collect(),
        checks: checks(found),
        columns: COLUMNS.to_vec(),
        rows: found.iter().flat_map(|f| f.rows.clone()).collect(),
        attachments: Vec::new(),
    }
}

fn checks(found: &[Found]) -> Vec<Check> {
    let restless: usize = found.iter().map(|f| f.restless).sum();
    let packs: usize = found.iter().map(|f| f.packs.len()).sum();
    let missing: usize = found.iter().map(|f| f.missing).sum();
    let penetration = found
        .iter()
        .flat_map(|f| &f.packs)
        .filter_map(|pack| pack.run.summary.number("penetration.mean_over_d").ok())
        .fold(0.0, f64::max);
    vec![
        Check::holds(
            "packs at rest with all bodies awake, no drag and no local damping; others do not count",
            "all",
            format!("{packs} of {}", packs + restless),
            restless == 0 && packs > 0,
        ),
        Check::holds("runs", "all", format!("{missing} missing"), missing == 0),
        Check::at_most("largest mean penetration over d", penetration, 0.005, ""),
    ]
}

impl Runs<'_> {
    /// Puts a picture beside a page.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn attach(&self, report: &mut Report, file: &str, svg: &str) -> Result<()> {
        let path = self.workshop().write(file, svg.as_bytes())?;
        report.attachments.push(path);
        Ok(())
    }
}
