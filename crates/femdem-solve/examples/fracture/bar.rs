//! A bar in tension: it bears the strength of its material, and breaking takes the energy of its section.

use super::setting::{TENSILE, YOUNG, add, model, pieces, rock, shaken, world};
use femdem_fem::{Boundary, Drive, Selection};
use femdem_mesh::Vector3;
use std::error::Error;

/// Energy of fracture, J/m².
const ENERGY: f64 = 20.0;

/// Speed of either end, m/s.
const SPEED: f64 = 0.05;

/// Time after the bar has come in two in which the rest of the crack opens, s: its ends go three times as far apart as a crack
/// bears.
const REST: f64 = 3e-4;

/// Time in which the bar has to come in two, s: by then its ends are ten times as far apart as a crack bears.
const LIMIT: f64 = 1e-3;

/// What came out.
pub struct Bar {
    /// Largest mean tension over the strength.
    pub strength: f64,
    /// Energy taken over that of the section.
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
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, -1.0), (size.x, 1.0)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (way * SPEED),
            start: 0.0,
            end: 1.0,
        };
        boundary.drive(&model, &end, [true, false, false], drive)?;
    }
    let mut world = world()?;
    let stretch = |x: &Vector3| Vector3::x() * (SPEED * (2.0 * x.x / size.x - 1.0));
    let body = add(&mut world, model, boundary, rock(ENERGY)?, stretch)?;
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
    Ok(Bar {
        strength: peak / TENSILE,
        pieces: pieces(&world, body),
        energy: (ledger.dissipated_fracture - ledger.lent) / (ENERGY * size.y * size.z),
        books: ledger.error_relative(),
    })
}
