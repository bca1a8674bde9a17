//! The active set: which bodies fall asleep, and what wakes them.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, add_floor, add_heap, add_sides, at, half_edge, parameters, run_until, solid,
};
use femdem_mesh::nalgebra::Vector3;
use femdem_solve::{BodySpec, Drive, SleepParameters, World, WorldParameters};

fn sleepy() -> WorldParameters {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.sleeping.enabled = true;
    p
}

fn add_cube(world: &mut World, shape: u32, position: Vector3<f64>) -> u32 {
    let spec = BodySpec::at_rest(shape, DENSITY, at(position));
    world.add_body(spec).unwrap()
}

/// Steps until nothing is awake.
fn settle(world: &mut World, latest: f64) {
    while world.awake_count() > 0 {
        world.step().unwrap();
        assert!(
            world.time() < latest,
            "{} are awake after {latest} s",
            world.awake_count()
        );
    }
}

fn places(world: &World) -> Vec<Vector3<f64>> {
    world
        .body_ids()
        .map(|i| world.position(i).unwrap())
        .collect()
}

fn largest_move(world: &World, from: &[Vector3<f64>]) -> f64 {
    let now = places(world);
    now.iter()
        .zip(from)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

/// Heaps that have settled under a strict rule sleep; woken for half a second without sleep they stay in
/// place (of the first fifteen one does not: a body tips by 4e-3 d). The default rule lets a body sleep that
/// still creeps by up to a hundredth of its size in half a second.
#[test]
fn a_sleeping_heap_is_at_rest() {
    let mut p = sleepy();
    p.sleeping.tolerance = 0.003;
    for seed in 6..11 {
        let moved = woken(p, seed);
        assert!(moved < 1e-3, "waking moved a body of {seed} by {moved:e} d");
    }
}

/// Largest displacement over d of a sleeping heap when it is woken.
fn woken(p: WorldParameters, seed: u64) -> f64 {
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 2.3 * D, Drive::Fixed);
    add_heap(&mut world, 16, seed);
    settle(&mut world, 10.0);
    assert!((0..16).all(|i| world.is_asleep(i)));
    assert_eq!(world.kinetic_energy(), 0.0);
    let asleep = places(&world);
    // All asleep: time passes without any motion.
    let until = world.time() + 0.05;
    run_until(&mut world, until);
    assert_eq!(places(&world), asleep);
    world.set_sleeping(false);
    assert_eq!(world.awake_count(), 16);
    let until = world.time() + 0.5;
    run_until(&mut world, until);
    assert!(
        world.residuals().max_over_load < 0.05,
        "{:?}",
        world.residuals()
    );
    largest_move(&world, &asleep) / D
}

/// A floor that moves away removes the support: everything wakes and falls freely.
#[test]
fn without_support_sleepers_fall() {
    let mut world = World::new(sleepy()).unwrap();
    let floor = add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    for k in 0..3 {
        add_cube(
            &mut world,
            shape,
            Vector3::z() * (half_edge() * (2.0 * f64::from(k) + 1.0)),
        );
    }
    settle(&mut world, 5.0);
    let before = places(&world);
    let start = world.time() + 0.01;
    let velocity = Vector3::z() * -5.0;
    world
        .drive_wall(
            floor,
            Drive::Linear {
                velocity,
                start,
                end: start + 1.0,
            },
        )
        .unwrap();
    run_until(&mut world, start + 0.3);
    let fallen = 0.5 * crate::common::G * 0.3 * 0.3;
    for (now, then) in places(&world).iter().zip(&before) {
        let depth = then.z - now.z;
        assert!(
            (depth / fallen - 1.0).abs() < 0.05,
            "{depth} m instead of {fallen} m"
        );
    }
    assert_eq!(world.awake_count(), 3);
}

