//! Contact laws of pairs of materials: what slides, rebounds, rolls and sinks in as its own pair does, in one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, add_heap, add_sides, at, half_edge, parameters, pose, run_until,
    solid, weightless,
};
use femdem_contact::{BodyId, ContactParameters, MaterialId, Wall};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::{Rotation, TetMesh};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, ImplicitStep, SleepParameters, World,
    WorldParameters,
};
use std::f64::consts::PI;

/// Of a floor or a wall, and of what lies on it.
const GROUND: MaterialId = MaterialId(3);
const KINDS: [MaterialId; 2] = [MaterialId(1), MaterialId(2)];

/// A floor of its own material, on which two kinds of bodies have their laws.
fn two_laws(p: WorldParameters, change: impl Fn(&mut ContactParameters, usize)) -> World {
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    world.set_wall_material(0, GROUND).unwrap();
    for (k, kind) in KINDS.into_iter().enumerate() {
        let mut law = p.contact;
        change(&mut law, k);
        world.set_law(GROUND, kind, law).unwrap();
    }
    world
}

/// One body of each kind, side by side on the floor or above it.
fn one_of_each(world: &mut World, shape: u32, height: f64, velocity: Vector3<f64>) -> [BodyId; 2] {
    [0, 1].map(|k| {
        let place = Vector3::new(0.0, 3.0 * D * k as f64, height);
        let spec = BodySpec {
            velocity,
            material: KINDS[k],
            ..BodySpec::at_rest(shape, DENSITY, at(place))
        };
        world.add_body(spec).unwrap()
    })
}

/// Gravity on a floor that is turned by a slope, degrees.
fn on_slope(slope: f64, contact: ContactParameters) -> WorldParameters {
    let (sin, cos) = slope.to_radians().sin_cos();
    WorldParameters {
        contact,
        gravity: Vector3::new(sin, 0.0, -cos) * G,
        ..weightless(1e7, 0.0, 0.6)
    }
}

fn friction(mu: f64) -> ContactParameters {
    ContactParameters {
        penalty: 1e7,
        friction: mu,
        ..ContactParameters::default()
    }
}

/// On a ramp of 20 degrees the cube whose pair has 0.2 slides with g (sin - 0.2 cos), that with 0.5 sticks, whatever the
/// default law says; by explicit and by implicit steps.
#[test]
fn one_cube_slides_and_one_sticks() {
    for usual in [0.05, 0.9] {
        for implicit in [None, Some(ImplicitStep::default())] {
            let mut p = on_slope(20.0, friction(usual));
            p.time_step.implicit = implicit;
            let mut world = two_laws(p, |law, k| law.friction = [0.2, 0.5][k]);
            let shape = world.add_shape("P5", &solid("P5")).unwrap();
            let sunk = half_edge() - 2e-6;
            let ids = one_of_each(&mut world, shape, sunk, Vector3::zeros());
            run_until(&mut world, 0.05);
            let (time, before) = (world.time(), ids.map(|id| world.velocity(id).unwrap().x));
            run_until(&mut world, 0.35);
            let speed = ids.map(|id| world.velocity(id).unwrap().x);
            let got = (speed[0] - before[0]) / (world.time() - time);
            let (sin, cos) = 20_f64.to_radians().sin_cos();
            let want = G * (sin - 0.2 * cos);
            assert!((got / want - 1.0).abs() < 2e-3, "{usual}: {got} for {want}");
            assert!(speed[1].abs() < 1e-4, "{usual}: {}", speed[1]);
        }
    }
}

/// Two cubes hit one wall: the published restitutions of their damping ratios, 0.7441 for 0.1 and 0.2488 for 0.6.
#[test]
fn two_restitutions_on_one_wall() {
    let mut p = weightless(1e7, 0.0, 0.3);
    p.time_step.safety = 0.1;
    let mut world = two_laws(p, |law, k| law.damping_ratio = [0.1, 0.6][k]);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let ids = one_of_each(&mut world, shape, half_edge() + 1e-4, -Vector3::z());
    run_until(&mut world, 0.02);
    assert!(world.contacts().is_empty());
    for (id, want) in ids.into_iter().zip([0.7441, 0.2488]) {
        let got = world.velocity(id).unwrap().z;
        assert!((got / want - 1.0).abs() < 0.02, "{got} for {want}");
    }
}

