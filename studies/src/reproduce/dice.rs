//! Platonic solids compared with experiments on dice.

use anyhow::Result;

use super::Scale;
use super::case::{Case, Found, by_reading, find_recorded, with_error};
use super::dots::{Dot, Series, svg};
use super::job::Size;
use super::page::page;
use super::paper::{DICE, DICE_ERROR, solid};
use super::readings::{READINGS, Reading, explained};
use super::record::Record;
use super::runs::Runs;
use super::statistics::Estimate;
use crate::validate::report::{Report, markdown_table};

/// Friction coefficient, about that of plastic on plastic.
const FRICTION: f64 = 0.5;

/// The packs of the study: by reading, then solid.
pub(super) fn cases(scale: Scale) -> Vec<Case> {
    let mut cases = Vec::new();
    for reading in READINGS {
        for dice in DICE {
            let volume = solid(dice.name).map_or(0.0, |solid| solid.volume);
            let (size, seeds) = match scale {
                Scale::Quick => (Size::quick(volume), 1),
                Scale::Full => (Size::small(volume), 3),
            };
            let label = format!("{}, {}", dice.name, reading.key);
            cases.push(Case::new(
                label,
                (dice.name, size),
                FRICTION,
                seeds,
                reading.options,
            ));
        }
    }
    cases
}

/// # Errors
/// When the program fails or a file cannot be written.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let record = Record::of(runs, "dice", scale)?;
    let all = find_recorded(runs, &cases(scale), &record)?;
    let readings = by_reading(&all, DICE.len());
    let text = format!(
        "Platonic solids at friction {FRICTION} beside random loose and random close packs of plastic dice (J. Baker and \
         A. Kudrolli, Phys. Rev. E 82, 061304, 2010; ±{DICE_ERROR}).\n\n{}\n\
         In brackets the place between loose (0) and close (1), with its standard error.\n\n{}\n![Chart](dice.svg)\n",
        explained(),
        table(&readings)
    );
    let title = "Platonic solids beside experiments on dice".to_owned();
    let mut report = page("dice", title, text, &all);
    runs.attach(&mut report, "dice.svg", &chart(&readings))?;
    Ok(report)
}

fn table(readings: &[(Reading, &[Found])]) -> String {
    let mut heads = vec!["solid", "loose", "close"];
    heads.extend(readings.iter().map(|(reading, _)| reading.key));
    let rows: Vec<Vec<String>> = DICE
        .iter()
        .enumerate()
        .map(|(place, dice)| {
            let cell = |(_, found): &(Reading, &[Found])| {
                let density = found.get(place).and_then(Found::density);
                let part = density.map_or_else(String::new, |density| {
                    let (part, error) = between(density, dice.loose, dice.close);
                    format!(" ({part:.2} ± {error:.2})")
                });
                with_error(density, 3) + &part
            };
            let mut row = vec![
                dice.name.to_owned(),
                dice.loose.to_string(),
                dice.close.to_string(),
            ];
            row.extend(readings.iter().map(cell));
            row
        })
        .collect();
    markdown_table(&heads, &rows)
}

/// Position of a density between two others that have an error of `DICE_ERROR` each, and its standard error.
fn between(density: Estimate, low: f64, high: f64) -> (f64, f64) {
    let range = high - low;
    let part = (density.mean - low) / range;
    let ends = DICE_ERROR * (1.0 - part).hypot(part);
    let own = if density.error.is_finite() {
        density.error
    } else {
        0.0
    };
    (part, own.hypot(ends) / range)
}

fn chart(readings: &[(Reading, &[Found])]) -> String {
    let published = |name: &str, value: fn(&super::paper::Dice) -> f64| Series {
        name: name.to_owned(),
        dots: (0..)
            .zip(&DICE)
            .map(|(place, dice)| Dot {
                place,
                value: value(dice),
                error: DICE_ERROR,
            })
            .collect(),
    };
    let mut series = vec![
        published("loose", |d| d.loose),
        published("close", |d| d.close),
    ];
    for (reading, found) in readings {
        series.push(Series::of_reading(reading, found));
    }
    let names: Vec<&str> = DICE.iter().map(|dice| dice.name).collect();
    svg(["solid", "packing density"], &names, &series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_zero_and_one_with_the_error_of_the_experiment() {
        let at = |mean, error| {
            let density = Estimate {
                mean,
                error,
                count: 1,
            };
            between(density, 0.5, 0.6)
        };
        let (part, error) = at(0.5, 0.0);
        assert!(part.abs() < 1e-12 && (error - 0.1).abs() < 1e-9);
        let (part, error) = at(0.6, f64::NAN);
        assert!((part - 1.0).abs() < 1e-12 && (error - 0.1).abs() < 1e-9);
        assert!((at(0.55, 0.01).1 - (1.5_f64).sqrt() * 0.1).abs() < 1e-9);
    }
}
