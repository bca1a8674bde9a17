//! Worlds shared out over ranks: the same bits as one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::ranks::Threads;
use femdem_contact::{ContactParameters, MaterialId, Wall};
use femdem_fem::Driven;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Translation3, UnitQuaternion};
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{
    Alone, BodySpec, Drive, Halo, ImplicitStep, Medium, TimeStepParameters, World, WorldParameters,
};

const D: f64 = 0.05;

const COUNT: usize = 90;

/// Bodies of four shapes above a floor between walls, under gravity that leans over, numbered at random.
fn pile(sleeping: bool) -> World {
    let mut parameters = WorldParameters {
        gravity: Vector3::new(3.0, 0.0, -9.0),
        contact: ContactParameters {
            friction: 0.4,
            ..ContactParameters::default()
        },
        ..WorldParameters::default()
    };
    // A rule under which bodies sleep before long, and often wake.
    parameters.sleeping.enabled = sleeping;
    parameters.sleeping.window = 60;
    parameters.sleeping.tolerance = 0.05;
    let mut world = World::new(parameters).unwrap();
    let (low, high) = (Vector3::zeros(), Vector3::new(12.0, 3.0, 40.0) * D);
    let mut walls = Vec::new();
    for wall in Wall::closed_box(low, high).unwrap() {
        walls.push(world.add_wall(wall, Drive::Fixed).unwrap());
    }
    // Which the bound of the step has to allow for.
    world.set_wall_material(walls[0], MaterialId(1)).unwrap();
    // They lean over for a while; after that nothing sleeps until all are at rest.
    let turn = Drive::Turn {
        axis: Vector3::y(),
        point: Vector3::zeros(),
        rate: 0.3,
        start: 0.02,
        end: 0.04,
    };
    if !sleeping {
        world.drive_wall(walls[0], turn).unwrap();
    }
    let mut shapes: Vec<u32> = ["A10", "P5", "P1"]
        .iter()
        .map(|name| {
            let shape: CatalogueShape = name.parse().unwrap();
            world
                .add_shape(name, &shape.polyhedron(D).unwrap())
                .unwrap()
        })
        .collect();
    shapes.push(world.add_sphere("ball", 0.4 * D).unwrap());
    let mut x = 0.3_f64;
    let mut next = || {
        x = (x * 997.0 + 0.123).fract();
        x
    };
    let mut places: Vec<usize> = (0..COUNT).collect();
    for k in (1..COUNT).rev() {
        places.swap(k, (next() * (k + 1) as f64) as usize);
    }
    for (k, place) in places.iter().enumerate() {
        let (i, j, l) = (place % 9, place / 9 % 2, place / 18);
        let at = Vector3::new(i as f64 + 0.6, j as f64 + 0.6, l as f64 + 0.6) * (1.2 * D);
        let turn = UnitQuaternion::from_euler_angles(6.0 * next(), 6.0 * next(), 6.0 * next());
        let pose = Pose::from_parts(Translation3::from(at), turn);
        let spec = BodySpec::at_rest(shapes[k % 4], 2500.0, pose);
        world.add_body(spec).unwrap();
    }
    world
}

/// Bytes a step for a guest that moves: one that says whether it sleeps, and 14 numbers, or 6 for each node.
fn bytes_for(world: &World, guest: u32) -> usize {
    let nodes = world.deformable(guest).map(|body| body.positions().len());
    1 + 8 * nodes.map_or(14, |nodes| 6 * nodes)
}

/// What the ranks have made of it: the whole, how many bodies changed their rank, and bytes over those for guests that move.
fn on_ranks(world: &World, size: usize, steps: u32) -> (World, usize, f64) {
    let parts = Threads::each(size, |halo| {
        let mut world = world.clone();
        world.share_out(halo).unwrap();
        let own = |world: &World| -> Vec<u32> {
            let ids = world.own_bodies(0);
            ids.filter_map(|id| world.number_in_whole(id)).collect()
        };
        let before = own(&world);
        let mut guests = 0;
        halo.sent = 0;
        for _ in 0..steps {
            world.step_on(halo).unwrap();
            let here = world.body_ids().filter(|id| world.is_guest(*id));
            guests += here.map(|id| bytes_for(&world, id)).sum::<usize>();
        }
        let after = own(&world);
        let came = after.iter().filter(|n| before.binary_search(n).is_err());
        (world.gather(halo).unwrap(), came.count(), halo.sent, guests)
    });
    let there: Vec<bool> = parts.iter().map(|part| part.0.is_some()).collect();
    assert!(there[0] && !there[1..].contains(&true));
    let moved = parts.iter().map(|part| part.1).sum();
    let sent: usize = parts.iter().map(|part| part.2).sum();
    let guests: usize = parts.iter().map(|part| part.3).sum();
    let traffic = sent as f64 / guests.max(1) as f64;
    let whole = parts.into_iter().next().unwrap().0;
    (whole.unwrap(), moved, traffic)
}

