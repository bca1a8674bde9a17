//! Worlds with deformable bodies shared out over ranks: the same bits as one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::ranks::Threads;
use crate::ranks::{as_alone, comes_and_goes_alike, goes_on_from_parts, goes_on_from_the_first};
use femdem_contact::{ContactParameters, Partner, PeriodicCell, Wall};
use femdem_fem::element::Element;
use femdem_fem::material::{AnyMaterial, J2, NeoHookean};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Translation3, UnitQuaternion};
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{
    Alone, BodySpec, ContactStiffness, DeformableSpec, Drive, Halo, Medium, World, WorldParameters,
};

/// Edge of a cube, m.
const EDGE: f64 = 0.1;

const COUNT: usize = 12;

const SHAKE: Drive = Drive::Shake {
    stroke: Vector3::new(1.5 * EDGE, 0.0, 0.0),
    frequency: 4.0,
    start: 0.05,
    periods: 1,
};

/// A cube of rubber about its centre.
pub fn rubber_cube(edge: f64) -> DeformableModel {
    cube_of(
        edge,
        1,
        Element::T4,
        NeoHookean::new(1e6, 0.3).unwrap().into(),
    )
}

/// A cube of 5 tetrahedra in each cell, about its centre.
fn cube(cells: u32, element: Element, material: AnyMaterial) -> DeformableModel {
    cube_of(EDGE, cells, element, material)
}

fn cube_of(edge: f64, cells: u32, element: Element, material: AnyMaterial) -> DeformableModel {
    let mesh = TetMesh::block([cells; 3], &Vector3::repeat(edge)).unwrap();
    let points = mesh.points().iter();
    let points = points.map(|p| p - Vector3::repeat(0.5 * edge));
    let mesh = TetMesh::new(points.collect(), mesh.tets().to_vec()).unwrap();
    let density = 1000.0;
    let region = MaterialRegion { material, density };
    DeformableModel::new(&mesh, element, vec![region], None).unwrap()
}

/// Rubber, metal that flows, and stones, numbered at random, fall into a trough under gravity that leans over, past a cube that
/// is held at one of its sides. Where nothing sleeps, one of the stones and a side of a cube swing.
fn heap(sleeping: bool) -> World {
    let mut parameters = WorldParameters {
        gravity: Vector3::new(3.0, 0.0, -9.0),
        contact: ContactParameters {
            friction: 0.4,
            ..ContactParameters::default()
        },
        ..WorldParameters::default()
    };
    // So that they come to rest before long.
    parameters.medium.local_damping = if sleeping { 0.3 } else { 0.0 };
    parameters.sleeping.enabled = sleeping;
    parameters.sleeping.deformables = sleeping;
    parameters.sleeping.window = 40;
    parameters.sleeping.tolerance = 0.05;
    let mut world = World::new(parameters).unwrap();
    let (low, high) = (Vector3::zeros(), Vector3::new(10.0, 1.6, 40.0) * EDGE);
    for wall in Wall::closed_box(low, high).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let rubber = NeoHookean::new(1e6, 0.3).unwrap();
    let metal = J2::new(1e6, 0.3, 3e3, 1e5).unwrap();
    let models = [
        cube(1, Element::T4, rubber.into()),
        cube(2, Element::T4, metal.into()),
        cube(1, Element::T10, rubber.into()),
    ];
    for (k, model) in models.into_iter().enumerate() {
        let name = format!("cube {k}");
        world
            .add_model(&name, model, ContactStiffness::default())
            .unwrap();
    }
    for name in ["A10", "P5"] {
        let shape: CatalogueShape = name.parse().unwrap();
        world
            .add_shape(name, &shape.polyhedron(EDGE).unwrap())
            .unwrap();
    }
    world.add_sphere("ball", 0.5 * EDGE).unwrap();
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
        let (i, j) = (place % 6, place / 6);
        let at = Vector3::new(1.3 * i as f64 + 0.9, 0.8, 1.6 * j as f64 + 0.9) * EDGE;
        let turn = UnitQuaternion::from_euler_angles(6.0 * next(), 6.0 * next(), 6.0 * next());
        let pose = Pose::from_parts(Translation3::from(at), turn);
        let kind = k as u32 % 3;
        if k % 2 == 0 {
            let spec = BodySpec::at_rest(kind, 1500.0, pose);
            if k == 4 && !sleeping {
                world.add_driven_body(spec, SHAKE).unwrap();
            } else {
                world.add_body(spec).unwrap();
            }
        } else {
            let spec = DeformableSpec {
                boundary: match k {
                    1 => held(&world, kind, Drive::Fixed),
                    7 if !sleeping => held(&world, kind, SHAKE),
                    _ => Boundary::default(),
                },
                ..DeformableSpec::at_rest(kind, pose)
            };
            world.add_deformable(spec).unwrap();
        }
    }
    world
}

