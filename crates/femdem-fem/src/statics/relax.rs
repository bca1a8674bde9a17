//! Dynamic relaxation with kinetic damping.
//!
//! The unknowns move under their forces without friction. Whenever their kinetic energy has passed a maximum,
//! they are stopped, moved back by half of the last step (approximately to the maximum), and released again
//! (Cundall 1976; Barnes, Comput. Struct. 30, 685 (1988)). Finally they are at rest.

use super::line_search::Point;
use super::{StaticProblem, check_start, judge, vector};
use crate::FemError;
use crate::error::check;
use serde::{Deserialize, Serialize};

/// Largest fraction of the stable step at which kinetic damping was found stable.
const LARGEST_SAFETY: f64 = 0.5;
/// Number of times that a step found too large is halved before giving up.
const MOST_CUTS: usize = 12;

/// The masses used by [`relax`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RelaxMasses {
    /// Those of the problem, with its stable step.
    #[default]
    Problem,
    /// A quarter of the row sums of |K|, renewed at every stop, for which 1 s is a stable step (the circles
    /// of Gershgorin). Small and stiff elements then no longer determine the step of all.
    Stiffness,
}

/// Options of [`relax`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RelaxOptions {
    /// Residual over force scale at which the state counts as equilibrium.
    pub tolerance: f64,
    /// Steps after which to give up.
    pub max_steps: usize,
    /// Step over the stable step, at most 0.5: kinetic damping is unstable at 0.6.
    pub safety: f64,
    /// The masses.
    pub masses: RelaxMasses,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        Self {
            tolerance: 1e-4,
            max_steps: 100_000,
            safety: LARGEST_SAFETY,
            masses: RelaxMasses::default(),
        }
    }
}

impl RelaxOptions {
    /// # Errors
    /// [`FemError::Parameter`].
    fn check(&self) -> Result<(), FemError> {
        let (t, s, n) = (self.tolerance, self.safety, self.max_steps as f64);
        check("tolerance", t, t > 0.0 && t < 1.0, "above 0 and below 1")?;
        let in_range = s > 0.0 && s <= LARGEST_SAFETY;
        check("safety", s, in_range, "above 0 and at most 0.5")?;
        check("max_steps", n, n >= 1.0, "at least 1")
    }
}

/// Report of [`relax`].
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RelaxReport {
    /// Steps taken.
    pub steps: usize,
    /// Times that all motion was stopped at a maximum of the kinetic energy.
    pub stops: usize,
    /// Times that the step was halved since it was too large.
    pub cuts: usize,
    /// Residual over force scale at the end.
    pub residual: f64,
    /// Energy at the end, J.
    pub energy: f64,
}

/// The motion since the last stop.
struct Motion {
    /// The point where it began.
    origin: Point,
    at: Point,
    velocity: Vec<f64>,
    masses: Vec<f64>,
    step: f64,
    /// Kinetic energy after the last kick, and the largest since the stop, J.
    kinetic: f64,
    largest: f64,
}

/// Moves `x` to an equilibrium by dynamic relaxation with kinetic damping.
///
/// # Errors
/// [`FemError::NotConverged`] with the residual reached, where `x` is the state of the last stop; a
/// problem's own error if its forces are not defined at the start or for any step size;
/// [`FemError::Parameter`] and [`FemError::WrongLength`] for bad options or a bad start.
pub fn relax<P: StaticProblem + ?Sized>(
    problem: &mut P,
    x: &mut [f64],
    options: &RelaxOptions,
) -> Result<RelaxReport, FemError> {
    options.check()?;
    check_start(problem, x)?;
    let mut motion = Motion::start(problem, x)?;
    let mut report = RelaxReport::default();
    let end = motion.run(problem, options, &mut report);
    let last = if end.is_ok() {
        &motion.at
    } else {
        &motion.origin
    };
    x.copy_from_slice(&last.x);
    report.energy = last.energy;
    end.map(|()| report)
}

impl Motion {
    fn start<P: StaticProblem + ?Sized>(problem: &mut P, x: &[f64]) -> Result<Self, FemError> {
        let mut at = Point {
            x: x.to_vec(),
            ..Point::default()
        };
        at.evaluate(problem)?;
        Ok(Self {
            origin: at.clone(),
            at,
            velocity: vec![0.0; x.len()],
            masses: Vec::new(),
            step: 0.0,
            kinetic: 0.0,
            largest: 0.0,
        })
    }

