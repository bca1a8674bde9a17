//! Nodal forces of deformable bodies are minus the gradient of the contact energy, and sum to the general
//! kernel's wrench.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::soft;
use crate::common::soft::{Soft, near};
use crate::common::tets::{body, cube, differences, dolos, total};
use femdem_contact::deform::{
    DeformableKernel, DeformableOverlap, DeformableScratch, Modulus, Operand,
};
use femdem_contact::general::GeneralScratch;
use femdem_contact::{
    ContactError, Field, FieldMesh, Frame, GeneralKernel, SolidWall, WallResponse,
};
use femdem_mesh::nalgebra::Vector3;

const MODULI: [Modulus; 2] = [Modulus::Penalty(3.0), Modulus::Foundation(20.0)];

fn evaluate(kernel: &DeformableKernel, a: Operand, b: Operand) -> Option<DeformableOverlap> {
    let mut scratch = DeformableScratch::default();
    kernel
        .evaluate((a, MODULI[0]), (b, MODULI[1]), &mut scratch)
        .unwrap()
}

/// Largest error of the forces on the nodes of side `k` against fourth-order differences, over the
/// largest force.
fn error(
    found: &DeformableOverlap,
    side: usize,
    x: &[Vector3<f64>],
    energy: impl Fn(&[Vector3<f64>]) -> f64,
) -> f64 {
    let mut forces = vec![Vector3::zeros(); x.len()];
    for node in &found.nodes[side] {
        forces[node.node as usize] = node.force;
    }
    let largest = forces.iter().map(Vector3::norm).fold(0.0, f64::max);
    let h = 2e-5;
    let mut worst = 0.0_f64;
    for i in 0..x.len() {
        for k in 0..3 {
            let at = |s: f64| {
                let mut moved = x.to_vec();
                moved[i][k] += s;
                energy(&moved)
            };
            let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            worst = worst.max((forces[i][k] + slope).abs());
        }
    }
    worst / largest
}

fn deformable(soft: &Soft) -> Operand<'_> {
    Operand::Deformable(&soft.shape, &soft.x)
}

/// The force and torque of the nodes of a side about the origin.
fn sum(found: &DeformableOverlap, side: usize, x: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let mut sum = [Vector3::zeros(); 2];
    for n in &found.nodes[side] {
        sum[0] += n.force;
        sum[1] += x[n.node as usize].cross(&n.force);
    }
    sum
}

/// Pairs of strongly deformed bodies: linear and quadratic, convex and not.
fn bodies() -> Vec<(&'static str, Soft, f64)> {
    vec![
        ("cube", Soft::linear(&cube(2)), 0.05),
        ("one cube, all of it skin", Soft::linear(&cube(1)), 0.08),
        ("dolos", Soft::linear(&dolos()), 0.02),
        ("quadratic cube", Soft::quadratic(&cube(1)), 0.04),
    ]
}

#[test]
fn nodal_forces_are_gradients() {
    let mut stream = Stream(5);
    let mut worst = 0.0_f64;
    let kernel = DeformableKernel::default();
    for (i, (name, first, shake)) in bodies().iter().enumerate() {
        let (other, second, shake2) = &bodies()[(i + 1) % 4];
        let mut frame = Frame::identity();
        frame.position = stream.vector() * 5.0;
        frame.rotation = stream.rotation();
        let a = first.posed(&frame).shaken(&mut stream, *shake);
        let b = second
            .posed(&near(&frame, &mut stream, 0.6))
            .shaken(&mut stream, *shake2);
        let found = evaluate(&kernel, deformable(&a), deformable(&b)).unwrap();
        let energy = |a: &[Vector3<f64>], b: &[Vector3<f64>]| {
            let sides = [
                Operand::Deformable(&first.shape, a),
                Operand::Deformable(&second.shape, b),
            ];
            evaluate(&kernel, sides[0], sides[1]).map_or(0.0, |o| o.energy)
        };
        let errors = [
            error(&found, 0, &a.x, |x| energy(x, &b.x)),
            error(&found, 1, &b.x, |x| energy(&a.x, x)),
        ];
        worst = worst.max(errors[0]).max(errors[1]);
        // Action and reaction are equal, about the same point.
        let [f, t] = sum(&found, 0, &a.x);
        let [g, u] = sum(&found, 1, &b.x);
        let size = found.nodes[0].iter().map(|n| n.force.norm()).sum::<f64>();
        assert!((f + g).norm() < 1e-12 * size, "{name} on {other}");
        assert!((t + u).norm() < 1e-11 * size, "{name} on {other}");
    }
    assert!(worst < 1e-8, "{worst:e}");
}

