//! The cohesive law of cut facets: forces, energies, and what breaking takes.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem_contact::glue::{
    GlueLaw, GlueLimits, GlueLoss, GluedFacet, GluedForces, Softening, mixed_energy, mixed_strength,
};
use femdem_mesh::Vector3;

/// Area of the facet of the tests, m².
pub const AREA: f64 = 0.5e-6;

pub fn law(softening: Softening) -> GlueLaw {
    GlueLaw {
        stiffness: 1e13,
        energies: [20.0, 100.0],
        mix: 2.0,
        softening,
        contact: 2e13,
        tangential: 1.6e13,
        friction: 0.6,
        presses: true,
    }
}

pub fn triangle() -> [Vector3; 3] {
    [Vector3::zeros(), Vector3::x() * 1e-3, Vector3::y() * 1e-3]
}

/// Tensile strength and cohesion, Pa.
const STRENGTHS: [f64; 2] = [5e6, 20e6];

/// A facet that was cut under a traction beyond its strength, and what its springs were lent, J.
fn cut(law: &GlueLaw, traction: [f64; 3]) -> (GluedFacet, f64) {
    rising(law, traction, &GlueLimits::flat([1e-6; 2], 0.0))
}

/// The same, whose glue is of any strength.
pub fn rising(law: &GlueLaw, traction: [f64; 3], limits: &GlueLimits) -> (GluedFacet, f64) {
    let mut facet = GluedFacet::new(AREA).unwrap();
    let lent = facet.join(law, traction, limits, [1.0; 3]);
    (facet, lent)
}

pub fn moved(by: Vector3) -> [Vector3; 3] {
    triangle().map(|x| x + by)
}

pub fn energy(forces: &GluedForces) -> f64 {
    forces.glue + forces.contact
}

/// When it is cut, a facet carries what it carried before: tension and shear by the glue, pressure by the contact, and shear
/// under pressure by friction as far as that can.
#[test]
fn nothing_jumps_when_a_facet_is_cut() {
    let law = law(Softening::Linear);
    for traction in [
        [5e6, 0.0, 0.0],
        [3e6, -2e6, 1e6],
        [-4e6, 1e6, 1e6],
        [-4e6, 3e6, -9e6],
        [0.0, 0.0, 0.0],
    ] {
        let (facet, lent) = cut(&law, traction);
        let (a, b) = (triangle(), triangle());
        let forces = facet.forces(&law, &a, &b);
        // The axes are z, x and y; side b pulls side a.
        let pull = Vector3::new(traction[1], traction[2], traction[0]) * AREA;
        let on_a: Vector3 = forces.on[0].iter().sum();
        assert!((on_a - pull).norm() <= 1e-12 * pull.norm(), "{traction:?}");
        assert!(
            (energy(&forces) - lent).abs() <= 1e-12 * lent,
            "{traction:?}"
        );
        let still = facet.clone().advance(&law, &a, &b);
        assert!(
            still.glue == 0.0 && still.friction <= 1e-12 * lent,
            "{traction:?}"
        );
    }
}

/// Pulled apart in many steps or one, breaking takes G: that of the mode, less what was lent.
#[test]
fn breaking_takes_the_energy_of_the_mode() {
    for softening in [
        Softening::Linear,
        Softening::Exponential,
        Softening::Bilinear,
    ] {
        let law = law(softening);
        let mixed = mixed_energy(law.energies, law.mix, 0.5);
        assert!((mixed - 40.0).abs() < 1e-12);
        for (traction, wanted) in [
            ([5e6, 0.0, 0.0], 20.0),
            ([0.0, 3e6, 4e6], 100.0),
            ([4e6, 0.0, 4e6], mixed),
        ] {
            for steps in [1, 50] {
                let (mut facet, lent) = cut(&law, traction);
                let mut lost = 0.0;
                for k in 1..=steps {
                    assert!(k > 1 || !facet.is_broken(&law));
                    let way = 1e-3 * f64::from(k) / f64::from(steps);
                    let apart = moved(
                        Vector3::new(traction[1], traction[2], traction[0]).normalize() * way,
                    );
                    lost += facet.advance(&law, &triangle(), &apart).glue;
                }
                assert!(facet.is_broken(&law));
                assert!(
                    ((lost - lent) / AREA / wanted - 1.0).abs() < 1e-10,
                    "{softening:?} {traction:?}"
                );
                let after = facet.forces(&law, &triangle(), &moved(Vector3::z() * 1e-6));
                assert_eq!(energy(&after), 0.0);
            }
        }
    }
}

