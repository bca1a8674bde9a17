//! Directions of descent from linear systems K d = r.

use super::cg::{self, CgLimits};
#[cfg(feature = "implicit")]
use super::cholesky::Cholesky;
use super::{Effort, StaticProblem, vector};
use crate::FemError;
use serde::{Deserialize, Serialize};

/// How the linear systems of Newton's method are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Linear {
    /// Conjugate gradients with 3 x 3 diagonal blocks as preconditioner; no matrix is stored. The
    /// number of iterations grows with the mesh's fineness and with the ratio of bulk to shear modulus.
    #[default]
    Cg,
    /// The same with the matrix: about five times faster, for the memory of the matrix, some 1 kB per
    /// unknown with quadratic elements.
    CgAssembled,
    /// Sparse Cholesky factorisation on one thread, fill-reducing order found once. Needs the feature
    /// `implicit`; memory and time grow faster than the mesh (see `records/statics.md`).
    Cholesky,
}

/// A linear solver with its memory.
#[derive(Debug)]
pub(super) enum Solver {
    Cg(cg::Cg),
    #[cfg(feature = "implicit")]
    Cholesky(Box<Cholesky>),
}

impl Solver {
    /// # Errors
    /// [`FemError::FeatureMissing`].
    pub(super) fn new(linear: Linear) -> Result<Self, FemError> {
        match linear {
            Linear::Cg => Ok(Self::Cg(cg::Cg::default())),
            Linear::CgAssembled => Ok(Self::Cg(cg::Cg::assembled())),
            #[cfg(feature = "implicit")]
            Linear::Cholesky => Ok(Self::Cholesky(Box::default())),
            #[cfg(not(feature = "implicit"))]
            Linear::Cholesky => Err(FemError::FeatureMissing {
                what: "the sparse Cholesky factorisation",
                feature: "implicit",
            }),
        }
    }

    /// Writes a direction d with r . d > 0 into `d`; K d = r where the tangent K is positive definite.
    ///
    /// # Errors
    /// Of the problem's tangent.
    pub(super) fn direction<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &[f64],
        r: &[f64],
        limits: CgLimits,
        d: &mut [f64],
    ) -> Result<Effort, FemError> {
        let effort = match self {
            Self::Cg(solver) => solver.direction(problem, x, r, limits, d)?,
            #[cfg(feature = "implicit")]
            Self::Cholesky(solver) => solver.direction(problem, x, r, d)?,
        };
        if vector::all_finite(d) && vector::dot(r, d) > 0.0 {
            return Ok(effort);
        }
        // Only round-off or a degenerate tangent leads here: use the preconditioned force.
        cg::Blocks::of(problem, x)?.apply(r, d);
        Ok(Effort {
            modified: true,
            ..effort
        })
    }
}