/// Balls on a slope of 20 degrees: 5/7 g sin without rolling friction, 5/7 g (sin - 0.1 cos) with 0.1.
#[test]
fn one_ball_rolls_harder() {
    let mut p = on_slope(20.0, friction(0.6));
    p.contact.penalty = 1e6;
    let mut world = two_laws(p, |law, k| law.rolling_friction = [0.0, 0.1][k]);
    let ball = world.add_sphere("ball", 0.01).unwrap();
    let ids = one_of_each(&mut world, ball, 0.009_975, Vector3::zeros());
    run_until(&mut world, 0.5);
    let (sin, cos) = 20_f64.to_radians().sin_cos();
    for (id, share) in ids.into_iter().zip([sin, sin - 0.1 * cos]) {
        let got = world.velocity(id).unwrap().x / world.time();
        let want = 5.0 / 7.0 * G * share;
        assert!((got - want).abs() < 0.01 * want, "{got} for {want}");
    }
}

/// How deep a body lies in a floor, for two penalties in one world. A face of the area A in a field of the depth h has the
/// energy 2 p A d^2/(2 h), and rests at d = m g h/(2 p A). A ball has at the distance a from the pole the depth
/// d - a^2/(2 R), where the wall presses it with 2 p/R times that: F = 2 p/R pi R d^2 = 2 pi p d^2, and it rests at
/// d = sqrt(m g/(2 pi p)).
#[test]
fn depths_go_with_the_penalty_of_the_pair() {
    let penalties = [1e6, 1.6e7];
    for ball in [false, true] {
        let mut world = two_laws(parameters(3e5, 0.5, 0.6), |law, k| {
            law.penalty = penalties[k]
        });
        let (shape, half) = if ball {
            (world.add_sphere("ball", 0.5 * D).unwrap(), 0.5 * D)
        } else {
            (world.add_shape("P5", &solid("P5")).unwrap(), half_edge())
        };
        let ids = one_of_each(&mut world, shape, half, Vector3::zeros());
        run_until(&mut world, 1.0);
        let depths = ids.map(|id| half - world.position(id).unwrap().z);
        for k in 0..2 {
            let weight = world.mass(ids[k]).unwrap() * G;
            let want = if ball {
                (weight / (2.0 * PI * penalties[k])).sqrt()
            } else {
                weight * half / (2.0 * penalties[k] * (2.0 * half).powi(2))
            };
            assert!(
                (depths[k] / want - 1.0).abs() < 0.02,
                "{ball} {k}: {} for {want}",
                depths[k]
            );
        }
        let ratio = if ball { 4.0 } else { 16.0 };
        assert!(
            (depths[0] / depths[1] / ratio - 1.0).abs() < 0.02,
            "{depths:?}"
        );
    }
}

