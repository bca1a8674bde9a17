//! Eigenvalues and eigenvectors of symmetric 3 x 3 matrices.

use femdem_mesh::Matrix3;

/// S = sum_A values[A] n_A (x) n_A with n_A the columns of `vectors`, orthonormal to round-off.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spectral {
    /// Eigenvalues, in no order.
    pub values: [f64; 3],
    /// Eigenvectors as columns, in the order of the values.
    pub vectors: Matrix3,
}

impl Spectral {
    /// Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 4th ed., section 8.5): as
    /// accurate for equal eigenvalues as for distinct ones. The upper triangle is read. A matrix that
    /// is not finite gives values that are not finite.
    pub fn of(symmetric: &Matrix3) -> Self {
        // Convergence is quadratic: five sweeps reach round-off, the rest is for safety.
        const SWEEPS: usize = 12;
        let mut s = *symmetric;
        let mut vectors = Matrix3::identity();
        for _ in 0..SWEEPS {
            let off = s.m12 * s.m12 + s.m13 * s.m13 + s.m23 * s.m23;
            let diagonal = s.m11 * s.m11 + s.m22 * s.m22 + s.m33 * s.m33;
            // Squares: off-diagonal entries below 1e-18 of the norm change no bit of a result.
            if off <= 1e-36 * diagonal {
                break;
            }
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                rotate(&mut s, &mut vectors, p, q);
            }
        }
        let values = [s.m11, s.m22, s.m33];
        Self { values, vectors }
    }
}

/// The rotation in the plane (p, q) that makes s_pq zero.
fn rotate(s: &mut Matrix3, vectors: &mut Matrix3, p: usize, q: usize) {
    if s[(p, q)] == 0.0 {
        return;
    }
    // t = tan(angle), |t| <= 1, the smaller root of t^2 + t (s_qq - s_pp)/s_pq = 1.
    let (gap, twice) = (s[(q, q)] - s[(p, p)], 2.0 * s[(p, q)]);
    let size = (gap * gap + twice * twice).sqrt();
    let sum = gap.abs() + size;
    let tangent = twice.copysign(twice * gap) / sum;
    let cosine = (0.5 * sum / size).sqrt();
    let sine = tangent * cosine;
    let r = 3 - p - q;
    let (pq, rp, rq) = (s[(p, q)], s[(p.min(r), p.max(r))], s[(q.min(r), q.max(r))]);
    s[(p, p)] -= tangent * pq;
    s[(q, q)] += tangent * pq;
    s[(p, q)] = 0.0;
    s[(p.min(r), p.max(r))] = cosine * rp - sine * rq;
    s[(q.min(r), q.max(r))] = sine * rp + cosine * rq;
    for i in 0..3 {
        let (vp, vq) = (vectors[(i, p)], vectors[(i, q)]);
        vectors[(i, p)] = cosine * vp - sine * vq;
        vectors[(i, q)] = sine * vp + cosine * vq;
    }
}

/// A lower bound of the smallest eigenvalue of a symmetric matrix, whose eigenvalues have the mean `mean`.
///
/// The smallest root t of the characteristic polynomial t^3 - 3 p t - 2 q of the deviator is between
/// -2 sqrt p and -sqrt p, where the polynomial rises and is concave: Newton's steps from the left end
/// approach it from below. Four bring it within 0.1 sqrt p where two eigenvalues are equal, and to
/// rounding where they are well apart.
pub(crate) fn smallest_below(symmetric: &Matrix3, mean: f64) -> f64 {
    let s = symmetric;
    let (a, b, c) = (s.m11 - mean, s.m22 - mean, s.m33 - mean);
    let (bc, ac, ab) = (s.m23, s.m13, s.m12);
    let p = (a * a + b * b + c * c + 2.0 * (bc * bc + ac * ac + ab * ab)) / 6.0;
    let determinant = a * (b * c - bc * bc) - ab * (ab * c - bc * ac) + ac * (ab * bc - b * ac);
    let root = p.sqrt();
    let mut t = -2.0 * root;
    for _ in 0..4 {
        let slope = 3.0 * (t * t - p);
        if slope > 0.0 {
            t -= (t * (t * t - 3.0 * p) - determinant) / slope;
        }
    }
    mean + t.min(-root)
}

