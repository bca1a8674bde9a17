//! The general kernel on the touching pairs of settled packs, as centroid fans and as finer meshes: per
//! touching pair, compared with the convex kernel. Caches are warm. Counts per pair are written to standard error, to convert times
//! per pair to times per piece.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use femdem::contact::general::{GeneralCache, GeneralScratch};
use femdem::contact::kernel::{PairCache, Scratch};
use femdem::contact::{ConvexShape, Field, FieldMesh, Frame, GeneralKernel, PairKernel};
use femdem::mesh::TetMesh;
use femdem_benches::{DIAMETER, SetUpError, frames, pack, solid};
use std::hint::black_box;

const PENALTY: f64 = 1e7;
const BODIES: u32 = 60;
const SETTLING: f64 = 0.6;

type Pair = (Frame, Frame);

/// The pairs of a pack that touch.
fn touching(shape: &ConvexShape, frames: &[Frame]) -> Result<Vec<Pair>, SetUpError> {
    let kernel = PairKernel::new(PENALTY)?;
    let mut scratch = Scratch::default();
    let mut pairs = Vec::new();
    for (i, a) in frames.iter().enumerate() {
        for b in &frames[i + 1..] {
            let near = (a.position - b.position).norm() < DIAMETER;
            if near && kernel.evaluate(shape, a, shape, b, &mut scratch).is_some() {
                pairs.push((*a, *b));
            }
        }
    }
    Ok(pairs)
}

fn bench_mesh(
    c: &mut Criterion,
    id: &str,
    body: &FieldMesh,
    pairs: &[Pair],
) -> Result<(), SetUpError> {
    let mut scratch = GeneralScratch::default();
    let mut group = c.benchmark_group("general_kernel");
    let kernel = GeneralKernel::new(PENALTY)?;
    let mut caches = vec![GeneralCache::default(); pairs.len()];
    let (mut candidates, mut pieces) = (0, 0);
    for ((a, b), cache) in pairs.iter().zip(&mut caches) {
        kernel.evaluate_cached(body, a, body, b, cache, 0.0, &mut scratch);
        let [looked_at, overlapping] = scratch.counts();
        candidates += looked_at;
        pieces += overlapping;
    }
    eprintln!(
        "{id}: {} pairs, {candidates} candidates, {pieces} pieces",
        pairs.len()
    );
    group.throughput(Throughput::Elements(pairs.len() as u64));
    group.bench_function(format!("general/{id}"), |bencher| {
        bencher.iter(|| {
            for ((a, b), cache) in pairs.iter().zip(&mut caches) {
                black_box(kernel.evaluate_cached(body, a, body, b, cache, 0.0, &mut scratch));
            }
        });
    });
    group.finish();
    Ok(())
}

fn bench_shape(c: &mut Criterion, id: &str) -> Result<(), SetUpError> {
    let polyhedron = solid(id)?;
    let (shape, frames) = frames(id, &pack(id, BODIES, SETTLING)?)?;
    let pairs = touching(&shape, &frames)?;
    let convex = PairKernel::new(PENALTY)?;
    let mut caches = vec![PairCache::default(); pairs.len()];
    let mut scratch = Scratch::default();
    let mut group = c.benchmark_group("general_kernel");
    group.throughput(Throughput::Elements(pairs.len() as u64));
    group.bench_function(format!("convex/{id}"), |bencher| {
        bencher.iter(|| {
            for ((a, b), cache) in pairs.iter().zip(&mut caches) {
                black_box(convex.evaluate_cached(&shape, a, &shape, b, cache, 0.0, &mut scratch));
            }
        });
    });
    group.finish();
    bench_mesh(c, id, &FieldMesh::from_convex(&polyhedron)?, &pairs)?;
    let fine = TetMesh::centroid_fan(&polyhedron)?.refined()?.refined()?;
    let centroid = polyhedron.mass_properties().centroid.coords;
    let fine = FieldMesh::new(&fine, centroid, Field::Body)?;
    bench_mesh(c, &format!("{id}/{} tets", fine.tet_count()), &fine, &pairs)
}

fn general_kernel(c: &mut Criterion) {
    for id in ["P1", "P5", "A10"] {
        bench_shape(c, id).expect("the set-up is valid");
    }
}

criterion_group!(benches, general_kernel);
criterion_main!(benches);
