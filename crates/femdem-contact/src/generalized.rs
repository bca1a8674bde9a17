//! Stiffness and viscosity of a body's contacts over its six degrees of freedom, and the step they allow.

use crate::motion::Motion;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// A symmetric positive semi-definite matrix over the translation and the rotation of a body, in world axes:
/// the stiffness of springs (N/m, N, N m) or the viscosity of dashpots (the same times s).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Generalized {
    /// Force by translation.
    pub translation: Matrix3,
    /// Torque by translation; the transpose is force by rotation.
    pub coupling: Matrix3,
    /// Torque by rotation.
    pub turning: Matrix3,
}

impl AddAssign<&Self> for Generalized {
    fn add_assign(&mut self, other: &Self) {
        self.translation += other.translation;
        self.coupling += other.coupling;
        self.turning += other.turning;
    }
}

impl Generalized {
    /// Adds a spring or dashpot along one direction, with its lever about the body's origin.
    #[inline]
    pub(crate) fn add_along(&mut self, n: &Vector3, lever: &Vector3, value: f64) {
        let (scaled, turned) = (n * value, lever * value);
        self.translation += scaled * n.transpose();
        self.coupling += turned * n.transpose();
        self.turning += turned * lever.transpose();
    }

    /// Adds an isotropic one at an arm from the body's origin.
    #[inline]
    pub(crate) fn add_everywhere(&mut self, arm: &Vector3, value: f64) {
        let a = arm * value;
        self.translation += Matrix3::from_diagonal_element(value);
        self.coupling += Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0);
        self.turning += Matrix3::from_diagonal_element(a.dot(arm)) - a * arm.transpose();
    }

    /// Adds another times a factor.
    pub(crate) fn add_scaled(&mut self, other: &Self, factor: f64) {
        *self = self.sum(1.0, other, factor);
    }

    /// Adds one against rotation about a unit axis.
    #[inline]
    pub(crate) fn add_about(&mut self, axis: &Vector3, value: f64) {
        self.turning += (axis * value) * axis.transpose();
    }

    /// The matrix scaled by the body's inverse masses: its eigenvalues are squared frequencies or rates.
    /// `root` times its transpose is the inverse inertia.
    fn by_mass(&self, inverse_mass: f64, root: &Matrix3) -> Self {
        Self {
            translation: self.translation * inverse_mass,
            coupling: root.tr_mul(&self.coupling) * inverse_mass.sqrt(),
            turning: root.tr_mul(&self.turning) * root,
        }
    }

    fn sum(&self, own: f64, other: &Self, others: f64) -> Self {
        Self {
            translation: self.translation * own + other.translation * others,
            coupling: self.coupling * own + other.coupling * others,
            turning: self.turning * own + other.turning * others,
        }
    }

    fn trace(&self) -> f64 {
        self.translation.trace() + self.turning.trace()
    }

    fn square(&self) -> Self {
        Self {
            translation: self.translation * self.translation + self.coupling.tr_mul(&self.coupling),
            coupling: self.coupling * self.translation + self.turning * self.coupling,
            turning: self.coupling * self.coupling.transpose() + self.turning * self.turning,
        }
    }

    /// The largest sum of magnitudes in a row: an upper bound of the largest eigenvalue.
    fn largest_row(&self) -> f64 {
        let sum = |m: &Matrix3, i: usize| m.row(i).iter().map(|x| x.abs()).sum::<f64>();
        let column = |m: &Matrix3, i: usize| m.column(i).iter().map(|x| x.abs()).sum::<f64>();
        (0..3)
            .map(|i| {
                let upper = sum(&self.translation, i) + column(&self.coupling, i);
                upper.max(sum(&self.coupling, i) + sum(&self.turning, i))
            })
            .fold(0.0, f64::max)
    }

    /// Upper bound of the largest eigenvalue, from the eighth power; at most 7 % above.
    fn largest(&self) -> f64 {
        let size = self.trace();
        if size <= 0.0 {
            return 0.0;
        }
        let unit = self.sum(1.0 / size, &Self::default(), 0.0);
        let power = unit.square().square().square();
        size * power.largest_row().sqrt().sqrt().sqrt()
    }
}

/// Largest stable step of a damped oscillator whose viscous force lags by half a step, s:
/// dt^2 omega^2/4 + dt gamma/2 <= 1, from the squared frequency (1/s^2) and the rate gamma (1/s).
pub fn stable_step(frequency2: f64, rate: f64) -> f64 {
    if frequency2 > 0.0 {
        // Written without a difference of large numbers, since the rate may dominate.
        4.0 / (rate + (rate * rate + 4.0 * frequency2).sqrt())
    } else if rate > 0.0 {
        2.0 / rate
    } else {
        f64::INFINITY
    }
}

