//! Strategies for property tests: bodies, placements and touching pairs.
//!
//! Behind the feature `proptest`, for tests of any contact kernel, this one or yours. Pairs come in all the
//! arrangements that contact codes tend to get wrong: faces in one plane, edge on edge, vertex on vertex, one
//! inside the other, two bodies in one place; at sizes from 1e-9 to 1e6 m, near the origin and up to 1e5 m
//! away from it. [`TestBody`] holds each body as a convex shape (if it is convex), as tetrahedra and as
//! tetrahedra with a field, all about its centroid, so that kernels of every kind are tested with the same
//! pair.
//!
//! ```
//! use femdem_contact::kernel::Scratch;
//! use femdem_contact::{PairKernel, strategies};
//! use proptest::prelude::*;
//!
//! // A kernel is safe if it knows no direction: mirrored roles give the opposite force.
//! proptest!(ProptestConfig::with_cases(64), |(pair in strategies::pairs(strategies::convex_bodies()))| {
//!     let kernel = PairKernel::new(1e6).unwrap();
//!     let (Some(a), Some(b)) = (&pair.a.convex, &pair.b.convex) else { unreachable!() };
//!     let scratch = &mut Scratch::default();
//!     let there = kernel.evaluate(a, &pair.frame_a, b, &pair.frame_b, scratch);
//!     let back = kernel.evaluate(b, &pair.frame_b, a, &pair.frame_a, scratch);
//!     // Penalty times the largest face stiffness times the size: a large contact's force.
//!     let scale = 1e6 * a.radius().min(b.radius()).powi(2);
//!     let force = |o: Option<femdem_contact::Overlap>| o.map_or(Default::default(), |o| o.force);
//!     prop_assert!((force(there) + force(back)).norm() <= 1e-6 * scale);
//! });
//! ```
//!
//! Shrinking simplifies bodies and placements; it does not round the coordinates of a mesh. A failing pair is
//! printed with the points of its bodies, so that it can be rebuilt.

mod bodies;
mod features;
mod place;

pub use bodies::{TestBody, bodies, convex_bodies, non_convex_bodies};
pub use place::{Arrangement, Placement, TestPair, pairs, placements};
