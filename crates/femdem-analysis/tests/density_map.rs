//! Local densities against the densities of the cells one by one.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Random, solid, turned_lattice};
use femdem_analysis::*;
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Vector3};

fn options(cell_over_d: f64) -> DensityMapOptions {
    DensityMapOptions {
        cell_over_d,
        ..DensityMapOptions::default()
    }
}

fn cell(map: &DensityMap, i: usize) -> Region {
    let half = Vector3::from(map.spacing) * 0.5;
    Region::Box {
        min: map.centre(i) - half,
        max: map.centre(i) + half,
    }
}

fn solid_volume(pack: &Pack, region: &Region) -> f64 {
    let found = exact_density(pack, region).unwrap();
    found.body_volume - found.overlap_volume
}

/// Two convex, two non-convex and mixed bodies that run into each other.
#[test]
fn cells_hold_what_each_holds_alone() {
    let dolos = Shape::from(Dolos::default()).polyhedron(1.0).unwrap();
    let shapes = [solid("A10", 1.0), dolos];
    let bodies = turned_lattice(&mut Random(3), 2, 6, 0.75);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = Region::Box {
        min: Point3::new(0.3, 0.2, -0.4),
        max: Point3::new(3.1, 3.5, 4.0),
    };
    let map = density_map(&pack, &region, &options(0.6)).unwrap();
    assert!(map.counts.iter().all(|n| *n >= 3), "{:?}", map.counts);
    for i in 0..map.densities.len() {
        let cell = cell(&map, i);
        let expected = solid_volume(&pack, &cell);
        assert!(
            (map.solids[i] - expected).abs() < 1e-10,
            "{cell:?}: {}, not {expected}",
            map.solids[i]
        );
        assert!((map.volumes[i] - cell.volume()).abs() < 1e-12);
    }
    let whole = exact_density(&pack, &region).unwrap().density;
    assert!((map.mean - whole).abs() < 1e-12);
}

#[test]
fn parts_in_round_regions_sum_to_the_whole() {
    let shapes = [solid("A10", 1.0)];
    let bodies = turned_lattice(&mut Random(5), 1, 6, 0.8);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let drum = Region::Cylinder {
        centre: [2.0, 2.1],
        radius: 1.7,
        z_min: 0.3,
        z_max: 3.7,
    };
    let ball = Region::Sphere {
        centre: Point3::new(2.0, 2.0, 2.2),
        radius: 1.8,
    };
    for region in [drum, ball] {
        let map = density_map(&pack, &region, &options(0.5)).unwrap();
        let volume: f64 = map.volumes.iter().sum();
        assert!((volume - region.volume()).abs() < 1e-11, "{volume}");
        let exact = exact_density(&pack, &region).unwrap();
        assert!(
            (map.mean - exact.density).abs() < 1e-11,
            "{} {exact:?}",
            map.mean
        );
        assert!(
            map.densities
                .iter()
                .all(|d| (-1e-9..1.0 + 1e-9).contains(d))
        );
        assert!(map.volumes.contains(&0.0) && map.blocks > 1);
    }
}

/// An empty half and a full one: the deviation of the cells is half a density.
#[test]
fn deviation_tells_how_uneven_a_pack_is() {
    let shapes = [crate::common::cube(1.0)];
    let node = f64::from;
    let bodies = crate::common::at(
        (0..32).map(|i| Vector3::new(node(i % 4), node(i / 4 % 4), node(i / 16))),
    );
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = Region::Box {
        min: Point3::from([-0.5; 3]),
        max: Point3::from([3.5; 3]),
    };
    let map = density_map(&pack, &region, &options(1.0 / 3_f64.sqrt())).unwrap();
    assert!((map.mean - 0.5).abs() < 1e-12 && (map.deviation - 0.5).abs() < 1e-12);
    assert_eq!(map.to_csv().lines().count(), 65);
    for cell_over_d in [0.0, f64::NAN, 1e-4] {
        let refused = density_map(&pack, &region, &options(cell_over_d));
        assert!(matches!(
            refused,
            Err(AnalysisError::Option {
                name: "cell_over_d",
                ..
            })
        ));
    }
}
