//! A bond and what it carries.

use super::{BondLaw, BondSection};
use crate::contact::{BodyId, Wrench};
use crate::error::ContactError;
use crate::generalized::Generalized;
use crate::glue::{GlueLaw, GlueLoss, GluedFacet, MidSurface, Openings};
use crate::motion::Motion;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Slip over the square root of the area at which a broken bond ends under pressure: its faces no longer lie on each other.
const SLIP: f64 = 0.1;

/// A triangle of the section, by the middles of its edges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Part {
    facet: GluedFacet,
    /// The points in the axes of A and of B, m.
    at: [[Vector3; 3]; 2],
    last: Last,
}

/// A triangle in the last update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Last {
    /// m.
    openings: Openings,
    /// N.
    slopes: Openings,
    /// Of springs, J.
    energy: f64,
}

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
    law: BondLaw,
    parts: Vec<Part>,
    area: f64,
    state: BondState,
    pub(crate) sides: [Side; 2],
    /// Viscosity over stiffness, s.
    pub(crate) delay: f64,
    lost: GlueLoss,
    /// Area that has given way, m², and the part of sliding in it.
    yielded: f64,
    slid: f64,
    broken_at: Option<f64>,
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
            Ok(Part {
                facet: GluedFacet::new(area)?,
                at: motions.map(|motion| points.map(|x| local(motion, &x))),
                last: Last::default(),
            })
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

    /// Its triangles now: their corners midway between the sides, m, mean opening and slip, m, mean damage, and area, m²; `motions` are those of A
    /// and B.
    #[must_use]
    pub fn facets(&self, motions: [&Motion; 2]) -> Vec<([Vector3; 3], [f64; 2], f64, f64)> {
        let glue = self.law.glue();
        let mean = |of: [f64; 3]| of.iter().sum::<f64>() / 3.0;
        let facet = |part: &Part| {
            let openings = part.last.openings;
            let slip = mean(openings.map(|o| o[1].hypot(o[2])));
            let middle = |q: usize| {
                let side = |k: usize| motions[k].frame.point(&part.at[k][q]);
                (side(0) + side(1)) * 0.5
            };
            let [p, q, r] = [0, 1, 2].map(middle);
            // The corners of a triangle from the middles of its edges.
            (
                [p + r - q, p + q - r, q + r - p],
                [mean(openings.map(|o| o[0])), slip],
                mean(part.facet.damage(&glue)),
                part.facet.area(),
            )
        };
        self.parts.iter().map(facet).collect()
    }

    /// Takes what these motions of A and B change for good, and evaluates the bond there. Returns what that dissipates.
    pub fn update(&mut self, motions: [&Motion; 2]) -> GlueLoss {
        let mut lost = GlueLoss::default();
        if self.ended {
            return lost;
        }
        let law = self.law.glue();
        let frames = motions.map(|motion| &motion.frame);
        // Relative to A, so that no digits are lost far from the origin.
        let apart = frames[1].position - frames[0].position;
        let origins = [Vector3::zeros(), apart];
        let mut found = Found::default();
        let mut points = Vec::with_capacity(3 * self.parts.len());
        for part in &mut self.parts {
            let a = part.at[0].map(|x| frames[0].rotation * x);
            let b = part.at[1].map(|x| frames[1].rotation * x + apart);
            let Some(middle) = MidSurface::new(&a, &b) else {
                continue;
            };
            let openings = middle.openings(&a, &b);
            let mut changed = false;
            for (q, opening) in openings.iter().enumerate() {
                let strengths = self.law.strengths();
                if let Some(sliding) = part.facet.give_way(q, &law, strengths, opening) {
                    let area = part.facet.area() / 3.0;
                    changed = true;
                    self.yielded += area;
                    self.slid += area * sliding;
                }
            }
            let more = part.facet.follow(&law, &openings);
            changed |= more != GlueLoss::default();
            let before = part.last;
            let stiffness = part.evaluate(&law, &middle, [&a, &b], &openings, &origins, &mut found);
            if changed {
                lost.friction += more.friction;
                lost.glue += part.last.work_since(&before) - more.friction;
            }
            for (q, stiffness) in stiffness.into_iter().enumerate() {
                points.push(((a[q] + b[q]) * 0.5, stiffness));
            }
            found.normal += middle.axes[0] * part.facet.area();
        }
        self.lost.glue += lost.glue;
        self.lost.friction += lost.friction;
        self.take(motions, &origins, &points, &found);
        lost
    }

    /// Keeps what was found: points midway with their stiffnesses (N/m), relative to A.
    fn take(
        &mut self,
        motions: [&Motion; 2],
        origins: &[Vector3; 2],
        points: &[(Vector3, f64)],
        found: &Found,
    ) {
        let count = points.len().max(1) as f64;
        let centre = points.iter().map(|(x, _)| x).sum::<Vector3>() / count;
        let masses = [0, 1].map(|k| motions[k].inverse_mass_at(&(centre - origins[k])));
        let light = motions[0].inverse_mass + motions[1].inverse_mass;
        self.delay = if light > 0.0 {
            2.0 * self.law.damping / (self.law.stiffness * self.area * light).sqrt()
        } else {
            0.0
        };
        let mut sides = [Side::default(); 2];
        for (k, side) in sides.iter_mut().enumerate() {
            side.elastic = found.elastic[k];
            side.share = if masses[k] > 0.0 {
                1.0 + (masses[1 - k] / masses[k]).sqrt()
            } else {
                1.0
            };
            for (x, stiffness) in points {
                side.stiffness.add_everywhere(&(x - origins[k]), *stiffness);
            }
        }
        if self.delay > 0.0 {
            for (x, stiffness) in points {
                let velocity = |k: usize| motions[k].velocity_at(&(x - origins[k]));
                let force = (velocity(1) - velocity(0)) * (self.delay * stiffness);
                for (k, force) in [force, -force].into_iter().enumerate() {
                    sides[k].damping.force += force;
                    sides[k].damping.torque += (x - origins[k]).cross(&force);
                }
            }
        }
        self.sides = sides;
        let on_a = &found.elastic[0];
        self.state = BondState {
            centre: centre + motions[0].frame.position,
            normal: found.normal.try_normalize(0.0).unwrap_or(self.state.normal),
            force: on_a.force,
            moment: on_a.torque - centre.cross(&on_a.force),
            tension: found.tension,
            energy: found.energy,
        };
    }

    /// The step in which its points open by the part `share` of G_I/f_t, s.
    pub(crate) fn resolving_step(&self, motions: [&Motion; 2], share: f64) -> f64 {
        let arm = |k: usize| self.state.centre - motions[k].frame.position;
        let apart = motions[1].velocity_at(&arm(1)) - motions[0].velocity_at(&arm(0));
        let turning = motions[1].angular_velocity - motions[0].angular_velocity;
        let speed = apart.norm() + turning.norm() * self.area.sqrt();
        share * self.law.energies[0] / self.law.tensile / speed
    }

    /// Whether a bond that was read has finite numbers and a law that is allowed.
    pub(crate) fn is_sound(&self) -> bool {
        let points = self.parts.iter().flat_map(|part| part.at.iter().flatten());
        let areas: f64 = self.parts.iter().map(|part| part.facet.area()).sum();
        self.law.check().is_ok()
            && (areas / self.area - 1.0).abs() < 1e-9
            && points.into_iter().all(|x| x.iter().all(|x| x.is_finite()))
    }

    /// Notes the time (s) when it is found broken. Returns whether it can end: it carries nothing, or has slid too far.
    pub(crate) fn may_end(&mut self, time: f64, motions: [&Motion; 2]) -> bool {
        if self.ended || !self.is_broken() {
            return false;
        }
        self.broken_at = self.broken_at.or(Some(time));
        let most = SLIP * self.area.sqrt();
        self.state.energy == 0.0
            || self.parts.iter().any(|part| {
                let [a, b] = [0, 1].map(|k| part.at[k].map(|x| motions[k].frame.point(&x)));
                part.facet.largest_slip(&a, &b) > most
            })
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

impl Last {
    /// The work of the mean forces since an earlier update, less what the springs store more, J: what a leapfrog step takes from the motion.
    fn work_since(&self, before: &Self) -> f64 {
        let mut work = before.energy - self.energy;
        for q in 0..3 {
            for i in 0..3 {
                let mean = 0.5 * (before.slopes[q][i] + self.slopes[q][i]);
                work += mean * (self.openings[q][i] - before.openings[q][i]);
            }
        }
        work
    }
}

/// Sums over the parts, relative to A.
#[derive(Default)]
struct Found {
    elastic: [Wrench; 2],
    normal: Vector3,
    tension: f64,
    energy: f64,
}

impl Part {
    /// Adds the forces at points of both sides, m, about the origins of the bodies, and returns the stiffness at each, N/m.
    fn evaluate(
        &mut self,
        law: &GlueLaw,
        middle: &MidSurface,
        [a, b]: [&[Vector3; 3]; 2],
        openings: &Openings,
        origins: &[Vector3; 2],
        found: &mut Found,
    ) -> [f64; 3] {
        let whole = self.facet.area() / 3.0 * law.stiffness;
        let (mut slopes, glue, contact) = self.facet.slopes(law, openings);
        let mut energy = glue + contact;
        let mut stiffness = self.facet.stiffness_at(law, openings);
        for q in 0..3 {
            if !self.facet.is_joined(q) {
                for (slope, opening) in slopes[q].iter_mut().zip(openings[q]) {
                    *slope = whole * opening;
                    energy += 0.5 * whole * opening * opening;
                }
                stiffness[q] = whole;
            }
            found.tension = found.tension.max(slopes[q][0] * 3.0 / self.facet.area());
        }
        found.energy += energy;
        self.last = Last {
            openings: *openings,
            slopes,
            energy,
        };
        let forces = middle.forces(a, b, &slopes);
        for (k, (points, forces)) in [a, b].into_iter().zip(forces).enumerate() {
            for (x, force) in points.iter().zip(forces) {
                found.elastic[k].force += force;
                found.elastic[k].torque += (x - origins[k]).cross(&force);
            }
        }
        stiffness
    }
}
