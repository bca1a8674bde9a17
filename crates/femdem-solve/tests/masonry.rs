//! Bodies set exactly face to face: nothing is stored where nothing overlaps, and an arch stands as long as a line of
//! thrust fits into it.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{G, add_floor, parameters, pose, run_until};
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::{Point3, Polyhedron, Rotation};
use femdem_solve::{BodySpec, Drive, World};
use std::f64::consts::{FRAC_PI_2, PI};

const VOUSSOIRS: u32 = 24;
const DEPTH: f64 = 0.4;
const PENALTY: f64 = 1e9;
const DENSITY: f64 = 2000.0;

/// A semicircular arch of mean radius 1 m on a floor.
fn arch(thickness: f64) -> World {
    let half = 0.5 * PI / f64::from(VOUSSOIRS);
    let corner = |r: f64, side: f64, y: f64| Point3::new(side * r * half.sin(), y, r * half.cos());
    let radii = [1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness];
    let mut corners = Vec::new();
    for y in [-0.5 * DEPTH, 0.5 * DEPTH] {
        for (r, side) in [(0, -1.0), (0, 1.0), (1, 1.0), (1, -1.0)] {
            corners.push(corner(radii[r], side, y));
        }
    }
    let faces = [
        [1, 2, 3, 0],
        [7, 6, 5, 4],
        [4, 5, 1, 0],
        [5, 6, 2, 1],
        [6, 7, 3, 2],
        [7, 4, 0, 3],
    ];
    let body = Polyhedron::new(corners, faces.map(|f| f.to_vec()).to_vec()).unwrap();
    let mut world = World::new(parameters(PENALTY, 1.0, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("voussoir", &body).unwrap();
    for k in 0..VOUSSOIRS {
        let angle = -FRAC_PI_2 + (2.0 * f64::from(k) + 1.0) * half;
        let turn = Rotation::from_axis_angle(&Vector3::y_axis(), angle);
        let spec = BodySpec::at_rest(shape, DENSITY, pose(Vector3::zeros(), turn));
        world.add_body(spec).unwrap();
    }
    world
}

fn crown(world: &World) -> f64 {
    world.position(VOUSSOIRS / 2).unwrap().z
}

#[test]
fn an_arch_set_face_to_face_stores_nothing() {
    let mut world = arch(0.12);
    world.step().unwrap();
    let books = world.ledger();
    // 1e-12 p r^3, with r = 0.2 m.
    let round_off = 1e-12 * PENALTY * 0.2_f64.powi(3) * f64::from(VOUSSOIRS);
    // Gravity has acted for one step.
    assert!(books.elastic < round_off + books.kinetic, "{books:?}");
    for contact in world.contacts() {
        let depth = contact.penetration();
        assert!(depth < 1e-9 + G * world.time().powi(2), "{depth}");
    }
}

/// The least thickness of a semicircular arch is 0.1075 of its radius (Milankovitch 1907; Cocchetti, Colasante and
/// Rizzi 2011, Appl. Mech. Rev. 64, 050802).
#[test]
fn an_arch_stands_on_its_line_of_thrust() {
    for (thickness, stands) in [(0.12, true), (0.10, false)] {
        let mut world = arch(thickness);
        let before = crown(&world);
        run_until(&mut world, 1.5);
        let sunk = before - crown(&world);
        assert_eq!(sunk < 0.01, stands, "{thickness}: sunk by {sunk} m");
    }
}
