//! The region of a contact on either body.

use super::candidates::ContactBox;
use super::plane::FieldPlane;
use femdem_mesh::{Matrix3, Vector3};

/// Faces of a contact box.
pub(crate) const BOX_FACES: usize = 6;

/// The pose of A in B's axes.
#[derive(Debug)]
pub(crate) struct Pose {
    pub inverse: Matrix3,
    pub a_in_b: Vector3,
}

impl Pose {
    #[inline]
    pub fn new(rotation: &Matrix3, offset: &Vector3) -> Self {
        let inverse = rotation.transpose();
        Self {
            inverse,
            a_in_b: -(inverse * offset),
        }
    }

    #[inline]
    pub fn in_b(&self, region: &ContactBox) -> ContactBox {
        ContactBox {
            axes: region.axes.map(|d| self.inverse * d),
            centre: self.inverse * region.centre + self.a_in_b,
            half: region.half,
        }
    }
}

/// The contact region on one of the bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Region<'a> {
    /// Given in the skin body's axes.
    Here(&'a ContactBox),
    /// Given in other axes, which the pose maps to the skin body's.
    Posed(&'a ContactBox, &'a Pose),
}

impl Region<'_> {
    pub fn face(&self, face: usize) -> FieldPlane {
        match self {
            Self::Here(region) => region.face(face),
            Self::Posed(region, pose) => pose.in_b(region).face(face),
        }
    }
}
