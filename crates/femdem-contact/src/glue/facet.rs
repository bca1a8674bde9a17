//! A cut facet whose sides still hold, press and rub.

use super::law::{Glue, Held};
use super::{GlueLaw, GlueLimits, MidSurface};
use crate::error::{ContactError, check};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A point of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    /// `None` where a facet across the plane that failed carried nothing.
    pub glue: Option<Glue>,
    /// Offset g of the contact, m, and what it loses in a step once no glue is left.
    pub offset: f64,
    pub fade: f64,
    /// Opening at the last [`GluedFacet::advance`], m.
    pub normal: f64,
    /// Where the friction springs are unstretched, m.
    pub slip: [f64; 2],
    /// Their stretch after the last [`GluedFacet::advance`], m; 0 without pressure.
    pub stretch: [f64; 2],
}

/// Openings at three points, or derivatives of an energy by them.
pub(crate) type Openings = [[f64; 3]; 3];

/// The matrix between the pairs of nodes and the points of a facet: each point has 2/3 of its corner and 1/6 of either other one,
/// half of it and a sixth of all. It is its own transpose: values at points of those of corners, and forces on corners of those at
/// points.
fn inside<const N: usize>(corners: &[[f64; N]; 3]) -> [[f64; N]; 3] {
    let mut all = [0.0; N];
    for corner in corners {
        for (sum, value) in all.iter_mut().zip(corner) {
            *sum += value / 6.0;
        }
    }
    let mut points = *corners;
    for point in &mut points {
        for (value, sum) in point.iter_mut().zip(all) {
            *value = 0.5 * *value + sum;
        }
    }
    points
}

/// Forces and energies of a facet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GluedForces {
    /// Forces on the nodes of the first and of the second side, N.
    pub on: [[Vector3; 3]; 2],
    /// Energy stored in the glue, J.
    pub glue: f64,
    /// Energy of the contact and its friction springs, J.
    pub contact: f64,
}

/// Energy that a facet has dissipated, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GlueLoss {
    /// By the glue.
    pub glue: f64,
    /// By friction, and by friction springs that lost their contact; the work of the mean friction of before and now over the
    /// slip.
    pub friction: f64,
    /// By the pressure of the birth, which fades once no glue is left.
    pub pressure: f64,
}

/// Steps in which the pressure of the birth fades.
const FADES: f64 = 50.0;

/// Friction springs are cut back to their limit up to this part of it.
const ROUNDING: f64 = 1e-9;

/// A cut facet between two tetrahedra.
///
/// What its openings do is summed over three points inside, at 2/3, 1/6, 1/6 of its corners, with a third of its area each, a rule
/// that is exact for quadratic functions (G. R. Cowper, Int. J. Numer. Meth. Engng 7 (1973) 405-408). So a facet that turns about
/// a corner which does not open breaks, too, and takes all of its energy. The module's documentation has an example.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GluedFacet {
    /// Area of the facet before the body deforms, m².
    area: f64,
    pub(super) points: [Option<Point>; 3],
}

impl Point {
    /// A point under a traction, and what its springs were lent, J/m².
    fn born(law: &GlueLaw, traction: [f64; 3], limits: &GlueLimits) -> (Self, f64) {
        let [normal, shear] = [traction[0], traction[1].hypot(traction[2])];
        let pressure = (-normal).max(0.0);
        // As much of the shear as friction holds; the glue has the rest.
        let rubbed = (law.friction * pressure).min(shear);
        let share = if shear > 0.0 { rubbed / shear } else { 0.0 };
        let [one, two] = [traction[1], traction[2]];
        let rest = [normal.max(0.0), one * (1.0 - share), two * (1.0 - share)];
        let offset = pressure / law.contact;
        let held = Held {
            friction: [one, two].map(|shear| shear * share),
            pressure,
        };
        let new = Self {
            glue: Glue::born(law, rest, held, limits),
            offset,
            fade: if law.presses { 0.0 } else { offset / FADES },
            normal: 0.0,
            slip: [one, two].map(|shear| -shear * share / law.tangential),
            stretch: [one, two].map(|shear| shear * share / law.tangential),
        };
        let glued = rest.iter().map(|t| t * t).sum::<f64>();
        let springs = glued / law.stiffness
            + pressure * pressure / law.contact
            + rubbed * rubbed / law.tangential;
        (new, 0.5 * springs)
    }

