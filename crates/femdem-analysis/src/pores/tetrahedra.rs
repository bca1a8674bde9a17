//! A cube as six tetrahedra around its diagonal, and the surface in each.

/// Corners of the cube, by their bits x = 1, y = 2, z = 4, of tetrahedra that are positively oriented. Their edges
/// lead from a corner to one that has all of its bits, so that cubes side by side agree on their common faces.
const TETRAHEDRA: [[u8; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];

/// Calls `hit` with the triangles, as three cut edges of (inner corner, outer corner), between the corners of a
/// cube that are inside and those that are not. Triangles are counter-clockwise seen from outside.
///
/// A quadrangle is halved by its diagonal from edge (a, c) to edge (b, d), of inner corners a < b and outer ones c < d, or by the other one if `other` holds
/// for c.
pub(super) fn triangles_of_cube(
    inside: u8,
    other: impl Fn(u8) -> bool,
    mut hit: impl FnMut([(u8, u8); 3]),
) {
    if inside == 0 || inside == u8::MAX {
        return;
    }
    for corners in TETRAHEDRA {
        let is_in = |corner: u8| inside >> corner & 1 == 1;
        let mut order = corners;
        let count = order.iter().filter(|c| is_in(**c)).count();
        if count == 0 || count == 4 {
            continue;
        }
        // The inner corners first, each kind along the edges. Every exchange of neighbours turns the tetrahedron inside out.
        let key = |corner: u8| (!is_in(corner), corner);
        let mut odd = false;
        for end in (1..4).rev() {
            for k in 0..end {
                if key(order[k + 1]) < key(order[k]) {
                    order.swap(k, k + 1);
                    odd = !odd;
                }
            }
        }
        let [a, b, c, d] = order;
        let mut turned = |[p, q, r]: [(u8, u8); 3]| hit(if odd { [r, q, p] } else { [p, q, r] });
        match count {
            1 => turned([(a, b), (a, c), (a, d)]),
            2 if other(c) => {
                turned([(a, d), (b, d), (b, c)]);
                turned([(a, d), (b, c), (a, c)]);
            }
            2 => {
                turned([(a, c), (a, d), (b, d)]);
                turned([(a, c), (b, d), (b, c)]);
            }
            _ => turned([(a, d), (b, d), (c, d)]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::{Point3, Vector3};

    fn place(corner: u8) -> Point3 {
        Point3::from([0, 1, 2].map(|k| f64::from(corner >> k & 1)))
    }

    #[test]
    fn the_tetrahedra_fill_the_cube() {
        let mut sum = 0.0;
        for corners in TETRAHEDRA {
            let [a, b, c, d] = corners.map(place);
            let volume = (b - a).dot(&(c - a).cross(&(d - a))) / 6.0;
            assert!((volume - 1.0 / 6.0).abs() < 1e-15, "{corners:?}");
            sum += volume;
        }
        assert!((sum - 1.0).abs() < 1e-15);
    }

    /// Every triangle has its outer corners in front and its inner ones behind, in all 254 cases.
    #[test]
    fn triangles_face_outward() {
        for (inside, other) in (1..u8::MAX).flat_map(|n| [(n, false), (n, true)]) {
            let mut count = 0;
            triangles_of_cube(
                inside,
                |_| other,
                |edges| {
                    let [a, b, c] =
                        edges.map(|(p, q)| Point3::from((place(p).coords + place(q).coords) * 0.5));
                    let normal: Vector3 = (b - a).cross(&(c - a));
                    assert!(normal.norm() > 0.1);
                    for (inner, outer) in edges {
                        assert!(inside >> inner & 1 == 1 && inside >> outer & 1 == 0);
                        assert!(
                            normal.dot(&(place(outer) - place(inner))) > 0.0,
                            "{inside:b}"
                        );
                    }
                    count += 1;
                },
            );
            assert!(count > 0);
        }
    }
}