/// Springs and dashpots that oppose the motions of a body, weighted by its share in each.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Resistance {
    /// N/m, N, N m.
    pub stiffness: Generalized,
    /// N s/m, N s, N m s.
    pub viscosity: Generalized,
}

impl AddAssign<&Self> for Resistance {
    fn add_assign(&mut self, other: &Self) {
        self.stiffness += &other.stiffness;
        self.viscosity += &other.viscosity;
    }
}

impl Resistance {
    /// The largest step for which the contacts of a body are stable, at most `most`, s. Infinite for a body
    /// of zero inverse mass and inertia.
    ///
    /// The matrix of a pair is at most its own diagonal blocks times 1 + sqrt(w_j/w_i) and 1 + sqrt(w_i/w_j),
    /// with w the inverse masses at the contact: these factors are the shares. A step that each body's block
    /// allows is therefore allowed by the whole. The share is 1 against partners that do not move: walls and
    /// sleeping bodies.
    pub fn largest_step(&self, motion: &Motion, most: f64) -> f64 {
        self.largest_step_from(motion, [0.0, most])
    }

    /// The same where `safe` (s) is known to be stable, between the two.
    pub(crate) fn largest_step_from(&self, motion: &Motion, between: [f64; 2]) -> f64 {
        largest_step(&self.stiffness, &self.viscosity, motion, between)
    }
}

/// L with L L^T = m, lower triangular, for a positive definite matrix.
fn cholesky(m: &Matrix3) -> Matrix3 {
    let root = |x: f64| x.max(0.0).sqrt();
    let over = |x: f64, by: f64| if by > 0.0 { x / by } else { 0.0 };
    let a = root(m.m11);
    let (b, c) = (over(m.m21, a), over(m.m31, a));
    let d = root(m.m22 - b * b);
    let e = over(m.m32 - b * c, d);
    let f = root(m.m33 - c * c - e * e);
    Matrix3::new(a, 0.0, 0.0, b, d, 0.0, c, e, f)
}

/// Iterations of the search for the largest step; each ends at a stable one.
const ROUNDS: usize = 3;

