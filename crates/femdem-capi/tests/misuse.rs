//! What callers get wrong is a status and a message, and changes nothing.

use std::ptr::{null, null_mut};
use std::sync::Barrier;
use std::thread;

use femdem_capi::FemdemStatus::{File, Handle, Null, Refused, Size};
use femdem_capi::*;

use crate::common::{at, batch, fails, got, message, named, ok, resting, text, update, world};

#[test]
fn null_is_named() {
    let (world, batch, cube) = (world(), batch(), named("cube", 1.0));
    // SAFETY: null is what is tried.
    unsafe {
        fails(
            femdem_shape_named(null(), 1.0, 0.0, None),
            Null,
            "name is null",
        );
        let name = text("cube");
        fails(
            femdem_shape_named(name.as_ptr(), 1.0, 0.0, None),
            Null,
            "shape is null",
        );
        fails(femdem_world_save(world, null()), Null, "path is null");
        fails(
            femdem_batch_update(batch, null(), 0, 0.0, null_mut(), 0),
            FemdemStatus::Ok,
            "",
        );
        got(|to| femdem_batch_add_body(batch, cube, 1.0, 0, to));
        fails(
            femdem_batch_update(batch, null(), 1, 0.0, null_mut(), 1),
            Null,
            "motions is null",
        );
        let still = resting(at(0.0, 0.0, 0.0));
        fails(
            femdem_batch_update(batch, &raw const still, 1, 0.0, null_mut(), 1),
            Null,
            "loads is null",
        );
        fails(
            femdem_world_bodies(world, null_mut(), 0, None),
            Null,
            "count is null",
        );
    }
    fails(femdem_world_new(None, None), Null, "world is null");
    fails(femdem_world_state(world, None), Null, "state is null");
    fails(
        femdem_world_add_plane(world, None, 0, None),
        Null,
        "wall is null",
    );
    fails(
        femdem_world_drive_wall(world, 0, None),
        Null,
        "drive is null",
    );
    fails(
        femdem_pair_evaluate(1.0, cube, None, cube, None, None),
        Null,
        "pair is null",
    );
}

#[test]
fn handles_that_are_none_freed_or_of_another_kind_are_told() {
    let (shape, batch, world) = (named("cube", 1.0), batch(), world());
    let steps = |id| femdem_world_step(FemdemWorld { id }, 1);
    fails(steps(0), Null, "is 0");
    fails(steps(shape.id), Handle, "is that of a shape");
    fails(steps(batch.id), Handle, "is that of a batch");
    fails(steps(u64::MAX), Handle, "never given out");
    let of_shape = femdem_batch_remove_body(FemdemBatch { id: world.id }, 0);
    fails(of_shape, Handle, "is that of a world");
    ok(femdem_world_free(world));
    fails(steps(world.id), Handle, "has been freed");
    fails(femdem_world_free(world), Handle, "has been freed");
    fails(
        femdem_shape_free(FemdemShape { id: batch.id }),
        Handle,
        "is that of a batch",
    );
    ok(femdem_shape_free(FemdemShape { id: 0 }));
    ok(femdem_shape_free(shape));
    let body = femdem_batch_add_body(
        batch,
        shape,
        1.0,
        0,
        Some(&mut std::mem::MaybeUninit::uninit()),
    );
    fails(body, Handle, "has been freed");
    ok(femdem_batch_free(batch));
}

