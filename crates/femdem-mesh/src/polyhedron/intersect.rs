//! Whether two triangles of a surface meet where they should not, decided by exact predicates.
//!
//! Triangles that share an edge may meet only in that edge, those that share a vertex only in that vertex,
//! others nowhere; touching counts as meeting. Signs of determinants are those of exact arithmetic (J. R.
//! Shewchuk, Discrete Comput. Geom. 18 (1997) 305-363), so that there are no tolerances and no undecided cases.

use crate::Point3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Whether two triangles, given by vertex indices, meet outside their shared edge or vertex.
///
/// A triangle whose corners lie exactly on a line has no inside: only its edges count.
pub(super) fn meet(vertices: &[Point3], first: [u32; 3], other: [u32; 3]) -> bool {
    // Shared vertices first, in the same order in both.
    let (first, other, shared) = align(first, other);
    let t = first.map(|i| vertices[i as usize]);
    let u = other.map(|i| vertices[i as usize]);
    match shared {
        0 => apart_meet(&t, &u),
        1 => fans_meet(&t, &u),
        2 => folded(&t, &u),
        _ => true,
    }
}

/// Both triangles rotated and reordered so that the shared vertices come first, and the number of shared
/// vertices. The following tests do not depend on orientation.
fn align(mut first: [u32; 3], mut other: [u32; 3]) -> ([u32; 3], [u32; 3], usize) {
    let mut shared = 0;
    for i in 0..3 {
        if let Some(j) = (shared..3).find(|&j| other[j] == first[i]) {
            first.swap(shared, i);
            other.swap(shared, j);
            shared += 1;
        }
    }
    (first, other, shared)
}

/// Triangles without a common vertex.
fn apart_meet(t: &[Point3; 3], u: &[Point3; 3]) -> bool {
    let sides_u = u.map(|p| side(t, p));
    if one_sided(sides_u) {
        return false;
    }
    let sides_t = t.map(|p| side(u, p));
    if one_sided(sides_t) {
        return false;
    }
    if sides_u == [0; 3] && sides_t == [0; 3] {
        return Flat::of(t, u).is_some_and(|flat| flat.overlap());
    }
    // Convex sets that are not in one plane meet in a segment whose ends lie on edges. An edge in the other's
    // plane need not be tried: its ends belong to edges that do not lie in it.
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        pierces([u[i], u[j]], [sides_u[i], sides_u[j]], t)
            || pierces([t[i], t[j]], [sides_t[i], sides_t[j]], u)
    })
}

/// Triangles that share their first corner: if they meet elsewhere, they do so on a side opposite to it.
fn fans_meet(t: &[Point3; 3], u: &[Point3; 3]) -> bool {
    let sides_u = [side(t, u[1]), side(t, u[2])];
    let sides_t = [side(u, t[1]), side(u, t[2])];
    if sides_u == [0; 2] && sides_t == [0; 2] {
        return Flat::of(t, u).is_some_and(|flat| flat.fans_overlap());
    }
    pierces([u[1], u[2]], sides_u, t) || pierces([t[1], t[2]], sides_t, u)
}

/// Triangles that share their first two corners: they meet elsewhere if one is folded onto the
/// other.
fn folded(t: &[Point3; 3], u: &[Point3; 3]) -> bool {
    side(t, u[2]) == 0 && Flat::of(t, u).is_some_and(|flat| flat.same_side())
}

/// Whether a segment that crosses or touches the plane of a triangle does so inside it. `sides`
/// are those of the segment's ends.
fn pierces(segment: [Point3; 2], sides: [i8; 2], triangle: &[Point3; 3]) -> bool {
    if sides[0] * sides[1] > 0 || sides == [0; 2] {
        return false;
    }
    let [p, q] = segment;
    let [a, b, c] = *triangle;
    let turns = [
        side(&[p, q, a], b),
        side(&[p, q, b], c),
        side(&[p, q, c], a),
    ];
    turns.iter().all(|&s| s >= 0) || turns.iter().all(|&s| s <= 0)
}

/// The side of a triangle's plane on which a point lies; 0 in the plane.
fn side([a, b, c]: &[Point3; 3], p: Point3) -> i8 {
    let at = |p: &Point3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    sign(orient3d(at(a), at(b), at(c), at(&p)))
}

fn one_sided(sides: [i8; 3]) -> bool {
    sides == [1; 3] || sides == [-1; 3]
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// Two triangles in one plane, projected along an axis in which their area does not vanish.
struct Flat {
    t: [Coord<f64>; 3],
    u: [Coord<f64>; 3],
}

impl Flat {
    /// None if the first triangle is a line, or the second.
    fn of(t: &[Point3; 3], u: &[Point3; 3]) -> Option<Self> {
        [[0, 1], [1, 2], [2, 0]].into_iter().find_map(|[x, y]| {
            let seen = |p: &Point3| Coord { x: p[x], y: p[y] };
            let flat = Self {
                t: t.each_ref().map(seen),
                u: u.each_ref().map(seen),
            };
            let area = |[a, b, c]: [Coord<f64>; 3]| orient2d(a, b, c) != 0.0;
            (area(flat.t) && area(flat.u)).then_some(flat)
        })
    }

    fn overlap(&self) -> bool {
        let Self { t, u } = self;
        (0..3).any(|i| reaches([t[i], t[(i + 1) % 3]], u)) || within(u[0], t)
    }

    fn fans_overlap(&self) -> bool {
        let Self { t, u } = self;
        reaches([t[1], t[2]], u) || reaches([u[1], u[2]], t)
    }

    /// Whether the third corners are on the same side of the common edge.
    fn same_side(&self) -> bool {
        let Self { t: [a, b, c], u } = *self;
        turn(a, b, c) == turn(a, b, u[2])
    }
}

fn turn(a: Coord<f64>, b: Coord<f64>, c: Coord<f64>) -> i8 {
    sign(orient2d(a, b, c))
}

/// Whether a segment meets a triangle, its border included.
fn reaches(segment: [Coord<f64>; 2], triangle: &[Coord<f64>; 3]) -> bool {
    within(segment[0], triangle)
        || (0..3).any(|i| cross(segment, [triangle[i], triangle[(i + 1) % 3]]))
}

/// Whether a point lies in a triangle or on its border.
fn within(p: Coord<f64>, [a, b, c]: &[Coord<f64>; 3]) -> bool {
    let turns = [turn(*a, *b, p), turn(*b, *c, p), turn(*c, *a, p)];
    turns.iter().all(|&s| s >= 0) || turns.iter().all(|&s| s <= 0)
}

/// Whether two segments meet, their ends included.
fn cross([a, b]: [Coord<f64>; 2], [c, d]: [Coord<f64>; 2]) -> bool {
    let (abc, abd) = (turn(a, b, c), turn(a, b, d));
    let (cda, cdb) = (turn(c, d, a), turn(c, d, b));
    if [abc, abd, cda, cdb] == [0; 4] {
        let apart = |a: f64, b: f64, c: f64, d: f64| a.max(b) < c.min(d) || c.max(d) < a.min(b);
        return !apart(a.x, b.x, c.x, d.x) && !apart(a.y, b.y, c.y, d.y);
    }
    abc * abd <= 0 && cda * cdb <= 0
}

#[cfg(test)]
mod tests;
