//! A sparse Cholesky factorisation (faer), on one thread.

use super::sparse::LowerTriangle;
use crate::FemError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// The factor L of a matrix A = L L^T in the fill-reducing order (approximate minimum degree) of its pattern.
pub(crate) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor")
            .field("entries", &self.values.len())
            .finish_non_exhaustive()
    }
}

impl Factor {
    /// The order and the pattern for a matrix, with the memory of its factor, which holds no numbers yet.
    ///
    /// # Errors
    /// [`FemError::Factorisation`].
    pub(crate) fn of_pattern(matrix: &LowerTriangle) -> Result<Self, FemError> {
        let symbolic = factorize_symbolic_cholesky(
            pattern(matrix),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        );
        let symbolic = symbolic.map_err(|e| failed(matrix.size(), e.to_string()))?;
        let mut values = Vec::new();
        let entries = symbolic.len_val();
        values
            .try_reserve_exact(entries)
            .map_err(|e| failed(matrix.size(), e.to_string()))?;
        values.resize(entries, 0.0);
        Ok(Self { symbolic, values })
    }

    /// Memory to factorise and to solve with.
    ///
    /// # Errors
    /// [`FemError::Factorisation`].
    pub(crate) fn memory(&self) -> Result<MemBuffer, FemError> {
        let symbolic = &self.symbolic;
        let factorise = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let need = factorise.or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        MemBuffer::try_new(need).map_err(|e| failed(symbolic.nrows(), e.to_string()))
    }

    /// Factorises a matrix of the pattern; returns whether it is positive definite.
    pub(crate) fn factorise(&mut self, matrix: &LowerTriangle, memory: &mut MemBuffer) -> bool {
        let factorised = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            SparseColMatRef::new(pattern(matrix), &matrix.values),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(memory),
            Default::default(),
        );
        factorised.is_ok()
    }

    /// Replaces `x` by the solution of A y = x.
    pub(crate) fn solve(&self, x: &mut [f64], memory: &mut MemBuffer) {
        let n = x.len();
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(memory),
        );
    }

    /// Where its numbers lie.
    #[cfg(test)]
    pub(super) fn place(&self) -> *const f64 {
        self.values.as_ptr()
    }

    /// Memory to solve with.
    ///
    /// # Errors
    /// [`FemError::Factorisation`].
    pub(crate) fn memory_to_solve(&self) -> Result<MemBuffer, FemError> {
        let need = self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        MemBuffer::try_new(need).map_err(|e| failed(self.symbolic.nrows(), e.to_string()))
    }
}

fn pattern(matrix: &LowerTriangle) -> SymbolicSparseColMatRef<'_, usize> {
    let n = matrix.size();
    SymbolicSparseColMatRef::new_checked(n, n, &matrix.starts, None, &matrix.rows)
}

fn failed(unknowns: usize, why: String) -> FemError {
    FemError::Factorisation { unknowns, why }
}
