//! Deformable bodies that touch themselves: a folded strip, a coil, and a block with a crack.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::soft::Soft;
use crate::common::tets::{block, cubes};
use femdem_contact::deform::{
    DeformableKernel, DeformableOverlap, DeformableScratch, DeformableShape, Modulus, NodalState,
    Operand,
};
use femdem_contact::{ContactBatch, ContactLaw, ContactParameters, Frame, Motion, Partner};
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::{Point3, TetMesh};

const MODULUS: Modulus = Modulus::Foundation(20.0);

fn evaluate(shape: &DeformableShape, x: &[Vector3<f64>]) -> Option<DeformableOverlap> {
    let mut scratch = DeformableScratch::default();
    let body = (Operand::Deformable(shape, x), MODULUS);
    let kernel = DeformableKernel::default();
    kernel.evaluate_itself(body, &mut scratch).unwrap()
}

/// The forces of both sides on every node.
fn forces(found: &DeformableOverlap, count: usize) -> Vec<Vector3<f64>> {
    let mut forces = vec![Vector3::zeros(); count];
    for node in found.nodes.iter().flatten() {
        forces[node.node as usize] += node.force;
    }
    forces
}

/// A strip of square section 1 along x, from 0 on, with its middle in the plane z = 0.
fn strip(length: i32, fine: i32) -> Soft {
    let mesh = cubes(
        &block([length * fine, fine, fine], |_| true),
        1.0 / f64::from(fine),
    );
    let mut soft = Soft::linear(&mesh);
    let to_middle = |p: &Point3| p.coords - Vector3::new(0.0, 0.5, 0.5);
    soft.x = mesh.points().iter().map(to_middle).collect();
    soft
}

/// The strip bent along a curve in the plane y = 0, given by its place and its direction at an arc length.
fn bent(mut soft: Soft, curve: impl Fn(f64) -> [Vector3<f64>; 2]) -> Soft {
    for x in &mut soft.x {
        let [at, along] = curve(x.x);
        let up = along.cross(&Vector3::y());
        *x = at + up * x.z + Vector3::y() * x.y;
    }
    soft
}

/// Straight, then round an arc of the given radius and angle, then straight again.
fn hairpin(start: f64, radius: f64, angle: f64) -> impl Fn(f64) -> [Vector3<f64>; 2] {
    move |s| {
        let turn = ((s - start) / radius).clamp(0.0, angle);
        let rest = s - start - turn * radius;
        let along = Vector3::new(turn.cos(), 0.0, turn.sin());
        let arc = Vector3::new(turn.sin(), 0.0, 1.0 - turn.cos()) * radius;
        [arc + along * rest, along]
    }
}

/// A spiral whose turns are `pitch` apart, from the radius `start` on.
fn spiral(start: f64, pitch: f64) -> impl Fn(f64) -> [Vector3<f64>; 2] {
    let rate = pitch / std::f64::consts::TAU;
    move |s| {
        // The arc length is close to the integral of the radius.
        let turn = ((start * start + 2.0 * rate * s).sqrt() - start) / rate;
        let radius = start + rate * turn;
        let along = Vector3::new(-turn.sin() * radius, 0.0, turn.cos() * radius)
            + Vector3::new(turn.cos(), 0.0, turn.sin()) * rate;
        let at = Vector3::new(turn.cos(), 0.0, turn.sin()) * radius;
        [at, along.normalize()]
    }
}

/// A block of 1 x 1 x 2 per unit of length with a crack in its middle plane z = 1.
#[derive(Clone)]
struct Cracked {
    soft: Soft,
    /// By tetrahedron, whether it lies above the plane.
    above: Vec<bool>,
}

/// Where the crack begins; it goes on to the end of the block.
const FRONT: f64 = 1.0;

/// A crack of nodes that exist twice, but for those at its front.
fn cracked(length: i32, stream: &mut Stream) -> Cracked {
    let mesh = cubes(&block([2 * length, 2, 4], |_| true), 0.5);
    let is_lip = |p: &Point3| (p.z - 1.0).abs() < 1e-9 && p.x > FRONT + 1e-9;
    let mut points = mesh.points().to_vec();
    // So that each tetrahedron has one triangle of the skin that is nearest; faces stay plane.
    for p in points.iter_mut().filter(|p| p.z % 1.0 != 0.0) {
        p.z += 0.1 * (stream.unit() - 0.5);
    }
    let mut twin = vec![None; points.len()];
    let mut tets = mesh.tets().to_vec();
    let height = |tet: &[u32; 4]| tet.map(|i| mesh.points()[i as usize].z).iter().sum::<f64>();
    let above: Vec<bool> = tets.iter().map(|tet| height(tet) > 4.0).collect();
    for (tet, _) in tets.iter_mut().zip(&above).filter(|(_, above)| **above) {
        for node in tet {
            let i = *node as usize;
            if is_lip(&mesh.points()[i]) {
                *node = *twin[i].get_or_insert_with(|| {
                    points.push(points[i]);
                    points.len() as u32 - 1
                });
            }
        }
    }
    let mesh = TetMesh::new(points, tets).unwrap();
    let soft = Soft::linear(&mesh);
    Cracked { soft, above }
}

