//! Points that hold from the start, until their strength is reached.

use super::facet::{GluedFacet, Point};
use super::law::{Glue, GlueLaw};

impl GluedFacet {
    /// Lets point `q`, which holds elastically with the stiffness of the law, give way if its traction at an opening (m) is beyond
    /// the strength: an ellipse of tensile strength and cohesion in tension, cohesion and friction under pressure. From then on
    /// it is glue at its peak, with the friction that the pressure holds; nothing jumps. Returns the part of sliding in the
    /// traction of the glue, squared.
    pub(crate) fn give_way(
        &mut self,
        q: usize,
        law: &GlueLaw,
        [tensile, cohesion]: [f64; 2],
        opening: &[f64; 3],
    ) -> Option<f64> {
        let point = self.points.get_mut(q).filter(|point| point.is_none())?;
        let traction = opening.map(|x| law.stiffness * x);
        let shear = traction[1].hypot(traction[2]);
        let rubbed = (law.friction * (-traction[0]).max(0.0)).min(shear);
        let share = if shear > 0.0 { rubbed / shear } else { 0.0 };
        let [normal, sliding] = [traction[0].max(0.0), shear - rubbed];
        let over = (normal / tensile).hypot(sliding / cohesion);
        if over <= 1.0 {
            return None;
        }
        let peak = normal.hypot(sliding) / over;
        let rest = [normal, sliding, 0.0];
        let energy = law.energy(rest) - 0.5 * peak * peak / law.stiffness;
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
        Some(sliding * sliding / (sliding * sliding + normal * normal))
    }

    /// The energy (J/m²) beyond the peak, over that of the whole fracture, in a mixed mode: s is the part of sliding.
    pub(crate) fn beyond_peak(law: &GlueLaw, [tensile, cohesion]: [f64; 2], s: f64) -> f64 {
        let peak2 = 1.0 / ((1.0 - s) / tensile.powi(2) + s / cohesion.powi(2));
        1.0 - 0.5 * peak2 / law.stiffness / super::mixed_energy(law.energies, law.mix, s)
    }
}
