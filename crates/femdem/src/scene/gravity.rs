//! Gravity as a number or a vector.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// How a scene file has it.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected gravity along -z such as 9.81, or a vector such as [0, 0, -9.81], in m/s²"
)]
enum Written {
    Down(f64),
    Vector([f64; 3]),
}

/// For serde: the size of gravity along -z \\[m/s²\\].
pub(super) fn down<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    match Written::deserialize(from)? {
        Written::Down(size) => Ok(size),
        Written::Vector([0.0, 0.0, z]) => Ok(-z),
        Written::Vector(other) => Err(D::Error::custom(format!(
            "gravity = {other:?} is not along -z, as that of a pack must be: give a number, such as 9.81"
        ))),
    }
}

/// For serde: gravity as a vector \\[m/s²\\].
pub(crate) fn vector<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f64; 3]>, D::Error> {
    Ok(Some(match Written::deserialize(from)? {
        Written::Down(size) => [0.0, 0.0, -size],
        Written::Vector(vector) => vector,
    }))
}
