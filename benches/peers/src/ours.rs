//! This project's world.

use crate::settle::Engine;
use anyhow::{Context, Result};
use femdem_mesh::Pose;
use femdem_pack::{PackSpec, Packing};
use femdem_solve::{ImplicitStep, World};

/// The world of a packing job, with all bodies at their starts.
pub struct Ours {
    world: World,
    diameter: f64,
    sleeps: bool,
    penalty: f64,
    implicit: Option<f64>,
}

impl Ours {
    /// All bodies at their starts, allowed to sleep or not; with implicit steps of a multiple of the
    /// explicit limit, if there is one.
    pub fn new(spec: &PackSpec, sleeps: bool, implicit: Option<f64>) -> Result<Self> {
        let mut spec = spec.clone();
        spec.time_step.implicit = implicit.map(|multiple| ImplicitStep {
            multiple,
            ..ImplicitStep::default()
        });
        spec.sleeping.enabled = sleeps;
        let penalty = spec.resolved_penalty()?;
        Ok(Self {
            diameter: spec.diameter(),
            world: Packing::new(spec)?.into_world(),
            sleeps,
            penalty,
            implicit,
        })
    }
}

impl Engine for Ours {
    fn name(&self) -> String {
        let sleep = if self.sleeps { "sleeping" } else { "all awake" };
        let steps = self
            .implicit
            .map_or_else(String::new, |multiple| format!(", implicit x{multiple}"));
        format!("femdem, {sleep}, penalty {:.2e} Pa{steps}", self.penalty)
    }

    fn advance(&mut self, until: f64) -> Result<()> {
        while self.world.time() < until {
            self.world.step()?;
        }
        Ok(())
    }

    fn time(&self) -> f64 {
        self.world.time()
    }

    fn steps(&self) -> u64 {
        self.world.steps()
    }

    fn kinetic_energy(&self) -> f64 {
        let g = self.world.parameters().gravity.norm();
        let of = |&body: &u32| {
            let mass = self.world.mass(body)?;
            Some(self.world.body_kinetic_energy(body)? / (mass * g * self.diameter))
        };
        self.world.awake().iter().filter_map(of).fold(0.0, f64::max)
    }

    fn poses(&self) -> Result<Vec<Pose>> {
        let bodies = self.world.body_ids();
        bodies
            .map(|body| self.world.pose(body).context("every body has a pose"))
            .collect()
    }
}
