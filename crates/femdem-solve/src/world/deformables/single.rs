//! Static equilibrium of single bodies by Newton's method: the first part of [`World::relax`].
//!
//! A body that supports hold and that touches nothing is a problem of its own. Newton's method solves it in a few
//! iterations, where dynamic relaxation needs some periods of its slowest oscillation, thousands of steps for slender bodies.
//! What comes of it is judged like everything else: the relaxation that follows measures all residuals, and goes on from
//! there if a body now touches something, or if Newton's method failed.

use super::{DeformableId, Deformables};
use crate::error::SolveError;
use crate::world::World;
use femdem_fem::FemError;
use femdem_fem::statics::{
    Linear, LoadPath, Method, NewtonOptions, StaticOptions, StaticSolution, solve_static_from,
};
use femdem_fem::{Boundary, DeformableState};
use femdem_mesh::Vector3;

/// Residual over force scale of Newton's method, over the tolerance of the relaxation: the first is of the norm over all nodes,
/// the second of the largest.
const STRICTER: f64 = 0.01;

impl World {
    /// Puts each deformable body that is held and touches nothing where it is in equilibrium, at rest, if Newton's method finds
    /// that; returns the number of those. The contacts have to be those of the present positions.
    pub(in crate::world) fn solve_single_bodies(
        &mut self,
        tolerance: f64,
    ) -> Result<u32, SolveError> {
        let (gravity, time) = (self.parameters.gravity, self.time);
        let ids: Vec<DeformableId> = self.deformable_ids().collect();
        let mut solved = 0;
        for id in ids {
            let Some(deformables) = self.deformables.as_deref() else {
                return Ok(solved);
            };
            let Some(solution) = deformables.solve_alone(id, &gravity, time, tolerance)? else {
                continue;
            };
            let DeformableState { x, v, history } = solution.state;
            self.put_nodes(id, [&x, &v], Some(history))?;
            solved += 1;
        }
        Ok(solved)
    }
}

impl Deformables {
    /// The equilibrium of a body under its own loads and supports at time `time` (s); `None` if it is free, touches something,
    /// or does not converge.
    fn solve_alone(
        &self,
        id: DeformableId,
        gravity: &Vector3,
        time: f64,
        tolerance: f64,
    ) -> Result<Option<StaticSolution>, SolveError> {
        let body = &self.bodies[id as usize];
        if body.boundary.held().next().is_none() || self.batch.touches(id) {
            return Ok(None);
        }
        let model = &self.models[body.model as usize].model;
        let boundary: Boundary = body.boundary.clone().with_gravity(gravity + body.pull)?;
        let start = DeformableState {
            x: body.positions.clone(),
            v: vec![Vector3::zeros(); body.positions.len()],
            history: body.history.clone(),
        };
        let options = StaticOptions {
            method: Method::Newton(NewtonOptions {
                tolerance: STRICTER * tolerance,
                linear: Linear::CgAssembled,
                ..NewtonOptions::default()
            }),
            time,
            path: LoadPath::InTime,
            max_halvings: 0,
            ..StaticOptions::default()
        };
        match solve_static_from(model, &boundary, &start, &options) {
            Ok(solution) => Ok(Some(solution)),
            Err(FemError::NotConverged { .. } | FemError::Element(_)) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }
}
