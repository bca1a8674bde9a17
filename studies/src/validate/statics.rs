//! Deformable bodies at rest, and Taylor's impact test, against closed forms and published values.

use anyhow::Result;

use super::lines::Output;
use super::program::Workshop;
use super::report::{Check, Report};

/// Runs the example `statics` of femdem-solve for one of its tables; returns the command, too.
fn run(workshop: &Workshop, table: &str) -> Result<(Output, String)> {
    Output::of(
        workshop,
        &format!("-p femdem-fem --features implicit --example statics -- {table}"),
    )
}

/// A value that has to be within a share of another.
fn within(figure: &str, measured: f64, value: f64, share: f64) -> Check {
    Check::holds(
        figure,
        &format!("{value} within {} %", 100.0 * share),
        measured,
        (measured / value - 1.0).abs() <= share,
    )
}

const VALUE: usize = 4;

/// Cantilever, thick sphere, Cook's membrane, and the cost of Newton's method.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn statics(workshop: &Workshop) -> Result<Report> {
    let (output, command) = run(workshop, "statics")?;
    let mut rows: Vec<Vec<String>> = output.rows("value").map(<[String]>::to_vec).collect();
    rows.sort_by(|a, b| a.first().cmp(&b.first()));
    Ok(Report {
        name: "statics",
        title: "Deformable bodies at rest".to_owned(),
        text: statics_text(&output),
        commands: vec![command],
        checks: statics_checks(&output),
        columns: vec!["case", "element", "mesh", "unknowns", "value", "seconds"],
        rows,
        attachments: Vec::new(),
    })
}

fn statics_checks(output: &Output) -> Vec<Check> {
    let value = |case: &str, element: &str, mesh: &str| {
        output.number("value", &[case, element, mesh], VALUE)
    };
    let sphere = |nu: &str| {
        value(
            &format!("thick sphere, nu {nu}"),
            "T10, F-bar",
            "12 around, 8 through",
        )
    };
    let cook = |nu: &str| value(&format!("Cook, nu {nu}"), "T10, F-bar", "32 x 32 x 1");
    let mut checks = vec![within(
        "cantilever, T10, 20 x 2 x 2, deflection over Timoshenko's",
        value("cantilever, nu 0.3", "T10", "20 x 2 x 2"),
        1.0,
        0.015,
    )];
    for nu in ["0.3", "0.499", "0.4999"] {
        let figure = format!("thick sphere, T10 with F-bar, nu {nu}, u(a) over the exact one");
        checks.push(within(&figure, sphere(nu), 1.0, 0.02));
    }
    checks.extend([
        within(
            "Cook's membrane, nu 1/3, T10 with F-bar, rise of the corner",
            cook("1/3"),
            32.24,
            0.01,
        ),
        within(
            "Cook's membrane, nu 0.4999, T10 with F-bar, rise of the corner",
            cook("0.4999"),
            28.0,
            0.02,
        ),
    ]);
    for row in output
        .rows("newton")
        .filter(|row| row.first().is_some_and(|s| s == "Cholesky"))
    {
        let [_, element, unknowns, iterations, _, residuals, ..] = row else {
            continue;
        };
        let last = residuals
            .split(' ')
            .next_back()
            .and_then(|r| r.parse().ok());
        let (last, count) = (
            last.unwrap_or(f64::NAN),
            iterations.parse().unwrap_or(f64::NAN),
        );
        checks.push(Check::holds(
            &format!("Newton with Cholesky, {element}, {unknowns} unknowns"),
            "at most 5 iterations to 1e-12",
            format!("{iterations} to {last:e}"),
            count <= 5.0 && last <= 1e-12,
        ));
    }
    checks
}

fn statics_text(output: &Output) -> String {
    let newton: String = output
        .rows("newton")
        .map(|row| format!("| {} |\n", row.join(" | ")))
        .collect();
    format!(
        "Neo-Hookean bodies under loads small enough for the linear theory, by `solve_static` with a sparse Cholesky \
         factorisation.\n\n\
         - **Cantilever** 10 x 1 x 1, a shear traction on its end. Value: mean deflection of the end over that of \
         Timoshenko's beam with Cowper's coefficient (J. Appl. Mech. 33, 335 (1966)).\n\
         - **Thick sphere**, radii 1 and 2, pressure inside, an eighth. Value: mean radial displacement inside over Lame's \
         (Timoshenko and Goodier, Theory of Elasticity, art. 136). Edges are straight, so that the surface under pressure \
         is too small, by 1 % on the fine mesh.\n\
         - **Cook's membrane** in plane strain, E = 70, shear traction 6.25. Value: rise of the upper right corner. \
         Published: 32.20 to 32.28 at nu = 1/3, and 27.52 to 27.56 at 0.4999, where the target is 28.0 (CoFEA, benchmark \
         2, <https://cofea.readthedocs.io>).\n\n\
         **Newton's method** on a clamped cube (nu = 0.3) whose one face moves by 10 % outwards and sideways, in one step:\n\n\
         | solver | element | unknowns | iterations | linear iterations | residual over reactions, from the start | seconds |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n{newton}",
    )
}

