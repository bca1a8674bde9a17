//! Processor time of the calling thread.

use std::fs;
use std::io;

/// Processor time that the calling thread has used, s, by Linux's scheduler statistics.
///
/// # Errors
/// If the system does not report it.
pub fn thread_time() -> io::Result<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat")?;
    let nanoseconds = text.split_whitespace().next().map(str::parse::<f64>);
    match nanoseconds {
        Some(Ok(time)) => Ok(1e-9 * time),
        _ => Err(io::Error::other(
            "/proc/thread-self/schedstat is not in the expected form",
        )),
    }
}
