//! The rotation of a body.

use femdem_mesh::nalgebra::{Quaternion, Unit};
use femdem_mesh::{Rotation, Vector3};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::error::wrong;

/// Most that the length of a quaternion may differ from 1; it is then normalised.
const LENGTH: f64 = 1e-3;

/// A turn: about an axis by an angle, by a quaternion, or by three angles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct RotationEntry {
    /// Axis, of any length.
    pub axis: Option<[f64; 3]>,
    /// Angle about the axis \[degrees\].
    pub angle: Option<f64>,
    /// Unit quaternion w, x, y, z.
    pub quaternion: Option<[f64; 4]>,
    /// Angles about the fixed axes x, y and z of the world, one turn after the other in this order \[degrees\].
    pub euler: Option<[f64; 3]>,
}

impl RotationEntry {
    /// From the coordinates of the shape to directions of the world.
    pub(super) fn rotation(&self) -> Result<Rotation, Error> {
        match (self.axis, self.angle, self.quaternion, self.euler) {
            (Some(axis), Some(angle), None, None) => about(axis, angle),
            (None, None, Some(quaternion), None) => by_quaternion(quaternion),
            (None, None, None, Some(angles)) => {
                if angles.iter().any(|angle| !angle.is_finite()) {
                    let allowed = "three finite angles about x, y and z, in degrees";
                    return Err(wrong("rotation.euler", &format!("{angles:?}"), allowed));
                }
                let [a, b, c] = angles.map(f64::to_radians);
                Ok(Rotation::from_euler_angles(a, b, c))
            }
            _ => Err(wrong(
                "rotation",
                "none or several of its kinds",
                "give axis and angle, or a quaternion, or euler",
            )),
        }
    }
}

fn about(axis: [f64; 3], angle: f64) -> Result<Rotation, Error> {
    let unit = Unit::try_new(Vector3::from(axis), 0.0);
    let unit = unit.filter(|unit| unit.norm() > 0.5).ok_or_else(|| {
        wrong(
            "rotation.axis",
            &format!("{axis:?}"),
            "a direction: three finite numbers, not all zero",
        )
    })?;
    if !angle.is_finite() {
        return Err(wrong(
            "rotation.angle",
            &angle.to_string(),
            "a finite angle, in degrees",
        ));
    }
    Ok(Rotation::from_axis_angle(&unit, angle.to_radians()))
}

fn by_quaternion(parts: [f64; 4]) -> Result<Rotation, Error> {
    let [w, x, y, z] = parts;
    let quaternion = Quaternion::new(w, x, y, z);
    // False for a part that is no number.
    let is_unit = (quaternion.norm() - 1.0).abs() <= LENGTH;
    if !is_unit {
        let allowed = "four numbers w, x, y, z of length 1, to 0.001";
        return Err(wrong("rotation.quaternion", &format!("{parts:?}"), allowed));
    }
    Ok(Rotation::from_quaternion(quaternion))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(text: &str, v: [f64; 3]) -> Vector3 {
        let entry: RotationEntry = toml::from_str(text).unwrap();
        entry.rotation().unwrap() * Vector3::from(v)
    }

    /// Quarter turns move the axes onto each other.
    #[test]
    fn quarter_turns_are_said_in_three_ways() {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let half = 0.5_f64.sqrt();
        for text in [
            "axis = [0, 0, 3]\nangle = 90".to_owned(),
            format!("quaternion = [{half}, 0, 0, {half}]"),
            "euler = [0, 0, 90]".to_owned(),
        ] {
            assert!((turned(&text, x.into()) - y).norm() < 1e-12, "{text}");
            assert!((turned(&text, y.into()) + x).norm() < 1e-12, "{text}");
        }
        // First about x (y to z), then about the y of the world (z to x), then about its z (x to y).
        let three = "euler = [90, 90, 90]";
        assert!((turned(three, y.into()) - y).norm() < 1e-12);
        assert!((turned("euler = [90, 90, 0]", y.into()) - x).norm() < 1e-12);
        assert!((turned("euler = [90, 0, 0]", y.into()) - z).norm() < 1e-12);
    }

    #[test]
    fn what_is_no_turn_is_refused_by_its_key() {
        for (text, words) in [
            ("axis = [0, 0, 1]", "give axis and angle"),
            (
                "euler = [0, 0, 1]\nquaternion = [1, 0, 0, 0]",
                "give axis and angle",
            ),
            ("axis = [0, 0, 0]\nangle = 1", "rotation.axis"),
            ("axis = [0, 0, 1]\nangle = inf", "rotation.angle"),
            ("quaternion = [1, 1, 0, 0]", "rotation.quaternion"),
            ("quaternion = [nan, 1, 0, 0]", "rotation.quaternion"),
            ("euler = [0, nan, 0]", "rotation.euler"),
        ] {
            let entry: RotationEntry = toml::from_str(text).unwrap();
            let message = entry.rotation().unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }
}
