//! Parameters of a world, with defaults and validation.

use crate::error::{SolveError, check};
use femdem_contact::{ContactLaw, ContactLaws, ContactParameters};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Everything a world needs to know besides its bodies and walls.
///
/// ```
/// use femdem_solve::{ImplicitStep, World, WorldParameters};
///
/// let mut parameters = WorldParameters::default();
/// parameters.contact.penalty = 1e7;
/// parameters.contact.friction = 0.4;
/// parameters.time_step.safety = 0.5;
/// World::new(parameters)?;
/// // Implicit steps have no rolling friction, and say so.
/// parameters.time_step.implicit = Some(ImplicitStep::default());
/// parameters.contact.rolling_friction = 0.1;
/// assert!(World::new(parameters).is_err_and(|error| error.to_string().contains("rolling_friction")));
/// # Ok::<(), femdem_solve::SolveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WorldParameters {
    /// Acceleration of gravity, m/s^2.
    pub gravity: Vector3,
    /// The contact law of all pairs of materials without [one of their own](crate::World::set_law).
    pub contact: ContactParameters,
    /// Step size control.
    pub time_step: TimeStepParameters,
    /// The active set: when bodies fall asleep and wake.
    pub sleeping: SleepParameters,
    /// Damping that acts on all motion.
    pub medium: Medium,
}

impl Default for WorldParameters {
    fn default() -> Self {
        Self {
            gravity: Vector3::new(0.0, 0.0, -9.81),
            contact: ContactParameters::default(),
            time_step: TimeStepParameters::default(),
            sleeping: SleepParameters::default(),
            medium: Medium::default(),
        }
    }
}

/// How the step is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TimeStepParameters {
    /// Fraction of the stability bound that is used, from 1e-6 to 1.
    pub safety: f64,
    /// An upper limit of the step, s.
    pub largest: Option<f64>,
    /// Steps linearly implicitly, with a larger step; explicitly if `None`, which is the default.
    pub implicit: Option<ImplicitStep>,
}

/// How a linearly implicit step is chosen and solved.
///
/// Contacts that exist are evaluated where the bodies are, the others and those that become much harder where the bodies
/// would be after the step with their present velocities; the velocities at its end are those under forces that change
/// linearly from there: one Newton step of the backward Euler method. The step can be many times the
/// explicit one; in turn it takes energy from all motion that it does not resolve: impacts and
/// vibrations shorter than a few steps. Small steps give the motion of explicit ones: the law of the contacts is the
/// same. Large ones are meant for bringing bodies to rest, not for impacts, waves or vibrations. No body moves by more than
/// 3 % of its bounding diameter in a step; a smaller one is taken then.
/// The elastic energy of the [`Ledger`](crate::Ledger) is that of the contacts where they were evaluated, so that its error tells
/// something once the bodies are at rest.
/// For rigid bodies without [local damping](Medium::local_damping) and rolling friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImplicitStep {
    /// The step over the explicit limit of one contact over a full face of the smallest body.
    pub multiple: f64,
    /// Longest step over sqrt(d/g), the time in which a body falls by half its diameter d. Twice the default will do
    /// where nothing falls.
    pub fall: f64,
}

impl Default for ImplicitStep {
    fn default() -> Self {
        Self {
            multiple: 9.0,
            fall: 0.01,
        }
    }
}

impl ImplicitStep {
    fn validate(&self) -> Result<(), SolveError> {
        check(
            "time_step.implicit.multiple",
            self.multiple,
            self.multiple > 0.0,
            "positive and finite; 9 is usual",
        )?;
        check(
            "time_step.implicit.fall",
            self.fall,
            self.fall > 0.0 && self.fall <= 0.02,
            "above 0 and at most 0.02: longer steps have not been tried",
        )
    }
}

impl Default for TimeStepParameters {
    fn default() -> Self {
        Self {
            safety: 0.9,
            largest: None,
            implicit: None,
        }
    }
}

