//! Worlds brought to rest by dynamic relaxation.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::Unit;
use femdem_mesh::{Pose, Rotation, TetMesh, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, World, WorldParameters, WorldRelaxation,
};

const SIDE: f64 = 0.1;
const DENSITY: f64 = 2000.0;

/// Cubes one on another, each a little above the one below.
fn stack(count: u32, young: f64, stiffness: ContactStiffness) -> World {
    let mut world = World::new(WorldParameters::default()).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(SIDE)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(young, 0.0).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let model = world.add_model("cube", model, stiffness).unwrap();
    for k in 0..count {
        let z = f64::from(k) * (SIDE - 1e-6) - 1e-6;
        // Slightly to the side, so that no side faces are in one plane.
        let pose = Pose::translation(1e-3 * f64::from(k % 2), 0.0, z);
        world
            .add_deformable(DeformableSpec::at_rest(model, pose))
            .unwrap();
    }
    world
}

/// Each contact carries the weight above it, and the middle of each cube the corresponding mean stress, for
/// cubes as soft as their contacts and for cubes of stone.
#[test]
fn a_stack_carries_its_weight() {
    for (young, stiffness) in [
        (1e6, ContactStiffness::default()),
        (6e10, ContactStiffness::Penalty(2e6)),
    ] {
        let mut world = stack(4, young, stiffness);
        let report = world.relax(&WorldRelaxation::default()).unwrap();
        assert!(report.residual <= 1e-4, "{report:?}");
        let weight = DENSITY * SIDE.powi(3) * 9.81;
        for contact in world.deformable_contacts() {
            let above = weight * f64::from(4 - contact.b);
            let force = contact.force_on_b().z;
            assert!((force / above - 1.0).abs() < 1e-3, "{contact:?} {above}");
        }
        for (k, body) in world.deformables().enumerate() {
            let stresses = body.stresses().unwrap();
            let volumes = body.model().volumes();
            let mean = stresses
                .iter()
                .zip(volumes)
                .map(|(s, v)| s.cauchy[(2, 2)] * v);
            let mean = mean.sum::<f64>() / SIDE.powi(3);
            let expected = -weight * (3.5 - k as f64) / SIDE.powi(2);
            assert!(
                (mean / expected - 1.0).abs() < 0.01,
                "{k} {mean} {expected}"
            );
        }
    }
}

/// A rigid cube that rests on a free deformable one: the relaxation ends with both at rest.
#[test]
fn a_rigid_body_on_a_deformable_one() {
    let mut world = stack(1, 1e7, ContactStiffness::default());
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(SIDE * 3.0_f64.sqrt()).unwrap();
    let shape = world.add_shape("P5", &cube).unwrap();
    // The mesh's corner is at its origin.
    let middle = SIDE / 2.0;
    let place = Pose::translation(middle, middle, SIDE + middle - 2e-5);
    let rigid = world
        .add_body(BodySpec::at_rest(shape, DENSITY, place))
        .unwrap();
    let report = world.relax(&WorldRelaxation::default()).unwrap();
    assert!(report.residual <= 1e-4, "{report:?}");
    let weight = DENSITY * SIDE.powi(3) * 9.81;
    let forces: Vec<f64> = world
        .deformable_contacts()
        .map(|c| c.normal_force / weight)
        .collect();
    assert_eq!(forces.len(), 2);
    assert!(
        (forces.iter().sum::<f64>() - 3.0).abs() < 1e-3,
        "{forces:?}"
    );
    assert!(world.velocity(rigid).unwrap().norm() == 0.0);
}

