//! How the traction of bonds and cracks falls.

use femdem_solve::contact::glue::Softening;

use crate::border::Failure;

/// Softening of a FemdemBondLaw or FemdemFracture: along a straight line.
pub const FEMDEM_SOFTENING_LINEAR: i32 = 0;
/// Softening of a FemdemBondLaw or FemdemFracture: along an exponential that ends.
pub const FEMDEM_SOFTENING_EXPONENTIAL: i32 = 1;
/// Softening of a FemdemBondLaw or FemdemFracture: along two straight lines, as of concrete.
pub const FEMDEM_SOFTENING_BILINEAR: i32 = 2;

/// The softening of a number.
pub(crate) fn softening(number: i32) -> Result<Softening, Failure> {
    Ok(match number {
        FEMDEM_SOFTENING_LINEAR => Softening::Linear,
        FEMDEM_SOFTENING_EXPONENTIAL => Softening::Exponential,
        FEMDEM_SOFTENING_BILINEAR => Softening::Bilinear,
        other => {
            let allowed = "one of the FEMDEM_SOFTENING constants";
            return Err(Failure::refused("softening", other, allowed));
        }
    })
}

/// The number of a softening.
pub(crate) fn number(softening: Softening) -> i32 {
    match softening {
        Softening::Linear => FEMDEM_SOFTENING_LINEAR,
        Softening::Exponential => FEMDEM_SOFTENING_EXPONENTIAL,
        Softening::Bilinear => FEMDEM_SOFTENING_BILINEAR,
    }
}