/// A facet opens like a page: one or two of its corners stay shut, and all of it breaks and takes G A, as soon as its point next to a
/// shut corner, which opens by a sixth of what the others do in sum, is open far enough; not before.
#[test]
fn a_facet_that_turns_about_shut_corners_takes_all_of_its_energy() {
    let strength = 5e6;
    for softening in [
        Softening::Linear,
        Softening::Exponential,
        Softening::Bilinear,
    ] {
        // The axes turn with the corners, so that they slide a little, too.
        let law = GlueLaw {
            energies: [20.0; 2],
            ..law(softening)
        };
        let limits = GlueLimits::flat([strength; 2], 0.0);
        let end = strength / law.stiffness + softening.end() * law.energies[0] / strength;
        for open in [vec![0], vec![2], vec![0, 1], vec![1, 2]] {
            for part in [1.0, 0.4, 0.0] {
                let mut facet = GluedFacet::new(AREA).unwrap();
                let lent = facet.join(&law, [part * strength, 0.0, 0.0], &limits, [1.0; 3]);
                let pull: Vector3 = facet.forces(&law, &triangle(), &triangle()).on[0]
                    .iter()
                    .sum();
                assert!((pull - Vector3::z() * (part * strength * AREA)).norm() < 1e-12);
                let mut lost = 0.0;
                let mut to = |height: f64| {
                    let mut side = triangle();
                    open.iter().for_each(|q| side[*q].z = height);
                    lost += facet.advance(&law, &triangle(), &side).glue;
                    facet.is_broken(&law)
                };
                let born = part * strength / law.stiffness;
                let whole = 6.0 / open.len() as f64 * (end - born);
                for k in 1..20 {
                    assert!(!to(0.05 * f64::from(k) * whole * 0.98));
                }
                assert!(to(1.02 * whole), "{softening:?} {open:?} {part}");
                let taken = (lost - lent) / AREA / law.energies[0];
                assert!(
                    (taken - 1.0).abs() < 1e-10,
                    "{softening:?} {open:?} {part} {taken}"
                );
            }
        }
    }
}

/// Its elastic energy is k/2 of the integral of the squared opening over the triangle, for linear ones A/12 (Σ δ² + (Σ δ)²), and a
/// point is as strong as the node next to it.
#[test]
fn openings_are_integrated_over_the_facet() {
    let law = law(Softening::Linear);
    let limits = GlueLimits::flat(STRENGTHS, 0.0);
    let mut facet = GluedFacet::new(AREA).unwrap();
    assert_eq!(facet.join(&law, [0.0; 3], &limits, [1.0; 3]), 0.0);
    for heights in [[1.0, 2.0, 3.0], [0.0, 0.0, 4.0], [5.0, 0.0, 1.0]] {
        let mut side = triangle();
        (0..3).for_each(|q| side[q].z = heights[q] * 1e-9);
        let squares: f64 = heights.iter().map(|h| h * h).sum();
        let all: f64 = heights.iter().sum();
        let wanted = 0.5 * law.stiffness * AREA / 12.0 * (squares + all * all) * 1e-18;
        facet.advance(&law, &triangle(), &side);
        let found = facet.forces(&law, &triangle(), &side).glue;
        assert!((found / wanted - 1.0).abs() < 1e-6, "{heights:?}");
    }
    let mut facet = GluedFacet::new(AREA).unwrap();
    facet.join(&law, [0.0; 3], &limits, [1.0, 2.0, 3.0]);
    let at = |part: f64| moved(Vector3::z() * (part * STRENGTHS[0] / law.stiffness));
    for (part, broken) in [
        (0.99, 0),
        (1.01, 1),
        (1.99, 1),
        (2.01, 2),
        (2.99, 2),
        (3.01, 3),
    ] {
        facet.advance(&law, &triangle(), &at(part));
        let soft = facet.damage(&law).iter().filter(|d| **d > 0.0).count();
        assert_eq!(soft, broken, "{part}");
    }
}