/// A driven body that moves away wakes the bodies that lay on it.
#[test]
fn a_driven_support_that_leaves_wakes_its_load() {
    let mut world = World::new(sleepy()).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let (start, speed) = (4.0, 2.0);
    let support = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * (0.3 + half_edge())));
    let away = Drive::Linear {
        velocity: Vector3::z() * -speed,
        start,
        end: start + 0.1,
    };
    world.add_driven_body(support, away).unwrap();
    let load = add_cube(&mut world, shape, Vector3::z() * (0.3 + 3.0 * half_edge()));
    run_until(&mut world, start - 0.01);
    assert!(world.is_asleep(load));
    let before = world.position(load).unwrap().z;
    run_until(&mut world, start + 0.08);
    assert!(!world.is_asleep(load));
    assert!(before - world.position(load).unwrap().z > 0.01);
}

/// At the top of its flight a body is at rest for a moment without support: it must not fall asleep there,
/// however slow the flight.
#[test]
fn nothing_sleeps_in_flight() {
    let mut p = sleepy();
    p.gravity = Vector3::z() * -0.05;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let mut spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * D));
    spec.velocity = Vector3::z() * 0.02;
    let body = world.add_body(spec).unwrap();
    // It rises for 0.4 s and falls for longer.
    while world.time() < 1.0 {
        world.step().unwrap();
        assert!(
            !world.is_asleep(body),
            "asleep in flight at {} s",
            world.time()
        );
    }
    assert!(world.velocity(body).unwrap().z < 0.0);
}

/// An impact wakes the body that is hit and its neighbours, and leaves the others on the floor asleep. The
/// rule here examines every step and takes no means: with the default a sleeping body acts like a wall for
/// the few steps of a hard impact.
#[test]
fn a_hit_wakes_those_around_it() {
    let mut p = sleepy();
    p.sleeping.window = 10;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let edge = 2.0 * half_edge();
    let bottom = add_cube(&mut world, shape, Vector3::z() * (0.5 * edge));
    let top = add_cube(&mut world, shape, Vector3::z() * (1.5 * edge));
    let far = add_cube(&mut world, shape, Vector3::new(3.0, 0.0, 0.5 * edge));
    settle(&mut world, 5.0);
    let before = world.position(top).unwrap();
    let mut spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::new(-0.3, 0.0, 1.6 * edge)));
    spec.velocity = Vector3::new(2.5, 0.0, 0.6);
    let hammer = world.add_body(spec).unwrap();
    let mut woken = [false; 2];
    for _ in 0..2000 {
        world.step().unwrap();
        woken[0] |= !world.is_asleep(top);
        woken[1] |= !world.is_asleep(bottom);
        assert!(world.is_asleep(far), "the far cube woke");
    }
    assert_eq!(
        woken,
        [true, true],
        "the hammer is at {:?}",
        world.position(hammer)
    );
    assert!((world.position(top).unwrap() - before).norm() > 0.05 * D);
}

/// A cube placed on a sleeping one adds its weight to a load that is balanced without it: the sleeper wakes
/// if that weight exceeds its limit, and stays asleep otherwise.
#[test]
fn a_sleeper_wakes_under_more_than_its_share() {
    for (share_of_weight, tolerance, wakes) in [
        (0.5, 0.03, true),
        (0.1, 0.03, false),
        (0.1, 0.0072, true),
        (0.02, 0.0072, false),
    ] {
        let mut p = sleepy();
        p.sleeping.tolerance = tolerance;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let below = add_cube(&mut world, shape, Vector3::z() * half_edge());
        settle(&mut world, 5.0);
        let above = Vector3::z() * (3.0 * half_edge());
        let light = BodySpec::at_rest(shape, share_of_weight * DENSITY, at(above));
        let load = world.add_body(light).unwrap();
        let mut woken = false;
        let until = world.time() + 1.0;
        while world.time() < until && !world.is_asleep(load) {
            world.step().unwrap();
            woken |= !world.is_asleep(below);
        }
        assert_eq!(woken, wakes, "{share_of_weight} of its weight, {tolerance}");
    }
}

