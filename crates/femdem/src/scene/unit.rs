//! Units of length, of surface files and of numbers.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A unit of length: of the coordinates in a surface file, or of a number such as 3.4mm.
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
    /// A number and its unit, if it has one: "3.4mm", "44 mm", "0.3".
    pub(super) fn split(text: &str) -> (&str, Option<Self>) {
        let text = text.trim();
        // What ends in another unit comes after that.
        let known = [
            ("mm", Self::Mm),
            ("cm", Self::Cm),
            ("um", Self::Um),
            ("µm", Self::Um),
            ("in", Self::In),
            ("ft", Self::Ft),
            ("m", Self::M),
        ];
        let mut found = known.into_iter().filter_map(|(symbol, unit)| {
            let number = text.strip_suffix(symbol)?;
            Some((number.trim_end(), Some(unit)))
        });
        found.next().unwrap_or((text, None))
    }

    /// A length of so many of this unit, from the text of the number \[m\]; `None` if it is no finite number.
    pub(super) fn length(self, number: &str) -> Option<f64> {
        let plain = !number.contains(['e', 'E']);
        // Decimal parts are read as such: 3.4 mm is the number nearest to 0.0034 m.
        let value = match self {
            Self::Cm if plain => format!("{number}e-2").parse(),
            Self::Mm if plain => format!("{number}e-3").parse(),
            Self::Um if plain => format!("{number}e-6").parse(),
            Self::Cm => number.parse().map(|x: f64| x / 1e2),
            Self::Mm => number.parse().map(|x: f64| x / 1e3),
            Self::Um => number.parse().map(|x: f64| x / 1e6),
            Self::M | Self::In | Self::Ft => number.parse().map(|x: f64| x * self.metres()),
        };
        value.ok().filter(|x: &f64| x.is_finite())
    }

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
