//! Many grains: how their strength falls with their size, and into what they break.

use super::crushed::{Crushed, crush as crush_one};
use super::grain::{First, Press, first_crack};
use super::mean::Mean;
use super::print;
use super::scatter::{Line, modulus};
use super::setting::TENSILE;
use super::shape::{ball, grain};
use femdem_analysis::{FragmentationOptions, SizeFit, fragmentation};
use femdem_mesh::TetMesh;
use rayon::prelude::*;
use std::error::Error;
use std::io::Write;
use std::ops::Range;

/// Moduli of Weibull's, and grains of each size.
const MODULI: [(f64, u64); 2] = [(3.0, 100), (8.0, 50)];

/// Sizes over a decade, and the smallest, m.
const SIZES: u64 = 7;
const SMALLEST: f64 = 0.002;

/// The size of the middle, m.
const MIDDLE: f64 = 0.006_324_6;

/// How often waves cross a grain while the way of the plates grows by e.
const CROSSINGS: f64 = 10.0;

/// Grains of the smallest and of the largest size that are pressed slower, too, and how much.
const SLOWER: u64 = 25;
const SLOW: f64 = 3.0;

/// Grains of one shape.
const TWINS: u64 = 300;

/// Largest speed of the plates where grains are crushed, m/s, and how many of them.
const FASTEST: f64 = 1.0;
const CRUSHED: u64 = 3;

/// Presses grains until they crack, by Weibull's modulus: so many of each size, some slower, and many of one shape; or the part of
/// these six that is asked for.
pub fn press(out: &mut impl Write, one: Option<usize>) -> Result<(), Box<dyn Error>> {
    let ball = ball(1, 0.3)?;
    for (k, (modulus, count)) in MODULI.into_iter().enumerate() {
        let grains = Grains {
            ball: &ball,
            mesh: format!("{} tetrahedra", ball.tets().len()),
            count,
            press: Press {
                size: MIDDLE,
                tensile: TENSILE,
                modulus: Some(modulus),
                crossings: CROSSINGS,
                fastest: f64::INFINITY,
            },
            modulus,
        };
        let is_due = |part| one.is_none_or(|one| one == 3 * k + part);
        if is_due(0) {
            grains.of_sizes(out)?;
        }
        if is_due(1) {
            grains.slower(out)?;
        }
        if is_due(2) {
            grains.of_one_shape(out)?;
        }
    }
    Ok(())
}

/// Grains whose strengths scatter with one modulus.
struct Grains<'a> {
    ball: &'a TetMesh,
    mesh: String,
    /// Of each size.
    count: u64,
    /// Those of the middle size.
    press: Press,
    modulus: f64,
}

impl Grains<'_> {
    /// The size of a number, m, and the numbers of its grains.
    fn size(&self, k: u64) -> (f64, Range<u64>) {
        let size = SMALLEST * 10_f64.powf(k as f64 / (SIZES - 1) as f64);
        (size, k * self.count..(k + 1) * self.count)
    }

    fn print(
        &self,
        out: &mut impl Write,
        which: &str,
        values: &[(&str, f64)],
    ) -> Result<(), Box<dyn Error>> {
        let setting = format!("m = {}, {which}", self.modulus);
        print(out, ["grain", &self.mesh, &setting], values)
    }

    /// Their strength by size.
    fn of_sizes(&self, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
        let (mut points, mut groups, mut seen) = (Vec::new(), Vec::new(), Seen::default());
        for k in 0..SIZES {
            let (size, numbers) = self.size(k);
            let press = Press { size, ..self.press };
            let group = cracks(numbers, |number| grain(self.ball, number), press, &mut seen)?;
            points.extend(group.iter().map(|s| [size.ln(), s.ln()]));
            let mean = group.iter().sum::<f64>() / self.count as f64;
            groups.push(group);
            let of_group = modulus(&groups[k as usize..]);
            let values = [("strength", mean), ("modulus", of_group)];
            self.print(out, &format!("{:.1} mm", 1e3 * size), &values)?;
        }
        let line = Line::through(&points);
        let values = [
            ("exponent", line.slope),
            ("interval", line.half),
            ("modulus", modulus(&groups)),
        ];
        self.print(out, "all", &values)?;
        self.print(out, "all", &seen.values())
    }

    /// How much stronger those of the smallest and of the largest size are than at a lower speed.
    fn slower(&self, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
        for k in [0, SIZES - 1] {
            let (size, numbers) = self.size(k);
            let of = |crossings| {
                let numbers = numbers.start..numbers.start + SLOWER;
                let press = Press {
                    size,
                    crossings,
                    ..self.press
                };
                cracks(
                    numbers,
                    |number| grain(self.ball, number),
                    press,
                    &mut Seen::default(),
                )
            };
            let (fast, slow) = (of(CROSSINGS)?, of(SLOW * CROSSINGS)?);
            let mut faster = Mean::default();
            let both = fast.iter().zip(&slow);
            both.for_each(|(fast, slow)| faster.add(fast / slow));
            let values = [("over slow", faster.value()), ("spread", faster.spread())];
            self.print(out, &format!("{:.1} mm, speed", 1e3 * size), &values)?;
        }
        Ok(())
    }

    /// The modulus of their strengths if they differ in nothing but the strengths of their nodes.
    fn of_one_shape(&self, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
        let one = grain(self.ball, 0)?;
        let twins = cracks(
            0..TWINS,
            |_| Ok(one.clone()),
            self.press,
            &mut Seen::default(),
        )?;
        self.print(out, "one shape", &[("modulus", modulus(&[twins]))])
    }
}

