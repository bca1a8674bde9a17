//! Sections between bodies that nearly touch.

use super::BondSection;
use crate::axes::complete;
use crate::body_shape::BodyShape;
use crate::error::{ContactError, check};
use crate::shape::{ConvexShape, Frame};
use femdem_mesh::Vector3;

/// Cosine of the angle up to which two faces are parallel: 3 degrees.
const PARALLEL: f64 = 0.9986;

/// Points nearer than this to a plane, over the radius of the body, lie on it.
const ON_PLANE: f64 = 1e-7;

/// Facing faces whose common part is smaller than this, over the face, do not count.
const SLIVER: f64 = 1e-6;

/// The section between two spheres by their centres and radii, m: a disc of `ratio` times the smaller radius in the middle of
/// their gap. `None` if the gap is larger than `gap`, m.
///
/// # Errors
/// [`ContactError::Parameter`] unless the ratio is above 0 and at most 1, and the gap at least 0.
pub fn between_spheres(
    [a, b]: [Vector3; 2],
    [of_a, of_b]: [f64; 2],
    gap: f64,
    ratio: f64,
) -> Result<Option<BondSection>, ContactError> {
    check_reach(gap, ratio)?;
    let between = b - a;
    let distance = between.norm();
    if distance - of_a - of_b > gap || distance == 0.0 {
        return Ok(None);
    }
    let normal = between / distance;
    let centre = (a + normal * of_a + b - normal * of_b) * 0.5;
    BondSection::disc(centre, normal, ratio * of_a.min(of_b)).map(Some)
}

/// The section between two bodies by their shapes and frames: for two spheres [their disc](between_spheres), for two convex
/// polyhedra the common part of the two faces that face each other, at most `gap` (m) apart and parallel to 3 degrees, shrunk
/// about its centroid by `ratio`; the largest of them that is a valid polygon. `None` where there is none, and for other shapes,
/// whose sections are [polygons](BondSection::polygon) of the caller.
///
/// # Errors
/// As [`between_spheres`].
pub fn between_shapes(
    [a, b]: [(&BodyShape, &Frame); 2],
    gap: f64,
    ratio: f64,
) -> Result<Option<BondSection>, ContactError> {
    check_reach(gap, ratio)?;
    match (a.0, b.0) {
        (BodyShape::Sphere(one), BodyShape::Sphere(two)) => {
            let radii = [one.radius(), two.radius()];
            between_spheres([a.1.position, b.1.position], radii, gap, ratio)
        }
        (BodyShape::Convex(one), BodyShape::Convex(two)) => {
            Ok(between_faces([(one, a.1), (two, b.1)], gap, ratio))
        }
        _ => Ok(None),
    }
}

fn check_reach(gap: f64, ratio: f64) -> Result<(), ContactError> {
    let allowed = "at least 0 and finite, in m";
    check("gap of bonds", gap, gap >= 0.0, allowed)?;
    let allowed = "above 0 and at most 1";
    check(
        "ratio of bonds",
        ratio,
        ratio > 0.0 && ratio <= 1.0,
        allowed,
    )
}

