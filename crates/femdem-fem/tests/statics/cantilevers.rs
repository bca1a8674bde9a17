//! The cantilever of `records/statics.md` on small meshes.

use super::{cantilever, newton, solvers, with};
use femdem_fem::element::Element;

#[test]
fn a_cantilever_of_quadratic_elements_bends_as_timoshenko_says() {
    for linear in solvers() {
        let (ratio, solution) =
            cantilever::run(Element::T10, [20, 2, 2], &with(linear, 1e-7)).unwrap();
        assert!((ratio - 1.0).abs() < 0.015, "{linear:?}: {ratio}");
        // Supports carry the load and its moment: 0.25 N at 10 m.
        let force: f64 = solution.reactions.iter().map(|f| f.z).sum();
        let moment: f64 = solution
            .reactions
            .iter()
            .zip(&solution.state.x)
            .map(|(f, x)| x.z * f.x - x.x * f.z)
            .sum();
        assert!((force - 0.25).abs() < 1e-7, "{force}");
        assert!((moment.abs() - 2.5).abs() < 1e-5, "{moment}");
    }
}

#[test]
fn linear_elements_are_stiff_in_bending_and_less_so_on_finer_meshes() {
    let ratio = |cells| {
        cantilever::run(Element::T4, cells, &newton(1e-7))
            .unwrap()
            .0
    };
    let (coarse, fine) = (ratio([20, 2, 2]), ratio([40, 4, 4]));
    assert!(
        0.4 < coarse && coarse < fine && fine < 0.9,
        "{coarse} {fine}"
    );
}

/// With one element across, F-bar treats a part of the bending as a change of volume and averages it out; the
/// table of elements states how much.
#[test]
fn fbar_wants_more_than_one_element_across() {
    let bends = |cells| {
        cantilever::run(Element::T10Fbar, cells, &newton(1e-7))
            .unwrap()
            .0
    };
    let (one, two) = (bends([20, 1, 1]), bends([20, 2, 2]));
    assert!((1.7..1.9).contains(&one), "{one}");
    assert!((1.03..1.07).contains(&two), "{two}");
}
