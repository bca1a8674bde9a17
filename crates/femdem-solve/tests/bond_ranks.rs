//! Worlds with bonded bodies shared out over ranks: the same bits as one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::bonds::LAW;
use crate::common::ranks::Threads;
use crate::ranks::comes_and_goes_alike;
use crate::soft_ranks::rubber_cube;
use femdem_contact::bond::{BondLaw, BondSection};
use femdem_contact::{BodyId, ContactParameters, Wall};
use femdem_fem::fracture::Strength;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{
    Alone, BodySpec, ContactStiffness, DeformableSpec, Drive, Fracture, Halo, World,
    WorldParameters,
};
use std::collections::BTreeSet;

/// Edge of a block, m.
const EDGE: f64 = 0.05;

/// Along a row, and rows above each other.
const COUNT: [u32; 2] = [10, 3];

/// Blocks of a row on which a cube falls.
const BLOCKS: usize = 8;

const MORTAR: BondLaw = BondLaw {
    stiffness: 1e9,
    tensile: 5e4,
    cohesion: 1e5,
    energies: [4.0, 16.0],
    damping: 0.2,
    ..LAW
};

/// A wall of blocks, numbered at random, that falls on a floor which leans over, between other walls, and breaks. The blocks of a
/// row are bonded, and those of the lowest rows.
fn masonry() -> World {
    let mut parameters = WorldParameters {
        gravity: Vector3::new(1.0, 0.0, -9.0),
        contact: ContactParameters {
            penalty: 1e7,
            friction: 0.5,
            damping_ratio: 0.3,
            ..ContactParameters::default()
        },
        ..WorldParameters::default()
    };
    parameters.sleeping.window = 60;
    parameters.sleeping.tolerance = 0.05;
    let mut world = World::new(parameters).unwrap();
    let (low, high) = (Vector3::zeros(), Vector3::new(16.0, 3.0, 60.0) * EDGE);
    for wall in Wall::closed_box(low, high).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(EDGE * 3_f64.sqrt()).unwrap();
    let shape = world.add_shape("block", &cube).unwrap();
    world.add_sphere("ball", 0.8 * EDGE).unwrap();
    let [along, rows] = COUNT;
    let count = (along * rows) as usize;
    let mut x = 0.3_f64;
    let mut next = || {
        x = (x * 997.0 + 0.123).fract();
        x
    };
    let mut places: Vec<usize> = (0..count).collect();
    for k in (1..count).rev() {
        places.swap(k, (next() * (k + 1) as f64) as usize);
    }
    let mut ids = vec![0; count];
    for place in places {
        let (i, j) = (place as u32 % along, place as u32 / along);
        let gap = if j == 2 { 0.4 } else { 0.0 };
        let at = Vector3::new(f64::from(i) + 1.0, 1.5, f64::from(j) + 1.3 + gap) * EDGE;
        let spec = BodySpec::at_rest(shape, 2500.0, Pose::translation(at.x, at.y, at.z));
        ids[place] = world.add_body(spec).unwrap();
    }
    let mut bond = |bodies: [BodyId; 2]| {
        let section = world.section_between(bodies, 1e-6, 1.0).unwrap();
        world.add_bond(bodies, &section.unwrap(), MORTAR).unwrap();
    };
    for place in 0..count {
        if !(place as u32 + 1).is_multiple_of(along) {
            bond([ids[place + 1], ids[place]]);
        }
        if place < along as usize {
            bond([ids[place], ids[place + along as usize]]);
        }
    }
    world
}

fn ball(k: u32) -> BodySpec {
    let at = Vector3::new(4.0 * f64::from(k % 3) + 3.0, 1.5, 9.0) * EDGE;
    BodySpec {
        velocity: Vector3::new(0.0, 0.0, -5.0),
        ..BodySpec::at_rest(1, 2500.0, Pose::translation(at.x, at.y, at.z))
    }
}

