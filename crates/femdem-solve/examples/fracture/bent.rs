//! The end-loaded split: a notched cantilever is bent at its end, its halves slide on each other, and a crack runs along the seam
//! between them. Two supports hold it, so that all is as in the end-notched beam on three, whose crack would run faster than slow
//! loads follow.

use super::beam::{Beam, Column, Seen};
use super::course::{Course, Run};
use super::setting::YOUNG;
use femdem_fem::fracture::Strength;
use femdem_mesh::{Point3, Vector3};
use femdem_solve::{Fracture, Fragments};
use std::error::Error;

/// Energy of fracture by sliding, J/m², a fifth of it by opening. Shear strength, Pa, and tensile strength: the seam fails by
/// shear, the same under any pressure; E G/c² is 7 mm.
const ENERGY: f64 = 50.0;
const COHESION: f64 = 12e6;
const TENSILE: f64 = 40e6;

/// Width and height of either half, m; lengths from the load to the first support and on to the second, and from the load to the tip
/// of the notch.
const WIDTH: f64 = 0.002;
const HEIGHT: f64 = 0.005;
const SPAN: f64 = 0.04;
const HOLD: f64 = 0.01;
const NOTCH: f64 = 0.024;

/// The beam is longer by this at either end, m.
const BEFORE: f64 = 0.002;

/// Speed of the end, m/s.
const SPEED: f64 = 0.1;

/// How far beyond the notch the seam is broken when the crack is taken to run steadily, and at the end, m.
const STEADY: f64 = 0.002;
const END: f64 = 0.006;

/// Time in which that has to be, s.
const LIMIT: f64 = 5e-3;

/// J/m² of beams: w = P (3 a³ + L³ + L² H)/(2 E b h³), J = 9 P² a²/(4 E b² h³) with the length a from the first.
fn of_beam(seen: &Seen) -> f64 {
    let stiff = 2.0 * YOUNG * WIDTH * HEIGHT.powi(3);
    let cubed = (stiff * seen.way / seen.force - SPAN.powi(2) * (SPAN + HOLD)) / 3.0;
    let length = cubed.max(0.0).cbrt();
    9.0 * (seen.force * length).powi(2) / (4.0 * YOUNG * WIDTH.powi(2) * HEIGHT.powi(3))
}

/// Bends a beam with cells of an edge along the seam, m.
pub fn bend(fine: f64) -> Result<Run, Box<dyn Error>> {
    let tip = BEFORE + NOTCH;
    let middle = BEFORE + SPAN;
    let stops = [
        (BEFORE, BEFORE),
        (tip - 0.0015, 0.002),
        (tip, fine),
        (middle, fine),
        (middle + HOLD, 0.001),
        (middle + HOLD + BEFORE, BEFORE),
    ];
    let beam = Beam::new([WIDTH, HEIGHT], &stops, tip, fine, false);
    let support = |x: f64, speed: f64| Column {
        plane: beam.plane(x),
        halves: [true, true],
        speed,
    };
    let columns = [
        support(BEFORE, SPEED),
        support(middle, 0.0),
        support(middle + HOLD, 0.0),
    ];
    let driven = columns.each_ref().map(|column| beam.driven(column));
    let mut fracture = Fracture::new(
        Strength::new(TENSILE, COHESION, 0.0)?,
        [0.2 * ENERGY, ENERGY],
    );
    fracture.fragments = Fragments::Pieces;
    // The mean height is of all cells, which are fine where cracks may be.
    fracture.coarse = true;
    // A cantilever whose end moves.
    let swing = |p: &Point3, _: bool| {
        let s = ((p.x - BEFORE) / SPAN).min(1.0);
        Vector3::z() * (SPEED * (1.0 - 1.5 * s + 0.5 * s.powi(3)))
    };
    let started = beam.start(&driven, fracture, 0.0, swing)?;
    let course = Course {
        columns: &columns,
        tip,
        energy: ENERGY,
        of_beam,
        steady: STEADY,
        end: END,
        limit: LIMIT,
    };
    course.follow(&beam, started)
}
