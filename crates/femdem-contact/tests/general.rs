//! The general kernel on centroid fans of convex bodies against the convex kernel.

use crate::common::tets;
use crate::common::{Stream, solids};
use femdem_contact::general::GeneralScratch;
use femdem_contact::kernel::Scratch;
use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel, Overlap, PairKernel};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::tet::FACES;

const PENALTY: f64 = 3.0;

/// All fields of an overlap of bodies of size 1, with the scales of their errors.
fn numbers(o: &Overlap) -> Vec<(&'static str, Vector3<f64>, f64)> {
    let f = o.force.norm();
    let one = |x: f64| Vector3::new(x, 0.0, 0.0);
    vec![
        ("force", o.force, f),
        ("torque on A", o.torque_a(), f),
        ("torque on B", o.torque_b(), f),
        // The convex kernel computes the energy as a difference of terms of the size of p V.
        ("energy", one(o.energy), PENALTY * o.volume),
        ("volume", one(o.volume), o.volume),
        ("moment", o.moment, f),
        ("arm of A", o.arm_a, 1.0),
        ("arm of B", o.arm_b, 1.0),
        ("normal", o.normal, 1.0),
        ("area", one(o.area), o.area),
        (
            "stiffness",
            one(o.foundation.stiffness),
            o.foundation.stiffness,
        ),
        ("second", one(o.foundation.polar()), o.foundation.stiffness),
        ("radius", one(o.torsion_radius), 1.0),
    ]
}

/// Worst relative differences, field by field.
fn compare(got: &Overlap, want: &Overlap, worst: &mut Vec<(&'static str, f64)>) {
    let pairs = numbers(got).into_iter().zip(numbers(want));
    for (k, ((name, g, _), (_, w, scale))) in pairs.enumerate() {
        let error = (g - w).norm() / scale;
        if worst.len() <= k {
            worst.push((name, 0.0));
        }
        worst[k].1 = worst[k].1.max(error);
    }
}

#[test]
fn fans_of_convex_bodies_are_the_convex_kernel() {
    let convex = PairKernel::new(PENALTY).unwrap();
    let general = GeneralKernel::new(PENALTY).unwrap();
    let (mut scratch, mut buffers) = (Scratch::default(), GeneralScratch::default());
    let mut stream = Stream(3);
    let mut worst = Vec::new();
    let mut touching = 0;
    for (name, polyhedron, shape) in solids() {
        let mesh = FieldMesh::from_convex(&polyhedron).unwrap();
        assert!((mesh.inradius() - shape.inradius()).abs() < 1e-14);
        for _ in 0..8 {
            let mut fa = Frame::identity();
            fa.position = stream.vector();
            fa.rotation = stream.rotation();
            let mut fb = fa;
            fb.rotation = stream.rotation();
            let direction = stream.vector().normalize();
            let reach = shape.support(&fa.rotation.tr_mul(&direction))
                + shape.support(&-fb.rotation.tr_mul(&direction));
            fb.position += direction * (reach * (0.55 + 0.4 * stream.unit()));
            let want = convex.evaluate(&shape, &fa, &shape, &fb, &mut scratch);
            let got = general.evaluate(&mesh, &fa, &mesh, &fb, &mut buffers);
            match (want, got) {
                (Some(want), [got]) => {
                    touching += 1;
                    compare(&got.overlap, &want, &mut worst);
                }
                (None, []) => {}
                (want, got) => panic!("{name}: {want:?} but {got:?}"),
            }
        }
    }
    assert!(touching > 60, "only {touching}");
    for (name, error) in worst {
        assert!(error < 2e-12, "{name} differs by {error:e}");
    }
}

/// Energy and volume against cutting every tetrahedron of one body by the planes of every one of the other,
/// with the recursive code of tests/common and nodal values from the mesh itself.
#[test]
fn energy_and_volume_are_those_of_brute_force() {
    let mut stream = Stream(29);
    let kernel = GeneralKernel::new(PENALTY).unwrap();
    let mut scratch = GeneralScratch::default();
    let mut several = 0;
    for mesh in [tets::l_block(), tets::tube(), tets::dolos()] {
        let mesh = mesh.with_interior_points();
        let body = tets::body(&mesh, Field::Body);
        for _ in 0..4 {
            let fa = Frame {
                position: stream.vector(),
                rotation: stream.rotation(),
            };
            let fb = Frame {
                position: fa.position + stream.vector().normalize() * (0.3 + 0.4 * stream.unit()),
                rotation: stream.rotation(),
            };
            let (volume, integral) = brute_force(&mesh, &body, &fa, &fb);
            let patches = kernel.evaluate(&body, &fa, &body, &fb, &mut scratch);
            several += usize::from(patches.len() > 1);
            let got = tets::total(patches);
            assert!(
                (got.volume - volume).abs() < 1e-12,
                "{} {volume}",
                got.volume
            );
            let energy = PENALTY * integral;
            assert!(
                (got.energy - energy).abs() < 1e-12,
                "{} {energy}",
                got.energy
            );
        }
    }
    assert!(several > 0);
}

type Nodal = ([Vector3<f64>; 4], [f64; 4]);

fn brute_force(mesh: &TetMesh, body: &FieldMesh, fa: &Frame, fb: &Frame) -> (f64, f64) {
    let distance = mesh.distance_to_skin();
    let most = distance.iter().copied().fold(0.0, f64::max);
    let posed = |frame: &Frame| -> Vec<Nodal> {
        let at = |i: u32| frame.point(&(mesh.points()[i as usize].coords - body.centroid()));
        let value = |i: u32| distance[i as usize] / most;
        mesh.tets()
            .iter()
            .map(|t| (t.map(at), t.map(value)))
            .collect()
    };
    let one_way = |own: &[Nodal], others: &[Nodal]| {
        let mut sum = (0.0, 0.0);
        for (y, _) in others {
            let plane = |f: &[usize; 3]| {
                let [p, q, r] = f.map(|c| y[c]);
                let n = (q - p).cross(&(r - p)).normalize();
                (n, n.dot(&p))
            };
            let planes: Vec<_> = FACES.iter().map(plane).collect();
            for (x, values) in own {
                let (v, i) = crate::common::clipped_integral(x, *values, &planes);
                sum = (sum.0 + v, sum.1 + i);
            }
        }
        sum
    };
    let (a, b) = (posed(fa), posed(fb));
    let (volume, of_a) = one_way(&a, &b);
    let (_, of_b) = one_way(&b, &a);
    (volume, of_a + of_b)
}