/// Falls, comes to rest, and is struck by balls. Returns how many bodies of the whole slept before, and after.
fn course(world: &mut World, halo: &mut dyn Halo) -> [usize; 2] {
    let steps = |world: &mut World, halo: &mut dyn Halo, count: u32| {
        for _ in 0..count {
            world.step_on(halo).unwrap();
        }
        let sleeps = world.of_whole(halo, |world, id| world.is_asleep(id));
        sleeps.unwrap().into_iter().filter(|sleeps| *sleeps).count()
    };
    let mut before = 0;
    while before < 15 {
        before = steps(world, halo, 100);
        assert!(world.steps() < 12_000, "{before}");
    }
    for k in 0..3 {
        world.add_body(ball(k)).unwrap();
    }
    [before, steps(world, halo, 600)]
}

#[test]
fn bonded_bodies_have_the_same_bits_on_any_ranks() {
    let world = masonry();
    let mut alone = world.clone();
    let [before, after] = course(&mut alone, &mut Alone);
    let ended = alone.bonds().filter(|(_, bond)| bond.has_ended()).count();
    let whole = alone.bonds().filter(|(_, bond)| !bond.is_broken());
    assert!(ended > 3 && whole.count() > 3, "{ended} have ended");
    assert!(before > 10 && after < before, "{before} and {after} slept");
    let expected = alone.checksum_of_motion().unwrap();
    for size in [1, 2, 3, 4] {
        let parts = Threads::each(size, |halo| {
            let mut world = world.clone();
            world.share_out(halo).unwrap();
            assert_eq!(course(&mut world, halo), [before, after], "{size} ranks");
            assert!(world.bonds().next().is_some());
            (world.to_bytes(), world.gather(halo).unwrap())
        });
        let (parts, wholes): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
        let whole = wholes.into_iter().next().unwrap().unwrap();
        let found = whole.checksum_of_motion().unwrap();
        assert_eq!(found, expected, "{size} ranks");
        assert!(whole.bonds().eq(alone.bonds()), "{size} ranks");
        let parts = parts.into_iter().map(|bytes| World::from_bytes(&bytes?));
        let joined = World::of_parts(parts).unwrap();
        assert_eq!(joined.checksum_of_motion().unwrap(), expected);
        assert!(joined.bonds().eq(alone.bonds()), "{size} ranks");
        let books = [&alone, &whole].map(World::ledger);
        let scale = books[0].exchanged;
        for (a, b) in [
            (books[0].error(), books[1].error()),
            (books[0].dissipated_bonds, books[1].dissipated_bonds),
            (books[0].dissipated_release, books[1].dissipated_release),
            (books[0].bonds, books[1].bonds),
        ] {
            assert!((a - b).abs() < 1e-9 * scale, "{a:e} {b:e}");
        }
    }
}

/// Also numbers of bodies whose bonds have ended.
#[test]
fn bonded_bodies_may_leave() {
    let mut world = masonry();
    let ended = |world: &World| -> BTreeSet<BodyId> {
        let ended = world.bonds().filter(|(_, bond)| bond.has_ended());
        ended.flat_map(|(_, bond)| bond.bodies()).collect()
    };
    while ended(&world).len() < 4 {
        world.step().unwrap();
        assert!(world.time() < 1.0, "{:?}", ended(&world));
    }
    let bodies = Vec::from_iter(ended(&world));
    let gone = [[bodies[3], bodies[0]], [bodies[2], bodies[1]]];
    comes_and_goes_alike(&world, gone, ball);
}

/// A row of bonded blocks that lies, and a rubber cube above one of them, which breaks by a fracture if it has one.
fn row_below_a_cube(fracture: Option<Fracture>) -> World {
    let mut parameters = WorldParameters::default();
    parameters.sleeping.window = 20;
    parameters.sleeping.tolerance = 0.05;
    parameters.contact.penalty = 1e7;
    parameters.contact.damping_ratio = 0.5;
    let mut world = World::new(parameters).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(EDGE * 3_f64.sqrt()).unwrap();
    let shape = world.add_shape("block", &cube).unwrap();
    let model = world.add_model("rubber", rubber_cube(EDGE), ContactStiffness::default());
    let place = |x: f64, z: f64| Pose::translation(x * EDGE, 0.5 * EDGE, z * EDGE);
    let mut row: Vec<BodyId> = Vec::new();
    for k in 0..BLOCKS {
        let spec = BodySpec::at_rest(shape, 2500.0, place(k as f64 + 0.5, 0.5));
        row.push(world.add_body(spec).unwrap());
    }
    for pair in row.windows(2) {
        let bodies = [pair[0], pair[1]];
        let section = world.section_between(bodies, 1e-6, 1.0).unwrap();
        world.add_bond(bodies, &section.unwrap(), MORTAR).unwrap();
    }
    let spec = DeformableSpec::at_rest(model.unwrap(), place(1.7, 2.5));
    world
        .add_deformable(DeformableSpec { fracture, ..spec })
        .unwrap();
    world
}

