//! Worlds in periodic space and worlds whose walls are controlled, shared out over ranks: the same bits as one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::ranks::Threads;
use crate::common::{D, DENSITY, noise, pose, solid, turned, weightless};
use crate::ranks::{as_alone, goes_on_from_parts, goes_on_from_the_first};
use femdem_contact::{Partner, PeriodicCell, Wall};
use femdem_fem::element::Element;
use femdem_fem::material::{AnyMaterial, NeoHookean};
use femdem_fem::{DeformableModel, Driven, MaterialRegion};
use femdem_mesh::{Matrix3, TetMesh, Vector3};
use femdem_solve::{
    Alone, AppliedLoad, BodySpec, ContactStiffness, DeformableSpec, Drive, Halo, Servo, SolveError,
    World, WorldParameters,
};

const SIDES: [f64; 3] = [7.2 * D, 4.4 * D, 4.4 * D];

/// Which grains are soft, one of them two cells away.
const FAR: [(u32, f64); 2] = [(20, 0.0), (61, 2.0 * SIDES[1])];

/// Grains of three shapes in a cell, numbered at random, some of them cells away, that fly about.
fn grains(parameters: WorldParameters) -> World {
    let mut world = World::new(parameters).unwrap();
    let cell = PeriodicCell::new(SIDES.map(Some)).unwrap();
    world.set_cell(cell).unwrap();
    let mut shapes = ["P5", "A10"]
        .map(|id| world.add_shape(id, &solid(id)).unwrap())
        .to_vec();
    shapes.push(world.add_sphere("ball", 0.45 * D).unwrap());
    for i in 0..96_u64 {
        // 35 has no factor in common with 96.
        let place = 35 * i % 96;
        let grid = [place % 6, place / 6 % 4, place / 24].map(|k| k as f64 * 1.1 * D);
        let jitter = [0, 1, 2].map(|k| 0.1 * D * noise(3 * i + k));
        let over = match i % 7 {
            0 => Vector3::new(SIDES[0], 0.0, -2.0 * SIDES[2]),
            1 => Vector3::new(0.0, -SIDES[1], 0.0),
            _ => Vector3::zeros(),
        };
        let x = Vector3::from(grid) + Vector3::from(jitter) + over;
        let shape = shapes[(i % 3) as usize];
        let mut spec = BodySpec::at_rest(shape, DENSITY, pose(x, turned(i)));
        spec.velocity = Vector3::new(noise(i), noise(i + 200), noise(i + 400)) * 0.8;
        world.add_body(spec).unwrap();
    }
    world
}

