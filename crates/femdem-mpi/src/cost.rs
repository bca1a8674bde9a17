//! The cost of a job over ranks, and when the first of them says what it does.

use anyhow::Result;
use femdem::Usage;
use femdem::solve::{Counters, Halo, processor_time};
use femdem_mpi::MpiHalo;
use std::time::{Duration, Instant};

/// Time between two lines of progress.
const BREATH: Duration = Duration::from_secs(10);

/// Watches over this part of a job.
pub(crate) struct Cost {
    before: Usage,
    start: Instant,
    saved: Instant,
    told: Instant,
}

impl Cost {
    /// From now on; `before` is that of earlier parts.
    pub fn after(before: Usage) -> Self {
        let now = Instant::now();
        Self {
            before,
            start: now,
            saved: now,
            told: now,
        }
    }

    /// The cost so far, of all ranks together.
    pub fn usage(&self, counters: &Counters, halo: &mut MpiHalo) -> Result<Usage> {
        let nanoseconds = |time: Duration| time.as_nanos() as u64;
        let mut sums = [
            processor_time().map_or(0, nanoseconds),
            nanoseconds(counters.contact_time),
            counters.touching_evaluations,
            rayon::current_num_threads() as u64,
        ];
        halo.sum(&mut sums)?;
        let [all, contact, touching, threads] = sums;
        let before = &self.before;
        Ok(Usage {
            threads: threads as usize,
            wall_seconds: before.wall_seconds + self.start.elapsed().as_secs_f64(),
            cpu_seconds: processor_time()
                .map(|_| before.cpu_seconds.unwrap_or_default() + all as f64 * 1e-9),
            peak_memory_bytes: before.peak_memory_bytes,
            contact_seconds: before.contact_seconds + contact as f64 * 1e-9,
            touching_evaluations: before.touching_evaluations + touching,
        })
    }

    /// Whether it is time for a checkpoint, every so many seconds: the first rank says.
    pub fn is_save_due(&mut self, every: f64, halo: &mut MpiHalo) -> Result<bool> {
        let so = halo.rank() == 0 && self.saved.elapsed().as_secs_f64() >= every;
        let mut count = [u64::from(so)];
        halo.sum(&mut count)?;
        let due = count[0] > 0;
        if due {
            self.saved = Instant::now();
        }
        Ok(due)
    }

    /// Writes how far the job is, if it is time to do so.
    pub fn tell(&mut self, halo: &MpiHalo, what: impl FnOnce() -> String) {
        if halo.rank() == 0 && self.told.elapsed() >= BREATH {
            self.told = Instant::now();
            println!(
                "{}, {:.0} s so far",
                what(),
                self.start.elapsed().as_secs_f64()
            );
        }
    }
}
