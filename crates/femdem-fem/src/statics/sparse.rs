//! The lower triangle of a symmetric sparse matrix by columns, assembled from entries that come in the same
//! order every time.

use super::StaticProblem;
use crate::FemError;

/// A symmetric matrix; the diagonal is stored in full, each column's first entry.
#[derive(Debug, Default)]
pub(crate) struct LowerTriangle {
    pub(crate) starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) values: Vec<f64>,
    /// The index in `values` of the k-th entry on or below the diagonal that the problem passes.
    places: Vec<usize>,
}

impl LowerTriangle {
    /// Assembles the tangent at `x`; returns whether its pattern differs from the one before.
    ///
    /// # Errors
    /// Of the problem's tangent.
    pub(crate) fn assemble<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &[f64],
    ) -> Result<bool, FemError> {
        if self.starts.len() == problem.len() + 1 && self.refill(problem, x)? {
            return Ok(false);
        }
        self.find_pattern(problem, x)?;
        self.refill(problem, x)?;
        Ok(true)
    }

    /// Fills in the values; returns whether all entries came at their known positions.
    fn refill<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &[f64],
    ) -> Result<bool, FemError> {
        self.values.fill(0.0);
        let mut places = self.places.iter();
        let mut fits = true;
        let (starts, rows, values) = (&self.starts, &self.rows, &mut self.values);
        problem.tangent(x, &mut |i, j, value| {
            let (i, j) = (i as usize, j as usize);
            if i < j {
                return;
            }
            let place = places.next().copied().unwrap_or(usize::MAX);
            let column = match (starts.get(j), starts.get(j + 1)) {
                (Some(&from), Some(&to)) => from..to,
                _ => 0..0,
            };
            if column.contains(&place) && rows.get(place) == Some(&i) {
                values[place] += value;
            } else {
                fits = false;
            }
        })?;
        Ok(fits && places.next().is_none())
    }

    fn find_pattern<P: StaticProblem + ?Sized>(
        &mut self,
        problem: &mut P,
        x: &[f64],
    ) -> Result<(), FemError> {
        let n = problem.len();
        let mut entries: Vec<(u32, u32)> = Vec::new();
        problem.tangent(x, &mut |i, j, _| {
            if i >= j && (i as usize) < n {
                entries.push((i, j));
            }
        })?;
        let mut columns: Vec<Vec<u32>> = (0..n).map(|j| vec![j as u32]).collect();
        for &(i, j) in &entries {
            columns[j as usize].push(i);
        }
        self.starts = vec![0];
        self.rows.clear();
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            self.rows.extend(column.iter().map(|&i| i as usize));
            self.starts.push(self.rows.len());
        }
        let place = |&(i, j): &(u32, u32)| {
            let column = &columns[j as usize];
            self.starts[j as usize] + column.partition_point(|&row| row < i)
        };
        self.places = entries.iter().map(place).collect();
        self.values = vec![0.0; self.rows.len()];
        Ok(())
    }

    /// Number of rows.
    #[cfg(feature = "implicit")]
    pub(crate) fn size(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Row, column and value of each entry on or below the diagonal.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.starts.windows(2).enumerate().flat_map(|(j, ends)| {
            let column = ends[0]..ends[1];
            let rows = self.rows[column.clone()].iter().zip(&self.values[column]);
            rows.map(move |(&i, &value)| (i, j, value))
        })
    }

    /// y = A x.
    pub(crate) fn product(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (j, ends) in self.starts.windows(2).enumerate() {
            let [from, to] = [ends[0], ends[1]];
            let xj = x[j];
            // The diagonal comes first in its column.
            let mut sum = self.values[from] * xj;
            let below = self.rows[from + 1..to]
                .iter()
                .zip(&self.values[from + 1..to]);
            for (&i, value) in below {
                y[i] += value * xj;
                sum += value * x[i];
            }
            y[j] += sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Chain, Membrane};
    use super::*;

    #[test]
    fn product_is_that_of_the_tangent() {
        let mut problem = Chain::hanging(7);
        let x = problem.start();
        let mut matrix = LowerTriangle::default();
        assert!(matrix.assemble(&mut problem, &x).unwrap());
        let n = problem.len();
        for k in 0..n {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let [mut exact, mut image] = [vec![0.0; n], vec![0.0; n]];
            problem.tangent_apply(&x, &unit, &mut exact).unwrap();
            matrix.product(&unit, &mut image);
            for (a, b) in exact.iter().zip(&image) {
                assert!((a - b).abs() < 1e-9, "{k}: {exact:?} {image:?}");
            }
        }
    }

    #[test]
    fn a_pattern_is_found_once_and_again_when_it_changes() {
        let mut matrix = LowerTriangle::default();
        let mut chain = Chain::hanging(7);
        let x = chain.start();
        assert!(matrix.assemble(&mut chain, &x).unwrap());
        let before = matrix.values.clone();
        assert!(!matrix.assemble(&mut chain, &x).unwrap());
        assert_eq!(matrix.values, before);
        let mut membrane = Membrane::new(4);
        let x = vec![0.0; membrane.len()];
        assert!(matrix.assemble(&mut membrane, &x).unwrap());
        let x = chain.start();
        assert!(matrix.assemble(&mut chain, &x).unwrap());
        assert_eq!(matrix.values, before);
    }
}
