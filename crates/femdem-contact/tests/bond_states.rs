//! Bonds that give way: dashpots, energies of mixed modes, friction, sections of faces, and when they end.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::bonds::{LAW, moved, pair, square};
use crate::common::Stream;
use femdem_contact::bond::{Bond, BondLaw, BondSection, between_shapes};
use femdem_contact::{
    BodyShape, ContactBatch, ContactError, ContactLaw, ContactParameters, ConvexShape, Frame,
    Motion,
};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, Vector3};

fn cube(edge: f64) -> BodyShape {
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(edge * 3_f64.sqrt()).unwrap();
    ConvexShape::new(&cube).unwrap().into()
}

/// A batch of the bodies of [`pair`], so small that only their bonds meet.
fn batch(sections: &[BondSection], law: BondLaw) -> (ContactBatch, [Motion; 2]) {
    let contact = ContactLaw::new(ContactParameters::default()).unwrap();
    let mut batch = ContactBatch::new(contact);
    let shape = batch.add_shape(cube(0.02));
    for _ in 0..2 {
        batch.add_body(shape).unwrap();
    }
    let (_, sides) = pair(law);
    for section in sections {
        batch.add_bond([0, 1], section, law, &sides).unwrap();
    }
    (batch, sides)
}

/// What a dashpot takes follows the stiffness that is left. Pulled apart at a constant speed v by opening and by sliding, the
/// springs have the peak f A and the work G A, and the dashpot takes the integral of c v S/k over the way, in closed form for
/// linear softening; at the end nothing is left of either.
#[test]
fn dashpots_fade_with_the_bond() {
    let (zeta, speed, area) = (0.5, 2.0, 1e-2);
    let law = BondLaw {
        damping: zeta,
        ..LAW
    };
    for (axis, strength, energy) in [(0, 1e6, 20.0), (1, 3e6, 100.0)] {
        let (mut batch, mut sides) = batch(&[square(0.1)], law);
        let last = 2.0 * energy / strength;
        let (steps, mut peak, mut work, mut drag) = (4000, 0.0_f64, 0.0, 0.0);
        let mut before = [0.0; 2];
        for k in 0..=steps {
            let way = 1.05 * last * f64::from(k) / f64::from(steps);
            sides[1] = moved(Vector3::ith(axis, way), Vector3::zeros());
            sides[1].velocity = Vector3::ith(axis, speed);
            batch.update(&sides, &[], 1e-9).unwrap();
            let load = batch.load_of(0);
            let now = [load.total.force[axis], load.damping.force[axis]];
            peak = peak.max(now[0] - now[1]);
            let step = if k > 0 {
                1.05 * last / f64::from(steps)
            } else {
                0.0
            };
            work += 0.5 * (now[0] + before[0]) * step;
            drag += 0.5 * (now[1] + before[1]) * step;
            before = now;
        }
        assert!(before == [0.0; 2], "{before:?}");
        assert!((peak / (strength * area) - 1.0).abs() < 0.01, "{peak}");
        assert!(((work - drag) / (energy * area) - 1.0).abs() < 1e-3);
        // Bodies of 1 kg: c = 2 zeta sqrt(k A/2), so c/(k A) = 2 zeta/sqrt(2 k A).
        let first = strength / law.stiffness;
        let fall = strength / (last - first) * (last * (last / first).ln() - (last - first));
        let expected =
            2.0 * zeta / (2.0 * law.stiffness * area).sqrt() * speed * area * (strength + fall);
        assert!((drag / expected - 1.0).abs() < 1e-3, "{drag} {expected}");
    }
}

/// Where broken faces slide under pressure friction alone resists, with a dashpot and without.
#[test]
fn dashpots_do_not_add_to_friction() {
    let law = BondLaw {
        damping: 0.5,
        ..LAW
    };
    let (mut batch, mut sides) = batch(&[square(0.1)], law);
    for k in 0..4000 {
        let by = Vector3::new(-2e-5, 2.5e-4 * f64::from(k) / 4000.0, 0.0);
        sides[1] = moved(by, Vector3::zeros());
        sides[1].velocity = Vector3::y() * 2.0;
        batch.update(&sides, &[], 1e-9).unwrap();
    }
    let held = 0.6 * 2e6 * 1e-2;
    let force = batch.load_of(0).total.force.y;
    assert!((force / held - 1.0).abs() < 1e-6, "{force} {held}");
    // Pressed at a speed, the whole dashpot acts along the normal: c = 2 zeta sqrt(k A/2).
    sides[1].velocity = Vector3::x();
    batch.update(&sides, &[], 1e-9).unwrap();
    let drag = batch.load_of(0).damping.force.x;
    let expected = 2.0 * 0.5 * (1e11_f64 * 1e-2 / 2.0).sqrt();
    assert!((drag / expected - 1.0).abs() < 1e-9, "{drag} {expected}");
}

