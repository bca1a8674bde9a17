//! Clipped volumes and overlaps against Monte Carlo, sums of parts, and symmetry.

use crate::common::{Random, at, body, comb, cube, holds, moved, solid, turned_lattice};
use femdem_analysis::{
    Pack, Region, exact_density, grid_density, intersection_volume, pair_overlaps, volume_inside,
};
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Point3, Pose, Rotation, Vector3};

fn box_region(random: &mut Random) -> Region {
    let min = random.point(&Point3::from([-0.8; 3]), &Point3::from([0.2; 3]));
    let size = random.point(&Point3::from([0.2; 3]), &Point3::from([1.2; 3]));
    Region::Box {
        min,
        max: min + size.coords,
    }
}

fn drum(random: &mut Random) -> Region {
    let z_min = random.uniform(-0.8, 0.2);
    let z_max = z_min + random.uniform(0.2, 1.0);
    let centre = [random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)];
    Region::Cylinder {
        centre,
        radius: random.uniform(0.2, 0.8),
        z_min,
        z_max,
    }
}

/// Five standard deviations of the share `p` of `n` samples, and never less than one sample in `n`.
fn tolerance(p: f64, n: u32) -> f64 {
    5.0 * ((p * (1.0 - p)).max(0.0) / f64::from(n)).sqrt() + 1.0 / f64::from(n)
}

#[test]
fn clipped_volume_against_monte_carlo() {
    let mut random = Random(11);
    let samples = 20_000;
    for id in ["P1", "P2", "P5", "A1", "A4", "A10", "A12"] {
        let shape = solid(id, 2.0);
        for region in [
            box_region(&mut random),
            drum(&mut random),
            box_region(&mut random),
            drum(&mut random),
        ] {
            let pose = random.pose(0.5);
            let exact = volume_inside(&shape, &pose, &region).unwrap() / region.volume();
            let (min, max) = region.corners();
            let (mut tried, mut hits) = (0, 0);
            while tried < samples {
                let point = random.point(&min, &max);
                if region.contains(&point) {
                    tried += 1;
                    hits += u32::from(holds(&shape, &pose, &point));
                }
            }
            let counted = f64::from(hits) / f64::from(samples);
            assert!(
                (exact - counted).abs() < tolerance(exact, samples),
                "{id} {region:?}: {exact} {counted}"
            );
        }
    }
}

#[test]
fn shared_volume_against_monte_carlo_and_swapped() {
    let mut random = Random(12);
    let samples = 20_000;
    for (first, second) in [
        ("P1", "P4"),
        ("A10", "A10"),
        ("P5", "P5"),
        ("A3", "P2"),
        ("A13", "P1"),
    ] {
        let (a, b) = (solid(first, 2.0), solid(second, 1.5));
        for _ in 0..4 {
            let (p, q) = (random.pose(0.4), random.pose(0.4));
            let exact = intersection_volume((&a, &p), (&b, &q)).unwrap();
            let swapped = intersection_volume((&b, &q), (&a, &p)).unwrap();
            assert!((exact - swapped).abs() < 1e-12, "{exact} {swapped}");
            let low = p.translation.vector.add_scalar(-1.0);
            let hits = (0..samples)
                .map(|_| random.point(&low.into(), &low.add_scalar(2.0).into()))
                .filter(|x| holds(&a, &p, x) && holds(&b, &q, x))
                .count();
            let (share, counted) = (exact / 8.0, hits as f64 / f64::from(samples));
            assert!(
                (share - counted).abs() < tolerance(share, samples),
                "{first} {second}: {share} {counted}"
            );
        }
    }
}

