//! The kernel of exact spheres: its forces against differences of its energy, its numbers against those of ever finer
//! polyhedra.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Stream, solids, turned};
use femdem_contact::kernel::{CavityKernel, Scratch};
use femdem_contact::{
    ConvexShape, Frame, Overlap, PairKernel, Sphere, SphereKernel, Wall, WallPlane,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use femdem_mesh::shapes;

fn kernel() -> SphereKernel {
    SphereKernel::new(1.0).unwrap()
}

fn energy(found: Option<Overlap>) -> f64 {
    found.map_or(0.0, |o| o.energy)
}

/// The step of differences, m, and what rounding makes of a slope of the energy: it rounds as the ball's volume does.
fn step(here: &Overlap, radius: f64) -> (f64, f64) {
    let depth = here.penetration();
    let depth = if depth > 0.0 { depth } else { radius };
    let step = 5e-4 * depth.min(0.05 * radius);
    (step, 4.0 * f64::EPSILON * radius.powi(3) / step)
}

/// Checks the force on B, of a radius, at `centre` against central differences of the energy, and the stiffness against
/// those of the force. Returns whether the stiffness is minus the trace of the Hessian, which it exceeds where a part
/// of it is limited to 0.
fn check_gradient(
    evaluate: impl Fn(&Vector3<f64>) -> Option<Overlap>,
    centre: Vector3<f64>,
    radius: f64,
) -> bool {
    let here = evaluate(&centre).unwrap();
    let scale = here.force.norm();
    let (step, rounding) = step(&here, radius);
    let mut trace = 0.0;
    for k in 0..3 {
        let mut e = Vector3::zeros();
        e[k] = step;
        let [up, down] = [evaluate(&(centre + e)), evaluate(&(centre - e))];
        let force = |o: &Option<Overlap>| o.as_ref().map_or(0.0, |o| o.force[k]);
        trace += (force(&down) - force(&up)) / (2.0 * step);
        let slope = (energy(up) - energy(down)) / (2.0 * step);
        assert!(
            (here.force[k] + slope).abs() < 1e-6 * scale + rounding,
            "{} for {} along {k} at {centre:?}",
            here.force[k],
            -slope
        );
    }
    let k = here.foundation.stiffness;
    let worst = 1e-5 * k + rounding;
    let text = format!("stiffness {k}, trace {trace} at {centre:?}");
    assert!(trace <= k + worst, "{text}");
    assert!((here.normal - here.force.normalize()).norm() < 1e-12);
    // Nothing turns the sphere about its centre.
    assert!(here.torque_b().norm() < 1e-12 * here.force.norm());
    (trace - k).abs() < worst
}

/// Of all relative sizes and depths: a slight overlap, one centre in the other, one ball in the other.
#[test]
fn spheres_have_the_gradient_of_their_energy() {
    let mut stream = Stream(3);
    for (a, b) in [(1.0, 1.0), (1.0, 0.2), (0.3, 1.0)] {
        let (a, b) = (Sphere::new(a).unwrap(), Sphere::new(b).unwrap());
        let (sum, less) = (a.radius() + b.radius(), (a.radius() - b.radius()).abs());
        let least = a.radius().min(b.radius());
        for d in [
            0.99 * sum,
            sum - 0.4 * least,
            less + 0.3 * least,
            0.7 * less,
            0.1 * less,
        ] {
            if d < 0.05 {
                continue;
            }
            let direction = stream.vector().normalize();
            let exact = d * d > a.radius().powi(2) + b.radius().powi(2);
            let evaluate = |x: &Vector3<f64>| kernel().evaluate(&a, &b, x);
            assert!(
                check_gradient(evaluate, direction * d, 1.0) || !exact,
                "at {d}"
            );
            // Swapped, all is the opposite.
            let one = kernel().evaluate(&a, &b, &(direction * d)).unwrap();
            let two = kernel().evaluate(&b, &a, &(direction * -d)).unwrap();
            assert!((one.force + two.force).norm() < 1e-14 * one.force.norm());
            assert!((one.arm_a - two.arm_b).norm() < 1e-12);
            for (x, y) in [(one.energy, two.energy), (one.volume, two.volume)] {
                assert!((x - y).abs() < 1e-12 * x, "{x} {y} at {d}");
            }
        }
    }
    let one = Sphere::new(1.0).unwrap();
    assert!(
        kernel()
            .evaluate(&one, &one, &Vector3::x().scale(2.0))
            .is_none()
    );
    assert!(kernel().evaluate(&one, &one, &Vector3::zeros()).is_none());
}

fn corner(normals: &[Vector3<f64>]) -> Wall {
    let planes = normals.iter().map(|&normal| WallPlane {
        normal,
        offset: 0.0,
    });
    Wall::new("corner", planes.collect()).unwrap()
}

/// A plane, an edge, a corner, and a blunt and a sharp cavity; from a touch to deep in the wall.
#[test]
fn walls_press_with_the_gradient_of_the_energy() {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let blunt = [Vector3::new(0.1, 0.0, 1.0), Vector3::new(-0.1, 0.02, 1.0)];
    let sharp = [Vector3::new(1.0, 0.0, 0.2), Vector3::new(-1.0, 0.0, 0.2)];
    let ball = Sphere::new(0.7).unwrap();
    let mut stream = Stream(11);
    for normals in [&axes[..1], &axes[..2], &axes[..], &blunt, &sharp] {
        let wall = corner(normals);
        for depth in [0.003, 0.05, 0.3, 0.9, 1.3] {
            let frame = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            let evaluate = |x: &Vector3<f64>| kernel().evaluate_wall(&wall, &frame, &ball, x);
            // Up the mean normal to where the deepest plane is that deep, and a little aside.
            let mean: Vector3<f64> = normals.iter().map(Vector3::normalize).sum();
            let rise = normals.iter().map(|n| n.normalize().dot(&mean));
            let rise = rise.fold(f64::INFINITY, f64::min);
            let up = mean * (0.7 * (1.0 - depth) / rise);
            let aside = stream.vector() * (0.2 * 0.7 * depth);
            let centre = frame.point(&(up + aside));
            let some = evaluate(&centre);
            if some.is_none() {
                continue;
            }
            let whole = check_gradient(evaluate, centre, 0.7);
            assert!(whole || depth > 0.5, "{depth}");
        }
    }
}

/// Ball radius, depth of the deepest plane over it, and all solids: facets, edges and vertices in the ball, and the ball
/// inside.
#[test]
fn polyhedra_press_with_the_gradient_of_the_energy() {
    let mut stream = Stream(5);
    let (mut inside, mut whole) = (0, 0);
    for (name, solid, shape) in solids() {
        for (radius, depth) in [
            (0.1, 0.03),
            (0.5, 0.02),
            (2.0, 0.01),
            (0.3, 0.5),
            (0.2, 1.6),
            (1.0, 0.4),
        ] {
            let ball = Sphere::new(radius).unwrap();
            let frame = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            // Onto a facet, an edge, a vertex: a point of the surface in a random direction, or a vertex.
            for case in 0..4 {
                let direction = match case {
                    0 => solid.vertices()[0].coords.normalize(),
                    1 => (solid.vertices()[0].coords + solid.vertices()[1].coords).normalize(),
                    _ => stream.vector().normalize(),
                };
                let skin = direction * (1.0 / (1.0 - shape.field(&direction)));
                let local = skin + direction * (radius * (1.0 - 2.0 * depth));
                let centre = frame.point(&(local + stream.vector() * (0.01 * radius)));
                let evaluate =
                    |x: &Vector3<f64>| kernel().evaluate_convex(&shape, &frame, &ball, x);
                let Some(here) = evaluate(&centre) else {
                    continue;
                };
                inside += usize::from(
                    shape.field(&frame.rotation.tr_mul(&(centre - frame.position))) > 0.0,
                );
                whole += usize::from(check_gradient(evaluate, centre, radius));
                // The torque on the polyhedron, against differences as it turns.
                let (step, rounding) = step(&here, radius);
                for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    let at = |angle: f64| {
                        let frame = turned(&frame, &axis, angle);
                        energy(kernel().evaluate_convex(&shape, &frame, &ball, &centre))
                    };
                    let slope = (at(step) - at(-step)) / (2.0 * step);
                    let torque = here.torque_a().dot(&axis);
                    let scale = here.force.norm() * here.arm_a.norm();
                    assert!(
                        (torque + slope).abs() < 1e-6 * scale + rounding,
                        "{name}: {torque} {slope}"
                    );
                }
            }
        }
    }
    assert!(inside > 80 && whole > 150, "{inside} {whole}");
}

