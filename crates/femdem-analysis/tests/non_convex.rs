//! Bodies that are not convex: overlaps and densities against closed formulas, sums of convex parts,
//! and Monte Carlo.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Random, body, comb, moved, prism, turned_lattice};
use femdem_analysis::{
    DensityOptions, Pack, PosedBody, Region, exact_density, grid_density, intersection_volume,
    packing_density, pair_overlaps, top_plane, volume_inside,
};
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::shapes::{Dolos, HollowCylinder, Pellet, Shape, Sphere};
use femdem_mesh::{Point3, Polyhedron, Pose, Rotation, Vector3};

fn made(shape: impl Into<Shape>, size: f64) -> Polyhedron {
    shape.into().polyhedron(size).unwrap()
}

fn shared(a: &Polyhedron, at_a: &Pose, b: &Polyhedron, at_b: &Pose) -> f64 {
    intersection_volume((a, at_a), (b, at_b)).unwrap()
}

/// Winding number of the surface about a point by solid angles (van Oosterom and Strackee 1983): 1
/// inside, 0 outside. Brute force over all triangles.
fn winding(shape: &Polyhedron, pose: &Pose, point: &Point3) -> f64 {
    let local = pose.inverse_transform_point(point);
    let mut angle = 0.0;
    for t in shape.triangles() {
        let [a, b, c] = t.map(|v| shape.vertices()[v as usize] - local);
        let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
        let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        angle += 2.0 * a.dot(&b.cross(&c)).atan2(below);
    }
    angle / (4.0 * std::f64::consts::PI)
}

/// A surface of some 2,000 triangles with bumps and hollows, as a scan has.
fn scan(size: f64) -> Polyhedron {
    let sphere = made(Sphere { level: 3 }, 1.0);
    let bumpy = |v: &Point3| {
        let d = v.coords.normalize();
        let waves = (7.0 * d.x).sin() * (6.0 * d.y).cos() + (9.0 * d.z + 2.0 * d.x).sin();
        Point3::from(d * (1.0 + 0.12 * waves) * 0.5 * size)
    };
    let vertices = sphere.vertices().iter().map(bumpy).collect();
    let triangles = sphere.triangles().iter().map(|t| t.to_vec()).collect();
    Polyhedron::new(vertices, triangles).unwrap()
}

/// Two combs share what their convex parts share, in all poses.
#[test]
fn shared_volume_is_the_sum_over_convex_parts() {
    let (whole, parts) = comb();
    let mut random = Random(31);
    let mut together = 0;
    for _ in 0..200 {
        let centred = Pose::translation(-2.5, -1.5, -0.5);
        let (p, q) = (random.pose(1.0) * centred, random.pose(1.0) * centred);
        let sum: f64 = parts
            .iter()
            .flat_map(|a| parts.iter().map(move |b| (a, b)))
            .map(|(a, b)| shared(a, &p, b, &q))
            .sum();
        let found = shared(&whole, &p, &whole, &q);
        assert!((found - sum).abs() < 1e-12, "{found} {sum}");
        assert!((found - shared(&whole, &q, &whole, &p)).abs() < 1e-12);
        together += u32::from(sum > 0.0);
    }
    assert!(together > 150, "{together}");
}

/// Faces that coincide or touch are no special case, in any orientation: a body shares its own volume
/// with itself, two halves pushed together share nothing, and one slid along shares the rest.
#[test]
fn coinciding_and_touching_faces() {
    let (comb, _) = comb();
    let ring = made(
        HollowCylinder {
            sides: 24,
            ..HollowCylinder::default()
        },
        1.0,
    );
    let mut random = Random(32);
    for (shape, height) in [(&comb, 1.0), (&ring, 1.0)] {
        let volume = shape.mass_properties().volume;
        for _ in 0..50 {
            let pose = random.pose(3.0);
            let own = shared(shape, &pose, shape, &pose);
            assert!((own / volume - 1.0).abs() < 1e-12, "{own} {volume}");
            let above = |dz: f64| pose * Pose::translation(0.0, 0.0, dz);
            assert!(shared(shape, &pose, shape, &above(height)).abs() < 1e-12 * volume);
            let slid = shared(shape, &pose, shape, &above(0.3 * height));
            assert!((slid / volume - 0.7).abs() < 1e-12, "{slid}");
        }
    }
}

