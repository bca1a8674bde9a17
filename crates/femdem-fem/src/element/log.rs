//! The natural logarithm in lanes.

use super::lanes::{Lanes, Row};
use std::f64::consts::{FRAC_1_SQRT_2, LN_2, SQRT_2};

/// (artanh s)/s = 1 + c_1 s^2 + c_2 s^4 + ..., for |s| <= (sqrt 2 - 1)/(sqrt 2 + 1): the polynomial of least
/// largest relative error, 1.3e-18, by Remez's exchange in 60 digits.
const SERIES: [f64; 8] = [
    1.0,
    0.333_333_333_333_336_7,
    0.199_999_999_997_071_6,
    0.142_857_143_712_372,
    0.111_110_992_817_762_77,
    0.090_917_824_312_501_74,
    0.076_570_179_778_209_58,
    0.073_980_520_646_090_66,
];

/// 2 artanh s.
#[inline(always)]
pub(super) fn twice_artanh<S: Lanes>(l: S, s: S::F) -> S::F {
    let z = l.mul(s, s);
    let z2 = l.mul(z, z);
    let z4 = l.mul(z2, z2);
    let low = l.add(pair(l, 0, z), l.mul(pair(l, 2, z), z2));
    let high = l.add(pair(l, 4, z), l.mul(pair(l, 6, z), z2));
    l.mul(l.add(s, s), l.add(low, l.mul(high, z4)))
}

#[inline(always)]
fn pair<S: Lanes>(l: S, k: usize, z: S::F) -> S::F {
    l.add(l.all(SERIES[k]), l.mul(l.all(SERIES[k + 1]), z))
}

/// Natural logarithm to a few roundings: ln x = e ln 2 + 2 artanh s with x = 2^e m, m from sqrt(1/2) to
/// sqrt 2, s = (m - 1)/(m + 1); nearly always e = 0 in all lanes. NaN in place of the logarithm of
/// numbers that are not positive and normal.
#[inline(always)]
pub(super) fn ln<S: Lanes>(l: S, x: S::F) -> S::F {
    if l.all_within(x, FRAC_1_SQRT_2, SQRT_2) {
        near_one(l, x)
    } else {
        let (mantissa, exponent) = split(l.store(x));
        let of_mantissa = near_one(l, l.load(&mantissa));
        l.add(of_mantissa, l.mul(l.load(&exponent), l.all(LN_2)))
    }
}

#[inline(always)]
fn near_one<S: Lanes>(l: S, m: S::F) -> S::F {
    let one = l.all(1.0);
    twice_artanh(l, l.div(l.sub(m, one), l.add(m, one)))
}

/// m and e with x = 2^e m.
#[cold]
#[inline(never)]
fn split(x: Row) -> (Row, Row) {
    const ONE: u64 = 1.0_f64.to_bits();
    const SQRT_HALF: u64 = FRAC_1_SQRT_2.to_bits();
    const MANTISSA: u64 = (1 << 52) - 1;
    let (mut mantissa, mut exponent) = (Row::default(), Row::default());
    for (lane, x) in x.0.into_iter().enumerate() {
        let sound = (f64::MIN_POSITIVE..f64::INFINITY).contains(&x);
        let bits = x.to_bits().wrapping_add(ONE - SQRT_HALF);
        exponent.0[lane] = (bits >> 52) as f64 - 1023.0;
        mantissa.0[lane] = if sound {
            f64::from_bits((bits & MANTISSA) + SQRT_HALF)
        } else {
            f64::NAN
        };
    }
    (mantissa, exponent)
}

#[cfg(test)]
mod tests {
    use super::super::lanes::Plain;
    use super::*;

    /// Against the logarithm of the standard library, near 1 and far from it.
    #[test]
    fn logarithm_to_rounding() {
        let mut x = 1e-300_f64;
        while x < 1e300 {
            let close = 1.0 + (x.ln() * 7.0).sin() * 1e-3;
            for arguments in [
                [x, x * 1.1, x * 1.3, x * 1.7],
                [close, close + 0.2, 0.71, 1.4],
                [close, 0.5, SQRT_2, FRAC_1_SQRT_2],
            ] {
                for (found, x) in ln(Plain, arguments).into_iter().zip(arguments) {
                    let error = (found - x.ln()).abs();
                    assert!(error <= 8e-16 * x.ln().abs(), "{x:e}: {error:e}");
                }
            }
            x *= 1.37;
        }
        assert_eq!(ln(Plain, [1.0; 4]), [0.0; 4]);
    }

    /// The result of a number does not depend on its neighbours.
    #[test]
    fn lanes_are_independent() {
        for k in 0..1000 {
            let x = 0.708 + 7e-4 * f64::from(k);
            let far = ln(Plain, [x, 1e-9, 3.0, 1e9])[0];
            assert_eq!(ln(Plain, [x; 4])[0].to_bits(), far.to_bits(), "{x}");
        }
        assert!(
            ln(Plain, [-1.0, 0.0, f64::NAN, f64::INFINITY])
                .iter()
                .all(|x| x.is_nan())
        );
    }
}