/// The numbers of an overlap, each with its size.
fn numbers(o: &Overlap) -> Vec<(&'static str, f64, f64)> {
    let (force, length) = (o.force.norm(), o.arm_b.norm());
    let disc = o.area.sqrt();
    let mut all = vec![
        ("energy", o.energy, o.energy),
        ("volume", o.volume, o.volume),
        ("area", o.area, o.area),
        ("stiffness", o.foundation.stiffness, o.foundation.stiffness),
        ("rocking", o.foundation.rocking[0], o.foundation.polar()),
        ("rocking", o.foundation.rocking[1], o.foundation.polar()),
        ("torsion radius", o.torsion_radius, o.torsion_radius),
    ];
    for k in 0..3 {
        all.push(("force", o.force[k], force));
        all.push(("moment", o.moment[k], force * disc));
        all.push(("arm A", o.arm_a[k], length));
        all.push(("arm B", o.arm_b[k], length));
        all.push(("centre", o.foundation.centre[k], disc));
    }
    all
}

fn facets(radius: f64, level: u32) -> ConvexShape {
    let shape = shapes::Shape::from(shapes::Sphere { level });
    ConvexShape::new(&shape.polyhedron(2.0 * radius).unwrap()).unwrap()
}

const LEVELS: [u32; 3] = [2, 3, 4];

