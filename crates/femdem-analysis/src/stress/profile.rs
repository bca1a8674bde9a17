//! Stress over the height.

use femdem_mesh::{Matrix3, Point3};
use serde::{Deserialize, Serialize};

use super::{Stress, stress_columns};
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::region::Region;
use crate::table::{Cell, Table};

/// Mean stress in a horizontal slab.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressSlab {
    /// Lower end (m).
    pub z_min: f64,
    /// Upper end (m).
    pub z_max: f64,
    /// The stress (Pa), over the volume of the slab, voids included.
    pub stress: Stress,
    /// Mean horizontal over vertical normal stress; `None` without a vertical one.
    pub lateral_ratio: Option<f64>,
}

/// Stress over the height of a region.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StressProfile {
    /// The slabs, from below.
    pub slabs: Vec<StressSlab>,
}

/// Largest number of slabs.
const MOST: usize = 10_000;

/// Mean stress in `slabs` equal horizontal slabs of a region that contains the whole pack, such as the inside
/// of its container. As in [`region_stress`](crate::region_stress), contacts count in each slab by the part of
/// their lines in it; lines beside the region count, too.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let bodies = [ForceBody { centre: Point3::new(0.0, 0.0, 0.5), volume: 1.0, diameter: 1.8, weight: 10.0 }];
/// let contacts = [ForceContact {
///     first: 0, second: Partner::Wall(0), point: Point3::origin(), normal: -Vector3::z(), normal_force: 10.0,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// }];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let region = Region::Box { min: Point3::new(-0.5, -0.5, 0.0), max: Point3::new(0.5, 0.5, 1.0) };
/// let profile = stress_profile(&network, &region, 2)?;
/// // Below the centre the line to the floor carries 10 N over 1 m²; above it nothing does.
/// assert_eq!(profile.slabs[0].stress.tensor[2][2], 10.0);
/// assert_eq!(profile.slabs[1].stress.pressure, 0.0);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a sphere, [`AnalysisError::Option`] unless there are 1 to 10,000 slabs.
pub fn stress_profile(
    network: &ForceNetwork,
    region: &Region,
    slabs: usize,
) -> Result<StressProfile, AnalysisError> {
    region.validate()?;
    if network.repeats(2) {
        return Err(AnalysisError::RegionKind {
            what: "a profile over the height",
            instead: "one where space does not repeat itself along z",
        });
    }
    if !(1..=MOST).contains(&slabs) {
        return Err(AnalysisError::Option {
            name: "slabs",
            value: slabs as f64,
            allowed: "1 to 10000",
        });
    }
    let (Point3 { coords: low }, Point3 { coords: high }) = region.corners();
    // Refuses regions without horizontal slabs.
    region.slab(low.z, high.z)?;
    let step = (high.z - low.z) / slabs as f64;
    let level = |k: usize| low.z + step * k as f64;
    let mut sums = vec![Matrix3::zeros(); slabs];
    for load in network.loads() {
        let centre = network.centre(load.body);
        let lever = network.lever(&load);
        let torque = load.moment.cross_matrix().transpose() * 0.5;
        let moment = load.force * lever.transpose() - torque;
        let ends = [centre.z, centre.z + lever.z];
        let [bottom, top] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        // Conversion to usize saturates at both ends.
        let slab_of = |z: f64| (((z - low.z) / step).floor() as usize).min(slabs - 1);
        if top < low.z || bottom > high.z {
            continue;
        }
        for (k, sum) in sums
            .iter_mut()
            .enumerate()
            .take(slab_of(top) + 1)
            .skip(slab_of(bottom))
        {
            let part = if top > bottom {
                (top.min(level(k + 1)) - bottom.max(level(k))).max(0.0) / (top - bottom)
            } else {
                1.0
            };
            *sum += moment * part;
        }
    }
    let volume = region.volume() / slabs as f64;
    let slab = |(k, sum): (usize, &Matrix3)| {
        let stress = Stress::of(&(-sum / volume));
        let [xx, yy, zz] = [0, 1, 2].map(|i| stress.tensor[i][i]);
        StressSlab {
            z_min: level(k),
            z_max: level(k + 1),
            stress,
            lateral_ratio: (zz > 0.0).then(|| 0.5 * (xx + yy) / zz),
        }
    };
    Ok(StressProfile {
        slabs: sums.iter().enumerate().map(slab).collect(),
    })
}

impl Table for StressProfile {
    fn columns(&self) -> &'static [&'static str] {
        stress_columns!["z_min_m", "z_max_m", "lateral_ratio"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.slabs.iter().map(|slab| {
            let place = [
                slab.z_min.into(),
                slab.z_max.into(),
                slab.lateral_ratio.into(),
            ];
            place.into_iter().chain(slab.stress.cells()).collect()
        }))
    }
}
