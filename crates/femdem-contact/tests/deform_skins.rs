//! The sums over skins, from which deformable bodies get their forces, against the sums over common parts of
//! tetrahedra, which share no arithmetic with them.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::soft::{Soft, near};
use crate::common::tets::{body, cube, dolos};
use femdem_contact::deform::{
    DeformableKernel, DeformableOverlap, DeformableScratch, Modulus, Operand,
};
use femdem_contact::{Field, Frame, SolidWall};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::{Point3, Vector3};

/// Over skins and over pieces.
fn both(a: Operand, b: Operand) -> [Option<DeformableOverlap>; 2] {
    let [a, b] = [(a, Modulus::Penalty(3.0)), (b, Modulus::Foundation(20.0))];
    let kernel = DeformableKernel::default();
    let mut scratch = DeformableScratch::default();
    [
        kernel.evaluate(a, b, &mut scratch).unwrap(),
        kernel.evaluate_pieces(a, b, &mut scratch).unwrap(),
    ]
}

/// Asserts that both agree, relative to the forces of either skin.
fn assert_same(name: &str, [skins, pieces]: [Option<DeformableOverlap>; 2], size: f64) -> f64 {
    let (Some(x), Some(y)) = (&skins, &pieces) else {
        assert_eq!(skins, pieces, "{name}");
        return 0.0;
    };
    let (f, g) = (&x.wrenches[1], &y.wrenches[1]);
    // The forces of all sides of an overlap may cancel.
    let force = g.force.norm().max(y.energy / size);
    let stiffness = y.stiffness.max(force / size);
    for (what, error) in [
        ("energy", (x.energy / y.energy - 1.0).abs()),
        ("force", (f.force - g.force).norm() / force),
        ("torque", (f.torque - g.torque).norm() / (force * size)),
        ("stiffness", (x.stiffness - y.stiffness).abs() / stiffness),
        ("centre", (x.centre - y.centre).norm() / size),
    ] {
        assert!(error < 1e-11, "{name}, {what}: {error:e}");
    }
    for side in 0..2 {
        assert_eq!(x.nodes[side].len(), y.nodes[side].len(), "{name}");
        for (n, m) in x.nodes[side].iter().zip(&y.nodes[side]) {
            assert_eq!(n.node, m.node);
            let error = (n.stiffness - m.stiffness).abs() / stiffness;
            assert!(error < 1e-11, "{name}: {error:e}");
            let error = (n.force - m.force).norm() / force;
            assert!(error < 1e-11, "{name}, node {}: {error:e}", n.node);
        }
    }
    assert!((x.volume / y.volume - 1.0).abs() < 1e-8, "{name}");
    y.volume
}

fn bodies() -> Vec<(&'static str, Soft, f64)> {
    let stone = TetMesh::centroid_fan(&tets_of_a_stone()).unwrap();
    vec![
        ("fan", Soft::linear(&stone), 0.02),
        ("cube", Soft::linear(&cube(2)), 0.05),
        ("one cube, all of it skin", Soft::linear(&cube(1)), 0.08),
        ("dolos", Soft::linear(&dolos()), 0.02),
        ("quadratic cube", Soft::quadratic(&cube(1)), 0.04),
    ]
}

fn tets_of_a_stone() -> femdem_mesh::Polyhedron {
    use femdem_mesh::shapes::{Boulder, Shape};
    Shape::Boulder(Boulder::default()).polyhedron(1.0).unwrap()
}

fn deformable(soft: &Soft) -> Operand<'_> {
    Operand::Deformable(&soft.shape, &soft.x)
}

