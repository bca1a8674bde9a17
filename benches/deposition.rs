//! A whole deposition of 100 truncated dodecahedra, to the verified pack.

use criterion::{Criterion, criterion_group, criterion_main};
use femdem::pack::{Container, PackShape, PackSpec, Packing};
use femdem_benches::{DIAMETER, SetUpError, solid};

fn spec() -> Result<PackSpec, SetUpError> {
    let side = 4.0 * DIAMETER;
    Ok(PackSpec {
        shapes: vec![PackShape::new("A10", solid("A10")?)],
        count: 100,
        container: Container::Box {
            width: side,
            depth: side,
        },
        ..PackSpec::default()
    })
}

fn deposition(c: &mut Criterion) {
    let spec = spec().expect("A10 is in the catalogue");
    let mut group = c.benchmark_group("deposition");
    group.sample_size(10);
    group.bench_function("100/A10", |b| {
        b.iter(|| {
            let mut packing = Packing::new(spec.clone()).expect("the job is valid");
            packing.run().expect("the pack settles")
        });
    });
    group.finish();
}

criterion_group!(benches, deposition);
criterion_main!(benches);
