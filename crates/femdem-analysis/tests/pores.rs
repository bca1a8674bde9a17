//! The void space of a pack against exact answers.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::f64::consts::PI;

use crate::common::{Random, at, body, cube, solid, turned_lattice};
use femdem_analysis::pores::*;
use femdem_analysis::*;
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Polyhedron {
    let corners = (0..8)
        .map(|c| Point3::from([0, 1, 2].map(|k| if c >> k & 1 == 0 { low[k] } else { high[k] })));
    femdem_mesh::convex_hull(&corners.collect::<Vec<_>>()).unwrap()
}

fn region(low: [f64; 3], high: [f64; 3]) -> Region {
    Region::Box {
        min: low.into(),
        max: high.into(),
    }
}

fn still(count: u32) -> Vec<PosedBody> {
    (0..count).map(|i| body(i, Pose::identity())).collect()
}

fn ball(radius: f64) -> Polyhedron {
    let shape: Shape = "sphere:level=2".parse().unwrap();
    shape.polyhedron(2.0 * radius).unwrap()
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

/// Distance of a point from a triangle by projection onto its convex set (alternating over barycentric weights).
fn sampled(triangle: &[Point3; 3], p: &Point3) -> f64 {
    let [a, b, c] = triangle;
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    // The distance from the segment at a share of the way from a to the side bc is convex in the share.
    let at = |s: f64| {
        let (q, r) = (a + (b - a) * s, a + (c - a) * s);
        let along = r - q;
        let t = if along.norm_squared() > 0.0 {
            ((p - q).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (q + along * t - p).norm()
    };
    for _ in 0..60 {
        let [s, t] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if at(s) < at(t) {
            high = t;
        } else {
            low = s;
        }
    }
    at(low).min(at(high))
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

fn inside(region: &Region) -> f64 {
    tube_surface(region).unwrap().check().volume
}

#[test]
fn tubes_are_closed_and_as_large_as_their_regions() {
    let unit = region([0.0; 3], [1.0, 2.0, 3.0]);
    assert!((inside(&unit) - 6.0).abs() < 1e-6);
    let tube = Region::Cylinder {
        centre: [0.5, -1.0],
        radius: 0.5,
        z_min: 1.0,
        z_max: 3.0,
    };
    let surface = tube_surface(&tube).unwrap();
    assert!(surface.check().is_closed());
    let excess = inside(&tube) / tube.volume() - 1.0;
    assert!(excess > 0.0 && excess < 3e-5, "{excess}");
    for part in [SurfacePatch::Sides, SurfacePatch::Low, SurfacePatch::High] {
        assert!(surface.part(part).count() >= 360);
    }
}

/// Two cubes face to face and one beside a wall.
fn touching() -> ([Polyhedron; 1], Vec<PosedBody>, Region) {
    let bodies = at([
        Vector3::new(0.5, 0.5, 0.5),
        Vector3::new(1.495, 0.5, 0.5),
        Vector3::new(0.5, 0.5, 3.0),
    ]);
    (
        [cube(1.0)],
        bodies,
        region([0.0, -1.0, -1.0], [4.0, 2.0, 5.0]),
    )
}

#[test]
fn shrunken_bodies_are_closed_and_have_the_volume_of_the_factor() {
    let (shapes, bodies, space) = touching();
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = facet_surface(&pack, &space, Sides::Wall, Treatment::Shrink(0.98)).unwrap();
    let check = found.surface.check();
    assert!(check.is_closed() && check.triangles == 36 && check.edges == 54);
    let expected = 3.0 * 0.98_f64.powi(3);
    assert!((check.volume - expected).abs() < 1e-6 && (found.volume - expected).abs() < 1e-12);
    assert_eq!(
        (found.bodies, found.changed, found.overlapping, found.beyond),
        (3, 3, 0, 0)
    );
    assert!((found.volume_before - 2.995).abs() < 1e-12);
    // Too little to take the two apart, and said so.
    let found = facet_surface(&pack, &space, Sides::Wall, Treatment::Shrink(0.999)).unwrap();
    assert_eq!(found.overlapping, 1);
}

#[test]
fn gaps_are_as_wide_as_asked_and_only_where_bodies_touch() {
    let (shapes, bodies, space) = touching();
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = facet_surface(&pack, &space, Sides::Wall, Treatment::Gap(0.02)).unwrap();
    assert!(found.surface.check().is_closed());
    // Between the two 0.995 - s = 0.02; at the wall 0.5 - s/2 = 0.02.
    let (first, second, third) = (0.96_f64, 0.975_f64, 0.96_f64);
    let expected = [first, second, third]
        .map(|s| s.powi(3))
        .iter()
        .sum::<f64>();
    assert!((found.volume - expected).abs() < 1e-9, "{}", found.volume);
    assert_eq!(found.changed, 3);
    // Open sides are no walls: the third cube stays as it is.
    let open = facet_surface(&pack, &space, Sides::Open, Treatment::Gap(0.02)).unwrap();
    assert!((open.volume - (1.0 + 2.0 * 0.975_f64.powi(3))).abs() < 1e-9);
    assert_eq!(open.changed, 2);
}

#[test]
fn caps_are_cut_only_where_bodies_touch() {
    let (shapes, bodies, space) = touching();
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = facet_surface(&pack, &space, Sides::Wall, Treatment::Cap(0.02)).unwrap();
    assert!(found.surface.check().is_closed());
    // Each loses 0.0125 at the contact, 0.02 at the wall.
    let expected = (1.0 - 0.0125 - 0.02) + (1.0 - 0.0125) + (1.0 - 0.02);
    assert!((found.volume - expected).abs() < 1e-9, "{}", found.volume);
    assert!((found.surface.check().volume - expected).abs() < 1e-6);
}

/// A turned pack in which bodies overlap by corners, edges and faces: after both treatments none of them has a
/// corner within the gap of another, and each stays closed.
#[test]
fn turned_bodies_are_taken_apart() {
    let shapes = [solid("A10", 1.0), solid("P4", 0.9)];
    let bodies = turned_lattice(&mut Random(11), 2, 2, 0.86);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    assert!(pair_overlaps(&pack).pairs.len() > 3);
    let space = region([-2.0; 3], [5.0; 3]);
    let gap = 0.01;
    for treatment in [Treatment::Gap(gap), Treatment::Cap(gap)] {
        let found = facet_surface(&pack, &space, Sides::Open, treatment).unwrap();
        let check = found.surface.check();
        assert!(check.is_closed(), "{check:?}");
        assert!((check.volume / found.volume - 1.0).abs() < 1e-5);
        assert!(found.volume < found.volume_before && found.volume > 0.7 * found.volume_before);
        let apart = apart(&found.surface);
        assert!(apart >= gap * (1.0 - 1e-9), "{treatment:?}: {apart}");
    }
}

/// Least distance of a corner of one connected part of a surface from another part.
fn apart(surface: &Surface) -> f64 {
    // Parts by the triangles' common corners.
    let bits = |p: &Point3| [p.x, p.y, p.z].map(f64::to_bits);
    let mut part: std::collections::BTreeMap<_, usize> = std::collections::BTreeMap::new();
    let corners: Vec<[Point3; 3]> = surface.part(SurfacePatch::Bodies).collect();
    for (number, triangle) in corners.iter().enumerate() {
        let known: Vec<usize> = triangle
            .iter()
            .filter_map(|p| part.get(&bits(p)).copied())
            .collect();
        for p in triangle {
            part.insert(bits(p), number);
        }
        for old in known {
            part.values_mut()
                .filter(|n| **n == old)
                .for_each(|n| *n = number);
        }
    }
    let of = |t: &[Point3; 3]| part[&bits(&t[0])];
    let mut least = f64::INFINITY;
    for t in &corners {
        for p in t {
            for other in corners.iter().filter(|o| of(o) != of(t)) {
                least = least.min(sampled(other, p));
            }
        }
    }
    least
}

/// The void around a ball in a box, and in a tube: closed, and of the exact volume to the second order.
#[test]
fn the_surface_of_the_void_is_closed() {
    let shapes = [ball(0.5)];
    let bodies = at([Vector3::new(0.1, 0.0, 0.9), Vector3::new(0.0, 0.2, 2.1)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let solids = Solids::new(&pack).with_balls(&[Some(0.5)]).unwrap();
    let balls = 2.0 * PI / 6.0;
    let tube = Region::Cylinder {
        centre: [0.0; 2],
        radius: 1.0,
        z_min: 0.0,
        z_max: 3.0,
    };
    for space in [region([-1.0, -1.0, 0.0], [1.0, 1.0, 3.0]), tube] {
        let image = voxel_image(&solids, &space, 0.05).unwrap();
        let distances = signed_distance(&solids, &image, Sides::Open);
        let surface = void_surface(&image, &distances, &[]).unwrap();
        let check = surface.check();
        assert!(check.is_closed() && check.degenerate == 0, "{check:?}");
        let expected = space.volume() - balls;
        assert!(
            (check.volume / expected - 1.0).abs() < 1e-3,
            "{} {expected}",
            check.volume
        );
        // The ends lie in their planes.
        for (part, z) in [(SurfacePatch::Low, 0.0), (SurfacePatch::High, 3.0)] {
            let mut area = 0.0;
            for [a, b, c] in surface.part(part) {
                assert!([a, b, c].iter().all(|p| (p.z - z).abs() < 1e-12));
                area += 0.5 * (b - a).cross(&(c - a)).norm();
            }
            // The rim is bevelled, by half a voxel.
            let exact = space.volume() / 3.0;
            assert!(area < exact && area > exact - 8.0 * 0.026, "{area} {exact}");
        }
    }
}

/// Two balls that touch in a point are joined by a bridge: one hole fewer between them, and the volume of the
/// cylinder less what the balls have of it.
#[test]
fn bridges_join_what_touches() {
    let shapes = [ball(0.5)];
    let bodies = at([Vector3::new(0.0, 0.0, 0.5), Vector3::new(0.0, 0.0, 1.5)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let solids = Solids::new(&pack).with_balls(&[Some(0.5)]).unwrap();
    let space = region([-1.0, -1.0, -0.5], [1.0, 1.0, 2.5]);
    let image = voxel_image(&solids, &space, 0.025).unwrap();
    let distances = signed_distance(&solids, &image, Sides::Open);
    let r = 0.2;
    let bridge = Bridge {
        point: Point3::new(0.0, 0.0, 1.0),
        normal: Vector3::z(),
        radius: r,
    };
    let surface = void_surface(&image, &distances, &[bridge]).unwrap();
    let check = surface.check();
    assert!(check.is_closed());
    let plain = void_surface(&image, &distances, &[]).unwrap().check();
    // Twice the part of the cylinder between the plane and a ball of radius R: π r² R - 2π/3 (R³ - (R² - r²)^1.5).
    let (big, small) = (0.5_f64, 0.25 - r * r);
    let lens = PI * r * r * big - 2.0 * PI / 3.0 * (big.powi(3) - small.powf(1.5));
    let lost = plain.volume - check.volume;
    assert!((lost / (2.0 * lens) - 1.0).abs() < 0.1, "{lost} {lens}");
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
    assert!(voxel_image(&solids, &round, 0.1).is_err() && tube_surface(&round).is_err());
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
