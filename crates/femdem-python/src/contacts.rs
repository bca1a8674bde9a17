//! Contacts as columns.

use femdem::contact::{Contact, Partner};
use femdem::mesh::Vector3;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{column, vectors};

/// Contacts, one a row; a wall w is a = -1 - w.
pub fn columns<'py>(py: Python<'py>, contacts: &[Contact]) -> PyResult<Bound<'py, PyDict>> {
    let each = |of: fn(&Contact) -> f64| column(py, contacts.iter().map(of));
    let three = |of: fn(&Contact) -> Vector3| vectors(py, contacts.iter().map(of));
    let partners = contacts.iter().map(|contact| match contact.a {
        Partner::Body(body) => i64::from(body),
        Partner::Wall(wall) => -1 - i64::from(wall),
    });
    let columns = PyDict::new(py);
    columns.set_item("a", column(py, partners))?;
    columns.set_item("b", column(py, contacts.iter().map(|c| i64::from(c.b))))?;
    columns.set_item("point", three(|c| c.point)?)?;
    columns.set_item("normal", three(|c| c.normal)?)?;
    columns.set_item("force", three(Contact::force_on_b)?)?;
    columns.set_item("normal_force", each(|c| c.parts().0))?;
    columns.set_item("friction", three(|c| c.parts().1)?)?;
    columns.set_item("area", each(|c| c.area))?;
    columns.set_item("volume", each(|c| c.volume))?;
    columns.set_item("energy", each(Contact::potential))?;
    columns.set_item("slides", column(py, contacts.iter().map(|c| c.slides)))?;
    Ok(columns)
}
