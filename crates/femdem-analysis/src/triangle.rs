//! The point of a triangle nearest to another point.

use femdem_mesh::{Point3, Vector3};

/// The point of a triangle nearest to `point`.
///
/// The foot on the triangle's plane where it lies in the triangle, else the nearest point of a side.
pub(crate) fn closest_point(triangle: &[Point3; 3], point: &Point3) -> Point3 {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(&(c - a));
    let sides = [(a, b), (b, c), (c, a)];
    let left_of = |(p, q): (&Point3, &Point3)| normal.dot(&(q - p).cross(&(point - p))) >= 0.0;
    let square = normal.norm_squared();
    if square > 0.0 && sides.into_iter().all(left_of) {
        return point - normal * (normal.dot(&(point - a)) / square);
    }
    let on_sides = sides.map(|(p, q)| on_segment(p, &(q - p), point));
    let mut nearest = on_sides[0];
    for candidate in &on_sides[1..] {
        if (candidate - point).norm_squared() < (nearest - point).norm_squared() {
            nearest = *candidate;
        }
    }
    nearest
}

/// The point nearest to `point` of the segment from `start` to `start + along`.
pub(crate) fn on_segment(start: &Point3, along: &Vector3, point: &Point3) -> Point3 {
    let square = along.norm_squared();
    if square <= 0.0 {
        return *start;
    }
    start + along * ((point - start).dot(along) / square).clamp(0.0, 1.0)
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