/// Moves the second side from one place to another, in steps. Returns the largest mean traction along a direction on the way, Pa, and
/// what the glue lost, J/m².
fn led(
    facet: &mut GluedFacet,
    law: &GlueLaw,
    [from, to]: [Vector3; 2],
    along: &Vector3,
) -> (f64, f64) {
    let (mut most, mut lost) = (f64::NEG_INFINITY, 0.0);
    let steps = 4000;
    for k in 1..=steps {
        let at = moved(from + (to - from) * (f64::from(k) / f64::from(steps)));
        lost += facet.advance(law, &triangle(), &at).glue / AREA;
        let pull: Vector3 = facet.forces(law, &triangle(), &at).on[0].iter().sum();
        most = most.max(pull.dot(along) / AREA);
    }
    (most, lost)
}

/// The mode of glue is that in which it gives way: cut by shear, unloaded and opened it bears f_t and takes G_I, cut by tension, unloaded
/// and sheared c and G_II, and at 45 degrees what mixed modes do.
#[test]
fn the_mode_is_that_in_which_glue_gives_way() {
    let [tensile, cohesion] = STRENGTHS;
    for softening in [
        Softening::Linear,
        Softening::Exponential,
        Softening::Bilinear,
    ] {
        // The way back from tension would press the faces.
        let law = GlueLaw {
            presses: false,
            ..law(softening)
        };
        let limits = GlueLimits::flat(STRENGTHS, 0.8);
        let opening = Vector3::z() * 1e-4;
        let sliding = Vector3::x() * 1e-4;
        let both = (Vector3::z() + Vector3::x()).normalize();
        // 1/P² = 1/2f² + 1/2c² and G_I + (G_II - G_I)/4.
        let mixed = (0.5 / tensile.powi(2) + 0.5 / cohesion.powi(2))
            .sqrt()
            .recip();
        let back = |born: [f64; 3]| Vector3::new(born[1], born[2], born[0]) / -law.stiffness;
        for (born, way, along, peak, energy) in [
            (
                [0.0, 0.9 * cohesion, 0.0],
                opening,
                Vector3::z(),
                tensile,
                20.0,
            ),
            (
                [0.0, 0.0, -0.9 * cohesion],
                opening,
                Vector3::z(),
                tensile,
                20.0,
            ),
            (
                [0.9 * tensile, 0.0, 0.0],
                sliding,
                Vector3::x(),
                cohesion,
                100.0,
            ),
            ([0.0, 0.9 * cohesion, 0.0], both * 1e-4, both, mixed, 40.0),
            ([0.9 * tensile, 0.0, 0.0], both * 1e-4, both, mixed, 40.0),
        ] {
            let (mut facet, lent) = rising(&law, born, &limits);
            let start = back(born);
            let to_start = facet.advance(&law, &triangle(), &moved(start));
            assert_eq!((to_start.glue, facet.damage(&law)), (0.0, [0.0; 3]));
            let (most, lost) = led(&mut facet, &law, [start, start + way], &along);
            assert!(facet.is_broken(&law));
            assert!(
                (most / peak - 1.0).abs() < 2e-2 && most <= peak,
                "{born:?} {most}"
            );
            let taken = lost - lent / AREA;
            assert!((taken / energy - 1.0).abs() < 1e-4, "{born:?} {taken}");
        }
    }
}

/// Glue that shear has brought beyond its limits, at birth or when it opens a little, has given way by sliding, for good: opened then,
/// it takes the energy of that mode.
#[test]
fn the_mode_stays() {
    let law = GlueLaw {
        presses: false,
        ..law(Softening::Linear)
    };
    let limits = GlueLimits::flat(STRENGTHS, 0.8);
    // On the ellipse of strengths, 18 MPa of shear give way with (1 - (18/20)²)^(1/2) of the strength in tension.
    let pull = 5e6 * (1.0_f64 - 0.81).sqrt();
    let share = 18e6_f64.powi(2) / (18e6_f64.powi(2) + pull * pull);
    for (shear, energy) in [(21e6, 100.0), (18e6, 20.0 + 80.0 * share * share)] {
        let (mut facet, lent) = rising(&law, [0.0, shear, 0.0], &limits);
        let way = [Vector3::zeros(), Vector3::z() * 2e-4];
        let (most, lost) = led(&mut facet, &law, way, &Vector3::z());
        assert!(facet.is_broken(&law) && most > 2.0 * STRENGTHS[0], "{most}");
        let taken = lost - lent / AREA;
        assert!((taken / energy - 1.0).abs() < 2e-2, "{shear} {taken}");
    }
}

