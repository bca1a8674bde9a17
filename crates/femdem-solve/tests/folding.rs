//! Deformable bodies that touch themselves: a folded strip, a coil that is wound up, a block with a crack.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{add_floor, parameters, weightless};
use femdem_contact::{Partner, Wrench};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use femdem_solve::{ContactStiffness, DeformableSpec, Drive, World, WorldParameters};

/// Thickness and width of the strips, m.
const THICK: f64 = 0.01;

fn model(mesh: &TetMesh, young: f64) -> DeformableModel {
    let region = MaterialRegion {
        material: NeoHookean::new(young, 0.25).unwrap().into(),
        density: 1000.0,
    };
    DeformableModel::new(mesh, Element::T4, vec![region], None).unwrap()
}

/// A strip of square section along a curve in the plane y = 0, given by its place and its direction at an arc length.
fn strip(length: f64, cells: u32, across: u32, curve: impl Fn(f64) -> [Vector3; 2]) -> TetMesh {
    let sides = Vector3::new(length, THICK, THICK);
    let straight = TetMesh::block([cells, across, across], &sides).unwrap();
    let place = |p: &Point3| {
        let [at, along] = curve(p.x);
        let up = along.cross(&Vector3::y());
        Point3::from(at + up * (p.z - 0.5 * THICK) + Vector3::y() * p.y)
    };
    let points = straight.points().iter().map(place).collect();
    TetMesh::new(points, straight.tets().to_vec()).unwrap()
}

/// Two arms of the given length along x, one above the other, joined by a half circle about the origin.
fn hairpin(arm: f64, radius: f64) -> impl Fn(f64) -> [Vector3; 2] {
    move |s| {
        let turn = ((s - arm) / radius).clamp(0.0, std::f64::consts::PI);
        let rest = s - arm - turn * radius;
        let along = Vector3::new(turn.cos(), 0.0, turn.sin());
        [
            Vector3::new(turn.sin(), 0.0, -turn.cos()) * radius + along * rest,
            along,
        ]
    }
}

/// Arms of five thicknesses, two thicknesses apart.
fn folded(across: u32) -> TetMesh {
    let (arm, radius) = (5.0 * THICK, 1.5 * THICK);
    let length = 2.0 * arm + std::f64::consts::PI * radius;
    strip(length, 16 * across, across, hairpin(arm, radius))
}

/// A hairpin whose arms fly at each other.
fn clapping(parameters: WorldParameters, meets_itself: bool) -> World {
    let mut world = World::new(parameters).unwrap();
    let model = model(&folded(1), 1e6);
    let nodes = model.nodes().to_vec();
    let model = world
        .add_model("strip", model, ContactStiffness::default())
        .unwrap();
    let id = world
        .add_deformable(DeformableSpec::at_rest(model, Pose::identity()))
        .unwrap();
    world.set_self_contact(id, meets_itself).unwrap();
    // The more, the farther from the bend.
    let speed = |x: &Vector3| -x.z.signum() * 60.0 * (-x.x).max(0.0);
    let velocities: Vec<Vector3> = nodes
        .iter()
        .map(|x| Vector3::new(0.0, 0.3, speed(x)))
        .collect();
    world.set_nodes(id, &nodes, &velocities).unwrap();
    world
}

fn own_contacts(world: &World) -> usize {
    let contacts = world.deformable_contacts();
    contacts.filter(|c| c.a == Partner::Body(c.b)).count()
}

/// The arms bounce off each other and keep their energy, momentum and angular momentum. Without contact they pass through
/// each other.
#[test]
fn the_arms_of_a_strip_bounce_off_each_other() {
    let mut p = weightless(1e6, 0.0, 0.0);
    p.time_step.safety = 0.3;
    let mut worlds = [true, false].map(|meets| clapping(p, meets));
    for (world, meets) in worlds.iter_mut().zip([true, false]) {
        let start = world.ledger().final_energy();
        let (linear, angular) = (
            world.linear_momentum(),
            world.angular_momentum(&Vector3::zeros()),
        );
        let (mut touched, mut worst, mut deepest) = (false, 0.0_f64, 0.0_f64);
        let mut crossed = false;
        while world.time() < 0.02 {
            world.step().unwrap();
            worst = worst.max((world.ledger().final_energy() / start - 1.0).abs());
            touched |= own_contacts(world) > 0;
            let depths = world.deformable_contacts().map(|c| c.penetration());
            deepest = depths.fold(deepest, f64::max);
            let body = world.deformable(0).unwrap();
            let nodes = body.model().nodes().iter().zip(body.positions());
            let tips = nodes.filter(|(start, _)| start.x < -4.9 * THICK);
            crossed |= tips.into_iter().all(|(start, x)| start.z * x.z < 0.0);
        }
        let speed = linear.norm();
        assert_eq!([touched, crossed], [meets, !meets]);
        assert!(worst < 1e-3 && deepest < 0.1 * THICK, "{worst} {deepest}");
        assert!((world.linear_momentum() - linear).norm() < 1e-12 * speed);
        let turned = world.angular_momentum(&Vector3::zeros()) - angular;
        assert!(turned.norm() < 1e-10 * speed * THICK, "{turned}");
    }
}

