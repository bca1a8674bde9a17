//! The void space of periodic packs: the same wherever the cell begins, and connected through its faces.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::f64::consts::PI;

use crate::common::at;
use crate::common::pores::{ball, cuboid, region, space};
use femdem_analysis::mesh::Matrix3;
use femdem_analysis::pores::*;
use femdem_analysis::*;
use femdem_mesh::{Point3, Vector3};

/// Centres of balls of radius 0.3 m, of which no two images overlap in a cell of 2 m, 1.6 m and 1.8 m, off the planes of voxels.
const CENTRES: [[f64; 3]; 4] = [
    [0.021, 0.113, 0.037],
    [1.013, 0.921, 0.871],
    [1.107, 0.237, 1.613],
    [0.243, 1.019, 1.231],
];
const SIDES: [f64; 3] = [2.0, 1.6, 1.8];

/// The balls, moved by parts of the sides of the cell: image, pore sizes, paths.
fn of_balls(parts: [f64; 3]) -> (VoxelImage, PoreSizes, Tortuosity) {
    let shapes = [ball(0.3)];
    let way = Vector3::from([0, 1, 2].map(|k| parts[k] * SIDES[k]));
    let bodies = at(CENTRES.map(|c| Vector3::from(c) + way));
    let cell = region([0.0; 3], SIDES);
    let images = WithImages::new(&shapes, &bodies, &space(SIDES.map(Some)), &cell, 1.5).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let solids = Solids::new(&pack).with_balls(&[Some(0.3)]).unwrap();
    let image = voxel_image(&solids, &cell, 0.05).unwrap();
    let distances = signed_distance(&solids, &image, Sides::Wall);
    assert!(distances.iter().all(|distance| *distance < 1.5));
    let diameters = local_thickness(&image, &distances).unwrap();
    let sizes = PoreSizes::new(&image, &diameters).unwrap();
    let found = paths(&image).tortuosity;
    (image, sizes, found)
}

#[test]
fn a_cell_of_balls_has_the_same_void_wherever_it_begins() {
    let (image, sizes, found) = of_balls([0.0; 3]);
    assert_eq!(image.repeats, [true; 3]);
    let volume: f64 = SIDES.iter().product();
    let exact = 1.0 - 4.0 * (4.0 / 3.0 * PI * 0.3_f64.powi(3)) / volume;
    assert!((image.counts().porosity() - exact).abs() < 1e-3);
    assert_eq!(
        (image.counts().outside, image.labels.iter().max()),
        (0, Some(&4))
    );
    assert_eq!(found.connected, 1.0);
    for parts in [[0.5, 0.0, 0.0], [0.0, -0.5, 0.0], [0.0, 0.0, 1.5], [0.5; 3]] {
        let (moved, other, ways) = of_balls(parts);
        assert_eq!(image.counts(), moved.counts());
        for (a, b) in [
            (sizes.mean, other.mean),
            (sizes.median, other.median),
            (sizes.largest, other.largest),
            (found.mean.unwrap(), ways.mean.unwrap()),
        ] {
            assert!((a / b - 1.0).abs() < 1e-3, "{parts:?}: {a} {b}");
        }
        // Voxel for voxel.
        for (index, label) in moved.labels.iter().enumerate() {
            let place = moved.grid.position(index);
            let from = [0, 1, 2].map(|k| {
                let count = moved.grid.counts[k] as f64;
                (place[k] as f64 - parts[k] * count).rem_euclid(count) as usize
            });
            assert_eq!(*label, image.labels[image.grid.index(from)], "{parts:?}");
        }
    }
}

/// A plate that lies across a face along z: the slit between it and its image is as wide as the rest of the cell, also where the
/// face cuts it.
#[test]
fn a_slit_is_as_wide_across_a_face() {
    let shapes = [cuboid([-9.0, -9.0, 0.3], [9.0, 9.0, 0.8])];
    let cell = region([0.0; 3], [1.0; 3]);
    let around = space([None, None, Some(1.0)]);
    let images = WithImages::new(&shapes, &at([Vector3::zeros()]), &around, &cell, 1.0).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let solids = Solids::new(&pack);
    let image = voxel_image(&solids, &cell, 0.1).unwrap();
    assert_eq!(image.repeats, [false, false, true]);
    let distances = signed_distance(&solids, &image, Sides::Open);
    let diameters = local_thickness(&image, &distances).unwrap();
    for (label, diameter) in image.labels.iter().zip(&diameters) {
        let expected = if *label == VOID { 0.5 } else { 0.0 };
        assert!((diameter - expected).abs() < 1e-12);
    }
}