/// A facet askew to a plane that fails by sliding, whose shear alone would pull that plane open, gives way where the plane does, at c +
/// p tan φ there, whatever part of its shear its faces hold by friction, and takes its part of G_II.
#[test]
fn a_facet_askew_under_pressure_slides() {
    for friction in [0.0, 0.1, 0.3] {
        let law = GlueLaw {
            stiffness: 1e15,
            contact: 1e15,
            tangential: 1e15,
            friction,
            presses: false,
            ..law(Softening::Linear)
        };
        // In a block under 60 MPa along e, a facet at 40 degrees to it, where the plane that fails first is at 64.3.
        let [facet, plane] = [40_f64, 64.3].map(f64::to_radians);
        let (sin, cos) = (plane - facet).sin_cos();
        let e = [facet.cos(), -facet.sin(), 0.0];
        let of = |part: f64| e.map(|e| -60e6 * part * e);
        let limits = GlueLimits {
            plane: [cos, sin, 0.0],
            aside: of(facet.cos() - cos * plane.cos()),
            ..GlueLimits::flat(STRENGTHS, 0.8)
        };
        let born = of(facet.cos());
        assert!(born[0] < 0.0 && born[1] > 0.0);
        let (mut glued, lent) = rising(&law, born, &limits);
        assert_eq!(glued.damage(&law), [0.0; 3]);
        let rubbed = friction * born[0];
        let lent = lent / AREA
            - 0.5 * born[0].powi(2) / law.contact
            - 0.5 * rubbed.powi(2) / law.tangential;
        let places = [0.0, 1e-6, 1.2e-5].map(|x| Vector3::x() * x);
        let x = Vector3::x();
        let (most, first) = led(&mut glued, &law, [places[0], places[1]], &x);
        let (_, rest) = led(&mut glued, &law, [places[1], places[2]], &x);
        // Until sliding by more shear makes c + p tan φ of what is on the plane.
        let [pressure, shear] = [plane.cos().powi(2), plane.sin() * plane.cos()].map(|x| 60e6 * x);
        let more = cos * (20e6 + 0.8 * pressure - shear) / (cos + 0.8 * sin);
        let most = most / (born[1] + more);
        assert!(
            (most - 1.0).abs() < 2e-2 && most <= 1.0,
            "{friction} {most}"
        );
        assert!(glued.is_broken(&law));
        let taken = first + rest - lent;
        assert!(
            (taken / (100.0 * cos) - 1.0).abs() < 1e-9,
            "{friction} {taken}"
        );
    }
}

/// A facet under pressure along a principal axis, or one whose faces hold its shear by friction, has nothing in its glue when the plane
/// that fails, askew to it, does. Slid, it bears and takes its part of what that plane does.
#[test]
fn a_facet_without_shear_gives_way_over_no_longer_way_than_others() {
    for friction in [0.0, 0.6] {
        let law = GlueLaw {
            friction,
            presses: false,
            ..law(Softening::Linear)
        };
        for angle in [0.5_f64, 1.05] {
            let (sin, cos) = angle.sin_cos();
            let limits = GlueLimits {
                plane: [cos, sin, 0.0],
                ..GlueLimits::flat([5e6, 1e6], 0.1)
            };
            // Its part of a pressure along its normal is more than the plane bears.
            let (mut facet, lent) = rising(&law, [-40e6, 0.0, 0.0], &limits);
            let springs = 0.5 * 40e6_f64.powi(2) / law.contact;
            assert!((lent / AREA / springs - 1.0).abs() < 1e-12);
            // A straight line falls over 2 G/c, from where it rose to.
            let end = 2.0 * 100.0 / 1e6 * 1.001;
            let (most, lost) = led(
                &mut facet,
                &law,
                [Vector3::zeros(), Vector3::x() * end],
                &Vector3::x(),
            );
            assert!(facet.is_broken(&law), "{friction} {angle}");
            let most = (most - friction * 40e6) / (cos * 1e6);
            assert!((most - 1.0).abs() < 2e-2 && most <= 1.0 + 1e-9, "{most}");
            assert!((lost / (100.0 * cos) - 1.0).abs() < 1e-9, "{lost}");
        }
    }
}

