//! Stress of a region: contact forces along the lines between centres and contact points.

use femdem_mesh::{Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::Stress;
use crate::blocks::Blocks;
use crate::bootstrap::BlockBootstrap;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::pack::WHOLE;
use crate::region::Region;

/// Mean stress in a region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegionStress {
    /// The stress (Pa), over the volume of the region, voids included.
    pub stress: Stress,
    /// Standard error of the pressure (Pa) by block bootstrap over sub-boxes of the region (slices of a
    /// cylinder), to which a contact belongs by its point; `None` with fewer than four blocks. In a pack under
    /// gravity most of it is the change with depth.
    pub pressure_error: Option<f64>,
    /// Contacts with a part of their lines in the region.
    pub contacts: usize,
    /// The region.
    pub region: Region,
}

/// Mean stress in `region`, compression positive:
///
/// σ_ij = −(1/V) Σ_c Σ_b λ [ f_i r_j − ½ ε_ijk m_k ]
///
/// over the bodies b of every contact, with λ the part of the line from the body's centre to the contact
/// point that lies in the region. Contacts at the border thus count in part; for a horizontal slab under a
/// pack in equilibrium σ_zz V is exactly the force carried through it, integrated over its height (see
/// [`vertical_balance`](crate::vertical_balance)).
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let cube = |x| ForceBody { centre: Point3::new(x, 0.0, 0.0), volume: 1.0, diameter: 1.8, weight: 0.0 };
/// let bodies = [cube(0.0), cube(1.0)];
/// let contacts = [ForceContact {
///     first: 0, second: Partner::Body(1), point: Point3::new(0.5, 0.0, 0.0), normal: Vector3::x(),
///     normal_force: 3.0, tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// }];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// // Between the centres the whole line carries 3 N over 1 m².
/// let region = Region::Box { min: Point3::new(0.2, -0.5, -0.5), max: Point3::new(0.9, 0.5, 0.5) };
/// let found = region_stress(&network, &region, BlockBootstrap::default())?;
/// assert!((found.stress.principal[0] - 3.0).abs() < 1e-12);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// In [periodic space](ForceNetwork::in_space) the region is a box over all of the cell along the axes that repeat themselves.
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::Option`], [`AnalysisError::RegionKind`] for a region that is no such box.
pub fn region_stress(
    network: &ForceNetwork,
    region: &Region,
    bootstrap: BlockBootstrap,
) -> Result<RegionStress, AnalysisError> {
    region.validate()?;
    check_whole(network, region)?;
    let blocks = Blocks::over(region, network.mean_diameter(), bootstrap)?;
    let mut sum = Matrix3::zeros();
    let mut contacts = 0;
    let mut pressures = Vec::new();
    let mut last = None;
    for load in network.loads() {
        let centre = network.centre(load.body);
        let lever = network.lever(&load);
        let point = centre + lever;
        let part = part_inside(region, &centre, &point, |axis| network.repeats(axis));
        if part <= 0.0 {
            continue;
        }
        let torque = load.moment.cross_matrix().transpose() * 0.5;
        let moment = (load.force * lever.transpose() - torque) * part;
        sum += moment;
        pressures.push((point, -moment.trace() / 3.0));
        // The two bodies of a contact follow one another.
        if last.replace(std::ptr::from_ref(load.contact)) != Some(std::ptr::from_ref(load.contact))
        {
            contacts += 1;
        }
    }
    Ok(RegionStress {
        stress: Stress::of(&(-sum / region.volume())),
        pressure_error: blocks.density_error(pressures, region.volume()),
        contacts,
        region: *region,
    })
}

/// Refuses a region that is only a part of periodic space along an axis that repeats itself.
fn check_whole(network: &ForceNetwork, region: &Region) -> Result<(), AnalysisError> {
    let Some(space) = network.space() else {
        return Ok(());
    };
    let (min, max) = region.corners();
    let whole = |k: usize| {
        let side = space.cell.edges()[(k, k)];
        !space.cell.repeats(k) || ((max[k] - min[k]) / side - 1.0).abs() <= WHOLE
    };
    if matches!(region, Region::Box { .. }) && (0..3).all(whole) {
        return Ok(());
    }
    Err(AnalysisError::RegionKind {
        what: "the stress in periodic space",
        instead: "a box over all of the cell along the axes that repeat themselves",
    })
}

/// The fraction of the segment from `a` to `b` that lies in `region`, 0 to 1; a region is endless along axes that repeat
/// themselves.
fn part_inside(region: &Region, a: &Point3, b: &Point3, repeats: impl Fn(usize) -> bool) -> f64 {
    let (min, max) = region.corners();
    let (flat, round): (&[usize], _) = match *region {
        Region::Box { .. } => (&[0, 1, 2], None),
        Region::Cylinder { centre, radius, .. } => {
            let foot = Point3::new(centre[0], centre[1], 0.0);
            (&[2], Some((foot, radius, Vector3::new(1.0, 1.0, 0.0))))
        }
        Region::Sphere { centre, radius } => (&[], Some((centre, radius, Vector3::repeat(1.0)))),
    };
    let along = b - a;
    let mut span = (0.0_f64, 1.0_f64);
    let mut keep = |low: f64, high: f64| span = (span.0.max(low), span.1.min(high));
    for &k in flat.iter().filter(|&&k| !repeats(k)) {
        if along[k] == 0.0 {
            if a[k] < min[k] || max[k] < a[k] {
                return 0.0;
            }
            continue;
        }
        let ends = [(min[k] - a[k]) / along[k], (max[k] - a[k]) / along[k]];
        keep(ends[0].min(ends[1]), ends[0].max(ends[1]));
    }
    if let Some((centre, radius, axes)) = round {
        let from = (a - centre).component_mul(&axes);
        let along = along.component_mul(&axes);
        let square = along.norm_squared();
        let inside = radius * radius - from.norm_squared();
        if square == 0.0 {
            if inside < 0.0 {
                return 0.0;
            }
        } else {
            let middle = -from.dot(&along) / square;
            let reach = middle * middle + inside / square;
            if reach <= 0.0 {
                return 0.0;
            }
            keep(middle - reach.sqrt(), middle + reach.sqrt());
        }
    }
    (span.1 - span.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against counting points along the segment.
        #[test]
        fn part_of_a_segment(
            a in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
            b in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
            level in any::<bool>(),
            kind in 0..3_u8,
        ) {
            let [a, mut b] = [a, b].map(Point3::from);
            if level {
                (b.x, b.y) = (a.x, a.y);
            }
            let region = match kind {
                0 => Region::Box { min: Point3::new(-1.0, -0.8, -0.9), max: Point3::new(0.7, 1.0, 1.2) },
                1 => Region::Cylinder { centre: [0.2, -0.1], radius: 1.1, z_min: -0.9, z_max: 1.2 },
                _ => Region::Sphere { centre: Point3::new(0.3, -0.2, 0.1), radius: 1.2 },
            };
            let n = 20_000;
            let at = |i: i32| a + (b - a) * ((f64::from(i) + 0.5) / f64::from(n));
            let counted = (0..n).filter(|i| region.contains(&at(*i))).count() as f64 / f64::from(n);
            prop_assert!((part_inside(&region, &a, &b, |_| false) - counted).abs() < 2.0 / f64::from(n));
        }
    }
}