/// The differences to the exact ball of polyhedra of the levels 2 to 4 become 4 times smaller from level to level: on
/// average over poses, and each number is within `last` at the last level.
fn check_convergence(
    exact: impl Fn(usize) -> Overlap,
    faceted: impl Fn(usize, &ConvexShape) -> Overlap,
    radius: f64,
    last: f64,
) {
    let poses = 4;
    let mut errors = Vec::new();
    for level in LEVELS {
        let shape = facets(radius, level);
        let mut sum = 0.0;
        for pose in 0..poses {
            let (one, other) = (exact(pose), faceted(pose, &shape));
            for ((name, x, size), (_, y, _)) in numbers(&one).into_iter().zip(numbers(&other)) {
                let error = (x - y).abs() / size;
                assert!(
                    level < 4 || error < last,
                    "{name} of pose {pose}: {x:e}, {y:e}"
                );
                sum += error;
            }
        }
        errors.push(sum);
    }
    assert!(
        errors[0] > 3.0 * errors[1] && errors[1] > 3.0 * errors[2],
        "{errors:?}"
    );
}

fn posed(seed: usize, position: Vector3<f64>) -> Frame {
    Frame {
        position,
        rotation: Stream(seed as u64 + 1).rotation(),
    }
}

#[test]
fn it_is_the_limit_of_finer_polyhedra_against_a_wall() {
    let ball = Sphere::new(0.7).unwrap();
    let wall = corner(&[Vector3::z(), Vector3::new(0.0, 0.6, 0.5)]);
    let centre =
        |pose: usize| Vector3::new(0.1, 0.2 * pose as f64 - 0.3, 0.66 - 0.04 * pose as f64);
    let cavity = CavityKernel::new(1.0).unwrap();
    let exact = |pose: usize| {
        kernel()
            .evaluate_wall(&wall, &Frame::identity(), &ball, &centre(pose))
            .unwrap()
    };
    let faceted = |pose: usize, shape: &ConvexShape| {
        let frame = posed(pose, centre(pose));
        cavity
            .evaluate(
                &wall,
                &Frame::identity(),
                shape,
                &frame,
                &mut Scratch::default(),
            )
            .unwrap()
    };
    check_convergence(exact, faceted, 0.7, 0.1);
}

#[test]
fn it_is_the_limit_of_finer_polyhedra_against_a_sphere() {
    let (a, b) = (Sphere::new(0.7).unwrap(), Sphere::new(1.1).unwrap());
    let between =
        |pose: usize| Vector3::new(0.3, -0.2, 0.5).normalize() * (1.75 - 0.04 * pose as f64);
    let pair = PairKernel::new(1.0).unwrap();
    let exact = |pose: usize| kernel().evaluate(&a, &b, &between(pose)).unwrap();
    let large = LEVELS.map(|level| facets(1.1, level));
    let faceted = |pose: usize, shape: &ConvexShape| {
        let alike = |other: &&ConvexShape| other.vertices().len() == shape.vertices().len();
        let large = large.iter().find(alike).unwrap();
        let at = [
            posed(pose, Vector3::zeros()),
            posed(pose + 9, between(pose)),
        ];
        pair.evaluate(shape, &at[0], large, &at[1], &mut Scratch::default())
            .unwrap()
    };
    check_convergence(exact, faceted, 0.7, 0.1);
}

