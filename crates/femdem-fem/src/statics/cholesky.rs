//! Directions from a sparse Cholesky factorisation.
//!
//! The pattern of the factor is computed once for each pattern of the tangent. If a tangent is not positive definite, a multiple of the magnitudes of its
//! diagonal is added (Nocedal and Wright, Numerical Optimization, 2006, alg. 3.3).

use super::factor::Factor;
use super::sparse::LowerTriangle;
use super::{Effort, StaticProblem, vector};
use crate::FemError;
use faer::dyn_stack::MemBuffer;

/// First multiple of the diagonal, and the factor from one try to the next.
const SHIFT: f64 = 1e-3;
const SHIFT_GROWTH: f64 = 10.0;
const MOST_SHIFTS: usize = 8;
/// A solution with a larger relative residual means that the matrix is numerically singular.
const WORST_SOLUTION: f64 = 1e-6;

/// The factorisation and its memory.
#[derive(Default)]
pub(super) struct Cholesky {
    matrix: LowerTriangle,
    factor: Option<(Factor, MemBuffer)>,
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky")
            .field("entries", &self.matrix.values.len())
            .field("factor", &self.factor.as_ref().map(|(factor, _)| factor))
            .finish_non_exhaustive()
    }
}

impl Cholesky {
    /// See [`Solver::direction`](super::linear::Solver::direction); `d` is zero if no shift helped.
    ///
    /// # Errors
    /// Of the problem's tangent; [`FemError::Factorisation`].
    pub(super) fn direction<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &[f64],
        r: &[f64],
        d: &mut [f64],
    ) -> Result<Effort, FemError> {
        if self.matrix.assemble(problem, x)? {
            self.factor = None;
        }
        let mut effort = Effort::default();
        let mut shift = 0.0;
        for _ in 0..=MOST_SHIFTS {
            effort.iterations += 1;
            if self.solve(r, d)? {
                return Ok(effort);
            }
            effort.modified = true;
            let next = if shift == 0.0 {
                SHIFT
            } else {
                shift * SHIFT_GROWTH
            };
            self.add_to_diagonal(next - shift);
            shift = next;
        }
        d.fill(0.0);
        Ok(effort)
    }

    /// Solves with the present matrix; returns whether it is positive definite.
    fn solve(&mut self, r: &[f64], d: &mut [f64]) -> Result<bool, FemError> {
        let matrix = &self.matrix;
        if !vector::all_finite(&matrix.values) {
            return Ok(false);
        }
        let (factor, memory) = match &mut self.factor {
            Some(kept) => kept,
            none => {
                let factor = Factor::of_pattern(matrix)?;
                let memory = factor.memory()?;
                none.insert((factor, memory))
            }
        };
        if !factor.factorise(matrix, memory) {
            return Ok(false);
        }
        d.copy_from_slice(r);
        factor.solve(d, memory);
        let mut rest = vec![0.0; r.len()];
        matrix.product(d, &mut rest);
        vector::add_scaled(&mut rest, -1.0, r);
        Ok(vector::norm(&rest) <= WORST_SOLUTION * vector::norm(r))
    }

    /// Adds `share` of the magnitude of each diagonal entry to it, and more to small ones.
    fn add_to_diagonal(&mut self, share: f64) {
        let LowerTriangle { starts, values, .. } = &mut self.matrix;
        let places = starts.split_last().map_or(&[][..], |(_, places)| places);
        let largest = places.iter().fold(0.0_f64, |m, &k| m.max(values[k].abs()));
        let least = if largest > 0.0 { 1e-6 * largest } else { 1.0 };
        for &place in places {
            values[place] += share * values[place].abs().max(least);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::Membrane;
    use super::*;

    #[test]
    fn the_pattern_of_the_factor_is_found_once() {
        let mut problem = Membrane::new(12);
        let x = vec![0.0; problem.len()];
        let mut r = x.clone();
        problem.residual(&x, &mut r).unwrap();
        let (mut first, mut second) = (x.clone(), x.clone());
        let mut solver = Cholesky::default();
        solver.direction(&mut problem, &x, &r, &mut first).unwrap();
        let place = |solver: &Cholesky| solver.factor.as_ref().map(|(factor, _)| factor.place());
        let factor = place(&solver);
        solver.direction(&mut problem, &x, &r, &mut second).unwrap();
        assert_eq!(first, second);
        assert_eq!(place(&solver), factor, "memory is kept");
        assert!(problem.error(&first) < 1e-12);
    }
}
