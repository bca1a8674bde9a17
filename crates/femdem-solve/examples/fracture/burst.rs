//! A bar stretched fast, which comes into many pieces: their mean length against that of one-dimensional calculations.

use super::setting::{DENSITY, POISSON, TENSILE, YOUNG, add, model, rock, shaken, world};
use femdem_fem::{Boundary, Drive, Selection};
use femdem_mesh::Vector3;
use femdem_solve::Fragments;
use std::error::Error;

/// Energy of fracture, J/m².
const ENERGY: f64 = 10.0;

/// Fragments that the formula gives for a bar, and cells in the length of one.
const COUNT: f64 = 15.0;

/// How much the strength of nodes differs: a hundredth, without which all fail at once.
const SCATTER: f64 = 0.01;

/// What came out.
pub struct Burst {
    /// Mean length of the pieces over E G/f², and that of the formula.
    pub length: f64,
    pub formula: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// The mean length of fragments over s = E G/f² at a rate over r = c f³/(E² G), with c = √(E/ρ): of F. Zhou, J.-F. Molinari
/// and K. T. Ramesh, Int. J. Fract. 139 (2006) 169-196, for calculations of bars in one dimension, as the public code DynFrag1D has it.
fn formula(rate: f64) -> f64 {
    4.5 / (1.0 + 0.77 * rate.powf(0.25) + 5.4 * rate.powf(0.75))
}

/// Stretches a bar at a rate over that of the formula, with cells by the length of a fragment.
pub fn stretch(rate: f64, cells: u32, seed: f64) -> Result<Burst, Box<dyn Error>> {
    let unit = YOUNG * ENERGY / TENSILE.powi(2);
    let speed = (YOUNG / DENSITY).sqrt();
    let strain = rate * speed * TENSILE.powi(3) / (YOUNG.powi(2) * ENERGY);
    let expected = formula(rate) * unit;
    let edge = expected / f64::from(cells);
    let size = Vector3::new(COUNT * expected, 2.0 * edge, 2.0 * edge);
    let mesh = shaken([COUNT as u32 * cells, 2, 2], &size, seed)?;
    let model = model(&mesh, YOUNG)?;
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, -0.5), (size.x, 0.5)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (way * strain * size.x),
            start: 0.0,
            end: 1.0,
        };
        boundary.drive(&model, &end, [true, false, false], drive)?;
    }
    let volumes = model.volumes().to_vec();
    let noise = |n: usize| (12.9898 * n as f64 + 37.719 * seed).sin();
    let factors: Vec<f64> = (0..mesh.points().len())
        .map(|n| 1.0 + 0.5 * SCATTER * (1.0 + noise(n)))
        .collect();
    let mut world = world()?;
    let mut fracture = rock(ENERGY)?;
    fracture.fragments = Fragments::Pieces;
    // Under tension along the bar alone, its sides come together.
    let grow = |x: &Vector3| {
        let from = x - size * 0.5;
        Vector3::new(from.x, -POISSON * from.y, -POISSON * from.z) * strain
    };
    let body = add(&mut world, model, boundary, fracture, grow)?;
    world.scale_strength(body, &factors)?;
    // Pieces and the sides of cracks that close pass through each other: with contact a run takes tens of times as long.
    world.set_self_contact(body, false)?;
    // Until fragments of that length are four times as far apart as a crack bears.
    let until = TENSILE / YOUNG / strain + 8.0 * ENERGY / TENSILE / (strain * expected);
    while world.time() < until {
        world.step()?;
    }
    let own = world.deformable(body).ok_or("no body")?;
    let parts = own.cracks().ok_or("no cracks")?.fragments();
    let mut pieces = vec![0.0; parts.iter().max().map_or(1, |m| *m as usize + 1)];
    for (part, volume) in parts.iter().zip(&volumes) {
        pieces[*part as usize] += volume;
    }
    // Chips that are no piece of the bar's length: less than a layer of cells.
    let layer = size.y * size.z * edge;
    let count = pieces.iter().filter(|v| **v >= layer).count().max(1);
    Ok(Burst {
        length: size.x / count as f64 / unit,
        formula: formula(rate),
        books: world.ledger().error_relative(),
    })
}
