//! The skin of one body in a contact, and the integrals over what of it lies in the field.

use super::cells::PlaneSums;
use super::clip::{Point, Second};
use super::plan::SidePlan;
use super::region::Region;
use crate::shape::{ConvexShape, PlaneFrame};
use femdem_mesh::{Matrix3, Vector3};

/// Integrals over the polygons inside the field, in the skin body's axes about an origin,
/// for unit penalty.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SideSums {
    /// Sum of n int phi dS.
    pub force: Vector3,
    /// Sum of int phi x dS cross n.
    pub torque: Vector3,
    /// Sum of int phi dS, int x phi dS, int |x|^2 phi dS.
    pub pressure: f64,
    pub pressure_moment: Vector3,
    pub pressure_second: f64,
    /// Minus the trace of the contact Hessian, and its first and second moments.
    pub stiffness: f64,
    pub stiffness_moment: Vector3,
    pub stiffness_second: Matrix3,
    /// Sum of n int dS: the vector area of the skin inside the field.
    pub vector_area: Vector3,
    /// Integrals of phi and of 1 over the overlap; see [`Brackets`](super::clip::Brackets). What a field's
    /// centre inside the overlap contributes is not included.
    pub energy: f64,
    pub volume: f64,
    /// Sum of s int phi dS with s the distance of the polygon's plane from the field's centre.
    pub lever: f64,
    /// Whether a polygon passes too close to the field's centre: `energy` and `volume` are not usable then.
    pub singular: bool,
}

impl SideSums {
    /// Adds plane integrals; `height` is the distance of the plane from the origin.
    #[inline]
    pub(crate) fn add_sums(
        &mut self,
        q: &PlaneSums,
        frame: &PlaneFrame,
        n: &Vector3,
        height: f64,
        lever: Lever,
    ) {
        let in_plane = |p: &Point| frame.e1 * p.x + frame.e2 * p.y;
        let p = &q.polygon;
        self.force += n * p.pressure;
        // (e1 x + e2 y) cross n
        self.torque += frame.e1 * p.pressure_moment.y - frame.e2 * p.pressure_moment.x;
        self.pressure += p.pressure;
        self.pressure_moment += in_plane(&p.pressure_moment) + n * (height * p.pressure);
        self.pressure_second += p.pressure_second + height * height * p.pressure;
        if q.stiffness > 0.0 {
            self.stiffness += q.stiffness;
            let moment = in_plane(&q.stiffness_moment);
            self.stiffness_moment += moment + n * (height * q.stiffness);
            // int x x^T w dS with x = e1 x + e2 y + n height.
            let Second { xx, xy, yy } = q.stiffness_second;
            let up = moment * height + n * (0.5 * height * height * q.stiffness);
            let half = frame.e1 * (0.5 * xx) + frame.e2 * xy;
            let half = half * frame.e1.transpose()
                + frame.e2 * (frame.e2 * (0.5 * yy)).transpose()
                + up * n.transpose();
            self.stiffness_second += half + half.transpose();
        }
        self.vector_area += n * p.area;
        self.lever += lever.distance * p.pressure;
        if lever.distance.abs() > lever.close {
            self.energy += lever.distance * q.brackets.energy;
            self.volume += lever.distance * q.brackets.volume;
        } else {
            self.singular = true;
        }
    }
}

/// The skin body's data for one side, with the region and the field's centre in its axes.
pub(crate) struct Skin<'a> {
    pub shape: &'a ConvexShape,
    pub plan: &'a SidePlan,
    pub field_centre: Vector3,
    /// [`CLOSE`] to that centre, m.
    pub close: f64,
    /// Centre of the region: the origin of the moments.
    pub origin: Vector3,
    pub region: Region<'a>,
}

impl Skin<'_> {
    /// A polygon's plane seen from the field's centre.
    #[inline]
    pub(crate) fn lever(&self, frame: &PlaneFrame, normal: &Vector3) -> Lever {
        Lever {
            distance: normal.dot(&(frame.origin - self.field_centre)),
            close: self.close,
        }
    }
}

/// Distance of a polygon's plane from the field's centre along the polygon's normal, and the distance that is too close to
/// it, m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lever {
    pub distance: f64,
    pub close: f64,
}
