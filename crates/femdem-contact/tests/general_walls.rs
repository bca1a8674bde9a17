//! Walls of tetrahedra against analytic ones and against differences of their energy.

use crate::common::tets;
use crate::common::{Stream, solids};
use femdem_contact::general::GeneralScratch;
use femdem_contact::kernel::{CavityKernel, Scratch};
use femdem_contact::{ContactError, Field, FieldMesh, Frame, GeneralKernel, SolidWall, Wall};
use femdem_mesh::nalgebra::{Point3, Vector3};
use std::cell::RefCell;

const PENALTY: f64 = 3.0;

/// A flat sheet of 2 n^2 triangles, 6 m wide, facing up.
fn flat(n: u32) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let at = |i: u32| f64::from(i) / f64::from(n) * 6.0 - 3.1;
    let points = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| Point3::new(at(i), at(j), 0.0)))
        .collect();
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let p = |a: u32, b: u32| (i + a) * (n + 1) + j + b;
            triangles.push([p(0, 0), p(1, 0), p(1, 1)]);
            triangles.push([p(1, 1), p(0, 1), p(0, 0)]);
        }
    }
    (points, triangles)
}

#[test]
fn a_plane_is_the_same_wall_as_a_mesh() {
    let analytic = CavityKernel::new(PENALTY).unwrap();
    let general = GeneralKernel::new(PENALTY).unwrap();
    let plane = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    let (points, triangles) = flat(3);
    let mesh = SolidWall::sheet(&points, &triangles, 2.0).unwrap();
    let (mut scratch, mut buffers) = (Scratch::default(), GeneralScratch::default());
    let mut stream = Stream(31);
    let mut touching = 0;
    for (name, polyhedron, shape) in solids() {
        let body = FieldMesh::from_convex(&polyhedron).unwrap();
        for tried in 0..4 {
            let mut frame_wall = Frame::identity();
            frame_wall.position = stream.vector() * 10.0;
            frame_wall.rotation = stream.rotation();
            let turn = if tried == 0 {
                Frame::identity().rotation
            } else {
                stream.rotation()
            };
            let reach = shape.support(&-turn.tr_mul(&Vector3::z()));
            let place = Vector3::new(
                stream.unit() - 0.5,
                stream.unit() - 0.5,
                reach * (0.4 + 0.59 * stream.unit()),
            );
            let frame = Frame {
                position: frame_wall.point(&place),
                rotation: frame_wall.rotation * turn,
            };
            let want = analytic
                .evaluate(&plane, &frame_wall, &shape, &frame, &mut scratch)
                .unwrap();
            let got = general.evaluate_wall(&mesh, &frame_wall, &body, &frame, &mut buffers);
            let [got] = got else {
                panic!("{name}: {} patches", got.len());
            };
            let got = got.overlap;
            touching += 1;
            let f = want.force.norm();
            let near = |got: f64, want: f64, scale: f64, what: &str| {
                let off = (got - want).abs() / scale;
                assert!(off < 1e-10, "{name}, {what}: off by {off:e}");
            };
            near((got.force - want.force).norm(), 0.0, f, "force");
            near((got.torque_b() - want.torque_b()).norm(), 0.0, f, "torque");
            near((got.arm_a - want.arm_a).norm(), 0.0, 1.0, "arm of the wall");
            near((got.arm_b - want.arm_b).norm(), 0.0, 1.0, "arm of the body");
            near(got.energy, want.energy, PENALTY * want.volume, "energy");
            near(got.volume, want.volume, want.volume, "volume");
            near(got.area, want.area, want.area, "area");
            near(
                got.foundation.stiffness,
                want.foundation.stiffness,
                want.foundation.stiffness,
                "stiffness",
            );
            near(
                got.foundation.polar(),
                want.foundation.polar(),
                want.foundation.stiffness,
                "second moment",
            );
            near(got.torsion_radius, want.torsion_radius, 1.0, "radius");
        }
    }
    assert!(touching > 50);
}

