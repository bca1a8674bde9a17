//! Right values from mechanics, in all layers.

use std::f64::consts::PI;

use femdem_capi::*;

use crate::common::{all, at, batch, got, named, ok, resting, update, world};

/// A cube of side 1 m as twelve triangles, with a corner in the origin.
const CORNERS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
const TRIANGLES: [[u32; 3]; 12] = [
    [0, 2, 1],
    [0, 3, 2],
    [4, 5, 6],
    [4, 6, 7],
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
];

/// Of side 1 m: its size is the diameter of the sphere around it.
fn cube() -> FemdemShape {
    named("cube", 3_f64.sqrt())
}

fn block() -> FemdemShape {
    let (vertices, triangles) = (CORNERS.as_flattened(), TRIANGLES.as_flattened());
    // SAFETY: rows of three, as many as said.
    got(|to| unsafe { femdem_shape_surface(vertices.as_ptr(), 8, triangles.as_ptr(), 12, 0.0, to) })
}

#[test]
fn shapes_have_their_volume_and_inertia_about_the_centroid() {
    let block = got(|to| femdem_shape_properties(block(), to));
    assert!((block.volume - 1.0).abs() < 1e-12 && (block.area - 6.0).abs() < 1e-12);
    assert!(block.centroid.iter().all(|x| (x - 0.5).abs() < 1e-12));
    assert!((block.inertia[4] - 1.0 / 6.0).abs() < 1e-12 && block.inertia[1].abs() < 1e-12);
    assert_eq!(
        (block.kind, block.vertex_count, block.triangle_count),
        (0, 8, 12)
    );

    let ball = got(|to| femdem_shape_properties(named("sphere", 2.0), to));
    assert!((ball.volume - 4.0 / 3.0 * PI).abs() < 1e-12 && (ball.area - 4.0 * PI).abs() < 1e-12);
    assert!((ball.inertia[8] / (0.4 * ball.volume) - 1.0).abs() < 1e-12);
    assert_eq!((ball.kind, ball.radius), (1, 1.0));
    // With a level it is a polyhedron.
    let facets = got(|to| femdem_shape_properties(named("sphere:level=2", 2.0), to));
    assert!(facets.kind == 0 && facets.volume < ball.volume);
    assert_eq!(
        got(|to| femdem_shape_properties(named("dolos", 1.0), to)).kind,
        2
    );
}

