//! Where a line parallel to an axis runs inside a body.

use femdem_mesh::{Point3, Vector3};
use robust::{Coord, orient2d};

/// Interval of the coordinate `axis` in which the line through `at` lies within all half-spaces
/// `normal · x <= offset`; `None` when it misses them. `at[axis]` is not used.
pub(crate) fn convex_span(
    planes: &[(Vector3, f64)],
    axis: usize,
    at: &Point3,
) -> Option<(f64, f64)> {
    let [u, v] = others(axis);
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (normal, offset) in planes {
        let room = offset - normal[u] * at[u] - normal[v] * at[v];
        let slope = normal[axis];
        if slope > 0.0 {
            high = high.min(room / slope);
        } else if slope < 0.0 {
            low = low.max(room / slope);
        } else if room < 0.0 {
            return None;
        }
    }
    (low <= high).then_some((low, high))
}

/// Coordinate `axis` where the line through `at` crosses a triangle, or `None`.
///
/// A line through an edge or vertex is treated as shifted by an infinitesimal amount that is the same for all
/// triangles, and sides are decided exactly, so that a closed surface is crossed an even number of times.
pub(crate) fn crossing(triangle: &[Point3; 3], axis: usize, at: &Point3) -> Option<f64> {
    let [u, v] = others(axis);
    let flat = |p: &Point3| [p[u], p[v]];
    let [a, b, c] = triangle;
    let weights = [
        side(flat(b), flat(c), flat(at)),
        side(flat(c), flat(a), flat(at)),
        side(flat(a), flat(b), flat(at)),
    ];
    let left = weights.map(|(_, left)| left);
    if left[0] != left[1] || left[1] != left[2] {
        return None;
    }
    let total: f64 = weights.iter().map(|(w, _)| w).sum();
    if total == 0.0 {
        return None;
    }
    let sum = weights[0].0 * a[axis] + weights[1].0 * b[axis] + weights[2].0 * c[axis];
    Some(sum / total)
}

/// Twice the signed area of `(a, b, p)`, of exact sign (Shewchuk's predicate), and whether `p` lies left
/// of `a -> b`.
///
/// A `p` on the line counts as left of `a -> b` if `a` comes before `b` in lexicographic order and as right if
/// it comes after; this is the effect of the shift `(-ε², ε)` of `p` for every edge.
fn side(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> (f64, bool) {
    let [a_at, b_at, p_at] = [a, b, p].map(|[x, y]| Coord { x, y });
    let area = orient2d(a_at, b_at, p_at);
    (area, area > 0.0 || (area == 0.0 && a <= b))
}

fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Pose;
    use femdem_mesh::catalogue::CatalogueShape;

    /// Lines through vertices, edges and face diagonals of a cube cross it twice or not at all, and a
    /// line inside agrees with the span from the planes.
    #[test]
    fn crossings_are_even_on_edges_and_vertices() {
        let cube = "P5"
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(2.0 * 3_f64.sqrt())
            .unwrap();
        let triangles: Vec<[Point3; 3]> = cube
            .triangles()
            .iter()
            .map(|t| t.map(|v| cube.vertices()[v as usize]))
            .collect();
        let planes: Vec<_> = (0..6)
            .map(|i| (cube.face_normal(i), cube.face_offset(i)))
            .collect();
        let values = [-1.5, -1.0, -0.5, 0.0, 0.25, 0.5, 1.0];
        for axis in 0..3 {
            let mut inside = 0;
            for (s, t) in values.iter().flat_map(|s| values.map(|t| (*s, t))) {
                let mut at = Point3::origin();
                [at[(axis + 1) % 3], at[(axis + 2) % 3]] = [s, t];
                let mut hits: Vec<f64> = triangles
                    .iter()
                    .filter_map(|tri| crossing(tri, axis, &at))
                    .collect();
                hits.sort_by(f64::total_cmp);
                assert!(hits.is_empty() || hits.len() == 2, "{hits:?} at {at}");
                if s.abs() < 0.9 && t.abs() < 0.9 {
                    let (low, high) = convex_span(&planes, axis, &at).unwrap();
                    assert!((hits[0] - low).abs() < 1e-12 && (hits[1] - high).abs() < 1e-12);
                    inside += 1;
                }
            }
            assert_eq!(inside, 16);
        }
    }

    /// Lines through corners that round-off has moved: signs that are not exact would disagree there.
    #[test]
    fn crossings_are_even_near_corners_of_turned_bodies() {
        let shape = "A11"
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(2.0)
            .unwrap();
        for turn in 0..40 {
            let axis = Vector3::new(0.3, 0.1 * f64::from(turn), 0.7);
            let pose = Pose::new(Vector3::new(3.1, -2.7, 0.4), axis);
            let corners: Vec<Point3> = shape.vertices().iter().map(|v| pose * v).collect();
            let triangles = shape.triangles();
            let mut met = 0;
            for (corner, step) in corners.iter().flat_map(|c| (0..25).map(move |k| (c, k))) {
                // A few units in the last place to either side.
                let at = corner.map(|x| x * (1.0 + f64::EPSILON * f64::from(step % 5 - 2)));
                let at = Point3::new(
                    at.x,
                    at.y,
                    corner.z * (1.0 + f64::EPSILON * f64::from(step / 5 - 2)),
                );
                for axis in 0..3 {
                    let hits = triangles
                        .iter()
                        .filter(|t| crossing(&t.map(|v| corners[v as usize]), axis, &at).is_some())
                        .count();
                    assert!(hits % 2 == 0, "{hits} at {at}");
                    met += hits;
                }
            }
            assert!(met > 0);
        }
    }
}
