//! Rock-like boulders.

use super::family::family;
use super::random::Random;
use super::weld::centred;
use crate::{MeshError, Point3, Polyhedron, Vector3, convex_hull};
use std::f64::consts::{PI, TAU};

/// No triangle of a boulder has an altitude below this part of its size.
pub const BOULDER_SMALLEST_ALTITUDE: f64 = 0.05;

/// Attempts with fresh points before giving up. The first one nearly always does.
const ATTEMPTS: u32 = 64;
/// Number of trial points, of which the one farthest from the others is used.
const TRIALS: usize = 8;

family! {
    /// A rock-like boulder: the convex hull of random points in an ellipsoidal shell.
    ///
    /// The size determines the volume and, with the density, the mass: [`size_for_mass`](Self::size_for_mass).
    /// Along x, y and z the extents are long, intermediate and short, exactly in the given ratios (T. Zingg's
    /// two ratios, Schweiz. Mineral. Petrogr. Mitt. 15 (1935) 39-140).
    ///
    /// More `angularity` means fewer points (96 at 0, 16 at 1) with more scatter in depth (none at 0,
    /// 45 % of the radius at 1), so fewer and larger faces with sharper edges. Points that would make
    /// slivers are dropped: no triangle of the surface has an altitude (nor an edge) of less than
    /// [`BOULDER_SMALLEST_ALTITUDE`] sizes. The same seed gives the same bits.
    Boulder = "boulder", "rock-like boulder, convex hull of random points",
    size: "the diameter of the sphere of the same volume" {
        /// Number of the random body; any.
        seed: u64 = 1, in 0, u64::MAX;
        /// From rounded to sharp.
        angularity: f64 = 0.5, in 0.0, 1.0;
        /// Intermediate over long extent.
        elongation: f64 = 0.8, in 0.4, 1.0;
        /// Short over intermediate extent.
        flatness: f64 = 0.8, in 0.4, 1.0;
    }
}

impl Boulder {
    /// The size \[m\] of a boulder of a mass \[kg\] and a density \[kg/m^3\].
    ///
    /// # Errors
    ///
    /// If the mass or the density is not positive and finite.
    pub fn size_for_mass(mass: f64, density: f64) -> Result<f64, MeshError> {
        for (what, value) in [
            ("the mass of a boulder", mass),
            ("the density of a boulder", density),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(MeshError::OutOfRange {
                    what,
                    value,
                    allowed: "a positive, finite number",
                });
            }
        }
        Ok((6.0 * mass / (PI * density)).cbrt())
    }

    fn build(&self) -> Result<Polyhedron, MeshError> {
        let mut random = Random::new(self.seed);
        for _ in 0..ATTEMPTS {
            let points = self.cloud(&mut random);
            if let Some(body) = self.without_slivers(points)? {
                return Ok(body);
            }
        }
        Err(MeshError::OutOfRange {
            what: "the seed of a boulder without slivers",
            value: self.seed as f64,
            allowed: "another seed, or less angularity, elongation or flatness",
        })
    }

    /// Random points about the unit sphere, well apart in direction.
    fn cloud(&self, random: &mut Random) -> Vec<Vector3> {
        let count = (96.0 - 80.0 * self.angularity).round() as usize;
        let scatter = 0.45 * self.angularity;
        let mut directions: Vec<Vector3> = Vec::with_capacity(count);
        let mut points = Vec::with_capacity(count);
        while directions.len() < count {
            let mut best = (-1.0, Vector3::z());
            for _ in 0..TRIALS {
                let z = 2.0 * random.uniform() - 1.0;
                let (sin, cos) = (TAU * random.uniform()).sin_cos();
                let across = (1.0 - z * z).max(0.0).sqrt();
                let trial = Vector3::new(across * cos, across * sin, z);
                let nearest = directions
                    .iter()
                    .map(|d| (d - trial).norm())
                    .fold(f64::INFINITY, f64::min);
                if nearest > best.0 {
                    best = (nearest, trial);
                }
            }
            directions.push(best.1);
            points.push(best.1 * (1.0 - scatter * random.uniform()));
        }
        points
    }

    /// The hull of the points, scaled to its extents and its volume, after dropping points until the smallest
    /// altitude is met; none if too few points remain.
    fn without_slivers(&self, mut points: Vec<Vector3>) -> Result<Option<Polyhedron>, MeshError> {
        loop {
            let body = self.scaled_hull(&points)?;
            let Some(corner) = corner_of_worst_triangle(&body) else {
                return Ok(Some(body));
            };
            // The hull keeps the vertices, not the points inside: continue with the vertices.
            points = body.vertices().iter().map(|v| v.coords).collect();
            points.remove(corner);
            if points.len() < 8 {
                return Ok(None);
            }
        }
    }

    fn scaled_hull(&self, points: &[Vector3]) -> Result<Polyhedron, MeshError> {
        let (mut low, mut high) = (points[0], points[0]);
        for p in points {
            (low, high) = (low.inf(p), high.sup(p));
        }
        let short = self.elongation * self.flatness;
        let wanted = Vector3::new(1.0, self.elongation, short);
        let stretch = wanted.component_div(&(high - low));
        let stretched: Vec<Point3> = points
            .iter()
            .map(|p| Point3::from(p.component_mul(&stretch)))
            .collect();
        let body = convex_hull(&stretched)?;
        let factor = (PI / 6.0 / body.mass_properties().volume).cbrt();
        centred(&body.scaled(factor)?)
    }
}

/// The corner opposite the longest edge of the triangle with the smallest altitude, if that is too small.
fn corner_of_worst_triangle(body: &Polyhedron) -> Option<usize> {
    let mut worst = (BOULDER_SMALLEST_ALTITUDE, None);
    for triangle in body.triangles() {
        let [a, b, c] = triangle.map(|i| body.vertices()[i as usize]);
        let twice_area = (b - a).cross(&(c - a)).norm();
        let edges = [(c - b).norm(), (a - c).norm(), (b - a).norm()];
        for (corner, edge) in triangle.into_iter().zip(edges) {
            let altitude = twice_area / edge;
            if altitude < worst.0 {
                worst = (altitude, Some(corner as usize));
            }
        }
    }
    worst.1
}
