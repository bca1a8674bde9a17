//! Deformable bodies that crack and break.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_fem::fracture::Strength;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, Drive, MaterialRegion, Selection};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use femdem_solve::{
    ContactStiffness, DeformableSpec, Fracture, SleepParameters, TimeStepParameters, World,
    WorldParameters,
};

const YOUNG: f64 = 20e9;
const TENSILE: f64 = 5e6;

/// Rock: f = 5 MPa, c = 20 MPa, tan φ = 0.8.
fn rock(energies: [f64; 2]) -> Fracture {
    Fracture::new(
        Strength::new(TENSILE, 20e6, 0.8_f64.atan()).unwrap(),
        energies,
    )
}

/// A block whose points are moved by up to a fifth of an edge, on the skin along it.
fn shaken(cells: [u32; 3], size: &Vector3) -> TetMesh {
    let block = TetMesh::block(cells, size).unwrap();
    let edge = size.component_div(&Vector3::from(cells.map(f64::from)));
    let noise = |i: usize, k: f64| (12.9898 * i as f64 + 78.233 * k).sin();
    let moved = |(i, p): (usize, &Point3)| {
        let mut p = *p;
        for k in 0..3 {
            let inside = p[k] > 1e-9 * size[k] && p[k] < (1.0 - 1e-9) * size[k];
            if inside {
                p[k] += 0.2 * edge[k] * noise(i, k as f64);
            }
        }
        p
    };
    let points = block.points().iter().enumerate().map(moved).collect();
    TetMesh::new(points, block.tets().to_vec()).unwrap()
}

fn model(mesh: &TetMesh) -> DeformableModel {
    let region = MaterialRegion {
        material: NeoHookean::new(YOUNG, 0.2).unwrap().into(),
        density: 2500.0,
    };
    DeformableModel::new(mesh, Element::T4, vec![region], None).unwrap()
}

fn still() -> World {
    World::new(WorldParameters {
        gravity: Vector3::zeros(),
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

/// Bar of 40 x 10 x 10 mm whose ends go apart at `speed` each, m/s.
fn bar(cells: [u32; 3], speed: f64, fracture: Option<Fracture>) -> World {
    let size = Vector3::new(0.04, 0.01, 0.01);
    let mut world = still();
    let model = model(&shaken(cells, &size));
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, -1.0), (size.x, 1.0)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (way * speed),
            start: 0.0,
            end: 1.0,
        };
        boundary
            .drive(&model, &end, [true, false, false], drive)
            .unwrap();
    }
    // Along the bar, no wave comes from the ends.
    let start: Vec<Vector3> = model.nodes().to_vec();
    let velocity = |x: &Vector3| Vector3::x() * (speed * (2.0 * x.x / size.x - 1.0));
    let velocities: Vec<Vector3> = start.iter().map(velocity).collect();
    let id = world
        .add_model("bar", model, ContactStiffness::default())
        .unwrap();
    let body = world
        .add_deformable(DeformableSpec {
            boundary,
            fracture,
            ..DeformableSpec::at_rest(id, Pose::identity())
        })
        .unwrap();
    world.set_nodes(body, &start, &velocities).unwrap();
    world
}

/// Mean tension at its middle, Pa.
fn tension(world: &World) -> f64 {
    let body = world.deformable(0).unwrap();
    let stresses = body.stresses().unwrap();
    let volumes = body.model().volumes();
    let sum: f64 = stresses
        .iter()
        .zip(volumes)
        .map(|(s, v)| s.cauchy[(0, 0)] * v)
        .sum();
    sum / volumes.iter().sum::<f64>()
}

fn fragments(world: &World) -> usize {
    let fragments = world.deformable(0).unwrap().cracks().unwrap().fragments();
    fragments.iter().max().map_or(1, |most| *most as usize + 1)
}

/// No calibration: the strength is that of the material, the energy at least that of the section (a bar under the same tension
/// everywhere cracks in several places before it breaks), and all of it is on the books. Then the pieces are pushed together again and bear pressure, as the whole bar does.
#[test]
fn a_bar_in_tension_breaks_at_its_strength_and_closes_again() {
    let mut world = bar([12, 3, 3], 0.2, Some(rock([20.0, 100.0])));
    let mut peak = 0.0_f64;
    while fragments(&world) < 2 {
        world.step().unwrap();
        peak = peak.max(tension(&world));
        assert!(world.time() < 1e-3, "it does not break: {peak:e}");
    }
    for _ in 0..500 {
        world.step().unwrap();
    }
    assert!((peak / TENSILE - 1.0).abs() < 0.05, "{peak:e}");
    let ledger = world.ledger();
    let taken = (ledger.dissipated_fracture - ledger.lent) / (20.0 * 1e-4);
    assert!(taken > 1.0 && taken < 4.0, "{taken}");
    assert!(ledger.error_relative().abs() < 1e-3, "{ledger:?}");
    let body = world.deformable(0).unwrap();
    let mass = 2500.0 * 0.04 * 1e-4;
    assert!((body.mass() / mass - 1.0).abs() < 1e-12);
    // Back at ten times the speed, until the pieces have met and press each other.
    let model = body.model().clone();
    let places = body.positions().to_vec();
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, 1.0), (0.04, -1.0)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (2.0 * way),
            start: world.time(),
            end: 1.0,
        };
        boundary
            .drive_from(&model, &end, [true, false, false], drive, &places)
            .unwrap();
    }
    world.set_boundary(0, boundary).unwrap();
    let pulled = 0.4 * world.time();
    let until = world.time() + (pulled + 1e-5) / 4.0;
    while world.time() < until {
        world.step().unwrap();
    }
    assert!(tension(&world) < -0.2 * YOUNG * 1e-5 / 0.04);
    assert!(
        world.ledger().error_relative().abs() < 2e-3,
        "{:?}",
        world.ledger()
    );
}