impl Cracked {
    /// By node, 1 above the crack, -1 below it, each times its distance behind the front up to 1.
    fn ramp(&self) -> Vec<f64> {
        let mut ramp = vec![-1.0; self.soft.x.len()];
        for (tet, above) in self.soft.mesh.tets().iter().zip(&self.above) {
            for node in tet.iter().filter(|_| *above) {
                ramp[*node as usize] = 1.0;
            }
        }
        let points = self.soft.mesh.points().iter();
        let all = ramp.into_iter().zip(points);
        all.map(|(sign, p)| sign * (p.x - FRONT).clamp(0.0, 1.0))
            .collect()
    }

    /// The lips turned into each other by an angle each.
    fn closed(mut self, angle: f64) -> Self {
        let mut is_above = vec![false; self.soft.x.len()];
        for (tet, above) in self.soft.mesh.tets().iter().zip(&self.above) {
            for node in tet {
                is_above[*node as usize] |= above;
            }
        }
        let nodes = self.soft.mesh.points().iter().zip(is_above);
        for (x, (p, above)) in self.soft.x.iter_mut().zip(nodes) {
            x.z += (if above { -angle } else { angle }) * (p.x - FRONT).max(0.0);
        }
        self
    }

    /// The part above or below the plane as a body of its own, and the nodes of the whole that its nodes are.
    fn half(&self, above: bool) -> (Soft, Vec<u32>) {
        let tets = self.soft.mesh.tets().iter().zip(&self.above);
        let tets: Vec<[u32; 4]> = tets
            .filter(|(_, a)| **a == above)
            .map(|(t, _)| *t)
            .collect();
        let mut nodes = tets.concat();
        nodes.sort_unstable();
        nodes.dedup();
        let new = |node: u32| nodes.binary_search(&node).unwrap() as u32;
        let points = nodes
            .iter()
            .map(|&i| self.soft.mesh.points()[i as usize])
            .collect();
        let tets = tets.into_iter().map(|t| t.map(new)).collect();
        let mut soft = Soft::linear(&TetMesh::new(points, tets).unwrap());
        soft.x = nodes.iter().map(|&i| self.soft.x[i as usize]).collect();
        (soft, nodes)
    }
}

/// Largest error of forces against fourth-order differences of the energy, over the largest force, and of their sums; at one
/// in so many nodes.
fn errors(soft: &Soft, stride: usize) -> [f64; 3] {
    let found = evaluate(&soft.shape, &soft.x).unwrap();
    let forces = forces(&found, soft.x.len());
    let largest = forces.iter().map(Vector3::norm).fold(0.0, f64::max);
    let energy = |x: &[Vector3<f64>]| evaluate(&soft.shape, x).map_or(0.0, |o| o.energy);
    let h = 2e-5;
    let mut worst = 0.0_f64;
    for i in (0..soft.x.len()).step_by(stride) {
        for k in 0..3 {
            let at = |s: f64| {
                let mut moved = soft.x.clone();
                moved[i][k] += s;
                energy(&moved)
            };
            let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            worst = worst.max((forces[i][k] + slope).abs());
        }
    }
    let sum: Vector3<f64> = forces.iter().sum();
    let turn: Vector3<f64> = soft.x.iter().zip(&forces).map(|(x, f)| x.cross(f)).sum();
    [worst, sum.norm(), turn.norm()].map(|e| e / largest)
}

/// A strip whose ends meet, a coil of two turns and a block whose crack is pressed shut: shaken, so that nothing fits.
#[test]
fn forces_are_gradients_and_balance() {
    let mut stream = Stream(3);
    let mut folded = bent(strip(13, 1), hairpin(4.5, 1.2, 3.5)).shaken(&mut stream, 0.02);
    let turn = stream.rotation();
    folded.x.iter_mut().for_each(|x| *x = turn * *x);
    let coil = bent(strip(14, 1), spiral(1.0, 0.9)).shaken(&mut stream, 0.02);
    let shut = cracked(2, &mut stream).closed(0.03).soft;
    let crack = shut.clone().shaken(&mut stream, 0.01);
    // Its mesh is one of the block as it is shut.
    let points = shut.x.iter().map(|x| Point3::from(*x)).collect();
    let curved = TetMesh::new(points, shut.mesh.tets().to_vec()).unwrap();
    let curved = Soft::quadratic(&curved).shaken(&mut stream, 0.005);
    for (name, soft, stride) in [
        ("folded", folded, 2),
        ("coil", coil, 3),
        ("crack", crack, 4),
        ("quadratic", curved, 40),
    ] {
        let [gradient, force, moment] = errors(&soft, stride);
        assert!(gradient < 1e-8, "{name}: {gradient:e}");
        assert!(
            force < 1e-12 && moment < 1e-11,
            "{name}: {force:e} {moment:e}"
        );
    }
}

/// The contact of both halves as two bodies.
fn pressed(crack: &Cracked) -> DeformableOverlap {
    let halves = [false, true].map(|above| crack.half(above).0);
    let [a, b] = [0, 1].map(|k| (Operand::Deformable(&halves[k].shape, &halves[k].x), MODULUS));
    let mut scratch = DeformableScratch::default();
    let found = DeformableKernel::default().evaluate(a, b, &mut scratch);
    found.unwrap().unwrap()
}