/// Cut under pressure, and sheared: cohesion and friction bear c + p tan φ, whatever part of it the faces rub by, and the glue takes
/// G_II. Then friction alone is left.
#[test]
fn pressed_glue_bears_cohesion_and_internal_friction() {
    let pressure = 4e6;
    for (presses, friction) in [(true, 0.6), (false, 0.6), (true, 0.8), (false, 0.0)] {
        let law = GlueLaw {
            presses,
            friction,
            ..law(Softening::Linear)
        };
        let limits = GlueLimits::flat(STRENGTHS, 0.8);
        for born in [0.0, 2e6] {
            let (mut facet, lent) = rising(&law, [-pressure, born, 0.0], &limits);
            let springs = pressure.powi(2) / law.contact
                + (friction * pressure).min(born).powi(2) / law.tangential;
            let lent = lent / AREA - 0.5 * springs;
            let slid = [Vector3::zeros(), Vector3::x() * 5e-5];
            let (most, lost) = led(&mut facet, &law, slid, &Vector3::x());
            let peak = STRENGTHS[1] + 0.8 * pressure;
            assert!((most / peak - 1.0).abs() < 1e-2 && most <= peak, "{most}");
            assert!(facet.is_broken(&law));
            assert!(((lost - lent) / 100.0 - 1.0).abs() < 1e-9, "{lost:?}");
        }
    }
}

/// Cut under pressure, and opened: the faces part at no traction, and then bear f_t and take G_I. Pressed, and a little apart, nothing
/// is lost.
#[test]
fn pressed_glue_holds_until_it_is_pulled() {
    for (presses, pressure) in [(true, 4e6), (false, 4e6), (false, 80e6)] {
        let law = GlueLaw {
            presses,
            ..law(Softening::Linear)
        };
        let limits = GlueLimits::flat(STRENGTHS, 0.8);
        let (mut facet, lent) = rising(&law, [-pressure, 0.0, 0.0], &limits);
        let apart = pressure / law.contact;
        let pull = |facet: &mut GluedFacet, z: f64| {
            let to = moved(Vector3::z() * z);
            assert_eq!(facet.advance(&law, &triangle(), &to).glue, 0.0);
            let on: Vector3 = facet.forces(&law, &triangle(), &to).on[0].iter().sum();
            on.z / AREA
        };
        for (part, wanted) in [(-0.5, 0.0), (0.5, -0.5 * pressure), (1.0, 0.0)] {
            let found = pull(&mut facet, part * apart);
            assert!(part < 0.0 || (found - wanted).abs() < 1.0, "{found}");
        }
        let half = pull(&mut facet, apart + 0.5 * STRENGTHS[0] / law.stiffness);
        assert!((half / (0.5 * STRENGTHS[0]) - 1.0).abs() < 1e-9, "{half}");
        let way = [Vector3::zeros(), Vector3::z() * (apart + 2e-5)];
        let (most, lost) = led(&mut facet, &law, way, &Vector3::z());
        assert!(
            (most / STRENGTHS[0] - 1.0).abs() < 1e-1 && most <= STRENGTHS[0],
            "{most}"
        );
        let springs = 0.5 * pressure.powi(2) / law.contact;
        assert!((lent / AREA / springs - 1.0).abs() < 1e-9);
        assert!(facet.is_broken(&law));
        assert!((lost / 20.0 - 1.0).abs() < 1e-9, "{lost:?}");
    }
}

/// A zigzag whose facets are askew to its mean plane by an angle, pulled along that plane's normal or slid along it, bears and takes
/// what the plane does, however far askew, in the mode of the plane.
#[test]
fn a_zigzag_gives_way_in_the_mode_of_its_plane() {
    let law = law(Softening::Linear);
    for angle in [0.2_f64, 0.7, 1.2] {
        // The facet is in the plane of x and y.
        let (sin, cos) = angle.sin_cos();
        let plane = Vector3::new(sin, 0.0, cos);
        // Slid the other way it would be pressed.
        let across = Vector3::new(-cos, 0.0, sin);
        let limits = GlueLimits {
            plane: [cos, sin, 0.0],
            ..GlueLimits::flat(STRENGTHS, 0.0)
        };
        for (way, peak, energy) in [
            (plane, STRENGTHS[0], 20.0),
            (across, STRENGTHS[1], 100.0),
            (Vector3::y(), STRENGTHS[1], 100.0),
        ] {
            let (mut facet, _) = rising(&law, [0.0; 3], &limits);
            let (most, lost) = led(&mut facet, &law, [Vector3::zeros(), way * 1e-4], &way);
            assert!((most / (cos * peak) - 1.0).abs() < 2e-2, "{angle} {most}");
            assert!(
                (lost / (cos * energy) - 1.0).abs() < 1e-9,
                "{angle} {lost:?}"
            );
        }
    }
}

