//! Table 1: packing densities of the solids.

use anyhow::Result;

use super::Scale;
use super::case::{Case, Found, beside, find_recorded, with_error};
use super::dots::{Dot, Series, svg};
use super::job::{Kind, kinds};
use super::page::{capital, page};
use super::paper::{ROUNDING, SOLIDS, Solid};
use super::readings::{READINGS, Reading, explained};
use super::record::Record;
use super::runs::Runs;
use super::statistics::spread;
use crate::validate::report::{Report, markdown_table};

/// Friction coefficient of the table.
const FRICTION: f64 = 0.6;

/// Packs of one kind and reading, a case for each solid.
struct Column {
    kind: &'static str,
    reading: Reading,
    cases: Vec<(Solid, Case)>,
}

/// By reading, then kind.
fn columns(scale: Scale) -> Vec<Column> {
    let kinds = || kinds(scale).into_iter();
    let of = |reading| kinds().map(move |kind| column(kind, reading, scale == Scale::Full));
    READINGS.into_iter().flat_map(of).collect()
}

/// `all`: include the solids for which the paper states no value.
fn column(kind: Kind, reading: Reading, all: bool) -> Column {
    let chosen = SOLIDS.iter().filter(|solid| all || solid.density.is_some());
    let case = |solid: &Solid| {
        let label = format!("{}, {}, {}", solid.name, reading.key, kind.name);
        let pack = (solid.name, (kind.size)(solid.volume));
        let case = Case::new(label, pack, FRICTION, kind.seeds, reading.options);
        (*solid, case)
    };
    Column {
        kind: kind.name,
        reading,
        cases: chosen.map(case).collect(),
    }
}

/// The packs of the study.
pub(super) fn cases(scale: Scale) -> Vec<Case> {
    let cases = columns(scale).into_iter().flat_map(|column| column.cases);
    cases.map(|(_, case)| case).collect()
}

/// # Errors
/// When the program fails or a file cannot be written.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let mut found = Vec::new();
    let record = Record::of(runs, "table1", scale)?;
    let columns = columns(scale);
    for column in &columns {
        let cases: Vec<Case> = column.cases.iter().map(|(_, case)| case.clone()).collect();
        found.push(find_recorded(runs, &cases, &record)?);
    }
    let mut text = introduction();
    let mut pictures = Vec::new();
    for Kind { name, .. } in kinds(scale) {
        let chosen: Vec<(&Column, &Vec<Found>)> = columns
            .iter()
            .zip(&found)
            .filter(|(column, found)| {
                column.kind == name && found.iter().any(|f| !f.packs.is_empty())
            })
            .collect();
        if chosen.is_empty() {
            continue;
        }
        let file = format!("table1-{name}.svg");
        text += &format!(
            "\n## {} packs\n\n{}\n![Chart]({file})\n",
            capital(name),
            tables(&chosen)
        );
        pictures.push((file, chart(&chosen)));
    }
    let all: Vec<Found> = found.into_iter().flatten().collect();
    let title = "Table 1: packing densities at friction 0.6".to_owned();
    let mut report = page("table1", title, text, &all);
    for (file, picture) in pictures {
        runs.attach(&mut report, &file, &picture)?;
    }
    Ok(report)
}

fn introduction() -> String {
    format!(
        "Table 1 of Xiang, Latham and Farsi (DEM7, 2016): 11,000 bodies, friction 0.6, density in a core 5 d from walls \
         and top.\n\n{}\n\
         Behind the ± is a standard error, by block bootstrap or, with several seeds, by the scatter between them if \
         that is larger. In brackets: the difference to the paper, and the same in combined standard errors s.\n",
        explained()
    )
}

fn tables(columns: &[(&Column, &Vec<Found>)]) -> String {
    let mut heads = vec!["solid", "bodies", "box / d", "paper"];
    heads.extend(columns.iter().map(|(column, _)| column.reading.key));
    let Some((first, _)) = columns.first() else {
        return String::new();
    };
    let row = |index: usize, solid: &Solid, case: &Case| {
        let options = case.jobs.first().map_or("", |job| job.options.as_str());
        let after = |key: &str| {
            let mut words = options.split_whitespace().skip_while(|word| *word != key);
            words.nth(1).unwrap_or_default().to_owned()
        };
        let published = solid.density.map(|density| (density, ROUNDING));
        let mut row = vec![
            solid.name.to_owned(),
            after("--count"),
            after("--box"),
            solid
                .density
                .map_or_else(|| "-".to_owned(), |d| format!("{d:.2}")),
        ];
        let cell = |found: &Found| beside(found.density(), published);
        row.extend(
            columns
                .iter()
                .map(|(_, found)| found.get(index).map_or_else(String::new, cell)),
        );
        row
    };
    let rows: Vec<Vec<String>> = first
        .cases
        .iter()
        .enumerate()
        .filter(|(index, _)| was_run(columns, *index))
        .map(|(index, (solid, case))| row(index, solid, case))
        .collect();
    format!(
        "{}\nAgainst the solids of the paper:\n\n{}\nMean number of contacts of the bodies in the core:\n\n{}",
        markdown_table(&heads, &rows),
        verdicts(columns),
        contacts(columns)
    )
}

