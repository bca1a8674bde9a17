//! Loads on faces and nodes.

use super::DeformableModel;
use crate::error::{FemError, check};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A number that changes in time.
///
/// ```
/// use femdem_fem::Curve;
///
/// let ramp = Curve::Ramp { value: 100.0, rise: 2.0 };
/// assert_eq!([0.0, 1.0, 5.0].map(|t| ramp.at(t)), [0.0, 50.0, 100.0]);
/// let cycle = Curve::Table(vec![[0.0, 0.0], [1.0, 10.0], [2.0, 0.0]]);
/// assert_eq!([0.5, 1.5, 3.0].map(|t| cycle.at(t)), [5.0, 5.0, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Curve {
    /// A constant.
    Constant(f64),
    /// Linear from zero at time 0 to `value` at time `rise` (s), then constant.
    Ramp {
        /// The final value.
        value: f64,
        /// Time of the rise, s.
        rise: f64,
    },
    /// Linear between points (time in s, value); the first value before and the last one after.
    Table(Vec<[f64; 2]>),
}

impl From<f64> for Curve {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl Curve {
    /// A value times factors over time: points (time, factor), s, with straight lines between.
    #[must_use]
    pub fn factors(value: f64, points: &[[f64; 2]]) -> Self {
        Self::Table(
            points
                .iter()
                .map(|[t, factor]| [*t, factor * value])
                .collect(),
        )
    }

    /// Checks that its numbers are finite and its times ascend.
    ///
    /// # Errors
    /// [`FemError::Parameter`] names the number.
    pub fn validate(&self) -> Result<(), FemError> {
        match self {
            Self::Constant(value) => check("value of a curve", *value, true, "finite"),
            Self::Ramp { value, rise } => {
                check("value of a curve", *value, true, "finite")?;
                check("rise of a ramp", *rise, *rise > 0.0, "positive, in s")
            }
            Self::Table(points) => {
                let count = points.len();
                check("points of a curve", count as f64, count > 0, "at least 1")?;
                for &[time, value] in points {
                    check("time of a curve", time, true, "finite, in s")?;
                    check("value of a curve", value, true, "finite")?;
                }
                for pair in points.windows(2) {
                    let step = pair[1][0] - pair[0][0];
                    check(
                        "time between points of a curve",
                        step,
                        step > 0.0,
                        "above 0 s",
                    )?;
                }
                Ok(())
            }
        }
    }

    /// The value at time `t` (s).
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Ramp { value, rise } => value * (t / rise).clamp(0.0, 1.0),
            Self::Table(points) => {
                let after = points.partition_point(|p| p[0] <= t);
                match (
                    after.checked_sub(1).and_then(|k| points.get(k)),
                    points.get(after),
                ) {
                    (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]),
                    (Some(last), None) => last[1],
                    (None, first) => first.map_or(0.0, |p| p[1]),
                }
            }
        }
    }
}

/// Kind of a load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) enum LoadKind {
    /// Pressure against the current faces, Pa.
    Pressure,
    /// Force per reference area in this direction, Pa.
    Traction(Vector3),
}

/// A load on faces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Load {
    pub kind: LoadKind,
    pub curve: Curve,
    pub faces: Vec<Vec<u32>>,
}

impl Load {
    pub fn validate(&self) -> Result<(), FemError> {
        self.curve.validate()?;
        if let LoadKind::Traction(traction) = self.kind {
            check("traction", traction.norm(), true, "finite, in Pa")?;
        }
        for face in &self.faces {
            let count = face.len();
            let allowed = "3, or 6 with those on the edges";
            check(
                "nodes of a loaded face",
                count as f64,
                count == 3 || count == 6,
                allowed,
            )?;
        }
        Ok(())
    }

    /// Adds the load at time `t` and positions `x` to `forces`.
    pub fn add(&self, model: &DeformableModel, t: f64, x: &[Vector3], forces: &mut [Vector3]) {
        let value = self.curve.at(t);
        if value == 0.0 {
            return;
        }
        for face in &self.faces {
            match (self.kind, face.as_slice()) {
                (LoadKind::Pressure, &[a, b, c]) => {
                    let each = area_vector([a, b, c], x) * (-value / 3.0);
                    for node in [a, b, c] {
                        forces[node as usize] += each;
                    }
                }
                (LoadKind::Pressure, nodes) => press_curved(nodes, value, x, forces),
                (LoadKind::Traction(direction), &[a, b, c, ref middles @ ..]) => {
                    let area = area_vector([a, b, c], model.nodes()).norm();
                    let each = direction * (value * area / 3.0);
                    // Mean of a quadratic shape function over a flat triangle: corners 0, middles 1/3.
                    let loaded = if middles.is_empty() {
                        &face[..3]
                    } else {
                        middles
                    };
                    for &node in loaded {
                        forces[node as usize] += each;
                    }
                }
                _ => {}
            }
        }
    }
}

/// Normal times area of a triangle, m^2.
fn area_vector([a, b, c]: [u32; 3], x: &[Vector3]) -> Vector3 {
    let [a, b, c] = [a, b, c].map(|i| x[i as usize]);
    0.5 * (b - a).cross(&(c - a))
}

/// Two triples of points and their weights, which integrate degree 4 over a triangle (D. A. Dunavant,
/// Int. J. Numer. Meth. Engng 21 (1985) 1129-1148): the barycentric coordinate that differs from the
/// two others, those, and the weight.
const TRIPLES: [[f64; 3]; 2] = [
    [
        0.108_103_018_168_070,
        0.445_948_490_915_965,
        0.223_381_589_678_011,
    ],
    [
        0.816_847_572_980_459,
        0.091_576_213_509_771,
        0.109_951_743_655_322,
    ],
];

/// Pressure on a face of six nodes: -p int N n dS, whose integrand is of degree 4.
fn press_curved(nodes: &[u32], pressure: f64, x: &[Vector3], forces: &mut [Vector3]) {
    let &[a, b, c, d, e, f] = nodes else { return };
    let nodes = [a, b, c, d, e, f];
    let places = nodes.map(|i| x[i as usize]);
    for [own, other, weight] in TRIPLES {
        for corner in 0..3 {
            let mut l = [other; 3];
            l[corner] = own;
            let [l0, l1, l2] = l;
            let shape = [
                l0 * (2.0 * l0 - 1.0),
                l1 * (2.0 * l1 - 1.0),
                l2 * (2.0 * l2 - 1.0),
                4.0 * l0 * l1,
                4.0 * l1 * l2,
                4.0 * l2 * l0,
            ];
            // Derivatives with respect to l1 and l2, with l0 = 1 - l1 - l2.
            let (p, q, r) = (4.0 * l0 - 1.0, 4.0 * l1 - 1.0, 4.0 * l2 - 1.0);
            let along1 = [-p, q, 0.0, 4.0 * (l0 - l1), 4.0 * l2, -4.0 * l2];
            let along2 = [-p, 0.0, r, -4.0 * l1, 4.0 * l1, 4.0 * (l0 - l2)];
            let tangent = |slopes: [f64; 6]| {
                let each = places.iter().zip(slopes);
                each.fold(Vector3::zeros(), |sum, (x, slope)| sum + x * slope)
            };
            let area = tangent(along1).cross(&tangent(along2)) * (0.5 * weight);
            for (&node, n) in nodes.iter().zip(shape) {
                forces[node as usize] -= area * (n * pressure);
            }
        }
    }
}
