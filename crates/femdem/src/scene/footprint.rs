//! Width and depth, written 6x6.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::Error;

/// Width and depth of a box, in body diameters; written "6x6" or "6x7.5".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Footprint {
    /// Along x, in body diameters.
    pub width: f64,
    /// Along y, in body diameters.
    pub depth: f64,
}

impl FromStr for Footprint {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let refused = || Error::Option {
            name: "box",
            value: text.chars().take(40).collect(),
            allowed: "give width x depth in body diameters, each at least 1, such as 6x6",
        };
        let (width, depth) = text.split_once(['x', 'X']).ok_or_else(refused)?;
        let number = |text: &str| match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
            _ => Err(refused()),
        };
        Ok(Self {
            width: number(width)?,
            depth: number(depth)?,
        })
    }
}

impl fmt::Display for Footprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.depth)
    }
}

impl TryFrom<String> for Footprint {
    type Error = Error;

    fn try_from(text: String) -> Result<Self, Error> {
        text.parse()
    }
}

impl From<Footprint> for String {
    fn from(footprint: Footprint) -> Self {
        footprint.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let footprint: Footprint = " 6 x7.5".parse().unwrap();
        assert_eq!(
            footprint,
            Footprint {
                width: 6.0,
                depth: 7.5
            }
        );
        assert_eq!(
            footprint.to_string().parse::<Footprint>().unwrap(),
            footprint
        );
        for bad in ["", "6", "6x", "x6", "6x-1", "NaNx6", "6x6x6", "infx2"] {
            let message = bad.parse::<Footprint>().unwrap_err().to_string();
            assert!(message.contains("such as 6x6"), "{bad}: {message}");
        }
    }
}
