//! A disc pressed across its diameter (the Brazilian test): it splits where the tension at its centre reaches the strength.

use super::setting::{TENSILE, YOUNG, add, facets, mean_angle, model, noise, rock_of, world};
use femdem_contact::BodyId;
use femdem_fem::{Boundary, Curve, DeformableModel, Selection};
use femdem_mesh::{Point3, TetMesh, Vector3};
use femdem_solve::{CrackFacet, World};
use std::error::Error;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Diameter, m.
const DIAMETER: f64 = 0.05;

/// Thickness, m.
const THICKNESS: f64 = 0.006;

/// Half the angle over which each jaw presses.
const SPREAD: f64 = TAU / 48.0;

/// Until then the load grows to 0.85 of the one that reaches the strength, s.
const RISE: f64 = 4e-4;

/// After that it grows by this part of that load in a second, by half a hundredth while a wave crosses the disc.
const RATE: f64 = 300.0;

/// For this long, s.
const LAST: f64 = 5e-3;

/// What came out; loads are over the one whose tension at the centre is the strength.
pub struct Disc {
    pub tets: usize,
    /// Diameter over the length of the process zone.
    pub zones: f64,
    /// Load at the first crack away from the jaws, within 0.9 of the radius.
    pub first: f64,
    /// Distance of that crack from the centre, and from the loaded diameter, over the radius.
    pub place: [f64; 2],
    /// Load when it gives way.
    pub peak: f64,
    /// Area of the facets that are broken then, as seen across the loaded diameter, over that of the section.
    pub broken: f64,
    /// Mean angle of its facets to the loaded diameter then, degrees.
    pub angle: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// The pressure whose tension at the centre is the strength, Pa: σ = 2 p (sin 2α − α)/π for a pressure over angles up to α from
/// the loaded diameter (G. Hondros, Aust. J. Appl. Sci. 10 (1959) 243-268), which is 2 P/(π D L) for a small α.
fn pressure() -> f64 {
    0.5 * PI * TENSILE / ((2.0 * SPREAD).sin() - SPREAD)
}

/// The pressure over time: a half wave of a cosine, then a slow line.
fn course() -> Curve {
    let early = (0..=20).map(|k| f64::from(k) / 20.0);
    let early = early.map(|t| [t * RISE, 0.85 * 0.5 * (1.0 - (PI * t).cos())]);
    let late = [RISE + LAST, 0.85 + RATE * LAST];
    let points: Vec<_> = early.chain([late]).collect();
    Curve::factors(pressure(), &points)
}

/// The load at a time.
fn load(time: f64) -> f64 {
    course().at(time) / pressure()
}

/// A disc of an even number of cells across, its axis along y, its centre at the origin: the rings of a square grid made round,
/// turned so that the loaded diameter, along z, is no plane of the mesh, and moved by up to a fifth of an edge inside.
fn disc(cells: u32) -> Result<TetMesh, Box<dyn Error>> {
    let half = cells / 2;
    let edge = DIAMETER / f64::from(cells);
    let layers = (THICKNESS / edge).round() as u32;
    let turn = TAU / f64::from(4 * cells) * f64::from(cells * 2 / 9);
    let mut points = Vec::new();
    for n in 0..(cells + 1) * (layers + 1) * (cells + 1) {
        let [i, j, k] = [
            n % (cells + 1),
            n / (cells + 1) % (layers + 1),
            n / ((cells + 1) * (layers + 1)),
        ];
        let [u, v] = [i, k].map(|at| f64::from(at) - f64::from(half));
        let ring = u.abs().max(v.abs());
        let angle = if u.abs() > v.abs() {
            FRAC_PI_4 * v / u + if u < 0.0 { PI } else { 0.0 }
        } else if ring > 0.0 {
            2.0 * FRAC_PI_4 - FRAC_PI_4 * u / v + if v < 0.0 { PI } else { 0.0 }
        } else {
            0.0
        };
        let (sin, cos) = (angle + turn).sin_cos();
        let y = THICKNESS * (f64::from(j) / f64::from(layers) - 0.5);
        let mut point = Point3::new(edge * ring * cos, y, edge * ring * sin);
        let is_free = [
            ring < f64::from(half),
            j > 0 && j < layers,
            ring < f64::from(half),
        ];
        for axis in (0..3).filter(|axis| is_free[*axis]) {
            point[axis] += 0.2 * edge * noise(n as usize, axis, 1.0);
        }
        points.push(point);
    }
    let quarter = TetMesh::block([half, layers, half], &Vector3::repeat(1.0))?;
    let mut tets = Vec::new();
    for [x, z] in [[false, false], [true, false], [true, true], [false, true]] {
        let at = |n: u32| {
            let [i, j, k] = [
                n % (half + 1),
                n / (half + 1) % (layers + 1),
                n / ((half + 1) * (layers + 1)),
            ];
            let [i, k] =
                [(i, x), (k, z)].map(|(at, back)| if back { half - at } else { half + at });
            i + (cells + 1) * (j + (layers + 1) * k)
        };
        tets.extend(quarter.tets().iter().map(|tet| {
            let [a, b, c, d] = tet.map(at);
            // A mirror turns elements inside out.
            if x == z { [a, b, c, d] } else { [a, b, d, c] }
        }));
    }
    Ok(TetMesh::new(points, tets)?)
}

/// The nodes under the lower jaw and under the upper one.
fn jaws(model: &DeformableModel) -> [Vec<u32>; 2] {
    [-1.0, 1.0].map(|way| {
        let nodes = (0_u32..).zip(model.nodes()).filter(|(_, x)| {
            let is_rim = x.x.hypot(x.z) > 0.5 * DIAMETER * (1.0 - 1e-9);
            is_rim && x.x.atan2(way * x.z).abs() < SPREAD * (1.0 + 1e-9)
        });
        nodes.map(|(n, _)| n).collect()
    })
}

/// Mean height of the nodes under the upper jaw over that of those under the lower one, m.
fn height(world: &World, body: BodyId, jaws: &[Vec<u32>; 2]) -> f64 {
    let places = world.deformable(body).map_or(&[][..], |b| b.positions());
    let mean = |nodes: &Vec<u32>| {
        let sum: f64 = nodes.iter().map(|n| places[*n as usize].z).sum();
        sum / nodes.len() as f64
    };
    mean(&jaws[1]) - mean(&jaws[0])
}

/// Presses a disc of so many cells across until it gives way: until it is half as much shorter again as an elastic one. Its energies
/// of fracture are by opening and by sliding, J/m².
pub fn split(cells: u32, energies: [f64; 2]) -> Result<Disc, Box<dyn Error>> {
    let mesh = disc(cells)?;
    let model = model(&mesh, YOUNG)?;
    let jaws = jaws(&model);
    let mut boundary = Boundary::default();
    for nodes in &jaws {
        boundary.press(&model, &Selection::Nodes(nodes.clone()), course())?;
    }
    let mut world = world()?;
    let mut fracture = rock_of(energies)?;
    fracture.coarse = true;
    let zones = DIAMETER / fracture.process_zone(YOUNG);
    let body = add(&mut world, model, boundary, fracture, |_| Vector3::zeros())?;
    // Nothing presses the halves on each other.
    world.set_self_contact(body, false)?;
    let mut first = None;
    let whole = height(&world, body, &jaws);
    // Shortening by a load of 1.
    let mut elastic = f64::INFINITY;
    loop {
        world.step()?;
        let load = load(world.time());
        let shorter = whole - height(&world, body, &jaws);
        if world.time() < RISE {
            elastic = shorter / load;
        } else if shorter > 1.5 * elastic * load {
            break;
        } else if world.time() > RISE + LAST {
            return Err("the disc holds".into());
        }
        if first.is_none() {
            first = facets(&world, body).iter().find_map(|f| {
                let centre = (f.corners[0] + f.corners[1] + f.corners[2]) / 3.0;
                let away = [centre.x.hypot(centre.z), centre.x.abs()];
                let away = away.map(|a| a / (0.5 * DIAMETER));
                (away[0] < 0.9).then_some((load, away))
            });
        }
    }
    let (first, place) = first.ok_or("no crack")?;
    let cracks = facets(&world, body);
    // Across the loaded diameter.
    let area = |f: &CrackFacet| {
        let [a, b, c] = f.place;
        0.5 * (b - a).cross(&(c - a)).x.abs()
    };
    let broken: f64 = cracks.iter().filter(|f| f.end.is_some()).map(area).sum();
    Ok(Disc {
        tets: mesh.tets().len(),
        zones,
        first,
        place,
        peak: load(world.time()),
        broken: broken / (DIAMETER * THICKNESS),
        angle: 90.0 - mean_angle(&cracks, &Vector3::z()),
        books: world.ledger().error_relative(),
    })
}
