//! Newton's method with a line search.

use super::cg::CgLimits;
use super::line_search::{Point, Search, search};
use super::linear::{Linear, Solver};
use super::{StaticProblem, check_start, judge};
use crate::FemError;
use crate::error::check;
use serde::{Deserialize, Serialize};

/// Cuts of a step before a direction is given up.
const MOST_CUTS: usize = 30;
/// Largest relative error of a linear solution by conjugate gradients; smaller near the solution (Eisenstat
/// and Walker, SIAM J. Sci. Comput. 17, 16 (1996), choice 2).
const LOOSEST: f64 = 1e-3;

/// Residual over force scale below which stagnation is attributed to round-off.
const NEAR: f64 = 1e-6;
const AT_ROUND_OFF: &str = "the rest may be round-off: raise the tolerance";

/// Options of [`newton`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NewtonOptions {
    /// Residual over force scale at which the state counts as equilibrium.
    pub tolerance: f64,
    /// Iterations after which to give up.
    pub max_iterations: usize,
    /// The linear solver.
    pub linear: Linear,
    /// Iterations of conjugate gradients for one direction, after which it is used as it is; 0 for
    /// twice the number of unknowns.
    pub max_linear_iterations: usize,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-9,
            max_iterations: 50,
            linear: Linear::default(),
            max_linear_iterations: 0,
        }
    }
}

impl NewtonOptions {
    /// # Errors
    /// [`FemError::Parameter`].
    fn check(&self) -> Result<(), FemError> {
        let t = self.tolerance;
        check("tolerance", t, t > 0.0 && t < 1.0, "above 0 and below 1")?;
        let n = self.max_iterations as f64;
        check("max_iterations", n, n >= 1.0, "at least 1")
    }
}

/// Report of [`newton`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct NewtonReport {
    /// Directions taken.
    pub iterations: usize,
    /// Residual over force scale, at the start and after each iteration.
    pub residuals: Vec<f64>,
    /// Iterations of conjugate gradients, or factorisations, of all directions together.
    pub linear_iterations: usize,
    /// Directions for which the tangent was not positive definite.
    pub modified: usize,
    /// Times the line search shortened a step.
    pub cuts: usize,
    /// Energy at the end, J.
    pub energy: f64,
}

impl NewtonReport {
    /// Residual over force scale at the end.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residuals.last().copied().unwrap_or(0.0)
    }
}

/// Newton's method with the memory of its linear solver, for many problems of one pattern (the steps of a
/// load): the symbolic factorisation is then done once.
#[derive(Debug)]
pub struct Newton {
    options: NewtonOptions,
    solver: Solver,
}

impl Newton {
    /// Checks the options.
    ///
    /// # Errors
    /// [`FemError::Parameter`]; [`FemError::FeatureMissing`] for [`Linear::Cholesky`] without the
    /// feature `implicit`.
    pub fn new(options: NewtonOptions) -> Result<Self, FemError> {
        options.check()?;
        let solver = Solver::new(options.linear)?;
        Ok(Self { options, solver })
    }

