//! Caches, patches and extreme scales of the general kernel.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::tets;
use crate::common::{Stream, turned};
use femdem_contact::general::{GeneralCache, GeneralScratch, Patch};
use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel, SolidWall};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::{Point3, Vector3};

const PENALTY: f64 = 3.0;

fn same(warm: &[Patch], cold: &[Patch], what: &str) {
    let (w, c) = (tets::total(warm), tets::total(cold));
    let scale = 1e-11 * c.force.norm() + 1e-15;
    for (x, y) in [
        (w.force, c.force),
        (w.torque_a, c.torque_a),
        (w.torque_b, c.torque_b),
    ] {
        assert!((x - y).norm() <= scale, "{what}: {x} {y}");
    }
    assert!(
        (w.energy - c.energy).abs() <= 1e-11 * c.energy + 1e-18,
        "{what}"
    );
    let keys = |p: &[Patch]| p.iter().map(|p| p.key).collect::<Vec<_>>();
    // Patches of no more than round-off may appear in one and not in the other.
    if c.volume > 1e-9 && warm.len() == cold.len() {
        assert_eq!(keys(warm), keys(cold), "{what}");
    }
}

/// A cache kept through approach, contact and separation gives the same contacts as a fresh one.
#[test]
fn a_warm_cache_changes_nothing() {
    let mut stream = Stream(41);
    let mut scratch = GeneralScratch::default();
    let wall = SolidWall::solid(&tets::cube(2));
    let mut touching = 0;
    for (name, mesh) in [
        ("L", tets::l_block()),
        ("tube", tets::tube()),
        ("dolos", tets::dolos()),
    ] {
        let body = tets::body(&mesh, Field::Body);
        // In the last case both travel much farther together than relative to each other.
        for together in [0.0, 0.05] {
            let kernel = GeneralKernel::new(PENALTY).unwrap();
            let fa = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            let start = stream.vector().normalize() * 1.4;
            let mut fb = Frame {
                position: fa.position + start,
                rotation: stream.rotation(),
            };
            let velocity = (stream.vector() * 0.3 - start) / 1.4;
            let axis = stream.vector().normalize();
            let (mut cache, mut of_wall) = (GeneralCache::default(), GeneralCache::default());
            let mut motion = 0.0;
            for step in 0..300 {
                // Slow, fast, and slow again.
                let h = if (100..200).contains(&step) {
                    1e-2
                } else {
                    2e-3
                };
                fb.position += velocity * h;
                fb = turned(&fb, &axis, h);
                motion += together + velocity.norm() * h + h * body.radius();
                let warm = kernel
                    .evaluate_cached(&body, &fa, &body, &fb, &mut cache, motion, &mut scratch)
                    .to_vec();
                let cold = kernel.evaluate(&body, &fa, &body, &fb, &mut scratch);
                touching += usize::from(!cold.is_empty());
                same(&warm, cold, name);
                assert!(cold.is_empty() || cache.is_near());
                let warm = kernel
                    .evaluate_wall_cached(
                        &wall,
                        &fa,
                        &body,
                        &fb,
                        &mut of_wall,
                        motion,
                        &mut scratch,
                    )
                    .to_vec();
                let cold = kernel.evaluate_wall(&wall, &fa, &body, &fb, &mut scratch);
                same(&warm, cold, name);
            }
        }
    }
    assert!(touching > 300, "{touching}");
}

