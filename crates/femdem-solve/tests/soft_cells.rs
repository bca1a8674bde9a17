//! Deformable bodies in periodic space.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{D, DENSITY, noise, pose, solid, turned, weightless};
use femdem_contact::{BodyId, PeriodicCell};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use femdem_mesh::{Rotation, TetMesh};
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, ModelId, World, WorldParameters};

/// Side of the cubes, m.
const A: f64 = 0.06;

const YOUNG: f64 = 1e6;

fn world(parameters: WorldParameters, sides: Option<[f64; 3]>) -> (World, ModelId) {
    let mut world = World::new(parameters).unwrap();
    if let Some(sides) = sides {
        let cell = PeriodicCell::new(sides.map(Some)).unwrap();
        world.set_cell(cell).unwrap();
    }
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(A)).unwrap();
    let rubber = MaterialRegion {
        material: NeoHookean::new(YOUNG, 0.0).unwrap().into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![rubber], None).unwrap();
    let stiffness = ContactStiffness::default();
    let model = world.add_model("cube", model, stiffness).unwrap();
    (world, model)
}

/// Adds a cube with its centre at a place.
fn add(
    world: &mut World,
    model: ModelId,
    centre: Vector3<f64>,
    turn: Rotation,
    velocity: Vector3<f64>,
) -> BodyId {
    let corner = centre - turn * Vector3::repeat(0.5 * A);
    let mut spec = DeformableSpec::at_rest(model, pose(corner, turn));
    spec.velocity = velocity;
    world.add_deformable(spec).unwrap()
}

/// What meets over an edge moves as what meets inside: two deformable cubes, and one and a rigid body, whichever of them is beyond.
#[test]
fn a_collision_over_an_edge_is_that_inside() {
    let side = 0.4;
    for (rigid, beyond) in [(false, 1), (true, 1), (true, 0)] {
        let [mut inside, mut across] = [false, true].map(|periodic| {
            let parameters = weightless(1e6, 0.4, 0.3);
            let (mut world, model) = world(parameters, periodic.then_some([side; 3]));
            let over = |k| Vector3::x() * if periodic && k == beyond { side } else { 0.0 };
            let turn = Rotation::identity();
            let speed = Vector3::new(0.5, 0.1, 0.0);
            add(&mut world, model, over(0), turn, speed);
            let place = Vector3::new(0.1, -0.01, 0.012) + over(1);
            if rigid {
                let shape = world.add_shape("A10", &solid("A10")).unwrap();
                let mut spec = BodySpec::at_rest(shape, DENSITY, pose(place, turned(4)));
                spec.velocity = -speed;
                world.add_body(spec).unwrap();
            } else {
                add(&mut world, model, place, turned(4), -speed);
            }
            world
        });
        let momentum = |world: &World| {
            let soft = world.deformables().map(|body| body.momentum());
            let hard = world.velocity(1).filter(|_| rigid).unwrap_or_default();
            let mass = DENSITY * solid("A10").mass_properties().volume;
            soft.sum::<Vector3<f64>>() + hard * mass
        };
        let before = momentum(&across);
        let mut met = 0;
        while inside.time() < 0.1 {
            inside.step().unwrap();
            across.step().unwrap();
            met += inside.deformable_contacts().count();
        }
        assert!(met > 20, "{rigid} {beyond}: {met}");
        let away = Vector3::x() * side;
        for id in 0..2 {
            let shift = if id == beyond { away } else { Vector3::zeros() };
            let pairs = match (inside.deformable(id), across.deformable(id)) {
                (Some(one), Some(other)) => {
                    let x = one
                        .positions()
                        .iter()
                        .copied()
                        .zip(other.positions().iter().copied());
                    x.collect()
                }
                _ => vec![(inside.position(id).unwrap(), across.position(id).unwrap())],
            };
            for (one, other) in pairs {
                assert!((other - one - shift).norm() < 1e-9 * A, "{}", other - one);
            }
        }
        let lost = momentum(&across) - before;
        assert!(lost.norm() < 1e-11, "{rigid} {beyond}: {lost}");
        let errors = [&inside, &across].map(|world| world.ledger().error());
        assert!((errors[0] - errors[1]).abs() < 1e-9 * inside.ledger().initial);
    }
}

/// Five cubes in a row that touch each other, the last the first.
fn ring(depth: f64, damping: f64) -> World {
    let pitch = A - depth;
    let (mut world, model) = world(weightless(1e6, 0.0, damping), Some([5.0 * pitch, 0.3, 0.3]));
    for i in 0..5 {
        let centre = Vector3::new(f64::from(i) * pitch, 0.0, 0.0);
        add(
            &mut world,
            model,
            centre,
            Rotation::identity(),
            Vector3::zeros(),
        );
    }
    world
}