/// Under tension along the normal of the plane that fails, and pressure or tension along that plane, facets of a zigzag carry more
/// than their part of the tension, some of them under pressure and with friction. They give way where that plane does, and take their
/// part of G_I.
#[test]
fn a_zigzag_opens_whatever_the_stress_along_it() {
    for friction in [0.0, 0.3] {
        let law = GlueLaw {
            friction,
            presses: false,
            ..law(Softening::Linear)
        };
        for (angle, along, (pull, gives_way)) in [0.2_f64, 0.5, 0.9].into_iter().flat_map(|angle| {
            [-2.5, -1.0, 0.5].into_iter().flat_map(move |along| {
                [(0.99, false), (1.01, true)].map(|pulled| (angle, along, pulled))
            })
        }) {
            let (sin, cos) = angle.sin_cos();
            // σ = f (pull m m + along s s), where s is in the plane: n = cos m + sin s.
            let of = |m: f64, s: f64| {
                [m * cos + s * sin, m * sin - s * cos, 0.0].map(|t| t * STRENGTHS[0])
            };
            let traction = of(pull * cos, along * sin);
            let limits = GlueLimits {
                plane: [cos, sin, 0.0],
                aside: of(0.0, along * sin),
                ..GlueLimits::flat(STRENGTHS, 0.8)
            };
            let (facet, lent) = rising(&law, traction, &limits);
            let pressure = (-traction[0]).max(0.0);
            let rubbed = (friction * pressure).min(traction[1].abs());
            let lent = lent / AREA
                - 0.5 * pressure.powi(2) / law.contact
                - 0.5 * rubbed.powi(2) / law.tangential;
            // The axes are z, x and y.
            let normal = Vector3::new(sin, 0.0, cos);
            let mut opened = facet.clone();
            opened.advance(&law, &triangle(), &moved(normal * 1e-9));
            let is_softer = opened.damage(&law)[0] > 0.0;
            assert_eq!(is_softer, gives_way, "{friction} {angle} {along} {pull}");
            let (mut facet, way) = (facet, [Vector3::zeros(), normal * 1e-4]);
            let (_, lost) = led(&mut facet, &law, way, &normal);
            assert!(facet.is_broken(&law));
            let taken = (lost - lent) / (20.0 * cos);
            assert!(
                (taken - 1.0).abs() < 1e-4,
                "{friction} {angle} {along} {taken}"
            );
        }
    }
}

/// However soft the springs, because elements are coarse, glue has its peak, and then falls no steeper than it rose.
#[test]
fn glue_too_soft_for_its_energy_has_its_peak() {
    for softening in [
        Softening::Linear,
        Softening::Exponential,
        Softening::Bilinear,
    ] {
        let soft = GlueLaw {
            stiffness: 1e11,
            ..law(softening)
        };
        let limits = GlueLimits::flat(STRENGTHS, 0.0);
        let (mut facet, lent) = rising(&soft, [1e6, 0.0, 0.0], &limits);
        let step = 1e-7;
        let (mut before, mut most, mut steepest, mut work) = (1e6, 0.0_f64, 0.0_f64, 0.0);
        for k in 1..=6000 {
            let to = moved(Vector3::z() * (f64::from(k) * step));
            facet.advance(&soft, &triangle(), &to);
            let on: Vector3 = facet.forces(&soft, &triangle(), &to).on[0].iter().sum();
            let pull = on.z / AREA;
            most = most.max(pull);
            steepest = steepest.max((before - pull) / step);
            work += 0.5 * (before + pull) * step;
            before = pull;
        }
        assert!(facet.is_broken(&soft), "{softening:?}");
        assert!((most / 5e6 - 1.0).abs() < 1e-2 && most <= 5e6, "{most}");
        // Within the step across the peak.
        let over = steepest / soft.stiffness;
        assert!(over < 1.0 + 1e-9 && over > 0.95, "{softening:?} {over}");
        // More than G = 20 J/m².
        assert!(lent > 0.0 && work > 60.0, "{work}");
    }
}

