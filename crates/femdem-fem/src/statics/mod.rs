//! Static equilibrium by Newton's method, for any problem with forces and a tangent.
//!
//! A [`StaticProblem`] is a vector of unknowns x (positions of free nodes, m) with a force on each of them.
//! [`newton`] finds a state in which all forces vanish, in a few expensive iterations with quadratic convergence. Its linear
//! systems are solved by conjugate gradients without a matrix ([`Linear::Cg`]) or, with the feature
//! `implicit`, by a sparse Cholesky factorisation ([`Linear::Cholesky`]). Bodies in contact are brought to rest by
//! `femdem_solve::World::relax`, which needs forces only.
//!
//! It runs on one thread in a fixed order, so that results are the same bits everywhere, and stops with
//! [`FemError::NotConverged`] rather than return a state that is not at rest.
//!
//! ```
//! use femdem_fem::FemError;
//! use femdem_fem::statics::{NewtonOptions, StaticProblem, newton};
//!
//! /// A weight of 1 N on a spring whose force is k (u + 100 u^3), k = 10 N/m.
//! struct Spring;
//! impl StaticProblem for Spring {
//!     fn len(&self) -> usize { 1 }
//!     fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<f64, FemError> {
//!         r[0] = 1.0 - 10.0 * (x[0] + 100.0 * x[0].powi(3));
//!         Ok(10.0 * (x[0].powi(2) / 2.0 + 25.0 * x[0].powi(4)) - x[0])
//!     }
//!     fn force_scale(&self) -> f64 { 1.0 }
//!     fn tangent_apply(&mut self, x: &[f64], dx: &[f64], out: &mut [f64]) -> Result<(), FemError> {
//!         out[0] = 10.0 * (1.0 + 300.0 * x[0].powi(2)) * dx[0];
//!         Ok(())
//!     }
//!     fn tangent(&mut self, x: &[f64], entry: &mut dyn FnMut(u32, u32, f64)) -> Result<(), FemError> {
//!         entry(0, 0, 10.0 * (1.0 + 300.0 * x[0].powi(2)));
//!         Ok(())
//!     }
//! }
//!
//! let mut x = [0.0];
//! let report = newton(&mut Spring, &mut x, &NewtonOptions::default())?;
//! assert!((x[0] + 100.0 * x[0].powi(3) - 0.1).abs() < 1e-10 && report.iterations < 8);
//! # Ok::<(), FemError>(())
//! ```

mod body;
mod cg;
#[cfg(feature = "implicit")]
mod cholesky;
#[cfg(feature = "implicit")]
mod factor;
mod line_search;
mod linear;
mod newton;
mod options;
mod report;
mod solve;
mod sparse;
#[cfg(test)]
mod testing;
mod vector;

#[cfg(feature = "implicit")]
pub(crate) use {body::BodyProblem, factor::Factor, sparse::LowerTriangle};

pub use linear::Linear;
pub use newton::{Newton, NewtonOptions, NewtonReport, newton};
pub use options::{LoadPath, StaticOptions};
pub use report::{StaticReport, StaticSolution};
pub use solve::{solve_static, solve_static_from};

use crate::FemError;

/// Unknowns and the forces on them: three for each free node of a body, or those of any other system that is
/// at rest when its forces vanish.
///
/// # Errors
/// Every method may refuse a state in which the forces are not defined, such as one with an inverted element.
/// The solvers then take a smaller step, and return the error only if that does not help.
pub trait StaticProblem {
    /// Number of unknowns.
    fn len(&self) -> usize;

    /// Whether there are no unknowns.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the force on each unknown into `r`, N, and returns the potential energy, J: r = -dE/dx.
    ///
    /// # Errors
    /// See the trait.
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<f64, FemError>;

    /// Whether [`residual`](Self::residual) is minus the gradient of the energy it returns. If not (pressure
    /// that follows a surface, friction), the line search uses forces alone.
    fn has_energy(&self) -> bool {
        true
    }

    /// The scale, N, of the Euclidean norm of the residual: such as the norm of loads and reactions at the
    /// point of the last call of [`residual`](Self::residual).
    fn force_scale(&self) -> f64;

    /// Effect of the rounding of `x` alone at the point of the last call of [`residual`](Self::residual).
    /// Smaller residuals count as zero.
    fn noise(&self) -> Noise {
        Noise::default()
    }

    /// Writes K dx into `out`, where K = -dr/dx at `x`, N/m.
    ///
    /// # Errors
    /// See the trait.
    fn tangent_apply(&mut self, x: &[f64], dx: &[f64], out: &mut [f64]) -> Result<(), FemError>;

    /// Calls `entry(row, column, value)` for the entries of K at `x`, both triangles; repeated entries are
    /// summed. The same positions in the same order every time let solvers reuse their work.
    ///
    /// # Errors
    /// See the trait.
    fn tangent(&mut self, x: &[f64], entry: &mut dyn FnMut(u32, u32, f64)) -> Result<(), FemError>;
}

/// Effect of rounding on forces and energy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Norm of a residual, N.
    pub force: f64,
    /// Difference of two energies, J.
    pub energy: f64,
}

/// If rounding is worse than this, relative to the force scale, no equilibrium can be found.
const WORST_ROUNDING: f64 = 1e-3;

/// The norm of `r` over the force scale, and whether it is at most `tolerance` or round-off.
fn judge<P: StaticProblem + ?Sized>(problem: &P, r: &[f64], tolerance: f64) -> (f64, bool) {
    let (norm, scale) = (vector::norm(r), problem.force_scale());
    let relative = if norm == 0.0 {
        0.0
    } else {
        norm / scale.max(f64::MIN_POSITIVE)
    };
    let rounding = problem.noise().force.min(WORST_ROUNDING * scale);
    (relative, relative <= tolerance || norm <= rounding)
}

/// Work done for one direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Effort {
    /// Iterations of conjugate gradients; factorisations otherwise.
    iterations: usize,
    /// The tangent was not positive definite, and the direction is not Newton's.
    modified: bool,
}

/// Returns an error unless `x` has the right length and is finite.
fn check_start<P: StaticProblem + ?Sized>(problem: &P, x: &[f64]) -> Result<(), FemError> {
    if x.len() != problem.len() {
        return Err(FemError::WrongLength {
            what: "values of the unknowns",
            given: x.len(),
            wanted: problem.len(),
        });
    }
    match x.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(FemError::Parameter {
            name: "an unknown at the start",
            value,
            allowed: "a finite number",
        }),
        None => Ok(()),
    }
}
