//! Profiles of packing density against densities of the same slabs and shells one by one.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Random, at, cube, solid, turned_lattice};
use femdem_analysis::*;
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Polyhedron, Vector3};

fn tank() -> Region {
    Region::Box {
        min: Point3::new(0.2, 0.3, -0.3),
        max: Point3::new(3.9, 3.6, 4.1),
    }
}

fn drum() -> Region {
    Region::Cylinder {
        centre: [2.0, 2.1],
        radius: 1.9,
        z_min: -0.3,
        z_max: 4.1,
    }
}

fn options(width_over_d: f64) -> ProfileOptions {
    ProfileOptions {
        width_over_d,
        ..ProfileOptions::default()
    }
}

fn shapes() -> [Polyhedron; 2] {
    let dolos = Shape::from(Dolos::default()).polyhedron(1.0).unwrap();
    [solid("A10", 1.0), dolos]
}

/// The part of the region at least `distance` from its side walls.
fn narrowed(region: &Region, distance: f64) -> Region {
    match *region {
        Region::Box { min, max } => Region::Box {
            min: min + Vector3::new(distance, distance, 0.0),
            max: max - Vector3::new(distance, distance, 0.0),
        },
        Region::Cylinder {
            centre,
            radius,
            z_min,
            z_max,
        } => Region::Cylinder {
            centre,
            radius: radius - distance,
            z_min,
            z_max,
        },
        Region::Sphere { .. } => panic!("no side walls"),
    }
}

fn solid_volume(pack: &Pack, region: &Region) -> f64 {
    let found = exact_density(pack, region).unwrap();
    found.body_volume - found.overlap_volume
}

/// A pack with overlaps of two convex, of two non-convex and of two mixed bodies, that reaches over the sides.
#[test]
fn slabs_hold_what_each_holds_alone() {
    let shapes = shapes();
    let bodies = turned_lattice(&mut Random(3), 2, 6, 0.75);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    for region in [tank(), drum()] {
        let profile = height_profile(&pack, &region, &options(0.3)).unwrap();
        assert_eq!(profile.coordinate, ProfileCoordinate::Height);
        assert!(profile.blocks >= 2);
        for bin in &profile.bins {
            let slab = region.slab(bin.low, bin.high).unwrap();
            assert!((slab.volume() - bin.volume).abs() < 1e-12);
            let expected = solid_volume(&pack, &slab);
            assert!((bin.solid - expected).abs() < 1e-10, "{bin:?}: {expected}");
            let centroids = pack.bodies_in(&slab).unwrap().len();
            assert_eq!(centroids, bin.centroids as usize);
        }
    }
}

#[test]
fn shells_hold_what_nested_regions_differ_by() {
    let shapes = shapes();
    let bodies = turned_lattice(&mut Random(4), 2, 6, 0.75);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    for region in [tank(), drum()] {
        let profile = wall_profile(&pack, &region, &options(0.25)).unwrap();
        assert_eq!(profile.coordinate, ProfileCoordinate::WallDistance);
        let (inner, shells) = profile.bins.split_last().unwrap();
        for bin in shells {
            let [outer, inner] = [bin.low, bin.high].map(|s| narrowed(&region, s));
            assert!((outer.volume() - inner.volume() - bin.volume).abs() < 1e-12);
            let expected = solid_volume(&pack, &outer) - solid_volume(&pack, &inner);
            assert!((bin.solid - expected).abs() < 1e-10, "{bin:?}: {expected}");
        }
        // The last bin reaches to the axis.
        let core = narrowed(&region, inner.low);
        assert!((inner.volume - core.volume()).abs() < 1e-12);
        assert!((inner.solid - solid_volume(&pack, &core)).abs() < 1e-10);
        let all: u32 = profile.bins.iter().map(|b| b.centroids).sum();
        assert_eq!(all as usize, pack.bodies_in(&region).unwrap().len());
    }
}

/// Cubes of side 1 in layers 1.25 apart: whole bins are full or empty.
#[test]
fn layers_show() {
    let node = |i: i32| f64::from(i);
    let bodies = at((0..256).map(|i| {
        Vector3::new(node(i % 8), node(i / 8 % 8), 1.25 * node(i / 64)) + Vector3::repeat(0.5)
    }));
    let shapes = [cube(1.0)];
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = Region::Box {
        min: Point3::origin(),
        max: Point3::new(8.0, 8.0, 5.0),
    };
    let profile = height_profile(&pack, &region, &options(0.25 / 3_f64.sqrt())).unwrap();
    for (k, bin) in profile.bins.iter().enumerate() {
        let expected = if k % 5 == 4 { 0.0 } else { 1.0 };
        assert!((bin.density - expected).abs() < 1e-12, "{bin:?}");
        assert!(bin.standard_error.unwrap() < 1e-12);
    }
}

/// The error stated for one pack agrees with the scatter over packs made in the same way.
#[test]
fn standard_errors_are_the_scatter_of_packs() {
    let shapes = [solid("A10", 1.0)];
    let region = Region::Box {
        min: Point3::new(0.6, 0.6, 0.6),
        max: Point3::new(10.4, 10.4, 4.4),
    };
    let mut random = Random(8);
    let (mut densities, mut errors) = (Vec::new(), Vec::new());
    for _ in 0..24 {
        // Some nodes of a lattice stay empty.
        let mut bodies = turned_lattice(&mut random, 1, 10, 1.1);
        bodies.retain(|b| b.pose.translation.z < 5.0 && random.uniform(0.0, 1.0) < 0.7);
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let bin = height_profile(&pack, &region, &options(0.4)).unwrap().bins[5];
        densities.push(bin.density);
        errors.push(bin.standard_error.unwrap());
    }
    let n = densities.len() as f64;
    let mean = densities.iter().sum::<f64>() / n;
    let scatter = (densities.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let stated = errors.iter().sum::<f64>() / n;
    // The scatter of 24 packs is known to 15 %.
    assert!(
        (0.6..1.5).contains(&(stated / scatter)),
        "stated {stated}, scatter {scatter}"
    );
}

#[test]
fn what_cannot_be_is_refused() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::zeros()]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    for width in [0.0, -1.0, f64::NAN, 1e-9] {
        let refused = height_profile(&pack, &tank(), &options(width));
        assert!(
            matches!(
                refused,
                Err(AnalysisError::Option {
                    name: "width_over_d",
                    ..
                })
            ),
            "{width}"
        );
    }
    let ball = Region::Sphere {
        centre: Point3::origin(),
        radius: 1.0,
    };
    assert!(matches!(
        wall_profile(&pack, &ball, &options(0.1)),
        Err(AnalysisError::RegionKind { .. })
    ));
    let empty = Pack::new(&shapes, &[]).unwrap();
    assert_eq!(
        height_profile(&empty, &tank(), &options(0.1)),
        Err(AnalysisError::EmptyPack)
    );
}
