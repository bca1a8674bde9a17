//! Why a body has no internal forces.

use thiserror::Error;

/// An element without stress, or arrays that do not match the model.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ElementFailure {
    /// An element is inverted, or a node's position is not finite.
    #[error(
        "element {element} has a volume ratio of {volume_ratio:e} at one of its points: it must be \
         positive and finite; take a smaller step, stiffer or lighter contacts, or a finer mesh"
    )]
    Inverted {
        /// Index of the element, that is, of its tetrahedron.
        element: usize,
        /// J = det F there.
        volume_ratio: f64,
    },
    /// The law has no stress for the deformation of an element.
    #[error(
        "the law \"{material}\" has no stress in element {element}, whose volume ratio is \
         {volume_ratio:e}: the deformation is out of the law's range (or a law of yours is not bound)"
    )]
    NoStress {
        /// Index of the element.
        element: usize,
        /// J = det F there.
        volume_ratio: f64,
        /// The law's name.
        material: String,
    },
    /// A node moves too far in one step for what it meets to be noticed.
    #[error(
        "its nodes move at up to {speed:.3e} m/s, {moves:.2} of its depth in a step: lower time_step.safety, \
         or, if it was launched or fell to this speed, set time_step.largest below {step:.1e} s"
    )]
    TooFast {
        /// The fastest node, m/s.
        speed: f64,
        /// Its way in the step over the depth of the body (the inradius of its contact field).
        moves: f64,
        /// A step that would do, s.
        step: f64,
    },
    /// An array does not have the length that the model needs.
    #[error("{what} has {found} entries: the model needs {expected}")]
    Length {
        /// The array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length needed.
        expected: usize,
    },
}

impl ElementFailure {
    /// The element concerned, if any.
    #[must_use]
    pub fn element(&self) -> Option<usize> {
        match self {
            Self::Inverted { element, .. } | Self::NoStress { element, .. } => Some(*element),
            Self::TooFast { .. } | Self::Length { .. } => None,
        }
    }

    /// The volume ratio J = det F of the element concerned, if any.
    #[must_use]
    pub fn volume_ratio(&self) -> Option<f64> {
        match self {
            Self::Inverted { volume_ratio, .. } | Self::NoStress { volume_ratio, .. } => {
                Some(*volume_ratio)
            }
            Self::TooFast { .. } | Self::Length { .. } => None,
        }
    }
}