#[test]
fn the_surface_is_about_the_centroid() {
    let shape = block();
    let (mut vertices, mut triangles) = ([[0.0_f64; 3]; 8], [[0_u32; 3]; 12]);
    let (v, t) = (vertices.as_mut_ptr().cast(), triangles.as_mut_ptr().cast());
    // SAFETY: rows of three, as many as said.
    ok(unsafe { femdem_shape_triangles(shape, v, 8, t, 12) });
    assert!(
        vertices
            .iter()
            .flatten()
            .all(|x| (x.abs() - 0.5).abs() < 1e-12)
    );
    // Outward, so that the volume over the origin is that of the cube.
    let volume = |[a, b, c]: [[f64; 3]; 3]| {
        let cross = [
            b[1] * c[2] - b[2] * c[1],
            b[2] * c[0] - b[0] * c[2],
            b[0] * c[1] - b[1] * c[0],
        ];
        (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
    };
    let corners = |t: &[u32; 3]| volume(t.map(|i| vertices[i as usize]));
    assert!((triangles.iter().map(corners).sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn files_have_a_unit_and_hulls_are_convex() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("block.obj");
    let mut obj: String = CORNERS
        .iter()
        .map(|[x, y, z]| format!("v {x} {y} {z}\n"))
        .collect();
    obj.extend(TRIANGLES.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)));
    std::fs::write(&path, obj).unwrap();
    let path = crate::common::text(path.to_str().unwrap());
    // SAFETY: the text lives longer.
    let small = got(|to| unsafe { femdem_shape_file(path.as_ptr(), 1e-3, 0.0, to) });
    let volume = got(|to| femdem_shape_properties(small, to)).volume;
    assert!((volume / 1e-9 - 1.0).abs() < 1e-9, "a cubic millimetre");
    // A world knows the name of the shape, not where the file was.
    let world = world();
    got(|to| femdem_world_add_body(world, small, 1.0, Some(&resting(at(0.0, 0.0, 0.0))), 0, to));
    // SAFETY: lists and rooms of `all` fit.
    let bytes = all(0_u8, |to, room, count| unsafe {
        femdem_world_to_bytes(world, to, room, count)
    });
    let has = |text: &str| {
        bytes
            .windows(text.len())
            .any(|part| part == text.as_bytes())
    };
    assert!(has("block") && !has(folder.path().to_str().unwrap()) && !has("block.obj"));
    // SAFETY: rows of three, as many as said.
    let hull = got(|to| unsafe { femdem_shape_hull(CORNERS.as_flattened().as_ptr(), 8, to) });
    assert!((got(|to| femdem_shape_properties(hull, to)).volume - 1.0).abs() < 1e-12);
}

/// Every kind with every kind: what one bears the other does too, about the same point, and the force is minus the gradient of
/// the energy.
#[test]
fn pairs_of_all_kinds_cancel_and_are_gradients() {
    let shapes = [cube(), named("sphere", 1.0), named("tetrapod", 1.0)];
    let pair = |a: FemdemShape, b: FemdemShape, z: f64| {
        let place = FemdemPose {
            position: [0.03, 0.02, z],
            rotation: [0.6, 0.8, 0.0, 0.0],
        };
        got(|to| femdem_pair_evaluate(1e6, a, Some(&at(0.0, 0.0, 0.0)), b, Some(&place), to))
    };
    for a in shapes {
        for b in shapes {
            let (z, step) = (0.5, 1e-6);
            let now = pair(a, b, z);
            assert!(now.patches > 0 && now.energy > 0.0 && now.volume > 0.0);
            let slope = (pair(a, b, z + step).energy - pair(a, b, z - step).energy) / (2.0 * step);
            let force = now.on_b.force;
            assert!(
                (force[2] + slope).abs() < 1e-4 * force[2].abs(),
                "{} {}",
                force[2],
                -slope
            );
            let arm = [0.03, 0.02, z];
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                assert_eq!(now.on_a.force[k], -force[k]);
                let moment =
                    now.on_a.torque[k] + now.on_b.torque[k] + arm[i] * force[j] - arm[j] * force[i];
                assert!(moment.abs() < 1e-9 * force[2].abs(), "{moment}");
            }
        }
    }
    assert_eq!(pair(shapes[0], shapes[1], 3.0), FemdemPair::default());
}

