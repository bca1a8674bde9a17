//! Strategies for property tests: rotations, poses and bodies.
//!
//! Behind the feature `proptest`, for tests of this crate and of those that build on it.

use crate::catalogue::CatalogueShape;
use crate::nalgebra::{Quaternion, Translation3};
use crate::{Point3, Polyhedron, Pose, Rotation, Vector3, convex_hull};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Rotations, uniform over all orientations (K. Shoemake, Graphics Gems III, 1992, 124-132).
pub fn rotations() -> impl Strategy<Value = Rotation> {
    (0.0..1.0_f64, 0.0..TAU, 0.0..TAU).prop_map(|(u, a, b)| {
        let (s, c) = ((1.0 - u).sqrt(), u.sqrt());
        Rotation::from_quaternion(Quaternion::new(
            c * b.cos(),
            s * a.sin(),
            s * a.cos(),
            c * b.sin(),
        ))
    })
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
