//! Walls against deformable bodies: as the mirror image of the body, and as against rigid bodies.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::soft::Soft;
use crate::common::tets::cube;
use femdem_contact::deform::{
    DeformableKernel, DeformableOverlap, DeformableScratch, Modulus, NodalState, Operand,
};
use femdem_contact::{
    ContactBatch, ContactLaw, ContactParameters, Frame, MeshWall, Motion, SolidWall, Wall,
    WallResponse, WallShape,
};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::Vector3;

/// A ball-like body whose lowest part, `depth` below z = 0, is a shallow cap: a cube with its lower
/// face bent, at rest at the height 1/2.
fn bent(depth: f64) -> Soft {
    let mut soft = Soft::linear(&cube(4));
    for x in &mut soft.x {
        let rise = 4.0 * depth * (x.x * x.x + x.y * x.y + 0.1 * x.x);
        x.z += 0.5 - depth + rise;
    }
    soft
}

/// The mirror image in the plane z = 0, with the same nodes.
fn mirrored(soft: &Soft) -> Soft {
    let flip = |x: &Vector3<f64>| Vector3::new(x.x, x.y, -x.z);
    let points = soft.mesh.points().iter().map(|p| flip(&p.coords).into());
    let tets = soft.mesh.tets().iter().map(|&[a, b, c, d]| [b, a, c, d]);
    let mesh = TetMesh::new(points.collect(), tets.collect()).unwrap();
    let mut image = Soft::linear(&mesh);
    image.x = soft.x.iter().map(flip).collect();
    image
}

/// A wall that fills the unit cube below the middle of the plane z = 0, and its frame.
fn unit_block_below() -> (SolidWall, Frame) {
    let mesh = cube(1);
    let corners = mesh.points().iter().map(|p| p.coords);
    let lowest = corners.reduce(|a, b| a.inf(&b)).unwrap();
    let mut below = Frame::identity();
    below.position = Vector3::new(-0.5, -0.5, -1.0) - lowest;
    (SolidWall::solid(&mesh), below)
}

fn operand(soft: &Soft) -> Operand<'_> {
    Operand::Deformable(&soft.shape, &soft.x)
}

fn evaluate(kernel: &DeformableKernel, a: Operand, b: Operand) -> DeformableOverlap {
    let modulus = Modulus::Penalty(3.0);
    let found = kernel.evaluate(
        (a, modulus),
        (b, modulus),
        &mut DeformableScratch::default(),
    );
    found.unwrap().unwrap()
}

/// Against its mirror image a body has twice the energy that it has against the plane, and the same nodal
/// forces, up to terms of the order of the depth.
#[test]
fn a_wall_acts_as_the_mirror_image_of_the_body() {
    let (floor, below) = unit_block_below();
    let depth = 2e-3;
    let body = bent(depth);
    let image = mirrored(&body);
    let kernel = DeformableKernel::default();
    let pair = evaluate(&kernel, operand(&image), operand(&body));
    let wall = evaluate(&kernel, Operand::Wall(&floor, &below), operand(&body));
    let ratio = 2.0 * wall.energy / pair.energy;
    assert!((ratio - 1.0).abs() < 0.01, "energy {ratio}");
    let largest = pair.nodes[1]
        .iter()
        .map(|n| n.force.norm())
        .fold(0.0, f64::max);
    for n in &pair.nodes[1] {
        let other = wall.nodes[1].iter().find(|m| m.node == n.node);
        let force = other.map_or_else(Vector3::zeros, |m| m.force);
        // Along the plane the forces of order depth on single nodes differ; their sum does not.
        let off = (force - n.force).z.abs() / largest;
        assert!(off < 0.02, "node {} {off}", n.node);
    }
}

/// Contact of a sheared body on a floor: nodal forces, their stiffness, energy.
fn on_floor(
    wall: WallShape,
    frame: Frame,
    law: ContactParameters,
) -> (Vec<Vector3<f64>>, Vec<f64>, f64) {
    let mut batch = ContactBatch::new(ContactLaw::new(law).unwrap());
    let mut body = bent(0.01).shaken(&mut Stream(11), 2e-3);
    let kind = batch.add_deformable_shape(body.shape.clone());
    batch
        .add_deformable(kind, Modulus::Penalty(law.penalty))
        .unwrap();
    batch.add_wall(wall);
    let inverse_masses = vec![1.0; body.x.len()];
    let velocities = vec![Vector3::new(0.1, 0.05, -0.2); body.x.len()];
    for _ in 0..4 {
        for (x, v) in body.x.iter_mut().zip(&velocities) {
            *x += v * 1e-3;
        }
        let state = NodalState {
            positions: &body.x,
            velocities: &velocities,
            inverse_masses: &inverse_masses,
        };
        batch
            .update_deformables(
                &[state],
                &[Motion::fixed(frame)],
                &[Motion::fixed(frame)],
                0.0,
            )
            .unwrap();
    }
    let energy = batch.deformable_totals().unwrap().energy;
    (
        batch.nodal_loads(0).forces.to_vec(),
        batch.nodal_loads(0).stiffness.to_vec(),
        energy,
    )
}

