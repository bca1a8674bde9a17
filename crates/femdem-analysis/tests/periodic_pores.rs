//! The void space of periodic packs: the same wherever the cell begins, and connected through its faces.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::f64::consts::PI;

use crate::common::pores::{ball, region};
use crate::common::{Random, at, solid, turned_lattice};
use femdem_analysis::mesh::{Matrix3, PeriodicCell};
use femdem_analysis::pores::*;
use femdem_analysis::*;
use femdem_mesh::{Point3, Polyhedron, Vector3};

fn space(sides: [Option<f64>; 3]) -> PeriodicSpace {
    PeriodicSpace {
        cell: PeriodicCell::new(sides).unwrap(),
        lower: Point3::origin(),
    }
}

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

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Polyhedron {
    let corners = (0..8)
        .map(|c| Point3::from([0, 1, 2].map(|k| if c >> k & 1 == 0 { low[k] } else { high[k] })));
    femdem_mesh::convex_hull(&corners.collect::<Vec<_>>()).unwrap()
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

/// Triangles of a part, moved, by corners that are sorted.
fn sorted(surface: &Surface, part: SurfacePatch, way: Vector3) -> Vec<[[i64; 3]; 3]> {
    let key = |p: Point3| [0, 1, 2].map(|k| ((p[k] + way[k]) * 1e9).round() as i64);
    let mut found: Vec<_> = surface
        .part(part)
        .map(|triangle| {
            let mut corners = triangle.map(key);
            corners.sort_unstable();
            corners
        })
        .collect();
    found.sort_unstable();
    found
}

/// Bodies in a corner and over edges of the cell, with a bridge through a face: the surface of the void is closed, has the volume
/// of the image, and equal triangles on opposite sides.
#[test]
fn opposite_sides_of_the_void_have_the_same_triangles() {
    let shapes = [solid("A10", 0.8)];
    let mut bodies = turned_lattice(&mut Random(5), 1, 2, 0.8);
    bodies.truncate(5);
    for sides in [
        [Some(1.987); 3],
        [Some(1.987), Some(1.987), None],
        [Some(1.987), None, None],
    ] {
        let cell = region([-0.313, -0.207, -0.911], [1.674, 1.78, 1.076]);
        let around = PeriodicSpace {
            lower: cell.corners().0,
            ..space(sides)
        };
        let images = WithImages::new(&shapes, &bodies, &around, &cell, 1.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        let solids = Solids::new(&pack);
        let image = voxel_image(&solids, &cell, 0.04).unwrap();
        let distances = signed_distance(&solids, &image, Sides::Open);
        let bridge = Bridge {
            point: Point3::new(-0.29, 0.9, 0.1),
            normal: Vector3::x(),
            radius: 0.1,
        };
        let surface = void_surface(&image, &distances, &[bridge]).unwrap();
        let check = surface.check();
        assert!(check.is_closed() && check.degenerate == 0, "{check:?}");
        let exact = cell.volume() * (1.0 - exact_density(&pack, &cell).unwrap().density);
        assert!(
            (check.volume / exact - 1.0).abs() < 3e-3,
            "{} {exact}",
            check.volume
        );
        let (low, high) = surface_region(&image).corners();
        for (k, [near, far]) in [
            [SurfacePatch::XLow, SurfacePatch::XHigh],
            [SurfacePatch::YLow, SurfacePatch::YHigh],
            [SurfacePatch::Low, SurfacePatch::High],
        ]
        .into_iter()
        .enumerate()
        {
            let mut way = Vector3::zeros();
            way[k] = high[k] - low[k];
            let [a, b] =
                [(near, way), (far, Vector3::zeros())].map(|(p, w)| sorted(&surface, p, w));
            if sides[k].is_some() {
                assert!(
                    a.len() > 100 && a == b,
                    "{sides:?} {k}: {} {}",
                    a.len(),
                    b.len()
                );
            } else {
                assert_eq!(a.is_empty(), k < 2);
            }
        }
    }
}

/// Caps of bodies at a face are those of their images at the other face, also where the partner lies wholly beyond it.
#[test]
fn bodies_at_opposite_faces_are_cut_alike() {
    let shapes = [cuboid([-0.5; 3], [0.5; 3])];
    // Face to face at x = 0, the face of the cell.
    let bodies = at([Vector3::new(0.4995, 0.5, 0.5), Vector3::new(2.5, 0.5, 0.5)]);
    let cell = region([0.0; 3], [3.0; 3]);
    let around = space([Some(3.0); 3]);
    let images = WithImages::new(&shapes, &bodies, &around, &cell, 0.5).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let found = facet_surface(&pack, &cell, Sides::Wall, Treatment::Cap(0.01)).unwrap();
    // The gap lies about x = -0.00025 and 2.99975, and there are no walls.
    for middle in [-0.00025, 2.99975] {
        let off = |p: &Point3| p.x - middle;
        let near = found
            .surface
            .vertices
            .iter()
            .map(off)
            .filter(|x| x.abs() < 0.1);
        let nearest = near.map(f64::abs).fold(f64::INFINITY, f64::min);
        assert!((nearest - 0.005).abs() < 1e-9, "{nearest}");
    }
    assert!((found.surface.check().volume / found.volume - 1.0).abs() < 1e-6);
}
