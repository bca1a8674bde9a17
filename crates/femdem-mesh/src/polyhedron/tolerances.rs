//! What counts as plane and as convex.

/// A vertex may lie off the plane of its face by this part of the bounding box's diagonal.
///
/// Wide enough for files that hold six or seven significant digits.
pub const PLANARITY_TOLERANCE: f64 = 1e-6;

/// A polyhedron counts as convex if no vertex lies farther outside any face's plane than this part
/// of the bounding box's diagonal.
pub const CONVEXITY_TOLERANCE: f64 = 1e-6;
