//! The bodies of a simulation.

use femdem_contact::BodyId;
use femdem_mesh::Pose;
use serde::{Deserialize, Serialize};

/// A body of a simulation. It stays among the members, with its number, when it has left at a sink.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Its name; copies of a body carry a number from 1, bodies of a source their number among the members.
    pub name: String,
    /// Its index in the world; [`GONE`](Self::GONE) once it has left.
    pub id: BodyId,
    /// Its initial pose: coordinates of its shape -> world.
    pub placed: Pose,
    /// Of a fragment that has become a body: the number among the members of the body that broke first.
    pub of: Option<u32>,
}

impl Member {
    /// What no body has for its index in the world.
    pub const GONE: BodyId = BodyId::MAX;

    /// A fragment, of index `id` in the world, of the member of number `whole`.
    pub(super) fn fragment(members: &[Self], whole: usize, id: BodyId) -> Self {
        let first = members[whole].of.unwrap_or(whole as u32);
        let Self { name, placed, .. } = &members[first as usize];
        Self {
            name: format!("{name} fragment {}", members.len()),
            id,
            placed: *placed,
            of: Some(first),
        }
    }
}