/// Random poses, from slight to so deep that inner nodes of one body lie in the other, against deformable
/// bodies, a rigid body, and walls of the same size and much larger.
#[test]
fn skins_add_up_to_the_pieces() {
    let mut stream = Stream(11);
    let rigid = body(&dolos(), Field::Body);
    let small = SolidWall::solid(&cube(1));
    let points = cube(1)
        .points()
        .iter()
        .map(|p| Point3::from(p.coords * 60.0))
        .collect();
    let large = SolidWall::solid(&TetMesh::new(points, cube(1).tets().to_vec()).unwrap());
    let all = bodies();
    let (mut volumes, mut count) = (Vec::new(), 0);
    for round in 0..12 {
        let distance = 0.15 + 0.08 * f64::from(round);
        for (i, (name, first, shake)) in all.iter().enumerate() {
            let (other, second, shake2) = &all[(i + 1 + round as usize % 5) % 5];
            let mut frame = Frame::identity();
            frame.position = stream.vector() * 5.0;
            frame.rotation = stream.rotation();
            let a = first.posed(&frame).shaken(&mut stream, *shake);
            let b = second
                .posed(&near(&frame, &mut stream, distance))
                .shaken(&mut stream, *shake2);
            let below = |edge: f64| Frame {
                position: frame.position
                    - frame.rotation * Vector3::new(0.5 * edge, 0.45 * edge, edge),
                ..frame
            };
            let (at_small, at_large) = (below(1.0), below(60.0));
            for (against, side) in [
                (*other, deformable(&a)),
                ("rigid dolos", Operand::Rigid(&rigid, &frame)),
                ("wall", Operand::Wall(&small, &at_small)),
                ("large wall", Operand::Wall(&large, &at_large)),
            ] {
                let found = both(side, deformable(&b));
                volumes.push(assert_same(
                    &format!("{other} on {against} by {name}"),
                    found,
                    1.0,
                ));
                count += 1;
            }
        }
    }
    let deep = volumes.iter().filter(|v| **v > 0.05).count();
    let slight = volumes.iter().filter(|v| **v > 0.0 && **v < 1e-3).count();
    assert!(
        deep > count / 10 && slight > count / 50,
        "{deep}, {slight} of {count}"
    );
}

/// Cubes of many cells shifted by whole cells: skins lie in faces inside the other body, and nodes with
/// pressure on skins. There the sums over pieces are used; slightly beside, the sums over skins agree with
/// them.
#[test]
fn coinciding_faces_are_no_trouble() {
    let soft = Soft::linear(&cube(2));
    for shift in [
        Vector3::new(0.0, 0.0, 0.5),
        Vector3::new(0.5, 0.5, 0.5),
        Vector3::new(0.5, 0.0, 0.9),
        Vector3::new(0.25, 0.5, 0.5),
        Vector3::new(0.0, 0.0, 0.9),
    ] {
        let mut at = Frame::identity();
        at.position = shift;
        let b = soft.posed(&at);
        let [skins, pieces] = both(deformable(&soft), deformable(&b));
        let energy = pieces.as_ref().unwrap().energy;
        assert_same(&format!("{shift:?}"), [skins, pieces], 1.0);
        at.position += Vector3::new(3e-10, -2e-10, 4e-10);
        let [beside, _] = both(deformable(&soft), deformable(&soft.posed(&at)));
        let beside = beside.unwrap().energy;
        assert!(
            (beside / energy - 1.0).abs() < 1e-7,
            "{shift:?}: {beside:e} {energy:e}"
        );
    }
}

/// A node with pressure very close to a skin: the flux about the node has a pole there.
#[test]
fn a_node_at_a_skin_is_no_trouble() {
    let mut stream = Stream(12);
    let soft = Soft::linear(&cube(2));
    let middle = soft.x.iter().position(|x| x.norm() < 1e-12).unwrap();
    for gap in [1e-2, 1e-3, 1e-5, 1e-8, 1e-11, 0.0, -1e-11, -1e-6, -1e-3] {
        let a = soft.clone().shaken(&mut stream, 0.03);
        let mut at = Frame::identity();
        at.rotation = stream.rotation();
        // A point of the lower face of B meets the node.
        let on_face = Vector3::new(0.13, -0.17, -0.5 - gap);
        at.position = a.x[middle] - at.rotation * on_face;
        let found = both(deformable(&a), deformable(&soft.posed(&at)));
        assert_same(&format!("{gap:e}"), found, 1.0);
    }
}
