//! Linear neo-Hookean tetrahedra, eight at a time, in structure-of-arrays blocks.
//!
//! The arithmetic is that of [`NeoHookean`] on arrays of eight lanes, in sums, products and quotients
//! alone, the logarithm included: the compiler makes vector instructions of it, and since it never
//! contracts a product and a sum, every build and every instruction set gives the same bits.

use crate::material::NeoHookean;
use femdem_mesh::{Matrix3, Vector3};
use std::ops::{Add, Div, Mul, Sub};

/// Elements per block.
pub(crate) const LANES: usize = 8;

/// One number for each element of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lanes([f64; LANES]);

macro_rules! lanewise {
    ($trait:ident, $method:ident) => {
        impl $trait for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for (a, b) in self.0.iter_mut().zip(other.0) {
                    *a = a.$method(b);
                }
                self
            }
        }
    };
}
lanewise!(Add, add);
lanewise!(Sub, sub);
lanewise!(Mul, mul);
lanewise!(Div, div);

impl Lanes {
    #[inline(always)]
    fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    /// Natural logarithm of positive normal numbers to a few roundings: ln x = e ln 2 + 2 artanh s with
    /// x = 2^e m, m from sqrt(1/2) to sqrt 2, s = (m - 1)/(m + 1), by the series of artanh to s^21.
    #[inline(always)]
    fn ln(self) -> Self {
        const ONE: u64 = 1.0_f64.to_bits();
        const SQRT_HALF: u64 = std::f64::consts::FRAC_1_SQRT_2.to_bits();
        const MANTISSA: u64 = (1 << 52) - 1;
        // Bits below 2^52 as a number: put behind those of 2^52.
        const SHIFT: f64 = (1_u64 << 52) as f64;
        let (mut mantissa, mut exponent) = ([0.0; LANES], [0.0; LANES]);
        for (lane, x) in self.0.into_iter().enumerate() {
            let bits = x.to_bits().wrapping_add(ONE - SQRT_HALF);
            exponent[lane] = f64::from_bits((bits >> 52) | SHIFT.to_bits()) - (SHIFT + 1023.0);
            mantissa[lane] = f64::from_bits((bits & MANTISSA).wrapping_add(SQRT_HALF));
        }
        let m = Self(mantissa);
        let s = (m - Self::all(1.0)) / (m + Self::all(1.0));
        let (z, over) = (s * s, |k: f64| Self::all(1.0 / k));
        let (z2, z4) = (z * z, z * z * (z * z));
        let low = over(3.0) * z + Self::all(1.0) + (over(7.0) * z + over(5.0)) * z2;
        let middle = over(11.0) * z + over(9.0) + (over(15.0) * z + over(13.0)) * z2;
        let high = over(19.0) * z + over(17.0) + over(21.0) * z2;
        let series = low + (middle + high * z4) * z4;
        (s + s) * series + Self(exponent) * Self::all(std::f64::consts::LN_2)
    }
}

/// Eight elements. Lanes beyond the last element repeat it without volume.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    nodes: [[u32; 4]; LANES],
    /// Gradients of the barycentric coordinates of corners 1 to 3, by rows.
    inverse: [Lanes; 9],
    volume: Lanes,
    lambda: Lanes,
    shear: Lanes,
    /// How many are elements.
    count: usize,
}

/// An element as a block takes it in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlockElement<'a> {
    pub nodes: [u32; 4],
    pub inverse: &'a Matrix3,
    pub volume: f64,
    pub material: &'a NeoHookean,
}

impl Block {
    /// A block of one to eight elements; `None` of none.
    pub fn new(elements: &[BlockElement]) -> Option<Self> {
        let last = elements.last()?;
        let at = |lane: usize| elements.get(lane).unwrap_or(last);
        let lanes = |f: &dyn Fn(&BlockElement) -> f64| Lanes(std::array::from_fn(|l| f(at(l))));
        Some(Self {
            nodes: std::array::from_fn(|lane| at(lane).nodes),
            inverse: std::array::from_fn(|k| lanes(&|e| e.inverse[(k / 3, k % 3)])),
            volume: Lanes(std::array::from_fn(|l| {
                elements.get(l).map_or(0.0, |e| e.volume)
            })),
            lambda: lanes(&|e| e.material.moduli().lambda),
            shear: lanes(&|e| e.material.moduli().shear),
            count: elements.len().min(LANES),
        })
    }
}

/// The stored energy of some blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BatchEnergy {
    energy: Lanes,
    /// NaN where an element was inverted.
    check: Lanes,
}

impl BatchEnergy {
    pub fn new() -> Self {
        Self {
            energy: Lanes::all(0.0),
            check: Lanes::all(0.0),
        }
    }

