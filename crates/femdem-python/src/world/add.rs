//! Bodies and walls that come into a world.

use std::sync::Arc;

use femdem::contact::{BodyId, MaterialId};
use femdem::fem::DeformableModel;
use femdem::fem::element::Element;
use femdem::mesh::Vector3;
use femdem::run::{Controls, FractureEntry, MaterialEntry, MotionEntry, WallEntry, density_factor};
use femdem::solve::{
    self, BodySpec, ContactStiffness, DeformableSpec, ShapeId, SolveError, WorldParameters,
};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::World;
use crate::arrays::{column, poses, rows_for};
use crate::error::{FemdemError, choice, options, refused, wrong};
use crate::shape::Shape;
use crate::threads::unlocked;

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
    fn shape_id(&mut self, py: Python<'_>, shape: &Shape) -> PyResult<ShapeId> {
        let form = shape.solid()?;
        let mut known = (0..).zip(&self.shapes);
        if let Some((id, _)) = known.find(|(_, own)| Arc::ptr_eq(own, form)) {
            return Ok(id);
        }
        let id = unlocked(py, || form.add_to(&mut self.world))?;
        self.shapes.push(Arc::clone(form));
        Ok(id)
    }

    /// Adds bodies, all of them or none, and returns their numbers.
    fn add_all<'py, S: Send>(
        &mut self,
        py: Python<'py>,
        specs: impl Iterator<Item = S> + Send,
        add: impl Fn(&mut solve::World, S) -> Result<BodyId, SolveError> + Send,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let world = &mut self.world;
        let ids = unlocked(py, move || {
            let mut ids = Vec::new();
            for spec in specs {
                match add(world, spec) {
                    Ok(id) => ids.push(id),
                    Err(error) => {
                        ids.into_iter().try_for_each(|id| world.remove_body(id))?;
                        return Err(error);
                    }
                }
            }
            Ok(ids)
        })?;
        Ok(column(py, ids))
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
        let shape = self.shape_id(py, shape.get())?;
        let rows = places.into_iter().zip(motions).zip(densities);
        let specs = rows.map(|((pose, [velocity, angular_velocity]), density)| BodySpec {
            shape,
            density,
            pose,
            velocity,
            angular_velocity,
            material: MaterialId(material),
        });
        self.add_all(py, specs, |world, spec| match &drive {
            Some(motion) => world.add_driven_body(spec, motion.drive()),
            None => world.add_body(spec),
        })
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
        boundary: &str,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let places = poses(places)?;
        let motions = motions(velocity, angular_velocity, places.len())?;
        let form = shape.get().solid()?;
        if let Some(size) = mesh_size.filter(|_| form.has_tetrahedra()) {
            let allowed = "leave it out: the shape has tetrahedra of its own";
            return Err(wrong("mesh_size", size, allowed));
        }
        let made = format!("{matter} {mesh_size:?} {element} {contact_ratio}");
        let mut known = self.models.iter();
        let known = known.find(|(of, how, _)| Arc::ptr_eq(of, form) && *how == made);
        let matter: MaterialEntry = options("material", matter)?;
        let fracture = matter.fracture.as_ref().map(FractureEntry::fracture);
        let fracture = fracture.transpose().map_err(refused)?;
        let model = if let Some((.., model)) = known {
            *model
        } else {
            let element: Element = choice("element", element)?;
            let model = unlocked(py, || {
                let mut region = matter.region()?;
                let mesh = form.tetrahedra(mesh_size.unwrap_or(MESH_SIZE))?;
                region.density *= density_factor(&form.surface, &mesh);
                let model = DeformableModel::new(&mesh, element, vec![region], None)?;
                let stiffness = ContactStiffness::Ratio(contact_ratio);
                Ok::<_, femdem::Error>(self.world.add_model(&form.name, model, stiffness)?)
            })?;
            self.models.push((Arc::clone(form), made, model));
            model
        };
        let boundary = self.boundary(boundary, model)?;
        let rows = places.into_iter().zip(motions);
        let specs = rows.map(|(pose, [velocity, angular_velocity])| DeformableSpec {
            model,
            pose,
            velocity,
            angular_velocity,
            boundary: boundary.clone(),
            material: MaterialId(material),
            fracture,
        });
        self.add_all(py, specs, solve::World::add_deformable)
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
        let (world, controls) = (&mut self.world, &mut self.controls);
        let add = |world: &mut solve::World, controls: &mut Controls| {
            let before: Vec<u32> = world.walls().map(|(id, _)| id).collect();
            entry.add_to(name, MaterialId(material), world)?;
            let ids = world.walls().map(|(id, _)| id);
            let ids: Vec<u32> = ids.filter(|id| !before.contains(id)).collect();
            controls.control_walls(&entry, name, &ids, world)?;
            Ok::<_, femdem::Error>(ids)
        };
        unlocked(py, || {
            // Another world tells first whether it can be controlled.
            let mut trial = solve::World::new(WorldParameters::default())?;
            add(&mut trial, &mut Controls::default())?;
            add(world, controls)
        })
    }

    /// Gives a wall another motion, counted from where it is; `None` holds it. Its control ends.
    fn drive_wall(&mut self, wall: u32, motion: Option<&str>) -> PyResult<()> {
        let motion: Option<MotionEntry> = motion.map(|text| options("motion", text)).transpose()?;
        let drive = motion.map(|motion| motion.drive()).unwrap_or_default();
        drive.validate().map_err(refused)?;
        let released = self.controls.release(wall, &mut self.world);
        released.map_err(refused)?;
        self.world.drive_wall(wall, drive).map_err(refused)
    }

    fn remove_wall(&mut self, py: Python<'_>, wall: u32) -> PyResult<()> {
        let (world, controls) = (&mut self.world, &mut self.controls);
        unlocked(py, || {
            controls.release(wall, world)?;
            world.remove_wall(wall)
        })
    }
}

/// A density for each body, or one for all.
fn densities(given: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<f64>> {
    let list: Vec<f64> = match given.extract() {
        Ok(one) => vec![one; count],
        Err(_) => given.extract().map_err(|_| {
            FemdemError::new_err("density is a number in kg/m^3, or one for each body")
        })?,
    };
    if list.len() != count {
        let came = list.len();
        return Err(FemdemError::new_err(format!(
            "density has {came} numbers, and 1 or {count} are needed, one for each body"
        )));
    }
    match list.iter().find(|x| !(**x > 0.0 && x.is_finite())) {
        Some(x) => Err(wrong(
            "density",
            x,
            "give positive, finite numbers, in kg/m^3",
        )),
        None => Ok(list),
    }
}
