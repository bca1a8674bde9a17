//! A deformable block that rocks on a floor comes to rest at the rate of its dashpot.

use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Pose, Rotation, TetMesh, Vector3};
use femdem_solve::{ContactStiffness, DeformableSpec, Drive, World, WorldParameters};

const SIDES: [f64; 3] = [0.2, 0.2, 0.1];
const DENSITY: f64 = 1000.0;
const PENALTY: f64 = 1e4;
/// Stiffness of the contact, N/m: 4 p/h with h half of the height, over the face.
const STIFFNESS: f64 = 4.0 * PENALTY / (0.5 * SIDES[2]) * SIDES[0] * SIDES[1];
/// Tilt, rad: a third of the tilt at which the pressure is at the limit of the middle third of the face.
const TILT: f64 = 4e-3;

/// A block that is much stiffer than its contact, tilted about x, at the depth that carries its weight.
fn tilted(zeta: f64) -> World {
    let mut p = WorldParameters::default();
    p.contact.friction = 0.0;
    p.contact.damping_ratio = zeta;
    let weight = DENSITY * SIDES.iter().product::<f64>() * -p.gravity.z;
    let mut world = World::new(p).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let mesh = TetMesh::block([4, 4, 2], &Vector3::from(SIDES)).unwrap();
    let centre = Vector3::from(SIDES) * 0.5;
    let points = mesh.points().iter().map(|p| p - centre).collect();
    let mesh = TetMesh::new(points, mesh.tets().to_vec()).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e8, 0.25).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let model = world
        .add_model("block", model, ContactStiffness::Penalty(PENALTY))
        .unwrap();
    let up = 0.5 * SIDES[2] - weight / STIFFNESS;
    let turn = Rotation::from_axis_angle(&Vector3::x_axis(), TILT);
    let pose = Pose::from_parts(Vector3::new(0.0, 0.0, up).into(), turn);
    world
        .add_deformable(DeformableSpec::at_rest(model, pose))
        .unwrap();
    world
}

/// Times and magnitudes of the maxima of the angular momentum about x, one for every half period.
fn swings(world: &mut World, until: f64) -> Vec<(f64, f64)> {
    let mut peaks = Vec::new();
    let mut last = [0.0; 2];
    while world.time() < until {
        world.step().unwrap();
        let body = world.deformable(0).unwrap();
        let now = body.angular_momentum(&body.centroid()).x.abs();
        if last[1] > last[0] && last[1] > now {
            peaks.push((world.time(), last[1]));
        }
        last = [last[1], now];
    }
    // The oscillation of the block's elements after its release makes small ones.
    let half = 0.5 * peaks.iter().map(|p| p.1).fold(0.0, f64::max);
    peaks.retain(|p| p.1 > 0.1 * half);
    peaks
}

/// Moment of inertia of the nodes about x, kg m^2.
fn inertia(world: &World) -> f64 {
    let body = world.deformable(0).unwrap();
    let nodes = body.model().nodes().iter().zip(body.model().masses());
    nodes.map(|(x, m)| m * x.yz().norm_squared()).sum()
}

#[test]
fn a_rocking_block_decays_at_the_predicted_rate() {
    let zeta = 0.05;
    let mut world = tilted(zeta);
    world.step().unwrap();
    let start = world.ledger();
    let peaks = swings(&mut world, 0.4);
    let (first, last) = (peaks[0], peaks[peaks.len() - 1]);
    let rate = (first.1 / last.1).ln() / (last.0 - first.0);
    // c/(2 I) with c = 2 zeta sqrt(k I): the frequency of the patch alone, times zeta.
    let patch = STIFFNESS * SIDES[1].powi(2) / 12.0;
    let expected = zeta * (patch / inertia(&world)).sqrt();
    let ratio = rate / expected;
    assert!((ratio - 0.98).abs() < 0.03, "{ratio}");
    let end = world.ledger();
    let (lost, booked) = (
        start.final_energy() - end.final_energy(),
        end.dissipated_damping - start.dissipated_damping,
    );
    assert!((booked / lost - 1.0).abs() < 1e-3, "{booked} of {lost}");

    let mut world = tilted(0.0);
    let peaks = swings(&mut world, 0.4);
    let ratio = peaks[peaks.len() - 1].1 / peaks[0].1;
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}