/// When bodies fall asleep, wake or fall apart: the step, how many blocks sleep then, and all bodies.
fn struck(world: &mut World, halo: &mut dyn Halo) -> Vec<(u64, usize, usize)> {
    let mut changes = Vec::new();
    let mut before = (0, world.count_in_whole());
    for _ in 0..1000 {
        world.step_on(halo).unwrap();
        world.fragment_bodies_on(halo).unwrap();
        let rest = |world: &World, id| id < BLOCKS as BodyId && world.is_asleep(id);
        let asleep = world.of_whole(halo, rest).unwrap();
        let asleep = asleep.into_iter().filter(|sleeps| *sleeps).count();
        let now = (asleep, world.count_in_whole());
        if now != before {
            changes.push((world.steps(), now.0, now.1));
        }
        before = now;
    }
    changes
}

/// All blocks wake in the step in which something deformable touches one, and move in that step.
#[test]
fn bonded_bodies_wake_together_where_a_deformable_one_strikes() {
    let fracture = Fracture {
        coarse: true,
        every: 3,
        ..Fracture::new(Strength::new(1.5e3, 4e3, 0.6).unwrap(), [0.02, 0.1])
    };
    for fracture in [None, Some(fracture)] {
        let world = row_below_a_cube(fracture);
        let mut alone = world.clone();
        let expected = struck(&mut alone, &mut Alone);
        let woke = |pair: &[(u64, usize, usize)]| pair[0].1 == BLOCKS && pair[1].1 == 0;
        assert!(expected.windows(2).any(woke), "{expected:?}");
        let pieces = alone.deformable_count();
        assert_eq!(pieces > 1, fracture.is_some(), "{pieces}");
        for size in [1, 2, 3, 4] {
            let parts = Threads::each(size, |halo| {
                let mut world = world.clone();
                world.share_out(halo).unwrap();
                assert_eq!(struck(&mut world, halo), expected, "{size} ranks");
                world.gather(halo).unwrap()
            });
            let whole = parts.into_iter().next().unwrap().unwrap();
            let [found, expected] =
                [&whole, &alone].map(|world| world.checksum_of_motion().unwrap());
            assert_eq!(found, expected, "{size} ranks");
        }
    }
}

/// Radius of a ball of a pair, m, and how far apart those may be that are shared.
const BALL: f64 = 0.02;
const REACH: f64 = (2.0 * 1.1 + 1.5) * BALL;

/// Bonded balls beside each other in free space, whose velocity and angular velocity are given by their places, m/s and rad/s.
fn pair(apart: Vector3, motion: impl Fn(Vector3) -> [Vector3; 2], cube: Option<Vector3>) -> World {
    let parameters = WorldParameters {
        gravity: Vector3::zeros(),
        ..WorldParameters::default()
    };
    let mut world = World::new(parameters).unwrap();
    let shape = world.add_sphere("ball", BALL).unwrap();
    let bodies = [-0.5, 0.5].map(|side| {
        let at = side * apart;
        let [velocity, angular_velocity] = motion(at);
        let spec = BodySpec {
            velocity,
            angular_velocity,
            ..BodySpec::at_rest(shape, 2500.0, Pose::translation(at.x, at.y, at.z))
        };
        world.add_body(spec).unwrap()
    });
    let section = BondSection::disc(Vector3::zeros(), apart.normalize(), 0.5 * BALL).unwrap();
    let rubber = BondLaw {
        stiffness: 1e7,
        energies: [1e3, 4e3],
        ..MORTAR
    };
    world.add_bond(bodies, &section, rubber).unwrap();
    if let Some(at) = cube {
        let model = world.add_model("rubber", rubber_cube(0.1), ContactStiffness::default());
        let place = Pose::translation(at.x, at.y, at.z);
        let spec = DeformableSpec::at_rest(model.unwrap(), place);
        world.add_deformable(spec).unwrap();
    }
    world
}

