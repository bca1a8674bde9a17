//! A triangle of the section of a bond, and what its points do.

use super::BondLaw;
use crate::contact::Wrench;
use crate::error::ContactError;
use crate::generalized::Generalized;
use crate::glue::{GlueLaw, GluedFacet, MidSurface, Onset, Openings};
use crate::motion::Motion;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A triangle of the section of a bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BondFacet {
    /// Its corners midway between the sides, m.
    pub corners: [Vector3; 3],
    /// Mean opening, m.
    pub opening: f64,
    /// Mean slip, m.
    pub slip: f64,
    /// Mean part of the stiffness that is lost.
    pub damage: f64,
    /// Area, m².
    pub area: f64,
}

/// A triangle of the section, by the middles of its edges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Part {
    pub facet: GluedFacet,
    /// The points in the axes of A and of B, m.
    pub at: [[Vector3; 3]; 2],
    pub last: Last,
}

/// A triangle in the last update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Last {
    /// m.
    pub openings: Openings,
    /// N.
    pub slopes: Openings,
    /// Of springs, J.
    pub energy: f64,
}

/// The bodies of a bond.
pub(super) struct View<'a> {
    pub motions: [&'a Motion; 2],
    /// Relative to A, so that no digits are lost far from the origin, m.
    pub origins: [Vector3; 2],
    law: GlueLaw,
    strengths: [f64; 2],
    /// Viscosity over stiffness, s.
    delay: f64,
}

/// Sums over the parts, relative to A; loads are about the origins of the bodies.
#[derive(Default)]
pub(super) struct Sums {
    pub elastic: [Wrench; 2],
    pub damping: [Wrench; 2],
    pub stiffness: [Generalized; 2],
    /// Of the points midway between the sides, m, and their number.
    pub middle: Vector3,
    pub points: f64,
    pub normal: Vector3,
    pub tension: f64,
    pub energy: f64,
}

/// What an update has changed for good.
#[derive(Default)]
pub(super) struct Change {
    pub is_any: bool,
    /// Area that has given way, m², and the part of sliding in it.
    pub yielded: f64,
    pub slid: f64,
    /// Dissipated by friction, J.
    pub friction: f64,
}

