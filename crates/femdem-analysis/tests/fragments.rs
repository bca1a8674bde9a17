//! Sizes of fragments with known boxes, laws and indices.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::f64::consts::PI;

use crate::common::{Random, solid};
use femdem_analysis::*;
use femdem_mesh::{Point3, Rotation};

const SIZE: f64 = 0.03;
const LAWS: [SizeLaw; 2] = [SizeLaw::RosinRammler, SizeLaw::GaudinSchuhmann];

/// Sizes of `count` pieces of the same mass.
fn by_mass(random: &mut Random, law: SizeLaw, exponent: f64, count: usize) -> Vec<(f64, f64)> {
    let size = |u: f64| match law {
        SizeLaw::RosinRammler => SIZE * (-u.ln()).powf(1.0 / exponent),
        SizeLaw::GaudinSchuhmann => SIZE * u.powf(1.0 / exponent),
    };
    (0..count)
        .map(|_| (size(random.uniform(1e-12, 1.0)), 1.0))
        .collect()
}

/// `count` pieces of Gaudin and Schuhmann above the size `least`, with masses as the cubes of their sizes, and the dust
/// below: where the mass up to d is as d^m, the number of pieces of a size is as d^(m - 4).
fn by_number(random: &mut Random, exponent: f64, count: usize, least: f64) -> Vec<(f64, f64)> {
    let mut pieces = Vec::new();
    while pieces.len() < count {
        let size = least * random.uniform(1e-12, 1.0).powf(1.0 / (exponent - 3.0));
        if size <= SIZE {
            pieces.push((size, size.powi(3)));
        }
    }
    let passing = (least / SIZE).powf(exponent);
    let mass: f64 = pieces.iter().map(|p| p.1).sum();
    let dust = mass * passing / (1.0 - passing) / 200.0;
    pieces.extend([(0.5 * least, dust); 200]);
    pieces
}

/// How often the intervals of exponent and size hold the true ones, out of 100 samples.
fn held(
    law: SizeLaw,
    exponent: f64,
    smallest: Option<f64>,
    mut sample: impl FnMut(&mut Random) -> Vec<(f64, f64)>,
) -> [usize; 2] {
    let mut held = [0; 2];
    for seed in 1..=100_u64 {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        let options = SizeFitOptions {
            smallest,
            resamples: 200,
            seed,
            ..SizeFitOptions::default()
        };
        let fit = fit_sizes(&sample(&mut random), law, &options);
        let fit = fit.unwrap().unwrap();
        let holds = |[low, high]: [f64; 2], value| usize::from(low < value && value < high);
        held[0] += holds(fit.exponent_interval, exponent);
        held[1] += holds(fit.size_interval, SIZE);
    }
    held
}

#[test]
fn intervals_of_the_laws_hold_their_parameters() {
    for law in LAWS {
        for count in [50, 200] {
            let found = held(law, 0.9, None, |random| by_mass(random, law, 0.9, count));
            let as_stated = found.iter().all(|n| (89..=99).contains(n));
            assert!(as_stated, "{law:?}, {count} pieces: {found:?} of 100");
        }
    }
    let law = SizeLaw::GaudinSchuhmann;
    let found = held(law, 0.6, Some(0.006), |random| {
        by_number(random, 0.6, 300, 0.006)
    });
    assert!(found.iter().all(|n| *n >= 85), "by number: {found:?}");
}

/// A sample of one law is farther from the other.
#[test]
fn the_law_of_a_sample_is_the_nearer_one() {
    for (k, law) in LAWS.into_iter().enumerate() {
        let pieces = by_mass(&mut Random(7), law, 1.1, 2000);
        let found = fragmentation(&pieces, &FragmentationOptions::default()).unwrap();
        let fits = [found.rosin_rammler, found.gaudin_schuhmann].map(Option::unwrap);
        assert!(fits[k].distance < 0.03, "{law:?}");
        assert!(fits[1 - k].distance > 2.0 * fits[k].distance, "{law:?}");
        assert!((fits[k].effective_pieces - 2000.0).abs() < 1e-6);
        // 1 - 1/e and all of the mass at the size of the law.
        let at_size = [1.0 - (-1.0_f64).exp(), 1.0][k];
        assert!((fits[k].passing(fits[k].size) - at_size).abs() < 1e-12);
        let words = found.to_csv();
        assert!(words.contains("\nrosin_rammler_n,") && words.contains("\npieces,2000.0,,\n"));
    }
}

/// Mass in a unit of another size, pieces in another order and sizes in millimetres are the same pieces.
#[test]
fn units_and_order_do_not_matter() {
    let pieces = by_mass(&mut Random(3), SizeLaw::RosinRammler, 1.3, 100);
    let other: Vec<(f64, f64)> = pieces.iter().rev().map(|p| (1e3 * p.0, 1e-3)).collect();
    let fit = |pieces: &[(f64, f64)]| {
        let options = SizeFitOptions::default();
        let found = fit_sizes(pieces, SizeLaw::RosinRammler, &options);
        found.unwrap().unwrap()
    };
    let (one, other) = (fit(&pieces), fit(&other));
    assert!((one.exponent - other.exponent).abs() < 1e-9);
    assert!((1e3 * one.size / other.size - 1.0).abs() < 1e-9);
}