    /// The sum, J; `None` if an element is inverted or not finite.
    pub fn sum(&self) -> Option<f64> {
        let checked = (self.energy + self.check).0;
        let sum: f64 = checked.iter().sum();
        sum.is_finite().then_some(sum)
    }
}

impl Block {
    /// Gives the nodal forces of every element, with its nodes, to `sink`, and adds its energy.
    #[inline(always)]
    pub fn forces(
        &self,
        x: &[Vector3],
        total: &mut BatchEnergy,
        mut sink: impl FnMut(usize, &[u32; 4], &[Vector3; 4]),
    ) {
        // F, by rows, from the edges at corner 0.
        let mut edges = [Lanes::all(0.0); 9];
        for (lane, nodes) in self.nodes.iter().enumerate() {
            let [a, b, c, d] = nodes.map(|i| x[i as usize]);
            for i in 0..3 {
                edges[3 * i].0[lane] = b[i] - a[i];
                edges[3 * i + 1].0[lane] = c[i] - a[i];
                edges[3 * i + 2].0[lane] = d[i] - a[i];
            }
        }
        let inv = &self.inverse;
        let f: [Lanes; 9] = std::array::from_fn(|k| {
            let (row, j) = (3 * (k / 3), k % 3);
            edges[row] * inv[j] + edges[row + 1] * inv[3 + j] + edges[row + 2] * inv[6 + j]
        });
        let cofactor = [
            f[4] * f[8] - f[5] * f[7],
            f[5] * f[6] - f[3] * f[8],
            f[3] * f[7] - f[4] * f[6],
            f[2] * f[7] - f[1] * f[8],
            f[0] * f[8] - f[2] * f[6],
            f[1] * f[6] - f[0] * f[7],
            f[1] * f[5] - f[2] * f[4],
            f[2] * f[3] - f[0] * f[5],
            f[0] * f[4] - f[1] * f[3],
        ];
        let j = f[0] * cofactor[0] + f[1] * cofactor[1] + f[2] * cofactor[2];
        for (check, j) in total.check.0.iter_mut().zip(j.0) {
            let sound = (f64::MIN_POSITIVE..f64::INFINITY).contains(&j);
            *check = if sound { *check } else { f64::NAN };
        }

        // W and V P = V (mu F + (lambda ln J - mu) F^-T).
        let (log_j, half, volume) = (j.ln(), Lanes::all(0.5), self.volume);
        let mut norm2 = f[0] * f[0];
        for entry in &f[1..] {
            norm2 = norm2 + *entry * *entry;
        }
        let isochoric = self.shear * half * (norm2 - Lanes::all(3.0));
        let volumetric = (self.lambda * half * log_j - self.shear) * log_j;
        total.energy = total.energy + (isochoric + volumetric) * volume;
        let by_cofactor = (self.lambda * log_j - self.shear) / j * volume;
        let by_gradient = self.shear * volume;
        let stress: [Lanes; 9] =
            std::array::from_fn(|k| by_gradient * f[k] + by_cofactor * cofactor[k]);
        let pulls: [Lanes; 9] = std::array::from_fn(|k| {
            let (row, a) = (3 * (k / 3), 3 * (k % 3));
            stress[row] * inv[a] + stress[row + 1] * inv[a + 1] + stress[row + 2] * inv[a + 2]
        });
        let first: [Lanes; 3] =
            std::array::from_fn(|i| pulls[3 * i] + pulls[3 * i + 1] + pulls[3 * i + 2]);
        for (lane, nodes) in self.nodes.iter().enumerate().take(self.count) {
            let on = |a: usize| Vector3::from_fn(|i, _| -pulls[3 * i + a].0[lane]);
            let at_first = Vector3::from_fn(|i, _| first[i].0[lane]);
            sink(lane, nodes, &[at_first, on(0), on(1), on(2)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the logarithm of the standard library, near 1 and far from it.
    #[test]
    fn logarithm_to_rounding() {
        let mut x = 1e-300_f64;
        while x < 1e300 {
            let close = 1.0 + (x.ln() * 7.0).sin() * 1e-3;
            let arguments = [
                x,
                x * 1.1,
                x * 1.3,
                x * 1.7,
                close,
                close + 0.2,
                0.5,
                2.0_f64.sqrt(),
            ];
            for (found, x) in Lanes(arguments).ln().0.into_iter().zip(arguments) {
                let error = (found - x.ln()).abs();
                assert!(error <= 8e-16 * x.ln().abs(), "{x:e}: {error:e}");
            }
            x *= 1.37;
        }
        assert_eq!(Lanes::all(1.0).ln(), Lanes::all(0.0));
    }
}