/// A pair of bodies that is a thousand times as stiff as the default needs steps as much shorter as the root of that, from
/// before they meet, and keeps its energy but for the jump of a face's force in the step of the touch; the step is below the
/// measured limit.
#[test]
fn steps_are_stable_for_the_stiffest_pair() {
    let mut p = weightless(1e5, 0.0, 0.0);
    p.time_step.safety = 0.3;
    let mut steps = [0.0; 2];
    for (k, penalty) in [1e5, 1e8].into_iter().enumerate() {
        let mut world = World::new(p).unwrap();
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let law = ContactParameters {
            penalty,
            ..p.contact
        };
        world.set_law(KINDS[0], KINDS[1], law).unwrap();
        let spec = |side: usize| BodySpec {
            velocity: Vector3::z() * [0.5, -0.5][side],
            material: KINDS[side],
            ..BodySpec::at_rest(
                shape,
                DENSITY,
                at(Vector3::z() * (2.0 * half_edge() + 1e-5) * side as f64),
            )
        };
        for side in 0..2 {
            world.add_body(spec(side)).unwrap();
        }
        world.step().unwrap();
        steps[k] = world.time_step();
        let (start, mut most, mut used) = (world.kinetic_energy(), 0.0_f64, 0.0_f64);
        while most == 0.0 || !world.contacts().is_empty() {
            world.step().unwrap();
            let contacts = world.contacts();
            let stored: f64 = contacts.iter().map(|c| c.energy).sum();
            most = most.max((stored + world.kinetic_energy()) / start);
            if most > 0.0 && stored > 0.0 && used == 0.0 {
                used = world.stability().unwrap().unwrap().used();
            }
        }
        assert!((0.01..1.0).contains(&used), "{used}");
        assert!(most < 1.15, "{most}");
        let rest = world.kinetic_energy() / start;
        assert!((rest - 1.0).abs() < 0.1, "{rest}");
    }
    let ratio = steps[0] / steps[1];
    assert!((ratio / 1000_f64.sqrt() - 1.0).abs() < 0.02, "{steps:?}");
}

fn rubber(sides: [f64; 3]) -> DeformableModel {
    let mesh = TetMesh::block([2, 2, 2], &Vector3::from(sides)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e6, 0.3).unwrap().into(),
        density: 1000.0,
    };
    DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap()
}

/// A rubber block between two walls that run past it: one drags it with 0.2, the other with 0.5 of its pressure.
#[test]
fn two_walls_rub_a_deformable_body() {
    let mut world = World::new(weightless(1e6, 0.9, 0.6)).unwrap();
    let velocity = Vector3::y() * 5.0;
    let run = Drive::Linear {
        velocity,
        start: 0.0,
        end: 1.0,
    };
    for (k, mu) in [0.2, 0.5].into_iter().enumerate() {
        let sign = 1.0 - 2.0 * k as f64;
        let wall = Wall::half_space(&format!("wall {k}"), Vector3::x() * sign, -0.0499).unwrap();
        let wall = world.add_wall(wall, run).unwrap();
        world.set_wall_material(wall, KINDS[k]).unwrap();
        let law = ContactParameters {
            friction: mu,
            ..world.parameters().contact
        };
        world.set_law(KINDS[k], GROUND, law).unwrap();
    }
    let model = world
        .add_model("rubber", rubber([0.1; 3]), ContactStiffness::default())
        .unwrap();
    let spec = DeformableSpec {
        material: GROUND,
        ..DeformableSpec::at_rest(model, at(Vector3::repeat(-0.05)))
    };
    let body = world.add_deformable(spec).unwrap();
    assert_eq!(world.material(body), Some(GROUND));
    run_until(&mut world, 2e-3);
    for (wall, mu) in [(0, 0.2), (1, 0.5)] {
        let force = world.wall_load(wall).unwrap().total.force;
        let got = -force.y / force.x.abs();
        assert!(force.x.abs() > 0.1, "{force}");
        assert!((got / mu - 1.0).abs() < 1e-5, "{got} for {mu}");
    }
    // Both with the first material: both with its friction, after the next step.
    world.set_wall_material(1, KINDS[0]).unwrap();
    run_until(&mut world, 2.2e-3);
    let force = world.wall_load(1).unwrap().total.force;
    assert!(
        (-force.y / force.x.abs() / 0.2 - 1.0).abs() < 1e-5,
        "{force}"
    );
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 0.01, "{ledger:?}");
}

/// A heap, rigid and deformable bodies of three materials between walls, for laws that are given to the pairs.
fn heap(laws: impl Fn(usize) -> Option<ContactParameters>) -> World {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 2.2 * D, Drive::Fixed);
    let ids = add_heap(&mut world, 8, 2);
    let model = world
        .add_model("rubber", rubber([0.1; 3]), ContactStiffness::Law)
        .unwrap();
    let above = DeformableSpec::at_rest(model, at(Vector3::new(0.11, 0.11, 0.36)));
    let soft = world.add_deformable(above).unwrap();
    let kinds = [0, 1, 2].map(MaterialId);
    for (k, id) in ids.into_iter().enumerate() {
        world.set_material(id, kinds[k % 3]).unwrap();
    }
    world.set_wall_material(0, kinds[2]).unwrap();
    world.set_material(soft, kinds[1]).unwrap();
    let mut pair = 0;
    for (i, a) in kinds.into_iter().enumerate() {
        for b in kinds.into_iter().take(i + 1) {
            if let Some(law) = laws(pair) {
                world.set_law(a, b, law).unwrap();
            }
            pair += 1;
        }
    }
    world
}

