//! Four numbers that are processed at a time where the processor can.

use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Four numbers. Every operation is that of IEEE 754 number by number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Row(pub [f64; 4]);

impl Row {
    #[inline(always)]
    pub fn all(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self([f(a, p), f(b, q), f(c, r), f(d, s)])
    }

    /// The first three moved up by one: (b, c, a, d).
    #[inline(always)]
    pub fn turned(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([b, c, a, d])
    }

    /// The larger ones. (Plain comparison: `f64::max` also handles NaN.)
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.with(other, |a, b| if a < b { a } else { b })
    }

    /// The smallest of the four.
    #[inline(always)]
    pub fn least(self) -> f64 {
        let lower = |a: f64, b: f64| if a < b { a } else { b };
        let [a, b, c, d] = self.0;
        lower(lower(a, b), lower(c, d))
    }

    /// Which numbers pass a test, as bits.
    #[inline(always)]
    pub fn bits(self, test: impl Fn(f64) -> bool) -> u8 {
        let [a, b, c, d] = self.0.map(|x| u8::from(test(x)));
        a | b << 1 | c << 2 | d << 3
    }
}

impl Add for Row {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }
}

impl Sub for Row {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }
}

impl Mul for Row {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }
}

impl Div for Row {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(other, |a, b| a / b)
    }
}

impl Mul<f64> for Row {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        self * Self::all(by)
    }
}

impl AddAssign for Row {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
