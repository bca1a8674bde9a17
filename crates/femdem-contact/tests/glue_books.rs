//! Forces of glue are the gradient of its energy, and its books balance on any path.

use crate::glue::{AREA, energy, law, moved, rising, triangle};
use femdem_contact::glue::{GlueLaw, GlueLimits, Softening};
use femdem_mesh::{Rotation, Vector3};
use proptest::prelude::*;

/// Glue that shears and hardly holds in tension is pulled open: it falls from what it bore, however far beyond its limits the step
/// is, and what it loses is on the books.
#[test]
fn glue_far_beyond_its_limits_falls_from_what_it_bore() {
    let law = law(Softening::Linear);
    let (mut facet, lent) = rising(&law, [0.0, -1e5, -3e6], &GlueLimits::flat([1.0, 8e6], 0.0));
    let way = Vector3::new(0.0, 1e-10, 3e-10);
    let (mut work, mut lost) = (0.0, 0.0);
    let mut forces = facet.forces(&law, &triangle(), &triangle());
    for k in 1..=10_000 {
        let to = moved(way * f64::from(k));
        let loss = facet.advance(&law, &triangle(), &to);
        let now = facet.forces(&law, &triangle(), &to);
        let jump = (now.on[1][0] - forces.on[1][0]).norm() / AREA;
        assert!(jump < 3.0 * law.stiffness * way.norm(), "{k} {jump:e}");
        work -= (0..3)
            .map(|q| 0.5 * (forces.on[1][q] + now.on[1][q]).dot(&way))
            .sum::<f64>();
        lost += loss.glue;
        forces = now;
    }
    let stored = energy(&forces);
    assert!(lost > 0.5 * lent, "{lost:e} of {lent:e}");
    assert!(
        (work + lent - lost - stored).abs() < 2e-3 * lent,
        "{work:e} + {lent:e} - {lost:e} - {stored:e}"
    );
}

/// Positions of both sides: the triangle and its copy, each node moved by up to 5 um.
fn sides() -> impl Strategy<Value = [[Vector3; 3]; 2]> {
    let shift = (-5e-6..5e-6, -5e-6..5e-6, -5e-6..5e-6);
    prop::array::uniform6(shift.prop_map(|(x, y, z)| Vector3::new(x, y, z))).prop_map(|by| {
        let triangle = triangle();
        [[0, 1, 2], [3, 4, 5]].map(|side| [0, 1, 2].map(|q| triangle[q] + by[side[q]]))
    })
}

/// Strengths up to 10 MPa, and planes up to 80 degrees askew.
fn limits() -> impl Strategy<Value = GlueLimits> {
    let angles = (0.0..1.4_f64, 0.0..6.3_f64);
    let strengths = (1.0..1e7, 1.0..1e7);
    let all = (strengths, 0.0..1.0, angles, traction());
    all.prop_map(|((tensile, cohesion), slope, (askew, about), aside)| {
        let [sin, cos] = [askew.sin(), askew.cos()];
        let plane = [cos, sin * about.cos(), sin * about.sin()];
        GlueLimits {
            strengths: [tensile, cohesion],
            slope,
            plane,
            aside,
        }
    })
}

