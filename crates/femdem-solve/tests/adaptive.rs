//! Bodies that are rigid far from their strength and deformable near it.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::{BodyId, Contact, ContactParameters, Field, Partner, Wall, WallResponse};
use femdem_fem::element::Element;
use femdem_fem::fracture::Strength;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use femdem_solve::{
    Adaptive, BodySpec, ContactStiffness, DeformableSpec, Drive, Fidelity, FidelityChange,
    Fracture, SleepParameters, SolveError, TimeStepParameters, World, WorldParameters,
};

const YOUNG: f64 = 20e9;
const DENSITY: f64 = 2500.0;
/// Side of the cube, m, and cells along it.
const SIDE: f64 = 0.01;
const CELLS: u32 = 3;
/// Pa: a foundation of E/(10 h) over half the side, with which contacts give way more than the body.
const PENALTY: f64 = YOUNG * CELLS as f64 / 20.0;

/// f = 5 MPa, c = 20 MPa, tan φ = 0.8.
fn rock() -> Fracture {
    let strength = Strength::new(5e6, 20e6, 0.8_f64.atan()).unwrap();
    Fracture::new(strength, [40.0, 200.0])
}

/// A cube about the origin, its inner points moved by up to a fifth of an edge.
fn cube() -> TetMesh {
    let block = TetMesh::block([CELLS; 3], &Vector3::repeat(SIDE)).unwrap();
    let edge = SIDE / f64::from(CELLS);
    let noise = |i: usize, k: f64| (12.9898 * i as f64 + 78.233 * k).sin();
    let moved = |(i, p): (usize, &Point3)| {
        let is_inside = |x: f64| x > 1e-9 && x < SIDE - 1e-9;
        let inside = p.iter().all(|x| is_inside(*x));
        let by = if inside { 0.2 * edge } else { 0.0 };
        Point3::from(Vector3::from_fn(|k, _| {
            p[k] - 0.5 * SIDE + by * noise(i, k as f64)
        }))
    };
    let points = block.points().iter().enumerate().map(moved).collect();
    TetMesh::new(points, block.tets().to_vec()).unwrap()
}

fn model() -> DeformableModel {
    let region = MaterialRegion {
        material: NeoHookean::new(YOUNG, 0.2).unwrap().into(),
        density: DENSITY,
    };
    DeformableModel::new(&cube(), Element::T4, vec![region], None).unwrap()
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Rigid,
    Adaptive,
    Breakable,
}

fn world(friction: f64) -> World {
    World::new(WorldParameters {
        gravity: Vector3::zeros(),
        contact: ContactParameters {
            penalty: PENALTY,
            friction,
            wall_response: WallResponse::Rigid,
            ..ContactParameters::default()
        },
        sleeping: SleepParameters {
            enabled: false,
            ..SleepParameters::default()
        },
        time_step: TimeStepParameters {
            safety: 0.5,
            ..TimeStepParameters::default()
        },
        ..WorldParameters::default()
    })
    .unwrap()
}

/// Adds a cube of a kind; those of a world have the same shape and model.
fn add(world: &mut World, kind: Kind, pose: Pose) -> BodyId {
    if kind == Kind::Breakable {
        let shape = femdem_contact::deform::DeformableShape::with_field(&cube(), &[], Field::Body);
        let shape = shape.unwrap();
        let ratio = PENALTY / shape.inradius() * shape.edge() / YOUNG;
        let stiffness = ContactStiffness::Ratio(ratio);
        let model = world.add_model("cube", model(), stiffness).unwrap();
        return world
            .add_deformable(DeformableSpec {
                fracture: Some(rock()),
                ..DeformableSpec::at_rest(model, pose)
            })
            .unwrap();
    }
    if world.shapes().is_empty() {
        let mesh = cube();
        let surface = mesh.surface().unwrap();
        world
            .add_mesh_shape("cube", &surface, &mesh, Field::Body)
            .unwrap();
    }
    if kind == Kind::Adaptive && world.model(0).is_none() {
        world
            .add_model("cube", model(), ContactStiffness::Law)
            .unwrap();
    }
    let id = world.add_body(BodySpec::at_rest(0, DENSITY, pose)).unwrap();
    if kind == Kind::Adaptive {
        let adaptive = Adaptive {
            model: 0,
            fracture: rock(),
        };
        world.set_adaptive(id, adaptive).unwrap();
    }
    id
}

