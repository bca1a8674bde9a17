use super::*;
use crate::element::Element;
use crate::material::NeoHookean;
use crate::model::{Boundary, Curve, MaterialRegion, Selection};
use femdem_mesh::nalgebra::{Rotation3, Unit};
use femdem_mesh::tet::{MeshOptions, mesh};
use femdem_mesh::{Matrix3, Point3, TetMesh, convex_hull};

fn model(mesh: &TetMesh, element: Element, poisson: f64) -> Arc<DeformableModel> {
    let material = NeoHookean::new(60e9, poisson).unwrap().into();
    let stone = MaterialRegion {
        material,
        density: 2650.0,
    };
    Arc::new(DeformableModel::new(mesh, element, vec![stone], None).unwrap())
}

fn body(mesh: &TetMesh, element: Element) -> FreeBody {
    FreeBody::new(model(mesh, element, 0.22)).unwrap()
}

fn block() -> TetMesh {
    TetMesh::block([3, 4, 5], &Vector3::new(0.03, 0.05, 0.04)).unwrap()
}

/// Nodal forces of tractions on the faces x = 0 and x = `length`.
fn pulled(model: &DeformableModel, length: f64, tractions: [Vector3; 2]) -> Vec<Vector3> {
    let mut boundary = Boundary::default();
    for (offset, traction) in [0.0, length].into_iter().zip(tractions) {
        let face = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        if traction != Vector3::zeros() {
            boundary
                .pull(model, &face, traction, Curve::Constant(1.0))
                .unwrap();
        }
    }
    let mut forces = vec![Vector3::zeros(); model.nodes().len()];
    boundary
        .add_forces(model, 0.0, model.nodes(), &mut forces)
        .unwrap();
    forces
}

/// Three loads that do not balance, on the faces of the block.
fn loads() -> [PatchLoad; 3] {
    let load = |point: [f64; 3], normal: Vector3, force: [f64; 3], moment: [f64; 3]| PatchLoad {
        point: point.into(),
        normal,
        area: 40e-6,
        force: force.into(),
        moment: moment.into(),
    };
    [
        load(
            [0.0, 0.02, 0.02],
            Vector3::x(),
            [50.0, 3.0, -8.0],
            [0.01, -0.02, 0.0],
        ),
        load(
            [0.03, 0.03, 0.015],
            -Vector3::x(),
            [-45.0, 5.0, 2.0],
            [0.0; 3],
        ),
        load(
            [0.01, 0.05, 0.03],
            -Vector3::y(),
            [1.0, -30.0, 2.0],
            [0.0, 0.03, 0.004],
        ),
    ]
}

fn worst(a: &[Matrix3], b: &[Matrix3]) -> f64 {
    let size = b.iter().map(Matrix3::norm).fold(0.0, f64::max);
    let apart = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    apart.fold(0.0, f64::max) / size
}

#[test]
fn uniform_tractions_give_uniform_stress() {
    let mesh = block();
    for element in [Element::T4, Element::T10] {
        let body = body(&mesh, element);
        let pressure = Vector3::new(-2e6, 0.0, 0.0);
        let forces = pulled(body.model(), 0.03, [-pressure, pressure]);
        let solved = body.solve(&forces).unwrap();
        let exact = Matrix3::from_diagonal(&pressure);
        let elements: Vec<Matrix3> = solved.elements().map(|s| s.cauchy).collect();
        assert!(worst(&elements, &vec![exact; elements.len()]) < 1e-9);
        assert!(worst(solved.corners(), &vec![exact; solved.corners().len()]) < 1e-9);
        assert!((solved.mean() - exact).norm() < 1e-3);
        // Hooke: the bar is shorter by p L / E.
        let moved = |end: Point3| {
            let node = mesh.points().iter().position(|p| (p - end).norm() < 1e-9);
            solved.displacements()[node.unwrap()].x
        };
        let shorter = moved(Point3::origin()) - moved(Point3::new(0.03, 0.0, 0.0));
        assert!((shorter - 2e6 * 0.03 / 60e9).abs() < 1e-15);
    }
}