/// Holds or drives one side of a cube.
fn held(world: &World, model: u32, drive: Drive) -> Boundary {
    let side = Selection::Plane {
        normal: Vector3::x(),
        offset: -0.5 * EDGE,
        tolerance: 1e-6,
    };
    let model = world.model(model).unwrap();
    let mut boundary = Boundary::default();
    boundary.drive(model, &side, [true; 3], drive).unwrap();
    boundary
}

/// All bits of what the bodies have in them.
fn state(world: &World) -> Vec<Vec<u64>> {
    let bits = |x: &f64| x.to_bits();
    let of = |id| {
        let body = world.deformable(id).unwrap();
        let stresses = body.stresses().unwrap();
        let vectors = [
            body.positions(),
            body.velocities(),
            body.internal_forces(),
            body.contact_forces(),
        ];
        let numbers = vectors.into_iter().flatten().flatten().map(bits);
        let stresses = stresses.iter().flat_map(|s| s.cauchy.iter().map(bits));
        let numbers = numbers.chain(body.history().iter().map(bits));
        numbers.chain(stresses).collect()
    };
    world.deformable_ids().map(of).collect()
}

#[test]
fn deformable_bodies_have_the_same_bits_on_any_ranks() {
    for sleeping in [false, true] {
        let world = heap(sleeping);
        let mut alone = world.clone();
        let steps = if sleeping { 2400 } else { 700 };
        let (mut slept, mut woke) = (0, 0);
        for _ in 0..steps {
            let before = alone.awake_deformable_count();
            alone.step().unwrap();
            let after = alone.awake_deformable_count();
            slept += usize::from(after < before);
            woke += usize::from(after > before);
        }
        assert_eq!(slept > 0, sleeping, "bodies fell asleep in {slept} steps");
        assert_eq!(woke > 0, sleeping, "bodies woke in {woke} steps");
        let flown = alone.ledger().dissipated_plastic;
        assert!(flown > 0.0, "{flown}");
        let found = state(&alone);
        let mut later = alone.clone();
        for _ in 0..40 {
            later.step().unwrap();
        }
        let sizes: &[usize] = if sleeping { &[1, 2, 3, 4] } else { &[2, 4] };
        let mut moved = 0;
        for &size in sizes {
            let (whole, changed) = as_alone(&alone, &world, size, steps);
            moved += changed;
            assert_eq!(state(&whole), found, "{size} ranks");
            // The whole goes on from a checkpoint.
            let mut read = World::from_bytes(&whole.to_bytes().unwrap()).unwrap();
            for _ in 0..40 {
                read.step().unwrap();
            }
            let [read, later] = [&read, &later].map(|world| world.checksum_of_motion().unwrap());
            assert_eq!(read, later, "{size} ranks");
        }
        assert!(moved > 0, "none has changed its rank");
    }
}