/// Bodies that touch nothing at first fall until they do.
#[test]
fn a_stack_that_touches_nothing_yet() {
    for gap in [0.0, 1e-4] {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let floor = Wall::half_space("floor", Vector3::z(), -gap).unwrap();
        world.add_wall(floor, Drive::Fixed).unwrap();
        let lifted = stack(1, 1e7, ContactStiffness::default());
        let body = lifted.deformable(0).unwrap();
        let model = world
            .add_model("cube", body.model().clone(), ContactStiffness::default())
            .unwrap();
        for k in 0..2 {
            let place = Pose::translation(0.0, 0.0, f64::from(k) * (SIDE + gap));
            world
                .add_deformable(DeformableSpec::at_rest(model, place))
                .unwrap();
        }
        let report = world.relax(&WorldRelaxation::default()).unwrap();
        assert!(report.residual <= 1e-4, "{gap} {report:?}");
        let weight = DENSITY * SIDE.powi(3) * 9.81;
        let sum: f64 = world.deformable_contacts().map(|c| c.normal_force).sum();
        assert!((sum / weight - 3.0).abs() < 1e-3, "{gap} {sum}");
    }
}

/// Without friction the ledger accounts for all energy: that of the bodies at the start, and that removed
/// when they are stopped, as wholes and element by element.
#[test]
fn the_books_of_a_relaxation_close() {
    let mut world = stack(3, 1e6, ContactStiffness::default());
    let mut contact = world.parameters().contact;
    contact.friction = 0.0;
    world.set_contact(contact).unwrap();
    for _ in 0..300 {
        world.step().unwrap();
    }
    assert!(world.kinetic_energy() > 0.0);
    world.relax(&WorldRelaxation::default()).unwrap();
    let error = world.ledger().error_relative();
    assert!(error.abs() < 0.02, "{error}");
}

/// A cube that is held at one side and pulled at the other, with no other load: for any size and load, it
/// reaches equilibrium to the tolerance, not to an absolute force in newtons.
#[test]
fn what_is_left_is_compared_with_the_loads() {
    for (side, stress) in [(1e-4, 1e2), (0.1, 1e4), (100.0, 1e5)] {
        let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(side)).unwrap();
        let young = 1e7;
        let region = MaterialRegion {
            material: NeoHookean::new(young, 0.0).unwrap().into(),
            density: DENSITY,
        };
        let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
        let end = |offset: f64| Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-6 * side,
        };
        let mut boundary = Boundary::new(Vector3::zeros()).unwrap();
        boundary.fix(&model, &end(0.0), [true; 3]).unwrap();
        let pull = Vector3::x() * stress;
        boundary.pull(&model, &end(side), pull, 1.0).unwrap();
        let gravity = Vector3::zeros();
        let parameters = WorldParameters {
            gravity,
            ..WorldParameters::default()
        };
        let mut world = World::new(parameters).unwrap();
        let model = world
            .add_model("cube", model, ContactStiffness::default())
            .unwrap();
        let spec = DeformableSpec {
            boundary,
            ..DeformableSpec::at_rest(model, Pose::identity())
        };
        world.add_deformable(spec).unwrap();
        let found = world.relax(&WorldRelaxation::default()).unwrap();
        assert!(found.residual <= 1e-4, "{found:?}");
        let compared = found.mean_contact_force / (stress * side * side);
        assert!((compared - 1.0).abs() < 0.01, "{found:?}");
        let body = world.deformable(0).unwrap();
        let longest = body.positions().iter().map(|x| x.x).fold(0.0, f64::max);
        let strain = longest / side - 1.0;
        assert!((strain * young / stress - 1.0).abs() < 0.02, "{strain}");
    }
}

