//! Arrays in and out.

use std::collections::BTreeSet;

use femdem::mesh::nalgebra::{Quaternion, Translation3, UnitQuaternion};
use femdem::mesh::{Pose, Vector3, checked_pose};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{FemdemError, wrong};

/// What the numbers of a pose are.
const ROW: &str = "a pose is x, y, z, qw, qx, qy, qz";

/// The rows of an array of shape (n, N), or (N,) for one row, all finite.
pub fn rows<const N: usize>(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; N]>> {
    let (shape, numbers) = numbers(name, given)?;
    match *shape {
        [_, columns] if columns == N => {}
        [columns] if columns == N => {}
        _ => {
            let came = tuple(&shape);
            return Err(FemdemError::new_err(format!(
                "{name} has the shape {came}, and (n, {N}) or ({N},) is needed"
            )));
        }
    }
    let (rows, _) = numbers.as_chunks::<N>();
    Ok(rows.to_vec())
}

/// The same with as many rows as there are bodies; one row is for all of them.
pub fn rows_for<const N: usize>(
    name: &str,
    given: &Bound<'_, PyAny>,
    count: usize,
) -> PyResult<Vec<[f64; N]>> {
    let rows = rows(name, given)?;
    match *rows {
        [one] => Ok(vec![one; count]),
        _ if rows.len() == count => Ok(rows),
        _ => Err(FemdemError::new_err(format!(
            "{name} has {} rows, and 1 or {count} are needed, one for each body",
            rows.len()
        ))),
    }
}

/// Refuses lists that have a body twice.
pub fn distinct(bodies: &[u32]) -> PyResult<()> {
    let mut seen = BTreeSet::new();
    match bodies.iter().find(|id| !seen.insert(**id)) {
        Some(id) => Err(FemdemError::new_err(format!(
            "body {id} is given twice: give each body once"
        ))),
        None => Ok(()),
    }
}

fn numbers(name: &str, given: &Bound<'_, PyAny>) -> PyResult<(Vec<usize>, Vec<f64>)> {
    let py = given.py();
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    options.set_item("order", "C")?;
    let numpy = py.import("numpy")?;
    let array = numpy.call_method("asarray", (given,), Some(&options));
    let array = array
        .map_err(|error| FemdemError::new_err(format!("{name} is no array of numbers: {error}")))?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    let numbers = array.to_vec()?;
    if let Some((at, value)) = (0..).zip(&numbers).find(|(_, x)| !x.is_finite()) {
        return Err(wrong(
            &format!("{name}.flat[{at}]"),
            value,
            "give finite numbers",
        ));
    }
    Ok((array.shape().to_vec(), numbers))
}

fn tuple(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => {
            let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// Poses of rows x, y, z, qw, qx, qy, qz.
pub fn poses(given: &Bound<'_, PyAny>) -> PyResult<Vec<Pose>> {
    rows::<7>("poses", given)?.iter().map(pose).collect()
}

fn pose(&[x, y, z, w, i, j, k]: &[f64; 7]) -> PyResult<Pose> {
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
    let pose = Pose::from_parts(Translation3::new(x, y, z), turn);
    checked_pose(&pose).map_err(|error| FemdemError::new_err(format!("{error}; {ROW}")))
}

/// The row of a pose.
pub fn row(pose: &Pose) -> [f64; 7] {
    let (x, q) = (pose.translation.vector, pose.rotation.coords);
    [x.x, x.y, x.z, q.w, q.x, q.y, q.z]
}

/// An array (n, N).
pub fn table<'py, T: numpy::Element, const N: usize>(
    py: Python<'py>,
    rows: impl IntoIterator<Item = [T; N]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let flat: Vec<T> = rows.into_iter().flatten().collect();
    let count = flat.len() / N;
    PyArray1::from_vec(py, flat).reshape([count, N])
}

/// An array (n, 3) of vectors.
pub fn vectors<'py>(
    py: Python<'py>,
    rows: impl IntoIterator<Item = Vector3>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    table(py, rows.into_iter().map(<[f64; 3]>::from))
}

/// An array (n,).
pub fn column<'py, T: numpy::Element>(
    py: Python<'py>,
    values: impl IntoIterator<Item = T>,
) -> Bound<'py, PyArray1<T>> {
    PyArray1::from_vec(py, values.into_iter().collect())
}
