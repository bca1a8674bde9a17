//! One side of a contact: plane polygons (the skin of one body, or a wall) inside the
//! pressure field of the other.

use super::cells::Cells;
use super::clip::{Clipper, Cut, Point};
use super::fast::Fast;
use super::field::{PlaneField, cut_by_field};
use super::plan::FacetPlan;
use super::plane::FieldPlane;
use super::region::{BOX_FACES, Region};
use super::skin::{Lever, SideSums, Skin};
use crate::shape::PlaneFrame;
use femdem_mesh::Vector3;

/// Buffers of the side loop.
#[derive(Debug, Default)]
pub(crate) struct SideScratch {
    pub clipper: Clipper,
    pub cells: Cells,
    pub fast: Fast,
}

/// Cuts the polygon in the clipper by the box, so that nothing outside it is integrated.
fn cut_by_box(clipper: &mut Clipper, region: &Region, frame: &PlaneFrame) -> bool {
    (0..BOX_FACES).all(|face| clipper.cut(&region.face(face).on(frame)) != Cut::Empty)
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
}
