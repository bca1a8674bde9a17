//! Lengths, in body diameters or in metres.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::Error;

/// A length in body diameters, written "6", or in metres, written "0.3m".
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
        let trimmed = text.trim();
        let (number, in_metres) = match trimmed.strip_suffix('m') {
            Some(number) => (number.trim_end(), true),
            None => (trimmed, false),
        };
        match number.parse::<f64>() {
            Ok(value) if value.is_finite() && value >= 0.0 => Ok(if in_metres {
                Self::Metres(value)
            } else {
                Self::Diameters(value)
            }),
            _ => Err(Error::Option {
                name: "length",
                value: text.chars().take(40).collect(),
                allowed: "give a number of body diameters, such as 6, or of metres, such as 0.3m",
            }),
        }
    }
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
        ] {
            let read: Length = text.parse().unwrap();
            assert_eq!(read, length);
            assert_eq!(length.to_string().parse::<Length>().unwrap(), length);
        }
        assert_eq!(Length::Diameters(6.0).metres(0.1), 0.6000000000000001);
        assert_eq!(Length::Metres(6.0).metres(0.1), 6.0);
        for bad in ["", "m", "6mm", "-1", "NaN", "infm"] {
            let message = bad.parse::<Length>().unwrap_err().to_string();
            assert!(message.contains("such as 0.3m"), "{bad}: {message}");
        }
    }
}
