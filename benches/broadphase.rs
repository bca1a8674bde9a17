//! An update of the batch in which bodies leave their skins: 8,000 A10 by themselves, and beside a cube eighty times
//! as large, which nothing touches.

use criterion::{Criterion, criterion_group, criterion_main};
use femdem::contact::{ContactBatch, ContactLaw, ContactParameters, ConvexShape, Frame, Motion};
use femdem::mesh::nalgebra::{Matrix3, Vector3};
use femdem_benches::{DIAMETER, SetUpError, solid};

/// Bodies along an edge of the lattice.
const ROW: u32 = 20;

/// Distance of the lattice's sites over d: the bodies do not touch.
const SPACING: f64 = 1.02;

/// Diameter of the large body over d.
const LARGE: f64 = 80.0;

fn at(position: Vector3<f64>) -> Motion {
    Motion::fixed(Frame {
        position,
        rotation: Matrix3::identity(),
    })
}

/// The bodies and their positions.
fn lattice(beside_a_large_one: bool) -> Result<(ContactBatch, Vec<Motion>), SetUpError> {
    let mut batch = ContactBatch::new(ContactLaw::new(ContactParameters::default())?);
    let shape = batch.add_shape(ConvexShape::new(&solid("A10")?)?);
    let mut motions = Vec::new();
    for i in 0..ROW.pow(3) {
        batch.add_body(shape)?;
        let site = Vector3::from([i % ROW, i / ROW % ROW, i / ROW / ROW].map(f64::from));
        motions.push(at(site * (SPACING * DIAMETER)));
    }
    if beside_a_large_one {
        let large = solid("P5")?.scaled(LARGE)?;
        let shape = batch.add_shape(ConvexShape::new(&large)?);
        batch.add_body(shape)?;
        motions.push(at(Vector3::z() * (-0.75 * LARGE * DIAMETER)));
    }
    batch.update(&motions, &[], 0.0)?;
    Ok((batch, motions))
}

fn broadphase(c: &mut Criterion) {
    let mut group = c.benchmark_group("broadphase");
    for (name, large) in [("alone", false), ("beside_a_large_one", true)] {
        let (mut batch, mut motions) = lattice(large).expect("the set-up is valid");
        let mut step = 0;
        group.bench_function(format!("8000/{name}"), |b| {
            b.iter(|| {
                // At most a fifth of half a skin: a body is searched for again in every fifth to tenth update.
                for (motion, i) in motions.iter_mut().zip(0_u32..) {
                    motion.travelled += 0.0025 * DIAMETER * f64::from((i + step) % 3);
                }
                step += 1;
                batch.update(&motions, &[], 0.0).expect("nothing touches");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, broadphase);
criterion_main!(benches);
