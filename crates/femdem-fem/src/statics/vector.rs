//! Sums over long vectors in a fixed order: four interleaved partial sums, so that the compiler can
//! use wide registers and the bits never depend on threads or features.

/// Sum of the products of the components.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (p, q) in a4.iter().zip(b4) {
        for k in 0..4 {
            sums[k] += p[k] * q[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(p, q)| p * q).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Euclidean length.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// y += s x.
pub(crate) fn add_scaled(y: &mut [f64], s: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += s * x;
    }
}

/// Whether every component is a finite number.
pub(crate) fn all_finite(a: &[f64]) -> bool {
    a.iter().all(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_take_every_component_once() {
        // Powers of two add without rounding: any component missed or doubled changes the sum.
        for n in 0..12 {
            let a: Vec<f64> = (0..n).map(|i| f64::from(1 << i)).collect();
            assert_eq!(dot(&a, &vec![1.0; a.len()]), f64::from((1 << n) - 1));
        }
        assert_eq!(norm(&[3.0, 0.0, 0.0, 0.0, 4.0]), 5.0);
    }

    #[test]
    fn what_is_not_finite_is_seen() {
        assert!(all_finite(&[0.0, -1e300]));
        assert!(!all_finite(&[0.0, f64::NAN]));
        assert!(!all_finite(&[f64::INFINITY]));
    }
}
