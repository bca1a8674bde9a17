//! Radial distribution function of the bodies' centroids, with exact volumes of shells in a box.

use std::f64::consts::PI;

use femdem_mesh::Point3;
use femdem_mesh::bvh::{Aabb, Bvh};
use serde::{Deserialize, Serialize};

use crate::ball::volume_in_ball;
use crate::blocks::Blocks;
use crate::bootstrap::BlockBootstrap;
use crate::bounds::Bounds;
use crate::clip::Clipper;
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::region::Region;
use crate::table::{Cell, Table};

/// Largest number of bins.
const MOST_BINS: f64 = 10_000.0;

/// Shortest and longest distances (m) whose cubes neither vanish nor overflow.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-90..=1e90;

/// How [`radial_distribution`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RadialOptions {
    /// Width of a bin over the mean diameter; above 0. Default 0.05. It is changed so that a whole number of bins fits.
    pub width_over_d: f64,
    /// Largest distance over the mean diameter; above 0. Default 5.
    pub reach_over_d: f64,
    /// How the errors are computed: from blocks of bodies.
    pub bootstrap: BlockBootstrap,
}

impl Default for RadialOptions {
    fn default() -> Self {
        Self {
            width_over_d: 0.05,
            reach_over_d: 5.0,
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// One bin of a radial distribution function. Where few pairs are expected, the value is mostly noise, and its
/// standard error, computed from few pairs, is of no help: see [`is_rare`](Self::is_rare).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialBin {
    /// Where the bin begins (m).
    pub low: f64,
    /// Where it ends (m).
    pub high: f64,
    /// Radial distribution function: pairs over the pairs expected for random points; 0 where the box has no
    /// room for any.
    pub value: f64,
    /// Standard error by block bootstrap; `None` with fewer than four blocks.
    pub standard_error: Option<f64>,
    /// Pairs of bodies with a distance in the bin.
    pub pairs: u64,
    /// Pairs expected for as many random points in the box.
    pub expected: f64,
}

impl RadialBin {
    /// Smallest number of expected pairs of a bin whose value is worth drawing.
    pub const LEAST_EXPECTED: f64 = 5.0;

    /// Whether fewer than [`LEAST_EXPECTED`](Self::LEAST_EXPECTED) pairs are expected. Such bins stay in the
    /// table, marked by 1 in the column `rare`, so that their pairs are not lost; leave them out of plots.
    pub fn is_rare(&self) -> bool {
        // Also true if the number is not one.
        self.expected.is_nan() || self.expected < Self::LEAST_EXPECTED
    }
}

/// Radial distribution function. As a [`Table`] one row per bin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialDistribution {
    /// The box measured.
    pub region: Region,
    /// Bodies with their centroid in it.
    pub bodies: usize,
    /// Their number density (1/m³).
    pub number_density: f64,
    /// The bins from distance 0 on, in order and without gaps.
    pub bins: Vec<RadialBin>,
}

/// Radial distribution function of the centroids in a box.
///
/// About every body the volume of each spherical shell inside the box is computed in closed form, so that
/// bodies at faces, edges and corners count like all others and none is left out: with `n_i` the others in the
/// shell and `V_i` its volume in the box, `g = Σ n_i / (ρ Σ V_i)`, `ρ = (N - 1)/V`. Random points give 1 at
/// every distance. Near walls bodies are layered: pass a core to measure the bulk.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// let shapes = ["P5".parse::<CatalogueShape>()?.polyhedron(1.0)?];
/// let at = |x| PosedBody { shape: 0, pose: Pose::translation(x, 0.0, 0.0) };
/// let bodies = [at(-1.0), at(1.0)];
/// let region = Region::Box { min: Point3::from([-3.0; 3]), max: Point3::from([3.0; 3]) };
/// let found = radial_distribution(&Pack::new(&shapes, &bodies)?, &region, &RadialOptions::default())?;
/// let peak: Vec<f64> = found.bins.iter().filter(|b| b.pairs > 0).map(|b| b.low).collect();
/// assert!((peak[0] - 2.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a region that is
/// not a box, [`AnalysisError::TooFewBodies`] for fewer than two in it, [`AnalysisError::Option`], also for
/// more than 10,000 bins and for lengths beyond 1e-90 to 1e90 m.
pub fn radial_distribution(
    pack: &Pack,
    region: &Region,
    options: &RadialOptions,
) -> Result<RadialDistribution, AnalysisError> {
    region.validate()?;
    let diameter = pack.mean_diameter()?;
    let blocks = Blocks::over(region, diameter, options.bootstrap)?;
    let Region::Box { min, max } = *region else {
        return Err(AnalysisError::RegionKind {
            what: "a radial distribution function",
            instead: "a box",
        });
    };
    let bins = options.bins(diameter)?;
    let width = options.reach_over_d * diameter / bins as f64;
    let centroids = pack.centroids();
    let points: Vec<Point3> = centroids
        .into_iter()
        .filter(|c| region.contains(c))
        .collect();
    if points.len() < 2 {
        return Err(AnalysisError::TooFewBodies {
            bodies: points.len(),
            least: 2,
        });
    }
    let density = (points.len() - 1) as f64 / region.volume();
    let around = shells(&points, &Bounds { min, max }, width, bins);
    let found = ordered_map(
        bins,
        || (),
        |(), k| {
            let pairs: u64 = around.iter().map(|shells| u64::from(shells[k].0)).sum();
            let expected: f64 = around.iter().map(|shells| density * shells[k].1).sum();
            let items = points.iter().zip(&around);
            let (value, standard_error) = blocks
                .ratio(items.map(|(point, shells)| {
                    (*point, f64::from(shells[k].0), density * shells[k].1)
                }));
            RadialBin {
                low: width * k as f64,
                high: width * (k + 1) as f64,
                value,
                standard_error,
                // Each pair was counted from both ends.
                pairs: pairs / 2,
                expected: expected / 2.0,
            }
        },
    );
    Ok(RadialDistribution {
        region: *region,
        bodies: points.len(),
        number_density: points.len() as f64 / region.volume(),
        bins: found,
    })
}

/// For every point the number of others in each shell about it, and the shell's volume in the box.
fn shells(points: &[Point3], bounds: &Bounds, width: f64, bins: usize) -> Vec<Vec<(u32, f64)>> {
    let boxes: Vec<Aabb> = points.iter().map(|p| Aabb::of_points([*p])).collect();
    let tree = Bvh::new(&boxes);
    let reach = width * bins as f64;
    ordered_map(points.len(), Clipper::default, |clipper, i| {
        let mut found = vec![(0, 0.0); bins];
        tree.query(&boxes[i].grown(reach), |j| {
            let distance = (points[j as usize] - points[i]).norm();
            if j as usize != i
                && let Some(shell) = found.get_mut((distance / width) as usize)
            {
                shell.0 += 1;
            }
        });
        let mut inner = 0.0;
        for (k, shell) in found.iter_mut().enumerate() {
            let outer = ball_in_box(clipper, &points[i], width * (k + 1) as f64, bounds);
            shell.1 = (outer - inner).max(0.0);
            inner = outer;
        }
        found
    })
}

/// Volume (m³) of the part of a ball inside a box that contains its centre.
fn ball_in_box(clipper: &mut Clipper, centre: &Point3, radius: f64, bounds: &Bounds) -> f64 {
    let [low, high] = [centre - bounds.min, bounds.max - centre];
    let farthest = low.sup(&high).norm();
    if farthest <= radius {
        return (bounds.max - bounds.min).product();
    }
    // Distances of the nearer faces: if their edges are out of reach, so are all others, and the parts beyond
    // the faces are caps without overlap.
    let near = low.inf(&high);
    let edge = (0..3)
        .map(|k| near[k].hypot(near[(k + 1) % 3]))
        .fold(f64::INFINITY, f64::min);
    if edge >= radius {
        let beyond = low.iter().chain(high.iter()).map(|h| {
            let depth = (radius - h).max(0.0);
            PI * depth * depth * (3.0 * radius - depth) / 3.0
        });
        return 4.0 / 3.0 * PI * radius.powi(3) - beyond.sum::<f64>();
    }
    clipper.load_box(bounds);
    let mut volume = 0.0;
    clipper.each_triangle(|t| volume += volume_in_ball(&t, centre, radius));
    volume
}

impl RadialOptions {
    /// The number of bins, with the mean diameter (m).
    fn bins(&self, diameter: f64) -> Result<usize, AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        for (name, value) in [
            ("width_over_d", self.width_over_d),
            ("reach_over_d", self.reach_over_d),
        ] {
            if !value.is_finite() || value <= 0.0 {
                return refuse(name, value, "above zero and finite");
            }
            if !LENGTHS.contains(&(value * diameter)) {
                return refuse(name, value, "such that it is 1e-90 to 1e90 m");
            }
        }
        let bins = (self.reach_over_d / self.width_over_d).round().max(1.0);
        if bins > MOST_BINS {
            return refuse(
                "reach_over_d / width_over_d",
                bins,
                "at most 10000, the most bins",
            );
        }
        Ok(bins as usize)
    }
}

