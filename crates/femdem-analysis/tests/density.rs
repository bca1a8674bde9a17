//! The whole density measurement: grid against exact, standard error, same bits, bad input.

use crate::common::{Random, at, body, cube, moved, solid, turned_lattice};
use femdem_analysis::{
    AnalysisError, DensityOptions, Pack, PackingDensity, Region, exact_density, grid_density,
    packing_density,
};
use femdem_mesh::{Point3, Pose, Vector3};
use proptest::prelude::*;

/// Over many packs of turned bodies, on a lattice that is itself turned and shifted so that nothing is in step
/// with the grid, the grid's error scatters as stated: hardly ever beyond four standard deviations, and the
/// stated deviation is neither too large nor too small.
#[test]
fn grid_errs_as_stated() {
    let mut random = Random(21);
    let shapes = [
        solid("P1", 1.0),
        solid("A10", 1.0),
        solid("P5", 1.0),
        solid("A2", 1.0),
    ];
    let boxed = Region::Box {
        min: Point3::from([-1.4; 3]),
        max: Point3::from([1.4; 3]),
    };
    let drum = Region::Cylinder {
        centre: [0.1, 0.2],
        radius: 1.5,
        z_min: -1.2,
        z_max: 1.3,
    };
    let centred = Pose::translation(-2.0, -2.0, -2.0);
    for region in [boxed, drum] {
        let mut squares = 0.0;
        let trials = 80;
        for _ in 0..trials {
            let straight = turned_lattice(&mut random, 4, 5, 1.01);
            let bodies = moved(&straight, &(random.pose(0.5) * centred));
            let pack = Pack::new(&shapes, &bodies).unwrap();
            let exact = exact_density(&pack, &region).unwrap();
            let grid = grid_density(&pack, &region, random.uniform(0.06, 0.12)).unwrap();
            let deviation = (grid.density - exact.density) / grid.error;
            assert!(deviation.abs() < 4.0, "{grid:?} {exact:?}");
            squares += deviation * deviation;
        }
        let scatter = (squares / f64::from(trials)).sqrt();
        assert!((0.4..1.0).contains(&scatter), "{scatter}");
    }
}

/// Where bodies overlap the grid counts the union, and so does the exact method.
#[test]
fn overlapping_bodies_count_once_in_both() {
    let mut random = Random(22);
    let shapes = [solid("A1", 1.0), solid("P2", 1.0)];
    let bodies = turned_lattice(&mut random, 2, 6, 0.8);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = Region::Box {
        min: Point3::from([0.3; 3]),
        max: Point3::from([3.7; 3]),
    };
    let result = packing_density(&pack, &region, &DensityOptions::default()).unwrap();
    let overlap = result.parts.overlap_volume / result.parts.region_volume;
    let (grid, error) = (result.grid.unwrap(), result.grid_error.unwrap());
    assert!(overlap > 10.0 * error, "{result:?}");
    assert!((result.exact - grid).abs() < 4.0 * error, "{result:?}");
    assert!(
        (result.exact - (result.parts.body_volume / result.parts.region_volume - overlap)).abs()
            < 1e-12
    );
}

/// Blocks of independent density: cubes of side 1 in cells of side 2, present with probability one half.
/// The density is 1/16 and its standard error sqrt(1/4)/8 over the root of the number of cells.
#[test]
fn standard_error_of_independent_blocks() {
    let mut random = Random(23);
    let shape = cube(1.0);
    let all = (0..512)
        .map(|i| Vector3::new(f64::from(i % 8), f64::from(i / 8 % 8), f64::from(i / 64)) * 2.0);
    let bodies = at(all
        .filter(|_| random.uniform(0.0, 1.0) < 0.5)
        .map(|p| p.add_scalar(1.0)));
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let region = Region::Box {
        min: Point3::origin(),
        max: Point3::from([16.0; 3]),
    };
    let options = DensityOptions {
        block_over_d: 2.0 / 3_f64.sqrt(),
        ..DensityOptions::default()
    };
    let result = packing_density(&pack, &region, &options).unwrap();
    assert_eq!(result.blocks, 512);
    let expected = 0.5 / 8.0 / 512_f64.sqrt();
    let found = result.standard_error.unwrap();
    assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    assert!((result.exact - 1.0 / 16.0).abs() < 4.0 * expected);
    // One block alone gives no error.
    let small = Region::Box {
        min: Point3::origin(),
        max: Point3::from([2.0; 3]),
    };
    let result = packing_density(&pack, &small, &DensityOptions::default()).unwrap();
    assert_eq!((result.blocks, result.standard_error), (1, None));
}

