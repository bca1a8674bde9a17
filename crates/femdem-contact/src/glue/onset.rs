//! Points that hold from the start, until their strength is reached.

use super::facet::{GluedFacet, Point};
use super::law::{Glue, GlueLaw, inverse_square, mixed_energy};

/// How a point gave way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Onset {
    /// The part of sliding in the traction of the glue, squared.
    pub sliding: f64,
    /// What friction dissipates at once, J.
    pub rubbed: f64,
}

impl GluedFacet {
    /// Lets point `q`, which holds elastically with the stiffness of the law, give way if its traction at an opening (m) is
    /// beyond the strength: an ellipse of tensile strength and cohesion in tension, cohesion and friction under pressure. From
    /// then on it is glue at its peak, with the friction that the pressure holds; no force jumps. One spring of the stretch (s +
    /// r)/k becomes two, of the stretches s/k of the glue and r/k of friction: the friction r has slid by s/k, and dissipates s
    /// r/k per area.
    pub(crate) fn give_way(
        &mut self,
        q: usize,
        law: &GlueLaw,
        strengths: [f64; 2],
        opening: &[f64; 3],
    ) -> Option<Onset> {
        let weight = self.area() / 3.0;
        let point = self.points.get_mut(q).filter(|point| point.is_none())?;
        let traction = opening.map(|x| law.stiffness * x);
        let shear = traction[1].hypot(traction[2]);
        let rubbed = (law.friction * (-traction[0]).max(0.0)).min(shear);
        let share = if shear > 0.0 { rubbed / shear } else { 0.0 };
        let [normal, sliding] = [traction[0].max(0.0), shear - rubbed];
        let over = (normal / strengths[0]).hypot(sliding / strengths[1]);
        if over <= 1.0 {
            return None;
        }
        let peak = normal.hypot(sliding) / over;
        let mode = sliding * sliding / (sliding * sliding + normal * normal);
        let energy = law.energy([normal, sliding, 0.0]) * Self::beyond_peak(law, strengths, mode);
        let taken = [1, 2].map(|i| traction[i] * share);
        let stretch = taken.map(|shear| shear / law.tangential);
        *point = Some(Point {
            glue: Some(Glue::softening(
                law,
                [0.0, -taken[0], -taken[1]],
                peak,
                energy,
            )),
            offset: 0.0,
            fade: 0.0,
            normal: opening[0],
            slip: [0, 1].map(|i| opening[i + 1] - stretch[i]),
            stretch,
        });
        let stored = |traction: f64, stiffness: f64| 0.5 * traction * traction / stiffness;
        let after = stored(sliding, law.stiffness) + stored(rubbed, law.tangential);
        Some(Onset {
            sliding: mode,
            rubbed: weight * (stored(shear, law.stiffness) - after),
        })
    }

    /// The energy beyond the peak, over that of the whole fracture, in a mixed mode: s is the part of sliding.
    fn beyond_peak(law: &GlueLaw, strengths: [f64; 2], s: f64) -> f64 {
        let all = mixed_energy(law.energies, law.mix, s);
        1.0 - 0.5 / (inverse_square(strengths, s) * law.stiffness * all)
    }

    /// A lower bound of it over all modes.
    pub(crate) fn least_beyond_peak(law: &GlueLaw, strengths: [f64; 2]) -> f64 {
        1.0 - 0.5 / (least_compliance(law.energies, law.mix, strengths) * law.stiffness)
    }
}

/// Intervals of the part of sliding in [`least_compliance`].
const INTERVALS: u32 = 256;

/// A lower bound, over all mixed modes, of the energy of fracture over the square of the strength, G/P², m/Pa. Both 1/P² and G are
/// monotonic in the part of sliding, so that in an interval of it their product is at least that of their least values at its ends.
#[must_use]
pub fn least_compliance(energies: [f64; 2], mix: f64, strengths: [f64; 2]) -> f64 {
    let part = |i: u32| f64::from(i) / f64::from(INTERVALS);
    let least = |i: u32| {
        let ends = [part(i), part(i + 1)];
        let of = |f: &dyn Fn(f64) -> f64| f(ends[0]).min(f(ends[1]));
        of(&|s| inverse_square(strengths, s)) * of(&|s| mixed_energy(energies, mix, s))
    };
    (0..INTERVALS).map(least).fold(f64::INFINITY, f64::min)
}
