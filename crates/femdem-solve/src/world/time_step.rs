//! The step size: a fraction of a stability bound, changed rarely and by fixed rules.

use crate::body::Body;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::parameters::TimeStepParameters;
use femdem_contact::{BodyShape, ContactParameters, stable_step};
use serde::{Deserialize, Serialize};

/// Step sizes are the cap divided by powers of this. A coarser ratio wastes half of itself on average, and
/// does not conserve energy better.
const LEVEL: f64 = 1.01;

/// The bound for a flat face that has just touched, over the cap, which ignores levers and friction: 0.43 to
/// 0.52 for two cubes, 0.61 to 0.74 for one on a floor.
const TOUCH: f64 = 0.45;

/// A larger step is taken only after so many steps that would all have allowed it.
const PATIENCE: u32 = 5;

/// A step that moves a body by more than this fraction of its bounding radius is a blow-up.
pub(super) const LARGEST_MOVE: f64 = 0.25;

/// Fraction of its bounding radius that a body should move in a step at most.
pub(super) const USUAL_MOVE: f64 = 0.1;

/// Speed makes the step at most this many times shorter than stability does. A body that is faster still, and
/// was not when it was added, has blown up.
const SHORTEST: f64 = 32.0;

/// The step if nothing is free to move, s.
const UNBOUNDED: f64 = 1e-3;

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepControl {
    /// The step of a single full face contact, the largest ever taken, s.
    cap: f64,
    current: f64,
    patience: u32,
    /// Smallest bound seen while waiting to grow, s.
    lowest: f64,
    /// The bound of the last step, s.
    bound: f64,
    /// Shortest step that the speed of an added body requires, s: a body launched fast has not blown up.
    launch: f64,
    /// Smallest length scale of the fields of all shapes in use, m.
    thinnest: f64,
    /// Whether the cap may be wrong: laws or a material have changed, a body has gone, or a thinner one has come.
    stale: bool,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            cap: f64::INFINITY,
            current: 0.0,
            patience: 0,
            lowest: f64::INFINITY,
            bound: f64::INFINITY,
            launch: f64::INFINITY,
            thinnest: f64::INFINITY,
            stale: false,
        }
    }
}

impl StepControl {
    /// The step in use, s; 0 before the first.
    pub(crate) fn current(&self) -> f64 {
        self.current
    }

    /// The stability bound of the last step, s.
    pub(crate) fn bound(&self) -> f64 {
        self.bound
    }

    /// Forgets the cap, when the law changes.
    pub(crate) fn forget(&mut self) {
        *self = Self::default();
    }

    /// Notes that all bodies must be met and seen again before the next step is chosen.
    pub(crate) fn lose(&mut self) {
        self.stale = true;
    }

    /// Whether all bodies must be met and seen again: the cap is forgotten then.
    pub(crate) fn begins_anew(&mut self) -> bool {
        if std::mem::take(&mut self.stale) {
            self.cap = f64::INFINITY;
            self.thinnest = f64::INFINITY;
            return true;
        }
        false
    }

    /// Records a shape in use. Returns whether its field is steeper than all before: all bodies must then be
    /// [seen](Self::see) again.
    pub(crate) fn meet(&mut self, shape: &BodyShape) -> bool {
        let length = shape.inradius();
        let thinner = length < self.thinnest;
        self.thinnest = self.thinnest.min(length);
        thinner
    }

