//! Options of the solution of a body.

use super::{NewtonOptions, RelaxOptions};
use crate::FemError;
use crate::error::check;
use serde::{Deserialize, Serialize};

/// How equilibrium is found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Newton's method: for most bodies.
    Newton(NewtonOptions),
    /// Relaxation: where Newton's method fails, such as with laws whose tangent is not symmetric (flow that
    /// is not associated), since the linear solvers use one triangle only.
    Relax(RelaxOptions),
}

impl Default for Method {
    fn default() -> Self {
        Self::Newton(NewtonOptions::default())
    }
}

/// How loads and weight grow. Driven nodes follow their path in time in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadPath {
    /// Together, in proportion from zero to their values at the end.
    #[default]
    Proportional,
    /// As given by their curves at every time: loading and unloading.
    InTime,
}

/// Options of [`solve_static`](super::solve_static).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StaticOptions {
    /// How each equilibrium is found.
    pub method: Method,
    /// The time of the boundary conditions that is to be reached, s.
    pub time: f64,
    /// How loads grow up to then.
    pub path: LoadPath,
    /// Number of equal steps of loads and driven nodes. A step that fails is halved; after a successful one
    /// the next is longer again. Plasticity needs many, and so do large motions of quadratic elements, which
    /// may fold between their points in a single step.
    pub steps: usize,
    /// Halvings of the step before giving up.
    pub max_halvings: usize,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            method: Method::default(),
            time: 1.0,
            path: LoadPath::default(),
            steps: 1,
            max_halvings: 10,
        }
    }
}

impl StaticOptions {
    /// # Errors
    /// [`FemError::Parameter`].
    pub(super) fn check(&self) -> Result<(), FemError> {
        let steps = self.steps as f64;
        check("steps", steps, steps >= 1.0, "at least 1")?;
        let time = self.time;
        check("time", time, time >= 0.0, "zero or positive, in s")
    }
}
