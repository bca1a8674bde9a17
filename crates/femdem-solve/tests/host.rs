//! Walls and bodies that a host moves step by step, and hosts that do anything at any time.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, add_floor, add_heap, add_sides, at, parameters, pose, solid, turned,
};
use femdem_contact::{ContactParameters, MaterialId, Partner, Wrench};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{TetMesh, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, Driven, ImplicitStep, SolveError, World,
};
use proptest::prelude::*;

fn box_of(count: u64, implicit: Option<ImplicitStep>, largest: Option<f64>) -> World {
    let mut p = parameters(1e6, 0.5, 0.5);
    p.time_step.implicit = implicit;
    p.time_step.largest = largest;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 2.2 * D, Drive::Fixed);
    add_heap(&mut world, count, 2);
    world
}

/// Places and velocities of all bodies, and the energies, as bits.
fn bits(world: &World) -> Vec<u64> {
    let of = |id| {
        let vectors = [
            world.position(id),
            world.velocity(id),
            world.angular_velocity(id),
        ];
        vectors
            .into_iter()
            .flat_map(|v| <[f64; 3]>::from(v.unwrap()))
    };
    let books = world.ledger();
    let energies = [
        books.work_in,
        books.elastic,
        books.dissipated(),
        world.time(),
    ];
    let all = world.body_ids().flat_map(of).chain(energies);
    all.map(f64::to_bits).collect()
}

/// What a host says, if it says what a drive says, has the effect of that drive, bit for bit.
#[test]
fn a_host_moves_as_a_drive_does() {
    let drives = [
        Drive::Linear {
            velocity: Vector3::new(0.1, 0.0, 0.2),
            start: 0.0,
            end: 0.03,
        },
        Drive::Turn {
            axis: Vector3::new(0.0, 0.6, 0.8),
            point: Vector3::new(D, D, 0.0),
            rate: 2.0,
            start: 0.01,
            end: 1.0,
        },
        Drive::Shake {
            stroke: Vector3::z() * 0.002,
            frequency: 50.0,
            start: 0.0,
            periods: 2,
        },
    ];
    for (k, drive) in drives.into_iter().enumerate() {
        let implicit = (k == 1).then(ImplicitStep::default);
        let mut driven = box_of(8, implicit, Some(5e-5));
        for _ in 0..100 {
            driven.step().unwrap();
        }
        driven.restart_clock();
        let mut hosted = driven.clone();
        driven.drive_wall(0, drive).unwrap();
        driven.drive_body(3, Some(drive)).unwrap();
        hosted.drive_wall_by_host(0, drive.at(0.0)).unwrap();
        hosted.drive_body_by_host(3, drive.at(0.0)).unwrap();
        assert_eq!(hosted.follows_drive(3), Some(true));
        let mut asked = Vec::new();
        for step in 0..800 {
            driven.step().unwrap();
            hosted
                .step_with(|thing, time| {
                    asked.push(thing);
                    Some(drive.at(time))
                })
                .unwrap();
            assert_eq!(bits(&driven), bits(&hosted), "{drive:?} at {step}");
            if step == 400 {
                hosted = World::from_bytes(&hosted.to_bytes().unwrap()).unwrap();
            }
        }
        assert_eq!(asked[..2], [Partner::Wall(0), Partner::Body(3)]);
        assert!(
            driven.ledger().work_in.abs() > 1e-5,
            "{:?}",
            driven.ledger()
        );
        // Without a word it stays where it is.
        let here = hosted.wall_pose(0).unwrap();
        for _ in 0..5 {
            hosted.step().unwrap();
        }
        assert_eq!(hosted.wall_pose(0).unwrap(), here);
        assert!(!hosted.is_driven(0.0));
        hosted.drive_body(3, None).unwrap();
        assert_eq!(hosted.follows_drive(3), Some(false));
    }
}