/// Two cubes press each other as in layer 1; a third stands on a wall that moves away.
#[test]
fn a_batch_gives_the_loads_of_its_pairs_and_walls() {
    let (batch, cube) = (batch(), cube());
    let add = |density| got(|to| femdem_batch_add_body(batch, cube, density, 0, to));
    let bodies = [add(1000.0), add(0.0), add(1000.0)];
    let floor = FemdemPlane {
        normal: [0.0, 0.0, 2.0],
        offset: -10.0,
    };
    let floor = got(|to| femdem_batch_add_plane(batch, Some(&floor), 0, to));
    let places = [at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.999), at(9.0, 0.0, -4.501)];
    let motions = places.map(resting);
    let loads = update(batch, &motions, 0.0);
    let pair =
        got(|to| femdem_pair_evaluate(1e6, cube, Some(&places[0]), cube, Some(&places[1]), to));
    assert_eq!(bodies, [0, 1, 2]);
    assert_eq!(
        [loads[0].force, loads[1].force],
        [pair.on_a.force, pair.on_b.force]
    );
    // 2 p a delta/h: as on an equal cube.
    assert!(
        (loads[2].force[2] / 4000.0 - 1.0).abs() < 0.005,
        "{:?}",
        loads[2]
    );
    let mut walls = [FemdemLoad::default()];
    // SAFETY: one wall.
    ok(unsafe { femdem_batch_wall_loads(batch, walls.as_mut_ptr(), 1) });
    assert_eq!(walls[0].force[2], -loads[2].force[2]);
    // SAFETY: lists and rooms of `all` fit.
    let contacts = |batch| unsafe {
        let count = got(|to| femdem_batch_contacts(batch, std::ptr::null_mut(), 0, to));
        let mut contacts = Vec::with_capacity(count);
        got(|to| femdem_batch_contacts(batch, contacts.as_mut_ptr(), count, to));
        contacts.set_len(count);
        contacts as Vec<FemdemContact>
    };
    let found: Vec<_> = contacts(batch)
        .iter()
        .map(|c| (c.a, c.a_is_wall, c.b))
        .collect();
    assert_eq!(found, [(0, 0, 1), (0, 1, 2)]);
    let totals = got(|to| femdem_batch_totals(batch, to));
    assert!(totals.touching == 2 && totals.stable_step > 0.0 && totals.stable_step < 0.1);

    let away = resting(at(0.0, 0.0, -1.0));
    ok(femdem_batch_move_wall(batch, floor, Some(&away)));
    assert_eq!(update(batch, &motions, 1e-4)[2], FemdemLoad::default());
    // A body goes, and its number with it until the next comes.
    ok(femdem_batch_remove_body(batch, bodies[0]));
    assert_eq!(update(batch, &motions, 1e-4)[1], FemdemLoad::default());
    assert_eq!(add(1.0), bodies[0]);
    ok(femdem_batch_free(batch));
}

/// The batch finds contacts of bodies that jump and turn, whatever its caches say: it counts their ways itself.
#[test]
fn a_batch_follows_bodies_that_jump() {
    let law = FemdemLaw {
        friction: 0.0,
        ..got(|to| femdem_law_default(to))
    };
    let (batch, cube) = (got(|to| femdem_batch_new(Some(&law), to)), cube());
    for _ in 0..2 {
        got(|to| femdem_batch_add_body(batch, cube, 1000.0, 0, to));
    }
    let mut motions = [resting(at(0.0, 0.0, 0.0)), resting(at(0.0, 0.0, 1.2))];
    for k in 0..200 {
        let angle = 0.37 * f64::from(k);
        motions[1].pose.rotation = [angle.cos(), angle.sin(), 0.0, 0.0];
        motions[1].pose.position[2] = 1.2 + 0.3 * (1.7 * f64::from(k)).sin();
        let loads = update(batch, &motions, 0.0);
        let pair = got(|to| {
            femdem_pair_evaluate(
                1e6,
                cube,
                Some(&motions[0].pose),
                cube,
                Some(&motions[1].pose),
                to,
            )
        });
        let size = pair.on_b.force[2].abs().max(1e-6);
        for i in 0..3 {
            assert!(
                (loads[1].force[i] - pair.on_b.force[i]).abs() < 1e-9 * size,
                "{k}"
            );
        }
    }
}

