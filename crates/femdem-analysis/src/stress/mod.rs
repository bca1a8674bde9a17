//! Stress from contact forces, and whether the forces carry the weight.
//!
//! **Sign**: compression is positive, as in soil mechanics. **Volume**: of the body for a body's stress, of
//! the region, voids included, for a region's.

mod balance;
mod bodies;
mod profile;
mod region;

use femdem_mesh::Matrix3;
use serde::{Deserialize, Serialize};

use crate::table::Cell;
use crate::tensor;

pub use balance::{BalanceCut, VerticalBalance, vertical_balance};
pub use bodies::{BodyStress, BodyStresses, body_stresses};
pub use profile::{StressProfile, StressSlab, stress_profile};
pub use region::{RegionStress, region_stress};

/// A mean stress (Pa), compression positive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stress {
    /// The tensor: row i is the component of the force, column j that of the lever. It is symmetric only in
    /// equilibrium of moments.
    pub tensor: [[f64; 3]; 3],
    /// Mean of the diagonal.
    pub pressure: f64,
    /// √(3/2 s:s) with s the deviator of the symmetric part: von Mises' measure.
    pub deviator: f64,
    /// Principal values of the symmetric part, largest first.
    pub principal: [f64; 3],
    /// Their unit directions; the largest coordinate of each is positive.
    pub directions: [[f64; 3]; 3],
}

impl Stress {
    pub(crate) fn of(tensor: &Matrix3) -> Self {
        // Adding zero turns -0 into 0.
        let tensor = tensor.add_scalar(0.0);
        let symmetric = (tensor + tensor.transpose()) * 0.5;
        let pressure = symmetric.trace() / 3.0;
        let deviator = symmetric - Matrix3::identity() * pressure;
        let (principal, directions) = tensor::principal(&symmetric);
        Self {
            tensor: tensor::rows(&tensor),
            pressure,
            deviator: (1.5 * deviator.norm_squared()).sqrt(),
            principal,
            directions: directions.map(Into::into),
        }
    }

    /// Norm of the antisymmetric part over that of the tensor: 0 in equilibrium of moments.
    #[must_use]
    pub fn asymmetry(&self) -> f64 {
        let t = &self.tensor;
        let odd = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| (t[i][j] - t[j][i]).powi(2));
        let all: f64 = t.iter().flatten().map(|x| x * x).sum();
        if all > 0.0 {
            (0.5 * odd.iter().sum::<f64>() / all).sqrt()
        } else {
            0.0
        }
    }

    /// Cells of the columns [`STRESS_COLUMNS`].
    pub(crate) fn cells(&self) -> impl Iterator<Item = Cell> {
        let scalars = [self.pressure, self.deviator];
        let numbers = scalars
            .into_iter()
            .chain(self.principal)
            .chain(self.directions[0])
            .chain(self.tensor.into_iter().flatten());
        numbers.map(Cell::from)
    }
}

/// The columns of a stress in a table, after three columns for its place.
macro_rules! stress_columns {
    ($($before:literal),* $(,)?) => {
        &[
            $($before,)*
            "pressure_pa", "deviator_pa", "principal_1_pa", "principal_2_pa", "principal_3_pa",
            "direction_1_x", "direction_1_y", "direction_1_z",
            "stress_xx_pa", "stress_xy_pa", "stress_xz_pa",
            "stress_yx_pa", "stress_yy_pa", "stress_yz_pa",
            "stress_zx_pa", "stress_zy_pa", "stress_zz_pa",
        ]
    };
}
pub(crate) use stress_columns;