fn traction() -> impl Strategy<Value = [f64; 3]> {
    [-5e6..5e6, -5e6..5e6, -5e6..5e6]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// In any state forces are minus the gradient of the energy, and balance with their moments; turned as a whole the facet
    /// has the same energy.
    #[test]
    fn forces_are_gradients_and_balance(
        born in traction(),
        past in sides(),
        at in sides(),
        turn in [-3.0..3.0, -3.0..3.0, -3.0..3.0],
        which in 0..3_usize,
        presses: bool,
        limits in limits(),
    ) {
        let softening = [Softening::Linear, Softening::Exponential, Softening::Bilinear][which];
        let law = GlueLaw { presses, ..law(softening) };
        let (mut facet, _) = rising(&law, born, &limits);
        let mut at_once = facet.clone();
        let lost = facet.advance(&law, &past[0], &past[1]);
        let there = facet.forces(&law, &past[0], &past[1]);
        prop_assert_eq!(at_once.step(&law, &past[0], &past[1]), (lost, there));
        let now = facet.forces(&law, &at[0], &at[1]);
        let largest = now.on.iter().flatten().map(Vector3::norm).fold(1e-9, f64::max);
        let sum: Vector3 = now.on.iter().flatten().sum();
        let moment: Vector3 = (0..2).flat_map(|s| (0..3).map(move |q| (s, q)))
            .map(|(s, q)| at[s][q].cross(&now.on[s][q])).sum();
        prop_assert!(sum.norm() < 1e-12 * largest);
        prop_assert!(moment.norm() < 1e-12 * 1e-3 * largest);
        let step = 1e-10;
        for (s, q, k) in (0..2).flat_map(|s| (0..3).flat_map(move |q| (0..3).map(move |k| (s, q, k)))) {
            let shifted = |by: f64| {
                let mut sides = at;
                sides[s][q][k] += by;
                energy(&facet.forces(&law, &sides[0], &sides[1]))
            };
            let slope = (shifted(step) - shifted(-step)) / (2.0 * step);
            prop_assert!((slope + now.on[s][q][k]).abs() < 1e-7 * largest, "{slope} {:?}", now.on[s][q]);
        }
        let turn = Rotation::from_scaled_axis(Vector3::from(turn));
        let shift = Vector3::new(1.0, -2.0, 0.5) * 1e-3;
        let turned = at.map(|side| side.map(|x| turn * x + shift));
        let there = facet.forces(&law, &turned[0], &turned[1]);
        // What it takes on the way is the same, in the same mode.
        let [here, away] = [&at, &turned].map(|sides| {
            let mut facet = facet.clone();
            let lost = facet.advance(&law, &sides[0], &sides[1]);
            (lost.glue, facet.damage(&law))
        });
        prop_assert!((here.0 - away.0).abs() <= 1e-9 * (here.0 + energy(&now)));
        prop_assert!((0..3).all(|q| (here.1[q] - away.1[q]).abs() < 1e-9));
        prop_assert!((energy(&there) - energy(&now)).abs() <= 1e-9 * energy(&now));
        prop_assert!((there.on[1][2] - turn * now.on[1][2]).norm() < 1e-9 * largest);
    }

    /// Around any closed path of the second side no energy is gained: the work is what is lost and stored more.
    #[test]
    fn closed_paths_gain_nothing(
        born in traction(),
        corners in prop::collection::vec([-3e-6..3e-6, -3e-6..3e-6, -1e-6..5e-6], 2..4),
        presses: bool,
        limits in limits(),
    ) {
        let law = GlueLaw { presses, ..law(Softening::Linear) };
        let (mut facet, lent) = rising(&law, born, &limits);
        let mut path = vec![Vector3::zeros()];
        path.extend(corners.into_iter().map(Vector3::from));
        path.push(Vector3::zeros());
        let steps = 2000;
        let (mut work, mut lost, mut turnover) = (0.0, 0.0, lent);
        let mut forces = facet.forces(&law, &triangle(), &triangle());
        for pair in path.windows(2) {
            let way = (pair[1] - pair[0]) / f64::from(steps);
            for k in 1..=steps {
                let to = moved(pair[0] + way * f64::from(k));
                let loss = facet.advance(&law, &triangle(), &to);
                prop_assert!(loss.glue >= 0.0 && loss.pressure >= 0.0);
                let now = facet.forces(&law, &triangle(), &to);
                let done: f64 = (0..3).map(|q| -0.5 * (forces.on[1][q] + now.on[1][q]).dot(&way)).sum();
                work += done;
                turnover += done.abs();
                lost += loss.glue + loss.friction + loss.pressure;
                forces = now;
            }
        }
        let balance = work + lent - lost - energy(&forces);
        prop_assert!(balance.abs() <= 2e-3 * turnover, "{balance} of {turnover}");
    }
}
