//! The shapes beyond the solids of the catalogue, against closed forms, published numbers and
//! sampling.

mod closed_forms;
mod general;
mod monte_carlo;
mod quality;
mod random_parameters;

use femdem_mesh::Polyhedron;
use femdem_mesh::shapes::Shape;

/// The body of a shape given as text.
fn body(text: &str, size: f64) -> Polyhedron {
    text.parse::<Shape>()
        .and_then(|shape| shape.polyhedron(size))
        .unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn assert_near(what: &str, value: f64, expected: f64, relative: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(
        error <= relative,
        "{what}: {value} instead of {expected}, off by {error:e} (allowed {relative:e})"
    );
}

/// The smallest altitude of a triangle of the surface.
fn smallest_altitude(body: &Polyhedron) -> f64 {
    body.triangles()
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| body.vertices()[i as usize]);
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            (b - a).cross(&(c - a)).norm() / longest
        })
        .fold(f64::INFINITY, f64::min)
}