/// As long as nothing cracks, a body that may break moves with the same bits as one that cannot.
#[test]
fn before_it_cracks_a_body_has_the_same_bits() {
    let [mut may, mut cannot] = [Some(rock([20.0, 100.0])), None].map(|f| bar([8, 2, 2], 0.05, f));
    for _ in 0..300 {
        may.step().unwrap();
        cannot.step().unwrap();
    }
    let stressed = tension(&may) / TENSILE;
    assert!(stressed > 0.5 && stressed < 1.0, "{stressed}");
    assert!(
        may.deformable(0)
            .unwrap()
            .cracks()
            .unwrap()
            .mesh()
            .is_none()
    );
    assert_eq!(
        may.deformable(0).unwrap().positions(),
        cannot.deformable(0).unwrap().positions()
    );
    assert_eq!(may.time(), cannot.time());
}

/// A cube that falls on its edge, fast enough to break.
fn dropped() -> World {
    let mut world = still();
    world
        .add_wall(
            Wall::half_space("floor", Vector3::z(), 0.0).unwrap(),
            femdem_solve::Drive::Fixed,
        )
        .unwrap();
    let id = world
        .add_model(
            "cube",
            model(&shaken([4; 3], &Vector3::repeat(0.02))),
            ContactStiffness::default(),
        )
        .unwrap();
    let place = Pose::new(Vector3::new(0.0, 0.0, 0.012), Vector3::new(0.6, 0.2, 0.0));
    world
        .add_deformable(DeformableSpec {
            velocity: Vector3::new(0.0, 0.0, -40.0),
            fracture: Some(Fracture {
                coarse: true,
                ..rock([5.0, 25.0])
            }),
            ..DeformableSpec::at_rest(id, place)
        })
        .unwrap();
    world
}

/// The pieces of a cube thrown on the floor: mass, momentum and energy are right, and the bits are the same with threads and
/// through checkpoints in the midst of it.
#[test]
fn a_thrown_cube_breaks() {
    let mut world = dropped();
    let mut restarted = dropped();
    let mut worst = 0.0_f64;
    for step in 0..2400 {
        world.step().unwrap();
        restarted.step().unwrap();
        if step % 400 == 399 {
            let bytes = restarted.to_bytes().unwrap();
            restarted = World::from_bytes(&bytes).unwrap();
        }
        worst = worst.max(world.ledger().error_relative().abs());
    }
    let cracks = world.deformable(0).unwrap();
    let cracks = cracks.cracks().unwrap();
    println!(
        "frag {} spent {} joints {} worst {worst:.1e} rel {:.2e}",
        fragments(&world),
        cracks.spent().len(),
        cracks.facets().count(),
        world.ledger().dissipated_release
    );
    assert!(fragments(&world) > 3);
    assert!(!cracks.spent().is_empty());
    assert_eq!(world.to_bytes().unwrap(), restarted.to_bytes().unwrap());
}

#[test]
fn what_cannot_break_is_refused_by_name() {
    let mut world = still();
    let mesh = shaken([2; 3], &Vector3::repeat(0.02));
    let of = |world: &mut World, element, stiffness, fracture| {
        let region = MaterialRegion {
            material: NeoHookean::new(YOUNG, 0.2).unwrap().into(),
            density: 2500.0,
        };
        let model = DeformableModel::new(&mesh, element, vec![region], None).unwrap();
        let id = world.add_model("cube", model, stiffness).unwrap();
        let spec = DeformableSpec {
            fracture: Some(fracture),
            ..DeformableSpec::at_rest(id, Pose::identity())
        };
        world.add_deformable(spec).unwrap_err().to_string()
    };
    let ratio = ContactStiffness::Ratio(1.0);
    let good = Fracture {
        coarse: true,
        ..rock([20.0, 100.0])
    };
    let coarse = of(&mut world, Element::T4, ratio, rock([2.0, 10.0]));
    assert!(
        coarse.contains("use a mesh with edges of about"),
        "{coarse}"
    );
    let quadratic = of(&mut world, Element::T10, ratio, good);
    assert!(quadratic.contains("linear elements (T4)"), "{quadratic}");
    let penalty = of(
        &mut world,
        Element::T4,
        ContactStiffness::Penalty(1e9),
        good,
    );
    assert!(
        penalty.contains("contact stiffness over depth"),
        "{penalty}"
    );
    let eager = of(
        &mut world,
        Element::T4,
        ratio,
        Fracture { every: 0, ..good },
    );
    assert!(eager.contains("steps between looks"), "{eager}");
    let slippery = of(&mut world, Element::T4, ratio, rock([20.0, 10.0]));
    assert!(
        slippery.contains("energy of fracture by sliding = 10"),
        "{slippery}"
    );
    assert_eq!(world.deformable_count(), 0);
}