fn pressing(speed: f64, end: f64) -> Drive {
    Drive::Linear {
        velocity: Vector3::z() * -speed,
        start: 0.0,
        end,
    }
}

/// A cube between a floor and a platen that comes down at `speed` (m/s) until `end` (s).
fn pressed(kind: Kind, speed: f64, end: f64) -> World {
    pressed_in(world(0.0), kind, speed, end)
}

fn pressed_in(mut world: World, kind: Kind, speed: f64, end: f64) -> World {
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let platen = Wall::half_space("platen", -Vector3::z(), -SIDE).unwrap();
    world.add_wall(platen, pressing(speed, end)).unwrap();
    add(&mut world, kind, Pose::translation(0.0, 0.0, 0.5 * SIDE));
    world
}

/// Force on the platen, N.
fn force(world: &World) -> f64 {
    world.wall_load(1).unwrap().total.force.z
}

fn is_cracked(world: &World) -> bool {
    let body = world.deformable(0);
    let cracks = body.and_then(|body| body.cracks());
    cracks.is_some_and(|cracks| cracks.mesh().is_some())
}

/// Steps until the body has changed; returns how.
fn until_changed(world: &mut World, most: u32) -> FidelityChange {
    for _ in 0..most {
        world.step().unwrap();
        if let Some(change) = world.take_fidelity_changes().first() {
            return *change;
        }
    }
    panic!("nothing has changed by {} s", world.time());
}

/// Steps until bodies have changed; returns what the world was before that step, and how they changed.
fn around_change(world: &mut World, most: u32) -> (World, Vec<FidelityChange>) {
    for _ in 0..most {
        let before = world.clone();
        world.step().unwrap();
        let changes = world.take_fidelity_changes();
        if !changes.is_empty() {
            return (before, changes);
        }
    }
    panic!("nothing has changed by {} s", world.time());
}

fn slow_down(world: &mut World, drag: f64) {
    let medium = femdem_solve::Medium {
        drag,
        ..Default::default()
    };
    world.set_medium(medium).unwrap();
}

fn angular_momentum(world: &World) -> Vector3 {
    world.angular_momentum(&Vector3::zeros())
}

#[test]
fn far_from_its_strength_a_body_has_the_bits_of_a_rigid_one() {
    // At half a step of the load at which it would become deformable the platen stops.
    let [mut rigid, mut adaptive] = [Kind::Rigid, Kind::Adaptive].map(|k| pressed(k, 0.1, 2e-4));
    for world in [&mut rigid, &mut adaptive] {
        while world.time() < 6e-4 {
            world.step().unwrap();
        }
    }
    assert!(force(&rigid) > 500.0, "{}", force(&rigid));
    assert_eq!(adaptive.take_fidelity_changes(), []);
    assert_eq!(force(&adaptive).to_bits(), force(&rigid).to_bits());
    assert_eq!(adaptive.pose(0), rigid.pose(0));
    assert_eq!(adaptive.steps(), rigid.steps());
    assert_eq!(adaptive.ledger(), rigid.ledger());
}

/// Uniaxial compression without friction: F = UCS A, UCS = 2 c cos φ/(1 − sin φ).
#[test]
fn a_pressed_body_becomes_deformable_and_breaks_where_a_breakable_one_does() {
    let mut loads = Vec::new();
    for kind in [Kind::Breakable, Kind::Adaptive] {
        let mut world = pressed(kind, 0.1, 1.0);
        if kind == Kind::Adaptive {
            let change = until_changed(&mut world, 20_000);
            assert_eq!(change.to, Fidelity::Deformable);
            assert!((0.7..0.75).contains(&change.ratio), "{change:?}");
            assert!(!is_cracked(&world));
            // Its strain energy, F²L/(2 E A) under uniform stress.
            let stored = force(&world).powi(2) / (2.0 * YOUNG * SIDE);
            assert!(
                (change.energy / stored - 1.0).abs() < 0.1,
                "{change:?} {stored}"
            );
            assert!((world.ledger().fidelity - change.energy).abs() < 1e-12 * stored);
        }
        let before = world.ledger().error_relative();
        while !is_cracked(&world) {
            world.step().unwrap();
            assert!(world.time() < 1e-2);
        }
        loads.push(force(&world));
        let error = world.ledger().error_relative();
        assert!(error.abs() < 1e-4, "{before} {error}");
    }
    let ucs = rock().strength.compressive() * SIDE * SIDE;
    assert!((loads[0] / ucs - 1.0).abs() < 0.05, "{loads:?} {ucs}");
    assert!((loads[1] / loads[0] - 1.0).abs() < 0.02, "{loads:?} {ucs}");
}

