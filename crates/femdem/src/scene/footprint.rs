//! Width, depth and height of a box, written 6x6, 0.3x0.4m or 526x530x387cm.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{Length, Unit};
use crate::Error;

/// Inner width and depth of a box and the height of its rim, in body diameters ("6x7.5") or with a unit
/// ("0.3x0.4m", "526x530x387cm").
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Footprint {
    /// Along x.
    pub width: Length,
    /// Along y.
    pub depth: Length,
    /// Height of the rim, if it has one.
    pub height: Option<Length>,
}

impl Footprint {
    /// A box without a rim, in body diameters.
    #[must_use]
    pub fn diameters(width: f64, depth: f64) -> Self {
        Self {
            width: Length::Diameters(width),
            depth: Length::Diameters(depth),
            height: None,
        }
    }
}

impl FromStr for Footprint {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let refused = || Error::Option {
            name: "box",
            value: text.chars().take(40).collect(),
            allowed: "give width x depth, and height of the rim if you like, in body diameters, such \
                      as 6x6, or with a unit, such as 5.26x5.3x3.87m or 300x400mm",
        };
        let parts: Vec<(&str, Option<Unit>)> = text.split(['x', 'X']).map(Unit::split).collect();
        // The unit at the end is that of all numbers without one.
        let shared = parts.last().and_then(|(_, unit)| *unit);
        let sizes: Option<Vec<Length>> = parts
            .iter()
            .map(|(number, unit)| {
                let length = match unit.or(shared) {
                    Some(unit) => Length::Metres(unit.length(number)?),
                    None => Length::Diameters(Unit::M.length(number)?),
                };
                (length.metres(1.0) >= 0.0).then_some(length)
            })
            .collect();
        let zero = |length: &Length| length.metres(1.0) == 0.0;
        match sizes.ok_or_else(refused)?.as_slice() {
            sizes if sizes.iter().any(zero) => Err(refused()),
            [width, depth] => Ok(Self {
                width: *width,
                depth: *depth,
                height: None,
            }),
            [width, depth, height] => Ok(Self {
                width: *width,
                depth: *depth,
                height: Some(*height),
            }),
            _ => Err(refused()),
        }
    }
}

impl fmt::Display for Footprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sizes = [Some(self.width), Some(self.depth), self.height];
        let texts: Vec<String> = sizes.iter().flatten().map(Length::to_string).collect();
        // The unit is written once, at the end.
        let last = texts.len() - 1;
        for (k, text) in texts.iter().enumerate() {
            match k {
                _ if k == last => f.write_str(text)?,
                _ => write!(f, "{}x", text.trim_end_matches('m'))?,
            }
        }
        Ok(())
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
        assert_eq!(footprint, Footprint::diameters(6.0, 7.5));
        let bin: Footprint = "5.26x5.3x3.87m".parse().unwrap();
        assert_eq!(bin.width, Length::Metres(5.26));
        assert_eq!(bin.height, Some(Length::Metres(3.87)));
        let mixed: Footprint = "30cm x 400mm".parse().unwrap();
        assert_eq!(
            [mixed.width, mixed.depth],
            [Length::Metres(0.3), Length::Metres(0.4)]
        );
        assert_eq!("300x400mm".parse::<Footprint>().unwrap(), mixed);
        for read in [footprint, bin, "0.3x0.4m".parse().unwrap()] {
            assert_eq!(read.to_string().parse::<Footprint>().unwrap(), read);
        }
        for bad in [
            "", "6", "6x", "x6", "6x-1", "NaNx6", "6x6x6x6", "infx2", "0x3", "6x6km",
        ] {
            let message = bad.parse::<Footprint>().unwrap_err().to_string();
            assert!(message.contains("such as 6x6"), "{bad}: {message}");
        }
    }
}