    /// Moves `x` to an equilibrium; see [`newton`].
    ///
    /// # Errors
    /// As [`newton`].
    pub fn solve<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &mut [f64],
    ) -> Result<NewtonReport, FemError> {
        check_start(problem, x)?;
        let mut at = Point {
            x: x.to_vec(),
            ..Point::default()
        };
        at.evaluate(problem)?;
        let mut report = NewtonReport::default();
        let end = self.iterate(problem, &mut at, &mut report);
        x.copy_from_slice(&at.x);
        end.map(|()| report)
    }

    /// The direction of the first iteration for the force `r` at `x`, solved tightly.
    ///
    /// # Errors
    /// Of the problem's tangent.
    pub(super) fn predict<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &[f64],
        r: &[f64],
    ) -> Result<Vec<f64>, FemError> {
        let limits = CgLimits {
            tolerance: 1e-3,
            ..self.limits(&[], x.len())
        };
        let mut d = vec![0.0; x.len()];
        self.solver.direction(problem, x, r, limits, &mut d)?;
        Ok(d)
    }

    fn iterate<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        at: &mut Point,
        report: &mut NewtonReport,
    ) -> Result<(), FemError> {
        let mut trial = Point::default();
        let mut d = vec![0.0; at.x.len()];
        loop {
            let (residual, is_rest) = judge(problem, &at.r, self.options.tolerance);
            report.residuals.push(residual);
            report.energy = at.energy;
            if is_rest {
                return Ok(());
            }
            if report.iterations >= self.options.max_iterations {
                let advice = "raise max_iterations, or apply the load in smaller steps";
                return Err(self.failure(report, advice));
            }
            if is_stalled(&report.residuals) {
                return Err(self.failure(report, AT_ROUND_OFF));
            }
            let limits = self.limits(&report.residuals, at.x.len());
            let effort = self
                .solver
                .direction(problem, &at.x, &at.r, limits, &mut d)?;
            report.iterations += 1;
            report.linear_iterations += effort.iterations;
            report.modified += usize::from(effort.modified);
            match search(problem, at, &mut trial, &d, MOST_CUTS) {
                Search::Moved(cuts) => report.cuts += cuts,
                Search::Stuck(error) => return Err(self.stuck(report, error)),
            }
        }
    }

    /// Limits of the linear solution: it need not be more accurate than the next residual can be.
    fn limits(&self, residuals: &[f64], unknowns: usize) -> CgLimits {
        let tolerance = match residuals {
            [.., before, now] => {
                let quadratic = 0.9 * (now / before).powi(2);
                quadratic.max(0.3 * self.options.tolerance / now)
            }
            _ => LOOSEST,
        };
        CgLimits {
            tolerance: tolerance.min(LOOSEST),
            iterations: match self.options.max_linear_iterations {
                0 => 2 * unknowns + 50,
                n => n,
            },
        }
    }

    fn stuck(&self, report: &NewtonReport, error: Option<FemError>) -> FemError {
        let advice = match error {
            Some(error) => {
                format!("apply the load in smaller steps; the last step failed: {error}")
            }
            None if report.residual() < NEAR => AT_ROUND_OFF.to_owned(),
            None => "apply the load in smaller steps, or relax the body in a world; the tangent may not \
                     belong to the forces"
                .to_owned(),
        };
        self.failure(report, &advice)
    }

    fn failure(&self, report: &NewtonReport, advice: &str) -> FemError {
        FemError::NotConverged {
            method: "Newton's method",
            iterations: report.iterations,
            residual: report.residual(),
            tolerance: self.options.tolerance,
            advice: advice.to_owned(),
        }
    }
}

/// Whether five iterations near the solution have not halved the residual.
fn is_stalled(residuals: &[f64]) -> bool {
    match residuals {
        [.., before, _, _, _, _, now] => *now < NEAR && *now > 0.5 * before,
        _ => false,
    }
}