#[test]
fn a_body_that_has_cracked_stays_breakable_and_so_do_its_fragments() {
    let mut world = pressed(Kind::Adaptive, 2.0, 1.0);
    while !is_cracked(&world) {
        world.step().unwrap();
        assert!(world.time() < 1e-3);
    }
    assert!(!world.is_adaptive(0));
    assert_eq!(world.adaptive_bodies().count(), 0);
    assert_eq!(world.take_fidelity_changes().len(), 1);
    while world.deformable_count() < 2 {
        world.step().unwrap();
        world.fragment_bodies().unwrap();
        assert!(world.time() < 2e-3);
    }
    let count = world.deformable_count();
    world.drive_wall(1, pressing(-1.0, 1.0)).unwrap();
    slow_down(&mut world, 2e4);
    for _ in 0..2000 {
        world.step().unwrap();
    }
    assert_eq!(world.take_fidelity_changes(), []);
    assert_eq!(world.deformable_count(), count);
}

/// A larger rigid body presses it, whose field is twice as deep.
#[test]
fn no_contact_force_jumps_when_a_body_cracks_under_one_of_another_size() {
    let mut world = world(0.0);
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let small = add(
        &mut world,
        Kind::Adaptive,
        Pose::translation(0.0, 0.0, 0.5 * SIDE),
    );
    let points = cube().points().iter().map(|x| x * 2.0).collect();
    let large = TetMesh::new(points, cube().tets().to_vec()).unwrap();
    let shape = world
        .add_mesh_shape("large", &large.surface().unwrap(), &large, Field::Body)
        .unwrap();
    let pose = Pose::translation(0.0, 0.0, 2.0 * SIDE);
    let large = world
        .add_body(BodySpec::at_rest(shape, DENSITY, pose))
        .unwrap();
    world.drive_body(large, Some(pressing(0.2, 1.0))).unwrap();
    let pressed = |world: &World| {
        let of_large = |contact: &Contact| contact.has_side(Partner::Body(large));
        let contacts = world.contacts();
        let own = contacts.iter().filter(|contact| of_large(contact));
        own.map(|contact| contact.force_on_b())
            .sum::<Vector3>()
            .norm()
    };
    let change = until_changed(&mut world, 40_000);
    assert_eq!((change.body, change.to), (small, Fidelity::Deformable));
    let mut before = pressed(&world);
    while world.is_adaptive(small) {
        before = pressed(&world);
        world.step().unwrap();
        assert!(world.time() < 1e-2);
    }
    let after = pressed(&world);
    assert!(before > 1e3, "{before}");
    assert!((after / before - 1.0).abs() < 0.01, "{before} {after}");
}

fn assert_kept(before: &World, after: &World, [momentum, turning]: [f64; 2]) {
    let moved = (after.linear_momentum() - before.linear_momentum()).norm();
    let turned = (angular_momentum(after) - angular_momentum(before)).norm();
    let [moved, turned] = [moved / momentum, turned / turning];
    assert!(moved < 1e-12 && turned < 1e-10, "{moved:e} {turned:e}");
}

/// Two cubes meet off their centres, and become deformable.
#[test]
fn momentum_stays_when_bodies_become_deformable() {
    let mut world = world(0.4);
    let place = |z: f64, y: f64| Pose::new(Vector3::new(0.0, y, z), Vector3::new(0.0, 0.0, 0.2));
    let a = add(&mut world, Kind::Adaptive, place(0.0, 0.0));
    let b = add(&mut world, Kind::Adaptive, place(1.0001 * SIDE, 0.2 * SIDE));
    let away = Vector3::new(0.1, 0.0, 17.0);
    world
        .set_velocity(a, away, Vector3::new(0.0, 20.0, 30.0))
        .unwrap();
    world.set_velocity(b, -away, Vector3::zeros()).unwrap();
    let momentum = DENSITY * SIDE.powi(3) * 17.0;
    let scale = [momentum, momentum * SIDE];
    let start = world.clone();
    while world.deformable_count() < 2 {
        let (before, _) = around_change(&mut world, 500);
        assert_kept(&before, &world, scale);
    }
    for _ in 0..50 {
        world.step().unwrap();
    }
    assert_kept(&start, &world, scale);
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 1e-3, "{ledger:?}");
    assert!(ledger.fidelity > 0.0);
}

