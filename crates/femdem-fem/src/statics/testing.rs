//! Small static problems with known answers.

use super::{Linear, StaticProblem};
use crate::FemError;

/// The linear solvers of this build.
pub(super) fn solvers() -> Vec<Linear> {
    let mut all = vec![Linear::Cg, Linear::CgAssembled];
    if cfg!(feature = "implicit") {
        all.push(Linear::Cholesky);
    }
    all
}

/// One unknown with an energy, its first and its second derivative; no forces where the
/// energy is not finite and the unknown negative.
pub(super) struct Function {
    parts: [Box<dyn Fn(f64) -> f64>; 3],
}

impl Function {
    pub(super) fn new(
        e: impl Fn(f64) -> f64 + 'static,
        de: impl Fn(f64) -> f64 + 'static,
        dde: impl Fn(f64) -> f64 + 'static,
    ) -> Self {
        Self {
            parts: [Box::new(e), Box::new(de), Box::new(dde)],
        }
    }
}

impl StaticProblem for Function {
    fn len(&self) -> usize {
        1
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<f64, FemError> {
        r[0] = -self.parts[1](x[0]);
        Ok(self.parts[0](x[0]))
    }

    fn force_scale(&self) -> f64 {
        1.0
    }

    fn tangent_apply(&mut self, x: &[f64], dx: &[f64], out: &mut [f64]) -> Result<(), FemError> {
        out[0] = self.parts[2](x[0]) * dx[0];
        Ok(())
    }

    fn tangent(&mut self, x: &[f64], entry: &mut dyn FnMut(u32, u32, f64)) -> Result<(), FemError> {
        entry(0, 0, self.parts[2](x[0]));
        Ok(())
    }
}

/// A square membrane, fixed at its edges, on n x n points by the five-point formula, with the load for
/// which the deflection is the product of two polynomials that the formula differentiates exactly.
pub(super) struct Membrane {
    n: usize,
    load: Vec<f64>,
}

impl Membrane {
    pub(super) fn new(n: usize) -> Self {
        let mut membrane = Self {
            n,
            load: vec![0.0; n * n],
        };
        let place = |k: usize| (k + 1) as f64 / (n + 1) as f64;
        let h2 = place(0).powi(2);
        for k in 0..n * n {
            let (x, y) = (place(k % n), place(k / n));
            // u = x (1 - x) y (1 - y): second differences of a parabola are exact.
            membrane.load[k] = 2.0 * h2 * (y * (1.0 - y) + x * (1.0 - x));
        }
        membrane
    }

    /// Largest difference from the closed form, over its largest value.
    pub(super) fn error(&self, u: &[f64]) -> f64 {
        let place = |k: usize| (k + 1) as f64 / (self.n + 1) as f64;
        let exact = |k: usize| {
            let (x, y) = (place(k % self.n), place(k / self.n));
            x * (1.0 - x) * y * (1.0 - y)
        };
        u.iter()
            .enumerate()
            .fold(0.0, |worst: f64, (k, u)| worst.max((u - exact(k)).abs()))
            * 16.0
    }

    fn neighbours(&self, k: usize) -> impl Iterator<Item = usize> + use<> {
        let (n, i, j) = (self.n, k % self.n, k / self.n);
        [
            (j > 0).then(|| k - n),
            (i > 0).then(|| k - 1),
            (i + 1 < n).then(|| k + 1),
            (j + 1 < n).then(|| k + n),
        ]
        .into_iter()
        .flatten()
    }
}

impl StaticProblem for Membrane {
    fn len(&self) -> usize {
        self.load.len()
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<f64, FemError> {
        self.tangent_apply(x, x, r)?;
        let mut energy = 0.0;
        for ((r, f), x) in r.iter_mut().zip(&self.load).zip(x) {
            energy += (0.5 * *r - f) * x;
            *r = f - *r;
        }
        Ok(energy)
    }

    fn force_scale(&self) -> f64 {
        super::vector::norm(&self.load)
    }

    fn tangent_apply(&mut self, _: &[f64], dx: &[f64], out: &mut [f64]) -> Result<(), FemError> {
        for (k, out) in out.iter_mut().enumerate() {
            *out = 4.0 * dx[k] - self.neighbours(k).map(|m| dx[m]).sum::<f64>();
        }
        Ok(())
    }

    fn tangent(&mut self, _: &[f64], entry: &mut dyn FnMut(u32, u32, f64)) -> Result<(), FemError> {
        for k in 0..self.len() {
            entry(k as u32, k as u32, 4.0);
            for m in self.neighbours(k) {
                entry(k as u32, m as u32, -1.0);
            }
        }
        Ok(())
    }
}

/// A chain of springs between two supports 1 m apart, in space, with equal weights on its points.
/// Springs are stretched from the start, so that it is stable, and sag strongly.
pub(super) struct Chain {
    points: usize,
    weight: f64,
    stiffness: Vec<f64>,
}

impl Chain {
    pub(super) fn hanging(points: usize) -> Self {
        Self {
            points,
            weight: 1.0 / points as f64,
            stiffness: vec![2.0 * (points + 1) as f64; points + 1],
        }
    }

