//! Bodies brought to rest under loads that grow from zero.

use super::body::{BodyProblem, flat, unflatten};
use super::loading::Loading;
use super::{Newton, NewtonOptions, NewtonReport, RelaxOptions, RelaxReport, StaticProblem, relax};
use crate::SolveError;
use crate::deformable::DeformableModel;
use crate::error::check;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// How equilibrium is found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Newton's method: for most bodies.
    Newton(NewtonOptions),
    /// Relaxation: for bodies that buckle, or laws whose tangent is not symmetric.
    Relax(RelaxOptions),
}

impl Default for Method {
    fn default() -> Self {
        Self::Newton(NewtonOptions::default())
    }
}

/// Options of [`solve_static`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StaticOptions {
    /// How each equilibrium is found.
    pub method: Method,
    /// Equal steps in which loads and prescribed motions are applied. A step that fails is halved;
    /// after one that went well the next is longer again. Plasticity wants many.
    pub steps: usize,
    /// Halvings of the step before giving up.
    pub max_halvings: usize,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            method: Method::default(),
            steps: 1,
            max_halvings: 10,
        }
    }
}

/// How a load step was solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepReport {
    /// By Newton's method.
    Newton(NewtonReport),
    /// By relaxation.
    Relax(RelaxReport),
}

impl StepReport {
    /// Residual over force scale at the end.
    #[must_use]
    pub fn residual(&self) -> f64 {
        match self {
            Self::Newton(report) => report.residual(),
            Self::Relax(report) => report.residual,
        }
    }
}

/// What [`solve_static`] did.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StaticReport {
    /// Load steps that went well: the part of the load at their end, and how they were solved.
    pub steps: Vec<(f64, StepReport)>,
    /// Load steps that failed and were halved.
    pub failed: usize,
}

impl StaticReport {
    /// Residual over force scale at the end.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.steps.last().map_or(0.0, |(_, step)| step.residual())
    }
}

/// A body at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticSolution {
    /// Positions of the model's nodes, m.
    pub positions: Vec<Vector3>,
    /// History of the integration points.
    pub history: Vec<f64>,
    /// Forces of the supports on the nodes, N; zero for nodes that are free.
    pub reactions: Vec<Vector3>,
    /// What was done.
    pub report: StaticReport,
}

/// A body on its way through the load steps.
struct March<'a> {
    problem: BodyProblem<'a>,
    loading: &'a Loading,
    method: Solver,
    x: Vec<f64>,
    report: StaticReport,
}

enum Solver {
    Newton(Newton),
    Relax(RelaxOptions),
}

/// The equilibrium of a body, from its reference state, under loads and prescribed motions that grow
/// together from zero to what `loading` says.
///
/// Free rigid motion is not removed: supports must hold the body (relaxation alone stands a free body
/// under balanced loads).
///
/// # Errors
/// [`SolveError::NotConverged`] or the body's [`SolveError::Element`] for the step that failed however
/// small it was made; [`SolveError::Parameter`] for options out of range; an error of the loading.
pub fn solve_static(
    model: &DeformableModel,
    loading: &Loading,
    options: &StaticOptions,
) -> Result<StaticSolution, SolveError> {
    let steps = options.steps as f64;
    check("steps", steps, steps >= 1.0, "at least 1")?;
    let method = match &options.method {
        Method::Newton(newton) => Solver::Newton(Newton::new(newton.clone())?),
        Method::Relax(relax) => Solver::Relax(relax.clone()),
    };
    loading.check(model)?;
    let mut march = March {
        problem: BodyProblem::new(model, loading.held.clone())?,
        loading,
        method,
        x: flat(model.nodes()),
        report: StaticReport::default(),
    };
    march.run(1.0 / steps, options.max_halvings)?;
    let mut positions = model.nodes().to_vec();
    unflatten(&march.x, &mut positions);
    Ok(StaticSolution {
        positions,
        history: march.problem.history().to_vec(),
        reactions: march.problem.reactions(),
        report: march.report,
    })
}

impl March<'_> {
    fn run(&mut self, longest: f64, max_halvings: usize) -> Result<(), SolveError> {
        let (mut done, mut step) = (0.0, longest);
        while done < 1.0 {
            // The last step ends at 1 exactly, and no sliver is left before it.
            let next = if done + 1.001 * step >= 1.0 {
                1.0
            } else {
                done + step
            };
            match self.advance(done, next) {
                Ok(report) => {
                    self.report.steps.push((next, report));
                    done = next;
                    step = (1.5 * step).min(longest);
                }
                Err(error) => {
                    self.report.failed += 1;
                    step *= 0.5;
                    if step < longest * 0.5_f64.powi(max_halvings.min(60) as i32) {
                        return Err(error);
                    }
                }
            }
        }
        Ok(())
    }

    fn advance(&mut self, from: f64, to: f64) -> Result<StepReport, SolveError> {
        self.problem.set_loads(self.loading.forces_at(to));
        let mut x = self.x.clone();
        let motion = flat(&self.loading.motion_of(to - from));
        if motion.iter().any(|&m| m != 0.0) {
            self.predict(&mut x, &motion)?;
        }
        let report = match &mut self.method {
            Solver::Newton(newton) => StepReport::Newton(newton.solve(&mut self.problem, &mut x)?),
            Solver::Relax(options) => StepReport::Relax(relax(&mut self.problem, &mut x, options)?),
        };
        self.problem.commit(&x)?;
        self.x = x;
        Ok(report)
    }

    /// Moves held coordinates, and with Newton's method the others as the tangent says, so that the
    /// whole body follows and not its outermost elements alone.
    fn predict(&mut self, x: &mut [f64], motion: &[f64]) -> Result<(), SolveError> {
        if let Solver::Newton(newton) = &mut self.method {
            let mut force = vec![0.0; x.len()];
            self.problem.residual(x, &mut force)?;
            let pull = self.problem.pull_of(x, motion)?;
            super::vector::add_scaled(&mut force, -1.0, &pull);
            let follow = newton.predict(&mut self.problem, x, &force)?;
            super::vector::add_scaled(x, 1.0, &follow);
        }
        super::vector::add_scaled(x, 1.0, motion);
        Ok(())
    }
}