/// A rod in the bore shares nothing with the ring, an eccentric rod what the closed formula for two
/// polygons says, and a ring hung into another (as links of a chain) nothing.
#[test]
fn rings_rods_and_links() {
    let sides = 48;
    let ring = made(
        HollowCylinder {
            aspect: 0.5,
            bore: 0.6,
            sides,
        },
        1.0,
    );
    let thin = made(
        HollowCylinder {
            aspect: 1.0,
            bore: 0.8,
            sides,
        },
        0.55,
    );
    let mut random = Random(33);
    // Area of a regular polygon of given circumscribed diameter.
    let area = |d: f64| {
        let n = f64::from(sides);
        0.125 * n * d * d * (2.0 * std::f64::consts::PI / n).sin()
    };
    for _ in 0..20 {
        let pose = random.pose(2.0);
        let lift = pose * Pose::translation(0.0, 0.0, random.uniform(-0.2, 0.2));
        assert_eq!(shared(&ring, &pose, &thin, &lift), 0.0);
        // Two concentric rings whose walls overlap: outer 1.0/0.6 and outer 0.8/0.4 share 0.6 to 0.8.
        let inner = made(
            HollowCylinder {
                aspect: 0.5,
                bore: 0.5,
                sides,
            },
            0.8,
        );
        let dz = random.uniform(0.0, 0.3);
        let found = shared(
            &ring,
            &pose,
            &inner,
            &(pose * Pose::translation(0.0, 0.0, dz)),
        );
        // Heights 0.5 and 0.4, centred.
        let height = (0.25_f64.min(dz + 0.2) - (-0.25_f64).max(dz - 0.2)).max(0.0);
        let expected = (area(0.8) - area(0.6)) * height;
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        // Links: the second ring stands upright in the first one's bore, around its wall.
        let upright = Pose::from_parts(
            Translation3::new(0.4, 0.0, 0.0),
            Rotation::from_scaled_axis(Vector3::x() * std::f64::consts::FRAC_PI_2),
        );
        let link = made(
            HollowCylinder {
                aspect: 0.1,
                bore: 0.8,
                sides,
            },
            1.0,
        );
        assert_eq!(shared(&link, &pose, &link, &(pose * upright)), 0.0);
    }
}

#[test]
fn dolosse_and_pellets_against_monte_carlo() {
    let mut random = Random(34);
    let dolos = made(Dolos::default(), 2.0);
    let pellet = made(
        Pellet {
            holes: 4,
            sides: 24,
            ..Pellet::default()
        },
        1.5,
    );
    let scan = scan(1.6);
    let samples = 6000;
    for (a, b) in [
        (&dolos, &dolos),
        (&dolos, &pellet),
        (&pellet, &pellet),
        (&scan, &dolos),
    ] {
        for _ in 0..3 {
            let (p, q) = (random.pose(0.3), random.pose(0.3));
            let exact = shared(a, &p, b, &q);
            let half = b.bounding_radius();
            let low = (q * b.mass_properties().centroid).map(|x| x - half);
            let high = low.map(|x| x + 2.0 * half);
            let mut hits = 0;
            for _ in 0..samples {
                let x = random.point(&low, &high);
                hits += u32::from(winding(b, &q, &x) > 0.5 && winding(a, &p, &x) > 0.5);
            }
            let share = exact / (2.0 * half).powi(3);
            let counted = f64::from(hits) / f64::from(samples);
            let scatter = (share * (1.0 - share) / f64::from(samples)).sqrt();
            assert!(
                share > 1e-3 && (share - counted).abs() < 4.5 * scatter,
                "{share} {counted}"
            );
        }
    }
}

