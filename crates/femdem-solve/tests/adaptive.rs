//! Bodies that are rigid far from their strength and deformable near it.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::{BodyId, ContactParameters, Field, Partner, Wall, WallResponse};
use femdem_fem::element::Element;
use femdem_fem::fracture::Strength;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use femdem_solve::{
    Adaptive, BodySpec, ContactStiffness, DeformableSpec, Drive, Fidelity, FidelityChange, Fracture,
    SleepParameters, SolveError, TimeStepParameters, World, WorldParameters,
};

const YOUNG: f64 = 20e9;
const DENSITY: f64 = 2500.0;
/// Side of the cube, m, and cells along it.
const SIDE: f64 = 0.01;
const CELLS: u32 = 3;
/// Pa: a foundation of E/h over half the side.
const PENALTY: f64 = YOUNG * CELLS as f64 / 2.0;

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
        world.add_model("cube", model(), ContactStiffness::Law).unwrap();
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
    let mut world = world(0.0);
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

#[test]
fn a_look() {
    for kind in [Kind::Adaptive, Kind::Breakable] {
        let mut world = pressed(kind, 0.1, 1.0);
        let mut peak = 0.0_f64;
        let start = std::time::Instant::now();
        let mut k = 0;
        while world.time() < 2e-3 && !is_cracked(&world) {
            world.step().unwrap();
            k += 1;
            for change in world.take_fidelity_changes() {
                eprintln!("{change:?} force {} {:?}", force(&world), start.elapsed());
            }
            if k % 500 == 0 {
                eprintln!("{k} {:e} {:e} {} err {:e} dt {:e}", world.time(), force(&world), is_cracked(&world), world.ledger().error_relative(), world.time_step());
            }
            peak = peak.max(force(&world));
        }
        eprintln!("cracked {:e} {:e} peak {peak} steps {k} {:?}", world.time(), force(&world), start.elapsed());
        for _ in 0..100 { world.step().unwrap(); peak = peak.max(force(&world)); }
        eprintln!("peak {peak}, {:?}", start.elapsed());
        eprintln!("{:?} {}", world.ledger(), world.ledger().error_relative());
    }
}
