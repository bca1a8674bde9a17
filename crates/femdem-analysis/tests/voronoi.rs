//! Set-Voronoi cells compared with known cells.

use crate::common::{Random, at, body, cube, moved, solid, turned_lattice};
use femdem_analysis::*;
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

fn options(leaf_over_d: f64) -> SetVoronoiOptions {
    SetVoronoiOptions {
        leaf_over_d,
        ..SetVoronoiOptions::default()
    }
}

fn box_of(min: [f64; 3], max: [f64; 3]) -> Region {
    Region::Box {
        min: Point3::from(min),
        max: Point3::from(max),
    }
}

/// Sum of the cells against the region, and of the solids against the exact density, in a pack with
/// overlaps, of convex and non-convex bodies, in a box, a cylinder and a sphere.
#[test]
fn cells_sum_to_the_region() {
    let dolos = Shape::from(Dolos::default()).polyhedron(1.0).unwrap();
    let shapes = [solid("A10", 1.0), dolos];
    let bodies = turned_lattice(&mut Random(3), 2, 5, 0.85);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let regions = [
        box_of([0.3, 0.2, -0.4], [3.1, 2.9, 6.0]),
        Region::Cylinder {
            centre: [1.7, 1.7],
            radius: 1.6,
            z_min: 0.0,
            z_max: 3.0,
        },
        Region::Sphere {
            centre: Point3::from([1.7; 3]),
            radius: 1.8,
        },
    ];
    for region in regions {
        let found = set_voronoi(&pack, &region, &options(0.2)).unwrap();
        let sum: f64 = found.cells.iter().map(|c| c.volume).sum();
        assert!(
            (sum / region.volume() - 1.0).abs() < 1e-9,
            "{sum} {}",
            region.volume()
        );
        let solid: f64 = found.cells.iter().map(|c| c.solid).sum();
        let exact = exact_density(&pack, &region).unwrap();
        assert!(
            (solid / sum - exact.density).abs() < 1e-9,
            "{} {exact:?}",
            solid / sum
        );
        assert!(
            found.cells.iter().any(|c| c.at_boundary) && found.cells.iter().any(|c| !c.at_boundary)
        );
    }
}

/// Rounding in a leaf does not create a part of a cell: the same cells reach the boundary wherever the pack is.
#[test]
fn cells_reach_the_boundary_wherever_the_pack_is() {
    let shapes = [solid("A1", 1.0)];
    let bodies = turned_lattice(&mut Random(5), 1, 6, 0.75);
    let found = |by: Vector3| {
        let moved = moved(&bodies, &Pose::translation(by.x, by.y, by.z));
        let pack = Pack::new(&shapes, &moved).unwrap();
        let [min, max] = [[0.2; 3], [3.6; 3]].map(|p| Point3::from(p) + by);
        set_voronoi(&pack, &Region::Box { min, max }, &options(0.125)).unwrap()
    };
    let reaching = |found: &SetVoronoi| -> Vec<(u32, bool)> {
        let cells = found.cells.iter();
        cells.map(|c| (c.body, c.at_boundary)).collect()
    };
    let here = reaching(&found(Vector3::zeros()));
    for k in 1..8 {
        let there = found(Vector3::new(0.1, -0.2, 0.7) * f64::from(k));
        assert_eq!(reaching(&there), here, "{k}");
    }
}

