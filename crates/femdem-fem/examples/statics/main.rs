//! The static benchmarks and Taylor's impact test, for `cargo studies validate statics` and `taylor`.
//!
//! Prints lines of columns separated by tabs; each begins with the name of its table.

mod cantilever;
mod cook;
mod cube;
mod cylinder;
mod planes;
mod sphere;
mod taylor;

use femdem_fem::element::Element;
use femdem_fem::statics::{Linear, NewtonOptions, StaticOptions, StaticSolution};
use std::error::Error;
use std::io::Write;
use std::time::Instant;

const ELEMENTS: [Element; 4] = [
    Element::T4,
    Element::T4NodalPressure,
    Element::T10,
    Element::T10Fbar,
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    match std::env::args().nth(1).as_deref() {
        Some("statics") => {
            cantilevers(&mut out)?;
            spheres(&mut out)?;
            cooks(&mut out)?;
            cubes(&mut out)
        }
        Some("taylor") => taylors(&mut out),
        _ => Err("say which: statics or taylor".into()),
    }
}

fn cantilevers(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let meshes = [[20, 2, 2], [40, 4, 4], [80, 8, 8]];
    for element in ELEMENTS {
        // Quadratic elements need no third mesh; averaged pressures fill the matrix.
        let count = if element == Element::T4 { 3 } else { 2 };
        for cells in &meshes[..count] {
            let start = Instant::now();
            let (ratio, solution) = cantilever::run(element, *cells, &options(Linear::Cholesky))?;
            let mesh = format!("{} x {} x {}", cells[0], cells[1], cells[2]);
            value(
                out,
                "cantilever, nu 0.3",
                element,
                &mesh,
                ratio,
                &solution,
                start,
            )?;
        }
    }
    Ok(())
}

fn spheres(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for poisson in [0.3, 0.499, 0.4999] {
        for element in ELEMENTS {
            for (around, through) in [(6, 4), (12, 8)] {
                let start = Instant::now();
                let linear = options(Linear::Cholesky);
                let (ratio, solution) = sphere::run(element, poisson, around, through, &linear)?;
                let mesh = format!("{around} around, {through} through");
                let case = format!("thick sphere, nu {poisson}");
                value(out, &case, element, &mesh, ratio, &solution, start)?;
            }
        }
    }
    Ok(())
}

fn cooks(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for (name, poisson) in [("1/3", 1.0 / 3.0), ("0.4999", 0.4999)] {
        for element in ELEMENTS {
            for n in [8, 16, 32] {
                let start = Instant::now();
                let linear = options(Linear::Cholesky);
                let (rise, solution) = cook::run(element, poisson, [n, n, 1], &linear)?;
                let (mesh, case) = (format!("{n} x {n} x 1"), format!("Cook, nu {name}"));
                value(out, &case, element, &mesh, rise, &solution, start)?;
            }
        }
    }
    Ok(())
}

/// A line of the table of values.
fn value(
    out: &mut impl Write,
    case: &str,
    element: Element,
    mesh: &str,
    value: f64,
    solution: &StaticSolution,
    start: Instant,
) -> Result<(), Box<dyn Error>> {
    let unknowns = 3 * solution.state.x.len();
    let seconds = start.elapsed().as_secs_f64();
    writeln!(
        out,
        "value\t{case}\t{}\t{mesh}\t{unknowns}\t{value:.5}\t{seconds:.2}",
        name(element)
    )?;
    Ok(out.flush()?)
}

fn cubes(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for (element, cells) in [
        (Element::T4, 13),
        (Element::T10, 6),
        (Element::T4, 24),
        (Element::T10, 12),
    ] {
        for linear in [Linear::Cg, Linear::CgAssembled, Linear::Cholesky] {
            let start = Instant::now();
            let solution = cube::run(element, cells, &options(linear))?;
            let seconds = start.elapsed().as_secs_f64();
            let unknowns = 3 * solution.state.x.len();
            for (_, report) in &solution.report.steps {
                let residuals: Vec<String> = report
                    .residuals
                    .iter()
                    .map(|r| format!("{r:.1e}"))
                    .collect();
                writeln!(
                    out,
                    "newton\t{linear:?}\t{}\t{unknowns}\t{}\t{}\t{}\t{seconds:.2}",
                    name(element),
                    report.iterations,
                    report.linear_iterations,
                    residuals.join(" "),
                )?;
            }
            out.flush()?;
        }
    }
    Ok(())
}

fn taylors(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for (rings, layers, elements) in [
        (2, 24, &ELEMENTS[..]),
        (3, 36, &ELEMENTS[..]),
        (6, 72, &ELEMENTS[..2]),
    ] {
        for &element in elements {
            let start = Instant::now();
            let bar = taylor::run(element, rings, layers)?;
            writeln!(
                out,
                "bar\t{}\t{rings} rings, {layers} layers\t{}\t{}\t{:.3}\t{:.3}\t{:.1e}\t{:.0}",
                name(element),
                bar.elements,
                bar.steps,
                1e3 * bar.radius,
                1e3 * bar.length,
                bar.energy_error,
                start.elapsed().as_secs_f64(),
            )?;
            out.flush()?;
        }
    }
    Ok(())
}

fn name(element: Element) -> &'static str {
    match element {
        Element::T4 => "T4",
        Element::T4NodalPressure => "T4, nodal pressure",
        Element::T10 => "T10",
        Element::T10Fbar => "T10, F-bar",
    }
}

fn options(linear: Linear) -> StaticOptions {
    StaticOptions {
        newton: NewtonOptions {
            linear,
            tolerance: 1e-13,
            ..NewtonOptions::default()
        },
        ..StaticOptions::default()
    }
}
