//! Processor time, to tell what work costs while other programs run.

use std::time::{Duration, Instant};

/// Processor time that this process has taken so far on all its threads; `None` where the platform does not report it.
///
/// ```
/// let start = femdem_solve::processor_time();
/// let sum: f64 = (0..100_000).map(|k| f64::from(k).sqrt()).sum();
/// assert!(sum > 0.0);
/// assert!(femdem_solve::processor_time() >= start);
/// ```
#[cfg(unix)]
pub fn processor_time() -> Option<Duration> {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    let seconds = u64::try_from(now.tv_sec).ok()?;
    Some(Duration::new(seconds, u32::try_from(now.tv_nsec).ok()?))
}

/// Processor time that this process has taken so far on all its threads; `None` where the platform does not report it.
#[cfg(not(unix))]
pub fn processor_time() -> Option<Duration> {
    None
}

/// Measures work: by processor time, or on the clock where the platform does not report that.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch {
    processor: Option<Duration>,
    clock: Instant,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self {
            processor: processor_time(),
            clock: Instant::now(),
        }
    }

    /// The time since the start.
    pub fn elapsed(&self) -> Duration {
        match self.processor.zip(processor_time()) {
            Some((start, now)) => now.saturating_sub(start),
            None => self.clock.elapsed(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What other threads do counts, too.
    #[cfg(unix)]
    #[test]
    fn the_work_of_all_threads_counts() {
        let watch = Stopwatch::start();
        let work = || {
            let mut sum = 0_u64;
            for k in 0..20_000_000_u64 {
                sum = std::hint::black_box(sum.wrapping_mul(31).wrapping_add(k));
            }
            sum
        };
        assert_ne!(work(), 0);
        let one = watch.elapsed();
        std::thread::scope(|scope| {
            let threads = [scope.spawn(work), scope.spawn(work)];
            for thread in threads {
                thread.join().unwrap();
            }
        });
        // This thread only waits meanwhile.
        let others = watch.elapsed() - one;
        assert!(others > one / 10, "{one:?}, {others:?}");
    }
}