/// From one state at rest under a heavy lid, single walls bear the same forces within 1 % whether bodies sleep or not.
#[test]
fn sleep_does_not_change_the_forces_on_walls() {
    let mut p = sleepy();
    p.sleeping.enabled = false;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 2.3 * D, Drive::Fixed);
    add_heap(&mut world, 16, 3);
    run_until(&mut world, 4.0);
    let shape = world.shape_of(0).unwrap();
    let tops = (0..16).map(|i| world.bounds(i).unwrap().1.z);
    let top = tops.fold(f64::NEG_INFINITY, f64::max);
    let above = at(Vector3::z() * (top + 0.6 * D));
    let heavy = BodySpec::at_rest(shape, 20.0 * DENSITY, above);
    world.add_body(heavy).unwrap();
    let until = world.time() + 4.0;
    run_until(&mut world, until);
    assert!(
        world.residuals().max_over_load < 1e-3,
        "{:?}",
        world.residuals()
    );
    let forces = |world: &World| -> Vec<Vector3<f64>> {
        world
            .walls()
            .map(|(w, _)| world.wall_load(w).unwrap().total.force)
            .collect()
    };
    let mut awake = world.clone();
    let until = world.time() + 1.0;
    run_until(&mut awake, until);
    world.set_sleeping(true);
    run_until(&mut world, until);
    assert_eq!(world.awake_count(), 0);
    let (free, frozen) = (forces(&awake), forces(&world));
    for (wall, (a, b)) in free.iter().zip(&frozen).enumerate() {
        assert!(
            (a - b).norm() <= 0.01 * a.norm().max(1e-9),
            "{wall}: {a} {b}"
        );
    }
    let carried: f64 = frozen.iter().map(|f| f.z).sum();
    let weight: f64 = (0..17)
        .map(|i| world.mass(i).unwrap() * crate::common::G)
        .sum();
    assert!((carried / weight + 1.0).abs() < 1e-3, "{carried} {weight}");
}

/// What a sleeper holds back is measured by its weight, whatever it bears: under nine weights, five weights more, which are
/// less than half of its load, wake the cube between and the lowest one; a tenth of a weight wakes neither.
#[test]
fn a_loaded_sleeper_holds_back_no_more_than_a_free_one() {
    for (more, wakes) in [(5.0, true), (0.1, false)] {
        let mut p = sleepy();
        // At rest without oscillation, so that the forces balance when it falls asleep.
        p.sleeping.enabled = false;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let stack = |weights: f64, k: f64, world: &mut World| {
            let place = at(Vector3::z() * (k * half_edge()));
            let spec = BodySpec::at_rest(shape, weights * DENSITY, place);
            world.add_body(spec).unwrap()
        };
        let lowest = stack(1.0, 1.0, &mut world);
        let between = stack(9.0, 3.0, &mut world);
        run_until(&mut world, 3.0);
        world.set_sleeping(true);
        settle(&mut world, 5.0);
        stack(more, 5.0, &mut world);
        let mut woken = [false; 2];
        let until = world.time() + 2.0;
        while world.time() < until && world.awake_count() > 0 {
            world.step().unwrap();
            woken[0] |= !world.is_asleep(between);
            woken[1] |= !world.is_asleep(lowest);
        }
        assert_eq!(woken, [wakes; 2], "{more}");
    }
}

/// Nothing sleeps again after a drive before all are at rest: a cube beside one that still swings stays awake.
#[test]
fn nothing_sleeps_after_a_drive_until_all_are_at_rest() {
    let mut world = World::new(sleepy()).unwrap();
    let end = 0.01;
    let lift = Drive::Linear {
        velocity: Vector3::z() * 0.01,
        start: 0.0,
        end,
    };
    add_floor(&mut world, lift);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    add_cube(&mut world, shape, Vector3::z() * half_edge());
    let high = Vector3::new(5.0, 0.0, half_edge() + 3.0);
    let falling = add_cube(&mut world, shape, high);
    let landed = |world: &World| !world.contacts_of(falling).is_empty();
    while !landed(&world) {
        assert_eq!(world.awake_count(), 2, "asleep at {} s", world.time());
        assert!(world.time() < 2.0);
        world.step().unwrap();
    }
    settle(&mut world, 10.0);
}

