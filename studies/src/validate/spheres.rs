//! Elastic balls that collide, against Hertz's theory and that of a ball of finite size.

use std::f64::consts::PI;
use std::path::Path;

use anyhow::Result;

use super::chart::{Series, svg};
use super::finite_ball::peak_over_hertz;
use super::hertz::{EXAMPLE, note};
use super::lines::{Output, cell};
use super::program::Workshop;
use super::report::{Check, Report};

/// Columns of the example's table `impact`.
const COLUMNS: [&str; 16] = [
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
    "peak_over_finite_ball",
];

/// An impact of the example: its name, the peak force of Hertz's theory (N; that of the tests as published),
/// Poisson's ratio, and the kinetic energy of a ball over Young's modulus and the cube of its radius.
struct Impact {
    name: &'static str,
    hertz: f64,
    poisson: f64,
    energy: f64,
}

/// Kinetic energy of a ball over E R^3, from its density, speed and Young's modulus.
const fn energy(density: f64, speed: f64, young: f64) -> f64 {
    2.0 / 3.0 * PI * density * speed * speed / young
}

const IMPACTS: [Impact; 3] = [
    Impact {
        name: "test 1, two glass balls",
        hertz: 10_697.0,
        poisson: 0.2,
        energy: energy(2800.0, 10.0, 48e9),
    },
    Impact {
        name: "test 1 at 1 m/s, a glass ball on a plane",
        hertz: 674.9,
        poisson: 0.2,
        energy: energy(2800.0, 1.0, 48e9),
    },
    Impact {
        name: "test 2, aluminium ball on a plane",
        hertz: 11_370.0,
        poisson: 0.3,
        energy: energy(2699.0, 0.2, 70e9),
    },
];

impl Impact {
    /// The peak force of a ball of finite size over that of Hertz's theory.
    fn finite(&self) -> f64 {
        peak_over_hertz(self.poisson, self.energy)
    }
}

/// Balls that collide.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn spheres(workshop: &Workshop, earlier: Option<&Path>) -> Result<Report> {
    let tables = ["glass", "laws", "slow", "aluminium"];
    let (output, commands) = Output::of_tables(workshop, earlier, EXAMPLE, &tables)?;
    let picture = workshop.write("spheres.svg", chart(&output).as_bytes())?;
    Ok(Report {
        name: "spheres",
        title: "Colliding elastic balls".to_owned(),
        text: TEXT.to_owned() + &finite_table() + note(earlier),
        commands,
        checks: checks(&output),
        columns: COLUMNS.to_vec(),
        rows: rows(&output),
        attachments: vec![picture],
    })
}

/// The part of an impact's name before the first comma; after it laws and partners differ.
fn test(name: &str) -> &str {
    name.split(',').next().unwrap_or_default()
}

/// The rows, each with its peak force over that of a ball of finite size.
fn rows(output: &Output) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> = output.rows("impact").map(<[String]>::to_vec).collect();
    for impact in &IMPACTS {
        let finite = impact.finite();
        for row in rows
            .iter_mut()
            .filter(|row| test(&row[0]) == test(impact.name))
        {
            row.push(format!("{:.5}", cell(row, 8) / finite));
        }
    }
    rows
}

fn finite_table() -> String {
    let mut text = "\n| impact | a/R | peak force of a ball of finite size over Hertz's |\n| --- | --- | --- |\n".to_owned();
    for impact in &IMPACTS {
        let approach = (impact.energy * 15.0 / 8.0 * (1.0 - impact.poisson.powi(2))).powf(0.4);
        text += &format!(
            "| {} | {:.3} | {:.4} |\n",
            impact.name,
            approach.sqrt(),
            impact.finite()
        );
    }
    text
}

const TEXT: &str = "Tests 1 and 2 of Y. C. Chung and J. Y. Ooi, Granular Matter 13 (2011) 643-656, with whole balls of \
neo-Hookean tetrahedra, without friction, damping or gravity.\n\n\
1. Two equal glass balls (R = 10 mm, E = 48 GPa, nu = 0.2, density 2800 kg/m^3), each at 10 m/s. Also one of them at \
1 m/s on a rigid plane.\n\
2. A ball of an aluminium alloy (R = 100 mm, E = 70 GPa, nu = 0.3, density 2699 kg/m^3) at 0.2 m/s on a rigid plane.\n\n\
The published forces are those of Hertz's theory, F = 4/3 E* sqrt(R*) d^1.5 with d = (15 m* v^2/(16 E* sqrt(R*)))^0.4, and \
the time in contact is 2.9433 d/v. Spacing is the mean edge of the skin about the pole, half of it for quadratic \
tetrahedra (T10).\n\n\
Hertz's theory takes each ball for a half-space. A ball of finite size is stiffer, by the series solution of a linearly \
elastic ball that its own inertia pushes onto the plane (`studies/src/validate/finite_ball.rs`):\n\n\
![Force in time](spheres.svg)\n";

/// The row that is assessed: that of T10, or else T4, with the finest mesh at kappa h/E = 1.
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

fn checks(output: &Output) -> Vec<Check> {
    let mut checks = Vec::new();
    for impact in &IMPACTS {
        let row = finest(output, impact.name).unwrap_or(&[]);
        let element = row.get(1).cloned().unwrap_or_default();
        let of = format!(
            "{}, {element}, a/h = {}",
            impact.name,
            row.get(6).cloned().unwrap_or_default()
        );
        let peak = cell(row, 7);
        let finite = impact.finite() * impact.hertz;
        for (force, whose) in [(impact.hertz, "Hertz's"), (finite, "a finite ball's")] {
            checks.push(Check::holds(
                &format!("{of}: peak force"),
                &format!("{whose} {:.4} kN within 3 %", force / 1e3),
                format!(
                    "{:.4} kN ({:+.1} %)",
                    peak / 1e3,
                    100.0 * (peak / force - 1.0)
                ),
                (peak / force - 1.0).abs() <= 0.03,
            ));
        }
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

fn chart(output: &Output) -> String {
    let mut series: Vec<Series> = Vec::new();
    for row in output.rows("curve") {
        let [impact, element, edge, ratio, ..] = row else {
            continue;
        };
        if ratio != "1" || IMPACTS.iter().all(|known| known.name != impact) {
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

    #[test]
    fn the_finest_quadratic_mesh_is_judged() {
        let text = "impact\ttest 1, two glass balls\tT4\t0.02\t0.02\t9\t1\t3\t9000\t1\t1\t1\n\
                    impact\ttest 1, two glass balls\tT10\t0.05\t0.05\t9\t1\t3\t9000\t1\t1\t1\n\
                    impact\ttest 1, two glass balls\tT10\t0.03\t0.03\t9\t1\t3\t11000\t1\t1\t1.01\n\
                    impact\ttest 1, two glass balls, law\tT10\t0.01\t0.01\t9\t1\t3\t9000\t1\t1\t2\n";
        let output = Output::parse(text);
        let met: Vec<bool> = checks(&output).iter().map(|c| c.met).collect();
        // Within 3 % of Hertz's force, of a finite ball's, and of Hertz's time; then two impacts without rows.
        assert_eq!(met[..3], [true, true, true]);
        assert!(met.len() == 9 && !met[3..].iter().any(|&met| met));
    }
}
