//! Rolling friction of a patch: a spring in the plane that slides.
//!
//! The relative rotation of the two sides about axes in the contact plane turns a spring of the stiffness k_t r^2, with
//! the tangential stiffness k_t of the patch and the rolling radius r
//! ([`RigidContact::rolling_radius`](crate::RigidContact::rolling_radius)). Its moment, with a dashpot beside it as in the
//! tangential spring, is at most mu_r N r: beyond, the spring is turned back and the difference is dissipated. For
//! spheres this is the constant directional torque with an elastic start of Ai, Chen, Rotter and Ooi (2011), Powder
//! Technology 206, 269-282 (their type C), with mu_r as it is given for other codes.

use crate::damping::against_lag;
use crate::friction::{FOLLOW, dashpot};
use crate::rocking::{Turn, turned};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// The spring of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct RollingState {
    /// Rotation of B against A that the spring stores, in the plane, rad.
    angle: Vector3,
    /// Stiffness at the last evaluation, N m; 0 before the first.
    stiffness: f64,
}

/// A patch as rolling friction sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Roller {
    pub normal: Vector3,
    /// Largest moment mu_r N r, N m.
    pub most: f64,
    /// k_t r^2, N m.
    pub stiffness: f64,
    /// Fraction of critical damping.
    pub zeta: f64,
}

/// Rolling friction of one step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Rolling {
    /// On B, and the part of it due to the dashpot, N m.
    pub moment: Vector3,
    pub drag: Vector3,
    /// Energy in the spring, J.
    pub energy: f64,
    /// N m and N m s.
    pub stiffness: f64,
    pub viscosity: f64,
}

impl RollingState {
    /// A spring that carries a moment on B, N m, until the next update, in which it takes on the stiffness of its patch.
    pub fn carrying(moment: Vector3) -> Self {
        // So soft that any patch is stiffer, which keeps its moment.
        let stiffness = f64::EPSILON.powi(2);
        Self {
            angle: -moment / stiffness,
            stiffness,
        }
    }

    /// Advances the spring by the time `dt` since the last evaluation, s. Without `dashpots` the moment is that of the
    /// spring alone.
    pub fn update(&mut self, patch: &Roller, turn: &Turn, dt: f64, dashpots: bool) -> Rolling {
        let n = &patch.normal;
        let across = |v: &Vector3| v - n * n.dot(v);
        let rate = across(&(turn.rates[1] - turn.rates[0]));
        let k = patch.stiffness;
        let spin = (turn.rates[0] + turn.rates[1]) * (0.5 * dt);
        let mut angle = if self.stiffness > 0.0 {
            across(&turned(&self.angle, &spin)) + rate * dt
        } else {
            Vector3::zeros()
        };
        // A stiffer patch keeps its moment, a softer one its angle: neither gains energy.
        if k > self.stiffness * (1.0 + FOLLOW) {
            angle *= self.stiffness / k;
        }
        let mobility = turn.mobilities[0] + turn.mobilities[1];
        let w = 0.5 * (mobility.trace() - n.dot(&(mobility * n)));
        let viscosity = dashpot(patch.zeta, k, w);
        let drag = rate * (viscosity * against_lag(viscosity * w, dt, 1.0));
        let asked = -angle * k - drag;
        let size = asked.norm();
        let mut moment = asked;
        if size > patch.most {
            moment *= patch.most / size;
            let spring = moment + drag;
            // The spring carries what the dashpot leaves of the bound, and never drives the rotation.
            angle = if spring.dot(&moment) > 0.0 {
                -spring / k
            } else {
                Vector3::zeros()
            };
        }
        let spring = -angle * k;
        if !dashpots {
            moment = spring;
        }
        *self = Self {
            angle,
            stiffness: k,
        };
        Rolling {
            moment,
            drag: moment - spring,
            energy: 0.5 * k * angle.norm_squared(),
            stiffness: k,
            viscosity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Matrix3;

    #[test]
    fn a_spring_begins_with_the_moment_that_it_is_given() {
        let patch = Roller {
            normal: Vector3::z(),
            most: 1.0,
            stiffness: 30.0,
            zeta: 0.3,
        };
        let turn = Turn {
            rates: [Vector3::zeros(); 2],
            mobilities: [Matrix3::identity(); 2],
        };
        let given = Vector3::new(0.3, -0.4, 0.0);
        let mut state = RollingState::carrying(given);
        for dt in [0.0, 1e-3] {
            let rolling = state.update(&patch, &turn, dt, true);
            assert!((rolling.moment - given).norm() < 1e-12, "{rolling:?}");
            // M²/(2 k).
            assert!((rolling.energy - 0.25 / 60.0).abs() < 1e-12, "{rolling:?}");
        }
    }

    /// Rolled to and fro by random rotations, with a patch that hardens and softens and a frame that turns, the spring
    /// never gives more than it took, and the moment keeps to its bound and plane.
    #[test]
    fn it_only_dissipates() {
        let mut state = RollingState::default();
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        let dt = 1e-3;
        let (mut taken, mut slid) = (0.0, 0);
        for _ in 0..20_000 {
            let rates = [(); 2].map(|()| Vector3::new(random(), random(), random()) * 30.0);
            let turn = Turn {
                rates,
                mobilities: [Matrix3::identity() * 100.0, Matrix3::zeros()],
            };
            let patch = Roller {
                normal: Vector3::new(random() * 0.01, random() * 0.01, 1.0).normalize(),
                most: 2.0 * (1.5 + random()),
                stiffness: 10.0 * (1.2 + random()),
                zeta: 0.6,
            };
            let got = state.update(&patch, &turn, dt, true);
            let size = got.moment.norm();
            assert!(size <= patch.most * (1.0 + 1e-12), "{size}");
            assert!(got.moment.dot(&patch.normal).abs() < 1e-12 * (1.0 + size));
            slid += u32::from(size > patch.most * (1.0 - 1e-9));
            // The work at the end of the step, which is not less than that at its middle.
            taken -= got.moment.dot(&(rates[1] - rates[0])) * dt;
            assert!(taken >= got.energy, "{taken} {}", got.energy);
        }
        assert!((1000..19_000).contains(&slid), "{slid}");
    }
}