fn rigid_side<'a>(
    is_body: bool,
    body: &'a FieldMesh,
    wall: &'a SolidWall,
    frame: &'a Frame,
) -> Operand<'a> {
    if is_body {
        Operand::Rigid(body, frame)
    } else {
        Operand::Wall(wall, frame)
    }
}

/// Against a rigid body and against walls: nodal forces, and the wrench on the rigid side.
#[test]
fn forces_on_and_from_rigid_sides_are_gradients() {
    let mut stream = Stream(6);
    let rigid = body(&dolos(), Field::Body);
    let wall = SolidWall::solid(&cube(1));
    let kernel = DeformableKernel::default();
    for (name, soft, shake) in bodies() {
        let mut frame = Frame::identity();
        frame.position = stream.vector();
        frame.rotation = stream.rotation();
        let b = soft
            .posed(&near(&frame, &mut stream, 0.3))
            .shaken(&mut stream, shake);
        let in_wall = Frame {
            position: frame.position - frame.rotation * Vector3::repeat(0.5),
            ..frame
        };
        for (which, at) in [("dolos", frame), ("wall", in_wall)] {
            let found = evaluate(
                &kernel,
                rigid_side(which == "dolos", &rigid, &wall, &at),
                deformable(&b),
            )
            .unwrap();
            let energy = |frame: &Frame, x: &[Vector3<f64>]| {
                let soft = Operand::Deformable(&b.shape, x);
                evaluate(
                    &kernel,
                    rigid_side(which == "dolos", &rigid, &wall, frame),
                    soft,
                )
                .map_or(0.0, |o| o.energy)
            };
            let worst = error(&found, 1, &b.x, |x| energy(&at, x));
            assert!(worst < 1e-8, "{name} on {which}: {worst:e}");
            let [force, torque] = differences(|f| energy(f, &b.x), &at, 1e-4);
            let got = found.wrenches[0];
            let about = got.torque - at.position.cross(&got.force);
            let size = got.force.norm();
            assert!((got.force - force).norm() < 1e-8 * size, "{name} {which}");
            assert!((about - torque).norm() < 1e-8 * size, "{name} {which}");
            let [f, t] = sum(&found, 1, &b.x);
            assert!((f + got.force).norm() < 1e-12 * size, "{name} {which}");
            assert!((t + got.torque).norm() < 1e-11 * size, "{name} {which}");
        }
    }
}