/// Alike and alike turned bodies on a lattice have cells of the same volume, that of the lattice's own cell.
/// In the core of a lattice, as in a periodic pack, density by cells is that of the lattice: 18/19 for octahedra
/// (Minkowski 1904), 1 for truncated octahedra, and thinned by a cube for shrunken ones.
#[test]
fn density_of_lattices() {
    let bcc = |half_cell: f64| {
        let mut places = Vec::new();
        for i in -7_i32..=7 {
            for j in -7_i32..=7 {
                for k in -7_i32..=7 {
                    if (i + j) % 2 == 0 && (j + k) % 2 == 0 {
                        places.push(Vector3::from([i, j, k].map(|n| f64::from(n) * half_cell)));
                    }
                }
            }
        }
        at(places)
    };
    let octahedra = {
        let basis =
            [[1, 2, -3], [-2, -3, -1], [-3, 1, -2]].map(|v| Vector3::from(v.map(f64::from)) / 3.0);
        let range = -6_i32..=6;
        let places = range.clone().flat_map(|i| {
            let range = range.clone();
            range
                .clone()
                .flat_map(move |j| range.clone().map(move |k| [i, j, k]))
        });
        at(places
            .map(|n| (0..3).map(|k| f64::from(n[k]) * basis[k]).sum::<Vector3>())
            .filter(|place| place.amax() < 3.7))
    };
    let half_cell = 2.0 / 5_f64.sqrt();
    let cases = [
        (solid("A13", 2.0), bcc(half_cell), 1.0, 2e-3),
        (solid("A13", 1.8), bcc(half_cell), 0.9_f64.powi(3), 3e-3),
        (
            solid("A10", 1.5),
            bcc(half_cell),
            solid("A10", 1.5).mass_properties().volume / (4.0 * half_cell.powi(3)),
            1e-3,
        ),
        (solid("P4", 2.0), octahedra, 18.0 / 19.0, 3e-3),
    ];
    for (shape, bodies, expected, tolerance) in cases {
        let shapes = [shape];
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let region = box_of([-3.0; 3], [3.0; 3]);
        let core = Region::Sphere {
            centre: Point3::origin(),
            radius: 1.6,
        };
        let with = SetVoronoiOptions {
            core: Some(core),
            ..SetVoronoiOptions::default()
        };
        let found = set_voronoi(&pack, &region, &with).unwrap();
        assert!(found.mean.count >= 9, "{found:?}");
        let density = found.density.mean;
        assert!(
            (density / expected - 1.0).abs() < tolerance,
            "{density}, not {expected}"
        );
        for cell in found.cells.iter().filter(|c| c.counted) {
            assert!(
                (cell.density / expected - 1.0).abs() < 3.0 * tolerance,
                "{cell:?}"
            );
        }
    }
}

