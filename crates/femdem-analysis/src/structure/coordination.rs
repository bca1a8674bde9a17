//! The mean coordination number with its error.

use crate::blocks::{Blocks, Estimate};
use crate::bootstrap::BlockBootstrap;
use crate::coordination::Partner;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::region::Region;

/// Mean number of partners, walls included, of the bodies with their centre in `region` (without one, of all
/// bodies), with a standard error. [`coordination`](crate::coordination) cannot give that error, because its
/// input has no positions.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let body = |x| ForceBody { centre: Point3::new(x, 0.0, 0.0), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let contact = |first: u32| ForceContact {
///     first, second: Partner::Body(first + 1), point: Point3::origin(), normal: Vector3::x(), normal_force: 1.0,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// // A row of 40: two partners each, but one at the ends.
/// let bodies: Vec<_> = (0..40).map(|i| body(f64::from(i))).collect();
/// let contacts: Vec<_> = (0..39).map(contact).collect();
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let found = mean_coordination(&network, None, BlockBootstrap::default())?;
/// assert_eq!((found.mean, found.count), (78.0 / 40.0, 40));
/// assert!(found.standard_error.is_some_and(|error| 0.0 < error && error < 0.1));
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::Option`].
pub fn mean_coordination(
    network: &ForceNetwork,
    region: Option<&Region>,
    bootstrap: BlockBootstrap,
) -> Result<Estimate, AnalysisError> {
    if let Some(region) = region {
        region.validate()?;
    }
    let blocks = Blocks::of(network, bootstrap)?;
    let mut partners = vec![0.0; network.bodies().len()];
    for pair in network.pairs() {
        partners[pair.first as usize] += 1.0;
        if let Partner::Body(second) = pair.second {
            partners[second as usize] += 1.0;
        }
    }
    let centres = network.bodies().iter().map(|body| body.centre);
    let counted = centres
        .zip(partners)
        .filter(|(centre, _)| region.is_none_or(|region| region.contains(centre)));
    Ok(blocks.mean(counted))
}