/// Both turn about their middle.
fn turning(at: Vector3) -> [Vector3; 2] {
    let turn = Vector3::new(0.0, 0.0, 10.0);
    [turn.cross(&at), turn]
}

/// They go apart, along the border between them.
fn parting(at: Vector3) -> [Vector3; 2] {
    [Vector3::new(4.0 * at.x, 10.0, 0.0), Vector3::zeros()]
}

/// Moves on for so long, s; without its soft body from then on.
fn moves(world: &mut World, halo: &mut dyn Halo, until: [f64; 2]) {
    while world.time() < until[0] {
        world.step_on(halo).unwrap();
    }
    if world.count_in_whole() > 2 {
        world.remove_bodies_on(&[2], halo).unwrap();
    }
    while world.time() < until[1] {
        world.step_on(halo).unwrap();
    }
}

/// Bonds that were let in are stretched, or the body leaves that was so large that the balls were near each other beside it.
#[test]
fn bonds_that_were_shared_stay_known() {
    let cube = Vector3::new(-0.5, 0.0, 0.0);
    for (world, until) in [
        (
            pair(Vector3::x() * (0.9999 * REACH), parting, None),
            [0.003, 0.006],
        ),
        (
            pair(Vector3::new(0.15, 0.15, 0.0), turning, Some(cube)),
            [0.1, 0.3],
        ),
    ] {
        let mut alone = world.clone();
        moves(&mut alone, &mut Alone, until);
        let [a, b] = [0, 1].map(|id| alone.position(id).unwrap());
        assert!((b - a).norm() > REACH, "{:e}", (b - a).norm() - REACH);
        assert!(!alone.bonds().next().unwrap().1.is_broken());
        let expected = alone.checksum_of_motion().unwrap();
        let mut apart = false;
        for size in [2, 3, 4] {
            let parts = Threads::each(size, |halo| {
                let mut world = world.clone();
                world.share_out(halo).unwrap();
                moves(&mut world, halo, until);
                (world.own_bodies(0).count(), world.gather(halo).unwrap())
            });
            apart |= parts.iter().all(|(own, _)| *own < 2);
            let whole = parts.into_iter().next().unwrap().1.unwrap();
            let found = whole.checksum_of_motion().unwrap();
            assert_eq!(found, expected, "{size} ranks");
        }
        assert!(apart);
    }
}

#[test]
fn bonded_bodies_that_are_far_apart_are_not_shared() {
    // Along each axis they are near, until they turn.
    let slanted = Vector3::new(1.0, 1.0, 0.0).normalize() * (1.1 * REACH);
    let refused = pair(slanted, turning, None).share_out(&mut Alone);
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("farther apart"), "{refused}");
    let mut world = masonry();
    let ball = |x: f64| BodySpec::at_rest(1, 2500.0, Pose::translation(x, 0.08, 0.3));
    let bodies = [0.05, 0.75].map(|x| world.add_body(ball(x)).unwrap());
    let middle = Vector3::new(0.4, 0.08, 0.3);
    let section = BondSection::disc(middle, Vector3::x(), 0.02).unwrap();
    world.add_bond(bodies, &section, MORTAR).unwrap();
    // Wherever the borders are, and before anything changes.
    for size in [1, 3] {
        let refused = Threads::each(size, |halo| {
            let mut world = world.clone();
            let before = world.state_hash().unwrap();
            let refused = world.share_out(halo).unwrap_err().to_string();
            assert_eq!(world.state_hash().unwrap(), before);
            refused
        });
        for refused in refused {
            assert!(refused.contains("farther apart"), "{refused}");
        }
    }
}
