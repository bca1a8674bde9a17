//! Worlds in periodic space.

use crate::common::{D, DENSITY, at, half_edge, noise, pose, solid, turned, weightless};
use femdem_contact::PeriodicCell;
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use femdem_solve::{Alone, BodySpec, World, WorldParameters};

#[expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
fn cube(sides: [f64; 3]) -> PeriodicCell {
    PeriodicCell::new(sides.map(Some)).unwrap()
}

/// Grains at random in a cubic cell, 64 of two shapes, that just do not touch or hardly.
#[expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
fn gas(parameters: WorldParameters, side: f64) -> World {
    let mut world = World::new(parameters).unwrap();
    world.set_cell(cube([side; 3])).unwrap();
    let shapes = ["P5", "A10"].map(|id| world.add_shape(id, &solid(id)).unwrap());
    for i in 0..64_u64 {
        let grid = [i % 4, i / 4 % 4, i / 16].map(|k| k as f64);
        let jitter = [0, 1, 2].map(|k| 0.1 * noise(900 + 3 * i + k));
        let place = (Vector3::from(grid) + Vector3::from(jitter)) * (0.25 * side);
        let spec = BodySpec::at_rest(shapes[(i % 2) as usize], DENSITY, pose(place, turned(i)));
        world.add_body(spec).unwrap();
    }
    world
}

/// Four cubes in a row that touch each other, the last the first, face to face.
#[expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
fn ring(world: &mut World, depth: f64) -> f64 {
    let pitch = 2.0 * half_edge() - depth;
    world
        .set_cell(cube([4.0 * pitch, 3.0 * D, 3.0 * D]))
        .unwrap();
    let shape = world.add_shape("cube", &solid("P5")).unwrap();
    for i in 0..4 {
        let place = Vector3::new(f64::from(i) * pitch, 0.0, 0.0);
        world
            .add_body(BodySpec::at_rest(shape, DENSITY, at(place)))
            .unwrap();
    }
    pitch
}

/// What meets over an edge moves as what meets inside.
#[test]
fn a_collision_over_an_edge_is_that_inside() {
    let side = 4.0 * D;
    let [mut inside, mut across] = [false, true].map(|periodic| {
        let mut world = World::new(weightless(1e6, 0.4, 0.3)).unwrap();
        if periodic {
            world.set_cell(cube([side; 3])).unwrap();
        }
        let shape = world.add_shape("A10", &solid("A10")).unwrap();
        let over = if periodic { side } else { 0.0 };
        for (x, way) in [(0.0, 1.0), (1.05 * D + over, -1.0)] {
            let place = pose(Vector3::new(x, 0.1 * way * D, 0.0), turned(way as u64 + 3));
            let mut spec = BodySpec::at_rest(shape, DENSITY, place);
            spec.velocity = Vector3::new(0.5 * way, 0.1, 0.0);
            world.add_body(spec).unwrap();
        }
        world
    });
    while inside.time() < 0.15 {
        inside.step().unwrap();
        across.step().unwrap();
    }
    let away = Vector3::new(side, 0.0, 0.0);
    for id in 0..2 {
        let off = across.velocity(id).unwrap() - inside.velocity(id).unwrap();
        assert!(off.norm() < 1e-9, "{off}");
        let off =
            across.position(id).unwrap() - inside.position(id).unwrap() - away * f64::from(id);
        assert!(off.norm() < 1e-9 * D, "{off}");
    }
    assert!(inside.velocity(0).unwrap().x < 0.2, "they have met");
}

/// The force of every contact of a ring of cubes over the area of the cell is the stress along it, and there is none across.
#[test]
fn the_stress_of_a_ring_is_its_force_over_the_area() {
    let mut world = World::new(weightless(1e6, 0.5, 0.0)).unwrap();
    ring(&mut world, 1e-3 * D);
    world.step().unwrap();
    let contacts = world.contacts();
    assert_eq!(contacts.len(), 4);
    let force = contacts[0].normal_force;
    let stress = world.cell_stress().unwrap();
    assert!((stress.m11 * 9.0 * D * D / force - 1.0).abs() < 1e-9);
    assert!((stress.norm() / stress.m11 - 1.0).abs() < 1e-9);
    assert!(
        world.velocity(0).unwrap().norm() < 1e-12,
        "it is in balance"
    );
}

