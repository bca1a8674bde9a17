//! Triangles of a plane region with holes.

use crate::MeshError;
use robust::Coord;
use std::collections::BTreeMap;

/// A point of the plane.
pub(super) type Point2 = Coord<f64>;

/// Constrained Delaunay triangles, counter-clockwise, of the region inside `outer` (a simple loop,
/// counter-clockwise) and outside `holes` (simple loops, clockwise, disjoint). Indices go through
/// `outer` and then through the holes.
///
/// Holes are bridged to the outer loop, the loop is cut by its ears, and edges are flipped until
/// every one is locally Delaunay (C. L. Lawson, in Mathematical Software III, 1977, 161-194), with
/// exact predicates.
pub(super) fn triangulate(
    outer: &[Point2],
    holes: &[Vec<Point2>],
) -> Result<Vec<[usize; 3]>, MeshError> {
    let points: Vec<Point2> = outer
        .iter()
        .chain(holes.iter().flatten())
        .copied()
        .collect();
    let mut ring: Vec<usize> = (0..outer.len()).collect();
    let mut loops = vec![ring.clone()];
    let mut next = outer.len();
    for hole in holes {
        loops.push((next..next + hole.len()).collect());
        next += hole.len();
    }
    for hole in loops.iter().skip(1) {
        ring = bridged(&points, &loops, ring, hole).ok_or_else(no_triangles)?;
    }
    let mut triangles = cut_ears(&points, ring).ok_or_else(no_triangles)?;
    flip_to_delaunay(&points, &mut triangles);
    Ok(triangles)
}

fn no_triangles() -> MeshError {
    MeshError::OutOfRange {
        what: "the number of triangles found for a cap with holes",
        value: 0.0,
        allowed: "at least 1: choose fewer sides or thicker walls",
    }
}

/// Exact sign: positive if c lies to the left of the line from a to b.
fn turn(points: &[Point2], a: usize, b: usize, c: usize) -> f64 {
    robust::orient2d(points[a], points[b], points[c])
}

/// Whether the closed segments ab and cd meet; those with a common end do not count.
fn meet(points: &[Point2], [a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
    if a == c || a == d || b == c || b == d {
        return false;
    }
    turn(points, a, b, c) * turn(points, a, b, d) <= 0.0
        && turn(points, c, d, a) * turn(points, c, d, b) <= 0.0
}

/// The ring with the hole joined to it by the shortest bridge, to a vertex not yet bridged.
fn bridged(
    points: &[Point2],
    loops: &[Vec<usize>],
    ring: Vec<usize>,
    hole: &[usize],
) -> Option<Vec<usize>> {
    let single = |v: usize| ring.iter().filter(|&&w| w == v).count() == 1;
    let mut candidates: Vec<(f64, usize, usize)> = Vec::new();
    for (at, &v) in ring.iter().enumerate().filter(|&(_, &v)| single(v)) {
        for (start, &w) in hole.iter().enumerate() {
            let length = (points[v].x - points[w].x).hypot(points[v].y - points[w].y);
            candidates.push((length, at, start));
        }
    }
    candidates.sort_by(|p, q| p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))));
    let crosses = |bridge: [usize; 2]| {
        let of = |corners: &[usize]| {
            (0..corners.len())
                .map(|i| [corners[i], corners[(i + 1) % corners.len()]])
                .any(|side| meet(points, bridge, side))
        };
        of(&ring) || loops.iter().any(|corners| of(corners))
    };
    let (_, at, start) = candidates
        .into_iter()
        .find(|&(_, at, start)| !crosses([ring[at], hole[start]]))?;
    let mut joined = ring[..=at].to_vec();
    joined.extend_from_slice(&hole[start..]);
    joined.extend_from_slice(&hole[..=start]);
    joined.extend_from_slice(&ring[at..]);
    Some(joined)
}

/// Triangles of a loop that may visit a vertex twice (along a bridge).
fn cut_ears(points: &[Point2], mut ring: Vec<usize>) -> Option<Vec<[usize; 3]>> {
    let mut triangles = Vec::with_capacity(ring.len());
    while ring.len() > 3 {
        let n = ring.len();
        let ear = (0..n).find(|&i| {
            let [a, b, c] = [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
            let holds = |p: usize| {
                turn(points, a, b, p) >= 0.0
                    && turn(points, b, c, p) >= 0.0
                    && turn(points, c, a, p) >= 0.0
            };
            turn(points, a, b, c) > 0.0
                && ring
                    .iter()
                    .all(|&p| p == a || p == b || p == c || !holds(p))
        })?;
        triangles.push([ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]]);
        ring.remove(ear);
    }
    triangles.push([*ring.first()?, *ring.get(1)?, *ring.get(2)?]);
    Some(triangles)
}

/// Flips inner edges until none has the opposite corner inside its circle.
fn flip_to_delaunay(points: &[Point2], triangles: &mut [[usize; 3]]) {
    loop {
        let mut owner = BTreeMap::new();
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for (side, opposite) in [([a, b], c), ([b, c], a), ([c, a], b)] {
                owner.insert(side, (t, opposite));
            }
        }
        let mut touched = vec![false; triangles.len()];
        let mut flipped = false;
        for (&[a, b], &(left, c)) in &owner {
            let Some(&(right, d)) = owner.get(&[b, a]) else {
                continue;
            };
            if a > b || touched[left] || touched[right] {
                continue;
            }
            let inside = robust::incircle(points[a], points[b], points[c], points[d]) > 0.0;
            let convex = turn(points, c, a, d) > 0.0 && turn(points, d, b, c) > 0.0;
            if inside && convex {
                triangles[left] = [c, a, d];
                triangles[right] = [d, b, c];
                (touched[left], touched[right], flipped) = (true, true, true);
            }
        }
        if !flipped {
            return;
        }
    }
}
