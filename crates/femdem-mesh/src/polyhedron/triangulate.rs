//! Cutting planar polygons into triangles.

use crate::{Point3, Vector3};

/// The fan of a loop from its first vertex. Signed integrals over it are correct for any planar polygon, convex
/// or not.
pub(super) fn fan(face: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    face.windows(2)
        .skip(1)
        .map(|side| [face[0], side[0], side[1]])
}

/// Usual limit of the sharpness of triangles (twice the area over the sum of two squared sides), below which
/// they are avoided: triangles whose vertices lie on a line have no normal.
pub(crate) const SHARP: f64 = 1e-9;

/// Appends triangles that cover the face: its fan if the face is convex and all triangles of the
/// fan are `sharp` or more, else by ear clipping.
pub(crate) fn triangulate(
    vertices: &[Point3],
    face: &[u32],
    normal: &Vector3,
    sharp: f64,
    triangles: &mut Vec<[u32; 3]>,
) {
    // The turn at b on the way from a to c, positive to the left seen from outside.
    let turn = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(|i| vertices[i as usize]);
        (b - a).cross(&(c - b)).dot(normal)
    };
    let is_sharp = |[a, b, c]: [u32; 3]| {
        let [p, q, r] = [a, b, c].map(|i| vertices[i as usize]);
        turn([a, b, c]) > sharp * ((q - p).norm_squared() + (r - q).norm_squared())
    };
    if face.len() <= 3 || (fan(face).all(is_sharp) && is_convex(face, turn)) {
        triangles.extend(fan(face));
        return;
    }
    let mut remaining = face.to_vec();
    // The search continues where the last ear was, which keeps the number of trials low.
    let mut at = 0;
    while remaining.len() > 3 {
        let n = remaining.len();
        let corner = |i: usize| {
            [
                remaining[(i + n - 1) % n],
                remaining[i % n],
                remaining[(i + 1) % n],
            ]
        };
        let is_ear = |i: usize| {
            let [a, b, c] = corner(i);
            let inside =
                |p: u32| turn([a, b, p]) >= 0.0 && turn([b, c, p]) >= 0.0 && turn([c, a, p]) >= 0.0;
            let others = remaining.iter().filter(|&&p| p != a && p != b && p != c);
            turn([a, b, c]) > 0.0 && others.copied().all(|p| !inside(p))
        };
        // Whether another corner lies on the side left by the ear, where rounding may hide it from the search
        // for ears: a triangle on that side would have no area.
        let leaves_area = |i: usize| {
            let [a, b, c] = corner(i);
            let between = |p: u32| {
                let [a, c, p] = [a, c, p].map(|i| vertices[i as usize]);
                (p - a).dot(&(c - a)) > 0.0 && (p - c).dot(&(a - c)) > 0.0
            };
            let on_side = |p: u32| !is_sharp([a, p, c]) && !is_sharp([c, p, a]) && between(p);
            let others = remaining.iter().filter(|&&p| p != a && p != b && p != c);
            !others.copied().any(on_side)
        };
        // A simple polygon always has an ear; rounding, or a loop that cuts itself, may hide it.
        let ear = (at..at + n)
            .find(|&i| is_sharp(corner(i)) && is_ear(i) && leaves_area(i))
            .or_else(|| (at..at + n).find(|&i| is_sharp(corner(i)) && is_ear(i)))
            .or_else(|| (at..at + n).find(|&i| is_ear(i)))
            .unwrap_or(at);
        triangles.push(corner(ear));
        at = ear % n;
        remaining.remove(at);
    }
    triangles.extend(fan(&remaining));
}

fn is_convex(face: &[u32], turn: impl Fn([u32; 3]) -> f64) -> bool {
    let n = face.len();
    (0..n).all(|i| turn([face[i], face[(i + 1) % n], face[(i + 2) % n]]) >= 0.0)
}