#[test]
fn it_is_the_limit_of_finer_polyhedra_against_solids() {
    let ball = Sphere::new(0.7).unwrap();
    let pair = PairKernel::new(1.0).unwrap();
    // Of no sharp edges: see `convex.rs` for the stiffness at these.
    let blunt = |name: &str| ["P2", "P5", "A10"].contains(&name);
    for (_, solid, body) in solids().into_iter().filter(|s| blunt(&s.0)) {
        let place = |pose: usize| {
            let corner = solid.vertices()[pose].coords;
            let next = solid.vertices()[(pose + 1) % 4].coords;
            let direction = (corner + next * (0.1 * pose as f64)).normalize();
            let skin = direction / (1.0 - body.field(&direction));
            posed(77, Vector3::zeros()).rotation * (skin + direction * (0.6 - 0.02 * pose as f64))
        };
        let still = posed(77, Vector3::zeros());
        let exact = |pose: usize| {
            kernel()
                .evaluate_convex(&body, &still, &ball, &place(pose))
                .unwrap()
        };
        let faceted = |pose: usize, shape: &ConvexShape| {
            let frame = posed(pose, place(pose));
            pair.evaluate(&body, &still, shape, &frame, &mut Scratch::default())
                .unwrap()
        };
        check_convergence(exact, faceted, 0.7, 0.1);
    }
}

/// Against a plane at the depth e: U = 2 p int_D^R 2 pi r (r - D) (1 - r/R) dr and F = 2 pi p e^2 (1 - 2 e/(3 R)).
#[test]
fn a_plane_presses_as_the_textbook_integral_says() {
    let wall = corner(&[Vector3::z()]);
    for (r, depth) in [(0.5, 1e-9), (0.5, 1e-4), (2.0, 0.1), (1.0, 0.7)] {
        let ball = Sphere::new(r).unwrap();
        let o = kernel()
            .evaluate_wall(
                &wall,
                &Frame::identity(),
                &ball,
                &Vector3::new(0.0, 0.0, r - depth),
            )
            .unwrap();
        let force = 2.0 * std::f64::consts::PI * depth * depth * (1.0 - 2.0 * depth / (3.0 * r));
        let area = std::f64::consts::PI * depth * (2.0 * r - depth);
        let rounding = 1e-15 * r / depth + 1e-12;
        assert!(
            (o.force.z / force - 1.0).abs() < rounding,
            "{} {force}",
            o.force.z
        );
        assert!((o.area / area - 1.0).abs() < rounding);
        let turned: Matrix3<f64> = Stream(4).rotation();
        assert!((turned * o.normal - turned.column(2)).norm() < 1e-14);
    }
}

/// With the ball's centre on a plane, to the last bit or nearly, half of the ball lies behind it: U = p pi R^3/3 on a wall,
/// whichever zero its distance is, and energy and force go on smoothly through a facet of a cube.
#[test]
fn a_centre_on_a_plane_is_no_exception() {
    let radius = 0.1;
    let ball = Sphere::new(radius).unwrap();
    let near = [0.0, -0.0, 1e-17, -1e-17, 1e-12, -1e-12, 1e-10, -1e-10];
    let half = std::f64::consts::PI * radius.powi(3) / 3.0;
    for sign in [1.0, -1.0] {
        let wall = corner(&[Vector3::z() * sign]);
        for off in near {
            let centre = Vector3::new(0.02, 0.03, off);
            let found = kernel().evaluate_wall(&wall, &Frame::identity(), &ball, &centre);
            assert!((energy(found) / half - 1.0).abs() < 1e-7, "{sign} {off}");
        }
    }
    let cube = "box:width=1,height=1".parse::<shapes::Shape>().unwrap();
    let cube = ConvexShape::new(&cube.polyhedron(1.0).unwrap()).unwrap();
    let at = |off: f64| {
        let centre = Vector3::new(0.02, 0.03, 0.5 + off);
        let found = kernel().evaluate_convex(&cube, &Frame::identity(), &ball, &centre);
        found.unwrap()
    };
    let beside = at(1e-7);
    for off in near {
        let o = at(off);
        assert!((o.energy / beside.energy - 1.0).abs() < 1e-4, "{off} {o:?}");
        assert!(
            (o.force - beside.force).norm() < 1e-4 * o.force.norm(),
            "{off} {o:?}"
        );
    }
}