/// Faces within a hair of parallel to the axes: slopes of 1e3 to 1e17 of one triangle over another, and
/// over the circle of a cylinder.
#[test]
fn nearly_upright_faces() {
    let (whole, parts) = comb();
    let mut random = Random(41);
    for power in 3..18 {
        for _ in 0..8 {
            let tilt = Vector3::new(1.0, -0.7, 0.4) * 10_f64.powi(-power);
            let quarter = random.uniform(0.0, 4.0).floor() * std::f64::consts::FRAC_PI_2;
            let turn = |size: Vector3| {
                Rotation::from_scaled_axis(size)
                    * Rotation::from_scaled_axis(Vector3::z() * quarter)
            };
            let place = random.point(&Point3::from([-0.5; 3]), &Point3::from([0.5; 3]));
            let p = Pose::from_parts(Translation3::from(place.coords), turn(tilt));
            let q = Pose::from_parts(Translation3::identity(), turn(-tilt));
            let sum: f64 = parts
                .iter()
                .flat_map(|a| parts.iter().map(move |b| (a, b)))
                .map(|(a, b)| shared(a, &p, b, &q))
                .sum();
            let found = shared(&whole, &p, &whole, &q);
            assert!(
                sum > 0.1 && (found - sum).abs() < 1e-13,
                "1e-{power}: {found} {sum}"
            );
            let drum = |z_min, z_max| Region::Cylinder {
                centre: [1.2, 1.1],
                radius: 1.3,
                z_min,
                z_max,
            };
            // Two drums on one another contain what the high one does, and the parts sum to the whole.
            let inside =
                |shape: &Polyhedron, low, high| volume_inside(shape, &p, &drum(low, high)).unwrap();
            let both = inside(&whole, -0.9, 0.4) + inside(&whole, 0.4, 2.0);
            let sum: f64 = parts.iter().map(|part| inside(part, -0.9, 2.0)).sum();
            assert!((both - sum).abs() < 1e-13, "1e-{power}: {both} {sum}");
        }
    }
}

/// Far from the origin and at other scales the same share of the volume, to what coordinates resolve.
#[test]
fn far_tiny_and_huge() {
    let mut random = Random(35);
    let dolos = made(Dolos::default(), 1.0);
    let (p, q) = (random.pose(0.1), random.pose(0.1));
    let reference = shared(&dolos, &p, &dolos, &q);
    assert!(reference > 0.01 * dolos.mass_properties().volume);
    for scale in [1e-9, 1e6] {
        let shape = dolos.scaled(scale).unwrap();
        let [p, q] = [p, q].map(|pose| {
            let place = Translation3::from(pose.translation.vector * scale);
            Pose::from_parts(place, pose.rotation)
        });
        let found = shared(&shape, &p, &shape, &q) / scale.powi(3);
        assert!((found / reference - 1.0).abs() < 1e-12, "{scale}: {found}");
    }
    let far = Pose::translation(1e5, -1e5, 1e5);
    let found = shared(&dolos, &(far * p), &dolos, &(far * q));
    assert!((found / reference - 1.0).abs() < 1e-8, "{found}");
}

/// A region cut into parts: overlaps inside the parts sum to those of the whole, for boxes and drums.
#[test]
fn overlaps_in_parts_of_a_region_sum_to_the_whole() {
    let mut random = Random(36);
    let shapes = [
        made(Dolos::default(), 1.0),
        made(Pellet::default(), 0.8),
        scan(0.9),
    ];
    let bodies = turned_lattice(&mut random, 3, 4, 0.55);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let around = |low: [f64; 3], high: [f64; 3]| Region::Box {
        min: Point3::from(low),
        max: Point3::from(high),
    };
    let all = exact_density(&pack, &around([-2.0; 3], [4.0; 3])).unwrap();
    let pairs = pair_overlaps(&pack);
    assert!(pairs.pairs.len() > 100 && all.overlap_volume > 0.02 * all.body_volume);
    assert!((all.overlap_volume / pairs.total() - 1.0).abs() < 1e-12);
    let (mut overlap, mut volume) = (0.0, 0.0);
    for i in 0..8 {
        let side = |k: usize| {
            if i >> k & 1 == 0 {
                (-2.0, 0.7)
            } else {
                (0.7, 4.0)
            }
        };
        let ends = [0, 1, 2].map(side);
        let part = exact_density(&pack, &around(ends.map(|e| e.0), ends.map(|e| e.1))).unwrap();
        overlap += part.overlap_volume;
        volume += part.body_volume;
    }
    assert!(
        (overlap / all.overlap_volume - 1.0).abs() < 1e-11,
        "{overlap} {all:?}"
    );
    assert!((volume / all.body_volume - 1.0).abs() < 1e-12);
    let drum = |z_min, z_max| Region::Cylinder {
        centre: [0.8, 0.8],
        radius: 0.9,
        z_min,
        z_max,
    };
    let [low, high, both] = [(-1.0, 0.6), (0.6, 3.0), (-1.0, 3.0)]
        .map(|(a, b)| exact_density(&pack, &drum(a, b)).unwrap());
    let sum = low.overlap_volume + high.overlap_volume;
    assert!(sum > 0.0 && (sum / both.overlap_volume - 1.0).abs() < 1e-11);
}