/// Motion before a body came to rest is not counted: a cube that lands flat at 0.5 m/s sleeps as soon as it
/// has been at rest for the window and the steps of the rule.
#[test]
fn a_landed_body_sleeps_when_it_has_been_at_rest_for_the_window() {
    let p = sleepy();
    let rule = p.sleeping;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let mut spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * (half_edge() + 1e-3)));
    spec.velocity = Vector3::z() * -0.5;
    let body = world.add_body(spec).unwrap();
    let limit = rule.ringing() * world.mass(body).unwrap() * crate::common::G * D;
    let mut moved = 0;
    while world.awake_count() > 0 {
        world.step().unwrap();
        if world.body_kinetic_energy(body).unwrap() >= limit {
            moved = world.steps();
        }
        assert!(world.steps() < 20_000, "awake after {moved}");
    }
    let waited = world.steps() - moved;
    let asked = u64::from(rule.window) * 13 / 10;
    // The limit above is from weight and diameter alone; the load of a landing is larger.
    assert!(
        (asked..2 * asked).contains(&waited),
        "{waited} steps where {asked} are asked for"
    );
}

/// A contact that carries almost nothing may come and go on a sleeper: a cube of a hundredth of its density
/// bounces on it.
#[test]
fn a_sleeper_that_loses_a_slight_contact_sleeps_on() {
    let mut p = sleepy();
    p.sleeping.window = 10;
    p.contact.damping_ratio = 0.1;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let body = add_cube(&mut world, shape, Vector3::z() * half_edge());
    settle(&mut world, 5.0);
    let above = Vector3::z() * (3.0 * half_edge() + 1e-4);
    let light = BodySpec::at_rest(shape, 0.01 * DENSITY, at(above));
    let ball = world.add_body(light).unwrap();
    let (mut touched, mut lost) = (false, 0);
    while !world.is_asleep(ball) {
        world.step().unwrap();
        assert!(world.is_asleep(body), "awake after {lost} losses");
        let touches = world.contacts_of(body).len() == 2;
        lost += u32::from(touched && !touches);
        touched = touches;
        assert!(world.time() < 5.0);
    }
    assert!(lost >= 2, "{lost} losses");
}

/// A body on a stiff floor that is stopped whenever it slows down comes to rest at once, where it would
/// otherwise bounce for long; the removed energy is booked.
#[test]
fn stopping_at_the_turn_damps_and_books_the_energy() {
    let bounce = |stops: bool| {
        let mut p = parameters(1e6, 0.0, 0.0);
        p.time_step.safety = 0.02;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let body = add_cube(&mut world, shape, Vector3::z() * half_edge());
        let start = world.position(body).unwrap().z;
        let mut lowest = start;
        let mut last = 0.0_f64;
        for k in 0..4000 {
            world.step().unwrap();
            if stops && world.is_slowing() {
                world.stop();
                assert_eq!(world.kinetic_energy(), 0.0);
            }
            lowest = lowest.min(world.position(body).unwrap().z);
            if k >= 3000 {
                last = last.max(world.body_kinetic_energy(body).unwrap());
            }
        }
        (start - lowest, last, world.ledger())
    };
    let (free_sag, free_energy, _) = bounce(false);
    let (sag, energy, ledger) = bounce(true);
    // Without damping it sinks to twice the equilibrium and keeps oscillating.
    assert!((sag / free_sag - 0.5).abs() < 0.05, "{sag} and {free_sag}");
    assert!(energy < 1e-4 * free_energy, "{energy} and {free_energy}");
    assert!(ledger.frozen > 0.5 * free_energy, "{ledger:?}");
    let error = ledger.error().abs();
    assert!(error < 0.02 * free_energy, "{error} of {free_energy}");
}