/// A block slides down a slope with the right acceleration, under the law of its material.
#[test]
fn a_pair_of_materials_has_its_law() {
    let slope: f64 = 0.35;
    let parameters = got(|to| femdem_world_defaults(to));
    let world = got(|to| femdem_world_new(Some(&parameters), to));
    ok(femdem_world_set_gravity(
        world,
        9.81 * slope.sin(),
        0.0,
        -9.81 * slope.cos(),
    ));
    let floor = FemdemPlane {
        normal: [0.0, 0.0, 1.0],
        offset: 0.0,
    };
    got(|to| femdem_world_add_plane(world, Some(&floor), 7, to));
    let law = FemdemLaw {
        friction: 0.2,
        ..parameters.law
    };
    ok(femdem_world_set_law(world, 7, 3, Some(&law)));
    let cube = cube();
    // As deep in the wall as bears the weight: 2 p a delta/h.
    let depth = 2000.0 * 9.81 * slope.cos() / 4e6;
    let place = |y: f64| resting(at(0.0, y, 0.5 - depth));
    let ice = got(|to| femdem_world_add_body(world, cube, 2000.0, Some(&place(0.0)), 3, to));
    let stone = got(|to| femdem_world_add_body(world, cube, 2000.0, Some(&place(3.0)), 0, to));
    // Once the springs of friction are stretched.
    let then = |until| {
        ok(femdem_world_step_until(world, until));
        let speed = got(|to| femdem_world_motion(world, ice, to))
            .velocity
            .linear[0];
        (got(|to| femdem_world_state(world, to)).time, speed)
    };
    let (start, end) = (then(0.2), then(0.5));
    let acceleration = (end.1 - start.1) / (end.0 - start.0);
    let wanted = 9.81 * (slope.sin() - 0.2 * slope.cos());
    assert!(
        (acceleration / wanted - 1.0).abs() < 0.02,
        "{acceleration} {wanted}"
    );
    let way = |body| got(|to| femdem_world_motion(world, body, to)).pose.position[0];
    assert!(way(stone) < 1e-2, "{}", way(stone));
}

/// A wall that is driven, a body that is held, loads and velocities by hand.
#[test]
fn a_world_does_what_the_caller_says() {
    let (world, ball) = (world(), named("sphere", 0.1));
    ok(femdem_world_set_gravity(world, 0.0, 0.0, 0.0));
    let add = |x| {
        got(|to| femdem_world_add_body(world, ball, 1000.0, Some(&resting(at(x, 0.0, 0.0))), 0, to))
    };
    let [pulled, thrown, held, turning] = [0.0, 1.0, 2.0, 3.0].map(add);
    let mass = 1000.0 * got(|to| femdem_shape_properties(ball, to)).volume;
    let load = FemdemLoad {
        force: [0.0, 0.0, 2.0 * mass],
        torque: [0.0; 3],
    };
    ok(femdem_world_set_load(world, pulled, Some(&load)));
    let velocity = FemdemVelocity {
        linear: [0.0, 0.0, 3.0],
        angular: [0.0; 3],
    };
    ok(femdem_world_set_velocity(world, thrown, Some(&velocity)));
    let drive = |kind, vector| FemdemDrive {
        kind,
        periods: 0,
        vector,
        point: [3.1, 0.0, 0.0],
        rate: PI,
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    };
    let still = drive(FEMDEM_DRIVE_FIXED, [0.0; 3]);
    ok(femdem_world_drive_body(world, held, Some(&still)));
    let round = drive(FEMDEM_DRIVE_TURN, [0.0, 0.0, 1.0]);
    ok(femdem_world_drive_body(world, turning, Some(&round)));
    ok(femdem_world_step_until(world, 0.5));
    let time = got(|to| femdem_world_state(world, to)).time;
    let place = |body| got(|to| femdem_world_motion(world, body, to)).pose.position;
    assert!(
        (place(pulled)[2] / (time * time) - 1.0).abs() < 0.02,
        "a t^2/2"
    );
    assert!((place(thrown)[2] / (3.0 * time) - 1.0).abs() < 1e-9);
    assert_eq!(place(held), [2.0, 0.0, 0.0]);
    let angle = PI * time;
    assert!((place(turning)[0] - (3.1 - 0.1 * angle.cos())).abs() < 1e-9);

    ok(femdem_world_set_pose(
        world,
        thrown,
        Some(&at(5.0, 0.0, 0.0)),
    ));
    assert_eq!(place(thrown), [5.0, 0.0, 0.0]);
    ok(femdem_world_drive_body(world, held, None));
    ok(femdem_world_remove_body(world, pulled));
    // SAFETY: lists and rooms of `all` fit.
    let ids = all(0_u32, |to, room, count| unsafe {
        femdem_world_bodies(world, to, room, count)
    });
    assert_eq!(ids, [thrown, held, turning]);
}
