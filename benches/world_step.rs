//! One step of a pack of 500 bodies, all awake, on the caller's thread pool.

use criterion::{Criterion, criterion_group, criterion_main};
use femdem_benches::pack;

const BODIES: u32 = 500;
const SETTLING: f64 = 0.6;

fn world_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("world_step");
    for id in ["P5", "A10"] {
        let mut world = pack(id, BODIES, SETTLING).expect("the set-up is valid");
        group.bench_function(format!("{BODIES}_awake/{id}"), |b| {
            b.iter(|| world.step().expect("the pack is at rest"));
        });
    }
    group.finish();
}

criterion_group!(benches, world_step);
criterion_main!(benches);
