//! A batch as bytes.

use std::sync::Arc;

use femdem::contact::{self, BodyShape, ContactError, Inertia, Motion};
use femdem::mesh::Matrix3;
use femdem::solve::checkpoint::{decode, encode};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};

use super::{Body, ContactBatch};
use crate::error::{FemdemError, refused};
use crate::shape::Form;
use crate::threads::unlocked;

/// A body: the number of its shape, its mass and inertia, and whether it has been in an update.
type Row = (u32, f64, Matrix3, bool);

#[derive(Serialize, Deserialize)]
struct Stored<B, S> {
    batch: B,
    shapes: S,
    bodies: Vec<Option<Row>>,
    /// Those of the bodies, of the walls, and of the walls in the next update.
    motions: [Vec<Motion>; 3],
}

#[pymethods]
impl ContactBatch {
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let ids = (0..).zip(&self.bodies);
        let rows = ids.map(|(id, body)| {
            let body = body.as_ref()?;
            let shape = self.batch.shape_index(id)?;
            Some((shape, body.mass, body.tensor, body.is_placed))
        });
        let shapes: Vec<&Form> = self.shapes.iter().map(Arc::as_ref).collect();
        let stored = Stored {
            batch: &self.batch,
            shapes,
            bodies: rows.collect(),
            motions: [&self.motions, &self.walls, &self.next_walls].map(Vec::clone),
        };
        let bytes = unlocked(py, || encode(&stored))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let stored: Stored<contact::ContactBatch, Vec<Form>> = unlocked(py, || decode(bytes))?;
        let Stored {
            mut batch,
            shapes,
            bodies,
            motions: [motions, walls, next_walls],
        } = stored;
        let shapes: Vec<Arc<Form>> = shapes.into_iter().map(Arc::new).collect();
        let made = unlocked(py, || {
            let made: Result<Vec<BodyShape>, ContactError> =
                shapes.iter().map(|form| form.contact()).collect();
            batch.restore_shapes(made?, Vec::new())?;
            Ok::<_, ContactError>(batch)
        })?;
        let [of_bodies, of_walls] = made.slots();
        let lengths = [bodies.len(), motions.len(), walls.len(), next_walls.len()];
        let holds = |(id, row): (u32, &Option<Row>)| {
            made.contains(id) == row.is_some()
                && row.is_none_or(|row| made.shape_index(id) == Some(row.0))
        };
        if lengths != [of_bodies, of_bodies, of_walls, of_walls] || !(0..).zip(&bodies).all(holds) {
            return Err(FemdemError::new_err(
                "the bytes of the batch do not fit together: give those of to_bytes",
            ));
        }
        let own = |row: Option<Row>| {
            row.map(|(shape, mass, tensor, is_placed)| {
                let form = &shapes[shape as usize];
                Ok(Body {
                    form: Arc::clone(form),
                    inertia: Inertia::new(mass, &tensor).map_err(refused)?,
                    centroid: form.centroid(),
                    radius: made.shapes()[shape as usize].radius(),
                    mass,
                    tensor,
                    is_placed,
                })
            })
            .transpose()
        };
        let bodies: PyResult<Vec<Option<Body>>> = bodies.into_iter().map(own).collect();
        Ok(Self {
            bodies: bodies?,
            batch: made,
            shapes,
            motions,
            walls,
            next_walls,
        })
    }
}
