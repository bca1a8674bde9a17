//! Symmetric tensors: principal values and directions.

use femdem_mesh::Vector3;
use femdem_mesh::nalgebra::Matrix3;

/// Rows of a matrix, for tables and JSON.
pub(crate) fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[(i, j)]))
}

/// Principal values, largest first, and unit directions of a symmetric matrix, by Jacobi rotations.
///
/// The largest coordinate of each direction is positive, so that the sign is unique.
pub(crate) fn principal(m: &Matrix3<f64>) -> ([f64; 3], [Vector3; 3]) {
    let mut a = *m;
    let mut v = Matrix3::identity();
    // Convergence is quadratic: five sweeps reach round-off, the others are a reserve.
    for _ in 0..12 {
        let off = a[(0, 1)].abs() + a[(0, 2)].abs() + a[(1, 2)].abs();
        if off <= f64::EPSILON * f64::EPSILON * a.amax() {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| a[(*j, *j)].total_cmp(&a[(*i, *i)]));
    let direction = |k: usize| {
        let column: Vector3 = v.column(k).into_owned();
        let largest = column[column.iamax()];
        if largest < 0.0 { -column } else { column }
    };
    (order.map(|k| a[(k, k)]), order.map(direction))
}

/// One Jacobi rotation in the plane of axes `p` and `q`, which makes `a[p][q]` zero.
fn rotate(a: &mut Matrix3<f64>, v: &mut Matrix3<f64>, p: usize, q: usize) {
    if a[(p, q)] == 0.0 {
        return;
    }
    let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * a[(p, q)]);
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    let mut turn = Matrix3::identity();
    (turn[(p, p)], turn[(q, q)]) = (c, c);
    (turn[(p, q)], turn[(q, p)]) = (s, -s);
    *a = turn.transpose() * *a * turn;
    *v *= turn;
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    #[test]
    fn degenerate_matrices() {
        assert_eq!(principal(&Matrix3::zeros()).0, [0.0; 3]);
        let (values, directions) = principal(&Matrix3::from_diagonal_element(2.0));
        assert_eq!(values, [2.0; 3]);
        assert_eq!(directions, [Vector3::x(), Vector3::y(), Vector3::z()]);
    }

    proptest! {
        /// Values and directions are recovered from a matrix made with known values and a known rotation.
        #[test]
        fn values_and_directions_come_back(
            values in [-3.0..3.0_f64, -3.0..3.0, -3.0..3.0],
            angles in [-3.0..3.0_f64, -1.5..1.5, -3.0..3.0],
            scale in prop::sample::select(vec![1e-9, 1.0, 1e12]),
        ) {
            let turn = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
            let r = turn.to_rotation_matrix().into_inner();
            let m = r * Matrix3::from_diagonal(&Vector3::from(values)) * r.transpose() * scale;
            let m = (m + m.transpose()) * 0.5;
            let (found, directions) = principal(&m);
            let mut sorted = values.map(|x| x * scale);
            sorted.sort_by(|a, b| b.total_cmp(a));
            for (k, direction) in directions.iter().enumerate() {
                prop_assert!((found[k] - sorted[k]).abs() < 1e-13 * scale);
                prop_assert!((m * direction - direction * found[k]).norm() < 1e-13 * scale);
                prop_assert!((direction.norm() - 1.0).abs() < 1e-13);
            }
        }
    }
}