/// A body that does not touch itself moves by the same bits, whether it may or not.
#[test]
fn a_body_clear_of_itself_has_the_same_bits() {
    let run = |meets: bool| {
        let mut p = parameters(1e6, 0.5, 0.3);
        p.time_step.safety = 0.5;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let model = model(&folded(1), 1e7);
        let model = world
            .add_model("strip", model, ContactStiffness::default())
            .unwrap();
        for k in 0..2 {
            let spec = DeformableSpec {
                angular_velocity: Vector3::new(8.0, -3.0, 2.0),
                ..DeformableSpec::at_rest(
                    model,
                    Pose::translation(0.0, 0.0, 0.03 + 0.05 * f64::from(k)),
                )
            };
            let id = world.add_deformable(spec).unwrap();
            world.set_self_contact(id, meets).unwrap();
        }
        while world.time() < 0.05 {
            world.step().unwrap();
            assert_eq!(own_contacts(&world), 0);
        }
        let bodies = world.deformables();
        let states = bodies.map(|b| (b.positions().to_vec(), b.velocities().to_vec()));
        (
            states.collect::<Vec<_>>(),
            world.ledger(),
            world.time_step(),
            // Nothing is on record, and nothing is tested.
            world.deformable_totals().copied(),
        )
    };
    assert_eq!(run(true), run(false));
}

/// A spiral about the y axis, whose turns are `pitch` apart, from the radius `start` on.
fn spiral(start: f64, pitch: f64) -> impl Fn(f64) -> [Vector3; 2] {
    let rate = pitch / std::f64::consts::TAU;
    move |s| {
        // The arc length is close to the integral of the radius.
        let turn = ((start * start + 2.0 * rate * s).sqrt() - start) / rate;
        let (sin, cos) = turn.sin_cos();
        let radius = start + rate * turn;
        let along = Vector3::new(-sin, 0.0, cos) * radius + Vector3::new(cos, 0.0, sin) * rate;
        [Vector3::new(cos, 0.0, sin) * radius, along.normalize()]
    }
}

/// Length, m, and cells along the strip of a coil.
const COIL: (f64, u32) = (0.36, 36);

/// A coil of two turns, `pitch` thicknesses from each other, held at its outer end and turned at its inner one.
fn coil(pitch: f64) -> World {
    let mut p = weightless(1e6, 0.3, 0.3);
    p.time_step.safety = 0.4;
    let mut world = World::new(p).unwrap();
    let (length, cells) = COIL;
    let mesh = strip(length, cells, 1, spiral(2.0 * THICK, pitch * THICK));
    let model = model(&mesh, 1e6);
    let ends = [0.0, length].map(|end| {
        let straight = TetMesh::block([cells, 1, 1], &Vector3::new(length, THICK, THICK)).unwrap();
        let points = straight.points().iter().zip(0..);
        let own = points.filter(|(p, _)| (p.x - end).abs() < 1e-9);
        Selection::Nodes(own.map(|(_, i)| i).collect())
    });
    let wind = Drive::Turn {
        axis: Vector3::y(),
        point: Vector3::zeros(),
        rate: 40.0,
        start: 0.0,
        end: 0.06,
    };
    let mut boundary = Boundary::default();
    boundary.drive(&model, &ends[0], [true; 3], wind).unwrap();
    boundary.fix(&model, &ends[1], [true; 3]).unwrap();
    let model = world
        .add_model("coil", model, ContactStiffness::default())
        .unwrap();
    let spec = DeformableSpec {
        boundary,
        ..DeformableSpec::at_rest(model, Pose::identity())
    };
    world.add_deformable(spec).unwrap();
    world
}