/// Two L-blocks of three cubes each, one turned by half a turn, fill a block of 2 x 3 x 1; `push`
/// moves the second into the first.
fn l_blocks(cells: i32, push: f64) -> (Polyhedron, Vec<PosedBody>) {
    let shape = prism(&[[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]]);
    let half_turn = Rotation::from_scaled_axis(Vector3::z() * std::f64::consts::PI);
    let mut bodies = Vec::new();
    for i in 0..cells * cells * cells {
        let cell = [i % cells, i / cells % cells, i / (cells * cells)].map(f64::from);
        let place = Pose::translation(2.0 * cell[0], 3.0 * cell[1], cell[2]);
        bodies.push(body(0, place));
        let turned = Pose::from_parts(Translation3::new(2.0, 3.0 - push, 0.0), half_turn);
        bodies.push(body(0, place * turned));
    }
    (shape, bodies)
}

/// Interlocked L-blocks fill space: density 1, no overlap, by the exact way in any orientation and by
/// the grid; pushed into one another they overlap by what two faces sweep.
#[test]
fn l_blocks_fill_space() {
    let cells = 4;
    let mut random = Random(37);
    let inner = |motion: &Pose| {
        let centre = motion * Point3::new(4.0, 6.0, 2.0);
        Region::Box {
            min: centre.map(|x| x - 1.1),
            max: centre.map(|x| x + 1.1),
        }
    };
    for _ in 0..10 {
        let motion = random.pose(5.0);
        let (shape, straight) = l_blocks(cells, 0.0);
        let bodies = moved(&straight, &motion);
        let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
        let total = pair_overlaps(&pack).total();
        assert!(total < 1e-11, "{total}");
        let region = inner(&motion);
        let exact = exact_density(&pack, &region).unwrap();
        assert!((exact.density - 1.0).abs() < 1e-12, "{exact:?}");
        // A centre on a face that two blocks share may fall to neither or both by round-off only.
        let grid = grid_density(&pack, &region, 0.07).unwrap();
        assert!(grid.density > 1.0 - 1e-4, "{grid:?}");
    }
    for push in [1e-6, 0.01, 0.2] {
        let motion = random.pose(5.0);
        let (shape, straight) = l_blocks(cells, push);
        let bodies = moved(&straight, &motion);
        let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
        let found = pair_overlaps(&pack);
        let expected = 2.0 * push * 64.0;
        let deep = found.pairs.iter().filter(|p| p.volume > 0.5 * push).count();
        assert!(
            (found.total() - expected).abs() < 1e-11,
            "{push}: {}",
            found.total()
        );
        assert_eq!(deep, 64);
    }
}

/// Grid against exact for a pack of dolosse, pellets and scans, and a scan's top seen from above
/// against the highest of all its triangles' tops.
#[test]
fn grid_agrees_with_exact() {
    let mut random = Random(38);
    let shapes = [
        made(Dolos::default(), 1.0),
        made(Pellet::default(), 0.8),
        scan(0.9),
    ];
    let mut squares = 0.0;
    for _ in 0..10 {
        let bodies = turned_lattice(&mut random, 3, 4, 0.9);
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let region = Region::Box {
            min: Point3::from([0.1; 3]),
            max: Point3::from([2.6; 3]),
        };
        let options = DensityOptions {
            grid_spacing_over_d: 0.07,
            ..DensityOptions::default()
        };
        let result = packing_density(&pack, &region, &options).unwrap();
        let deviation = (result.grid.unwrap() - result.exact) / result.grid_error.unwrap();
        assert!(deviation.abs() < 4.0, "{result:?}");
        squares += deviation * deviation;
    }
    assert!(
        (0.3..1.5).contains(&(squares / 10.0_f64).sqrt()),
        "{squares}"
    );
}

