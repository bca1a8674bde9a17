//! Walls that the caller of a batch turns and moves.

use std::mem::MaybeUninit;

use femdem_capi::FemdemStatus::Refused;
use femdem_capi::*;

use crate::common::{at, batch, fails, got, named, ok, resting, update};

/// The plane z = 0, with bodies above.
const FLOOR: FemdemPlane = FemdemPlane {
    normal: [0.0, 0.0, 1.0],
    offset: 0.0,
};

fn floor(batch: FemdemBatch) -> u32 {
    got(|to| femdem_batch_add_plane(batch, Some(&FLOOR), 0, to))
}

/// Turned about y, which lifts where x is positive.
fn tilted(angle: f64) -> FemdemMotion {
    let (sin, cos) = (-0.5 * angle).sin_cos();
    let mut motion = resting(at(0.0, 0.0, 0.0));
    motion.pose.rotation = [cos, 0.0, sin, 0.0];
    motion
}

/// A plane that tilts reaches a cube far from the axis, whatever its caches say: a batch that has never seen it elsewhere has the
/// same loads.
#[test]
fn a_wall_that_turns_meets_a_body_far_from_its_axis() {
    let law = FemdemLaw {
        friction: 0.0,
        damping_ratio: 0.0,
        ..got(|to| femdem_law_default(to))
    };
    let cube = named("cube", 3_f64.sqrt());
    let place = [resting(at(20.0, 0.0, 1.0))];
    let made = || {
        let batch = got(|to| femdem_batch_new(Some(&law), to));
        got(|to| femdem_batch_add_body(batch, cube, 1000.0, 0, to));
        (batch, floor(batch))
    };
    let loads = |(batch, wall): (FemdemBatch, u32), angle: f64| {
        ok(femdem_batch_move_wall(batch, wall, Some(&tilted(angle))));
        update(batch, &place, 0.0)[0]
    };
    let warm = made();
    let mut touched = 0;
    for k in 0..60 {
        // By creep, and by a jump and back.
        let angle = if k == 50 { 0.0 } else { 6e-4 * f64::from(k) };
        let (own, fresh) = (loads(warm, angle), made());
        let wanted = loads(fresh, angle);
        ok(femdem_batch_free(fresh.0));
        touched += u32::from(wanted.force[2] > 0.0);
        let size = wanted.force[2].max(1e-6);
        for (x, y) in own.force.iter().zip(wanted.force) {
            assert!((x - y).abs() < 1e-9 * size, "{k}: {own:?} {wanted:?}");
        }
    }
    assert!((10..50).contains(&touched), "{touched}");
}

/// A turntable drags what lies on it along its circle, with the whole friction once it slides, but for what twists; and bears the
/// opposite torque.
#[test]
fn a_turntable_drags_along_its_circle() {
    let (batch, cube) = (batch(), named("cube", 3_f64.sqrt()));
    got(|to| femdem_batch_add_body(batch, cube, 1000.0, 0, to));
    let table = floor(batch);
    let place = [resting(at(3.0, 0.0, 0.499))];
    update(batch, &place, 0.0);
    let turning = |k: i32| {
        let angle = 0.01 * f64::from(k);
        let (sin, cos) = (0.5 * angle).sin_cos();
        let mut motion = resting(at(0.0, 0.0, 0.0));
        motion.pose.rotation = [cos, 0.0, 0.0, sin];
        motion.velocity.angular = [0.0, 0.0, 1.0];
        motion
    };
    let mut load = FemdemLoad::default();
    for k in 1..10 {
        ok(femdem_batch_move_wall(batch, table, Some(&turning(k))));
        load = update(batch, &place, 0.01)[0];
    }
    let [x, y, z] = load.force;
    let usual = got(|to| femdem_law_default(to)).friction;
    assert!(
        (y / (usual * z) - 1.0).abs() < 0.02 && x.abs() < 0.02 * y,
        "{load:?}"
    );
    let mut walls = [FemdemLoad::default()];
    // SAFETY: one wall.
    ok(unsafe { femdem_batch_wall_loads(batch, walls.as_mut_ptr(), 1) });
    // About the axis: the arm is that of the cube, but for the turn of its own face.
    assert!(
        (walls[0].torque[2] / (-3.0 * y) - 1.0).abs() < 0.02,
        "{walls:?}"
    );
}

#[test]
fn a_place_without_a_way_to_it_is_refused_and_changes_nothing() {
    let (batch, cube) = (batch(), named("cube", 3_f64.sqrt()));
    got(|to| femdem_batch_add_body(batch, cube, 1000.0, 0, to));
    let wall = floor(batch);
    let place = [resting(at(0.0, 0.0, 0.499))];
    let before = update(batch, &place, 0.0)[0];
    let mut wild = tilted(0.0);
    wild.velocity.angular[1] = f64::NAN;
    fails(
        femdem_batch_move_wall(batch, wall, Some(&wild)),
        Refused,
        "velocity = NaN",
    );
    wild = resting(at(0.0, 0.0, 0.0));
    wild.pose.rotation = [0.0; 4];
    fails(
        femdem_batch_move_wall(batch, wall, Some(&wild)),
        Refused,
        "quaternion",
    );
    // Each is finite, and so is its distance from where the wall was; not that between the two.
    let [far, farther] = [1.3e154, -1.3e154].map(|x| resting(at(x, 0.0, -1.0)));
    ok(femdem_batch_move_wall(batch, wall, Some(&far)));
    update(batch, &place, 0.0);
    ok(femdem_batch_move_wall(batch, wall, Some(&farther)));
    let mut load = MaybeUninit::uninit();
    // SAFETY: one of each.
    let status =
        unsafe { femdem_batch_update(batch, place.as_ptr(), 1, 0.0, load.as_mut_ptr(), 1) };
    fails(status, Refused, "walls[0]: way");
    ok(femdem_batch_move_wall(batch, wall, Some(&tilted(0.0))));
    assert_eq!(update(batch, &place, 0.0)[0], before);
}
