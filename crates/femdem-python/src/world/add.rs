//! Bodies and walls that come into a world.

use std::sync::Arc;

use femdem::contact::MaterialId;
use femdem::fem::element::Element;
use femdem::fem::{Boundary, DeformableModel};
use femdem::mesh::Vector3;
use femdem::run::{MaterialEntry, MotionEntry, WallEntry};
use femdem::solve::{BodySpec, ContactStiffness, DeformableSpec, ShapeId};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::World;
use crate::arrays::{column, poses, rows_for};
use crate::error::{FemdemError, options, refused, unlocked};
use crate::shape::{Shape, tetrahedra};

/// Size of the tetrahedra of deformable bodies in circumscribed diameters, as in scenes.
const MESH_SIZE: f64 = 0.2;

/// Velocities of bodies, and angular velocities.
fn motions(
    velocities: Option<&Bound<'_, PyAny>>,
    spins: Option<&Bound<'_, PyAny>>,
    count: usize,
) -> PyResult<Vec<[Vector3; 2]>> {
    let read = |name, given: Option<&Bound<'_, PyAny>>| match given {
        Some(given) => rows_for::<3>(name, given, count),
        None => Ok(vec![[0.0; 3]; count]),
    };
    let (v, w) = (
        read("velocity", velocities)?,
        read("angular_velocity", spins)?,
    );
    Ok(v.into_iter()
        .zip(w)
        .map(|(v, w)| [v.into(), w.into()])
        .collect())
}

impl World {
    fn shape_id(&mut self, shape: &Shape) -> PyResult<ShapeId> {
        let mut known = self.shapes.iter();
        if let Some((_, id)) = known.find(|(form, _)| Arc::ptr_eq(form, &shape.form)) {
            return Ok(*id);
        }
        let id = shape.form.add_to(&mut self.world).map_err(refused)?;
        self.shapes.push((Arc::clone(&shape.form), id));
        Ok(id)
    }
}

#[pymethods]
impl World {
    /// Adds rigid bodies of one shape; returns their numbers.
    #[expect(clippy::too_many_arguments, reason = "those of the Python layer")]
    fn add<'py>(
        &mut self,
        py: Python<'py>,
        shape: &Bound<'py, Shape>,
        places: &Bound<'py, PyAny>,
        density: &Bound<'py, PyAny>,
        velocity: Option<&Bound<'py, PyAny>>,
        angular_velocity: Option<&Bound<'py, PyAny>>,
        material: u8,
        motion: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let places = poses(places)?;
        let motions = motions(velocity, angular_velocity, places.len())?;
        let densities = densities(density, places.len())?;
        let drive: Option<MotionEntry> = motion.map(|text| options("motion", text)).transpose()?;
        let shape = self.shape_id(shape.get())?;
        let mut ids = Vec::with_capacity(places.len());
        for ((pose, [velocity, angular_velocity]), density) in
            places.into_iter().zip(motions).zip(densities)
        {
            let spec = BodySpec {
                shape,
                density,
                pose,
                velocity,
                angular_velocity,
                material: MaterialId(material),
            };
            let added = match &drive {
                Some(motion) => self.world.add_driven_body(spec, motion.drive()),
                None => self.world.add_body(spec),
            };
            match added {
                Ok(id) => ids.push(id),
                Err(error) => {
                    // All of them, or none.
                    ids.into_iter()
                        .try_for_each(|id| self.world.remove_body(id))
                        .map_err(refused)?;
                    return Err(refused(error));
                }
            }
        }
        Ok(column(py, ids))
    }

    /// Adds deformable bodies of one shape; returns their numbers.
    #[expect(clippy::too_many_arguments, reason = "those of the Python layer")]
    fn add_deformable<'py>(
        &mut self,
        py: Python<'py>,
        shape: &Bound<'py, Shape>,
        places: &Bound<'py, PyAny>,
        matter: &str,
        velocity: Option<&Bound<'py, PyAny>>,
        angular_velocity: Option<&Bound<'py, PyAny>>,
        material: u8,
        mesh_size: Option<f64>,
        element: &str,
        contact_ratio: f64,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let places = poses(places)?;
        let motions = motions(velocity, angular_velocity, places.len())?;
        let matter: MaterialEntry = options("material", matter)?;
        let element: Element = options("element", &format!("{element:?}"))?;
        let form = &shape.get().form;
        let model = unlocked(py, || {
            let region = matter.region()?;
            let mesh = tetrahedra(&form.surface, Some(mesh_size.unwrap_or(MESH_SIZE)))?;
            Ok::<_, femdem::Error>(DeformableModel::new(&mesh, element, vec![region], None)?)
        })?;
        let stiffness = ContactStiffness::Ratio(contact_ratio);
        let model = self
            .world
            .add_model(&form.name, model, stiffness)
            .map_err(refused)?;
        let mut ids = Vec::with_capacity(places.len());
        for (pose, [velocity, angular_velocity]) in places.into_iter().zip(motions) {
            let spec = DeformableSpec {
                model,
                pose,
                velocity,
                angular_velocity,
                boundary: Boundary::default(),
                material: MaterialId(material),
                fracture: None,
            };
            ids.push(self.world.add_deformable(spec).map_err(refused)?);
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
        let before: Vec<u32> = self.world.walls().map(|(id, _)| id).collect();
        unlocked(py, || {
            entry.add_to(name, MaterialId(material), &mut self.world)
        })?;
        let ids = self.world.walls().map(|(id, _)| id);
        Ok(ids.filter(|id| !before.contains(id)).collect())
    }

    /// Gives a wall another motion, counted from where it is; `None` holds it.
    fn drive_wall(&mut self, wall: u32, motion: Option<&str>) -> PyResult<()> {
        let motion: Option<MotionEntry> = motion.map(|text| options("motion", text)).transpose()?;
        let drive = motion.map(|motion| motion.drive()).unwrap_or_default();
        self.world.drive_wall(wall, drive).map_err(refused)
    }

    fn remove_wall(&mut self, wall: u32) -> PyResult<()> {
        self.world.remove_wall(wall).map_err(refused)
    }
}

/// A density for each body, or one for all.
fn densities(given: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    if let Ok(one) = given.extract::<f64>() {
        return Ok(vec![one; count]);
    }
    let list: Vec<f64> = given
        .extract()
        .map_err(|_| FemdemError::new_err("density is a number in kg/m^3, or one for each body"))?;
    if list.len() == count {
        Ok(list)
    } else {
        let came = list.len();
        Err(FemdemError::new_err(format!(
            "density has {came} numbers, and 1 or {count} are needed, one for each body"
        )))
    }
}
