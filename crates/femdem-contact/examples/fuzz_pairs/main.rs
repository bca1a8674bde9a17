//! Random pairs through every kernel: no panic, and only finite numbers.
//!
//! ```text
//! cargo run --release -p femdem-contact --features proptest --example fuzz_pairs -- 1000000 4 1
//! ```
//!
//! The arguments are the number of pairs, of threads, and the seed (default: 1000, 1 and 1). Prints a line
//! for each kernel, then sums, as `name<TAB>number...`; faults, if any, go to the standard error. Run by
//! `cargo studies validate fuzz-pairs`.

#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program prints its results"
)]

mod every_kernel;

use every_kernel::{KERNELS, Kernels, Verdict};
use femdem_contact::strategies::{Arrangement, TestPair, bodies, convex_bodies, pairs, placements};
use proptest::prop_oneof;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Placements drawn per two bodies: making bodies is the costlier part.
const PLACEMENTS: u64 = 32;

/// Number of faults that are printed in full.
const TOLD: usize = 5;

/// Energies that differ by more than this over p r^3 are printed.
const UNEQUAL: f64 = 1e-9;

/// Results of one thread, or of all.
#[derive(Default)]
struct Tally {
    pairs: u64,
    asked: [u64; KERNELS.len()],
    touching: [u64; KERNELS.len()],
    faults: [u64; KERNELS.len()],
    panics: u64,
    far: u64,
    smallest: f64,
    largest: f64,
    arrangements: [u64; Arrangement::ALL.len()],
    /// The largest difference of energies.
    energy_difference: f64,
    /// Pairs whose energies differ by more than [`UNEQUAL`].
    unequal: u64,
    told: Vec<String>,
}

impl Tally {
    fn add(&mut self, pair: &TestPair, verdict: Option<Verdict>) {
        let first = self.pairs == 0;
        self.pairs += 1;
        let sizes = [pair.a.radius(), pair.b.radius()];
        self.smallest = sizes
            .iter()
            .copied()
            .fold(if first { f64::INFINITY } else { self.smallest }, f64::min);
        self.largest = sizes.iter().copied().fold(self.largest, f64::max);
        self.far += u64::from(pair.frame_a.position.norm() > 1e4);
        let place = Arrangement::ALL.iter().position(|a| *a == pair.arrangement);
        self.arrangements[place.unwrap_or(0)] += 1;
        let Some(verdict) = verdict else {
            self.panics += 1;
            self.tell(format!("panic: {pair:?}"));
            return;
        };
        for k in 0..KERNELS.len() {
            self.asked[k] += u64::from(verdict.asked[k]);
            self.touching[k] += u64::from(verdict.touching[k]);
        }
        self.energy_difference = self.energy_difference.max(verdict.energy_difference);
        if verdict.energy_difference > UNEQUAL {
            self.unequal += 1;
            let difference = verdict.energy_difference;
            self.tell(format!("energies differ by {difference:e}: {pair:?}"));
        }
        for (kernel, text) in verdict.faults {
            self.faults[kernel] += 1;
            self.tell(format!("{}: {text}: {pair:?}", KERNELS[kernel]));
        }
    }

    fn tell(&mut self, text: String) {
        if self.told.len() < TOLD {
            self.told.push(text);
        }
    }

    fn merge(&mut self, other: Self) {
        let sums = [&mut self.asked, &mut self.touching, &mut self.faults];
        let others = [&other.asked, &other.touching, &other.faults];
        for (own, others) in sums.into_iter().zip(others) {
            own.iter_mut().zip(others).for_each(|(x, y)| *x += y);
        }
        let counts = self.arrangements.iter_mut().zip(&other.arrangements);
        counts.for_each(|(x, y)| *x += y);
        self.smallest = if self.pairs == 0 {
            other.smallest
        } else {
            self.smallest.min(other.smallest)
        };
        self.largest = self.largest.max(other.largest);
        self.energy_difference = self.energy_difference.max(other.energy_difference);
        self.unequal += other.unequal;
        self.pairs += other.pairs;
        self.panics += other.panics;
        self.far += other.far;
        other.told.into_iter().for_each(|text| self.tell(text));
    }

    fn print(&self) {
        for (k, name) in KERNELS.iter().enumerate() {
            let (asked, touching, faults) = (self.asked[k], self.touching[k], self.faults[k]);
            println!("kernel\t{name}\t{asked}\t{touching}\t{faults}");
        }
        for (arrangement, count) in Arrangement::ALL.iter().zip(self.arrangements) {
            println!("arrangement\t{arrangement:?}\t{count}");
        }
        println!("pairs\t{}\npanics\t{}", self.pairs, self.panics);
        println!("farther than 1e4 m\t{}", self.far);
        println!("smallest radius\t{:e}", self.smallest);
        println!("largest radius\t{:e}", self.largest);
        println!("unequal energies\t{}", self.unequal);
        println!("energy difference\t{:e}", self.energy_difference);
    }
}

/// Checks `count` pairs drawn from `seed`.
fn run(count: u64, seed: u64) -> Result<Tally, Box<dyn Error + Send + Sync>> {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    // Half of the pairs are convex on both sides, so that the kernels of convex bodies are tested enough.
    let pairs = prop_oneof![1 => pairs(convex_bodies()), 2 => pairs(bodies())];
    let placements = placements();
    let mut kernels = Kernels::new()?;
    let mut tally = Tally::default();
    while tally.pairs < count {
        let drawn = pairs
            .new_tree(&mut runner)
            .map_err(|e| e.to_string())?
            .current();
        for again in 0..PLACEMENTS.min(count - tally.pairs) {
            let pair = if again == 0 {
                drawn.clone()
            } else {
                let placement = placements
                    .new_tree(&mut runner)
                    .map_err(|e| e.to_string())?
                    .current();
                TestPair::new(&drawn.a, &drawn.b, &placement)
            };
            let verdict = catch_unwind(AssertUnwindSafe(|| kernels.check(&pair)));
            tally.add(&pair, verdict.ok().transpose()?);
        }
    }
    Ok(tally)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = |default: u64| match arguments.next() {
        Some(text) => text.parse(),
        None => Ok(default),
    };
    let (count, threads, seed) = (next(1000)?, next(1)?.max(1), next(1)?);
    let share = |k: u64| count / threads + u64::from(k < count % threads);
    let mut total = Tally::default();
    let tallies = std::thread::scope(|scope| {
        let start = |k: u64| scope.spawn(move || run(share(k), seed.wrapping_mul(1009) + k));
        let handles: Vec<_> = (0..threads).map(start).collect();
        let results = handles.into_iter().map(|h| h.join());
        results.collect::<Vec<_>>()
    });
    for tally in tallies {
        let tally = tally.map_err(|_| "a thread panicked outside the kernels")?;
        total.merge(tally.map_err(|e| e.to_string())?);
    }
    total.print();
    total.told.iter().for_each(|text| eprintln!("{text}"));
    Ok(())
}