    /// Opening of the glue in the axes of the facet, m; the normal part is not negative.
    fn stretch(glue: &Glue, law: &GlueLaw, opening: &[f64; 3]) -> [f64; 3] {
        let all = [0, 1, 2].map(|i| opening[i] + glue.traction[i] / law.stiffness);
        [all[0].max(0.0), all[1], all[2]]
    }

    /// Stretch of the contact, m.
    fn overlap(&self, law: &GlueLaw, opening: &[f64; 3]) -> f64 {
        let apart = if law.presses {
            opening[0]
        } else {
            opening[0].max(0.0)
        };
        (self.offset - apart).max(0.0)
    }

    /// Energy of the contact over its stiffness, m²: the integral of the stretch over the opening.
    fn pressed(&self, law: &GlueLaw, opening: &[f64; 3]) -> f64 {
        let overlap = self.overlap(law, opening);
        // Under the pressure of the birth alone, which stays the same as the faces overlap.
        let beyond = if law.presses {
            0.0
        } else {
            (-opening[0]).max(0.0)
        };
        0.5 * overlap * overlap + self.offset * beyond
    }

    /// Stretch of the friction springs, m.
    fn shear(&self, opening: &[f64; 3]) -> [f64; 2] {
        [opening[1] - self.slip[0], opening[2] - self.slip[1]]
    }

    /// Stretch at which the friction springs slide, m.
    fn longest(law: &GlueLaw, overlap: f64) -> f64 {
        law.friction * law.contact * overlap / law.tangential
    }

    /// What the faces hold at an opening, after they have slid.
    fn held(&self, law: &GlueLaw, opening: &[f64; 3]) -> Held {
        let overlap = self.overlap(law, opening);
        let stretch = self.slid(law, opening, overlap);
        Held {
            friction: stretch.map(|x| law.tangential * x),
            pressure: law.contact * overlap,
        }
    }

    /// Stretch of the friction springs at an opening, m: no longer than they slide. Without pressure they let go.
    fn slid(&self, law: &GlueLaw, opening: &[f64; 3], overlap: f64) -> [f64; 2] {
        let shear = self.shear(opening);
        let length = shear[0].hypot(shear[1]);
        let most = Self::longest(law, overlap);
        let kept = if length > most { most / length } else { 1.0 };
        shear.map(|x| x * kept)
    }

    /// Whether the friction springs were below it after the last [`GluedFacet::advance`].
    fn sticks(&self, law: &GlueLaw, overlap: f64) -> bool {
        let [one, two] = self.stretch;
        one.hypot(two) < Self::longest(law, overlap) * (1.0 - ROUNDING)
    }

    /// Whether every number is finite, and those that cannot be negative are not.
    fn is_sound(&self, law: &GlueLaw) -> bool {
        let mut numbers = [self.normal]
            .into_iter()
            .chain(self.slip)
            .chain(self.stretch);
        numbers.all(f64::is_finite)
            && [self.offset, self.fade]
                .iter()
                .all(|x| *x >= 0.0 && x.is_finite())
            && self.glue.is_none_or(|glue| glue.is_sound(law))
    }
}

impl GluedFacet {
    /// A facet of an area (m²) that is not joined yet: it exerts no force.
    ///
    /// # Errors
    ///
    /// [`ContactError::Parameter`] unless the area is positive and finite.
    pub fn new(area: f64) -> Result<Self, ContactError> {
        check(
            "area of a facet",
            area,
            area > 0.0,
            "above 0 and finite, in m^2",
        )?;
        Ok(Self {
            area,
            points: [None; 3],
        })
    }

    /// Joins a facet the first of whose nodes has just been split, under the traction (Pa) that it carries, in the axes of its
    /// [`MidSurface`]: the normal part, positive in tension, and two along the facet, of the second side on the first. Its glue has
    /// the limits given, which are for [`GlueLimits::check`] to test, times the factor of the strength at the node nearest to each
    /// point. Returns the energy that its springs were lent, J.
    pub fn join(
        &mut self,
        law: &GlueLaw,
        traction: [f64; 3],
        limits: &GlueLimits,
        factors: [f64; 3],
    ) -> f64 {
        let mut lent = 0.0;
        for (point, factor) in self.points.iter_mut().zip(factors) {
            let (new, springs) = Point::born(law, traction, &limits.scaled(factor));
            *point = Some(new);
            lent += springs * self.area / 3.0;
        }
        lent
    }

    /// Area before the body deforms, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Whether it has been joined.
    #[must_use]
    pub fn is_joined(&self) -> bool {
        self.points.iter().all(Option::is_some)
    }

    /// Whether point `q` has given way.
    pub(crate) fn gave_way(&self, q: usize) -> bool {
        self.points[q].is_some()
    }