/// All that moves, with every bit: these numbers are printed so that no two of them look alike.
fn bits(world: &World) -> String {
    let bodies = world.body_ids();
    let poses: Vec<_> = bodies
        .map(|id| {
            (
                world.pose(id),
                world.velocity(id),
                world.angular_velocity(id),
            )
        })
        .collect();
    let nodes: Vec<_> = world
        .deformables()
        .map(|d| d.positions().to_vec())
        .collect();
    let soft: Vec<_> = world.deformable_contacts().collect();
    format!(
        "{poses:?} {nodes:?} {:?} {soft:?} {:?}",
        world.contacts(),
        world.ledger()
    )
}

/// A table that is full of equal laws changes no bit; one of different laws does.
#[test]
fn a_table_of_equal_laws_changes_no_bit() {
    let usual = parameters(1e6, 0.6, 0.6).contact;
    let run = |laws: &dyn Fn(usize) -> Option<ContactParameters>| {
        let mut world = heap(laws);
        run_until(&mut world, 0.25);
        assert!(world.contacts().len() > 8 && world.deformable_contacts().count() > 0);
        bits(&world)
    };
    let one = run(&|_| None);
    assert_eq!(run(&|_| Some(usual)), one);
    let friction = |k: usize| 0.1 * (k as f64 + 1.0);
    let mixed = run(&|k| {
        Some(ContactParameters {
            friction: friction(k),
            ..usual
        })
    });
    assert_ne!(mixed, one);
}

/// The numbers of materials are names: others, in the middle of a run, change nothing else.
#[test]
fn materials_with_other_numbers_change_no_bit() {
    let law = |k: usize| Some(friction(0.1 + 0.2 * k as f64));
    let mut as_it_was = heap(law);
    let mut renumbered = heap(law);
    for world in [&mut as_it_was, &mut renumbered] {
        for _ in 0..200 {
            world.step().unwrap();
        }
    }
    let most = renumbered
        .body_ids()
        .filter_map(|id| renumbered.material(id));
    let most = usize::from(most.map(|id| id.0).max().unwrap().max(GROUND.0));
    let others: Vec<MaterialId> = (0..=most)
        .map(|k| MaterialId((7 * (most - k) + 3) as u8))
        .collect();
    let error = renumbered
        .renumber_materials(&others[..1])
        .unwrap_err()
        .to_string();
    assert!(error.contains("material"), "{error}");
    let twice = vec![MaterialId(4); most + 1];
    assert!(renumbered.renumber_materials(&twice).is_err());
    renumbered.renumber_materials(&others).unwrap();
    for world in [&mut as_it_was, &mut renumbered] {
        for _ in 0..200 {
            world.step().unwrap();
        }
    }
    for id in as_it_was.body_ids() {
        let (old, new) = (
            as_it_was.material(id).unwrap(),
            renumbered.material(id).unwrap(),
        );
        assert_eq!(new, others[usize::from(old.0)]);
        let states = [&as_it_was, &renumbered].map(|w| (w.position(id), w.velocity(id)));
        assert_eq!(states[0], states[1]);
    }
}

