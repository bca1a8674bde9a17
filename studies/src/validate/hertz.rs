//! Elastic balls pressed on a plane and on each other, against Hertz's theory.

use std::path::Path;

use anyhow::Result;

use super::chart::{Series, svg};
use super::lines::{Output, cell};
use super::program::Workshop;
use super::report::{Check, Report, short};

/// Columns of the example's table `hertz`.
const PRESSED: [&str; 12] = [
    "against",
    "edge_asked_over_R",
    "edge_over_R",
    "tets",
    "kappa_h_over_E",
    "d_over_R",
    "a_over_h",
    "force_over_Hertz",
    "radius_over_Hertz",
    "pressure_over_Hertz",
    "relaxation_steps",
    "seconds",
];
const EDGE: usize = 2;
const RATIO: usize = 4;
const DEPTH: usize = 5;
const RESOLVED: usize = 6;
const FORCE: usize = 7;

pub(super) const EXAMPLE: &str = "-p femdem-solve --example hertz --";

/// The note on a page made of earlier lines.
pub(super) fn note(earlier: Option<&Path>) -> &'static str {
    match earlier {
        Some(_) => "\nOther work shared the machine: the seconds mean little.\n",
        None => "",
    }
}

/// Balls pressed on a plane and on each other.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn hertz(workshop: &Workshop, earlier: Option<&Path>) -> Result<Report> {
    let (output, commands) = Output::of_tables(workshop, earlier, EXAMPLE, &["plane", "two"])?;
    let rows: Vec<&[String]> = output.rows("hertz").collect();
    let picture = workshop.write("hertz.svg", pressed_chart(&rows).as_bytes())?;
    Ok(Report {
        name: "hertz",
        title: "Elastic balls pressed on a plane and on each other".to_owned(),
        text: PRESSED_TEXT.to_owned() + &converged_table(&rows) + note(earlier),
        commands,
        checks: pressed_checks(&rows),
        columns: PRESSED.to_vec(),
        rows: rows.iter().map(|row| row.to_vec()).collect(),
        attachments: vec![picture],
    })
}

const PRESSED_TEXT: &str = "The lower half of a neo-Hookean ball, nu = 0.3, its equator held in a plane that is moved by the depth d, on a smooth \
rigid plane and on an equal half ball. Linear tetrahedra, fine within 0.26 R of the pole, for d up to 0.02 R also within \
0.16 R; h is the mean edge there, a Hertz's contact radius. Quantities are over those of Hertz's theory for the same d: \
F = 4/3 E* sqrt(R) d^1.5, a = sqrt(R d), p = 2/pi E* sqrt(d/R).\n\n\
The theory is for d much less than R and a half-space. The force is therefore judged against its converged value: the \
intercept of the least-squares fit F0 + A h + B h/(kappa h/E) to the runs with kappa h/E = 1 and 3. The radius is that of a \
circle of the contact's area. The pressure is that of the field on the axis (-: not measured).\n\n\
![Force over Hertz's](hertz.svg)\n\n";

/// The three unknowns of F0 + A h + B h/r by least squares; NaN without enough runs.
fn converged(rows: &[&[String]], against: &str, depth: &str) -> f64 {
    let mut normal = [[0.0_f64; 4]; 3];
    for row in rows.iter().filter(|row| {
        row.first().is_some_and(|c| c == against)
            && row.get(DEPTH).is_some_and(|c| c == depth)
            && cell(row, RATIO) >= 1.0
    }) {
        let h = cell(row, EDGE);
        let terms = [1.0, h, h / cell(row, RATIO)];
        for (line, term) in normal.iter_mut().zip(terms) {
            for (sum, other) in line
                .iter_mut()
                .zip(terms.into_iter().chain([cell(row, FORCE)]))
            {
                *sum += term * other;
            }
        }
    }
    solve(normal)[0]
}

