//! Any parameters give a valid body or an error with a name; never a panic.

use femdem_mesh::MeshError;
use femdem_mesh::shapes::Shape;
use proptest::prelude::*;

/// A value from somewhat below to somewhat above the range of a parameter, as text; `part` says
/// where in it.
fn value(range: &str, part: f64) -> String {
    let bounds: Vec<Option<f64>> = range.split(" to ").map(|b| b.parse().ok()).collect();
    match bounds[..] {
        [Some(low), Some(high)] => {
            let x = low + (high - low) * (1.1 * part - 0.05);
            let whole = !range.contains('.') && (high > 2.5);
            if whole {
                format!("{x:.0}")
            } else {
                x.to_string()
            }
        }
        _ => (part > 0.5).to_string(),
    }
}

fn check(shape: &Shape) -> Result<(), TestCaseError> {
    match shape.polyhedron(1.0) {
        Ok(body) => {
            let mass = body.mass_properties();
            prop_assert!(mass.volume > 0.0 && mass.volume.is_finite());
            let centroid = mass.centroid.coords.amax();
            prop_assert!(
                centroid < 1e-10 * body.bounding_radius(),
                "{shape}: {centroid:e}"
            );
            prop_assert!(body.euler_characteristic() % 2 == 0);
            let cuts = body.self_intersections(1);
            prop_assert!(cuts.is_empty(), "{shape}: faces {cuts:?} cut each other");
        }
        Err(error) => {
            let named = matches!(
                error,
                MeshError::OutOfRange { .. }
                    | MeshError::BadParameter { .. }
                    | MeshError::Disconnected { .. }
                    | MeshError::Hollow { .. }
            );
            prop_assert!(named, "{shape}: {error}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_body_or_a_named_error(family in 0..13_usize, parts in prop::collection::vec(0.0..1.0, 7)) {
        let mut shape = Shape::all().swap_remove(family);
        for (parameter, part) in shape.parameters().into_iter().zip(parts) {
            // The finest subdivisions are tried elsewhere; here they would take the time.
            let part = if ["level", "cells"].contains(&parameter.name) { 0.6 * part } else { part };
            let text = value(&parameter.range, part);
            if let Err(error) = shape.set(parameter.name, &text) {
                let bad = matches!(error, MeshError::BadParameter { .. });
                prop_assert!(bad, "{error}");
            }
        }
        check(&shape)?;
    }

    #[test]
    fn clumps_of_any_spheres(
        spheres in prop::collection::vec((-0.6..0.6, -0.6..0.6, -0.6..0.6, 0.2..0.5), 1..6)
    ) {
        let radii: Vec<f64> = spheres.iter().map(|s| s.3).collect();
        let spheres: Vec<String> = spheres
            .iter()
            .map(|(x, y, z, r): &(f64, f64, f64, f64)| format!("{x} {y} {z} {r}"))
            .collect();
        let shape: Shape = format!("clump:spheres={}", spheres.join("/")).parse().unwrap();
        check(&shape)?;
        if let Ok(body) = shape.polyhedron(1.0) {
            let smallest = radii.iter().copied().fold(f64::INFINITY, f64::min);
            let altitude = super::smallest_altitude(&body);
            prop_assert!(altitude > 0.03 * smallest, "{shape}: {altitude}");
        }
    }

    #[test]
    fn text_never_panics(text in "[a-z0-9_]{0,12}:?[a-z0-9=,./ -]{0,30}") {
        let _ = text.parse::<Shape>().map(|shape| shape.to_string());
    }

    #[test]
    fn known_families_with_any_parameters_never_panic(
        family in 0..14_usize, text in "[a-z]{1,9}=[-0-9.e/ ]{0,12}"
    ) {
        let name = Shape::all()[family].name();
        let _ = format!("{name}:{text}").parse::<Shape>();
    }
}
