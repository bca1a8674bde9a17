//! Two sides in contact, and how they move.

use super::near::Near;
use super::operand::Operand;
use super::record::NodalState;
use super::turning::Turning;
use crate::contact::{BodyId, Partner};
use crate::law::ContactParameters;
use crate::motion::Motion;
use crate::rocking::Turn;
use crate::spring_load::SpringLoad;

/// Motion of one side of a pair.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Mover<'a> {
    Nodes(NodalState<'a>),
    Rigid(&'a Motion),
}

/// A pair of bodies in contact.
pub(crate) struct Pair<'a> {
    pub ids: (Partner, BodyId),
    pub sides: [Operand<'a>; 2],
    pub movers: [Mover<'a>; 2],
    /// Slowest elastic oscillations of the deformable sides, rad/s; 0 if not known.
    pub frequencies: [f64; 2],
    /// Rotation as a whole of the deformable sides.
    pub turnings: [Option<&'a Turning>; 2],
    pub near: &'a Near,
    pub law: &'a ContactParameters,
    /// Initial friction of the springs.
    pub begins: Option<SpringLoad>,
    /// Time since the last evaluation, s.
    pub dt: f64,
}

impl Pair<'_> {
    /// Whether both sides are one body. Nothing in such a contact acts on the body as a whole.
    pub fn is_own(&self) -> bool {
        self.ids.0 == Partner::Body(self.ids.1)
    }

    /// Angular velocities of both sides, and their inverse inertia; `None` if a side cannot turn, or if both are one body.
    pub fn turn(&self) -> Option<Turn> {
        if self.is_own() {
            return None;
        }
        let side = |side: usize| match &self.movers[side] {
            Mover::Rigid(motion) => Some((motion.angular_velocity, motion.inverse_inertia)),
            Mover::Nodes(..) => self.turnings[side].map(|t| (t.rate, t.mobility)),
        };
        let ((of_a, w_a), (of_b, w_b)) = (side(0)?, side(1)?);
        Some(Turn {
            rates: [of_a, of_b],
            mobilities: [w_a, w_b],
        })
    }
}
