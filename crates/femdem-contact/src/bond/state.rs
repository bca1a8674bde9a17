//! A bond and what it carries.

use super::part::{BondFacet, Part, Sums, View};
use super::{BondLaw, BondSection};
use crate::contact::{BodyId, Wrench};
use crate::error::ContactError;
use crate::generalized::Generalized;
use crate::glue::GlueLoss;
use crate::motion::Motion;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Opening or slip of a point, over the square root of the area, at which a broken bond ends under pressure elsewhere: its faces
/// no longer lie on each other.
const SLIP: f64 = 0.1;

/// What a bond carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BondState {
    /// Centroid of the section midway between its sides, m.
    pub centre: Vector3,
    /// Mean normal, from A to B.
    pub normal: Vector3,
    /// Force with which B pulls A, without dashpots, N: along `normal` in tension.
    pub force: Vector3,
    /// Moment of B on A about `centre`, without dashpots, N m: twisting along `normal`, bending across.
    pub moment: Vector3,
    /// Largest normal traction of its points, Pa; tension is positive.
    pub tension: f64,
    /// Stored energy, J.
    pub energy: f64,
}

/// Loads on a body about its origin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Side {
    /// Of the springs.
    pub elastic: Wrench,
    /// Of the dashpot.
    pub damping: Wrench,
    /// Stiffness if the other body rests.
    pub stiffness: Generalized,
    /// Factor with which both bodies may move ([`Resistance`](crate::Resistance)).
    pub share: f64,
}

/// A bond between two bodies. See the [module](super).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bond {
    bodies: [BodyId; 2],
    pub(super) law: BondLaw,
    pub(super) parts: Vec<Part>,
    pub(super) area: f64,
    pub(super) state: BondState,
    pub(crate) sides: [Side; 2],
    /// Viscosity over stiffness, s.
    pub(crate) delay: f64,
    pub(super) lost: GlueLoss,
    /// Area that has given way, m², and the part of sliding in it.
    pub(super) yielded: f64,
    pub(super) slid: f64,
    pub(super) broken_at: Option<f64>,
    pub(crate) ended: bool,
}

impl Bond {
    /// Bonds two bodies as they lie, without force; `motions` are those of A and B.
    ///
    /// # Errors
    /// As [`BondLaw::check`].
    pub fn new(
        bodies: [BodyId; 2],
        section: &BondSection,
        law: BondLaw,
        motions: [&Motion; 2],
    ) -> Result<Self, ContactError> {
        law.check()?;
        let local = |motion: &Motion, x: &Vector3| {
            motion.frame.rotation.tr_mul(&(x - motion.frame.position))
        };
        let parts = section.triangles().map(|(points, area)| {
            let at = motions.map(|motion| points.map(|x| local(motion, &x)));
            Part::new(at, area)
        });
        let mut bond = Self {
            bodies,
            law,
            parts: parts.collect::<Result<_, ContactError>>()?,
            area: section.area(),
            state: BondState {
                centre: section.centre(),
                normal: section.normal(),
                ..BondState::default()
            },
            sides: Default::default(),
            delay: 0.0,
            lost: GlueLoss::default(),
            yielded: 0.0,
            slid: 0.0,
            broken_at: None,
            ended: false,
        };
        bond.update(motions);
        Ok(bond)
    }

    /// The bodies A and B.
    #[must_use]
    pub fn bodies(&self) -> [BodyId; 2] {
        self.bodies
    }

    /// Gives its bodies other numbers. `None` if one of them has none.
    pub(crate) fn renumbered(mut self, number: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        let [a, b] = self.bodies;
        self.bodies = [number(a)?, number(b)?];
        Some(self)
    }

    /// Its law.
    #[must_use]
    pub fn law(&self) -> &BondLaw {
        &self.law
    }

    /// Area of the section, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// What it carries, as of the last update.
    #[must_use]
    pub fn state(&self) -> &BondState {
        &self.state
    }

    /// Mean over the area of the part of the stiffness that is lost: 0 for a whole bond, 1 for a broken one.
    #[must_use]
    pub fn damage(&self) -> f64 {
        let glue = self.law.glue();
        let of = |part: &Part| part.facet.damage(&glue).iter().sum::<f64>() * part.facet.area();
        (self.parts.iter().map(of).sum::<f64>() / (3.0 * self.area)).min(1.0)
    }

    /// The part of sliding in the traction under which its points gave way, squared: 0 by opening, 1 by sliding; 0 while all are
    /// whole.
    #[must_use]
    pub fn mode(&self) -> f64 {
        if self.yielded > 0.0 {
            self.slid / self.yielded
        } else {
            0.0
        }
    }

    /// Whether a point has given way.
    #[must_use]
    pub fn has_yielded(&self) -> bool {
        self.yielded > 0.0
    }

