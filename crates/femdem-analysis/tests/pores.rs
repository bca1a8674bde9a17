//! The void space of a pack against exact answers.

use std::f64::consts::PI;

use crate::common::pores::{ball, cuboid, region, sampled};
use crate::common::{Random, at, body, cube, solid, turned_lattice};
use femdem_analysis::pores::*;
use femdem_analysis::*;
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Pose, Vector3};

fn still(count: u32) -> Vec<PosedBody> {
    (0..count).map(|i| body(i, Pose::identity())).collect()
}

/// A cube whose faces lie between voxel centres is counted exactly; voxels carry its number.
#[test]
fn a_cube_fills_its_voxels() {
    let shapes = [cube(0.5)];
    let bodies = at([
        Vector3::new(0.25, 0.25, 0.75),
        Vector3::new(0.75, 0.75, 0.25),
    ]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let unit = region([0.0; 3], [1.0; 3]);
    let image = voxel_image(&Solids::new(&pack), &unit, 0.1).unwrap();
    assert_eq!(image.grid.counts, [10; 3]);
    let counts = image.counts();
    assert_eq!((counts.void, counts.solid, counts.outside), (750, 250, 0));
    assert_eq!(image.labels[image.grid.index([0, 0, 9])], 1);
    assert_eq!(image.labels[image.grid.index([9, 9, 0])], 2);
    assert_eq!(image.labels[image.grid.index([0, 9, 9])], VOID);
    assert!((exact_density(&pack, &unit).unwrap().density - 0.25).abs() < 1e-12);
}

/// A ball as a ball, not as its facets, in a tube: porosity by the formulas, voxels outside the tube marked.
#[test]
fn a_ball_in_a_tube_has_the_porosity_of_the_formula() {
    let shapes = [ball(0.8)];
    let bodies = at([Vector3::new(0.1, 0.0, 1.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let tube = Region::Cylinder {
        centre: [0.0; 2],
        radius: 1.0,
        z_min: 0.0,
        z_max: 2.0,
    };
    let solids = Solids::new(&pack).with_balls(&[Some(0.8)]).unwrap();
    let image = voxel_image(&solids, &tube, 0.02).unwrap();
    let exact = 1.0 - 4.0 / 3.0 * PI * 0.8_f64.powi(3) / (2.0 * PI);
    let counts = image.counts();
    assert!((counts.porosity() - exact).abs() < 1e-3);
    let corner = 1.0 - PI / 4.0;
    assert!((counts.outside as f64 / 1e6 - corner).abs() < 1e-3);
    assert_eq!(image.labels[0], OUTSIDE);
    // Distances of the ball and of the wall.
    let distances = signed_distance(&solids, &image, Sides::Wall);
    for (index, distance) in distances.iter().enumerate() {
        let p = image.grid.centre(image.grid.position(index));
        let wall = 1.0 - p.x.hypot(p.y);
        let of_ball = (p - Point3::new(0.1, 0.0, 1.0)).norm() - 0.8;
        let expected = if image.labels[index] == OUTSIDE {
            wall
        } else {
            wall.min(of_ball)
        };
        assert!((distance - expected).abs() < 1e-12, "{p}");
    }
}

/// Distances of convex, many-faced and non-convex bodies against the nearest of all triangles, in a turned pack
/// with overlaps.
#[test]
fn distances_are_those_of_the_nearest_triangle() {
    let dolos = Shape::from(Dolos::default()).polyhedron(1.0).unwrap();
    let shapes = [solid("A3", 1.0), dolos, ball(0.5)];
    let mut bodies = turned_lattice(&mut Random(7), 2, 2, 0.9);
    for (i, body) in bodies.iter_mut().enumerate() {
        body.shape = i as u32 % 3;
    }
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let part = region([-0.2; 3], [1.1, 1.0, 1.2]);
    let image = voxel_image(&Solids::new(&pack), &part, 0.13).unwrap();
    let distances = signed_distance(&Solids::new(&pack), &image, Sides::Open);
    let triangles: Vec<[Point3; 3]> = bodies
        .iter()
        .flat_map(|b| {
            let shape = &shapes[b.shape as usize];
            let place = |v: u32| b.pose * shape.vertices()[v as usize];
            shape.triangles().into_iter().map(move |t| t.map(place))
        })
        .collect();
    let mut void = 0;
    for (index, distance) in distances.iter().enumerate() {
        assert_eq!(*distance > 0.0, image.labels[index] == VOID);
        if *distance > 0.0 {
            let p = image.grid.centre(image.grid.position(index));
            let brute = triangles.iter().map(|t| sampled(t, &p));
            let brute = brute.fold(f64::INFINITY, f64::min);
            assert!((distance - brute).abs() < 1e-6, "{distance} {brute}");
            void += 1;
        }
    }
    assert!(void > 100 && void < distances.len() - 100);
}

/// Two plates 0.5 m apart: the pore is as wide as the slit, where the slit ends by less.
#[test]
fn a_slit_is_as_wide_as_it_is() {
    let shapes = [
        cuboid([-9.0, -9.0, -2.0], [9.0, 9.0, 0.2]),
        cuboid([-9.0, -9.0, 0.7], [9.0, 9.0, 2.0]),
    ];
    let bodies = still(2);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let solids = Solids::new(&pack);
    // 5 voxels across the slit, one of them in the middle.
    let unit = region([0.0; 3], [1.0; 3]);
    let image = voxel_image(&solids, &unit, 0.1).unwrap();
    let fill = |sides| {
        let distances = signed_distance(&solids, &image, sides);
        let diameters = local_thickness(&image, &distances).unwrap();
        (PoreSizes::new(&image, &diameters).unwrap(), diameters)
    };
    let (sizes, diameters) = fill(Sides::Open);
    for (label, diameter) in image.labels.iter().zip(&diameters) {
        let expected = if *label == VOID { 0.5 } else { 0.0 };
        assert!((diameter - expected).abs() < 1e-12);
    }
    assert!((sizes.mean - 0.5).abs() < 1e-12 && sizes.deviation < 1e-12);
    assert!((sizes.median - 0.5).abs() < 1e-12);
    let last = sizes.bins.last().unwrap();
    assert!((last.cumulative - 1.0).abs() < 1e-15);
    let volume: f64 = sizes.bins.iter().map(|b| b.volume).sum();
    assert!((volume - 0.5).abs() < 1e-12);
    // Walls at the sides make pores narrower in the corners, not wider anywhere.
    let (walled, _) = fill(Sides::Wall);
    assert!(walled.mean < 0.5 - 1e-3 && walled.largest < 0.5 + 1e-12);
}

/// Every void voxel has the largest ball that covers it, by trying all.
#[test]
fn pore_sizes_are_those_of_all_balls_tried() {
    let shapes = [solid("A10", 1.0)];
    let bodies = turned_lattice(&mut Random(3), 1, 2, 1.0);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let solids = Solids::new(&pack);
    let part = region([-0.2; 3], [1.3, 1.2, 1.4]);
    let image = voxel_image(&solids, &part, 0.09).unwrap();
    let distances = signed_distance(&solids, &image, Sides::Wall);
    let diameters = local_thickness(&image, &distances).unwrap();
    let void: Vec<usize> = (0..image.labels.len())
        .filter(|&i| image.labels[i] == VOID)
        .collect();
    let centre = |i: usize| image.grid.centre(image.grid.position(i));
    assert!(void.len() > 500);
    for &i in &void {
        let covers = |&&j: &&usize| (centre(i) - centre(j)).norm() <= distances[j] + 1e-12;
        let largest = void.iter().filter(covers).map(|&j| 2.0 * distances[j]);
        let largest = largest.fold(0.0, f64::max);
        assert!((diameters[i] - largest).abs() < 1e-9);
    }
}

#[test]
fn an_empty_box_is_straight() {
    let shapes = [cube(0.1)];
    let bodies = at([Vector3::new(9.0, 9.0, 9.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let unit = region([0.0; 3], [1.0, 0.6, 1.3]);
    let image = voxel_image(&Solids::new(&pack), &unit, 0.1).unwrap();
    let found = paths(&image).tortuosity;
    assert!((found.straight - 1.3).abs() < 1e-12);
    for value in [found.shortest, found.mean, found.longest] {
        assert!((value.unwrap() - 1.0).abs() < 1e-12);
    }
    assert_eq!(found.connected, 1.0);
}

/// Two shelves leave a slot at the left, then one at the right: between them the shortest path is √2 of the height.
/// Fast marching is too long by less than a voxel and a half per corner, and converges.
#[test]
fn paths_go_around_shelves() {
    // From the edge of the lower shelf at (0, 0.5) to that of the upper at (1, 1.5).
    let shapes = [
        cuboid([0.0, -9.0, 0.48], [9.0, 9.0, 0.5]),
        cuboid([-9.0, -9.0, 1.5], [1.0, 9.0, 1.52]),
    ];
    let bodies = still(2);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let wide = region([-0.2, 0.0, 0.0], [1.2, 0.04, 2.0]);
    let expected = (0.5 + 2_f64.sqrt() + 0.48 + 0.02) / 2.0;
    let shortest = |voxel: f64| {
        let image = voxel_image(&Solids::new(&pack), &wide, voxel).unwrap();
        paths(&image).tortuosity.shortest.unwrap()
    };
    let (coarse, fine) = (shortest(0.02), shortest(0.01));
    assert!(
        coarse > fine && fine > expected - 1e-6,
        "{coarse} {fine} {expected}"
    );
    // Two corners, over a height of 2.
    assert!(coarse - expected < 1.5 * 0.02, "{coarse} {expected}");
    assert!(fine - expected < 1.5 * 0.01, "{fine} {expected}");
}

#[test]
fn a_shelf_from_wall_to_wall_lets_nothing_through() {
    let shapes = [cuboid([-9.0, -9.0, 0.4], [9.0, 9.0, 0.6])];
    let bodies = still(1);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let unit = region([0.0; 3], [1.0; 3]);
    let image = voxel_image(&Solids::new(&pack), &unit, 0.1).unwrap();
    let found = paths(&image);
    assert_eq!(found.tortuosity.shortest, None);
    assert_eq!(found.tortuosity.connected, 0.5);
    assert_eq!(found.lengths.iter().filter(|x| x.is_finite()).count(), 400);
}

#[test]
fn bad_options_of_pores_are_refused_by_name() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::zeros()]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let solids = Solids::new(&pack);
    let unit = region([0.0; 3], [1.0; 3]);
    for voxel in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-4] {
        let error = voxel_image(&solids, &unit, voxel).unwrap_err().to_string();
        assert!(error.contains("voxel"), "{error}");
    }
    let round = Region::Sphere {
        centre: Point3::origin(),
        radius: 1.0,
    };
    assert!(
        voxel_image(&solids, &round, 0.1).is_err() && tube_surface(&round, [false; 3]).is_err()
    );
    let nothing = Pack::new(&shapes, &[]).unwrap();
    assert_eq!(
        voxel_image(&Solids::new(&nothing), &unit, 0.1).unwrap_err(),
        AnalysisError::EmptyPack
    );
    assert!(solids.clone().with_balls(&[]).is_err());
    assert!(solids.clone().with_balls(&[Some(-1.0)]).is_err());
    let image = voxel_image(&solids, &unit, 0.5).unwrap();
    assert!(local_thickness(&image, &[]).is_err() && void_surface(&image, &[], &[]).is_err());
    let full = voxel_image(&solids, &region([-0.4; 3], [0.4; 3]), 0.2).unwrap();
    let sizes = PoreSizes::new(&full, &vec![0.0; full.labels.len()]);
    assert_eq!(sizes, Err(AnalysisError::NoVoid));
    let treat = |treatment| {
        let found = facet_surface(&pack, &unit, Sides::Wall, treatment);
        found.unwrap_err().to_string()
    };
    assert!(treat(Treatment::Shrink(1.1)).contains("0.5 to 1"));
    assert!(treat(Treatment::Gap(0.0)).contains("gap"));
    assert!(treat(Treatment::Gap(9.0)).contains("smaller gap"));
    let dolos = [Shape::from(Dolos::default()).polyhedron(1.0).unwrap()];
    let pack = Pack::new(&dolos, &bodies).unwrap();
    let found = facet_surface(&pack, &unit, Sides::Open, Treatment::Cap(0.01));
    assert!(found.unwrap_err().to_string().contains("not convex"));
}
