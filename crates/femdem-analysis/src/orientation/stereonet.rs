//! Schmidt net with Kamb density.

use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

use super::unit_vectors;
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::table::{Cell, Table};

/// Smallest counting circle, as a part of the hemisphere: densities in smaller ones overflow in the end.
const LEAST_CIRCLE: f64 = 1e-9;

/// How [`stereonet`] counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StereonetOptions {
    /// Kamb's number of standard deviations to which the count expected in a circle corresponds; above 0 and at
    /// most 1000. Default 3.
    pub sigmas: f64,
    /// Smallest part of the hemisphere that a counting circle covers, 1e-9 or more and below 1: in smaller ones
    /// hardly anything is ever counted. Default 0.01: Kamb's
    /// circle shrinks with the number of directions, and would become smaller than the net's meshes with many.
    pub least_circle: f64,
    /// Nodes across the net, 3 to 1001. Default 41.
    pub nodes_across: u32,
}

impl Default for StereonetOptions {
    fn default() -> Self {
        Self {
            sigmas: 3.0,
            least_circle: 0.01,
            nodes_across: 41,
        }
    }
}

/// A node of the net.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NetNode {
    /// Position in the unit disc: x to the east, y to the north ([`schmidt`]).
    pub place: [f64; 2],
    /// The direction there, on the lower hemisphere.
    pub direction: [f64; 3],
    /// Directions in the counting circle about it.
    pub count: u32,
    /// Density in multiples of the uniform one.
    pub density: f64,
    /// Kamb's measure: the count minus the expected one, in standard deviations for uniform directions. Values
    /// beyond 3 are hardly due to chance; values beyond 2 occur at single nodes of many.
    pub sigmas: f64,
}

/// Kamb density on a Schmidt net. As a [`Table`] one row per node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stereonet {
    /// Number of directions.
    pub directions: usize,
    /// Part of the hemisphere that a counting circle covers.
    pub circle: f64,
    /// Opening angle of the counting circle, from its centre (rad).
    pub angle: f64,
    /// Count expected in a circle if directions are uniform.
    pub expected: f64,
    /// Standard deviation of a node's density for independent uniform directions: `√((1 - a) / (N a))`.
    pub noise: f64,
    /// Nodes across the net.
    pub nodes_across: u32,
    /// The nodes in the disc, row by row from the south.
    pub nodes: Vec<NetNode>,
}

/// Position of an axis on a Schmidt net: Lambert's equal-area projection of the lower hemisphere (z down) onto
/// the unit disc, x to the east and y to the north. The vector need not be of unit length; a vector that points
/// up is replaced by its opposite; zero and non-finite vectors give the centre.
///
/// ```
/// assert_eq!(femdem_analysis::schmidt([0.0, 0.0, 1.0]), [0.0, 0.0]);
/// assert_eq!(femdem_analysis::schmidt([2.0, 0.0, 0.0]), [1.0, 0.0]);
/// ```
pub fn schmidt(axis: [f64; 3]) -> [f64; 2] {
    // Squares of larger or smaller lengths would overflow or vanish.
    let largest = Vector3::from(axis).amax();
    let axis = if (1e-100..=1e100).contains(&largest) {
        axis
    } else {
        axis.map(|x| x / largest)
    };
    let length = Vector3::from(axis).norm();
    let [x, y, z] = axis;
    // Axes that point up are reversed.
    let scale = if z > 0.0 { -1.0 } else { 1.0 } / (length * (length + z.abs())).sqrt();
    if scale.is_finite() {
        [scale * x, scale * y]
    } else {
        [0.0; 2]
    }
}

/// The axis at a position of the unit disc.
fn lower_hemisphere([x, y]: [f64; 2]) -> Vector3 {
    let square = x * x + y * y;
    let flat = (2.0 - square).max(0.0).sqrt();
    Vector3::new(x * flat, y * flat, square - 1.0)
}