/// The whole that so many ranks make of a world has the motion and the books of one `alone` after the same steps, and messages hold
/// hardly more than the guests that move. Also returns how many bodies have changed their rank on the way, which depends on the time
/// that they took, by which space is cut.
pub fn as_alone(alone: &World, world: &World, size: usize, steps: u32) -> (World, usize) {
    let (whole, moved, traffic) = on_ranks(world, size, steps);
    let [found, expected] = [&whole, alone].map(|world| world.checksum_of_motion().unwrap());
    assert_eq!(found, expected, "{size} ranks");
    let books = [alone, &whole].map(World::ledger);
    let ratio = books[0].dissipated() / books[1].dissipated();
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    let missing = (books[0].error() - books[1].error()).abs();
    assert!(missing < 1e-9 * books[0].exchanged, "{missing:e}");
    assert!(traffic <= 1.06, "{traffic}");
    (whole, moved)
}

#[test]
fn any_number_of_ranks_gives_the_same_bits() {
    for sleeping in [false, true] {
        let world = pile(sleeping);
        let mut alone = world.clone();
        let steps = 2000;
        let mut woke = 0;
        for _ in 0..steps {
            let before = alone.awake_count();
            alone.step().unwrap();
            woke += usize::from(alone.awake_count() > before);
        }
        let awake = alone.awake_count();
        assert_eq!(awake < COUNT, sleeping, "{awake} are awake");
        assert_eq!(woke > 0, sleeping, "bodies woke in {woke} steps");
        let sizes: &[usize] = if sleeping { &[1, 2, 3, 4] } else { &[2, 4] };
        let moved: Vec<usize> = sizes
            .iter()
            .map(|&size| as_alone(&alone, &world, size, steps).1)
            .collect();
        assert!(moved.iter().any(|moved| *moved > 0), "{moved:?}");
    }
}

/// A world in motion that only the first rank has goes on over all to the bits of one of its own.
pub fn goes_on_from_the_first(world: &World, steps: u32) {
    let mut alone = world.clone();
    for _ in 0..steps {
        alone.step().unwrap();
    }
    let expected = alone.checksum_of_motion().unwrap();
    for size in [1, 3, 4] {
        let parts = Threads::each(size, |halo| {
            let given = (halo.rank() == 0).then(|| world.clone());
            let mut world = World::share_from_first(given, halo).unwrap();
            assert!(world.own_bodies(0).next().is_some());
            for _ in 0..steps {
                world.step_on(halo).unwrap();
            }
            world.gather(halo).unwrap()
        });
        let whole = parts.into_iter().next().unwrap().unwrap();
        let found = whole.checksum_of_motion().unwrap();
        assert_eq!(found, expected, "{size} ranks");
        let books = [&alone, &whole].map(World::ledger);
        let missing = (books[0].error() - books[1].error()).abs();
        assert!(missing < 1e-9 * books[0].exchanged, "{missing:e}");
    }
}

/// The worlds that a rank reads of the parts of a whole: all ranks read all.
pub fn parts_for(parts: &[Vec<u8>], halo: &dyn Halo) -> Vec<World> {
    let own = parts.iter().skip(halo.rank()).step_by(halo.size());
    own.map(|bytes| World::from_bytes(bytes).unwrap()).collect()
}

/// The parts of a world over so many ranks, after some steps.
fn parts_after(world: &World, size: usize, steps: u32) -> Vec<Vec<u8>> {
    Threads::each(size, |halo| {
        let mut world = world.clone();
        world.share_out(halo).unwrap();
        for _ in 0..steps {
            world.step_on(halo).unwrap();
        }
        world.to_bytes().unwrap()
    })
}

