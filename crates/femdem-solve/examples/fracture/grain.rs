//! Irregular grains between two plates: their strength falls with their size as that of their weakest places.

use super::setting::{DENSITY, SLOPE, YOUNG, add, facets, model, world};
use femdem_contact::{BodyId, Partner, Wall};
use femdem_fem::fracture::{FractureMode, Strength, Weibull};
use femdem_fem::{Boundary, Driven};
use femdem_mesh::{Point3, TetMesh, Vector3};
use femdem_solve::{Fracture, SolveError, World};
use std::error::Error;

/// Distance of the plates over the process zone E G/f².
const ZONES: f64 = 10.0;

/// The volume to which the strength belongs, m³.
const VOLUME: f64 = 1e-7;

/// What the way of the plates over their distance is multiplied with.
const WAY: f64 = 1e-4;

/// How a grain is pressed.
#[derive(Clone, Copy)]
pub struct Press {
    /// Distance of the plates, m.
    pub size: f64,
    /// Strength in tension of 1e-7 m³, Pa; four times as much is the cohesion.
    pub tensile: f64,
    /// Modulus of its scatter after Weibull, if it scatters.
    pub modulus: Option<f64>,
    /// Times that a wave crosses the grain while the way of the plates grows by e, so that load grows at one rate over load
    /// wherever the grain cracks: way = WAY d (exp(t/τ) − 1), up to the largest speed.
    pub crossings: f64,
    /// Largest speed of the upper plate, m/s.
    pub fastest: f64,
}

/// A grain between plates.
pub struct Pressed {
    pub world: World,
    pub body: BodyId,
    pub press: Press,
    /// Height of the lower plate, m.
    low: f64,
}

impl Press {
    /// Puts a grain of width 1 between the plates; its number draws the strengths.
    pub fn start(self, unit: &TetMesh, number: u64) -> Result<Pressed, Box<dyn Error>> {
        let Self { size, tensile, .. } = self;
        let points: Vec<Point3> = unit.points().iter().map(|p| p * size).collect();
        let low = points.iter().map(|p| p.z).fold(f64::MAX, f64::min);
        let mesh = TetMesh::new(points, unit.tets().to_vec())?;
        let model = model(&mesh, YOUNG)?;
        let mut world = world()?;
        let up = Vector3::z();
        world.add_wall(Wall::half_space("anvil", up, low)?, Default::default())?;
        let platen = Wall::half_space("platen", -up, -low - size)?;
        let platen = world.add_wall(platen, Default::default())?;
        let strength = Strength::new(tensile, 4.0 * tensile, SLOPE.atan())?;
        let energy = size * tensile.powi(2) / (ZONES * YOUNG);
        let mut fracture = Fracture::new(strength, [energy, 5.0 * energy]);
        fracture.coarse = true;
        if let Some(modulus) = self.modulus {
            fracture.scatter = Some(Weibull::new(modulus, VOLUME, number)?);
        }
        let boundary = Boundary::default();
        let body = add(&mut world, model, boundary, fracture, |_| Vector3::zeros())?;
        world.drive_wall_by_host(platen, self.driven(0.0))?;
        Ok(Pressed {
            world,
            body,
            press: self,
            low,
        })
    }

    /// Where the upper plate is at a time, s.
    fn driven(&self, time: f64) -> Driven {
        let constant = self.crossings * self.size / (YOUNG / DENSITY).sqrt();
        let start = WAY * self.size / constant;
        let fastest = constant * (self.fastest / start).ln();
        let growth = time.min(fastest) / constant;
        let speed = start * growth.exp();
        let way = start * constant * growth.exp_m1() + speed * (time - fastest).max(0.0);
        Driven {
            displacement: Vector3::z() * -way,
            velocity: Vector3::z() * -speed,
            ..Driven::default()
        }
    }
}

impl Pressed {
    pub fn step(&mut self) -> Result<(), SolveError> {
        let press = self.press;
        let mut host = |_: Partner, time: f64| Some(press.driven(time));
        self.world.step_with(&mut host)
    }

    /// Way of the plates over their distance.
    pub fn shortening(&self) -> f64 {
        let driven = self.press.driven(self.world.time());
        driven.displacement.norm() / self.press.size
    }

    /// The loads on both plates over the square of their distance at first, Pa.
    pub fn loads(&self) -> [f64; 2] {
        let load = |w| {
            self.world
                .wall_load(w)
                .map_or(0.0, |l| l.total.force.norm())
        };
        [0, 1].map(|w| load(w) / self.press.size.powi(2))
    }
}

/// The first crack of a grain.
#[derive(Clone, Copy, Debug)]
pub struct First {
    /// Load over the square of the distance of the plates, Pa.
    pub strength: f64,
    /// Its distance from the nearer plate over that of both.
    pub place: f64,
    pub is_tension: bool,
    /// Difference of the loads of the plates over their mean.
    pub unbalanced: f64,
    /// Relative error of the ledger.
    pub books: f64,
}

/// Presses a grain until it cracks.
pub fn first_crack(unit: &TetMesh, number: u64, press: Press) -> Result<First, Box<dyn Error>> {
    let mut pressed = press.start(unit, number)?;
    loop {
        let loads = pressed.loads();
        pressed.step()?;
        let cracks = facets(&pressed.world, pressed.body);
        let Some(first) = cracks.first() else {
            continue;
        };
        let strength = 0.5 * (loads[0] + loads[1]);
        let height = first.place.iter().map(|c| c.z).sum::<f64>() / 3.0;
        let height = (height - pressed.low) / press.size;
        return Ok(First {
            strength,
            place: height.min(1.0 - height),
            is_tension: first.mode == FractureMode::Tension,
            unbalanced: (loads[0] - loads[1]).abs() / strength,
            books: pressed.world.ledger().error_relative(),
        });
    }
}
