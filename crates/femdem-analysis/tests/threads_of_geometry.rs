//! Geometry gives the same bits whatever the number of threads.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Random, solid, turned_lattice};
use femdem_analysis::*;
use femdem_mesh::Point3;
use femdem_mesh::shapes::{Dolos, Shape};

fn tables(pack: &Pack) -> Vec<String> {
    let region = Region::Box {
        min: Point3::from([0.1; 3]),
        max: Point3::from([4.2; 3]),
    };
    let drum = Region::Cylinder {
        centre: [2.0; 2],
        radius: 1.9,
        z_min: 0.3,
        z_max: 4.0,
    };
    let axes = BodyAxes::Principal;
    let directions: Vec<[f64; 3]> = body_directions(pack, &axes, None)
        .unwrap()
        .iter()
        .map(|d| d.direction)
        .collect();
    let order = orientation_order(pack, &axes, None, &OrientationOptions::default()).unwrap();
    vec![
        height_profile(pack, &drum, &ProfileOptions::default())
            .unwrap()
            .to_csv(),
        wall_profile(pack, &region, &ProfileOptions::default())
            .unwrap()
            .to_csv(),
        density_map(pack, &drum, &DensityMapOptions::default())
            .unwrap()
            .to_csv(),
        set_voronoi(pack, &region, &SetVoronoiOptions::default())
            .unwrap()
            .to_csv(),
        serde_json::to_string(&set_voronoi(pack, &drum, &SetVoronoiOptions::default()).unwrap())
            .unwrap(),
        radial_distribution(pack, &region, &RadialOptions::default())
            .unwrap()
            .to_csv(),
        stereonet(&directions, &StereonetOptions::default())
            .unwrap()
            .to_csv(),
        serde_json::to_string(&order).unwrap(),
    ]
}

#[test]
fn same_bits_with_any_number_of_threads() {
    let dolos = Shape::from(Dolos::default()).polyhedron(1.0).unwrap();
    let shapes = [solid("A10", 1.0), dolos];
    let bodies = turned_lattice(&mut Random(2), 2, 5, 0.85);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| tables(&pack))
    };
    let one = with(1);
    assert!(one.iter().all(|table| table.len() > 100));
    for threads in [2, 3] {
        assert_eq!(with(threads), one, "{threads} threads");
    }
}

/// The void space, too: image, distances, pore sizes and both kinds of surfaces.
#[test]
fn same_bits_of_pores_with_any_number_of_threads() {
    use femdem_analysis::pores::*;
    let shapes = [solid("A10", 1.0)];
    let bodies: Vec<PosedBody> = turned_lattice(&mut Random(2), 1, 4, 0.85);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let drum = Region::Cylinder {
        centre: [1.4; 2],
        radius: 1.8,
        z_min: -0.3,
        z_max: 3.0,
    };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let solids = Solids::new(&pack);
            let image = voxel_image(&solids, &drum, 0.07).unwrap();
            let distances = signed_distance(&solids, &image, Sides::Wall);
            let diameters = local_thickness(&image, &distances).unwrap();
            let found = paths(&image);
            let void = void_surface(&image, &distances, &[]).unwrap();
            let caps = facet_surface(&pack, &drum, Sides::Open, Treatment::Cap(0.01)).unwrap();
            (image, distances, diameters, found, void, caps)
        })
    };
    let one = with(1);
    assert!(one.0.counts().void > 1000 && one.5.changed > 10);
    for threads in [2, 3] {
        assert!(with(threads) == one, "{threads} threads");
    }
}