/// Solves three linear equations by Cramer's rule.
fn solve(lines: [[f64; 4]; 3]) -> [f64; 3] {
    let determinant = |columns: [usize; 3]| {
        let [a, b, c] = lines.map(|line| columns.map(|k| line[k]));
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let all = determinant([0, 1, 2]);
    [[3, 1, 2], [0, 3, 2], [0, 1, 3]].map(|columns| determinant(columns) / all)
}

/// The depths in the rows, each once.
fn depths(rows: &[&[String]]) -> Vec<String> {
    let mut depths: Vec<String> = rows.iter().filter_map(|r| r.get(DEPTH).cloned()).collect();
    depths.sort_unstable();
    depths.dedup();
    depths
}

const AGAINST: [&str; 2] = ["plane", "two balls"];

fn converged_table(rows: &[&[String]]) -> String {
    let mut text =
        "| d/R | converged force over Hertz's, plane | two balls |\n| --- | --- | --- |\n"
            .to_owned();
    for depth in depths(rows) {
        let [plane, two] = AGAINST.map(|against| short(converged(rows, against, &depth)));
        text += &format!("| {depth} | {plane} | {two} |\n");
    }
    text
}

fn pressed_checks(rows: &[&[String]]) -> Vec<Check> {
    let mut checks = Vec::new();
    for against in AGAINST {
        let mut worst = (f64::NAN, 0.0_f64);
        let [mut judged, mut within] = [0; 2];
        for depth in depths(rows) {
            let limit = converged(rows, against, &depth);
            for row in rows.iter().filter(|row| {
                row.first().is_some_and(|c| c == against)
                    && row.get(DEPTH) == Some(&depth)
                    && cell(row, RATIO) == 1.0
                    && cell(row, RESOLVED) >= 2.0
            }) {
                judged += 1;
                let off = cell(row, FORCE) / limit - 1.0;
                within += usize::from(off.abs() <= 0.05);
                if worst.0.is_nan() || off.abs() > worst.1.abs() {
                    worst = (cell(row, RESOLVED), off);
                }
            }
        }
        checks.push(Check::holds(
            &format!("{against}: force at kappa h/E = 1 and a/h >= 2 from the converged value, {judged} runs"),
            "within 5 %",
            format!("{:.1} % at worst (a/h = {:.2}), {within} within", 100.0 * worst.1, worst.0),
            judged > 0 && worst.1.abs() <= 0.05,
        ));
    }
    checks
}

fn pressed_chart(rows: &[&[String]]) -> String {
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let [against, _, edge, _, ratio, ..] = row else {
            continue;
        };
        let name = format!("{against}, {edge}, {ratio}");
        let point = [cell(row, DEPTH), cell(row, FORCE)];
        match series.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => series.push(Series {
                name,
                points: vec![point],
            }),
        }
    }
    svg(
        ["d/R (lines: against, h/R, kappa h/E)", "force over Hertz's"],
        [0.0, 0.07],
        [0.6, 1.3],
        &series,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows whose force is exactly that of the fit, with the limit 1.1.
    fn rows(slope: f64) -> String {
        let mut text = String::new();
        for against in AGAINST {
            for h in [0.08, 0.05, 0.04] {
                for r in [1.0, 3.0] {
                    let force = 1.1 + 0.2 * h + slope * h / r;
                    text += &format!(
                        "hertz\t{against}\t{h}\t{h}\t9\t{r}\t0.06\t3\t{force}\t1\t1\t9\t1\n"
                    );
                }
            }
        }
        text
    }

    #[test]
    fn the_limit_of_the_fit_is_found_and_soft_contacts_miss_it() {
        for (slope, met) in [(-0.5, true), (-1.0, false)] {
            let text = rows(slope);
            let output = Output::parse(&text);
            let rows: Vec<&[String]> = output.rows("hertz").collect();
            let limit = converged(&rows, "plane", "0.06");
            assert!((limit - 1.1).abs() < 1e-9, "{limit}");
            let checks = pressed_checks(&rows);
            assert!(
                checks.len() == 2 && checks.iter().all(|c| c.met == met),
                "{checks:?}"
            );
        }
        assert!(pressed_checks(&[]).iter().all(|c| !c.met));
    }
}