    /// A straight line, with a slight offset so that all directions are involved.
    pub(super) fn start(&self) -> Vec<f64> {
        let at = |i: usize| (i + 1) as f64 / (self.points + 1) as f64;
        (0..self.points)
            .flat_map(|i| {
                [
                    at(i),
                    0.01 * at(i) * (1.0 - at(i)),
                    -0.3 * at(i) * (1.0 - at(i)),
                ]
            })
            .collect()
    }

    /// Violation of equilibrium of the left half, found from the whole: the horizontal pull of all
    /// springs is one number, and the vertical pull at the left support is half the weight.
    pub(super) fn sag_error(&self, x: &[f64]) -> f64 {
        let pulls: Vec<[f64; 3]> = (0..=self.points).map(|s| self.pull(x, s)).collect();
        let level = pulls.iter().map(|p| (p[0] - pulls[0][0]).abs());
        let half = 0.5 * self.weight * self.points as f64;
        level.fold((pulls[0][2] + half).abs(), f64::max)
    }

    fn point(&self, x: &[f64], i: usize) -> [f64; 3] {
        match i {
            0 => [0.0; 3],
            i if i > self.points => [1.0, 0.0, 0.0],
            i => [x[3 * i - 3], x[3 * i - 2], x[3 * i - 1]],
        }
    }

    fn span(&self, x: &[f64], spring: usize) -> ([f64; 3], f64) {
        let (a, b) = (self.point(x, spring), self.point(x, spring + 1));
        let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        (d, super::vector::norm(&d))
    }

    fn rest(&self) -> f64 {
        0.9 / (self.points + 1) as f64
    }

    /// Force of a spring on its left end.
    fn pull(&self, x: &[f64], spring: usize) -> [f64; 3] {
        let (d, length) = self.span(x, spring);
        d.map(|d| self.stiffness[spring] * (length - self.rest()) * d / length)
    }

    /// Second derivatives of a spring's energy by the difference of its ends.
    fn block(&self, x: &[f64], spring: usize) -> [[f64; 3]; 3] {
        let (d, length) = self.span(x, spring);
        let (k, ratio) = (self.stiffness[spring], self.rest() / length);
        let mut block = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                block[i][j] = k * ratio * d[i] * d[j] / (length * length);
            }
            block[i][i] += k * (1.0 - ratio);
        }
        block
    }
}

impl StaticProblem for Chain {
    fn len(&self) -> usize {
        3 * self.points
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<f64, FemError> {
        r.fill(0.0);
        let mut energy = 0.0;
        for i in 0..self.points {
            r[3 * i + 2] -= self.weight;
            energy += self.weight * x[3 * i + 2];
        }
        for s in 0..=self.points {
            let (_, length) = self.span(x, s);
            energy += 0.5 * self.stiffness[s] * (length - self.rest()).powi(2);
            for (k, f) in self.pull(x, s).into_iter().enumerate() {
                if s > 0 {
                    r[3 * (s - 1) + k] += f;
                }
                if s < self.points {
                    r[3 * s + k] -= f;
                }
            }
        }
        Ok(energy)
    }

    fn force_scale(&self) -> f64 {
        self.weight * (self.points as f64).sqrt()
    }

    fn tangent_apply(&mut self, x: &[f64], dx: &[f64], out: &mut [f64]) -> Result<(), FemError> {
        out.fill(0.0);
        self.tangent(x, &mut |i, j, value| {
            out[i as usize] += value * dx[j as usize];
        })
    }

    fn tangent(&mut self, x: &[f64], entry: &mut dyn FnMut(u32, u32, f64)) -> Result<(), FemError> {
        for s in 0..=self.points {
            let block = self.block(x, s);
            let ends = [s.checked_sub(1), (s < self.points).then_some(s)];
            for (a, left) in ends.iter().enumerate() {
                for (b, right) in ends.iter().enumerate() {
                    let (Some(p), Some(q)) = (left, right) else {
                        continue;
                    };
                    let sign = if a == b { 1.0 } else { -1.0 };
                    for (i, row) in block.iter().enumerate() {
                        for (j, value) in row.iter().enumerate() {
                            entry((3 * p + i) as u32, (3 * q + j) as u32, sign * value);
                        }
                    }
                }
            }
        }
        Ok(())
    }
}
