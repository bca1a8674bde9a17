//! A plate of glass under sudden tension across its notch: the crack runs, and branches.

use super::plate::{Plate, Solid, direction};
use femdem_fem::fracture::Strength;
use femdem_fem::{Curve, Selection};
use femdem_mesh::Vector3;
use femdem_solve::{CrackFacet, Fracture, Fragments};
use std::error::Error;

const GLASS: Solid = Solid {
    young: 32e9,
    poisson: 0.2,
    density: 2450.0,
};

/// Energy of fracture, J/m², strength in tension, and in shear, Pa.
const ENERGY: f64 = 3.0;
const TENSILE: f64 = 4.5e6;
const SHEAR: f64 = 13.5e6;

/// Speed of Rayleigh waves, m/s.
const RAYLEIGH: f64 = 2125.0;

/// Plate and notch, m.
const LENGTH: f64 = 0.1;
const WIDTH: f64 = 0.04;

/// Tension on the long sides, Pa, and the time for which it pulls, s.
const PULL: f64 = 1e6;
const UNTIL: f64 = 80e-6;

/// Distance of two branches from the line of the notch at which they are seen as such, m, and length over which a speed is taken, m.
const APART: f64 = 0.002;
const SPAN: f64 = 0.01;

/// What came out.
pub struct Branched {
    pub tets: usize,
    /// When the crack began to run, s.
    pub start: f64,
    /// Largest mean speed of its tip over a centimetre, over that of Rayleigh waves.
    pub speed: f64,
    /// Energy that is taken by cracks, by length of thickness, J/m.
    pub taken: f64,
    pub fork: Option<Fork>,
    pub books: f64,
}

/// Two branches of a crack.
pub struct Fork {
    /// When and where along x they were first apart, s, m.
    pub time: f64,
    pub place: f64,
    /// The angle between them, degrees.
    pub angle: f64,
}

/// The largest mean speed of the tip over a centimetre, m/s.
fn fastest(broken: &[(f64, Vector3, CrackFacet)]) -> f64 {
    let mut tips: Vec<(f64, f64)> = Vec::new();
    for (time, centre, _) in broken {
        if tips.last().is_none_or(|(_, x)| centre.x > *x) {
            tips.push((*time, centre.x));
        }
    }
    let mut fastest = 0.0_f64;
    for (k, (time, x)) in tips.iter().enumerate() {
        if let Some((later, ahead)) = tips[k..].iter().find(|(_, ahead)| ahead - x >= SPAN) {
            fastest = fastest.max((ahead - x) / (later - time));
        }
    }
    fastest
}

/// Pulls a plate of cells of an edge, m.
pub fn branch(edge: f64) -> Result<Branched, Box<dyn Error>> {
    let middle = 0.5 * WIDTH;
    let plate = Plate::even([LENGTH, WIDTH], [0.5 * LENGTH, middle], edge);
    let strength = Strength::new(TENSILE, SHEAR, 0.0)?;
    let mut fracture = Fracture::new(strength, [ENERGY, ENERGY]);
    fracture.fragments = Fragments::Pieces;
    let mut cracked = plate.start(GLASS, fracture, 0.0, |model, boundary| {
        for (offset, way) in [(0.0, -1.0), (WIDTH, 1.0)] {
            let side = Selection::Plane {
                normal: Vector3::y(),
                offset,
                tolerance: 1e-9,
            };
            let pull = Vector3::y() * (way * PULL);
            boundary.pull(model, &side, pull, Curve::Constant(1.0))?;
        }
        Ok(vec![Vector3::zeros(); model.nodes().len()])
    })?;
    cracked.until(UNTIL)?;
    let broken = cracked.broken();
    let first = broken.first().map_or(f64::NAN, |b| b.0);
    Ok(Branched {
        tets: cracked.tets,
        start: first,
        speed: fastest(&broken) / RAYLEIGH,
        taken: broken.iter().map(|b| b.2.taken).sum::<f64>() / edge,
        fork: fork(&broken, middle),
        books: cracked.world.ledger().error_relative(),
    })
}

/// The branches of a crack along a line, if there are facets away from it on both sides.
fn fork(broken: &[(f64, Vector3, CrackFacet)], line: f64) -> Option<Fork> {
    let side = |way: f64| {
        let all = broken.iter();
        all.filter(move |(_, c, _)| way * (c.y - line) > APART)
    };
    let (up, down) = (side(1.0).next()?, side(-1.0).next()?);
    let last = if up.0 > down.0 { up } else { down };
    let [above, below] = [1.0, -1.0].map(|way| direction(side(way).map(|(_, c, f)| (*c, f.taken))));
    Some(Fork {
        time: last.0,
        place: last.1.x,
        angle: above - below,
    })
}
