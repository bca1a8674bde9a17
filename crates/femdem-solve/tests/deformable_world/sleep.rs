//! Deformable bodies at rest are frozen, and wake when another load acts on them.

use super::{block, on_threads};
use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_fem::{Boundary, Selection};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, SleepParameters, World, WorldParameters,
};

/// Edge of a cube, m.
const EDGE: f64 = 0.1;
const WEIGHT: f64 = 1000.0 * EDGE * EDGE * EDGE * 9.81;

/// Parameters with which deformable bodies sleep.
fn sleepy() -> WorldParameters {
    let mut p = WorldParameters::default();
    p.sleeping.deformables = true;
    p
}

/// A floor, a model of cubes, and a column of one cube per given gap (m).
fn column(element: Element, gaps: &[f64]) -> World {
    column_with(sleepy(), element, gaps)
}

fn column_with(p: WorldParameters, element: Element, gaps: &[f64]) -> World {
    let mut world = World::new(p).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let cells = if element == Element::T4 { 2 } else { 1 };
    let model = block([cells; 3], [EDGE; 3], element, 1e6);
    let model = world
        .add_model("cube", model, ContactStiffness::default())
        .unwrap();
    let mut top = 0.0;
    for gap in gaps {
        let place = Pose::translation(0.0, 0.0, top + gap + 0.5 * EDGE);
        world
            .add_deformable(DeformableSpec::at_rest(model, place))
            .unwrap();
        top += gap + EDGE;
    }
    world
}

fn step_for(world: &mut World, time: f64) {
    let until = world.time() + time;
    while world.time() < until {
        world.step().unwrap();
    }
}

/// Steps until all deformable bodies are frozen.
fn settle(world: &mut World, within: f64) {
    let until = world.time() + within;
    while world.awake_deformable_count() > 0 {
        world.step().unwrap();
        assert!(
            world.time() < until,
            "{} are awake",
            world.awake_deformable_count()
        );
    }
}

/// Heights of the lowest and the highest node, m.
fn reach(world: &World, id: u32) -> [f64; 2] {
    let body = world.deformable(id).unwrap();
    let heights = || body.positions().iter().map(|x| x.z);
    [
        heights().fold(f64::MAX, f64::min),
        heights().fold(f64::MIN, f64::max),
    ]
}

/// Falling bodies fall asleep in equilibrium: the floor carries them, sleepers are motionless, the ledger
/// closes, and woken for good they stay in place.
#[test]
fn a_column_falls_asleep_in_equilibrium() {
    for element in [Element::T4, Element::T10] {
        let mut world = column(element, &[0.002, 0.001]);
        let mut before = 0.0;
        while world.ledger().frozen == 0.0 {
            before = world.ledger().error();
            step_for(&mut world, 0.01);
        }
        settle(&mut world, 3.0);
        // The forces of all contacts with the bodies at rest.
        world.step().unwrap();
        assert_eq!(world.kinetic_energy(), 0.0);
        let floor = -world.wall_load(0).unwrap().total.force.z;
        // The imbalance of a sleeper may be 6 % of its load scale, which is 1 and 1.5 weights.
        let error = (floor / WEIGHT - 2.0).abs();
        assert!(error < 0.06 * 2.5, "{element:?} {floor}");
        let ledger = world.ledger();
        let lost = ledger.error() - before;
        assert!(lost.abs() < 0.01 * ledger.frozen, "{lost} {ledger:?}");
        let before = [0, 1].map(|i| reach(&world, i)[0]);
        world.set_sleeping(false);
        step_for(&mut world, 0.2);
        for (i, z) in (0..).zip(before) {
            // The same imbalances over the stiffness with which a cube's weight penetrates by 120 um.
            let moved = reach(&world, i)[0] - z;
            assert!(
                moved.abs() < 0.06 * 2.5 * 120e-6,
                "{element:?}: {i} moves by {moved}"
            );
        }
    }
}