/// Taylor's impact test.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn taylor(workshop: &Workshop) -> Result<Report> {
    let (output, command) = run(workshop, "taylor")?;
    Ok(Report {
        name: "taylor",
        title: "Taylor's impact test".to_owned(),
        text: "A copper bar, 32.4 mm long and 3.2 mm in radius, strikes a rigid, smooth wall at 227 m/s (Wilkins and \
               Guinan, J. Appl. Phys. 44, 1200 (1973)): E = 117 GPa, nu = 0.35, density 8930 kg/m^3, J2 plasticity with \
               a yield stress of 400 MPa and linear hardening of 100 MPa; explicit, to 80 microseconds, a quarter of the \
               bar.\n\n\
               Published: radius of the face 7.22 mm (Foulk et al. 2021), 7.12 mm (Simo 1992) and 7.11 mm (Zienkiewicz \
               et al. 1998); length 21.42 to 21.48 mm, as compiled in the benchmark tet15-p1/taylor of the research code \
               Carina.\n"
            .to_owned(),
        commands: vec![command],
        checks: taylor_checks(&output),
        columns: vec![
            "element", "mesh", "elements", "steps", "radius_mm", "length_mm", "ledger_error", "seconds",
        ],
        rows: output.rows("bar").map(<[String]>::to_vec).collect(),
        attachments: Vec::new(),
    })
}

fn taylor_checks(output: &Output) -> Vec<Check> {
    let mut checks = Vec::new();
    for (element, mesh) in [
        ("T4, nodal pressure", "6 rings, 72 layers"),
        ("T10, F-bar", "3 rings, 36 layers"),
    ] {
        let number = |column| output.number("bar", &[element, mesh], column);
        checks.push(within(
            &format!("radius, {element}, {mesh}, in mm"),
            number(4),
            7.2,
            0.03,
        ));
        checks.push(within(
            &format!("length, {element}, {mesh}, in mm"),
            number(5),
            21.45,
            0.01,
        ));
    }
    checks
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATICS: &str = "value\tcantilever, nu 0.3\tT10\t20 x 2 x 2\t2000\t0.98930\t0.1\n\
         value\tthick sphere, nu 0.3\tT10, F-bar\t12 around, 8 through\t9\t0.99\t1\n\
         value\tthick sphere, nu 0.499\tT10, F-bar\t12 around, 8 through\t9\t0.99\t1\n\
         value\tthick sphere, nu 0.4999\tT10, F-bar\t12 around, 8 through\t9\t0.99\t1\n\
         value\tCook, nu 1/3\tT10, F-bar\t32 x 32 x 1\t9\t32.25\t1\n\
         value\tCook, nu 0.4999\tT10, F-bar\t32 x 32 x 1\t9\t27.9\t1\n\
         newton\tCg\tT4\t9\t3\t70\t1e-1 1e-4 1e-8 1e-13\t2\n\
         newton\tCholesky\tT4\t9\t3\t3\t1e-1 1e-4 1e-8 1e-13\t2\n";

    #[test]
    fn good_values_meet_all_and_bad_ones_miss() {
        let missed = |text: &str| {
            let checks = statics_checks(&Output::parse(text));
            checks.iter().filter(|check| !check.met).count()
        };
        assert_eq!(missed(STATICS), 0);
        assert_eq!(missed(&STATICS.replace("0.98930", "0.98")), 1);
        assert_eq!(missed(&STATICS.replace("1e-13\t2\n", "1e-9\t2\n")), 1);
        assert_eq!(missed(""), 6);
        assert!(statics_text(&Output::parse(STATICS)).contains("| Cg | T4 | 9 | 3 | 70 |"));
    }

    #[test]
    fn the_bar_is_judged_by_radius_and_length() {
        let text = "bar\tT4, nodal pressure\t6 rings, 72 layers\t1\t2\t7.15\t21.5\t1e-3\t9\n\
                    bar\tT10, F-bar\t3 rings, 36 layers\t1\t2\t5.5\t21.5\t1e-3\t9\n";
        let met: Vec<bool> = taylor_checks(&Output::parse(text))
            .iter()
            .map(|c| c.met)
            .collect();
        assert_eq!(met, [true, true, false, true]);
    }
}