/// What some ranks have made of a world is one world again, or goes on over other ranks, to the bits of one of its own.
pub fn goes_on_from_parts(world: &World, steps: u32) {
    let mut alone = world.clone();
    for _ in 0..steps {
        alone.step().unwrap();
    }
    let parts = parts_after(world, 3, steps);
    let read = parts.iter().map(|bytes| World::from_bytes(bytes));
    let mut whole = World::of_parts(read).unwrap();
    let checksum = |world: &World| world.checksum_of_motion().unwrap();
    assert_eq!(checksum(&whole), checksum(&alone));
    for world in [&mut alone, &mut whole] {
        for _ in 0..steps {
            world.step().unwrap();
        }
    }
    let expected = checksum(&alone);
    assert_eq!(checksum(&whole), expected);
    for size in [1, 2, 5] {
        let worlds = Threads::each(size, |halo| {
            let mut world = World::share_parts(parts_for(&parts, halo), halo).unwrap();
            let own = world.own_bodies(0).count();
            assert!(size == 1 || own < world.count_in_whole(), "{own} bodies");
            for _ in 0..steps {
                world.step_on(halo).unwrap();
            }
            let found = world.checksum_of_motion_on(halo).unwrap();
            assert_eq!(found, expected, "{size} ranks");
            world.gather(halo).unwrap()
        });
        let found = worlds.into_iter().flatten().next().unwrap();
        let books = [&alone, &found].map(World::ledger);
        let missing = (books[0].error() - books[1].error()).abs();
        assert!(missing < 1e-9 * books[0].exchanged, "{missing:e}");
    }
}

#[test]
fn a_pile_goes_on_from_its_parts() {
    goes_on_from_parts(&pile(false), 200);
    let mut sleepy = pile(true);
    while sleepy.awake_count() == COUNT {
        sleepy.step().unwrap();
    }
    goes_on_from_parts(&sleepy, 100);
}

#[test]
fn parts_that_are_no_whole_are_refused() {
    let world = pile(false);
    let [parts, later] = [20, 21].map(|steps| parts_after(&world, 3, steps));
    let mixed = [&parts[..2], &later[2..]].concat();
    let twice = [&parts[..2], &parts[1..2]].concat();
    for (parts, why) in [
        (&parts[..2], "do not have all bodies"),
        (&mixed[..], "at one time"),
        (&twice[..], "number of a body"),
        (&[world.to_bytes().unwrap()], "was not shared out"),
        (&[], "at least one part"),
    ] {
        let read = parts.iter().map(|bytes| World::from_bytes(bytes));
        let refused = World::of_parts(read).unwrap_err().to_string();
        assert!(refused.contains(why), "{refused}");
    }
    for parts in [&parts[..2], &mixed[..]] {
        let refused = Threads::each(3, |halo| {
            let shared = World::share_parts(parts_for(parts, halo), halo);
            shared.unwrap_err().to_string()
        });
        for refused in refused {
            assert!(refused.contains("do not have all bodies"), "{refused}");
        }
    }
    // The first of two ranks has two parts, and alone sees that they are not of one time.
    let refused = Threads::each(2, |halo| {
        let shared = World::share_parts(parts_for(&mixed, halo), halo);
        shared.unwrap_err().to_string()
    });
    for (refused, why) in refused.iter().zip(["at one time", "another rank"]) {
        assert!(refused.contains(why), "{refused}");
    }
}

#[test]
fn a_pile_in_motion_is_shared_from_the_first() {
    let mut world = pile(true);
    world.step().unwrap();
    // With what has come since the contacts were last evaluated.
    let place = Pose::translation(0.3, 0.1, 1.8);
    world.add_body(BodySpec::at_rest(0, 2500.0, place)).unwrap();
    goes_on_from_the_first(&world, 300);
    while world.awake_count() == COUNT + 1 {
        world.step().unwrap();
    }
    goes_on_from_the_first(&world, 300);
}

