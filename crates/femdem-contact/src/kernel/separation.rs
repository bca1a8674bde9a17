//! Separating directions: a GJK descent on the Minkowski difference.
//!
//! The distance itself is not needed. The descent only proposes directions; the gap reported for a direction
//! is recomputed from the supports, so it is a true lower bound even if the descent fails.

use crate::shape::ConvexShape;
use femdem_mesh::{Matrix3, Vector3};

/// A direction from A to B (unit, A's axes) and the gap between the supports along it, m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Separation {
    pub axis: Vector3,
    pub gap: f64,
}

const MOST_ITERATIONS: usize = 32;

/// Gap between the supports of A and B along `axis` (A's axes); positive: separated.
#[inline]
pub(crate) fn gap_along(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    axis: &Vector3,
) -> f64 {
    let in_b = -rotation.tr_mul(axis);
    axis.dot(offset) - b.support(&in_b) - a.support(axis)
}

/// Searches for a separating direction of A and B, with B posed by `rotation`, `offset` in A's axes. Stops as
/// soon as the gap is at least half the distance found. `None` if the bodies touch or the descent stalls.
pub(crate) fn separate(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    hint: &Vector3,
) -> Option<Separation> {
    let scale = a.radius() + b.radius();
    let mut simplex: Vec<Vector3> = Vec::with_capacity(4);
    // v: the point of the simplex nearest to the origin, of the set B - A.
    let mut v = *hint;
    if v.norm_squared() < 1e-30 {
        v = Vector3::x();
    }
    for _ in 0..MOST_ITERATIONS {
        let norm = v.norm();
        if norm < 1e-14 * scale {
            return None;
        }
        let axis = v / norm;
        let (ib, _) = b.support_vertex(&-rotation.tr_mul(&axis));
        let (ia, _) = a.support_vertex(&axis);
        let w = rotation * b.vertices()[ib] + offset - a.vertices()[ia];
        let gap = axis.dot(&w);
        // The hint is only a direction: a distance is known once there is a simplex.
        let close = !simplex.is_empty() && gap >= 0.5 * norm;
        if gap > 0.0 && (close || simplex.contains(&w)) {
            return Some(Separation { axis, gap });
        }
        if simplex.contains(&w) {
            return None;
        }
        simplex.push(w);
        v = nearest(&mut simplex)?;
    }
    None
}

/// Nearest point of the simplex to the origin; reduces the simplex to the vertices
/// that carry it. `None` if the origin is inside.
fn nearest(simplex: &mut Vec<Vector3>) -> Option<Vector3> {
    match simplex.len() {
        1 => Some(simplex[0]),
        2 => Some(nearest_on_segment(simplex)),
        3 => Some(nearest_on_triangle(simplex)),
        _ => nearest_on_tetrahedron(simplex),
    }
}

fn nearest_on_segment(s: &mut Vec<Vector3>) -> Vector3 {
    let (a, b) = (s[0], s[1]);
    let ab = b - a;
    let t = -a.dot(&ab);
    let length2 = ab.norm_squared();
    if t <= 0.0 || length2 == 0.0 {
        s.truncate(1);
        a
    } else if t >= length2 {
        s.swap_remove(0);
        b
    } else {
        a + ab * (t / length2)
    }
}

/// Nearest point of a triangle by its Voronoi regions (Ericson, Real-Time Collision
/// Detection, 5.1.5), written for the origin as the query point.
fn nearest_on_triangle(s: &mut Vec<Vector3>) -> Vector3 {
    let [a, b, c] = [s[0], s[1], s[2]];
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(&a), -ac.dot(&a));
    let (d3, d4) = (-ab.dot(&b), -ac.dot(&b));
    let (d5, d6) = (-ab.dot(&c), -ac.dot(&c));
    let keep = |s: &mut Vec<Vector3>, points: &[Vector3]| {
        s.clear();
        s.extend_from_slice(points);
    };
    if d1 <= 0.0 && d2 <= 0.0 {
        keep(s, &[a]);
        return a;
    }
    if d3 >= 0.0 && d4 <= d3 {
        keep(s, &[b]);
        return b;
    }
    if d6 >= 0.0 && d5 <= d6 {
        keep(s, &[c]);
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        keep(s, &[a, b]);
        return a + ab * (d1 / (d1 - d3));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        keep(s, &[a, c]);
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        keep(s, &[b, c]);
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    if sum == 0.0 {
        keep(s, &[a]);
        return a;
    }
    a + ab * (vb / sum) + ac * (vc / sum)
}

fn nearest_on_tetrahedron(s: &mut Vec<Vector3>) -> Option<Vector3> {
    let p = [s[0], s[1], s[2], s[3]];
    let mut best: Option<(f64, Vector3, Vec<Vector3>)> = None;
    for [i, j, k, l] in [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]] {
        let normal = (p[j] - p[i]).cross(&(p[k] - p[i]));
        let origin_side = -normal.dot(&p[i]);
        let inner_side = normal.dot(&(p[l] - p[i]));
        if origin_side * inner_side >= 0.0 && inner_side != 0.0 {
            continue;
        }
        let mut face = vec![p[i], p[j], p[k]];
        let v = nearest_on_triangle(&mut face);
        let d = v.norm_squared();
        if best.as_ref().is_none_or(|b| d < b.0) {
            best = Some((d, v, face));
        }
    }
    let (_, v, face) = best?;
    *s = face;
    Some(v)
}
