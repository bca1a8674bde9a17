//! Deformable bodies that crack and break.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

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

#[test]
fn a_bar_in_tension_breaks_at_its_strength() {
    let mut world = bar([12, 3, 3], 0.2, Some(rock([20.0, 100.0])));
    let mut peak = 0.0_f64;
    let mut after = 0;
    while after < 4000 {
        world.step().unwrap();
        peak = peak.max(tension(&world));
        let body = world.deformable(0).unwrap();
        let mesh = body.cracks().unwrap().mesh();
        after += u32::from(mesh.is_some_and(|mesh| mesh.parts().iter().max() > Some(&0)));
        assert!(world.time() < 1e-3, "it does not break: {peak:e}");
    }
    let ledger = world.ledger();
    let taken = (ledger.dissipated_fracture - ledger.lent) / (20.0 * 1e-4);
    println!(
        "peak {:.3} taken {taken:.3} ledger {:.2e} steps {} t {:.3e} facets {}",
        peak / TENSILE,
        ledger.error_relative(),
        world.steps(),
        world.time(),
        world
            .deformable(0)
            .unwrap()
            .cracks()
            .unwrap()
            .facets()
            .count(),
    );
    println!("{ledger:#?}");
}
