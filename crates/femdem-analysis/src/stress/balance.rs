//! Vertical balance: the force carried through horizontal cuts compared with the weight above.

use serde::{Deserialize, Serialize};

use crate::coordination::Partner;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::table::{Cell, Table};

/// One horizontal cut through a pack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BalanceCut {
    /// Height of the cut (m).
    pub height: f64,
    /// Upward force (N) that the part below exerts on the part above: summed over all lines from the centre of
    /// a body to one of its contact points that cross the cut.
    pub carried: f64,
    /// Weight of the bodies whose centres lie above the cut (N).
    pub weight_above: f64,
    /// Upward force of the walls at contact points above the cut (N): wall friction, and the vertical
    /// part of normal forces of inclined walls.
    pub wall_support: f64,
    /// `carried + wall_support − weight_above`, over `weight_above`; over the weight of the whole pack where
    /// nothing lies above. Zero in equilibrium.
    pub residual: f64,
}

/// Vertical balance at several heights.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VerticalBalance {
    /// The cuts, in the order given.
    pub cuts: Vec<BalanceCut>,
    /// Largest magnitude of the residuals of the cuts that have at least a tenth of the weight above them.
    pub worst: f64,
}

/// Compares the vertical force through horizontal cuts with the weight above minus what the walls carry.
///
/// The force through a cut is that of all lines from a body's centre to its contact points that cross it. If
/// every body is in equilibrium the balance is exact at any height, so that the residual shows only how far the
/// bodies are from equilibrium, or that a force is missing or has the wrong sign.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// // A cube that weighs 10 N: the floor carries 7 N, the friction of a wall 3 N.
/// let bodies = [ForceBody { centre: Point3::new(0.0, 0.0, 0.5), volume: 1.0, diameter: 1.8, weight: 10.0 }];
/// let contact = |wall, point, normal, normal_force, tangential| ForceContact {
///     first: 0, second: Partner::Wall(wall), point, normal, normal_force, tangential,
///     moment: Vector3::zeros(), class: None,
/// };
/// let contacts = [
///     contact(0, Point3::origin(), -Vector3::z(), 7.0, Vector3::zeros()),
///     contact(1, Point3::new(0.5, 0.0, 0.75), Vector3::x(), 6.0, Vector3::new(0.0, 0.0, -3.0)),
/// ];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let found = vertical_balance(&network, &[0.25])?;
/// assert_eq!((found.cuts[0].carried, found.cuts[0].wall_support), (7.0, 3.0));
/// assert_eq!(found.worst, 0.0);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::NoWeight`], [`AnalysisError::Option`] for a height that is not finite.
pub fn vertical_balance(
    network: &ForceNetwork,
    heights: &[f64],
) -> Result<VerticalBalance, AnalysisError> {
    network.need_weights()?;
    if let Some(bad) = heights.iter().find(|z| !z.is_finite()) {
        return Err(AnalysisError::Option {
            name: "heights",
            value: *bad,
            allowed: "finite (m)",
        });
    }
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by(|a, b| heights[*a].total_cmp(&heights[*b]));
    let sorted: Vec<f64> = order.iter().map(|i| heights[*i]).collect();
    // Number of cuts below a height. What lies at the height of a cut counts as below it.
    let below = |z: f64| sorted.partition_point(|cut| *cut < z);
    let mut carried = vec![0.0; sorted.len()];
    let mut walls = vec![0.0; sorted.len()];
    let mut weights = vec![0.0; sorted.len()];
    let add = |sums: &mut [f64], value: f64| sums.iter_mut().for_each(|sum| *sum += value);
    for body in network.bodies() {
        add(&mut weights[..below(body.centre.z)], body.weight);
    }
    for load in network.loads() {
        let centre = below(network.centre(load.body).z);
        let point = below(load.contact.point.z);
        if point < centre {
            add(&mut carried[point..centre], load.force.z);
        } else {
            add(&mut carried[centre..point], -load.force.z);
        }
        if matches!(load.contact.second, Partner::Wall(_)) {
            add(&mut walls[..point], load.force.z);
        }
    }
    let total: f64 = network.bodies().iter().map(|b| b.weight).sum();
    let mut cuts = vec![None; heights.len()];
    let mut worst = 0.0_f64;
    for (k, &i) in order.iter().enumerate() {
        let scale = if weights[k] > 0.0 { weights[k] } else { total };
        let residual = (carried[k] + walls[k] - weights[k]) / scale;
        if weights[k] >= 0.1 * total {
            worst = worst.max(residual.abs());
        }
        cuts[i] = Some(BalanceCut {
            height: sorted[k],
            carried: carried[k],
            weight_above: weights[k],
            wall_support: walls[k],
            residual,
        });
    }
    Ok(VerticalBalance {
        cuts: cuts.into_iter().flatten().collect(),
        worst,
    })
}

impl Table for VerticalBalance {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "height_m",
            "carried_n",
            "weight_above_n",
            "wall_support_n",
            "residual",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.cuts.iter().map(|cut| {
            let numbers = [
                cut.height,
                cut.carried,
                cut.weight_above,
                cut.wall_support,
                cut.residual,
            ];
            numbers.map(Cell::from).to_vec()
        }))
    }
}
