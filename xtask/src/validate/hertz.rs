//! Elastic balls pressed and colliding, against Hertz's theory.

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

const EXAMPLE: &str = "-p femdem-solve --example hertz --";

/// The lines of an earlier run, or of one now, and the commands.
fn lines(
    workshop: &Workshop,
    earlier: Option<&Path>,
    tables: [&str; 2],
) -> Result<(Output, Vec<String>)> {
    let mut output = Output::default();
    let mut commands = Vec::new();
    for table in tables {
        let arguments = format!("{EXAMPLE} {table}");
        let (lines, command) = match earlier {
            Some(folder) => Output::read(&folder.join(format!("{table}.tsv")), &arguments)?,
            None => Output::of(workshop, &arguments)?,
        };
        output = output.and(lines);
        commands.push(command);
    }
    Ok((output, commands))
}

/// What a page made of earlier lines says.
fn note(earlier: Option<&Path>) -> &'static str {
    match earlier {
        Some(_) => {
            "\nThis page is made of lines that the example printed before, on this machine while others used \
             it: the seconds mean little, and meshes and stiffnesses of the commands below that have no row here \
             are still to be run.\n"
        }
        None => "",
    }
}

/// Balls pressed on a plane and on each other.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn hertz(workshop: &Workshop, earlier: Option<&Path>) -> Result<Report> {
    let (output, commands) = lines(workshop, earlier, ["plane", "two"])?;
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

const PRESSED_TEXT: &str = "The lower half of a neo-Hookean ball, nu = 0.3, its equator held in a plane \
that is moved by the depth d, on a smooth rigid plane and on an equal half ball (which moves by 2 d \
towards it); `World` in explicit motion to each depth, then `World::relax` to a residual of 5e-4 of the \
force. Linear tetrahedra, fine within 0.26 R of the pole; h is the mean edge there, a Hertz's contact \
radius. kappa h/E is the stiffness of the contact field, given as a penalty. Quantities are over those \
of Hertz's theory for the same d: F = 4/3 E* sqrt(R) d^1.5, a = sqrt(R d), p = 2/pi E* sqrt(d/R).\n\n\
The theory is for d much less than R, a half-space and small strain. Here the depth goes to 0.06 R and \
a to 0.245 R: the equator is held, the ball is finite and round, and the law of the material stiffens \
at finite strain, so the converged force exceeds Hertz's more the larger d is. The force is therefore \
judged against its converged value: the intercept of the least-squares fit \
F0 + A h + B h/(kappa h/E) to the runs of the table with kappa h/E = 1 and 3, for each depth. \
The radius is that of a circle of the contact's area, which counts all that overlaps, so it exceeds the \
elastic one where the field is soft. The pressure is that of the field on the axis (-: not measured).\n\n\
A pair of deformable bodies overlaps with both fields; a wall has none and acts as the body's mirror image: \
ball on plane and two balls are the same problem, on meshes that meet the plane or each other.\n\n![Force over Hertz's](hertz.svg)\n\n";

