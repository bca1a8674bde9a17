//! Faces that coincide: bodies set face to face by hand, where round-off decides on which side of which face a face
//! lies. Energy, volume, area, centre and penetration are right to round-off of the body, as the force is.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Stream, oracle, tets, wall_oracle};
use femdem_contact::general::GeneralScratch;
use femdem_contact::kernel::{CavityKernel, Scratch};
use femdem_contact::{
    ConvexShape, Field, Frame, GeneralKernel, Overlap, PairKernel, SolidWall, Wall, WallPlane,
};
use femdem_mesh::nalgebra::{Point3, Vector3};
use femdem_mesh::{Polyhedron, TetMesh};

const PENALTY: f64 = 1.0;

/// Bodies are about 1 m large.
const ROUNDING: f64 = 1e-12;

fn brick(sides: [f64; 3]) -> Polyhedron {
    let corner = |i: usize| {
        let at = |axis: usize| sides[axis] * if i >> axis & 1 == 1 { 0.5 } else { -0.5 };
        Point3::new(at(0), at(1), at(2))
    };
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let faces = faces.iter().map(|f| f.to_vec()).collect();
    Polyhedron::new((0..8).map(corner).collect(), faces).unwrap()
}

/// A pose of both, turned and moved together.
fn together(stream: &mut Stream, between: Vector3<f64>, first: bool) -> [Frame; 2] {
    let mut a = Frame::identity();
    // Axis-parallel at the origin, and anywhere.
    if !first {
        a.rotation = stream.rotation();
        a.position = stream.vector() * 3.0;
    }
    let b = Frame {
        position: a.position + a.rotation * between,
        rotation: a.rotation,
    };
    [a, b]
}

/// What is right: the overlap is a plate of an area, a thickness, and a centre from A's origin in its axes.
struct Plate {
    area: f64,
    depth: f64,
    /// Not known where the field of a mesh depends on its cells.
    centre: Option<Vector3<f64>>,
    energy: f64,
    volume: f64,
}

fn check(what: &str, got: Option<&Overlap>, frame_a: &Frame, right: &Plate) {
    let Some(got) = got else {
        // Nothing but round-off.
        assert!(right.depth.abs() < 1e-13, "{what}: missed");
        return;
    };
    let near = |name: &str, got: f64, want: f64, scale: f64| {
        assert!(
            (got - want).abs() < scale,
            "{what} {name}: {got:e} for {want:e}"
        );
    };
    near("energy", got.energy, right.energy, ROUNDING);
    near("volume", got.volume, right.volume, ROUNDING);
    let depth = right.depth.max(0.0);
    near(
        "penetration",
        got.penetration(),
        depth,
        ROUNDING + 1e-3 * depth,
    );
    if right.depth > 1e-13 {
        // The normal of a small force has few digits.
        let tilt = 1e-16 / depth;
        near(
            "area",
            got.area,
            right.area,
            ROUNDING + 10.0 * (depth + tilt),
        );
        if let Some(centre) = right.centre {
            let off = got.arm_a - frame_a.rotation * centre;
            let digits = ROUNDING + 10.0 * tilt + 3.0 * depth;
            assert!(off.norm() < digits, "{what} centre: {off} of {digits:e}");
        }
    }
}

/// Depths from a gap to a real contact; the smallest are round-off.
const DEPTHS: [f64; 8] = [-1e-16, 0.0, 1e-16, 1e-14, 1e-11, 1e-8, 1e-5, 1e-3];