/// A change after 7 steps leads to the same bits 3 steps later, alone and on ranks: `early`, just before the world is shared out, or
/// just after it.
fn agrees(world: &World, early: bool, change: impl Fn(&mut World) + Sync) {
    let run = |world: &mut World, halo: &mut dyn Halo, steps: u32| {
        for _ in 0..steps {
            world.step_on(halo).unwrap();
        }
    };
    let mut begun = world.clone();
    run(&mut begun, &mut Alone, 7);
    let mut alone = begun.clone();
    change(&mut alone);
    run(&mut alone, &mut Alone, 3);
    let expected = alone.checksum_of_motion().unwrap();
    for size in [1, 2] {
        let parts = Threads::each(size, |halo| {
            let mut world = begun.clone();
            if early {
                change(&mut world);
            }
            world.share_out(halo).unwrap();
            if !early {
                change(&mut world);
            }
            run(&mut world, halo, 3);
            world.gather(halo).unwrap()
        });
        let whole = parts.into_iter().next().unwrap().unwrap();
        let found = whole.checksum_of_motion().unwrap();
        assert_eq!(found, expected, "{size} ranks");
        assert_eq!(whole.time_step(), alone.time_step());
    }
}

#[test]
fn a_heap_in_motion_is_shared_from_the_first() {
    let mut world = heap(true);
    for _ in 0..300 {
        world.step().unwrap();
    }
    goes_on_from_the_first(&world, 200);
    goes_on_from_parts(&world, 50);
}

#[test]
fn bodies_of_both_kinds_may_leave_a_heap() {
    let spec = |k: u32| {
        let at = Vector3::new(f64::from(2 * k % 7) + 1.0, 0.8, 3.5 + f64::from(k)) * (1.2 * EDGE);
        let pose = Pose::from_parts(Translation3::from(at), UnitQuaternion::identity());
        BodySpec {
            velocity: Vector3::new(0.0, 0.0, -3.0),
            ..BodySpec::at_rest(k % 3, 1500.0, pose)
        }
    };
    comes_and_goes_alike(&heap(true), [[6, 3], [2, 9]], spec);
}

#[test]
fn the_step_after_a_change_of_the_medium_is_the_same_on_any_ranks() {
    let medium = Medium {
        local_damping: 0.2,
        ..Medium::default()
    };
    agrees(&heap(false), false, |world| {
        world.set_medium(medium).unwrap()
    });
}

#[test]
fn the_step_after_a_thinner_body_has_come_is_the_same_on_any_ranks() {
    let mut world = heap(false);
    let bead = world.add_sphere("bead", 0.1 * EDGE).unwrap();
    agrees(&world, false, |world| {
        let pose = Pose::translation(5.0 * EDGE, 0.8 * EDGE, 20.0 * EDGE);
        world
            .add_body(BodySpec::at_rest(bead, 1500.0, pose))
            .unwrap();
    });
}

#[test]
fn the_step_after_changes_by_hand_is_the_same_if_the_world_is_then_shared_out() {
    let world = heap(false);
    agrees(&world, true, |world| world.remove_body(6).unwrap());
    agrees(&world, true, |world| {
        // Smaller by a fifth: the bound of its elements is another.
        let body = world.deformable(3).unwrap();
        let [x, v] = [body.positions(), body.velocities()].map(<[Vector3]>::to_vec);
        let middle = x.iter().sum::<Vector3>() / x.len() as f64;
        let x: Vec<_> = x.iter().map(|x| middle + 0.8 * (x - middle)).collect();
        world.set_nodes(3, &x, &v).unwrap();
    });
}

#[test]
fn what_one_rank_cannot_do_with_deformable_bodies_is_refused() {
    let mut world = heap(false);
    let cell = PeriodicCell::new([Some(1.0); 3]).unwrap();
    world.share_out(&mut Alone).unwrap();
    let refused = [
        world.solve_single_bodies(1e-3).map(|_| ()),
        world.begin_friction(Partner::Wall(0), 1, Vector3::x(), 0.0),
        world.set_cell(cell),
    ];
    for result in refused {
        let error = result.unwrap_err().to_string();
        assert!(error.contains("gather it first"), "{error}");
    }
}