/// Shelves with a slot at x from 0.85 to 0.95 and one from 0.05 to 0.15, in cells of 1 m: the way through the face is 0.1 m wide,
/// that within it 0.7 m.
#[test]
fn paths_go_on_through_faces() {
    let shapes = [
        cuboid([-0.05, -9.0, 0.48], [0.85, 9.0, 0.52]),
        cuboid([0.15, -9.0, 1.48], [1.05, 9.0, 1.52]),
    ];
    let found = |sides: [Option<f64>; 3], up: f64| {
        let mut bodies = at([0.0, 0.0].map(|x| Vector3::new(x, 0.0, up)));
        bodies[1].shape = 1;
        let cell = region([0.0; 3], [1.0, 0.02, 2.0]);
        let images = WithImages::new(&shapes, &bodies, &space(sides), &cell, 0.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        paths(&voxel_image(&Solids::new(&pack), &cell, 0.01).unwrap()).tortuosity
    };
    // A corner takes a voxel and a half; between the shelves the way rises by 0.96.
    let across = found([Some(1.0), None, None], 0.0).shortest.unwrap();
    let expected = (0.1_f64.hypot(0.96) + 1.04) / 2.0;
    assert!(
        across > expected - 1e-6 && across < expected + 0.015,
        "{across} {expected}"
    );
    // In a pile of such cells the way bends back above.
    let sides = [Some(1.0), None, Some(2.0)];
    let expected = (2.0 * 0.1_f64.hypot(0.96) + 0.08) / 2.0;
    for up in [0.0, 0.4, 1.0, -0.7] {
        let piled = found(sides, up);
        let mean = piled.mean.unwrap();
        assert!(
            mean > expected - 1e-6 && mean < expected + 0.03,
            "{mean} {expected}"
        );
        assert!(piled.deviation.unwrap() < 1e-3 && piled.connected == 1.0);
    }
}

#[test]
fn a_cell_that_leans_is_refused_by_name() {
    let shapes = [ball(0.3)];
    let mut around = space(SIDES.map(Some));
    let mut edges: Matrix3 = *around.cell.edges();
    edges[(0, 2)] = 0.25;
    around.cell = around.cell.with_edges(edges).unwrap();
    let cell = region([0.0; 3], SIDES);
    let images = WithImages::new(
        &shapes,
        &at(CENTRES.map(Vector3::from)),
        &around,
        &cell,
        1.0,
    );
    let images = images.unwrap();
    let pack = images.pack(&shapes).unwrap();
    let solids = Solids::new(&pack);
    let error = voxel_image(&solids, &cell, 0.1).unwrap_err().to_string();
    assert!(
        error.contains("edge z") && error.contains("0.25"),
        "{error}"
    );
    // A part of it has sides that are cut.
    let part = region([0.0; 3], [1.0; 3]);
    assert_eq!(
        voxel_image(&solids, &part, 0.1).unwrap().repeats,
        [false; 3]
    );
}

fn upright(radius: f64, z: [f64; 2]) -> Region {
    Region::Cylinder {
        centre: [0.0; 2],
        radius,
        z_min: z[0],
        z_max: z[1],
    }
}

/// A ball on the ends of an upright cylinder that is a period long, and half a period off them.
#[test]
fn a_cylinder_goes_on_through_its_ends() {
    let shapes = [ball(0.3)];
    let around = space([None, None, Some(1.0)]);
    let found = [0.013, 0.513].map(|z| {
        let bodies = at([Vector3::new(0.1, 0.0, z)]);
        let drum = upright(0.6, [0.0, 1.0]);
        let images = WithImages::new(&shapes, &bodies, &around, &drum, 1.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        let solids = Solids::new(&pack).with_balls(&[Some(0.3)]).unwrap();
        let image = voxel_image(&solids, &drum, 0.02).unwrap();
        assert_eq!(image.repeats, [false, false, true]);
        let distances = signed_distance(&solids, &image, Sides::Wall);
        let diameters = local_thickness(&image, &distances).unwrap();
        let sizes = PoreSizes::new(&image, &diameters).unwrap();
        let ways = paths(&image).tortuosity;
        (
            image.counts(),
            [sizes.mean, sizes.largest, ways.mean.unwrap()],
        )
    });
    assert_eq!(found[0].0, found[1].0);
    for (a, b) in found[0].1.iter().zip(&found[1].1) {
        assert!((a / b - 1.0).abs() < 1e-3, "{found:?}");
    }
}

/// The cell is a third of a metre wide along x and has walls along y.
#[test]
fn sides_are_walls_where_they_are_those_of_the_container() {
    let bodies = at([Vector3::zeros()]);
    let shapes = [ball(0.01)];
    let cell = region([0.0; 3], [1.0 / 3.0, 1.0, 1.0]);
    let around = space([Some(1.0 / 3.0), None, None]);
    let images = WithImages::new(&shapes, &bodies, &around, &cell, 0.0).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let found = |region: &Region, other: &Region| {
        let repeats = pack.repeats_over(region).unwrap();
        (repeats[0], pack.has_sides_of(region, other).unwrap())
    };
    // Typed, begun elsewhere, narrower along x, narrower along y.
    for (low, high, repeats, same) in [
        ([0.0; 3], [0.333_333_3, 1.0, 0.5], true, true),
        ([0.1, 0.0, 0.0], [0.433_333_3, 1.0, 1.0], true, true),
        ([0.0; 3], [0.333, 1.0, 1.0], false, false),
        ([0.0; 3], [0.333_333_3, 0.99, 1.0], true, false),
    ] {
        assert_eq!(
            found(&region(low, high), &cell),
            (repeats, same),
            "{high:?}"
        );
    }
    let drum = upright(1.0, [0.0, 5.0]);
    assert_eq!(found(&upright(1.0, [0.0, 2.0]), &drum), (false, true));
    assert_eq!(found(&upright(0.9, [0.0, 2.0]), &drum), (false, false));
    assert_eq!(found(&cell, &drum), (true, false));
}

/// Small balls at the centres of the voxels that lie in a cylinder: its mantle is far from them.
#[test]
fn images_count_as_far_as_the_void_is_wide() {
    let shapes = [ball(0.01)];
    let drum = upright(1.0, [0.0, 0.5]);
    let all =
        [-0.75_f64, -0.25, 0.25, 0.75].map(|x| [-0.75_f64, -0.25, 0.25, 0.75].map(|y| [x, y]));
    let places = all.as_flattened().iter().filter(|[x, y]| x.hypot(*y) < 1.0);
    let bodies = at(places.map(|[x, y]| Vector3::new(*x, *y, 0.25)));
    assert_eq!(bodies.len(), 12);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let solids = Solids::new(&pack);
    let reach = images_reach(&solids, &drum, 0.5, 0.0).unwrap();
    let rim = Point3::new(0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.5);
    assert!(reach >= solids.signed_distance(&rim), "{reach}");
}
