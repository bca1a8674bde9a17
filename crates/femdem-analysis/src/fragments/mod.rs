//! Sizes of fragments, their distribution, and the laws that describe it.

mod breakage;
mod fit;
mod measure;
mod smallest_box;

pub use breakage::{
    BreakageIndex, Fragmentation, FragmentationOptions, breakage_index, fragmentation,
};
pub use fit::{SizeFit, SizeFitOptions, SizeLaw, fit_sizes};
pub use measure::{Fragment, FragmentExtent, FragmentSize, FragmentSizes, measure_fragments};

use crate::error::AnalysisError;

/// Sizes, masses, volumes and areas that are measured: their powers and sums are numbers.
const RANGE: std::ops::RangeInclusive<f64> = 1e-60..=1e60;

/// Refuses a quantity of a fragment that is out of the range.
fn check(index: usize, name: &'static str, value: f64) -> Result<(), AnalysisError> {
    if RANGE.contains(&value) {
        return Ok(());
    }
    Err(AnalysisError::Fragment {
        index,
        name,
        value,
        allowed: "1e-60 to 1e60 in SI units",
    })
}

/// Refuses pieces, given by size and mass, of which there is none or that are out of the range.
fn check_pieces(pieces: &[(f64, f64)]) -> Result<(), AnalysisError> {
    if pieces.is_empty() {
        return Err(AnalysisError::NoFragments);
    }
    for (index, (size, mass)) in pieces.iter().enumerate() {
        check(index, "size", *size)?;
        check(index, "mass", *mass)?;
    }
    Ok(())
}

/// Refuses an option that must be a size, where it is given.
fn check_size(name: &'static str, size: Option<f64>) -> Result<(), AnalysisError> {
    match size {
        Some(value) if !RANGE.contains(&value) => Err(AnalysisError::Option {
            name,
            value,
            allowed: "1e-60 to 1e60 (m)",
        }),
        _ => Ok(()),
    }
}
