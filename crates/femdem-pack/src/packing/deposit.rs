//! Depositing: when the next bodies are released, and where.

use super::ranks::is_on_all;
use super::{Packing, Stage};
use crate::error::PackError;
use crate::placement::{self, Start};
use crate::protocol::{Pour, Protocol, Sequential};
use femdem_solve::{BodySpec, Halo};

/// A batch has landed when its bodies have been at rest for this long, in units of sqrt(d/g); the
/// turning point of an impact is shorter.
const REST: f64 = 0.1;

/// Default height of a pour above the expected top of the pack, in d.
const POUR_HEAD: f64 = 1.0;

impl Packing {
    pub(super) fn step_deposition(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        self.world.step_on(halo)?;
        if self.job.relaxing.is_some() {
            return self.step_relaxation(halo);
        }
        if self.world.time() >= self.job.next_check {
            self.guard()?;
            self.wait_for_next_check();
        }
        self.release_if_due(halo)
    }

    /// Releases the next bodies if they are due, or begins settling if none are left.
    pub(super) fn release_if_due(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        let first = self.placed();
        let due = match self.job.spec.protocol {
            Protocol::Sequential(s) => self.may_follow(&s, halo)?,
            Protocol::Pour(p) => self.world.time() >= self.next_layer(&p),
            Protocol::Release(_) => true,
        };
        if !due {
            return Ok(());
        }
        if matches!(self.job.spec.protocol, Protocol::Sequential(_)) && self.is_relaxation_due() {
            self.begin_relaxation(halo)?;
            return Ok(());
        }
        self.update_top(halo)?;
        if first >= self.job.spec.count {
            self.enter(Stage::Settling);
            return Ok(());
        }
        let starts = match self.job.spec.protocol {
            Protocol::Release(release) => placement::lattice(&self.job.spec, &release)?,
            protocol => {
                let diameter = self.job.spec.largest_diameter();
                let most = protocol.batch(&self.job.spec.container, diameter, self.job.spec.count);
                let clear = self.job.top + protocol.clearance() * diameter;
                placement::batch(&self.job.spec, first, most, clear.max(self.pour_height()))?
            }
        };
        self.job.batches.push(first);
        self.job.released = self.world.time();
        self.job.landed_since = None;
        self.add(&starts)
    }

    fn add(&mut self, starts: &[Start]) -> Result<(), PackError> {
        for start in starts {
            let spec = &self.job.spec;
            let shape = &spec.shapes[start.shape as usize];
            let body = BodySpec {
                material: shape.material,
                ..BodySpec::at_rest(start.shape, spec.density_of(shape), start.pose)
            };
            self.world.add_body(body)?;
            let high = start.centroid.z + start.radius;
            self.job.highest_start = self.job.highest_start.max(high);
        }
        self.job.top = self.job.highest_start;
        Ok(())
    }

    /// Height of a pour, m; 0 for other protocols.
    fn pour_height(&self) -> f64 {
        match self.job.spec.protocol {
            Protocol::Pour(Pour { height, .. }) => height.unwrap_or_else(|| {
                self.job.spec.expected_height() + POUR_HEAD * self.job.spec.largest_diameter()
            }),
            _ => 0.0,
        }
    }

    /// When the next layer of a pour is due, s: the bodies of the last one at the given rate.
    fn next_layer(&self, pour: &Pour) -> f64 {
        match self.job.batches.last() {
            Some(&first) => self.job.released + f64::from(self.placed() - first) / pour.rate,
            None => 0.0,
        }
    }

    /// Whether the next batch may be released: the last one has landed, or its time is over.
    fn may_follow(
        &mut self,
        sequential: &Sequential,
        halo: &mut dyn Halo,
    ) -> Result<bool, PackError> {
        let now = self.world.time();
        let unit = self.job.spec.time_unit();
        let rests = self.is_batch_at_rest(sequential.landing.kinetic_energy);
        if !is_on_all(rests, halo)? {
            self.job.landed_since = None;
            let longest = self.fall_time() + sequential.landing.longest_wait * unit;
            let over = now - self.job.released > longest;
            self.job.cut_short += u32::from(over);
            return Ok(over);
        }
        let since = *self.job.landed_since.get_or_insert(now);
        Ok(self.job.batches.is_empty() || now - since >= REST * unit)
    }

    /// Time of free fall from the highest start to the floor, s.
    pub(super) fn fall_time(&self) -> f64 {
        (2.0 * self.job.highest_start / self.job.spec.gravity).sqrt()
    }

    /// Whether every body of the last batch that is here touches something and has a kinetic energy below
    /// `limit` m g d, or sleeps.
    fn is_batch_at_rest(&self, limit: f64) -> bool {
        let first = self.job.batches.last().copied().unwrap_or(0);
        let limit = limit * self.job.spec.gravity * self.job.spec.diameter();
        self.world.own_bodies(first).all(|body| {
            let energy = self.world.body_kinetic_energy(body);
            let moving = energy.zip(self.world.mass(body));
            let rests = moving.is_some_and(|(energy, mass)| energy < limit * mass);
            self.world.is_asleep(body) || (rests && !self.world.contacts_of(body).is_empty())
        })
    }
}
