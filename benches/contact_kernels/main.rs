//! Every contact kernel and parry's contact query on the same touching pairs, in one run: nanoseconds per pair,
//! as tables.
//!
//! Kernels take turns of a few rounds over the pairs, and each figure is the fastest of all rounds, so that
//! other work on the machine matters little. No pair moves; `warm` uses the cache that the batch keeps, `cold`
//! is the stateless call.

mod convex;
mod faces;
mod meshed;
mod pairs;

use std::error::Error;
use std::time::Instant;

/// Turns of each kernel.
const TURNS: u32 = 200;

/// Rounds over the pairs in a turn: at the first one the processor's caches hold other data.
const ROUNDS: u32 = 5;

/// One kernel: a name, and a round over all pairs.
struct Kernel<'a> {
    name: &'static str,
    pairs: usize,
    round: Box<dyn FnMut() + 'a>,
}

impl<'a> Kernel<'a> {
    fn new(name: &'static str, pairs: usize, round: impl FnMut() + 'a) -> Self {
        let round = Box::new(round);
        Self { name, pairs, round }
    }
}

/// Fastest time per pair of each kernel, ns.
fn fastest(kernels: &mut [Kernel], turns: u32) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; kernels.len()];
    for _ in 0..turns {
        for (kernel, best) in kernels.iter_mut().zip(&mut best) {
            for _ in 0..ROUNDS {
                let start = Instant::now();
                (kernel.round)();
                let time = start.elapsed().as_nanos() as f64;
                *best = best.min(time / kernel.pairs.max(1) as f64);
            }
        }
    }
    best
}

/// Prints a table with a heading and a row for each case.
fn print(title: &str, columns: &[&str], rows: &[Vec<String>]) {
    println!("\n{title}\n\n| {} |", columns.join(" | "));
    println!("|{}", "---|".repeat(columns.len()));
    for row in rows {
        println!("| {} |", row.join(" | "));
    }
}

/// A row of a table: a name, and times.
fn row(name: &str, times: &[f64]) -> Vec<String> {
    let times = times.iter().map(|t| format!("{t:.0}"));
    std::iter::once(name.to_owned()).chain(times).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    // `cargo test --benches` runs this, too: then one turn is enough.
    let is_bench = std::env::args().any(|argument| argument == "--bench");
    let turns = if is_bench { TURNS } else { 1 };
    convex::table(turns)?;
    meshed::table(turns)?;
    faces::table(turns)?;
    Ok(())
}
