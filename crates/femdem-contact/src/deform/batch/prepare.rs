//! Data of a body that the contacts of an update need.

use super::body::{GRAIN, SoftBody};
use super::context::Context;
use super::each::on_each;
use super::state::Sleep;
use crate::deform::turning::Turning;

/// Data of a body that the contacts of an update need.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Wanted {
    /// Its tree, up to date.
    pub tree: bool,
    /// Its rotation as a whole.
    pub turning: bool,
}

/// Updates the data that is needed of the bodies.
pub(crate) fn prepare(bodies: &mut [SoftBody], wanted: &[Wanted], context: &Context) {
    on_each(bodies, GRAIN, |i, body| {
        let wanted = wanted[i];
        if wanted.tree
            && let Some(operand) = context.soft(i as u32, body)
        {
            body.refit(&operand);
        }
        // Its pairs at rest still have moments against rocking, whose distribution needs it.
        if body.sleep == Sleep::Frozen && !wanted.turning {
            return;
        }
        let before = body.turning.take();
        let shape = context.shapes.get(body.shape as usize);
        if wanted.turning
            && shape.is_some_and(|shape| !shape.is_in_pieces())
            && let Some(state) = context.states.get(i)
        {
            body.turning = Turning::new(state, before);
        }
    });
}