fn floor_of_planes() -> WallShape {
    Wall::half_space("floor", Vector3::z(), 0.0).unwrap().into()
}

fn law(penalty: f64, wall_response: WallResponse) -> ContactParameters {
    ContactParameters {
        penalty,
        wall_response,
        ..ContactParameters::default()
    }
}

/// Forces, friction and damping included, stiffness and energy are the same on a floor given as a plane and
/// as a mesh.
#[test]
fn a_floor_of_planes_is_a_floor_of_tetrahedra() {
    let mesh = cube(1);
    let mut big = Vec::new();
    let lowest = mesh
        .points()
        .iter()
        .map(|p| p.coords)
        .reduce(|a, b| a.inf(&b))
        .unwrap();
    for p in mesh.points() {
        let unit = p.coords - lowest;
        big.push((unit * 8.0 - Vector3::new(4.0, 4.0, 8.0)).into());
    }
    let block = TetMesh::new(big, mesh.tets().to_vec()).unwrap();
    for response in [WallResponse::Mirror, WallResponse::Rigid] {
        let law = law(1e6, response);
        let planes = on_floor(floor_of_planes(), Frame::identity(), law);
        let solid = on_floor(
            MeshWall::solid("block", &block).into(),
            Frame::identity(),
            law,
        );
        let size = planes.0.iter().map(Vector3::norm).fold(0.0, f64::max);
        assert!(size > 0.0);
        for (f, g) in planes.0.iter().zip(&solid.0) {
            assert!((f - g).norm() < 1e-9 * size, "{response:?}: {f} {g}");
        }
        let size = planes.1.iter().copied().fold(0.0, f64::max);
        for (k, l) in planes.1.iter().zip(&solid.1) {
            assert!((k - l).abs() < 1e-9 * size, "{response:?}: {k} {l}");
        }
        assert!((planes.2 / solid.2 - 1.0).abs() < 1e-9, "{response:?}");
    }
}

/// All that depends on the energy follows the response: forces with friction and damping, stiffness.
#[test]
fn the_response_scales_all_that_a_wall_does() {
    let mirror = on_floor(
        floor_of_planes(),
        Frame::identity(),
        law(1e6, WallResponse::Mirror),
    );
    let rigid = on_floor(
        floor_of_planes(),
        Frame::identity(),
        law(2e6, WallResponse::Rigid),
    );
    assert_eq!(mirror, rigid);
    let soft = on_floor(
        floor_of_planes(),
        Frame::identity(),
        law(1e6, WallResponse::Rigid),
    );
    assert!((mirror.2 / soft.2 - 2.0).abs() < 1e-12);
}

/// The largest eigenvalue of a wall's stiffness in the metric of the masses, by power iteration on
/// differences of forces, lies below the bound used for the step, and not far below.
#[test]
fn the_nodes_stiffness_bounds_the_frequency_on_a_wall() {
    let (floor, below) = unit_block_below();
    for depth in [0.1, 0.01, 0.001] {
        let mut stream = Stream(13);
        let body = bent(depth).shaken(&mut stream, 0.02 * depth);
        let weight: Vec<f64> = body.x.iter().map(|_| 1.0 + 3.0 * stream.unit()).collect();
        let kernel = DeformableKernel::default();
        let at = |shift: &[Vector3<f64>]| {
            let x: Vec<_> = body.x.iter().zip(shift).map(|(x, d)| x + d).collect();
            let sides = [
                Operand::Wall(&floor, &below),
                Operand::Deformable(&body.shape, &x),
            ];
            let mut forces = vec![Vector3::zeros(); x.len()];
            let mut bound = 0.0_f64;
            for n in &evaluate(&kernel, sides[0], sides[1]).nodes[1] {
                forces[n.node as usize] = n.force;
                bound = bound.max(2.0 * n.stiffness * weight[n.node as usize]);
            }
            (forces, bound)
        };
        let mut v: Vec<Vector3<f64>> = weight.iter().map(|_| stream.vector()).collect();
        let mut largest = 0.0;
        for _ in 0..60 {
            let size = v.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
            let step = 1e-3 * depth / size;
            let by = |s: f64| -> Vec<_> { v.iter().map(|v| v * (s * step)).collect() };
            let (plus, minus) = (at(&by(1.0)).0, at(&by(-1.0)).0);
            let new: Vec<_> = (0..v.len())
                .map(|i| (minus[i] - plus[i]) * (0.5 / step * weight[i]))
                .collect();
            let product = |x: &[Vector3<f64>]| -> f64 {
                (0..v.len()).map(|i| v[i].dot(&x[i]) / weight[i]).sum()
            };
            largest = product(&new) / product(&v);
            v = new;
        }
        let bound = at(&vec![Vector3::zeros(); weight.len()]).1;
        let ratio = bound / largest;
        assert!((1.0..8.0).contains(&ratio), "{depth}: {ratio}");
    }
}