/// A sleeper that is struck wakes and deforms like one that never slept.
#[test]
fn a_blow_wakes_a_sleeper() {
    let strike = |sleeps: bool| {
        let mut world = column(Element::T4, &[0.001]);
        settle(&mut world, 2.0);
        if !sleeps {
            world.set_sleeping(false);
        }
        let fall = DeformableSpec {
            velocity: Vector3::new(0.0, 0.0, -0.5),
            ..DeformableSpec::at_rest(0, Pose::translation(0.0, 0.0, 1.5 * EDGE + 1e-4))
        };
        world.add_deformable(fall).unwrap();
        step_for(&mut world, 0.01);
        let body = world.deformable(0).unwrap();
        assert!(!body.is_asleep());
        body.internal().energy
    };
    let (slept, awake) = (strike(true), strike(false));
    assert!((slept / awake - 1.0).abs() < 0.04, "{slept} {awake}");
}

/// A rigid body that is placed on a sleeper wakes it; one of a hundredth of its weight does not.
#[test]
fn a_load_wakes_a_sleeper_and_a_trifle_does_not() {
    for (density, wakes) in [(1000.0, true), (10.0, false)] {
        let mut world = column(Element::T4, &[0.001]);
        settle(&mut world, 2.0);
        let cube = "P5".parse::<CatalogueShape>().unwrap();
        let cube = cube.polyhedron(EDGE * 3_f64.sqrt()).unwrap();
        let shape = world.add_shape("cube", &cube).unwrap();
        let place = Pose::translation(0.0, 0.0, reach(&world, 0)[1] + 0.5 * EDGE);
        world
            .add_body(BodySpec::at_rest(shape, density, place))
            .unwrap();
        let mut woke = false;
        let until = world.time() + 0.1;
        while world.time() < until {
            world.step().unwrap();
            woke |= world.awake_deformable_count() > 0;
        }
        assert_eq!(woke, wakes, "{density}");
        assert!(world.position(1).unwrap().z > 1.4 * EDGE);
    }
}

/// Rigid and deformable bodies on each other fall asleep together, carry the weights above them, and all wake
/// when the uppermost is struck.
#[test]
fn a_mixed_column_sleeps_and_wakes() {
    let mut world = column(Element::T4, &[EDGE + 0.001]);
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(EDGE * 3_f64.sqrt()).unwrap();
    let shape = world.add_shape("cube", &cube).unwrap();
    let at = |z: f64| BodySpec::at_rest(shape, 1000.0, Pose::translation(0.0, 0.0, z));
    let below = world.add_body(at(0.5 * EDGE)).unwrap();
    let above = world.add_body(at(2.5 * EDGE + 0.002)).unwrap();
    let all_sleep = |world: &World| world.awake_count() + world.awake_deformable_count() == 0;
    while !all_sleep(&world) {
        world.step().unwrap();
        assert!(world.time() < 3.0, "{:?} are awake", world.awake());
    }
    for _ in 0..10 {
        world.step().unwrap();
    }
    assert!(all_sleep(&world) && world.kinetic_energy() == 0.0);
    // The tolerated imbalance of a rigid sleeper is larger than that of a deformable one.
    for id in [above, below] {
        let load = world.load(id).unwrap().total.force.z / WEIGHT;
        assert!((load - 1.0).abs() < 0.3, "{id}: {load}");
    }
    let places = [below, above].map(|id| world.position(id).unwrap());
    let fall = BodySpec {
        velocity: Vector3::new(0.0, 0.0, -1.0),
        ..at(3.5 * EDGE + 0.001)
    };
    world.add_body(fall).unwrap();
    let (mut woken, until) = (false, world.time() + 0.05);
    while world.time() < until {
        world.step().unwrap();
        woken |= world.awake_count() == 3 && world.awake_deformable_count() == 1;
    }
    assert!(woken);
    for (id, place) in [below, above].into_iter().zip(places) {
        assert!(world.position(id).unwrap() != place, "{id}");
    }
}

