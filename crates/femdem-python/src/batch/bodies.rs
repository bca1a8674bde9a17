//! Bodies and walls that come into a batch and leave it.

use std::sync::Arc;

use femdem::contact::{BodyId, ContactError, Frame, Inertia, MaterialId, Motion};
use femdem::run::WallEntry;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::{Body, ContactBatch};
use crate::arrays::{column, distinct};
use crate::error::{options, refused, wrong};
use crate::shape::Shape;
use crate::threads::unlocked;

/// Puts something at a number, which may be the next new one.
fn put<T>(list: &mut Vec<T>, number: u32, value: T) {
    let i = number as usize;
    match list.get_mut(i) {
        Some(old) => *old = value,
        None => list.push(value),
    }
}

impl ContactBatch {
    fn no_such(what: &'static str, index: u32, count: usize) -> PyErr {
        let index = index as usize;
        refused(ContactError::NoSuch { what, index, count })
    }

    /// Whether all are bodies, each given once.
    fn known(&self, bodies: &[BodyId]) -> PyResult<()> {
        let stranger = bodies.iter().find(|id| !self.batch.contains(**id));
        match stranger {
            Some(id) => Err(Self::no_such("body", *id, self.batch.len())),
            None => distinct(bodies),
        }
    }

    pub(super) fn known_wall(&self, wall: u32) -> PyResult<()> {
        match self.batch.wall(wall) {
            Some(_) => Ok(()),
            None => Err(Self::no_such("wall", wall, self.batch.walls().count())),
        }
    }
}

#[pymethods]
impl ContactBatch {
    /// Adds rigid bodies of one shape; returns their numbers.
    fn add<'py>(
        &mut self,
        py: Python<'py>,
        shape: &Bound<'py, Shape>,
        density: f64,
        count: usize,
        material: u8,
    ) -> PyResult<Bound<'py, PyArray1<BodyId>>> {
        let form = shape.get().solid()?;
        if !(density > 0.0 && density.is_finite()) {
            return Err(wrong(
                "density",
                density,
                "a positive, finite number, in kg/m^3",
            ));
        }
        let (mass, tensor) = form.mass(density);
        let inertia = Inertia::new(mass, &tensor).map_err(refused)?;
        let mut known = (0..).zip(&self.shapes);
        let id = if let Some((id, _)) = known.find(|(_, own)| Arc::ptr_eq(own, form)) {
            id
        } else {
            let made = unlocked(py, || form.contact())?;
            self.shapes.push(Arc::clone(form));
            self.batch.add_shape(made)
        };
        let radius = self.batch.shapes()[id as usize].radius();
        let mut ids = Vec::with_capacity(count);
        for _ in 0..count {
            let body = self.batch.add_body(id).map_err(refused)?;
            let touched = self.batch.set_material(body, MaterialId(material));
            touched.map_err(refused)?;
            let own = Body {
                form: Arc::clone(form),
                inertia,
                centroid: form.centroid(),
                radius,
                mass,
                tensor,
                is_placed: false,
            };
            put(&mut self.bodies, body, Some(own));
            put(&mut self.motions, body, Motion::fixed(Frame::identity()));
            ids.push(body);
        }
        Ok(column(py, ids))
    }

    /// Adds a wall, or the walls of a box, as a scene describes it; returns their numbers.
    fn add_wall(
        &mut self,
        py: Python<'_>,
        name: &str,
        entry: &str,
        material: u8,
    ) -> PyResult<Vec<u32>> {
        let entry: WallEntry = options("wall", entry)?;
        let (shapes, _) = unlocked(py, || entry.shapes(name))?;
        let mut ids = Vec::new();
        for shape in shapes {
            let wall = self.batch.add_wall(shape);
            let touched = self.batch.set_wall_material(wall, MaterialId(material));
            touched.map_err(refused)?;
            for list in [&mut self.walls, &mut self.next_walls] {
                put(list, wall, Motion::fixed(Frame::identity()));
            }
            ids.push(wall);
        }
        Ok(ids)
    }

    /// Removes bodies; returns those that they touched.
    fn remove<'py>(
        &mut self,
        py: Python<'py>,
        bodies: Vec<BodyId>,
    ) -> PyResult<Bound<'py, PyArray1<BodyId>>> {
        self.known(&bodies)?;
        let mut touched = Vec::new();
        for id in bodies {
            touched.extend(self.batch.remove_body(id).map_err(refused)?);
            self.bodies[id as usize] = None;
        }
        touched.retain(|id| self.batch.contains(*id));
        touched.sort_unstable();
        touched.dedup();
        Ok(column(py, touched))
    }

    /// Removes a wall; returns the bodies that touched it.
    fn remove_wall<'py>(
        &mut self,
        py: Python<'py>,
        wall: u32,
    ) -> PyResult<Bound<'py, PyArray1<BodyId>>> {
        let touched = self.batch.remove_wall(wall).map_err(refused)?;
        // So that it moves no more.
        self.next_walls[wall as usize] = self.walls[wall as usize];
        Ok(column(py, touched))
    }

    /// Ends the contacts of bodies that a host puts elsewhere.
    fn put_elsewhere(&mut self, bodies: Vec<BodyId>) -> PyResult<()> {
        self.known(&bodies)?;
        for id in bodies {
            self.batch.moved_by_hand(id).map_err(refused)?;
        }
        Ok(())
    }
}
