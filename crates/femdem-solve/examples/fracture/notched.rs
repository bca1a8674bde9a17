//! Beams on three points with a notch under the load, through which a crack runs freely.

use super::plate::{Plate, Running, Solid};
use super::setting::facets;
use femdem_fem::fracture::Strength;
use femdem_fem::{Boundary, DeformableModel, Drive, Selection};
use femdem_mesh::Vector3;
use femdem_solve::{Fracture, Fragments};
use std::error::Error;

/// Most that cells grow from one to the next, away from the crack.
const GROWTH: f64 = 1.3;

/// Cells on either side of the notch's plane that are fine.
const SIDE: f64 = 6.0;

/// A beam of height W on supports S apart, with a notch a, m.
pub struct Notched {
    pub height: f64,
    pub span: f64,
    pub notch: f64,
    pub solid: Solid,
    /// Energy of fracture, J/m², and strength in tension, Pa; that in shear is three times as high.
    pub energy: f64,
    pub tensile: f64,
    /// Edge of the fine cells, and how far beyond the notch they go, m.
    pub fine: f64,
    pub reach: f64,
    /// Speed of the load, m/s, and local damping.
    pub speed: f64,
    pub local_damping: f64,
    /// The load over the largest at which the run ends.
    pub end: f64,
}

/// The mean of a load over periods of a beam, in which it vibrates after each cell that cracks.
struct Load {
    period: f64,
    sum: f64,
    time: f64,
}

impl Load {
    /// Adds a load that has acted for a time; the mean where a period is over.
    fn add(&mut self, load: f64, time: f64) -> Option<f64> {
        self.sum += load * time;
        self.time += time;
        if self.time < self.period {
            return None;
        }
        let mean = self.sum / self.time;
        (self.sum, self.time) = (0.0, 0.0);
        Some(mean)
    }
}

/// A brittle beam: 20 lengths of its process zone high.
pub const ROCK: Notched = Notched {
    height: 0.1,
    span: 0.4,
    notch: 0.05,
    solid: Solid {
        young: 20e9,
        poisson: 0.2,
        density: 2500.0,
    },
    energy: 6.25,
    tensile: 5e6,
    fine: 0.9e-3,
    reach: 0.015,
    speed: 2e-3,
    local_damping: 0.1,
    end: 0.9,
};

/// The beam of P.-E. Petersson (Crack growth and development of fracture zones in plain concrete, Lund 1981), half a process zone high.
pub const CONCRETE: Notched = Notched {
    height: 0.2,
    span: 2.0,
    notch: 0.1,
    solid: Solid {
        young: 30e9,
        poisson: 0.2,
        density: 2400.0,
    },
    energy: 137.0,
    tensile: 3.3e6,
    fine: 20e-3,
    reach: 0.1,
    speed: 5e-3,
    local_damping: 0.1,
    end: 0.02,
};

/// What came out.
pub struct Bent {
    pub tets: usize,
    /// Largest load by width, its mean over a period of the beam, N/m, and opening of the notch's mouth then, m.
    pub peak: f64,
    pub mouth: f64,
    /// Energy that cracks have taken over G (W - a), and work of the load over the same.
    pub taken: f64,
    pub work: f64,
    pub books: f64,
}

/// Places away from a centre up to a limit, fine within a reach, m.
pub fn away(limit: f64, fine: f64, reach: f64) -> Vec<f64> {
    let (mut all, mut edge) = (vec![0.0], fine);
    loop {
        let last = all[all.len() - 1];
        if last >= reach {
            edge *= GROWTH;
        }
        if limit - last < 1.6 * edge {
            all.push(limit);
            return all;
        }
        all.push(last + edge);
    }
}

/// Places on both sides of a centre.
pub fn around(centre: f64, below: &[f64], above: &[f64]) -> Vec<f64> {
    let low = below.iter().skip(1).rev().map(|d| centre - d);
    low.chain(above.iter().map(|d| centre + d)).collect()
}

impl Notched {
    /// The load by width that linear elastic fracture mechanics gives, N/m: K B W^(3/2)/(S f(a/W)) with K = √(E G) (ASTM E399,
    /// S = 4 W).
    pub fn brittle(&self) -> f64 {
        let a = self.notch / self.height;
        let shape = 3.0 * a.sqrt() * (1.99 - a * (1.0 - a) * (2.15 - 3.93 * a + 2.7 * a * a))
            / (2.0 * (1.0 + 2.0 * a) * (1.0 - a).powf(1.5));
        let toughness = (self.solid.young * self.energy).sqrt();
        toughness * self.height.powf(1.5) / (self.span * shape)
    }

    /// Length beyond either support, m.
    fn beyond(&self) -> f64 {
        0.05 * self.span
    }

