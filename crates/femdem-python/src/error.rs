//! Errors as Python sees them.

use std::fmt::Display;

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::Value;

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

/// A word for one of several things, such as a unit.
pub fn choice<T: DeserializeOwned>(name: &str, word: &str) -> PyResult<T> {
    let value = Value::String(word.to_owned());
    serde_json::from_value(value).map_err(|error| FemdemError::new_err(format!("{name}: {error}")))
}
