//! Four numbers at a time: with AVX2 if the machine has it, otherwise as plain arrays.
//!
//! Sums, products and quotients are those of IEEE 754 for each number, never fused, so that both give the
//! same bits.

/// Numbers of a vector.
pub(crate) const LANES: usize = 4;

/// Four numbers in memory.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C, align(32))]
pub(crate) struct Row(pub [f64; LANES]);

/// Arithmetic of four numbers. Every method is inlined into code for the instruction set of the type.
pub(super) trait Lanes: Copy {
    type F: Copy;
    fn load(self, row: &Row) -> Self::F;
    fn store(self, a: Self::F) -> Row;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// Whether all are larger than `low` and smaller than `high`.
    fn all_within(self, a: Self::F, low: f64, high: f64) -> bool;
    /// Transposes four rows.
    fn transpose(self, rows: [Self::F; 4]) -> [Self::F; 4];

    #[inline(always)]
    fn all(self, value: f64) -> Self::F {
        self.load(&Row([value; LANES]))
    }
}

/// Plain arrays, vectorised by the compiler for the target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plain;

impl Lanes for Plain {
    type F = [f64; 4];

    #[inline(always)]
    fn load(self, row: &Row) -> [f64; 4] {
        row.0
    }

    #[inline(always)]
    fn store(self, a: [f64; 4]) -> Row {
        Row(a)
    }

    #[inline(always)]
    fn add(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
    }

    #[inline(always)]
    fn sub(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
    }

    #[inline(always)]
    fn mul(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
    }

    #[inline(always)]
    fn div(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] / b[0], a[1] / b[1], a[2] / b[2], a[3] / b[3]]
    }

    #[inline(always)]
    fn all_within(self, a: [f64; 4], low: f64, high: f64) -> bool {
        a.iter().all(|x| low < *x && *x < high)
    }

    #[inline(always)]
    fn transpose(self, [a, b, c, d]: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
        [
            [a[0], b[0], c[0], d[0]],
            [a[1], b[1], c[1], d[1]],
            [a[2], b[2], c[2], d[2]],
            [a[3], b[3], c[3], d[3]],
        ]
    }
}

/// AVX2, where the machine has it.
#[cfg(target_arch = "x86_64")]
pub(super) use pulp::x86::V3;

#[cfg(target_arch = "x86_64")]
impl Lanes for V3 {
    type F = pulp::f64x4;

    #[inline(always)]
    fn load(self, row: &Row) -> pulp::f64x4 {
        let [a, b, c, d] = row.0;
        pulp::f64x4(a, b, c, d)
    }

    #[inline(always)]
    fn store(self, a: pulp::f64x4) -> Row {
        Row([a.0, a.1, a.2, a.3])
    }

    #[inline(always)]
    fn add(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.add_f64x4(a, b)
    }

    #[inline(always)]
    fn sub(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.sub_f64x4(a, b)
    }

    #[inline(always)]
    fn mul(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.mul_f64x4(a, b)
    }

    #[inline(always)]
    fn div(self, a: pulp::f64x4, b: pulp::f64x4) -> pulp::f64x4 {
        self.div_f64x4(a, b)
    }

    #[inline(always)]
    fn all_within(self, a: pulp::f64x4, low: f64, high: f64) -> bool {
        let above = self.cmp_lt_f64x4(self.splat_f64x4(low), a);
        let below = self.cmp_lt_f64x4(a, self.splat_f64x4(high));
        let both: std::arch::x86_64::__m256d = pulp::cast(self.and_m64x4(above, below));
        self.avx._mm256_movemask_pd(both) == 0b1111
    }

    #[inline(always)]
    fn transpose(self, [a, b, c, d]: [pulp::f64x4; 4]) -> [pulp::f64x4; 4] {
        let (a, b) = (pulp::cast(a), pulp::cast(b));
        let (c, d) = (pulp::cast(c), pulp::cast(d));
        let (even, odd) = (
            [
                self.avx._mm256_unpacklo_pd(a, b),
                self.avx._mm256_unpacklo_pd(c, d),
            ],
            [
                self.avx._mm256_unpackhi_pd(a, b),
                self.avx._mm256_unpackhi_pd(c, d),
            ],
        );
        [
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x20>(even[0], even[1])),
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x20>(odd[0], odd[1])),
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x31>(even[0], even[1])),
            pulp::cast(self.avx._mm256_permute2f128_pd::<0x31>(odd[0], odd[1])),
        ]
    }
}

#[inline(always)]
pub(super) fn cross<S: Lanes>(l: S, a: &[S::F; 3], b: &[S::F; 3]) -> [S::F; 3] {
    [
        l.sub(l.mul(a[1], b[2]), l.mul(a[2], b[1])),
        l.sub(l.mul(a[2], b[0]), l.mul(a[0], b[2])),
        l.sub(l.mul(a[0], b[1]), l.mul(a[1], b[0])),
    ]
}

#[inline(always)]
pub(super) fn dot<S: Lanes>(l: S, a: &[S::F; 3], b: &[S::F; 3]) -> S::F {
    l.add(
        l.add(l.mul(a[0], b[0]), l.mul(a[1], b[1])),
        l.mul(a[2], b[2]),
    )
}
