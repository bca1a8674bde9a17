//! What a run costs: time on the clock, processor time, memory.

use std::fs;
use std::time::{Duration, Instant};

use femdem::Usage;
use femdem::solve::{Counters, processor_time};

/// Adds the cost of this part of a run to that of the earlier parts.
pub(crate) struct Meter {
    before: Usage,
    started: Instant,
    cpu_at_start: Option<f64>,
    threads: usize,
    /// Whether the job was complete before: reading it costs nothing.
    done: bool,
}

impl Meter {
    pub(crate) fn start(before: Usage, threads: usize, done: bool) -> Self {
        Self {
            done,
            before,
            started: Instant::now(),
            cpu_at_start: cpu_seconds(),
            threads,
        }
    }

    pub(crate) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// The cost so far. The counters of a world start at zero when it is made or read.
    pub(crate) fn read(&self, counters: &Counters) -> Usage {
        if self.done {
            return self.before;
        }
        let cpu = cpu_seconds()
            .zip(self.cpu_at_start)
            .map(|(now, start)| now - start);
        // A part of unknown cost makes the sum unknown; before the first part it is zero.
        let cpu_before = self
            .before
            .cpu_seconds
            .or((self.before.wall_seconds == 0.0).then_some(0.0));
        Usage {
            threads: self.threads,
            wall_seconds: self.before.wall_seconds + self.elapsed().as_secs_f64(),
            cpu_seconds: cpu.zip(cpu_before).map(|(now, before)| now + before),
            peak_memory_bytes: peak_memory_bytes().max(self.before.peak_memory_bytes),
            contact_seconds: self.before.contact_seconds + counters.contact_time.as_secs_f64(),
            touching_evaluations: self.before.touching_evaluations + counters.touching_evaluations,
        }
    }
}

/// Processor time of this program \[s\]; none if the system does not report it.
fn cpu_seconds() -> Option<f64> {
    processor_time().map(|time| time.as_secs_f64())
}

/// Largest resident memory of this program; none if the system does not report it.
fn peak_memory_bytes() -> Option<u64> {
    parse_memory(&fs::read_to_string("/proc/self/status").ok()?)
}

fn parse_memory(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_that_linux_tells_is_understood() {
        assert_eq!(
            parse_memory("Name:\tx\nVmHWM:\t    2048 kB\n"),
            Some(2 << 20)
        );
        assert_eq!(parse_memory("VmRSS: 1 kB"), None);
    }
}
