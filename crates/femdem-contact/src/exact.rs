//! Sums that do not depend on the order of their terms.

/// Bits of a limb.
const BITS: u32 = 32;

/// Limbs of all finite numbers, 2098 bits from the least to the largest one, and two for what sums of them need more.
const LIMBS: usize = 68;

/// The least positive number is 2 to minus this.
const LEAST: i32 = 1074;

/// After so many terms the limbs are carried, so that none of them overflows.
const TERMS: u32 = 1 << 30;

/// A sum of numbers that is exact, so that it is the same in any order of its terms: of contacts on any number of threads and of
/// ranks. Its [`value`](Self::value) is rounded once.
///
/// A fixed-point number with all bits of all finite numbers, as that of Kulisch (2013, Computer Arithmetic and Validity, §8).
///
/// ```
/// use femdem_contact::ExactSum;
///
/// let terms = [1e300, 1.0, -1e300, 1e-300];
/// let sum: ExactSum = terms.into_iter().collect();
/// assert_eq!(sum.value(), 1.0);
/// assert_eq!(sum, terms.into_iter().rev().collect());
/// ```
#[derive(Debug, Clone)]
pub struct ExactSum {
    /// Digits to the base 2^32, the least first; the last has the sign.
    limbs: [i64; LIMBS],
    /// How many terms were not finite.
    lost: u64,
    /// Terms since the limbs were carried.
    terms: u32,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self {
            limbs: [0; LIMBS],
            lost: 0,
            terms: 0,
        }
    }
}

impl ExactSum {
    /// How many words [`words`](Self::words) has.
    pub const WORDS: usize = LIMBS + 2;

    /// Adds a number. One that is not finite makes the sum NaN.
    pub fn add(&mut self, term: f64) {
        let bits = term.to_bits();
        let exponent = (bits >> 52) as u32 & 0x7ff;
        if exponent == 0x7ff {
            self.lost += 1;
            return;
        }
        let fraction = bits & ((1 << 52) - 1);
        let hidden = u64::from(exponent > 0) << 52;
        // The last bit of the number over the least one.
        let shift = exponent.max(1) - 1;
        let digits = u128::from(fraction | hidden) << (shift % BITS);
        let first = (shift / BITS) as usize;
        for (k, limb) in self.limbs[first..first + 3].iter_mut().enumerate() {
            let digit = i64::from((digits >> (BITS as usize * k)) as u32);
            *limb += if bits >> 63 == 0 { digit } else { -digit };
        }
        self.terms += 1;
        if self.terms == TERMS {
            self.carry();
        }
    }

    /// The sum as words: sums of the words of parts, word by word, are words of the sum of the parts, for up to 2^30 parts.
    pub fn words(mut self) -> [u64; Self::WORDS] {
        self.carry();
        let top = self.limbs[LIMBS - 1];
        let mut words = [self.lost; Self::WORDS];
        for (word, limb) in words.iter_mut().zip(self.limbs) {
            *word = limb.cast_unsigned();
        }
        // The only one with a sign, as two without.
        (words[LIMBS - 1], words[LIMBS]) = (top.max(0).unsigned_abs(), top.min(0).unsigned_abs());
        words
    }

    /// The sum of which these are the [words](Self::words).
    pub fn of_words(words: &[u64; Self::WORDS]) -> Self {
        let [above @ .., below, lost] = words;
        let mut limbs = above.map(u64::cast_signed);
        limbs[LIMBS - 1] = limbs[LIMBS - 1].wrapping_sub(below.cast_signed());
        let mut sum = Self {
            limbs,
            lost: *lost,
            terms: 0,
        };
        sum.carry();
        sum
    }

    /// Makes all limbs but the last digits, from 0 to 2^32 - 1: then equal sums have equal limbs.
    fn carry(&mut self) {
        let mut over = 0;
        for limb in &mut self.limbs[..LIMBS - 1] {
            *limb += over;
            over = *limb >> BITS;
            *limb &= (1 << BITS) - 1;
        }
        self.limbs[LIMBS - 1] += over;
        self.terms = 0;
    }

