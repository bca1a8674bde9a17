//! The section on fracture.

use super::facts::{KeyFigure, figures_html};
use super::section;
use crate::fracture::check_cracks;
use crate::output::short_number;
use crate::plot::fracture_plots;
use crate::{CrackMode, Fracture, ViewError};

/// Numbers and plots of what is known; empty without any.
pub(super) fn html(fracture: &Fracture) -> Result<String, ViewError> {
    check_cracks(&fracture.cracks)?;
    let lead = figures_html(&figures(fracture));
    Ok(section("Fracture", &lead, &fracture_plots(fracture)))
}

fn figures(fracture: &Fracture) -> Vec<KeyFigure> {
    let mut figures = Vec::new();
    let mut add = |label: &str, value: String, note: String| {
        let label = label.to_owned();
        figures.push(KeyFigure { label, value, note });
    };
    if let Some(found) = &fracture.fragmentation {
        let mass = format!("{} kg in all", short_number(found.mass));
        add("Fragments", found.pieces.to_string(), mass);
        if let Some(t10) = found.index(10.0) {
            let note = "of the mass passes a tenth of the size of the unbroken body";
            add("t10", format!("{:.1} %", 100.0 * t10), note.to_owned());
        }
    }
    if let Some([_, energy]) = fracture.dissipated.last() {
        let value = format!("{} J", short_number(*energy));
        add(
            "Energy of fracture",
            value,
            "taken up to the end".to_owned(),
        );
    }
    let broken = || fracture.cracks.iter().filter(|facet| facet.damage >= 1.0);
    if !fracture.cracks.is_empty() {
        let shear = broken().filter(|facet| facet.mode == CrackMode::Shear);
        let note = format!(
            "{} of them in shear; {} more are damaged",
            shear.count(),
            fracture.cracks.len() - broken().count()
        );
        add("Broken facets", broken().count().to_string(), note);
    }
    figures
}
