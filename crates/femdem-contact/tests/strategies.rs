//! The strategies give what they promise, and every kernel handles it.

#![allow(clippy::unwrap_used, reason = "what cannot be built fails the test")]

#[path = "../examples/fuzz_pairs/every_kernel.rs"]
mod every_kernel;

use every_kernel::{KERNELS, Kernels};
use femdem_contact::strategies::{
    Arrangement, Placement, TestPair, bodies, convex_bodies, non_convex_bodies, pairs, placements,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

#[test]
fn every_kernel_stands_random_pairs() {
    let mut runner = TestRunner::deterministic();
    let (strategy, placements) = (pairs(bodies()), placements());
    let mut kernels = Kernels::new().unwrap();
    let mut touching = [0; KERNELS.len()];
    for _ in 0..100 {
        let drawn = strategy.new_tree(&mut runner).unwrap().current();
        for _ in 0..20 {
            let placement = placements.new_tree(&mut runner).unwrap().current();
            let pair = TestPair::new(&drawn.a, &drawn.b, &placement);
            let verdict = kernels.check(&pair).unwrap();
            assert_eq!(verdict.faults, [], "{pair:?}");
            let same = verdict.energy_difference < 1e-9;
            assert!(same, "{verdict:?}: {pair:?}");
            (0..KERNELS.len()).for_each(|k| touching[k] += u32::from(verdict.touching[k]));
        }
    }
    assert!(touching.iter().all(|n| *n > 250), "{touching:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn bodies_lie_about_their_centroids(body in bodies(), factor in 1e-9..1e6_f64) {
        prop_assert!((0.3..3.0).contains(&body.radius()), "{}", body.radius());
        let mass = body.mesh.mass_properties();
        prop_assert!(mass.centroid.coords.norm() < 1e-12);
        let scaled = body.scaled(factor).unwrap();
        prop_assert!((scaled.radius() / (factor * body.radius()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn kinds_are_what_they_are_called(convex in convex_bodies(), other in non_convex_bodies()) {
        prop_assert!(convex.field.is_convex() && convex.convex.is_some());
        prop_assert!(!other.field.is_convex() && other.convex.is_none());
        let volume = convex.surface.unwrap().mass_properties().volume;
        prop_assert!((convex.mesh.volume() / volume - 1.0).abs() < 1e-12);
    }

    /// For features brought together without depth, those of B touch the plane through A's feature; convex
    /// bodies lie on opposite sides of it.
    #[test]
    fn features_meet(
        a in convex_bodies(),
        b in convex_bodies(),
        placement in placements(),
        chosen in prop::sample::select(vec![
            Arrangement::FaceOnFace,
            Arrangement::AlignedFaces,
            Arrangement::EdgeOnEdge,
            Arrangement::VertexOnVertex,
            Arrangement::VertexOnFace,
        ]),
    ) {
        let placement = Placement { arrangement: chosen, depth: 0.0, ..placement };
        let pair = TestPair::new(&a, &b, &placement);
        let up = pair.frame_wall.rotation.column(2).into_owned();
        let height = |x| up.dot(&(x - pair.frame_wall.position));
        let of_a = a.mesh.points().iter().map(|p| height(pair.frame_a.point(&p.coords)));
        let of_b = b.mesh.points().iter().map(|p| height(pair.frame_b.point(&p.coords)));
        let tolerance = 1e-9 + 1e-14 * placement.position.norm();
        prop_assert!(of_a.fold(f64::INFINITY, f64::min).abs() < tolerance);
        prop_assert!(of_b.fold(f64::NEG_INFINITY, f64::max).abs() < tolerance);
    }
}