/// The strengths at the first crack of grains by their numbers, in their order.
fn cracks(
    numbers: Range<u64>,
    shape: impl Fn(u64) -> Result<TetMesh, Box<dyn Error>> + Sync,
    press: Press,
    seen: &mut Seen,
) -> Result<Vec<f64>, Box<dyn Error>> {
    let one = |number| {
        let first = shape(number).and_then(|unit| first_crack(&unit, number, press));
        first.map_err(|error| error.to_string())
    };
    let found: Result<Vec<First>, String> = numbers.into_par_iter().map(one).collect();
    let found = found?;
    found.iter().for_each(|first| seen.add(first));
    Ok(found.iter().map(|first| first.strength).collect())
}

/// What was seen of first cracks.
#[derive(Default)]
struct Seen {
    place: Mean,
    tension: Mean,
    unbalanced: Mean,
    books: f64,
}

impl Seen {
    fn add(&mut self, first: &First) {
        self.place.add(first.place);
        self.tension.add(f64::from(first.is_tension));
        self.unbalanced.add(first.unbalanced);
        self.books = self.books.max(first.books.abs());
    }

    fn values(&self) -> [(&'static str, f64); 4] {
        [
            ("place", self.place.value()),
            ("tension", self.tension.value()),
            ("unbalanced", self.unbalanced.value()),
            ("books", self.books),
        ]
    }
}

/// Crushes some grains.
pub fn crush(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let ball = ball(1, 0.3)?;
    let press = Press {
        size: MIDDLE,
        tensile: TENSILE,
        modulus: Some(3.0),
        crossings: CROSSINGS,
        fastest: FASTEST,
    };
    let one = |number| {
        let found = grain(&ball, number).and_then(|unit| crush_one(&unit, number, press));
        found.map_err(|error| error.to_string())
    };
    let found: Result<Vec<Crushed>, String> = (0..CRUSHED).into_par_iter().map(one).collect();
    let found = found?;
    let mesh = format!("{} tetrahedra", ball.tets().len());
    for (number, grain) in found.iter().enumerate() {
        let total: f64 = grain.pieces.iter().map(|p| p.mass).sum();
        let largest = grain.pieces.iter().map(|p| p.mass).fold(0.0, f64::max);
        let small = || grain.pieces.iter().filter(|p| p.tets <= 4);
        let values = [
            ("first crack", grain.first),
            ("largest load", grain.strength),
            ("shortening", grain.shortening),
            ("height", grain.height),
            ("pieces", grain.pieces.len() as f64),
            ("largest piece", largest / total),
            ("small pieces", small().count() as f64),
            (
                "mass of those",
                small().map(|p| p.mass).sum::<f64>() / total,
            ),
            ("books", grain.books),
        ];
        print(out, ["crushed", &mesh, &format!("grain {number}")], &values)?;
    }
    let pieces = found.iter().flat_map(|grain| &grain.pieces);
    let pieces: Vec<(f64, f64)> = pieces.map(|p| (p.size, p.mass)).collect();
    let options = FragmentationOptions {
        parent_size: Some(1.0),
        ..FragmentationOptions::default()
    };
    let sizes = fragmentation(&pieces, &options)?;
    let exponent = |fit: Option<SizeFit>| fit.map_or(f64::NAN, |fit| fit.exponent);
    let values = [
        ("t2", sizes.index(2.0).unwrap_or(f64::NAN)),
        ("t10", sizes.index(10.0).unwrap_or(f64::NAN)),
        ("Rosin-Rammler n", exponent(sizes.rosin_rammler)),
        ("Gaudin-Schuhmann m", exponent(sizes.gaudin_schuhmann)),
    ];
    print(out, ["crushed", &mesh, "all"], &values)
}