/// An undeformed body has the contact of the rigid body in the general kernel.
#[test]
fn bodies_in_their_reference_state_are_the_rigid_ones() {
    let mut stream = Stream(7);
    let p = 3.0;
    let wall = SolidWall::solid(&cube(1));
    let moduli = (Modulus::Penalty(p), Modulus::Penalty(p));
    let general = GeneralKernel::new(p).unwrap();
    let kernel = DeformableKernel::default().with_walls(WallResponse::Rigid);
    for mesh in [cube(2), dolos()] {
        let mesh = mesh.with_interior_points();
        let (rigid, soft) = (body(&mesh, Field::Body), Soft::linear(&mesh));
        let mut fa = Frame::identity();
        fa.position = stream.vector();
        fa.rotation = stream.rotation();
        let fb = near(&fa, &mut stream, 0.4);
        let (a, b) = (soft.posed(&fa), soft.posed(&fb));
        let in_wall = Frame {
            position: fa.position - fa.rotation * Vector3::repeat(0.5),
            ..fa
        };
        let mut old = GeneralScratch::default();
        let mut scratch = DeformableScratch::default();
        let sides = [
            deformable(&a),
            Operand::Rigid(&rigid, &fa),
            Operand::Wall(&wall, &in_wall),
        ];
        for (k, side) in sides.into_iter().enumerate() {
            let patches = if k < 2 {
                general.evaluate(&rigid, &fa, &rigid, &fb, &mut old)
            } else {
                general.evaluate_wall(&wall, &in_wall, &rigid, &fb, &mut old)
            };
            let want = total(patches);
            let stiffness: f64 = patches.iter().map(|p| p.overlap.foundation.stiffness).sum();
            let found = kernel
                .evaluate((side, moduli.0), (deformable(&b), moduli.1), &mut scratch)
                .unwrap()
                .unwrap();
            let [force, torque] = sum(&found, 1, &b.x);
            let about = torque - fb.position.cross(&force);
            let size = want.force.norm();
            assert!((force - want.force).norm() < 1e-12 * size, "{k}");
            assert!((about - want.torque_b).norm() < 1e-12 * size, "{k}");
            assert!((found.energy / want.energy - 1.0).abs() < 1e-12, "{k}");
            assert!((found.volume / want.volume - 1.0).abs() < 1e-12, "{k}");
            assert!((found.stiffness / stiffness - 1.0).abs() < 1e-11, "{k}");
            // The nodes of a side add up to the stiffness.
            let shared: f64 = found.nodes[1].iter().map(|n| n.stiffness).sum();
            assert!((shared / stiffness - 1.0).abs() < 1e-11, "{k}");
        }
    }
}

#[test]
fn unusable_states_are_named() {
    let kernel = DeformableKernel::default();
    let a = Soft::linear(&cube(2));
    let mut above = Frame::identity();
    above.position.z = 0.9;
    let good = a.posed(&above);
    let mut scratch = DeformableScratch::default();
    let mut run = |a: Operand, b: Operand, p: f64| {
        kernel.evaluate((a, Modulus::Penalty(p)), (b, MODULI[0]), &mut scratch)
    };
    for bad in [f64::NAN, f64::INFINITY] {
        let mut b = good.clone();
        b.x[3].y = bad;
        assert_eq!(
            run(deformable(&a), deformable(&b), 1.0).unwrap_err(),
            ContactError::NodeState { body: 1, node: 3 }
        );
        assert!(run(deformable(&a), deformable(&good), bad).is_err());
    }
    let short = Operand::Deformable(&a.shape, &a.x[1..]);
    assert!(matches!(
        run(short, deformable(&good), 1.0),
        Err(ContactError::NodeCount {
            body: 0,
            given: 26,
            expected: 27
        })
    ));
    // A corner of B pushed through its own body.
    let mut b = good.clone();
    for x in &mut b.x {
        x.z = 1.8 - x.z;
    }
    assert!(matches!(
        run(deformable(&a), deformable(&b), 1.0),
        Err(ContactError::InvertedTet { body: 1, .. })
    ));
    // All nodes at one point.
    b.x.fill(Vector3::zeros());
    assert!(matches!(
        run(deformable(&a), deformable(&b), 1.0),
        Err(ContactError::InvertedTet { body: 1, .. })
    ));
    let rigid = body(&cube(1), Field::Body);
    let frame = Frame::identity();
    let b = Operand::Rigid(&rigid, &frame);
    assert!(run(deformable(&a), b, 1.0).is_err());
}