/// A bar pulled at one end alone flies off, and its tension falls linearly to the free end.
#[test]
fn a_bar_pulled_at_one_end_is_balanced_by_its_inertia() {
    let mesh = block();
    let body = FreeBody::new(model(&mesh, Element::T10, 0.0)).unwrap();
    let traction = Vector3::new(3e6, 0.0, 0.0);
    let forces = pulled(body.model(), 0.03, [Vector3::zeros(), traction]);
    let solved = body.solve(&forces).unwrap();
    let exact = |x: &Point3| Matrix3::from_diagonal(&(traction * (x.x / 0.03)));
    let exact: Vec<Matrix3> = mesh.points().iter().map(exact).collect();
    assert!(worst(solved.corners(), &exact) < 1e-9);
}

#[test]
fn patches_keep_force_moment_and_first_moment() {
    for element in [Element::T4, Element::T10] {
        let body = body(&block(), element);
        for load in loads() {
            let mut forces = vec![Vector3::zeros(); body.model().nodes().len()];
            body.add_patch(&load, &mut forces).unwrap();
            let sum: Vector3 = forces.iter().sum();
            assert!((sum - load.force).norm() < 1e-9 * load.force.norm());
            let nodes = body.model().nodes().iter().zip(&forces);
            let first: Matrix3 = nodes
                .map(|(x, f)| f * (x - load.point.coords).transpose())
                .sum();
            let moment = Vector3::new(
                first[(2, 1)] - first[(1, 2)],
                first[(0, 2)] - first[(2, 0)],
                first[(1, 0)] - first[(0, 1)],
            );
            assert!((moment - load.moment).norm() < 1e-9 * load.force.norm() * 0.05);
            // Without a moment the tractions have no first moment at all: the mean stress is that of a point force.
            if load.moment == Vector3::zeros() {
                assert!(first.norm() < 1e-9 * load.force.norm() * 0.05);
            }
        }
    }
}

/// Discs beyond an edge, off the body, or at a corner, and points.
#[test]
fn patches_over_edges_and_beside_the_body_keep_force_and_moment() {
    let body = body(&block(), Element::T10);
    let [mut load, ..] = loads();
    for (point, area) in [
        ([0.0, 0.001, 0.02], 4e-4),
        ([0.0, 0.0, 0.0], 1e-4),
        ([-0.01, 0.02, 0.02], 1e-4),
        ([0.0, 0.02, 0.02], 0.0),
        ([0.0, 0.02, 0.02], 1.0),
    ] {
        (load.point, load.area) = (Point3::from(point), area);
        let mut forces = vec![Vector3::zeros(); body.model().nodes().len()];
        body.add_patch(&load, &mut forces).unwrap();
        let nodes = body.model().nodes().iter().zip(&forces);
        let moment: Vector3 = nodes.map(|(x, f)| (x - load.point.coords).cross(f)).sum();
        assert!(
            (forces.iter().sum::<Vector3>() - load.force).norm() < 1e-8 * 50.0,
            "{point:?}"
        );
        assert!(
            (moment - load.moment).norm() < 1e-8 * 50.0 * 0.05,
            "{point:?} {area}"
        );
    }
    // All points on the edge beside the disc: about that edge, along z, nothing can turn.
    (load.point, load.area) = (Point3::new(0.0, -0.01, 0.02), 1e-6);
    let mut forces = vec![Vector3::zeros(); body.model().nodes().len()];
    body.add_patch(&load, &mut forces).unwrap();
    assert!((forces.iter().sum::<Vector3>() - load.force).norm() < 1e-8 * 50.0);
    let moment = |about: Vector3| -> Vector3 {
        let nodes = body.model().nodes().iter().zip(&forces);
        nodes.map(|(x, f)| (x - about).cross(f)).sum()
    };
    let kept = (moment(load.point.coords) - load.moment).xy();
    assert!(kept.norm() < 1e-8 * 50.0 * 0.05, "{kept}");
    // Forces t in proportion to levers of root mean square r have sum |t| <= M/r, r = R/2 on the diameter of a disc of radius R;
    // shape functions on an edge have at most 5/4 for the sum of their sizes.
    let about_disc = moment(Vector3::new(0.0, 0.0, 0.02)).xy().norm();
    let allowed = 1.25 * (load.force.norm() + about_disc / (0.5 * load.radius()));
    let sizes: f64 = forces.iter().map(Vector3::norm).sum();
    assert!(sizes <= allowed, "{sizes} {allowed}");
}

