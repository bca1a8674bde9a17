//! Bonds between the bodies of a world.

use std::mem::MaybeUninit;
use std::ptr::null;

use femdem_capi::FemdemStatus::{Null, Refused};
use femdem_capi::*;

use crate::common::{all, at, fails, got, named, ok, resting};

/// Without sleep.
fn world() -> FemdemWorld {
    let parameters = FemdemWorldParameters {
        sleeping: 0,
        ..got(|to| femdem_world_defaults(to))
    };
    got(|to| femdem_world_new(Some(&parameters), to))
}

fn bonds(world: FemdemWorld) -> Vec<FemdemBond> {
    // SAFETY: lists and rooms of `all` fit.
    all(FemdemBond::default(), |to, room, count| unsafe {
        femdem_world_bonds(world, to, room, count)
    })
}

fn law() -> FemdemBondLaw {
    FemdemBondLaw {
        damping: 0.5,
        ..got(|to| femdem_bond_law_default(to))
    }
}

/// Two bodies side by side along x, `distance` apart; the first is held.
fn pair(world: FemdemWorld, name: &str, size: f64, distance: f64) -> [u32; 2] {
    let shape = named(name, size);
    let bodies = [0.0, distance].map(|x| {
        let motion = resting(at(x, 0.0, 0.0));
        got(|to| femdem_world_add_body(world, shape, 2500.0, Some(&motion), 0, to))
    });
    let held = FemdemDrive {
        kind: FEMDEM_DRIVE_FIXED,
        periods: 0,
        vector: [0.0; 3],
        point: [0.0; 3],
        rate: 0.0,
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    };
    ok(femdem_world_drive_body(world, bodies[0], Some(&held)));
    bodies
}

/// A ball glued to one that is held hangs by its weight, and its moment; pulled by more than the mortar bears it comes off.
#[test]
fn a_ball_hangs_on_its_bond_and_comes_off() {
    let world = world();
    let [a, b] = pair(world, "sphere", 0.1, 0.1);
    let bond = got(|to| femdem_world_add_bond_between(world, a, b, 1e-3, 0.5, Some(&law()), to));
    ok(femdem_world_step_until(world, 0.02));
    let found = bonds(world);
    assert_eq!(
        (found.len(), found[0].bond, found[0].a, found[0].b),
        (1, bond, a, b)
    );
    // The disc has half the radius of the balls; its hexagon has that area.
    assert!((found[0].area / (std::f64::consts::PI * 0.025_f64.powi(2)) - 1.0).abs() < 1e-9);
    let weight = 9.81 * 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.05_f64.powi(3);
    assert!(
        (found[0].force[2] / -weight - 1.0).abs() < 0.02,
        "{found:?}"
    );
    assert!(
        (found[0].moment[1] / (0.05 * weight) - 1.0).abs() < 0.02,
        "{found:?}"
    );
    assert_eq!((found[0].broken, found[0].damage), (0, 0.0));
    assert!(found[0].broken_at.is_nan());

    let pull = FemdemLoad {
        force: [1.5 * law().tensile * found[0].area, 0.0, 0.0],
        torque: [0.0; 3],
    };
    ok(femdem_world_set_load(world, b, Some(&pull)));
    ok(femdem_world_step_until(world, 0.03));
    let found = bonds(world);
    assert_eq!(
        (found[0].broken, found[0].ended, found[0].damage),
        (1, 1, 1.0)
    );
    assert!((0.02..0.03).contains(&found[0].broken_at));
    // By opening, which takes the energy of fracture of the area.
    assert!(found[0].mode < 0.1, "{found:?}");
    let energy = found[0].dissipated / (law().opening_energy * found[0].area);
    assert!((energy - 1.0).abs() < 0.1, "{energy}");
    ok(femdem_world_remove_body(world, b));
    assert_eq!(bonds(world), []);
}

/// Cubes with a joint of mortar between them: a pull stretches it by its stress over its stiffness.
#[test]
fn a_joint_over_a_polygon_stretches_by_its_stiffness() {
    let world = world();
    ok(femdem_world_set_gravity(world, 0.0, 0.0, 0.0));
    let [a, b] = pair(world, "cube", 0.1 * 3_f64.sqrt(), 0.11);
    let corners = [
        [0.055, -0.04, -0.05],
        [0.055, 0.04, -0.05],
        [0.055, 0.04, 0.05],
        [0.055, -0.04, 0.05],
    ];
    let law = FemdemBondLaw {
        stiffness: 1e10,
        opening_energy: 200.0,
        sliding_energy: 1000.0,
        ..law()
    };
    // SAFETY: rows of three, as many as said.
    got(|to| unsafe {
        femdem_world_add_bond(
            world,
            a,
            b,
            corners.as_flattened().as_ptr(),
            4,
            Some(&law),
            to,
        )
    });
    let pull = FemdemLoad {
        force: [4000.0, 0.0, 0.0],
        torque: [0.0; 3],
    };
    ok(femdem_world_set_load(world, b, Some(&pull)));
    ok(femdem_world_step_until(world, 0.05));
    let bond = bonds(world)[0];
    assert!((bond.area - 0.008).abs() < 1e-12 && bond.normal == [1.0, 0.0, 0.0]);
    assert!((bond.force[0] / 4000.0 - 1.0).abs() < 1e-3, "{bond:?}");
    assert!((bond.tension / 5e5 - 1.0).abs() < 1e-3, "{bond:?}");
    let way = got(|to| femdem_world_motion(world, b, to)).pose.position[0] - 0.11;
    assert!((way / (5e5 / 1e10) - 1.0).abs() < 1e-3, "{way}");
}

#[test]
fn bonds_that_mean_nothing_are_refused_by_name() {
    let world = world();
    let [a, b] = pair(world, "cube", 0.1 * 3_f64.sqrt(), 0.11);
    let mut number = MaybeUninit::uninit();
    let mut between = |pair: [u32; 2], gap, law: &FemdemBondLaw| {
        femdem_world_add_bond_between(
            world,
            pair[0],
            pair[1],
            gap,
            1.0,
            Some(law),
            Some(&mut number),
        )
    };
    let odd = FemdemBondLaw {
        softening: 3,
        ..law()
    };
    let weak = FemdemBondLaw {
        tensile: -1.0,
        ..law()
    };
    fails(between([a, b], 0.02, &odd), Refused, "softening = 3");
    fails(between([a, b], 0.02, &weak), Refused, "tensile strength");
    fails(
        between([a, a], 0.02, &law()),
        Refused,
        "two different numbers",
    );
    fails(between([a, 9], 0.02, &law()), Refused, "no rigid body 9");
    fails(
        between([a, b], 0.001, &law()),
        Refused,
        "at most the gap apart",
    );
    assert_eq!(bonds(world), []);
    ok(between([a, b], 0.02, &law()));
    fails(between([b, a], 0.02, &law()), Refused, "twice the mortar");
    // SAFETY: null is what is tried.
    let nothing =
        unsafe { femdem_world_add_bond(world, a, b, null(), 3, Some(&law()), Some(&mut number)) };
    fails(nothing, Null, "corners is null");
    let line = [0.0; 9];
    // SAFETY: rows of three, as many as said.
    let flat = unsafe {
        femdem_world_add_bond(
            world,
            a,
            b,
            line.as_ptr(),
            3,
            Some(&law()),
            Some(&mut number),
        )
    };
    fails(flat, Refused, "area of a bond");
}