/// Angle about the y axis, counted on over the turns, and distance from it, of the middles of the sections along a coil.
fn middles(world: &World) -> Vec<[f64; 2]> {
    let (length, cells) = COIL;
    let straight = TetMesh::block([cells, 1, 1], &Vector3::new(length, THICK, THICK)).unwrap();
    let mut sums = vec![Vector3::zeros(); cells as usize + 1];
    let body = world.deformable(0).unwrap();
    for (p, x) in straight.points().iter().zip(body.positions()) {
        sums[(p.x / length * f64::from(cells)).round() as usize] += x / 4.0;
    }
    let mut middles: Vec<[f64; 2]> = Vec::new();
    for x in sums {
        let before = middles.last().map_or(0.0, |m| m[0]);
        let angle = x.z.atan2(x.x) - before;
        let turn = std::f64::consts::TAU;
        middles.push([
            before + angle - turn * (angle / turn).round(),
            x.x.hypot(x.z),
        ]);
    }
    middles
}

/// The least distance of a turn from the one outside of it, between their middles, m.
fn least_pitch(world: &World) -> f64 {
    let middles = middles(world);
    let mut least = f64::INFINITY;
    for [angle, radius] in &middles {
        let outside = angle + std::f64::consts::TAU;
        for pair in middles.windows(2) {
            let [[a, r], [b, s]] = [pair[0], pair[1]];
            if (a..b).contains(&outside) {
                least = least.min(r + (s - r) * (outside - a) / (b - a) - radius);
            }
        }
    }
    least
}

/// A coil that is wound up closes, and its turns stay apart by their thickness; the books close.
#[test]
fn a_coil_that_is_wound_up_stays_out_of_itself() {
    let mut world = coil(1.5);
    let (mut touched, mut least) = (0, f64::INFINITY);
    while world.time() < 0.07 {
        world.step().unwrap();
        touched += usize::from(own_contacts(&world) > 0);
        least = least.min(least_pitch(&world));
    }
    assert!(touched > 500, "{touched}");
    assert!((0.85..1.1).contains(&(least / THICK)), "{least}");
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 0.01, "{ledger:?}");
    // Without contact with itself it would wind up farther.
    let mut free = coil(1.5);
    free.set_self_contact(0, false).unwrap();
    while free.time() < 0.07 {
        free.step().unwrap();
    }
    assert!(least_pitch(&free) < 0.5 * THICK, "{}", least_pitch(&free));
}

/// The same bits on any number of threads, and through bytes in the middle.
#[test]
fn the_same_bits_after_a_checkpoint_and_with_threads_in_a_coil() {
    let run = |threads: usize, stops: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| {
            let mut world = coil(1.05);
            let mut touched = false;
            for step in 0..300 {
                world.step().unwrap();
                touched |= own_contacts(&world) > 0;
                if stops && step % 40 == 17 {
                    world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
                }
            }
            assert!(touched);
            world.state_hash().unwrap()
        })
    };
    let once = run(1, false);
    assert_eq!(run(3, false), once);
    assert_eq!(run(1, true), once);
}

