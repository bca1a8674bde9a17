//! One level layer of cells, and what is spread over it.

use std::ops::Range;

use femdem_mesh::{Matrix3, Point3, Vector3};

use super::Tensor;
use super::kernel::Lucy;
use crate::coordination::Partner;
use crate::network::ForceNetwork;

/// A body as a source of fields.
struct Source {
    centre: Point3,
    volume: f64,
    mass: f64,
    velocity: Vector3,
    /// Sum of n n over its contacts.
    normals: Matrix3,
}

/// A line from a body's centre to a contact point.
struct Line {
    start: Point3,
    along: Vector3,
    /// −f (p − x) (N m).
    moment: Matrix3,
}

/// Bodies and lines, and the function that spreads them.
pub(super) struct Sources {
    bodies: Vec<Source>,
    lines: Vec<Line>,
    lucy: Lucy,
}

/// Bodies and lines that reach a layer, ascending.
#[derive(Clone, Default)]
pub(super) struct Reaching {
    bodies: Vec<usize>,
    lines: Vec<usize>,
}

impl Sources {
    pub(super) fn new(
        network: &ForceNetwork,
        masses: &[f64],
        velocities: &[Vector3],
        lucy: Lucy,
    ) -> Self {
        let mut bodies: Vec<Source> = network
            .bodies()
            .iter()
            .enumerate()
            .map(|(i, body)| Source {
                centre: body.centre,
                volume: body.volume,
                // Without a list their fields are not told.
                mass: masses.get(i).copied().unwrap_or(0.0),
                velocity: velocities.get(i).copied().unwrap_or_default(),
                normals: Matrix3::zeros(),
            })
            .collect();
        for contact in network.touching_contacts() {
            let normals = contact.normal * contact.normal.transpose();
            bodies[contact.first as usize].normals += normals;
            if let Partner::Body(second) = contact.second {
                bodies[second as usize].normals += normals;
            }
        }
        let lines = network.loads().map(|load| {
            let start = network.centre(load.body);
            let along = load.contact.point - start;
            Line {
                start,
                along,
                moment: -load.force * along.transpose(),
            }
        });
        Self {
            lines: lines.collect(),
            bodies,
            lucy,
        }
    }

    /// What reaches each of the layers, whose heights ascend.
    pub(super) fn by_layer(&self, count: usize, height: impl Fn(usize) -> f64) -> Vec<Reaching> {
        let heights: Vec<f64> = (0..count).map(height).collect();
        let between = |low: f64, high: f64| {
            let first = heights.partition_point(|z| *z <= low - self.lucy.radius);
            first..heights.partition_point(|z| *z < high + self.lucy.radius)
        };
        let mut lists = vec![Reaching::default(); count];
        for (i, body) in self.bodies.iter().enumerate() {
            let layers = between(body.centre.z, body.centre.z);
            lists[layers]
                .iter_mut()
                .for_each(|list| list.bodies.push(i));
        }
        for (i, line) in self.lines.iter().enumerate() {
            let ends = [line.start.z, line.start.z + line.along.z];
            let layers = between(ends[0].min(ends[1]), ends[0].max(ends[1]));
            lists[layers].iter_mut().for_each(|list| list.lines.push(i));
        }
        lists
    }
}

/// A layer of cells; one value per cell, x running fastest.
pub(super) struct Layer {
    origin: Point3,
    spacing: f64,
    counts: [usize; 2],
    z: f64,
    pub(super) solid: Vec<f64>,
    pub(super) mass: Vec<f64>,
    pub(super) momentum: Vec<[f64; 3]>,
    /// Sum of m v v.
    flux: Vec<Tensor>,
    pub(super) stress: Vec<Tensor>,
    pub(super) fabric: Vec<Tensor>,
}

impl Layer {
    pub(super) fn new(origin: Point3, spacing: f64, counts: [usize; 2], z: f64) -> Self {
        let cells = counts[0] * counts[1];
        Self {
            origin,
            spacing,
            counts,
            z,
            solid: vec![0.0; cells],
            mass: vec![0.0; cells],
            momentum: vec![[0.0; 3]; cells],
            flux: vec![[0.0; 9]; cells],
            stress: vec![[0.0; 9]; cells],
            fabric: vec![[0.0; 9]; cells],
        }
    }

    pub(super) fn add(&mut self, sources: &Sources, reaching: &Reaching) {
        let lucy = &sources.lucy;
        for body in reaching.bodies.iter().map(|&i| &sources.bodies[i]) {
            let momentum = body.velocity * body.mass;
            let flux = momentum * body.velocity.transpose();
            let normals = body.normals * body.volume;
            for (cell, at) in self.cells(&body.centre, &body.centre, lucy.radius) {
                let value = lucy.at((at - body.centre).norm_squared());
                self.solid[cell] += value * body.volume;
                self.mass[cell] += value * body.mass;
                (0..3).for_each(|k| self.momentum[cell][k] += value * momentum[k]);
                add(&mut self.flux[cell], &flux, value);
                add(&mut self.fabric[cell], &normals, value);
            }
        }
        for line in reaching.lines.iter().map(|&i| &sources.lines[i]) {
            let end = line.start + line.along;
            let (low, high) = (line.start.inf(&end), line.start.sup(&end));
            for (cell, at) in self.cells(&low, &high, lucy.radius) {
                let value = lucy.along(&line.start, &line.along, &at);
                add(&mut self.stress[cell], &line.moment, value);
            }
        }
    }

    /// The cells whose centre is within `radius` of a box in plan, with their centres.
    fn cells(
        &self,
        low: &Point3,
        high: &Point3,
        radius: f64,
    ) -> impl Iterator<Item = (usize, Point3)> + use<> {
        let range = |k: usize| -> Range<usize> {
            let place = |x: f64| (x - self.origin[k]) / self.spacing - 0.5;
            // Conversion to usize saturates: what lies before the first cell becomes 0.
            let first = place(low[k] - radius).ceil() as usize;
            let end = (place(high[k] + radius).floor() + 1.0) as usize;
            first..end.min(self.counts[k])
        };
        let (xs, ys) = (range(0), range(1));
        let (origin, spacing, width, z) = (self.origin, self.spacing, self.counts[0], self.z);
        let centre = move |k: usize, i: usize| origin[k] + (i as f64 + 0.5) * spacing;
        ys.flat_map(move |j| {
            xs.clone()
                .map(move |i| (j * width + i, Point3::new(centre(0, i), centre(1, j), z)))
        })
    }

    /// Momentum over mass.
    pub(super) fn velocity(&self) -> impl Iterator<Item = [f64; 3]> {
        let cells = self.mass.iter().zip(&self.momentum);
        cells.map(|(mass, momentum)| momentum.map(|p| if *mass > 0.0 { p / mass } else { 0.0 }))
    }

    /// Σ m v v φ − ρ V V, which is the stress of the motion about V.
    pub(super) fn kinetic_stress(&self) -> impl Iterator<Item = Tensor> {
        let cells = self.flux.iter().zip(&self.momentum).zip(self.velocity());
        cells.map(|((flux, momentum), velocity)| {
            let mut rest = *flux;
            for (k, rest) in rest.iter_mut().enumerate() {
                *rest -= momentum[k / 3] * velocity[k % 3];
            }
            rest
        })
    }
}

/// Adds `value` times a tensor.
fn add(sum: &mut Tensor, tensor: &Matrix3, value: f64) {
    for (k, sum) in sum.iter_mut().enumerate() {
        *sum += value * tensor[(k / 3, k % 3)];
    }
}
