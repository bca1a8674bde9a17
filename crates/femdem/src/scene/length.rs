//! Lengths, in body diameters or with a unit.

use std::fmt;
use std::str::FromStr;

use serde::de::{DeserializeOwned, Error as _, Visitor};
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

/// The form of a length in a scene file.
#[derive(Serialize)]
#[serde(untagged)]
pub(crate) enum Written {
    Number(f64),
    Text(String),
}

impl<'de> Deserialize<'de> for Written {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(WrittenVisitor)
    }
}

/// Says what is wanted where neither is found.
struct WrittenVisitor;

impl Visitor<'_> for WrittenVisitor {
    type Value = Written;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a length, such as 0.02 or \"20mm\"")
    }

    fn visit_f64<E>(self, x: f64) -> Result<Written, E> {
        Ok(Written::Number(x))
    }

    fn visit_i64<E>(self, x: i64) -> Result<Written, E> {
        Ok(Written::Number(x as f64))
    }

    fn visit_u64<E>(self, x: u64) -> Result<Written, E> {
        Ok(Written::Number(x as f64))
    }

    fn visit_str<E>(self, text: &str) -> Result<Written, E> {
        Ok(Written::Text(text.to_owned()))
    }
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

/// What holds lengths in metres, as a scene file writes them: each a number of metres, or a text with a unit.
pub(crate) trait InMetres: Sized {
    /// The form in the file.
    type Written: DeserializeOwned;

    /// In metres.
    fn read(written: Self::Written) -> Result<Self, Error>;
}

impl InMetres for f64 {
    type Written = Written;

    fn read(written: Written) -> Result<Self, Error> {
        match written {
            Written::Number(x) => Ok(x),
            Written::Text(text) => metres(&text),
        }
    }
}

impl<T: InMetres> InMetres for Option<T> {
    type Written = T::Written;

    fn read(written: T::Written) -> Result<Self, Error> {
        T::read(written).map(Some)
    }
}

impl<T: InMetres> InMetres for Vec<T> {
    type Written = Vec<T::Written>;

    fn read(written: Self::Written) -> Result<Self, Error> {
        written.into_iter().map(T::read).collect()
    }
}

impl InMetres for [f64; 2] {
    type Written = [Written; 2];

    fn read([x, y]: [Written; 2]) -> Result<Self, Error> {
        Ok([f64::read(x)?, f64::read(y)?])
    }
}

impl InMetres for [f64; 3] {
    type Written = [Written; 3];

    fn read([x, y, z]: [Written; 3]) -> Result<Self, Error> {
        Ok([f64::read(x)?, f64::read(y)?, f64::read(z)?])
    }
}

/// For serde: lengths of a scene file in metres, or with their units.
pub(crate) fn in_metres<'de, D: Deserializer<'de>, T: InMetres>(from: D) -> Result<T, D::Error> {
    T::Written::deserialize(from).and_then(|written| T::read(written).map_err(D::Error::custom))
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

    #[test]
    fn lengths_of_scenes_take_units_alone_and_in_lists() {
        #[derive(Debug, PartialEq, Deserialize)]
        struct Entry {
            #[serde(deserialize_with = "in_metres")]
            one: f64,
            #[serde(default, deserialize_with = "in_metres")]
            perhaps: Option<[f64; 2]>,
            #[serde(deserialize_with = "in_metres")]
            places: Vec<[f64; 3]>,
        }
        let read = |text: &str| toml::from_str::<Entry>(text);
        let entry = Entry {
            one: 0.02,
            perhaps: Some([1.0, 0.03]),
            places: vec![[0.0, -0.5, 0.004]],
        };
        let text = "one = \"20mm\"\nperhaps = [1, \"3cm\"]\nplaces = [[0, -0.5, \"4mm\"]]";
        assert_eq!(read(text).unwrap(), entry);
        let plain = "one = 0.02\nplaces = []";
        assert_eq!(read(plain).unwrap().perhaps, None);
        for (bad, words) in [
            (plain.replace("0.02", "true"), "such as 0.02 or \"20mm\""),
            (plain.replace("0.02", "\"20\u{b5}\""), "such as 20mm"),
            (plain.replace("[]", "[[0, 1]]"), "length"),
        ] {
            let message = read(&bad).unwrap_err().to_string();
            assert!(message.contains(words), "{bad}: {message}");
        }
    }
}
