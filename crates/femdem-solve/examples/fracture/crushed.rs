//! Irregular grains crushed between two plates: the sizes of their pieces.

use super::grain::{Press, Pressed};
use super::setting::{DENSITY, facets};
use femdem_analysis::{Fragment, FragmentExtent, measure_fragments};
use femdem_mesh::{Point3, TetMesh};
use std::collections::BTreeMap;
use std::error::Error;

/// A grain that gave way.
#[derive(Clone, Debug)]
pub struct Crushed {
    /// Load over the square of the distance of the plates, Pa: at the first crack, and the largest.
    pub first: f64,
    pub strength: f64,
    /// Way of the plates over their distance.
    pub shortening: f64,
    /// Sieve sizes of its pieces over its own, masses, kg, and tetrahedra.
    pub pieces: Vec<(f64, f64, usize)>,
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
    let whole = pieces(&pressed)?[0].0;
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
    let found = pieces(&pressed)?;
    Ok(Crushed {
        first,
        strength,
        shortening: pressed.shortening(),
        pieces: found.iter().map(|p| (p.0 / whole, p.1, p.2)).collect(),
        height,
        books: pressed.world.ledger().error_relative(),
    })
}

/// Sieve size, m, mass, kg, and tetrahedra of each piece, as they were without loads.
fn pieces(pressed: &Pressed) -> Result<Vec<(f64, f64, usize)>, Box<dyn Error>> {
    let mut found = Vec::new();
    for id in pressed.world.deformable_ids() {
        let own = pressed.world.deformable(id).ok_or("no body")?;
        let (model, cracks) = (own.model(), own.cracks().ok_or("it cannot break")?);
        let tets = model.mesh().tets();
        let mut parts = cracks.fragments();
        parts.resize(tets.len(), 0);
        let mut pieces: BTreeMap<u32, (f64, usize, Vec<Point3>)> = BTreeMap::new();
        for ((part, tet), volume) in parts.iter().zip(tets).zip(model.volumes()) {
            let piece = pieces.entry(*part).or_default();
            piece.0 += volume;
            piece.1 += 1;
            piece
                .2
                .extend(tet.map(|n| Point3::from(model.nodes()[n as usize])));
        }
        for (volume, count, mut points) in pieces.into_values() {
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
            found.push((size, mass, count));
        }
    }
    Ok(found)
}
