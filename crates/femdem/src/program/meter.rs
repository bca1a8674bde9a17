//! What a run costs: time on the clock, processor time, memory.

use std::fs;
use std::time::{Duration, Instant};

use femdem::Usage;
use femdem::solve::Counters;

/// Ticks per second in which Linux counts processor time for programs (USER_HZ).
const TICKS_PER_SECOND: f64 = 100.0;

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
    parse_cpu(&fs::read_to_string("/proc/self/stat").ok()?)
}

/// Fields 14 and 15 of proc(5)'s stat; field 2, the name in brackets, may contain spaces.
fn parse_cpu(stat: &str) -> Option<f64> {
    let after_name = stat.rsplit_once(')')?.1;
    let mut ticks = after_name
        .split_whitespace()
        .skip(11)
        .map(str::parse::<f64>);
    Some((ticks.next()?.ok()? + ticks.next()?.ok()?) / TICKS_PER_SECOND)
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
    fn files_of_linux_are_understood() {
        let stat = "7 (a) b) R 1 7 7 0 -1 4194304 91 0 0 0 250 50 0 0 20 0 1 0 11 2 3";
        assert_eq!(parse_cpu(stat), Some(3.0));
        assert_eq!(
            parse_memory("Name:\tx\nVmHWM:\t    2048 kB\n"),
            Some(2 << 20)
        );
        assert_eq!(parse_cpu("nonsense"), None);
        assert_eq!(parse_memory("VmRSS: 1 kB"), None);
    }
}
