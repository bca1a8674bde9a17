//! A wall that presses with a wanted force.

use crate::error::{SolveError, check};
use serde::{Deserialize, Serialize};

/// Time τ in which the force of contacts whose bodies hold still comes to its wanted value, in steps of the world: the
/// stiffness may grow many times within a step.
const STEPS: f64 = 5.0;

/// Part of the velocity of the dashpot at which the integral begins, against it, and its time in τ for each body from wall to
/// wall: the two for which the force comes to its value in e^(−t 14/15 R τ) alone. The energy that gravity stores makes R too
/// large; what is then left for the slow integral is a fifteenth.
const BACK: f64 = 1.0 / 15.0;
const SLOW: f64 = 225.0 / 14.0;

/// Least number of bodies from wall to wall for which the integral is slow enough.
const FEWEST: f64 = 5.0;

/// Part of the wanted force by which the force may miss it while the wall stands still.
const TOLERANCE: f64 = 1e-3;

/// What a wall meets: [`World::resistances`](crate::World::resistances).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resistance {
    /// Force with which the wall presses now, best without dashpots
    /// ([`Load::static_part`](femdem_contact::Load::static_part)), N.
    pub force: f64,
    /// Stiffness of what it touches, N/m; 0 if it touches nothing.
    pub stiffness: f64,
    /// Elastic energy of what it presses, J.
    pub energy: f64,
}

/// Moves a wall so that it presses with a wanted force: a controller with a limit of speed.
///
/// The wall is a piston without weight, pushed by the wanted force F\*, that meets the bodies with F. Its velocity is the
/// sum of that of a dashpot and that of a mass,
///
/// v = (F\* − F)/(K τ) + ∫ (F\* − F)/(16 R K τ²) dt,
///
/// with the stiffness K of its contacts and τ = 5 steps. What it presses yields R times as much as these contacts: with the
/// energy U that it stores its stiffness is F²/2U, so that R = 2 K U/F², and at least 5. Dashpot and mass are passive: the wall
/// feeds no oscillation of the bodies, whatever their mass. The integral begins at −(F\* − F)/(15 K τ) when the wall begins
/// to move, and after it was at its limit of speed; with it the force of bodies that are elastic comes to F\* without exceeding
/// it. It is taken back with R = 5 once the force is beyond F\*.
///
/// While the wall must travel at a constant speed, as the sides of a specimen that is sheared, no error stays. Where bodies
/// that gave way suddenly hold, the force exceeds F\* for a while. Free of contacts, the wall moves at the limit of speed. It
/// stands still while the force is right to 10⁻³, so that bodies can come to rest.
///
/// ```
/// use femdem_solve::{Resistance, Servo};
///
/// // A spring of 1000 N/m is to be pressed with 5 N.
/// let (mut servo, mut pressed, step) = (Servo::new(0.1)?, 0.0, 1e-4);
/// for _ in 0..4000 {
///     let energy = 500.0 * pressed * pressed;
///     let resistance = Resistance { force: 1000.0 * pressed, stiffness: 1000.0, energy };
///     pressed += servo.velocity(&resistance, 5.0, step) * step;
/// }
/// assert!((1000.0 * pressed - 5.0).abs() <= 5e-3);
/// assert_eq!(servo.velocity(&Resistance { force: 5.0, stiffness: 1000.0, energy: 0.0125 }, 5.0, step), 0.0);
/// # Ok::<(), femdem_solve::SolveError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// m/s.
    limit: f64,
    /// The integral, m/s; `None`: it begins with the next step.
    drift: Option<f64>,
    stands: bool,
}

impl Servo {
    /// A controller that moves a wall at most at `limit`, m/s.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] for a limit that is not positive and finite.
    pub fn new(limit: f64) -> Result<Self, SolveError> {
        check(
            "speed of a controlled wall",
            limit,
            limit > 0.0,
            "positive and finite, in m/s",
        )?;
        Ok(Self {
            limit,
            drift: None,
            stands: false,
        })
    }

