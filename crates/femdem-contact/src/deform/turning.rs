//! The rotation of a deformable body as a whole.
//!
//! The dashpots of a contact that act on bodies as wholes ([`crate::rocking`], [`super::body_dashpot`]) need the
//! velocity of a deformable body's centre, and its angular velocity ω = I⁻¹ Σ m_a r_a × v_a. A moment M acts on all of
//! its nodes as f_a = m_a (I⁻¹ M) × r_a. The two are conjugate: the power is M·ω for any motion of the nodes, so a
//! dashpot only dissipates; and Σ f_a = 0, Σ r_a × f_a = M, so momentum and angular momentum are conserved. The forces
//! rotate the body as if it were rigid and strain nothing, so that their rate is that of a body and not that of an
//! element: it hardly shortens the step. (Dashpots between the nodes in contact would have the rate of the nodes; at
//! the same cost in step length they would damp the rocking of a body a hundred times less.)

use super::record::NodalState;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Rotation of a deformable body as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Turning {
    /// Masses of the free nodes, kg, 0 for prescribed ones; 1 for all if no node is free.
    weights: Vec<f64>,
    /// Their centre, m.
    centre: Vector3,
    /// I⁻¹ of the weights, 1/(kg m^2).
    inverse_inertia: Matrix3,
    /// Sum of the weights.
    total: f64,
    /// Whether all nodes are free.
    whole: bool,
    /// Velocity of the centre, m/s.
    velocity: Vector3,
    /// Angular velocity, rad/s.
    pub rate: Vector3,
    /// The same as `inverse_inertia`; 0 if no node is free.
    pub mobility: Matrix3,
}

impl Turning {
    /// `None` if the free nodes lie on a line. Reuses the list of weights of `before`, if given.
    pub fn new(state: &NodalState, before: Option<Self>) -> Option<Self> {
        let mut weights = before.map_or_else(Vec::new, |t| t.weights);
        weights.clear();
        let mass = |w: &f64| if *w > 0.0 { 1.0 / w } else { 0.0 };
        weights.extend(state.inverse_masses.iter().map(mass));
        let is_free = weights.iter().any(|m| *m > 0.0);
        if !is_free {
            weights.fill(1.0);
        }
        let (mut total, mut first) = (0.0, Vector3::zeros());
        for (x, m) in state.positions.iter().zip(&weights) {
            total += m;
            first += x * *m;
        }
        let centre = first / total;
        let (mut second, mut momentum) = (Matrix3::zeros(), Vector3::zeros());
        let mut linear = Vector3::zeros();
        for ((x, v), m) in state.positions.iter().zip(state.velocities).zip(&weights) {
            let r = x - centre;
            let weighted = r * *m;
            second += weighted * r.transpose();
            momentum += weighted.cross(v);
            linear += v * *m;
        }
        let trace = second.trace();
        let inertia = Matrix3::from_diagonal_element(trace) - second;
        // For nodes on a line one moment is zero, and I/trace has the determinant 0.
        let least = 1e-9 * trace.powi(3);
        if inertia.determinant().is_nan() || inertia.determinant() <= least {
            return None;
        }
        let inverse_inertia = inertia.try_inverse()?;
        Some(Self {
            total,
            whole: is_free && weights.iter().all(|m| *m > 0.0),
            velocity: linear / total,
            rate: inverse_inertia * momentum,
            mobility: if is_free {
                inverse_inertia
            } else {
                Matrix3::zeros()
            },
            weights,
            centre,
            inverse_inertia,
        })
    }

    /// Whether the body can move as a whole: no node is held in all directions.
    pub fn is_whole(&self) -> bool {
        self.whole
    }

    /// m.
    pub fn centre(&self) -> &Vector3 {
        &self.centre
    }

    /// The same of an image of the body that is `way` (m) away and moves by `velocity` (m/s) faster.
    pub fn seen_from(&self, way: &Vector3, velocity: &Vector3) -> Self {
        let mut seen = self.clone();
        seen.centre += way;
        seen.velocity += velocity;
        seen
    }

    /// |f|²/M + t I⁻¹ t of a force (N) and a torque about the centre (N m), N²/kg.
    pub fn response(&self, force: &Vector3, torque: &Vector3) -> f64 {
        force.norm_squared() / self.total + torque.dot(&(self.inverse_inertia * torque))
    }