    /// The sum, rounded to the nearest number.
    pub fn value(&self) -> f64 {
        if self.lost > 0 {
            return f64::NAN;
        }
        let mut sum = self.clone();
        sum.carry();
        let is_negative = sum.limbs[LIMBS - 1] < 0;
        if is_negative {
            for limb in &mut sum.limbs {
                *limb = -*limb;
            }
            sum.carry();
        }
        let limbs = &sum.limbs;
        let Some(top) = limbs.iter().rposition(|limb| *limb != 0) else {
            return 0.0;
        };
        // Four digits, and whether any below is not 0: more than the 53 bits of a number and one to round by.
        let digit = |k: usize| top.checked_sub(k).map_or(0, |at| limbs[at].cast_unsigned());
        let digits = (0..4).fold(0_u128, |all, k| all << BITS | u128::from(digit(k)));
        let below = limbs[..top.saturating_sub(3)].iter().any(|limb| *limb != 0);
        let rounded = (digits | u128::from(below)) as f64;
        // In two parts, of which neither leaves the range of the numbers.
        let power = BITS as i32 * (top as i32 - 3) - LEAST;
        let half = power / 2;
        let size = rounded * f64::powi(2.0, half) * f64::powi(2.0, power - half);
        if is_negative { -size } else { size }
    }
}

/// Of the values, whatever the terms.
impl PartialEq for ExactSum {
    fn eq(&self, other: &Self) -> bool {
        self.clone().words() == other.clone().words()
    }
}

impl Eq for ExactSum {}

impl Extend<f64> for ExactSum {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, terms: T) {
        for term in terms {
            self.add(term);
        }
    }
}

impl FromIterator<f64> for ExactSum {
    fn from_iter<T: IntoIterator<Item = f64>>(terms: T) -> Self {
        let mut sum = Self::default();
        sum.extend(terms);
        sum.carry();
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_are_their_own_sums() {
        let numbers = [
            0.0,
            f64::from_bits(1),
            f64::MIN_POSITIVE,
            f64::from_bits(f64::MIN_POSITIVE.to_bits() - 1),
            1.0,
            -1.0 / 3.0,
            f64::MAX,
            f64::MIN,
        ];
        for number in numbers {
            assert_eq!(ExactSum::from_iter([number]).value(), number);
        }
        assert_eq!(
            ExactSum::from_iter([f64::MAX, f64::MAX]).value(),
            f64::INFINITY
        );
        assert_eq!(
            ExactSum::from_iter([f64::MAX, f64::MAX, f64::MIN]).value(),
            f64::MAX
        );
        for lost in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(ExactSum::from_iter([1.0, lost]).value().is_nan());
        }
    }

    #[test]
    fn halves_are_rounded_to_even_and_what_is_beyond_them_up() {
        let (one, half) = (1.0, f64::EPSILON / 2.0);
        assert_eq!(ExactSum::from_iter([one, half]).value(), one);
        assert_eq!(
            ExactSum::from_iter([one, half, 1e-200]).value(),
            one + f64::EPSILON
        );
        assert_eq!(ExactSum::from_iter([one, half, -1e-200]).value(), one);
        assert_eq!(
            ExactSum::from_iter([-one, -half, -1e-200]).value(),
            -one - f64::EPSILON
        );
    }

    #[test]
    fn equal_sums_are_equal_whatever_their_terms() {
        let mut sum = ExactSum::default();
        sum.extend([1.0, -1.0]);
        assert_eq!(sum, ExactSum::default());
        sum.add(0.5);
        assert_ne!(sum, ExactSum::default());
    }

    proptest! {
        /// Whole numbers times a power of two, which 128 bits hold exactly.
        #[test]
        fn sums_are_those_of_whole_numbers(
            terms in prop::collection::vec((any::<i64>(), 0_u32..50), 0..40),
            power in -1000_i32..800,
        ) {
            let exact: i128 = terms.iter().map(|(n, k)| i128::from(*n >> 11) << k).sum();
            let unit = f64::powi(2.0, power);
            let term = |(n, k): &(i64, u32)| (*n >> 11) as f64 * f64::powi(2.0, *k as i32) * unit;
            let sum: ExactSum = terms.iter().map(term).collect();
            prop_assert_eq!(sum.value(), exact as f64 * unit);
        }

        #[test]
        fn order_and_parts_do_not_matter(terms in prop::collection::vec(any::<f64>(), 0..40), at in 0_usize..40) {
            let whole: ExactSum = terms.iter().copied().collect();
            let (first, second) = terms.split_at(at.min(terms.len()));
            let parts = [second, first].map(|part| part.iter().rev().copied().collect::<ExactSum>().words());
            let mut words = parts[0];
            for (word, other) in words.iter_mut().zip(parts[1]) {
                *word += other;
            }
            let joined = ExactSum::of_words(&words);
            prop_assert_eq!(joined.value().to_bits(), whole.value().to_bits());
            prop_assert_eq!(joined, whole);
        }
    }
}