/// A body shares its whole volume with itself (all faces coplanar) and with a copy inside, none with
/// a copy that only touches.
#[test]
fn coincident_and_touching_faces() {
    let mut random = Random(13);
    for id in ["P1", "P3", "P5", "A7", "A10", "A4m"] {
        let (shape, small) = (solid(id, 2.0), solid(id, 1.0));
        let volume = shape.mass_properties().volume;
        for _ in 0..20 {
            let pose = random.pose(3.0);
            let own = intersection_volume((&shape, &pose), (&shape, &pose)).unwrap();
            assert!(
                (own / volume - 1.0).abs() < 1e-12,
                "{id}: {own} of {volume}"
            );
            let inner = intersection_volume((&small, &pose), (&shape, &pose)).unwrap();
            assert!((8.0 * inner / volume - 1.0).abs() < 1e-12);
            // A copy slid along the normal of a face until the two just touch, and spun about that normal.
            let normal = shape.face_normal(0);
            let spin = Rotation::from_scaled_axis(normal * random.uniform(0.0, 6.0));
            let width = shape.face_offset(0)
                - shape
                    .vertices()
                    .iter()
                    .map(|v| normal.dot(&v.coords))
                    .fold(0.0, f64::min);
            let beside = pose * Pose::from_parts(Translation3::from(normal * width), spin);
            let touching = intersection_volume((&shape, &pose), (&shape, &beside)).unwrap();
            assert!(touching.abs() / volume < 1e-12, "{id}: {touching}");
        }
    }
}

/// Two cubes of side 1, one inside the other by 0.2 x 1 x 1, and a third by 0.1 x 0.5 x 1.
#[test]
fn known_overlaps_are_subtracted_once() {
    let shape = cube(1.0);
    let bodies = at([
        Vector3::zeros(),
        Vector3::new(0.8, 0.0, 0.0),
        Vector3::new(-0.9, 0.5, 0.0),
    ]);
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let overlaps = pair_overlaps(&pack);
    let found: Vec<_> = overlaps.pairs.iter().map(|p| (p.first, p.second)).collect();
    assert_eq!(found, [(0, 1), (0, 2)]);
    assert!(
        (overlaps.pairs[0].volume - 0.2).abs() < 1e-12
            && (overlaps.pairs[1].volume - 0.05).abs() < 1e-12
    );
    let around = Region::Box {
        min: Point3::from([-2.0; 3]),
        max: Point3::from([2.0; 3]),
    };
    let whole = exact_density(&pack, &around).unwrap();
    assert!((whole.density * 64.0 - 2.75).abs() < 1e-12, "{whole:?}");
    // A region whose face runs through the middle of the first overlap.
    let part = Region::Box {
        min: Point3::new(0.4, -1.0, -1.0),
        max: Point3::new(2.0, 1.0, 1.0),
    };
    let cut = exact_density(&pack, &part).unwrap();
    assert!(
        (cut.overlap_volume - 0.1).abs() < 1e-12 && (cut.body_volume - 1.0).abs() < 1e-12,
        "{cut:?}"
    );
}

/// A non-convex body is the sum of its convex parts, for every region, section and partner.
#[test]
fn non_convex_bodies_are_the_sum_of_their_parts() {
    let (whole, parts) = comb();
    assert!(!whole.is_convex());
    let mut random = Random(14);
    let knife = solid("A8", 3.0);
    for trial in 0..60 {
        let pose = random.pose(1.5) * Pose::translation(-2.5, -1.5, -0.5);
        let round = trial % 6 == 0;
        for region in [box_region(&mut random)]
            .into_iter()
            .chain(round.then(|| drum(&mut random)))
        {
            let sum: f64 = parts
                .iter()
                .map(|p| volume_inside(p, &pose, &region).unwrap())
                .sum();
            let found = volume_inside(&whole, &pose, &region).unwrap();
            assert!((found - sum).abs() < 1e-12, "{found} {sum}");
        }
        let other = random.pose(1.0);
        let sum: f64 = parts
            .iter()
            .map(|p| intersection_volume((p, &pose), (&knife, &other)).unwrap())
            .sum();
        let found = intersection_volume((&knife, &other), (&whole, &pose)).unwrap();
        assert!((found - sum).abs() < 1e-12, "{found} {sum}");
    }
}

