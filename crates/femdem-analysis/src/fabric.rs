//! Fabric: the directions of contact normals and of the lines between centres.

use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::coordination::Partner;
use crate::network::ForceNetwork;
use crate::table::{Cell, Table};
use crate::tensor;

/// Second moment of a set of directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// Mean of n ⊗ n; trace 1. Zero without directions.
    pub tensor: [[f64; 3]; 3],
    /// Principal values, largest first: 1/3 each if isotropic.
    pub principal: [f64; 3],
    /// Unit directions of the principal values; the largest coordinate of each is positive.
    pub directions: [[f64; 3]; 3],
    /// Anisotropy a = √(3/2 A:A) with A = 15/2 (mean of n ⊗ n − 1/3), the second-order coefficient of
    /// P(n) = (1 + A_ij n_i n_j)/4π (Kanatani 1984): 0 if isotropic, 7.5 if all directions are one.
    pub anisotropy: f64,
    /// Root mean square of the anisotropy of as many independent uniform directions, 7.5/√count: smaller values
    /// are not significant.
    pub anisotropy_noise: f64,
    /// Number of directions.
    pub count: usize,
}

/// Fabric of the touching pairs of bodies, walls left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactFabric {
    /// Of the contact normals, one for each contact: all contacts of a touching pair count, however weak they
    /// are.
    pub normals: Fabric,
    /// Of the same normals, each weighted with its normal force, or with 0 where it pulls.
    pub forces: Fabric,
    /// Of the branches, the lines from centre to centre, one for each touching pair.
    pub branches: Fabric,
    /// Mean length of a branch (m); 0 without any.
    pub mean_branch: f64,
}

/// Fabric tensors of a network.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let body = |x| ForceBody { centre: Point3::new(x, 0.0, 0.0), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let contact = |first, second| ForceContact {
///     first, second: Partner::Body(second), point: Point3::origin(), normal: Vector3::x(), normal_force: 2.0,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// let bodies = [body(0.0), body(1.0), body(2.0)];
/// let contacts = [contact(0, 1), contact(1, 2)];
/// let fabric = contact_fabric(&ForceNetwork::new(&bodies, &contacts, 0.0)?);
/// assert_eq!(fabric.normals.principal, [1.0, 0.0, 0.0]);
/// assert!((fabric.branches.anisotropy - 7.5).abs() < 1e-12);
/// assert_eq!(fabric.mean_branch, 1.0);
/// # Ok::<(), AnalysisError>(())
/// ```
#[must_use]
pub fn contact_fabric(network: &ForceNetwork) -> ContactFabric {
    let between = || {
        network
            .touching_contacts()
            .filter(|contact| matches!(contact.second, Partner::Body(_)))
    };
    let branch = |(i, j, _): (u32, u32, _)| {
        let line = network.branch(i, j);
        let length = line.norm();
        (length > 0.0).then(|| (line / length, length))
    };
    let branches: Vec<(Vector3, f64)> = network.body_pairs().filter_map(branch).collect();
    // Not `sum`, which is -0 without branches.
    let lengths = branches.iter().fold(0.0, |sum, branch| sum + branch.1);
    ContactFabric {
        normals: Fabric::of(between().map(|c| (c.normal, 1.0))),
        forces: Fabric::of(between().map(|c| (c.normal, c.normal_force.max(0.0)))),
        mean_branch: lengths / (branches.len() as f64).max(1.0),
        branches: Fabric::of(branches.into_iter().map(|(line, _)| (line, 1.0))),
    }
}

impl Fabric {
    /// Of unit vectors with weights of zero or more; their sign does not matter.
    pub(crate) fn of(directions: impl Iterator<Item = (Vector3, f64)>) -> Self {
        let mut sum = Matrix3::zeros();
        let mut weights = (0.0, 0.0);
        let mut count = 0;
        for (n, weight) in directions {
            sum += n * n.transpose() * weight;
            weights = (weights.0 + weight, weights.1 + weight * weight);
            count += 1;
        }
        if weights.0 <= 0.0 {
            return Self::default();
        }
        let mean = sum / weights.0;
        let deviator = (mean - Matrix3::identity() / 3.0) * 7.5;
        let (principal, directions) = tensor::principal(&mean);
        Self {
            tensor: tensor::rows(&mean),
            principal,
            directions: directions.map(Into::into),
            anisotropy: (1.5 * deviator.norm_squared()).sqrt(),
            // The effective number of unequal weights is that of Kish (1965).
            anisotropy_noise: 7.5 * weights.1.sqrt() / weights.0,
            count,
        }
    }
}

impl Table for ContactFabric {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "of",
            "count",
            "anisotropy",
            "anisotropy_noise",
            "principal_1",
            "principal_2",
            "principal_3",
            "direction_1_x",
            "direction_1_y",
            "direction_1_z",
            "xx",
            "xy",
            "xz",
            "yy",
            "yz",
            "zz",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let rows = [
            ("normals", &self.normals),
            ("forces", &self.forces),
            ("branches", &self.branches),
        ];
        Box::new(rows.into_iter().map(|(of, fabric)| {
            let t = &fabric.tensor;
            let upper = [t[0][0], t[0][1], t[0][2], t[1][1], t[1][2], t[2][2]];
            let numbers = [fabric.anisotropy, fabric.anisotropy_noise]
                .into_iter()
                .chain(fabric.principal)
                .chain(fabric.directions[0])
                .chain(upper);
            let start = [Cell::from(of), fabric.count.into()];
            start.into_iter().chain(numbers.map(Cell::from)).collect()
        }))
    }
}
