//! The core region and the mean top plane.

use crate::common::{Random, at, body, comb, cube, solid, turned_lattice};
use femdem_analysis::{
    AnalysisError, CoreOptions, InsetLimit, Pack, Region, TopPlane, choose_core, top_plane,
};
use femdem_mesh::{Point3, Pose, Vector3};

/// A container with its floor at z = -1.
fn container(width: f64, height: f64) -> Region {
    Region::Box {
        min: Point3::new(0.0, 0.0, -1.0),
        max: Point3::new(width, width, height - 1.0),
    }
}

/// Columns of unit cubes on the floor, `heights[i][j]` cubes each.
fn columns(heights: &[&[u32]]) -> Vec<femdem_analysis::PosedBody> {
    let mut places = Vec::new();
    for (i, row) in (0..).zip(heights) {
        for (j, &count) in (0..).zip(*row) {
            let stack = (0..count).map(|k| Vector3::new(f64::from(i), f64::from(j), f64::from(k)));
            places.extend(stack.map(|p| p + Vector3::new(0.5, 0.5, -0.5)));
        }
    }
    at(places)
}

#[test]
fn mean_top_of_steps_with_a_hole() {
    let shape = cube(1.0);
    let bodies = columns(&[&[1, 2], &[0, 3]]);
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let top = top_plane(&pack, &container(2.0, 9.0), 0.1).unwrap();
    // Heights above z = -1 of 1, 2 and 3 over a quarter of the floor each.
    assert!((top.mean - 1.0).abs() < 1e-12, "{top:?}");
    assert!((top.deviation - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    assert_eq!((top.columns, top.empty_columns), (300, 100));
    // A drum's floor is round: the corners are not used.
    let drum = Region::Cylinder {
        centre: [1.0, 1.0],
        radius: 1.0,
        z_min: -1.0,
        z_max: 1.0,
    };
    let top = top_plane(&pack, &drum, 0.1).unwrap();
    let asked = (top.columns + top.empty_columns) as f64;
    assert!(
        (asked / 400.0 - std::f64::consts::FRAC_PI_4).abs() < 0.02,
        "{asked}"
    );
    assert!((top.mean - 1.0).abs() < 1e-12);
}

/// The top of a comb is the mean over the tops of its parts, weighted by their widths.
#[test]
fn mean_top_of_a_non_convex_body() {
    let (shape, _) = comb();
    // Prongs up: y of the comb becomes z.
    let upright = Pose::rotation(Vector3::x() * std::f64::consts::FRAC_PI_2);
    let bodies = [body(0, Pose::translation(0.0, 1.0, 0.0) * upright)];
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let floor = Region::Box {
        min: Point3::origin(),
        max: Point3::new(5.0, 1.0, 1.0),
    };
    let top = top_plane(&pack, &floor, 0.05).unwrap();
    assert!(
        (top.mean - (3.0 + 1.0 + 2.0 + 1.0 + 3.0) / 5.0).abs() < 1e-12,
        "{top:?}"
    );
    assert_eq!(top.empty_columns, 0);
    // Beside the body there is no top; such a result can be read back from a file.
    let aside = Region::Box {
        min: Point3::new(50.0, 50.0, 0.0),
        max: Point3::new(51.0, 51.0, 1.0),
    };
    let none = top_plane(&pack, &aside, 0.05).unwrap();
    assert_eq!((none.mean, none.columns), (f64::NEG_INFINITY, 0));
    for top in [top, none] {
        let text = serde_json::to_string(&top).unwrap();
        assert_eq!(serde_json::from_str::<TopPlane>(&text).unwrap(), top);
    }
}

/// Where there is room the paper's five diameters are kept from walls, floor and top.
#[test]
fn paper_inset_where_there_is_room() {
    let shape = solid("A10", 1.0);
    let mut random = Random(31);
    let bodies = turned_lattice(&mut random, 1, 15, 1.0);
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let walls = Region::Box {
        min: Point3::from([-0.5; 3]),
        max: Point3::new(14.5, 14.5, 40.0),
    };
    let core = choose_core(&pack, &walls, &CoreOptions::default()).unwrap();
    assert_eq!((core.limit, core.inset_over_d), (InsetLimit::None, 5.0));
    let Region::Box { min, max } = core.region else {
        panic!("{core:?}")
    };
    assert!(
        (min - Point3::from([4.5; 3])).norm() < 1e-12
            && (max.xy() - min.xy()).add_scalar(-5.0).norm() < 1e-12
    );
    // Truncated dodecahedra standing in layers: the mean top lies in the upper half of the last one.
    assert!((14.0..14.5).contains(&core.top.mean));
    assert!((max.z - (core.top.mean - 5.0)).abs() < 1e-12);
}

/// Smaller packs keep a core of three diameters, the smallest half of their extent.
#[test]
fn smaller_packs_inset_less() {
    let shape = cube(1.0);
    let d = 3_f64.sqrt();
    let slab = |n: usize, height: u32| columns(&vec![vec![height; n].as_slice(); n]);
    let choose = |bodies: &[_], walls: &Region| {
        let pack = Pack::new(std::slice::from_ref(&shape), bodies).unwrap();
        choose_core(&pack, walls, &CoreOptions::default()).unwrap()
    };
    let low = choose(&slab(16, 12), &container(16.0, 30.0));
    assert_eq!(low.limit, InsetLimit::Height);
    assert!((low.inset - (12.0 - 3.0 * d) / 2.0).abs() < 1e-9, "{low:?}");
    let (min, max) = low.region.corners();
    assert!((max.z - min.z - 3.0 * d).abs() < 1e-9 && (min.z + 1.0 - low.inset).abs() < 1e-9);

    let tiny = choose(&slab(4, 9), &container(4.0, 30.0));
    assert_eq!(tiny.limit, InsetLimit::Width);
    let (min, max) = tiny.region.corners();
    assert!((max.x - min.x - 2.0).abs() < 1e-9 && (tiny.inset - 1.0).abs() < 1e-9);

    // A lid below the top of the pack counts as the top.
    let lidded = choose(&slab(16, 14), &container(16.0, 12.0));
    assert!((lidded.region.corners().1.z - (11.0 - lidded.inset)).abs() < 1e-9);

    let drum = Region::Cylinder {
        centre: [8.0, 8.0],
        radius: 7.0,
        z_min: -1.0,
        z_max: 20.0,
    };
    let round = choose(&slab(16, 14), &drum);
    let Region::Cylinder { radius, .. } = round.region else {
        panic!("{round:?}")
    };
    assert!((radius - (7.0 - round.inset)).abs() < 1e-12 && round.limit == InsetLimit::Width);
}

#[test]
fn packs_without_a_core_are_refused() {
    let shapes = [cube(1.0)];
    let options = CoreOptions::default();
    let walls = container(4.0, 4.0);
    let none = Pack::new(&shapes, &[]).unwrap();
    assert_eq!(
        choose_core(&none, &walls, &options),
        Err(AnalysisError::EmptyPack)
    );
    let aside = at([Vector3::new(50.0, 0.0, 0.0)]);
    let below = at([Vector3::new(2.0, 2.0, -9.0)]);
    for bodies in [aside, below] {
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let refused = choose_core(&pack, &walls, &options).unwrap_err();
        assert!(
            matches!(
                refused,
                AnalysisError::NoPackInContainer { floor: -1.0, .. }
            ),
            "{refused}"
        );
    }
    let bodies = at([Vector3::new(2.0, 2.0, 0.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    for bad in [
        CoreOptions {
            inset_over_d: -1.0,
            ..options
        },
        CoreOptions {
            minimum_core_over_d: 0.0,
            ..options
        },
        CoreOptions {
            column_spacing_over_d: f64::NAN,
            ..options
        },
    ] {
        assert!(matches!(
            choose_core(&pack, &walls, &bad),
            Err(AnalysisError::Option { .. })
        ));
    }
    assert!(matches!(
        top_plane(&pack, &walls, 0.0),
        Err(AnalysisError::Option { .. })
    ));
    assert!(matches!(
        top_plane(&pack, &walls, 1e-9),
        Err(AnalysisError::GridTooFine { .. })
    ));
}