    /// Whether nothing holds any more.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        self.ended || {
            let glue = self.law.glue();
            self.parts.iter().all(|part| part.facet.is_broken(&glue))
        }
    }

    /// When it was found broken, s.
    #[must_use]
    pub fn broken_at(&self) -> Option<f64> {
        self.broken_at
    }

    /// Whether the two bodies meet by the kernel again: it carries nothing any more.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// What it has dissipated so far; dashpots do not count.
    #[must_use]
    pub fn lost(&self) -> GlueLoss {
        self.lost
    }

    /// Its triangles now; `motions` are those of A and B.
    #[must_use]
    pub fn facets(&self, motions: [&Motion; 2]) -> Vec<BondFacet> {
        let glue = self.law.glue();
        let facet = |part: &Part| part.seen(&glue, motions);
        self.parts.iter().map(facet).collect()
    }

    /// Takes what these motions of A and B change for good, and evaluates the bond there. Returns what that dissipates.
    pub fn update(&mut self, motions: [&Motion; 2]) -> GlueLoss {
        self.evaluate(motions, true)
    }

    /// [`update`](Self::update), which changes nothing for good unless it `takes`.
    pub(crate) fn evaluate(&mut self, motions: [&Motion; 2], takes: bool) -> GlueLoss {
        let mut lost = GlueLoss::default();
        if self.ended {
            return lost;
        }
        let light = motions[0].inverse_mass + motions[1].inverse_mass;
        self.delay = if light > 0.0 {
            2.0 * self.law.damping / (self.law.stiffness * self.area * light).sqrt()
        } else {
            0.0
        };
        let view = View::new(&self.law, motions, self.delay);
        let mut sums = Sums::default();
        for part in &mut self.parts {
            if takes {
                let change = part.take(&view);
                self.yielded += change.yielded;
                self.slid += change.slid;
                let before = part.last;
                part.evaluate(&view, &mut sums);
                if change.is_any {
                    lost.friction += change.friction;
                    lost.glue += part.last.work_since(&before) - change.friction;
                }
            } else {
                part.evaluate(&view, &mut sums);
            }
        }
        self.lost.glue += lost.glue;
        self.lost.friction += lost.friction;
        self.keep(&view, &sums);
        lost
    }

    /// Keeps what was found.
    fn keep(&mut self, view: &View, sums: &Sums) {
        let centre = sums.middle / sums.points.max(1.0);
        let inverse_mass = |k: usize| view.motions[k].inverse_mass_at(&(centre - view.origins[k]));
        let masses = [0, 1].map(inverse_mass);
        self.sides = [0, 1].map(|k| Side {
            elastic: sums.elastic[k],
            damping: sums.damping[k],
            stiffness: sums.stiffness[k],
            share: if masses[k] > 0.0 {
                1.0 + (masses[1 - k] / masses[k]).sqrt()
            } else {
                1.0
            },
        });
        let on_a = &sums.elastic[0];
        self.state = BondState {
            centre: centre + view.motions[0].frame.position,
            normal: sums.normal.try_normalize(0.0).unwrap_or(self.state.normal),
            force: on_a.force,
            moment: on_a.torque - centre.cross(&on_a.force),
            tension: sums.tension,
            energy: sums.energy,
        };
    }

    /// The step in which its points open or slide by the part `share` of the smaller of G_I/f_t and G_II/c, s.
    pub(crate) fn resolving_step(&self, motions: [&Motion; 2], share: f64) -> f64 {
        let arm = |k: usize| self.state.centre - motions[k].frame.position;
        let apart = motions[1].velocity_at(&arm(1)) - motions[0].velocity_at(&arm(0));
        let turning = motions[1].angular_velocity - motions[0].angular_velocity;
        let speed = apart.norm() + turning.norm() * self.area.sqrt();
        let [opening, sliding] = self.law.energies;
        let shortest = (opening / self.law.tensile).min(sliding / self.law.cohesion);
        share * shortest / speed
    }

    /// Notes the time (s) when it is found broken. Returns whether it can end: it carries nothing, or a point has
    /// opened or slid too far.
    pub(crate) fn may_end(&mut self, time: f64, motions: [&Motion; 2]) -> bool {
        if self.ended || !self.is_broken() {
            return false;
        }
        self.broken_at = self.broken_at.or(Some(time));
        let most = SLIP * self.area.sqrt();
        self.state.energy == 0.0 || self.parts.iter().any(|part| part.is_apart(motions, most))
    }

    /// Ends it, and returns what it held, J.
    pub(crate) fn end(&mut self) -> f64 {
        self.ended = true;
        self.sides = Default::default();
        let held = std::mem::take(&mut self.state.energy);
        self.state.force = Vector3::zeros();
        self.state.moment = Vector3::zeros();
        self.state.tension = 0.0;
        held
    }
}