/// A cube that was pressed and has come to rest flies and spins, free of contacts.
#[test]
fn momentum_stays_when_a_body_becomes_rigid() {
    let mut world = pressed(Kind::Adaptive, 0.1, 1.0);
    until_changed(&mut world, 20_000);
    let refused = world.set_self_contact(0, false);
    assert!(
        matches!(refused, Err(SolveError::CannotAdapt { .. })),
        "{refused:?}"
    );
    world.drive_wall(1, pressing(-0.3, 1.0)).unwrap();
    while !world.contacts().is_empty() {
        world.step().unwrap();
        assert!(world.time() < 1e-2);
    }
    // It is rigid after 100 steps of rest within itself.
    slow_down(&mut world, 4e5);
    let mut quiet = 0;
    while quiet < 50 {
        world.step().unwrap();
        let kinetic = world.deformable(0).unwrap().kinetic_energy();
        quiet = if kinetic < 3e-10 { quiet + 1 } else { 0 };
        assert!(world.time() < 1e-2);
    }
    slow_down(&mut world, 0.0);
    let spin = Vector3::new(5.0, -3.0, 8.0);
    let body = world.deformable(0).unwrap();
    let positions = body.positions().to_vec();
    let from = body.centroid();
    let velocity = |x: &Vector3| Vector3::new(0.3, 0.1, 1.0) + spin.cross(&(x - from));
    let velocities: Vec<Vector3> = positions.iter().map(velocity).collect();
    world.set_nodes(0, &positions, &velocities).unwrap();
    let (before, changes) = around_change(&mut world, 500);
    assert_eq!(changes[0].to, Fidelity::Rigid);
    assert_eq!(world.contacts().len(), 0);
    let scale = [before.linear_momentum(), angular_momentum(&before)];
    assert_kept(&before, &world, scale.map(|of| of.norm()));
    // Masses at the nodes of a block of n cells along each side turn 1 + 2/n² times as hard as the solid.
    let faster = world.angular_velocity(0).unwrap() - spin * (1.0 + 2.0 / f64::from(CELLS * CELLS));
    assert!(faster.norm() < 0.03 * spin.norm(), "{faster:?}");
}

/// Pressed under friction to where it is deformable, and held at a tenth of that by a platen that has turned about an axis
/// beside it: both changes leave forces, friction and torsion as they are, and exchange the energy of its strain.
#[test]
fn forces_stay_when_a_body_changes_under_friction() {
    let mut world = pressed_in(world(0.1), Kind::Adaptive, 0.1, 1.0);
    let (before, changes) = around_change(&mut world, 20_000);
    assert_eq!(changes[0].to, Fidelity::Deformable);
    let most = force(&before);
    let jump = (force(&world) - most).abs() / most;
    assert!(jump < 0.02, "{jump}");
    world.drive_wall(1, pressing(-0.1, 1.0)).unwrap();
    slow_down(&mut world, 2e4);
    while force(&world) > 0.1 * most {
        world.step().unwrap();
        assert!(world.time() < 1e-2);
    }
    let start = world.time();
    let turn = Drive::Turn {
        axis: Vector3::z(),
        point: Vector3::y() * SIDE,
        rate: 4.0,
        start,
        end: start + 5e-5,
    };
    world.drive_wall(1, turn).unwrap();
    let (before, changes) = around_change(&mut world, 20_000);
    let change = changes[0];
    assert_eq!(change.to, Fidelity::Rigid);
    assert!(before.time() > start + 5e-5, "{}", before.time());
    let load = |world: &World| world.wall_load(1).unwrap().total;
    let [old, new] = [load(&before), load(&world)];
    let across = |load: femdem_contact::Wrench| load.force.xy();
    assert!(
        across(old).norm() > 10.0 && old.torque.z.abs() > 1e-2,
        "{old:?}"
    );
    assert!(
        (new.force.z / old.force.z - 1.0).abs() < 0.02,
        "{old:?} {new:?}"
    );
    assert!(
        (across(new) - across(old)).norm() < 0.02 * across(old).norm(),
        "{old:?} {new:?}"
    );
    assert!(
        (new.torque.z / old.torque.z - 1.0).abs() < 0.02,
        "{old:?} {new:?}"
    );
    let strain = before.deformable(0).unwrap().internal().energy;
    assert!(
        (change.energy / strain + 1.0).abs() < 0.1,
        "{change:?} {strain}"
    );
}