/// A rigid body is not at rest under a couple: one jammed obliquely between two walls turns until it lies
/// flat.
#[test]
fn a_couple_is_no_equilibrium() {
    let mut p = WorldParameters {
        gravity: Vector3::zeros(),
        ..WorldParameters::default()
    };
    p.contact.friction = 0.0;
    let mut world = World::new(p).unwrap();
    let turn = 0.3_f64;
    let reach = 0.5 * SIDE * (turn.cos() + turn.sin()) - 1e-4;
    for side in [1.0, -1.0] {
        let wall = Wall::half_space("side", Vector3::x() * side, -reach).unwrap();
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(SIDE * 3_f64.sqrt()).unwrap();
    let shape = world.add_shape("cube", &cube).unwrap();
    let askew = Pose::rotation(Vector3::z() * turn);
    let body = world.add_body(BodySpec::at_rest(shape, DENSITY, askew));
    let body = body.unwrap();
    let found = world.relax(&WorldRelaxation::default());
    let load = world.load(body).unwrap();
    let couple = load.total.torque.norm() / (SIDE * load.normal_sum.max(f64::MIN_POSITIVE));
    assert!(found.is_err() || couple < 1e-3, "{found:?} {couple}");
}

/// What does not rest yet comes to rest where it stands and is not thrown away: blocks that touch with a face, an edge or
/// a corner, or hardly, of any stiffness.
#[test]
fn what_touches_lightly_comes_to_rest() {
    for young in [1e6, 1e9] {
        for (gap, angle) in [(-1e-6, 0.0), (1e-5, 0.0), (-1e-6, 0.1), (1e-4, 0.1)] {
            let mut world = stack(0, young, ContactStiffness::default());
            let turn =
                Rotation::from_axis_angle(&Unit::new_normalize(Vector3::new(1.0, 2.0, 0.0)), angle);
            let middle = Vector3::repeat(SIDE / 2.0);
            // The lowest corner stands so high above the floor.
            let lowest = (0..8).map(|k| {
                let side = |bit: u32| f64::from(k >> bit & 1) - 0.5;
                (turn * Vector3::new(side(0), side(1), side(2))).z * SIDE
            });
            let height = gap - lowest.fold(f64::INFINITY, f64::min);
            let pose = Pose::from_parts((Vector3::z() * height).into(), turn)
                * Pose::from_parts((-middle).into(), Rotation::identity());
            world
                .add_deformable(DeformableSpec::at_rest(0, pose))
                .unwrap();
            let report = world.relax(&WorldRelaxation::default()).unwrap();
            assert!(report.residual <= 1e-4, "{young} {gap} {angle}: {report:?}");
            let weight = DENSITY * SIDE.powi(3) * 9.81;
            let force = world
                .deformable_contacts()
                .map(|c| c.force_on_b().z)
                .sum::<f64>();
            assert!(
                (force / weight - 1.0).abs() < 2e-4,
                "{young} {gap} {angle}: {force}"
            );
            let place = world.deformables().next().unwrap().centroid();
            let moved = place - Vector3::z() * height;
            assert!(
                moved.norm() < 0.2 * SIDE,
                "{young} {gap} {angle}: {moved:?}"
            );
        }
    }
}

/// A light cube in the air beside a block under a large load is no equilibrium.
#[test]
fn a_light_body_in_the_air_falls() {
    let mut world = stack(1, 1e6, ContactStiffness::default());
    let lid = Wall::half_space("lid", -Vector3::z(), -0.99 * SIDE).unwrap();
    world.add_wall(lid, Drive::Fixed).unwrap();
    let mesh = TetMesh::block([1, 1, 1], &Vector3::repeat(0.01)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e5, 0.0).unwrap().into(),
        density: 100.0,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let model = world
        .add_model("light", model, ContactStiffness::default())
        .unwrap();
    let pose = Pose::translation(0.3, 0.0, 0.02);
    let light = world
        .add_deformable(DeformableSpec::at_rest(model, pose))
        .unwrap();
    world.relax(&WorldRelaxation::default()).unwrap();
    let force: Vector3 = world
        .deformable(light)
        .unwrap()
        .contact_forces()
        .iter()
        .sum();
    assert!(force.z > 0.0, "{force:?}");
}

/// A beam of length 1 m that a support holds at its end, and a wall so far (m) below its foot.
fn cantilever(gap: f64) -> World {
    let mut world = World::new(WorldParameters::default()).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), -gap).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let mesh = TetMesh::block([20, 2, 2], &Vector3::new(1.0, SIDE, SIDE)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e8, 0.3).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T10, vec![region], None).unwrap();
    let root = Selection::Plane {
        normal: Vector3::x(),
        offset: 0.0,
        tolerance: 1e-9,
    };
    let mut boundary = Boundary::default();
    boundary.fix(&model, &root, [true; 3]).unwrap();
    let model = world
        .add_model("beam", model, ContactStiffness::default())
        .unwrap();
    let beam = world
        .add_deformable(DeformableSpec::at_rest(model, Pose::identity()))
        .unwrap();
    world.set_boundary(beam, boundary).unwrap();
    world
}

