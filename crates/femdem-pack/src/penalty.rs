//! The penalty that a pack needs: an estimate from its weight and the penetration allowed.

use serde::{Deserialize, Serialize};

/// How the penalty of the contact law is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Penalty {
    /// From the expected stress in the pack, by [`automatic_penalty`], and what attraction adds to it.
    Automatic {
        /// Target of the mean penetration, over d.
        penetration: f64,
    },
    /// As given.
    Given {
        /// Penalty p, Pa.
        pressure: f64,
    },
}

impl Default for Penalty {
    fn default() -> Self {
        Self::Automatic {
            penetration: 0.0035,
        }
    }
}

/// Packing density assumed in estimates of the height and weight of a pack.
pub(crate) const EXPECTED_DENSITY: f64 = 0.57;

/// Horizontal over vertical stress in a pack between walls (Janssen's constant).
const STRESS_RATIO: f64 = 0.5;

/// Largest shear over vertical stress that a wall can take, however rough: the pack beside it yields first, at
/// sin(f) cos(f)/(1 + sin^2(f)) for a friction angle f inside it, which never exceeds 1/sqrt(8).
const LARGEST_GRIP: f64 = std::f64::consts::SQRT_2 / 4.0;

/// Penalty times (mean penetration/d)^3 over the mean stress. The exponent is that of vertex and crossed-edge
/// contacts, which are the softest and dominate the mean. The factor is calibrated on settled packs of
/// truncated dodecahedra at friction 0.6: 60, 100 and 300 bodies with penalties of 2, 7.7 and 3 MPa gave
/// 1.6e-4, 1.6e-4 and 1.75e-4.
const PENALTY_SCALE: f64 = 1.7e-4;

/// Inradius over d of truncated dodecahedra: the depth over which their field rises from 0 to 1.
pub(crate) const CALIBRATED_DEPTH: f64 = 0.42;

/// Weight and surroundings of a pack: the inputs of the penalty estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PackLoad {
    /// Weight of the pack per volume: bulk density times g, N/m^3.
    pub unit_weight: f64,
    /// Height of the pack, m.
    pub height: f64,
    /// Area of the floor, m^2.
    pub floor_area: f64,
    /// Length of the walls around it, m.
    pub perimeter: f64,
    /// Friction coefficient of the walls.
    pub wall_friction: f64,
    /// Circumscribed diameter d of the bodies, m.
    pub diameter: f64,
}

impl PackLoad {
    /// Vertical stress at mid height, Pa: the weight above minus what the walls carry (Janssen 1895), sigma =
    /// gamma l (1 - exp(-z/l)) with l = A/(K mu P) and K = 0.5; at least the stress under one layer of bodies.
    /// K mu is at most 0.35, the most that a pack transfers to a rough wall.
    pub fn mean_stress(&self) -> f64 {
        let depth = (self.height / 2.0).max(self.diameter);
        let shear = (STRESS_RATIO * self.wall_friction).min(LARGEST_GRIP);
        let grip = shear * self.perimeter / self.floor_area;
        let carried = if grip * depth > 1e-9 {
            -(-grip * depth).exp_m1() / grip
        } else {
            depth
        };
        self.unit_weight * carried
    }
}

/// The penalty (Pa) at which a pack under `load` is expected to have the mean penetration
/// `penetration_over_d`.
///
/// A vertex pressed into a face by the force F penetrates by delta with F of order p delta^3/d, and
/// F is of order sigma d^2, so p = c sigma/(delta/d)^3. The mean over all contacts of overlap volume over
/// contact area follows the same law with c = 1.7e-4, calibrated on settled packs of truncated dodecahedra. In
/// trials other shapes penetrated less, by up to a fifth (P3, A1, A13) or a quarter (P1, P4, P5); every report
/// states the value reached. For bodies that are not convex
/// [`PackSpec::resolved_penalty`](crate::PackSpec::resolved_penalty) reduces the penalty in proportion to the
/// depth over which their fields rise.
pub fn automatic_penalty(load: &PackLoad, penetration_over_d: f64) -> f64 {
    penalty_under_stress(load.mean_stress(), penetration_over_d, CALIBRATED_DEPTH)
}

/// As [`automatic_penalty`], under a mean stress (Pa), for bodies whose fields rise over `field_depth_over_d`.
pub fn penalty_under_stress(stress: f64, penetration_over_d: f64, field_depth_over_d: f64) -> f64 {
    let depth = field_depth_over_d / CALIBRATED_DEPTH;
    PENALTY_SCALE * stress / penetration_over_d.powi(3) * depth
}

/// The penalty (Pa) at which the faces of two bodies, or of one and a wall, rest at the depth `depth` (m) under a cohesion
/// (Pa) alone, where fields rise over `field_depth` (m): their stiffness per area is 2 p over that. The overlap of a ball has this
/// depth as its volume over its area, too, that of a corner one of the same order.
pub fn penalty_under_cohesion(cohesion: f64, field_depth: f64, depth: f64) -> f64 {
    0.5 * cohesion * field_depth / depth
}

/// The penalty (Pa) at which two equal balls of a radius (m) rest at the depth `depth` (m) under an adhesion (J/m^2) alone:
/// p pi depth^2 is 3/4 pi w R. The overlap volume over the area is half of the depth.
pub fn penalty_under_adhesion(adhesion_energy: f64, radius: f64, depth: f64) -> f64 {
    0.75 * adhesion_energy * radius / (depth * depth)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: PackLoad = PackLoad {
        unit_weight: 1.5e4,
        height: 0.2,
        floor_area: 0.01,
        perimeter: 0.4,
        wall_friction: 0.0,
        diameter: 0.01,
    };

    #[test]
    fn without_wall_friction_the_stress_is_the_weight_above() {
        assert!((LOAD.mean_stress() - 1500.0).abs() < 1e-9);
    }

    /// A wall rougher than the pack acts like one as rough as the pack.
    #[test]
    fn walls_grip_no_more_than_the_pack() {
        let stress = |wall_friction: f64| {
            PackLoad {
                wall_friction,
                ..LOAD
            }
            .mean_stress()
        };
        assert!(stress(0.7) > stress(1.0));
        for mu in [10.0, 1e300] {
            assert_eq!(stress(mu), stress(1.0));
        }
    }

    /// Janssen's differential equation d sigma/dz = gamma - K mu P/A sigma, integrated by Euler's
    /// midpoint rule from the top to mid height.
    #[test]
    fn wall_friction_obeys_janssens_equation() {
        let load = PackLoad {
            wall_friction: 0.6,
            height: 0.4,
            ..LOAD
        };
        let rate = |s: f64| load.unit_weight - 0.5 * 0.6 * 0.4 / 0.01 * s;
        let (mut stress, dz) = (0.0, 0.2 / 10_000.0);
        for _ in 0..10_000 {
            stress += dz * rate(stress + 0.5 * dz * rate(stress));
        }
        assert!((load.mean_stress() / stress - 1.0).abs() < 1e-6);
    }

    #[test]
    fn half_the_penetration_needs_eight_times_the_penalty() {
        let ratio = automatic_penalty(&LOAD, 0.002) / automatic_penalty(&LOAD, 0.004);
        assert!((ratio - 8.0).abs() < 1e-12);
    }
}