/// Bodies without contacts, with boundary conditions, or in motion do not sleep; nor does any body unless
/// sleep is enabled.
#[test]
fn what_does_not_rest_stays_awake() {
    let mut world = column(Element::T4, &[0.5]);
    step_for(&mut world, 0.2);
    assert_eq!(world.awake_deformable_count(), 1, "falls");
    settle(&mut world, 3.0);
    let mut boundary = Boundary::default();
    let body = world.deformable(0).unwrap();
    let (node, model, places) = (Selection::Nodes(vec![0]), body.model(), body.positions());
    boundary
        .drive_from(model, &node, [true; 3], Drive::Fixed, places)
        .unwrap();
    world.set_boundary(0, boundary).unwrap();
    step_for(&mut world, 0.2);
    assert_eq!(world.awake_deformable_count(), 1, "held");

    let mut world = column(Element::T4, &[0.001]);
    let rule = SleepParameters::default();
    assert!(rule.enabled && !rule.deformables);
    world.set_sleep_rule(rule).unwrap();
    step_for(&mut world, 2.0);
    assert_eq!(world.awake_deformable_count(), 1, "by default");
}

/// A wall that begins to move wakes bodies that sleep on it.
#[test]
fn a_moving_wall_wakes_sleepers() {
    let mut world = column(Element::T4, &[0.001]);
    settle(&mut world, 2.0);
    let start = world.time() + 0.05;
    let lift = Drive::Linear {
        velocity: Vector3::new(0.0, 0.0, 0.2),
        start,
        end: start + 0.1,
    };
    world.drive_wall(0, lift).unwrap();
    let before = reach(&world, 0)[0];
    step_for(&mut world, 0.2);
    assert!((reach(&world, 0)[0] - before - 0.02).abs() < 1e-3);
}

/// Adds a rigid cube as large as the deformable ones.
fn add_rigid(world: &mut World, x: f64, z: f64) -> u32 {
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(EDGE * 3_f64.sqrt()).unwrap();
    let shape = world.add_shape("cube", &cube).unwrap();
    let place = Pose::translation(x, 0.0, z);
    world
        .add_body(BodySpec::at_rest(shape, 1000.0, place))
        .unwrap()
}

/// A body that is carried so slowly that it might count as resting is not stopped on the way: the ledger
/// loses nothing, and the support works only against the contact force. Tested on a wall, and on nodes that
/// move as prescribed.
#[test]
fn what_is_carried_slowly_does_not_fall_asleep() {
    for by_wall in [true, false] {
        let mut world = column(Element::T4, &[0.001, 0.001]);
        let rigid = add_rigid(&mut world, 0.0, 2.5 * EDGE + 0.003);
        settle(&mut world, 3.0);
        let start = world.time() + 0.01;
        let drive = Drive::Linear {
            velocity: Vector3::new(0.002, 0.0, 0.0),
            start,
            end: start + 10.0,
        };
        if by_wall {
            world.drive_wall(0, drive).unwrap();
        } else {
            let body = world.deformable(0).unwrap();
            let all = Selection::Nodes((0..body.positions().len() as u32).collect());
            let mut boundary = Boundary::default();
            boundary
                .drive_from(body.model(), &all, [true; 3], drive, body.positions())
                .unwrap();
            world.set_boundary(0, boundary).unwrap();
        }
        let places = |world: &World| {
            let deformable = world.deformable(1).unwrap().centroid();
            [deformable, world.position(rigid).unwrap()]
        };
        let (before, frozen) = (places(&world), world.ledger().frozen);
        step_for(&mut world, 0.51);
        assert_eq!(world.ledger().frozen, frozen, "{by_wall}");
        for (now, before) in places(&world).into_iter().zip(before) {
            let way = now.x - before.x;
            assert!((way - 0.001).abs() < 1e-4, "{by_wall}: {way}");
        }
    }
}