/// Laws and materials are part of the state: read from bytes in the middle, a heap with a law for each pair goes on with the
/// same bits.
#[test]
fn a_world_of_many_laws_goes_on_from_bytes() {
    let usual = parameters(1e6, 0.6, 0.6).contact;
    let law = |k: usize| ContactParameters {
        penalty: 1e6 * (1.0 + k as f64),
        friction: 0.1 * k as f64,
        damping_ratio: 0.1 + 0.1 * k as f64,
        ..usual
    };
    let mut straight = heap(|k| Some(law(k)));
    run_until(&mut straight, 0.1);
    let mut broken = World::from_bytes(&straight.to_bytes().unwrap()).unwrap();
    assert_eq!(broken.laws(), straight.laws());
    for _ in 0..200 {
        straight.step().unwrap();
        broken.step().unwrap();
    }
    assert_eq!(broken.state_hash().unwrap(), straight.state_hash().unwrap());
}

/// Runs until all that moves has died out, and on until all bodies sleep.
fn come_to_rest(world: &mut World) {
    let rule = world.parameters().sleeping;
    for enabled in [false, true] {
        world
            .set_sleep_rule(SleepParameters { enabled, ..rule })
            .unwrap();
        let time = world.time();
        run_until(world, time + 0.2);
    }
    assert_eq!(world.awake_count(), 0);
}

/// Cubes at rest, one on another: a law and materials that are changed by hand keep the ledger, wake what they touch, and act.
#[test]
fn laws_and_materials_change_by_hand() {
    let mut p = on_slope(10.0, friction(0.3));
    p.time_step.safety = 0.1;
    let mut world = World::new(p).unwrap();
    let floor = add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let ids = [0.0, 1.0].map(|k| {
        let place = at(Vector3::z() * half_edge() * (2.0 * k + 1.0));
        world
            .add_body(BodySpec::at_rest(shape, DENSITY, place))
            .unwrap()
    });
    let closes = |world: &World| {
        let ledger = world.ledger();
        assert!(ledger.error_relative().abs() < 2e-3, "{ledger:?}");
    };
    come_to_rest(&mut world);
    // A stiffer law of its own for the pair: nothing yet is of that material.
    let law = ContactParameters {
        penalty: 4e7,
        ..p.contact
    };
    world.set_law(KINDS[0], MaterialId::default(), law).unwrap();
    come_to_rest(&mut world);
    let depth = |world: &World| {
        let contact = world.contacts_of(ids[1])[0];
        (contact.penetration(), contact.energy)
    };
    let before = depth(&world);
    let springs_before = world.contacts_of(ids[1])[0].spring_energy;
    let work = world.ledger().work_in;
    world.set_material(ids[1], KINDS[0]).unwrap();
    assert!(!world.is_asleep(ids[0]) && !world.is_asleep(ids[1]));
    // At the same place the pair stores four times as much; its friction springs keep their force, with a quarter of the energy.
    let (gained, springs) = (world.ledger().work_in - work, springs_before);
    let want = 3.0 * before.1 - 0.75 * springs;
    assert!((gained / want - 1.0).abs() < 1e-6, "{gained} {want}");
    come_to_rest(&mut world);
    let after = depth(&world);
    assert!(
        (before.0 / after.0 / 4.0 - 1.0).abs() < 0.01,
        "{before:?} {after:?}"
    );
    closes(&world);
    // Ice under the lower cube: both go, and the upper one rides.
    let ice = ContactParameters {
        friction: 0.05,
        ..p.contact
    };
    world.set_law(KINDS[1], MaterialId::default(), ice).unwrap();
    come_to_rest(&mut world);
    world.set_wall_material(floor, KINDS[1]).unwrap();
    assert!(!world.is_asleep(ids[0]));
    let speeds = |world: &World| ids.map(|id| world.velocity(id).unwrap().x);
    let start = world.time();
    run_until(&mut world, start + 0.1);
    let (time, early) = (world.time(), speeds(&world));
    run_until(&mut world, start + 0.3);
    let (sin, cos) = 10_f64.to_radians().sin_cos();
    let want = G * (sin - 0.05 * cos) * (world.time() - time);
    for (early, late) in early.into_iter().zip(speeds(&world)) {
        let got = late - early;
        assert!((got / want - 1.0).abs() < 0.01, "{got} for {want}");
    }
    closes(&world);
    // The usual law again holds them.
    world
        .set_law(KINDS[1], MaterialId::default(), None)
        .unwrap();
    let start = world.time();
    run_until(&mut world, start + 0.5);
    assert!(speeds(&world).iter().all(|speed| speed.abs() < 1e-3));
    closes(&world);
}

