//! The rate of a drag, per second or by the fall of a body.

use std::fmt;
use std::str::FromStr;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use crate::Error;

/// Unit of a rate by the fall of a body: per sqrt(d/g), the time in which it falls half its diameter.
const FALL: &str = "/fall";

/// Unit of a rate per second.
const SECOND: &str = "/s";

/// The rate of a drag: the force on a mass m is -rate m v. Written "8.4/s", or "0.6/fall" in sqrt(g/d).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum Drag {
    /// In 1/s.
    PerSecond(f64),
    /// In sqrt(g/d), with gravity g and the mean circumscribed diameter d.
    ByFall(f64),
}

/// How a scene file has it.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Number(f64),
    Text(String),
}

impl Drag {
    /// No drag.
    pub const NONE: Self = Self::PerSecond(0.0);

    /// In 1/s, for bodies of a diameter \\[m\\] under gravity \\[m/s²\\].
    #[must_use]
    pub fn per_second(self, diameter: f64, gravity: f64) -> f64 {
        match self {
            Self::PerSecond(rate) => rate,
            Self::ByFall(rate) => rate * (gravity.abs() / diameter).sqrt(),
        }
    }
}

fn wrong(value: &str) -> Error {
    Error::Option {
        name: "drag",
        value: value.chars().take(40).collect(),
        allowed: "give a rate, 0 or more, with its unit: such as 8.4/s, or 0.6/fall in sqrt(g/d), as a plain number \
                  of `femdem pack` once was",
    }
}

impl FromStr for Drag {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let (number, by): (_, fn(f64) -> Self) =
            match (text.strip_suffix(SECOND), text.strip_suffix(FALL)) {
                (Some(number), _) => (number, Self::PerSecond),
                (_, Some(number)) => (number, Self::ByFall),
                // None is none in any unit.
                _ => (text, |_| Self::NONE),
            };
        let has_unit = number.len() < text.len();
        let rate: Option<f64> = number.trim().parse().ok();
        rate.filter(|rate| rate.is_finite() && (*rate == 0.0 || (has_unit && *rate > 0.0)))
            .map(by)
            .ok_or_else(|| wrong(text))
    }
}

impl fmt::Display for Drag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PerSecond(rate) => write!(f, "{rate}{SECOND}"),
            Self::ByFall(rate) => write!(f, "{rate}{FALL}"),
        }
    }
}

impl TryFrom<Written> for Drag {
    type Error = Error;

    fn try_from(written: Written) -> Result<Self, Error> {
        match written {
            Written::Number(rate) => rate.to_string().parse(),
            Written::Text(text) => text.parse(),
        }
    }
}

impl From<Drag> for Written {
    fn from(drag: Drag) -> Self {
        match drag {
            Drag::NONE => Self::Number(0.0),
            other => Self::Text(other.to_string()),
        }
    }
}

/// For serde: a rate in 1/s, as a number or with the unit.
pub(crate) fn per_second<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    match Written::deserialize(from)? {
        Written::Number(rate) => Ok(rate),
        Written::Text(text) => match text.parse().map_err(D::Error::custom)? {
            Drag::PerSecond(rate) => Ok(rate),
            Drag::ByFall(_) => Err(D::Error::custom(
                "drag in 1/fall, sqrt(g/d), is for `femdem pack`, whose bodies have one diameter d: give it in 1/s, such as 8.4/s",
            )),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_units() {
        for (text, drag) in [
            ("8.4/s", Drag::PerSecond(8.4)),
            ("0.6/fall", Drag::ByFall(0.6)),
            ("1e2 /s", Drag::PerSecond(100.0)),
            ("0", Drag::NONE),
        ] {
            let read: Drag = text.parse().unwrap();
            assert_eq!(read, drag);
            assert_eq!(drag.to_string().parse::<Drag>().unwrap(), drag);
        }
        assert_eq!(Drag::ByFall(2.0).per_second(0.05, 9.8), 28.0);
        for bad in ["0.6", "-1/s", "x/s", "inf/s", ""] {
            let message = bad.parse::<Drag>().unwrap_err().to_string();
            assert!(message.contains("such as 8.4/s"), "{bad}: {message}");
        }
    }
}
