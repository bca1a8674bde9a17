//! Properties of the pair kernel for any two of the solids, at any scale and place.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Stream, solids};
use femdem_contact::kernel::{PairCache, Scratch};
use femdem_contact::{ConvexShape, Frame, Overlap, PairKernel};
use femdem_mesh::Polyhedron;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use std::sync::LazyLock;

static SOLIDS: LazyLock<Vec<(String, Polyhedron, ConvexShape)>> = LazyLock::new(solids);

/// Two solids, each of its own scale, with poses that overlap by a share of their reach.
#[derive(Clone)]
struct Case {
    names: [String; 2],
    a: ConvexShape,
    b: ConvexShape,
    fa: Frame,
    fb: Frame,
    /// From the centroid of A to that of B.
    direction: Vector3<f64>,
    /// Distance of the centroids at which the extents along `direction` just meet.
    reach: f64,
    scale: f64,
}

impl std::fmt::Debug for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self {
            names,
            fa,
            fb,
            reach,
            scale,
            ..
        } = self;
        write!(
            f,
            "{names:?} at {fa:?} and {fb:?}, reach {reach:e}, scale {scale:e}"
        )
    }
}

impl Case {
    /// The case with B moved so that the extents overlap by a share of the reach.
    fn overlapped(&self, share: f64) -> Frame {
        Frame {
            position: self.fa.position + self.direction * (self.reach * (1.0 - share)),
            ..self.fb
        }
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let scale = (-6.0..3.0_f64).prop_map(|x| 10.0_f64.powf(x));
    (
        0..18_usize,
        0..18_usize,
        scale,
        0.5..2.0_f64,
        0.02..0.4_f64,
        any::<u64>(),
    )
        .prop_map(|(i, j, scale, ratio, share, seed)| {
            let shape = |k: usize, d: f64| {
                let solid = SOLIDS[k].1.scaled(d).unwrap();
                ConvexShape::new(&solid).unwrap()
            };
            let (a, b) = (shape(i, scale), shape(j, scale * ratio));
            let mut stream = Stream(seed);
            let fa = Frame {
                position: stream.vector() * scale,
                rotation: stream.rotation(),
            };
            let rotation = stream.rotation();
            let direction = stream.vector().normalize();
            let reach = a.support(&fa.rotation.tr_mul(&direction))
                + b.support(&-rotation.tr_mul(&direction));
            let mut case = Case {
                names: [i, j].map(|k| SOLIDS[k].0.clone()),
                a,
                b,
                fa,
                fb: Frame {
                    position: fa.position,
                    rotation,
                },
                direction,
                reach,
                scale,
            };
            case.fb = case.overlapped(share);
            case
        })
}

fn evaluate(case: &Case, fa: &Frame, fb: &Frame) -> Option<Overlap> {
    // Penalty over scale: forces of order one at every scale.
    let kernel = PairKernel::new(1.0 / case.scale.powi(2)).unwrap();
    kernel.evaluate(&case.a, fa, &case.b, fb, &mut Scratch::default())
}

/// Two overlaps of one configuration are equal up to a share of their size and the rounding
/// of the poses, the second after a `turn`; with `sign` -1 A and B are exchanged.
fn same(
    got: &Overlap,
    want: &Overlap,
    turn: &Matrix3<f64>,
    sign: f64,
    case: &Case,
    share: f64,
) -> Result<(), TestCaseError> {
    let d = case.scale;
    // The rounding of the poses, as a share of the depth of the overlap.
    let share = share + 1e3 * f64::EPSILON * case.reach / want.penetration();
    let force = want.force.norm();
    let off = (got.force - turn * want.force * sign).norm();
    prop_assert!(
        off <= share * force,
        "{:?}: force off by {off:e} of {force:e}",
        case.names
    );
    let torque = if sign > 0.0 {
        [want.torque_a(), want.torque_b()]
    } else {
        [want.torque_b(), want.torque_a()]
    };
    for (x, y) in [got.torque_a(), got.torque_b()].iter().zip(torque) {
        let off = (x - turn * y).norm();
        prop_assert!(
            off <= share * force * d,
            "{:?}: torque off by {off:e}",
            case.names
        );
    }
    // The volume of a vanishing overlap is lost in the rounding of the poses.
    if want.volume < 1e-10 * d.powi(3) {
        return Ok(());
    }
    // The energy is the small difference of two terms of the size p V.
    let energy = want.energy.max(want.volume / (d * d));
    for (what, x, y, size) in [
        ("energy", got.energy, want.energy, energy),
        ("volume", got.volume, want.volume, want.volume),
        ("area", got.area, want.area, want.area),
        (
            "stiffness",
            got.foundation.stiffness,
            want.foundation.stiffness,
            want.foundation.stiffness,
        ),
    ] {
        let off = (x - y).abs();
        prop_assert!(
            off <= 10.0 * share * size,
            "{:?}: {what} {x:e} instead of {y:e}",
            case.names
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Action and reaction: exchanging A and B negates the wrench and keeps everything else.
    #[test]
    fn swapping_the_bodies_negates_the_wrench(case in cases()) {
        let swapped = Case { a: case.b.clone(), b: case.a.clone(), ..case.clone() };
        match (evaluate(&case, &case.fa, &case.fb), evaluate(&swapped, &case.fb, &case.fa)) {
            (Some(x), Some(y)) => same(&y, &x, &Matrix3::identity(), -1.0, &case, 1e-9)?,
            (None, None) => {}
            (x, y) => prop_assert!(false, "only one of the orders touches: {x:?} {y:?}"),
        }
    }

    /// A rigid motion of the pair turns the wrench with it.
    #[test]
    fn a_rigid_motion_turns_the_wrench(case in cases(), seed in any::<u64>()) {
        let mut stream = Stream(seed);
        let turn = stream.rotation();
        let shift = stream.vector() * (10.0 * case.scale);
        let moved = |f: &Frame| Frame { position: turn * f.position + shift, rotation: turn * f.rotation };
        match (evaluate(&case, &case.fa, &case.fb), evaluate(&case, &moved(&case.fa), &moved(&case.fb))) {
            (Some(x), Some(y)) => same(&y, &x, &turn, 1.0, &case, 1e-9)?,
            (None, None) => {}
            (x, y) => prop_assert!(false, "only one of the places touches: {x:?} {y:?}"),
        }
    }

    /// Far from the origin only the digits of the positions are lost: the wrench changes by no more than the
    /// stiffness times their rounding.
    #[test]
    fn far_from_the_origin(case in cases(), seed in any::<u64>()) {
        let shift = Stream(seed).vector().normalize() * 1e3;
        let moved = |f: &Frame| Frame { position: f.position + shift, ..*f };
        let (near, far) = (evaluate(&case, &case.fa, &case.fb), evaluate(&case, &moved(&case.fa), &moved(&case.fb)));
        let rounding = 4.0 * 1e3 * f64::EPSILON;
        if let Some(x) = near && rounding < 1e-3 * x.penetration() {
            prop_assert!(far.is_some(), "lost by a shift of 1 km");
            let y = far.unwrap();
            let off = (y.force - x.force).norm();
            let bound = 4.0 * x.foundation.stiffness * rounding + 1e-9 * x.force.norm();
            prop_assert!(off <= bound, "{:?}: force off by {off:e} of {:e}, bound {bound:e}", case.names, x.force.norm());
        }
    }

    /// The wrenches on A and B cancel, about any common point.
    #[test]
    fn forces_and_moments_cancel(case in cases()) {
        if let Some(x) = evaluate(&case, &case.fa, &case.fb) {
            let between = case.fb.position - case.fa.position;
            let arms = (x.arm_a - x.arm_b - between).norm();
            prop_assert!(arms <= 1e-12 * case.reach);
            let about_a = x.torque_a() + x.torque_b() + between.cross(&x.force);
            prop_assert!(about_a.norm() <= 1e-12 * x.force.norm() * case.reach);
            prop_assert!((x.normal.norm() - 1.0).abs() < 1e-14);
            // The normal points from A to B if neither body contains the other's centre.
            let outside = case.a.field(&case.fa.rotation.tr_mul(&between)) < 0.0;
            prop_assert!(!outside || x.normal.dot(&case.direction) > 0.0);
        }
    }

    /// Bodies whose extents along a direction do not meet have no contact; as the overlap of their extents
    /// decreases, the force goes to zero.
    #[test]
    fn no_contact_when_apart_and_no_jump_at_first_touch(case in cases()) {
        for gap in [1e-12, 1e-6, 1e-3, 1.0] {
            let apart = case.overlapped(-gap);
            let found = evaluate(&case, &case.fa, &apart);
            prop_assert!(found.is_none(), "{:?}: a contact across a gap of {gap:e}: {found:?}", case.names);
        }
        // No contact is stiffer than a face's 2 A/h on either side.
        let stiffest = (case.a.face_stiffness() + case.b.face_stiffness()) / case.scale.powi(2);
        for share in [1e-9, 1e-6, 1e-3] {
            if let Some(x) = evaluate(&case, &case.fa, &case.overlapped(share)) {
                let bound = 2.0 * stiffest * share * case.reach;
                prop_assert!(x.force.norm() <= bound, "{:?}: {:e} at {share:e}", case.names, x.force.norm());
                prop_assert!(x.volume <= 1.1 * share * case.reach * std::f64::consts::PI * case.a.radius().powi(2));
            }
        }
    }

    /// Any finite poses, however deep, give finite numbers.
    #[test]
    fn nothing_but_finite_numbers(case in cases(), share in 0.0..1.0_f64, same_turn in any::<bool>()) {
        let mut fb = case.overlapped(share);
        if same_turn {
            fb.rotation = case.fa.rotation;
        }
        for position in [fb.position, case.fa.position] {
            fb.position = position;
            if let Some(x) = evaluate(&case, &case.fa, &fb) {
                let vectors = [x.force, x.moment, x.arm_a, x.arm_b, x.normal];
                prop_assert!(vectors.iter().flatten().all(|v| v.is_finite()), "{x:?}");
                for v in [x.energy, x.volume, x.area, x.foundation.polar(), x.torsion_radius] {
                    prop_assert!(v.is_finite() && v >= 0.0, "{x:?}");
                }
                // For bodies around one centre only rounding remains, of either sign.
                let rounding = 1e-12 * case.a.face_stiffness() / case.scale.powi(2);
                prop_assert!(x.foundation.stiffness.is_finite() && x.foundation.stiffness >= -rounding, "{x:?}");
            }
        }
    }

    /// As above, for poses that have nothing to do with the bodies.
    #[test]
    fn arbitrary_poses(case in cases(), place in proptest::array::uniform3(-1e300..1e300_f64)) {
        let fb = Frame { position: Vector3::from(place), ..case.fb };
        prop_assert!(evaluate(&case, &case.fa, &fb).is_none());
    }
}

/// Two bodies in the same place: no force, and next to it the energy of the whole overlap,
/// p (V/4 + V/4), because the mean of the gauge field over a body is 1/4.
#[test]
fn coincident_bodies() {
    let kernel = PairKernel::new(3.0).unwrap();
    let mut scratch = Scratch::default();
    for (name, solid, shape) in SOLIDS.iter() {
        let frame = Frame {
            position: Vector3::new(0.3, -0.2, 0.1),
            rotation: Stream(3).rotation(),
        };
        let same = kernel.evaluate(shape, &frame, shape, &frame, &mut scratch);
        let force = same.map_or(0.0, |x| x.force.norm());
        assert!(force < 1e-12, "{name}: {force:e} N without a direction");
        let mut beside = frame;
        beside.position.x += 1e-6;
        let near = kernel.evaluate(shape, &frame, shape, &beside, &mut scratch);
        let energy = near.map_or(0.0, |x| x.energy);
        let want = 3.0 * solid.mass_properties().volume / 2.0;
        assert!(
            (energy / want - 1.0).abs() < 1e-5,
            "{name}: {energy:e} instead of {want:e} J"
        );
    }
}

/// Number of evaluations not skipped by the cache, for bodies of circumscribed diameter `size` that pass each
/// other without touching: the travel budget scales with the size.
fn looks(size: f64) -> u32 {
    let kernel = PairKernel::new(1.0).unwrap();
    let mut scratch = Scratch::default();
    let solid = "A10".parse::<CatalogueShape>().unwrap();
    let shape = ConvexShape::new(&solid.polyhedron(size).unwrap()).unwrap();
    let mut stream = Stream(5);
    let mut count = 0;
    for _ in 0..20 {
        let [a, b] = [0, 1].map(|_| Frame {
            position: Vector3::zeros(),
            rotation: stream.rotation(),
        });
        let mut cache = PairCache::default();
        for k in 0..1024 {
            let way = (f64::from(k) / 512.0 - 1.0) * size;
            let beside = Frame {
                position: Vector3::new(way, 0.75 * size, 0.625 * size),
                ..b
            };
            let motion = way + size;
            count += u32::from(!cache.is_clear(motion));
            kernel.evaluate_cached(
                &shape,
                &a,
                &shape,
                &beside,
                &mut cache,
                motion,
                &mut scratch,
            );
        }
    }
    count
}

#[test]
fn large_bodies_are_looked_at_as_seldom_as_small_ones() {
    let [small, large] = [1.0, 2.0_f64.powi(20)].map(looks);
    assert_eq!(small, large);
}
