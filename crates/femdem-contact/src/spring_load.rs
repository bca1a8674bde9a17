//! What the springs of a contact carry across its normal and against turning.

use crate::contact::RigidContact;
use crate::error::{ContactError, check};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// What the springs of friction and of rolling friction of a contact carry, without the dashpots beside them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SpringLoad {
    /// Friction on B, N.
    pub force: Vector3,
    /// Moment of friction on B about the normal, N m.
    pub torsion: f64,
    /// Moment of rolling friction on B, N m.
    pub rolling: Vector3,
}

/// The springs of one patch of several.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub load: SpringLoad,
    /// Where the force acts, m.
    pub point: Vector3,
    pub normal: Vector3,
    /// N.
    pub normal_force: f64,
}

impl SpringLoad {
    /// The same if the two sides have changed places: the moment about the normal is the same seen from either.
    #[must_use]
    pub fn seen_from(self, swapped: bool) -> Self {
        let side = |v: Vector3| if swapped { -v } else { v };
        Self {
            force: side(self.force),
            torsion: self.torsion,
            rolling: side(self.rolling),
        }
    }

    /// A part of it.
    pub(crate) fn share(&self, part: f64) -> Self {
        Self {
            force: self.force * part,
            torsion: self.torsion * part,
            rolling: self.rolling * part,
        }
    }

    /// What several patches of a pair carry together. The moment about the normal is that about their centre of pressure: with the points
    /// x_i, Σ (τ_i + n·((x_i − c) × F_i)), c = Σ N_i x_i / Σ N_i.
    pub(crate) fn of_pair(parts: &[Part]) -> Self {
        let pressing: f64 = parts.iter().map(|part| part.normal_force).sum();
        let mean = |of: fn(&Part) -> Vector3| match pressing > 0.0 {
            true => {
                parts
                    .iter()
                    .map(|p| of(p) * p.normal_force)
                    .sum::<Vector3>()
                    / pressing
            }
            false => parts.iter().map(of).sum::<Vector3>() / parts.len().max(1) as f64,
        };
        let centre = mean(|part| part.point);
        let normal = mean(|part| part.normal);
        let normal = normal.try_normalize(0.0).unwrap_or_default();
        let mut sum = Self::default();
        for Part { load, point, .. } in parts {
            sum.force += load.force;
            sum.torsion += load.torsion + normal.dot(&(point - centre).cross(&load.force));
            sum.rolling += load.rolling;
        }
        sum
    }

    pub(crate) fn check(&self) -> Result<(), ContactError> {
        let force = self.force.norm();
        check("force", force, true, "finite in every component, in N")?;
        check("torsion", self.torsion, true, "finite, in N m")?;
        let rolling = self.rolling.norm();
        check(
            "rolling",
            rolling,
            true,
            "finite in every component, in N m",
        )
    }
}

impl From<&RigidContact> for Part {
    fn from(contact: &RigidContact) -> Self {
        Self {
            load: SpringLoad {
                force: contact.friction - contact.drag,
                torsion: contact.torsion - contact.drag_torsion,
                rolling: contact.rolling - contact.drag_rolling,
            },
            point: contact.point,
            normal: contact.normal,
            normal_force: contact.normal_force,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two patches 2 m apart on z = 0, whose forces are a couple of 6 N m.
    #[test]
    fn a_couple_of_two_patches_is_a_torsion() {
        let part = |x: f64, fy: f64| Part {
            load: SpringLoad {
                force: Vector3::new(1.0, fy, 0.0),
                torsion: 0.5,
                rolling: Vector3::x(),
            },
            point: Vector3::x() * x,
            normal: Vector3::z(),
            normal_force: 4.0,
        };
        let sum = SpringLoad::of_pair(&[part(-1.0, -3.0), part(1.0, 3.0)]);
        assert_eq!(sum.force, Vector3::x() * 2.0);
        assert_eq!(sum.torsion, 7.0);
        assert_eq!(sum.rolling, Vector3::x() * 2.0);
        assert_eq!(SpringLoad::of_pair(&[]), SpringLoad::default());
    }
}
