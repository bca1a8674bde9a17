//! Two spheres.
//!
//! On the skin of a sphere S with its centre at the distance d from that of a sphere F, let r be the distance of a point
//! from the centre of F, and theta its angle at the centre of S from the direction to F. Then
//! r^2 = d^2 + S^2 - 2 d S cos(theta) gives dS = 2 pi (S/d) r dr, so that every integral of the field phi = 1 - r/F over
//! the skin of S in F is one of a polynomial in r. So is every integral over the overlap: of the sphere of radius r about
//! F's centre, pi (r/d) (S^2 - (d - r)^2) lies in S. With r = |d - S| + w all factors are free of cancellation, also for
//! the slightest overlap.

use super::rule::FOUR;
use crate::axes::complete;
use crate::foundation::Foundation;
use crate::kernel::Overlap;
use femdem_mesh::Vector3;
use std::f64::consts::PI;

/// The field of a sphere F over the skin of a sphere S and over the overlap. Heights z are above the pole of S that is
/// nearest to F's centre, towards S's centre; rho is the distance from the line of centres.
#[derive(Debug, Clone, Copy, Default)]
struct Side {
    /// int phi dS, int phi z dS, int phi (rho^2 + z^2) dS, int phi cos(theta) dS.
    pressure: f64,
    first: f64,
    second: f64,
    force: f64,
    /// int k dS, int k z dS, int k rho^2 dS with the stiffness per area k = max(0, n . grad phi), n the outward normal
    /// of S.
    stiffness: f64,
    stiffness_first: f64,
    polar: f64,
    /// int cos(theta) dS.
    area: f64,
    /// int phi dV, int dV.
    energy: f64,
    volume: f64,
}

impl Side {
    /// The radii of F and S and the distance of their centres, m.
    fn new(field: f64, skin: f64, d: f64) -> Self {
        let mut sums = Self::default();
        let least = (d - skin).abs();
        let holds_centre = d < skin;
        if holds_centre {
            // The spheres about F's centre that lie within S: 4 pi int (1 - r/F) r^2 dr.
            let r = least.min(field);
            sums.energy = PI * r.powi(3) * (4.0 / 3.0 - r / field);
            sums.volume = 4.0 / 3.0 * PI * r.powi(3);
        }
        let width = (field - least).min(2.0 * d.min(skin));
        if width.is_nan() || width <= 0.0 {
            return sums;
        }
        // z/S = 1 - cos(theta)
        let rise = |w: f64| w * (2.0 * least + w) / (2.0 * d * skin);
        let rim = rise(width);
        sums.area = PI * skin * skin * rim * (2.0 - rim);
        for (node, weight) in FOUR {
            let w = width * node;
            let r = least + w;
            let phi = (field - r) / field;
            let q = rise(w);
            let in_s = if holds_centre {
                (2.0 * least + w) * (2.0 * d - w)
            } else {
                w * (2.0 * skin - w)
            };
            let shell = PI * width / d * weight * r * in_s;
            sums.energy += shell * phi;
            sums.volume += shell;
            let pressed = 2.0 * PI * skin * (width / d) * weight * r * phi;
            let z = skin * q;
            sums.pressure += pressed;
            sums.first += pressed * z;
            // rho^2 = S^2 q (2 - q), rho^2 + z^2 = 2 S^2 q
            sums.second += pressed * 2.0 * skin * z;
            sums.force += pressed * (1.0 - q);
        }
        sums.add_stiffness(field, skin, d, width);
        sums
    }

    /// n . grad phi = (d^2 - S^2 - r^2)/(2 r S F), which is positive for r^2 < d^2 - S^2.
    fn add_stiffness(&mut self, field: f64, skin: f64, d: f64, width: f64) {
        let least = d - skin;
        if least <= 0.0 {
            return;
        }
        let width = width.min((least * (d + skin)).sqrt() - least);
        for (node, weight) in FOUR {
            let w = width * node;
            let q = w * (2.0 * least + w) / (2.0 * d * skin);
            let rate = 2.0 * least * (skin - w) - w * w;
            let k = PI * width / (d * field) * weight * rate;
            self.stiffness += k;
            self.stiffness_first += k * skin * q;
            self.polar += k * skin * skin * q * (2.0 - q);
        }
    }
}

/// The contact of two spheres with radii `a` and `b` (m), the centre of B at `between` from that of A, for a penalty in
/// Pa. `None` if they do not overlap, or if there is no net force (one centred in the other).
pub(super) fn overlap(penalty: f64, a: f64, b: f64, between: &Vector3) -> Option<Overlap> {
    let d = between.norm();
    let depth = a + b - d;
    if !(depth > 0.0 && d > 0.0) {
        return None;
    }
    let normal = between / d;
    let (on_b, on_a) = (Side::new(a, b, d), Side::new(b, a, d));
    let force = penalty * (on_a.force + on_b.force);
    let pressure = on_a.pressure + on_b.pressure;
    if !(force > 0.0 && pressure > 0.0) {
        return None;
    }
    // Along the normal from the middle between the poles: that of B's skin lies at -depth/2, that of A's at depth/2.
    let half = 0.5 * depth;
    let first =
        |of_b: f64, of_a: f64, sum: [f64; 2]| (of_b - half * sum[0]) - (of_a - half * sum[1]);
    let centre = first(on_b.first, on_a.first, [on_b.pressure, on_a.pressure]) / pressure;
    let second = (on_b.second + on_a.second) - depth * (on_b.first + on_a.first);
    let spread = second / pressure + half * half - centre * centre;
    let stiffness = on_a.stiffness + on_b.stiffness;
    let stiff = first(
        on_b.stiffness_first,
        on_a.stiffness_first,
        [on_b.stiffness, on_a.stiffness],
    );
    let [_, axis, _] = complete(&normal);
    let offset = if stiffness > 0.0 {
        stiff / stiffness - centre
    } else {
        0.0
    };
    let foundation = Foundation::round(
        normal * offset,
        axis,
        penalty * stiffness,
        penalty * (on_a.polar + on_b.polar),
    );
    let arm_a = normal * (a - half + centre);
    Some(Overlap {
        force: normal * force,
        moment: Vector3::zeros(),
        arm_a,
        arm_b: normal * (half + centre - b),
        normal,
        energy: penalty * (on_a.energy + on_b.energy),
        volume: on_a.volume,
        area: on_b.area.max(0.0),
        torsion_radius: foundation.mean_over_rms() * spread.max(0.0).sqrt(),
        foundation,
    })
}