/// A ring that is compressed with its cell has the same force in all contacts at all times, in proportion to the depth, and the work
/// over the edges is what it stores.
#[test]
fn a_compressed_ring_is_strained_evenly() {
    let mut world = World::new(weightless(1e6, 0.5, 0.0)).unwrap();
    let pitch = ring(&mut world, 1e-4 * D);
    world.step().unwrap();
    let met = world.cell_resistance(&mut Alone).unwrap();
    let stiffness = met.unwrap().stiffness[0];
    let before = (
        world.contacts()[0].normal_force,
        world.cell().unwrap().edges().m11,
    );
    let mut rates = Matrix3::zeros();
    rates.m11 = -0.02 * pitch;
    world.deform_cell(rates).unwrap();
    let end = world.time() + 0.1;
    let mut first = None;
    while world.time() < end {
        world.step().unwrap();
        let forces: Vec<f64> = world.contacts().iter().map(|c| c.normal_force).collect();
        let spread = forces
            .iter()
            .map(|f| (f / forces[0] - 1.0).abs())
            .fold(0.0, f64::max);
        assert!(spread < 1e-6, "{forces:?}");
        first
            .get_or_insert((forces[0] - before.0) / (before.1 - world.cell().unwrap().edges().m11));
    }
    // The force of a face on a face is linear in the depth.
    assert!(
        (first.unwrap() / stiffness - 1.0).abs() < 0.01,
        "{first:?} {stiffness}"
    );
    let depth = 1e-4 * D + 0.25 * (before.1 - world.cell().unwrap().edges().m11);
    let force = world.contacts()[0].normal_force;
    assert!((force / before.0 / (depth / (1e-4 * D)) - 1.0).abs() < 0.01);
    assert!(
        world.ledger().error_relative().abs() < 1e-3,
        "{}",
        world.ledger().error_relative()
    );
    // Space stands again: what the bodies had of its motion is taken back.
    world.deform_cell(Matrix3::zeros()).unwrap();
    assert!(world.ledger().kinetic < 1e-3 * world.ledger().elastic);
}

/// Grains with friction, damping and a drag, sheared and compressed at the same time: momentum is kept, the ledger closes, and
/// they resist.
#[test]
fn a_sheared_gas_keeps_its_books() {
    let mut parameters = weightless(1e6, 0.5, 0.5);
    parameters.medium.drag = 2.0;
    parameters.time_step.safety = 0.4;
    let side = 4.4 * D;
    let mut world = gas(parameters, side);
    let rates = Matrix3::new(-0.6, 0.0, 3.0, 0.0, -0.6, 0.0, 0.0, 0.0, -0.6) * side;
    world.deform_cell(rates).unwrap();
    let mass: f64 = world.body_ids().filter_map(|id| world.mass(id)).sum();
    // Two bodies move against each other as space does between them.
    let [near, far] = [3, 60].map(|id| (world.position(id).unwrap(), world.velocity(id).unwrap()));
    let expected = rates / side * (far.0 - near.0);
    assert!((far.1 - near.1 - expected).norm() < 1e-12);
    while world.time() < 0.4 {
        world.step().unwrap();
    }
    assert!(world.contacts().len() > 100, "{}", world.contacts().len());
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 5e-3, "{ledger:?}");
    assert!(
        ledger.dissipated_friction > 0.0
            && ledger.dissipated_damping > 0.0
            && ledger.dissipated_medium > 0.0
    );
    let drift = world.linear_momentum().norm() / (mass * 3.0 * side);
    assert!(drift < 1e-12, "{drift}");
    // Space is sheared by 1.2.
    let cell = *world.cell().unwrap();
    assert!((cell.edges().m13 / side - 3.0 * world.time()).abs() < 1e-9);
    let stress = world.cell_stress().unwrap();
    assert!(stress.m11 > 0.0 && stress.m22 > 0.0 && stress.m33 > 0.0);
    assert!(stress.m13 < 0.0, "it resists: {stress}");
}

#[test]
fn same_bits_through_a_checkpoint_and_with_threads() {
    let run = |threads: usize, halfway: bool| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut world = gas(weightless(1e6, 0.5, 0.5), 5.0 * D);
            let rates = Matrix3::new(-0.5, 0.2, 3.0, 0.0, -0.5, 0.1, 0.0, 0.0, -0.5) * (5.0 * D);
            world.deform_cell(rates).unwrap();
            for step in 0..600 {
                world.step().unwrap();
                if halfway && step == 300 {
                    world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
                }
            }
            assert!(world.contacts().len() > 20);
            world.state_hash().unwrap()
        })
    };
    let one = run(1, false);
    assert_eq!(one, run(3, false));
    assert_eq!(one, run(1, true));
}

#[test]
fn cells_are_refused_where_they_cannot_be() {
    let mut world = World::new(weightless(1e6, 0.5, 0.5)).unwrap();
    assert!(world.deform_cell(Matrix3::zeros()).is_err(), "no cell");
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros())))
        .unwrap();
    assert!(world.set_cell(cube([1.0; 3])).is_err(), "there are bodies");

    let mut world = gas(weightless(1e6, 0.5, 0.5), 5.0 * D);
    assert!(
        world.deform_cell(Matrix3::repeat(0.1)).is_err(),
        "edge x turns"
    );
    world.deform_cell(Matrix3::identity() * -0.1).unwrap();
    let refused = world.relax(&Default::default()).unwrap_err().to_string();
    assert!(refused.contains("periodic cell"), "{refused}");
    // Compressed too far for its bodies, which are told.
    let refused = world.set_cell(cube([2.0 * D; 3])).unwrap_err().to_string();
    assert!(refused.contains("2.25"), "{refused}");
}
