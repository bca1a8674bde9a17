//! Closed surfaces of the void space against exact answers.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::f64::consts::PI;

use crate::common::pores::{ball, region, sampled};
use crate::common::{Random, at, cube, solid, turned_lattice};
use femdem_analysis::pores::*;
use femdem_analysis::*;
use femdem_mesh::{Point3, Polyhedron, Vector3};

fn inside(region: &Region) -> f64 {
    tube_surface(region, [false; 3]).unwrap().check().volume
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
    let surface = tube_surface(&tube, [false; 3]).unwrap();
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

/// The largest factor that takes all apart: two cubes that overlap by 0.005 m need 0.99; one that reaches into the
/// wall by 0.02 m needs 0.96.
#[test]
fn the_usual_factor_takes_all_apart() {
    let (shapes, mut bodies, space) = touching();
    let factor = |bodies: &[PosedBody], sides| {
        let pack = Pack::new(&shapes, bodies).unwrap();
        shrink_factor(&pack, &space, sides).unwrap()
    };
    assert!((factor(&bodies, Sides::Wall) - 0.99).abs() < 1e-12);
    bodies[2].pose.translation.x = 0.481;
    assert!((factor(&bodies, Sides::Open) - 0.99).abs() < 1e-12);
    assert!((factor(&bodies, Sides::Wall) - 0.96).abs() < 1e-12);
}

/// A flow begins a margin below the lowest body and ends one above the highest, but not in the cone of a silo.
#[test]
fn tubes_of_a_flow_have_margins() {
    let shapes = [cube(1.0)];
    let container = region([-2.0, -2.0, 0.0], [2.0, 2.0, 9.0]);
    let of = |heights: [f64; 2]| {
        let bodies = at(heights.map(|z| Vector3::new(0.0, 0.0, z)));
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let (low, high) = flow_region(&pack, &container, 1.0).unwrap().corners();
        [low.z, high.z]
    };
    assert_eq!(
        of([0.49, 1.5]).map(|z| (z * 1e3).round()),
        [-1010.0, 3000.0]
    );
    assert_eq!(of([-0.5, 1.5]).map(|z| (z * 1e3).round()), [0.0, 3000.0]);
}
