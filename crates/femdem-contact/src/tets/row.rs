//! Four numbers at a time: by AVX2 where the machine has it, otherwise one by one.
//!
//! Sums, products and quotients are those of IEEE 754 for each number, never fused, so that both give the same bits.

use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Arithmetic of four numbers. Every method is inlined into code for the instruction set of the type.
pub(crate) trait Lanes: Copy {
    type F: Copy;
    fn load(self, numbers: [f64; 4]) -> Self::F;
    fn store(self, a: Self::F) -> [f64; 4];
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger ones, those of `b` where they cannot be compared.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// As bits, which numbers of `a` are no larger than those of `b`.
    fn at_most(self, a: Self::F, b: Self::F) -> u8;
    /// (b, c, a, d).
    fn turned(self, a: Self::F) -> Self::F;
    /// (d, d, d, d).
    fn fourth(self, a: Self::F) -> Self::F;
}

/// One by one, for any processor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plain;

#[inline(always)]
fn each([a, b, c, d]: [f64; 4], [p, q, r, s]: [f64; 4], f: impl Fn(f64, f64) -> f64) -> [f64; 4] {
    [f(a, p), f(b, q), f(c, r), f(d, s)]
}

impl Lanes for Plain {
    type F = [f64; 4];

    #[inline(always)]
    fn load(self, numbers: [f64; 4]) -> [f64; 4] {
        numbers
    }

    #[inline(always)]
    fn store(self, a: [f64; 4]) -> [f64; 4] {
        a
    }

    #[inline(always)]
    fn add(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each(a, b, |a, b| a / b)
    }

    #[inline(always)]
    fn max(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn min(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn at_most(self, [a, b, c, d]: [f64; 4], [p, q, r, s]: [f64; 4]) -> u8 {
        u8::from(a <= p) | u8::from(b <= q) << 1 | u8::from(c <= r) << 2 | u8::from(d <= s) << 3
    }

    #[inline(always)]
    fn turned(self, [a, b, c, d]: [f64; 4]) -> [f64; 4] {
        [b, c, a, d]
    }

    #[inline(always)]
    fn fourth(self, [.., d]: [f64; 4]) -> [f64; 4] {
        [d; 4]
    }
}

/// AVX2, where the machine has it.
#[cfg(target_arch = "x86_64")]
pub(crate) use pulp::x86::V3;

#[cfg(target_arch = "x86_64")]
impl Lanes for V3 {
    type F = std::arch::x86_64::__m256d;

    #[inline(always)]
    fn load(self, [a, b, c, d]: [f64; 4]) -> Self::F {
        pulp::cast(pulp::f64x4(a, b, c, d))
    }

    #[inline(always)]
    fn store(self, a: Self::F) -> [f64; 4] {
        pulp::cast(a)
    }

    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        self.avx._mm256_add_pd(a, b)
    }

    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        self.avx._mm256_sub_pd(a, b)
    }

    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        self.avx._mm256_mul_pd(a, b)
    }

    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        self.avx._mm256_div_pd(a, b)
    }

    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        self.avx._mm256_max_pd(a, b)
    }

    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        self.avx._mm256_min_pd(a, b)
    }

    #[inline(always)]
    fn at_most(self, a: Self::F, b: Self::F) -> u8 {
        let below = self
            .avx
            ._mm256_cmp_pd::<{ std::arch::x86_64::_CMP_LE_OQ }>(a, b);
        self.avx._mm256_movemask_pd(below) as u8
    }

    #[inline(always)]
    fn turned(self, a: Self::F) -> Self::F {
        self.avx2._mm256_permute4x64_pd::<0b11_00_10_01>(a)
    }

    #[inline(always)]
    fn fourth(self, a: Self::F) -> Self::F {
        self.avx2._mm256_permute4x64_pd::<0b11_11_11_11>(a)
    }
}

/// Four numbers, and how they are processed.
#[derive(Clone, Copy)]
pub(crate) struct Row<L: Lanes> {
    numbers: L::F,
    lanes: L,
}

impl<L: Lanes> Row<L> {
    #[inline(always)]
    pub fn new(lanes: L, numbers: [f64; 4]) -> Self {
        Self {
            numbers: lanes.load(numbers),
            lanes,
        }
    }

    #[inline(always)]
    pub fn all(lanes: L, value: f64) -> Self {
        Self::new(lanes, [value; 4])
    }

    #[inline(always)]
    pub fn get(self) -> [f64; 4] {
        self.lanes.store(self.numbers)
    }

    #[inline(always)]
    fn with(self, numbers: L::F) -> Self {
        Self { numbers, ..self }
    }

    /// The first three moved up by one: (b, c, a, d).
    #[inline(always)]
    pub fn turned(self) -> Self {
        self.with(self.lanes.turned(self.numbers))
    }

    /// The fourth number four times.
    #[inline(always)]
    pub fn fourth(self) -> Self {
        self.with(self.lanes.fourth(self.numbers))
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.with(self.lanes.max(self.numbers, other.numbers))
    }

    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.with(self.lanes.min(self.numbers, other.numbers))
    }

    /// Which numbers are at most `value`, as bits.
    #[inline(always)]
    pub fn at_most(self, value: f64) -> u8 {
        self.lanes
            .at_most(self.numbers, self.lanes.load([value; 4]))
    }

    /// Which numbers are at least `value`, as bits.
    #[inline(always)]
    pub fn at_least(self, value: f64) -> u8 {
        self.lanes
            .at_most(self.lanes.load([value; 4]), self.numbers)
    }
}

impl<L: Lanes> Add for Row<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(self.lanes.add(self.numbers, other.numbers))
    }
}

impl<L: Lanes> Sub for Row<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(self.lanes.sub(self.numbers, other.numbers))
    }
}

impl<L: Lanes> Mul for Row<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(self.lanes.mul(self.numbers, other.numbers))
    }
}

impl<L: Lanes> Div for Row<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(self.lanes.div(self.numbers, other.numbers))
    }
}

impl<L: Lanes> Mul<f64> for Row<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        self.with(self.lanes.mul(self.numbers, self.lanes.load([by; 4])))
    }
}

impl<L: Lanes> AddAssign for Row<L> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