    /// Power of a force (N) and a torque about the centre (N m) on the body as a whole, W.
    pub fn power(&self, force: &Vector3, torque: &Vector3) -> f64 {
        force.dot(&self.velocity) + torque.dot(&self.rate)
    }

    /// Nodal forces of a force (N) and a moment about the centre (N m), for the given positions of the nodes, N.
    pub fn forces<'a>(
        &'a self,
        [force, moment]: &[Vector3; 2],
        positions: &'a [Vector3],
    ) -> impl Iterator<Item = Vector3> + 'a {
        let straight = force / self.total;
        let turning = self.inverse_inertia * moment;
        let nodes = positions.iter().zip(&self.weights);
        nodes.map(move |(x, m)| (straight + turning.cross(&(x - self.centre))) * *m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between -1 and 1 without a pattern.
    fn noise(count: usize, seed: f64) -> Vec<Vector3> {
        let number = |i: usize, k: f64| (12.9898 * i as f64 + 78.233 * k + seed).sin();
        let node = |i| Vector3::new(number(i, 1.0), number(i, 2.0), number(i, 3.0));
        (0..count).map(node).collect()
    }

    /// Nodes with unequal masses, some of which are prescribed.
    fn nodes() -> ([Vec<Vector3>; 2], Vec<f64>) {
        let inverse = |i: usize| {
            if i % 5 == 3 {
                0.0
            } else {
                0.1 + 0.05 * i as f64
            }
        };
        (
            [noise(17, 0.3), noise(17, 4.2)],
            (0..17).map(inverse).collect(),
        )
    }

    fn state<'a>(x: &'a [Vector3], v: &'a [Vector3], w: &'a [f64]) -> NodalState<'a> {
        NodalState {
            positions: x,
            velocities: v,
            inverse_masses: w,
        }
    }

    /// The nodal forces of a moment have that moment and no resultant, and do the work of the rotation for
    /// any motion of the nodes; prescribed nodes get none.
    #[test]
    fn forces_are_those_of_the_moment() {
        let ([x, v], w) = nodes();
        let turning = Turning::new(&state(&x, &v, &w), None).unwrap();
        let moment = Vector3::new(0.3, -1.2, 0.7);
        let forces: Vec<Vector3> = turning.forces(&[Vector3::zeros(), moment], &x).collect();
        let sum = |f: &dyn Fn(usize) -> Vector3| (0..17).map(f).sum::<Vector3>();
        assert!(sum(&|i| forces[i]).norm() < 1e-14);
        assert!((sum(&|i| x[i].cross(&forces[i])) - moment).norm() < 1e-14);
        let power: f64 = forces.iter().zip(&v).map(|(f, v)| f.dot(v)).sum();
        assert!((power - moment.dot(&turning.rate)).abs() < 1e-14);
        assert_eq!(forces[3], Vector3::zeros());
    }

    /// The rotation of a rigid motion is recovered; so is that of a body without free nodes.
    #[test]
    fn rigid_motions_turn_as_they_do() {
        let ([x, _], w) = nodes();
        let spin = Vector3::new(2.0, -1.0, 0.5);
        let rigid = |x: &Vector3| spin.cross(x) + Vector3::new(5.0, 1.0, -3.0);
        let v: Vec<Vector3> = x.iter().map(rigid).collect();
        for w in [w, vec![0.0; 17]] {
            let turning = Turning::new(&state(&x, &v, &w), None).unwrap();
            assert!((turning.rate - spin).norm() < 1e-13, "{}", turning.rate);
            assert_eq!(turning.mobility.trace() > 0.0, w[0] > 0.0);
        }
    }

    /// Nodes on a line can turn about it without moving.
    #[test]
    fn nodes_on_a_line_do_not_turn() {
        let x: Vec<Vector3> = (0..5)
            .map(|i| Vector3::new(1.0, 2.0, 3.0) * f64::from(i))
            .collect();
        let v = vec![Vector3::zeros(); 5];
        assert_eq!(Turning::new(&state(&x, &v, &[1.0; 5]), None), None);
    }
}
