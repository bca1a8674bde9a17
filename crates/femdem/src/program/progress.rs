//! The progress bar, and the lines of a log in its place.

use std::cell::Cell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use anyhow::Result;
use femdem::output::short_number;
use femdem::pack::{Progress, Stage};
use femdem::run::{Run, Simulation};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Time between the lines of a log.
const LOG_EVERY: Duration = Duration::from_secs(30);

/// Writes the progress as lines where standard error is no terminal, so that a file or a job queue shows it.
struct Log {
    /// `None`: no lines.
    every: Option<Duration>,
    last: Cell<Instant>,
}

impl Log {
    fn new(quiet: bool) -> Self {
        let on = !quiet && !std::io::stderr().is_terminal();
        Self::every(on.then_some(LOG_EVERY))
    }

    fn every(every: Option<Duration>) -> Self {
        let last = Cell::new(Instant::now());
        Self { every, last }
    }

    /// Whether a line is due; the next one is then due after another interval.
    fn is_due(&self) -> bool {
        let due = self
            .every
            .is_some_and(|every| self.last.get().elapsed() >= every);
        if due {
            self.last.set(Instant::now());
        }
        due
    }
}

/// Shows the progress of a job: on a terminal as a bar, elsewhere as lines.
pub(crate) struct Bar {
    bar: ProgressBar,
    log: Log,
    started: Instant,
    /// Share of the work that was done when this part of the run began.
    share_at_start: f64,
}

impl Bar {
    pub(crate) fn new(at: &Progress, quiet: bool) -> Result<Self> {
        let bar = ProgressBar::new(u64::from(at.count));
        if quiet {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.set_style(
            ProgressStyle::with_template("[{bar:30}] {pos}/{len} bodies {msg}")?
                .progress_chars("=> "),
        );
        Ok(Self {
            bar,
            log: Log::new(quiet),
            started: Instant::now(),
            share_at_start: share(at),
        })
    }

    pub(crate) fn show(&self, at: &Progress) {
        let left = self
            .time_left(at)
            .map_or(String::new(), |left| format!(", {} left", span(left)));
        let text = format!(
            "{}, height {:.3} m, {:.2} s simulated, {} awake{left}",
            at.stage, at.top, at.time, at.awake
        );
        if self.log.is_due() {
            super::complain(&format!("{} of {} bodies {text}", at.placed, at.count));
        }
        self.bar.set_position(u64::from(at.placed));
        self.bar.set_message(text);
    }

    fn time_left(&self, at: &Progress) -> Option<Duration> {
        time_left(share(at), self.share_at_start, self.started)
    }

    /// Writes a line above the bar.
    pub(crate) fn note(&self, text: &str) {
        self.bar.suspend(|| super::complain(text));
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Time to go if the work continues at its present rate; none before that can be estimated.
fn time_left(share: f64, share_at_start: f64, started: Instant) -> Option<Duration> {
    let (done, elapsed) = (share - share_at_start, started.elapsed());
    let judged = done > 0.02 && elapsed > Duration::from_secs(1);
    judged.then(|| elapsed.mul_f64((1.0 - share).max(0.0) / done))
}

/// Shows the simulated time in the same way.
pub(crate) struct Clock {
    bar: ProgressBar,
    log: Log,
    started: Instant,
    /// s.
    duration: f64,
    share_at_start: f64,
}

/// Positions of the bar of a [`Clock`].
const TICKS: f64 = 1000.0;

impl Clock {
    pub(crate) fn new(duration: f64, at: &Simulation, quiet: bool) -> Result<Self> {
        let bar = ProgressBar::new(TICKS as u64);
        if quiet {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.set_style(ProgressStyle::with_template("[{bar:30}] {msg}")?.progress_chars("=> "));
        Ok(Self {
            bar,
            log: Log::new(quiet),
            started: Instant::now(),
            duration,
            share_at_start: at.world.time() / duration,
        })
    }

    pub(crate) fn show(&self, run: &Run) {
        let (world, frames) = (&run.simulation().world, run.frames().len());
        if let Some(so_far) = run.relaxation() {
            let text = format!(
                "relaxing: {} steps, residual {:.1e}",
                so_far.steps, so_far.residual
            );
            return self.tell(1.0, text);
        }
        let share = (world.time() / self.duration).min(1.0);
        let left = time_left(share, self.share_at_start, self.started);
        let left = left.map_or(String::new(), |left| format!(", {} left", span(left)));
        let text = format!(
            "{} of {} s, step {} of {:.1e} s, {frames} frames{left}",
            short_number(world.time()),
            self.duration,
            world.steps(),
            world.time_step()
        );
        self.tell(share, text);
    }

    fn tell(&self, share: f64, text: String) {
        if self.log.is_due() {
            super::complain(&text);
        }
        self.bar.set_position((share * TICKS) as u64);
        self.bar.set_message(text);
    }

    /// Writes a line above the bar.
    pub(crate) fn note(&self, text: &str) {
        self.bar.suspend(|| super::complain(text));
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Share of the work that is done, 0 to 1; deposition is most of it.
fn share(at: &Progress) -> f64 {
    match at.stage {
        Stage::Depositing => 0.9 * f64::from(at.placed) / f64::from(at.count.max(1)),
        Stage::Settling => 0.92,
        Stage::Verifying => 0.96,
        Stage::Done => 1.0,
    }
}

/// "12 s", "3 min", "2 h 5 min".
pub(super) fn span(time: Duration) -> String {
    let seconds = time.as_secs();
    match seconds {
        0..=99 => format!("{seconds} s"),
        100..=5999 => format!("{} min", (seconds + 30) / 60),
        _ => format!("{} h {} min", seconds / 3600, seconds % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_due_after_every_interval_and_never_without_one() {
        assert!(!Log::every(None).is_due());
        assert!(!Log::every(Some(Duration::from_secs(3600))).is_due());
        let log = Log::every(Some(Duration::ZERO));
        assert!(log.is_due() && log.is_due());
    }

    #[test]
    fn spans_are_short() {
        let text = |seconds| span(Duration::from_secs(seconds));
        assert_eq!(
            [text(5), text(150), text(7500)],
            ["5 s", "3 min", "2 h 5 min"]
        );
    }
}
