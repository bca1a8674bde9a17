//! Exact spheres against solids of tetrahedra: the kernels of planes and of convex polyhedra where these are the same
//! solids, forces against differences of the energy, patches one by one.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::meshes::{block, boxes, dolos, ring};
use crate::common::{Stream, solids, turned};
use femdem_contact::general::Patch;
use femdem_contact::{
    Field, FieldMesh, Frame, MeshWall, Overlap, SolidWall, Sphere, SphereKernel, Wall, WallShape,
};
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::{TetMesh, Vector3 as Vector};

fn kernel() -> SphereKernel {
    SphereKernel::new(1.0).unwrap()
}

fn close(name: &str, x: f64, y: f64, size: f64) {
    assert!((x - y).abs() <= 1e-9 * size, "{name}: {x:e} {y:e}");
}

/// Both are the same contact, but for a stiffness that is limited in the parts of the field one by one: `one` has as
/// many parts or more. Returns whether the stiffness is the same, too.
fn check_same(one: &Overlap, other: &Overlap, radius: f64) -> bool {
    let force = other.force.norm();
    close("energy", one.energy, other.energy, force * radius);
    close("volume", one.volume, other.volume, radius.powi(3));
    close("area", one.area, other.area, radius * radius);
    let (k, r) = (other.foundation.stiffness, radius);
    let more = one.foundation.stiffness - k;
    assert!(more > -1e-9 * (k + force / r), "stiffness {k:e}, {more:e}");
    let same = more < 1e-9 * (k + force / r);
    // Next to none is left of a stiffness that cancels.
    if same && k > 1e-3 * force / r {
        let (polar, wanted) = (one.foundation.polar(), other.foundation.polar());
        close("polar", polar, wanted, (k + force / r) * r * r);
        close("torsion", one.torsion_radius, other.torsion_radius, r);
    }
    for i in 0..3 {
        close("force", one.force[i], other.force[i], force);
        close("arm A", one.arm_a[i], other.arm_a[i], r);
        close("arm B", one.arm_b[i], other.arm_b[i], r);
    }
    same
}

#[test]
fn a_block_is_a_plane_and_a_step_is_an_edge() {
    let mut stream = Stream(7);
    let slab = SolidWall::solid(&block(
        Vector::new(-4.0, -5.0, -3.0),
        Vector::new(4.0, 4.0, 0.0),
        5,
    ));
    let floor = Wall::half_space("floor", Vector::z(), 0.0).unwrap();
    let ball = Sphere::new(0.7).unwrap();
    let mut patches = 0;
    for depth in [1e-5, 1e-3, 0.05, 0.3, 0.69, 0.9, 1.3] {
        for _ in 0..5 {
            let frame = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            let mut local = stream.vector();
            local.z = 0.7 - depth;
            let centre = frame.point(&local);
            let found = kernel().evaluate_solid_wall(&slab, &frame, &ball, &centre);
            let plane = kernel().evaluate_wall(&floor, &frame, &ball, &centre);
            assert_eq!(found.len(), 1);
            assert!(check_same(&found[0].overlap, &plane.unwrap(), 0.7));
            patches += 1;
        }
    }
    assert_eq!(patches, 35);
}

/// A convex body as tetrahedra about its centroid, whole and refined: facets, edges, vertices, and balls inside.
#[test]
fn a_convex_body_of_tetrahedra_is_the_convex_body() {
    let mut stream = Stream(2);
    let (mut touching, mut same) = (0, 0);
    for (name, solid, shape) in solids() {
        let fan = TetMesh::centroid_fan(&solid).unwrap();
        let centroid = solid.mass_properties().centroid.coords;
        for mesh in [fan.clone(), fan.refined().unwrap()] {
            let mesh = FieldMesh::new(&mesh, centroid, Field::Gauge).unwrap();
            for (radius, depth) in [
                (0.1, 0.03),
                (0.5, 0.02),
                (2.0, 0.01),
                (0.3, 0.5),
                (0.2, 1.6),
            ] {
                let ball = Sphere::new(radius).unwrap();
                let frame = Frame {
                    position: stream.vector(),
                    rotation: stream.rotation(),
                };
                let direction = stream.vector().normalize();
                let skin = direction * (1.0 / (1.0 - shape.field(&direction)));
                let local = skin + direction * (radius * (1.0 - 2.0 * depth));
                let centre = frame.point(&local);
                let found = kernel().evaluate_mesh(&mesh, &frame, &ball, &centre);
                let convex = kernel().evaluate_convex(&shape, &frame, &ball, &centre);
                assert_eq!(found.len(), usize::from(convex.is_some()), "{name}");
                if let (Some(found), Some(convex)) = (found.first(), convex) {
                    same += usize::from(check_same(&found.overlap, &convex, radius));
                    touching += 1;
                }
            }
        }
    }
    assert!(touching > 150 && same > 100, "{touching} {same}");
}

fn energy(patches: &[Patch]) -> f64 {
    patches.iter().map(|patch| patch.overlap.energy).sum()
}

fn force(patches: &[Patch]) -> Vector3<f64> {
    patches.iter().map(|patch| patch.overlap.force).sum()
}