#[test]
fn motions_that_are_none_are_refused() {
    let mut world = box_of(1, None, None);
    world.drive_wall_by_host(0, Driven::default()).unwrap();
    let turned = |axis: Vector3, angle: f64| Driven {
        axis,
        angle,
        ..Driven::default()
    };
    let mut say = |driven: Driven| world.step_with(|_, _| Some(driven));
    say(turned(Vector3::x(), 1e-3)).unwrap();
    for (driven, word) in [
        (turned(Vector3::x(), f64::NAN), "motion"),
        (turned(Vector3::zeros(), 1.0), "length of the axis"),
        (turned(Vector3::y(), 1e-3), "change of the axis"),
    ] {
        let error = say(driven).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
    assert!(matches!(
        world.drive_wall_by_host(9, Driven::default()),
        Err(SolveError::NoSuch { .. })
    ));
}

/// Something that a host does.
#[derive(Debug, Clone)]
enum Doing {
    Add(Vector3, u64),
    Remove(usize),
    Put(usize, Vector3, u64),
    Throw(usize, Vector3),
    Load(usize, Vector3),
    Wall(bool),
    /// Gives a body, a deformable body or the floor one of three materials.
    Recast(usize),
    /// Adds, removes, puts or pushes a deformable body, where there may be any.
    Soft(usize, Vector3),
    Steps(usize),
}

fn doings() -> impl Strategy<Value = Vec<Doing>> {
    let place = || {
        let side = || -1.5 * D..1.5 * D;
        (side(), side(), 0.6 * D..4.0 * D).prop_map(|(x, y, z)| Vector3::new(x, y, z))
    };
    let speed = || prop::array::uniform3(-1.0..1.0).prop_map(Vector3::from);
    let one = prop_oneof![
        (place(), any::<u64>()).prop_map(|(x, turn)| Doing::Add(x, turn)),
        any::<usize>().prop_map(Doing::Remove),
        (any::<usize>(), place(), any::<u64>()).prop_map(|(i, x, turn)| Doing::Put(i, x, turn)),
        (any::<usize>(), speed()).prop_map(|(i, v)| Doing::Throw(i, v)),
        (any::<usize>(), speed()).prop_map(|(i, f)| Doing::Load(i, f)),
        any::<bool>().prop_map(Doing::Wall),
        (any::<usize>(), place()).prop_map(|(i, x)| Doing::Soft(i, x)),
        any::<usize>().prop_map(Doing::Recast),
        (1..60_usize).prop_map(Doing::Steps),
        (1..60_usize).prop_map(Doing::Steps),
    ];
    prop::collection::vec(one, 10..60)
}

/// Does one thing; returns whether the energies must not have changed by more than was booked.
fn act(world: &mut World, doing: &Doing) -> Result<(), SolveError> {
    let ids: Vec<u32> = world.rigid_ids().collect();
    let pick = |i: usize| ids.get(i % ids.len().max(1)).copied().unwrap_or(99);
    match doing {
        Doing::Add(x, turn) => {
            let spec =
                BodySpec::at_rest((*turn % 2) as u32, DENSITY, pose(*x, turned(*turn % 1000)));
            let free = (0..).find(|i| !world.has_body(*i));
            assert_eq!(Some(world.add_body(spec)?), free);
            Ok(())
        }
        Doing::Remove(i) => world.remove_body(pick(*i)),
        Doing::Put(i, x, turn) => world.set_pose(pick(*i), pose(*x, turned(*turn % 1000))),
        Doing::Throw(i, v) => world.set_velocity(pick(*i), *v, *v * 5.0),
        Doing::Load(i, f) => world.set_load(
            pick(*i),
            Wrench {
                force: *f * 5.0,
                torque: *f * 0.05,
            },
        ),
        Doing::Wall(add) => {
            if *add && world.wall(0).is_none() {
                add_floor(world, Drive::Fixed);
            } else if !add && world.wall(0).is_some() {
                return world.remove_wall(0);
            }
            Ok(())
        }
        Doing::Recast(k) => {
            let material = MaterialId((k % 3) as u8);
            let soft = world.deformable_ids().next();
            match (k / 3 % 3, soft) {
                (0, Some(id)) => world.set_material(id, material),
                (1, _) if world.wall(0).is_some() => world.set_wall_material(0, material),
                _ => world.set_material(pick(k / 9), material),
            }
        }
        Doing::Soft(i, x) => act_softly(world, *i, x),
        Doing::Steps(count) => (0..*count).try_for_each(|_| world.step()),
    }
}

fn act_softly(world: &mut World, i: usize, x: &Vector3) -> Result<(), SolveError> {
    let ids: Vec<u32> = world.deformable_ids().collect();
    let place = at(*x);
    if world.parameters().time_step.implicit.is_some() {
        return Ok(());
    }
    match (i % 4, ids.get(i / 4 % ids.len().max(1))) {
        (1, Some(&id)) => world.remove_body(id),
        (2, Some(&id)) => {
            let nodes = world.deformable(id).unwrap().model().nodes();
            let nodes: Vec<Vector3> = nodes.iter().map(|y| y + place.translation.vector).collect();
            world.set_nodes(id, &nodes, &vec![*x; nodes.len()])
        }
        (3, Some(&id)) => world.set_load(
            id,
            Wrench {
                force: x * 20.0,
                torque: Vector3::zeros(),
            },
        ),
        _ => {
            let free = (0..).find(|i| !world.has_body(*i));
            let spec = DeformableSpec::at_rest(0, place);
            assert_eq!(Some(world.add_deformable(spec)?), free);
            Ok(())
        }
    }
}

fn check_ids(world: &World) {
    let soft: Vec<u32> = world.deformable_ids().collect();
    assert!(soft.is_sorted() && soft.len() == world.deformable_count());
    for contact in world.deformable_contacts() {
        let a = match contact.a {
            Partner::Body(a) => world.has_body(a),
            Partner::Wall(wall) => world.wall(wall).is_some(),
        };
        assert!(a && soft.contains(&contact.b));
    }
    let all: Vec<u32> = world.body_ids().collect();
    assert!(all.is_sorted() && all.len() == world.body_count());
    let ids: Vec<u32> = world.rigid_ids().collect();
    assert!(ids.is_sorted() && ids.len() == world.rigid_count());
    assert_eq!(ids.len() + soft.len(), all.len());
    assert!(world.awake().is_sorted() && world.awake().iter().all(|id| ids.contains(id)));
    assert_eq!(world.awake_count(), world.awake().len());
    for id in 0..all.last().map_or(1, |last| last + 2) {
        assert_eq!(world.pose(id).is_some(), ids.contains(&id));
        assert_eq!(world.has_body(id), all.contains(&id));
        let alone = world.contacts_of(id).is_empty();
        assert!(all.contains(&id) || alone);
    }
    for contact in world.rigid_contacts() {
        let a = match contact.a {
            Partner::Body(a) => ids.contains(&a),
            Partner::Wall(wall) => world.wall(wall).is_some(),
        };
        assert!(a && ids.contains(&contact.b));
    }
    assert!(
        world
            .residuals()
            .worst_body
            .is_none_or(|id| ids.contains(&id))
    );
}

fn playground(sleeping: bool, implicit: bool) -> World {
    let mut p = parameters(1e6, 0.5, 0.5);
    p.sleeping.enabled = sleeping;
    p.time_step.safety = 0.2;
    p.time_step.implicit = implicit.then(ImplicitStep::default);
    let mut world = World::new(p).unwrap();
    for id in ["P5", "A1"] {
        world.add_shape(id, &solid(id)).unwrap();
    }
    if !implicit {
        let mesh = TetMesh::block([1, 1, 1], &Vector3::repeat(D)).unwrap();
        let region = MaterialRegion {
            material: NeoHookean::new(1e6, 0.3).unwrap().into(),
            density: DENSITY,
        };
        let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
        let stiffness = ContactStiffness::default();
        world.add_model("cube", model, stiffness).unwrap();
    }
    for (k, penalty) in [(1, 3e6), (2, 3e5)] {
        let law = ContactParameters {
            penalty,
            friction: 0.2,
            ..p.contact
        };
        world.set_law(MaterialId(k), MaterialId(0), law).unwrap();
    }
    add_floor(&mut world, Drive::Fixed);
    for k in 0..3 {
        let place = at(Vector3::z() * D * (0.5 + f64::from(k)));
        world
            .add_body(BodySpec::at_rest(0, DENSITY, place))
            .unwrap();
    }
    world
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever a host does: indices name what is there, what it put in is on the books at once, and steps keep
    /// them balanced.
    #[test]
    fn a_host_may_do_anything(doings in doings(), sleeping: bool, implicit: bool) {
        let mut world = playground(sleeping, implicit);
        let mut scale = 0.1;
        for doing in &doings {
            let before = world.ledger();
            // What an implicit step has left open is settled first where contacts end, and large such steps miss much.
            let exact = match doing {
                Doing::Steps(_) => false,
                Doing::Remove(_) | Doing::Put(..) | Doing::Wall(_) | Doing::Soft(..) | Doing::Recast(_) => !implicit,
                Doing::Add(..) | Doing::Throw(..) | Doing::Load(..) => true,
            };
            let done = act(&mut world, doing);
            check_ids(&world);
            let after = world.ledger();
            match done {
                Err(SolveError::NoSuch { .. }) => prop_assert_eq!(world.rigid_count(), 0),
                // Bodies put deep into each other.
                Err(SolveError::BlowUp { .. } | SolveError::BodyFailed { .. }) => break,
                Err(error) => return Err(TestCaseError::fail(error.to_string())),
                Ok(()) => {}
            }
            let turnover = |l: &femdem_solve::Ledger| l.kinetic + l.strain + l.elastic + l.dissipated().abs() + l.exchanged + l.potential.abs();
            scale = f64::max(scale, turnover(&before).max(turnover(&after)));
            let off = (after.error() - before.error()).abs();
            let allowed = if exact { 1e-10 } else { 0.05 } * scale;
            prop_assert!(off <= allowed || (implicit && !exact), "{:?}: {} of {}", doing, off, scale);
        }
    }

    /// The same bits through files after every thing that is done, and on one thread and two.
    #[test]
    fn whatever_a_host_does_the_bits_are_the_same(doings in doings(), sleeping: bool) {
        let run = |threads: usize, files: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut world = playground(sleeping, false);
                let mut hashes = Vec::new();
                for doing in &doings {
                    match act(&mut world, doing) {
                        Ok(()) | Err(SolveError::NoSuch { .. }) => {}
                        Err(_) => break,
                    }
                    if files {
                        world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
                    }
                    hashes.push(world.state_hash().unwrap());
                }
                hashes
            })
        };
        let straight = run(1, false);
        prop_assert_eq!(&straight, &run(1, true), "through files");
        prop_assert_eq!(&straight, &run(2, false), "on two threads");
    }
}