    fn plate(&self) -> Plate {
        let half = 0.5 * self.span;
        let along = {
            let mut side = away(half, self.fine, SIDE * self.fine);
            side.push(half + self.beyond());
            around(half + self.beyond(), &side, &side)
        };
        let low = away(self.notch, self.fine, SIDE * self.fine);
        let high = away(self.height - self.notch, self.fine, self.reach);
        let across = around(self.notch, &low, &high);
        let mut plate = Plate::new(
            [across, along],
            [self.notch, half + self.beyond()],
            self.fine,
        );
        plate.is_strain = false;
        plate
    }

    /// The nodes nearest to a place of the plane, through the thickness.
    fn at(model: &DeformableModel, place: [f64; 2]) -> Vec<u32> {
        let gap = |p: &Vector3| (p.x - place[0]).hypot(p.y - place[1]);
        let least = model.nodes().iter().map(gap).fold(f64::MAX, f64::min);
        let nodes = (0..).zip(model.nodes());
        let near = nodes.filter(|(_, p)| gap(p) < least + 1e-9);
        near.map(|(n, _)| n).collect()
    }

    /// Holds the supports, drives the load; the velocities are those of an elastic beam.
    fn load(
        &self,
        model: &DeformableModel,
        boundary: &mut Boundary,
    ) -> Result<Vec<Vector3>, Box<dyn Error>> {
        let ends = self.supports(model);
        boundary.drive(
            model,
            &Selection::Nodes(ends.clone()),
            [true, false, false],
            Drive::Fixed,
        )?;
        let half = 0.5 * self.span;
        let top = Self::at(model, [self.height, half + self.beyond()]);
        let drive = Drive::Linear {
            velocity: -Vector3::x() * self.speed,
            start: 0.0,
            end: f64::MAX,
        };
        let top = Selection::Nodes(top);
        boundary.drive(model, &top, [true, false, false], drive)?;
        boundary.drive(model, &top, [false, true, false], Drive::Fixed)?;
        let sag = |p: &Vector3| {
            let s = (half - (p.y - half - self.beyond()).abs()) / self.span;
            -Vector3::x() * (self.speed * (3.0 * s - 4.0 * s.powi(3)))
        };
        Ok(model.nodes().iter().map(sag).collect())
    }

    fn supports(&self, model: &DeformableModel) -> Vec<u32> {
        let places = [self.beyond(), self.beyond() + self.span];
        places
            .iter()
            .flat_map(|y| Self::at(model, [0.0, *y]))
            .collect()
    }

    /// Bends it until the load has fallen.
    pub fn bend(&self) -> Result<Bent, Box<dyn Error>> {
        let strength = Strength::new(self.tensile, 3.0 * self.tensile, 0.0)?;
        let mut fracture = Fracture::new(strength, [self.energy; 2]);
        fracture.fragments = Fragments::Pieces;
        // The mean height is of all cells, which are fine where the crack is.
        fracture.coarse = true;
        let plate = self.plate();
        let width = plate.thickness;
        let Running {
            mut world,
            body,
            tets,
        } = plate.start(
            self.solid,
            fracture,
            self.local_damping,
            |model, boundary| self.load(model, boundary),
        )?;
        let model = world.deformable(body).ok_or("no body")?.model().clone();
        let (ends, mouth) = (
            self.supports(&model),
            Self::at(&model, [0.0, 0.5 * self.span + self.beyond()]),
        );
        let (mut peak, mut opening, mut work) = (0.0_f64, 0.0, 0.0);
        let mut mean = Load {
            period: self.period(),
            sum: 0.0,
            time: 0.0,
        };
        loop {
            let from = world.time();
            world.step()?;
            let own = world.deformable(body).ok_or("no body")?;
            let force = |n: &u32| own.internal_forces()[*n as usize].x;
            let load = ends.iter().map(force).sum::<f64>().abs() / width;
            let time = world.time() - from;
            work += load * self.speed * time;
            let Some(load) = mean.add(load, time) else {
                continue;
            };
            if load > peak {
                peak = load;
                let places = mouth.iter().map(|n| own.positions()[*n as usize].y);
                let sides = places.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
                opening = sides.1 - sides.0;
            }
            if load < self.end * peak {
                break;
            }
        }
        let whole = self.energy * (self.height - self.notch);
        let taken: f64 = facets(&world, body).iter().map(|f| f.taken).sum();
        Ok(Bent {
            tets,
            peak,
            mouth: opening,
            taken: taken / (whole * width),
            work: work / whole,
            books: world.ledger().error_relative(),
        })
    }

    /// The period of the slowest vibration of a slender beam, s: 2 S² √(12 ρ/E)/(π W).
    fn period(&self) -> f64 {
        let slow = (12.0 * self.solid.density / self.solid.young).sqrt();
        2.0 * self.span.powi(2) * slow / (std::f64::consts::PI * self.height)
    }
}