/// A region beyond the pack counts as void; one without any body has density 0.
#[test]
fn regions_beyond_the_pack_are_void() {
    let shape = cube(1.0);
    let bodies = at([Vector3::zeros()]);
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let region = |low: f64, high: f64| Region::Box {
        min: Point3::from([low; 3]),
        max: Point3::from([high; 3]),
    };
    let wide = packing_density(&pack, &region(-5.0, 5.0), &DensityOptions::default()).unwrap();
    assert!((wide.exact - 1e-3).abs() < 1e-14);
    let far = packing_density(&pack, &region(5.0, 15.0), &DensityOptions::default()).unwrap();
    assert_eq!(
        (far.exact, far.grid, far.standard_error),
        (0.0, Some(0.0), Some(0.0))
    );
}

/// A region too wide for the grid still has its exact density.
#[test]
fn regions_too_wide_for_the_grid_have_the_exact_density_alone() {
    let shape = cube(1.0);
    let bodies = at([Vector3::zeros()]);
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let region = Region::Box {
        min: Point3::new(-1000.0, -1000.0, -1.0),
        max: Point3::new(1000.0, 1000.0, 1.0),
    };
    let wide = packing_density(&pack, &region, &DensityOptions::default()).unwrap();
    assert!((wide.exact - 1.25e-7).abs() < 1e-15, "{wide:?}");
    assert_eq!(
        (wide.grid, wide.grid_spacing, wide.grid_error),
        (None, None, None)
    );
    assert!(wide.standard_error.is_some());
}

#[test]
fn bad_input_is_refused() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::zeros()]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let good = Region::Box {
        min: Point3::from([-1.0; 3]),
        max: Point3::from([1.0; 3]),
    };
    let bad = Region::Box {
        min: Point3::from([-1.0; 3]),
        max: Point3::new(1.0, f64::NAN, 1.0),
    };
    let defaults = DensityOptions::default();

    let refused = packing_density(&pack, &bad, &defaults).unwrap_err();
    assert!(
        matches!(refused, AnalysisError::Region { name: "max.y", .. }),
        "{refused}"
    );
    assert!(matches!(
        grid_density(&pack, &bad, 0.1),
        Err(AnalysisError::Region { .. })
    ));
    assert!(matches!(
        exact_density(&pack, &bad),
        Err(AnalysisError::Region { .. })
    ));

    let none = Pack::new(&shapes, &[]).unwrap();
    assert_eq!(
        packing_density(&none, &good, &defaults),
        Err(AnalysisError::EmptyPack)
    );
    assert_eq!(exact_density(&none, &good), Err(AnalysisError::EmptyPack));

    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            grid_density(&pack, &good, spacing),
            Err(AnalysisError::Option { .. })
        ));
        let options = DensityOptions {
            grid_spacing_over_d: spacing,
            ..defaults
        };
        assert!(matches!(
            packing_density(&pack, &good, &options),
            Err(AnalysisError::Option { .. })
        ));
        let options = DensityOptions {
            block_over_d: spacing,
            ..defaults
        };
        assert!(matches!(
            packing_density(&pack, &good, &options),
            Err(AnalysisError::Option { .. })
        ));
    }
    let options = DensityOptions {
        resamples: 1,
        ..defaults
    };
    assert!(matches!(
        packing_density(&pack, &good, &options),
        Err(AnalysisError::Option { .. })
    ));
    for spacing in [1e-6, 1e-300] {
        assert!(matches!(
            grid_density(&pack, &good, spacing),
            Err(AnalysisError::GridTooFine { .. })
        ));
    }

    let missing = [body(1, Pose::identity())];
    let expected = AnalysisError::ShapeIndex {
        body: 0,
        shape: 1,
        shapes: 1,
    };
    assert_eq!(Pack::new(&shapes, &missing).unwrap_err(), expected);
    let lost = [bodies[0], body(0, Pose::translation(0.0, f64::NAN, 0.0))];
    assert!(matches!(
        Pack::new(&shapes, &lost).unwrap_err(),
        AnalysisError::Pose { body: 1, .. }
    ));
}

