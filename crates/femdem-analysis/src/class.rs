//! How two surfaces meet: face, edge or point.

use serde::{Deserialize, Serialize};

/// How two surfaces meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactClass {
    /// A face on a face (or on a wall).
    FaceFace,
    /// An edge on a face, or two edges along each other.
    EdgeFace,
    /// A vertex on anything, or two edges across each other.
    Point,
}

impl ContactClass {
    /// The classes, in the order of tables.
    pub const ALL: [Self; 3] = [Self::FaceFace, Self::EdgeFace, Self::Point];

    /// Class of a patch, by two numbers that do not depend on how deep the bodies overlap.
    ///
    /// **Face or not**: q = A/(δ d) with the mean penetration δ = V/A. Two planes that meet at an
    /// angle θ along a length l overlap in a wedge with q = 2 (l/d)/tan θ; for l = d/2 the limit
    /// q = 8 is θ = 7°. An edge of a cube on a face has q = 2, blunt edges up to about 6.
    ///
    /// **Edge or point**: the exponent n of the force law F ~ δⁿ, 2 for an edge on a face, 3 for a
    /// vertex on a face or an edge across an edge. As U = F δ/(n + 1) and K = n F/δ,
    /// K U/F² = n/(n + 1). The limit is n = 2.5. Without a force it is a point.
    ///
    /// ```
    /// use femdem_analysis::{ContactClass, Patch};
    ///
    /// // A square of side 0.5 m, pressed 1 mm into a face: F = k δ, U = k δ²/2, K = k.
    /// let patch = Patch { area: 0.25, volume: 2.5e-4, energy: 0.5, force: 1e3, stiffness: 1e6, diameter: 1.0 };
    /// assert_eq!(ContactClass::of_patch(&patch), ContactClass::FaceFace);
    /// ```
    #[must_use]
    pub fn of_patch(patch: &Patch) -> Self {
        const FACE: f64 = 8.0;
        const EDGE: f64 = 2.5 / 3.5;
        let Patch {
            area,
            volume,
            energy,
            force,
            stiffness,
            diameter,
        } = *patch;
        if area * area >= FACE * volume * diameter && volume > 0.0 {
            Self::FaceFace
        } else if stiffness * energy <= EDGE * force * force && force > 0.0 {
            Self::EdgeFace
        } else {
            Self::Point
        }
    }

    /// "face-face", "edge-face" or "point".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FaceFace => "face-face",
            Self::EdgeFace => "edge-face",
            Self::Point => "point",
        }
    }

    /// The class with a given name, as returned by [`name`](Self::name).
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.name() == name)
    }

    /// 2 for a face, 1 for an edge, 0 for a point: the dimension of the patch.
    #[must_use]
    pub const fn dimension(self) -> u8 {
        match self {
            Self::FaceFace => 2,
            Self::EdgeFace => 1,
            Self::Point => 0,
        }
    }

    /// Degrees of freedom that a contact of rigid bodies of this class removes from the pair, of six. Without
    /// friction these are one more than the dimension (approach, and rocking where the patch is extended); with
    /// friction also the two directions of sliding, and the spin about the normal where the patch is extended.
    /// So face-face 3 and 6, edge-face 2 and 5, point 1 and 3 (as in Jaoshvili et al. 2010).
    #[must_use]
    pub const fn constraints(self, friction: bool) -> u32 {
        match (self, friction) {
            (Self::FaceFace, false) | (Self::Point, true) => 3,
            (Self::EdgeFace, false) => 2,
            (Self::Point, false) => 1,
            (Self::FaceFace, true) => 6,
            (Self::EdgeFace, true) => 5,
        }
    }
}

/// The quantities from which the class of a contact is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Contact area A (m²).
    pub area: f64,
    /// Overlap volume V (m³).
    pub volume: f64,
    /// Contact energy U (J).
    pub energy: f64,
    /// Elastic normal force F (N).
    pub force: f64,
    /// Normal stiffness K (N/m).
    pub stiffness: f64,
    /// Mean circumscribed diameter d of the bodies (m).
    pub diameter: f64,
}
