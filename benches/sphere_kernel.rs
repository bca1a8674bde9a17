//! The kernel of exact spheres, time per touching pair: with a sphere, a plane, the corner of a box, and the facets,
//! edges and vertices of a cube.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use femdem::contact::{ConvexShape, Frame, Sphere, SphereKernel, Wall, WallPlane};
use femdem::mesh::Vector3;
use femdem_benches::{SetUpError, solid};
use std::hint::black_box;

const PENALTY: f64 = 1e7;
const RADIUS: f64 = 0.01;

/// Directions over a sphere, on a spiral.
fn directions() -> Vec<Vector3> {
    let at = |k: u32| {
        let z = f64::from(2 * k + 1) / 64.0 - 1.0;
        let (sin, cos) = (2.4 * f64::from(k)).sin_cos();
        let out = (1.0 - z * z).sqrt();
        Vector3::new(out * cos, out * sin, z)
    };
    (0..64).map(at).collect()
}

fn planes(normals: &[Vector3]) -> Result<Wall, SetUpError> {
    let plane = |&normal: &Vector3| WallPlane {
        normal,
        offset: 0.0,
    };
    Ok(Wall::new("wall", normals.iter().map(plane).collect())?)
}

fn bench(c: &mut Criterion) -> Result<(), SetUpError> {
    let kernel = SphereKernel::new(PENALTY)?;
    let ball = Sphere::new(RADIUS)?;
    let here = Frame::identity();
    let places = directions();
    let mut group = c.benchmark_group("sphere_kernel");
    group.throughput(Throughput::Elements(places.len() as u64));
    group.bench_function("sphere", |b| {
        b.iter(|| {
            for u in &places {
                black_box(kernel.evaluate(&ball, &ball, &(u * (1.99 * RADIUS))));
            }
        });
    });
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    for (name, normals) in [("plane", &axes[2..]), ("corner", &axes[..])] {
        let wall = planes(normals)?;
        group.bench_function(name, |b| {
            b.iter(|| {
                for u in &places {
                    let centre = Vector3::repeat(0.99 * RADIUS) + u * (0.005 * RADIUS);
                    black_box(kernel.evaluate_wall(&wall, &here, &ball, &centre));
                }
            });
        });
    }
    let cube = ConvexShape::new(&solid("P5")?)?;
    group.bench_function("cube", |b| {
        b.iter(|| {
            for u in &places {
                let skin = u / (1.0 - cube.field(u));
                let centre = skin + u * (0.99 * RADIUS);
                black_box(kernel.evaluate_convex(&cube, &here, &ball, &centre));
            }
        });
    });
    group.finish();
    Ok(())
}

fn sphere_kernel(c: &mut Criterion) {
    bench(c).expect("the set-up is valid");
}

criterion_group!(benches, sphere_kernel);
criterion_main!(benches);
