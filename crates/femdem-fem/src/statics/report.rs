//! Result of the solution of a body.

use super::NewtonReport;
use crate::model::DeformableState;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Report of [`solve_static`](super::solve_static).
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StaticReport {
    /// Successful load steps: the fraction of the load at their end, and how they were solved.
    pub steps: Vec<(f64, NewtonReport)>,
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
    /// Positions and history; velocities are zero.
    pub state: DeformableState,
    /// Forces of the supports on the nodes, N; zero for nodes that are free.
    pub reactions: Vec<Vector3>,
    /// Report of the solution.
    pub report: StaticReport,
}
