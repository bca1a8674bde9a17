//! What the host changes between steps.

use femdem::contact::Wrench;
use femdem::run::MotionEntry;
use femdem::solve::SolveError;
use pyo3::prelude::*;

use super::{World, no_such};
use crate::arrays::{distinct, poses, rows_for};
use crate::error::{FemdemError, options, refused};
use crate::threads::unlocked;

impl World {
    /// Refuses numbers of bodies that are not there or not rigid.
    pub(super) fn are_rigid(&self, bodies: &[u32]) -> PyResult<()> {
        let world = &self.world;
        match bodies.iter().find(|id| world.pose(**id).is_none()) {
            Some(id) => Err(no_such("rigid body", *id, world.rigid_ids().count())),
            None => Ok(()),
        }
    }

    /// Whether a change of bodies is possible for all of them, so that none is changed if it is not.
    fn can_change(&self, bodies: &[u32], rigid: bool) -> PyResult<()> {
        let world = &self.world;
        if rigid {
            self.are_rigid(bodies)?;
        }
        for &id in bodies {
            if world.mass(id).is_none() {
                return Err(no_such("body", id, world.body_count()));
            }
        }
        distinct(bodies)
    }
}

#[pymethods]
impl World {
    /// Puts rigid bodies at poses.
    fn set_pose(
        &mut self,
        py: Python<'_>,
        bodies: Vec<u32>,
        places: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let places = poses(places)?;
        if places.len() != bodies.len() {
            let (rows, count) = (places.len(), bodies.len());
            return Err(FemdemError::new_err(format!(
                "poses has {rows} rows, and {count} are needed, one for each body"
            )));
        }
        self.can_change(&bodies, true)?;
        let mut each = bodies.into_iter().zip(places);
        unlocked(py, || {
            each.try_for_each(|(id, pose)| self.world.set_pose(id, pose))
        })
    }

    /// Sets the velocities of rigid bodies; what is not given stays.
    fn set_velocity(
        &mut self,
        bodies: Vec<u32>,
        velocity: Option<&Bound<'_, PyAny>>,
        angular_velocity: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let read = |name, given: Option<&Bound<'_, PyAny>>| {
            given
                .map(|given| rows_for::<3>(name, given, bodies.len()))
                .transpose()
        };
        let (v, w) = (
            read("velocity", velocity)?,
            read("angular_velocity", angular_velocity)?,
        );
        self.can_change(&bodies, true)?;
        let mut each = bodies.iter();
        if let Some(&id) = each.find(|id| self.world.body_drive(**id).is_some()) {
            return Err(refused(SolveError::Driven { body: id as usize }));
        }
        for (k, id) in bodies.iter().copied().enumerate() {
            let given = |rows: &Option<Vec<[f64; 3]>>| rows.as_ref().map(|rows| rows[k].into());
            let v = given(&v)
                .or_else(|| self.world.velocity(id))
                .unwrap_or_default();
            let w = given(&w)
                .or_else(|| self.world.angular_velocity(id))
                .unwrap_or_default();
            self.world.set_velocity(id, v, w).map_err(refused)?;
        }
        Ok(())
    }

    /// Loads bodies with forces and torques, in place of earlier ones.
    fn set_load(
        &mut self,
        bodies: Vec<u32>,
        force: Option<&Bound<'_, PyAny>>,
        torque: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let read = |name, given: Option<&Bound<'_, PyAny>>| match given {
            Some(given) => rows_for::<3>(name, given, bodies.len()),
            None => Ok(vec![[0.0; 3]; bodies.len()]),
        };
        let (forces, torques) = (read("force", force)?, read("torque", torque)?);
        self.can_change(&bodies, false)?;
        for (id, torque) in bodies.iter().zip(&torques) {
            if self.world.pose(*id).is_none() && *torque != [0.0; 3] {
                return Err(FemdemError::new_err(format!(
                    "body {id} is deformable and bears no torque: give it a torque of 0"
                )));
            }
        }
        for ((id, force), torque) in bodies.iter().zip(forces).zip(torques) {
            let load = Wrench {
                force: force.into(),
                torque: torque.into(),
            };
            self.world.set_load(*id, load).map_err(refused)?;
        }
        Ok(())
    }

    /// Gives rigid bodies a prescribed motion, or sets them free.
    fn drive(&mut self, bodies: Vec<u32>, motion: Option<&str>) -> PyResult<()> {
        let motion: Option<MotionEntry> = motion.map(|text| options("motion", text)).transpose()?;
        let drive = motion.map(|motion| motion.drive());
        self.can_change(&bodies, true)?;
        let mut each = bodies.into_iter();
        each.try_for_each(|id| self.world.drive_body(id, drive))
            .map_err(refused)
    }

    fn remove(&mut self, py: Python<'_>, bodies: Vec<u32>) -> PyResult<()> {
        self.can_change(&bodies, false)?;
        let mut each = bodies.into_iter();
        unlocked(py, || each.try_for_each(|id| self.world.remove_body(id)))
    }
}
