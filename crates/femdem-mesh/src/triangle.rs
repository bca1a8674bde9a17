//! The point of a triangle nearest to another point.

use crate::{Point3, Vector3};

/// The point of a triangle nearest to `p`, by the region of the plane over which `p` lies (C. Ericson,
/// Real-Time Collision Detection, 2005, section 5.1.5). A triangle without area acts as its longest side.
pub fn closest_point([a, b, c]: &[Point3; 3], p: &Point3) -> Point3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return along(a, &ab, d1, d1 - d3);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return along(a, &ac, d2, d2 - d6);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return along(b, &(c - b), d4 - d3, (d4 - d3) + (d5 - d6));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

fn along(start: &Point3, direction: &Vector3, part: f64, whole: f64) -> Point3 {
    start + direction * if whole > 0.0 { part / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No point of a fine net over the triangle is nearer, and the returned point lies in the triangle.
        #[test]
        fn none_is_nearer(corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)), at in prop::array::uniform3(-2.0..2.0_f64)) {
            let triangle = corners.map(Point3::from);
            let point = Point3::from(at);
            let found = closest_point(&triangle, &point);
            let [a, b, c] = triangle;
            let n = 60;
            let mut least = f64::INFINITY;
            for i in 0..=n {
                for j in 0..=n - i {
                    let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(n));
                    let on_net = a + (b - a) * u + (c - a) * v;
                    prop_assert!((on_net - point).norm() >= (found - point).norm() - 1e-12);
                    least = least.min((on_net - found).norm());
                }
            }
            prop_assert!(least < 4.0 / f64::from(n));
        }
    }

    /// Triangles without area act as their longest side.
    #[test]
    fn flat_triangles() {
        let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]].map(Point3::from);
        assert_eq!(
            closest_point(&line, &Point3::new(2.0, 5.0, 0.0)),
            Point3::new(2.0, 0.0, 0.0)
        );
        let dot = [Point3::new(1.0, 1.0, 1.0); 3];
        assert_eq!(closest_point(&dot, &Point3::origin()), dot[0]);
    }
}
