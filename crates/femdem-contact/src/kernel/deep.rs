//! Volumes of overlaps so deep that polygons pass close to the centres of the fields.

use super::cells::Cells;
use super::clip::{Clipper, Point};
use super::field::{CLOSE, PlaneField, cut_by_field};
use super::plane::FieldPlane;
use crate::shape::{ConvexShape, PlaneFrame};
use femdem_mesh::{Matrix3, Vector3};

/// Points tried as poles, times the inradius: in no symmetric place.
const POLES: [[f64; 3]; 4] = [
    [0.31, 0.23, 0.17],
    [-0.29, 0.19, -0.13],
    [0.11, -0.37, -0.21],
    [-0.07, -0.41, 0.33],
];

/// What polygons enclose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Inner {
    /// What lies behind all of them: a convex body.
    All,
    /// What lies behind any of them: a wall.
    Any,
}

/// Volume of the part of a convex body inside another, in whose axes it is posed by `rotation`, `offset`, m^3.
pub(super) fn volume_within(
    body: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    other: &ConvexShape,
) -> f64 {
    let faces = other.facets.iter().map(|facet| {
        let normal = other.planes[usize::from(facet.plane)].normal;
        (other.polygon(facet), facet.frame, normal)
    });
    volume_behind(body, rotation, offset, Inner::All, faces)
}

/// Volume of the part of a convex body that lies in what plane polygons enclose, m^3. The body is posed by `rotation`,
/// `offset` in the axes of the polygons, which have their outward normals.
///
/// As by [`Brackets`](super::clip::Brackets), about a point of the body that is close to none of the planes: any
/// point inside serves as the centre of a gauge that is 1 on the skin.
pub(super) fn volume_behind<'a>(
    body: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    inner: Inner,
    faces: impl Iterator<Item = (&'a [Point], PlaneFrame, Vector3)> + Clone,
) -> f64 {
    let place = |pole: &Vector3| offset + rotation * pole;
    let lever = |frame: &PlaneFrame, normal: &Vector3, pole: &Vector3| {
        normal.dot(&(frame.origin - place(pole)))
    };
    let clearance = |pole: &Vector3| {
        let levers = faces
            .clone()
            .map(|(_, frame, n)| lever(&frame, &n, pole).abs());
        levers.fold(f64::INFINITY, f64::min)
    };
    let mut best = (Vector3::zeros(), -1.0);
    for pole in POLES {
        let pole = Vector3::from(pole) * body.inradius();
        let clear = clearance(&pole);
        if clear > best.1 {
            best = (pole, clear);
        }
        if clear > CLOSE * body.inradius() {
            break;
        }
    }
    let (pole, _) = best;
    let planes: Vec<FieldPlane> = body
        .planes
        .iter()
        .map(|plane| {
            let gradient = rotation * (plane.normal / (plane.offset - plane.normal.dot(&pole)));
            FieldPlane {
                gradient,
                level: 1.0 + gradient.dot(&place(&pole)),
            }
        })
        .collect();
    let (mut clipper, mut cells) = (Clipper::default(), Cells::default());
    let mut field = PlaneField::new(&planes);
    let mut volume = 0.0;
    let (mut behind, mut count) = (0, 0);
    for (polygon, frame, normal) in faces.clone() {
        let distance = lever(&frame, &normal, &pole);
        behind += usize::from(distance > 0.0);
        count += 1;
        clipper.load(polygon);
        field.place(&frame);
        if !polygon.is_empty() && cut_by_field(&mut clipper, &field, planes.len()) {
            let sums = cells.integrate(clipper.polygon(), &mut field, &normal, &Point::default());
            volume += distance * sums.brackets.volume;
        }
    }
    let inside = match inner {
        Inner::All => behind == count,
        Inner::Any => behind > 0,
    };
    if inside {
        volume += body.volume();
    }
    volume
}
