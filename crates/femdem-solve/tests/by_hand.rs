//! Bodies and walls that a host removes, puts elsewhere, pushes and loads while the world runs.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, add_heap, add_sides, at, half_edge, parameters, pose, run_until,
    solid, turned, weightless,
};
use femdem_contact::{BodyId, Partner, Wall, Wrench};
use femdem_fem::DeformableModel;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_mesh::{TetMesh, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, ImplicitStep, SolveError, World,
    WorldParameters,
};

fn force(force: Vector3) -> Wrench {
    Wrench {
        force,
        torque: Vector3::zeros(),
    }
}

/// Cubes on each other on a floor, barely touching; sleep is allowed.
fn stack(count: u32) -> (World, Vec<BodyId>) {
    let mut p = parameters(1e7, 0.6, 0.6);
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let place = |k: u32| at(Vector3::z() * (half_edge() * f64::from(2 * k + 1)));
    let ids = (0..count).map(|k| {
        let spec = BodySpec::at_rest(shape, DENSITY, place(k));
        world.add_body(spec).unwrap()
    });
    let ids = ids.collect();
    (world, ids)
}

fn sleep(world: &mut World) {
    let end = world.time() + 5.0;
    while world.awake_count() > 0 {
        world.step().unwrap();
        assert!(world.time() < end, "{} are awake", world.awake_count());
    }
}

/// Everything above falls freely once what carried it is gone, be it a body or the floor.
#[test]
fn what_loses_its_support_falls() {
    for floor in [false, true] {
        let (mut world, ids) = stack(3);
        sleep(&mut world);
        if floor {
            world.remove_wall(0).unwrap();
        } else {
            world.remove_body(ids[1]).unwrap();
            assert!(!world.is_asleep(ids[0]) && !world.has_body(ids[1]));
        }
        let next = ids[if floor { 0 } else { 2 }];
        assert!(!world.is_asleep(next));
        let (start, top) = (world.time(), world.position(next).unwrap().z);
        run_until(&mut world, start + 0.06);
        let time = world.time() - start;
        let fallen = top - world.position(next).unwrap().z;
        assert!(
            (fallen / (0.5 * G * time * time) - 1.0).abs() < 0.02,
            "{fallen}"
        );
        let below = world.position(ids[0]).unwrap().z;
        assert_eq!(below < 0.9 * half_edge(), floor, "{below}");
        // The one above follows, be it with the delay of the active set.
        assert!(world.velocity(ids[2]).unwrap().z < -0.8 * G * time);
    }
}

/// A body that has lost its support just before it would sleep does not sleep in the air.
#[test]
fn what_was_about_to_sleep_falls_too() {
    let (mut world, ids) = stack(2);
    let mut almost = world.clone();
    while world.awake_count() == 2 {
        almost = world.clone();
        world.step().unwrap();
    }
    almost.remove_body(ids[0]).unwrap();
    let end = almost.time() + 0.05;
    run_until(&mut almost, end);
    assert!(almost.velocity(ids[1]).unwrap().z < -0.9 * G * 0.05);
}

#[test]
fn whatever_is_done_to_a_sleeper_wakes_it() {
    let (mut world, ids) = stack(1);
    sleep(&mut world);
    let doings: [&dyn Fn(&mut World); 4] = [
        &|w| {
            w.set_velocity(ids[0], Vector3::x(), Vector3::zeros())
                .unwrap()
        },
        &|w| w.set_pose(ids[0], w.pose(ids[0]).unwrap()).unwrap(),
        &|w| w.set_load(ids[0], force(Vector3::x())).unwrap(),
        &|w| w.remove_wall(0).unwrap(),
    ];
    for (k, doing) in doings.iter().enumerate() {
        let mut world = world.clone();
        doing(&mut world);
        assert_eq!(world.awake(), [ids[0]], "{k}");
        world.step().unwrap();
    }
    world.set_load(ids[0], Wrench::default()).unwrap();
    assert!(world.is_asleep(ids[0]), "nothing has changed");
}