/// A ring of cubes that is compressed slowly with its cell carries the stress of a bar whose contacts give way, too, and the work over
/// the edges is what it stores.
#[test]
fn a_compressed_ring_has_the_stress_of_its_contacts() {
    let mut world = ring(1e-4 * A, 0.5);
    world.step().unwrap();
    let mut rates = Matrix3::zeros();
    rates.m11 = -0.05 * A;
    world.deform_cell(rates).unwrap();
    while world.time() < 0.25 {
        world.step().unwrap();
    }
    world.deform_cell(Matrix3::zeros()).unwrap();
    while world.time() < 0.5 {
        world.step().unwrap();
    }
    let force = |contact: &femdem_contact::Contact| contact.normal_force;
    let forces: Vec<f64> = world.deformable_contacts().map(force).collect();
    assert_eq!(forces.len(), 5);
    let stress = world.cell_stress().unwrap() * 0.09;
    for force in &forces {
        assert!(
            (stress.m11 / force - 1.0).abs() < 1e-3,
            "{stress} {forces:?}"
        );
    }
    // The mean stress within the cubes is that of the cell, over their part of its volume.
    let body = world.deformable(2).unwrap();
    let elements = body.stresses().unwrap();
    let (model, x) = (body.model(), body.positions());
    let volume = |tet: &[u32; 4]| {
        let [a, b, c, d] = tet.map(|i| x[i as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0
    };
    let volumes: Vec<f64> = model.mesh().tets().iter().map(volume).collect();
    let sum: f64 = elements
        .iter()
        .zip(&volumes)
        .map(|(e, v)| -e.cauchy.m11 * v)
        .sum();
    let whole = 5.0 * sum / world.cell().unwrap().volume().unwrap();
    assert!(
        (whole * 0.09 / stress.m11 - 1.0).abs() < 5e-3,
        "{whole} {stress}"
    );
    let ledger = world.ledger();
    assert!(
        ledger.error_relative().abs() < 1e-3,
        "{}",
        ledger.error_relative()
    );
    assert!(ledger.kinetic < 1e-3 * ledger.work_in && ledger.work_in > 0.0);
}

/// Eight soft cubes and eight rigid grains in a cell that is compressed and sheared.
fn mixture(medium: f64) -> World {
    let side = 4.0 * D;
    let mut parameters = weightless(1e6, 0.5, 0.3);
    parameters.medium.drag = medium;
    let (mut world, model) = world(parameters, Some([side; 3]));
    let shape = world.add_shape("A10", &solid("A10")).unwrap();
    for i in 0..27_u64 {
        let grid = [i % 3, i / 3 % 3, i / 9].map(|k| k as f64);
        let jitter = [0, 1, 2].map(|k| 0.1 * noise(70 + 3 * i + k));
        // Some are a cell away from the others.
        let over = Vector3::new(0.0, if i % 5 == 0 { side } else { 0.0 }, 0.0);
        let place = (Vector3::from(grid) + Vector3::from(jitter)) * (side / 3.0) + over;
        let velocity = Vector3::new(noise(i), noise(i + 200), noise(i + 400)) * 0.3;
        if i % 2 == 0 {
            add(&mut world, model, place, turned(i), velocity);
        } else {
            let mut spec = BodySpec::at_rest(shape, DENSITY, pose(place, turned(i)));
            spec.velocity = velocity;
            world.add_body(spec).unwrap();
        }
    }
    let mut rates = Matrix3::zeros();
    rates.m11 = -0.6 * side;
    rates.m22 = -0.6 * side;
    rates.m33 = -0.6 * side;
    rates.m13 = 0.5 * side;
    world.deform_cell(rates).unwrap();
    world
}

/// The ledger of a mixture that is compressed and sheared closes, with and without a medium, and so does its momentum.
#[test]
fn a_mixture_that_is_sheared_keeps_its_books() {
    for drag in [0.0, 5.0] {
        let mut world = mixture(drag);
        let momentum = |world: &World| {
            let soft = world.deformables().map(|body| body.momentum());
            let hard = (1..27).step_by(2).map(|i| world.velocity(i).unwrap());
            let mass = DENSITY * solid("A10").mass_properties().volume;
            soft.sum::<Vector3<f64>>() + hard.sum::<Vector3<f64>>() * mass
        };
        let before = momentum(&world);
        let (mut most, mut over) = (0.0_f64, 0);
        while world.time() < 0.4 {
            world.step().unwrap();
            most = most.max(world.cell_stress().unwrap().trace());
            over += world.deformable_contacts().count();
        }
        let ledger = world.ledger();
        assert!(over > 1000 && most > 0.0, "{over} {most}");
        assert!(
            ledger.error_relative().abs() < 0.01,
            "{}",
            ledger.error_relative()
        );
        if drag == 0.0 {
            assert!(
                (momentum(&world) - before).norm() < 1e-10,
                "{}",
                momentum(&world) - before
            );
        }
    }
}

/// The same bits through a checkpoint, and with several threads.
#[test]
fn a_mixture_has_the_same_bits_with_threads_and_through_bytes() {
    let run = |world: &mut World, end: f64| {
        while world.time() < end {
            world.step().unwrap();
        }
    };
    let mut whole = mixture(0.0);
    run(&mut whole, 0.3);
    let mut parts = mixture(0.0);
    for end in [0.11, 0.2, 0.3] {
        run(&mut parts, end);
        parts = World::from_bytes(&parts.to_bytes().unwrap()).unwrap();
    }
    assert!(whole.to_bytes().unwrap() == parts.to_bytes().unwrap());
    #[cfg(feature = "parallel")]
    {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let hash = pool.unwrap().install(|| {
            let mut world = mixture(0.0);
            run(&mut world, 0.3);
            world.state_hash().unwrap()
        });
        assert_eq!(hash, whole.state_hash().unwrap());
    }
}

/// A cell too small for a cube is refused by name.
#[test]
fn a_cell_too_small_for_a_cube_is_refused() {
    let (mut world, model) = world(weightless(1e6, 0.5, 0.3), Some([0.2; 3]));
    add(
        &mut world,
        model,
        Vector3::zeros(),
        Rotation::identity(),
        Vector3::zeros(),
    );
    let error = world.step().unwrap_err().to_string();
    assert!(error.contains("side of a periodic cell"), "{error}");
}