#[test]
fn too_few_sizes_have_no_law_but_a_curve_and_indices() {
    let options = FragmentationOptions {
        parent_size: Some(1.0),
        ..FragmentationOptions::default()
    };
    // Four sizes, two of them equal to rounding; masses 8, 4, 2, 1 and 1.
    let tenth = 0.1 * (1.0 + 1e-12);
    let pieces = [
        (0.8, 8.0),
        (0.5, 4.0),
        (tenth, 2.0),
        (0.1, 1.0),
        (0.01, 1.0),
    ];
    let found = fragmentation(&pieces, &options).unwrap();
    assert_eq!((found.rosin_rammler, found.gaudin_schuhmann), (None, None));
    let at = |n| found.index(n);
    assert_eq!([at(2.0), at(4.0), at(10.0)], [0.5, 0.25, 0.25].map(Some));
    assert_eq!([at(25.0), at(50.0), at(75.0)], [0.0625; 3].map(Some));
    assert_eq!(at(3.0), None);
    assert_eq!(found.curve.points.len(), 4);
    assert_eq!((found.pieces, found.mass), (5, 16.0));
    // The unbroken body: nothing passes less than its own size.
    assert_eq!(breakage_index(&[(1.0, 5.0)], 1.0, 10.0), Ok(0.0));
    assert_eq!(breakage_index(&[(1.0, 5.0)], 1.0, 1.0), Ok(1.0));
}

fn measured(points: &[Point3], volume: f64, area: Option<f64>) -> FragmentSize {
    let fragment = Fragment {
        volume,
        mass: 1.0,
        area,
        extent: FragmentExtent::Points(points),
    };
    measure_fragments(&[fragment]).unwrap().fragments[0]
}

fn turned(points: &[Point3], turn: &Rotation) -> Vec<Point3> {
    points.iter().map(|p| turn * p).collect()
}

#[test]
fn bricks_and_regular_tetrahedra_have_their_smallest_boxes() {
    let mut random = Random(11);
    // The cube around a regular tetrahedron has the same corners on the same sphere.
    let cube = 1.0 / 3_f64.sqrt();
    for _ in 0..20 {
        let turn = random.rotation();
        let sides = [1, 2, 3].map(|_| random.uniform(0.1, 2.0));
        let corner = |k: u32| {
            Point3::from([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { sides[axis] } else { 0.0 }))
        };
        let mut points: Vec<Point3> = (0..8).map(corner).collect();
        points.extend((0..10).map(|_| random.point(&Point3::origin(), &corner(7))));
        let found = measured(&turned(&points, &turn), sides.iter().product(), None);
        let mut sorted = sides;
        sorted.sort_by(f64::total_cmp);
        for (found, side) in found.sides.iter().zip(sorted) {
            assert!((found - side).abs() < 1e-9, "{found} {side}");
        }
        let tetrahedron = solid("P1", 1.0);
        let found = measured(&turned(tetrahedron.vertices(), &turn), 1e-3, None);
        for side in found.sides {
            assert!((side - cube).abs() < 1e-9, "{:?}", found.sides);
        }
    }
}

/// No box of a thousand turns is smaller.
#[test]
fn no_turned_box_is_smaller() {
    let mut random = Random(5);
    let (low, high) = (Point3::from([-1.0; 3]), Point3::new(1.0, 0.7, 0.4));
    for count in [4, 5, 6, 9, 20] {
        let points: Vec<Point3> = (0..count).map(|_| random.point(&low, &high)).collect();
        let sides = measured(&points, 1e-6, None).sides;
        assert!(sides.is_sorted());
        for _ in 0..1000 {
            let seen = turned(&points, &random.rotation());
            let width = |k: usize| {
                let ends = seen.iter().map(|p| p[k]);
                ends.clone().fold(f64::MIN, f64::max) - ends.fold(f64::MAX, f64::min)
            };
            let volume: f64 = (0..3).map(width).product();
            assert!(volume >= sides.iter().product::<f64>() * (1.0 - 1e-9));
        }
    }
}

#[test]
fn diameter_and_sphericity_of_a_cube() {
    let cube = Fragment {
        volume: 8.0,
        mass: 3.0,
        area: Some(24.0),
        extent: FragmentExtent::Sides([2.0; 3]),
    };
    let found = measure_fragments(&[cube]).unwrap();
    let one = found.fragments[0];
    assert!((4.0 / 3.0 * PI * (0.5 * one.equivalent_diameter).powi(3) - 8.0).abs() < 1e-12);
    // Wadell's value for the cube.
    assert!((one.sphericity.unwrap() - 0.806).abs() < 5e-4);
    assert_eq!(found.by_sieve(), [(2.0, 3.0)]);
    assert_eq!(found.by_volume()[0].1, 3.0);
    assert_eq!(found.to_csv().lines().count(), 2);
}