    /// Whether it has been joined and no glue holds any more.
    #[must_use]
    pub fn is_broken(&self, law: &GlueLaw) -> bool {
        let broken = |point: &Point| point.glue.is_none_or(|glue| glue.is_broken(law));
        self.points
            .iter()
            .all(|point| point.as_ref().is_some_and(broken))
    }

    /// Whether the facet does nothing any more: neither glue nor pressure of the birth is left.
    #[must_use]
    pub fn is_spent(&self, law: &GlueLaw) -> bool {
        self.is_broken(law) && self.points.iter().flatten().all(|p| p.offset == 0.0)
    }

    /// A bound of the stiffness at each pair of nodes now, N/m, of the glue that is left and of the contact: with shape functions N
    /// that sum up to 1, Σ_r Σ_p A/3 k_p N_q N_r = Σ_p A/3 k_p N_q.
    #[must_use]
    pub fn stiffness(&self, law: &GlueLaw) -> [f64; 3] {
        let points = self.points.map(|point| {
            let of = |point: Point| {
                let glue = point.glue.map_or(0.0, |glue| glue.secant(law));
                let contact = law.contact.max(law.tangential);
                let can_press = law.presses || point.offset > 0.0;
                glue + if can_press { contact } else { 0.0 }
            };
            [point.map_or(0.0, of) * self.area / 3.0]
        });
        inside(&points).map(|[stiffness]| stiffness)
    }

    /// Stiffness at each point at these openings, N/m: where the sides are apart, that of the glue, or of a contact that
    /// closes, whichever is larger.
    pub(crate) fn stiffness_at(&self, law: &GlueLaw, openings: &Openings) -> [f64; 3] {
        [0, 1, 2].map(|q| {
            let of = |point: Point| {
                let glue = point.glue.map_or(0.0, |glue| glue.secant(law));
                let contact = law.contact.max(law.tangential);
                if point.overlap(law, &openings[q]) > 0.0 {
                    glue + contact
                } else {
                    glue.max(contact)
                }
            };
            self.points[q].map_or(0.0, of) * self.area / 3.0
        })
    }

