//! Meshes made of cubes, for bodies of any shape, and differences of energies.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "every test file uses its own part, and helpers of tests fail the test"
)]

use femdem_contact::general::Patch;
use femdem_contact::{Field, FieldMesh, Frame};
use femdem_mesh::nalgebra::{UnitQuaternion, Vector3};
use femdem_mesh::{Point3, TetMesh};
use std::collections::BTreeMap;

/// The six tetrahedra of a cube, each a path from corner 0 to corner 7 along the axes.
const KUHN: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [2, 1, 0],
    [1, 0, 2],
];

/// A mesh of unit cubes at the given places, scaled by `size`. Neighbouring cubes fit.
pub fn cubes(places: &[[i32; 3]], size: f64) -> TetMesh {
    let mut index = BTreeMap::new();
    let mut points = Vec::new();
    let mut tets = Vec::new();
    for place in places {
        for path in KUHN {
            let mut at = *place;
            let mut tet = vec![at];
            for axis in path {
                at[axis] += 1;
                tet.push(at);
            }
            let mut tet: Vec<u32> = tet
                .into_iter()
                .map(|p| {
                    *index.entry(p).or_insert_with(|| {
                        points.push(Point3::from(Vector3::from(p.map(f64::from)) * size));
                        points.len() as u32 - 1
                    })
                })
                .collect();
            let x = |k: usize| points[tet[k] as usize];
            let volume = (x(1) - x(0)).dot(&(x(2) - x(0)).cross(&(x(3) - x(0))));
            if volume < 0.0 {
                tet.swap(2, 3);
            }
            tets.push([tet[0], tet[1], tet[2], tet[3]]);
        }
    }
    TetMesh::new(points, tets).unwrap()
}

/// All cells of a block for which `keep` holds.
pub fn block(size: [i32; 3], keep: impl Fn([i32; 3]) -> bool) -> Vec<[i32; 3]> {
    let mut places = Vec::new();
    for x in 0..size[0] {
        for y in 0..size[1] {
            for z in 0..size[2] {
                if keep([x, y, z]) {
                    places.push([x, y, z]);
                }
            }
        }
    }
    places
}

/// A cube of side 1 of n^3 smaller ones.
pub fn cube(n: i32) -> TetMesh {
    cubes(&block([n; 3], |_| true), 1.0 / f64::from(n))
}

/// An L of three cubes of side 1/2 by 2 deep.
pub fn l_block() -> TetMesh {
    cubes(&block([4, 4, 2], |[x, y, _]| x < 2 || y < 2), 0.25)
}

/// A square tube: a ring of eight columns around a hole.
pub fn tube() -> TetMesh {
    cubes(&block([3, 3, 2], |[x, y, _]| (x, y) != (1, 1)), 0.3)
}

/// Two crossed bars at the ends of a shank, like a dolos.
pub fn dolos() -> TetMesh {
    let keep = |[x, y, z]: [i32; 3]| match z {
        0 => y == 2,
        4 => x == 2,
        _ => x == 2 && y == 2,
    };
    cubes(&block([5, 5, 5], keep), 0.2)
}

pub fn body(mesh: &TetMesh, field: Field) -> FieldMesh {
    let centroid = mesh.mass_properties().centroid.coords;
    FieldMesh::new(mesh, centroid, field).unwrap()
}

/// Sums over patches.
#[derive(Debug, Default, Clone, Copy)]
pub struct Total {
    pub energy: f64,
    pub volume: f64,
    pub force: Vector3<f64>,
    pub torque_a: Vector3<f64>,
    pub torque_b: Vector3<f64>,
}

pub fn total(patches: &[Patch]) -> Total {
    let mut all = Total::default();
    for Patch { overlap, .. } in patches {
        all.energy += overlap.energy;
        all.volume += overlap.volume;
        all.force += overlap.force;
        all.torque_a += overlap.torque_a();
        all.torque_b += overlap.torque_b();
    }
    all
}

/// A frame moved by `s` along axis `k` (0 to 2) or turned by it about axis `k` - 3.
pub fn nudged(frame: &Frame, k: usize, s: f64) -> Frame {
    let mut e = Vector3::zeros();
    e[k % 3] = s;
    let mut moved = *frame;
    if k < 3 {
        moved.position += e;
    } else {
        let turn = UnitQuaternion::from_scaled_axis(e).to_rotation_matrix();
        moved.rotation = turn.into_inner() * frame.rotation;
    }
    moved
}

/// Minus the gradient of an energy: force and torque, by differences of fourth order.
pub fn differences(energy: impl Fn(&Frame) -> f64, frame: &Frame, h: f64) -> [Vector3<f64>; 2] {
    let slope = |k: usize| {
        let at = |s: f64| energy(&nudged(frame, k, s));
        -(8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    };
    [
        Vector3::new(slope(0), slope(1), slope(2)),
        Vector3::new(slope(3), slope(4), slope(5)),
    ]
}
