//! Cost per body and step, and memory per body, of packs of growing size, for
//! `cargo studies validate size`.
//!
//! A column of 250 truncated dodecahedra, 5.3 d wide, is settled once. A pack of N bodies consists of copies of
//! it side by side, with walls around the whole but not between the copies. Bodies are numbered from below, as
//! if deposited, so that neighbours lie far apart in memory. All stay awake.
//!
//! Prints lines of columns separated by tabs; each begins with the name of its table. Arguments: copies along x
//! and y (`4x5`), steps that are not counted, rounds, steps in a round. One size per process, so that memory is
//! that of this size alone.

mod common;

use femdem_contact::Wall;
use femdem_mesh::{Pose, Vector3};
use femdem_pack::{Container, PackSpec, Packing, Penalty, Protocol, Release};
use femdem_solve::{BodySpec, Drive, Medium, World};
use std::error::Error;
use std::io::Write;

/// Bodies of the column that is copied.
const COLUMN: u32 = 250;

/// Its width over d.
const WIDTH: f64 = 5.3;

/// Pa; about what the program takes for such a load.
const PENALTY: f64 = 5.2e6;

fn main() -> Result<(), Box<dyn Error>> {
    common::on_one_thread(run)
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text = |i: usize, default: &'static str| arguments.get(i).map_or(default, String::as_str);
    let (nx, ny) = text(0, "2x2").split_once('x').ok_or("give copies as 2x3")?;
    let (nx, ny): (u32, u32) = (nx.parse()?, ny.parse()?);
    let uncounted: u64 = text(1, "300").parse()?;
    let rounds: usize = text(2, "5").parse()?;
    let steps: u64 = text(3, "20").parse()?;

    let spec = column();
    let mut packing = Packing::new(spec.clone())?;
    packing.run()?;
    let settled = packing.into_world();
    let shapes = memory("VmRSS")?;
    let mut world = copies(&settled, &spec, [nx, ny])?;
    drop(settled);
    // The copies begin without friction, and sink a little.
    let medium = Medium {
        local_damping: 0.7,
        ..Medium::default()
    };
    world.set_medium(medium)?;
    for _ in 0..uncounted {
        world.step()?;
    }
    world.set_medium(Medium::default())?;
    let bodies = world.body_count() as f64;
    let mut costs = Vec::with_capacity(rounds);
    let before = *world.counters();
    for _ in 0..rounds {
        let start = processor_time()?;
        for _ in 0..steps {
            world.step()?;
        }
        costs.push((processor_time()? - start) / (steps as f64 * bodies));
    }
    costs.sort_by(f64::total_cmp);
    let counters = world.counters();
    let per_step =
        |of: u64, from: u64| (of - from) as f64 / (counters.body_steps - before.body_steps) as f64;
    let touching = per_step(counters.touching_evaluations, before.touching_evaluations);
    let mut out = std::io::stdout().lock();
    for (name, value) in [
        ("bodies", bodies),
        ("awake", world.awake_count() as f64),
        ("least microseconds per body-step", 1e6 * costs[0]),
        (
            "median microseconds per body-step",
            1e6 * costs[costs.len() / 2],
        ),
        ("touching pairs per body", touching),
        (
            "candidate pairs per body",
            per_step(counters.pair_evaluations, before.pair_evaluations),
        ),
        ("bytes per body", (memory("VmRSS")? - shapes) / bodies),
        (
            "state bytes per body",
            world.to_bytes()?.len() as f64 / bodies,
        ),
        ("kinetic energy per body", world.kinetic_energy() / bodies),
    ] {
        writeln!(out, "number\t{name}\t{value:.6e}")?;
    }
    writeln!(out, "hash\t{:016x}", world.state_hash()?)?;
    let bits = world
        .body_ids()
        .filter_map(|i| Some((world.position(i)?, world.velocity(i)?)))
        .flat_map(|(x, v)| [x, v])
        .flat_map(|x| <[f64; 3]>::from(x).map(f64::to_bits))
        .fold(0_u64, |sum, bits| sum.rotate_left(5) ^ bits);
    writeln!(out, "bits\t{bits:016x}")?;
    Ok(())
}

fn column() -> PackSpec {
    let mut spec = PackSpec {
        count: COLUMN,
        penalty: Penalty::Given { pressure: PENALTY },
        protocol: Protocol::Release(Release::default()),
        ..PackSpec::default()
    };
    let width = WIDTH * spec.diameter();
    spec.container = Container::Box {
        width,
        depth: width,
    };
    spec.sleeping.enabled = false;
    spec
}

/// The settled bodies `n` times along x and y, at rest, from below.
fn copies(settled: &World, spec: &PackSpec, n: [u32; 2]) -> Result<World, Box<dyn Error>> {
    let width = WIDTH * spec.diameter();
    let mut poses: Vec<Pose> = Vec::new();
    for i in 0..n[0] {
        for j in 0..n[1] {
            let shift = Vector3::new(f64::from(i), f64::from(j), 0.0) * width;
            poses.extend((0..COLUMN).filter_map(|b| settled.pose(b)).map(|mut pose| {
                pose.translation.vector += shift;
                pose
            }));
        }
    }
    poses.sort_by(|a, b| a.translation.z.total_cmp(&b.translation.z));
    let mut world = World::new(*settled.parameters())?;
    let shape = world.add_shape("A10", &spec.shapes[0].polyhedron)?;
    let half = 0.5 * width;
    let far = [f64::from(n[0]) - 0.5, f64::from(n[1]) - 0.5].map(|k| k * width);
    for wall in Wall::closed_box(
        Vector3::new(-half, -half, 0.0),
        Vector3::new(far[0], far[1], 100.0 * width),
    )? {
        world.add_wall(wall, Drive::Fixed)?;
    }
    for pose in poses {
        world.add_body(BodySpec::at_rest(shape, spec.density, pose))?;
    }
    Ok(world)
}

/// Processor time of this process, s.
fn processor_time() -> Result<f64, Box<dyn Error>> {
    // Nanoseconds on a processor, of the one thread.
    let text = std::fs::read_to_string("/proc/self/schedstat")?;
    let first = text.split_whitespace().next().ok_or("no schedstat")?;
    Ok(first.parse::<f64>()? * 1e-9)
}

/// A row of /proc/self/status in bytes.
fn memory(row: &str) -> Result<f64, Box<dyn Error>> {
    let text = std::fs::read_to_string("/proc/self/status")?;
    let line = text.lines().find(|line| line.starts_with(row));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1));
    Ok(kilobytes.ok_or("no such row")?.parse::<f64>()? * 1024.0)
}
