//! The threads on which the libraries compute.

use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{refused, wrong};

/// The pool, with the process that made it: a fork has none of its threads.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process; one thread for each core unless [`set_threads`] said another number.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
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

fn make(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    Ok(Arc::new(pool.map_err(refused)?))
}

/// Lets worlds compute on so many threads. Results are the same bits for any number.
#[pyfunction]
pub fn set_threads(threads: usize) -> PyResult<()> {
    if threads == 0 {
        return Err(wrong("threads", 0, "give 1 or more"));
    }
    let made = make(threads)?;
    *POOL.lock().unwrap_or_else(PoisonError::into_inner) = Some((process::id(), made));
    Ok(())
}