/// A block with a crack across it up to its middle, which is pressed shut by 2 % of its height: its lips carry what the
/// whole block would carry there.
#[test]
fn a_crack_that_is_pressed_shut_carries_the_load() {
    let (side, height, press, time) = (0.02, 0.04, 8e-4, 0.02);
    let whole = TetMesh::block([4, 4, 8], &Vector3::new(side, side, height)).unwrap();
    let mut points = whole.points().to_vec();
    let mut tets = whole.tets().to_vec();
    let mut twins = std::collections::BTreeMap::new();
    for tet in &mut tets {
        let middle = tet.iter().map(|&i| points[i as usize].z).sum::<f64>() / 4.0;
        for node in tet.iter_mut().filter(|_| middle > 0.5 * height) {
            let p = points[*node as usize];
            if (p.z - 0.5 * height).abs() < 1e-9 && p.x > 0.5 * side + 1e-9 {
                *node = *twins.entry(*node).or_insert_with(|| {
                    points.push(p);
                    points.len() as u32 - 1
                });
            }
        }
    }
    let cracked = TetMesh::new(points, tets).unwrap();
    let carried = |mesh: &TetMesh, meets: bool| {
        let mut p = weightless(1e6, 0.5, 0.3);
        p.time_step.safety = 0.5;
        let mut world = World::new(p).unwrap();
        let model = model(mesh, 1e6);
        let level = |offset: f64| Selection::Plane {
            normal: Vector3::z(),
            offset,
            tolerance: 1e-9,
        };
        let mut boundary = Boundary::default();
        boundary
            .fix(&model, &level(0.0), [false, false, true])
            .unwrap();
        let down = Drive::Linear {
            velocity: -Vector3::z() * (press / time),
            start: 0.0,
            end: time,
        };
        boundary
            .drive(&model, &level(height), [true; 3], down)
            .unwrap();
        let id = world
            .add_model("block", model, ContactStiffness::Ratio(10.0))
            .unwrap();
        let spec = DeformableSpec {
            boundary,
            ..DeformableSpec::at_rest(id, Pose::identity())
        };
        let body = world.add_deformable(spec).unwrap();
        world.set_self_contact(body, meets).unwrap();
        let (mut sum, mut count) = (0.0, 0.0);
        while world.time() < time {
            world.step().unwrap();
            if world.time() > 0.75 * time {
                let body = world.deformable(body).unwrap();
                let nodes = body.model().nodes().iter().zip(body.internal_forces());
                let bottom = nodes.filter(|(x, _)| x.z < 1e-9);
                sum += bottom.map(|(_, f)| -f.z).sum::<f64>() / world.time();
                count += 1.0;
            }
        }
        assert_eq!(own_contacts(&world) > 0, meets);
        let ledger = world.ledger();
        assert!(ledger.error_relative().abs() < 0.01, "{ledger:?}");
        sum / count
    };
    let [one, shut, open] = [(&whole, false), (&cracked, true), (&cracked, false)]
        .map(|(mesh, meets)| carried(mesh, meets));
    assert!((shut / one - 1.0).abs() < 0.02, "{shut} {one}");
    assert!(open < 0.9 * one, "{open} {one}");
}

/// A strip whose upper arm sags onto the lower one falls asleep so, keeps its contact, and wakes when it is loaded.
#[test]
fn a_strip_sleeps_on_itself() {
    let mut p = parameters(1e4, 0.5, 0.3);
    p.medium.drag = 20.0;
    p.sleeping.enabled = true;
    p.sleeping.deformables = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let model = model(&folded(1), 2e4);
    let model = world
        .add_model("strip", model, ContactStiffness::default())
        .unwrap();
    let place = Pose::translation(0.0, 0.0, 2.0 * THICK + 1e-4);
    let id = world
        .add_deformable(DeformableSpec::at_rest(model, place))
        .unwrap();
    while world.awake_deformable_count() > 0 && world.time() < 4.0 {
        world.step().unwrap();
    }
    assert!(world.deformable(id).unwrap().is_asleep());
    assert!(own_contacts(&world) > 0);
    let before = world.deformable(id).unwrap().positions().to_vec();
    for _ in 0..200 {
        world.step().unwrap();
    }
    assert_eq!(world.deformable(id).unwrap().positions(), before);
    assert!(own_contacts(&world) > 0);
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 0.02, "{ledger:?}");
    world
        .set_load(
            id,
            Wrench {
                force: Vector3::new(0.0, 0.0, -0.1),
                torque: Vector3::zeros(),
            },
        )
        .unwrap();
    for _ in 0..200 {
        world.step().unwrap();
    }
    assert!(!world.deformable(id).unwrap().is_asleep());
}

/// What parts that lie in each other bring or take away when their contact is switched is booked as done by hand.
#[test]
fn the_books_close_when_the_contact_is_switched() {
    let mut world = clapping(weightless(1e6, 0.3, 0.3), false);
    while world.time() < 0.006 {
        world.step().unwrap();
    }
    for on in [true, false, true] {
        let stored = world.ledger().elastic;
        world.set_self_contact(0, on).unwrap();
        world.step().unwrap();
        assert_eq!(own_contacts(&world) > 0, on);
        assert!(on || stored > 0.0);
        let ledger = world.ledger();
        assert!(ledger.error_relative().abs() < 0.01, "{ledger:?}");
    }
    assert!(world.ledger().by_hand.abs() > 0.0);
    assert!(world.set_self_contact(1, true).is_err());
}
