//! What a deformable body meets.

use crate::contact::{BodyId, Partner};
use serde::{Deserialize, Serialize};

/// Side A of a pair with a deformable body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub(crate) enum Side {
    /// Another one, of lower number, or the same: a body that touches itself.
    Deformable(BodyId),
    /// A rigid body.
    Rigid(BodyId),
    /// A wall.
    Wall(u32),
}

impl Side {
    /// The number of a deformable body.
    pub fn deformable(self) -> Option<BodyId> {
        match self {
            Self::Deformable(body) => Some(body),
            Self::Rigid(_) | Self::Wall(_) => None,
        }
    }
}

impl From<Side> for Partner {
    fn from(side: Side) -> Self {
        match side {
            Side::Deformable(body) | Side::Rigid(body) => Self::Body(body),
            Side::Wall(wall) => Self::Wall(wall),
        }
    }
}