/// Laws that are none, bodies and walls that are none, and rolling friction under implicit steps are refused by name, and
/// nothing changes.
#[test]
fn what_cannot_be_is_refused() {
    let mut world = two_laws(parameters(1e6, 0.6, 0.6), |_, _| {});
    let before = world.state_hash().unwrap();
    let usual = world.parameters().contact;
    let bad = ContactParameters {
        friction: -1.0,
        ..usual
    };
    let refused = world.set_law(GROUND, GROUND, bad).unwrap_err().to_string();
    assert!(refused.contains("friction = -1"), "{refused}");
    for refused in [
        world.set_material(0, GROUND),
        world.set_wall_material(1, GROUND),
    ] {
        assert!(refused.unwrap_err().to_string().contains("there is no"));
    }
    assert_eq!(world.state_hash().unwrap(), before);
    assert_eq!((world.material(0), world.wall_material(7)), (None, None));
    let rolls = ContactParameters {
        rolling_friction: 0.1,
        ..usual
    };
    let mut implicit = world.parameters().time_step;
    implicit.implicit = Some(ImplicitStep::default());
    let mut other = world.clone();
    other.set_law(GROUND, GROUND, rolls).unwrap();
    let refused = other.set_time_step(implicit).unwrap_err().to_string();
    assert!(
        refused.contains("rolling_friction with time_step.implicit = 0.1"),
        "{refused}"
    );
    world.set_time_step(implicit).unwrap();
    assert!(world.set_law(GROUND, GROUND, rolls).is_err());
    assert_eq!(world.laws().between([GROUND; 2]).rolling_friction, 0.0);
}

/// Relaxation leaves the laws as they were, and finds for each pair the depth of its own.
#[test]
fn relaxation_keeps_the_laws() {
    let mut world = two_laws(parameters(1e6, 0.6, 0.6), |law, k| {
        law.penalty = [1e6, 4e6][k]
    });
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let ids = one_of_each(&mut world, shape, half_edge() - 1e-5, Vector3::zeros());
    let laws = world.laws().clone();
    world.relax(&Default::default()).unwrap();
    assert_eq!(world.laws(), &laws);
    let depths = ids.map(|id| half_edge() - world.position(id).unwrap().z);
    assert!(
        (depths[0] / depths[1] / 4.0 - 1.0).abs() < 0.01,
        "{depths:?}"
    );
}

/// A body of which the model takes its stiffness from the law has that of its own material.
#[test]
fn deformable_bodies_have_the_penalty_of_their_material() {
    let mut world = two_laws(parameters(1e6, 0.3, 0.6), |_, _| {});
    let law = ContactParameters {
        penalty: 9e6,
        ..world.parameters().contact
    };
    world.set_law(KINDS[1], KINDS[1], law).unwrap();
    let model = world
        .add_model("rubber", rubber([0.1; 3]), ContactStiffness::Law)
        .unwrap();
    let ids = [0, 1].map(|k| {
        let place = pose(
            Vector3::new(0.0, 0.3 * k as f64, -1e-5),
            Rotation::identity(),
        );
        let spec = DeformableSpec {
            material: KINDS[k],
            ..DeformableSpec::at_rest(model, place)
        };
        world.add_deformable(spec).unwrap()
    });
    world.step().unwrap();
    let stiffness = |world: &World, id| {
        let mut contacts = world.deformable_contacts();
        contacts.find(|c| c.b == id).unwrap().stiffness
    };
    let [soft, hard] = ids.map(|id| stiffness(&world, id));
    assert!((hard / soft / 9.0 - 1.0).abs() < 0.01, "{soft} {hard}");
    world.set_material(ids[0], KINDS[1]).unwrap();
    world.step().unwrap();
    let changed = stiffness(&world, ids[0]);
    assert!((changed / hard - 1.0).abs() < 0.01, "{changed} {hard}");
}