/// Whether there is a pack of the solid at an index in any reading.
fn was_run(columns: &[(&Column, &Vec<Found>)], index: usize) -> bool {
    let has_packs = |found: &Found| !found.packs.is_empty();
    columns
        .iter()
        .any(|(_, found)| found.get(index).is_some_and(has_packs))
}

/// Differences of a reading to the paper's values.
fn differences(column: &Column, found: &[Found]) -> Vec<f64> {
    let pairs = column.cases.iter().zip(found);
    let difference = |((solid, _), found): (&(Solid, Case), &Found)| {
        Some(found.density()?.mean - solid.density?)
    };
    pairs.filter_map(difference).collect()
}

/// How well each reading agrees over all solids, compared with a constant.
fn verdicts(columns: &[(&Column, &Vec<Found>)]) -> String {
    let line = |name: &str, differences: &[f64]| {
        let (size, mean) = spread(differences)?;
        let worst = differences.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        // The rest after subtracting the mean: the order of the shapes.
        let order = (size * size - mean * mean).max(0.0).sqrt();
        Some(vec![
            name.to_owned(),
            differences.len().to_string(),
            format!("{size:.3}"),
            format!("{mean:+.3}"),
            format!("{order:.3}"),
            format!("{worst:.3}"),
        ])
    };
    let mut rows: Vec<Vec<String>> = columns
        .iter()
        .filter_map(|(column, found)| line(column.reading.key, &differences(column, found)))
        .collect();
    let listed: Vec<f64> = SOLIDS.iter().filter_map(|solid| solid.density).collect();
    let mean = listed.iter().sum::<f64>() / listed.len() as f64;
    let constant: Vec<f64> = listed.iter().map(|density| mean - density).collect();
    rows.extend(line(&format!("the constant {mean:.3}"), &constant));
    markdown_table(
        &[
            "reading",
            "solids",
            "root mean square difference",
            "mean difference",
            "scatter about that",
            "largest",
        ],
        &rows,
    )
}

fn contacts(columns: &[(&Column, &Vec<Found>)]) -> String {
    let mut heads = vec!["solid"];
    heads.extend(columns.iter().map(|(column, _)| column.reading.key));
    let solids = columns.first().map_or(&[][..], |(column, _)| &column.cases);
    let rows: Vec<Vec<String>> = solids
        .iter()
        .enumerate()
        .filter(|(index, _)| was_run(columns, *index))
        .map(|(index, (solid, _))| {
            let cell = |found: &Found| with_error(found.core_coordination(), 2);
            let cells = columns
                .iter()
                .map(|(_, f)| f.get(index).map_or_else(String::new, cell));
            std::iter::once(solid.name.to_owned())
                .chain(cells)
                .collect()
        })
        .collect();
    markdown_table(&heads, &rows)
}

fn chart(columns: &[(&Column, &Vec<Found>)]) -> String {
    let Some((first, _)) = columns.first() else {
        return String::new();
    };
    let places: Vec<&str> = first.cases.iter().map(|(solid, _)| solid.name).collect();
    let paper = first
        .cases
        .iter()
        .enumerate()
        .filter_map(|(place, (solid, _))| {
            Some(Dot {
                place,
                value: solid.density?,
                error: ROUNDING,
            })
        });
    let mut series = vec![Series {
        name: "paper".to_owned(),
        dots: paper.collect(),
    }];
    for (column, found) in columns {
        series.push(Series::of_reading(&column.reading, found));
    }
    svg(["solid", "packing density"], &places, &series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_solid_is_packed_in_every_reading() {
        let full = cases(Scale::Full);
        assert_eq!(full.len(), READINGS.len() * 2 * 18);
        let quick = cases(Scale::Quick);
        assert_eq!(quick.len(), READINGS.len() * 11);
        assert!(
            quick
                .iter()
                .all(|case| case.jobs.len() == 1 && case.jobs[0].bodies < 1000)
        );
        let jobs = full.iter().flat_map(|case| &case.jobs);
        let keys: std::collections::BTreeSet<String> =
            jobs.map(super::super::job::Job::key).collect();
        assert_eq!(keys.len(), READINGS.len() * 18 * 4);
    }
}
