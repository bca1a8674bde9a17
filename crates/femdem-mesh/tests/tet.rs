//! Tetrahedral meshes of closed surfaces: shapes, volumes, distances, and what is refused.

#![expect(clippy::expect_used, clippy::unwrap_used, reason = "helpers of tests")]

use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::{MeshOptions, Method, mesh};
use femdem_mesh::{MeshError, Point3, Polyhedron, Pose, Rotation, Vector3};
use std::f64::consts::TAU;

/// The union of unit cubes at integer places, scaled by `size` along each axis.
fn cubes(places: &[[i32; 3]], size: f64) -> Polyhedron {
    let mut vertices: Vec<[i32; 3]> = Vec::new();
    let mut faces = Vec::new();
    for place in places {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = *place;
                beside[axis] += 2 * side - 1;
                if places.contains(&beside) {
                    continue;
                }
                let mut loop_ = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| {
                    let mut corner = *place;
                    corner[axis] += side;
                    corner[(axis + 1) % 3] += u;
                    corner[(axis + 2) % 3] += v;
                    corner
                });
                if side == 0 {
                    loop_.reverse();
                }
                let face = loop_.map(|corner| {
                    let known = vertices.iter().position(|v| *v == corner);
                    known.unwrap_or_else(|| {
                        vertices.push(corner);
                        vertices.len() - 1
                    }) as u32
                });
                faces.push(face.to_vec());
            }
        }
    }
    let vertices = vertices
        .iter()
        .map(|v| Point3::from(v.map(f64::from)) * size)
        .collect();
    Polyhedron::new(vertices, faces).expect("a valid surface")
}

/// A closed grid of quads, `m` by `n` and periodic both ways, as triangles.
fn wrapped(m: u32, n: u32, point: impl Fn(f64, f64) -> Point3) -> Polyhedron {
    let vertices = (0..m * n)
        .map(|k| point(TAU * f64::from(k / n) / f64::from(m), f64::from(k % n)))
        .collect();
    let id = |i: u32, j: u32| i % m * n + j % n;
    let mut faces = Vec::new();
    for i in 0..m {
        for j in 0..n {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            faces.extend([vec![a, b, c], vec![a, c, d]]);
        }
    }
    Polyhedron::new(vertices, faces).expect("a valid surface")
}

fn torus(m: u32, n: u32, radius: f64, tube: f64) -> Polyhedron {
    wrapped(m, n, |u, j| {
        let v = TAU * j / f64::from(n);
        let r = radius + tube * v.cos();
        Point3::new(r * u.cos(), r * u.sin(), tube * v.sin())
    })
}

fn hollow_cylinder(m: u32, outer: f64, inner: f64, height: f64) -> Polyhedron {
    wrapped(m, 4, |u, j| {
        let [r, z] = [[outer, 0.0], [outer, height], [inner, height], [inner, 0.0]][j as usize];
        Point3::new(r * u.cos(), r * u.sin(), z)
    })
}

/// Two crossed bars joined by a third: the skeleton of a dolos. Not star-shaped.
fn block_dolos() -> Polyhedron {
    let mut places: Vec<[i32; 3]> = (0..5).map(|i| [0, 0, i]).collect();
    places.extend([[-2, 0, 0], [-1, 0, 0], [1, 0, 0], [2, 0, 0]]);
    places.extend([[0, -2, 4], [0, -1, 4], [0, 1, 4], [0, 2, 4]]);
    cubes(&places, 0.1)
}

