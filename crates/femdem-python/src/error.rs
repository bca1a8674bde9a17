//! Errors as Python sees them, and work without the interpreter lock.

use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;

create_exception!(
    femdem,
    FemdemError,
    PyException,
    "What femdem refuses: the value, what is allowed, and what to do."
);

/// An error of the libraries.
pub fn refused(error: impl Display) -> PyErr {
    FemdemError::new_err(error.to_string())
}

/// A value that is not allowed.
pub fn wrong(name: &str, value: impl Display, allowed: &str) -> PyErr {
    FemdemError::new_err(format!("{name} = {value} is not allowed: {allowed}"))
}

/// Work of the libraries without the interpreter lock. A panic there is a fault of femdem, and becomes an error.
pub fn unlocked<T: Send, E: Display + Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, E> + Send,
) -> PyResult<T> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    done.map_err(|panic| fault(&*panic))?.map_err(refused)
}

/// What a panic said, as an error.
pub fn fault(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    let text = text.unwrap_or("of unknown cause");
    FemdemError::new_err(format!(
        "a fault of femdem itself, please report it; do not use the object any more: {text}"
    ))
}

/// Options that the Python layer passes as text.
pub fn options<T: DeserializeOwned>(name: &str, text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|error| {
        // The place is of a text that the caller has not seen.
        let error = error.to_string();
        let what = error.split(" at line ").next().unwrap_or(&error);
        FemdemError::new_err(format!("{name}: {what}"))
    })
}
