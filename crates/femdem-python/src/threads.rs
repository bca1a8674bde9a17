//! The threads on which the libraries compute, without the interpreter lock.

use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{fault, refused, wrong};

/// The pool, with the process that made it: a fork has none of its threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process; one thread for each core unless [`set_threads`] said another number.
fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*kept {
        Some((process, pool)) if *process == process::id() => Ok(Arc::clone(pool)),
        of_parent => {
            let threads = of_parent
                .as_ref()
                .map_or(0, |(_, p)| p.current_num_threads());
            let made = make(threads)?;
            // Threads that are not there cannot be joined.
            if let Some(gone) = kept.replace((process::id(), Arc::clone(&made))) {
                std::mem::forget(gone);
            }
            Ok(made)
        }
    }
}

/// Work of the libraries, on the threads of the pool and without the interpreter lock. A panic there is a fault of femdem,
/// and becomes an error.
pub fn unlocked<T: Send, E: Display + Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, E> + Send,
) -> PyResult<T> {
    let pool = pool()?;
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(|| pool.install(work))));
    done.map_err(|panic| fault(&*panic))?.map_err(refused)
}

fn make(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    Ok(Arc::new(pool.map_err(refused)?))
}

/// Lets worlds compute on so many threads. Results are the same bits for any number.
#[pyfunction]
pub fn set_threads(threads: i64) -> PyResult<()> {
    let count = usize::try_from(threads).ok().filter(|&count| count > 0);
    let count = count.ok_or_else(|| wrong("threads", threads, "give 1 or more"))?;
    let made = make(count)?;
    *POOL.lock().unwrap_or_else(PoisonError::into_inner) = Some((process::id(), made));
    Ok(())
}