#[test]
fn wrenches_of_walls_are_gradients() {
    let mut stream = Stream(37);
    let wall = SolidWall::solid(&tets::l_block());
    let mut touching = 0;
    let meshes = [tets::cube(1), tets::cube(2), tets::dolos(), tets::tube()];
    for mesh in meshes.iter().cycle().take(24) {
        let body = tets::body(mesh, Field::Body);
        let kernel = GeneralKernel::new(PENALTY).unwrap();
        let frame_wall = Frame {
            position: stream.vector(),
            rotation: stream.rotation(),
        };
        let frame = Frame {
            position: frame_wall.position + stream.vector(),
            rotation: stream.rotation(),
        };
        let scratch = RefCell::new(GeneralScratch::default());
        let at = |f: &Frame| {
            let mut scratch = scratch.borrow_mut();
            tets::total(kernel.evaluate_wall(&wall, &frame_wall, &body, f, &mut scratch))
        };
        let got = at(&frame);
        if got.energy == 0.0 {
            continue;
        }
        touching += 1;
        let [force, torque] = tets::differences(|f| at(f).energy, &frame, 1e-5);
        let error = (got.force - force)
            .norm()
            .max((got.torque_b - torque).norm());
        assert!(error < 1e-7 * got.force.norm() + 1e-12, "{error:e}");
    }
    assert!(touching > 12, "{touching}");
}

/// A groove, of either curvature, holds a body as two planes do.
#[test]
fn a_bent_sheet_is_a_wall_of_its_shape() {
    let at = [[-2.0, 2.0], [0.0, 0.0], [2.0, 2.0], [4.0, 0.0]];
    let points: Vec<Point3<f64>> = at
        .iter()
        .flat_map(|p| [-3.0, 3.0].map(|y| Point3::new(p[0], y, p[1])))
        .collect();
    let triangles = [
        [0, 2, 3],
        [0, 3, 1],
        [2, 4, 5],
        [2, 5, 3],
        [4, 6, 7],
        [4, 7, 5],
    ];
    let wall = SolidWall::sheet(&points, &triangles, 0.5).unwrap();
    let body = tets::body(&tets::cube(2), Field::Body);
    let kernel = GeneralKernel::new(PENALTY).unwrap();
    let mut scratch = GeneralScratch::default();
    let mut frame = Frame::identity();
    frame.position.z = 1.1;
    let total =
        tets::total(kernel.evaluate_wall(&wall, &Frame::identity(), &body, &frame, &mut scratch));
    // Two edges at x = -0.5 and 0.5, z = 0.6 would meet z = |x| + 0.1; the cube's bottom is at
    // 0.6 where the groove is 1.2 wide: apart.
    assert_eq!(total.volume, 0.0);
    frame.position.z = 0.9;
    let patches = kernel.evaluate_wall(&wall, &Frame::identity(), &body, &frame, &mut scratch);
    // Each lower edge is a wedge of legs 0.1, 1 m long, in its side of the groove.
    assert_eq!(patches.len(), 2);
    for patch in patches {
        assert!((patch.overlap.volume - 0.005).abs() < 1e-13);
        let slope = patch.overlap.normal.x.abs() / patch.overlap.normal.z;
        assert!((slope - 1.0).abs() < 1e-9, "{slope}");
    }
}

#[test]
fn bad_sheets_are_refused() {
    let (points, triangles) = flat(2);
    let message = |result: Result<SolidWall, ContactError>| result.unwrap_err().to_string();
    assert!(message(SolidWall::sheet(&points, &triangles, 0.0)).contains("thickness"));
    assert!(message(SolidWall::sheet(&points, &triangles, f64::NAN)).contains("thickness"));
    assert!(message(SolidWall::sheet(&points, &[[0, 1, 99]], 1.0)).contains("does not exist"));
    assert!(message(SolidWall::sheet(&points, &[[0, 0, 1]], 1.0)).contains("no area"));
    assert!(message(SolidWall::sheet(&points, &triangles[..1], 1.0)).contains("no triangles"));
    let mut flipped = triangles.clone();
    flipped[0].swap(0, 1);
    assert!(SolidWall::sheet(&points, &flipped, 1.0).is_err());
}
