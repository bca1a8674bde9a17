//! Plots of the tables of a pack, as SVG: for the report, and as files for papers.
//!
//! Every plot has a title, units at its axes, and a caption that explains it. Colours are taken from a style
//! sheet, so that the same SVG follows the light or dark scheme of a page.
//!
//! The writer is our own, because plots here need a style sheet, texts for screen readers, and text that stays
//! text; plotters uses fixed colours and positions text by estimated widths.

mod axis;
mod chart;
mod forces;
mod fracture;
mod lines;
mod net;
mod profiles;
mod structure;
mod svg;
mod sweep;

pub use fracture::fracture_plots;
pub use lines::LineChart;
pub use svg::Plot;
pub(crate) use svg::{STYLE, escape};
pub use sweep::{Series, sweep};

use crate::tables::Tables;

/// The plots for which tables exist, in the order of the report.
#[must_use]
pub fn plots(tables: &Tables) -> Vec<Plot> {
    let mut plots = Vec::new();
    plots.extend(structure::sieve(tables));
    plots.extend(profiles::height(tables));
    plots.extend(profiles::wall(tables));
    plots.extend(profiles::radial(tables));
    plots.extend(structure::local_density(tables));
    plots.extend(net::stereonet(tables));
    plots.extend(structure::tilt(tables));
    plots.extend(structure::coordination(tables));
    plots.extend(structure::classes(tables));
    plots.extend(forces::distribution(tables));
    plots.extend(forces::thresholds(tables));
    plots.extend(forces::chains(tables));
    plots.extend(forces::stress(tables));
    plots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::TableOptions;
    use crate::testing::two_cubes;

    fn two() -> Vec<Plot> {
        plots(&Tables::compute(&two_cubes(), &TableOptions::default()).unwrap())
    }

    /// Distances at which fewer than 5 pairs are expected are neither in the line nor in the band.
    #[test]
    fn the_radial_distribution_is_drawn_where_pairs_are_expected() {
        let mut tables = Tables::compute(&two_cubes(), &TableOptions::default()).unwrap();
        let found = tables.radial_distribution.as_mut().unwrap();
        found.bins.truncate(6);
        let values = [900.0, 1.0, 2.0, 1.5, 700.0, f64::NAN];
        for (bin, (value, expected)) in
            found
                .bins
                .iter_mut()
                .zip(values.into_iter().zip([4.9, 5.0, 80.0, 6.0, 0.0, f64::NAN]))
        {
            (bin.value, bin.expected, bin.standard_error) = (value, expected, Some(0.1));
        }
        let radial = |tables: &Tables| plots(tables).into_iter().find(|p| p.name == "radial");
        let plot = radial(&tables).unwrap();
        let line = plot.content.lines().find(|l| l.contains("\"line first\""));
        assert_eq!(line.unwrap().matches('L').count(), 2, "{}", plot.content);
        assert!(!plot.content.contains("900") && plot.caption.contains("fewer than 5 pairs"));
        let found = tables.radial_distribution.as_mut().unwrap();
        found.bins.iter_mut().for_each(|bin| bin.expected = 4.0);
        assert!(radial(&tables).is_none());
    }

    #[test]
    fn two_cubes_have_a_histogram_of_coordination_that_is_well_formed() {
        let plots = two();
        let plot = plots
            .iter()
            .find(|plot| plot.name == "coordination")
            .unwrap();
        let svg = plot.svg();
        assert!(svg.contains("1 partners: 1 bodies") && svg.contains("2 partners: 1 bodies"));
        for name in ["svg", "text", "g", "rect", "desc"] {
            let opened = svg.matches(&format!("<{name} ")).count()
                + svg.matches(&format!("<{name}>")).count();
            assert_eq!(opened, svg.matches(&format!("</{name}>")).count(), "{name}");
        }
    }

    /// Two cubes, one twice as large: a step at each size, up to a ninth and to all of the volume.
    #[test]
    fn sizes_are_drawn_as_a_sieve_curve_if_they_differ() {
        assert!(two().iter().all(|plot| plot.name != "sieve"));
        let mut snapshot = two_cubes();
        let mut large = snapshot.shapes[0].clone();
        large.polyhedron = large.polyhedron.scaled(2.0).unwrap();
        snapshot.shapes.push(large);
        snapshot.bodies[1].shape = 1;
        snapshot.masses.clear();
        let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
        let curve = tables.sieve.as_ref().unwrap();
        assert!((curve.points[0].passing - 1.0 / 9.0).abs() < 1e-12);
        let plots = plots(&tables);
        let plot = plots.iter().find(|plot| plot.name == "sieve").unwrap();
        let line = plot.content.lines().find(|l| l.contains("\"line first\""));
        assert_eq!(line.unwrap().matches('L').count(), 3, "{}", plot.content);
    }

    #[test]
    fn a_file_holds_its_style_and_white_paper() {
        let mut bytes = Vec::new();
        two()[0].write_svg(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.starts_with("<?xml") && text.contains("<style>") && text.contains("#ffffff"));
    }
}
