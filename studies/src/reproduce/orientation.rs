//! Orientations: stereonets of a pack of cylinders and of the faces of truncated dodecahedra.

use anyhow::{Context, Result};

use super::Scale;
use super::case::{Case, Found, find};
use super::job::Size;
use super::pack::Pack;
use super::page::page;
use super::paper::solid;
use super::runs::Runs;
use crate::validate::report::{Report, markdown_table};

const FRICTION: f64 = 0.6;

/// Cylinders twice as high as wide; d is the diameter of the sphere around one.
const CYLINDER: &str = "cylinder:aspect=2";

/// Volume over d³ of such a cylinder, were it round: π/4 (1/√5)² (2/√5).
const CYLINDER_VOLUME: f64 = 0.1405;

/// The packs: label in file names, shape, volume over d³.
fn packs() -> [(&'static str, &'static str, f64); 2] {
    let a10 = solid("A10").map_or(0.0, |solid| solid.volume);
    [("cylinder", CYLINDER, CYLINDER_VOLUME), ("A10", "A10", a10)]
}

/// The packs of the study.
pub(super) fn cases(scale: Scale) -> Vec<Case> {
    let case = |(label, shape, volume): (&str, &str, f64)| {
        let size = match scale {
            Scale::Quick => Size::quick(volume),
            Scale::Full => Size::small(volume),
        };
        let seeds = if scale == Scale::Quick { 1 } else { 3 };
        Case::new(label.to_owned(), (shape, size), FRICTION, seeds, "")
    };
    packs().into_iter().map(case).collect()
}

/// # Errors
/// When the program fails or a file cannot be written.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let found = find(runs, &cases(scale))?;
    let mut text = introduction();
    let mut nets = Vec::new();
    for ((label, ..), found) in packs().iter().zip(&found) {
        text += &format!("\n## {label}\n\n{}\n", table(found)?);
        if let Some(pack) = found.packs.first() {
            let file = format!("orientation-{label}.svg");
            text += &format!("![Stereonet of {label}, seed 1]({file})\n");
            nets.push((file, pack.run.plot(runs.program(), "stereonet.svg")?));
        }
    }
    let title = "Orientations of bodies in packs".to_owned();
    let mut report = page("orientation", title, text, &found);
    for (file, picture) in nets {
        runs.attach(&mut report, &file, &picture)?;
    }
    Ok(report)
}

fn introduction() -> String {
    "Directions of all bodies of a pack on an equal-area net: of the axes of cylinders twice as long as wide, and of the \
     normals of the ten-sided faces of truncated dodecahedra. Against chance: the mean cos² of the angle to the vertical \
     (1/3 at random, with a standard error of √(4/45/N)); the nematic and cubatic order of 200 random packs; the deviation \
     of the nodes of the net in Kamb's standard errors.\n"
        .to_owned()
}

fn table(found: &Found) -> Result<String> {
    let mut rows = Vec::new();
    for (pack, seed) in found.packs.iter().zip(1..) {
        let analysis = &pack.analysis;
        let bodies = analysis.number("orientation.order.bodies");
        let cylinder = found.case.label == "cylinder";
        let order = if cylinder { "nematic" } else { "cubatic" };
        let number = |key: &str| analysis.number(&format!("orientation.order.{order}.{key}"));
        let (value, random, deviation) = (
            number("value"),
            number("random_mean"),
            number("random_deviation"),
        );
        let upright = analysis.number("orientation.order.fabric.tensor.2.2");
        let told = if cylinder {
            let error = (4.0 / 45.0 / bodies).sqrt();
            format!("{upright:.4} ({:+.1} s)", (upright - 1.0 / 3.0) / error)
        } else {
            "1/3 by symmetry".to_owned()
        };
        let (size, largest) = deviations(pack)?;
        rows.push(vec![
            seed.to_string(),
            bodies.to_string(),
            told,
            format!("{order} {value:.4}"),
            format!("{random:.4} ± {deviation:.4}"),
            format!("{:+.1} s", (value - random) / deviation),
            format!("{size:.2}"),
            format!("{largest:.1}"),
        ]);
    }
    let heads = [
        "seed",
        "bodies",
        "mean cos² to the vertical",
        "order",
        "random",
        "difference",
        "nodes, root mean square",
        "nodes, largest",
    ];
    Ok(markdown_table(&heads, &rows))
}

/// Root mean square and largest deviation of the nodes of the net, in standard errors.
fn deviations(pack: &Pack) -> Result<(f64, f64)> {
    let path = pack.analysis.tables.join("stereonet.csv");
    let text = std::fs::read_to_string(&path)
        .with_context(|| format!("cannot read {}", path.display()))?;
    sigmas(&text).with_context(|| format!("{} has no column sigmas", path.display()))
}

fn sigmas(table: &str) -> Option<(f64, f64)> {
    let mut lines = table.lines();
    let column = lines.next()?.split(',').position(|name| name == "sigmas")?;
    let values: Vec<f64> = lines
        .filter_map(|line| line.split(',').nth(column)?.parse().ok())
        .collect();
    let squares: f64 = values.iter().map(|v| v * v).sum();
    let largest = values.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    (!values.is_empty()).then(|| ((squares / values.len() as f64).sqrt(), largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_read_from_their_column() {
        let (size, largest) = sigmas("x,sigmas,y\n0,3,1\n0,-4,1\n").unwrap();
        assert!((size - 12.5_f64.sqrt()).abs() < 1e-12 && largest == 4.0);
        assert_eq!(sigmas("x,y\n1,2\n"), None);
        assert_eq!(sigmas("sigmas\n"), None);
    }

    #[test]
    fn a_cylinder_twice_as_long_as_wide_has_this_volume() {
        // Inscribed in a sphere of diameter 1: width w, height 2 w, 5 w² = 1.
        let width = 0.2_f64.sqrt();
        let volume = std::f64::consts::PI / 4.0 * width.powi(2) * 2.0 * width;
        assert!((volume - CYLINDER_VOLUME).abs() < 1e-4);
    }
}
