//! Tail exponents of samples from a known law.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Random;
use crate::common::forces::{between, body};
use femdem_analysis::{
    AnalysisError, ForceBody, ForceContact, ForceDistributionOptions, ForceNetwork, TailLaw,
    TailOptions, fit_tail, force_distribution,
};

/// `count` draws of an exponential law with exponent `rate` above `start`.
fn exponential(random: &mut Random, count: usize, rate: f64, start: f64) -> Vec<f64> {
    (0..count)
        .map(|_| start - random.uniform(f64::MIN_POSITIVE, 1.0).ln() / rate)
        .collect()
}

/// How often the interval holds the true exponent, out of `samples` seeded samples of 400 values.
fn covered(law: TailLaw, samples: u64) -> usize {
    let exponent = 2.5;
    let held = |seed: u64| {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let values = match law {
            TailLaw::Exponential => exponential(&mut random, 400, exponent, 1.0),
            // f0 exp(X) with X exponential of rate alpha - 1.
            TailLaw::Power => exponential(&mut random, 400, exponent - 1.0, 0.0)
                .into_iter()
                .map(|x| 1.5 * x.exp())
                .collect(),
        };
        let start = match law {
            TailLaw::Exponential => 1.0,
            TailLaw::Power => 1.5,
        };
        let options = TailOptions {
            law,
            start: Some(start),
            resamples: 400,
            seed,
            ..TailOptions::default()
        };
        let fit = fit_tail(&values, &options).unwrap().unwrap();
        assert_eq!((fit.count, fit.start_given), (400, true));
        fit.interval[0] < exponent && exponent < fit.interval[1]
    };
    (1..=samples).filter(|seed| held(*seed)).count()
}

/// Intervals of 95 % hold the exponent 95 times in 100: 950 times in 1,000, of which a fair count varies by
/// ±7.
#[test]
fn intervals_hold_the_exponent_95_times_in_100() {
    for law in [TailLaw::Exponential, TailLaw::Power] {
        let count = covered(law, 1000);
        assert!((936..=964).contains(&count), "{law:?}: {count} of 1000");
    }
}

/// The law holds above 1 only, and below it the density is flat: both the start and the exponent are found. The
/// intervals, which account for the search of the start, contain the exponent in 91 of these 100 cases.
#[test]
fn start_of_a_tail_is_found() {
    let mut held = 0;
    for seed in 1..=100_u64 {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let mut values: Vec<f64> = (0..500).map(|_| random.uniform(0.001, 1.0)).collect();
        values.extend(exponential(&mut random, 500, 3.0, 1.0));
        let options = TailOptions {
            resamples: 200,
            seed,
            ..TailOptions::default()
        };
        let fit = fit_tail(&values, &options).unwrap().unwrap();
        assert!((0.9..1.9).contains(&fit.start), "start {}", fit.start);
        assert!(!fit.start_given && fit.distance < 1.2 / (fit.count as f64).sqrt());
        held += u32::from(fit.interval[0] < 3.0 && 3.0 < fit.interval[1]);
    }
    assert!((88..=99).contains(&held), "{held} of 100");
}

/// A law that is not exponential is detected by its distance.
#[test]
fn a_wrong_law_is_far_away() {
    let mut random = Random(5);
    let values: Vec<f64> = (0..3000).map(|_| random.uniform(1.0, 2.0)).collect();
    let options = TailOptions {
        start: Some(1.0),
        ..TailOptions::default()
    };
    let fit = fit_tail(&values, &options).unwrap().unwrap();
    assert!(
        fit.distance > 3.0 * 1.1 / 3000_f64.sqrt(),
        "{}",
        fit.distance
    );
}