/// The force and the torque of all patches against differences of their energy.
fn check_gradient(
    evaluate: impl Fn(&Frame, &Vector3<f64>) -> Vec<Patch>,
    frame: &Frame,
    at: &Vector3<f64>,
) {
    let here = evaluate(frame, at);
    let scale: f64 = here.iter().map(|p| p.overlap.force.norm()).sum();
    let step = 2e-6;
    for k in 0..3 {
        let mut axis = Vector3::zeros();
        axis[k] = 1.0;
        let [up, down] = [step, -step].map(|by| energy(&evaluate(frame, &(at + axis * by))));
        let slope = (up - down) / (2.0 * step);
        let along = force(&here)[k];
        assert!(
            (along + slope).abs() < 1e-5 * scale + 1e-9,
            "{along} {slope} along {k}"
        );
        // The vector area is the gradient of the volume.
        let volume = |by: f64| -> f64 {
            let patches = evaluate(frame, &(at + axis * by));
            patches.iter().map(|patch| patch.overlap.volume).sum()
        };
        let slope = (volume(step) - volume(-step)) / (2.0 * step);
        let area: f64 = here.iter().map(|p| p.touching.area[k]).sum();
        assert!(
            (area - slope).abs() < 1e-5 * area.abs() + 1e-8,
            "{area} {slope} along {k}"
        );
        let turn = |by: f64| energy(&evaluate(&turned(frame, &axis, by), at));
        let slope = (turn(step) - turn(-step)) / (2.0 * step);
        let torque: f64 = here.iter().map(|p| p.overlap.torque_a()[k]).sum();
        assert!(
            (torque + slope).abs() < 1e-5 * scale + 1e-9,
            "{torque} {slope} about {k}"
        );
    }
}

/// Balls of several sizes at random against a dolos and a ring, as walls and as bodies.
#[test]
fn forces_are_gradients_of_the_energy() {
    let mut stream = Stream(13);
    let (mut touching, mut several) = (0, 0);
    for mesh in [dolos(0.4), ring(0.5, 0.15, 12, 6)] {
        let wall = SolidWall::solid(&mesh);
        let body = FieldMesh::new(&mesh, Vector::zeros(), Field::Body).unwrap();
        for case in 0..160 {
            let ball = Sphere::new([0.08, 0.2, 0.37, 0.6][case % 4]).unwrap();
            let frame = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            let centre = frame.point(&(stream.vector() * 1.6));
            let of_wall = |frame: &Frame, x: &Vector3<f64>| {
                kernel().evaluate_solid_wall(&wall, frame, &ball, x)
            };
            let of_body =
                |frame: &Frame, x: &Vector3<f64>| kernel().evaluate_mesh(&body, frame, &ball, x);
            let found = of_body(&frame, &centre);
            touching += usize::from(!found.is_empty());
            several += usize::from(found.len() > 1);
            check_gradient(of_wall, &frame, &centre);
            check_gradient(of_body, &frame, &centre);
        }
    }
    assert!(touching > 100 && several > 3, "{touching} {several}");
}

/// In a channel a ball touches both sides, each in a patch with its own normal, and on its floor in a third.
#[test]
fn sides_of_a_channel_are_patches_of_their_own() {
    let cells = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 1], [2, 0, 1]];
    let channel = boxes(
        &cells,
        &[-2.0, -0.69, 0.69, 2.0],
        &[-3.0, 3.0],
        &[-1.0, 0.0, 2.0],
    );
    let wall = SolidWall::solid(&channel);
    let ball = Sphere::new(0.7).unwrap();
    let at = |x: f64, z: f64| {
        let centre = Vector::new(x, 0.2, z);
        kernel().evaluate_solid_wall(&wall, &Frame::identity(), &ball, &centre)
    };
    assert_eq!(at(0.0, 0.705).len(), 2);
    let three = at(0.005, 0.695);
    assert_eq!(three.len(), 3);
    let floor = Wall::half_space("floor", Vector::z(), 0.0).unwrap();
    let frame = Frame::identity();
    let plane = |depth: f64| {
        let centre = Vector::z() * (0.7 - depth);
        let found = kernel().evaluate_wall(&floor, &frame, &ball, &centre);
        found.unwrap().force.norm()
    };
    let mut forces: Vec<f64> = three.iter().map(|p| p.overlap.force.norm()).collect();
    forces.sort_by(f64::total_cmp);
    let mut wanted = [plane(0.005), plane(0.005), plane(0.015)];
    wanted.sort_by(f64::total_cmp);
    for (x, y) in forces.iter().zip(wanted) {
        close("force", *x, y, y);
    }
    for patch in &three {
        let along = patch.overlap.normal.abs().max();
        close("normal", along, 1.0, 1.0);
    }
}

/// In front of a leaning slab the clearance is the distance from its plane; nowhere is it more than the distance from
/// the nearest corner, and in the slab it is none.
#[test]
fn the_clearance_of_a_leaning_slab_is_that_of_its_plane() {
    let mut stream = Stream(3);
    let slab = block(Vector::new(-1.0, -1.0, -0.2), Vector::new(1.0, 1.0, 0.0), 3);
    let turn = stream.rotation();
    let points = slab.points().iter().map(|p| turn * p.coords);
    let points: Vec<Vector> = points.collect();
    let leaning = points.iter().map(|p| (*p).into()).collect();
    let leaning = TetMesh::new(leaning, slab.tets().to_vec()).unwrap();
    let wall = WallShape::from(MeshWall::solid("slab", &leaning));
    for _ in 0..50 {
        let x = stream.vector() * 1.5;
        let above = Vector::new(x.x, x.y, x.z.abs());
        let found = wall.clearance(&(turn * above));
        assert!((found - above.z).abs() < 1e-12, "{found} {above:?}");
        let far = x * 4.0;
        let corner = points.iter().map(|p| (p - turn * far).norm());
        let corner = corner.fold(f64::INFINITY, f64::min);
        let found = wall.clearance(&(turn * far));
        assert!((0.0..=corner).contains(&found), "{found} {corner}");
        let inside = Vector::new(x.x, x.y, -0.2 * stream.unit());
        assert!(wall.clearance(&(turn * inside)) < 1e-12);
    }
}