#[test]
fn wrong_lengths_are_told_with_the_right_ones() {
    let (world, batch, cube) = (world(), batch(), named("cube", 1.0));
    for _ in 0..2 {
        got(|to| femdem_batch_add_body(batch, cube, 1.0, 0, to));
        got(|to| femdem_world_add_body(world, cube, 1.0, Some(&resting(at(0.0, 0.0, 0.0))), 0, to));
    }
    let motions = [resting(at(0.0, 0.0, 0.0)); 3];
    let mut loads = [FemdemLoad::default(); 3];
    let mut ids = [0_u32; 1];
    let mut count = std::mem::MaybeUninit::uninit();
    let inertia = [1.0; 9];
    let (from, to) = (motions.as_ptr(), loads.as_mut_ptr());
    // SAFETY: wrong lengths are refused before anything is read; all are at most the true ones.
    unsafe {
        fails(
            femdem_batch_update(batch, from, 3, 0.0, to, 3),
            Size,
            "motions has 3 elements, and 2 are needed",
        );
        fails(
            femdem_batch_update(batch, from, 2, 0.0, to, 1),
            Size,
            "loads has 1 elements, and 2 are needed",
        );
        fails(
            femdem_batch_update(batch, from, usize::MAX, 0.0, to, usize::MAX),
            Size,
            "cannot have",
        );
        fails(femdem_batch_wall_loads(batch, to, 1), Size, "0 are needed");
        fails(
            femdem_batch_set_mass(batch, 0, 1.0, inertia.as_ptr(), 6),
            Size,
            "9 are needed",
        );
        fails(
            femdem_world_bodies(world, ids.as_mut_ptr(), 1, Some(&mut count)),
            Size,
            "2 are needed",
        );
        assert_eq!(count.assume_init(), 2);
        fails(
            femdem_shape_triangles(cube, null_mut(), 7, null_mut(), 12),
            Size,
            "8 are needed",
        );
    }
}