/// Sheared apart under a pressure p, glue takes G_II A, and friction the rest: r = mu p over all of the way but the stretch
/// of its springs.
#[test]
fn glue_takes_its_energy_under_pressure() {
    let (pressure, area) = (2e6, 1e-2);
    let (mut bond, sides) = pair(LAW);
    let (end, steps) = (2.5e-4, 20_000);
    for k in 0..=steps {
        let by = Vector3::new(-pressure / 1e11, end * f64::from(k) / f64::from(steps), 0.0);
        bond.update([&sides[0], &moved(by, Vector3::zeros())]);
    }
    assert!(bond.is_broken());
    let lost = bond.lost();
    assert!((lost.glue / (100.0 * area) - 1.0).abs() < 1e-4, "{lost:?}");
    let rubbed = 0.6 * pressure;
    let friction = rubbed * (end - rubbed / 1e11) * area;
    assert!(
        (lost.friction / friction - 1.0).abs() < 1e-4,
        "{lost:?} {friction}"
    );
}

/// Pulled apart along a line at an angle: G_I + (G_II - G_I) s^2 with s the square of its sine.
#[test]
fn mixed_modes_take_their_energy() {
    for degrees in [20.0_f64, 45.0, 70.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (mut bond, sides) = pair(LAW);
        for k in 0..=20_000 {
            let by = Vector3::new(cos, 0.0, sin) * (1.5e-4 * f64::from(k) / 20_000.0);
            bond.update([&sides[0], &moved(by, Vector3::zeros())]);
        }
        assert!(bond.is_broken() && bond.state().energy == 0.0);
        let expected = (20.0 + 80.0 * sin.powi(4)) * 1e-2;
        let lost = bond.lost();
        assert!(
            (lost.glue / expected - 1.0).abs() < 1e-4,
            "{degrees} {lost:?} {expected}"
        );
        assert!((bond.mode() - sin * sin).abs() < 1e-9, "{}", bond.mode());
    }
}

/// A law in which one mode between the pure ones, and between any coarse samples, has no energy left beyond its strength is
/// refused: such glue would never break. Of one with a little left that mode breaks and takes its energy.
#[test]
fn every_mode_has_energy_to_soften_by() {
    // G/peak^2 is the least at a part of sliding of 5e-4, 1 % below that of opening.
    let law = |stored: f64| BondLaw {
        tensile: 1e6,
        cohesion: 1e6 / 21_f64.sqrt(),
        energies: [10.0, 1.0],
        mix: 0.5,
        stiffness: 1e12 / (2.0 * 10.0 * stored),
        ..LAW
    };
    let refused = law(0.995).check().unwrap_err().to_string();
    assert!(refused.contains("raise the energy"), "{refused}");
    let sliding = 5e-4_f64;
    let along = Vector3::new((1.0 - sliding).sqrt(), sliding.sqrt(), 0.0);
    let (mut bond, sides) = pair(law(0.9));
    for k in 0..=10_000 {
        let by = along * (4e-5 * f64::from(k) / 10_000.0);
        bond.update([&sides[0], &moved(by, Vector3::zeros())]);
    }
    assert!(bond.is_broken());
    let expected = (10.0 - 9.0 * sliding.sqrt()) * 1e-2;
    let lost = bond.lost().glue;
    assert!((lost / expected - 1.0).abs() < 1e-3, "{lost} {expected}");
}

/// Faces of turned and tilted cubes have a section whatever rounding makes of the corners of their common part, whole or shrunk.
#[test]
fn faces_have_sections_in_all_poses() {
    let shape = cube(1.0);
    let mut stream = Stream(7);
    for case in 0..4000 {
        let small = 10_f64.powi(-(case % 16) - 1);
        let mut signed = || 2.0 * stream.unit() - 1.0;
        let whole = Pose::new(
            Vector3::new(signed(), signed(), signed()) * 3.0,
            Vector3::new(signed(), signed(), signed()),
        );
        let tilt = Vector3::new(signed(), signed(), signed()) * small.min(0.02);
        let by = Vector3::new(1.0 + 1e-3 * signed(), small * signed(), small * signed());
        let other = whole * Pose::new(by, tilt);
        let ratio = if case % 2 == 0 { 1.0 } else { 0.5 };
        let frames = [Frame::from(&whole), Frame::from(&other)];
        let found = between_shapes([(&shape, &frames[0]), (&shape, &frames[1])], 0.1, ratio);
        let section = found.unwrap_or_else(|error| panic!("{case}: {error}"));
        let area = section.unwrap_or_else(|| panic!("{case}: none")).area();
        // Shifts and turns of the common part by up to these.
        let most = 2.2 * small.min(1.0) + 0.01;
        assert!((area / (ratio * ratio) - 1.0).abs() < most, "{case} {area}");
    }
}