    fn run<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        options: &RelaxOptions,
        report: &mut RelaxReport,
    ) -> Result<(), FemError> {
        // Factor of all halvings so far; it is kept.
        let mut slower = 1.0;
        let mut is_rest = true;
        loop {
            let (residual, is_done) = judge(problem, &self.at.r, options.tolerance);
            report.residual = residual;
            if is_done {
                return Ok(());
            }
            if report.steps >= options.max_steps {
                return Err(failure(options, report, "raise max_steps or the tolerance"));
            }
            if is_rest {
                self.renew(problem, options, slower)?;
            }
            report.steps += 1;
            let passed_maximum = self.kick(is_rest);
            is_rest = passed_maximum;
            if passed_maximum {
                self.step_back();
                report.stops += 1;
            } else {
                vector::add_scaled(&mut self.at.x, self.step, &self.velocity);
            }
            match self.evaluate(problem) {
                Ok(()) if passed_maximum => self.origin.clone_from(&self.at),
                Ok(()) => {}
                Err(error) => {
                    report.cuts += 1;
                    if report.cuts > MOST_CUTS {
                        return Err(error.unwrap_or_else(|| {
                            failure(
                                options,
                                report,
                                "the motion gains energy at any step: the \
                                     stable step or the energy of the problem is wrong",
                            )
                        }));
                    }
                    slower *= 0.5;
                    self.at.clone_from(&self.origin);
                    self.velocity.fill(0.0);
                    is_rest = true;
                }
            }
        }
    }

    /// Masses and step for the motion from a stop.
    fn renew<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        options: &RelaxOptions,
        slower: f64,
    ) -> Result<(), FemError> {
        let stable = match options.masses {
            RelaxMasses::Problem => {
                self.masses.clear();
                self.masses.extend_from_slice(problem.masses());
                problem.stable_step(&self.at.x)?
            }
            RelaxMasses::Stiffness => {
                self.masses = quarter_row_sums(problem, &self.at.x)?;
                1.0
            }
        };
        check("the stable step", stable, stable > 0.0, "positive")?;
        let bad = self
            .masses
            .iter()
            .copied()
            .find(|&m| !(m.is_finite() && m > 0.0));
        if let Some(mass) = bad {
            check("a mass of the static problem", mass, false, "positive")?;
        }
        self.step = options.safety * stable * slower;
        (self.kinetic, self.largest) = (0.0, 0.0);
        Ok(())
    }

    /// Accelerates for a step, or half a step from rest. Returns whether the kinetic energy has fallen, in
    /// which case the velocity is unchanged.
    fn kick(&mut self, is_rest: bool) -> bool {
        let time = if is_rest { 0.5 * self.step } else { self.step };
        for ((v, r), m) in self.velocity.iter_mut().zip(&self.at.r).zip(&self.masses) {
            *v += time * r / m;
        }
        let squares = self
            .velocity
            .iter()
            .zip(&self.masses)
            .map(|(v, m)| m * v * v);
        let kinetic = 0.5 * squares.sum::<f64>();
        // NaN counts as fallen; the evaluation after it then finds the cause.
        let fallen = kinetic < self.kinetic || kinetic.is_nan();
        if fallen {
            for ((v, r), m) in self.velocity.iter_mut().zip(&self.at.r).zip(&self.masses) {
                *v -= time * r / m;
            }
        }
        self.kinetic = kinetic;
        self.largest = self.largest.max(kinetic);
        fallen
    }

    /// Moves back by half of the last step, and stops.
    fn step_back(&mut self) {
        vector::add_scaled(&mut self.at.x, -0.5 * self.step, &self.velocity);
        self.velocity.fill(0.0);
    }

    /// # Errors
    /// The problem's error, or `None` if energy was gained, which only a step too large causes.
    fn evaluate<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
    ) -> Result<(), Option<FemError>> {
        self.at.evaluate(problem).map_err(Some)?;
        // At half the stable step, the energy error of the leapfrog is at most (omega dt / 2)^2 = 1/4 of the
        // kinetic energy.
        let rounding = (1e-12 * self.origin.energy.abs()).max(problem.noise().energy);
        let slack = 0.5 * self.largest + rounding;
        if problem.has_energy() && self.at.energy > self.origin.energy + slack {
            return Err(None);
        }
        Ok(())
    }
}

