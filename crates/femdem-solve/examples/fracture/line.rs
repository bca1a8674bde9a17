//! A crack that runs straight through a notched beam: the model of the fictitious crack (A. Hillerborg, M. Modéer, P.-E. Petersson,
//! Cem. Concr. Res. 6 (1976) 773-782) with linear softening, by plane elements of half of the beam. What a mesh in space, whose
//! crack is free, is compared with.

use super::notched::{Notched, around, away};
use femdem_mesh::nalgebra::{DMatrix, DVector, Matrix3, SMatrix};

/// Cells of the ligament.
const CELLS: u32 = 100;

/// A symmetric matrix of which only a band is not zero: row i has the columns i - width to i.
struct Band {
    width: usize,
    rows: Vec<Vec<f64>>,
}

impl Band {
    fn new(size: usize, width: usize) -> Self {
        Self {
            width,
            rows: vec![vec![0.0; width + 1]; size],
        }
    }

    fn add(&mut self, row: usize, column: usize, value: f64) {
        if column <= row {
            self.rows[row][column + self.width - row] += value;
        }
    }

    fn at(&self, a: usize, b: usize) -> f64 {
        let (row, column) = (a.max(b), a.min(b));
        if row - column > self.width {
            return 0.0;
        }
        self.rows[row][column + self.width - row]
    }

    /// Makes a row and its column those of the identity.
    fn hold(&mut self, held: usize) {
        self.rows[held].fill(0.0);
        self.rows[held][self.width] = 1.0;
        let last = (held + self.width + 1).min(self.rows.len());
        for row in held + 1..last {
            self.rows[row][held + self.width - row] = 0.0;
        }
    }

    /// Its Cholesky factor, in place.
    fn factor(&mut self) {
        for i in 0..self.rows.len() {
            let first = i.saturating_sub(self.width);
            for j in first..=i {
                let from = first.max(j.saturating_sub(self.width));
                let sum: f64 = (from..j).map(|k| self.at(i, k) * self.at(j, k)).sum();
                let own = self.at(i, j) - sum;
                let value = if i == j {
                    own.sqrt()
                } else {
                    own / self.at(j, j)
                };
                self.rows[i][j + self.width - i] = value;
            }
        }
    }

    /// Solves with the factor, in place.
    fn solve(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let first = i.saturating_sub(self.width);
            let sum: f64 = (first..i).map(|k| self.at(i, k) * x[k]).sum();
            x[i] = (x[i] - sum) / self.at(i, i);
        }
        for i in (0..x.len()).rev() {
            x[i] /= self.at(i, i);
            for k in i.saturating_sub(self.width)..i {
                x[k] -= self.at(i, k) * x[i];
            }
        }
    }
}

/// The stiffness of a bilinear rectangle of sides a and b under plane stress, by width: ∫ Bᵀ D B dA with two by two points of Gauss.
fn rectangle(a: f64, b: f64, young: f64, poisson: f64) -> SMatrix<f64, 8, 8> {
    let shear = 0.5 * (1.0 - poisson);
    let elastic = Matrix3::new(1.0, poisson, 0.0, poisson, 1.0, 0.0, 0.0, 0.0, shear)
        * (young / (1.0 - poisson * poisson));
    let mut stiffness = SMatrix::<f64, 8, 8>::zeros();
    let point = 1.0 / 3.0_f64.sqrt();
    for (s, t) in [
        (-point, -point),
        (point, -point),
        (-point, point),
        (point, point),
    ] {
        let mut strain = SMatrix::<f64, 3, 8>::zeros();
        for (n, (x, y)) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
            .into_iter()
            .enumerate()
        {
            let (by_x, by_y) = (x * (1.0 + y * t) / (2.0 * a), y * (1.0 + x * s) / (2.0 * b));
            strain[(0, 2 * n)] = by_x;
            strain[(1, 2 * n + 1)] = by_y;
            strain[(2, 2 * n)] = by_y;
            strain[(2, 2 * n + 1)] = by_x;
        }
        stiffness += strain.transpose() * elastic * strain * (0.25 * a * b);
    }
    stiffness
}

