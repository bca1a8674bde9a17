//! How far the parts of a body have moved towards each other.
//!
//! A motion of the body as a whole does not count: the nodes are compared with where those of an earlier moment would be
//! if the body had moved as a rigid one since. So neither flight nor rotation, nor vibration about one shape, makes a search
//! due for places where the body touches itself.

use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Steps in which the rotation is fitted.
const FITS: usize = 2;

/// The shape of a body at an earlier moment, and its difference from the present one.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Bend {
    /// The nodes about their mean at that moment, m; empty if they are not known.
    before: Vec<Vector3>,
    /// Inverse of their second moments trace(S) 1 - S, 1/m^2.
    inverse: Matrix3,
    /// The rotation since then.
    rotation: Matrix3,
    /// The value of `bent` at that moment, m.
    base: f64,
    /// At the last measurement: running bound of the distance of any node from where it would be in a rigid body, m, and the
    /// distance that any node had travelled.
    bent: f64,
    travelled: f64,
}

impl Bend {
    /// Running bound of the motion of any part of the body towards any other, m. Between two moments, the later one of which
    /// is that of the last measurement and the earlier one such that the motion was no less than `clear`, it grew by at
    /// least as much.
    pub fn motion(&self) -> f64 {
        2.0 * self.bent
    }

    /// The nodes were put somewhere else.
    pub fn forget(&mut self) {
        self.before = Vec::new();
    }

    /// Measures the motion, if it may have reached `clear` (m) by the distance that any node has `travelled` (m). `centre` is
    /// the mean of the positions `x`, m.
    pub fn measure(&mut self, x: &[Vector3], centre: &Vector3, travelled: f64, clear: f64) {
        if 2.0 * (self.bent + (travelled - self.travelled)) < clear {
            return;
        }
        self.travelled = travelled;
        if self.before.len() == x.len() {
            self.bent = self.base + self.difference(x, centre);
        }
        if self.motion() >= clear || self.before.len() != x.len() {
            self.start_anew(x, centre);
        }
    }

    fn start_anew(&mut self, x: &[Vector3], centre: &Vector3) {
        self.before.clear();
        self.before.extend(x.iter().map(|x| x - centre));
        let second: Matrix3 = self.before.iter().map(|r| r * r.transpose()).sum();
        let moments = Matrix3::from_diagonal_element(second.trace()) - second;
        // Nodes on a line are not turned.
        self.inverse = moments.try_inverse().unwrap_or_else(Matrix3::zeros);
        self.rotation = Matrix3::identity();
        self.base = self.bent;
    }

    /// Largest distance of a node from where it would be in a rigid body, m.
    fn difference(&mut self, x: &[Vector3], centre: &Vector3) -> f64 {
        for _ in 0..FITS {
            let mut turned = Vector3::zeros();
            for (x, r) in x.iter().zip(&self.before) {
                turned += (self.rotation * r).cross(&(x - centre));
            }
            let rotation = &self.rotation;
            let turn = rotation * (self.inverse * rotation.tr_mul(&turned));
            self.rotation = rational(&turn) * self.rotation;
        }
        let mut most = 0.0;
        for (x, r) in x.iter().zip(&self.before) {
            let way = (x - centre - self.rotation * r).norm_squared();
            most = if way > most { way } else { most };
        }
        most.sqrt()
    }
}

/// A rotation by about the vector `turn`, rad, that is a rational function of it.
fn rational(turn: &Vector3) -> Matrix3 {
    let half = turn * 0.5;
    let square = half.norm_squared();
    let cross = half.cross_matrix();
    Matrix3::identity() + (cross + cross * cross) * (2.0 / (1.0 + square))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes() -> Vec<Vector3> {
        let number = |i: usize, k: f64| (12.9898 * i as f64 + 78.233 * k).sin();
        let node = |i| Vector3::new(number(i, 1.0), 2.0 * number(i, 2.0), 0.3 * number(i, 3.0));
        (0..40).map(node).collect()
    }

    fn mean(x: &[Vector3]) -> Vector3 {
        x.iter().sum::<Vector3>() / x.len() as f64
    }

    /// A body that turns and flies and swings, by much more than it bends: what counts is the bending, as far as it is from
    /// the shape at the start.
    #[test]
    fn only_bending_counts() {
        let start = nodes();
        let mut bend = Bend::default();
        bend.measure(&start, &mean(&start), 0.0, 0.0);
        let (mut travelled, mut before) = (0.0, start.clone());
        for step in 1..=400 {
            let t = 0.01 * f64::from(step);
            let turn = femdem_mesh::Rotation::from_scaled_axis(Vector3::new(1.0, -0.4, 0.3) * t);
            let swing = 0.01 * (20.0 * t).sin();
            let place = |x: &Vector3| {
                let x = x + Vector3::new(0.0, 0.0, swing * x.x * x.x);
                turn * x + Vector3::new(3.0, 1.0, 0.0) * t
            };
            let x: Vec<Vector3> = start.iter().map(place).collect();
            let ways = x.iter().zip(&before).map(|(x, y)| (x - y).norm());
            travelled += ways.fold(0.0, f64::max);
            before.clone_from(&x);
            bend.measure(&x, &mean(&x), travelled, 0.1);
            // No node is farther than this from a rigid body that follows.
            assert!(bend.motion() <= 2.0 * 0.0101, "{}", bend.motion());
        }
        assert!(travelled > 10.0 && bend.base == 0.0);
        // More than that: by 0.1 at the ends, less what a rotation and the mean take away.
        let turn = femdem_mesh::Rotation::from_scaled_axis(Vector3::new(4.0, -1.6, 1.2));
        let x: Vec<Vector3> = start
            .iter()
            .map(|x| turn * (x + Vector3::z() * (0.1 * x.x * x.x)))
            .collect();
        bend.measure(&x, &mean(&x), travelled + 10.0, 0.01);
        assert!((0.03..=0.1).contains(&bend.base), "{}", bend.base);
    }

    #[test]
    fn rational_rotations_are_rotations() {
        let turn = rational(&Vector3::new(0.4, -0.9, 0.2));
        assert!((turn * turn.transpose() - Matrix3::identity()).norm() < 1e-15);
        let small = Vector3::new(1e-4, -2e-4, 3e-4);
        let x = Vector3::new(1.0, 2.0, -1.0);
        assert!((rational(&small) * x - x - small.cross(&x)).norm() < 1e-6);
    }
}