/// Columns over one body: their highest points by a ray against every triangle.
#[test]
fn top_of_a_scan_against_all_triangles() {
    let shape = scan(1.0);
    let mut random = Random(39);
    let pose = random.pose(0.2);
    let bodies = [body(0, pose)];
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let floor = Region::Box {
        min: Point3::new(-0.6, -0.6, -1.0),
        max: Point3::new(0.6, 0.6, 0.0),
    };
    let top = top_plane(&pack, &floor, 0.04).unwrap();
    let mut heights = Vec::new();
    for (i, j) in (0..30).flat_map(|i| (0..30).map(move |j| (i, j))) {
        let at = [i, j].map(|k| -0.6 + 0.04 * (f64::from(k) + 0.5));
        let mut highest = f64::NEG_INFINITY;
        for t in shape.triangles() {
            let [a, b, c] = t.map(|v| pose * shape.vertices()[v as usize]);
            let (p, q) = (b - a, c - a);
            let det = p.x * q.y - p.y * q.x;
            let (x, y) = (at[0] - a.x, at[1] - a.y);
            let (s, t) = ((x * q.y - y * q.x) / det, (p.x * y - p.y * x) / det);
            if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
                highest = highest.max(a.z + s * p.z + t * q.z);
            }
        }
        heights.extend(highest.is_finite().then_some(highest));
    }
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    assert_eq!(top.columns, heights.len());
    assert!((top.mean - mean).abs() < 1e-12);
}

/// The volume of a scan inside boxes that cut it, by signed prisms with a box and by clipping.
#[test]
fn two_ways_to_cut_a_scan_agree() {
    let shape = scan(1.0);
    let fine = made(Sphere { level: 2 }, 1.0);
    let (comb, parts) = comb();
    let mut random = Random(40);
    for _ in 0..20 {
        let (p, q) = (
            random.pose(0.3),
            random.pose(0.3) * Pose::translation(-2.5, -1.5, -0.5),
        );
        // Comb and scan: neither is convex; its parts are, and cut the scan by planes.
        let sum: f64 = parts.iter().map(|part| shared(&shape, &p, part, &q)).sum();
        let found = shared(&shape, &p, &comb, &q);
        assert!((found - sum).abs() < 1e-13, "{found} {sum}");
        // A box as a region and as a body; a sphere of many faces is handled by prisms.
        let cube = Region::Box {
            min: Point3::from([-0.5; 3]),
            max: Point3::from([0.5; 3]),
        };
        let found = shared(&crate::common::cube(1.0), &Pose::identity(), &fine, &p);
        assert!((found - volume_inside(&fine, &p, &cube).unwrap()).abs() < 1e-13);
    }
}

/// Two bodies that are not convex share in a sphere what their convex parts share there, however much of the
/// overlap the sphere cuts.
#[test]
fn overlaps_in_spheres_are_the_sum_over_convex_parts() {
    let (whole, parts) = comb();
    let mut random = Random(38);
    let mut cut = 0;
    for _ in 0..60 {
        let centred = Pose::translation(-2.5, -1.5, -0.5);
        let poses = [random.pose(1.0) * centred, random.pose(1.0) * centred];
        let region = Region::Sphere {
            centre: (random.pose(1.5) * Point3::origin()),
            radius: 0.9,
        };
        let body = |shape: usize, pose: &Pose| PosedBody {
            shape: shape as u32,
            pose: *pose,
        };
        let inside = |shapes: &[Polyhedron], bodies: &[PosedBody]| {
            let pack = Pack::new(shapes, bodies).unwrap();
            exact_density(&pack, &region).unwrap().overlap_volume
        };
        let found = inside(
            std::slice::from_ref(&whole),
            &poses.map(|pose| body(0, &pose)),
        );
        let sum: f64 = (0..parts.len())
            .flat_map(|a| (0..parts.len()).map(move |b| (a, b)))
            .map(|(a, b)| inside(&parts, &[body(a, &poses[0]), body(b, &poses[1])]))
            .sum();
        assert!((found - sum).abs() < 1e-11, "{found} {sum}");
        let all = shared(&whole, &poses[0], &whole, &poses[1]);
        cut += u32::from(sum > 1e-6 && sum < all - 1e-6);
    }
    assert!(cut > 20, "{cut}");
}
