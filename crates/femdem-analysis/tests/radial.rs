//! Radial distribution functions that are known.

use crate::common::{Random, at, cube};
use femdem_analysis::*;
use femdem_mesh::{Point3, Vector3};

fn options(width_over_d: f64, reach_over_d: f64) -> RadialOptions {
    RadialOptions {
        width_over_d,
        reach_over_d,
        ..RadialOptions::default()
    }
}

fn box_of(size: [f64; 3]) -> Region {
    Region::Box {
        min: Point3::origin(),
        max: Point3::from(size),
    }
}

/// Points strewn at random give 1 at every distance, also in a plate and in a bar where walls are near to all and
/// most shells are cut; within the noise of the number of pairs.
#[test]
fn an_ideal_gas_is_flat() {
    let shapes = [cube(1.0 / 3_f64.sqrt())];
    let mut random = Random(41);
    for size in [[12.0, 12.0, 12.0], [1.5, 20.0, 20.0], [1.0, 1.0, 60.0]] {
        let region = box_of(size);
        let (min, max) = region.corners();
        let mut squares = Vec::new();
        for _ in 0..4 {
            let bodies = at((0..2000).map(|_| random.point(&min, &max).coords));
            let pack = Pack::new(&shapes, &bodies).unwrap();
            let found = radial_distribution(&pack, &region, &options(0.25, 6.0)).unwrap();
            assert_eq!((found.bodies, found.bins.len()), (2000, 24));
            for bin in &found.bins {
                assert!((bin.value - bin.pairs as f64 / bin.expected).abs() < 1e-12);
                let off = (bin.pairs as f64 - bin.expected) / bin.expected.sqrt();
                squares.push(off * off);
            }
        }
        // Pairs are counted from 2,000 points, so they scatter a little more than as many independent events.
        let spread = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(
            (0.6..1.6).contains(&spread),
            "{size:?}: {spread} of the noise of pairs"
        );
    }
}

/// All pairs of a cubic lattice are counted, whatever side of the box they are at.
#[test]
fn a_lattice_has_its_neighbours() {
    let n = 8_u64;
    let node = |i: u64| i as f64 + 0.5;
    let places =
        (0..n.pow(3)).map(|i| Vector3::new(node(i % n), node(i / n % n), node(i / (n * n))));
    let bodies = at(places);
    let shapes = [cube(1.0 / 3_f64.sqrt())];
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = radial_distribution(&pack, &box_of([8.0; 3]), &options(0.1, 1.8)).unwrap();
    let pairs: Vec<u64> = found.bins.iter().map(|b| b.pairs).collect();
    assert_eq!(pairs[10], 3 * n * n * (n - 1));
    assert_eq!(pairs[14], 6 * n * (n - 1) * (n - 1));
    assert_eq!(pairs[17], 4 * (n - 1).pow(3));
    assert_eq!(pairs.iter().sum::<u64>(), pairs[10] + pairs[14] + pairs[17]);
    assert!(found.bins[10].value > 4.0 && found.bins[10].standard_error.unwrap() < 0.2);
    assert_eq!(found.to_csv().lines().count(), 19);
    assert!((found.number_density - 1.0).abs() < 1e-12);
}

/// Bins with too few expected pairs stay in the table and are marked.
#[test]
fn bins_of_few_expected_pairs_are_marked() {
    let shapes = [cube(1.0 / 3_f64.sqrt())];
    let mut random = Random(7);
    let region = box_of([10.0; 3]);
    let (min, max) = region.corners();
    let bodies = at((0..40).map(|_| random.point(&min, &max).coords));
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = radial_distribution(&pack, &region, &options(0.5, 5.0)).unwrap();
    // 780 pairs in 1000 m3: a ball of 0.5 m holds 0.4 of them, a shell from 4.5 m to 5 m more than 50 at the
    // most, and no fewer than a fourth of that at the walls.
    let csv = found.to_csv();
    let marks: Vec<&str> = csv.lines().filter_map(|l| l.rsplit(',').next()).collect();
    assert_eq!((marks[0], marks.len()), ("rare", 11));
    assert_eq!((marks[1], marks[2], marks[10]), ("1", "1", "0"));
    for (bin, mark) in found.bins.iter().zip(&marks[1..]) {
        assert_eq!(*mark == "1", bin.expected < 5.0, "{bin:?}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::repeat(1.0), Vector3::repeat(50.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = box_of([8.0; 3]);
    let few = radial_distribution(&pack, &region, &RadialOptions::default());
    assert_eq!(
        few,
        Err(AnalysisError::TooFewBodies {
            bodies: 1,
            least: 2
        })
    );
    let ball = Region::Sphere {
        centre: Point3::origin(),
        radius: 9.0,
    };
    let round = radial_distribution(&pack, &ball, &RadialOptions::default());
    assert!(matches!(round, Err(AnalysisError::RegionKind { .. })));
    for (width, reach) in [
        (0.0, 1.0),
        (f64::NAN, 1.0),
        (0.1, -1.0),
        (1e-6, 1.0),
        (0.1, f64::INFINITY),
    ] {
        let refused = radial_distribution(&pack, &region, &options(width, reach));
        assert!(
            matches!(refused, Err(AnalysisError::Option { .. })),
            "{width} {reach}"
        );
    }
}