fn lowest(world: &World) -> f64 {
    let body = world.deformable(0).unwrap();
    let heights = body.positions().iter().map(|x| x.z);
    heights.fold(f64::INFINITY, f64::min)
}

/// A beam held at one end, which touches nothing, is solved at once: it sags by w L^4/(8 E I). Its slowest oscillation takes
/// more than a thousand steps.
#[test]
fn a_beam_that_touches_nothing_is_solved_at_once() {
    let mut world = cantilever(0.1);
    let period = 2.0 * std::f64::consts::PI / (3.516 * (1e8 * SIDE * SIDE / 12.0 / DENSITY).sqrt());
    let options = WorldRelaxation {
        steps: 100,
        ..WorldRelaxation::default()
    };
    assert_eq!(world.solve_single_bodies(options.tolerance).unwrap(), 1);
    assert_eq!(world.solve_single_bodies(options.tolerance).unwrap(), 0);
    let books = world.ledger();
    assert_eq!(books.by_hand, 0.0);
    assert!(
        books.frozen > 0.0 && books.error_relative().abs() < 1e-9,
        "{books:?}"
    );
    let report = world.relax(&options).unwrap();
    assert!(world.time_step() * 1000.0 < period);
    assert!(report.residual <= 1e-4, "{report:?}");
    let theory = DENSITY * 9.81 * 1.5 / (1e8 * SIDE * SIDE);
    let sag = -lowest(&world);
    assert!((sag / theory - 1.0).abs() < 0.03, "{sag} {theory}");
}

/// The same above a floor that it would pass through: after Newton's method it lies on the floor, and relaxes on it.
#[test]
fn a_beam_that_comes_down_on_a_floor_goes_on_from_there() {
    let mut world = cantilever(0.02);
    assert_eq!(world.solve_single_bodies(1e-4).unwrap(), 1);
    let report = world.relax(&WorldRelaxation::default()).unwrap();
    assert!(report.residual <= 1e-4, "{report:?}");
    let (lowest, touching) = (lowest(&world), world.deformable_contacts().count());
    assert!(lowest > -0.0205 && touching == 1, "{lowest} {touching}");
    // A propped cantilever, whose prop has sunk: the tip bears 3/8 of the weight less what the sinking takes.
    let stiffness = 3.0 * 1e8 * SIDE.powi(4) / 12.0;
    let weight = DENSITY * 9.81 * SIDE * SIDE;
    let expected = 0.375 * weight - stiffness * 0.02;
    let borne: f64 = world.deformable_contacts().map(|c| c.normal_force).sum();
    assert!((borne / expected - 1.0).abs() < 0.1, "{borne} {expected}");
}

/// Relaxation, which needs forces only, ends where Newton's method does, which needs the tangent.
#[test]
fn relaxation_finds_the_equilibrium_of_newton() {
    let mut solved = cantilever(0.2);
    assert_eq!(solved.solve_single_bodies(1e-6).unwrap(), 1);
    let mut relaxed = cantilever(0.2);
    let options = WorldRelaxation {
        tolerance: 1e-7,
        ..WorldRelaxation::default()
    };
    // What is left over at the tip, where a force of 1 N bends the beam by 0.4 mm, counts most.
    let report = relaxed.relax(&options).unwrap();
    assert!(report.stops > 1 && report.steps[1] > 1000, "{report:?}");
    let [a, b] = [&solved, &relaxed].map(lowest);
    assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
}
