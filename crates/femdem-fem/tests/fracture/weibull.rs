//! Scatter of strength.

use super::*;
use femdem_fem::fracture::Weibull;

/// Largest distance between the distribution of a sample and 1 - exp(-x^m).
fn distance(mut sample: Vec<f64>, modulus: f64) -> f64 {
    sample.sort_by(f64::total_cmp);
    let count = sample.len() as f64;
    let far = |(i, x): (usize, &f64)| {
        let exact = 1.0 - (-x.powf(modulus)).exp();
        (exact - i as f64 / count)
            .abs()
            .max((exact - (i + 1) as f64 / count).abs())
    };
    sample.iter().enumerate().map(far).fold(0.0, f64::max)
}

/// Kolmogorov and Smirnov: 1.63 / sqrt n is exceeded by one sample in a hundred.
#[test]
fn the_distribution_over_nodes_bodies_and_seeds() {
    let (modulus, count) = (8.0, 20_000_u32);
    let bound = 1.63 / f64::from(count).sqrt();
    let scatter = Weibull::new(modulus, 1e-6, 42).unwrap();
    let nodes = (0..count).map(|n| scatter.factor(3, n, 1e-6)).collect();
    let bodies = (0..count).map(|b| scatter.factor(u64::from(b), 3, 1e-6));
    let seeds = (0..count).map(|s| {
        let seeded = Weibull::new(modulus, 1e-6, u64::from(s)).unwrap();
        seeded.factor(3, 3, 1e-6)
    });
    for sample in [nodes, bodies.collect(), seeds.collect()] {
        assert!(distance(sample, modulus) < bound);
    }
    // Neighbours in any key are independent: no correlation beyond 3.3 / sqrt n.
    let pairs = (0..count).map(|n| {
        let [a, b] =
            [(3, n), (4, n + 1)].map(|(b, n)| scatter.factor(b, n, 1e-6).powf(modulus) - 1.0);
        a * b
    });
    assert!(pairs.sum::<f64>().abs() / f64::from(count) < 3.3 / f64::from(count).sqrt());
}

/// The weakest node of any mesh follows the law with the volume of the whole body.
#[test]
fn the_weakest_node_knows_the_volume_alone() {
    let (modulus, bodies) = (10.0, 1500_u64);
    let scatter = Weibull::new(modulus, 4e-6, 5).unwrap();
    for cells in [[2, 1, 1], [4, 3, 2]] {
        let size = Vector3::new(0.04, 0.02, 0.02);
        let mesh = TetMesh::block(cells, &size).unwrap();
        let weakest = |body| {
            let factors = scatter.factors(body, &mesh);
            factors.into_iter().fold(f64::INFINITY, f64::min)
        };
        // Volume 16e-6: weaker by 4^(1/10).
        let sample = (0..bodies).map(|body| weakest(body) * 4_f64.powf(0.1));
        assert!(distance(sample.collect(), modulus) < 1.63 / (bodies as f64).sqrt());
    }
}

#[test]
fn files_keep_it() {
    let scatter = Weibull::new(12.0, 1e-3, u64::MAX).unwrap();
    let text = serde_json::to_string(&scatter).unwrap();
    assert_eq!(serde_json::from_str::<Weibull>(&text).unwrap(), scatter);
    let bad = text.replace("12.0", "0.5");
    assert!(serde_json::from_str::<Weibull>(&bad).is_err());
}
