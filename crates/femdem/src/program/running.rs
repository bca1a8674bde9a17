//! What commands that take long share: threads, interruption, how they end.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use anyhow::{Context, Result, bail};
use femdem::Scene;

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// With all that it was asked for.
    Finished,
    /// By Ctrl-C; a checkpoint was written.
    Interrupted,
}

/// Interval at which the job checks for interrupts and shows its progress.
pub(super) const BREATH: Duration = Duration::from_millis(80);

/// Runs `work` on its own thread pool, and passes it the number of threads.
pub(crate) fn in_pool<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce(usize) -> Result<T> + Send,
) -> Result<T> {
    if threads == Some(0) {
        bail!("threads = 0 is not allowed: give 1 or more, or leave it out for one for each core");
    }
    // 0 means one thread for each core.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build();
    let pool = pool.context("cannot start the threads; give fewer with --threads")?;
    pool.install(|| work(pool.current_num_threads()))
}

pub(super) fn checkpoint_interval(seconds: Option<f64>) -> Result<Duration> {
    let seconds = seconds.unwrap_or(Scene::default().checkpoint_every);
    let allowed = "give a number of seconds, 0 or more";
    Duration::try_from_secs_f64(seconds).map_err(|_| {
        femdem::Error::Option {
            name: "checkpoint-every",
            value: seconds.to_string(),
            allowed,
        }
        .into()
    })
}

/// The flag of a host; or one that Ctrl-C sets, the same for all jobs of the program, where a second Ctrl-C ends the program
/// at once.
pub(super) fn watch_for_interrupt(host: Option<&Arc<AtomicBool>>) -> Result<Arc<AtomicBool>> {
    if let Some(flag) = host {
        return Ok(Arc::clone(flag));
    }
    static WATCHED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    if let Some(flag) = WATCHED.get() {
        return Ok(Arc::clone(flag));
    }
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(super::INTERRUPTED.into());
        }
    })
    .context("cannot watch for Ctrl-C")?;
    Ok(Arc::clone(WATCHED.get_or_init(|| flag)))
}