/// A rule out of range is refused and changes nothing; one that forbids sleep wakes all.
#[test]
fn the_rule_can_be_replaced() {
    let mut world = World::new(sleepy()).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    add_cube(&mut world, shape, Vector3::z() * half_edge());
    settle(&mut world, 5.0);
    let before = world.parameters().sleeping;
    let bad = SleepParameters {
        window: 9,
        ..before
    };
    assert!(world.set_sleep_rule(bad).is_err());
    assert_eq!(world.parameters().sleeping, before);
    let strict = SleepParameters {
        tolerance: 0.01,
        ..before
    };
    world.set_sleep_rule(strict).unwrap();
    assert_eq!(world.parameters().sleeping, strict);
    assert_eq!(world.awake_count(), 0);
    let never = SleepParameters {
        enabled: false,
        ..strict
    };
    world.set_sleep_rule(never).unwrap();
    assert_eq!(world.awake_count(), 1);
}

/// If sleep is forbidden, a heap at rest stays awake.
#[test]
fn sleep_can_be_forbidden() {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    add_cube(&mut world, shape, Vector3::z() * half_edge());
    run_until(&mut world, 2.0);
    assert_eq!(world.awake(), [0]);
}

/// While all bodies sleep nothing limits the step. The step in which a floor begins to shake is as small as
/// if they had been awake.
#[test]
fn the_step_is_chosen_for_those_that_a_drive_wakes() {
    let mut p = sleepy();
    // Soft, so that the patches are large.
    p.contact.penalty = 1e5;
    let mut world = World::new(p).unwrap();
    let start = 6.0;
    let shake = Drive::Shake {
        stroke: Vector3::z() * (0.1 * D),
        frequency: 20.0,
        start,
        periods: 3,
    };
    add_floor(&mut world, shake);
    add_sides(&mut world, 2.3 * D, Drive::Fixed);
    add_heap(&mut world, 16, 2);
    settle(&mut world, start - 0.1);
    run_until(&mut world, start - 0.01);
    let unlimited = world.time_step();
    while world.awake_count() == 0 {
        let mut awake = world.clone();
        awake.wake_all();
        awake.step().unwrap();
        world.step().unwrap();
        assert!(world.time() < start + 0.01, "nothing wakes");
        if world.awake_count() > 0 {
            assert_eq!(world.time_step(), awake.time_step());
            assert!(
                world.time_step() < 0.9 * unlimited,
                "{} {}",
                world.time_step(),
                unlimited
            );
        }
    }
}

/// A body that slept on another falls when that one is knocked away, however fast.
#[test]
fn nothing_sleeps_on_without_its_support() {
    for (window, speed) in [(100, 6.0), (100, 7.5), (1000, 5.0), (1000, 9.0)] {
        let mut p = sleepy();
        p.sleeping.window = window;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let edge = 2.0 * half_edge();
        add_cube(&mut world, shape, Vector3::z() * (0.5 * edge));
        let above = add_cube(&mut world, shape, Vector3::z() * (1.5 * edge));
        settle(&mut world, 10.0);
        let beside = at(Vector3::new(-1.3 * edge, 0.0, 0.5 * edge));
        let mut striker = BodySpec::at_rest(shape, 8.0 * DENSITY, beside);
        striker.velocity.x = speed;
        world.add_body(striker).unwrap();
        let until = world.time() + 1.0;
        run_until(&mut world, until);
        let height = world.position(above).unwrap().z;
        assert!(height < 1.2 * edge, "{window} {speed}: {}", height / edge);
    }
}

/// A body that is stopped is not pushed by the dashpot forces of its earlier velocity.
#[test]
fn what_is_stopped_goes_on_from_rest() {
    let mut p = parameters(1e6, 0.0, 0.6);
    (p.gravity, p.time_step.safety) = (Vector3::zeros(), 0.1);
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let mut spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * (half_edge() + 1e-4)));
    spec.velocity.z = -1.0;
    let body = world.add_body(spec).unwrap();
    while world.contacts().is_empty() {
        world.step().unwrap();
    }
    world.step().unwrap();
    let elastic = world.contacts()[0].elastic_force;
    let damped = world.ledger().dissipated_damping;
    world.stop();
    world.step().unwrap();
    let gained = elastic * world.time_step() / world.mass(body).unwrap();
    let speed = world.velocity(body).unwrap().z;
    assert!((speed / gained - 1.0).abs() < 0.1, "{speed} {gained}");
    assert!(world.ledger().dissipated_damping >= damped);
}
