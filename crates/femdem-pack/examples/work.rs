//! What a deposition costs and where: truncated dodecahedra in a column of 7 d x 7 d, one thread. See
//! `records/cost.md`.
//!
//! Prints lines of columns separated by tabs: phase, body steps per body, touching pairs evaluated per
//! body, time per body in ms, steps, rounds of the linear systems. Arguments: bodies, seed, and `awake` for a
//! run in which no body ever sleeps.

mod common;

use femdem_mesh::catalogue::CatalogueShape;
use femdem_pack::{Container, PackShape, PackSpec, Packing, Penalty, Progress, Stage};
use std::error::Error;
use std::io::Write;
use std::time::Instant;

/// d, m.
const DIAMETER: f64 = 0.05;

/// Pa; the same for all columns, so that their steps are alike.
const PENALTY: f64 = 5.2e6;

/// Below this number of bodies there is no relaxation.
const FEWEST: u32 = 100;

const PHASES: [&str; 4] = [
    "some awake",
    "all awake while it grows",
    "last relaxation",
    "verification",
];

/// Sums over the steps of a phase.
#[derive(Debug, Clone, Copy, Default)]
struct Work {
    body_steps: u64,
    touching: u64,
    steps: u64,
    rounds: u64,
}

impl Work {
    fn of(packing: &Packing) -> Self {
        let counters = packing.world().counters();
        Self {
            body_steps: counters.body_steps,
            touching: counters.touching_evaluations,
            steps: packing.world().steps(),
            rounds: counters.linear_rounds,
        }
    }

    fn add(&mut self, before: &Self, now: &Self) {
        self.body_steps += now.body_steps - before.body_steps;
        self.touching += now.touching - before.touching;
        self.steps += now.steps - before.steps;
        self.rounds += now.rounds - before.rounds;
    }
}

fn phase(at: &Progress) -> usize {
    let all = at.awake == at.placed as usize && at.placed >= FEWEST;
    match at.stage {
        _ if !all => 0,
        Stage::Depositing => 1,
        Stage::Settling => 2,
        _ => 3,
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    common::on_one_thread(run)
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text = |i: usize, default: &'static str| arguments.get(i).map_or(default, String::as_str);
    let count: u32 = text(0, "500").parse()?;
    let surface = "A10".parse::<CatalogueShape>()?.polyhedron(DIAMETER)?;
    let mut spec = PackSpec {
        shapes: vec![PackShape::new("A10", surface)],
        count,
        seed: text(1, "1").parse()?,
        friction: 0.6,
        penalty: Penalty::Given { pressure: PENALTY },
        container: Container::Box {
            width: 7.0 * DIAMETER,
            depth: 7.0 * DIAMETER,
        },
        ..PackSpec::default()
    };
    spec.sleeping.enabled = text(2, "") != "awake";

    let mut packing = Packing::new(spec)?;
    let mut work = [Work::default(); PHASES.len()];
    let mut times = [0.0; PHASES.len()];
    let (mut before, mut start) = (Work::of(&packing), Instant::now());
    while !packing.is_done() {
        let k = phase(&packing.progress());
        packing.advance(1)?;
        let (now, end) = (Work::of(&packing), Instant::now());
        work[k].add(&before, &now);
        times[k] += (end - start).as_secs_f64();
        (before, start) = (now, end);
    }
    let bodies = f64::from(count);
    let mut out = std::io::stdout().lock();
    for ((name, w), time) in PHASES.iter().zip(&work).zip(times) {
        writeln!(
            out,
            "{name}\t{:.0}\t{:.0}\t{:.2}\t{}\t{}",
            w.body_steps as f64 / bodies,
            w.touching as f64 / bodies,
            1e3 * time / bodies,
            w.steps,
            w.rounds
        )?;
    }
    let heights = (0..count).filter_map(|body| Some(packing.world().pose(body)?.translation.z));
    writeln!(
        out,
        "mean height over d\t{:.4}",
        heights.sum::<f64>() / (bodies * DIAMETER)
    )?;
    let report = packing.report()?;
    writeln!(out, "settled\t{}", report.settled)?;
    if let Some(found) = report.verification {
        writeln!(out, "tries to verify\t{}", found.tries)?;
    }
    Ok(())
}