/// Moves `x` to an equilibrium by Newton's method.
///
/// The direction solves K d = r. If K is not positive definite, conjugate gradients stop at the first
/// direction of negative curvature, and Cholesky factorises K + t |diag K| with t = 1e-3, 1e-2, ... instead.
/// The step along it is cut until the energy falls (or the slope, near round-off). So every iteration
/// descends, and the result is a stable equilibrium.
///
/// # Errors
/// [`FemError::NotConverged`] with the residual reached, where `x` is the best state; a problem's own error
/// if its forces are not defined at the start; [`FemError::Parameter`] and [`FemError::WrongLength`] for
/// bad options or a bad start; [`FemError::FeatureMissing`].
pub fn newton<P: StaticProblem + ?Sized>(
    problem: &mut P,
    x: &mut [f64],
    options: &NewtonOptions,
) -> Result<NewtonReport, FemError> {
    Newton::new(options.clone())?.solve(problem, x)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Chain, Function, Membrane, solvers};
    use super::*;

    fn options(linear: Linear) -> NewtonOptions {
        NewtonOptions {
            linear,
            tolerance: 1e-12,
            ..NewtonOptions::default()
        }
    }

    #[test]
    fn a_linear_membrane_takes_its_closed_form() {
        for linear in solvers() {
            let mut problem = Membrane::new(20);
            let mut x = vec![0.0; problem.len()];
            let report = newton(&mut problem, &mut x, &options(linear)).unwrap();
            assert!(
                problem.error(&x) < 1e-12,
                "{linear:?}: {}",
                problem.error(&x)
            );
            if linear == Linear::Cholesky {
                assert!(report.iterations <= 2, "{report:?}");
            }
        }
    }

    #[test]
    fn convergence_is_quadratic() {
        for linear in solvers() {
            let mut problem = Chain::hanging(40);
            let mut x = problem.start();
            let report = newton(&mut problem, &mut x, &options(linear)).unwrap();
            // Once below 1e-2, the number of digits at least nearly doubles, down to round-off.
            let r = &report.residuals;
            let pairs: Vec<_> = r
                .windows(2)
                .filter(|w| w[0] < 1e-3 && w[0] > 1e-7)
                .collect();
            assert!(!pairs.is_empty(), "{linear:?} {r:?}");
            for w in pairs {
                assert!(
                    w[1] < w[0].powf(1.7) * 10.0 || w[1] < 1e-11,
                    "{linear:?} {r:?}"
                );
            }
            assert!(problem.sag_error(&x) < 1e-9, "{}", problem.sag_error(&x));
        }
    }

    #[test]
    fn an_indefinite_tangent_leads_downhill_to_a_minimum() {
        // E = (x^2 - 1)^2 + 0.1 x: a maximum near 0, minima near -1 and 1.
        let e = |x: f64| (x * x - 1.0).powi(2) + 0.1 * x;
        let de = |x: f64| 4.0 * x * (x * x - 1.0) + 0.1;
        for linear in solvers() {
            let mut problem = Function::new(e, de, |x| 12.0 * x * x - 4.0);
            let mut x = [0.03];
            let report = newton(&mut problem, &mut x, &options(linear)).unwrap();
            assert!(report.modified >= 1, "{linear:?} {report:?}");
            assert!(de(x[0]).abs() < 1e-12 && 12.0 * x[0] * x[0] - 4.0 > 0.0);
            assert!(report.energy < e(0.03));
        }
    }

    #[test]
    fn a_load_without_support_is_told_apart_from_rest() {
        // A constant force and no stiffness: there is no equilibrium.
        for linear in solvers() {
            let mut problem = Function::new(|x| -x, |_| -1.0, |_| 0.0);
            let mut x = [0.0];
            let error = newton(&mut problem, &mut x, &options(linear)).unwrap_err();
            assert!(
                matches!(error, FemError::NotConverged { residual, .. } if residual == 1.0),
                "{linear:?}: {error}"
            );
            assert!(x[0].is_finite());
        }
    }

    #[test]
    fn forces_that_are_not_finite_are_an_error_by_name() {
        let mut problem = Function::new(|_| f64::NAN, |_| f64::NAN, |_| 1.0);
        let error = newton(&mut problem, &mut [0.0], &NewtonOptions::default()).unwrap_err();
        assert!(error.to_string().contains("finite"), "{error}");
    }

    #[test]
    fn a_tolerance_below_round_off_is_given_up_soon() {
        let mut problem = Chain::hanging(40);
        let mut x = problem.start();
        let strict = NewtonOptions {
            tolerance: 1e-20,
            ..NewtonOptions::default()
        };
        match newton(&mut problem, &mut x, &strict) {
            Err(FemError::NotConverged {
                iterations,
                residual,
                advice,
                ..
            }) => {
                assert!(
                    iterations < 30 && residual < 1e-11,
                    "{iterations} {residual}"
                );
                assert!(advice.contains("round-off"), "{advice}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn nothing_to_do_is_done_at_once() {
        let mut problem = Function::new(|x| x * x, |x| 2.0 * x, |_| 2.0);
        let report = newton(&mut problem, &mut [0.0], &NewtonOptions::default()).unwrap();
        assert_eq!((report.iterations, report.residual()), (0, 0.0));
    }

    #[test]
    fn bad_options_and_starts_are_refused() {
        let mut problem = Function::new(|x| x * x, |x| 2.0 * x, |_| 2.0);
        for tolerance in [0.0, -1.0, f64::NAN, 1.0] {
            let options = NewtonOptions {
                tolerance,
                ..NewtonOptions::default()
            };
            assert!(newton(&mut problem, &mut [0.0], &options).is_err());
        }
        let usual = NewtonOptions::default();
        assert!(matches!(
            newton(&mut problem, &mut [0.0, 1.0], &usual),
            Err(FemError::WrongLength {
                given: 2,
                wanted: 1,
                ..
            })
        ));
        assert!(newton(&mut problem, &mut [f64::NAN], &usual).is_err());
    }

    #[cfg(not(feature = "implicit"))]
    #[test]
    fn a_missing_feature_is_named() {
        let error = Newton::new(options(Linear::Cholesky)).unwrap_err();
        assert!(error.to_string().contains("implicit"), "{error}");
    }
}
