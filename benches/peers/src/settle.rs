//! The job of every engine, and how long it takes.

use crate::clock::thread_time;
use anyhow::{Result, ensure};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Polyhedron, Pose};
use femdem_pack::{Container, PackShape, PackSpec, Penalty, Protocol, Release};

/// Circumscribed diameter d of the bodies, m.
pub const DIAMETER: f64 = 0.02;

/// Inner width of the box over d.
const WIDTH: f64 = 6.0;

/// All bodies at once, 5 x 5 to a layer.
pub const PROTOCOL: Protocol = Protocol::Release(Release {
    spacing: SPACING,
    per_layer: Some([5, 5]),
});

/// Lattice spacing over d.
const SPACING: f64 = 1.05;

/// Largest kinetic energy of a body at rest, over m g d.
const REST: f64 = 1e-6;

/// Checks in a row that must find all bodies at rest: together one sqrt(d/g).
const LOOKS: u32 = 10;

/// Time between two checks, in sqrt(d/g).
const BETWEEN_LOOKS: f64 = 0.1;

/// An engine that has not come to rest by then is stopped, in sqrt(d/g) after the time of fall.
const LONGEST: f64 = 60.0;

/// A simulation of the job, by any engine.
pub trait Engine {
    /// Name and settings.
    fn name(&self) -> String;

    /// Continues to a simulated time, s, or just past it.
    fn advance(&mut self, until: f64) -> Result<()>;

    /// Simulated time, s.
    fn time(&self) -> f64;

    /// Steps taken.
    fn steps(&self) -> u64;

    /// Largest kinetic energy of a body over m g d.
    fn kinetic_energy(&self) -> f64;

    /// Poses of the bodies: coordinates of the shape to the world's.
    fn poses(&self) -> Result<Vec<Pose>>;
}

/// Cost of bringing the bodies to rest.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cost {
    /// Processor time from the release on, s.
    pub processor: f64,
    /// Simulated time from the release on, s.
    pub simulated: f64,
    /// Whether all bodies came to rest.
    pub rests: bool,
}

impl Cost {
    /// Processor seconds per simulated second.
    pub fn ratio(&self) -> f64 {
        self.processor / self.simulated
    }
}

/// The job: `count` bodies of one shape, released at once.
pub fn spec(shape: &str, count: u32, penetration: f64, seed: u64) -> Result<PackSpec> {
    let polyhedron = shape.parse::<CatalogueShape>()?.polyhedron(DIAMETER)?;
    let width = WIDTH * DIAMETER;
    Ok(PackSpec {
        shapes: vec![PackShape::new(shape, polyhedron)],
        count,
        seed,
        friction: 0.6,
        penalty: Penalty::Automatic { penetration },
        container: Container::Box {
            width,
            depth: width,
        },
        protocol: PROTOCOL,
        ..PackSpec::default()
    })
}

/// The surface of the one shape of a job.
pub fn surface(spec: &PackSpec) -> Result<&Polyhedron> {
    ensure!(spec.shapes.len() == 1, "the job is for one shape");
    Ok(&spec.shapes[0].polyhedron)
}

/// An engine on its way to rest.
struct Run {
    engine: Box<dyn Engine>,
    cost: Cost,
    looks: u32,
}

/// Lets all engines bring their bodies to rest, in turns of a slice of simulated time each, so that other work
/// on the machine slows all of them alike.
pub fn settle(
    spec: &PackSpec,
    engines: Vec<Box<dyn Engine>>,
) -> Result<Vec<(Box<dyn Engine>, Cost)>> {
    let unit = (spec.diameter() / spec.gravity).sqrt();
    let layers = f64::from(spec.count.div_ceil(25));
    let fall = (2.0 * SPACING * layers * spec.diameter() / spec.gravity).sqrt();
    let mut runs: Vec<Run> = engines
        .into_iter()
        .map(|engine| Run {
            engine,
            cost: Cost::default(),
            looks: 0,
        })
        .collect();
    let mut until = 0.0;
    while until < fall + LONGEST * unit && runs.iter().any(|run| !run.cost.rests) {
        until += BETWEEN_LOOKS * unit;
        for run in runs.iter_mut().filter(|run| !run.cost.rests) {
            let before = thread_time()?;
            run.engine.advance(until)?;
            run.cost.processor += thread_time()? - before;
            run.cost.simulated = run.engine.time();
            let is_calm = until > fall && run.engine.kinetic_energy() < REST;
            run.looks = if is_calm { run.looks + 1 } else { 0 };
            run.cost.rests = run.looks >= LOOKS;
        }
    }
    Ok(runs.into_iter().map(|run| (run.engine, run.cost)).collect())
}