/// The largest step that is stable for a body with these springs and dashpots, or `safe` if that is larger, at most `most`, s.
/// Infinite for a body of zero inverse mass and inertia.
///
/// Below `most` it is a function of the body alone: so the least over many bodies does not depend on their order, nor on how they
/// are shared out.
///
/// With the viscous force half a step late, the leapfrog step of a linear system is stable if dt^2/4 k + dt/2
/// c <= 1 for every motion, where k and c are the Rayleigh quotients of stiffness and viscosity in the metric
/// of the masses. This holds if the largest eigenvalue of the sum of both matrices is at most 1.
fn largest_step(
    stiffness: &Generalized,
    viscosity: &Generalized,
    motion: &Motion,
    [safe, most]: [f64; 2],
) -> f64 {
    let (w, root) = (motion.inverse_mass, cholesky(&motion.inverse_inertia));
    let traces = [stiffness, viscosity].map(|m| {
        w * m.translation.trace() + motion.inverse_inertia.component_mul(&m.turning).sum()
    });
    // Below this step even the sum of all eigenvalues is at most 1.
    let alone = stable_step(traces[0], traces[1]);
    let safe = alone.max(safe);
    if safe >= most || safe == f64::INFINITY {
        return safe.min(most);
    }
    let (k, c) = (stiffness.by_mass(w, &root), viscosity.by_mass(w, &root));
    let eigenvalue = |dt: f64| k.sum(0.25 * dt * dt, &c, 0.5 * dt).largest();
    let mut step = alone;
    for _ in 0..ROUNDS {
        let largest = eigenvalue(step);
        // A larger step scales the matrix by at most the square of the ratio.
        step /= if largest > 1.0 {
            largest
        } else {
            largest.sqrt()
        };
    }
    step.max(safe).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Frame;

    /// Reproducible numbers between -0.5 and 0.5.
    fn numbers() -> impl FnMut() -> f64 {
        let mut x = 0.3_f64;
        move || {
            x = (x * 997.0 + 0.123).fract();
            x - 0.5
        }
    }

    fn vector(next: &mut impl FnMut() -> f64) -> Vector3 {
        Vector3::new(next(), next(), next())
    }

    /// Six orthonormal motions.
    fn basis(next: &mut impl FnMut() -> f64) -> Vec<[Vector3; 2]> {
        let mut basis: Vec<[Vector3; 2]> = Vec::new();
        while basis.len() < 6 {
            let mut u = [vector(next), vector(next)];
            for v in &basis {
                let part = u[0].dot(&v[0]) + u[1].dot(&v[1]);
                u = [u[0] - v[0] * part, u[1] - v[1] * part];
            }
            let size = u[0].norm().hypot(u[1].norm());
            basis.push(u.map(|x| x / size));
        }
        basis
    }

    #[test]
    fn the_bound_lies_just_above_the_largest_eigenvalue() {
        let mut next = numbers();
        for _ in 0..200 {
            let mut m = Generalized::default();
            let mut exact = 0.0_f64;
            for [n, lever] in basis(&mut next) {
                let value = (3.0 * next()).exp();
                m.add_along(&n, &lever, value);
                exact = exact.max(value);
            }
            let ratio = m.largest() / exact;
            assert!((1.0 - 1e-12..1.08).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn a_spring_and_a_dashpot_through_the_centroid() {
        let mut motion = Motion::fixed(Frame::identity());
        motion.inverse_mass = 2.0;
        motion.inverse_inertia = Matrix3::from_diagonal_element(3.0);
        let n = Vector3::new(0.36, 0.48, -0.8);
        for (k, c) in [(5.0, 0.0), (5.0, 0.7), (5.0, 30.0), (0.0, 2.0)] {
            let [mut stiffness, mut viscosity] = [Generalized::default(); 2];
            stiffness.add_along(&n, &Vector3::zeros(), k);
            viscosity.add_along(&n, &Vector3::zeros(), c);
            let step = largest_step(&stiffness, &viscosity, &motion, [0.0, f64::INFINITY]);
            let ratio = step / stable_step(2.0 * k, 2.0 * c);
            assert!((0.9..1.0 + 1e-12).contains(&ratio), "k {k} c {c}: {ratio}");
            assert!(
                (largest_step(&stiffness, &viscosity, &motion, [0.0, 1e-3]) - 1e-3).abs() < 1e-18
            );
        }
        let none = Generalized::default();
        let step = largest_step(&none, &none, &motion, [0.0, f64::INFINITY]);
        assert!(step.is_infinite());
    }

    /// Springs and dashpots at the corners of a body with three different moments of inertia, in
    /// the coordinates of its principal axes: the leapfrog step stays bounded at the step found and
    /// grows at one 30 % larger.
    #[test]
    fn the_step_separates_decay_from_growth() {
        let mut next = numbers();
        for case in 0..20 {
            let mut motion = Motion::fixed(Frame::identity());
            motion.inverse_mass = 1.5;
            motion.inverse_inertia = Matrix3::from_diagonal(&Vector3::new(2.0, 5.0, 9.0));
            let [mut stiffness, mut viscosity] = [Generalized::default(); 2];
            for _ in 0..4 {
                let (n, arm) = (vector(&mut next).normalize(), vector(&mut next));
                stiffness.add_along(&n, &arm.cross(&n), 1.0 + next());
                stiffness.add_everywhere(&arm, 0.3);
                let [_, axis, _] = crate::axes::complete(&n);
                stiffness.add_about(&n, 0.02);
                stiffness.add_about(&axis, 0.04);
                let viscous = if case % 2 == 0 { 0.2 } else { 1.5 };
                viscosity.add_along(&n, &vector(&mut next), viscous);
                viscosity.add_about(&axis, 0.03);
            }
            let step = largest_step(&stiffness, &viscosity, &motion, [0.0, f64::INFINITY]);
            let times = |m: &Generalized, [x, turn]: &[Vector3; 2]| {
                [
                    m.translation * x + m.coupling.tr_mul(turn),
                    m.coupling * x + m.turning * turn,
                ]
            };
            let grows = |dt: f64| {
                let mut x = [Vector3::new(1.0, 0.3, -0.4), Vector3::new(0.2, -0.7, 0.5)];
                let mut v = [Vector3::zeros(); 2];
                for _ in 0..3000 {
                    let (k, c) = (times(&stiffness, &x), times(&viscosity, &v));
                    v[0] -= (k[0] + c[0]) * (motion.inverse_mass * dt);
                    v[1] -= motion.inverse_inertia * (k[1] + c[1]) * dt;
                    x = [x[0] + v[0] * dt, x[1] + v[1] * dt];
                }
                let size = x[0].norm() + x[1].norm();
                !size.is_finite() || size > 1e3
            };
            assert!(!grows(step), "case {case}");
            // The condition is exact where springs and dashpots act along the same motions.
            assert!(grows(1.3 * step), "case {case}");
        }
    }
}
