//! Cost of the contacts of deformable boulders in a heap, in nanoseconds: per tetrahedron of all bodies and
//! step, per touching pair, and per overlapping pair of tetrahedra.
//!
//! ```text
//! cargo run --release -p femdem-contact --example deform_cost -- [BODIES PER SIDE] [SPACING] [STEPS]
//! ```

#![expect(clippy::print_stdout, reason = "an example shows its results")]

use femdem_contact::deform::{DeformableShape, Modulus, NodalState};
use femdem_contact::{ContactBatch, ContactLaw, ContactParameters, Frame, Motion};
use femdem_mesh::nalgebra::{UnitQuaternion, Vector3};
use femdem_mesh::shapes::{Boulder, Shape};
use femdem_mesh::{TetMesh, Vector3 as V};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = |i: usize| std::env::args().nth(i);
    let side: usize = argument(1).map_or(Ok(7), |s| s.parse())?;
    let spacing: f64 = argument(2).map_or(Ok(0.93), |s| s.parse())?;
    let steps: u32 = argument(3).map_or(Ok(500), |s| s.parse())?;
    let law = ContactLaw::new(ContactParameters::default())?;
    let mut batch = ContactBatch::new(law);
    let mut state = 7_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut vector = move || Vector3::new(random(), random(), random());
    let (mut places, mut velocities, mut masses) = (Vec::new(), Vec::new(), Vec::new());
    let (mut tets, mut nodes) = (0, 0);
    for i in 0..side * side * side {
        let boulder = Shape::Boulder(Boulder {
            seed: i as u64 % 16,
            ..Boulder::default()
        });
        let mesh = TetMesh::centroid_fan(&boulder.polyhedron(1.0)?)?;
        let shape = DeformableShape::new(&mesh)?;
        tets += mesh.tets().len();
        nodes += mesh.points().len();
        let index = batch.add_deformable_shape(shape);
        batch.add_deformable(index, Modulus::Penalty(1e6))?;
        let [x, y, z] = [i % side, i / side % side, i / side / side].map(|k| k as f64);
        let turn = UnitQuaternion::from_scaled_axis(vector() * 5.0);
        let at = Vector3::new(x, y, z) * spacing;
        let x: Vec<V> = mesh.points().iter().map(|p| turn * p.coords + at).collect();
        let drift = vector() * 1e-3;
        velocities.push(
            x.iter()
                .map(|_| drift + vector() * 1e-4)
                .collect::<Vec<V>>(),
        );
        masses.push(vec![1.0; x.len()]);
        places.push(x);
    }
    let dt = 1e-4;
    let still = vec![Motion::fixed(Frame::identity()); places.len()];
    let mut sums = [0_usize; 4];
    let (mut time, mut depth) = (0.0, 0.0);
    for step in 0..steps {
        for (x, v) in places.iter_mut().flatten().zip(velocities.iter().flatten()) {
            *x += v * dt;
        }
        let states: Vec<NodalState> = places
            .iter()
            .zip(&velocities)
            .zip(&masses)
            .map(|((x, v), w)| NodalState {
                positions: x,
                velocities: v,
                inverse_masses: w,
            })
            .collect();
        let start = Instant::now();
        batch.update_deformables(&states, &still, &[], 0.0)?;
        if step >= 10 {
            time += start.elapsed().as_secs_f64();
            depth = batch
                .deformable_contacts()
                .map(|c| c.penetration())
                .sum::<f64>()
                / batch.deformable_contacts().count().max(1) as f64;
            let t = batch.deformable_totals().copied().unwrap_or_default();
            for (sum, n) in sums
                .iter_mut()
                .zip([t.pairs, t.touching, t.candidates, t.pieces])
            {
                *sum += n;
            }
        }
    }
    let n = f64::from(steps - 10);
    let per = |count: f64| 1e9 * time / count;
    let [pairs, touching, candidates, pieces] = sums.map(|s| s as f64);
    println!(
        "{} bodies, {tets} tets, {nodes} nodes; per step: {:.1} pairs, {:.1} touch, {:.0} candidates, {:.0} pieces; mean penetration {:.1e} of the size",
        places.len(),
        pairs / n,
        touching / n,
        candidates / n,
        pieces / n,
        depth / touching
    );
    println!(
        "{:.2} ns per tet and step, {:.0} ns per touching pair, {:.0} ns per piece, {:.1} ns per candidate",
        per(n * tets as f64),
        per(touching),
        per(pieces),
        per(candidates)
    );
    Ok(())
}
