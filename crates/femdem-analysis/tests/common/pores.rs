//! What tests of the void space share.

use femdem_analysis::mesh::PeriodicCell;
use femdem_analysis::{PeriodicSpace, Region};
use femdem_mesh::shapes::Shape;
use femdem_mesh::{Point3, Polyhedron};

/// A box.
pub fn region(low: [f64; 3], high: [f64; 3]) -> Region {
    Region::Box {
        min: low.into(),
        max: high.into(),
    }
}

/// A box as a body.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Polyhedron {
    let corners = (0..8)
        .map(|c| Point3::from([0, 1, 2].map(|k| if c >> k & 1 == 0 { low[k] } else { high[k] })));
    femdem_mesh::convex_hull(&corners.collect::<Vec<_>>()).unwrap()
}

/// Periodic space with a corner of its cell at the origin.
pub fn space(sides: [Option<f64>; 3]) -> PeriodicSpace {
    PeriodicSpace {
        cell: PeriodicCell::new(sides).unwrap(),
        lower: Point3::origin(),
    }
}

/// The facets of a ball.
pub fn ball(radius: f64) -> Polyhedron {
    let shape: Shape = "sphere:level=2".parse().unwrap();
    shape.polyhedron(2.0 * radius).unwrap()
}

/// Distance of a point from a triangle by projection onto its convex set (alternating over barycentric weights).
pub fn sampled(triangle: &[Point3; 3], p: &Point3) -> f64 {
    let [a, b, c] = triangle;
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    // The distance from the segment at a share of the way from a to the side bc is convex in the share.
    let at = |s: f64| {
        let (q, r) = (a + (b - a) * s, a + (c - a) * s);
        let along = r - q;
        let t = if along.norm_squared() > 0.0 {
            ((p - q).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (q + along * t - p).norm()
    };
    for _ in 0..60 {
        let [s, t] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if at(s) < at(t) {
            high = t;
        } else {
            low = s;
        }
    }
    at(low).min(at(high))
}