/// Density of axes on a Schmidt net after Kamb (J. Geophys. Res. 64, 1891, 1959).
///
/// The axes within a circle about each node are counted. The circle covers the part `a = k²/(N + k²)` of the
/// hemisphere, with `k` the `sigmas` of the options: the count expected for uniform axes is then `k` times its
/// standard deviation. Vectors need not be of unit length. Correlated axes, such as the face normals of one
/// body, scatter less than independent ones in circles that contain several of a body, and nearly the same in
/// smaller circles. Lengths do not count, however large or small, but a vector without a direction, zero or not
/// finite, is an error. All numbers of the net are finite.
///
/// ```
/// use femdem_analysis::{StereonetOptions, stereonet};
///
/// let found = stereonet(&[[0.0, 0.1, 1.0], [0.1, 0.0, -1.0]], &StereonetOptions::default())?;
/// let densest = found.nodes.iter().max_by_key(|n| n.count);
/// assert_eq!(densest.map(|n| n.count), Some(2));
/// # Ok::<(), femdem_analysis::AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::NoDirections`], [`AnalysisError::Direction`], [`AnalysisError::Option`].
pub fn stereonet(
    directions: &[[f64; 3]],
    options: &StereonetOptions,
) -> Result<Stereonet, AnalysisError> {
    options.validate()?;
    if directions.is_empty() {
        return Err(AnalysisError::NoDirections);
    }
    let mut axes = unit_vectors(directions)?;
    for axis in &mut axes {
        if axis.z > 0.0 {
            *axis = -*axis;
        }
    }
    axes.sort_by(|a, b| a.z.total_cmp(&b.z));
    let count = axes.len() as f64;
    let circle =
        (options.sigmas.powi(2) / (count + options.sigmas.powi(2))).max(options.least_circle);
    let (expected, spread) = (count * circle, (count * circle * (1.0 - circle)).sqrt());
    let across = options.nodes_across;
    let line = |i: u32| 2.0 * f64::from(i) / f64::from(across - 1) - 1.0;
    let places: Vec<[f64; 2]> = (0..across * across)
        .map(|i| [line(i % across), line(i / across)])
        .filter(|[x, y]| x * x + y * y <= 1.0 + 1e-12)
        .collect();
    let nodes = ordered_map(
        places.len(),
        || (),
        |(), i| {
            let direction = lower_hemisphere(places[i]);
            let count = count_within(&axes, &direction, 1.0 - circle);
            NetNode {
                place: places[i],
                direction: direction.into(),
                count,
                density: f64::from(count) / expected,
                sigmas: (f64::from(count) - expected) / spread,
            }
        },
    );
    Ok(Stereonet {
        directions: directions.len(),
        circle,
        angle: (1.0 - circle).acos(),
        expected,
        noise: spread / expected,
        nodes_across: across,
        nodes,
    })
}

/// Axes of the lower hemisphere, sorted by z, whose angle to `centre` has at least the cosine given.
fn count_within(axes: &[Vector3], centre: &Vector3, cosine: f64) -> u32 {
    // Heights within the circle; beyond the equator it continues on the opposite side.
    let angle = cosine.acos();
    let tilt = centre.z.clamp(-1.0, 1.0).acos();
    let [high, low] =
        [tilt - angle, tilt + angle].map(|t| t.clamp(0.0, std::f64::consts::PI).cos());
    let mirrored = (-high).min(low);
    let from = axes.partition_point(|a| a.z < mirrored - 1e-9);
    let to = axes.partition_point(|a| a.z <= high + 1e-9);
    let near = axes[from..to.max(from)].iter();
    near.filter(|a| a.dot(centre).abs() >= cosine).count() as u32
}

impl StereonetOptions {
    fn validate(&self) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        // The condition is false for NaN.
        if !(self.sigmas > 0.0 && self.sigmas <= 1e3) {
            return refuse("sigmas", self.sigmas, "above zero and at most 1000");
        }
        if !(LEAST_CIRCLE..1.0).contains(&self.least_circle) {
            let allowed = "1e-9 or more and below 1";
            return refuse("least_circle", self.least_circle, allowed);
        }
        if !(3..=1001).contains(&self.nodes_across) {
            return refuse("nodes_across", f64::from(self.nodes_across), "3 to 1001");
        }
        Ok(())
    }
}

impl Table for Stereonet {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "x",
            "y",
            "direction_x",
            "direction_y",
            "direction_z",
            "count",
            "density",
            "sigmas",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.nodes.iter().map(|node| {
            let [x, y] = node.place;
            let [u, v, w] = node.direction;
            let mut row = [x, y, u, v, w].map(Cell::from).to_vec();
            row.extend([node.count.into(), node.density.into(), node.sigmas.into()]);
            row
        }))
    }
}
