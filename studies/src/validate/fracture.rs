//! Strength of bodies that break, against closed forms.

use std::path::Path;

use anyhow::Result;

use super::lines::{Output, cell};
use super::program::Workshop;
use super::report::{Check, Report, short};

const EXAMPLE: &str = "-p femdem-solve --example fracture --";

/// Columns of a row.
const MESH: usize = 1;
const SETTING: usize = 2;
const VALUE: usize = 4;

/// Bars in tension, blocks under compression and discs across their diameter.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn fracture(workshop: &Workshop, earlier: Option<&Path>) -> Result<Report> {
    let tests = ["bar", "block", "disc"];
    let (output, commands) = Output::of_tables(workshop, earlier, EXAMPLE, &tests)?;
    Ok(Report {
        name: "fracture",
        title: "Bodies that break".to_owned(),
        text: TEXT.to_owned() + &table(&output),
        commands,
        checks: checks(&output),
        columns: vec!["test", "mesh", "setting", "quantity", "value"],
        rows: output.rows("value").map(<[String]>::to_vec).collect(),
        attachments: Vec::new(),
    })
}

/// Rows of a test and a quantity, with their values.
fn all<'a>(
    output: &'a Output,
    test: &'a str,
    quantity: &'a str,
) -> impl Iterator<Item = (&'a [String], f64)> {
    output.rows("value").filter_map(move |row| match row {
        [own, .., what, _] if own == test && what == quantity => Some((row, cell(row, VALUE))),
        _ => None,
    })
}

/// The value farthest from 1; NaN without values, or if one is.
fn farthest(values: impl Iterator<Item = f64>) -> f64 {
    let farther = |most: f64, value: f64| {
        if value.is_nan() || (value - 1.0).abs() > (most - 1.0).abs() {
            value
        } else {
            most
        }
    };
    values.reduce(farther).unwrap_or(f64::NAN)
}

/// A check that values lie within a share of 1.
fn near_one(figure: &str, values: impl Iterator<Item = f64>, share: f64) -> Check {
    let value = farthest(values);
    Check::holds(
        figure,
        &format!("1 within {:.0} %", 100.0 * share),
        format!("{value:.3}"),
        (value - 1.0).abs() <= share,
    )
}

fn checks(output: &Output) -> Vec<Check> {
    let of = |test: &'static str, quantity: &'static str| all(output, test, quantity).map(|r| r.1);
    let with = |test, quantity, mesh: &'static str, setting: &'static str| {
        all(output, test, quantity)
            .filter(move |(row, _)| {
                row[MESH].starts_with(mesh) && row[SETTING].starts_with(setting)
            })
            .map(|r| r.1)
    };
    let books = ["bar", "block", "disc"].map(|test| {
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        let worst = of(test, "books").map(f64::abs).reduce(larger);
        let worst = worst.unwrap_or(f64::NAN);
        Check::at_most(
            &format!("{test}, relative error of the ledger"),
            worst,
            1e-3,
            "",
        )
    });
    let mut checks = vec![
        near_one(
            "bar, strength, farthest of three meshes and three seeds",
            of("bar", "strength"),
            0.03,
        ),
        near_one(
            "bar, energy over G A, farthest of the same",
            of("bar", "energy"),
            0.1,
        ),
        near_one(
            "block, strength over Mohr and Coulomb's, three meshes",
            with("block", "strength", "", "0 MPa"),
            0.1,
        ),
        near_one(
            "the same under 5, 10 and 20 MPa on its sides",
            ["5 MPa", "10 MPa", "20 MPa"]
                .into_iter()
                .map(|p| all(output, "block", "strength").find(|(row, _)| row[SETTING] == p))
                .map(|found| found.map_or(f64::NAN, |(_, value)| value)),
            0.1,
        ),
        near_one(
            "disc, load at the first crack inside, D/l = 12.5 and more",
            with("disc", "first crack", "", "5 J").chain(with("disc", "first crack", "", "2.5 J")),
            0.05,
        ),
        near_one(
            "disc, largest load, D/l = 12.5",
            with("disc", "strength", "", "5 J"),
            0.05,
        ),
        near_one(
            "disc, largest load, D/l = 25",
            with("disc", "strength", "", "2.5 J"),
            0.05,
        ),
    ];
    checks.extend(books);
    checks
}

const TEXT: &str = "A rock: E = 20 GPa, nu = 0.2, 2,500 kg/m3, strength in tension f = 5 MPa, cohesion c = 20 MPa, tan(phi) = 0.8, energy \
of fracture by opening G = 20 J/m2 where nothing else is said, by sliding five times as much. Linear tetrahedra, neo-Hookean, whose \
points are shaken where the mesh is a block; no friction at the platens; the default step at the safety 0.5. Nothing is fitted.\n\n\
- **Bar** of 40 x 10 x 10 mm, its ends pulled apart at 0.1 m/s. Strength: largest mean tension over f. Energy: what it has \
taken over G times its section.\n\
- **Block** of 20 x 20 x 40 mm, compressed at 0.5 m/s, with a pressure p on its sides. Strength: largest axial stress over \
2 c cos(phi)/(1 - sin(phi)) + p (1 + sin(phi))/(1 - sin(phi)) (Mohr and Coulomb). Held: stress after a tenth more compression over the \
largest; 0.1 and below ends the run.\n\
- **Disc**, 50 mm wide and 6 mm thick, pressed across at 0.1 m/s (the Brazilian test). Loads P over pi D t f/2, at which the tension at the centre of \
an elastic disc is f; place of the first crack that is farther than 0.2 R from the rim, over R; mean angle between \
cut facets and the loaded diameter, by energy. D over the length l = E G/f2 of the process zone says how brittle it is: above some 10 a \
disc splits at once.\n\n";

/// The values, a line for each run.
fn table(output: &Output) -> String {
    let mut lines: Vec<(String, Vec<String>)> = Vec::new();
    for row in output.rows("value") {
        let [test, mesh, setting, quantity, _] = row else {
            continue;
        };
        let value = short(cell(row, VALUE));
        let run = format!("{test} | {mesh} | {setting}");
        let text = format!("{quantity} {value}");
        match lines.last_mut() {
            Some((own, values)) if *own == run => values.push(text),
            _ => lines.push((run, vec![text])),
        }
    }
    let rows: String = lines
        .iter()
        .map(|(run, values)| format!("| {run} | {} |\n", values.join(", ")))
        .collect();
    format!("| test | mesh | setting | results |\n| --- | --- | --- | --- |\n{rows}")
}
