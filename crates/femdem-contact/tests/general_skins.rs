//! The sums of rigid meshes over skins against those over common parts of tetrahedra: the same patches, and the same
//! numbers of each.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::meshes;
use crate::common::tets::{self, cube, dolos, l_block, tube};
use crate::common::{Stream, solids};
use femdem_contact::general::{GeneralScratch, Patch};
use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel, SolidWall};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use femdem_mesh::{Point3, TetMesh};

const PENALTY: f64 = 3.0;

/// Both ways, skins first.
struct Both {
    kernel: GeneralKernel,
    scratch: GeneralScratch,
    /// Whether the patches have the same keys.
    keys: bool,
    /// Pairs with that many patches.
    seen: [usize; 4],
}

impl Both {
    fn new() -> Self {
        Self {
            kernel: GeneralKernel::new(PENALTY).unwrap(),
            scratch: GeneralScratch::default(),
            keys: true,
            seen: [0; 4],
        }
    }

    fn bodies(&mut self, what: &str, a: &FieldMesh, fa: &Frame, b: &FieldMesh, fb: &Frame) {
        let Self {
            kernel, scratch, ..
        } = self;
        let skins = kernel.evaluate(a, fa, b, fb, scratch).to_vec();
        let pieces = kernel.evaluate_pieces(a, fa, b, fb, scratch).to_vec();
        self.compare(what, &skins, &pieces);
    }

    fn wall(&mut self, what: &str, a: &SolidWall, fa: &Frame, b: &FieldMesh, fb: &Frame) {
        let Self {
            kernel, scratch, ..
        } = self;
        let skins = kernel.evaluate_wall(a, fa, b, fb, scratch).to_vec();
        let pieces = kernel.evaluate_wall_pieces(a, fa, b, fb, scratch).to_vec();
        self.compare(what, &skins, &pieces);
    }

    fn compare(&mut self, what: &str, skins: &[Patch], pieces: &[Patch]) {
        // Where nothing but round-off overlaps, either way may see it.
        let real = |list: &[Patch]| -> Vec<Patch> {
            let all = list.iter().copied();
            all.filter(|p| p.overlap.volume > 1e-13).collect()
        };
        let (skins, pieces) = (real(skins), real(pieces));
        assert_eq!(skins.len(), pieces.len(), "{what}");
        if self.keys {
            let keys = |list: &[Patch]| list.iter().map(|p| p.key).collect::<Vec<_>>();
            assert_eq!(keys(&skins), keys(&pieces), "{what}");
        }
        self.seen[skins.len().min(3)] += 1;
        for (x, y) in skins.iter().zip(&pieces) {
            let (x, y) = (&x.overlap, &y.overlap);
            // The forces of all sides of an overlap may cancel, and slight ones have few digits.
            let force = y.force.norm().max(y.energy);
            let digits = 1e-11 + 1e-14 / (y.volume / y.area.max(y.volume));
            let stiffness = y.foundation.stiffness.max(force);
            for (name, off) in [
                ("force", (x.force - y.force).norm() / force),
                ("torque on A", (x.torque_a() - y.torque_a()).norm() / force),
                ("torque on B", (x.torque_b() - y.torque_b()).norm() / force),
                ("energy", (x.energy - y.energy).abs() / y.energy),
                ("volume", (x.volume - y.volume).abs() / y.volume),
                ("area", (x.area - y.area).abs()),
                ("centre", (x.arm_a - y.arm_a).norm()),
                (
                    "stiffness",
                    (x.foundation.stiffness - y.foundation.stiffness).abs() / stiffness,
                ),
                (
                    "polar",
                    (x.foundation.polar() - y.foundation.polar()).abs() / stiffness,
                ),
                ("radius", (x.torsion_radius - y.torsion_radius).abs()),
            ] {
                assert!(off < digits, "{what}, {name}: {off:e} of {digits:e}");
            }
        }
    }
}

fn beside(stream: &mut Stream, distance: f64) -> [Frame; 2] {
    let a = Frame {
        position: stream.vector() * 5.0,
        rotation: stream.rotation(),
    };
    let b = Frame {
        position: a.position + stream.vector().normalize() * distance,
        rotation: stream.rotation(),
    };
    [a, b]
}

fn bodies() -> Vec<(&'static str, FieldMesh)> {
    let of = |name, mesh: TetMesh| (name, tets::body(&mesh, Field::Body));
    vec![
        of("cube", cube(2)),
        of("L", l_block()),
        of("tube", tube()),
        of("dolos", dolos()),
        of("fine dolos", meshes::dolos(0.3)),
        of("ring", meshes::ring(0.5, 0.12, 9, 5)),
    ]
}

/// Random poses, from slight overlaps to ones in which nodes of one lie in the other: the same patches.
#[test]
fn skins_and_pieces_give_the_same_patches() {
    let mut stream = Stream(51);
    let mut both = Both::new();
    let all = bodies();
    for round in 0..24 {
        let distance = 0.05 + 0.045 * f64::from(round);
        for (i, (name, a)) in all.iter().enumerate() {
            for (other, b) in &all[i..] {
                let [fa, fb] = beside(&mut stream, distance);
                let what = format!("{name} {other} {distance}");
                both.bodies(&what, a, &fa, b, &fb);
            }
        }
    }
    // Apart, one patch, two, and more.
    assert!(both.seen.iter().all(|n| *n > 10), "{:?}", both.seen);
}