/// A push of a little less than friction bears leaves a sleeping cube where it is; a little more moves it with the rest of
/// the force.
#[test]
fn a_push_beyond_friction_slides() {
    let friction = 0.5;
    for share in [0.97, 1.03] {
        let mut p = parameters(1e8, friction, 0.6);
        p.sleeping.enabled = true;
        p.sleeping.tolerance = 1e-3;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * half_edge()));
        let cube = world.add_body(spec).unwrap();
        sleep(&mut world);
        let start = (world.time(), world.position(cube).unwrap().x);
        let weight = world.mass(cube).unwrap() * G;
        let push = share * friction * weight;
        world.set_load(cube, force(Vector3::x() * push)).unwrap();
        run_until(&mut world, start.0 + 0.25);
        let half = world.position(cube).unwrap().x - start.1;
        run_until(&mut world, start.0 + 0.5);
        let (time, way) = (
            world.time() - start.0,
            world.position(cube).unwrap().x - start.1,
        );
        let slid = 0.5 * (share - 1.0) * friction * G * time * time;
        if share < 1.0 {
            // Its springs give way at first.
            assert!(
                way < 1e-4 * D && (way - half).abs() < 1e-2 * way,
                "{half} {way}"
            );
            assert!(world.body_residual(cube).unwrap() < 0.02);
        } else {
            assert!((way / slid - 1.0).abs() < 0.05, "{way} {slid}");
        }
        let books = world.ledger();
        assert!((books.load_work - push * way).abs() < 1e-3 * push * way.max(1e-4));
        assert!(books.error_relative().abs() < 1e-2, "{books:?}");
    }
}

/// A force and a torque on a free body: its momentum is F t, its angular momentum T t, its energy their work; a lone force
/// moves it by F t^2/(2 m).
#[test]
fn a_load_gives_its_impulse() {
    for implicit in [None, Some(ImplicitStep::default())] {
        let mut p = weightless(1e7, 0.5, 0.5);
        p.time_step.implicit = implicit;
        p.time_step.largest = Some(1e-4);
        let mut world = World::new(p).unwrap();
        let shape = world.add_shape("A1", &solid("A1")).unwrap();
        let spec = BodySpec::at_rest(shape, DENSITY, pose(Vector3::x(), turned(3)));
        let body = world.add_body(spec).unwrap();
        let other = world
            .add_body(BodySpec::at_rest(shape, DENSITY, at(Vector3::y())))
            .unwrap();
        let load = Wrench {
            force: Vector3::new(1.0, -2.0, 3.0),
            torque: Vector3::new(0.02, 0.05, -0.03),
        };
        world.set_load(body, load).unwrap();
        world.set_load(other, force(load.force)).unwrap();
        assert_eq!(world.applied_load(body), Some(load));
        run_until(&mut world, 0.05);
        let (time, mass) = (world.time(), world.mass(body).unwrap());
        let momentum = world.velocity(body).unwrap() * mass;
        assert!((momentum - load.force * time).norm() < 1e-12 * momentum.norm());
        // Of both bodies; the other one has none about its own centre.
        let about = world.position(body).unwrap();
        let arm = world.position(other).unwrap() - about;
        let spin =
            world.angular_momentum(&about) - arm.cross(&(world.velocity(other).unwrap() * mass));
        assert!((spin - load.torque * time).norm() < 1e-11 * spin.norm());
        let way = world.position(other).unwrap() - Vector3::y();
        let free = load.force * (0.5 * time * time / mass);
        let books = world.ledger();
        assert!(books.error().abs() < 1e-11 * books.load_work, "{books:?}");
        assert!((way - free).norm() < 1e-12 * free.norm());
        let work = load.force.dot(&way);
        let mut alone = world.clone();
        alone.remove_body(body).unwrap();
        assert!((alone.ledger().kinetic - work).abs() < 1e-11 * work);
        assert!(alone.ledger().error().abs() < 1e-11 * books.load_work);
    }
}