#[test]
fn too_little_and_bad_values() {
    let options = TailOptions::default();
    assert_eq!(fit_tail(&[], &options), Ok(None));
    assert_eq!(fit_tail(&[1.0; 19], &options), Ok(None));
    assert_eq!(fit_tail(&[1.0; 500], &options), Ok(None));
    let refused = |values: &[f64], options: TailOptions| match fit_tail(values, &options) {
        Err(AnalysisError::Option { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&[1.0, 0.0], options), "values");
    assert_eq!(refused(&[1.0, f64::NAN], options), "values");
    assert_eq!(
        refused(
            &[],
            TailOptions {
                start: Some(-1.0),
                ..options
            }
        ),
        "start"
    );
    assert_eq!(
        refused(
            &[],
            TailOptions {
                resamples: 3,
                ..options
            }
        ),
        "resamples"
    );
    assert_eq!(
        refused(
            &[],
            TailOptions {
                confidence: 1.0,
                ..options
            }
        ),
        "confidence"
    );
}

/// P(f) of a row of contacts with exponential forces: it integrates to 1, its mean is 1, and the tail has
/// exponent 1 in units of the mean.
#[test]
fn distribution_of_a_row() {
    let mut random = Random(9);
    let bodies: Vec<ForceBody> = (0..3001).map(|k| body(f64::from(k), 0.0, 0.0)).collect();
    let forces = exponential(&mut random, 3000, 0.2, 0.0);
    let contacts: Vec<ForceContact> = (0..)
        .zip(&forces)
        .map(|(k, force)| between(&bodies, k, k + 1, *force))
        .collect();
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let found = force_distribution(&network, &ForceDistributionOptions::default())
        .unwrap()
        .unwrap();
    let mean = forces.iter().sum::<f64>() / 3000.0;
    assert!((found.mean_force.mean - mean).abs() < 1e-12 * mean);
    // Forces of a row are independent: sd / sqrt(n), with 8 blocks known to a third.
    let error = found.mean_force.standard_error.unwrap();
    assert!(
        (0.4..1.8).contains(&(error / (5.0 / 3000_f64.sqrt()))),
        "{error}"
    );
    let integral: f64 = found
        .bins
        .iter()
        .map(|b| b.density * (b.high - b.low))
        .sum();
    assert!((integral - 1.0).abs() < 1e-12);
    assert!((found.sd - 1.0).abs() < 0.06);
    let tail = found.tail.unwrap();
    assert!(tail.interval[0] < 1.0 && 1.0 < tail.interval[1], "{tail:?}");
    // Each bin within four counting errors of the law.
    for bin in found.bins.iter().filter(|b| b.count > 20) {
        let expected = ((-bin.low).exp() - (-bin.high).exp()) / (bin.high - bin.low);
        assert!((bin.density - expected).abs() < 4.0 * bin.error, "{bin:?}");
    }
}

/// The same bits with 1, 2 and 3 threads.
#[cfg(feature = "parallel")]
#[test]
fn same_bits_for_any_number_of_threads_in_forces() {
    use femdem_analysis::{ChainOptions, WeightRule, chains_by_weight};

    let mut random = Random(4);
    let (bodies, contacts) = crate::common::forces::random_network(&mut random, 2000);
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let measure = || {
        let forces = force_distribution(&network, &ForceDistributionOptions::default()).unwrap();
        let rule = WeightRule { factor: 0.6 };
        let chains = chains_by_weight(&network, rule, &ChainOptions::default()).unwrap();
        assert!(chains.chains.len() > 3);
        serde_json::to_string(&(forces, chains)).unwrap()
    };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(measure)
    };
    let one = with(1);
    assert_eq!(with(2), one);
    assert_eq!(with(3), one);
}

/// A tail far from zero has the exponent of one beside it.
#[test]
fn tails_far_from_zero_keep_their_exponent() {
    let values = exponential(&mut Random(5), 2000, 1.0, 0.0);
    let fit = |shift: f64| {
        let shifted: Vec<f64> = values.iter().map(|v| v + shift).collect();
        let options = TailOptions {
            law: TailLaw::Exponential,
            start: Some(shift + 0.5),
            resamples: 200,
            ..TailOptions::default()
        };
        fit_tail(&shifted, &options).unwrap().unwrap()
    };
    let (near, far) = (fit(1.0), fit(1e9));
    assert_eq!(near.count, far.count);
    for (a, b) in [
        (near.exponent, far.exponent),
        (near.interval[0], far.interval[0]),
        (near.interval[1], far.interval[1]),
    ] {
        assert!((a / b - 1.0).abs() < 1e-5, "{a} {b}");
    }
}

/// The unit of the values does not matter: powers of two change no digit, however large.
#[test]
fn the_unit_of_the_values_does_not_matter() {
    let mut random = Random(7);
    let values = exponential(&mut random, 200, 2.0, 1.0);
    let options = TailOptions::default();
    let fit = fit_tail(&values, &options).unwrap().unwrap();
    for power in [-980, -500, 500, 980] {
        let unit = 2.0_f64.powi(power);
        let other: Vec<f64> = values.iter().map(|v| v * unit).collect();
        let found = fit_tail(&other, &options).unwrap().unwrap();
        assert_eq!(found.exponent * unit, fit.exponent, "2^{power}");
        assert_eq!(found.interval.map(|x| x * unit), fit.interval);
        assert_eq!(found.start, fit.start * unit);
        assert_eq!((found.count, found.distance), (fit.count, fit.distance));
    }
    let beyond = fit_tail(&[1e-305], &options);
    assert!(matches!(
        beyond,
        Err(AnalysisError::Option { name: "values", .. })
    ));
}

/// The forces of a crystal differ by rounding alone.
#[test]
fn values_that_differ_by_rounding_have_no_tail() {
    let values: Vec<f64> = (0..400).map(|i| 1.0 + 1e-12 * f64::from(i)).collect();
    for law in [TailLaw::Exponential, TailLaw::Power] {
        let options = TailOptions {
            law,
            ..TailOptions::default()
        };
        assert_eq!(fit_tail(&values, &options).unwrap(), None);
    }
}
