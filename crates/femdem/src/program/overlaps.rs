//! Warnings of bodies that a scene places into each other.

use femdem::run::Simulation;

/// Overlaps are named one by one up to this number.
const NAMED: usize = 5;

/// Reports deep overlaps after the first step, or after its failure.
pub(crate) fn warn(simulation: &Simulation, tell: impl Fn(&str)) {
    let deep = simulation.deep_overlaps();
    for pair in deep.iter().take(NAMED) {
        tell(&format!(
            "warning: \"{}\" and \"{}\" overlap at the start, {:.2e} m deep ({:.0} % of the smaller body's \
             diameter): they burst apart, or what is wholly in a wall falls through it; place them apart",
            pair.a,
            pair.b,
            pair.depth,
            100.0 * pair.share
        ));
    }
    if deep.len() > NAMED {
        let more = deep.len() - NAMED;
        tell(&format!("warning: {more} more pairs overlap as deeply"));
    }
}
