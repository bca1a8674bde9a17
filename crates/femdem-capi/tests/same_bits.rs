//! The same scene here and in Rust.

use femdem_capi::*;
use femdem_solve::contact::{Field, Wall};
use femdem_solve::mesh::shapes::Shape;
use femdem_solve::mesh::tet::{MeshOptions, mesh};
use femdem_solve::mesh::{Pose, Vector3};
use femdem_solve::{BodySpec, Drive, World, WorldParameters};

use crate::common::{all, at, got, named, ok, resting, text};

/// Cubes, balls and tetrapods above each other, each shifted a little.
fn places() -> impl Iterator<Item = (usize, [f64; 3])> {
    (0..9).map(|k| {
        let x = 0.01 * k as f64;
        (k % 3, [0.2 + x, 0.25 - x, 0.1 + 0.13 * k as f64])
    })
}

fn in_rust() -> World {
    let mut world = World::new(WorldParameters::default()).unwrap();
    for wall in Wall::closed_box(Vector3::zeros(), Vector3::new(0.4, 0.4, 2.0)).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let surface = |name: &str| name.parse::<Shape>().unwrap().polyhedron(0.1).unwrap();
    let (cube, tetrapod) = (surface("cube"), surface("tetrapod"));
    let (tets, _) = mesh(&tetrapod, &MeshOptions::default()).unwrap();
    let shapes = [
        world.add_shape("cube", &cube).unwrap(),
        world.add_sphere("ball", 0.05).unwrap(),
        world
            .add_mesh_shape("tetrapod", &tetrapod, &tets, Field::Body)
            .unwrap(),
    ];
    for (shape, [x, y, z]) in places() {
        let pose = Pose::translation(x, y, z);
        let spec = BodySpec::at_rest(shapes[shape], 2000.0, pose);
        world.add_body(spec).unwrap();
    }
    world
}

fn in_c() -> FemdemWorld {
    let world = crate::common::world();
    let inside = FemdemBox {
        low: [0.0; 3],
        high: [0.4, 0.4, 2.0],
    };
    let sides = got(|to| femdem_world_add_box(world, Some(&inside), 0, to));
    assert_eq!((sides.low, sides.high), ([0, 2, 4], [1, 3, 5]));
    let shapes = ["cube", "sphere", "tetrapod"].map(|name| named(name, 0.1));
    for (shape, [x, y, z]) in places() {
        let motion = resting(at(x, y, z));
        got(|to| femdem_world_add_body(world, shapes[shape], 2000.0, Some(&motion), 0, to));
    }
    // Bodies keep what they need.
    for shape in shapes {
        ok(femdem_shape_free(shape));
    }
    world
}

#[test]
fn a_world_has_the_bits_of_one_in_rust() {
    let (mut rust, c) = (in_rust(), in_c());
    ok(femdem_world_set_threads(c, 2));
    for _ in 0..1500 {
        rust.step().unwrap();
    }
    ok(femdem_world_step(c, 1500));
    let state = got(|to| femdem_world_state(c, to));
    assert_eq!((state.time, state.steps), (rust.time(), rust.steps()));
    assert_eq!((state.body_count, state.wall_count), (9, 6));
    // SAFETY: lists and rooms of `all` fit.
    let motions = all(resting(at(0.0, 0.0, 0.0)), |to, room, count| unsafe {
        femdem_world_motions(c, to, room, count)
    });
    for (id, motion) in (0..).zip(&motions) {
        assert_eq!(motion.pose, rust.pose(id).unwrap().into());
        let velocities = [
            rust.velocity(id).unwrap(),
            rust.angular_velocity(id).unwrap(),
        ];
        let own = [motion.velocity.linear, motion.velocity.angular];
        assert_eq!(own, velocities.map(<[f64; 3]>::from));
        let load = got(|to| femdem_world_body_load(c, id, to));
        assert_eq!(
            load.force,
            <[f64; 3]>::from(rust.load(id).unwrap().total.force)
        );
    }
    let ledger = got(|to| femdem_world_ledger(c, to));
    assert_eq!(ledger.error, rust.ledger().error());
    let floor = got(|to| femdem_world_wall_load(c, 4, to));
    assert_eq!(
        floor.force,
        <[f64; 3]>::from(rust.wall_load(4).unwrap().total.force)
    );
    assert!(floor.force[2] < 0.0, "something lies on the floor");
    ok(femdem_world_free(c));
}

#[test]
fn files_and_bytes_go_on_with_the_same_bits() {
    let world = in_c();
    ok(femdem_world_step(world, 300));
    // SAFETY: lists and rooms of `all` fit.
    let bytes = all(0_u8, |to, room, count| unsafe {
        femdem_world_to_bytes(world, to, room, count)
    });
    let folder = tempfile::tempdir().unwrap();
    let path = text(folder.path().join("world.ckpt").to_str().unwrap());
    // SAFETY: the text lives longer.
    ok(unsafe { femdem_world_save(world, path.as_ptr()) });
    // SAFETY: the bytes live longer.
    let from_bytes = got(|to| unsafe { femdem_world_from_bytes(bytes.as_ptr(), bytes.len(), to) });
    // SAFETY: the text lives longer.
    let from_file = got(|to| unsafe { femdem_world_load(path.as_ptr(), to) });
    let hashes = [world, from_bytes, from_file].map(|world| {
        ok(femdem_world_step(world, 200));
        let hash = got(|to| femdem_world_hash(world, to));
        ok(femdem_world_free(world));
        hash
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
}
