//! Figure 6: packing density of truncated tetrahedra against friction.

use anyhow::{Context, Result};

use super::Scale;
use super::case::{Case, Found, beside, by_reading, find_recorded};
use super::dots::{Dot, Series, svg};
use super::job::{Kind, Size, kinds};
use super::page::{capital, page};
use super::paper::{FIGURE6, FIGURE6_ERROR, solid};
use super::readings::{READINGS, Reading, explained};
use super::record::Record;
use super::runs::Runs;
use super::statistics::spread;
use crate::validate::report::{Report, markdown_table};

const SHAPE: &str = "A1";

/// The packs of the study: by size, then reading, then friction.
pub(super) fn cases(scale: Scale) -> Vec<Case> {
    let volume = solid(SHAPE).map_or(0.0, |solid| solid.volume);
    let mut cases = Vec::new();
    for Kind { name, size, seeds } in kinds(scale) {
        let size = size(volume);
        for reading in READINGS {
            for (friction, _) in FIGURE6 {
                let label = format!(
                    "{SHAPE}, mu {friction}, {}, {}",
                    reading.key,
                    name.to_lowercase()
                );
                cases.push(Case::new(
                    label,
                    (SHAPE, size),
                    friction,
                    seeds,
                    reading.options,
                ));
            }
        }
    }
    cases
}

/// # Errors
/// When the program fails or a file cannot be written.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let volume = solid(SHAPE).context("the solid is not in the list")?.volume;
    let record = Record::of(runs, "figure6", scale)?;
    let all = find_recorded(runs, &cases(scale), &record)?;
    let mut text = format!(
        "Figure 6 of Xiang, Latham and Farsi (DEM7, 2016), read off to {FIGURE6_ERROR}: truncated tetrahedra (A1) at five \
         friction coefficients.\n\n{}\n\
         Cells are the density of the core with its standard error, and in brackets the difference to the paper, also in \
         combined standard errors s.\n",
        explained()
    );
    let mut pictures = Vec::new();
    let blocks = all.chunks(READINGS.len() * FIGURE6.len());
    for (Kind { name, size, seeds }, found) in kinds(scale).into_iter().zip(blocks) {
        let Size {
            bodies,
            width,
            inset,
        } = size(volume);
        let file = format!("figure6-{name}.svg");
        let readings = by_reading(found, FIGURE6.len());
        if readings.is_empty() {
            continue;
        }
        text += &format!(
            "\n## {} packs\n\n{bodies} bodies, box {width} d wide, core {inset} d from walls, floor and top, \
             seeds 1 to {seeds}.\n\n{}\n![Chart]({file})\n",
            capital(name),
            table(&readings)
        );
        pictures.push((file, chart(&readings)));
    }
    let title = "Figure 6: packing density against friction".to_owned();
    let mut report = page("figure6", title, text, &all);
    for (file, picture) in pictures {
        runs.attach(&mut report, &file, &picture)?;
    }
    Ok(report)
}

/// Rows by friction, columns by reading; below them the root mean square difference.
fn table(readings: &[(Reading, &[Found])]) -> String {
    let mut heads = vec!["friction", "paper"];
    heads.extend(readings.iter().map(|(reading, _)| reading.key));
    let mut rows: Vec<Vec<String>> = FIGURE6
        .iter()
        .enumerate()
        .map(|(place, (friction, density))| {
            let cell = |(_, found): &(Reading, &[Found])| {
                let density = Some((*density, FIGURE6_ERROR));
                found
                    .get(place)
                    .map_or_else(String::new, |f| beside(f.density(), density))
            };
            let mut row = vec![friction.to_string(), format!("{density:.4}")];
            row.extend(readings.iter().map(cell));
            row
        })
        .collect();
    let mut last = vec!["root mean square".to_owned(), String::new()];
    last.extend(readings.iter().map(|(_, found)| {
        let pairs = FIGURE6.iter().zip(*found);
        let differences: Vec<f64> = pairs
            .filter_map(|((_, paper), f)| Some(f.density()?.mean - paper))
            .collect();
        let told = |(size, mean): (f64, f64)| format!("{size:.3} (mean {mean:+.3})");
        spread(&differences).map_or_else(|| "not run".to_owned(), told)
    }));
    rows.push(last);
    markdown_table(&heads, &rows)
}

fn chart(readings: &[(Reading, &[Found])]) -> String {
    let places: Vec<String> = FIGURE6
        .iter()
        .map(|(friction, _)| friction.to_string())
        .collect();
    let names: Vec<&str> = places.iter().map(String::as_str).collect();
    let paper = |(place, (_, value)): (usize, &(f64, f64))| Dot {
        place,
        value: *value,
        error: FIGURE6_ERROR,
    };
    let mut series = vec![Series {
        name: "paper".to_owned(),
        dots: FIGURE6.iter().enumerate().map(paper).collect(),
    }];
    for (reading, found) in readings {
        series.push(Series::of_reading(reading, found));
    }
    svg(
        ["friction coefficient", "packing density of A1"],
        &names,
        &series,
    )
}

#[cfg(test)]
mod tests {
    use super::super::table1;
    use super::*;

    /// The packs at friction 0.6 are those of Table 1, and are made once.
    #[test]
    fn one_friction_is_shared_with_the_table() {
        let keys = |cases: Vec<Case>| -> std::collections::BTreeSet<String> {
            let jobs = cases.into_iter().flat_map(|case| case.jobs);
            jobs.map(|job| job.key()).collect()
        };
        for (scale, shared) in [
            (Scale::Full, READINGS.len() * 4),
            (Scale::Quick, READINGS.len()),
        ] {
            let (ours, table) = (keys(cases(scale)), keys(table1::cases(scale)));
            assert_eq!(ours.len(), shared * FIGURE6.len());
            assert_eq!(ours.intersection(&table).count(), shared);
        }
    }
}