/// The work of a load against contact and gravity, explicitly and implicitly, is force times way.
#[test]
fn the_work_of_a_load_is_on_the_books() {
    for implicit in [None, Some(ImplicitStep::default())] {
        let (mut world, ids) = stack(1);
        world.set_sleeping(false);
        let mut steps = world.parameters().time_step;
        steps.implicit = implicit;
        world.set_time_step(steps).unwrap();
        run_until(&mut world, 0.1);
        let before = world.position(ids[0]).unwrap();
        let weight = world.mass(ids[0]).unwrap() * G;
        let push = Vector3::new(0.2, 0.0, 1.5) * weight;
        world.set_load(ids[0], force(push)).unwrap();
        run_until(&mut world, 0.3);
        let work = push.dot(&(world.position(ids[0]).unwrap() - before));
        let books = world.ledger();
        assert!(
            work > 0.01 * weight && (books.load_work / work - 1.0).abs() < 1e-3,
            "{work}"
        );
        assert!(books.error_relative().abs() < 5e-3, "{books:?}");
    }
}

/// After removals the contacts are those of a new world with the same bodies.
#[test]
fn what_remains_is_a_world_of_its_own() {
    let mut p = parameters(1e6, 0.0, 0.0);
    p.time_step.largest = Some(1e-5);
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 3.2 * D, Drive::Fixed);
    add_heap(&mut world, 27, 3);
    run_until(&mut world, 0.15);
    for id in [4, 11, 0, 20] {
        world.remove_body(id).unwrap();
    }
    world.remove_wall(3).unwrap();
    let mut fresh = World::new(p).unwrap();
    for (_, wall) in world.walls() {
        fresh.add_wall(wall.clone(), Drive::Fixed).unwrap();
    }
    for shape in world.shapes() {
        fresh.add_shape(&shape.name, &shape.polyhedron).unwrap();
    }
    let ids: Vec<BodyId> = world.body_ids().collect();
    for &id in &ids {
        let spec = BodySpec {
            shape: world.shape_of(id).unwrap(),
            density: DENSITY,
            pose: world.pose(id).unwrap(),
            velocity: world.velocity(id).unwrap(),
            angular_velocity: world.angular_velocity(id).unwrap(),
            material: world.material(id).unwrap(),
        };
        fresh.add_body(spec).unwrap();
    }
    for step in 0..20 {
        world.step().unwrap();
        fresh.step().unwrap();
        assert_eq!(world.time_step(), fresh.time_step());
        let mut seen = 0;
        for (new, &old) in (0..).zip(&ids) {
            let [a, b] = [world.load(old), fresh.load(new)].map(Option::unwrap);
            assert_eq!(a.contacts, b.contacts, "{old} at {step}");
            let off = (a.total.force - b.total.force).norm();
            assert!(
                off < 1e-7 * (a.normal_sum + 1.0),
                "{old} at {step}: {off:e}"
            );
            seen += a.contacts;
        }
        assert!(seen > 20, "{seen}");
    }
}

/// An index of what is gone is refused by name, and is given to what comes next.
#[test]
fn indices_are_refused_until_they_are_given_again() {
    let (mut world, ids) = stack(3);
    world.step().unwrap();
    world.remove_body(ids[0]).unwrap();
    world.remove_body(ids[1]).unwrap();
    let gone = |result: Result<(), SolveError>| {
        let error = result.unwrap_err().to_string();
        assert!(
            error.contains("no body 1") && error.contains("there are 1"),
            "{error}"
        );
    };
    gone(world.remove_body(ids[1]));
    gone(world.set_pose(ids[1], at(Vector3::z())));
    gone(world.set_velocity(ids[1], Vector3::x(), Vector3::x()));
    gone(world.set_load(ids[1], Wrench::default()));
    gone(world.drive_body(ids[1], None));
    assert!(world.position(ids[1]).is_none() && world.load(ids[1]).is_none());
    assert!(world.bounds(ids[1]).is_none() && !world.is_asleep(ids[1]));
    assert_eq!(world.body_ids().collect::<Vec<_>>(), [2]);
    assert_eq!((world.body_count(), world.awake().len()), (1, 1));
    let spec = BodySpec::at_rest(0, DENSITY, at(Vector3::x()));
    assert_eq!([0, 1, 3], [0; 3].map(|_| world.add_body(spec).unwrap()));
    world.remove_wall(0).unwrap();
    assert!(world.remove_wall(0).is_err() && world.drive_wall(0, Drive::Fixed).is_err());
    assert!(world.wall_pose(0).is_none() && world.wall_load(0).is_none());
    assert_eq!(add_floor(&mut world, Drive::Fixed), 0);
    world.step().unwrap();
    let bad = world.set_velocity(2, Vector3::repeat(f64::NAN), Vector3::x());
    assert!(bad.unwrap_err().to_string().contains("velocity"));
    world.drive_body(2, Some(Drive::Fixed)).unwrap();
    let bad = world.set_velocity(2, Vector3::x(), Vector3::x());
    assert!(matches!(bad, Err(SolveError::Driven { body: 2 })));
}

