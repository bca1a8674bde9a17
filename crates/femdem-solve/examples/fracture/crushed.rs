//! Irregular grains crushed between two plates: the sizes of their pieces.

use super::grain::{Press, Pressed};
use super::setting::{DENSITY, facets};
use femdem_analysis::{Fragment, FragmentExtent, measure_fragments};
use femdem_mesh::{Point3, TetMesh};
use std::collections::BTreeMap;
use std::error::Error;

/// A piece.
pub struct Piece {
    /// Sieve size over that of the grain, and mass, kg.
    pub size: f64,
    pub mass: f64,
    pub tets: usize,
}

/// A grain that gave way.
pub struct Crushed {
    /// Load over the square of the distance of the plates, Pa: at the first crack, and the largest.
    pub first: f64,
    pub strength: f64,
    /// Way of the plates over their distance.
    pub shortening: f64,
    pub pieces: Vec<Piece>,
    /// Mean height of its elements over the largest with which cracks take the energy given.
    pub height: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// Presses a grain until its load has fallen to a half after it cracked.
pub fn crush(unit: &TetMesh, number: u64, press: Press) -> Result<Crushed, Box<dyn Error>> {
    let mut pressed = press.start(unit, number)?;
    let own = pressed.world.deformable(pressed.body).ok_or("no body")?;
    let cracks = own.cracks().ok_or("it cannot break")?;
    let height = cracks.element_height() / cracks.largest_height();
    let whole = pieces(&pressed, 1.0)?[0].size;
    let (mut first, mut strength) = (0.0, 0.0_f64);
    loop {
        pressed.step()?;
        pressed.world.fragment_bodies()?;
        let loads = pressed.loads();
        let load = 0.5 * (loads[0] + loads[1]);
        strength = strength.max(load);
        if first == 0.0 {
            if !facets(&pressed.world, pressed.body).is_empty() {
                first = load;
            }
        } else if load < 0.5 * strength {
            break;
        }
    }
    Ok(Crushed {
        first,
        strength,
        shortening: pressed.shortening(),
        pieces: pieces(&pressed, whole)?,
        height,
        books: pressed.world.ledger().error_relative(),
    })
}

/// The pieces, as they were without loads, for a grain of a sieve size, m.
fn pieces(pressed: &Pressed, whole: f64) -> Result<Vec<Piece>, Box<dyn Error>> {
    let mut found = Vec::new();
    for id in pressed.world.deformable_ids() {
        let own = pressed.world.deformable(id).ok_or("no body")?;
        let (model, cracks) = (own.model(), own.cracks().ok_or("it cannot break")?);
        let tets = model.mesh().tets();
        let mut parts = cracks.fragments();
        parts.resize(tets.len(), 0);
        let mut all: BTreeMap<u32, (f64, usize, Vec<Point3>)> = BTreeMap::new();
        for ((part, tet), volume) in parts.iter().zip(tets).zip(model.volumes()) {
            let piece = all.entry(*part).or_default();
            piece.0 += volume;
            piece.1 += 1;
            piece
                .2
                .extend(tet.map(|n| Point3::from(model.nodes()[n as usize])));
        }
        for (volume, tets, mut points) in all.into_values() {
            points.sort_by(|a, b| {
                a.x.total_cmp(&b.x)
                    .then(a.y.total_cmp(&b.y))
                    .then(a.z.total_cmp(&b.z))
            });
            points.dedup();
            let mass = volume * DENSITY;
            let fragment = Fragment {
                volume,
                mass,
                area: None,
                extent: FragmentExtent::Points(&points),
            };
            let size = measure_fragments(&[fragment])?.fragments[0].sieve_size();
            found.push(Piece {
                size: size / whole,
                mass,
                tets,
            });
        }
    }
    Ok(found)
}
