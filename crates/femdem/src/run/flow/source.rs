//! Bodies that come while a simulation runs.

use femdem_contact::MaterialId;
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Point3, Pose, Vector3};
use femdem_pack::{body_stream, random_rotation, uniform};
use femdem_solve::{BodySpec, ShapeId, World};
use serde::{Deserialize, Serialize};

use super::{Count, SourceEntry};
use crate::Error;
use crate::run::loads::Placed;
use crate::run::{Member, Scenario, Simulation};

/// Places that are tried in a step at most.
const TRIES: u32 = 16;

/// A source in progress.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::run) struct Supply {
    pub name: String,
    /// Its bodies, at rest.
    pub shape: ShapeId,
    pub density: f64,
    material: MaterialId,
    /// Mass of one \[kg\].
    pub mass: f64,
    /// Distance of the farthest point from the centroid \[m\].
    pub radius: f64,
    /// Corners of the box for the centroids \[m\].
    pub lower: [f64; 3],
    pub upper: [f64; 3],
    /// m/s.
    pub velocity: [f64; 3],
    /// 1/s.
    rate: f64,
    /// Bodies in all.
    pub most: u64,
    start: f64,
    end: f64,
    seed: u64,
    /// Places tried so far.
    tried: u32,
    pub(super) come: Count,
}

impl Supply {
    /// Number of bodies that should have come by a time \[s\].
    fn due(&self, time: f64) -> u64 {
        let due = self.rate * (time.min(self.end) - self.start);
        // A negative number becomes 0.
        (due as u64).min(self.most)
    }

    /// The time at which the last body is due \[s\], 0 once it has come.
    pub fn settled_from(&self) -> f64 {
        if self.is_done() {
            return 0.0;
        }
        (self.start + self.most as f64 / self.rate).min(self.end)
    }

    fn is_done(&self) -> bool {
        self.come.bodies as u64 >= self.most
    }

    /// Mass of the bodies that are still to come \[kg\].
    pub fn mass_to_come(&self) -> f64 {
        let left = self.most.saturating_sub(self.come.bodies as u64);
        left as f64 * self.mass
    }

    /// One of its bodies as the loads see it: at the highest place at which it may come, above the middle of the box. `None`
    /// if all have come.
    pub fn placed(&self, member: usize, axes: &[Vector3; 3], world: &World) -> Option<Placed> {
        if self.is_done() {
            return None;
        }
        let [low, high] = [self.lower, self.upper].map(Vector3::from);
        let middle = |axis: &Vector3| 0.5 * axis.dot(&(low + high));
        let half = 0.5 * (high - low).abs().dot(&axes[0].abs());
        let shape = world.shape(self.shape)?;
        let centre = [middle(&axes[0]) + half, middle(&axes[1]), middle(&axes[2])];
        Some(Placed {
            member,
            mass: self.mass,
            volume: shape.volume,
            diameter: 2.0 * self.radius,
            field_depth: world.field_depth(self.shape)?,
            speed: Vector3::from(self.velocity).norm(),
            extents: centre.map(|at| [at - self.radius, at + self.radius]),
            width: 2.0 * self.radius,
            drop: 0.0,
        })
    }

    /// The next place to be tried: a centroid and an orientation.
    fn next_place(&mut self) -> Pose {
        let mut stream = body_stream(self.seed, self.tried);
        self.tried = self.tried.wrapping_add(1);
        let share = [0, 1, 2].map(|_| uniform(&mut stream));
        let at = [0, 1, 2].map(|k| self.lower[k] + share[k] * (self.upper[k] - self.lower[k]));
        Pose::from_parts(Translation3::from(at), random_rotation(&mut stream))
    }
}

impl Simulation {
    /// The source that an entry describes, with its shape in the world.
    pub(super) fn supply(
        &mut self,
        scene: &Scenario,
        entry: &SourceEntry,
        name: &str,
    ) -> Result<Supply, Error> {
        entry.check()?;
        let density = scene.material(&entry.material)?.density()?;
        let material = scene.material_id(&entry.material)?;
        let geometry = entry.geometry()?;
        self.note(geometry.note.as_ref());
        let shape = self.add_shape(name, &geometry)?;
        let volume = self.world.shapes()[shape as usize].volume;
        let mass = density * volume;
        let rate = entry.bodies_per_second(mass)?;
        Ok(Supply {
            name: name.to_owned(),
            shape,
            density,
            material,
            mass,
            radius: self.reach_of(shape),
            lower: entry.lower,
            upper: entry.upper,
            velocity: entry.velocity,
            rate,
            most: entry.most(mass, rate, scene.duration)?,
            start: entry.start,
            end: entry.end.unwrap_or(f64::MAX),
            seed: entry.seed,
            tried: 0,
            come: Count::default(),
        })
    }