/// Sides of A and of B, and the offset of B beside A: in line, offset, half bond, and a small brick flush with two
/// sides of a large one.
const SETS: [([f64; 3], [f64; 3], [f64; 2]); 5] = [
    ([1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [0.0, 0.0]),
    ([1.0, 0.5, 0.3], [1.0, 0.5, 0.3], [0.0, 0.0]),
    ([1.0, 0.5, 0.3], [1.0, 0.5, 0.3], [0.5, 0.0]),
    ([1.0, 0.5, 0.3], [1.0, 0.5, 0.3], [0.13, -0.21]),
    ([1.0, 0.8, 0.3], [0.25, 0.2, 0.6], [0.375, 0.3]),
];

/// A plate between two bricks, one on the other along z.
fn plate(a: [f64; 3], b: [f64; 3], beside: [f64; 2], depth: f64, sums: [f64; 2]) -> Plate {
    let span = |axis: usize| {
        let low = (-0.5 * a[axis]).max(beside[axis] - 0.5 * b[axis]);
        let high = (0.5 * a[axis]).min(beside[axis] + 0.5 * b[axis]);
        (high - low, 0.5 * (low + high))
    };
    let ((dx, x), (dy, y)) = (span(0), span(1));
    Plate {
        area: dx * dy,
        depth,
        centre: Some(Vector3::new(x, y, 0.5 * a[2])),
        energy: PENALTY * sums[1],
        volume: sums[0],
    }
}

#[test]
fn bricks_on_bricks() {
    let kernel = PairKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(3);
    for (of_a, of_b, beside) in SETS {
        let (pa, pb) = (brick(of_a), brick(of_b));
        let (a, b) = (
            ConvexShape::new(&pa).unwrap(),
            ConvexShape::new(&pb).unwrap(),
        );
        for depth in DEPTHS {
            for turn in 0..20 {
                let up = 0.5 * (of_a[2] + of_b[2]) - depth;
                let between = Vector3::new(beside[0], beside[1], up);
                let [fa, fb] = together(&mut stream, between, turn == 0);
                let (volume, integral) = oracle(&pa, &fa, &pb, &fb);
                let right = plate(of_a, of_b, beside, depth, [volume, integral]);
                let what = format!("{of_a:?} {of_b:?} {beside:?} {depth:e} {turn}");
                let got = kernel.evaluate(&a, &fa, &b, &fb, &mut scratch);
                check(&what, got.as_ref(), &fa, &right);
            }
        }
    }
}

#[test]
fn bricks_in_a_corner_of_walls() {
    let kernel = CavityKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(4);
    let sides = [1.0, 0.5, 0.3];
    let body = brick(sides);
    let shape = ConvexShape::new(&body).unwrap();
    let wall = Wall::new(
        "corner",
        (0..3)
            .map(|k| WallPlane {
                normal: Vector3::ith(k, 1.0),
                offset: 0.0,
            })
            .collect(),
    )
    .unwrap();
    for depth in DEPTHS {
        for turn in 0..20 {
            // Flush with two of the walls, and as deep as is said in the third.
            let between = Vector3::new(0.5, 0.25, 0.15 - depth);
            let [fa, fb] = together(&mut stream, between, turn == 0);
            let planes: Vec<_> = (0..3)
                .map(|k| {
                    let n = fa.rotation.column(k).into_owned();
                    (n, n.dot(&fa.position))
                })
                .collect();
            let (volume, integral) = wall_oracle(&body, &fb, &planes);
            let right = Plate {
                area: 0.5,
                depth,
                centre: Some(Vector3::new(0.5, 0.25, 0.0)),
                energy: 2.0 * PENALTY * integral,
                volume,
            };
            let got = kernel.evaluate(&wall, &fa, &shape, &fb, &mut scratch);
            check(&format!("{depth:e} {turn}"), got.as_ref(), &fa, &right);
        }
    }
}

/// The same bricks as meshes of 3 x 3 x 3 cells, against each other and on a mesh that is a wall.
#[test]
fn meshes_of_bricks() {
    let kernel = GeneralKernel::new(PENALTY).unwrap();
    let mut scratch = GeneralScratch::default();
    let mut stream = Stream(5);
    let mesh = |sides: [f64; 3]| -> TetMesh {
        let cube = tets::cube(3);
        let place = |p: &Point3<f64>| {
            let x = p.coords - Vector3::repeat(0.5);
            Point3::from(x.component_mul(&Vector3::from(sides)))
        };
        let points = cube.points().iter().map(place).collect();
        TetMesh::new(points, cube.tets().to_vec()).unwrap()
    };
    for (of_a, of_b, beside) in SETS {
        let (ma, mb) = (mesh(of_a), mesh(of_b));
        let (a, b) = (tets::body(&ma, Field::Body), tets::body(&mb, Field::Body));
        let wall = SolidWall::solid(&ma);
        for depth in DEPTHS {
            for turn in 0..6 {
                let up = 0.5 * (of_a[2] + of_b[2]) - depth;
                let between = Vector3::new(beside[0], beside[1], up);
                let [fa, fb] = together(&mut stream, between, turn == 0);
                let mut right = plate(of_a, of_b, beside, depth, [0.0; 2]);
                right.volume = right.area * depth.max(0.0);
                if of_a != of_b {
                    right.centre = None;
                }
                let what = format!("{of_a:?} {of_b:?} {beside:?} {depth:e} {turn}");
                for solid in [false, true] {
                    let patches = if solid {
                        kernel.evaluate_wall(&wall, &fa, &b, &fb, &mut scratch)
                    } else {
                        kernel.evaluate(&a, &fa, &b, &fb, &mut scratch)
                    };
                    let total = tets::total(patches);
                    // At most the energy of a plate in fields that begin at the face alone.
                    let lengths = if solid {
                        [0.0, b.inradius().recip()]
                    } else {
                        [a.inradius(), b.inradius()].map(f64::recip)
                    };
                    let factor = if solid { 2.0 } else { 1.0 };
                    let most =
                        factor * 0.5 * right.area * depth * depth * (lengths[0] + lengths[1]);
                    assert!(
                        total.energy <= most * (1.0 + 1e-9) + ROUNDING,
                        "{what} {solid}: {:e} of {most:e}",
                        total.energy
                    );
                    if let [patch] = patches {
                        right.energy = total.energy;
                        check(&what, Some(&patch.overlap), &fa, &right);
                    } else {
                        assert!(total.volume < ROUNDING, "{what}: {} patches", patches.len());
                    }
                }
            }
        }
    }
}
