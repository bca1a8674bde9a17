//! Tests of strength with known results.
//!
//! `cargo studies validate fracture` runs them all. Takes which test to run, for discs and blocks the number of one of them, from 0,
//! for grains that of a part, for beams and plates the edge of one mesh, m, for bars the cells across of one, for bars that burst one
//! rate. Prints lines of columns separated by tabs: `value`, test, mesh, setting, quantity, value.

mod bar;
mod beam;
mod bent;
mod block;
mod branch;
mod burst;
mod course;
mod crushed;
mod disc;
mod grain;
mod grains;
mod line;
mod mean;
mod notched;
mod opened;
mod plate;
mod scatter;
mod setting;
mod shape;
mod struck;

use std::error::Error;
use std::io::Write;

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    let which = std::env::args().nth(1).unwrap_or_default();
    match which.as_str() {
        "bar" => bars(&mut out),
        "block" => blocks(&mut out, number()?),
        "disc" => discs(&mut out, number()?),
        "opened" => opened(&mut out),
        "bent" => bent(&mut out),
        "burst" => bursts(&mut out),
        "branch" => branches(&mut out),
        "struck" => struck(&mut out),
        "notched" => notched(&mut out),
        "grain" => grains::press(&mut out, number()?),
        "crushed" => grains::crush(&mut out),
        _ => Err(
            "say which: bar, block, disc, opened, bent, burst, branch, struck, notched, grain or crushed"
                .into(),
        ),
    }
}

/// The number of one run of a test, if that is asked for.
fn number() -> Result<Option<usize>, Box<dyn Error>> {
    let one = std::env::args().nth(2);
    Ok(one.map(|one| one.parse()).transpose()?)
}

/// Prints the values of a run.
fn print(
    out: &mut impl Write,
    [test, mesh, setting]: [&str; 3],
    values: &[(&str, f64)],
) -> Result<(), Box<dyn Error>> {
    for (quantity, value) in values {
        // Sums of nothing are −0.
        let value = value + 0.0;
        writeln!(
            out,
            "value\t{test}\t{mesh}\t{setting}\t{quantity}\t{value:.4e}"
        )?;
    }
    out.flush()?;
    Ok(())
}

/// Bars in tension: three meshes, three seeds of their places of nodes.
fn bars(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let across = match std::env::args().nth(2) {
        Some(one) => vec![one.parse()?],
        None => vec![2, 3, 4],
    };
    for n in across {
        let cells = [4 * n, n, n];
        let mesh = format!("{} x {} x {}", cells[0], cells[1], cells[2]);
        for seed in [1, 2, 3] {
            let bar = bar::break_in_tension(cells, f64::from(seed))?;
            let values = [
                ("strength", bar.strength),
                ("crack", bar.crack),
                ("energy", bar.energy),
                ("pieces", bar.pieces as f64),
                ("books", bar.books),
            ];
            print(out, ["bar", &mesh, &format!("seed {seed}")], &values)?;
        }
    }
    Ok(())
}

/// Blocks under compression: three meshes, and one under three pressures on its sides.
fn blocks(out: &mut impl Write, one: Option<usize>) -> Result<(), Box<dyn Error>> {
    let runs = [(4, 0.0), (6, 0.0), (8, 0.0), (6, 5e6), (6, 10e6), (6, 20e6)];
    let chosen = runs.into_iter().enumerate();
    let chosen = chosen.filter(|(k, _)| one.is_none_or(|one| one == *k));
    for (_, (cells, confinement)) in chosen {
        let block = block::compress(cells, confinement)?;
        let mesh = format!("{cells} x {cells} x {}", 2 * cells);
        let setting = format!("{:.0} MPa", confinement / 1e6);
        let values = [
            ("strength", block.strength),
            ("held", block.held),
            ("books", block.books),
        ];
        print(out, ["block", &mesh, &setting], &values)?;
    }
    Ok(())
}

/// Discs across their diameter: three meshes, with two energies of fracture by sliding, and three by opening on the second.
fn discs(out: &mut impl Write, one: Option<usize>) -> Result<(), Box<dyn Error>> {
    let runs = [
        (24, [5.0, 25.0]),
        (36, [5.0, 25.0]),
        (48, [5.0, 25.0]),
        (36, [10.0, 50.0]),
        (36, [20.0, 100.0]),
        (24, [5.0, 5.0]),
        (36, [5.0, 5.0]),
        (48, [5.0, 5.0]),
    ];
    let chosen = runs.into_iter().enumerate();
    let chosen = chosen.filter(|(k, _)| one.is_none_or(|one| one == *k));
    for (_, (cells, energies)) in chosen {
        let disc = disc::split(cells, energies)?;
        let mesh = format!("{cells} cells across, {} tetrahedra", disc.tets);
        let setting = format!("{} and {} J/m2", energies[0], energies[1]);
        let values = [
            ("zones", disc.zones),
            ("first crack", disc.first),
            ("from the centre", disc.place[0]),
            ("from the diameter", disc.place[1]),
            ("strength", disc.peak),
            ("broken", disc.broken),
            ("angle", disc.angle),
            ("books", disc.books),
        ];
        print(out, ["disc", &mesh, &setting], &values)?;
    }
    Ok(())
}

