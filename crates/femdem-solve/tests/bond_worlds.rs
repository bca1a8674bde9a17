//! Bonded bodies among others: first touch, where the kernel takes over, stability, sleep, and what is refused.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::bonds::{A, LAW, block, bond};
use crate::common::{at, parameters, weightless};
use femdem_contact::Wall;
use femdem_contact::bond::BondLaw;
use femdem_mesh::Vector3;
use femdem_solve::{BodySpec, Drive, SleepParameters, World, WorldRelaxation};

/// Cubes side by side fly flat against a floor, bonded or apart: the step in which they touch it, and the largest error of the
/// books until they have left it.
fn dropped(law: Option<BondLaw>) -> (f64, f64) {
    let mut world = World::new(weightless(1e9, 0.0, 0.0)).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let shape = block(&mut world);
    let apart = if law.is_some() { A } else { 2.0 * A };
    let bodies = [0.0, apart].map(|x| {
        let place = Vector3::new(x, 0.0, 0.5 * A + 5e-3);
        let spec = BodySpec {
            velocity: -Vector3::z(),
            ..BodySpec::at_rest(shape, 2000.0, at(place))
        };
        world.add_body(spec).unwrap()
    });
    if let Some(law) = law {
        bond(&mut world, bodies, law);
    }
    let (mut touch, mut worst) = (None, 0.0_f64);
    while world.velocity(bodies[0]).unwrap().z < 0.5 {
        world.step().unwrap();
        if touch.is_none() && !world.contacts().is_empty() {
            touch = Some(world.time_step());
        }
        worst = worst.max(world.ledger().error_relative().abs());
        assert!(world.time() < 0.02);
    }
    (touch.unwrap(), worst)
}

/// A soft bond asks for no small step, and the first touch of a face does: bonded bodies strike a floor with the step of bodies
/// alone.
#[test]
fn soft_bonds_do_not_lengthen_the_step_of_a_first_touch() {
    let law = BondLaw {
        stiffness: 1e7,
        tensile: 1e5,
        cohesion: 1e5,
        energies: [1e4, 1e4],
        ..LAW
    };
    let (alone, bonded) = (dropped(None), dropped(Some(law)));
    assert!(
        (bonded.0 / alone.0 - 1.0).abs() < 0.02,
        "{bonded:?} {alone:?}"
    );
    assert!(bonded.1 < 1.05 * alone.1, "{bonded:?} {alone:?}");
}

/// Slides a block along a fixed one at `velocity` that overlaps by `overlap` (m) when they are bonded, until the bond ends; where
/// the one that slides is then, and the world.
fn slid(velocity: Vector3, overlap: f64) -> (Vector3, World) {
    let mut p = weightless(1e9, 0.0, 0.0);
    p.time_step.largest = Some(2e-6);
    let mut world = World::new(p).unwrap();
    let shape = block(&mut world);
    let spec = |x: f64| BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * x));
    let fixed = world.add_driven_body(spec(0.0), Drive::Fixed).unwrap();
    let drive = Drive::Linear {
        velocity,
        start: 0.0,
        end: 1.0,
    };
    let pulled = world.add_driven_body(spec(A - overlap), drive).unwrap();
    let bodies = [fixed, pulled];
    let section = world.section_between(bodies, 2.0 * overlap + 1e-9, 1.0);
    let section = section.unwrap().unwrap();
    let id = world.add_bond(bodies, &section, LAW).unwrap();
    while !world.bond(id).unwrap().has_ended() {
        world.step().unwrap();
        assert!(world.time() < 0.01, "{:?}", world.bond(id));
    }
    (world.position(pulled).unwrap(), world)
}

/// Energy of flat faces of blocks that overlap by this, J: p A d^2/h.
fn pressed(overlap: f64, slid: f64) -> f64 {
    1e9 * A * (A - slid) * overlap * overlap / (0.5 * A)
}

/// Blocks that overlap when they are bonded meet by the kernel when the bond has been sheared off: what the contact holds then is
/// lent.
#[test]
fn a_contact_that_takes_over_is_lent_its_energy() {
    let (place, world) = slid(Vector3::z() * 0.5, 1e-5);
    assert!(
        (place.z / (2.0 * 100.0 / 3e6) - 1.0).abs() < 0.05,
        "{place}"
    );
    let ledger = world.ledger();
    let expected = pressed(1e-5, place.z);
    assert!(
        (ledger.lent / expected - 1.0).abs() < 0.01,
        "{ledger:?} {expected}"
    );
    assert!((ledger.elastic / expected - 1.0).abs() < 0.01 && ledger.dissipated_release == 0.0);
    assert!(ledger.error_relative().abs() < 1e-3, "{ledger:?}");
}

/// Pressed and sheared off, a bond ends when it has slid by a tenth of its width; what it held beyond what the contact does is
/// released.
#[test]
fn a_bond_that_has_slid_far_releases_its_energy() {
    let (place, world) = slid(Vector3::new(-0.005, 0.0, 5.0), 0.0);
    assert!((place.z / (0.1 * A) - 1.0).abs() < 0.01, "{place}");
    let overlap = A - place.x;
    let held = 0.5 * LAW.stiffness * (1.0 + LAW.friction.powi(2)) * overlap.powi(2) * A * A;
    let expected = held - pressed(overlap, place.z);
    let ledger = world.ledger();
    assert!(
        (ledger.dissipated_release / expected - 1.0).abs() < 0.01,
        "{ledger:?} {expected}"
    );
    assert!(ledger.lent == 0.0 && ledger.bonds == 0.0);
    assert!(ledger.error_relative().abs() < 1e-3, "{ledger:?}");
}

