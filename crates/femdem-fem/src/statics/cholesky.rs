//! Directions from a sparse Cholesky factorisation (faer), on one thread.
//!
//! The fill-reducing order (approximate minimum degree) and the pattern of the factor are computed once for
//! each pattern of the tangent. If a tangent is not positive definite, a multiple of the magnitudes of its
//! diagonal is added (Nocedal and Wright, Numerical Optimization, 2006, alg. 3.3).

use super::sparse::LowerTriangle;
use super::{Effort, StaticProblem, vector};
use crate::FemError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

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
    symbolic: Option<SymbolicCholesky<usize>>,
    factor: Vec<f64>,
    memory: Option<MemBuffer>,
}

impl std::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cholesky")
            .field("entries", &self.matrix.values.len())
            .field("entries_of_factor", &self.factor.len())
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
            self.symbolic = None;
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
        let n = r.len();
        let failed = |why: String| FemError::Factorisation { unknowns: n, why };
        let matrix = &self.matrix;
        if !vector::all_finite(&matrix.values) {
            return Ok(false);
        }
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &matrix.starts, None, &matrix.rows);
        if self.symbolic.is_none() {
            let symbolic = factorize_symbolic_cholesky(
                pattern,
                Side::Lower,
                SymmetricOrdering::Amd,
                CholeskySymbolicParams::default(),
            )
            .map_err(|e| failed(e.to_string()))?;
            let factorise =
                symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
            let need = factorise.or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
            // The old memory is released first.
            (self.memory, self.factor) = (None, Vec::new());
            let entries = symbolic.len_val();
            self.factor
                .try_reserve_exact(entries)
                .map_err(|e| failed(e.to_string()))?;
            self.factor.resize(entries, 0.0);
            self.memory = Some(MemBuffer::try_new(need).map_err(|e| failed(e.to_string()))?);
            self.symbolic = Some(symbolic);
        }
        let (Some(symbolic), Some(memory)) = (&self.symbolic, &mut self.memory) else {
            return Ok(false);
        };
        let values = SparseColMatRef::new(pattern, &matrix.values);
        let stack = MemStack::new(memory);
        let factorised = symbolic.factorize_numeric_llt(
            &mut self.factor,
            values,
            Side::Lower,
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        if factorised.is_err() {
            return Ok(false);
        }
        d.copy_from_slice(r);
        LltRef::new(symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(d, n, 1),
            Par::Seq,
            stack,
        );
        let mut rest = vec![0.0; n];
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
        let factor = solver.factor.as_ptr();
        solver.direction(&mut problem, &x, &r, &mut second).unwrap();
        assert_eq!(first, second);
        assert_eq!(solver.factor.as_ptr(), factor, "memory is kept");
        assert!(problem.error(&first) < 1e-12);
    }
}
