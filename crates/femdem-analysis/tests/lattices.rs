//! Densities of perfect lattices, exactly and by the grid.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Random, at, cube, moved, solid};
use femdem_analysis::{Pack, PosedBody, Region, exact_density, grid_density};
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

fn cube_region(low: [f64; 3], side: f64) -> Region {
    let min = Point3::from(low);
    Region::Box {
        min,
        max: min + Vector3::repeat(side),
    }
}

/// All lattice points `scale * (i a + j b + k c)` whose body of radius `radius` can reach the region.
fn lattice(basis: [[i32; 3]; 3], scale: f64, region: &Region, radius: f64) -> Vec<PosedBody> {
    let (min, max) = region.corners();
    let reach = ((max - min).norm() + min.coords.norm()) / scale;
    // Every integer point up to that distance, kept when it is in the lattice: basis^-1 x integer.
    let m = |r: usize, c: usize| i64::from(basis[r][c]);
    let cofactor = |r: usize, c: usize| {
        let [r1, r2, c1, c2] = [(r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3];
        m(r1, c1) * m(r2, c2) - m(r1, c2) * m(r2, c1)
    };
    let determinant: i64 = (0..3).map(|c| m(0, c) * cofactor(0, c)).sum();
    let most = reach.ceil() as i64 + 3;
    let mut places = Vec::new();
    for x in -most..=most {
        for y in -most..=most {
            for z in -most..=most {
                let place = Vector3::new(x as f64, y as f64, z as f64) * scale;
                let near =
                    (0..3).all(|k| min[k] - radius <= place[k] && place[k] <= max[k] + radius);
                let in_lattice = || {
                    (0..3).all(|r| {
                        (x * cofactor(r, 0) + y * cofactor(r, 1) + z * cofactor(r, 2)) % determinant
                            == 0
                    })
                };
                if near && in_lattice() {
                    places.push(place);
                }
            }
        }
    }
    at(places)
}

fn density(shape: &Polyhedron, bodies: &[PosedBody], region: &Region) -> f64 {
    let shapes = std::slice::from_ref(shape);
    exact_density(&Pack::new(shapes, bodies).unwrap(), region)
        .unwrap()
        .density
}

fn grid_of_cubes(n: i32) -> Vec<PosedBody> {
    let place = |i: i32| f64::from(i);
    at((0..n * n * n).map(|i| Vector3::new(place(i % n), place(i / n % n), place(i / (n * n)))))
}

/// Cubes face to face fill space: also when the pack is turned against the region.
#[test]
fn stacked_cubes_fill_space() {
    let bodies = grid_of_cubes(9);
    let shape = cube(1.0);
    assert!((density(&shape, &bodies, &cube_region([0.3, 0.7, 1.1], 6.3)) - 1.0).abs() < 1e-9);
    assert!((density(&shape, &bodies, &cube_region([0.5; 3], 7.0)) - 1.0).abs() < 1e-9);
    let mut random = Random(5);
    for _ in 0..10 {
        let turn = Pose::from_parts(Translation3::identity(), random.rotation());
        let turned = moved(&moved(&bodies, &Pose::translation(-4.0, -4.0, -4.0)), &turn);
        let found = density(&shape, &turned, &cube_region([-2.0; 3], 4.0));
        assert!((found - 1.0).abs() < 1e-9, "{found}");
        let drum = Region::Cylinder {
            centre: [0.1, 0.2],
            radius: 2.0,
            z_min: -1.5,
            z_max: 2.0,
        };
        assert!((density(&shape, &turned, &drum) - 1.0).abs() < 1e-9);
    }
}

/// Truncated octahedra on a body-centred cubic lattice fill space. Vertices are the permutations of
/// (0, ±1, ±2) over sqrt 5, the cubic cell has side 4 over sqrt 5.
#[test]
fn truncated_octahedra_fill_space() {
    let shape = solid("A13", 2.0);
    let half_cell = 2.0 / 5_f64.sqrt();
    let region = cube_region([-1.7, -2.1, -1.9], 4.3);
    let bodies = lattice([[1, 1, 1], [2, 0, 0], [0, 2, 0]], half_cell, &region, 1.0);
    let found = density(&shape, &bodies, &region);
    assert!((found - 1.0).abs() < 1e-9, "{found}");
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let grid = grid_density(&pack, &region, 0.1).unwrap();
    assert!((grid.density - 1.0).abs() < 4.0 * grid.error, "{grid:?}");
}

/// Densest known lattice packings, solids of circumradius 1, in a cubic region whose side is a period
/// of the lattice: the density there is the lattice's, wherever the region lies.
///
/// Bases: from an optimisation made for this project, with densities that agree to six digits with Torquato and
/// Jiao, Phys. Rev. E 80, 041104 (2009); given here as integers times a length, of which they were found to be
/// multiples. Densities: tetrahedra 18/49 (Hoylman 1970), octahedra 18/19 (Minkowski 1904), dodecahedra (2 +
/// φ)/4 (Betke and Henk 2000), truncated tetrahedra 207/304 (Betke and Henk 2000).
#[test]
fn densest_lattices() {
    let golden = 0.5 * (1.0 + 5_f64.sqrt());
    let cases = [
        (
            "P1",
            [[2, 5, -5], [-1, -6, -1], [-6, -1, 1]],
            1.0 / 27_f64.sqrt(),
            196,
            18.0 / 49.0,
        ),
        (
            "P3",
            [[-1, 1, 0], [-1, 1, 2], [-1, 0, 1]],
            2.0 / 3_f64.sqrt(),
            2,
            (2.0 + golden) / 4.0,
        ),
        (
            "P4",
            [[1, 2, -3], [-2, -3, -1], [-3, 1, -2]],
            1.0 / 3.0,
            38,
            18.0 / 19.0,
        ),
        (
            "A1",
            [[1, 1, -4], [-1, -4, -1], [-3, -2, 1]],
            4.0 / (3.0 * 11_f64.sqrt()),
            38,
            207.0 / 304.0,
        ),
    ];
    for (id, basis, scale, period, expected) in cases {
        let shape = solid(id, 2.0);
        let region = cube_region([0.123, -0.456, 0.789], f64::from(period) * scale);
        let bodies = lattice(basis, scale, &region, 1.0);
        let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
        let found = exact_density(&pack, &region).unwrap();
        assert!(
            (found.density - expected).abs() < 1e-9,
            "{id}: {found:?}, expected {expected}"
        );
        assert!(
            found.overlap_volume / found.body_volume < 1e-10,
            "{id} overlaps: {found:?}"
        );
        let grid = grid_density(&pack, &region, 0.173).unwrap();
        assert!(
            (grid.density - expected).abs() < 4.0 * grid.error,
            "{id}: {grid:?}, expected {expected}"
        );
    }
}