/// A needle so thin that it is accepted as a convex body, but has no tetrahedra.
#[test]
fn a_refused_shape_leaves_nothing_behind() {
    let mut world = World::new(WorldParameters::default()).unwrap();
    add_soft(&mut world, Vector3::zeros());
    let thin = 2.2e-6;
    let block = TetMesh::block([1, 1, 1], &Vector3::new(2.0, thin, thin)).unwrap();
    let needle = block.surface().unwrap().with_merged_faces();
    assert!(
        World::new(WorldParameters::default())
            .unwrap()
            .add_shape("needle", &needle)
            .is_ok()
    );
    assert!(world.add_shape("needle", &needle).is_err());
    assert!(world.shapes().is_empty());
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z()));
    let body = world.add_body(spec).unwrap();
    assert_eq!(
        world.shape(world.shape_of(body).unwrap()).unwrap().name,
        "P5"
    );
    world.step().unwrap();
}

fn add_soft(world: &mut World, corner: Vector3) -> u32 {
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(D)).unwrap();
    let region = femdem_fem::MaterialRegion {
        material: NeoHookean::new(1e7, 0.3).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let model = world
        .add_model("cube", model, ContactStiffness::default())
        .unwrap();
    let spec = DeformableSpec::at_rest(model, at(corner));
    world.add_deformable(spec).unwrap()
}

