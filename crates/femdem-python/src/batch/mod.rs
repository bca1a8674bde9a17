//! Contacts for hosts that own the bodies and their motion: layer 2 of the contact crate.

mod bodies;
mod state;
mod stored;

use std::sync::Arc;

use femdem::contact::{
    self, ContactError, ContactLaw, ContactLaws, ContactParameters, Frame, Inertia, MaterialId,
    Motion,
};
use femdem::mesh::{Matrix3, Pose, Vector3};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::{poses, rows_for, vectors};
use crate::error::{options, refused, wrong};
use crate::shape::Form;
use crate::threads::unlocked;

/// What the motion of a body is made of.
struct Body {
    form: Arc<Form>,
    inertia: Inertia,
    /// Centroid in the coordinates of the shape, m.
    centroid: Vector3,
    /// Of its farthest point from the centroid, m.
    radius: f64,
    /// kg.
    mass: f64,
    /// About the centroid in the axes of the shape, kg m^2.
    tensor: Matrix3,
    /// Whether its motion is that of an update.
    is_placed: bool,
}

impl Body {
    /// The motion of its centroid, where `pose` takes the coordinates of its shape to the world.
    fn motion(
        &self,
        pose: &Pose,
        velocity: Vector3,
        spin: Vector3,
        last: &Motion,
    ) -> Result<Motion, ContactError> {
        let own = Pose::translation(self.centroid.x, self.centroid.y, self.centroid.z);
        let motion = self.inertia.motion(&(pose * own), velocity, spin)?;
        let way = if self.is_placed {
            motion.way_from(last, self.radius)
        } else {
            0.0
        };
        Ok(Motion {
            travelled: last.travelled + way,
            ..motion
        })
    }
}

/// Contacts of rigid bodies and walls that a host moves.
#[pyclass(module = "femdem._femdem")]
pub struct ContactBatch {
    batch: contact::ContactBatch,
    /// Its shapes by their numbers.
    shapes: Vec<Arc<Form>>,
    /// By number; `None` where there is none.
    bodies: Vec<Option<Body>>,
    /// As of the last update.
    motions: Vec<Motion>,
    walls: Vec<Motion>,
    /// Where the walls are in the next update; the travel of these means nothing.
    next_walls: Vec<Motion>,
}

impl ContactBatch {
    /// Reads the motions of the bodies.
    fn read(
        &self,
        given: &Bound<'_, PyAny>,
        velocities: Option<&Bound<'_, PyAny>>,
        spins: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<Motion>> {
        let (places, count) = (poses(given)?, self.batch.len());
        if places.len() != count {
            let came = places.len();
            return Err(wrong(
                "rows of poses",
                came,
                &format!("{count} are needed, one for each body in the order of ids"),
            ));
        }
        let read = |name, given: Option<&Bound<'_, PyAny>>| match given {
            Some(given) => rows_for::<3>(name, given, count),
            None => Ok(vec![[0.0; 3]; count]),
        };
        let velocities = read("velocities", velocities)?;
        let spins = read("angular_velocities", spins)?;
        let mut motions = self.motions.clone();
        let bodies = (0_u32..).zip(self.bodies.iter().zip(&mut motions));
        let bodies = bodies.filter_map(|(id, (body, motion))| Some((id, body.as_ref()?, motion)));
        let rows = places.iter().zip(velocities).zip(spins);
        for ((id, body, motion), ((pose, v), w)) in bodies.zip(rows) {
            let moved = body.motion(pose, v.into(), w.into(), motion);
            *motion = reached("body", id, moved.map_err(refused)?)?;
        }
        Ok(motions)
    }

    /// The motions of the walls in the next update, where bodies have these motions.
    fn moved_walls(&self, bodies: &[Motion]) -> PyResult<Vec<Motion>> {
        let moved = |(id, (last, next)): (u32, (&Motion, &Motion))| {
            let travelled = last.travelled + self.batch.wall_way(last, next, bodies);
            reached("wall", id, Motion { travelled, ..*next })
        };
        let walls = self.walls.iter().zip(&self.next_walls);
        (0..).zip(walls).map(moved).collect()
    }

