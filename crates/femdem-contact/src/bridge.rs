//! Liquid bridges between round bodies.
//!
//! A bridge of the volume V and the surface tension gamma, with the contact angle theta, pulls two balls, or a ball and a plane,
//! that are the gap H > 0 apart by
//!
//! F = 4 pi R gamma cos(theta) (1 - H/sqrt(H^2 + V/(pi R))),  R = R_A R_B/(R_A + R_B), the ball's at a plane.
//!
//! This is the capillary force of Rabinovich, Esayanur and Moudgil (2005), Langmuir 21, 10992-10997,
//! without the pull of the surface along the contact line, which is small for small V: for equal balls of the radius R_A it is
//! 2 pi R_A gamma cos(theta)/(1 + H/(2 d)) with d = H/2 (sqrt(1 + 2 V/(pi R_A H^2)) - 1), for a ball and a plane
//! 4 pi R_A gamma cos(theta)/(1 + H/d) with d = sqrt(H^2 + V/(pi R_A)) - H. They derive it as the derivative of the energy of the
//! wetted surface, so that it has a potential. Bodies that overlap are pulled as where they touch.
//!
//! Each pair of a ball and another, or a wall, has one bridge; where a wall has several planes, to the nearest one.
//!
//! A bridge forms when bodies touch, and breaks at the distance (1 + theta/2) V^(1/3) of Lian, Thornton and Adams (1993),
//! J. Colloid Interface Sci. 161, 138-147. Its energy is 0 where they touch; what it holds when it breaks is lost.

use crate::error::{ContactError, check};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// The liquid between round bodies that have touched.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiquidBridge {
    /// Volume V of a bridge, above 0, m^3; much smaller than the cubes of the radii.
    pub volume: f64,
    /// Surface tension gamma, at least 0, N/m; at 0 there is no bridge.
    pub tension: f64,
    /// Contact angle theta, from 0 to below pi/2, rad.
    pub contact_angle: f64,
}

impl LiquidBridge {
    /// Refuses what cannot be.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] names the first number out of its range.
    pub fn validate(&self) -> Result<(), ContactError> {
        let Self {
            volume,
            tension,
            contact_angle,
        } = *self;
        check(
            "liquid_bridge.volume",
            volume,
            (1e-100..=1e100).contains(&volume),
            "from 1e-100 to 1e100 m^3",
        )?;
        check(
            "liquid_bridge.tension",
            tension,
            (0.0..=1e100).contains(&tension),
            "from 0 to 1e100 N/m",
        )?;
        check(
            "liquid_bridge.contact_angle",
            contact_angle,
            (0.0..FRAC_PI_2).contains(&contact_angle),
            "from 0 to below a right angle",
        )
    }

    /// The gap at which a bridge breaks, m.
    #[must_use]
    pub fn rupture_distance(&self) -> f64 {
        (1.0 + 0.5 * self.contact_angle) * self.volume.cbrt()
    }

    /// The pull where the two touch, the largest, for a reduced radius in m, N.
    #[must_use]
    pub fn largest_force(&self, radius: f64) -> f64 {
        4.0 * PI * radius * self.tension * self.contact_angle.cos()
    }

    /// The pull over a gap (m; negative for a depth), N.
    #[must_use]
    pub fn force(&self, radius: f64, gap: f64) -> f64 {
        let most = self.largest_force(radius);
        if gap <= 0.0 {
            return most;
        }
        most * (1.0 - gap / self.reach(radius, gap))
    }

    /// The energy over a gap, J: the integral of the force from 0 on.
    #[must_use]
    pub fn energy(&self, radius: f64, gap: f64) -> f64 {
        let whole = self.largest_force(radius) * gap;
        if gap <= 0.0 {
            return whole;
        }
        whole * (1.0 - gap / (self.reach(radius, gap) + self.reach(radius, 0.0)))
    }

    /// What a bridge holds when it breaks, J.
    #[must_use]
    pub fn work_of_rupture(&self, radius: f64) -> f64 {
        self.energy(radius, self.rupture_distance())
    }

    /// sqrt(H^2 + V/(pi R)), m.
    fn reach(&self, radius: f64, gap: f64) -> f64 {
        gap.hypot((self.volume / (PI * radius)).sqrt())
    }
}