/// All points of a disc beyond a corner act at the corner, where nothing can turn: the force alone is kept.
#[test]
fn a_disc_wholly_beyond_a_corner_keeps_the_force() {
    let axis = Unit::new_normalize(Vector3::new(1.0, -2.0, 0.5));
    let turn = Rotation3::from_axis_angle(&axis, 1.1);
    let mesh = block();
    let place = |p: &Point3| turn * p + Vector3::new(0.1 / 3.0, 2_f64.sqrt(), -0.7);
    let points = mesh.points().iter().map(place).collect();
    let turned = TetMesh::new(points, mesh.tets().to_vec()).unwrap();
    let out = turn * -Vector3::new(1.0, 1.1, 0.9).normalize();
    let corner = place(&Point3::origin());
    for element in [Element::T4, Element::T10] {
        let body = body(&turned, element);
        for gap in [1e-5, 1e-4, 1e-3] {
            let load = PatchLoad {
                point: corner + out * gap,
                normal: out,
                area: (0.1 * gap).powi(2),
                force: Vector3::new(0.6, 0.0, -0.8),
                moment: Vector3::zeros(),
            };
            let mut forces = vec![Vector3::zeros(); body.model().nodes().len()];
            body.add_patch(&load, &mut forces).unwrap();
            let apart = (forces.iter().sum::<Vector3>() - load.force).norm();
            assert!(apart < 1e-12, "{gap} {apart:e}");
            // All of the disc acts at the corner, but for that of the smallest gap, which is wider than the gap.
            let sizes: f64 = forces.iter().map(Vector3::norm).sum();
            let allowed = if gap < 1e-4 { 1e-2 } else { 1e-12 };
            assert!((sizes - 1.0).abs() < allowed, "{gap} {sizes}");
        }
    }
}

#[test]
fn any_loads_are_balanced_whichever_nodes_are_held() {
    let model = model(&block(), Element::T10, 0.22);
    let free = FreeBody::new(Arc::clone(&model)).unwrap();
    let one = free.solve_patches(&loads()).unwrap();
    assert!(one.residual() < 1e-9);
    let other = FreeBody::with_supports(model, [40, 77, 13]).unwrap();
    assert_ne!(free.held, other.held);
    let two = other.solve_patches(&loads()).unwrap();
    assert!(worst(two.corners(), one.corners()) < 1e-9);
    let size = one
        .displacements()
        .iter()
        .map(Vector3::norm)
        .fold(0.0, f64::max);
    for (u, v) in one.displacements().iter().zip(two.displacements()) {
        assert!((u - v).norm() < 1e-8 * size);
    }
}

#[test]
fn stresses_turn_with_body_and_loads() {
    let mesh = block();
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::new(1.0, -2.0, 0.5)), 1.1);
    let points = mesh.points().iter().map(|p| turn * p).collect();
    let turned = TetMesh::new(points, mesh.tets().to_vec()).unwrap();
    let turned_loads = loads().map(|load| PatchLoad {
        point: turn * load.point,
        normal: turn * load.normal,
        area: 0.0,
        force: turn * load.force,
        moment: turn * load.moment,
    });
    let upright = loads().map(|load| PatchLoad { area: 0.0, ..load });
    let before = body(&mesh, Element::T10).solve_patches(&upright).unwrap();
    let after = body(&turned, Element::T10)
        .solve_patches(&turned_loads)
        .unwrap();
    let back = |s: &Matrix3| turn.inverse().matrix() * s * turn.matrix();
    let back: Vec<Matrix3> = after.corners().iter().map(back).collect();
    // The points of the disc turn about its normal, as their first direction is that of an axis.
    let apart = worst(&back, before.corners());
    assert!(apart < 1e-3, "{apart}");
}

/// A ball of diameter 1 m from points on a spiral.
fn ball(edge: f64) -> TetMesh {
    let count = 400;
    let golden = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
    let point = |k: i32| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
        let (sin, cos) = (golden * f64::from(k)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Point3::new(r * cos, r * sin, z) * 0.5
    };
    let hull = convex_hull(&(0..count).map(point).collect::<Vec<_>>()).unwrap();
    let options = MeshOptions {
        edge_length: Some(edge),
        ..MeshOptions::default()
    };
    mesh(&hull, &options).unwrap().0
}