    /// Lowers the cap for a body: one contact over its stiffest side against an equal body, or against one as
    /// thin as the thinnest in use, by each of the laws that its material may meet.
    pub(crate) fn see<'a>(
        &mut self,
        shape: &BodyShape,
        body: &Body,
        laws: impl Iterator<Item = &'a ContactParameters>,
    ) {
        let length = shape.inradius();
        let steeper = 0.5 * (1.0 + length / self.thinnest.min(length));
        for law in laws {
            let stiffness = shape.face_stiffness() * steeper * law.penalty;
            let frequency2 = 2.0 * stiffness / body.mass;
            let rate = 2.0 * law.damping_ratio * frequency2.sqrt();
            self.cap = self.cap.min(stable_step(frequency2, rate));
        }
    }

    /// Allows steps as short as the speed of a body requires that was added or got its velocity by hand.
    pub(crate) fn launch(&mut self, body: &Body) {
        self.see_launch(USUAL_MOVE * body.radius / body.fastest());
    }

    /// Takes the shortest step of a launch of another rank; all else is alike.
    pub(crate) fn join(&mut self, other: &Self) {
        self.see_launch(other.launch);
    }

    /// Takes the smallest length scale of all ranks.
    pub(crate) fn share_lengths(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        halo.least(std::slice::from_mut(&mut self.thinnest))
    }

    /// Takes the lowest cap and the shortest step of a launch of all ranks.
    pub(crate) fn share_steps(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let mut least = [self.cap, self.launch];
        halo.least(&mut least)?;
        [self.cap, self.launch] = least;
        Ok(())
    }

    /// The bound for a body that comes down on a face, including friction springs and levers, s.
    pub(crate) fn touch(&self) -> f64 {
        TOUCH * self.cap
    }

    /// Allows steps as short as the speed of a new body requires, s.
    pub(crate) fn see_launch(&mut self, usual: f64) {
        self.launch = self.launch.min(usual);
    }

    /// The largest step that may be chosen, s.
    pub(crate) fn top(&self, parameters: &TimeStepParameters) -> f64 {
        let limit = parameters.largest.unwrap_or(f64::INFINITY);
        let top = (parameters.safety * self.cap).min(limit);
        if top.is_finite() { top } else { UNBOUNDED }
    }

    /// Lowers the cap for a deformable body: the bound of its elements or of its contacts, s.
    pub(crate) fn see_elements(&mut self, bound: f64) {
        self.cap = self.cap.min(bound);
    }

    /// Takes an implicit step of a multiple of the cap, s, at most `most`.
    pub(crate) fn choose_implicit(&mut self, multiple: f64, most: f64) -> f64 {
        self.bound = f64::INFINITY;
        self.patience = 0;
        let step = (multiple * self.cap).min(most);
        self.current = if step.is_finite() { step } else { UNBOUNDED };
        self.current
    }

    /// Chooses the step from the stability bound, s, and the step in which no body moves [far](USUAL_MOVE), s.
    pub(crate) fn choose(
        &mut self,
        bound: f64,
        usual: f64,
        parameters: &TimeStepParameters,
    ) -> f64 {
        let top = self.top(parameters);
        self.bound = bound;
        let stable = top.min(parameters.safety * self.bound);
        let shortest = self.launch.min(stable / SHORTEST);
        let allowed = on_level(top, stable.min(usual.max(shortest)));
        if allowed <= self.current || self.current == 0.0 || self.current > top {
            self.current = allowed;
            self.patience = 0;
            self.lowest = f64::INFINITY;
        } else {
            self.lowest = self.lowest.min(allowed);
            self.patience += 1;
            if self.patience >= PATIENCE {
                self.current = self.lowest;
                self.patience = 0;
                self.lowest = f64::INFINITY;
            }
        }
        self.current
    }
}

/// The largest top / LEVEL^k that is at most `allowed`.
fn on_level(top: f64, allowed: f64) -> f64 {
    let mut step = top;
    while step > allowed && step > 0.0 {
        step /= LEVEL;
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x'' = -omega^2 x - gamma v with the velocity of the half step before, kick-drift-kick:
    /// bounded just below the bound, growing just above.
    #[test]
    fn the_bound_separates_decay_from_growth() {
        for (omega, gamma) in [(1.0_f64, 0.0), (1.0, 0.5), (3.0, 4.0)] {
            let bound = stable_step(omega * omega, gamma);
            let grows = |dt: f64| {
                let (mut x, mut v) = (1.0_f64, 0.0_f64);
                let mut f = -omega * omega * x - gamma * v;
                for _ in 0..4000 {
                    v += 0.5 * dt * f;
                    x += dt * v;
                    f = -omega * omega * x - gamma * v;
                    v += 0.5 * dt * f;
                }
                x.is_nan() || x.abs() > 1e3
            };
            assert!(!grows(0.99 * bound), "omega {omega} gamma {gamma}");
            assert!(grows(1.02 * bound), "omega {omega} gamma {gamma}");
        }
    }
}