/// Deformable cubes on each other with a rigid one on top: what is above a removed one falls, at the right rate, and what was
/// removed, stretched or thrown is on the books.
#[test]
fn deformable_bodies_come_and_go() {
    let mut p = parameters(1e7, 0.5, 0.5);
    p.time_step.safety = 0.4;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let ids = [0.0, 1.0, 2.0].map(|k| add_soft(&mut world, Vector3::z() * (k * D)));
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let top = Vector3::new(0.5 * D, 0.5 * D, 3.0 * D + half_edge());
    let rigid = world
        .add_body(BodySpec::at_rest(shape, DENSITY, at(top)))
        .unwrap();
    run_until(&mut world, 0.05);
    let error = |world: &World| world.ledger().error();
    let scale = world.ledger().elastic + world.ledger().strain;
    let before = error(&world);
    world.remove_body(ids[1]).unwrap();
    assert!((error(&world) - before).abs() < 1e-9 * scale);
    assert!(world.remove_body(ids[1]).is_err() && world.deformable(ids[1]).is_none());
    assert_eq!(world.deformable_ids().collect::<Vec<_>>(), [ids[0], ids[2]]);
    // Of the two above.
    let momentum = |world: &World| {
        let soft = world.deformable(ids[2]).unwrap().momentum();
        soft.z + world.velocity(rigid).unwrap().z * world.mass(rigid).unwrap()
    };
    let (start, from) = (world.time(), momentum(&world));
    let fresh = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    run_until(&mut world, start + 0.05);
    let mass = DENSITY * D.powi(3) + world.mass(rigid).unwrap();
    let lost = (from - momentum(&world)) / (mass * G * (world.time() - start));
    assert!((lost - 1.0).abs() < 1e-9, "{lost}");
    let mut again = fresh;
    run_until(&mut again, start + 0.05);
    assert_eq!(again.state_hash().unwrap(), world.state_hash().unwrap());

    // Stretched, thrown and put aside.
    let body = world.deformable(ids[2]).unwrap();
    let stretched = |x: &Vector3| Vector3::new(1.02 * x.x + 5.0 * D, x.y, x.z);
    let places: Vec<Vector3> = body
        .model()
        .nodes()
        .iter()
        .map(|x| stretched(x) + Vector3::z() * D)
        .collect();
    let speeds = vec![Vector3::y() * 0.5; places.len()];
    let before = error(&world);
    world.set_nodes(ids[2], &places, &speeds).unwrap();
    assert!((error(&world) - before).abs() < 1e-9 * scale);
    let body = world.deformable(ids[2]).unwrap();
    // For this law at a stretch of 2 % the energy is close to E e^2/2 times the volume, with the sides held.
    let strain = body.internal().energy;
    let held = 1e7 * 0.7 / (1.3 * 0.4);
    let expected = 0.5 * held * 4e-4 * D.powi(3);
    assert!(
        (strain / expected - 1.0).abs() < 0.05,
        "{strain} {expected}"
    );
    let [short, inverted] = [&places[1..], &vec![Vector3::zeros(); places.len()][..]];
    assert!(world.set_nodes(ids[2], short, &speeds).is_err());
    assert!(world.set_nodes(ids[2], inverted, &speeds).is_err());
    assert_eq!(world.deformable(ids[2]).unwrap().positions(), places);

    assert_eq!(add_soft(&mut world, Vector3::x() * (-5.0 * D)), ids[1]);
    let end = world.time() + 0.02;
    run_until(&mut world, end);
    let books = world.ledger();
    assert!(books.error_relative().abs() < 1e-2, "{books:?}");
}

/// Stability is measured of the rigid bodies that are there: numbers that were removed or that are deformable have no part in it.
#[test]
fn the_stability_of_what_remains() {
    let (mut world, ids) = stack(3);
    run_until(&mut world, 0.02);
    world.remove_body(ids[2]).unwrap();
    world.step().unwrap();
    let frequency = |world: &World| world.stability().unwrap().unwrap().frequency;
    let alone = frequency(&world);
    assert!(alone.is_finite() && alone > 0.0, "{alone}");
    let soft = add_soft(&mut world, Vector3::new(0.0, 0.0, 50.0 * D));
    assert_eq!(soft, ids[2]);
    let beside = frequency(&world);
    assert!((beside / alone - 1.0).abs() < 0.05, "{beside} {alone}");
}