#[test]
fn mid_edges_must_be_the_edges() {
    use femdem_contact::deform::DeformableShape;
    let mesh = cube(1);
    let edges = soft::edges(&mesh);
    assert!(DeformableShape::quadratic(&mesh, &edges).is_ok());
    let why = |edges: &[[u32; 2]]| {
        let error = DeformableShape::quadratic(&mesh, edges).unwrap_err();
        error.to_string()
    };
    assert!(why(&edges[1..]).contains("has no node"));
    let mut far = edges.clone();
    far[0] = [0, 99];
    assert!(why(&far).contains("points 0 and 99"));
}

/// The largest eigenvalue of the contact's stiffness in the metric of the masses, by power iteration on
/// differences of forces, lies below the bound from the nodes' stiffness.
#[test]
fn the_nodes_stiffness_bounds_the_frequency() {
    let mut stream = Stream(9);
    let kernel = DeformableKernel::default();
    for depth in [0.3, 0.1, 0.01] {
        let (below, above) = (Soft::linear(&cube(2)), Soft::quadratic(&cube(1)));
        let mut frame = Frame::identity();
        frame.position = Vector3::new(0.1, 0.2, 1.0 - depth);
        let a = below.shaken(&mut stream, 0.02 * depth);
        let b = above.posed(&frame).shaken(&mut stream, 0.02 * depth);
        let weight: Vec<f64> = (0..a.x.len() + b.x.len())
            .map(|_| 1.0 + 3.0 * stream.unit())
            .collect();
        let forces = |shift: &[Vector3<f64>]| {
            let move_by = |x: &[Vector3<f64>], by: &[Vector3<f64>]| -> Vec<_> {
                x.iter().zip(by).map(|(x, d)| x + d).collect()
            };
            let x = move_by(&a.x, shift);
            let y = move_by(&b.x, &shift[a.x.len()..]);
            let sides = [
                Operand::Deformable(&a.shape, &x),
                Operand::Deformable(&b.shape, &y),
            ];
            let found = evaluate(&kernel, sides[0], sides[1]).unwrap();
            let mut forces = vec![Vector3::zeros(); shift.len()];
            let mut stiffness = vec![0.0; shift.len()];
            for (side, first) in [(0, 0), (1, a.x.len())] {
                for n in &found.nodes[side] {
                    forces[first + n.node as usize] = n.force;
                    stiffness[first + n.node as usize] = n.stiffness;
                }
            }
            (forces, stiffness)
        };
        // Of the two ends of the spectrum, the one farther from `-shift`.
        let mut end = |shift: f64| {
            let mut v: Vec<Vector3<f64>> = weight.iter().map(|_| stream.vector()).collect();
            let mut value = 0.0;
            for _ in 0..40 {
                let size = v.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
                let step = 1e-4 * depth / size;
                let by = |s: f64| -> Vec<_> { v.iter().map(|v| v * (s * step)).collect() };
                let (plus, minus) = (forces(&by(1.0)).0, forces(&by(-1.0)).0);
                let stiff = |i: usize| (minus[i] - plus[i]) * (0.5 / step * weight[i]);
                let new: Vec<_> = (0..v.len()).map(|i| stiff(i) + v[i] * shift).collect();
                let product = |x: &[Vector3<f64>]| -> f64 {
                    (0..v.len()).map(|i| v[i].dot(&x[i]) / weight[i]).sum()
                };
                value = product(&new) / product(&v) - shift;
                v = new;
            }
            value
        };
        // For deep overlaps, equal fields have negative curvature too.
        let first = end(0.0);
        let largest = if first < 0.0 { end(-first) } else { first };
        let count = weight.len();
        let stiffness = forces(&vec![Vector3::zeros(); count]).1;
        let bound = stiffness.iter().zip(&weight).map(|(k, w)| 2.0 * k * w);
        let bound = bound.fold(0.0, f64::max);
        assert!(largest < bound, "{depth}: {largest} above {bound}");
    }
}