/// The common part of the faces of two convex bodies that face each other.
fn between_faces([a, b]: [(&ConvexShape, &Frame); 2], gap: f64, ratio: f64) -> Option<BondSection> {
    let mut best: Option<BondSection> = None;
    // Relative to A, so that no digits are lost far from the origin.
    let shift = b.1.position - a.1.position;
    for plane in &a.0.planes {
        let normal = a.1.rotation * plane.normal;
        for other in &b.0.planes {
            let facing = b.1.rotation * other.normal;
            if normal.dot(&facing) > -PARALLEL {
                continue;
            }
            let mean = (normal - facing).normalize();
            let one: Vec<Vector3> = face(a.0, &plane.normal, plane.offset)
                .map(|x| a.1.rotation * x)
                .collect();
            let two: Vec<Vector3> = face(b.0, &other.normal, other.offset)
                .map(|x| b.1.rotation * x + shift)
                .collect();
            let depth = |face: &[Vector3]| {
                face.iter().map(|x| mean.dot(x)).sum::<f64>() / face.len().max(1) as f64
            };
            let levels = [depth(&one), depth(&two)];
            // As deep an overlap counts as a gap: bodies that were packed overlap a little.
            if (levels[1] - levels[0]).abs() > gap {
                continue;
            }
            let middle = 0.5 * (levels[0] + levels[1]);
            let [_, e1, e2] = complete(&mean);
            let flat = |face: &[Vector3]| ordered(face.iter().map(|x| [e1.dot(x), e2.dot(x)]));
            let (one, two) = (flat(&one), flat(&two));
            let whole = area(&one).min(area(&two));
            let common = clipped(one, &two);
            if area(&common) <= SLIVER * whole {
                continue;
            }
            let place = |x: &[f64; 2]| e1 * x[0] + e2 * x[1] + mean * middle + a.1.position;
            let corners: Vec<Vector3> = common.iter().map(place).collect();
            // Corners that rounding has brought out of order make no section.
            let Ok(section) = BondSection::polygon(&corners, mean) else {
                continue;
            };
            if best
                .as_ref()
                .is_none_or(|best| section.area() > best.area())
            {
                best = Some(section);
            }
        }
    }
    let best = best?;
    let centre = best.centre();
    let shrink = |x: &Vector3| centre + (x - centre) * ratio;
    let corners: Vec<Vector3> = best.corners().iter().map(shrink).collect();
    BondSection::polygon(&corners, best.normal()).ok()
}

/// Vertices of a face, in body axes.
fn face(shape: &ConvexShape, normal: &Vector3, offset: f64) -> impl Iterator<Item = Vector3> {
    let least = offset - ON_PLANE * shape.radius();
    shape
        .vertices()
        .iter()
        .copied()
        .filter(move |x| normal.dot(x) >= least)
}

/// Corners of a convex polygon, counter-clockwise.
fn ordered(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.collect();
    let count = points.len().max(1) as f64;
    let mean = [0, 1].map(|k| points.iter().map(|x| x[k]).sum::<f64>() / count);
    let angle = |x: &[f64; 2]| (x[1] - mean[1]).atan2(x[0] - mean[0]);
    points.sort_by(|x, y| angle(x).total_cmp(&angle(y)));
    points
}

fn cross(o: [f64; 2], p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let Some(&first) = polygon.first() else {
        return 0.0;
    };
    0.5 * polygon
        .windows(2)
        .map(|w| cross(first, w[0], w[1]))
        .sum::<f64>()
}

/// The part of a convex polygon in another; both are counter-clockwise (Sutherland and Hodgman 1974).
fn clipped(polygon: Vec<[f64; 2]>, by: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let least = 1e-9 * area(by);
    let mut kept = polygon;
    for i in 0..by.len() {
        let (p, q) = (by[i], by[(i + 1) % by.len()]);
        // A corner that lies on the edge stays as it is, so that faces that coincide give themselves.
        let height = |x: [f64; 2]| {
            let height = cross(p, q, x);
            if height.abs() < least { 0.0 } else { height }
        };
        let mut next = Vec::with_capacity(kept.len() + 1);
        for k in 0..kept.len() {
            let (x, y) = (kept[k], kept[(k + 1) % kept.len()]);
            let (u, v) = (height(x), height(y));
            if u >= 0.0 {
                next.push(x);
            }
            if u * v < 0.0 {
                let t = u / (u - v);
                next.push([0, 1].map(|k| x[k] + (y[k] - x[k]) * t));
            }
        }
        kept = next;
    }
    let least = 1e-12 * area(by);
    let is_near =
        |x: [f64; 2], y: [f64; 2]| (0..2).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>() < least;
    kept.dedup_by(|x, y| is_near(*x, *y));
    while kept.len() > 1 && is_near(kept[0], kept[kept.len() - 1]) {
        kept.pop();
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::clipped;

    /// Where the first corner is cut off by next to nothing one is left of it, though its two are the ends of the list.
    #[test]
    fn corners_that_nearly_coincide_are_one() {
        let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let cut = 1e-8;
        // Its long edge is x + y = cut.
        let triangle = [[3.0, cut - 3.0], [3.0, 3.0], [cut - 3.0, 3.0]];
        let common = clipped(square, &triangle);
        assert_eq!(common.len(), 4, "{common:?}");
    }
}
