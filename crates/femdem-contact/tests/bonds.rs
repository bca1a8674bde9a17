//! Bonds: gradient, balance, stiffness, strength and energy of a pair.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::bond::{Bond, BondLaw, BondSection, between_shapes, between_spheres};
use femdem_contact::{BodyShape, ConvexShape, Frame, Motion};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, Rotation, Vector3};

pub(crate) const LAW: BondLaw = BondLaw {
    stiffness: 1e11,
    tensile: 1e6,
    cohesion: 3e6,
    friction: 0.6,
    energies: [20.0, 100.0],
    mix: 2.0,
    softening: femdem_contact::glue::Softening::Linear,
    damping: 0.0,
};

fn motion(x: Vector3, turn: Vector3) -> Motion {
    let frame = Frame::from(&Pose::new(x, turn));
    Motion {
        inverse_mass: 1.0,
        inverse_inertia_max: 100.0,
        ..Motion::fixed(frame)
    }
}

/// A square of side `a` about the origin, across x.
pub(crate) fn square(a: f64) -> BondSection {
    let corner = |y: f64, z: f64| Vector3::new(0.0, y, z) * (0.5 * a);
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    BondSection::polygon(&corners, Vector3::x()).unwrap()
}

/// Two bodies at -0.1 and 0.1 m on the x axis with a square bond of 0.1 m between.
pub(crate) fn pair(law: BondLaw) -> (Bond, [Motion; 2]) {
    let sides = [-0.1, 0.1].map(|x| motion(Vector3::x() * x, Vector3::zeros()));
    let bond = Bond::new([0, 1], &square(0.1), law, [&sides[0], &sides[1]]).unwrap();
    (bond, sides)
}

/// Moves B by a translation and a rotation about the middle of the bond.
pub(crate) fn moved(by: Vector3, turn: Vector3) -> Motion {
    let rotation = Rotation::from_scaled_axis(turn);
    motion(by + rotation * Vector3::x() * 0.1, turn)
}

/// Forces and torques of both sides by the state of the bond.
fn wrenches(bond: &Bond, sides: &[Motion; 2]) -> [[Vector3; 2]; 2] {
    let state = bond.state();
    [1.0, -1.0].map(|sign| {
        let side = &sides[usize::from(sign < 0.0)];
        let arm = state.centre - side.frame.position;
        [
            state.force * sign,
            (state.moment + arm.cross(&state.force)) * sign,
        ]
    })
}

/// The wrenches are minus the derivatives of the energy by the motions of either body, whole, softened and pressed.
#[test]
fn bonds_are_gradients() {
    let starts = [
        (
            Vector3::new(2e-6, 1e-6, -3e-6),
            Vector3::new(1e-5, -2e-5, 3e-5),
        ),
        (
            Vector3::new(2e-5, 3e-5, 1e-5),
            Vector3::new(3e-4, -4e-4, 2e-4),
        ),
        (
            Vector3::new(-1e-5, 5e-5, 1e-5),
            Vector3::new(3e-4, -1e-4, 2e-4),
        ),
    ];
    for (k, (by, turn)) in starts.into_iter().enumerate() {
        let (mut bond, mut sides) = pair(LAW);
        // Seen from elsewhere, both turned.
        let whole = Pose::new(Vector3::new(0.4, -0.2, 0.7), Vector3::new(0.9, -1.7, 0.4));
        sides[1] = moved(by, turn);
        let place = |side: &Motion| {
            let frame = Frame::from(&whole);
            Motion {
                frame: Frame {
                    position: frame.point(&side.frame.position),
                    rotation: frame.rotation * side.frame.rotation,
                },
                ..*side
            }
        };
        let sides = sides.map(|side| place(&side));
        bond.update([&sides[0], &sides[1]]);
        assert_eq!(bond.has_yielded(), k > 0, "case {k}");
        // Bigger damage first, so that nothing changes for good in the differences.
        let worse = place(&moved(by * 1.3, turn * 1.3));
        bond.update([&sides[0], &worse]);
        bond.update([&sides[0], &sides[1]]);
        let loads = wrenches(&bond, &sides);
        // Friction slides one way only: differences are good to the step over the opening.
        let step = 1e-11;
        for side in 0..2 {
            for axis in 0..6 {
                let unit = Vector3::ith(axis % 3, step);
                let energy = |sign: f64| {
                    let mut moved = sides;
                    let frame = &mut moved[side].frame;
                    if axis < 3 {
                        frame.position += unit * sign;
                    } else {
                        let turn = Rotation::from_scaled_axis(unit * (10.0 * sign));
                        frame.rotation = turn.to_rotation_matrix().into_inner() * frame.rotation;
                    }
                    let mut bond = bond.clone();
                    let lost = bond.update([&moved[0], &moved[1]]);
                    bond.state().energy + lost.friction
                };
                let scale = if axis < 3 { 1.0 } else { 10.0 };
                let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step * scale);
                let load = loads[side][axis / 3][axis % 3];
                let size = loads[side][axis / 3].norm() + 1.0;
                assert!(
                    (slope + load).abs() < 5e-6 * size,
                    "{k} {side} {axis}: {slope} {load}"
                );
            }
        }
    }
}

