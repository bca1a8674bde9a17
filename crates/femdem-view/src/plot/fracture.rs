//! Plots of fracture: sizes of fragments, energy, directions of cracks.

use femdem_analysis::{Fragmentation, SizeFit, SizeLaw, StereonetOptions, stereonet};

use super::axis::Axis;
use super::chart::{Chart, Hue};
use super::net;
use super::svg::Plot;
use crate::Fracture;
use crate::output::short_number;

/// Most steps of the curve that are drawn.
const STEPS: usize = 500;

/// Fewest facets whose directions are drawn.
const FACETS: usize = 10;

/// The plots of what is known of fracture, in the order of the report.
#[must_use]
pub fn fracture_plots(fracture: &Fracture) -> Vec<Plot> {
    let mut plots = Vec::new();
    plots.extend(fracture.fragmentation.as_ref().and_then(sizes));
    plots.extend(dissipated(&fracture.dissipated));
    plots.extend(normals(fracture));
    plots
}

/// The size curve with the laws.
fn sizes(found: &Fragmentation) -> Option<Plot> {
    let points = &found.curve.points;
    let (first, last) = (points.first()?, points.last()?);
    let x = Axis::log("size / m", points.iter().map(|point| point.size));
    let y = Axis::linear("part of the mass that passes", 0.0, 1.04);
    let mut chart = Chart::new(x, y);
    chart.key_at_left();
    let every = points.len().div_ceil(STEPS);
    let mut steps: Vec<[f64; 2]> = Vec::with_capacity(2 * STEPS);
    // From the largest down, so that it is drawn.
    for point in points.iter().rev().step_by(every) {
        if let Some([above, _]) = steps.last().copied() {
            steps.push([above, point.passing]);
        }
        steps.push([point.size, point.passing]);
    }
    steps.push([first.size, 0.0]);
    chart.line(Hue::Ink, &steps);
    chart.name(Hue::Ink, "measured");
    let (low, high) = (first.size / 1.5, last.size * 1.5);
    let curve = |fit: &SizeFit| -> Vec<[f64; 2]> {
        let size = |k: u32| low * (high / low).powf(f64::from(k) / 100.0);
        (0..=100).map(|k| [size(k), fit.passing(size(k))]).collect()
    };
    let mut told = String::new();
    let fits = [
        (Hue::First, &found.rosin_rammler),
        (Hue::Second, &found.gaudin_schuhmann),
    ];
    for (hue, fit) in fits {
        let Some(fit) = fit else { continue };
        chart.line(hue, &curve(fit));
        chart.name(hue, fit.law.name());
        told.push_str(&words(fit));
    }
    let thinned = match every {
        1 => String::new(),
        _ => format!(" (one size of {every} is drawn)"),
    };
    let caption = format!(
        "Part of the mass in fragments up to a size, for {} fragments{thinned}.{told}",
        found.pieces
    );
    let title = "Sizes of the fragments";
    Some(Plot::of("fragment-sizes", title, caption, chart))
}

/// Such as " Rosin-Rammler: n = 1.2 (1.1 to 1.3), d63 = 0.02 m (0.018 to 0.022), off by 0.03 at most."
fn words(fit: &SizeFit) -> String {
    let (exponent, size) = match fit.law {
        SizeLaw::RosinRammler => ("n", "d63"),
        SizeLaw::GaudinSchuhmann => ("m", "d_max"),
    };
    let range = |[low, high]: [f64; 2]| format!("{} to {}", short_number(low), short_number(high));
    format!(
        " {}: {exponent} = {} ({}), {size} = {} m ({}), off by {:.3} at most.",
        fit.law.name(),
        short_number(fit.exponent),
        range(fit.exponent_interval),
        short_number(fit.size),
        range(fit.size_interval),
        fit.distance
    )
}

/// The energy that fracture has taken, over time.
fn dissipated(points: &[[f64; 2]]) -> Option<Plot> {
    let (first, last) = (points.first()?, points.last()?);
    if last[0] <= first[0] || points.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    let x = Axis::linear("time / s", first[0], last[0]);
    let y = Axis::from_zero("energy / J", points.iter().map(|point| point[1]));
    let mut chart = Chart::new(x, y);
    chart.line(Hue::First, points);
    let caption = format!(
        "Energy that fracture has taken up to a time; {} J in the end.",
        short_number(last[1])
    );
    let title = "Energy of fracture";
    Some(Plot::of("fracture-energy", title, caption, chart))
}

/// The normals of the cracks on a net.
fn normals(fracture: &Fracture) -> Option<Plot> {
    let directions: Vec<[f64; 3]> = fracture
        .cracks
        .iter()
        .map(|facet| facet.normal().into())
        .filter(|normal: &[f64; 3]| normal.iter().any(|x| *x != 0.0))
        .collect();
    if directions.len() < FACETS {
        return None;
    }
    let net = stereonet(&directions, &StereonetOptions::default()).ok()?;
    let caption = format!(
        "Normals of {} crack facets{}",
        net.directions,
        net::legend(&net)
    );
    net::plot("crack-normals", "Directions of the cracks", caption, &net)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::crack;
    use femdem_analysis::{FragmentationOptions, fragmentation};

    fn found(pieces: u32) -> Fragmentation {
        let size = |k: u32| 0.01 * f64::from(k + 1) / f64::from(pieces);
        let pieces: Vec<(f64, f64)> = (0..pieces).map(|k| (size(k), 1.0)).collect();
        fragmentation(&pieces, &FragmentationOptions::default()).unwrap()
    }

    #[test]
    fn what_is_known_is_drawn_and_nothing_else() {
        assert!(fracture_plots(&Fracture::default()).is_empty());
        let known = Fracture {
            fragmentation: Some(found(50)),
            dissipated: vec![[0.0, 0.0], [0.1, 2.0]],
            cracks: vec![crack(0.0); FACETS],
        };
        let plots = fracture_plots(&known);
        let names: Vec<&str> = plots.iter().map(|plot| plot.name.as_str()).collect();
        assert_eq!(
            names,
            ["fragment-sizes", "fracture-energy", "crack-normals"]
        );
        let content = &plots[0].content;
        // Down and left at each of the 50 sizes but the smallest, which ends at 0.
        let line = content.lines().find(|l| l.contains("\"line ink\""));
        assert_eq!(line.unwrap().matches('L').count(), 2 * 49 + 1);
        assert!(content.contains(">Rosin-Rammler<") && content.contains(">Gaudin-Schuhmann<"));
        assert!(plots[0].caption.contains("m = ") && plots[1].caption.contains("2 J"));
        // Facets that have shrunk to a line have no normal.
        let mut thin = known;
        let corner = thin.cracks[0].points[0];
        thin.cracks[0].points = [corner; 3];
        assert_eq!(fracture_plots(&thin).len(), 2);
    }

    #[test]
    fn many_sizes_are_thinned_up_to_the_largest() {
        let plot = sizes(&found(1001)).unwrap();
        let line = plot.content.lines().find(|l| l.contains("\"line ink\""));
        assert!(line.unwrap().matches('L').count() < 2 * STEPS);
        assert!(plot.caption.contains("one size of 3"), "{}", plot.caption);
    }
}