/// Three cubes of one model under one platen: each becomes deformable at 0.7 of its own strength, its weakest node's.
#[test]
fn each_body_has_its_own_strength() {
    let mut world = pressed(Kind::Adaptive, 0.1, 1.0);
    let scatter = femdem_fem::fracture::Weibull::new(4.0, SIDE.powi(3), 1).unwrap();
    let fracture = Fracture {
        scatter: Some(scatter),
        ..rock()
    };
    for id in 0..3 {
        if id > 0 {
            let pose = Pose::translation(2.0 * SIDE * f64::from(id), 0.0, 0.5 * SIDE);
            assert_eq!(add(&mut world, Kind::Adaptive, pose), id);
        }
        world
            .set_adaptive(id, Adaptive { model: 0, fracture })
            .unwrap();
    }
    let mut seen = Vec::new();
    while seen.len() < 3 {
        let (before, changes) = around_change(&mut world, 40_000);
        let contacts = before.contacts();
        for change in changes {
            let thing = Partner::Body(change.body);
            let own = contacts.iter().filter(|c| c.has_side(thing));
            let both: f64 = own.map(|c| c.normal_force).sum();
            let factors = scatter.factors(u64::from(change.body), &cube());
            let weakest = factors.into_iter().fold(f64::INFINITY, f64::min);
            let stress = 0.5 * both / (SIDE * SIDE);
            let used = stress / (weakest * rock().strength.compressive());
            assert!((0.7..0.77).contains(&change.ratio), "{change:?}");
            assert!(
                (used / change.ratio - 1.0).abs() < 0.1,
                "{change:?} {used} {weakest}"
            );
            seen.push(weakest);
        }
    }
    seen.sort_by(f64::total_cmp);
    assert!(seen[2] > 1.25 * seen[0], "{seen:?}");
}

#[test]
fn a_body_that_sleeps_is_left_alone_until_it_is_pressed() {
    let parameters = WorldParameters {
        gravity: Vector3::z() * -9.81,
        sleeping: SleepParameters::default(),
        ..*world(0.4).parameters()
    };
    let mut world = pressed_in(World::new(parameters).unwrap(), Kind::Adaptive, 0.0, 1.0);
    world
        .set_pose(0, Pose::translation(0.0, 0.0, 0.4999 * SIDE))
        .unwrap();
    slow_down(&mut world, 1e4);
    for _ in 0..20_000 {
        world.step().unwrap();
        if world.is_asleep(0) {
            break;
        }
    }
    assert!(world.is_asleep(0));
    assert_eq!(world.take_fidelity_changes(), []);
    slow_down(&mut world, 0.0);
    world.drive_wall(1, pressing(0.1, 1.0)).unwrap();
    let change = until_changed(&mut world, 40_000);
    assert_eq!(change.to, Fidelity::Deformable);
    assert!((0.7..0.75).contains(&change.ratio), "{change:?}");
}

/// Pressed to where it is deformable, then set free, and pressed again.
fn pressed_twice() -> World {
    let mut world = pressed(Kind::Adaptive, 0.1, 1.0);
    let change = until_changed(&mut world, 20_000);
    assert_eq!(change.to, Fidelity::Deformable);
    world.drive_wall(1, pressing(-0.1, 1.0)).unwrap();
    slow_down(&mut world, 2e4);
    world
}

#[test]
fn a_body_that_is_set_free_becomes_rigid_again_and_deformable_under_load() {
    let mut world = pressed_twice();
    let first = world.deformable(0).unwrap().model_id();
    let change = until_changed(&mut world, 60_000);
    assert_eq!(change.to, Fidelity::Rigid);
    assert!(change.ratio < 0.3, "{change:?}");
    assert_eq!((world.deformable_count(), world.rigid_count()), (0, 1));
    let mass = DENSITY * SIDE.powi(3);
    assert!((world.mass(0).unwrap() / mass - 1.0).abs() < 1e-12);
    assert!(
        world.ledger().error_relative().abs() < 1e-3,
        "{:?}",
        world.ledger()
    );
    world.drive_wall(1, pressing(0.1, 1.0)).unwrap();
    let again = until_changed(&mut world, 60_000);
    assert_eq!(again.to, Fidelity::Deformable);
    assert_eq!(world.deformable(0).unwrap().model_id(), first);
    assert!(
        world.ledger().error_relative().abs() < 1e-3,
        "{:?}",
        world.ledger()
    );
}