impl<'a> View<'a> {
    pub fn new(law: &BondLaw, motions: [&'a Motion; 2], delay: f64) -> Self {
        let apart = motions[1].frame.position - motions[0].frame.position;
        Self {
            motions,
            origins: [Vector3::zeros(), apart],
            law: law.glue(),
            strengths: law.strengths(),
            delay,
        }
    }

    /// How fast B leaves A at a point, m/s.
    fn parting(&self, x: &Vector3) -> Vector3 {
        let [a, b] = [0, 1].map(|k| self.motions[k].velocity_at(&(x - self.origins[k])));
        b - a
    }
}

impl Last {
    /// The work of the mean forces since an earlier update, less what the springs store more, J: what a leapfrog step takes from
    /// the motion.
    pub fn work_since(&self, before: &Self) -> f64 {
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

impl Part {
    pub fn new(at: [[Vector3; 3]; 2], area: f64) -> Result<Self, ContactError> {
        Ok(Self {
            facet: GluedFacet::new(area)?,
            at,
            last: Last::default(),
        })
    }

    /// The points of both sides, relative to A, m, and the surface midway; `None` where that has no area.
    fn sides(&self, view: &View) -> ([[Vector3; 3]; 2], Option<MidSurface>) {
        let [a, b] = [0, 1].map(|k| {
            let rotation = &view.motions[k].frame.rotation;
            self.at[k].map(|x| rotation * x + view.origins[k])
        });
        ([a, b], MidSurface::new(&a, &b))
    }

    /// Takes what the motions change for good.
    pub fn take(&mut self, view: &View) -> Change {
        let mut change = Change::default();
        let ([a, b], Some(middle)) = self.sides(view) else {
            return change;
        };
        let openings = middle.openings(&a, &b);
        for (q, opening) in openings.iter().enumerate() {
            let onset = self.facet.give_way(q, &view.law, view.strengths, opening);
            if let Some(Onset { sliding, rubbed }) = onset {
                let area = self.facet.area() / 3.0;
                change.is_any = true;
                change.yielded += area;
                change.slid += area * sliding;
                change.friction += rubbed;
            }
        }
        let more = self.facet.follow(&view.law, &openings);
        change.is_any |= more != Default::default();
        change.friction += more.friction;
        change
    }

    /// Adds what it does to the bodies.
    pub fn evaluate(&mut self, view: &View, sums: &mut Sums) {
        let ([a, b], Some(middle)) = self.sides(view) else {
            return;
        };
        let law = &view.law;
        let openings = middle.openings(&a, &b);
        let whole = self.facet.area() / 3.0 * law.stiffness;
        let (mut slopes, glue, contact) = self.facet.slopes(law, &openings);
        let mut energy = glue + contact;
        let mut stiffness = self.facet.stiffness_at(law, &openings);
        let mut left = self.facet.stiffness_left(law, &openings);
        for q in 0..3 {
            if !self.facet.gave_way(q) {
                for (slope, opening) in slopes[q].iter_mut().zip(openings[q]) {
                    *slope = whole * opening;
                    energy += 0.5 * whole * opening * opening;
                }
                stiffness[q] = whole;
                left[q] = [whole; 2];
            }
            sums.tension = sums.tension.max(slopes[q][0] * 3.0 / self.facet.area());
        }
        sums.energy += energy;
        sums.normal += middle.axes[0] * self.facet.area();
        self.last = Last {
            openings,
            slopes,
            energy,
        };
        let forces = middle.forces(&a, &b, &slopes);
        for (k, (points, forces)) in [a, b].iter().zip(forces).enumerate() {
            for (x, force) in points.iter().zip(forces) {
                add(&mut sums.elastic[k], &force, &(x - view.origins[k]));
            }
        }
        for q in 0..3 {
            let x = (a[q] + b[q]) * 0.5;
            sums.middle += x;
            sums.points += 1.0;
            for k in 0..2 {
                sums.stiffness[k].add_everywhere(&(x - view.origins[k]), stiffness[q]);
            }
            if view.delay > 0.0 {
                let [along, across] = left[q].map(|left| left * view.delay);
                let [normal, speed] = [middle.axes[0], view.parting(&x)];
                let force = speed * across + normal * (normal.dot(&speed) * (along - across));
                for (k, force) in [force, -force].into_iter().enumerate() {
                    add(&mut sums.damping[k], &force, &(x - view.origins[k]));
                }
            }
        }
    }

    /// Whether a point has opened or slid by more than `most` (m), or the sides have turned so far that they face nothing.
    pub fn is_apart(&self, motions: [&Motion; 2], most: f64) -> bool {
        let [a, b] = [0, 1].map(|k| self.at[k].map(|x| motions[k].frame.point(&x)));
        MidSurface::new(&a, &b).is_none_or(|middle| {
            let far = |o: &[f64; 3]| o[0].max(0.0).hypot(o[1]).hypot(o[2]) > most;
            middle.openings(&a, &b).iter().any(far)
        })
    }

    /// As others see it.
    pub fn seen(&self, law: &GlueLaw, motions: [&Motion; 2]) -> BondFacet {
        let mean = |of: [f64; 3]| of.iter().sum::<f64>() / 3.0;
        let openings = self.last.openings;
        let middle = |q: usize| {
            let side = |k: usize| motions[k].frame.point(&self.at[k][q]);
            (side(0) + side(1)) * 0.5
        };
        let [p, q, r] = [0, 1, 2].map(middle);
        BondFacet {
            // The corners of a triangle from the middles of its edges.
            corners: [p + r - q, p + q - r, q + r - p],
            opening: mean(openings.map(|o| o[0])),
            slip: mean(openings.map(|o| o[1].hypot(o[2]))),
            damage: mean(self.facet.damage(law)),
            area: self.facet.area(),
        }
    }
}

fn add(to: &mut Wrench, force: &Vector3, arm: &Vector3) {
    to.force += force;
    to.torque += arm.cross(force);
}
