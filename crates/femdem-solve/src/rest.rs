//! The rule of rest: whether a body, rigid or deformable, rests as a whole.
//!
//! What oscillates has no mean; a lasting imbalance or motion has. So a body is judged by the means of its net force, net moment
//! and velocities over the steps since it last moved, at most a window: see [`SleepParameters`].

use crate::parameters::{SleepMeasure, SleepParameters};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// By its load a body whose load scale is more than this many times its weight is confined: an imbalance presses
/// it against its neighbours but hardly turns it over.
const CONFINED: f64 = 2.0;

/// A confined body sleeps under a larger share, in proportion to its load scale, up to this factor.
const LARGEST_SHARE: f64 = 2.0;

/// A body as the rule sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Whole {
    /// Mass, kg, and largest principal moment of inertia, kg m^2.
    pub mass: f64,
    pub moment_of_inertia: f64,
    /// Bounding diameter, m.
    pub diameter: f64,
    /// N.
    pub weight: f64,
    /// What its net force is compared with.
    pub measure: SleepMeasure,
    /// Number of contacts, of a deformable body 1 if it has any, and the sum of their normal forces, N.
    pub contacts: u32,
    pub borne: f64,
    /// Net force, N, and net moment about the centre, N m, without dashpots: a body that dashpots alone hold is not at rest.
    pub force: Vector3,
    pub moment: Vector3,
    /// m/s and rad/s.
    pub velocity: Vector3,
    pub angular_velocity: Vector3,
    /// Vibrations included, J.
    pub kinetic_energy: f64,
}

impl Whole {
    /// Load scale W, N: the larger of the weight and half the sum of the normal forces.
    pub fn scale(&self) -> f64 {
        self.weight.max(0.5 * self.borne)
    }

    /// What net forces are compared with, N.
    fn compared_with(&self) -> f64 {
        match self.measure {
            SleepMeasure::Weight if self.weight > 0.0 => self.weight,
            SleepMeasure::Weight | SleepMeasure::Load => self.scale(),
        }
    }

    /// Imbalance over its measure at which a frozen body wakes.
    fn wake_share(&self, rule: &SleepParameters) -> f64 {
        let (scale, limit) = (self.scale(), CONFINED * self.weight);
        let factor = match self.measure {
            SleepMeasure::Load if scale > limit => scale / limit,
            SleepMeasure::Load | SleepMeasure::Weight => 1.0,
        };
        rule.wake() * factor.min(LARGEST_SHARE)
    }

    /// Whether the present forces of a frozen body balance well enough for it to stay asleep.
    pub fn holds(&self, rule: &SleepParameters) -> bool {
        let bound = self.wake_share(rule) * self.compared_with();
        self.force.norm() < bound && self.moment.norm() < bound * self.diameter
    }
}

/// What is known of the rest of a body: running means, and for how long they have been those of rest.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct RestRecord {
    /// Mean net force, N, and net moment, N m.
    force: Vector3,
    moment: Vector3,
    /// Mean velocity, m/s, and angular velocity, rad/s.
    velocity: Vector3,
    angular_velocity: Vector3,
    /// Steps that the means are taken over, at most the window.
    samples: u32,
    /// Contacts when the body was last looked at.
    contacts: u32,
    /// Steps at rest in a row.
    pub quiet_steps: u32,
}

impl RestRecord {
    /// Takes a step of an awake body into account. It counts as one at rest only if it `may`.
    pub fn count(&mut self, whole: &Whole, rule: &SleepParameters, may: bool) {
        let energy_scale = whole.scale() * whole.diameter;
        let rings = whole.kinetic_energy >= rule.ringing() * energy_scale;
        // The means restart with every motion: the forces before the body came to rest say nothing about its balance.
        let before = if rings { 0 } else { self.samples };
        self.samples = rule.window.min(before.saturating_add(1)).max(1);
        self.mix(whole, 1.0 / f64::from(self.samples));
        let creep = 0.5
            * (whole.mass * self.velocity.norm_squared()
                + whole.moment_of_inertia * self.angular_velocity.norm_squared());
        let quiet = may
            && !rings
            && self.samples >= rule.window
            && creep < rule.creep() * energy_scale
            && self.is_balanced(whole, rule.tolerance);
        self.contacts = whole.contacts;
        self.quiet_steps = if quiet {
            self.quiet_steps.saturating_add(1)
        } else {
            0
        };
    }

    /// Takes a re-examination of a frozen body into account. Whether it has lost its balance: in the mean, or at once where it has
    /// lost a contact.
    pub fn has_lost_balance(&mut self, whole: &Whole, rule: &SleepParameters) -> bool {
        self.mix(whole, f64::from(rule.recheck()) / f64::from(rule.window));
        let lost = whole.contacts < self.contacts;
        self.contacts = whole.contacts;
        (lost && !whole.holds(rule)) || !self.is_balanced(whole, whole.wake_share(rule))
    }

    /// Awake again. The means of force and moment are kept. Restarted from zero they would let the body sleep again
    /// before it has moved; restarted at an impact they would keep it awake for long.
    pub fn wake(&mut self) {
        self.quiet_steps = 0;
        self.velocity = Vector3::zeros();
        self.angular_velocity = Vector3::zeros();
    }

    /// Whether this was the first step without motion.
    pub fn is_first_calm(&self) -> bool {
        self.samples == 2
    }

    /// Whether it has been at rest for long enough to be frozen.
    pub fn has_rested(&self, rule: &SleepParameters) -> bool {
        self.quiet_steps >= rule.steps()
    }

    /// Whether the mean force, and the mean moment over the diameter, are below a share of the measure.
    fn is_balanced(&self, whole: &Whole, share: f64) -> bool {
        let bound = share * whole.compared_with();
        whole.contacts > 0
            && self.force.norm() < bound
            && self.moment.norm() < bound * whole.diameter
    }

    /// Mixes the present state into the means with a weight.
    fn mix(&mut self, whole: &Whole, share: f64) {
        self.force += (whole.force - self.force) * share;
        self.moment += (whole.moment - self.moment) * share;
        self.velocity += (whole.velocity - self.velocity) * share;
        self.angular_velocity += (whole.angular_velocity - self.angular_velocity) * share;
    }
}