#[test]
fn values_out_of_range_are_named() {
    let (world, batch, cube) = (world(), batch(), named("cube", 1.0));
    let mut place = std::mem::MaybeUninit::uninit();
    let mut shape = |name: &str, size, mesh_size| {
        let name = text(name);
        // SAFETY: the text lives until the call ends.
        unsafe { femdem_shape_named(name.as_ptr(), size, mesh_size, Some(&mut place)) }
    };
    fails(shape("no such", 1.0, 0.0), Refused, "no such");
    fails(shape("cube", f64::NAN, 0.0), Refused, "NaN");
    fails(shape("dolos", 1.0, -1.0), Refused, "mesh_size = -1");
    let mut usual = got(|to| femdem_law_default(to));
    usual.friction = -0.5;
    fails(
        femdem_batch_set_law(batch, 0, 0, Some(&usual)),
        Refused,
        "friction = -0.5",
    );
    fails(
        femdem_world_set_law(world, 0, 256, None),
        Refused,
        "material = 256",
    );
    fails(
        femdem_world_set_threads(world, 5000),
        Refused,
        "threads = 5000",
    );
    let mut body = std::mem::MaybeUninit::uninit();
    let mut add = |density, motion| {
        femdem_world_add_body(world, cube, density, Some(&motion), 0, Some(&mut body))
    };
    let still = resting(at(0.0, 0.0, 0.0));
    fails(add(-1.0, still), Refused, "density");
    fails(
        add(1.0, resting(at(f64::NAN, 0.0, 0.0))),
        Refused,
        "translation",
    );
    let mut turned = still;
    turned.pose.rotation = [2.0, 0.0, 0.0, 0.0];
    fails(add(1.0, turned), Refused, "quaternion");
    let mut fast = still;
    fast.velocity.angular[1] = f64::INFINITY;
    fails(add(1.0, fast), Refused, "angular_velocity");
    assert_eq!(got(|to| femdem_world_state(world, to)).body_count, 0);
    fails(
        femdem_world_step_until(world, f64::NAN),
        Refused,
        "time = NaN",
    );
    fails(
        femdem_world_set_gravity(world, f64::NAN, 0.0, 0.0),
        Refused,
        "gravity",
    );
    let odd = FemdemDrive {
        kind: 9,
        periods: 0,
        vector: [0.0; 3],
        point: [0.0; 3],
        rate: 0.0,
        frequency: 0.0,
        start: 0.0,
        end: 0.0,
    };
    fails(
        femdem_world_drive_body(world, 0, Some(&odd)),
        Refused,
        "kind = 9",
    );
    let flat = FemdemPlane {
        normal: [0.0; 3],
        offset: 0.0,
    };
    fails(
        femdem_batch_add_plane(
            batch,
            Some(&flat),
            0,
            Some(&mut std::mem::MaybeUninit::uninit()),
        ),
        Refused,
        "normal",
    );

    let heavy = femdem_batch_add_body(
        batch,
        cube,
        f64::NAN,
        0,
        Some(&mut std::mem::MaybeUninit::uninit()),
    );
    fails(heavy, Refused, "density = NaN");
    got(|to| femdem_batch_add_body(batch, cube, 1.0, 0, to));
    let skew = [1.0, 5.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    // SAFETY: as long as said.
    fails(
        unsafe { femdem_batch_set_mass(batch, 0, 1.0, skew.as_ptr(), 9) },
        Refused,
        "inertia",
    );
    let mut wrong = still;
    wrong.velocity.linear[0] = f64::NAN;
    for (motion, dt, word) in [
        (turned, 0.0, "motions[0]"),
        (wrong, 0.0, "motions[0]: velocity"),
        (still, -1.0, "dt = -1"),
    ] {
        let mut load = FemdemLoad::default();
        // SAFETY: one of each.
        let status =
            unsafe { femdem_batch_update(batch, &raw const motion, 1, dt, &raw mut load, 1) };
        fails(status, Refused, word);
    }
}

/// Loads and totals after updates that were refused are those without them, though bodies before the wrong one were right.
#[test]
fn a_refused_update_changes_nothing() {
    let cube = named("cube", 3_f64.sqrt());
    let run = |refused: &[([FemdemMotion; 2], f64)]| {
        let batch = batch();
        for _ in 0..2 {
            got(|to| femdem_batch_add_body(batch, cube, 1000.0, 0, to));
        }
        let place = |x: f64| [at(x, 0.0, 0.0), at(0.0, 0.0, 0.999)].map(resting);
        update(batch, &place(0.0), 0.0);
        for (motions, dt) in refused {
            let mut loads = [FemdemLoad::default(); 2];
            let (from, to) = (motions.as_ptr(), loads.as_mut_ptr());
            // SAFETY: both are as long as said.
            let status = unsafe { femdem_batch_update(batch, from, 2, *dt, to, 2) };
            assert_eq!(status, Refused, "{}", message());
            assert_eq!(loads, [FemdemLoad::default(); 2]);
        }
        let before = got(|to| femdem_batch_totals(batch, to));
        let then = [1e-3, 2e-3].map(|x| update(batch, &place(x), 1e-4));
        (before, then, got(|to| femdem_batch_totals(batch, to)))
    };
    let right = [at(0.3, 0.0, 0.0), at(0.0, 0.0, 0.999)].map(resting);
    let (mut lost, mut wild) = (right, right);
    lost[1].velocity.linear[2] = f64::NAN;
    wild[1].pose.position[2] = 1e20;
    assert_eq!(run(&[(lost, 1e-4), (wild, -1.0)]), run(&[]));
}

#[test]
fn a_refused_body_leaves_the_world_as_it_was() {
    let (world, cube) = (world(), named("cube", 1.0));
    let hash = || got(|to| femdem_world_hash(world, to));
    let before = hash();
    let mut motion = resting(at(0.0, 0.0, 0.0));
    let mut body = std::mem::MaybeUninit::uninit();
    let heavy = femdem_world_add_body(world, cube, -1.0, Some(&motion), 0, Some(&mut body));
    fails(heavy, Refused, "density");
    motion.velocity.linear[0] = f64::NAN;
    let lost = femdem_world_add_body(world, cube, 1.0, Some(&motion), 0, Some(&mut body));
    fails(lost, Refused, "velocity");
    assert_eq!(hash(), before);
}

#[test]
fn an_end_that_is_no_number_is_refused() {
    let (world, cube) = (world(), named("cube", 1.0));
    let still = resting(at(0.0, 0.0, 0.0));
    let body = got(|to| femdem_world_add_body(world, cube, 1.0, Some(&still), 0, to));
    let drive = |end| FemdemDrive {
        kind: FEMDEM_DRIVE_LINEAR,
        periods: 0,
        vector: [1.0, 0.0, 0.0],
        point: [0.0; 3],
        rate: 0.0,
        frequency: 0.0,
        start: 0.0,
        end,
    };
    let status = femdem_world_drive_body(world, body, Some(&drive(f64::NAN)));
    fails(status, Refused, "NaN");
    ok(femdem_world_drive_body(
        world,
        body,
        Some(&drive(f64::INFINITY)),
    ));
}

/// A room for what there is none of, and counts that nobody asks for.
#[test]
fn what_is_not_needed_may_be_null() {
    let (world, batch) = (world(), batch());
    // SAFETY: nothing is written, since there are no bodies.
    let count = got(|to| unsafe { femdem_world_bodies(world, null_mut(), 5, to) });
    assert_eq!(count, 0);
    let cube = named("cube", 1.0);
    got(|to| femdem_batch_add_body(batch, cube, 1.0, 0, to));
    assert_eq!(got(|to| femdem_batch_slots(batch, to, None)), 1);
    assert_eq!(got(|to| femdem_batch_slots(batch, None, to)), 0);
}

#[test]
fn numbers_that_name_nothing_are_told() {
    let (world, batch) = (world(), batch());
    for status in [
        femdem_world_remove_body(world, 5),
        femdem_world_set_pose(world, 5, Some(&at(0.0, 0.0, 0.0))),
        femdem_world_set_velocity(world, 5, Some(&FemdemVelocity::default())),
        femdem_world_set_load(world, 5, Some(&FemdemLoad::default())),
        femdem_world_drive_body(world, 5, None),
        femdem_world_motion(world, 5, Some(&mut std::mem::MaybeUninit::uninit())),
        femdem_world_body_load(world, 5, Some(&mut std::mem::MaybeUninit::uninit())),
        femdem_world_remove_wall(world, 5),
        femdem_world_wall_load(world, 5, Some(&mut std::mem::MaybeUninit::uninit())),
        femdem_batch_remove_body(batch, 5),
        femdem_batch_forget_contacts(batch, 5),
        femdem_batch_remove_wall(batch, u32::MAX),
    ] {
        fails(status, Refused, "there is no");
    }
    fails(
        femdem_batch_move_wall(batch, 5, Some(&resting(at(0.0, 0.0, 0.0)))),
        Refused,
        "no wall 5",
    );
    let inertia = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    // SAFETY: as long as said.
    fails(
        unsafe { femdem_batch_set_mass(batch, 5, 1.0, inertia.as_ptr(), 9) },
        Refused,
        "no body 5",
    );
    // Triangles of vertices that are not there.
    let (vertices, triangles) = ([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0_u32, 1, 9]);
    let mut wall = std::mem::MaybeUninit::uninit();
    // SAFETY: as long as said.
    let sheet = unsafe {
        femdem_world_add_sheet(
            world,
            vertices.as_ptr(),
            3,
            triangles.as_ptr(),
            1,
            0.1,
            0,
            Some(&mut wall),
        )
    };
    assert_eq!(sheet, Refused, "{}", message());
}

#[test]
fn files_and_bytes_that_hold_no_world_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.stl");
    std::fs::write(&path, "nothing").unwrap();
    let (there, gone) = (text(path.to_str().unwrap()), text("no/such/file.stl"));
    let mut world = std::mem::MaybeUninit::uninit();
    let mut shape = std::mem::MaybeUninit::uninit();
    let bytes = [1_u8; 100];
    // SAFETY: texts and bytes live longer.
    unsafe {
        fails(
            femdem_world_load(gone.as_ptr(), Some(&mut world)),
            File,
            "no/such/file",
        );
        fails(
            femdem_world_load(there.as_ptr(), Some(&mut world)),
            File,
            "checkpoint",
        );
        fails(
            femdem_world_from_bytes(bytes.as_ptr(), 100, Some(&mut world)),
            Refused,
            "state",
        );
        fails(
            femdem_shape_file(gone.as_ptr(), 1.0, 0.0, Some(&mut shape)),
            File,
            "no/such/file",
        );
        fails(
            femdem_shape_file(there.as_ptr(), 1.0, 0.0, Some(&mut shape)),
            File,
            "x.stl",
        );
    }
}

/// Worlds step in threads of their own, with the same bits; a shape is for all of them.
#[test]
fn threads_have_their_own_worlds_and_share_shapes() {
    let (cube, start) = (named("cube", 0.1), Barrier::new(3));
    let run = || {
        let world = world();
        let floor = FemdemPlane {
            normal: [0.0, 0.0, 1.0],
            offset: 0.0,
        };
        got(|to| femdem_world_add_plane(world, Some(&floor), 0, to));
        let motion = resting(at(0.0, 0.0, 0.06));
        start.wait();
        got(|to| femdem_world_add_body(world, cube, 2000.0, Some(&motion), 0, to));
        ok(femdem_world_step(world, 400));
        let hash = got(|to| femdem_world_hash(world, to));
        ok(femdem_world_free(world));
        hash
    };
    let hashes = thread::scope(|scope| {
        let threads = [(); 3].map(|()| scope.spawn(run));
        threads.map(|thread| thread.join().unwrap())
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]));
}