/// A block on a fixed one, whole and while its bond softens: the highest mode, of sliding and rocking together, has (3 + sqrt
/// 7)/2 times the frequency squared S A/m of the springs that are left. The limit of the step is with the damping of the bond.
#[test]
fn stability_of_a_softening_bond() {
    let mut p = weightless(1e9, 0.5, 0.1);
    p.time_step.largest = Some(1e-6);
    let mut world = World::new(p).unwrap();
    let shape = block(&mut world);
    let spec = |x: f64| BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * x));
    let fixed = world.add_driven_body(spec(0.0), Drive::Fixed).unwrap();
    let free = world.add_body(spec(A)).unwrap();
    let law = BondLaw {
        damping: 0.3,
        ..LAW
    };
    let id = bond(&mut world, [fixed, free], law);
    world
        .set_velocity(free, Vector3::x() * 0.6, Vector3::zeros())
        .unwrap();
    for most in [0.0, 0.3] {
        while world.bond(id).unwrap().damage() < most || world.steps() == 0 {
            world.step().unwrap();
            assert!(world.time() < 1e-3);
        }
        let damage = world.bond(id).unwrap().damage();
        let found = world.stability().unwrap().unwrap();
        let square = 0.5 * (3.0 + 7_f64.sqrt()) * (1.0 - damage) * LAW.stiffness / (2000.0 * A);
        assert!(
            (found.frequency / square.sqrt() - 1.0).abs() < 2e-3,
            "{damage}: {found:?} {}",
            square.sqrt()
        );
        let limit = 2.0 / found.frequency * (1.09_f64.sqrt() - 0.3);
        assert!((found.limit / limit - 1.0).abs() < 1e-12);
        assert_eq!(world.bond(id).unwrap().damage(), damage);
    }
}

/// Blocks on both sides of a fixed one: one falls asleep and sleeps on while the other is kept in motion.
#[test]
fn a_fixed_body_parts_those_bonded_to_it() {
    let mut p = parameters(1e8, 0.5, 0.1);
    p.sleeping = SleepParameters::default();
    let mut world = World::new(p).unwrap();
    let shape = block(&mut world);
    let spec = |x: f64| BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * x));
    let fixed = world.add_driven_body(spec(0.0), Drive::Fixed).unwrap();
    let [left, right] = [-A, A].map(|x| world.add_body(spec(x)).unwrap());
    let law = BondLaw {
        stiffness: 1e9,
        tensile: 1e7,
        cohesion: 1e7,
        energies: [1e6, 1e6],
        damping: 0.3,
        ..LAW
    };
    bond(&mut world, [left, fixed], law);
    bond(&mut world, [fixed, right], law);
    let kick = |world: &mut World| {
        let upwards = Vector3::z() * 0.1;
        world
            .set_velocity(right, upwards, Vector3::zeros())
            .unwrap();
    };
    while !world.is_asleep(left) {
        if world.steps().is_multiple_of(10) {
            kick(&mut world);
        }
        world.step().unwrap();
        assert!(world.time() < 1.0 && !world.is_asleep(right));
    }
    for _ in 0..200 {
        kick(&mut world);
        world.step().unwrap();
        assert!(world.is_asleep(left) && !world.is_asleep(right));
    }
    assert_eq!(world.bonded_with(left), [fixed, left, right]);
}

/// A relaxation refuses bonds by name.
#[test]
fn a_relaxation_refuses_bonds() {
    let mut world = World::new(weightless(1e9, 0.5, 0.1)).unwrap();
    let shape = block(&mut world);
    let bodies = [0.0, A].map(|x| {
        let spec = BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * x));
        world.add_body(spec).unwrap()
    });
    let id = bond(&mut world, bodies, LAW);
    let refused = world.relax(&WorldRelaxation::default()).unwrap_err();
    assert!(
        refused.to_string().contains("bonds in a relaxation = 1"),
        "{refused}"
    );
    // Numbers of bonds that are not there have no motions.
    assert!(world.motions_of(id).is_some() && world.motions_of(id + 1).is_none());
    world.remove_body(bodies[0]).unwrap();
    assert!(world.motions_of(id).is_none() && world.bonds_added() == 1);
}

/// Pieces are those that bonds hold which are not broken.
#[test]
fn pieces_of_a_row() {
    let mut world = World::new(weightless(1e9, 0.5, 0.1)).unwrap();
    let shape = block(&mut world);
    let bodies = [0.0, 1.0, 2.0, 3.0].map(|x| {
        let spec = BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * (A * x)));
        world.add_body(spec).unwrap()
    });
    for (a, b) in [(2, 3), (0, 1), (2, 1)] {
        bond(&mut world, [bodies[a], bodies[b]], LAW);
    }
    assert_eq!(world.bonded_pieces(), [bodies.to_vec()]);
    for i in [2, 3] {
        world
            .set_velocity(bodies[i], Vector3::x() * 5.0, Vector3::zeros())
            .unwrap();
    }
    while !world.bond(2).unwrap().is_broken() {
        world.step().unwrap();
        assert!(world.time() < 1e-3);
    }
    let halves = [bodies[..2].to_vec(), bodies[2..].to_vec()];
    assert_eq!(world.bonded_pieces(), halves);
}