/// The tension in the middle of a ball between two point forces F is 21 F/(pi d² (7 + 5 nu)): the mean pressure
/// F/(2 pi R²), and 5 (7 + 2 nu)/(14 + 10 nu) times as much from the part of the load that goes with the second Legendre
/// polynomial, whose compression is twice its tension; higher ones leave the middle free.
#[test]
fn a_ball_between_two_point_forces_splits() {
    let body = body(&ball(0.11), Element::T10);
    let press = |z: f64| PatchLoad {
        point: Point3::new(0.0, 0.0, z),
        normal: Vector3::z(),
        area: std::f64::consts::PI * 0.02_f64.powi(2),
        force: Vector3::z() * -z.signum(),
        moment: Vector3::zeros(),
    };
    let loads = [press(0.5), press(-0.5)];
    let solved = body.solve_patches(&loads).unwrap();
    let nodes = body.model().mesh().points().iter().zip(solved.corners());
    let distance = |p: &Point3| p.coords.norm();
    let middle = nodes.min_by(|(p, _), (q, _)| distance(p).total_cmp(&distance(q)));
    let (middle, stress) = middle.unwrap();
    assert!(distance(middle) < 0.03);
    // The mesh is a little smaller than the ball.
    let squared = (6.0 * body.model().mesh().volume() / std::f64::consts::PI).powf(2.0 / 3.0);
    let nu = 0.22;
    let tension = 21.0 / (std::f64::consts::PI * (7.0 + 5.0 * nu)) / squared;
    let second = 5.0 * (7.0 + 2.0 * nu) / (14.0 + 10.0 * nu);
    let compression = -2.0 / std::f64::consts::PI * (1.0 + 2.0 * second) / squared;
    let across = 0.5 * (stress[(0, 0)] + stress[(1, 1)]);
    assert!((across / tension - 1.0).abs() < 0.03, "{across} {tension}");
    assert!(
        (stress[(2, 2)] / compression - 1.0).abs() < 0.03,
        "{stress}"
    );
    // Hiramatsu and Oka: the tension along the axis is about that in the middle, and the estimate is near.
    let peaks = body.peaks(&solved, &loads);
    assert!(
        (peaks.tension.unwrap() / across - 1.0).abs() < 0.1,
        "{peaks:?}"
    );
    let estimate = body.splitting_estimate(1.0) / peaks.tension.unwrap();
    assert!((0.98..1.3).contains(&estimate), "{estimate}");
}

#[test]
fn the_estimate_takes_the_smallest_width_and_tension_needs_room() {
    let body = body(&block(), Element::T4);
    assert!((body.inscribed_diameter() / 0.03 - 1.0).abs() < 1e-3);
    let estimate = body.splitting_estimate(50.0);
    assert!(
        (estimate / (0.9 * 50.0 / 9e-4) - 1.0).abs() < 3e-3,
        "{estimate}"
    );
    // Without a node away from contacts there is no tension there.
    let everywhere = body.model().mesh().points().iter().map(|point| PatchLoad {
        point: *point,
        ..loads()[0]
    });
    let solved = body.solve_patches(&[]).unwrap();
    let mut everywhere: Vec<_> = everywhere.collect();
    let peaks = body.peaks(&solved, &everywhere);
    assert_eq!((peaks.tension, peaks.tension_anywhere), (None, 0.0));
    // Contacts of hardly any force take no room.
    for load in &mut everywhere[1..] {
        load.force *= 1e-7;
    }
    assert_eq!(body.peaks(&solved, &everywhere).tension, Some(0.0));
}

#[test]
fn what_cannot_be_solved_is_refused_by_name() {
    let mesh = block();
    let fbar = FreeBody::new(model(&mesh, Element::T10Fbar, 0.22)).unwrap_err();
    assert!(fbar.to_string().contains("T4 or of T10"), "{fbar}");
    let body = body(&mesh, Element::T4);
    let short = body.solve(&[Vector3::zeros()]).unwrap_err().to_string();
    assert!(short.contains("number of nodal forces = 1"), "{short}");
    let [mut load, ..] = loads();
    load.normal = Vector3::zeros();
    let flat = body.solve_patches(&[load]).unwrap_err().to_string();
    assert!(flat.contains("length of a load's normal"), "{flat}");
    // No load is no error.
    assert_eq!(body.solve_patches(&[]).unwrap().mean().norm(), 0.0);
}
