//! The commands of the program.

use std::ffi::OsString;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use femdem::program::{Outcome, call};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::error::{FemdemError, fault, refused};

/// Time between looks for Ctrl-C and for the end of a command.
const BREATH: Duration = Duration::from_millis(20);

/// Runs a command of the program to its end. After Ctrl-C, or another signal whose handler raises, it ends early with a
/// checkpoint if it makes one; what was raised first is raised then.
#[pyfunction]
pub fn command(py: Python<'_>, words: Vec<OsString>) -> PyResult<()> {
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&stop);
    // The thread of the caller looks for signals meanwhile.
    let work = thread::Builder::new().spawn(move || call(words, &seen));
    let work = work.map_err(refused)?;
    let mut raised: Option<PyErr> = None;
    while !work.is_finished() {
        py.detach(|| thread::sleep(BREATH));
        if let Err(error) = py.check_signals() {
            stop.store(true, Ordering::Relaxed);
            raised.get_or_insert(error);
        }
    }
    let ended = match py.detach(|| work.join()) {
        Err(panic) => Err(fault(&*panic)),
        Ok(Err(why)) => Err(FemdemError::new_err(why)),
        Ok(Ok(Outcome::Interrupted)) => Err(PyKeyboardInterrupt::new_err(())),
        Ok(Ok(Outcome::Finished)) => Ok(()),
    };
    raised.map_or(ended, Err)
}
