//! Strategies for property tests: rotations, poses and bodies.
//!
//! Behind the feature `proptest`, for tests of this crate and of crates that use it.

use crate::catalogue::CatalogueShape;
use crate::nalgebra::{Quaternion, Translation3};
use crate::{Point3, Polyhedron, Pose, Rotation, Vector3, convex_hull};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Rotations, uniform over all orientations (K. Shoemake, Graphics Gems III, 1992, 124-132).
pub fn rotations() -> impl Strategy<Value = Rotation> {
    (0.0..1.0_f64, 0.0..TAU, 0.0..TAU).prop_map(|(u, a, b)| shoemake(u, a, b))
}

/// A rotation from three numbers uniform in 0 to 1, 0 to 2 pi and 0 to 2 pi.
fn shoemake(u: f64, a: f64, b: f64) -> Rotation {
    let (s, c) = ((1.0 - u).sqrt(), u.sqrt());
    let (w, x, y, z) = (c * b.cos(), s * a.sin(), s * a.cos(), c * b.sin());
    Rotation::from_quaternion(Quaternion::new(w, x, y, z))
}

/// Vectors, uniform in the cube from `-reach` to `reach` in each coordinate.
pub fn vectors(reach: f64) -> impl Strategy<Value = Vector3> {
    prop::array::uniform3(-1.0..=1.0_f64).prop_map(move |v| Vector3::from(v) * reach)
}

/// Poses of uniform orientation and of position in the cube from `-reach` to `reach`.
pub fn poses(reach: f64) -> impl Strategy<Value = Pose> {
    (vectors(reach), rotations())
        .prop_map(|(position, rotation)| Pose::from_parts(Translation3::from(position), rotation))
}

/// Shapes of the catalogue, both hands of chiral ones.
pub fn catalogue_shapes() -> impl Strategy<Value = CatalogueShape> {
    prop::sample::select(CatalogueShape::all_with_mirror_images().collect::<Vec<_>>())
}

/// Convex bodies: hulls of 4 to 30 points in the cube from -1 to 1, at least about 0.1 thick.
pub fn convex_polyhedra() -> impl Strategy<Value = Polyhedron> {
    prop::collection::vec(vectors(1.0).prop_map(Point3::from), 4..=30).prop_filter_map(
        "too thin",
        |points| {
            convex_hull(&points)
                .ok()
                .filter(|body| body.inradius() > 0.05)
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Matrix3;

    #[test]
    fn rotations_favour_no_direction() {
        // Means of the matrix entries and of their squares over all orientations: 0 and 1/3.
        let n = 40;
        let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(n);
        let mut mean = Matrix3::zeros();
        let mut mean_square = Matrix3::zeros();
        for (i, j, k) in (0..n * n * n).map(|m| (m % n, m / n % n, m / n / n)) {
            let rotation = shoemake(middle(i), middle(j) * TAU, middle(k) * TAU);
            let matrix = rotation.to_rotation_matrix().into_inner();
            mean += matrix / f64::from(n * n * n);
            mean_square += matrix.component_mul(&matrix) / f64::from(n * n * n);
        }
        assert!(mean.amax() < 1e-12);
        assert!(mean_square.add_scalar(-1.0 / 3.0).amax() < 1e-3);
    }

    proptest! {
        #[test]
        fn bodies_are_as_promised(body in convex_polyhedra(), pose in poses(3.0)) {
            prop_assert!(body.is_convex() && body.inradius() > 0.05);
            prop_assert!(pose.translation.vector.amax() <= 3.0);
        }
    }
}