/// Between taps bodies sleep.
#[test]
fn bodies_sleep_between_taps() {
    let mut world = column(Element::T4, &[0.001]);
    let rigid = add_rigid(&mut world, 0.0, 1.5 * EDGE + 0.002);
    settle(&mut world, 3.0);
    let tap = Drive::Tap {
        stroke: Vector3::new(0.0, 0.0, 1e-4),
        frequency: 50.0,
        start: world.time() + 0.1,
        interval: 1.0,
        taps: 2,
    };
    world.drive_wall(0, tap).unwrap();
    for tap in 0..2 {
        step_for(&mut world, 0.12);
        assert!(
            world.awake_deformable_count() == 1 && !world.is_asleep(rigid),
            "{tap}"
        );
        step_for(&mut world, 0.8);
        assert!(
            world.awake_deformable_count() == 0 && world.is_asleep(rigid),
            "{tap}"
        );
        step_for(&mut world, 0.08);
    }
}

/// A body that slides slowly without friction is not at rest: it keeps sliding, at whichever step the
/// rule is replaced by one of a shorter window.
#[test]
fn a_slow_slide_is_no_rest() {
    let mut p = sleepy();
    p.contact.friction = 0.0;
    let mut world = column_with(p, Element::T4, &[0.001]);
    settle(&mut world, 3.0);
    let slide = DeformableSpec {
        velocity: Vector3::new(0.01, 0.0, 0.0),
        ..DeformableSpec::at_rest(0, Pose::translation(0.0, 1.0, 0.5 * EDGE - 1e-4))
    };
    let slider = world.add_deformable(slide).unwrap();
    step_for(&mut world, 0.7);
    let rule = SleepParameters {
        window: 40,
        ..world.parameters().sleeping
    };
    for phase in 0..5 {
        let mut world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
        for _ in 0..25 * phase {
            world.step().unwrap();
        }
        world.set_sleep_rule(rule).unwrap();
        for _ in 0..200 {
            world.step().unwrap();
        }
        let momentum = world.deformable(slider).unwrap().momentum().x;
        assert!((momentum - 0.01).abs() < 1e-4, "{phase}: {momentum}");
    }
}

/// A rigid body does not sleep on an awake deformable one, however short its rule.
#[test]
fn a_rigid_body_waits_for_what_deforms_beneath_it() {
    let mut p = WorldParameters::default();
    p.sleeping.window = 10;
    let mut world = column_with(p, Element::T4, &[0.001]);
    let rigid = add_rigid(&mut world, 0.0, 1.5 * EDGE + 0.002);
    for _ in 0..6000 {
        world.step().unwrap();
        assert!(!world.is_asleep(rigid), "{}", world.time());
    }
    assert!(world.kinetic_energy() < 1e-6 * WEIGHT * EDGE);
}

/// Sleepers continue bit for bit after a checkpoint, also one right after a body fell asleep, and with any
/// number of threads.
#[test]
fn sleepers_have_the_same_bits() {
    let run = |threads: usize, split: bool| {
        on_threads(threads, || {
            let mut world = column(Element::T4, &[0.002, 0.001]);
            let (mut slept, mut woken) = (false, false);
            for k in 0..4000 {
                let before = world.awake_deformable_count();
                world.step().unwrap();
                let falls_asleep = world.awake_deformable_count() < before;
                if split && (k % 750 == 0 || falls_asleep) {
                    world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
                }
                slept |= world.awake_deformable_count() < before;
                woken |= world.awake_deformable_count() > before;
                if k == 3200 {
                    let place = Pose::translation(0.02, 0.0, 2.6 * EDGE);
                    world
                        .add_deformable(DeformableSpec::at_rest(0, place))
                        .unwrap();
                }
            }
            assert!(slept && woken, "{slept} {woken}");
            world.to_bytes().unwrap()
        })
    };
    let one = run(1, false);
    assert!(one == run(3, false), "threads");
    assert!(one == run(2, true), "checkpoint");
}