    /// Distance of the farthest point of a shape from its centroid \[m\].
    fn reach_of(&self, shape: ShapeId) -> f64 {
        let shape = &self.world.shapes()[shape as usize];
        shape.sphere.unwrap_or_else(|| {
            let centroid = shape.polyhedron.mass_properties().centroid;
            let corners = shape.polyhedron.vertices().iter();
            corners.map(|x| (x - centroid).norm()).fold(0.0, f64::max)
        })
    }

    /// Adds the bodies of sources that are due and for which there is room.
    pub(in crate::run) fn bring_bodies(&mut self) -> Result<(), Error> {
        let time = self.world.time();
        for k in 0..self.flow.supplies.len() {
            let due = self.flow.supplies[k].due(time);
            let lacks = |supply: &Supply| (supply.come.bodies as u64) < due;
            if !lacks(&self.flow.supplies[k]) {
                continue;
            }
            // What is there, found once a step.
            let mut others = self.balls();
            for _ in 0..TRIES {
                if !lacks(&self.flow.supplies[k]) {
                    break;
                }
                let place = self.flow.supplies[k].next_place();
                let radius = self.flow.supplies[k].radius;
                let x = place.translation.vector;
                let free = |(at, reach): &(Vector3, f64)| (at - x).norm() >= radius + reach;
                if others.iter().all(free) && self.is_off_walls(&x, radius) {
                    self.bring(k, &place)?;
                    others.push((x, radius));
                }
            }
        }
        Ok(())
    }

    /// Balls around all bodies: centroids and radii \[m\].
    fn balls(&self) -> Vec<(Vector3, f64)> {
        let shapes = 0..self.world.shapes().len();
        let reach: Vec<f64> = shapes
            .map(|shape| self.reach_of(shape as ShapeId))
            .collect();
        let ball = |member: &Member| {
            let x = self.world.position(member.id)?;
            let radius = match self.world.deformable(member.id) {
                Some(body) => {
                    let far = body.positions().iter().map(|p| (p - x).norm());
                    far.fold(0.0, f64::max)
                }
                None => reach[self.world.shape_of(member.id)? as usize],
            };
            Some((x, radius))
        };
        self.members.iter().filter_map(ball).collect()
    }

    /// Whether a ball overlaps no wall.
    fn is_off_walls(&self, x: &Vector3, radius: f64) -> bool {
        self.world.walls().all(|(wall, shape)| {
            let pose = self.world.wall_pose(wall).unwrap_or_default();
            let x = pose.inverse_transform_point(&Point3::from(*x));
            shape.clearance(&x.coords) >= radius
        })
    }

    /// Adds the next body of a source, with its centroid and orientation at `place`.
    fn bring(&mut self, k: usize, place: &Pose) -> Result<(), Error> {
        let supply = &self.flow.supplies[k];
        let polyhedron = &self.world.shapes()[supply.shape as usize].polyhedron;
        let centroid = polyhedron.mass_properties().centroid;
        let pose = place * Pose::from_parts((-centroid.coords).into(), Default::default());
        let id = self.world.add_body(BodySpec {
            shape: supply.shape,
            density: supply.density,
            pose,
            velocity: Vector3::from(supply.velocity),
            angular_velocity: Vector3::zeros(),
            material: supply.material,
        })?;
        let x = place.translation.vector;
        for gate in &mut self.flow.gates {
            let is_beyond = gate.is_beyond(&x);
            gate.beyond.push(is_beyond);
        }
        self.members.push(Member {
            name: format!("{} {}", supply.name, self.members.len()),
            id,
            placed: pose,
        });
        let mass = supply.mass;
        self.flow.supplies[k].come.add(1, mass);
        Ok(())
    }
}