/// Bounds of the eigenvalues of a symmetric matrix: at most the smallest, at least the largest. They are exact to
/// rounding (1e-7 of |S|) where two eigenvalues are equal, and off by 0.0074 sqrt p at most, with 6 p = |deviator|^2. Not finite if the matrix is not.
///
/// The eigenvalues are mean + 2 sqrt p cos(theta + 2 pi k/3) with cos 3 theta = det(deviator) / (2 p^1.5). With y the cosine of
/// 3 theta/2, the largest has cos theta = cos(2/3 arccos y), which lies below the parabola through its ends that has its slope at 0.
#[inline]
pub(crate) fn range_around(symmetric: &Matrix3) -> [f64; 2] {
    let s = symmetric;
    let mean = (s.m11 + s.m22 + s.m33) / 3.0;
    let (a, b, c) = (s.m11 - mean, s.m22 - mean, s.m33 - mean);
    let (bc, ac, ab) = (s.m23, s.m13, s.m12);
    let p = (a * a + b * b + c * c + 2.0 * (bc * bc + ac * ac + ab * ab)) / 6.0;
    let determinant = a * (b * c - bc * bc) - ab * (ab * c - bc * ac) + ac * (ab * bc - b * ac);
    let root = p.sqrt();
    let cube = 2.0 * p * root;
    let triple = if cube == 0.0 {
        0.0
    } else {
        (determinant / cube).clamp(-1.0, 1.0)
    };
    let above = |y: f64| {
        const SLOPE: f64 = 0.577_350_269_189_625_8;
        1.0 + y * (2.0 * SLOPE + y * (1.0 - 2.0 * SLOPE))
    };
    let (largest, smallest) = (0.5 + 0.5 * triple, 0.5 - 0.5 * triple);
    [
        mean - root * above(smallest.sqrt()),
        mean + root * above(largest.sqrt()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Vector3;
    use proptest::prelude::*;

    /// A symmetric matrix with spectra from well apart to equal, at scales from 1e-6 to 1e6.
    fn symmetric() -> impl Strategy<Value = Matrix3> {
        let gap = prop_oneof![Just(0.0), (-15.0..0.0_f64).prop_map(|e| 10_f64.powf(e))];
        let values = (0.1..2.0_f64, gap.clone(), gap, -6.0..6.0_f64);
        (values, prop::array::uniform3(-1.0..1.0_f64), -3.0..3.0_f64).prop_map(
            |((base, first, second, scale), axis, angle)| {
                let values = Vector3::new(base, base + first, base - 0.5 * second);
                let q =
                    femdem_mesh::nalgebra::Rotation3::new(Vector3::from(axis).normalize() * angle);
                q * Matrix3::from_diagonal(&(values * 10_f64.powf(scale))) * q.transpose()
            },
        )
    }

    proptest! {
        #[test]
        fn the_spectrum_gives_the_matrix_back(s in symmetric()) {
            let Spectral { values, vectors } = Spectral::of(&s);
            let back = vectors * Matrix3::from_diagonal(&values.into()) * vectors.transpose();
            prop_assert!((back - s).norm() < 4e-15 * s.norm());
            prop_assert!((vectors.tr_mul(&vectors) - Matrix3::identity()).norm() < 4e-15);
        }
    }

    /// (x - 1)(x - 2)(x - 4) as the characteristic polynomial of a matrix with rational entries:
    /// Q diag(1, 2, 4) Q^T with Q = I - 2 v v^T/9, v = (1, 2, 2).
    #[test]
    fn known_eigenvalues() {
        let v = Vector3::new(1.0, 2.0, 2.0);
        let q = Matrix3::identity() - v * v.transpose() * (2.0 / 9.0);
        let s = q * Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 4.0)) * q.transpose();
        let mut values = Spectral::of(&s).values;
        values.sort_by(f64::total_cmp);
        for (value, expected) in values.iter().zip([1.0, 2.0, 4.0]) {
            assert!((value - expected).abs() < 1e-14);
        }
        assert!(
            Spectral::of(&(s * f64::NAN))
                .values
                .iter()
                .any(|v| v.is_nan())
        );
    }

    proptest! {
        /// Against Jacobi's rotations.
        #[test]
        fn the_smallest_from_below(s in symmetric()) {
            let exact = Spectral::of(&s).values.into_iter().fold(f64::INFINITY, f64::min);
            let mean = s.trace() / 3.0;
            let spread = (s - Matrix3::identity() * mean).norm() / 6_f64.sqrt();
            let below = smallest_below(&s, mean);
            prop_assert!(below <= exact + 1e-14 * s.norm(), "{below:e} {exact:e}");
            prop_assert!(below >= exact - 0.1 * spread - 1e-14 * s.norm(), "{below:e} {exact:e}");
        }
    }

    proptest! {
        /// Against Jacobi's rotations.
        #[test]
        fn the_range_from_outside(s in symmetric()) {
            prop_assume!(s.trace().is_finite());
            let values = Spectral::of(&s).values;
            let exact = [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)];
            let mean = s.trace() / 3.0;
            let root = (s - Matrix3::identity() * mean).norm() / 6_f64.sqrt();
            let rounding = 1e-14 * s.norm() + 1e-7 * (root * s.norm()).sqrt();
            let [smallest, largest] = range_around(&s);
            for excess in [exact[0] - smallest, largest - exact[1]] {
                prop_assert!(excess >= -rounding, "{excess:e} of {root:e}");
                prop_assert!(excess <= 0.0074 * root + rounding, "{excess:e} of {root:e}");
            }
        }
    }

    /// Uniaxial tension and compression, none, and what is not finite.
    #[test]
    fn the_range_of_simple_matrices() {
        let x = Matrix3::from_diagonal(&Vector3::new(3.0, 0.0, 0.0));
        for (s, range) in [(x, [0.0, 3.0]), (-x, [-3.0, 0.0]), (x * 0.0, [0.0; 2])] {
            let found = range_around(&s);
            assert!((found[0] - range[0]).abs() + (found[1] - range[1]).abs() < 1e-14);
        }
        for bad in [f64::NAN, f64::INFINITY] {
            for at in [0, 3] {
                let mut s = x;
                (s[at], s[(at % 3, at / 3)]) = (bad, bad);
                assert!(range_around(&s).iter().all(|v| !v.is_finite()));
            }
        }
    }
}
