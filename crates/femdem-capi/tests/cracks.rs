//! A bar that is pulled apart: cracks, fragments, and bodies of these.

use femdem_capi::*;
use femdem_solve::mesh::{TetMesh, Vector3};

use crate::common::{all, at, got, ok, resting};
use crate::deformable::{add_mesh, drive, drive_nodes, positions, state};

#[test]
fn a_bar_breaks_at_its_strength_and_its_halves_go_on() {
    let parameters = FemdemWorldParameters {
        gravity: [0.0; 3],
        ..got(|to| femdem_world_defaults(to))
    };
    let world = got(|to| femdem_world_new(Some(&parameters), to));
    let mesh = TetMesh::block([10, 2, 2], &Vector3::new(0.1, 0.02, 0.02)).unwrap();
    let matter = FemdemMatter {
        density: 2400.0,
        young: 1e9,
        poisson: 0.2,
        ..got(|to| femdem_matter_default(to))
    };
    let fracture = FemdemFracture {
        tensile: 1e6,
        cohesion: 4e6,
        friction_angle: 35_f64.to_radians(),
        opening_energy: 100.0,
        sliding_energy: 500.0,
        ..got(|to| femdem_fracture_default(to))
    };
    let model = add_mesh(world, &mesh, &matter);
    let motion = resting(at(0.0, 0.0, 0.0));
    let bar =
        got(|to| femdem_world_add_deformable(world, model, Some(&motion), Some(&fracture), 0, to));
    let tets = state(world, bar).tet_count;
    let ends = |x: f64| -> Vec<u32> {
        let nodes = positions(world, bar);
        let near = (0..).zip(nodes).filter(|(_, p)| (p[0] - x).abs() < 1e-9);
        near.map(|(i, _)| i).collect()
    };
    let axes = FEMDEM_AXIS_X | FEMDEM_AXIS_Y | FEMDEM_AXIS_Z;
    drive_nodes(
        world,
        bar,
        &ends(0.0),
        axes,
        drive(FEMDEM_DRIVE_FIXED, [0.0; 3]),
    );
    let pull = drive(FEMDEM_DRIVE_LINEAR, [0.1, 0.0, 0.0]);
    drive_nodes(world, bar, &ends(0.1), axes, pull);
    let none = FemdemCrack::default();
    let cracks = || {
        all(none, |to, room, count| {
            // SAFETY: lists and rooms of `all` fit.
            unsafe { femdem_world_cracks(world, bar, to, room, count) }
        })
    };
    let fragments = || {
        all(0, |to, room, count| {
            // SAFETY: lists and rooms of `all` fit.
            unsafe { femdem_world_fragments(world, bar, to, room, count) }
        })
    };
    assert_eq!((cracks().len(), fragments()), (0, vec![0; tets]));
    ok(femdem_world_step_until(world, 0.0042));

    let cut = cracks();
    // The strain f/E at the strength.
    let birth = cut.iter().map(|crack| crack.birth).fold(f64::MAX, f64::min);
    assert!((birth / 1e-3 - 1.0).abs() < 0.1, "{birth}");
    // The energy of fracture over one section at least.
    let dissipated: f64 = cut.iter().map(|crack| crack.dissipated).sum();
    assert!(dissipated > 0.8 * 100.0 * 0.02 * 0.02, "{dissipated}");
    assert!(
        cut.iter()
            .any(|crack| crack.broken_at.is_finite() && crack.sheared == 0)
    );
    assert!(fragments().iter().any(|fragment| *fragment > 0));
    let ledger = got(|to| femdem_world_ledger(world, to));
    assert!(ledger.dissipated_fracture > 0.0 && ledger.error_relative.abs() < 0.02);

    ok(femdem_world_release(world, bar));
    ok(femdem_world_step(world, 1));
    let count = got(|to| femdem_world_fragment_bodies(world, to));
    let new = || {
        all(FemdemFragment::default(), |to, room, count| {
            // SAFETY: lists and rooms of `all` fit.
            unsafe { femdem_world_new_fragments(world, to, room, count) }
        })
    };
    let bodies = new();
    assert!(count >= 1 && bodies.len() == count);
    assert!(bodies.iter().all(|fragment| fragment.of == bar));
    let counted = bodies
        .iter()
        .map(|fragment| state(world, fragment.body).tet_count);
    assert_eq!(counted.sum::<usize>() + state(world, bar).tet_count, tets);
    assert_eq!(
        got(|to| femdem_world_state(world, to)).deformable_count,
        1 + count
    );
    ok(femdem_world_step(world, 10));
    assert_eq!(got(|to| femdem_world_fragment_bodies(world, to)), 0);
    assert!(new().is_empty());
    ok(femdem_world_free(world));
}
