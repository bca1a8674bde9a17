//! One side of a contact: plane polygons (the skin of one body, or a wall) inside the
//! pressure field of the other.

use super::candidates::{Candidates, ContactBox};
use super::cells::{Cells, PlaneSums};
use super::clip::{Clipper, Cut, Line, Point};
use super::field::PlaneField;
use super::rows::Rows;
use crate::shape::{ConvexShape, PlaneFrame};
use femdem_mesh::{Matrix3, Vector3};

/// A plane of the field body in the skin body's axes: phi = (offset - normal.x) * scale.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FieldPlane {
    /// Outward unit normal.
    pub normal: Vector3,
    pub offset: f64,
    pub scale: f64,
}

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
    pub stiffness_second: f64,
    /// Sum of n int dS: the vector area of the skin inside the field.
    pub vector_area: Vector3,
    /// Sum of s int phi dS with s the distance of the polygon's plane from the field's centre.
    pub lever: f64,
    /// Sum of n (x) int x dS: the volume is u.T u for any unit u.
    pub volume_tensor: Matrix3,
}

/// Buffers of the side loop.
#[derive(Debug, Default)]
pub(crate) struct SideScratch {
    pub clipper: Clipper,
    pub cells: Cells,
    rows4: Rows<4>,
    rows8: Rows<8>,
    rows12: Rows<12>,
}

/// Planes of the field body expressed in the skin body's axes. The field body is posed
/// by `rotation`, `offset` in those axes.
pub(crate) fn pose_planes(
    field: &ConvexShape,
    list: &Candidates,
    rotation: &Matrix3,
    offset: &Vector3,
    out: &mut Vec<FieldPlane>,
) {
    out.clear();
    out.extend(list.planes.iter().map(|&k| {
        let plane = &field.planes[usize::from(k)];
        let normal = rotation * plane.normal;
        FieldPlane {
            normal,
            offset: plane.offset + normal.dot(offset),
            scale: 1.0 / plane.offset,
        }
    }));
}

/// Cuts the polygon in the clipper by the box, so that nothing outside it is integrated.
fn cut_by_box(clipper: &mut Clipper, region: &ContactBox, frame: &PlaneFrame) -> bool {
    let from = region.centre - frame.origin;
    [1, 2, 0].iter().all(|&k| {
        let axis = &region.axes[k];
        let mid = axis.dot(&from);
        let upper = Line {
            a: axis.dot(&frame.e1),
            b: axis.dot(&frame.e2),
            c: mid + region.half[k],
        };
        let lower = Line {
            a: -upper.a,
            b: -upper.b,
            c: region.half[k] - mid,
        };
        clipper.cut_all([&upper, &lower])
    })
}

/// The skin body's part in one side, with the region and the field's centre in its axes.
pub(crate) struct Skin<'a> {
    pub shape: &'a ConvexShape,
    pub facets: &'a [u16],
    pub field_centre: Vector3,
    pub region: ContactBox,
}

/// Adds up the facets of the skin inside the field, of which the first `bounding` planes
/// can cut. Moments are about the region's centre.
pub(crate) fn integrate_side(
    skin: &Skin,
    field: &[FieldPlane],
    bounding: usize,
    scratch: &mut SideScratch,
) -> SideSums {
    match field.len() {
        0 => SideSums::default(),
        1..=4 => scratch.rows4.integrate_side(skin, field, bounding),
        5..=8 => scratch.rows8.integrate_side(skin, field, bounding),
        9..=12 => scratch.rows12.integrate_side(skin, field, bounding),
        _ => integrate_side_of_many(skin, field, bounding, scratch),
    }
}

/// As [`integrate_side`], for any number of planes.
pub(crate) fn integrate_side_of_many(
    skin: &Skin,
    planes: &[FieldPlane],
    bounding: usize,
    scratch: &mut SideScratch,
) -> SideSums {
    let mut sums = SideSums::default();
    let mut field = PlaneField::new(planes);
    for &i in skin.facets {
        let facet = &skin.shape.facets[usize::from(i)];
        let frame = &facet.frame;
        field.place(frame);
        scratch.clipper.load(skin.shape.polygon(facet));
        if !cut_by_field(&mut scratch.clipper, &field, bounding)
            || !cut_by_box(&mut scratch.clipper, &skin.region, frame)
        {
            continue;
        }
        let normal = skin.shape.planes[usize::from(facet.plane)].normal;
        let lever = normal.dot(&(frame.origin - skin.field_centre));
        sums.add_polygon(
            frame,
            &normal,
            lever,
            &mut field,
            &skin.region.centre,
            scratch,
        );
    }
    sums
}

/// Cuts the polygon in the clipper by the planes that bound the field.
pub(crate) fn cut_by_field(clipper: &mut Clipper, field: &PlaneField, bounding: usize) -> bool {
    (0..bounding).all(|k| clipper.cut(&field.line(k)) != Cut::Empty)
}

impl SideSums {
    /// Adds the polygon in the clipper; the field is placed on its plane. `lever` is the
    /// distance of that plane from the field's centre along the normal.
    #[inline]
    pub(crate) fn add_polygon(
        &mut self,
        frame: &PlaneFrame,
        normal: &Vector3,
        lever: f64,
        field: &mut PlaneField,
        origin: &Vector3,
        scratch: &mut SideScratch,
    ) {
        let from = origin - frame.origin;
        let origin_2d = Point {
            x: from.dot(&frame.e1),
            y: from.dot(&frame.e2),
        };
        let SideScratch { clipper, cells, .. } = scratch;
        let q = cells.integrate(clipper.polygon(), field, normal, &origin_2d);
        self.add_sums(&q, frame, normal, -from.dot(normal));
        self.lever += lever * q.polygon.pressure;
    }

    /// Adds plane integrals; `height` is the distance of the plane from the origin.
    #[inline]
    pub(crate) fn add_sums(&mut self, q: &PlaneSums, frame: &PlaneFrame, n: &Vector3, height: f64) {
        let in_plane = |p: &Point| frame.e1 * p.x + frame.e2 * p.y;
        let p = &q.polygon;
        let square = height * height;
        self.force += n * p.pressure;
        // (e1 x + e2 y) cross n
        self.torque += frame.e1 * p.pressure_moment.y - frame.e2 * p.pressure_moment.x;
        self.pressure += p.pressure;
        self.pressure_moment += in_plane(&p.pressure_moment) + n * (height * p.pressure);
        self.pressure_second += p.pressure_second + square * p.pressure;
        self.stiffness += q.stiffness;
        self.stiffness_moment += in_plane(&q.stiffness_moment) + n * (height * q.stiffness);
        self.stiffness_second += q.stiffness_second + square * q.stiffness;
        self.vector_area += n * p.area;
        self.add_volume(&(in_plane(&p.moment) + n * (height * p.area)), n);
    }

    fn add_volume(&mut self, moment: &Vector3, normal: &Vector3) {
        self.volume_tensor += normal * moment.transpose();
    }

    /// Adds a polygon on which the field vanishes: it only closes the volume.
    pub(crate) fn add_skin(
        &mut self,
        polygon: &[Point],
        frame: &PlaneFrame,
        normal: &Vector3,
        origin: &Vector3,
    ) {
        let from = origin - frame.origin;
        let origin_2d = Point {
            x: from.dot(&frame.e1),
            y: from.dot(&frame.e2),
        };
        let q = super::clip::integrate(polygon, &origin_2d, &Line::default());
        let moment =
            frame.e1 * q.moment.x + frame.e2 * q.moment.y - normal * (from.dot(normal) * q.area);
        self.add_volume(&moment, normal);
    }
}
