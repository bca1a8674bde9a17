//! rapier3d, an impulse engine of single precision.
//!
//! Its defaults are made for bodies about a metre large. The job has no length except d and no time except
//! sqrt(d/g), so that the engine computes the same job with d = 1 m; its seconds are then sqrt(50) of the
//! job's.

use crate::settle::Engine;
use anyhow::{Context, Result};
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
use femdem_mesh::{Pose, Vector3};
use femdem_pack::{PackSpec, Packing};
use rapier3d::prelude as rapier;
use std::str::FromStr;

/// Resolution of the engine, in a world with d = 1 m.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// Steps per second; the engine's default is 60.
    pub rate: u32,
    /// Natural frequency of its contacts, 1/s; the engine's default is 30.
    pub frequency: f32,
}

impl FromStr for Setting {
    type Err = anyhow::Error;

    /// Reads `240`, with the default frequency, or `240:120`.
    fn from_str(text: &str) -> Result<Self> {
        let (rate, frequency) = text.split_once(':').unwrap_or((text, "30"));
        Ok(Self {
            rate: rate.parse().context("steps per second")?,
            frequency: frequency.parse().context("frequency of the contacts")?,
        })
    }
}

/// The engine's world, in units of d.
pub struct Rapier {
    world: rapier::PhysicsWorld,
    bodies: Vec<rapier::RigidBodyHandle>,
    /// d, m.
    length: f64,
    /// Seconds of the job per second of the engine.
    second: f64,
    gravity: f64,
    setting: Setting,
    sleeps: bool,
    steps: u64,
}

impl Rapier {
    /// All bodies at the starts of a packing job.
    pub fn new(spec: &PackSpec, setting: Setting, sleeps: bool) -> Result<Self> {
        let length = spec.diameter();
        let mut world = rapier::PhysicsWorld::new();
        world.gravity = rapier::Vector::new(0.0, 0.0, -spec.gravity as f32);
        world.integration_parameters.dt = 1.0 / setting.rate as f32;
        let softness = &mut world.integration_parameters.contact_softness;
        softness.natural_frequency = setting.frequency;
        add_walls(&mut world, spec, length);
        let surface = crate::settle::surface(spec)?;
        let points: Vec<rapier::Vector> = surface
            .vertices()
            .iter()
            .map(|v| single(&(v.coords / length)))
            .collect();
        let hull = rapier::ColliderBuilder::convex_hull(&points)
            .context("the engine makes no hull of the shape")?
            .density(spec.density as f32)
            .friction(spec.friction as f32)
            .restitution(0.0);
        let start = Packing::new(spec.clone())?.into_world();
        let poses = start.body_ids().filter_map(|body| start.pose(body));
        let bodies = poses
            .map(|pose| {
                let body = rapier::RigidBodyBuilder::dynamic()
                    .pose(to_single(&pose, length))
                    .can_sleep(sleeps);
                world.insert(body, hull.clone()).0
            })
            .collect();
        Ok(Self {
            world,
            bodies,
            length,
            second: length.sqrt(),
            gravity: spec.gravity,
            setting,
            sleeps,
            steps: 0,
        })
    }
}

/// A floor and four walls.
fn add_walls(world: &mut rapier::PhysicsWorld, spec: &PackSpec, length: f64) {
    let [x, y] = spec.container.half_extent().map(|half| half / length);
    let planes = [
        (Vector3::z(), 0.0),
        (Vector3::x(), x),
        (-Vector3::x(), x),
        (Vector3::y(), y),
        (-Vector3::y(), y),
    ];
    for (normal, distance) in planes {
        let wall = rapier::ColliderBuilder::new(rapier::SharedShape::halfspace(single(&normal)))
            .translation(single(&(normal * -distance)))
            .friction(spec.friction as f32)
            .restitution(0.0);
        world.insert_collider(wall, None);
    }
}

fn single(v: &Vector3) -> rapier::Vector {
    rapier::Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

fn to_single(pose: &Pose, length: f64) -> rapier::Pose {
    let q = pose.rotation.coords;
    let rotation = rapier::Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32);
    rapier::Pose::from_parts(single(&(pose.translation.vector / length)), rotation)
}

fn to_double(pose: &rapier::Pose, length: f64) -> Pose {
    let (t, q) = (pose.translation, pose.rotation);
    let translation = Vector3::new(t.x.into(), t.y.into(), t.z.into()) * length;
    let rotation = Quaternion::new(q.w.into(), q.x.into(), q.y.into(), q.z.into());
    Pose::from_parts(translation.into(), UnitQuaternion::new_normalize(rotation))
}

impl Engine for Rapier {
    fn name(&self) -> String {
        let sleep = if self.sleeps { "sleeping" } else { "all awake" };
        let Setting { rate, frequency } = self.setting;
        format!("rapier3d, {sleep}, 1/{rate} s, {frequency} Hz")
    }

    fn advance(&mut self, until: f64) -> Result<()> {
        while self.time() < until {
            self.world.step();
            self.steps += 1;
        }
        Ok(())
    }

    fn time(&self) -> f64 {
        self.steps as f64 / f64::from(self.setting.rate) * self.second
    }

    fn steps(&self) -> u64 {
        self.steps
    }

    fn kinetic_energy(&self) -> f64 {
        let energies = self.bodies.iter().filter_map(|&body| {
            let body = self.world.bodies.get(body)?;
            let scale = f64::from(body.mass()) * self.gravity;
            Some(if body.is_sleeping() {
                0.0
            } else {
                f64::from(body.kinetic_energy()) / scale
            })
        });
        energies.fold(0.0, f64::max)
    }

    fn poses(&self) -> Result<Vec<Pose>> {
        let bodies = self.bodies.iter();
        bodies
            .map(|&body| {
                let body = self
                    .world
                    .bodies
                    .get(body)
                    .context("every body is still there")?;
                Ok(to_double(body.position(), self.length))
            })
            .collect()
    }
}
