//! The energy ledger closes, and no dissipative part gives energy back.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, add_floor, add_heap, add_sides, at, parameters, run_until, solid, turned,
    weightless,
};
use femdem_mesh::Pose;
use femdem_mesh::nalgebra::{Translation3, Vector3};
use femdem_solve::{BodySpec, Drive, Ledger, World};

fn dissipated_parts(ledger: &Ledger) -> [f64; 4] {
    [
        ledger.dissipated_friction,
        ledger.dissipated_damping,
        ledger.dissipated_medium,
        ledger.frozen,
    ]
}

/// One oblique, spinning impact on the floor with a given share of the stable step.
fn impact(id: &str, seed: u64, safety: f64) -> Ledger {
    let mut p = parameters(1e6, 0.4, 0.3);
    p.time_step.safety = safety;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape(id, &solid(id)).unwrap();
    let pose = Pose::from_parts(Translation3::new(0.0, 0.0, 0.6 * D), turned(seed));
    let spec = BodySpec {
        velocity: Vector3::new(0.8, 0.1, -1.5),
        angular_velocity: Vector3::new(4.0, -6.0, 9.0),
        ..BodySpec::at_rest(shape, DENSITY, pose)
    };
    world.add_body(spec).unwrap();
    run_until(&mut world, 0.1);
    world.ledger()
}

/// The ledger of a single impact misses less than 1e-3 of the turnover at a tenth of the stable step, and the
/// missing part is the error of a second-order integrator: a quarter at half the step. A wrong entry would
/// not shrink with the step.
#[test]
fn the_ledger_of_one_impact_closes() {
    for (seed, id) in [(5, "P1"), (6, "P5"), (7, "A10"), (8, "P3")] {
        let [coarse, fine] = [0.1, 0.05].map(|safety| impact(id, seed, safety));
        assert!(
            coarse.dissipated_damping > 0.01 * coarse.initial,
            "{id}: {coarse:?}"
        );
        assert!(
            coarse.dissipated_friction > 0.001 * coarse.initial,
            "{id}: {coarse:?}"
        );
        let errors = [coarse, fine].map(|l| l.error_relative());
        assert!(errors[0].abs() < 1e-3, "{id}: off by {errors:?}");
        let order = (errors[0] / errors[1]).log2();
        assert!(
            (order - 2.0).abs() < 0.2,
            "{id}: order {order} from {errors:?}"
        );
    }
}

/// A heap falls into a box and settles with the default step: the ledger closes, and each kind of dissipation
/// only grows, except for the lag of half a step.
#[test]
fn the_ledger_of_a_settling_pack_closes() {
    let mut p = parameters(1e6, 0.5, 0.6);
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 3.3 * D, Drive::Fixed);
    add_heap(&mut world, 30, 3);
    let start = world.ledger().initial;
    assert!((world.ledger().final_energy() / start - 1.0).abs() < 1e-12);
    let mut worst = 0.0_f64;
    let mut before = [0.0; 4];
    for k in 1..=30 {
        run_until(&mut world, 0.05 * f64::from(k));
        let ledger = world.ledger();
        worst = worst.max(ledger.error().abs());
        let now = dissipated_parts(&ledger);
        for (x, y) in now.iter().zip(&before) {
            assert!(
                x - y >= -1e-4 * start,
                "{before:?} then {now:?} of {start} J"
            );
        }
        before = now;
    }
    let ledger = world.ledger();
    assert!(ledger.dissipated() > 0.2 * start, "{ledger:?}");
    let error = ledger.error_relative();
    assert!(error.abs() < 1e-3, "off by {error:e}: {ledger:?}");
    assert!(
        worst < 1e-3 * start,
        "off by {worst:e} J of {start} J on the way"
    );
}

/// Two rough bodies collide in free space with every damping on: their energy never grows.
#[test]
fn a_collision_never_gains_energy() {
    for seed in 0..12_u64 {
        let mut p = weightless(1e6, 0.5, 0.5);
        p.time_step.safety = 0.1;
        let mut world = World::new(p).unwrap();
        let shape = world.add_shape("A1", &solid("A1")).unwrap();
        for (side, k) in [(-1.0, 0), (1.0, 1)] {
            let pose = Pose::from_parts(
                Translation3::new(side * 0.6 * D, 0.0, 0.0),
                turned(2 * seed + k),
            );
            let spec = BodySpec {
                velocity: Vector3::new(-side, 0.3 * side, 0.0),
                angular_velocity: Vector3::new(2.0, -3.0, side * 4.0),
                ..BodySpec::at_rest(shape, DENSITY, pose)
            };
            world.add_body(spec).unwrap();
        }
        let start = world.kinetic_energy();
        let (mut lowest, mut touched) = (start, false);
        while world.time() < 0.15 {
            world.step().unwrap();
            touched |= !world.contacts().is_empty();
            let now = world.ledger().final_energy();
            assert!(
                now <= lowest + 2e-4 * start,
                "seed {seed}: {now} after {lowest} J"
            );
            lowest = lowest.min(now);
        }
        assert!(
            touched && lowest < 0.95 * start,
            "seed {seed}: {lowest} of {start} J left"
        );
    }
}

/// A world without contacts has nothing to dissipate.
#[test]
fn flight_costs_nothing() {
    let mut world = World::new(parameters(1e6, 0.5, 0.6)).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros())))
        .unwrap();
    run_until(&mut world, 0.3);
    assert_eq!(world.ledger().dissipated(), 0.0);
}