/// When a body is frozen, and when it is looked at again.
///
/// A body is judged by means over the last `window` steps at rest, because every impact rings
/// through the whole pack: what oscillates has no mean, a lasting imbalance or motion has. The means
/// begin anew while it moves.
/// Its load scale W is the larger of its weight and half the sum of its normal forces; its
/// [`measure`](Self::measure) of balance is one or the other.
///
/// One number says how strict the rule is, the `tolerance` τ of the mean net force. A body that is out of balance by τ W
/// for a time t has the kinetic energy τ²/2 (g t²/d) W d. From this follow the limits of its motion: its mean motion may have
/// what it would gain in 0.08 sqrt(d/g) ([`creep`](Self::creep)), and a body that has more than it would gain in
/// 0.5 sqrt(d/g) moves ([`ringing`](Self::ringing)).
///
/// Nothing sleeps while a wall, a body or nodes move as prescribed, nor from then on until all awake rigid
/// bodies are at rest together.
///
/// ```
/// use femdem_solve::SleepParameters;
///
/// let usual = SleepParameters::default();
/// assert!((usual.wake() - 0.25).abs() < 1e-12 && (usual.ringing() - 1e-4).abs() < 1e-12);
/// // Strict enough for bodies whose kinetic energy is at most 1e-6 W d.
/// let strict = usual.for_ringing(1e-6);
/// assert!((strict.tolerance - 0.003).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SleepParameters {
    /// Whether bodies may sleep at all.
    pub enabled: bool,
    /// Whether deformable bodies may sleep too; off by default. Only bodies without prescribed nodes or loads
    /// sleep. A body is a candidate once it has rested for 1.3 windows. It is then stopped at each
    /// maximum of its kinetic energy. It stays frozen if (1) the sum of |residual| over its nodes is below
    /// `tolerance` times the sum of |external force| on them, and (2) the net force and moment are below
    /// `tolerance` of its load scale. It wakes when one of these exceeds 2 `tolerance`. It does not follow
    /// smaller changes of its loads, nor do its stresses. Rigid bodies that touch a deformable one sleep only
    /// if it does.
    pub deformables: bool,
    /// What net forces of rigid bodies are compared with; those of deformable ones are with their load scale.
    pub measure: SleepMeasure,
    /// Mean net force, and mean net moment over d, below this fraction of the measure count as balanced.
    pub tolerance: f64,
    /// Steps of the means, 10 or more. A body must be at rest for 0.3 of it once its means are complete; sleeping
    /// bodies beside awake ones are re-examined every tenth of it.
    pub window: u32,
}

impl SleepParameters {
    /// A frozen body wakes when its mean net force, or mean net moment over d, exceeds this fraction of the
    /// measure, 25/3 of the tolerance; by load up to twice as much where W is two to four weights or more, since a confined
    /// body does not turn over. Loads below it are not passed on: a pack that grew while it slept is compressed too little
    /// until all its bodies have been awake together.
    #[must_use]
    pub fn wake(&self) -> f64 {
        self.tolerance * 25.0 / 3.0
    }

    /// Kinetic energy of the mean motion over W d that counts as rest, τ²/300.
    #[must_use]
    pub fn creep(&self) -> f64 {
        self.tolerance * self.tolerance / 300.0
    }

    /// Kinetic energy over W d above which a body moves, τ²/9; with a smaller one it at most rings.
    #[must_use]
    pub fn ringing(&self) -> f64 {
        self.tolerance * self.tolerance / 9.0
    }

    /// The same rule, made strict enough for bodies with at most this kinetic energy over W d, if it is not already.
    #[must_use]
    pub fn for_ringing(self, limit: f64) -> Self {
        let tolerance = (9.0 * limit).sqrt().max(LEAST_TOLERANCE);
        Self {
            tolerance: self.tolerance.min(tolerance),
            ..self
        }
    }

    /// Steps at rest, with complete means, before a body is frozen.
    pub(crate) fn steps(&self) -> u32 {
        (f64::from(self.window) * 0.3) as u32
    }