fn l_block() -> Polyhedron {
    cubes(
        &[[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [0, 2, 0]],
        0.1,
    )
}

fn u_block() -> Polyhedron {
    let mut places = Vec::new();
    for i in 0..3 {
        places.extend([[i, 0, 0], [0, i + 1, 0], [2, i + 1, 0]]);
    }
    cubes(&places, 0.1)
}

fn turned(body: &Polyhedron, i: u32) -> Polyhedron {
    let [a, b, c] = [0.37, 1.13, 2.09].map(|x| x * f64::from(i));
    body.transformed(&Pose::from_parts(
        Translation3::from(Vector3::new(0.1, -0.2, 0.3) * f64::from(i)),
        Rotation::from_euler_angles(a, b, c),
    ))
    .unwrap()
}

struct Case {
    name: &'static str,
    body: Polyhedron,
    length: f64,
    /// Allowed errors: of the volume, and distances as parts of the length.
    volume: f64,
    distance: f64,
    edge_distance: f64,
    /// Least dihedral angle in degrees.
    dihedral: f64,
}

fn cases() -> Vec<Case> {
    let case = |name, body, length, [volume, distance, edge_distance, dihedral]: [f64; 4]| Case {
        name,
        body,
        length,
        volume,
        distance,
        edge_distance,
        dihedral,
    };
    // Blocks whose edges are whole numbers of cells are represented exactly, the others except at corners.
    vec![
        case("L", l_block(), 0.05, [1e-12, 1e-9, 1e-9, 44.9]),
        case("U", u_block(), 0.05, [1e-12, 1e-9, 1e-9, 44.9]),
        case("U, uneven", u_block(), 0.03, [1e-12, 1e-9, 1e-9, 12.0]),
        case(
            "dolos of blocks",
            block_dolos(),
            0.05,
            [1e-12, 1e-9, 1e-9, 44.9],
        ),
        // Curved edges are cut short by chords.
        case(
            "hollow cylinder",
            hollow_cylinder(32, 0.1, 0.05, 0.2),
            0.025,
            [2e-3, 0.08, 0.05, 15.0],
        ),
        case(
            "torus",
            torus(32, 16, 0.1, 0.04),
            0.02,
            [0.03, 0.16, 0.0, 15.0],
        ),
        case(
            "fine torus",
            torus(32, 16, 0.1, 0.04),
            0.01,
            [7e-3, 0.16, 0.0, 15.0],
        ),
    ]
}

#[test]
fn general_bodies_in_any_orientation() {
    for case in cases() {
        for i in 0..4 {
            let body = turned(&case.body, i);
            let options = MeshOptions {
                edge_length: Some(case.length),
                ..MeshOptions::default()
            };
            let (mesh, report) = mesh(&body, &options).unwrap();
            let context = format!("{} turned {i}: {report:?}", case.name);
            assert!(mesh.every_tet_has_interior_point(), "{context}");
            let skin = mesh.surface().unwrap();
            assert_eq!(
                skin.euler_characteristic(),
                body.euler_characteristic(),
                "{context}"
            );
            assert_eq!(report.method, Method::Stuffing, "{context}");
            assert_eq!(report.lattice_length, Some(case.length), "{context}");
            assert!(report.volume_error.abs() <= case.volume, "{context}");
            assert!(report.distance <= case.distance * case.length, "{context}");
            assert!(
                report.edge_distance <= case.edge_distance * case.length,
                "{context}"
            );
            let dihedral = report.quality.min_dihedral.to_degrees();
            assert!(dihedral > case.dihedral, "{context}");
            assert!(
                report.quality.max_dihedral.to_degrees() < 160.0,
                "{context}"
            );
            assert!(report.quality.min_radius_ratio > 0.3, "{context}");
            assert!(
                report.quality.smallest_height > 0.08 * case.length,
                "{context}"
            );
            // An independent volume: that of the skin as a surface.
            let relative = skin.mass_properties().volume / body.mass_properties().volume - 1.0;
            assert!((relative - report.volume_error).abs() < 1e-12, "{context}");
        }
    }
}

#[test]
fn curved_surfaces_are_approached() {
    // Volumes converge with the square of the length, as chords do.
    let body = torus(96, 48, 0.1, 0.04);
    let error = |length: f64| {
        let options = MeshOptions {
            edge_length: Some(length),
            ..MeshOptions::default()
        };
        mesh(&body, &options).unwrap().1.volume_error
    };
    let (coarse, fine) = (error(0.02), error(0.01));
    assert!(
        coarse < 0.0 && fine < 0.0 && coarse / fine > 3.0,
        "{coarse} {fine}"
    );
}

#[test]
fn thin_parts_make_the_lattice_finer_or_are_refused() {
    // A tube with walls of 10 mm, meshed with a length of 30 mm.
    let tube = hollow_cylinder(32, 0.1, 0.09, 0.06);
    let options = MeshOptions {
        edge_length: Some(0.03),
        ..MeshOptions::default()
    };
    let (fine, report) = mesh(&tube, &options).unwrap();
    assert!(report.lattice_length.unwrap() < 0.02);
    assert_eq!(fine.surface().unwrap().euler_characteristic(), 0);
    assert!(report.volume_error.abs() < 0.05);

    let strict = MeshOptions {
        refinements: 0,
        ..options
    };
    let error = mesh(&tube, &strict).unwrap_err();
    assert!(matches!(
        error,
        MeshError::MeshingFailed {
            asked: 0.03,
            tried: 0.03,
            ..
        }
    ));
    assert!(error.to_string().contains("thinner"), "{error}");
}

#[test]
fn the_quality_floor_is_enforced() {
    let options = MeshOptions {
        edge_length: Some(0.03),
        min_dihedral: 0.6,
        refinements: 0,
        ..MeshOptions::default()
    };
    let Err(MeshError::MeshingFailed { problem, .. }) = mesh(&u_block(), &options) else {
        panic!("34 degrees cannot be had with cells that do not fit");
    };
    assert!(matches!(*problem, MeshError::BadShape { .. }), "{problem}");
}

#[test]
fn the_route_follows_the_body() {
    let coarse = MeshOptions::default();
    let route = |body: &Polyhedron, options: &MeshOptions| mesh(body, options).unwrap().1.method;
    let cube = cubes(&[[0, 0, 0]], 1.0);
    assert_eq!(route(&cube, &coarse), Method::CentroidFan);
    assert_eq!(route(&l_block(), &coarse), Method::StarFan);
    assert_eq!(route(&block_dolos(), &coarse), Method::Stuffing);
    let stuffing = MeshOptions {
        method: Some(Method::Stuffing),
        edge_length: Some(0.25),
        ..coarse
    };
    assert_eq!(route(&cube, &stuffing), Method::Stuffing);
    let star = MeshOptions {
        method: Some(Method::StarFan),
        ..coarse
    };
    let Err(MeshError::NotStarShaped { faces, radius }) = mesh(&u_block(), &star) else {
        panic!("a U is not star-shaped");
    };
    assert!(faces.len() == 4 && radius <= 0.0, "{faces:?} {radius}");
}

#[test]
fn fans_are_refined_to_the_length() {
    let cube = cubes(&[[0, 0, 0]], 1.0);
    let options = MeshOptions {
        edge_length: Some(0.2),
        ..MeshOptions::default()
    };
    let (_, report) = mesh(&cube, &options).unwrap();
    assert_eq!(report.method, Method::CentroidFan);
    assert!(report.longest_edge <= 0.2 * 2_f64.sqrt() && report.longest_edge > 0.1);
    assert!(report.volume_error.abs() < 1e-12 && report.distance < 1e-12);
}

#[test]
fn bad_options_are_named() {
    for (length, dihedral, volume) in [
        (0.0, 0.1, 0.1),
        (f64::NAN, 0.1, 0.1),
        (1.0, 1.0, 0.1),
        (1.0, 0.1, -0.1),
        (1e-6, 0.1, 0.1),
    ] {
        let options = MeshOptions {
            edge_length: Some(length),
            min_dihedral: dihedral,
            max_volume_error: volume,
            ..MeshOptions::default()
        };
        let error = mesh(&u_block(), &options).unwrap_err();
        assert!(matches!(error, MeshError::OutOfRange { .. }), "{error}");
    }
}

#[test]
fn same_bits_in_every_run_and_same_shapes_at_every_scale() {
    let body = block_dolos();
    let make = |scale: f64| {
        let options = MeshOptions {
            edge_length: Some(0.04 * scale),
            ..MeshOptions::default()
        };
        mesh(&body.scaled(scale).unwrap(), &options).unwrap()
    };
    let (first, report) = make(1.0);
    assert_eq!(make(1.0).0, first);
    // Powers of two change no digit.
    for scale in [2_f64.powi(-60), 2_f64.powi(60)] {
        let (other, found) = make(scale);
        assert_eq!(other.tets(), first.tets());
        assert_eq!(found.volume_error, report.volume_error);
        assert_eq!(found.quality.min_dihedral, report.quality.min_dihedral);
    }
}

/// A ball of 2,000 triangles whose points are off by up to 15 % of the radius, as scans are.
fn rough_ball() -> Polyhedron {
    let (m, n) = (40, 26);
    // Noise without a generator: the fractional parts of large sines.
    let radius =
        |i: u32| 0.1 * (1.0 + 0.15 * ((f64::from(i) * 12.9898).sin() * 43_758.545).fract());
    let mut vertices = vec![Point3::new(0.0, 0.0, radius(0))];
    for k in 0..m * (n - 1) {
        let (polar, around) = (
            f64::from(k / m + 1) / f64::from(n),
            f64::from(k % m) / f64::from(m),
        );
        let (s, c) = (0.5 * TAU * polar).sin_cos();
        let (y, x) = (TAU * around).sin_cos();
        vertices.push(Point3::new(s * x, s * y, c) * radius(k + 1));
    }
    vertices.push(Point3::new(0.0, 0.0, -radius(9999)));
    let last = vertices.len() as u32 - 1;
    let id = |i: u32, j: u32| 1 + (j - 1) * m + i % m;
    let mut faces = Vec::new();
    for i in 0..m {
        faces.push(vec![0, id(i, 1), id(i + 1, 1)]);
        faces.push(vec![last, id(i + 1, n - 1), id(i, n - 1)]);
        for j in 1..n - 1 {
            faces.push(vec![id(i, j), id(i, j + 1), id(i + 1, j + 1)]);
            faces.push(vec![id(i, j), id(i + 1, j + 1), id(i + 1, j)]);
        }
    }
    Polyhedron::new(vertices, faces).expect("a valid surface")
}

#[test]
fn a_rough_scan_is_meshed() {
    let body = rough_ball();
    assert_eq!(body.face_count(), 2000);
    let options = MeshOptions {
        method: Some(Method::Stuffing),
        edge_length: Some(0.02),
        ..MeshOptions::default()
    };
    for i in 0..3 {
        let (mesh, report) = mesh(&turned(&body, i), &options).unwrap();
        assert_eq!(report.lattice_length, Some(0.02), "{report:?}");
        assert!(mesh.every_tet_has_interior_point());
        assert!(mesh.surface().unwrap().self_intersections(1).is_empty());
        assert!(report.volume_error.abs() < 0.05, "{report:?}");
        // Noise on the scale of the lattice is smoothed over, not followed: convex tips are cut.
        assert!(report.distance < 0.03, "{report:?}");
    }
}

#[test]
fn tips_edges_and_bores_of_catalogue_shapes_are_kept() {
    // Largest miss of the sharp edges, and error of the volume.
    for (text, length, edges, volume) in [
        ("P1", 0.1, 0.01, 0.01),
        ("dolos", 0.05, 0.01, 0.002),
        ("dolos", 0.1, 0.04, 0.02),
        ("tetrapod", 0.08, 0.02, 0.02),
        ("antifer", 0.1, 1e-6, 0.01),
        ("hollow_cylinder", 0.2, 0.015, 0.01),
        ("pellet", 0.08, 0.01, 0.03),
    ] {
        let body = text.parse::<Shape>().unwrap().polyhedron(1.0).unwrap();
        let options = MeshOptions {
            method: Some(Method::Stuffing),
            edge_length: Some(length),
            ..MeshOptions::default()
        };
        let (mesh, report) = mesh(&body, &options).unwrap();
        let context = format!("{text} {report:?}");
        assert!(
            report.edges_kept && report.lattice_length == Some(length),
            "{context}"
        );
        assert!(report.edge_distance < edges, "{context}");
        assert!(report.volume_error.abs() < volume, "{context}");
        assert!(mesh.every_tet_has_interior_point(), "{context}");
    }
}

/// A body that is long in one direction only does not need more nodes for that.
#[test]
fn slender_bodies_are_meshed() {
    let channel = |x: i32| [[x, 0, 0], [x, 1, 0], [x, 2, 0], [x, 0, 1], [x, 2, 1]];
    let body = cubes(&(0..80).flat_map(channel).collect::<Vec<_>>(), 1.0);
    let options = MeshOptions {
        edge_length: Some(0.35),
        ..MeshOptions::default()
    };
    for body in [body.clone(), turned(&body, 3)] {
        let (mesh, report) = mesh(&body, &options).unwrap();
        assert_eq!(report.method, Method::Stuffing);
        assert!(report.volume_error.abs() < 1e-6 && mesh.tets().len() < 300_000);
    }
}

/// A lattice that is too large stays so when it is made finer.
#[test]
fn refinements_without_end_end() {
    let options = MeshOptions {
        edge_length: Some(1e-9),
        refinements: u32::MAX,
        ..MeshOptions::default()
    };
    let refused = mesh(&u_block(), &options).unwrap_err();
    assert!(
        matches!(refused, MeshError::OutOfRange { value, .. } if value == 1e-9),
        "{refused}"
    );
}

/// Refining keeps the angles of a fan: a bad one is refused before it is refined to millions.
#[test]
fn fans_of_bad_shape_are_not_refined() {
    let plate = cubes(&[[0, 0, 0]], 1.0);
    let flat = plate
        .vertices()
        .iter()
        .map(|v| Point3::new(v.x, v.y, 1e-3 * v.z));
    let faces = plate.faces().map(<[u32]>::to_vec).collect();
    let plate = Polyhedron::new(flat.collect(), faces).unwrap();
    let options = MeshOptions {
        method: Some(Method::CentroidFan),
        edge_length: Some(0.01),
        ..MeshOptions::default()
    };
    let refused = mesh(&plate, &options).unwrap_err();
    assert!(matches!(refused, MeshError::BadShape { .. }), "{refused}");
}