/// Steps of both kinds, with bodies that come on the way; one of them lowers the step of all.
fn course(world: &mut World, halo: &mut dyn Halo) {
    let steps = |world: &mut World, halo: &mut dyn Halo, count: u32| {
        for _ in 0..count {
            world.step_on(halo).unwrap();
        }
    };
    let usual = world.parameters().time_step;
    let implicit = TimeStepParameters {
        implicit: Some(ImplicitStep::default()),
        ..usual
    };
    steps(world, halo, 700);
    for k in 0..14 {
        let at = Vector3::new(f64::from(k % 7) + 0.6, f64::from(k / 7) + 0.6, 10.0) * (1.4 * D);
        let pose = Pose::from_parts(Translation3::from(at), UnitQuaternion::identity());
        let shape = if k == 3 { 4 } else { k % 4 };
        let spec = BodySpec {
            velocity: Vector3::new(0.0, 0.0, -6.0),
            ..BodySpec::at_rest(shape, 2500.0, pose)
        };
        let number = world.add_body(spec).unwrap();
        assert_eq!(number as usize, COUNT + k as usize);
        assert_eq!(world.count_in_whole(), COUNT + k as usize + 1);
    }
    // The contacts of the new ones are not known yet when the steps become implicit.
    world.set_time_step(implicit).unwrap();
    steps(world, halo, 8);
    world.set_time_step(usual).unwrap();
    steps(world, halo, 700);
    world.set_sleeping(false);
    world.set_time_step(implicit).unwrap();
    for _ in 0..60 {
        world.step_on(halo).unwrap();
        if world.is_slowing_on(halo).unwrap() {
            world.stop();
        }
    }
    world.step_explicitly().unwrap();
    steps(world, halo, 200);
}

#[test]
fn bodies_may_come_and_steps_be_implicit() {
    let mut world = pile(true);
    world.add_sphere("bead", 0.2 * D).unwrap();
    let mut alone = world.clone();
    course(&mut alone, &mut Alone);
    let expected = alone.checksum_of_motion().unwrap();
    let places = |world: &World, halo: &mut dyn Halo| {
        let place = |world: &World, id| world.position(id).unwrap();
        world.of_whole(halo, place).unwrap()
    };
    let all = places(&alone, &mut Alone);
    for size in [1, 2, 3, 4] {
        let parts = Threads::each(size, |halo| {
            let mut world = world.clone();
            world.share_out(halo).unwrap();
            course(&mut world, halo);
            assert_eq!(places(&world, halo), all);
            assert!(world.own_bodies(0).next().is_some(), "rank {}", halo.rank());
            for id in world.rigid_ids() {
                let number = world.number_in_whole(id).unwrap();
                assert_eq!(world.number_here(number), Some(id));
            }
            world.gather(halo).unwrap()
        });
        let whole = parts.into_iter().next().unwrap().unwrap();
        assert_eq!(
            whole.checksum_of_motion().unwrap(),
            expected,
            "{size} ranks"
        );
        let books = [&alone, &whole].map(World::ledger);
        let missing = (books[0].error() - books[1].error()).abs();
        assert!(missing < 1e-9 * books[0].exchanged, "{missing:e}");
    }
}

/// Bodies leave and others come under their numbers, at rest and in motion, and a wall goes; with a checkpoint on the way.
/// `spec` is that of the k-th body that comes.
pub fn comes_and_goes(
    world: &mut World,
    halo: &mut dyn Halo,
    gone: [[u32; 2]; 2],
    spec: impl Fn(u32) -> BodySpec,
) {
    let steps = |world: &mut World, halo: &mut dyn Halo, count: u32| {
        for _ in 0..count {
            world.step_on(halo).unwrap();
        }
    };
    let total = world.count_in_whole() as u32;
    steps(world, halo, 500);
    let [first, second] = gone;
    world.remove_bodies_on(&first, halo).unwrap();
    assert_eq!(world.count_in_whole() as u32, total - 2);
    *world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    let again = world.remove_bodies_on(&first[..1], halo).unwrap_err();
    assert!(again.to_string().contains("there is no body"), "{again}");
    steps(world, halo, 20);
    let low = first[0].min(first[1]);
    assert_eq!(world.add_body(spec(0)).unwrap(), low);
    steps(world, halo, 150);
    world.remove_bodies_on(&second, halo).unwrap();
    let mut free = [first[0].max(first[1]), second[0], second[1], total];
    free.sort_unstable();
    for (k, number) in (1..).zip(free) {
        assert_eq!(world.add_body(spec(k)).unwrap(), number);
    }
    steps(world, halo, 300);
    world.remove_walls_on(&[1], halo).unwrap();
    steps(world, halo, 300);
}

