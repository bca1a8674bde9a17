//! A block between platens without friction, with a pressure on its sides: the strength of Mohr and Coulomb.

use super::setting::{YOUNG, add, compressive, model, rock, shaken, world};
use femdem_contact::Wall;
use femdem_fem::{Boundary, Curve, Drive, Selection};
use femdem_mesh::Vector3;
use std::error::Error;

/// Energy of fracture, J/m².
const ENERGY: f64 = 20.0;

/// Speed of the upper platen, m/s.
const SPEED: f64 = 0.5;

/// Time in which the pressure on the sides rises, s: some ten times that of a wave across.
const RISE: f64 = 1e-4;

/// What came out.
pub struct Block {
    /// Largest axial stress over that of Mohr and Coulomb.
    pub strength: f64,
    /// Axial stress over the peak after a tenth more compression.
    pub held: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// Compresses a block of 20 mm x 20 mm x 40 mm under a pressure on its sides, Pa.
pub fn compress(cells: u32, confinement: f64) -> Result<Block, Box<dyn Error>> {
    let size = Vector3::new(0.02, 0.02, 0.04);
    let mesh = shaken([cells, cells, 2 * cells], &size, 1.0)?;
    let model = model(&mesh, YOUNG)?;
    let mut boundary = Boundary::default();
    if confinement > 0.0 {
        for (normal, width) in [(Vector3::x(), size.x), (Vector3::y(), size.y)] {
            for offset in [0.0, width] {
                let side = Selection::Plane {
                    normal,
                    offset,
                    tolerance: 1e-9,
                };
                let rise = Curve::Ramp {
                    value: confinement,
                    rise: RISE,
                };
                boundary.press(&model, &side, rise)?;
            }
        }
    }
    let mut world = world()?;
    let up = Vector3::z();
    world.add_wall(Wall::half_space("anvil", up, 0.0)?, Drive::Fixed)?;
    let drive = Drive::Linear {
        velocity: -up * SPEED,
        start: 0.0,
        end: 1.0,
    };
    world.add_wall(Wall::half_space("platen", -up, -size.z)?, drive)?;
    let mut fracture = rock(ENERGY)?;
    fracture.coarse = true;
    let shorten = |x: &Vector3| -up * (SPEED * x.z / size.z);
    add(&mut world, model, boundary, fracture, shorten)?;
    let (mut peak, mut when, mut load) = (0.0_f64, 0.0, 0.0);
    // A tenth more compression than at the peak.
    while when == 0.0 || world.time() < 1.1 * when {
        world.step()?;
        load = [0, 1]
            .iter()
            .filter_map(|w| world.wall_load(*w))
            .map(|l| l.total.force.norm())
            .sum::<f64>()
            / (2.0 * size.x * size.y);
        if load > peak {
            peak = load;
            when = world.time();
        }
        if load < 0.1 * peak && peak > 0.5 * compressive(confinement) {
            break;
        }
    }
    Ok(Block {
        strength: peak / compressive(confinement),
        held: load / peak,
        books: world.ledger().error_relative(),
    })
}