/// A layer of springs: k A along and across, k I in bending, k (I1 + I2) in torsion, in tension and in pressure.
#[test]
fn stiffness_is_that_of_a_layer_of_springs() {
    let (area, moment) = (1e-2, 1e-4 / 12.0);
    let (small, angle) = (1e-8, 1e-7);
    for sign in [1.0, -1.0] {
        for axis in 0..3 {
            let unit = Vector3::ith(axis, sign);
            let (mut bond, sides) = pair(LAW);
            bond.update([&sides[0], &moved(unit * small, Vector3::zeros())]);
            let force = bond.state().force[axis] * sign;
            assert!(
                (force / (1e11 * area * small) - 1.0).abs() < 1e-6,
                "{axis} {force}"
            );
            let (mut bond, sides) = pair(LAW);
            bond.update([&sides[0], &moved(Vector3::zeros(), unit * angle)]);
            let second = if axis == 0 { 2.0 * moment } else { moment };
            let got = bond.state().moment[axis] * sign;
            assert!(
                (got / (1e11 * second * angle) - 1.0).abs() < 1e-5,
                "{axis} {got}"
            );
        }
    }
}

/// Peak force and dissipated energy of the modes: f_t A and G_I A by opening, c A and G_II A by sliding.
#[test]
fn pulled_and_sheared_apart() {
    for (axis, strength, energy) in [(0, 1e6, 20.0), (1, 3e6, 100.0), (2, 3e6, 100.0)] {
        let (mut bond, sides) = pair(LAW);
        let (mut peak, mut work, mut before) = (0.0_f64, 0.0, 0.0);
        let (end, steps) = (1.05 * 2.0 * energy / strength, 20_000);
        for k in 1..=steps {
            let by = Vector3::ith(axis, end * f64::from(k) / f64::from(steps));
            bond.update([&sides[0], &moved(by, Vector3::zeros())]);
            let force = bond.state().force[axis];
            work += 0.5 * (force + before) * end / f64::from(steps);
            before = force;
            peak = peak.max(force);
        }
        assert!(bond.is_broken() && bond.state().energy == 0.0);
        assert!((peak / (strength * 1e-2) - 1.0).abs() < 0.01, "{peak}");
        let lost = bond.lost();
        assert!((lost.glue / (energy * 1e-2) - 1.0).abs() < 1e-6, "{lost:?}");
        assert!((work / lost.glue - 1.0).abs() < 1e-3, "{work} {lost:?}");
        assert!((bond.mode() - if axis == 0 { 0.0 } else { 1.0 }).abs() < 1e-12);
    }
}

/// Bending gives way at M = f_t W, with the outermost points in the middles of the edges; under pressure shear is held by
/// cohesion and friction, and friction alone is left.
#[test]
fn first_damage_in_bending_and_shear_under_pressure() {
    let section_modulus = 1e-3 / 6.0;
    for (over, yields) in [(0.999, false), (1.001, true)] {
        let (mut bond, sides) = pair(LAW);
        let angle = over * 1e6 * section_modulus / (1e11 * 1e-4 / 12.0);
        bond.update([&sides[0], &moved(Vector3::zeros(), Vector3::y() * angle)]);
        assert_eq!(bond.has_yielded(), yields);
        // T = c (I1 + I2)/r, at half an edge from the centre, too.
        let (mut bond, sides) = pair(LAW);
        let angle = over * 3e6 / (1e11 * 0.05);
        bond.update([&sides[0], &moved(Vector3::zeros(), Vector3::x() * angle)]);
        assert_eq!(bond.has_yielded(), yields);
        let torque = 1e11 * angle * 1e-4 / 6.0;
        let twisted = bond.state().moment.x;
        // The points at half an edge carry half of it; beyond their strength c, at c/k, they soften towards 2 G/c.
        let (first, last) = (3e6 / 1e11, 2.0 * 100.0 / 3e6);
        let softened = (1.0 - (over - 1.0).max(0.0) * first / (last - first)) / over.max(1.0);
        let expected = torque * 0.5 * (1.0 + softened);
        assert!(
            (twisted / expected - 1.0).abs() < 1e-5,
            "{twisted} {expected}"
        );
    }
    let pressure = 2e6;
    let (mut bond, sides) = pair(LAW);
    let mut peak = 0.0_f64;
    for k in 0..4000 {
        let by = Vector3::new(-pressure / 1e11, 2.5e-4 * f64::from(k) / 4000.0, 0.0);
        bond.update([&sides[0], &moved(by, Vector3::zeros())]);
        peak = peak.max(bond.state().force.y);
    }
    assert!(
        (peak / ((3e6 + 0.6 * pressure) * 1e-2) - 1.0).abs() < 0.01,
        "{peak}"
    );
    let left = bond.state().force.y;
    assert!(
        bond.is_broken() && (left / (0.6 * pressure * 1e-2) - 1.0).abs() < 1e-3,
        "{left}"
    );
}