#[test]
fn results_survive_json() {
    let mut random = Random(24);
    let shapes = [solid("A10", 1.0)];
    let bodies = turned_lattice(&mut random, 1, 4, 0.9);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = Region::Cylinder {
        centre: [1.3, 1.4],
        radius: 1.2,
        z_min: 0.0,
        z_max: 2.7,
    };
    let result = packing_density(&pack, &region, &DensityOptions::default()).unwrap();
    let text = serde_json::to_string(&result).unwrap();
    let back: PackingDensity = serde_json::from_str(&text).unwrap();
    assert!(
        (back.exact - result.exact).abs() < 1e-15
            && back.core == region
            && back.blocks == result.blocks
    );
}

/// The same bits with 1, 2 and 3 threads.
#[cfg(feature = "parallel")]
#[test]
fn same_bits_for_any_number_of_threads() {
    use femdem_analysis::{CoreOptions, choose_core, pair_overlaps};

    let mut random = Random(25);
    let shapes = [
        solid("A10", 1.0),
        crate::common::comb().0.scaled(0.2).unwrap(),
        solid("P4", 1.1),
    ];
    let bodies = turned_lattice(&mut random, 3, 7, 0.85);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let boxed = Region::Box {
        min: Point3::from([-0.5; 3]),
        max: Point3::from([5.6; 3]),
    };
    let drum = Region::Cylinder {
        centre: [2.5, 2.5],
        radius: 2.0,
        z_min: 0.0,
        z_max: 5.0,
    };
    let measure = || {
        let density =
            [boxed, drum].map(|r| packing_density(&pack, &r, &DensityOptions::default()).unwrap());
        let core = choose_core(&pack, &boxed, &CoreOptions::default()).unwrap();
        (density, core, pair_overlaps(&pack))
    };
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
    };
    let reference = pool(1).install(measure);
    assert!(reference.2.pairs.len() > 100);
    for threads in [2, 3] {
        assert_eq!(
            pool(threads).install(measure),
            reference,
            "{threads} threads"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any finite input is measured or refused: no panic, and an answer is between 0 and 1 where the
    /// bodies do not overlap.
    #[test]
    fn any_finite_input_is_measured_or_refused(
        place in prop::array::uniform3(prop_oneof![-2.0..2.0_f64, -1e12..1e12_f64, -1e300..1e300_f64]),
        low in prop::array::uniform3(prop_oneof![-2.0..1.0_f64, -1e12..1e12_f64]),
        size in prop::array::uniform3(prop_oneof![1e-9..3.0_f64, 1e3..1e9_f64]),
        round in any::<bool>(),
    ) {
        let shapes = [cube(1.0), crate::common::comb().0];
        let there = Pose::translation(place[0], place[1], place[2]);
        let region = if round {
            Region::Cylinder { centre: [low[0], low[1]], radius: size[0], z_min: low[2], z_max: low[2] + size[2] }
        } else {
            Region::Box { min: Point3::from(low), max: Point3::from(low) + Vector3::from(size) }
        };
        let bodies = [body(0, there), body(1, Pose::translation(40.0, 0.0, 0.0))];
        let pack = Pack::new(&shapes, &bodies).unwrap();
        match packing_density(&pack, &region, &DensityOptions::default()) {
            Ok(result) => {
                prop_assert!(result.grid.is_none_or(|grid| (0.0..=1.0).contains(&grid)));
                // Coordinates of 1e12 resolve no better than 1e-4; the clipped volume follows.
                let near = place.iter().chain(&low).all(|x| x.abs() < 10.0) && size.iter().all(|x| *x > 1e-3);
                prop_assert!(result.exact.is_finite());
                prop_assert!(!near || (-1e-9..=1.0 + 1e-9).contains(&result.exact), "{:?}", result);
            }
            Err(AnalysisError::Region { .. }) => {}
            Err(other) => prop_assert!(false, "{other}"),
        }
        let _ = femdem_analysis::pair_overlaps(&pack);
        let _ = femdem_analysis::choose_core(&pack, &region, &femdem_analysis::CoreOptions::default());
    }
}