/// Two soft cubes in place of stones, the second as far away.
fn with_soft_cubes(mut world: World, places: [(u32, f64); 2]) -> World {
    let mesh = TetMesh::block([2; 3], &Vector3::repeat(0.6 * D)).unwrap();
    let points = mesh.points().iter();
    let points = points.map(|p| p - Vector3::repeat(0.3 * D)).collect();
    let mesh = TetMesh::new(points, mesh.tets().to_vec()).unwrap();
    let material = AnyMaterial::NeoHookean(NeoHookean::new(1e6, 0.3).unwrap());
    let region = MaterialRegion {
        material,
        density: 1500.0,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let model = world
        .add_model("cube", model, ContactStiffness::default())
        .unwrap();
    for (id, shift) in places {
        let x = world.position(id).unwrap();
        let velocity = world.velocity(id).unwrap();
        world.remove_body(id).unwrap();
        let place = x + Vector3::new(0.0, shift, 0.0);
        let mut spec = DeformableSpec::at_rest(model, pose(place, turned(id.into())));
        spec.velocity = velocity;
        world.add_deformable(spec).unwrap();
    }
    world
}

fn stepped(world: &World, steps: u32) -> World {
    let mut alone = world.clone();
    for _ in 0..steps {
        alone.step().unwrap();
    }
    alone
}

#[test]
fn grains_in_a_fixed_cell_have_the_same_bits() {
    let mut parameters = weightless(1e6, 0.5, 0.5);
    parameters.medium.drag = 30.0;
    parameters.sleeping.enabled = true;
    parameters.sleeping.window = 40;
    let world = grains(parameters);
    let alone = stepped(&world, 2500);
    assert!(alone.cell_stress().unwrap().norm() > 0.0);
    let moved = [2, 3, 4].map(|size| as_alone(&alone, &world, size, 2500).1);
    assert!(moved.iter().any(|moved| *moved > 0), "{moved:?}");
}

/// Compressed slowly and sheared fast, so that bodies of several cells are carried over the borders of the ranks.
fn rates() -> Matrix3 {
    let sides = Matrix3::from_diagonal(&Vector3::from(SIDES));
    Matrix3::new(-0.2, 0.0, 2.0, 0.0, -0.2, 0.0, 0.0, 0.0, -0.2) * sides
}

#[test]
fn grains_in_a_cell_that_is_sheared_have_the_same_bits() {
    let mut world = grains(weightless(1e6, 0.5, 0.5));
    world.deform_cell(rates()).unwrap();
    let alone = stepped(&world, 4000);
    assert!(alone.time() > 0.1, "{}", alone.time());
    // In motion, with forces over the edges, which do work in the next half step.
    goes_on_from_the_first(&alone, 100);
    goes_on_from_parts(&alone, 50);
    let moved = [2, 3, 4].map(|size| as_alone(&alone, &world, size, 4000).1);
    assert!(moved.iter().any(|moved| *moved > 0), "{moved:?}");
}

#[test]
fn soft_bodies_in_a_cell_that_is_sheared_have_the_same_bits() {
    let mut parameters = weightless(1e6, 0.5, 0.5);
    parameters.medium.drag = 2.0;
    let mut world = with_soft_cubes(grains(parameters), FAR);
    world.deform_cell(rates()).unwrap();
    let alone = stepped(&world, 1500);
    let moved = [2, 4].map(|size| as_alone(&alone, &world, size, 1500).1);
    assert!(moved.iter().any(|moved| *moved > 0), "{moved:?}");
}

/// A cell that follows a pressure along x and a rate of shear.
fn follow(world: &mut World, halo: &mut dyn Halo, steps: u32) -> Result<f64, SolveError> {
    let mut servo = Servo::new(0.5)?;
    let mut stress = 0.0;
    for _ in 0..steps {
        let met = world.cell_resistance(halo)?.unwrap();
        let edges = *world.cell().unwrap().edges();
        let area = edges.m22 * edges.m33;
        let meets = femdem_solve::Resistance {
            force: met.stress.m11 * area,
            stiffness: met.stiffness[0],
            energy: met.energy,
        };
        let mut rates = Matrix3::zeros();
        rates.m11 = -servo.velocity(&meets, 2e3 * area, world.time_step());
        rates.m13 = 0.5 * edges.m33;
        world.deform_cell_on(rates, halo)?;
        world.step_on(halo)?;
        stress = met.stress.m11;
    }
    Ok(stress)
}

#[test]
fn a_cell_that_follows_a_stress_has_the_same_bits() {
    let world = with_soft_cubes(grains(weightless(1e6, 0.5, 0.5)), FAR);
    let mut alone = world.clone();
    let stress = follow(&mut alone, &mut Alone, 1500).unwrap();
    assert!(stress > 0.0);
    let met = alone.cell_resistance(&mut Alone).unwrap().unwrap();
    assert_eq!(met.stress, alone.cell_stress().unwrap());
    assert!((met.energy / alone.stored_energy() - 1.0).abs() < 1e-12);
    for size in [2, 3] {
        let wholes = Threads::each(size, |halo| {
            let mut world = world.clone();
            world.share_out(halo).unwrap();
            assert_eq!(follow(&mut world, halo, 1500).unwrap(), stress);
            world.gather(halo).unwrap()
        });
        let whole = wholes.into_iter().flatten().next().unwrap();
        let [found, expected] = [&whole, &alone].map(|world| world.checksum_of_motion().unwrap());
        assert_eq!(found, expected, "{size} ranks");
    }
}

/// Stones and soft cubes under a lid that a servo presses.
fn pressed() -> (World, u32) {
    let mut parameters = weightless(1e6, 0.5, 0.5);
    parameters.gravity = Vector3::new(0.0, 0.0, -9.81);
    let mut world = World::new(parameters).unwrap();
    let high = Vector3::new(4.4, 3.0, 4.5) * D;
    let mut lid = 0;
    for wall in Wall::closed_box(-0.7 * Vector3::repeat(D), high).unwrap() {
        let is_lid = wall.planes()[0].normal.z < -0.5;
        let id = world.add_wall(wall, Drive::Fixed).unwrap();
        if is_lid {
            lid = id;
        }
    }
    world.drive_wall_by_host(lid, Driven::default()).unwrap();
    let shape = world.add_shape("A10", &solid("A10")).unwrap();
    for i in 0..48_u64 {
        let place = 35 * i % 48;
        let grid = [place % 4, place / 4 % 3, place / 12].map(|k| k as f64 * 1.05 * D);
        let spec = BodySpec::at_rest(shape, DENSITY, pose(Vector3::from(grid), turned(i)));
        world.add_body(spec).unwrap();
    }
    // In the uppermost layer.
    (with_soft_cubes(world, [(12, 0.0), (23, 0.0)]), lid)
}

fn press(
    world: &mut World,
    lid: u32,
    halo: &mut dyn Halo,
    steps: u32,
) -> Result<[f64; 2], SolveError> {
    let (mut servo, mut moved) = (Servo::new(0.5)?, 0.0);
    let mut force = 0.0;
    for step in 0..steps {
        // A stone and a soft cube, which are pushed to and fro.
        let push = Vector3::x() * if step < steps / 2 { 0.2 } else { -0.1 };
        let load = AppliedLoad::at_point(push, Vector3::zeros());
        world.set_loads_on(&[(5, load), (12, load)], halo)?;
        let met = world.resistances(&[(lid, -Vector3::z())], halo)?[0];
        force = met.force;
        let velocity = servo.velocity(&met, 40.0, world.time_step());
        let start = world.time();
        let driven = |thing, end: f64| {
            (thing == Partner::Wall(lid)).then(|| Driven {
                displacement: -Vector3::z() * (moved + velocity * (end - start)),
                velocity: -Vector3::z() * velocity,
                ..Driven::default()
            })
        };
        world.step_with_on(driven, halo)?;
        moved += velocity * (world.time() - start);
    }
    Ok([force, moved])
}

#[test]
fn a_lid_that_presses_has_the_same_bits() {
    let (world, lid) = pressed();
    let mut alone = world.clone();
    let pressed = press(&mut alone, lid, &mut Alone, 2500).unwrap();
    assert!((pressed[0] / 40.0 - 1.0).abs() < 0.1, "{pressed:?}");
    let met = alone
        .resistances(&[(lid, -Vector3::z())], &mut Alone)
        .unwrap()[0];
    let load = alone.wall_load(lid).unwrap().static_part().force.z;
    let contacts = alone.contacts().into_iter();
    let on_lid = contacts.filter(|contact| contact.a == Partner::Wall(lid));
    let against = |contact: &femdem_contact::Contact| {
        let n = contact.normal;
        contact.stiffness * n.z * n.z + contact.tangential_stiffness * (n.x * n.x + n.y * n.y)
    };
    let stiffness: f64 = on_lid.map(|contact| against(&contact)).sum();
    for (exact, direct) in [
        (met.force, load),
        (met.stiffness, stiffness),
        (met.energy, alone.stored_energy()),
    ] {
        assert!((exact / direct - 1.0).abs() < 1e-12, "{exact} {direct}");
    }
    let expected = alone.checksum_of_motion().unwrap();
    let moving = alone.kinetic_energy_on(&mut Alone).unwrap();
    assert!((moving / alone.kinetic_energy() - 1.0).abs() < 1e-12);
    for size in [2, 3, 4] {
        let wholes = Threads::each(size, |halo| {
            let mut world = world.clone();
            world.share_out(halo).unwrap();
            assert_eq!(press(&mut world, lid, halo, 2500).unwrap(), pressed);
            assert_eq!(world.kinetic_energy_on(halo).unwrap(), moving);
            world.gather(halo).unwrap()
        });
        let whole = wholes.into_iter().flatten().next().unwrap();
        assert_eq!(
            whole.checksum_of_motion().unwrap(),
            expected,
            "{size} ranks"
        );
    }
}

#[test]
fn what_ranks_cannot_do_in_a_cell_is_said() {
    // Two bodies in wide space, whose edges move a thousand times as fast as they.
    let mut fast = World::new(weightless(1e6, 0.5, 0.5)).unwrap();
    let cell = PeriodicCell::new([Some(2000.0 * D); 3]).unwrap();
    fast.set_cell(cell).unwrap();
    let shape = fast.add_shape("A10", &solid("A10")).unwrap();
    for x in [0.0, 1.2 * D] {
        let place = pose(Vector3::new(x, 0.0, 0.0), turned(1));
        fast.add_body(BodySpec::at_rest(shape, DENSITY, place))
            .unwrap();
    }
    let rate = Matrix3::from_diagonal(&Vector3::new(-2.0, 0.0, 0.0));
    fast.deform_cell(rate * 2000.0 * D).unwrap();
    let errors = Threads::each(2, |halo| {
        let mut world = fast.clone();
        world.share_out(halo).unwrap();
        world.step_on(halo).unwrap_err().to_string()
    });
    for error in errors {
        assert!(error.contains("the edges of the periodic cell"), "{error}");
    }
    let mut shared = grains(weightless(1e6, 0.5, 0.5));
    shared.share_out(&mut Alone).unwrap();
    let refused = shared.deform_cell(rates()).unwrap_err().to_string();
    assert!(refused.contains("gather it first"), "{refused}");
}