    /// Sleeping bodies beside awake ones are re-examined every so many steps.
    pub(crate) fn recheck(&self) -> u32 {
        (self.window / 10).max(1)
    }
}

/// A stricter rule freezes nothing: net forces are this accurate.
const LEAST_TOLERANCE: f64 = 1e-12;

/// What the net force of a frozen body is compared with. It is missing from the forces on the walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SleepMeasure {
    /// Its weight, or its load scale where nothing weighs: sums of forces are right to the fractions of the
    /// rule. Under many weights bodies sleep seldom.
    #[default]
    Weight,
    /// Its load scale, for work whose results are taken with all bodies awake: a growing pack sleeps through what
    /// it grows by.
    Load,
}

impl Default for SleepParameters {
    fn default() -> Self {
        Self {
            enabled: true,
            deformables: false,
            measure: SleepMeasure::default(),
            tolerance: 0.03,
            window: 100,
        }
    }
}

/// Damping by what surrounds the bodies; off by default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Medium {
    /// Drag rate a, 1/s: force -a m v and moment -a I omega, integrated exactly.
    pub drag: f64,
    /// Cundall's local damping: each component of the net force is reduced by this
    /// fraction of its size, against the motion.
    pub local_damping: f64,
}

impl WorldParameters {
    /// The laws of a world with these parameters and the laws of pairs of `others`.
    pub(crate) fn laws(&self, others: &ContactLaws) -> Result<ContactLaws, SolveError> {
        let laws = others.clone().with_usual(self.validate()?);
        let rolls = |law: &&ContactParameters| law.rolling_friction != 0.0;
        if let Some(law) = laws.all().find(rolls)
            && self.time_step.implicit.is_some()
        {
            check(
                "rolling_friction with time_step.implicit",
                law.rolling_friction,
                false,
                "0: implicit steps have no rolling friction; step explicitly",
            )?;
        }
        if let Some(law) = laws.all().find(|law| law.attracts())
            && self.time_step.implicit.is_some()
        {
            check(
                "cohesion, adhesion or liquid bridge with time_step.implicit",
                law.cohesion.max(law.work_of_adhesion()),
                false,
                "0: implicit steps have no attraction; step explicitly",
            )?;
        }
        Ok(laws)
    }

    pub(crate) fn validate(&self) -> Result<ContactLaw, SolveError> {
        let law = ContactLaw::new(self.contact)?;
        let g = self.gravity.norm();
        check("gravity", g, true, "finite in every component, in m/s^2")?;
        let t = &self.time_step;
        check(
            "time_step.safety",
            t.safety,
            (1e-6..=1.0).contains(&t.safety),
            "from 1e-6 to 1",
        )?;
        if let Some(largest) = t.largest {
            check(
                "time_step.largest",
                largest,
                largest > 0.0,
                "positive and finite, in s",
            )?;
        }
        if let Some(implicit) = &t.implicit {
            implicit.validate()?;
            check(
                "medium.local_damping with time_step.implicit",
                self.medium.local_damping,
                self.medium.local_damping == 0.0,
                "0: local damping is not a function that an implicit step can follow",
            )?;
        }
        let s = &self.sleeping;
        check(
            "sleeping.tolerance",
            s.tolerance,
            (LEAST_TOLERANCE..=0.06).contains(&s.tolerance),
            "1e-12 to 0.06: a laxer rule freezes bodies that are not at rest",
        )?;
        check(
            "sleeping.window",
            f64::from(s.window),
            s.window >= 10,
            "at least 10",
        )?;
        check(
            "medium.drag",
            self.medium.drag,
            self.medium.drag >= 0.0,
            "at least 0 and finite, in 1/s",
        )?;
        check(
            "medium.local_damping",
            self.medium.local_damping,
            (0.0..1.0).contains(&self.medium.local_damping),
            "at least 0 and below 1",
        )?;
        Ok(law)
    }
}
