//! Units of length of surface files.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The unit of the coordinates in a surface file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// Metres
    #[default]
    M,
    /// Centimetres
    Cm,
    /// Millimetres
    Mm,
    /// Micrometres
    Um,
    /// Inches
    In,
    /// Feet
    Ft,
}

impl Unit {
    /// Length of the unit \[m\].
    #[must_use]
    pub const fn metres(self) -> f64 {
        match self {
            Self::M => 1.0,
            Self::Cm => 1e-2,
            Self::Mm => 1e-3,
            Self::Um => 1e-6,
            Self::In => 0.0254,
            Self::Ft => 0.3048,
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::M => "metres",
            Self::Cm => "centimetres",
            Self::Mm => "millimetres",
            Self::Um => "micrometres",
            Self::In => "inches",
            Self::Ft => "feet",
        })
    }
}
