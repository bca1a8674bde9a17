//! The largest contact force on each body over the body's weight.

use serde::{Deserialize, Serialize};

use crate::blocks::{Blocks, Estimate};
use crate::bootstrap::BlockBootstrap;
use crate::coordination::Partner;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::table::{Cell, Table};

/// Largest contact force on each body over its weight, F_c/W, by which the founding paper (Xiang, Latham and
/// Farsi 2016) normalises its force chains.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceMaxima {
    /// Mean over the bodies that touch anything.
    pub mean: Estimate,
    /// Median over the same bodies; 0 without any.
    pub median: f64,
    /// The largest of all.
    pub largest: f64,
    /// For each body; 0 for a body that touches nothing, or whose contacts with each partner cancel.
    pub bodies: Vec<f64>,
}

/// The largest contact force on each body, friction included, over its weight. Contacts of a pair are summed to
/// one force; walls count.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let bodies = [ForceBody { centre: Point3::origin(), volume: 1.0, diameter: 1.0, weight: 2.0 }];
/// let contacts = [ForceContact {
///     first: 0, second: Partner::Wall(0), point: Point3::origin(), normal: -Vector3::z(), normal_force: 4.0,
///     tangential: Vector3::x() * 3.0, moment: Vector3::zeros(), class: None,
/// }];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// assert_eq!(force_maxima(&network, BlockBootstrap::default())?.bodies, [2.5]);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::NoWeight`], [`AnalysisError::Option`].
pub fn force_maxima(
    network: &ForceNetwork,
    bootstrap: BlockBootstrap,
) -> Result<ForceMaxima, AnalysisError> {
    network.need_weights()?;
    let blocks = Blocks::of(network, bootstrap)?;
    let bodies = largest_over_weight(network);
    // Not by the force, which may be 0 if patches cancel.
    let touches = network.touches();
    let touching = || (0..bodies.len()).filter(|body| touches[*body]);
    let mean = blocks.mean(touching().map(|body| (network.bodies()[body].centre, bodies[body])));
    let mut sorted: Vec<f64> = touching().map(|body| bodies[body]).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    let median = match sorted.len() {
        0 => 0.0,
        n if n % 2 == 1 => sorted[middle],
        _ => 0.5 * (sorted[middle - 1] + sorted[middle]),
    };
    Ok(ForceMaxima {
        mean,
        median,
        largest: sorted.last().copied().unwrap_or(0.0),
        bodies,
    })
}

/// The largest F_c/W of each body.
pub(crate) fn largest_over_weight(network: &ForceNetwork) -> Vec<f64> {
    let mut largest = vec![0.0_f64; network.bodies().len()];
    let mut raise = |body: u32, force: f64| {
        let weight = network.bodies()[body as usize].weight;
        let entry = &mut largest[body as usize];
        *entry = entry.max(force / weight);
    };
    for pair in network.pairs() {
        let force = pair.force.norm();
        raise(pair.first, force);
        if let Partner::Body(second) = pair.second {
            raise(second, force);
        }
    }
    largest
}

impl Table for ForceMaxima {
    fn columns(&self) -> &'static [&'static str] {
        &["body", "largest_force_over_weight"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let rows = (0_u32..).zip(&self.bodies);
        Box::new(rows.map(|(body, force)| vec![body.into(), (*force).into()]))
    }
}