/// A bond opens or slides in a step by a part of the shorter of G_I/f_t and G_II/c.
#[test]
fn steps_resolve_opening_and_sliding() {
    let law = BondLaw {
        energies: [1000.0, 60.0],
        ..LAW
    };
    let (batch, mut sides) = batch(&[square(0.1)], law);
    sides[1].velocity = Vector3::y() * 2.0;
    let step = batch.step_of_bonds(&sides, 0.2).unwrap();
    assert!(
        (step / (0.2 * 60.0 / 3e6 / 2.0) - 1.0).abs() < 1e-9,
        "{step}"
    );
}

#[test]
fn motions_must_be_those_of_all_bodies() {
    let (mut batch, sides) = batch(&[square(0.1)], LAW);
    let is_count = |error: ContactError| {
        matches!(
            error,
            ContactError::StateCount {
                what: "body",
                given: 1,
                expected: 2
            }
        )
    };
    assert!(is_count(batch.step_of_bonds(&sides[..1], 0.2).unwrap_err()));
    assert!(is_count(batch.end_bonds(&sides[..1], 0.0).unwrap_err()));
}

/// Two bonds on a pair, the halves of a square, are the whole one together; the pair meets by the kernel once both have
/// ended.
#[test]
fn two_bonds_on_a_pair() {
    let half = |from: f64, to: f64| {
        let corners = [[-0.05, from], [0.05, from], [0.05, to], [-0.05, to]];
        let corners = corners.map(|[y, z]| Vector3::new(0.0, y, z));
        BondSection::polygon(&corners, Vector3::x()).unwrap()
    };
    let (mut batch, mut sides) = batch(&[half(-0.05, 0.0), half(0.0, 0.05)], LAW);
    let turn = Vector3::new(2e-6, -1e-6, 3e-6);
    sides[1] = moved(Vector3::new(1e-6, 2e-6, -1e-6), turn);
    batch.update(&sides, &[], 1e-9).unwrap();
    let (mut one, at) = pair(LAW);
    one.update([&at[0], &sides[1]]);
    let state = one.state();
    let load = batch.load_of(0).total;
    let torque = state.moment + (state.centre - at[0].frame.position).cross(&state.force);
    assert!((load.force - state.force).norm() < 1e-5 * state.force.norm());
    assert!((load.torque - torque).norm() < 1e-5 * torque.norm());
    // Hinged at the lower edge: the upper half breaks and is clear, the lower one holds.
    let angle = 1e-3;
    sides[1] = moved(Vector3::x() * (0.05 * angle), Vector3::y() * angle);
    batch.update(&sides, &[], 1e-9).unwrap();
    let ended = batch.end_bonds(&sides, 1.0).unwrap();
    let broken = |batch: &ContactBatch| [0, 1].map(|id| batch.bond(id).unwrap().has_ended());
    assert_eq!((broken(&batch), ended.parted.len()), ([false, true], 0));
    assert!(batch.are_bonded([1, 0]));
    sides[1] = moved(Vector3::x() * 1e-3, Vector3::zeros());
    batch.update(&sides, &[], 1e-9).unwrap();
    let ended = batch.end_bonds(&sides, 2.0).unwrap();
    assert_eq!(Vec::from_iter(ended.parted), [(0, 1)]);
    assert!(broken(&batch) == [true, true] && !batch.are_bonded([0, 1]));
}

/// A broken bond that is pressed at one edge ends when the other has opened by a tenth of its width, as it does where it has slid
/// as far.
#[test]
fn hinged_and_slid_bonds_end() {
    let hinged = |angle: f64| {
        let lift = Vector3::x() * (0.05 * angle.sin() - 1e-6);
        moved(lift, Vector3::y() * angle)
    };
    let slid = |way: f64| moved(Vector3::new(-1e-6, way, 0.0), Vector3::zeros());
    for (place, ends) in [
        (hinged(0.09), false),
        (hinged(0.11), true),
        (slid(0.0099), false),
        (slid(0.0101), true),
    ] {
        let (mut batch, mut sides) = batch(&[square(0.1)], LAW);
        sides[1] = moved(Vector3::x() * 1e-3, Vector3::zeros());
        batch.update(&sides, &[], 1e-9).unwrap();
        sides[1] = place;
        batch.update(&sides, &[], 1e-9).unwrap();
        let bond: &Bond = batch.bond(0).unwrap();
        let held = bond.state().energy;
        assert!(bond.is_broken() && held > 0.0, "{held}");
        let ended = batch.end_bonds(&sides, 1.0).unwrap();
        assert_eq!(!ended.parted.is_empty(), ends);
        let sum = 0.0 + ended.held.values().sum::<f64>();
        assert_eq!(sum, if ends { held } else { 0.0 });
    }
}
