//! The vector area of the skins in a contact: a pass of its own, for pairs with cohesion only.

use super::clip::{Clipper, Cut, Point};
use super::field::{PlaneField, cut_by_field};
use super::plane::FieldPlane;
use super::region::BOX_FACES;
use super::skin::Skin;
use crate::shape::PlaneFrame;
use femdem_mesh::Vector3;

/// Integrals of n and of (x - origin) cross n over a polygon in a plane with the unit normal n.
pub(super) fn add_polygon(
    to: &mut [Vector3; 2],
    polygon: &[Point],
    frame: &PlaneFrame,
    normal: &Vector3,
    origin: &Vector3,
) {
    let Some((first, rest)) = polygon.split_first() else {
        return;
    };
    let (mut area, mut x, mut y) = (0.0, 0.0, 0.0);
    for edge in rest.windows(2) {
        let [p, q] = [&edge[0], &edge[1]].map(|p| Point {
            x: p.x - first.x,
            y: p.y - first.y,
        });
        let part = 0.5 * (p.x * q.y - p.y * q.x);
        area += part;
        x += part / 3.0 * (p.x + q.x);
        y += part / 3.0 * (p.y + q.y);
    }
    let corner = frame.origin + frame.e1 * first.x + frame.e2 * first.y - origin;
    let moment = corner * area + frame.e1 * x + frame.e2 * y;
    to[0] += normal * area;
    to[1] += moment.cross(normal);
}

/// The same over the skin inside the field of the other body, about the skin's origin in its axes.
pub(super) fn of_skin(skin: &Skin, planes: &[FieldPlane], clipper: &mut Clipper) -> [Vector3; 2] {
    let mut sums = [Vector3::zeros(); 2];
    let mut field = PlaneField::new(planes);
    let bounding = usize::from(skin.plan.bounding);
    for plan in &skin.plan.facets {
        let facet = &skin.shape.facets[usize::from(plan.facet)];
        let frame = &facet.frame;
        field.place(frame);
        clipper.load(skin.shape.polygon(facet));
        let within = |k: usize, clipper: &mut Clipper| {
            clipper.cut(&skin.region.face(k).on(frame)) != Cut::Empty
        };
        if cut_by_field(clipper, &field, bounding) && (0..BOX_FACES).all(|k| within(k, clipper)) {
            let normal = &skin.shape.planes[usize::from(facet.plane)].normal;
            add_polygon(&mut sums, clipper.polygon(), frame, normal, &skin.origin);
        }
    }
    sums
}