impl Table for RadialDistribution {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "low_m",
            "high_m",
            "value",
            "standard_error",
            "pairs",
            "expected_pairs",
            "rare",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.bins.iter().map(|bin| {
            vec![
                bin.low.into(),
                bin.high.into(),
                bin.value.into(),
                bin.standard_error.into(),
                bin.pairs.into(),
                bin.expected.into(),
                u32::from(bin.is_rare()).into(),
            ]
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Volumes by caps, where caps suffice, agree with the closed form over the faces; volumes grow with
        /// the radius up to the box.
        #[test]
        fn balls_in_boxes(at in prop::array::uniform3(0.0..1.0_f64), radius in 0.0..4.0_f64) {
            let bounds = Bounds { min: Point3::origin(), max: Point3::new(1.0, 2.0, 3.0) };
            let centre = Point3::new(at[0], 2.0 * at[1], 3.0 * at[2]);
            let mut clipper = Clipper::default();
            let found = ball_in_box(&mut clipper, &centre, radius, &bounds);
            clipper.load_box(&bounds);
            let mut volume = 0.0;
            clipper.each_triangle(|t| volume += volume_in_ball(&t, &centre, radius));
            prop_assert!((found - volume).abs() < 1e-11, "{} {}", found, volume);
            let more = ball_in_box(&mut clipper, &centre, radius + 0.1, &bounds);
            prop_assert!(more >= found - 1e-12 && more <= 6.0 + 1e-12);
        }
    }
}
