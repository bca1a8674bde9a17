//! A bar in tension: it bears the strength of its material, and breaking takes the energy of its section.

use super::setting::{POISSON, TENSILE, YOUNG, add, facets, model, pieces, rock, shaken, world};
use femdem_fem::{Boundary, Drive, Selection};
use femdem_mesh::Vector3;
use std::error::Error;

/// Energy of fracture, J/m².
const ENERGY: f64 = 20.0;

/// Speed of either end, m/s: the stress grows by a hundredth of the strength while a wave crosses the bar.
const SPEED: f64 = 0.004;

/// The stress at the beginning over the strength.
const BEGIN: f64 = 0.95;

/// Time after the bar has come in two in which other cracks may open or close, s: twenty crossings.
const REST: f64 = 3e-4;

/// Time in which the bar has to come in two, s.
const LIMIT: f64 = 1e-3;

/// What came out.
pub struct Bar {
    /// Largest mean tension over the strength.
    pub strength: f64,
    /// Energy that the facets which broke have taken over that of the section.
    pub crack: f64,
    /// The same of all cracks: what those which close again give back of what was lent to them is less than nothing.
    pub energy: f64,
    /// Number of pieces: one if the limit of time is over and something still joins all.
    pub pieces: usize,
    /// Relative error of the ledger.
    pub books: f64,
}

/// Pulls a bar of 40 mm x 10 mm x 10 mm apart.
pub fn break_in_tension(cells: [u32; 3], seed: f64) -> Result<Bar, Box<dyn Error>> {
    let size = Vector3::new(0.04, 0.01, 0.01);
    let model = model(&shaken(cells, &size, seed)?, YOUNG)?;
    let strain = BEGIN * TENSILE / YOUNG;
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, -1.0), (size.x, 1.0)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (way * SPEED),
            start: -0.5 * strain * size.x / SPEED,
            end: 1.0,
        };
        boundary.drive(&model, &end, [true, false, false], drive)?;
    }
    let mut world = world()?;
    // Under tension along the bar alone, its sides come together.
    let grow = |x: &Vector3| {
        let from = x - size * 0.5;
        Vector3::new(from.x, -POISSON * from.y, -POISSON * from.z)
    };
    let nodes = model.nodes().to_vec();
    let free = Boundary::default();
    let body = add(&mut world, model, free, rock(ENERGY)?, |_| Vector3::zeros())?;
    let places: Vec<Vector3> = nodes.iter().map(|x| x + grow(x) * strain).collect();
    let rate = 2.0 * SPEED / size.x;
    let velocities: Vec<Vector3> = nodes.iter().map(|x| grow(x) * rate).collect();
    world.set_nodes(body, &places, &velocities)?;
    world.set_boundary(body, boundary)?;
    let mut peak = 0.0_f64;
    while pieces(&world, body) < 2 && world.time() < LIMIT {
        world.step()?;
        let own = world.deformable(body).ok_or("no body")?;
        let (mut sum, mut volume) = (0.0, 0.0);
        for (stress, v) in own.stresses()?.iter().zip(own.model().volumes()) {
            sum += stress.cauchy[(0, 0)] * v;
            volume += v;
        }
        peak = peak.max(sum / volume);
    }
    let until = world.time() + REST;
    while world.time() < until {
        world.step()?;
    }
    let ledger = world.ledger();
    let facets = facets(&world, body).into_iter();
    let broken = facets.filter(|facet| facet.end.is_some());
    let section = ENERGY * size.y * size.z;
    Ok(Bar {
        strength: peak / TENSILE,
        pieces: pieces(&world, body),
        crack: broken.map(|facet| facet.taken).sum::<f64>() / section,
        energy: (ledger.dissipated_fracture + ledger.cracks - ledger.lent) / section,
        books: ledger.error_relative(),
    })
}
