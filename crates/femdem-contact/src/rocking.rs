//! The dashpot of a patch against its rattle: the elastic rocking of a body on its face.
//!
//! Rocking about the contact point is orthogonal to the gradient of the energy to first order, so that the normal
//! dashpot ([`crate::damping`]) does not see it. Let M be the elastic moment on B about the centre of the patch's
//! foundation, and Omega the angular velocity of B relative to A, both about a principal axis of the foundation with
//! the rocking stiffness J. As long as the whole patch stays in touch, M changes by -J Omega per time, and a dashpot
//! with the fraction zeta of critical damping is tau dM/dt with tau = 2 zeta/omega, omega^2 = J w, w the inverse
//! moment of inertia about the axis.
//!
//! In rolling the pressure travels with the patch, and M stays what it is; in toppling over an edge the patch narrows,
//! and M changes the other way. Neither may be resisted. What is resisted is therefore the share g of the rotation that
//! the patch follows elastically,
//!
//! m = -2 zeta sqrt(J/w) g^2 Omega,   g = -sum(dM dTheta)/sum(J dTheta^2), limited to 0..1,
//!
//! with dTheta = Omega dt and sums over the steps so far that forget over 1/omega. The power is
//! -2 zeta sqrt(J/w) (g Omega)^2: the dashpot only dissipates. While the patch follows, g is 1 whichever way the body
//! rocks. While the body rolls, also on the facets of a polygon, M stays bounded and dTheta adds up, so that g vanishes.
//!
//! dM is the difference of two evaluations, in axes that turn with the mean rotation of both bodies; a patch that has
//! just formed has none. No tension: the centre of pressure stays within the patch.

use crate::damping::against_lag;
use crate::foundation::Foundation;
use crate::motion::Motion;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// The elastic rocking of a patch so far.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct RockingState {
    /// The elastic moment on B about the foundation's centre at the last evaluation, N m; `None` before the first.
    moment: Option<Vector3>,
    /// By principal axis, sums of -dM dTheta and of J dTheta^2, J.
    followed: [f64; 2],
    turned: [f64; 2],
}

/// How the two sides turn.
pub(crate) struct Turn {
    /// Angular velocities of A and of B, rad/s.
    pub rates: [Vector3; 2],
    /// Their inverse inertia tensors in world axes, 1/(kg m^2).
    pub mobilities: [Matrix3; 2],
}

impl Turn {
    pub fn of_bodies([a, b]: [&Motion; 2]) -> Self {
        Self {
            rates: [a.angular_velocity, b.angular_velocity],
            mobilities: [a.inverse_inertia, b.inverse_inertia],
        }
    }
}

/// A patch as the dashpot sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rocker<'a> {
    pub foundation: &'a Foundation,
    pub normal: &'a Vector3,
    /// Elastic force and its moment about the contact point, on B, N and N m.
    pub force: Vector3,
    pub moment: Vector3,
    /// Normal force with damping over the elastic one.
    pub scale: f64,
    /// Fraction of critical damping.
    pub zeta: f64,
}

/// The dashpot's moment and viscosities.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Rocking {
    /// On B, N m.
    pub moment: Vector3,
    /// Principal axes of the foundation in the plane, and the largest viscosities about them, N m s.
    pub axes: [Vector3; 2],
    pub viscosity: [f64; 2],
    /// Those that act now.
    pub acting: [f64; 2],
}

impl Rocking {
    /// Without the moment, for hosts that apply the viscosities themselves.
    pub fn leave_springs(&mut self) {
        self.moment = Vector3::zeros();
        self.viscosity = self.acting;
    }
}

impl RockingState {
    /// Advances the record to the present evaluation and returns the dashpot; `dt` is the time since the last, s.
    pub fn update(&mut self, patch: &Rocker, turn: &Turn, dt: f64) -> Rocking {
        let moment = patch.about_centre();
        let change = self.moment.map(|before| {
            let spin = (turn.rates[0] + turn.rates[1]) * (0.5 * dt);
            moment - turned(&before, &spin)
        });
        self.moment = Some(moment);
        patch.rocking(turn, &change.unwrap_or_default(), dt, self)
    }

    /// Adds a change of the moment (N m) and of the angle (rad) about a principal axis with stiffness J (N m) to the
    /// sums, which forget the fraction `lost`, and returns the share g.
    fn share(&mut self, axis: usize, change: f64, angle: f64, stiffness: f64, lost: f64) -> f64 {
        let kept = 1.0 - lost;
        self.followed[axis] = self.followed[axis] * kept - change * angle;
        self.turned[axis] = self.turned[axis] * kept + stiffness * angle * angle;
        let (followed, turned) = (self.followed[axis], self.turned[axis]);
        if followed >= turned {
            // Also at rest, where both are zero.
            1.0
        } else if followed > 0.0 {
            followed / turned
        } else {
            0.0
        }
    }
}

/// A vector turned by a small angle, rad: without a trigonometric function, to second order, and as long as it was.
pub(crate) fn turned(v: &Vector3, angle: &Vector3) -> Vector3 {
    let half = angle * 0.5;
    let across = half.cross(v);
    v + (across + half.cross(&across)) * (2.0 / (1.0 + half.norm_squared()))
}

