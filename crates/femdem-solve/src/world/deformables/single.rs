//! Static equilibrium of single bodies by Newton's method, before [`World::relax`].
//!
//! A body that supports hold and that touches nothing is a problem of its own. Newton's method solves it in a few
//! iterations, where dynamic relaxation needs some periods of its slowest oscillation, thousands of steps for slender bodies.
//! What comes of it is judged like everything else: a relaxation that follows measures all residuals, and goes on from
//! there if a body now touches something, or if Newton's method failed.

use super::Deformables;
use crate::error::{SolveError, check};
use crate::world::World;
use femdem_contact::{BodyId, ContactBatch};
use femdem_fem::DeformableState;
use femdem_fem::statics::{
    Linear, LoadPath, NewtonOptions, StaticOptions, StaticSolution, solve_static_from,
};
use femdem_mesh::Vector3;

/// Residual over force scale of Newton's method, over the tolerance of the relaxation: the first is of the norm over all nodes,
/// the second of the largest. And the largest one.
const STRICTER: f64 = 0.01;
const LARGEST: f64 = 1e-3;

impl World {
    /// Puts each deformable body that supports hold and that touches nothing where it is in equilibrium, at rest, by Newton's
    /// method; returns the number of bodies so moved. One for which the method fails stays where it is. `tolerance` is that of
    /// the [relaxation](Self::relax) that follows, which verifies the result. The change of energy is
    /// [`Ledger::frozen`](crate::Ledger::frozen).
    ///
    /// # Errors
    /// [`SolveError::Parameter`] unless the tolerance is positive and finite, [`SolveError::Ranks`] in a world that is
    /// [shared out](Self::share_out), and those of [`World::step`] for the contacts.
    pub fn solve_single_bodies(&mut self, tolerance: f64) -> Result<u32, SolveError> {
        check(
            "tolerance",
            tolerance,
            tolerance > 0.0,
            "positive and finite",
        )?;
        self.not_shared("solving single bodies")?;
        self.evaluate_if_due()?;
        let (gravity, time) = (self.parameters.gravity, self.time);
        let ids: Vec<BodyId> = self.deformable_ids().collect();
        let mut solved = 0;
        for id in ids {
            let deformables = self.deformables.as_deref();
            let alone =
                deformables.and_then(|d| d.solve_alone(id, &self.batch, &gravity, time, tolerance));
            let Some(DeformableState { x, v, history }) = alone.map(|solution| solution.state)
            else {
                continue;
            };
            let by_hand = self.flows.by_hand;
            if self.put_nodes(id, [&x, &v], Some(history)).is_ok() {
                self.flows.frozen -= self.flows.by_hand - by_hand;
                self.flows.by_hand = by_hand;
                solved += 1;
            }
        }
        Ok(solved)
    }
}

impl Deformables {
    /// The equilibrium of a body under its own loads and supports at time `time` (s); `None` if it is there already, is free,
    /// touches something, or does not converge.
    fn solve_alone(
        &self,
        id: BodyId,
        batch: &ContactBatch,
        gravity: &Vector3,
        time: f64,
        tolerance: f64,
    ) -> Option<StaticSolution> {
        let body = &self.bodies[id as usize];
        if body.boundary.held().next().is_none() || batch.touches(id) {
            return None;
        }
        let model = &self.models[body.model as usize].model;
        let boundary = body.boundary.clone().with_gravity(gravity + body.pull);
        let start = DeformableState {
            x: body.positions.clone(),
            v: vec![Vector3::zeros(); body.positions.len()],
            history: body.history.clone(),
        };
        let options = StaticOptions {
            newton: NewtonOptions {
                tolerance: (STRICTER * tolerance).min(LARGEST),
                linear: Linear::CgAssembled,
                ..NewtonOptions::default()
            },
            time,
            path: LoadPath::InTime,
            max_halvings: 0,
            ..StaticOptions::default()
        };
        // Whatever is wrong, the relaxation meets it too, and says so.
        let solution = solve_static_from(model, &boundary.ok()?, &start, &options).ok()?;
        let mut steps = solution.report.steps.iter();
        let moved = steps.any(|(_, step)| step.iterations > 0);
        moved.then_some(solution)
    }
}
