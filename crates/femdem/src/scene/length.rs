//! Lengths, in body diameters or with a unit.

use std::fmt;
use std::str::FromStr;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::Unit;
use crate::Error;

/// A length in body diameters, written "6", or with a unit, written "0.3m", "44mm", "2in".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum Length {
    /// In body diameters d.
    Diameters(f64),
    /// In m.
    Metres(f64),
}

/// The form of a length in a scene file: a plain number is in diameters.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Text(String),
}

impl Length {
    /// In metres, for bodies of a diameter \[m\].
    #[must_use]
    pub fn metres(self, diameter: f64) -> f64 {
        match self {
            Self::Diameters(x) => x * diameter,
            Self::Metres(x) => x,
        }
    }
}

impl FromStr for Length {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let (number, unit) = Unit::split(text);
        let value = match unit {
            Some(unit) => unit.length(number).map(Self::Metres),
            None => Unit::M.length(number).map(Self::Diameters),
        };
        value
            .filter(|length| length.metres(1.0) >= 0.0)
            .ok_or_else(|| Error::Option {
                name: "length",
                value: text.chars().take(40).collect(),
                allowed: "give a number of body diameters, such as 6, or a length with its unit (m, cm, mm, um, in, ft), \
                          such as 0.3m or 44mm",
            })
    }
}

/// Reads a length without reference to bodies: a number of metres, or a number with its unit \[m\].
///
/// # Errors
///
/// [`Error::Option`] for what is neither.
///
/// ```
/// assert_eq!(femdem::scene::metres("20mm")?, 0.02);
/// assert_eq!(femdem::scene::metres("0.02")?, 0.02);
/// # Ok::<(), femdem::Error>(())
/// ```
pub fn metres(text: &str) -> Result<f64, Error> {
    let (number, unit) = Unit::split(text);
    let value = unit.unwrap_or_default().length(number);
    value.ok_or_else(|| Error::Option {
        name: "length",
        value: text.chars().take(40).collect(),
        allowed: "give metres, such as 0.02, or a length with its unit (m, cm, mm, um, in, ft), such as 20mm",
    })
}

/// For serde: a length of a scene file in metres, or with its unit.
pub(crate) fn in_metres<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    match Written::deserialize(from)? {
        Written::Number(x) => Ok(x),
        Written::Text(text) => metres(&text).map_err(D::Error::custom),
    }
}

/// The same for a length that may be left out.
pub(crate) fn perhaps_in_metres<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<f64>, D::Error> {
    in_metres(from).map(Some)
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Diameters(x) => write!(f, "{x}"),
            Self::Metres(x) => write!(f, "{x}m"),
        }
    }
}

impl TryFrom<Written> for Length {
    type Error = Error;

    fn try_from(written: Written) -> Result<Self, Error> {
        match written {
            Written::Number(x) => x.to_string().parse(),
            Written::Text(text) => text.parse(),
        }
    }
}

impl From<Length> for Written {
    fn from(length: Length) -> Self {
        match length {
            Length::Diameters(x) => Self::Number(x),
            Length::Metres(_) => Self::Text(length.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        for (text, length) in [
            ("6", Length::Diameters(6.0)),
            (" 0.3 m", Length::Metres(0.3)),
            ("1e-3m", Length::Metres(1e-3)),
            ("44mm", Length::Metres(0.044)),
            ("3.4 cm", Length::Metres(0.034)),
            ("2in", Length::Metres(0.0508)),
            ("1e2um", Length::Metres(1e-4)),
        ] {
            let read: Length = text.parse().unwrap();
            assert_eq!(read, length);
            assert_eq!(length.to_string().parse::<Length>().unwrap(), length);
        }
        assert_eq!(Length::Diameters(6.0).metres(0.1), 0.6000000000000001);
        assert_eq!(Length::Metres(6.0).metres(0.1), 6.0);
        for bad in ["", "m", "6km", "-1", "-1mm", "NaN", "infm", "NaNmm"] {
            let message = bad.parse::<Length>().unwrap_err().to_string();
            assert!(message.contains("such as 0.3m"), "{bad}: {message}");
        }
    }
}