    /// Stiffness that holds each point at these openings, N/m, along the normal and across, of which dashpots are a part:
    /// across an open gap that of the glue, under pressure that of the contact, and of its friction as long as it sticks; at most
    /// that before the point gave way. Where the sides slide on each other, friction alone resists.
    pub(crate) fn stiffness_left(&self, law: &GlueLaw, openings: &Openings) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|q| {
            let of = |point: Point| {
                let glue = point.glue.map_or(0.0, |glue| glue.secant(law));
                let overlap = point.overlap(law, &openings[q]);
                let (mut along, mut across) = (glue, glue);
                if overlap > 0.0 {
                    along = law.contact;
                    if point.sticks(law, overlap) {
                        across += law.tangential;
                    }
                }
                [along, across].map(|left| left.min(law.stiffness) * self.area / 3.0)
            };
            self.points[q].map_or([0.0; 2], of)
        })
    }

    /// Whether every number is finite and possible: for a facet that was read.
    pub(crate) fn is_sound(&self, law: &GlueLaw) -> bool {
        self.area > 0.0
            && self.area.is_finite()
            && self
                .points
                .iter()
                .flatten()
                .all(|point| point.is_sound(law))
    }

    /// Whether every number is finite and possible, and all of its points are joined or none: for a facet of a crack that was read.
    #[must_use]
    pub fn is_of_crack(&self, law: &GlueLaw) -> bool {
        let is_apart = self.points.iter().all(Option::is_none);
        (self.is_joined() || is_apart) && self.is_sound(law)
    }

    /// Damage of its points: 0 at birth, 1 where nothing holds any more; 0 for those that are not joined.
    #[must_use]
    pub fn damage(&self, law: &GlueLaw) -> [f64; 3] {
        let of = |point: Point| point.glue.map_or(1.0, |glue| glue.damage(law));
        self.points.map(|point| point.map_or(0.0, of))
    }

    /// Forces and energies at positions of the nodes of the two sides, m, for which [`advance`](Self::advance) has been called
    /// first: what has slid and softened up to there. Nothing for a facet whose mid-surface has lost its area.
    #[must_use]
    pub fn forces(&self, law: &GlueLaw, a: &[Vector3; 3], b: &[Vector3; 3]) -> GluedForces {
        let middle = MidSurface::new(a, b);
        middle.map_or_else(GluedForces::default, |middle| {
            self.pull(law, &middle, a, b, &inside(&middle.openings(a, b)))
        })
    }

    /// Forces and energies at the openings of the points between two sides, m.
    fn pull(
        &self,
        law: &GlueLaw,
        middle: &MidSurface,
        a: &[Vector3; 3],
        b: &[Vector3; 3],
        openings: &Openings,
    ) -> GluedForces {
        let (slopes, glue, contact) = self.slopes(law, openings);
        GluedForces {
            on: middle.forces(a, b, &inside(&slopes)),
            glue,
            contact,
        }
    }

    /// Derivatives of the energy by the openings of the points, N, and the energies of the glue and of the contact, J.
    pub(crate) fn slopes(&self, law: &GlueLaw, openings: &Openings) -> (Openings, f64, f64) {
        let mut energies = [0.0; 2];
        let weight = self.area / 3.0;
        let mut slopes = [[0.0; 3]; 3];
        for ((point, opening), slope) in self.points.iter().zip(openings).zip(&mut slopes) {
            let Some(point) = point else {
                continue;
            };
            if let Some(glue) = &point.glue {
                let secant = weight * glue.secant(law);
                let stretch = Point::stretch(glue, law, opening);
                for i in 0..3 {
                    slope[i] += secant * stretch[i];
                    energies[0] += 0.5 * secant * stretch[i] * stretch[i];
                }
            }
            let overlap = point.overlap(law, opening);
            if overlap > 0.0 {
                slope[0] -= weight * law.contact * overlap;
                energies[1] += weight * law.contact * point.pressed(law, opening);
                for (i, stretch) in point.shear(opening).into_iter().enumerate() {
                    slope[i + 1] += weight * law.tangential * stretch;
                    energies[1] += 0.5 * weight * law.tangential * stretch * stretch;
                }
            }
        }
        (slopes, energies[0], energies[1])
    }

    /// Takes what the openings at these positions change for good: glue that stretches further than ever softens, friction
    /// springs beyond the limit slide, and those without pressure let go. Returns what that dissipates.
    pub fn advance(&mut self, law: &GlueLaw, a: &[Vector3; 3], b: &[Vector3; 3]) -> GlueLoss {
        let middle = MidSurface::new(a, b);
        middle.map_or_else(GlueLoss::default, |middle| {
            self.follow(law, &inside(&middle.openings(a, b)))
        })
    }

    /// [`advance`](Self::advance), and then [`forces`](Self::forces).
    pub fn step(
        &mut self,
        law: &GlueLaw,
        a: &[Vector3; 3],
        b: &[Vector3; 3],
    ) -> (GlueLoss, GluedForces) {
        let Some(middle) = MidSurface::new(a, b) else {
            return Default::default();
        };
        let openings = inside(&middle.openings(a, b));
        let lost = self.follow(law, &openings);
        (lost, self.pull(law, &middle, a, b, &openings))
    }

    /// [`advance`](Self::advance) by the openings of the points, m.
    pub(crate) fn follow(&mut self, law: &GlueLaw, openings: &Openings) -> GlueLoss {
        let mut lost = GlueLoss::default();
        let weight = self.area / 3.0;
        for (point, opening) in self.points.iter_mut().zip(openings) {
            let Some(point) = point else {
                continue;
            };
            let held = point.held(law, opening);
            if let Some(glue) = &mut point.glue {
                let stretch = Point::stretch(glue, law, opening);
                lost.glue += weight * glue.reach(law, &stretch, held);
            }
            if point.offset > 0.0 && point.glue.is_none_or(|glue| glue.is_broken(law)) {
                // The mean of where the faces were and are: with the energy this is the work of the mean force.
                let places = [[point.normal, 0.0, 0.0], *opening];
                let pressed = |point: &Point| places.map(|at| 0.5 * point.pressed(law, &at));
                let before = pressed(point);
                point.offset = (point.offset - point.fade).max(0.0);
                let after = pressed(point);
                lost.pressure +=
                    weight * law.contact * (before[0] - after[0] + before[1] - after[1]);
            }
            point.normal = opening[0];
            let overlap = point.overlap(law, opening);
            let stretch = point.slid(law, opening, overlap);
            for i in 0..2 {
                // The mean of the friction before and now, over the slip: with the energy of the springs this is the work of
                // the mean force.
                let slip = opening[i + 1] - stretch[i];
                let mean = 0.5 * (point.stretch[i] + stretch[i]);
                lost.friction += weight * law.tangential * mean * (slip - point.slip[i]);
                point.slip[i] = slip;
            }
            point.stretch = stretch;
        }
        lost
    }
}
