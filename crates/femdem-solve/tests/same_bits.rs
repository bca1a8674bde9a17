//! The state after n steps is the same bits for any number of threads, with and without the
//! feature `parallel`, and through a checkpoint.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod common;

use common::{D, DENSITY, G, add_floor, add_heap, add_sides, parameters};
use femdem_contact::{ContactParameters, MaterialId};
use femdem_mesh::nalgebra::Vector3;
use femdem_solve::checkpoint::checksum;
use femdem_solve::{Drive, World};
use std::path::{Path, PathBuf};

const STEPS: u32 = 1500;

/// A heap with friction between moving walls. No trigonometric function is called: their
/// last digits are the platform's.
fn heap(count: u64, wide: u64) -> World {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let velocity = Vector3::new(0.02, 0.01, 0.0);
    let side = (1.05 * wide as f64 + 0.1) * D;
    add_sides(
        &mut world,
        side,
        Drive::Linear {
            velocity,
            start: 0.05,
            end: 0.2,
        },
    );
    // Bodies of three materials, with a law for the pair of two of them.
    for (k, id) in (0..).zip(add_heap(&mut world, count, wide)) {
        world.set_material(id, MaterialId(k % 3)).unwrap();
    }
    let law = ContactParameters {
        penalty: 3e6,
        friction: 0.3,
        ..p.contact
    };
    world.set_law(MaterialId(1), MaterialId(2), law).unwrap();
    world
}

fn advance(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// The hash after all steps, and the largest number of pairs evaluated in a step.
fn run(threads: usize) -> (u64, u64) {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut world = heap(125, 5);
        let mut most = 0;
        for _ in 0..10 {
            let before = world.counters().pair_evaluations;
            advance(&mut world, STEPS / 10);
            let pairs = world.counters().pair_evaluations - before;
            most = most.max(pairs / u64::from(STEPS / 10));
        }
        (world.state_hash().unwrap(), most)
    })
}

#[test]
fn any_number_of_threads() {
    let (hash, pairs) = run(1);
    assert!(pairs > 256, "{pairs} pairs are too few to be handed out");
    assert_eq!(run(2).0, hash, "two threads");
    assert_eq!(run(3).0, hash, "three threads");
    compare_with_the_other_build(hash);
}

/// The hash differs between states, even if they differ by the last bit of one coordinate.
#[test]
fn the_hash_tells_states_apart() {
    let mut worlds = [0.0, 1e-15].map(|x| {
        let mut world = heap(8, 2);
        let mut spec = femdem_solve::BodySpec::at_rest(0, DENSITY, common::at(Vector3::z()));
        spec.velocity.x = 1.0 + x;
        world.add_body(spec).unwrap();
        world
    });
    let hashes = |worlds: &[World; 2]| worlds.each_ref().map(|w| w.state_hash().unwrap());
    let [a, b] = hashes(&worlds);
    assert_ne!(a, b);
    assert_eq!(worlds[0].clone().state_hash().unwrap(), a);
    worlds.iter_mut().for_each(|w| advance(w, 1));
    assert_ne!(hashes(&worlds)[0], a);
}

/// Written and read again while bodies slide and sleep, and walls move.
#[test]
fn through_bytes_in_the_middle() {
    let mut straight = heap(27, 3);
    let mut broken = straight.clone();
    let (mut slept, mut slid, mut moved) = (false, false, false);
    for _ in 0..100 {
        // What falls on sleepers wakes some of them.
        if straight.awake_count() == 0 && straight.body_count() == 27 {
            for world in [&mut straight, &mut broken] {
                let above = common::at(Vector3::z() * 8.0 * D);
                world
                    .add_body(femdem_solve::BodySpec::at_rest(0, DENSITY, above))
                    .unwrap();
            }
        }
        advance(&mut straight, 100);
        advance(&mut broken, 100);
        broken = World::from_bytes(&broken.to_bytes().unwrap()).unwrap();
        slept |= (1..27).contains(&broken.awake_count());
        slid |= broken
            .contacts()
            .iter()
            .any(|c| c.slides && c.friction.norm() > 0.0);
        moved |= (0.05..0.2).contains(&broken.time());
    }
    assert_eq!(straight.state_hash().unwrap(), broken.state_hash().unwrap());
    assert_eq!([slept, slid, moved], [true; 3]);
    assert!(straight.kinetic_energy() < 0.1 * 27.0 * G * D);
}

/// A build with `parallel` and one without store their hashes in the target folder, under a name derived from
/// the sources; whichever runs second compares them. So run this test twice in the crate's folder, once with
/// `--no-default-features`.
fn compare_with_the_other_build(hash: u64) {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut sources = Vec::new();
    for name in ["femdem-mesh", "femdem-contact", "femdem-solve"] {
        collect(&crates.join(name), &mut sources);
    }
    sources.sort();
    let text: Vec<u8> = sources
        .iter()
        .flat_map(|p| std::fs::read(p).unwrap())
        .collect();
    let name = |parallel: bool| {
        let kind = if parallel { "parallel" } else { "serial" };
        let optimised = if cfg!(debug_assertions) {
            "debug"
        } else {
            "release"
        };
        let file = format!("hash-{kind}-{optimised}-{:016x}", checksum(&text));
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(file)
    };
    let own = cfg!(feature = "parallel");
    std::fs::write(name(own), hash.to_string()).unwrap();
    if let Ok(other) = std::fs::read_to_string(name(!own)) {
        assert_eq!(
            other,
            hash.to_string(),
            "with and without the feature `parallel`"
        );
    }
}

/// All Rust files under a folder.
fn collect(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}