/// A number is one body's, whatever the body is: what is asked of all bodies is answered for both kinds, and the lowest free
/// number goes to what comes next.
#[test]
fn rigid_and_deformable_bodies_are_numbered_together() {
    let mut world = World::new(weightless(1e7, 0.5, 0.5)).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let rigid = |x: f64| BodySpec::at_rest(shape, DENSITY, at(Vector3::x() * x));
    assert_eq!(world.add_body(rigid(0.0)).unwrap(), 0);
    let soft = add_soft(&mut world, Vector3::y() * D);
    assert_eq!((soft, world.add_body(rigid(1.0)).unwrap()), (1, 2));
    assert_eq!(world.body_ids().collect::<Vec<_>>(), [0, 1, 2]);
    assert_eq!(world.rigid_ids().collect::<Vec<_>>(), [0, 2]);
    assert_eq!(world.deformable_ids().collect::<Vec<_>>(), [1]);
    // A cube of side D, whose nodes move at 3 m/s.
    let nodes = world.deformable(soft).unwrap().positions().to_vec();
    let velocities = vec![Vector3::z() * 3.0; nodes.len()];
    world.set_nodes(soft, &nodes, &velocities).unwrap();
    let mass = world.mass(soft).unwrap();
    let centre = Vector3::new(0.5, 1.5, 0.5) * D;
    assert!((world.position(soft).unwrap() - centre).norm() < 1e-12);
    assert!((world.velocity(soft).unwrap() - Vector3::z() * 3.0).norm() < 1e-12);
    let kinetic = world.body_kinetic_energy(soft).unwrap();
    assert!((kinetic / (4.5 * mass) - 1.0).abs() < 1e-12);
    // What only rigid bodies have is refused by name.
    let refused = world.set_pose(soft, at(Vector3::z())).unwrap_err();
    assert!(refused.to_string().contains("no rigid body 1"), "{refused}");
    assert!(world.pose(soft).is_none() && world.set_nodes(0, &[], &[]).is_err());
    // A rigid body takes the number of a deformable one, and the other way round.
    world.step().unwrap();
    world.remove_body(soft).unwrap();
    assert!(world.mass(soft).is_none() && world.deformable_count() == 0);
    assert_eq!(world.add_body(rigid(2.0)).unwrap(), 1);
    world.remove_body(0).unwrap();
    assert_eq!(add_soft(&mut world, Vector3::z() * D), 0);
    world.step().unwrap();
    let mut again = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    for world in [&mut world, &mut again] {
        run_until(world, 2e-3);
    }
    assert_eq!(world.state_hash().unwrap(), again.state_hash().unwrap());
}

/// A force on a deformable body accelerates it as a whole, without straining it.
#[test]
fn a_force_on_a_deformable_body_accelerates_it() {
    let mut world = World::new(weightless(1e7, 0.5, 0.5)).unwrap();
    let body = add_soft(&mut world, Vector3::zeros());
    let load = Vector3::new(1.0, 2.0, -3.0);
    world.set_load(body, force(load)).unwrap();
    let turned = Wrench {
        force: load,
        torque: load,
    };
    let refused = world.set_load(body, turned).unwrap_err().to_string();
    assert!(refused.contains("torque"), "{refused}");
    run_until(&mut world, 0.02);
    let found = world.deformable(body).unwrap();
    assert!((found.applied_load() - load).norm() < 1e-12);
    let momentum = load * world.time();
    assert!((found.momentum() - momentum).norm() < 1e-11 * momentum.norm());
    let books = world.ledger();
    assert!(books.strain < 1e-12 * books.kinetic);
    assert!(
        (books.load_work / books.kinetic - 1.0).abs() < 1e-11,
        "{books:?}"
    );
}

/// A body put into another by hand, in a world of implicit and of explicit steps: the overlap is on the books.
#[test]
fn an_overlap_made_by_hand_is_on_the_books() {
    for implicit in [None, Some(ImplicitStep::default())] {
        let (mut world, ids) = stack(2);
        world.set_sleeping(false);
        let mut steps = world.parameters().time_step;
        steps.implicit = implicit;
        steps.largest = Some(1e-5);
        world.set_time_step(steps).unwrap();
        for _ in 0..20 {
            world.step().unwrap();
        }
        let before = world.ledger();
        let deep = at(Vector3::z() * (2.98 * half_edge()));
        world.set_pose(ids[1], deep).unwrap();
        world.step().unwrap();
        let after = world.ledger();
        let brought = after.by_hand - before.by_hand;
        // U = p A x^2/h per face in a contact of two.
        let depth = 0.02 * half_edge();
        let area = 4.0 * half_edge() * half_edge();
        let energy = 1e7 * area * depth * depth / half_edge();
        assert!((brought / energy - 1.0).abs() < 0.05, "{brought} {energy}");
        assert!(
            (after.error() - before.error()).abs() < 0.02 * energy,
            "{after:?}"
        );
        let walls = |p: &Partner| matches!(p, Partner::Wall(_));
        assert!(world.contacts().iter().any(|c| walls(&c.a)));
        let side = Wall::half_space("side", Vector3::x(), -half_edge()).unwrap();
        world.add_wall(side, Drive::Fixed).unwrap();
        world.step().unwrap();
    }
}
