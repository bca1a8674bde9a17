//! A plate of steel struck beside its notch (Kalthoff and Winkler): the crack turns away from the notch.

use super::plate::{Plate, Solid, direction};
use femdem_fem::fracture::Strength;
use femdem_fem::{Drive, Selection};
use femdem_mesh::Vector3;
use femdem_solve::{Fracture, Fragments};
use std::error::Error;

const STEEL: Solid = Solid {
    young: 190e9,
    poisson: 0.3,
    density: 8000.0,
};

/// Energy of fracture, J/m², strength in tension, and cohesion, Pa.
const ENERGY: f64 = 22_130.0;
const TENSILE: f64 = 844e6;
const COHESION: f64 = 2600e6;

/// Speed of Rayleigh waves, m/s.
const RAYLEIGH: f64 = 2800.0;

/// Half of the plate, m: y is 0 in its plane of symmetry; length and place of the notch.
const SIZE: [f64; 2] = [0.1, 0.1];
const NOTCH: [f64; 2] = [0.05, 0.025];

/// Speed of the struck side, m/s, and end of the run, s.
const SPEED: f64 = 16.5;
const UNTIL: f64 = 90e-6;

/// Cracks within this of the tip of the notch are not of a direction yet, m.
const NEAR: f64 = 0.004;

/// What came out.
pub struct Struck {
    pub tets: usize,
    /// When the crack began to run, s.
    pub start: f64,
    /// Angle to the notch, degrees: of all of the crack, and of the line from the tip of the notch to its farthest facet.
    pub angle: f64,
    pub chord: f64,
    /// How far that is, m, and the mean speed on the way over that of Rayleigh waves.
    pub length: f64,
    pub speed: f64,
    pub books: f64,
}

/// Strikes a plate of cells of an edge, m.
pub fn strike(edge: f64) -> Result<Struck, Box<dyn Error>> {
    let plate = Plate::even(SIZE, NOTCH, edge);
    let strength = Strength::new(TENSILE, COHESION, 0.0)?;
    let mut fracture = Fracture::new(strength, [ENERGY, ENERGY]);
    fracture.fragments = Fragments::Pieces;
    let mut cracked = plate.start(STEEL, fracture, 0.0, |model, boundary| {
        let plane = Selection::Plane {
            normal: Vector3::y(),
            offset: 0.0,
            tolerance: 1e-9,
        };
        boundary.drive(model, &plane, [false, true, false], Drive::Fixed)?;
        // The nodes of the notch's mouth are two at one place: only that below it is struck.
        let mouth = NOTCH[1] - 0.5 * edge;
        let is_struck = |x: &Vector3| x.x < 1e-9 && x.y < mouth;
        let nodes = model.nodes().iter().enumerate();
        let struck = nodes.filter(|(_, x)| is_struck(x)).map(|(n, _)| n as u32);
        let drive = Drive::Linear {
            velocity: Vector3::x() * SPEED,
            start: 0.0,
            end: 1.0,
        };
        let side = Selection::Nodes(struck.collect());
        boundary.drive(model, &side, [true, false, false], drive)?;
        Ok(vec![Vector3::zeros(); model.nodes().len()])
    })?;
    cracked.until(UNTIL)?;
    let broken = cracked.broken();
    let tip = Vector3::new(NOTCH[0], NOTCH[1], 0.0);
    let away = |c: &Vector3| (c - tip).xy().norm();
    let ahead = |c: &Vector3| c.y > tip.y && away(c) < 0.06;
    let crack = broken.iter().filter(|b| ahead(&b.1));
    let first = crack.clone().next().map_or(f64::NAN, |b| b.0);
    let far = crack
        .clone()
        .max_by(|a, b| away(&a.1).total_cmp(&away(&b.1)));
    let (end, last) = far.map_or((f64::NAN, tip), |b| (b.0, b.1));
    let run = crack.filter(|b| away(&b.1) > NEAR);
    let length = away(&last);
    Ok(Struck {
        tets: cracked.tets,
        start: first,
        angle: direction(run.map(|(_, c, f)| (*c, f.taken))),
        chord: (last.y - tip.y).atan2(last.x - tip.x).to_degrees(),
        length,
        speed: length / (end - first) / RAYLEIGH,
        books: cracked.world.ledger().error_relative(),
    })
}
