//! Force and torque of the production kernel against central differences of an energy that is coded
//! separately (tests/common), for all 18 solids.

use crate::common::{Stream, oracle, solids, turned, wall_oracle};
use femdem_contact::kernel::{CavityCache, CavityKernel, PairCache, Scratch};
use femdem_contact::{ConvexShape, Frame, Overlap, PairKernel, Wall, WallPlane};
use femdem_mesh::Polyhedron;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::Vector3;

const PENALTY: f64 = 3.0;

/// Wrench on B (force, torque about its origin) by central differences of an energy.
fn differences(energy: impl Fn(&Frame) -> f64, frame: &Frame, h: f64) -> [Vector3<f64>; 2] {
    let along = |k: usize| {
        let mut e = Vector3::zeros();
        e[k] = 1.0;
        e
    };
    let force = |k: usize| {
        let at = |s: f64| {
            let mut f = *frame;
            f.position += along(k) * s;
            energy(&f)
        };
        -(8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    };
    let torque = |k: usize| {
        let at = |s: f64| energy(&turned(frame, &along(k), s));
        -(8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
    };
    [
        Vector3::new(force(0), force(1), force(2)),
        Vector3::new(torque(0), torque(1), torque(2)),
    ]
}

/// A pose of B that overlaps A, from slightly to deeply.
fn overlapping(stream: &mut Stream, a: &ConvexShape, b: &ConvexShape) -> (Frame, Frame) {
    let mut fa = Frame::identity();
    fa.position = stream.vector();
    fa.rotation = stream.rotation();
    let mut fb = fa;
    fb.rotation = stream.rotation();
    let direction = stream.vector().normalize();
    let reach =
        a.support(&fa.rotation.tr_mul(&direction)) + b.support(&-fb.rotation.tr_mul(&direction));
    fb.position += direction * (reach * (0.55 + 0.4 * stream.unit()));
    (fa, fb)
}

fn close(got: &Vector3<f64>, want: &Vector3<f64>, scale: f64, what: &str) {
    let error = (got - want).norm();
    assert!(
        error <= 1e-6 * scale,
        "{what}: got {got:?}, want {want:?}, relative error {:e}",
        error / scale
    );
}

/// `step` is that of the differences, by the smaller of the two: the edges of polygons must not change within it.
fn check_pair(
    name: &str,
    [pa, pb]: [&Polyhedron; 2],
    a: &ConvexShape,
    [fa, fb]: [&Frame; 2],
    step: f64,
    got: &Overlap,
) {
    let energy = |f: &Frame| PENALTY * oracle(pa, fa, pb, f).1;
    let (volume, integral) = oracle(pa, fa, pb, fb);
    let relative = (got.energy - PENALTY * integral).abs() / (PENALTY * integral);
    assert!(relative < 1e-9, "{name}: energy off by {relative:e}");
    assert!(
        (got.volume - volume).abs() < 1e-9 * volume,
        "{name}: volume"
    );
    let [force, torque] = differences(energy, fb, step);
    close(&got.force, &force, force.norm(), &format!("{name} force"));
    let lever = force.norm() * a.radius();
    close(
        &got.torque_b(),
        &torque,
        lever,
        &format!("{name} torque on B"),
    );
    let [_, torque_a] = differences(|f| PENALTY * oracle(pa, f, pb, fb).1, fa, step);
    close(
        &got.torque_a(),
        &torque_a,
        lever,
        &format!("{name} torque on A"),
    );
}

#[test]
fn wrench_is_minus_the_gradient_of_the_energy() {
    let kernel = PairKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(7);
    let mut checked = 0;
    for (name, polyhedron, shape) in solids() {
        for _ in 0..6 {
            let (fa, fb) = overlapping(&mut stream, &shape, &shape);
            if let Some(got) = kernel.evaluate(&shape, &fa, &shape, &fb, &mut scratch) {
                checked += 1;
                let both = [&polyhedron; 2];
                check_pair(&name, both, &shape, [&fa, &fb], 3e-4, &got);
            }
        }
    }
    assert!(checked > 60, "only {checked} overlapping pairs");
}

/// Two different solids of different size: neither field may be taken for the other.
#[test]
fn fields_of_unlike_bodies_are_not_mixed_up() {
    let kernel = PairKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(8);
    let all = solids();
    let mut checked = 0;
    for (i, (name, polyhedron, shape)) in all.iter().enumerate() {
        for (other, size) in [(i + 1, 0.5), (i + 7, 1.6)] {
            let catalogue: CatalogueShape = all[other % all.len()].0.parse().unwrap();
            let second = catalogue.polyhedron(size).unwrap();
            let b = ConvexShape::new(&second).unwrap();
            for _ in 0..2 {
                let (fa, fb) = overlapping(&mut stream, shape, &b);
                if let Some(got) = kernel.evaluate(shape, &fa, &b, &fb, &mut scratch) {
                    checked += 1;
                    let name = format!("{name} and {catalogue}");
                    let both = [polyhedron, &second];
                    let step = 3e-4 * size.min(1.0);
                    check_pair(&name, both, shape, [&fa, &fb], step, &got);
                }
            }
        }
    }
    assert!(checked > 40, "only {checked} overlapping pairs");
}

/// The culled kernel, with a cache kept through many small motions, finds the same contact as a fresh one;
/// also where the bodies travel much farther together than relative to each other.
#[test]
fn a_warm_cache_changes_nothing() {
    let kernel = PairKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(11);
    for (name, _, shape) in solids() {
        for together in [0.0, 0.0, 0.05, 0.05] {
            let (fa, mut fb) = overlapping(&mut stream, &shape, &shape);
            let mut cache = PairCache::default();
            let mut motion = 0.0;
            let direction = stream.vector().normalize();
            let axis = stream.vector().normalize();
            for _ in 0..200 {
                fb.position += direction * 1e-3;
                fb = turned(&fb, &axis, 1e-3);
                motion += together + 1e-3 + 1e-3 * shape.radius();
                let warm = kernel.evaluate_cached(
                    &shape,
                    &fa,
                    &shape,
                    &fb,
                    &mut cache,
                    motion,
                    &mut scratch,
                );
                let cold = kernel.evaluate(&shape, &fa, &shape, &fb, &mut scratch);
                match (warm, cold) {
                    (Some(w), Some(c)) => {
                        let scale = c.force.norm();
                        let off = (w.force - c.force).norm();
                        assert!(off <= 1e-9 * scale + 1e-18, "{name}: {off:e} of {scale:e}");
                        let lever = scale * shape.radius();
                        let off = (w.torque_b() - c.torque_b()).norm();
                        assert!(off <= 1e-9 * lever + 1e-18, "{name}: torque off by {off:e}");
                    }
                    (None, None) => {}
                    (w, c) => {
                        let tiny = w.or(c).map_or(0.0, |o| o.force.norm());
                        assert!(tiny < 1e-15, "{name}: only one of them touches, {tiny:e}");
                    }
                }
            }
        }
    }
}

/// Half-spaces and a wedge of two planes, against the same differences.
#[test]
fn wall_wrench_is_minus_the_gradient() {
    let kernel = CavityKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(5);
    let at_origin = Frame::identity();
    let mut checked = 0;
    for (name, polyhedron, shape) in solids() {
        for planes in [1, 2, 3] {
            let base = stream.vector().normalize();
            let normals: Vec<Vector3<f64>> = (0..planes)
                .map(|k| (base + stream.vector() * (0.2 * f64::from(k))).normalize())
                .collect();
            let mut fb = Frame::identity();
            fb.rotation = stream.rotation();
            fb.position = base * (shape.radius() * (0.5 + 0.3 * stream.unit()));
            let wall = Wall::new(
                "wedge",
                normals
                    .iter()
                    .map(|n| WallPlane {
                        normal: *n,
                        offset: 0.0,
                    })
                    .collect(),
            )
            .unwrap();
            let oracle_planes: Vec<_> = normals.iter().map(|n| (*n, 0.0)).collect();
            let energy = |f: &Frame| 2.0 * PENALTY * wall_oracle(&polyhedron, f, &oracle_planes).1;
            let Some(got) = kernel.evaluate(&wall, &at_origin, &shape, &fb, &mut scratch) else {
                continue;
            };
            if energy(&fb) < 1e-6 {
                continue;
            }
            checked += 1;
            let relative = (got.energy - energy(&fb)).abs() / energy(&fb);
            assert!(
                relative < 1e-8,
                "{name} with {planes}: energy off by {relative:e}"
            );
            let [force, torque] = differences(energy, &fb, 3e-4);
            close(
                &got.force,
                &force,
                force.norm(),
                &format!("{name} wall force"),
            );
            let lever = force.norm() * shape.radius();
            close(
                &got.torque_b(),
                &torque,
                lever,
                &format!("{name} wall torque"),
            );
        }
    }
    assert!(checked > 25, "only {checked} touching walls");
}

/// The same for a wall: a body slides and turns along a wedge of two planes.
#[test]
fn a_warm_wall_cache_changes_nothing() {
    let kernel = CavityKernel::new(PENALTY).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(13);
    let at_origin = Frame::identity();
    let mut touching = 0;
    for (name, _, shape) in solids() {
        let base = stream.vector().normalize();
        let planes = [base, (base + stream.vector() * 0.4).normalize()].map(|normal| WallPlane {
            normal,
            offset: 0.0,
        });
        let wall = Wall::new("wedge", planes.to_vec()).unwrap();
        let mut fb = Frame::identity();
        fb.rotation = stream.rotation();
        fb.position = base * (shape.radius() * 1.05);
        let mut cache = CavityCache::default();
        let mut motion = 0.0;
        let direction = stream.vector().normalize() * 0.5 - base;
        let axis = stream.vector().normalize();
        for _ in 0..300 {
            fb.position += direction * 5e-4;
            fb = turned(&fb, &axis, 1e-3);
            motion += direction.norm() * 5e-4 + 1e-3 * shape.radius();
            let warm = kernel.evaluate_cached(
                &wall,
                &at_origin,
                &shape,
                &fb,
                &mut cache,
                motion,
                &mut scratch,
            );
            let cold = kernel.evaluate(&wall, &at_origin, &shape, &fb, &mut scratch);
            let (Some(w), Some(c)) = (warm, cold) else {
                let tiny = warm.or(cold).map_or(0.0, |o| o.force.norm());
                assert!(tiny < 1e-15, "{name}: only one of them touches, {tiny:e}");
                continue;
            };
            touching += 1;
            let scale = 1e-9 * c.force.norm() + 1e-18;
            assert!((w.force - c.force).norm() <= scale, "{name}: force");
            assert!(
                (w.torque_b() - c.torque_b()).norm() <= scale,
                "{name}: torque"
            );
        }
    }
    assert!(touching > 2000, "only {touching} touching steps");
}