#[test]
fn bad_fragments_and_options_are_refused_by_name() {
    let good = Fragment {
        volume: 1.0,
        mass: 1.0,
        area: Some(6.0),
        extent: FragmentExtent::Sides([1.0; 3]),
    };
    let says = |bad: Fragment| {
        let refused = measure_fragments(&[good, bad]);
        refused.unwrap_err().to_string()
    };
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]].map(Point3::from);
    let few = [Point3::origin(); 3];
    let wild = [[f64::NAN; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0; 3]].map(Point3::from);
    for (bad, words) in [
        (
            Fragment {
                volume: 0.0,
                ..good
            },
            "volume = 0 ",
        ),
        (
            Fragment {
                volume: 1.1,
                ..good
            },
            "at most that of its box",
        ),
        (
            Fragment {
                mass: f64::NAN,
                ..good
            },
            "mass = NaN",
        ),
        (
            Fragment {
                area: Some(-1.0),
                ..good
            },
            "area = -1",
        ),
        (
            Fragment {
                area: Some(4.8),
                ..good
            },
            "at least that of the ball",
        ),
        (
            Fragment {
                extent: FragmentExtent::Sides([1.0, f64::INFINITY, 1.0]),
                ..good
            },
            "side = inf",
        ),
        (
            Fragment {
                extent: FragmentExtent::Points(&flat),
                ..good
            },
            "no box",
        ),
        (
            Fragment {
                extent: FragmentExtent::Points(&few),
                ..good
            },
            "no box",
        ),
        (
            Fragment {
                extent: FragmentExtent::Points(&wild),
                ..good
            },
            "no box",
        ),
    ] {
        let found = says(bad);
        assert!(
            found.starts_with("fragment 1") && found.contains(words),
            "{found}"
        );
    }
    assert_eq!(measure_fragments(&[]).unwrap().fragments, []);
    let pieces = [(1.0, 1.0); 3];
    assert_eq!(
        fragmentation(&[], &FragmentationOptions::default()),
        Err(AnalysisError::NoFragments)
    );
    let fit = |pieces: &[(f64, f64)], options| {
        let refused = fit_sizes(pieces, SizeLaw::RosinRammler, &options);
        refused.unwrap_err().to_string()
    };
    let usual = SizeFitOptions::default();
    assert!(fit(&[(1.0, 1.0), (-1.0, 1.0)], usual).contains("fragment 1: its size = -1"));
    assert!(fit(&[(1.0, 0.0)], usual).contains("fragment 0: its mass = 0"));
    for (options, words) in [
        (
            SizeFitOptions {
                smallest: Some(0.0),
                ..usual
            },
            "smallest = 0",
        ),
        (
            SizeFitOptions {
                largest: Some(f64::NAN),
                ..usual
            },
            "largest = NaN",
        ),
        (
            SizeFitOptions {
                resamples: 19,
                ..usual
            },
            "resamples = 19",
        ),
        (
            SizeFitOptions {
                confidence: 1.0,
                ..usual
            },
            "confidence = 1",
        ),
    ] {
        let found = fit(&pieces, options);
        assert!(found.contains(words), "{found}");
    }
    for (parent, ratio, words) in [
        (0.0, 10.0, "parent_size = 0"),
        (1.0, 0.5, "ratio = 0.5"),
        (1.0, f64::NAN, "ratio = NaN"),
    ] {
        let found = breakage_index(&pieces, parent, ratio).unwrap_err();
        assert!(found.to_string().contains(words), "{found}");
    }
}

#[cfg(feature = "parallel")]
#[test]
fn same_bits_of_fragments_with_any_number_of_threads() {
    let mut random = Random(9);
    let (low, high) = (Point3::from([-1.0; 3]), Point3::from([1.0; 3]));
    let clouds: Vec<Vec<Point3>> = (0..40)
        .map(|k| (0..4 + k % 9).map(|_| random.point(&low, &high)).collect())
        .collect();
    let fragments: Vec<Fragment> = clouds
        .iter()
        .map(|points| Fragment {
            volume: 1e-3,
            mass: 1.0,
            area: None,
            extent: FragmentExtent::Points(points),
        })
        .collect();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let sizes = measure_fragments(&fragments).unwrap();
            let options = FragmentationOptions::default();
            let found = fragmentation(&sizes.by_sieve(), &options).unwrap();
            [sizes.to_csv(), serde_json::to_string(&found).unwrap()]
        })
    };
    let one = with(1);
    for threads in [2, 3] {
        assert_eq!(with(threads), one, "{threads} threads");
    }
}
