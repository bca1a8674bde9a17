//! A notched beam on two rollers under a third: the load that it bears by linear fracture mechanics.

use super::beam::Beam;
use super::setting::YOUNG;
use femdem_fem::fracture::Strength;
use femdem_mesh::{Point3, Vector3};
use femdem_solve::{Fracture, Fragments};
use std::error::Error;

/// Energy of fracture by opening, J/m², and strength, Pa: the process zone is 0.8 mm long.
const ENERGY: f64 = 10.0;
const TENSILE: f64 = 16e6;

/// Thickness B, height W, length of the notch, and half the span, m; how much longer the beam is at either end.
const THICKNESS: f64 = 0.0006;
const HEIGHT: f64 = 0.02;
const NOTCH: f64 = 0.01;
const HALF: f64 = 0.04;
const BEYOND: f64 = 0.004;

/// Speed of the middle roller, m/s.
const SPEED: f64 = 0.04;

/// Steps over which the load is the mean.
const LOOK: u32 = 50;

/// What came out.
pub struct Notched {
    pub tets: usize,
    /// Largest load over that of linear fracture mechanics.
    pub strength: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// The load at which K = P S/(B W^1.5) f(a/W) is √(E G) (ASTM E399, S = 4 W), N.
fn load() -> f64 {
    let a = NOTCH / HEIGHT;
    let shape = 3.0 * a.sqrt() * (1.99 - a * (1.0 - a) * (2.15 - 3.93 * a + 2.7 * a * a))
        / (2.0 * (1.0 + 2.0 * a) * (1.0 - a).powf(1.5));
    (YOUNG * ENERGY).sqrt() * THICKNESS * HEIGHT.powf(1.5) / (2.0 * HALF * shape)
}

/// Bends a beam with cells of an edge ahead of the notch, m.
pub fn bend(fine: f64) -> Result<Notched, Box<dyn Error>> {
    let stops = [
        (NOTCH - 0.003, 0.002),
        (NOTCH - 0.0006, 0.0006),
        (NOTCH, fine),
        (NOTCH + 0.0024, fine),
        (NOTCH + 0.006, 0.0006),
        (HEIGHT, 0.002),
    ];
    let beam = Beam::new([THICKNESS, HALF + BEYOND], &stops, NOTCH, fine, true);
    let driven = [
        beam.line(HEIGHT, 0.0, -SPEED),
        beam.line(0.0, HALF, 0.0),
        beam.line(0.0, -HALF, 0.0),
    ];
    let mut fracture = Fracture::new(
        Strength::new(TENSILE, 4.0 * TENSILE, 0.6)?,
        [ENERGY, 5.0 * ENERGY],
    );
    fracture.fragments = Fragments::Pieces;
    // The mean height is of all cells, which are fine where cracks may be.
    fracture.coarse = true;
    // The rollers do not crush it.
    let factor = |p: &Point3| {
        let is_held = p.x > 0.8 * HEIGHT || p.z.abs() > 0.5 * HALF;
        if is_held { 10.0 } else { 1.0 }
    };
    // Two halves that turn about the rollers, with a beam's bending.
    let swing = |p: &Point3, _: bool| {
        let s = 1.0 - (p.z.abs() / HALF);
        Vector3::x() * (-SPEED * (1.5 * s - 0.5 * s.powi(3)))
    };
    let (mut world, body, tets) = beam.start(&driven, fracture, 0.0, factor, swing)?;
    let (mut peak, mut force) = (0.0_f64, f64::INFINITY);
    while force > 0.5 * peak || peak < 0.3 * load() {
        // The mean over some steps: vibrations.
        let mut sum = 0.0;
        for _ in 0..LOOK {
            world.step()?;
            let own = world.deformable(body).ok_or("no body")?;
            let nodes = driven[0].nodes.iter();
            sum += nodes
                .map(|n| own.internal_forces()[*n as usize].x)
                .sum::<f64>();
        }
        force = sum / f64::from(LOOK);
        peak = peak.max(force);
        if world.time() > 5e-3 {
            return Err("the beam does not break".into());
        }
    }
    Ok(Notched {
        tets,
        strength: peak / load(),
        books: world.ledger().error_relative(),
    })
}