/// Meshes of beams and plates by their cells, m: those of a test, or the one that is asked for.
fn meshes(usual: [f64; 3]) -> Result<Vec<f64>, Box<dyn Error>> {
    match std::env::args().nth(2) {
        Some(edge) => Ok(vec![edge.parse()?]),
        None => Ok(usual.to_vec()),
    }
}

/// Double cantilever beams: on each mesh the seam plane, then rough.
fn opened(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for fine in meshes([1.4e-3, 1.0e-3, 0.7e-3])? {
        for (setting, rough) in [("plane", false), ("rough", true)] {
            let run = opened::open(fine, rough)?;
            let mesh = format!("{:.2} mm, {} tetrahedra", 1e3 * fine, run.tets);
            print(out, ["opened", &mesh, setting], &run.values())?;
        }
    }
    Ok(())
}

/// End-loaded splits.
fn bent(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for fine in meshes([1.0e-3, 0.7e-3, 0.5e-3])? {
        let run = bent::bend(fine)?;
        let mesh = format!("{:.2} mm, {} tetrahedra", 1e3 * fine, run.tets);
        print(out, ["bent", &mesh, "plane"], &run.values())?;
    }
    Ok(())
}

/// Bars stretched at four rates, on three meshes, by three seeds of strengths.
fn bursts(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let rates = match std::env::args().nth(2) {
        Some(one) => vec![one.parse()?],
        None => vec![0.1, 1.0, 10.0, 100.0],
    };
    for rate in rates {
        for cells in [5, 7, 10] {
            let (mut length, mut formula, mut books) = (0.0, 0.0, 0.0_f64);
            for seed in [1.0, 2.0, 3.0] {
                let burst = burst::stretch(rate, cells, seed)?;
                length += burst.length / 3.0;
                formula = burst.formula;
                books = books.max(burst.books.abs());
            }
            let mesh = format!("{cells} cells by fragment");
            let values = [
                ("length", length),
                ("over the formula", length / formula),
                ("books", books),
            ];
            print(out, ["burst", &mesh, &format!("rate {rate}")], &values)?;
        }
    }
    Ok(())
}

/// Plates whose crack branches: three meshes, or the one that is asked for.
fn branches(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for edge in meshes([1.25e-3, 1.0e-3, 0.625e-3])? {
        let run = branch::branch(edge)?;
        let mesh = format!("{:.2} mm, {} tetrahedra", 1e3 * edge, run.tets);
        let mut values = vec![
            ("start", run.start),
            ("speed", run.speed),
            ("taken", run.taken),
            ("branches", if run.fork.is_some() { 2.0 } else { 1.0 }),
        ];
        if let Some(fork) = run.fork {
            values.extend([
                ("branch", fork.time),
                ("its place", fork.place),
                ("angle", fork.angle),
            ]);
        }
        values.push(("books", run.books));
        print(out, ["branch", &mesh, "1 MPa"], &values)?;
    }
    Ok(())
}

/// Plates that are struck beside their notch.
fn struck(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for edge in meshes([0.1 / 64.0, 1.25e-3, 1.0e-3])? {
        let run = struck::strike(edge)?;
        let mesh = format!("{:.2} mm, {} tetrahedra", 1e3 * edge, run.tets);
        let values = [
            ("start", run.start),
            ("angle", run.angle),
            ("chord", run.chord),
            ("length", run.length),
            ("speed", run.speed),
            ("books", run.books),
        ];
        print(out, ["struck", &mesh, "16.5 m/s"], &values)?;
    }
    Ok(())
}

/// Beams on three points: of a brittle rock, and of the concrete of Petersson's.
fn notched(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    for (beam, setting, edges) in [
        (notched::ROCK, "rock", [1.25e-3, 0.9e-3, 0.625e-3]),
        (notched::CONCRETE, "concrete", [25e-3, 20e-3, 12.5e-3]),
    ] {
        let asked = meshes(edges)?;
        let straight = line::largest_load(&beam);
        for fine in edges.into_iter().filter(|edge| asked.contains(edge)) {
            let beam = notched::Notched { fine, ..beam };
            let run = beam.bend()?;
            let mesh = format!("{:.2} mm, {} tetrahedra", 1e3 * fine, run.tets);
            let values = [
                ("load", run.peak),
                ("over the straight one", run.peak / straight),
                ("over the brittle one", run.peak / beam.brittle()),
                ("mouth", run.mouth),
                ("taken", run.taken),
                ("work", run.work),
                ("books", run.books),
            ];
            print(out, ["notched", &mesh, setting], &values)?;
        }
    }
    Ok(())
}