/// The point in the cell of every body by brute force: nearest of all bodies.
#[test]
fn cells_agree_with_counting_nearest_bodies() {
    let shapes = [solid("P5", 1.0), solid("P1", 1.0)];
    let mut random = Random(21);
    let bodies: Vec<PosedBody> = (0..12).map(|i| body(i % 2, random.pose(1.0))).collect();
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = box_of([-1.4, -1.5, -1.3], [1.5, 1.4, 1.6]);
    let found = set_voronoi(&pack, &region, &options(0.1)).unwrap();
    // Distance as the norm of what alternating projections onto the half-spaces leave (Dykstra).
    let distance =
        |b: &PosedBody, p: &Point3| depth_or_distance(&shapes[b.shape as usize], &b.pose, p);
    let n = 30_000;
    let mut counts = vec![0_u32; bodies.len()];
    let (min, max) = region.corners();
    for _ in 0..n {
        let point = random.point(&min, &max);
        let distances: Vec<f64> = bodies.iter().map(|b| distance(b, &point)).collect();
        let nearest = (0..bodies.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        counts[nearest.unwrap()] += 1;
    }
    for cell in &found.cells {
        let share = cell.volume / region.volume();
        let counted = f64::from(counts[cell.body as usize]) / f64::from(n);
        let noise = (share * (1.0 - share) / f64::from(n)).sqrt();
        assert!(
            (share - counted).abs() < 4.5 * noise,
            "{cell:?}: {share}, counted {counted}"
        );
    }
}

/// Largest distance from a face's plane inside; outside the distance to the projection by Dykstra's method.
fn depth_or_distance(shape: &Polyhedron, pose: &Pose, point: &Point3) -> f64 {
    let start = pose.inverse_transform_point(point).coords;
    let planes: Vec<(Vector3, f64)> = (0..shape.face_count())
        .map(|k| (shape.face_normal(k), shape.face_offset(k)))
        .collect();
    let depth = planes
        .iter()
        .map(|(n, o)| n.dot(&start) - o)
        .fold(f64::NEG_INFINITY, f64::max);
    if depth <= 0.0 {
        return depth;
    }
    let mut at = start;
    let mut corrections = vec![Vector3::zeros(); planes.len()];
    for _ in 0..60 {
        for ((normal, offset), correction) in planes.iter().zip(&mut corrections) {
            let trial = at + *correction;
            at = trial - normal * (normal.dot(&trial) - offset).max(0.0);
            *correction = trial - at;
        }
    }
    (at - start).norm()
}

/// The stated error of a cell: against leaves a quarter as wide.
#[test]
fn error_of_a_cell_is_as_stated() {
    let shapes = [solid("A10", 1.0)];
    let bodies = turned_lattice(&mut Random(9), 1, 5, 0.9);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = box_of([0.2; 3], [3.4; 3]);
    let error = |leaf: f64| {
        let fine = set_voronoi(&pack, &region, &options(0.03125)).unwrap();
        let coarse = set_voronoi(&pack, &region, &options(leaf)).unwrap();
        let both = coarse
            .cells
            .iter()
            .zip(&fine.cells)
            .filter(|(c, _)| !c.at_boundary);
        let squares: Vec<f64> = both
            .map(|(c, f)| (c.volume / f.volume - 1.0).powi(2))
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let (coarse, fine) = (error(0.125), error(0.0625));
    assert!(coarse < 0.0013, "{coarse}");
    assert!(fine < 0.4 * coarse, "{fine} {coarse}");
}

/// Icosahedra and tetrahedra, whose densest known lattices have no simple lengths. Bases: from an optimisation
/// made for this project, with densities that agree to six digits with Torquato and Jiao, Phys. Rev. E 80,
/// 041104 (2009); tetrahedra 18/49 (Hoylman 1970). Solids of circumradius 1.
#[test]
fn density_of_oblique_lattices() {
    let cases = [
        (
            "P2",
            [
                [0.646145775124307, 1.2880219853220087, -1.8753491455939066],
                [0.03559406879562153, -1.5353568739330086, 0.4344489775594788],
                [
                    -1.3902775120186062,
                    -0.8142716778911536,
                    0.45828056006744655,
                ],
            ],
            0.836357,
        ),
        (
            "P1",
            [
                [0.38489759972920345, 0.9622537980024244, -0.9622496792080278],
                [
                    -0.1924497472786299,
                    -1.154700538704742,
                    -0.19245085949671423,
                ],
                [-1.154700538704742, -0.19245322526238148, 0.1924521125744695],
            ],
            18.0 / 49.0,
        ),
    ];
    for (id, basis, expected) in cases {
        let basis = basis.map(Vector3::from);
        let mut places = Vec::new();
        for i in 0..17_i32.pow(3) {
            let n = [i % 17 - 8, i / 17 % 17 - 8, i / 289 - 8].map(f64::from);
            let place: Vector3 = (0..3).map(|k| n[k] * basis[k]).sum();
            if place.amax() < 4.8 {
                places.push(place);
            }
        }
        let (shapes, bodies) = ([solid(id, 2.0)], at(places));
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let core = Region::Sphere {
            centre: Point3::origin(),
            radius: 2.2,
        };
        let with = SetVoronoiOptions {
            core: Some(core),
            ..SetVoronoiOptions::default()
        };
        let found = set_voronoi(&pack, &box_of([-3.8; 3], [3.8; 3]), &with).unwrap();
        assert!(found.mean.count >= 5, "{id}: {:?}", found.mean);
        let density = found.density.mean;
        assert!(
            (density / expected - 1.0).abs() < 4e-3,
            "{id}: {density}, not {expected}"
        );
    }
}

#[test]
fn far_bodies_and_empty_space() {
    // One body owns everything, however far.
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::new(50.0, 0.0, 0.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = box_of([0.0; 3], [3.0; 3]);
    let found = set_voronoi(&pack, &region, &options(0.5)).unwrap();
    assert!((found.cells[0].volume - 27.0).abs() < 1e-9);
    assert_eq!(
        (
            found.cells[0].solid,
            found.mean.count,
            found.mean.standard_error
        ),
        (0.0, 0, None)
    );
    for leaf in [0.0, f64::NAN, 1e-5] {
        let refused = set_voronoi(&pack, &region, &options(leaf));
        assert!(matches!(
            refused,
            Err(AnalysisError::Option {
                name: "leaf_over_d",
                ..
            })
        ));
    }
}