/// Cells counted in a comb are the cells counted in its parts.
#[test]
fn grid_counts_non_convex_bodies_as_their_parts() {
    let (whole, parts) = comb();
    let mut random = Random(15);
    let region = Region::Box {
        min: Point3::from([-2.0; 3]),
        max: Point3::new(2.0, 2.5, 1.5),
    };
    for _ in 0..10 {
        let pose = random.pose(0.5) * Pose::translation(-2.5, -1.5, -0.5);
        let one = [body(0, pose)];
        let many: Vec<_> = (0..4).map(|i| body(i, pose)).collect();
        let whole = grid_density(
            &Pack::new(std::slice::from_ref(&whole), &one).unwrap(),
            &region,
            0.11,
        )
        .unwrap();
        let parts = grid_density(&Pack::new(&parts, &many).unwrap(), &region, 0.11).unwrap();
        assert!(whole.solid_cells > 1000);
        assert_eq!(whole.solid_cells, parts.solid_cells);
    }
}

/// Density does not depend on where the world's origin is, nor on the order of the bodies; a quarter
/// turn of everything changes nothing either.
#[test]
fn density_follows_rigid_motion() {
    let mut random = Random(16);
    let shapes = [solid("A10", 1.1), solid("P1", 1.4)];
    let bodies = turned_lattice(&mut random, 2, 5, 0.8);
    let region = Region::Box {
        min: Point3::new(0.3, 0.5, 0.2),
        max: Point3::new(2.9, 2.7, 3.0),
    };
    let reference = exact_density(&Pack::new(&shapes, &bodies).unwrap(), &region).unwrap();
    assert!(
        reference.overlap_volume / reference.body_volume > 1e-3,
        "{reference:?}"
    );

    let shift = Vector3::new(17.3, -4.1, 9.9);
    let shifted = moved(&bodies, &Pose::translation(shift.x, shift.y, shift.z));
    let Region::Box { min, max } = region else {
        unreachable!()
    };
    let there = Region::Box {
        min: min + shift,
        max: max + shift,
    };
    let found = exact_density(&Pack::new(&shapes, &shifted).unwrap(), &there).unwrap();
    assert!((found.density - reference.density).abs() < 1e-12);

    let quarter = Pose::from_parts(
        Translation3::identity(),
        Rotation::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_2),
    );
    let turned = moved(&bodies, &quarter);
    let there = Region::Box {
        min: Point3::new(-max.y, min.x, min.z),
        max: Point3::new(-min.y, max.x, max.z),
    };
    let found = exact_density(&Pack::new(&shapes, &turned).unwrap(), &there).unwrap();
    assert!((found.density - reference.density).abs() < 1e-12);

    let reversed: Vec<_> = bodies.iter().rev().copied().collect();
    let found = exact_density(&Pack::new(&shapes, &reversed).unwrap(), &region).unwrap();
    assert!((found.density - reference.density).abs() < 1e-12);
}

/// A body around the whole cylinder fills it; one that reaches to a chord leaves a circular segment.
#[test]
fn cylinders_against_closed_formulas() {
    let big = cube(10.0);
    let region = Region::Cylinder {
        centre: [0.4, -0.3],
        radius: 2.5,
        z_min: -2.0,
        z_max: 1.0,
    };
    let inside = volume_inside(&big, &Pose::identity(), &region).unwrap();
    assert!((inside / region.volume() - 1.0).abs() < 1e-14, "{inside}");
    // A face at distance h from the axis.
    let h = 1.1_f64;
    let beyond = volume_inside(&big, &Pose::translation(0.4 + h + 5.0, 0.0, 0.0), &region).unwrap();
    let segment = 3.0 * (2.5_f64.powi(2) * (h / 2.5).acos() - h * (2.5_f64.powi(2) - h * h).sqrt());
    assert!(
        (beyond - segment).abs() / region.volume() < 1e-14,
        "{beyond} {segment}"
    );
}