/// Fans of convex bodies, with long tetrahedra of very different sizes.
#[test]
fn skins_and_pieces_of_fans_agree() {
    let mut stream = Stream(52);
    let mut both = Both::new();
    let fans: Vec<(String, FieldMesh)> = solids()
        .into_iter()
        .map(|(name, polyhedron, _)| {
            (
                name.to_string(),
                FieldMesh::from_convex(&polyhedron).unwrap(),
            )
        })
        .collect();
    for (i, (name, a)) in fans.iter().enumerate() {
        let (other, b) = &fans[(i + 5) % fans.len()];
        for round in 0..6 {
            let distance = a.radius() * (0.4 + 0.25 * f64::from(round));
            let [fa, fb] = beside(&mut stream, distance);
            both.bodies(&format!("{name} {other} {round}"), a, &fa, b, &fb);
        }
    }
    assert!(both.seen[1] > 40, "{:?}", both.seen);
}

/// Solid walls of the same size and much larger, and sheets.
#[test]
fn skins_and_pieces_agree_at_walls() {
    let mut stream = Stream(53);
    let mut both = Both::new();
    let large = |size: f64| {
        let points = cube(1).points().to_vec();
        let points = points.iter().map(|p| Point3::from(p.coords * size));
        TetMesh::new(points.collect(), cube(1).tets().to_vec()).unwrap()
    };
    let sheet = SolidWall::sheet(
        &[
            [0.0, 0.0, 0.3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.3],
        ]
        .map(Point3::from),
        &[[0, 1, 2], [1, 3, 2]],
        0.2,
    )
    .unwrap();
    let walls = [
        SolidWall::solid(&l_block()),
        SolidWall::solid(&large(1.0)),
        SolidWall::solid(&large(40.0)),
        sheet,
    ];
    for (name, body) in &bodies() {
        for (w, wall) in walls.iter().enumerate() {
            let (low, high) = wall.bounds();
            for round in 0..20 {
                let fa = Frame {
                    position: stream.vector(),
                    rotation: stream.rotation(),
                };
                let up = stream.unit() - 0.2;
                let place = Vector3::new(
                    low.x + (high.x - low.x) * stream.unit(),
                    low.y + (high.y - low.y) * stream.unit(),
                    high.z + up * body.radius(),
                );
                let fb = Frame {
                    position: fa.point(&place),
                    rotation: stream.rotation(),
                };
                both.wall(&format!("{name} {w} {round}"), wall, &fa, body, &fb);
            }
        }
    }
    assert!(both.seen[1..3].iter().all(|n| *n > 20), "{:?}", both.seen);
}

/// Bodies shifted by whole cells and parts of them: faces, edges and corners coincide, also with those inside the other.
#[test]
fn skins_and_pieces_agree_where_faces_coincide() {
    let mut both = Both::new();
    // Which of the tetrahedra at a coinciding face come first depends on round-off.
    both.keys = false;
    let mut stream = Stream(54);
    let steps = [0.0, 0.1, 0.2, 0.25, 0.3, 0.5, 0.9, 1.0];
    for (name, mesh) in [("cube", cube(2)), ("L", l_block()), ("tube", tube())] {
        let body = tets::body(&mesh, Field::Body);
        let wall = SolidWall::solid(&mesh);
        for n in 0..120 {
            let pick = |k: usize| steps[(n * (3 + 2 * k) + n / 7 + k) % steps.len()];
            let shift = Vector3::new(pick(0), pick(1), pick(2));
            let fa = Frame {
                position: stream.vector(),
                rotation: if n % 2 == 0 {
                    Matrix3::identity()
                } else {
                    stream.rotation()
                },
            };
            let fb = Frame {
                position: fa.position + fa.rotation * shift,
                rotation: fa.rotation,
            };
            both.bodies(&format!("{name} {shift:?}"), &body, &fa, &body, &fb);
            let what = format!("{name} on the wall {shift:?}");
            both.wall(
                &what,
                &wall,
                &Frame::identity(),
                &body,
                &Frame {
                    position: shift + body.centroid(),
                    ..Frame::identity()
                },
            );
        }
    }
    assert!(both.seen[1] > 200, "{:?}", both.seen);
}

/// A shell in whose wall a ball lies: the boundary of their overlap has two parts, one inside the other, and is one
/// patch. So has that of a shell with a ball that reaches into its cavity.
#[test]
fn a_hole_in_an_overlap_is_no_patch() {
    let mut both = Both::new();
    let shell = tets::cubes(&tets::block([5, 5, 5], |at| at != [2, 2, 2]), 0.2);
    let shell = tets::body(&shell, Field::Body);
    let mut stream = Stream(55);
    for side in [0.08, 0.15, 0.35, 0.5, 0.7] {
        let inside = tets::body(
            &tets::cubes(&tets::block([2; 3], |_| true), 0.5 * side),
            Field::Body,
        );
        for _ in 0..12 {
            let fa = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            let fb = Frame {
                position: fa.position + fa.rotation * (stream.vector() * 0.2),
                rotation: stream.rotation(),
            };
            both.bodies(&format!("{side}"), &shell, &fa, &inside, &fb);
            both.bodies(&format!("{side} around"), &inside, &fb, &shell, &fa);
        }
    }
    assert!(both.seen[1] > 50, "{:?}", both.seen);
}