    /// The velocity for the next step, positive into the bodies, m/s, under a `wanted` force (N). `step` is the size of the last
    /// step (s); where none has been taken, 0, the force is not known yet, and the wall waits.
    pub fn velocity(&mut self, resistance: &Resistance, wanted: f64, step: f64) -> f64 {
        let Resistance {
            force,
            stiffness,
            energy,
        } = *resistance;
        if step == 0.0 {
            return 0.0;
        }
        let missing = wanted - force;
        let allowed = TOLERANCE * wanted.abs();
        let relaxing = STEPS * step * stiffness;
        let resting = self.drift.unwrap_or(0.0).abs() * relaxing <= allowed;
        let most = if self.stands { 2.0 * allowed } else { allowed };
        self.stands = missing.abs() <= most && resting;
        let drift = self.drift.take();
        if self.stands {
            return 0.0;
        }
        if stiffness == 0.0 {
            return if missing == 0.0 {
                0.0
            } else {
                self.limit.copysign(missing)
            };
        }
        let at_once = missing / relaxing;
        // Infinite without a force: the integral waits.
        let yielding = (2.0 * stiffness * energy / force.powi(2)).max(FEWEST);
        let drift = drift.map_or(-BACK * at_once, |drift| {
            // What carries the wall beyond the wanted force ends soon.
            let bodies = if drift * missing < 0.0 {
                FEWEST
            } else {
                yielding
            };
            drift + at_once / (SLOW * STEPS * bodies)
        });
        let velocity = at_once + drift;
        if velocity.abs() > self.limit {
            return self.limit.copysign(velocity);
        }
        self.drift = Some(drift);
        velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STEP: f64 = 1e-4;

    /// What a wall of the contact stiffness `k` meets that presses with a force in front of springs of the stiffness `behind`.
    fn met(force: f64, k: f64, behind: f64) -> Resistance {
        Resistance {
            force,
            stiffness: if force > 0.0 { k } else { 0.0 },
            energy: 0.5 * force.powi(2) / behind,
        }
    }

    /// The force on a spring after `steps`; `ahead` moves its other end away from the wall, m/s.
    fn pressed(servo: &mut Servo, stiffness: f64, wanted: f64, ahead: f64, steps: u32) -> f64 {
        let (mut wall, mut end) = (0.0, 0.0);
        for _ in 0..steps {
            let force = f64::max(0.0, stiffness * (wall - end));
            wall += servo.velocity(&met(force, stiffness, stiffness), wanted, STEP) * STEP;
            end += ahead * STEP;
        }
        stiffness * (wall - end)
    }

    #[test]
    fn a_spring_that_yields_steadily_is_pressed_without_error() {
        let mut servo = Servo::new(1.0).unwrap();
        let force = pressed(&mut servo, 1e5, 20.0, 0.05, 4000);
        assert!((force / 20.0 - 1.0).abs() < 2e-3, "{force}");
    }

    #[test]
    fn the_wanted_force_is_not_exceeded_on_the_way() {
        for yielding in [1.0, 0.3, 0.1, 0.01] {
            let mut servo = Servo::new(1e-2).unwrap();
            let (stiffness, wanted, mut force) = (1e5, 20.0, 0.0);
            let behind = yielding * stiffness;
            for _ in 0..40_000 {
                let resistance = met(force, stiffness, behind);
                force += behind * servo.velocity(&resistance, wanted, STEP) * STEP;
                assert!(force <= wanted * (1.0 + TOLERANCE), "{force}");
            }
            assert!(force >= 0.999 * wanted, "{force}");
        }
    }

    #[test]
    fn the_speed_has_its_limit() {
        let mut servo = Servo::new(0.01).unwrap();
        let velocity = servo.velocity(&met(1.0, 1.0, 1.0), 1e3, STEP);
        assert_eq!(velocity, 0.01);
        assert_eq!(servo.velocity(&met(0.0, 1.0, 1.0), 1e3, STEP), 0.01);
        assert_eq!(servo.velocity(&met(1.0, 1.0, 1.0), 1e3, 0.0), 0.0);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Servo::new(bad).is_err(), "{bad}");
        }
    }

    /// A mass between the wall and a spring to the ground, without any damping of its own.
    #[test]
    fn a_mass_on_a_spring_comes_to_rest() {
        let (contact, ground, mass, wanted) = (1e5, 1e4, 0.1, 10.0);
        let step = 0.2 * f64::sqrt(mass / (contact + ground));
        let mut servo = Servo::new(1.0).unwrap();
        let (mut wall, mut x, mut v) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..40_000 {
            let force = f64::max(0.0, contact * (wall - x));
            let resistance = met(force, contact, 1.0 / (1.0 / contact + 1.0 / ground));
            wall += servo.velocity(&resistance, wanted, step) * step;
            v += (force - ground * x) / mass * step;
            x += v * step;
        }
        assert!((ground * x / wanted - 1.0).abs() < 5e-3, "{}", ground * x);
        assert!(v.abs() * f64::sqrt(mass * contact) < 0.01 * wanted, "{v}");
    }

    proptest! {
        /// Any stiffness, force and limit: the force comes to its value and the wall then stands.
        #[test]
        fn any_spring_is_pressed(stiffness in 1e-3_f64..1e9, wanted in 1e-3_f64..1e6, limit in 1e-3_f64..10.0) {
            let mut servo = Servo::new(limit).unwrap();
            let way = (wanted / stiffness / (limit * STEP)).min(1e5) as u32;
            prop_assume!(wanted / stiffness < 1e4 * limit * STEP);
            let force = pressed(&mut servo, stiffness, wanted, 0.0, 2 * way + 8000);
            prop_assert!((force / wanted - 1.0).abs() <= 2.0 * TOLERANCE, "{}", force);
            prop_assert!(servo.velocity(&met(force, stiffness, stiffness), wanted, STEP) == 0.0);
        }
    }
}