/// A plate on the two feet of a U rests in two patches, one on each; on its edge in one.
#[test]
fn every_connected_part_is_a_patch() {
    let legs = tets::block([5, 2, 3], |[x, _, z]| z == 0 || x == 0 || x == 4);
    let u = tets::body(&tets::cubes(&legs, 0.2), Field::Body);
    let plate = tets::body(
        &tets::cubes(&tets::block([6, 3, 1], |_| true), 0.2),
        Field::Body,
    );
    let kernel = GeneralKernel::new(PENALTY).unwrap();
    let mut scratch = GeneralScratch::default();
    let top = u.support(&Vector3::z());
    let mut frame = Frame::identity();
    frame.position.z = top + 0.1 - 0.01;
    for shift in [0.0, 0.013] {
        frame.position.x = shift;
        let patches = kernel.evaluate(&u, &Frame::identity(), &plate, &frame, &mut scratch);
        assert_eq!(patches.len(), 2);
        for (patch, side) in patches.iter().zip([-1.0, 1.0]) {
            let o = &patch.overlap;
            assert!((o.volume - 0.2 * 0.4 * 0.01).abs() < 1e-14, "{}", o.volume);
            assert!((o.area - 0.2 * 0.4).abs() < 1e-10, "{}", o.area);
            assert!((o.normal - Vector3::z()).norm() < 0.1);
            assert!((o.arm_a.x - 0.4 * side).abs() < 0.01, "{}", o.arm_a);
        }
        assert!(patches[0].key < patches[1].key);
    }
    // Flat on the floor of the U it touches all along.
    frame.position = Vector3::new(0.0, 0.0, -u.support(&-Vector3::z()) - 0.1 + 0.01);
    let patches = kernel.evaluate(&u, &Frame::identity(), &plate, &frame, &mut scratch);
    assert_eq!(patches.len(), 1);
}

fn scaled(mesh: &TetMesh, size: f64) -> TetMesh {
    let points = mesh
        .points()
        .iter()
        .map(|p| Point3::from(p.coords * size))
        .collect();
    TetMesh::new(points, mesh.tets().to_vec()).unwrap()
}

/// Pairs of any sizes from 1e-9 to 1e6 m, far from the origin, at any distance from each other:
/// no panic, finite results, opposite wrenches.
#[test]
fn hostile_scales_give_finite_contacts() {
    let (pairs, mut stream) = (3000, Stream(43));
    let shapes = [tets::cube(1), tets::l_block(), tets::dolos()];
    let mut bodies: Vec<FieldMesh> = Vec::new();
    for exponent in -9..=6 {
        for mesh in &shapes {
            let mesh = scaled(mesh, 10_f64.powi(exponent));
            bodies.push(tets::body(&mesh, Field::Body));
        }
    }
    let kernel = GeneralKernel::new(1e6).unwrap();
    let mut scratch = GeneralScratch::default();
    let mut touching = 0;
    for n in 0..pairs {
        let mut pick = || &bodies[(stream.unit() * bodies.len() as f64) as usize];
        let (a, mut b) = (pick(), pick());
        if n % 4 > 0 {
            // Mostly of about the same size.
            let i = bodies.iter().position(|x| std::ptr::eq(x, a)).unwrap();
            b = &bodies[(i + n % 3) % bodies.len()];
        }
        let far = [0.0, 1e5, a.radius()][n % 3];
        let frame_a = Frame {
            position: stream.vector() * far,
            rotation: stream.rotation(),
        };
        let aligned = n % 5 == 0;
        let reach = (a.radius() + b.radius()) * stream.unit();
        let mut step = stream.vector() * 2.0 * reach;
        if aligned {
            step = Vector3::new(0.0, 0.0, [a.inradius(), b.radius(), 0.0][n % 3]);
        }
        let frame_b = Frame {
            position: frame_a.position + step,
            rotation: if aligned {
                frame_a.rotation
            } else {
                stream.rotation()
            },
        };
        for patch in kernel.evaluate(a, &frame_a, b, &frame_b, &mut scratch) {
            touching += 1;
            let o = &patch.overlap;
            let all = [
                o.energy,
                o.volume,
                o.area,
                o.foundation.stiffness,
                o.foundation.polar(),
                o.torsion_radius,
                o.force.norm(),
                o.moment.norm(),
                o.arm_a.norm(),
                o.arm_b.norm(),
            ];
            assert!(all.iter().all(|x| x.is_finite() && *x >= 0.0), "{n}: {o:?}");
            assert!((o.normal.norm() - 1.0).abs() < 1e-9, "{n}: {o:?}");
            let about = o.torque_a() + o.torque_b() + frame_b.position.cross(&o.force)
                - frame_a.position.cross(&o.force);
            let lever = frame_a.position.norm() + a.radius() + b.radius();
            assert!(
                about.norm() <= 1e-9 * lever * o.force.norm(),
                "{n}: {about}"
            );
        }
    }
    assert!(touching > pairs / 10, "{touching}");
}