/// The lips of a crack press on each other as two bodies do that are the halves of the block, up to its very front.
#[test]
fn a_crack_is_two_bodies() {
    for angle in [1e-4, 0.02] {
        let crack = cracked(3, &mut Stream(8)).closed(angle);
        let found = evaluate(&crack.soft.shape, &crack.soft.x).unwrap();
        let own = forces(&found, crack.soft.x.len());
        let pair = pressed(&crack);
        let mut want = vec![Vector3::zeros(); own.len()];
        for (list, above) in pair.nodes.iter().zip([false, true]) {
            let (_, nodes) = crack.half(above);
            for node in list {
                want[nodes[node.node as usize] as usize] += node.force;
            }
        }
        let largest = want.iter().map(Vector3::norm).fold(0.0, f64::max);
        let error = own
            .iter()
            .zip(&want)
            .map(|(f, g)| (f - g).norm())
            .fold(0.0, f64::max);
        assert!(error < 1e-9 * largest, "{angle}: {:e}", error / largest);
        assert!((found.energy / pair.energy - 1.0).abs() < 1e-9);
        assert!((found.area / pair.area - 1.0).abs() < 1e-9);
        assert!((found.stiffness / pair.stiffness - 1.0).abs() < 1e-9);
    }
}

/// A crack whose lips lie in each other by `DEPTH`, but for a ramp of length 1 behind its front, and the same slid along y.
const DEPTH: f64 = 0.01;

fn slid(crack: &Cracked, slip: f64) -> Vec<Vector3<f64>> {
    let by = Vector3::new(0.0, slip, -DEPTH) * 0.5;
    let nodes = crack.soft.x.iter().zip(crack.ramp());
    nodes.map(|(x, ramp)| x + by * ramp).collect()
}

/// Flat lips press on each other as two bodies do. While they hold, the stiffness of their friction is the tangential share
/// of that of the pressing, and when they slide it is the coefficient of friction times the force.
#[test]
fn lips_hold_and_slide_as_flat_faces_do() {
    let crack = cracked(3, &mut Stream(2));
    let law = ContactParameters {
        friction: 0.5,
        tangential_ratio: 0.8,
        tangential_damping: 0.0,
        damping_ratio: 0.0,
        ..ContactParameters::default()
    };
    let mut batch = ContactBatch::new(ContactLaw::new(law).unwrap());
    let shape = batch.add_deformable_shape(crack.soft.shape.clone());
    let body = batch.add_deformable(shape, MODULUS).unwrap();
    assert!(!batch.self_contact(body));
    batch.set_self_contact(body, true).unwrap();
    let count = crack.soft.x.len();
    let still = [Motion::fixed(Frame::identity())];
    let (rest, masses) = (vec![Vector3::zeros(); count], vec![1.0; count]);
    let put = |batch: &mut ContactBatch, slip: f64| {
        let x = slid(&crack, slip);
        let state = NodalState {
            positions: &x,
            velocities: &rest,
            inverse_masses: &masses,
        };
        batch
            .update_deformables(&[state], &still, &[], 1e-3)
            .unwrap();
        x
    };
    let mut update = |slip: f64| {
        let x = put(&mut batch, slip);
        let all = batch.nodal_loads(body).forces;
        let total: Vector3<f64> = all.iter().sum();
        let moment: Vector3<f64> = x.iter().zip(all).map(|(x, f)| x.cross(f)).sum();
        assert!(total.norm() < 1e-13 && moment.norm() < 1e-12);
        let contacts: Vec<_> = batch.deformable_contacts().copied().collect();
        assert_eq!(contacts.len(), 1);
        assert_eq!((contacts[0].a, contacts[0].b), (Partner::Body(body), body));
        (
            contacts[0].elastic_force,
            contacts[0].friction.y.abs(),
            contacts[0].slides,
        )
    };
    let mut halves = crack.clone();
    halves.soft.x = slid(&crack, 0.0);
    let pressing = pressed(&halves).wrenches[1].force.norm();
    let near = |found: f64, want: f64| assert!((found / want - 1.0).abs() < 0.02, "{found} {want}");
    for step in 0..=40 {
        // Slips up to 5/8 of the depth hold.
        let part = 0.05 * f64::from(step);
        let (normal, friction, slides) = update(part * DEPTH);
        if step == 0 {
            assert!((normal / pressing - 1.0).abs() < 1e-9);
        }
        near(normal, pressing);
        if (1..=10).contains(&step) {
            near(friction, 0.8 * pressing * part);
            assert!(!slides);
        }
        if step > 20 {
            near(friction, 0.5 * pressing);
        }
    }
    assert_eq!(batch.deformable_totals().unwrap().touching, 1);
    batch.set_self_contact(body, false).unwrap();
    put(&mut batch, 0.0);
    assert!(!batch.touches(body) && batch.deformable_contacts().next().is_none());
    assert!(batch.set_self_contact(7, true).is_err());
}