/// The stiffness of half of the beam, by width, for the openings of the nodes of the ligament (half of those of the crack) and the
/// way of the load; and the heights that belong to these nodes, m.
fn condensed(beam: &Notched) -> (DMatrix<f64>, Vec<f64>) {
    let ligament = beam.height - beam.notch;
    let cell = ligament / f64::from(CELLS);
    let low = away(beam.notch, cell, 5.0 * cell);
    let high: Vec<f64> = (0..=CELLS).map(|i| cell * f64::from(i)).collect();
    let up = around(beam.notch, &low, &high);
    let along = away(0.5 * beam.span, cell, 20.0 * cell);
    let (nx, ny) = (up.len(), along.len());
    let mut stiffness = Band::new(2 * nx * ny, 2 * nx + 3);
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            let [a, b] = [up[i + 1] - up[i], along[j + 1] - along[j]];
            let own = rectangle(a, b, beam.solid.young, beam.solid.poisson);
            let corners = [
                i + nx * j,
                i + 1 + nx * j,
                i + nx * (j + 1),
                i + 1 + nx * (j + 1),
            ];
            let rows = [0, 1, 2, 3, 4, 5, 6, 7].map(|r| 2 * corners[r / 2] + r % 2);
            for (r, row) in rows.iter().enumerate() {
                for (c, column) in rows.iter().enumerate() {
                    stiffness.add(*row, *column, own[(r, c)]);
                }
            }
        }
    }
    stiffness.hold(2 * nx * (ny - 1));
    let tip = low.len() - 1;
    let mut kept: Vec<usize> = (tip..nx).map(|i| 2 * i + 1).collect();
    kept.push(2 * (nx - 1));
    let columns: Vec<Vec<f64>> = kept
        .iter()
        .map(|c| (0..2 * nx * ny).map(|row| stiffness.at(row, *c)).collect())
        .collect();
    for held in &kept {
        stiffness.hold(*held);
    }
    stiffness.factor();
    let size = kept.len();
    let mut result = DMatrix::zeros(size, size);
    for (c, column) in columns.iter().enumerate() {
        let mut inside = column.clone();
        for held in kept.iter().chain([&(2 * nx * (ny - 1))]) {
            inside[*held] = 0.0;
        }
        stiffness.solve(&mut inside);
        for (r, row) in columns.iter().enumerate() {
            let through: f64 = row.iter().zip(&inside).map(|(k, x)| k * x).sum();
            result[(r, c)] = column[kept[r]] - through;
        }
    }
    let heights = (tip..nx).map(|i| {
        let below = if i > tip { up[i] - up[i - 1] } else { 0.0 };
        let above = if i + 1 < nx { up[i + 1] - up[i] } else { 0.0 };
        0.5 * (below + above)
    });
    (result, heights.collect())
}

/// The largest load by width, N/m: the crack comes to the nodes one by one, that in which it ends bears the strength, those behind it
/// f (1 - w/w_c) with w_c = 2 G/f.
pub fn largest_load(beam: &Notched) -> f64 {
    let (stiffness, heights) = condensed(beam);
    let load = heights.len();
    let end = 2.0 * beam.energy / beam.tensile;
    let mut largest = 0.0_f64;
    // Which nodes still bear something.
    let mut holds = vec![true; load];
    for tip in 0..load - 1 {
        // Openings of the nodes behind the tip, and the way of the load.
        let size = tip + 1;
        let of = |k: usize| if k < tip { k } else { load };
        loop {
            let mut matrix = DMatrix::from_fn(size, size, |r, c| stiffness[(r, of(c))]);
            let mut right = DVector::zeros(size);
            for r in (0..size).filter(|r| holds[*r]) {
                right[r] = -beam.tensile * heights[r];
                if r < tip {
                    matrix[(r, r)] -= 2.0 * beam.tensile * heights[r] / end;
                }
            }
            let Some(found) = matrix.lu().solve(&right) else {
                return f64::NAN;
            };
            let open = (0..tip).filter(|k| holds[*k] && 2.0 * found[*k] > end);
            let open: Vec<usize> = open.collect();
            if open.is_empty() {
                let all = (0..size).map(|k| stiffness[(load, of(k))] * found[k]);
                largest = largest.max(2.0 * all.sum::<f64>().abs());
                break;
            }
            for k in open {
                holds[k] = false;
            }
        }
    }
    largest
}
