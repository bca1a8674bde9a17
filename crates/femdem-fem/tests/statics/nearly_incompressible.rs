//! The locking benchmarks of `records/statics.md`, on small meshes. Conjugate gradients take minutes
//! there, so they run only with the feature `implicit`.

use super::{cook, newton, sphere};
use femdem_fem::element::Element;

/// Target: F-bar within 2 % of the exact solution at nu = 0.4999. The error on this mesh is mostly due to the
/// straight edges at the surface, and is the same at every nu.
#[test]
fn a_thick_sphere_that_hardly_changes_volume_grows_as_lame_says() {
    let ratio = |element, poisson| {
        sphere::run(element, poisson, 9, 4, &newton(1e-7))
            .unwrap()
            .0
    };
    for poisson in [0.3, 0.4999] {
        let value = ratio(Element::T10Fbar, poisson);
        assert!((value - 1.0).abs() < 0.02, "{poisson}: {value}");
    }
    let [locked, averaged] = [Element::T4, Element::T4NodalPressure].map(|e| ratio(e, 0.4999));
    assert!(locked < 0.85 && averaged > 0.9, "{locked} {averaged}");
}

/// Published: 32.2 to 32.3 at nu = 1/3 and 27.5 to 28.0 at 0.4999 (CoFEA, benchmark 2: three codes
/// on quadratic tetrahedra, and the target values of its source).
#[test]
fn cooks_membrane_rises_as_published() {
    let rise = |poisson| {
        cook::run(Element::T10Fbar, poisson, [12, 12, 1], &newton(1e-7))
            .unwrap()
            .0
    };
    let (compressible, nearly_not) = (rise(1.0 / 3.0), rise(0.4999));
    assert!((compressible / 32.24 - 1.0).abs() < 0.01, "{compressible}");
    assert!((nearly_not / 27.75 - 1.0).abs() < 0.015, "{nearly_not}");
}
