//! The double cantilever beam: its arms are pulled apart, and a crack runs along the seam between them.

use super::beam::{Beam, Column, Seen};
use super::course::{Course, Run};
use super::setting::YOUNG;
use femdem_fem::fracture::Strength;
use femdem_mesh::{Point3, Vector3};
use femdem_solve::{Fracture, Fragments};
use std::error::Error;

/// Energy of fracture by opening, J/m², and strength, Pa: the process zone is 8 mm long.
const ENERGY: f64 = 10.0;
const TENSILE: f64 = 5e6;

/// Pressure on the ends of the beam, Pa. The arms are pulled by f √(3 l/h) = 1.5 f at the tip of the notch, so that without it the crack
/// would turn into one of them.
const PRESSURE: f64 = 10e6;

/// Width and height of either arm, m; from the load to the tip of the notch, and to the end of the cells that are fine.
const WIDTH: f64 = 0.002;
const HEIGHT: f64 = 0.01;
const NOTCH: f64 = 0.03;
const FINE: f64 = 0.052;

/// The beam is longer by this before the load, m.
const BEFORE: f64 = 0.002;

/// Speed of either arm, m/s.
const SPEED: f64 = 0.03;

/// How far beyond the notch the seam is broken when the crack is taken to run steadily, and at the end, m.
const STEADY: f64 = 0.003;
const END: f64 = 0.008;

/// Time in which that has to be, s.
const LIMIT: f64 = 3e-3;

/// J/m² of a cantilever: I = b h³/12, w = P a³/(3 E I), J = P² a²/(b E I) with the length a from the first.
fn of_beam(seen: &Seen) -> f64 {
    let bending = YOUNG * WIDTH * HEIGHT.powi(3) / 12.0;
    let length = (3.0 * bending * seen.way / seen.force).cbrt();
    (seen.force * length).powi(2) / (WIDTH * bending)
}

/// Opens a beam with cells of an edge along the seam, m.
pub fn open(fine: f64, rough: bool) -> Result<Run, Box<dyn Error>> {
    let [tip, end] = [NOTCH, FINE].map(|x| BEFORE + x);
    let stops = [
        (BEFORE, BEFORE),
        (tip - 0.0015, 0.002),
        (tip, fine),
        (end, fine),
        (0.075, 0.002),
    ];
    let beam = Beam::new([WIDTH, HEIGHT], &stops, tip, fine, rough);
    let arm = |above: bool| Column {
        plane: beam.plane(BEFORE),
        halves: [above, !above],
        speed: if above { SPEED } else { -SPEED },
    };
    let columns = [arm(true), arm(false)];
    let driven = columns.each_ref().map(|column| beam.driven(column));
    let mut fracture = Fracture::new(
        Strength::new(TENSILE, 4.0 * TENSILE, 0.6)?,
        [ENERGY, 5.0 * ENERGY],
    );
    fracture.fragments = Fragments::Pieces;
    // The mean height is of all cells, which are fine where cracks may be.
    fracture.coarse = true;
    // A cantilever whose end moves.
    let swing = |p: &Point3, above: bool| {
        let s = ((p.x - BEFORE) / NOTCH).min(1.0);
        let way = 1.0 - 1.5 * s + 0.5 * s.powi(3);
        Vector3::z() * if above { SPEED * way } else { -SPEED * way }
    };
    let started = beam.start(&driven, fracture, PRESSURE, swing)?;
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