/// A facet across the plane that fails carries all of its traction over some way, too.
#[test]
fn glue_across_the_plane_falls_no_steeper_than_it_rises() {
    let law = law(Softening::Linear);
    let limits = GlueLimits {
        plane: [0.0, 1.0, 0.0],
        ..GlueLimits::flat(STRENGTHS, 0.0)
    };
    let (mut facet, lent) = rising(&law, [3e6, 0.0, 0.0], &limits);
    let stretch = 3e6 / law.stiffness;
    facet.advance(&law, &triangle(), &moved(Vector3::z() * (0.5 * stretch)));
    assert!((facet.damage(&law)[0] - 2.0 / 3.0).abs() < 1e-9);
    let to = moved(Vector3::z() * (1.001 * stretch));
    facet.advance(&law, &triangle(), &to);
    assert!(facet.is_broken(&law) && lent > 0.0);
    // One that carries nothing has nothing.
    let (empty, lent) = rising(&law, [0.0; 3], &limits);
    assert!(empty.is_broken(&law) && lent == 0.0);
}

#[test]
fn strengths_of_mixed_modes_lie_on_an_ellipse() {
    for (sliding, wanted) in [(0.0, 3.0), (1.0, 4.0), (0.5, 288_f64.sqrt() / 5.0)] {
        assert!((mixed_strength([3.0, 4.0], sliding) - wanted).abs() < 1e-12);
    }
    let good = GlueLimits::flat([3.0, 4.0], 0.5);
    assert!(good.check().is_ok());
    let wrong = |limits: GlueLimits| limits.check().unwrap_err().to_string();
    let flat = GlueLimits::flat;
    assert!(wrong(flat([0.0, 1.0], 0.0)).contains("tensile strength of glue"));
    assert!(wrong(flat([1.0, f64::NAN], 0.0)).contains("cohesion of glue"));
    assert!(wrong(flat([1.0, 1.0], -0.1)).contains("slope of glue"));
    for (plane, name) in [
        ([0.9, 0.0, 0.0], "length of the normal"),
        ([-1.0, 0.0, 0.0], "part of glue in its plane"),
    ] {
        assert!(wrong(GlueLimits { plane, ..good }).contains(name));
    }
}

/// What has softened stays soft, unloads towards where it was born, and presses as if it were whole.
#[test]
fn damage_does_not_heal() {
    let law = law(Softening::Linear);
    let (mut facet, _) = cut(&law, [5e6, 0.0, 0.0]);
    let pull = |facet: &GluedFacet, z: f64| {
        let on = facet.forces(&law, &triangle(), &moved(Vector3::z() * z)).on[0];
        on.iter().map(|f| f.z).sum::<f64>() / AREA
    };
    // Half of the peak is left at an opening of G/T.
    facet.advance(&law, &triangle(), &moved(Vector3::z() * 4e-6));
    let half = pull(&facet, 4e-6);
    assert!((half / 2.5e6 - 1.0).abs() < 1e-9, "{half}");
    for z in [2e-6, 0.0, -1e-7] {
        assert_eq!(
            facet
                .advance(&law, &triangle(), &moved(Vector3::z() * z))
                .glue,
            0.0
        );
    }
    let stretch = 5e6 / law.stiffness;
    let expected = half * (2e-6 + stretch) / (4e-6 + stretch);
    assert!((pull(&facet, 2e-6) / expected - 1.0).abs() < 1e-9);
    let pressed = pull(&facet, -1e-6);
    assert!(
        (pressed / (-1e-6 * law.contact) - 1.0).abs() < 1e-9,
        "{pressed}"
    );
}

/// Pressed faces slide at friction, and lose the work of it.
#[test]
fn closed_faces_slide_at_friction() {
    let law = law(Softening::Linear);
    let (mut facet, lent) = cut(&law, [-4e6, 0.0, 0.0]);
    let mut work = 0.0;
    let mut lost = 0.0;
    let mut before = facet.forces(&law, &triangle(), &triangle()).on[1];
    for k in 1..=4000 {
        let to = moved(Vector3::x() * 1e-9 * f64::from(k));
        lost += facet.advance(&law, &triangle(), &to).friction;
        let now = facet.forces(&law, &triangle(), &to).on[1];
        work -= (0..3)
            .map(|q| 0.5 * (before[q] + now[q]).x * 1e-9)
            .sum::<f64>();
        before = now;
    }
    let drag = -before.iter().map(|f| f.x).sum::<f64>() / AREA;
    assert!((drag / (0.6 * 4e6) - 1.0).abs() < 1e-9, "{drag}");
    let stored = facet.forces(&law, &triangle(), &moved(Vector3::x() * 4e-6));
    assert!(((energy(&stored) - lent + lost) / work - 1.0).abs() < 1e-9);
    // Apart it lets go of its springs, and does not rub.
    let mut apart = moved(Vector3::new(4e-6, 0.0, 1e-6));
    let let_go = facet.advance(&law, &triangle(), &apart).friction;
    let springs = 0.5 * AREA * (0.6_f64 * 4e6).powi(2) / law.tangential;
    assert!((let_go / springs - 1.0).abs() < 1e-9);
    apart[1].x += 5e-6;
    assert_eq!(facet.advance(&law, &triangle(), &apart).friction, 0.0);
}

