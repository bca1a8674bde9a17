//! Step length along a direction of descent.
//!
//! A step is accepted if it lowers the energy enough (Armijo). Where differences of energies are lost in
//! round-off, it is accepted if the slope along the direction has fallen enough without a rise of the energy
//! (the approximate conditions of Hager and Zhang, SIAM J. Optim. 16, 170 (2005), eq. 4.1).

use super::{StaticProblem, vector};
use crate::FemError;

/// Fraction of the slope at the start that the mean slope must keep.
const DECREASE: f64 = 1e-4;
/// Rise of the energy that counts as round-off, relative to its size, if the problem gives no estimate.
const ROUND_OFF: f64 = 1e-13;
/// Without an energy, the slope must fall to this fraction of its value at the start.
const SLOPE: f64 = 0.9;
/// A step that is rejected is cut to between these fractions.
const CUT: [f64; 2] = [0.1, 0.5];

/// A point with its forces.
#[derive(Debug, Clone, Default)]
pub(super) struct Point {
    pub(super) x: Vec<f64>,
    pub(super) r: Vec<f64>,
    pub(super) energy: f64,
}

impl Point {
    /// Evaluates the forces at `self.x`.
    ///
    /// # Errors
    /// Of the problem; a force or an energy that is not finite.
    pub(super) fn evaluate<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
    ) -> Result<(), FemError> {
        self.r.resize(self.x.len(), 0.0);
        self.energy = problem.residual(&self.x, &mut self.r)?;
        if self.energy.is_finite() && vector::all_finite(&self.r) {
            return Ok(());
        }
        Err(FemError::Parameter {
            name: "a force or the energy of the static problem",
            value: f64::NAN,
            allowed: "finite: check moduli, loads and positions for values out of range",
        })
    }
}

/// Result of a search.
#[derive(Debug)]
pub(super) enum Search {
    /// The point was moved; the number of cuts.
    Moved(usize),
    /// No step was accepted; the problem's last error, if any.
    Stuck(Option<FemError>),
}

/// Moves `from` along `d`, a direction with r . d > 0, using `trial` as memory. The last call of the
/// problem's residual is at the point returned, except when stuck.
pub(super) fn search<P: StaticProblem + ?Sized>(
    problem: &mut P,
    from: &mut Point,
    trial: &mut Point,
    d: &[f64],
    most_cuts: usize,
) -> Search {
    let slope = vector::dot(&from.r, d);
    let mut step = 1.0;
    let mut error = None;
    for cuts in 0..=most_cuts {
        trial.x.clone_from(&from.x);
        vector::add_scaled(&mut trial.x, step, d);
        let cut = match trial.evaluate(problem) {
            Err(e) => {
                error = Some(e);
                CUT[1]
            }
            Ok(()) => {
                let now = vector::dot(&trial.r, d);
                if is_enough(problem, from, trial, step, slope, now) {
                    std::mem::swap(from, trial);
                    return Search::Moved(cuts);
                }
                // Where the slope, assumed linear, vanishes.
                (slope / (slope - now)).clamp(CUT[0], CUT[1])
            }
        };
        step *= cut;
    }
    Search::Stuck(error)
}

/// Slopes are those of descent: positive while the energy falls.
fn is_enough<P: StaticProblem + ?Sized>(
    problem: &P,
    from: &Point,
    trial: &Point,
    step: f64,
    slope: f64,
    now: f64,
) -> bool {
    let (before, after) = (vector::norm(&from.r), vector::norm(&trial.r));
    if !problem.has_energy() {
        return now.abs() <= SLOPE * slope || after <= (1.0 - DECREASE) * before;
    }
    let fall = from.energy - trial.energy;
    let size = from.energy.abs().max(trial.energy.abs());
    let noise = problem.noise();
    if fall.abs() > noise.energy.max(ROUND_OFF * size) {
        return fall >= DECREASE * step * slope;
    }
    now >= -(1.0 - 2.0 * DECREASE) * slope || after <= before.max(noise.force)
}

#[cfg(test)]
mod tests {
    use super::super::testing::Function;
    use super::*;

    fn start(problem: &mut Function, x: f64) -> Point {
        let mut point = Point {
            x: vec![x],
            ..Point::default()
        };
        point.evaluate(problem).unwrap();
        point
    }

    #[test]
    fn a_step_too_far_is_cut_until_the_energy_falls() {
        // E = x^4, from 1 along -100: the minimum is at 1 % of the step.
        let mut problem = Function::new(|x| x.powi(4), |x| 4.0 * x.powi(3), |x| 12.0 * x * x);
        let mut from = start(&mut problem, 1.0);
        let end = search(
            &mut problem,
            &mut from,
            &mut Point::default(),
            &[-100.0],
            20,
        );
        assert!(matches!(end, Search::Moved(1..)), "{end:?}");
        assert!(from.energy < 1.0 && from.x[0] < 1.0);
    }

    #[test]
    fn states_without_forces_are_stepped_back_from() {
        // E = x - ln x, undefined for x <= 0.
        let mut problem = Function::new(|x| x - x.ln(), |x| 1.0 - 1.0 / x, |x| x.powi(-2));
        let mut from = start(&mut problem, 8.0);
        let end = search(&mut problem, &mut from, &mut Point::default(), &[-56.0], 20);
        assert!(matches!(end, Search::Moved(1..)), "{end:?}");
        assert!(from.x[0] > 0.0 && from.energy < 8.0 - 8.0_f64.ln());
    }

    #[test]
    fn no_way_down_is_stuck() {
        let mut problem = Function::new(|x| x * x, |x| 2.0 * x, |_| 2.0);
        let mut from = start(&mut problem, 1.0);
        // Along the opposite of a direction of descent.
        let end = search(&mut problem, &mut from, &mut Point::default(), &[1.0], 5);
        assert!(matches!(end, Search::Stuck(None)), "{end:?}");
        assert_eq!(from.x, [1.0]);
    }
}