/// A stressed pair carried through half a turn keeps its energy.
#[test]
fn half_a_turn_changes_nothing() {
    let (mut bond, mut sides) = pair(LAW);
    sides[1] = moved(
        Vector3::new(1.5e-5, 2e-5, 0.0),
        Vector3::new(1e-4, 2e-4, 0.0),
    );
    bond.update([&sides[0], &sides[1]]);
    let before = (bond.state().energy, bond.damage());
    assert!(before.1 > 0.1);
    for k in 1..=100 {
        let turn = Vector3::new(1.0, 2.0, -1.0).normalize()
            * (std::f64::consts::PI * f64::from(k) / 100.0);
        let frame = Frame::from(&Pose::new(Vector3::new(3.0, 1.0, 0.0), turn));
        let turned = sides.map(|side| Motion {
            frame: Frame {
                position: frame.point(&side.frame.position),
                rotation: frame.rotation * side.frame.rotation,
            },
            ..side
        });
        let lost = bond.update([&turned[0], &turned[1]]);
        assert!(lost.glue < 1e-9 * before.0);
    }
    assert!((bond.state().energy / before.0 - 1.0).abs() < 1e-9);
}

/// Sections of spheres and of faces that face each other, and a gap that is too wide.
#[test]
fn sections_between_bodies() {
    let spheres = |gap: f64| {
        between_spheres(
            [Vector3::zeros(), Vector3::y() * 0.31],
            [0.1, 0.2],
            gap,
            0.5,
        )
        .unwrap()
    };
    let disc = spheres(0.02).unwrap();
    assert!((disc.area() / (std::f64::consts::PI * 0.05 * 0.05) - 1.0).abs() < 1e-12);
    assert!((disc.centre() - Vector3::y() * 0.105).norm() < 1e-12);
    assert!(spheres(0.009).is_none());
    let cube = "P5"
        .parse::<CatalogueShape>()
        .unwrap()
        .polyhedron(3_f64.sqrt())
        .unwrap();
    let cube = BodyShape::from(ConvexShape::new(&cube).unwrap());
    let at = |x: Vector3, turn: Vector3| Frame::from(&Pose::new(x, turn));
    let frame = at(Vector3::new(5.0, 0.0, 0.0), Vector3::zeros());
    let beside = at(
        Vector3::new(6.001, 0.4, 0.0),
        Vector3::x() * std::f64::consts::FRAC_PI_2,
    );
    let found = |gap: f64| between_shapes([(&cube, &frame), (&cube, &beside)], gap, 1.0).unwrap();
    let face = found(0.01).unwrap();
    assert!((face.area() - 0.6).abs() < 1e-9, "{}", face.area());
    assert!((face.centre() - Vector3::new(5.5005, 0.2, 0.0)).norm() < 1e-9);
    assert!((face.normal() - Vector3::x()).norm() < 1e-9);
    assert!(found(1e-4).is_none());
}

#[test]
fn laws_and_sections_that_cannot_be_are_refused() {
    let refused = |law: BondLaw| law.check().unwrap_err().to_string();
    for (message, name) in [
        (
            refused(BondLaw {
                tensile: 0.0,
                ..LAW
            }),
            "tensile",
        ),
        (
            refused(BondLaw {
                cohesion: f64::NAN,
                ..LAW
            }),
            "cohesion",
        ),
        (
            refused(BondLaw {
                stiffness: -1.0,
                ..LAW
            }),
            "stiffness",
        ),
        (
            refused(BondLaw {
                damping: -0.1,
                ..LAW
            }),
            "damping",
        ),
        (
            refused(BondLaw {
                energies: [4.9, 100.0],
                ..LAW
            }),
            "raise the energy",
        ),
        (
            refused(BondLaw {
                energies: [20.0, 44.0],
                ..LAW
            }),
            "raise the energy",
        ),
    ] {
        assert!(message.contains(name), "{message}");
    }
    let at = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    let polygon =
        |corners: &[Vector3], to| BondSection::polygon(corners, to).unwrap_err().to_string();
    let square = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    assert!(polygon(&square[..2], Vector3::z()).contains("3 or more"));
    assert!(polygon(&square, Vector3::x()).contains("area"));
    let mut bent = square;
    bent[2].z = 0.1;
    assert!(polygon(&bent, Vector3::z()).contains("flat"));
    let crossed = [square[0], square[2], square[1], square[3]];
    assert!(!polygon(&crossed, Vector3::z()).is_empty());
    let flipped = BondSection::polygon(&square, -Vector3::z()).unwrap();
    assert_eq!(flipped.normal(), -Vector3::z());
}
