//! The pair kernel on the pairs of settled packs, time per pair: touching pairs with a cache from the last step
//! (`warm`) and without (`cold`), and near misses with and without the separating axis of the last step. No
//! pair moves, so that a warm near miss only checks the cached travel budget.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use femdem::contact::kernel::{PairCache, Scratch};
use femdem::contact::{ConvexShape, Frame, PairKernel};
use femdem_benches::{DIAMETER, SetUpError, frames, pack};
use std::hint::black_box;

const PENALTY: f64 = 1e7;
const BODIES: u32 = 100;
const SETTLING: f64 = 0.6;

type Pair = (Frame, Frame);

/// The touching pairs of a pack, and those that do not touch though their spheres overlap.
fn pairs(kernel: &PairKernel, shape: &ConvexShape, frames: &[Frame]) -> (Vec<Pair>, Vec<Pair>) {
    let mut scratch = Scratch::default();
    let mut touches = |a: &Frame, b: &Frame| {
        let overlap = kernel.evaluate(shape, a, shape, b, &mut scratch);
        overlap.is_some()
    };
    let (mut touching, mut missing) = (Vec::new(), Vec::new());
    for (i, a) in frames.iter().enumerate() {
        for b in &frames[i + 1..] {
            if (a.position - b.position).norm() > DIAMETER {
                continue;
            }
            if touches(a, b) {
                touching.push((*a, *b));
            } else {
                missing.push((*a, *b));
            }
        }
    }
    (touching, missing)
}

fn bench_shape(c: &mut Criterion, id: &str) -> Result<(), SetUpError> {
    let (shape, frames) = frames(id, &pack(id, BODIES, SETTLING)?)?;
    let kernel = PairKernel::new(PENALTY)?;
    let (touching, missing) = pairs(&kernel, &shape, &frames);
    let mut scratch = Scratch::default();
    let mut group = c.benchmark_group("pair_kernel");
    for (what, pairs) in [("touching", &touching), ("near_miss", &missing)] {
        group.throughput(Throughput::Elements(pairs.len() as u64));
        let mut caches = vec![PairCache::default(); pairs.len()];
        group.bench_function(format!("{what}/warm/{id}"), |b| {
            b.iter(|| {
                for ((a, b), cache) in pairs.iter().zip(&mut caches) {
                    black_box(kernel.evaluate_cached(
                        &shape,
                        a,
                        &shape,
                        b,
                        cache,
                        0.0,
                        &mut scratch,
                    ));
                }
            });
        });
        group.bench_function(format!("{what}/cold/{id}"), |b| {
            b.iter(|| {
                for (a, b) in pairs {
                    black_box(kernel.evaluate(&shape, a, &shape, b, &mut scratch));
                }
            });
        });
    }
    group.finish();
    Ok(())
}

fn pair_kernel(c: &mut Criterion) {
    for id in ["P1", "P5", "A1", "P3", "A10"] {
        bench_shape(c, id).expect("the set-up is valid");
    }
}

criterion_group!(benches, pair_kernel);
criterion_main!(benches);
