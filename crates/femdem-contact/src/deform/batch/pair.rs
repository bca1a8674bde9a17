//! A pair with a deformable body.

use crate::deform::near::Candidates;
use crate::deform::outcome::Outcome;
use crate::deform::record::DeformableTotals;
use crate::deform::side::Side;
use crate::spring_load::SpringLoad;
use crate::walls::LocalSolid;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A body or wall A, and a deformable body B.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SoftPair {
    pub a: Side,
    pub b: u32,
    /// Whether B comes first in the evaluation. The springs of friction belong to the skin of the side that comes second, one for each
    /// triangle. That has to be the finer skin: a spring of a large triangle would act on a single small one of the other
    /// skin, and shake its nodes instead of holding the body. So it does not matter either which body was added first.
    pub swapped: bool,
    pub candidates: Candidates,
    /// In periodic space: which image of A it is that B meets.
    pub image: [i32; 3],
    /// From the centre of that image to the centre of B, m, where they touched last.
    pub branch: Vector3,
    /// The part of a wall of planes near the body.
    pub local: LocalSolid,
    pub outcome: Outcome,
    /// Inverted tetrahedron in the last evaluation: the side and the index.
    pub failure: Option<(u32, u32)>,
    pub counts: [u32; 2],
    /// Initial friction of its springs.
    pub begins: Option<SpringLoad>,
}

impl SoftPair {
    pub fn new((a, b): (Side, u32), swapped: bool) -> Self {
        Self {
            a,
            b,
            swapped,
            candidates: Candidates::default(),
            image: [0; 3],
            branch: Vector3::zeros(),
            local: LocalSolid::default(),
            outcome: Outcome::default(),
            failure: None,
            counts: [0; 2],
            begins: None,
        }
    }

    /// A pair that is evaluated in this order of its sides.
    pub fn between(first: Side, second: u32) -> Self {
        match first {
            Side::Deformable(i) if i > second => Self::new((Side::Deformable(second), i), true),
            _ => Self::new((first, second), false),
        }
    }

    pub fn key(&self) -> (Side, u32) {
        (self.a, self.b)
    }

    /// The sides in the order of the evaluation.
    pub fn sides(&self) -> (Side, u32) {
        match self.a {
            Side::Deformable(i) if self.swapped => (Side::Deformable(self.b), i),
            _ => (self.a, self.b),
        }
    }

    /// Whether it is a body with itself.
    pub fn is_own(&self) -> bool {
        self.a == Side::Deformable(self.b)
    }

    /// Whether anything is near: two bodies by being on the list, parts of one body by their own.
    pub fn is_near(&self) -> bool {
        !self.is_own() || self.candidates.near().is_some()
    }

    /// Its deformable bodies; one that meets itself twice.
    pub fn deformables(&self) -> impl Iterator<Item = u32> + use<> {
        self.a.deformable().into_iter().chain([self.b])
    }

    pub fn totals(&self) -> DeformableTotals {
        DeformableTotals {
            pairs: usize::from(self.is_near()),
            candidates: self.counts[0] as usize,
            pieces: self.counts[1] as usize,
            ..self.outcome.totals
        }
    }
}
