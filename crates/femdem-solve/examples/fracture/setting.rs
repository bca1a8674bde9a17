//! What the tests have in common.

use femdem_contact::BodyId;
use femdem_fem::element::Element;
use femdem_fem::fracture::Strength;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use femdem_solve::{
    ContactStiffness, CrackFacet, DeformableSpec, Fracture, SleepParameters, TimeStepParameters,
    World, WorldParameters,
};
use std::error::Error;

/// Young's modulus, Pa.
pub const YOUNG: f64 = 20e9;

/// Poisson's ratio.
pub const POISSON: f64 = 0.2;

/// Density, kg/m³.
pub const DENSITY: f64 = 2500.0;

/// Strength in tension, Pa.
pub const TENSILE: f64 = 5e6;

/// Cohesion, Pa.
const COHESION: f64 = 20e6;

/// Tangent of the angle of internal friction.
pub const SLOPE: f64 = 0.8;

/// A rock of the given energy of fracture by opening, J/m²; five times as much by sliding.
pub fn rock(energy: f64) -> Result<Fracture, Box<dyn Error>> {
    rock_of([energy, 5.0 * energy])
}

/// A rock of the given energies of fracture by opening and by sliding, J/m².
pub fn rock_of(energies: [f64; 2]) -> Result<Fracture, Box<dyn Error>> {
    let strength = Strength::new(TENSILE, COHESION, SLOPE.atan())?;
    Ok(Fracture::new(strength, energies))
}

/// The axial stress at failure under a pressure on the sides (Mohr and Coulomb), Pa.
pub fn compressive(confinement: f64) -> f64 {
    let angle = SLOPE.atan();
    let flow = (1.0 + angle.sin()) / (1.0 - angle.sin());
    2.0 * COHESION * flow.sqrt() + confinement * flow
}

/// A number from -1 to 1 for a component of a point.
pub fn noise(point: usize, component: usize, seed: f64) -> f64 {
    (12.9898 * point as f64 + 78.233 * component as f64 + 37.719 * seed).sin()
}

/// A block of cells whose points are moved by up to a fifth of an edge, those on the skin along it.
pub fn shaken(cells: [u32; 3], size: &Vector3, seed: f64) -> Result<TetMesh, Box<dyn Error>> {
    let block = TetMesh::block(cells, size)?;
    let edge = size.component_div(&Vector3::from(cells.map(f64::from)));
    let mut points: Vec<Point3> = block.points().to_vec();
    for (i, p) in points.iter_mut().enumerate() {
        for k in 0..3 {
            if p[k] > 1e-9 * size[k] && p[k] < (1.0 - 1e-9) * size[k] {
                p[k] += 0.2 * edge[k] * noise(i, k, seed);
            }
        }
    }
    Ok(TetMesh::new(points, block.tets().to_vec())?)
}

/// A world without gravity and without friction.
pub fn world() -> Result<World, Box<dyn Error>> {
    damped_world(0.0)
}

/// The same with a local damping.
pub fn damped_world(local_damping: f64) -> Result<World, Box<dyn Error>> {
    let mut parameters = WorldParameters {
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
    };
    parameters.contact.friction = 0.0;
    parameters.medium.local_damping = local_damping;
    Ok(World::new(parameters)?)
}

/// The elements of a body.
pub fn model(mesh: &TetMesh, young: f64) -> Result<DeformableModel, Box<dyn Error>> {
    let region = MaterialRegion {
        material: NeoHookean::new(young, POISSON)?.into(),
        density: DENSITY,
    };
    Ok(DeformableModel::new(mesh, Element::T4, vec![region], None)?)
}

/// Adds a body that may break, whose nodes begin with the given velocities.
pub fn add(
    world: &mut World,
    model: DeformableModel,
    boundary: Boundary,
    fracture: Fracture,
    velocity: impl Fn(&Vector3) -> Vector3,
) -> Result<BodyId, Box<dyn Error>> {
    let velocities: Vec<Vector3> = model.nodes().iter().map(velocity).collect();
    add_moving(world, model, boundary, fracture, &velocities)
}

/// As [`add`], with the velocities of the nodes.
pub fn add_moving(
    world: &mut World,
    model: DeformableModel,
    boundary: Boundary,
    fracture: Fracture,
    velocities: &[Vector3],
) -> Result<BodyId, Box<dyn Error>> {
    let places: Vec<Vector3> = model.nodes().to_vec();
    let id = world.add_model("specimen", model, ContactStiffness::Ratio(4.0))?;
    let spec = DeformableSpec {
        boundary,
        fracture: Some(fracture),
        ..DeformableSpec::at_rest(id, Pose::identity())
    };
    let body = world.add_deformable(spec)?;
    world.set_nodes(body, &places, velocities)?;
    Ok(body)
}

/// The facets of a body that are cut or broken.
pub fn facets(world: &World, body: BodyId) -> Vec<CrackFacet> {
    let cracks = world.deformable(body).and_then(|b| b.cracks());
    cracks.map_or_else(Vec::new, |c| {
        c.spent().iter().copied().chain(c.facets()).collect()
    })
}

/// Number of pieces.
pub fn pieces(world: &World, body: BodyId) -> usize {
    let cracks = world.deformable(body).and_then(|b| b.cracks());
    let most = cracks.and_then(|c| c.fragments().iter().max().copied());
    most.map_or(1, |m| m as usize + 1)
}

/// The mean angle between facets and the plane across an axis, degrees, weighted by the energy that they have taken.
pub fn mean_angle(facets: &[CrackFacet], axis: &Vector3) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for f in facets {
        let [a, b, c] = f.corners;
        let normal = (b - a).cross(&(c - a)).normalize();
        sum += f.taken * normal.dot(axis).abs().min(1.0).acos().to_degrees();
        weight += f.taken;
    }
    sum / weight
}