/// Masses for which 1 s is a stable step: row sums of |K| bound the eigenvalues of M^-1 K by 4.
fn quarter_row_sums<P: StaticProblem + ?Sized>(
    problem: &mut P,
    x: &[f64],
) -> Result<Vec<f64>, FemError> {
    // Repeated entries may cancel: the sum of their magnitudes is on the safe side.
    let mut masses = vec![0.0; problem.len()];
    problem.tangent(x, &mut |i, _, value| {
        if let Some(mass) = masses.get_mut(i as usize) {
            *mass += 0.25 * value.abs();
        }
    })?;
    // An unknown without stiffness gets the smallest of the other masses.
    let least = masses
        .iter()
        .copied()
        .filter(|&m| m > 0.0)
        .fold(f64::INFINITY, f64::min);
    let least = if least.is_finite() { least } else { 1.0 };
    for mass in &mut masses {
        *mass = mass.max(least);
    }
    Ok(masses)
}

fn failure(options: &RelaxOptions, report: &RelaxReport, advice: &str) -> FemError {
    FemError::NotConverged {
        method: "dynamic relaxation",
        iterations: report.steps,
        residual: report.residual,
        tolerance: options.tolerance,
        advice: advice.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Chain, Function, Membrane};
    use super::*;

    fn options(masses: RelaxMasses) -> RelaxOptions {
        RelaxOptions {
            tolerance: 1e-9,
            masses,
            ..RelaxOptions::default()
        }
    }

    #[test]
    fn a_membrane_and_a_hanging_chain_come_to_their_closed_forms() {
        for masses in [RelaxMasses::Problem, RelaxMasses::Stiffness] {
            let mut membrane = Membrane::new(20);
            let mut x = vec![0.0; membrane.len()];
            let report = relax(&mut membrane, &mut x, &options(masses)).unwrap();
            assert!(
                membrane.error(&x) < 1e-8,
                "{masses:?} {}",
                membrane.error(&x)
            );
            assert!(report.stops > 2 && report.cuts == 0, "{report:?}");

            let mut chain = Chain::hanging(20);
            let mut x = chain.start();
            relax(&mut chain, &mut x, &options(masses)).unwrap();
            assert!(
                chain.sag_error(&x) < 1e-7,
                "{masses:?} {}",
                chain.sag_error(&x)
            );
        }
    }

    #[test]
    fn light_unknowns_do_not_set_the_pace_with_masses_from_the_stiffness() {
        let mut chain = Chain::hanging(20);
        chain.lighten(7, 1e-4);
        let steps = [RelaxMasses::Stiffness, RelaxMasses::Problem].map(|masses| {
            let mut x = chain.start();
            let options = RelaxOptions {
                tolerance: 1e-6,
                ..options(masses)
            };
            relax(&mut chain, &mut x, &options).unwrap().steps
        });
        assert!(5 * steps[0] < steps[1], "{steps:?}");
    }

    #[test]
    fn a_wrong_stable_step_is_noticed_and_cut() {
        // The problem claims 7 times its stable step.
        let mut problem = Function::new(|x| 50.0 * x * x, |x| 100.0 * x, |_| 100.0 / 49.0);
        let mut x = [1.0];
        let report = relax(&mut problem, &mut x, &options(RelaxMasses::Problem)).unwrap();
        assert!(report.cuts >= 1 && x[0].abs() < 1e-9, "{report:?} {x:?}");
    }

    #[test]
    fn states_without_forces_are_stepped_back_from() {
        // E = x - 0.01 ln x: from afar the motion overshoots zero.
        let mut problem = Function::new(
            |x| x - 0.01 * x.ln(),
            |x| 1.0 - 0.01 / x,
            |x| 0.01 * x.powi(-2),
        );
        let mut x = [3.0];
        relax(&mut problem, &mut x, &options(RelaxMasses::Problem)).unwrap();
        assert!((x[0] - 0.01).abs() < 1e-9, "{x:?}");
    }

    #[test]
    fn running_out_of_steps_is_an_error_that_keeps_the_state() {
        let mut membrane = Membrane::new(20);
        let mut x = vec![0.0; membrane.len()];
        let few = RelaxOptions {
            max_steps: 200,
            ..options(RelaxMasses::Problem)
        };
        let error = relax(&mut membrane, &mut x, &few).unwrap_err();
        assert!(error.to_string().contains("max_steps"), "{error}");
        assert!(membrane.error(&x) < 1.0 && x.iter().any(|&u| u != 0.0));
    }

    #[test]
    fn options_out_of_range_are_refused() {
        let mut membrane = Membrane::new(4);
        let mut x = vec![0.0; membrane.len()];
        for safety in [0.0, 0.51, f64::NAN] {
            let bad = RelaxOptions {
                safety,
                ..RelaxOptions::default()
            };
            assert!(relax(&mut membrane, &mut x, &bad).is_err());
        }
    }
}
