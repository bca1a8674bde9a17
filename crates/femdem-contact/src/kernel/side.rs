//! One side of a contact: plane polygons (the skin of one body, or a wall) inside the
//! pressure field of the other.

use super::candidates::ContactBox;
use super::cells::{Cells, PlaneSums};
use super::clip::{Clipper, Cut, Line, Point, Second};
use super::fast::Fast;
use super::field::PlaneField;
use super::pair::Pose;
use super::plan::{FacetPlan, SidePlan};
use crate::shape::{ConvexShape, PlaneFrame};
use femdem_mesh::{Matrix3, Vector3};

/// A plane of the field body in the skin body's axes: phi = level - gradient.x.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FieldPlane {
    /// Along the outward normal.
    pub gradient: Vector3,
    pub level: f64,
}

impl FieldPlane {
    /// phi on the plane of a polygon.
    #[inline]
    pub fn on(&self, frame: &PlaneFrame) -> Line {
        Line {
            a: self.gradient.dot(&frame.e1),
            b: self.gradient.dot(&frame.e2),
            c: self.level - self.gradient.dot(&frame.origin),
        }
    }

    /// Stiffness weight for a polygon with unit normal `n`: the rate at which phi grows as
    /// the polygon moves along -n, if it does.
    #[inline]
    pub fn weight(&self, n: &Vector3) -> f64 {
        (-n.dot(&self.gradient)).max(0.0)
    }
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

/// Faces of a contact box.
pub(crate) const BOX_FACES: usize = 6;

/// Buffers of the side loop.
#[derive(Debug, Default)]
pub(crate) struct SideScratch {
    pub clipper: Clipper,
    pub cells: Cells,
    pub fast: Fast,
}

/// Planes of the field body expressed in the skin body's axes. The field body is posed
/// by `rotation`, `offset` in those axes.
#[inline]
pub(crate) fn pose_planes(
    field: &ConvexShape,
    list: &[u16],
    rotation: &Matrix3,
    offset: &Vector3,
    out: &mut Vec<FieldPlane>,
) {
    out.clear();
    out.extend(list.iter().map(|&k| {
        let gradient = rotation * field.planes[usize::from(k)].gauge;
        FieldPlane {
            gradient,
            level: 1.0 + gradient.dot(offset),
        }
    }));
}

/// Cuts the polygon in the clipper by the box, so that nothing outside it is integrated.
fn cut_by_box(clipper: &mut Clipper, region: &Region, frame: &PlaneFrame) -> bool {
    (0..BOX_FACES).all(|face| clipper.cut(&region.face(face).on(frame)) != Cut::Empty)
}

/// Planes that pass the field's centre at less than this fraction of the field body's inradius are too close to the
/// singular point of the [`Brackets`](super::clip::Brackets).
pub(crate) const CLOSE: f64 = 1e-3;

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

/// The contact region on one of the bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Region<'a> {
    /// Given in the skin body's axes.
    Here(&'a ContactBox),
    /// Given in other axes, which the pose maps to the skin body's.
    Posed(&'a ContactBox, &'a Pose),
}

impl Region<'_> {
    fn face(&self, face: usize) -> FieldPlane {
        match self {
            Self::Here(region) => region.face(face),
            Self::Posed(region, pose) => pose.in_b(region).face(face),
        }
    }
}

/// Sums over the facets of the skin inside the field. Moments are about the region's centre. `planes` are
/// those of the plan, posed; the planes of the box faces in the plan are appended to them.
#[inline]
pub(crate) fn integrate_side(
    skin: &Skin,
    planes: &mut Vec<FieldPlane>,
    sums: &mut SideSums,
    scratch: &mut SideScratch,
) {
    if skin.plan.general {
        return integrate_side_of_many(skin, planes, sums, scratch);
    }
    let own = planes.len();
    if skin.plan.box_faces != 0 {
        let named = |face: &usize| skin.plan.box_faces >> face & 1 == 1;
        planes.extend((0..BOX_FACES).filter(named).map(|f| skin.region.face(f)));
    }
    for facet in &skin.plan.facets {
        let done = scratch.fast.add_facet(skin, facet, planes, sums);
        if done.is_err() {
            add_facet_of_many(skin, facet, &planes[..own], sums, scratch);
        }
    }
}

/// As [`integrate_side`], for any number of planes and corners.
pub(crate) fn integrate_side_of_many(
    skin: &Skin,
    planes: &[FieldPlane],
    sums: &mut SideSums,
    scratch: &mut SideScratch,
) {
    for facet in &skin.plan.facets {
        add_facet_of_many(skin, facet, planes, sums, scratch);
    }
}

/// Adds up one facet, cut by all planes and the box whatever its plan says.
fn add_facet_of_many(
    skin: &Skin,
    plan: &FacetPlan,
    planes: &[FieldPlane],
    sums: &mut SideSums,
    scratch: &mut SideScratch,
) {
    let facet = &skin.shape.facets[usize::from(plan.facet)];
    let normal = &skin.shape.planes[usize::from(facet.plane)].normal;
    let frame = &facet.frame;
    let lever = skin.lever(frame, normal);
    let mut field = PlaneField::new(planes);
    field.place(frame);
    scratch.clipper.load(skin.shape.polygon(facet));
    let bounding = usize::from(skin.plan.bounding);
    if cut_by_field(&mut scratch.clipper, &field, bounding)
        && cut_by_box(&mut scratch.clipper, &skin.region, frame)
    {
        let origin = &skin.origin;
        sums.add_polygon(frame, normal, lever, &mut field, origin, scratch);
    }
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
        lever: Lever,
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
        self.add_sums(&q, frame, normal, -from.dot(normal), lever);
    }

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