/// The three unknowns of F0 + A h + B h/r by least squares; not numbers without runs enough.
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
        let mut judged = 0;
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
                if worst.0.is_nan() || off.abs() > worst.1.abs() {
                    worst = (cell(row, RESOLVED), off);
                }
            }
        }
        checks.push(Check::holds(
            &format!("{against}: force at kappa h/E = 1 and a/h >= 2 from the converged value, {judged} runs"),
            "within 5 %",
            format!("{:.1} % at worst (a/h = {:.2})", 100.0 * worst.1, worst.0),
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

/// Columns of the example's table `impact`.
const COLLIDED: [&str; 15] = [
    "impact",
    "element",
    "edge_asked_over_R",
    "spacing_over_R",
    "tets",
    "kappa_h_over_E",
    "a_over_h",
    "peak_force_N",
    "peak_over_Hertz",
    "duration_s",
    "duration_over_Hertz",
    "restitution",
    "ledger_error",
    "steps",
    "seconds",
];

/// The two impacts with their published peak forces, N.
const PUBLISHED: [(&str, f64); 2] = [
    ("test 1, two glass balls", 10_697.0),
    ("test 2, aluminium ball on a plane", 11_370.0),
];

/// Balls that collide.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn spheres(workshop: &Workshop, earlier: Option<&Path>) -> Result<Report> {
    let (output, commands) = lines(workshop, earlier, ["glass", "aluminium"])?;
    let picture = workshop.write("spheres.svg", collided_chart(&output).as_bytes())?;
    Ok(Report {
        name: "spheres",
        title: "Colliding elastic balls".to_owned(),
        text: COLLIDED_TEXT.to_owned() + note(earlier),
        commands,
        checks: collided_checks(&output),
        columns: COLLIDED.to_vec(),
        rows: output.rows("impact").map(<[String]>::to_vec).collect(),
        attachments: vec![picture],
    })
}

const COLLIDED_TEXT: &str = "Tests 1 and 2 of Y. C. Chung and J. Y. Ooi, Granular Matter 13 (2011) \
643-656, with whole balls of neo-Hookean tetrahedra in an explicit `World` at 0.9 of the stable step, \
without friction, damping or gravity.\n\n\
1. Two equal glass balls (R = 10 mm, E = 48 GPa, nu = 0.2, density 2800 kg/m^3), each at 10 m/s.\n\
2. A ball of an aluminium alloy (R = 100 mm, E = 70 GPa, density 2699 kg/m^3) at 0.2 m/s on a rigid \
plane. nu = 0.3, with which Hertz's theory gives the published force; nu = 0.33 would give 11.465 kN.\n\n\
The published forces are those of Hertz's theory of impact: F = 4/3 E* sqrt(R*) d^1.5 with \
d = (15 m* v^2/(16 E* sqrt(R*)))^0.4, and the time in contact is 2.9433 d/v. The tables give peak force \
and duration (to the last contact) over those. Spacing is the mean edge of the skin about the pole, half of \
it for quadratic tetrahedra (T10); kappa h/E is meant with it. The density is raised by what the \
polyhedron lacks of the ball's volume. Restitution is the momentum after over that before.\n\n\
![Force in time](spheres.svg)\n";

/// The row that is judged: that of T10, or else T4, with the finest mesh at kappa h/E = 1.
fn finest<'a>(output: &'a Output, impact: &str) -> Option<&'a [String]> {
    let rows = output
        .rows("impact")
        .filter(|row| row.first().is_some_and(|c| c == impact) && cell(row, 5) == 1.0);
    rows.min_by(|a, b| {
        let quality = |row: &[String]| (row.get(1).is_none_or(|e| e != "T10"), cell(row, 3));
        quality(a)
            .partial_cmp(&quality(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    })
}

fn collided_checks(output: &Output) -> Vec<Check> {
    let mut checks = Vec::new();
    for (impact, force) in PUBLISHED {
        let row = finest(output, impact).unwrap_or(&[]);
        let element = row.get(1).cloned().unwrap_or_default();
        let of = format!(
            "{impact}, {element}, a/h = {}",
            row.get(6).cloned().unwrap_or_default()
        );
        let peak = cell(row, 7);
        checks.push(Check::holds(
            &format!("{of}: peak force"),
            &format!("{} kN within 3 %", force / 1e3),
            format!(
                "{:.3} kN ({:+.1} %)",
                peak / 1e3,
                100.0 * (peak / force - 1.0)
            ),
            (peak / force - 1.0).abs() <= 0.03,
        ));
        let duration = cell(row, 10);
        checks.push(Check::holds(
            &format!("{of}: time in contact"),
            "Hertz's within 3 %",
            format!("{:+.1} %", 100.0 * (duration - 1.0)),
            (duration - 1.0).abs() <= 0.03,
        ));
    }
    checks
}

fn collided_chart(output: &Output) -> String {
    let mut series: Vec<Series> = Vec::new();
    for row in output.rows("curve") {
        let [impact, element, edge, ratio, ..] = row else {
            continue;
        };
        if ratio != "1" {
            continue;
        }
        let name = format!(
            "{} {element} {edge}",
            impact.split(',').next().unwrap_or_default()
        );
        let point = [cell(row, 4), cell(row, 5)];
        match series.iter_mut().find(|line| line.name == name) {
            Some(line) => line.points.push(point),
            None => series.push(Series {
                name,
                points: vec![point],
            }),
        }
    }
    svg(
        [
            "time over Hertz's time in contact (lines: test, element, h/R)",
            "force over Hertz's peak",
        ],
        [0.0, 1.25],
        [0.0, 1.25],
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

    #[test]
    fn the_finest_quadratic_mesh_is_judged() {
        let text = "impact\ttest 1, two glass balls\tT4\t0.02\t0.02\t9\t1\t3\t9000\t1\t1\t1\n\
                    impact\ttest 1, two glass balls\tT10\t0.05\t0.05\t9\t1\t3\t9000\t1\t1\t1\n\
                    impact\ttest 1, two glass balls\tT10\t0.03\t0.03\t9\t1\t3\t10700\t1\t1\t1.01\n";
        let met: Vec<bool> = collided_checks(&Output::parse(text))
            .iter()
            .map(|c| c.met)
            .collect();
        assert_eq!(met, [true, true, false, false]);
    }
}
