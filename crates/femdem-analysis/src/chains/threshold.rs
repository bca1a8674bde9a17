//! Components and cycles of the force network against a threshold.

use serde::{Deserialize, Serialize};

use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::network::graph::Sets;
use crate::table::{Cell, Table};

/// The thresholds of [`threshold_curve`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ThresholdOptions {
    /// In mean normal forces of the pairs of bodies that press on each other, finite. Default 0 to 5 in steps of 0.1.
    pub thresholds: Vec<f64>,
}

impl Default for ThresholdOptions {
    fn default() -> Self {
        Self {
            thresholds: (0..=50).map(|k| f64::from(k) / 10.0).collect(),
        }
    }
}

/// The network of pairs of bodies above one threshold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThresholdPoint {
    /// The threshold in mean normal forces.
    pub threshold: f64,
    /// Pairs with a normal force above it.
    pub links: usize,
    /// Bodies with at least one such pair.
    pub bodies: usize,
    /// Connected parts of two bodies or more.
    pub components: usize,
    /// Bodies of the largest part.
    pub largest: usize,
    /// Independent loops: links − bodies + components.
    pub cycles: usize,
}

/// Components and cycles against threshold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ThresholdCurve {
    /// The points, in the order of the options.
    pub points: Vec<ThresholdPoint>,
}

/// The zeroth and first Betti numbers of the force network as the threshold rises.
///
/// Contacts with walls are left out. Without touching pairs of bodies all counts are 0.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// // A triangle with forces 3, 3 and 1, and a pair with 5, mean 3.
/// let bodies = [ForceBody { centre: Point3::origin(), volume: 1.0, diameter: 1.0, weight: 1.0 }; 5];
/// let contact = |first, second, normal_force| ForceContact {
///     first, second: Partner::Body(second), point: Point3::origin(), normal: Vector3::x(), normal_force,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// let contacts = [contact(0, 1, 3.0), contact(1, 2, 3.0), contact(2, 0, 1.0), contact(3, 4, 5.0)];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let curve = threshold_curve(&network, &ThresholdOptions { thresholds: vec![0.0, 0.5, 1.5] })?;
/// let counts: Vec<_> = curve.points.iter().map(|p| (p.components, p.cycles, p.largest)).collect();
/// assert_eq!(counts, [(2, 1, 3), (2, 0, 3), (1, 0, 2)]);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Option`] for a threshold that is not finite.
pub fn threshold_curve(
    network: &ForceNetwork,
    options: &ThresholdOptions,
) -> Result<ThresholdCurve, AnalysisError> {
    let thresholds = &options.thresholds;
    if let Some(bad) = thresholds.iter().find(|t| !t.is_finite()) {
        return Err(AnalysisError::Option {
            name: "thresholds",
            value: *bad,
            allowed: "finite",
        });
    }
    let mean = network.mean_force().unwrap_or(0.0);
    let mut links: Vec<(f64, u32, u32)> = network
        .body_pairs()
        .map(|(i, j, pair)| (pair.normal_force, i, j))
        .collect();
    // From strong to weak, so that parts can only join.
    links.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut order: Vec<usize> = (0..thresholds.len()).collect();
    order.sort_by(|a, b| thresholds[*b].total_cmp(&thresholds[*a]));
    let mut growing = Growing::new(network.bodies().len());
    let mut waiting = links.into_iter().peekable();
    let mut points = vec![None; thresholds.len()];
    for index in order {
        let threshold = thresholds[index];
        while let Some((_, i, j)) = waiting.next_if(|link| link.0 > threshold * mean) {
            growing.add(i, j);
        }
        points[index] = Some(growing.point(threshold));
    }
    Ok(ThresholdCurve {
        points: points.into_iter().flatten().collect(),
    })
}

/// The network up to the present link.
struct Growing {
    sets: Sets,
    links: usize,
    bodies: usize,
    components: usize,
    largest: u32,
}

impl Growing {
    fn new(bodies: usize) -> Self {
        Self {
            sets: Sets::new(bodies),
            links: 0,
            bodies: 0,
            components: 0,
            largest: 0,
        }
    }

    fn add(&mut self, i: u32, j: u32) {
        self.links += 1;
        let Some(sizes) = self.sets.join(i, j) else {
            return;
        };
        let lone = sizes.iter().filter(|size| **size == 1).count();
        self.bodies += lone;
        // Two single bodies form a part, two parts become one.
        match lone {
            2 => self.components += 1,
            0 => self.components -= 1,
            _ => {}
        }
        self.largest = self.largest.max(sizes[0] + sizes[1]);
    }

    fn point(&self, threshold: f64) -> ThresholdPoint {
        ThresholdPoint {
            threshold,
            links: self.links,
            bodies: self.bodies,
            components: self.components,
            largest: self.largest as usize,
            cycles: (self.links + self.components) - self.bodies,
        }
    }
}

impl Table for ThresholdCurve {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "threshold",
            "links",
            "bodies",
            "components",
            "largest",
            "cycles",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.points.iter().map(|p| {
            vec![
                p.threshold.into(),
                p.links.into(),
                p.bodies.into(),
                p.components.into(),
                p.largest.into(),
                p.cycles.into(),
            ]
        }))
    }
}