#[test]
fn same_bits_through_a_checkpoint_and_with_threads() {
    let run = |threads: usize, save: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let mut world = pressed(Kind::Adaptive, 0.1, 1.0);
            let (mut changes, mut steps) = (0, 0_u32);
            while changes < 2 {
                world.step().unwrap();
                steps += 1;
                let seen = world.take_fidelity_changes().len();
                changes += seen;
                if seen > 0 && changes == 1 {
                    world.drive_wall(1, pressing(-0.1, 1.0)).unwrap();
                    slow_down(&mut world, 2e4);
                }
                if save && (steps.is_multiple_of(777) || seen > 0) {
                    world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
                }
                assert!(world.time() < 1e-2);
            }
            for _ in 0..100 {
                world.step().unwrap();
            }
            (steps, world.state_hash().unwrap())
        })
    };
    let plain = run(1, false);
    assert_eq!(run(3, false), plain);
    assert_eq!(run(2, true), plain);
}

#[test]
fn what_cannot_change_is_refused_by_name() {
    let mut world = world(0.3);
    let id = add(&mut world, Kind::Adaptive, Pose::identity());
    let adaptive = Adaptive {
        model: 0,
        fracture: rock(),
    };
    let refused = |result: Result<(), SolveError>, word: &str| {
        let text = result.unwrap_err().to_string();
        assert!(text.contains(word), "{text}");
    };
    let unknown = Adaptive {
        model: 7,
        ..adaptive
    };
    refused(world.set_adaptive(id, unknown), "model 7");
    let ball = world.add_sphere("ball", 0.01).unwrap();
    let pose = Pose::translation(1.0, 0.0, 0.0);
    let ball = world
        .add_body(BodySpec::at_rest(ball, DENSITY, pose))
        .unwrap();
    refused(world.set_adaptive(ball, adaptive), "another shape");
    let heavy = BodySpec::at_rest(0, 2.0 * DENSITY, Pose::translation(2.0, 0.0, 0.0));
    let heavy = world.add_body(heavy).unwrap();
    refused(world.set_adaptive(heavy, adaptive), "another mass");
    let mut contact = world.parameters().contact;
    contact.wall_response = WallResponse::Mirror;
    refused(world.set_contact(contact), "mirror");
    refused(
        world.drive_body(id, Some(Drive::Fixed)),
        "prescribed motion",
    );
    let torque = femdem_contact::Wrench {
        force: Vector3::zeros(),
        torque: Vector3::x(),
    };
    refused(world.set_load(id, torque), "torque");
    let turned = BodySpec::at_rest(0, DENSITY, Pose::translation(3.0, 0.0, 0.0));
    let turned = world.add_body(turned).unwrap();
    world.set_load(turned, torque).unwrap();
    refused(world.set_adaptive(turned, adaptive), "torque");
    world
        .set_load(turned, femdem_contact::Wrench::default())
        .unwrap();
    let weaker = Adaptive {
        fracture: Fracture::new(Strength::new(4e6, 16e6, 0.6).unwrap(), [40.0, 200.0]),
        ..adaptive
    };
    refused(world.set_adaptive(turned, weaker), "strength");
    let own = world.add_model("own", model(), ContactStiffness::Ratio(1.0));
    let own = Adaptive {
        model: own.unwrap(),
        ..adaptive
    };
    refused(world.set_adaptive(turned, own), "stiffness of the law");
    let relaxation = femdem_solve::WorldRelaxation::default();
    refused(world.relax(&relaxation).map(|_| ()), "a relaxation");
    // Another material has a law with another penalty.
    let other = ContactParameters {
        penalty: 2.0 * PENALTY,
        ..world.parameters().contact
    };
    let [first, second] = [0, 1].map(femdem_contact::MaterialId);
    refused(world.set_law(first, second, other), "penalty");
    world.set_law(second, second, other).unwrap();
    refused(world.set_material(id, second), "penalty");
    assert!(world.is_adaptive(id) && !world.is_adaptive(ball));
    world.remove_body(id).unwrap();
    assert_eq!(world.adaptive_bodies().count(), 0);
}
