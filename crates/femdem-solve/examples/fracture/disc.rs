//! A disc pressed across its diameter (the Brazilian test): it splits where the tension at its centre reaches the strength.

use super::setting::{TENSILE, YOUNG, add, facets, mean_angle, model, rock, world};
use femdem_contact::Wall;
use femdem_fem::{Boundary, Drive};
use femdem_mesh::shapes::{Cylinder, Shape};
use femdem_mesh::tet::{MeshOptions, mesh};
use femdem_mesh::{Point3, Polyhedron, Vector3};
use std::error::Error;
use std::f64::consts::PI;

/// Diameter, m.
const DIAMETER: f64 = 0.05;

/// Thickness, m.
const THICKNESS: f64 = 0.006;

/// Speed of the upper platen, m/s.
const SPEED: f64 = 0.1;

/// What came out; loads are over π D L f/2.
pub struct Disc {
    pub tets: usize,
    /// Diameter over the length of the process zone.
    pub zones: f64,
    /// Load at the first crack away from the platens.
    pub first: f64,
    /// Distance of that crack from the centre, over the radius.
    pub place: f64,
    /// Largest load.
    pub peak: f64,
    /// Mean angle of the facets to the loaded diameter at the fall of the load, degrees.
    pub angle: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// Its axis along y, its centre at the origin.
fn polyhedron() -> Result<Polyhedron, Box<dyn Error>> {
    let cylinder = Shape::from(Cylinder::default()).polyhedron(1.0)?;
    let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
    for v in cylinder.vertices() {
        low = low.inf(&v.coords);
        high = high.sup(&v.coords);
    }
    let scale = Vector3::new(DIAMETER, DIAMETER, THICKNESS).component_div(&(high - low));
    let placed = |v: &Point3| {
        let x = (v.coords - (low + high) * 0.5).component_mul(&scale);
        Point3::new(x.x, x.z, -x.y)
    };
    let vertices = cylinder.vertices().iter().map(placed).collect();
    let faces = cylinder.faces().map(<[u32]>::to_vec).collect();
    Ok(Polyhedron::new(vertices, faces)?)
}

/// Presses the disc until its load has fallen to a half.
pub fn split(edge: f64, energy: f64) -> Result<Disc, Box<dyn Error>> {
    let options = MeshOptions {
        edge_length: Some(edge),
        ..MeshOptions::default()
    };
    let (mesh, _) = mesh(&polyhedron()?, &options)?;
    let model = model(&mesh, YOUNG)?;
    let mut world = world()?;
    let up = Vector3::z();
    let lowest = mesh.points().iter().map(|p| p.z).fold(0.0, f64::min);
    world.add_wall(Wall::half_space("anvil", up, lowest)?, Drive::Fixed)?;
    let drive = Drive::Linear {
        velocity: -up * SPEED,
        start: 0.0,
        end: 1.0,
    };
    world.add_wall(Wall::half_space("platen", -up, lowest)?, drive)?;
    let mut fracture = rock(energy)?;
    fracture.coarse = true;
    let zones = DIAMETER / fracture.process_zone(YOUNG);
    let shorten = |x: &Vector3| -up * (SPEED * (x.z / DIAMETER + 0.5));
    let body = add(&mut world, model, Boundary::default(), fracture, shorten)?;
    let (mut peak, mut first, mut place) = (0.0_f64, f64::NAN, f64::NAN);
    loop {
        world.step()?;
        let loads = [0, 1].iter().filter_map(|w| world.wall_load(*w));
        let force: f64 = loads.map(|l| l.total.force.norm()).sum::<f64>() / 2.0;
        let load = force / (PI * DIAMETER * THICKNESS * TENSILE / 2.0);
        peak = peak.max(load);
        if first.is_nan() {
            let inside = facets(&world, body).iter().find_map(|f| {
                let centre = (f.corners[0] + f.corners[1] + f.corners[2]) / 3.0;
                let away = centre.x.hypot(centre.z) / (0.5 * DIAMETER);
                (away < 0.8).then_some(away)
            });
            if let Some(away) = inside {
                (first, place) = (load, away);
            }
        }
        if load < 0.5 * peak && peak > 0.5 {
            break;
        }
    }
    let cracks = facets(&world, body);
    Ok(Disc {
        tets: mesh.tets().len(),
        zones,
        first,
        place,
        peak,
        angle: 90.0 - mean_angle(&cracks, &up),
        books: world.ledger().error_relative(),
    })
}
