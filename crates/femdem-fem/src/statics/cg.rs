//! Conjugate gradients, with or without a matrix, for directions of Newton's method.
//!
//! The iteration stops early if the tangent is found not to be positive definite, and returns the present
//! iterate, which is a direction of descent (Steihaug, SIAM J. Numer. Anal. 20, 626 (1983)).

use super::sparse::LowerTriangle;
use super::{Effort, StaticProblem, vector};
use crate::FemError;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct CgLimits {
    /// Norm of r - K d over that of r.
    pub(super) tolerance: f64,
    pub(super) iterations: usize,
}

/// Inverses of the 3 x 3 blocks on the diagonal of a tangent, as six numbers each.
#[derive(Debug)]
pub(super) struct Blocks {
    /// xx, yy, zz, xy, yz, zx.
    inverses: Vec<[f64; 6]>,
}

impl Blocks {
    /// Of the tangent at `x`. A block that is not positive definite is replaced by the absolute
    /// values of its diagonal.
    ///
    /// # Errors
    /// Of the problem's tangent.
    pub(super) fn of<P: StaticProblem + ?Sized>(
        problem: &mut P,
        x: &[f64],
    ) -> Result<Self, FemError> {
        let mut diagonal = Diagonal::new(problem.len());
        problem.tangent(x, &mut |i, j, value| {
            if i <= j {
                diagonal.add(i as usize, j as usize, value);
            }
        })?;
        Ok(diagonal.inverse())
    }

    /// Of an assembled tangent.
    fn of_matrix(matrix: &LowerTriangle, unknowns: usize) -> Self {
        let mut diagonal = Diagonal::new(unknowns);
        for (row, column, value) in matrix.entries() {
            diagonal.add(column, row, value);
        }
        diagonal.inverse()
    }

    /// Writes the product of the inverse blocks with `r` into `z`.
    pub(super) fn apply(&self, r: &[f64], z: &mut [f64]) {
        let triples = r.chunks(3).zip(z.chunks_mut(3));
        for (&[xx, yy, zz, xy, yz, zx], (r, z)) in self.inverses.iter().zip(triples) {
            let at = |k: usize| r.get(k).copied().unwrap_or(0.0);
            let (a, b, c) = (at(0), at(1), at(2));
            let product = [
                xx * a + xy * b + zx * c,
                xy * a + yy * b + yz * c,
                zx * a + yz * b + zz * c,
            ];
            for (z, value) in z.iter_mut().zip(product) {
                *z = value;
            }
        }
    }
}

/// The 3 x 3 blocks on the diagonal themselves.
struct Diagonal {
    blocks: Vec<[f64; 6]>,
}

impl Diagonal {
    fn new(unknowns: usize) -> Self {
        let mut blocks = vec![[0.0; 6]; unknowns.div_ceil(3)];
        if let (Some(last), rest @ 1..) = (blocks.last_mut(), unknowns % 3) {
            // The last block may have fewer than three rows: ones fill its diagonal.
            last[2] = 1.0;
            if rest == 1 {
                last[1] = 1.0;
            }
        }
        Self { blocks }
    }

    /// Adds an entry on or above the diagonal of the matrix, if it lies in a block.
    fn add(&mut self, i: usize, j: usize, value: f64) {
        if i / 3 == j / 3
            && let Some(place) = place(i % 3, j % 3)
            && let Some(block) = self.blocks.get_mut(i / 3)
        {
            block[place] += value;
        }
    }

    fn inverse(&self) -> Blocks {
        Blocks {
            inverses: self.blocks.iter().map(inverse).collect(),
        }
    }
}

/// Index at which an entry of the upper triangle of a block is stored.
fn place(i: usize, j: usize) -> Option<usize> {
    match (i, j) {
        (0, 0) => Some(0),
        (1, 1) => Some(1),
        (2, 2) => Some(2),
        (0, 1) => Some(3),
        (1, 2) => Some(4),
        (0, 2) => Some(5),
        _ => None,
    }
}

/// Inverse of a symmetric block, or of the absolute values of its diagonal.
fn inverse(&[xx, yy, zz, xy, yz, zx]: &[f64; 6]) -> [f64; 6] {
    let minor = xx * yy - xy * xy;
    let cofactors = [yy * zz - yz * yz, xy * zz - yz * zx, xy * yz - yy * zx];
    let determinant = xx * cofactors[0] - xy * cofactors[1] + zx * cofactors[2];
    // Away from round-off: the determinant is compared with that of the diagonal.
    if xx > 0.0 && minor > 0.0 && determinant > 1e-12 * xx * yy * zz.abs() {
        [
            cofactors[0] / determinant,
            (xx * zz - zx * zx) / determinant,
            minor / determinant,
            -cofactors[1] / determinant,
            (xy * zx - xx * yz) / determinant,
            cofactors[2] / determinant,
        ]
    } else {
        let scale = xx.abs().max(yy.abs()).max(zz.abs());
        let one = |value: f64| match value.abs().max(1e-6 * scale) {
            0.0 => 1.0,
            positive => 1.0 / positive,
        };
        [one(xx), one(yy), one(zz), 0.0, 0.0, 0.0]
    }
}

/// The vectors of the iteration, and the matrix if it is assembled.
#[derive(Debug, Default)]
pub(super) struct Cg {
    matrix: Option<LowerTriangle>,
    remainder: Vec<f64>,
    scaled: Vec<f64>,
    search: Vec<f64>,
    image: Vec<f64>,
}

impl Cg {
    /// Products with the tangent use a matrix, assembled once for each direction.
    pub(super) fn assembled() -> Self {
        Self {
            matrix: Some(LowerTriangle::default()),
            ..Self::default()
        }
    }

    /// Solves K d = r to the limits; see [`Solver::direction`](super::linear::Solver::direction).
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
        let n = r.len();
        for v in [&mut self.scaled, &mut self.image] {
            v.resize(n, 0.0);
        }
        let blocks = match &mut self.matrix {
            None => Blocks::of(problem, x)?,
            Some(matrix) => {
                matrix.assemble(problem, x)?;
                Blocks::of_matrix(matrix, n)
            }
        };
        self.remainder.clear();
        self.remainder.extend_from_slice(r);
        d.fill(0.0);
        blocks.apply(r, &mut self.scaled);
        self.search.clone_from(&self.scaled);
        let mut rho = vector::dot(&self.remainder, &self.scaled);
        let goal = limits.tolerance * vector::norm(r);
        let mut effort = Effort::default();
        while effort.iterations < limits.iterations {
            match &self.matrix {
                None => problem.tangent_apply(x, &self.search, &mut self.image)?,
                Some(matrix) => matrix.product(&self.search, &mut self.image),
            }
            effort.iterations += 1;
            let curvature = vector::dot(&self.search, &self.image);
            // Not positive, which a NaN is neither.
            if !(curvature > 0.0 && curvature.is_finite()) {
                if effort.iterations == 1 {
                    d.copy_from_slice(&self.search);
                }
                effort.modified = true;
                return Ok(effort);
            }
            let step = rho / curvature;
            vector::add_scaled(d, step, &self.search);
            vector::add_scaled(&mut self.remainder, -step, &self.image);
            if vector::norm(&self.remainder) <= goal {
                break;
            }
            blocks.apply(&self.remainder, &mut self.scaled);
            let next = vector::dot(&self.remainder, &self.scaled);
            let ratio = next / rho;
            rho = next;
            for (p, z) in self.search.iter_mut().zip(&self.scaled) {
                *p = z + ratio * *p;
            }
        }
        Ok(effort)
    }
}