/// The same on any number of ranks as alone.
pub fn comes_and_goes_alike(
    world: &World,
    gone: [[u32; 2]; 2],
    spec: impl Fn(u32) -> BodySpec + Sync,
) {
    let mut alone = world.clone();
    comes_and_goes(&mut alone, &mut Alone, gone, &spec);
    let expected = alone.checksum_of_motion().unwrap();
    for size in [1, 2, 3, 4] {
        let parts = Threads::each(size, |halo| {
            let mut world = world.clone();
            world.share_out(halo).unwrap();
            comes_and_goes(&mut world, halo, gone, &spec);
            world.gather(halo).unwrap()
        });
        let whole = parts.into_iter().next().unwrap().unwrap();
        let found = whole.checksum_of_motion().unwrap();
        assert_eq!(found, expected, "{size} ranks");
        let books = [&alone, &whole].map(World::ledger);
        let scale = books[0].exchanged;
        let missing = (books[0].error() - books[1].error()).abs();
        let by_hand = (books[0].by_hand - books[1].by_hand).abs();
        assert!(missing < 1e-9 * scale, "{missing:e}");
        assert!(by_hand < 1e-9 * scale, "{by_hand:e}");
    }
}

#[test]
fn bodies_and_walls_may_leave() {
    let spec = |k: u32| {
        let at = Vector3::new(f64::from(2 * k % 7) + 0.6, 0.6, 9.0 + f64::from(k)) * (1.4 * D);
        let pose = Pose::from_parts(Translation3::from(at), UnitQuaternion::identity());
        BodySpec {
            velocity: Vector3::new(0.0, 0.0, -4.0),
            ..BodySpec::at_rest(k % 4, 2500.0, pose)
        }
    };
    for sleeping in [false, true] {
        comes_and_goes_alike(&pile(sleeping), [[40, 3], [77, 10]], spec);
    }
}

/// The whole that is gathered before the next step knows the fastest body, which the first rank does not have.
#[test]
fn parameters_may_change_before_bodies_are_gathered() {
    let mut world = pile(false);
    let x = |id: &u32| world.position(*id).unwrap().x;
    let last = world.rigid_ids().max_by(|a, b| x(a).total_cmp(&x(b)));
    let fast = Vector3::new(0.0, 0.0, 5.0);
    world
        .set_velocity(last.unwrap(), fast, Vector3::zeros())
        .unwrap();
    let change = |world: &mut World, halo: &mut dyn Halo| {
        for _ in 0..20 {
            world.step_on(halo).unwrap();
        }
        let medium = Medium {
            local_damping: 0.2,
            ..Medium::default()
        };
        world.set_medium(medium).unwrap();
    };
    let parts = Threads::each(2, |halo| {
        let mut world = world.clone();
        world.share_out(halo).unwrap();
        let number = world.number_here(last.unwrap());
        assert_eq!(halo.rank() == 0, number.is_none());
        change(&mut world, halo);
        world.gather(halo).unwrap()
    });
    let whole = parts.into_iter().next().unwrap().unwrap();
    change(&mut world, &mut Alone);
    let [found, expected] = [whole, world].map(|world| world.checksum_of_motion().unwrap());
    assert_eq!(found, expected);
}

#[test]
fn what_cannot_be_shared_is_said() {
    let halos = &mut Threads::of(2);
    let mut world = pile(true);
    let stepped = world.step_on(&mut halos[0]).unwrap_err().to_string();
    assert!(stepped.contains("was not shared out"), "{stepped}");
    world.share_out(&mut Alone).unwrap();
    assert!(
        world
            .step()
            .unwrap_err()
            .to_string()
            .contains("gather it first")
    );
    assert_eq!(halos[1].rank(), 1);
    let refused = world.remove_body(3).unwrap_err().to_string();
    assert!(refused.contains("gather it first"), "{refused}");
    let mut driven = pile(true);
    driven.drive_body(3, Some(Drive::Fixed)).unwrap();
    driven.share_out(&mut Alone).unwrap();
    let refused = driven.remove_bodies_on(&[3], &mut Alone).unwrap_err();
    assert!(refused.to_string().contains("a driven body"), "{refused}");
    let mut hosted = pile(true);
    hosted.drive_body_by_host(0, Driven::default()).unwrap();
    let refused = hosted.share_out(&mut Alone).unwrap_err().to_string();
    assert!(refused.contains("bodies that a host moves"), "{refused}");
    let nothing = World::share_from_first(None, &mut Alone).unwrap_err();
    assert!(nothing.to_string().contains("the first rank gives"));
}