impl Rocker<'_> {
    /// The elastic moment on B about the foundation's centre, N m.
    fn about_centre(&self) -> Vector3 {
        self.moment - self.foundation.centre.cross(&self.force)
    }

    /// The dashpot after a `change` of the elastic moment (N m) within `dt` (s); velocities are those of half a step
    /// before.
    fn rocking(
        &self,
        sides: &Turn,
        change: &Vector3,
        dt: f64,
        state: &mut RockingState,
    ) -> Rocking {
        let mut found = Rocking {
            axes: self.foundation.axes(self.normal),
            ..Rocking::default()
        };
        let mobility = sides.mobilities[0] + sides.mobilities[1];
        let moment = self.about_centre();
        let force = self.force.dot(self.normal);
        for k in 0..2 {
            let axis = found.axes[k];
            let w = axis.dot(&(mobility * axis));
            let stiffness = self.foundation.rocking[k];
            // Also where the stiffness of the patch is zero up to rounding.
            let usable = stiffness > 0.0 && w > 0.0 && self.zeta > 0.0;
            if !usable {
                continue;
            }
            found.viscosity[k] = 2.0 * self.zeta * (stiffness / w).sqrt();
            let viscosity = found.viscosity[k];
            let turn = (sides.rates[1] - sides.rates[0]).dot(&axis);
            let forgets = dt * (stiffness * w).sqrt();
            let lost = forgets / (1.0 + forgets);
            let share = state.share(k, change.dot(&axis), turn * dt, stiffness, lost);
            found.acting[k] = viscosity * share * share;
            let late = against_lag(viscosity * w, dt, 1.0);
            let asked = -found.acting[k] * late * turn;
            // Half the width of a uniform rectangle with this second moment.
            let reach = (3.0 * stiffness / self.foundation.stiffness).sqrt();
            let room = force * reach - moment.dot(&axis) * asked.signum();
            let room = (room * self.scale).max(0.0);
            found.moment += axis * asked.max(-room).min(room);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A patch of a given length and width on the plane z = 0, pressed by 1 N.
    fn foundation(length: f64, width: f64) -> Foundation {
        Foundation {
            rocking: [width * width / 12.0, length * length / 12.0].map(|x| x * 100.0),
            ..Foundation::round(Vector3::zeros(), Vector3::x(), 100.0, 0.0)
        }
    }

    fn turn(rate: Vector3) -> Turn {
        Turn {
            rates: [Vector3::zeros(), rate],
            mobilities: [Matrix3::zeros(), Matrix3::identity() * 50.0],
        }
    }

    fn rocker<'a>(foundation: &'a Foundation, normal: &'a Vector3, moment: Vector3) -> Rocker<'a> {
        Rocker {
            foundation,
            normal,
            force: *normal,
            moment,
            scale: 1.0,
            zeta: 0.6,
        }
    }

    /// Whatever the moment does, the dashpot takes energy or none, and the pressure stays on the patch.
    #[test]
    fn it_never_drives() {
        let mut seed = 3_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / f64::from(1 << 23) - 1.0
        };
        let (mut state, normal) = (RockingState::default(), Vector3::z());
        for _ in 0..10_000 {
            let patch = foundation(0.2 + 0.1 * random(), 0.05 + 0.04 * random());
            let moment = Vector3::new(random() * 0.02, random() * 0.06, 0.0);
            let rate = Vector3::new(random(), random(), random());
            let got = state.update(&rocker(&patch, &normal, moment), &turn(rate), 1e-3);
            assert!(got.moment.dot(&rate) <= 0.0, "{got:?}");
            for k in 0..2 {
                let reach = (3.0 * patch.rocking[k] / patch.stiffness).sqrt();
                let asked = got.moment.dot(&got.axes[k]);
                let elastic = moment.dot(&got.axes[k]);
                let most = reach.max(elastic.abs()) * (1.0 + 1e-12);
                assert!((elastic + asked).abs() <= most, "{elastic} {asked}");
            }
        }
    }

    /// Where the moment follows the rotation the dashpot has its full viscosity about each axis; where it does not
    /// change, none.
    #[test]
    fn it_resists_the_rattle_and_not_rolling() {
        let (patch, normal, dt) = (foundation(0.2, 0.05), Vector3::z(), 1e-4);
        for k in 0..2 {
            let axis = patch.axes(&normal)[k];
            let rate = axis * 1e-3;
            let (mut rattles, mut rolls) = (RockingState::default(), RockingState::default());
            let (mut angle, mut got) = (0.0, [Rocking::default(); 2]);
            for _ in 0..20_000 {
                angle += 1e-3 * dt;
                let moment = axis * (-patch.rocking[k] * angle);
                got = [
                    rattles.update(&rocker(&patch, &normal, moment), &turn(rate), dt),
                    rolls.update(&rocker(&patch, &normal, axis * 1e-3), &turn(rate), dt),
                ];
            }
            let critical = 2.0 * 0.6 * (patch.rocking[k] / 50.0).sqrt();
            assert!((got[0].viscosity[k] / critical - 1.0).abs() < 1e-12);
            assert!((got[0].acting[k] / critical - 1.0).abs() < 1e-3, "{got:?}");
            assert!(got[1].acting[k] < 1e-3 * critical, "{got:?}");
        }
    }
}