    fn laws(&self) -> ContactLaws {
        self.batch.laws().clone()
    }
}

/// Refuses a place without a finite way to it: no later one would have a finite way either.
fn reached(what: &str, id: u32, motion: Motion) -> PyResult<Motion> {
    if motion.travelled.is_finite() {
        return Ok(motion);
    }
    let at: [f64; 3] = motion.frame.position.into();
    let name = format!("pose of {what} {id}");
    let allowed = "its distance from the last place must be finite";
    Err(wrong(&name, format!("{at:?}"), allowed))
}

fn law(name: &str, text: &str) -> PyResult<ContactLaw> {
    let parameters: ContactParameters = options(name, text)?;
    ContactLaw::new(parameters).map_err(refused)
}

#[pymethods]
impl ContactBatch {
    #[new]
    fn new(contact: &str) -> PyResult<Self> {
        Ok(Self {
            batch: contact::ContactBatch::new(law("ContactBatch", contact)?),
            shapes: Vec::new(),
            bodies: Vec::new(),
            motions: Vec::new(),
            walls: Vec::new(),
            next_walls: Vec::new(),
        })
    }

    /// Finds and evaluates all contacts; a step of `dt` has led here.
    fn update<'py>(
        &mut self,
        py: Python<'py>,
        places: &Bound<'py, PyAny>,
        velocities: Option<&Bound<'py, PyAny>>,
        angular_velocities: Option<&Bound<'py, PyAny>>,
        dt: f64,
    ) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
        let motions = self.read(places, velocities, angular_velocities)?;
        let walls = self.moved_walls(&motions)?;
        // Also if it is refused: the travel to the next places counts from these.
        (self.motions, self.walls) = (motions, walls);
        let bodies = self.bodies.iter_mut().flatten();
        bodies.for_each(|body| body.is_placed = true);
        unlocked(py, || self.batch.update(&self.motions, &self.walls, dt))?;
        self.loads(py)
    }

    /// Forces and torques about the centroids, as of the last update.
    fn loads<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
        let loads = self.batch.loads();
        let each = || self.batch.body_ids().map(|id| &loads[id as usize].total);
        Ok([
            vectors(py, each().map(|load| load.force))?,
            vectors(py, each().map(|load| load.torque))?,
        ])
    }

    /// Puts a wall elsewhere from the next update on.
    fn move_wall(
        &mut self,
        wall: u32,
        pose: &Bound<'_, PyAny>,
        velocity: [f64; 3],
        angular_velocity: [f64; 3],
    ) -> PyResult<()> {
        self.known_wall(wall)?;
        let places = poses(pose)?;
        let [place] = *places else {
            return Err(wrong("rows of pose", places.len(), "give one pose (7,)"));
        };
        self.next_walls[wall as usize] = Motion {
            velocity: velocity.into(),
            angular_velocity: angular_velocity.into(),
            ..Motion::fixed(Frame::from(&place))
        };
        Ok(())
    }

    /// Replaces the law of all pairs of materials without one of their own.
    fn set_contact(&mut self, text: &str) -> PyResult<()> {
        let laws = self.laws().with_usual(law("contact", text)?);
        self.batch.set_laws(laws);
        Ok(())
    }

    /// Gives a pair of materials a law of its own.
    fn set_law(&mut self, a: u8, b: u8, text: Option<&str>) -> PyResult<()> {
        let own = text.map(|text| law("law", text)).transpose()?;
        let mut laws = self.laws();
        laws.set([MaterialId(a), MaterialId(b)], own);
        self.batch.set_laws(laws);
        Ok(())
    }

    fn contact(&self) -> PyResult<String> {
        serde_json::to_string(self.batch.laws().usual()).map_err(refused)
    }
}
