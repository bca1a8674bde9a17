//! Options of the solution of a body.

use super::{NewtonOptions, RelaxOptions};
use crate::SolveError;
use crate::error::check;
use serde::{Deserialize, Serialize};

/// How equilibrium is found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Newton's method: for most bodies.
    Newton(NewtonOptions),
    /// Relaxation: where Newton's method finds no way, such as with laws whose tangent is not symmetric
    /// (flow that is not associated), of which the linear solvers see one triangle only.
    Relax(RelaxOptions),
}

impl Default for Method {
    fn default() -> Self {
        Self::Newton(NewtonOptions::default())
    }
}

/// How loads and weight grow. Driven nodes are on their path in time in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadPath {
    /// Together, from zero to what they are at the end.
    #[default]
    Proportional,
    /// As their curves say at every moment: loading and unloading.
    InTime,
}

/// Options of [`solve_static`](super::solve_static).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StaticOptions {
    /// How each equilibrium is found.
    pub method: Method,
    /// The moment of the boundary conditions that is to be reached, s.
    pub time: f64,
    /// How loads grow on the way there.
    pub path: LoadPath,
    /// Equal steps in which loads and driven nodes go there. A step that fails is halved; after one
    /// that went well the next is longer again. Plasticity wants many, and so do large motions of
    /// quadratic elements, which in one step may fold between their points.
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
    /// [`SolveError::Parameter`].
    pub(super) fn check(&self) -> Result<(), SolveError> {
        let steps = self.steps as f64;
        check("steps", steps, steps >= 1.0, "at least 1")?;
        let time = self.time;
        check("time", time, time >= 0.0, "zero or positive, in s")
    }
}
