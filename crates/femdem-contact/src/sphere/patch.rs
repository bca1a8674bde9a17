//! Sums over a contact of a ball with plane faces, in the axes of these and about the ball's centre, for unit penalty.

use super::disc::Disc;
use super::sums::{FieldSums, SolidSums};
use crate::foundation::{Foundation, FoundationSums};
use crate::kernel::{Overlap, Point, Second};
use crate::shape::PlaneFrame;
use femdem_mesh::{Matrix3, Vector3};
use std::f64::consts::PI;

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Patch {
    /// Force on the ball.
    pub force: Vector3,
    /// int phi dS, int x phi dS, int |x|^2 phi dS.
    pub pressure: f64,
    pub moment: Vector3,
    pub second: f64,
    pub stiffness: FoundationSums,
    /// int n dS over the faces in the ball.
    pub vector_area: Vector3,
    /// int phi dV and int dV over the overlap.
    pub energy: f64,
    pub volume: f64,
}

/// The plane of a face: its outward normal, its signed distance from the ball's centre along it, and axes about the
/// foot of the centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub normal: Vector3,
    pub height: f64,
    pub frame: PlaneFrame,
}

impl Face {
    pub fn new(normal: Vector3, height: f64) -> Self {
        Self {
            normal,
            height,
            frame: PlaneFrame::new(normal * height, &normal),
        }
    }

    /// With the axes of a frame in the plane.
    pub fn along(normal: Vector3, height: f64, frame: &PlaneFrame) -> Self {
        Self {
            normal,
            height,
            frame: PlaneFrame {
                origin: normal * height,
                ..*frame
            },
        }
    }

    /// The foot of the ball's centre.
    pub fn foot(&self) -> &Vector3 {
        &self.frame.origin
    }

    pub fn vector(&self, p: &Point) -> Vector3 {
        self.frame.e1 * p.x + self.frame.e2 * p.y
    }

    /// 1 if the ball's centre lies behind the face, else -1.
    pub fn side(&self) -> f64 {
        if self.height > 0.0 { 1.0 } else { -1.0 }
    }

    /// int y y^T k dA of the points y = foot + x, from the moments about the foot.
    pub fn second(&self, total: f64, first: &Point, second: &Second) -> Matrix3 {
        let PlaneFrame { origin, e1, e2 } = &self.frame;
        let half = origin * (0.5 * total) + self.vector(first);
        let half = origin * half.transpose()
            + e1 * (e1 * (0.5 * second.xx) + e2 * second.xy).transpose()
            + e2 * (e2 * (0.5 * second.yy)).transpose();
        half + half.transpose()
    }
}

impl Patch {
    /// Adds the part of a face in the ball: the ball's field over it, and what it takes from the ball.
    pub fn add_face(&mut self, disc: &Disc, face: &Face, field: &FieldSums, solid: &SolidSums) {
        let scale = 1.0 / disc.radius;
        let foot = face.foot();
        self.force += face.normal * (field.pressure * scale);
        self.pressure += field.pressure * scale;
        self.moment += (foot * field.pressure + face.vector(&field.first)) * scale;
        self.second += (foot.norm_squared() * field.pressure + field.second) * scale;
        self.vector_area += face.normal * solid.area;
        self.energy -= face.side() * field.energy;
        self.volume -= face.side() * solid.volume;
        // n . grad phi = -height/(R s)
        let steep = -face.height * scale;
        if steep > 0.0 {
            let (first, second) = (&field.slope_first, &field.slope_second);
            self.stiffness += FoundationSums {
                total: steep * field.slope,
                first: (foot * field.slope + face.vector(first)) * steep,
                second: face.second(field.slope, first, second) * steep,
            };
        }
    }

    /// Adds the whole ball, whose centre lies in the overlap.
    pub fn add_centre(&mut self, radius: f64) {
        self.energy += PI / 3.0 * radius.powi(3);
        self.volume += 4.0 / 3.0 * PI * radius.powi(3);
    }

    /// The contact on a ball B whose centre is at `between` from A's origin in world axes, for a penalty in Pa;
    /// `rotation` takes the faces' axes to the world's. No force on a ball turns it about its centre.
    pub fn overlap(&self, penalty: f64, rotation: &Matrix3, between: &Vector3) -> Option<Overlap> {
        let force = self.force * penalty;
        let magnitude = force.norm();
        if !(self.pressure > 0.0 && magnitude > 0.0) {
            return None;
        }
        let normal = force / magnitude;
        let centre = self.moment / self.pressure;
        let spread = self.second / self.pressure - centre.norm_squared();
        let stiffness = self.stiffness * penalty;
        let foundation = Foundation::new(&stiffness, &normal, &centre);
        let arm_b = rotation * centre;
        let to_world = rotation * normal;
        Some(Overlap {
            force: to_world * magnitude,
            moment: -arm_b.cross(&(to_world * magnitude)),
            arm_a: arm_b + between,
            arm_b,
            normal: to_world,
            energy: (penalty * self.energy).max(0.0),
            volume: self.volume.max(0.0),
            area: normal.dot(&self.vector_area).max(0.0),
            torsion_radius: foundation.mean_over_rms() * spread.max(0.0).sqrt(),
            foundation: foundation.rotated(rotation),
        })
    }
}
