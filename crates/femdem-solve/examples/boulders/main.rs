//! Deformable boulders dumped into the bin of the founding paper (Fig. 1), for
//! `cargo studies validate boulders-deformable`.
//!
//! Prints lines of columns separated by tabs; each begins with the name of its table. Arguments: the
//! simulated time (s), the number of threads, the number of boulders, the time (s) that they then spend in a
//! medium that damps their vibrations, and as long again without it, and a folder for their surfaces. With
//! `sleep` among the arguments boulders at rest are frozen instead; all are woken where the medium would
//! begin, and are awake in the last part.

mod pack;

use femdem_solve::Medium;
use pack::Pack;
use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// Lines of progress per simulated second.
const LINES: f64 = 4.0;

/// Drag of the medium, 1/s.
const DRAG: f64 = 10.0;

/// Number of evaluations when the elements are timed separately.
const REPEATS: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let (flags, arguments): (Vec<String>, Vec<String>) = std::env::args()
        .skip(1)
        .partition(|argument| argument == "sleep");
    let number = |i: usize, default: f64| arguments.get(i).map_or(Ok(default), |a| a.parse());
    let (seconds, threads, count) = (number(0, 4.0)?, number(1, 1.0)?, number(2, 288.0)?);
    let settling = number(3, 0.0)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads as usize)
        .build()?;
    let sleep = !flags.is_empty();
    let run = || run(seconds, count as usize, settling, sleep);
    let pack = pool.install(|| run().map_err(|e| e.to_string()))?;
    if let Some(folder) = arguments.get(4) {
        pack.write(Path::new(folder))?;
    }
    Ok(())
}

fn run(seconds: f64, count: usize, settling: f64, sleep: bool) -> Result<Pack, Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    let mut pack = Pack::new(count, sleep)?;
    writeln!(out, "number\tboulders\t{count}")?;
    writeln!(out, "number\ttets\t{}", pack.tets)?;
    let (start, cpu) = (Instant::now(), processor_time()?);
    let mut progress = Progress::new(cpu);
    progress.until(seconds, &mut pack, &mut out)?;
    writeln!(
        out,
        "number\tkinetic energy over m g d without a medium\t{:.6e}",
        pack.kinetic_energy()
    )?;
    if settling > 0.0 && sleep {
        // Load changes too small to wake a sleeper are transferred now.
        pack.world.wake_all();
        progress.until(seconds + settling, &mut pack, &mut out)?;
        pack.world.set_sleeping(false);
        progress.until(seconds + 2.0 * settling, &mut pack, &mut out)?;
    } else if settling > 0.0 {
        let drag = Medium {
            drag: DRAG,
            ..Medium::default()
        };
        pack.world.set_medium(drag)?;
        progress.until(seconds + settling, &mut pack, &mut out)?;
        writeln!(
            out,
            "number\tkinetic energy over m g d as the medium ends\t{:.6e}",
            pack.kinetic_energy()
        )?;
        pack.world.set_medium(Medium::default())?;
        progress.until(seconds + 2.0 * settling, &mut pack, &mut out)?;
    }
    let (cpu, steps) = (processor_time()? - cpu, pack.world.steps());
    let ledger = pack.world.ledger();
    for (name, value) in [
        ("wall seconds", start.elapsed().as_secs_f64()),
        ("processor seconds", cpu),
        ("steps", steps as f64),
        ("step", pack.world.time_step()),
        ("simulated seconds", pack.world.time()),
        (
            "processor seconds per simulated second",
            cpu / pack.world.time(),
        ),
        (
            "all-in ns per tet-step",
            1e9 * cpu / (steps as f64 * pack.tets as f64),
        ),
        ("elements ns per tet-step", pack.element_cost(REPEATS)?),
        ("kinetic energy over m g d", pack.kinetic_energy()),
        ("mean penetration over d", pack.penetration()),
        ("ledger error", ledger.error_relative()),
        ("above the rim", pack.above_the_rim() as f64),
    ] {
        writeln!(out, "number\t{name}\t{value:.6e}")?;
    }
    writeln!(out, "hash\t{:016x}", pack.world.state_hash()?)?;
    Ok(pack)
}

/// Lines about the run so far.
struct Progress {
    /// Processor time at the start, s.
    start: f64,
    /// Processor time, steps and time at the last line.
    before: (f64, u64, f64),
    next: f64,
}

impl Progress {
    fn new(start: f64) -> Self {
        Self {
            start,
            before: (start, 0, 0.0),
            next: 1.0 / LINES,
        }
    }

    /// Steps until a simulated time, s.
    fn until(
        &mut self,
        end: f64,
        pack: &mut Pack,
        out: &mut impl Write,
    ) -> Result<(), Box<dyn Error>> {
        while pack.world.time() < end {
            pack.world.step()?;
            if pack.world.time() >= self.next {
                self.next += 1.0 / LINES;
                self.line(pack, out)?;
            }
        }
        Ok(())
    }

    fn line(&mut self, pack: &Pack, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
        let now = (processor_time()?, pack.world.steps(), pack.world.time());
        let before = std::mem::replace(&mut self.before, now);
        let each = (now.0 - before.0) / ((now.1 - before.1) as f64 * pack.tets as f64);
        let totals = pack.world.deformable_totals().copied().unwrap_or_default();
        writeln!(
            out,
            "progress\t{:.2}\t{}\t{:.3e}\t{:.2}\t{:.2}\t{:.1}\t{}\t{}\t{}\t{}\t{:.3e}",
            now.2,
            now.1,
            pack.world.time_step(),
            now.0 - self.start,
            (now.0 - before.0) / (now.2 - before.2),
            each * 1e9,
            totals.touching,
            totals.candidates,
            totals.pieces,
            pack.world.awake_deformable_count(),
            pack.kinetic_energy(),
        )?;
        Ok(out.flush()?)
    }
}

/// Processor time of all threads of this process, s.
fn processor_time() -> Result<f64, Box<dyn Error>> {
    // Fields 14 and 15 count hundredths of a second. Field 2, in parentheses, may contain spaces.
    let text = std::fs::read_to_string("/proc/self/stat")?;
    let rest = text.rsplit(')').next().unwrap_or_default();
    let fields: Vec<&str> = rest.split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).map_or(Ok(0.0), |f| f.parse::<f64>());
    Ok((ticks(11)? + ticks(12)?) / 100.0)
}
