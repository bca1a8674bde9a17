//! Random numbers: one stream for each body, and uniform rotations.

use femdem_contact::BodyId;
use femdem_mesh::Rotation;
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// The random stream of a body: ChaCha8 with the pack's seed and the body's number as stream, so
/// that a body's start depends on nothing but these two.
pub fn body_stream(seed: u64, body: BodyId) -> ChaCha8Rng {
    let mut stream = ChaCha8Rng::seed_from_u64(seed);
    stream.set_stream(u64::from(body));
    stream
}

/// A uniform number in [0, 1) with 53 random bits.
pub fn uniform(rng: &mut impl Rng) -> f64 {
    const SCALE: f64 = 1.0 / (1_u64 << 53) as f64;
    (rng.next_u64() >> 11) as f64 * SCALE
}

/// The place of a body in a random order of `count` bodies that depends on the seed alone: a Feistel network on the
/// smallest even number of bits that holds the bodies, repeated until it comes out among them (Black and Rogaway,
/// "Ciphers with arbitrary finite domains", 2002). No list of the order has to be kept.
pub(crate) fn shuffled(body: BodyId, count: u32, seed: u64) -> u32 {
    const ROUNDS: u64 = 8;
    let bits = u32::BITS - count.saturating_sub(1).leading_zeros();
    let half = bits.div_ceil(2).max(1);
    let mask = (1_u64 << half) - 1;
    let mut place = u64::from(body);
    loop {
        for round in 0..ROUNDS {
            let (left, right) = (place >> half, place & mask);
            let key = mixed(seed ^ mixed(round + 1));
            place = right << half | (left ^ (mixed(right ^ key) & mask));
        }
        // Below 2^32, as the bodies are.
        if place < u64::from(count) {
            return place as u32;
        }
    }
}

/// Bits that depend on all bits given: the finalizer of SplitMix64 (Steele, Lea and Flood 2014).
fn mixed(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// A rotation distributed uniformly over all rotations, by the subgroup algorithm of Shoemake,
/// "Uniform random rotations", Graphics Gems III (1992). Draws three numbers.
pub fn random_rotation(rng: &mut impl Rng) -> Rotation {
    let share = uniform(rng);
    let (s1, c1) = (TAU * uniform(rng)).sin_cos();
    let (s2, c2) = (TAU * uniform(rng)).sin_cos();
    let (r1, r2) = ((1.0 - share).sqrt(), share.sqrt());
    UnitQuaternion::new_normalize(Quaternion::new(c2 * r2, s1 * r1, c1 * r1, s2 * r2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Vector3;

    fn rotations(n: u32) -> impl Iterator<Item = Rotation> {
        (0..n).map(|k| random_rotation(&mut body_stream(7, k)))
    }

    /// For uniform rotations R the nine entries have mean 0 and variance 1/3, and entries of one
    /// column are uncorrelated. With n = 40,000 the standard errors are 0.003 for the mean and
    /// 0.0015 for second moments (fourth moment 1/5); the bounds are 4.5 of them.
    #[test]
    fn rotated_axes_are_spread_evenly() {
        let n = 40_000;
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            let mut mean = Vector3::zeros();
            let mut second = femdem_mesh::Matrix3::zeros();
            for r in rotations(n) {
                let v = r * axis;
                mean += v / f64::from(n);
                second += v * v.transpose() / f64::from(n);
            }
            assert!(mean.amax() < 0.013, "{mean}");
            let expected = femdem_mesh::Matrix3::identity() / 3.0;
            assert!((second - expected).amax() < 0.007, "{second}");
        }
    }

    /// The angle of a uniform rotation has the density (1 - cos t)/pi, hence P(angle < t) =
    /// (t - sin t)/pi (Miles 1965). Kolmogorov-Smirnov distance below 1.95/sqrt(n) (p = 0.001).
    #[test]
    fn rotation_angles_follow_haar_measure() {
        let n = 20_000;
        let mut angles: Vec<f64> = rotations(n).map(|r| r.angle()).collect();
        angles.sort_by(f64::total_cmp);
        let distance = angles.iter().enumerate().map(|(i, t)| {
            let expected = (t - t.sin()) / std::f64::consts::PI;
            (expected - (i as f64 + 0.5) / f64::from(n)).abs()
        });
        let worst = distance.fold(0.0, f64::max);
        assert!(worst < 1.95 / f64::from(n).sqrt(), "{worst}");
    }

    #[test]
    fn streams_differ_by_body_and_by_seed_and_repeat() {
        let first = |seed, body| body_stream(seed, body).next_u64();
        assert_eq!(first(1, 5), first(1, 5));
        assert_ne!(first(1, 5), first(1, 6));
        assert_ne!(first(1, 5), first(2, 5));
    }

    #[test]
    fn a_shuffle_gives_every_place_once() {
        for count in [1, 2, 3, 64, 65, 1000] {
            let mut places: Vec<u32> = (0..count).map(|body| shuffled(body, count, 5)).collect();
            if count == 1000 {
                // Neighbours end up far apart: a third of the bodies on average.
                let apart = places.windows(2).map(|w| f64::from(w[0].abs_diff(w[1])));
                let mean = apart.sum::<f64>() / 999.0;
                assert!((290.0..=375.0).contains(&mean), "{mean}");
            }
            places.sort_unstable();
            assert!(places.into_iter().eq(0..count), "{count}");
        }
    }

    #[test]
    fn uniform_numbers_stay_below_one_and_have_the_right_mean() {
        let mut rng = body_stream(3, 0);
        let n = 10_000;
        let numbers: Vec<f64> = (0..n).map(|_| uniform(&mut rng)).collect();
        assert!(numbers.iter().all(|u| (0.0..1.0).contains(u)));
        // Standard error sqrt(1/12/n) = 0.0029.
        assert!((numbers.iter().sum::<f64>() / f64::from(n) - 0.5).abs() < 0.012);
    }
}