/// Where the faces meet by another law, the facet keeps the pressure of its birth while they overlap, loses it as they go apart, and
/// lets it fade in fifty steps when nothing holds them: then it is spent.
#[test]
fn the_pressure_of_the_birth_fades() {
    let law = GlueLaw {
        presses: false,
        friction: 0.0,
        ..law(Softening::Linear)
    };
    let (mut facet, lent) = rising(&law, [-4e6, 0.0, 0.0], &GlueLimits::flat(STRENGTHS, 0.0));
    let push = |facet: &GluedFacet, z: f64| {
        let on = facet.forces(&law, &triangle(), &moved(Vector3::z() * z)).on[1];
        on.iter().map(|f| f.z).sum::<f64>() / AREA
    };
    // The pressure is gone at an opening of 4e6/2e13 m; from there on the glue pulls.
    for (z, pressure) in [(-3e-7, 4e6), (0.0, 4e6), (1e-7, 2e6), (3e-7, -1e6)] {
        assert!((push(&facet, z) - pressure).abs() < 1.0, "{z}");
    }
    // Glue that holds keeps the pressure.
    for _ in 0..60 {
        let still = facet.advance(&law, &triangle(), &triangle());
        assert_eq!(still, GlueLoss::default());
    }
    assert!((push(&facet, 0.0) - 4e6).abs() < 1.0 && !facet.is_broken(&law));
    let slid = moved(Vector3::x() * 1e-4);
    let mut lost = facet.advance(&law, &triangle(), &slid).pressure;
    assert!(facet.is_broken(&law) && !facet.is_spent(&law));
    for _ in 0..49 {
        lost += facet.advance(&law, &triangle(), &triangle()).pressure;
    }
    assert!((lost / lent - 1.0).abs() < 1e-9 && push(&facet, 0.0).abs() < 1.0);
    facet.advance(&law, &triangle(), &triangle());
    assert!(facet.is_spent(&law) && facet.stiffness(&law) == [0.0; 3]);
}

#[test]
fn laws_that_cannot_be_are_refused_by_name() {
    let good = law(Softening::Linear);
    assert!(good.check().is_ok());
    assert!(GluedFacet::new(-1.0).is_err() && GluedFacet::new(f64::NAN).is_err());
    for (law, name) in [
        (
            GlueLaw {
                stiffness: 0.0,
                ..good
            },
            "stiffness of the glue",
        ),
        (
            GlueLaw {
                energies: [0.0, 1.0],
                ..good
            },
            "opening",
        ),
        (
            GlueLaw {
                energies: [1.0, f64::NAN],
                ..good
            },
            "sliding",
        ),
        (
            GlueLaw {
                friction: -0.1,
                ..good
            },
            "friction",
        ),
        (
            GlueLaw {
                contact: f64::INFINITY,
                ..good
            },
            "contact",
        ),
    ] {
        let error = law.check().unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
    let flat = GlueLimits::flat(STRENGTHS, 0.8);
    assert!(flat.check().is_ok());
    for (limits, name) in [
        (GlueLimits::flat([0.0, 1e6], 0.8), "tensile strength"),
        (GlueLimits::flat([1e6, f64::NAN], 0.8), "cohesion"),
        (GlueLimits::flat(STRENGTHS, -0.1), "slope"),
        (
            GlueLimits {
                plane: [0.6, 0.6, 0.0],
                ..flat
            },
            "length of the normal",
        ),
        (
            GlueLimits {
                plane: [-1.0, 0.0, 0.0],
                ..flat
            },
            "part of glue in its plane",
        ),
        (
            GlueLimits {
                aside: [0.0, f64::NAN, 0.0],
                ..flat
            },
            "traction of glue along the crack",
        ),
    ] {
        let error = limits.check().unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}
