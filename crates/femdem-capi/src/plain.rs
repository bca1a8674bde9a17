//! Plain data that passes the border.

use femdem_solve::contact::{Contact, Frame, Load, Partner, Wrench};
use femdem_solve::mesh::nalgebra::{Quaternion, Translation3};
use femdem_solve::mesh::{Pose, Rotation, Vector3, checked_pose};

use crate::border::Failure;

/// Where a body is: the coordinates of its shape, whose origin is the centroid, turned and then moved.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemPose {
    /// Of the centroid, m.
    pub position: [f64; 3],
    /// Quaternion w, x, y, z, of length 1 to 1e-6.
    pub rotation: [f64; 4],
}

/// How a body moves, in world axes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FemdemVelocity {
    /// Of the centroid, m/s.
    pub linear: [f64; 3],
    /// rad/s.
    pub angular: [f64; 3],
}

/// Where a body is and how it moves.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemMotion {
    /// Where it is.
    pub pose: FemdemPose,
    /// How it moves.
    pub velocity: FemdemVelocity,
}

/// A force and a torque, in world axes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FemdemLoad {
    /// N.
    pub force: [f64; 3],
    /// About the centroid of a body, the origin of a wall, N m.
    pub torque: [f64; 3],
}

/// A plane with bodies on one side of it.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemPlane {
    /// Direction towards the bodies, of any length above 0.
    pub normal: [f64; 3],
    /// Its product with a point of the plane: with a normal of length 1 the distance from the origin, m.
    pub offset: f64,
}

/// A box with bodies inside.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemBox {
    /// Lowest corner, m.
    pub low: [f64; 3],
    /// Highest corner, m.
    pub high: [f64; 3],
}

/// A contact, in one patch, of a body or wall A and a body B. Vectors are in world axes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemContact {
    /// Number of the body or wall A.
    pub a: u32,
    /// Number of the body B.
    pub b: u32,
    /// 1 if A is a wall, else 0.
    pub a_is_wall: i32,
    /// Number of the patch, from 0: bodies that are not convex may touch in several.
    pub patch: u32,
    /// 1 if it slides, else 0.
    pub slides: i32,
    /// Centre of pressure, m.
    pub point: [f64; 3],
    /// Unit vector from A to B.
    pub normal: [f64; 3],
    /// Whole force on B, N; A bears the opposite.
    pub force: [f64; 3],
    /// Its part across the normal, N.
    pub friction: [f64; 3],
    /// Its part along the normal, N; negative where it pulls.
    pub normal_force: f64,
    /// Contact area, m^2.
    pub area: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Energy of the normal contact, J.
    pub energy: f64,
    /// Normal stiffness, N/m.
    pub stiffness: f64,
}

impl FemdemPose {
    /// The pose, checked.
    pub(crate) fn checked(&self) -> Result<Pose, Failure> {
        let [w, x, y, z] = self.rotation;
        let rotation = Rotation::new_unchecked(Quaternion::new(w, x, y, z));
        let pose = Pose::from_parts(Translation3::from(self.position), rotation);
        Ok(checked_pose(&pose)?)
    }

    pub(crate) fn frame(&self) -> Result<Frame, Failure> {
        Ok(Frame::from(&self.checked()?))
    }
}

impl From<Pose> for FemdemPose {
    fn from(pose: Pose) -> Self {
        let turn = pose.rotation;
        Self {
            position: pose.translation.vector.into(),
            rotation: [turn.w, turn.i, turn.j, turn.k],
        }
    }
}

impl FemdemMotion {
    /// The place, and the velocity and the angular velocity, checked.
    pub(crate) fn checked(&self) -> Result<(Frame, [Vector3; 2]), Failure> {
        let (frame, velocity) = (self.pose.frame()?, self.velocity.parts());
        let speed: f64 = velocity.iter().map(Vector3::norm).sum();
        if !speed.is_finite() {
            let allowed = "finite in every component";
            return Err(Failure::refused("velocity", speed, allowed));
        }
        Ok((frame, velocity))
    }
}

impl FemdemVelocity {
    pub(crate) fn parts(&self) -> [Vector3; 2] {
        [self.linear.into(), self.angular.into()]
    }
}

impl From<&Wrench> for FemdemLoad {
    fn from(wrench: &Wrench) -> Self {
        Self {
            force: wrench.force.into(),
            torque: wrench.torque.into(),
        }
    }
}

impl From<&Load> for FemdemLoad {
    fn from(load: &Load) -> Self {
        Self::from(&load.total)
    }
}

impl From<&Contact> for FemdemContact {
    fn from(contact: &Contact) -> Self {
        let (a, a_is_wall) = match contact.a {
            Partner::Body(body) => (body, 0),
            Partner::Wall(wall) => (wall, 1),
        };
        let (normal_force, friction) = contact.parts();
        Self {
            a,
            b: contact.b,
            a_is_wall,
            patch: contact.patch,
            slides: i32::from(contact.slides),
            point: contact.point.into(),
            normal: contact.normal.into(),
            force: contact.force_on_b().into(),
            friction: friction.into(),
            normal_force,
            area: contact.area,
            volume: contact.volume,
            energy: contact.potential(),
            stiffness: contact.stiffness,
        }
    }
}
