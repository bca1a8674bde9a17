//! A periodic cell.

use femdem_capi::*;

use crate::common::{all, at, fails, got, named, ok, resting};

#[test]
fn bodies_meet_through_the_faces_of_the_cell() {
    use FemdemStatus::{Null, Refused};
    let mut parameters = got(|to| femdem_world_defaults(to));
    // The stress is without dashpots.
    (parameters.gravity, parameters.law.damping_ratio) = ([0.0; 3], 0.0);
    let world = got(|to| femdem_world_new(Some(&parameters), to));
    let mut matrix = std::mem::MaybeUninit::uninit();
    let none = femdem_world_cell(world, Some(&mut matrix));
    fails(none, Refused, "femdem_world_set_cell");
    fails(femdem_world_set_cell(world, -1.0, 1.0, 1.0), Refused, "-1");
    ok(femdem_world_set_cell(world, 0.4, 0.4, 0.4));
    let edges = got(|to| femdem_world_cell(world, to)).rows;
    assert_eq!(edges, [0.4, 0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 0.4]);

    let ball = named("sphere", 0.1);
    // 0.099 m apart through the face of the cell.
    for x in [0.05, 0.351] {
        let motion = resting(at(x, 0.2, 0.2));
        got(|to| femdem_world_add_body(world, ball, 2000.0, Some(&motion), 0, to));
    }
    ok(femdem_world_step(world, 1));
    let nothing = || -> FemdemContact {
        // SAFETY: of numbers alone.
        unsafe { std::mem::zeroed() }
    };
    // SAFETY: lists and rooms of `all` fit.
    let contacts = all(nothing(), |to, room, count| unsafe {
        femdem_world_contacts(world, to, room, count)
    });
    assert_eq!(contacts.len(), 1);
    // Of one force: it times the way between the centres over the volume.
    let stress = got(|to| femdem_world_cell_stress(world, to)).rows[0];
    let wanted = contacts[0].normal_force * 0.099 / 0.4_f64.powi(3);
    assert!((stress / wanted - 1.0).abs() < 0.02, "{stress} {wanted}");

    fails(femdem_world_deform_cell(world, None), Null, "rates");
    let mut rates = FemdemMatrix { rows: [0.0; 9] };
    rates.rows[0] = 0.1;
    ok(femdem_world_deform_cell(world, Some(&rates)));
    let before = got(|to| femdem_world_state(world, to)).time;
    ok(femdem_world_step(world, 20));
    let taken = got(|to| femdem_world_state(world, to)).time - before;
    let grown = got(|to| femdem_world_cell(world, to)).rows[0] - 0.4;
    assert!((grown / (0.1 * taken) - 1.0).abs() < 1e-9);
    ok(femdem_world_free(world));
}
