//! Cost of the contacts of rigid meshes, for pairs that overlap by 0.3 % of their size in random orientations, with
//! warm caches: nanoseconds per evaluation, and per pair of tetrahedra in which the skin of one lies in the other.
//!
//! ```text
//! cargo run --release -p femdem-contact --example general_cost -- [SHAPE] [PAIRS] [EVALUATIONS]
//! ```

#![expect(clippy::print_stdout, reason = "an example shows its results")]

use femdem_contact::general::{GeneralCache, GeneralScratch};
use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel};
use femdem_mesh::nalgebra::{UnitQuaternion, Vector3};
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::{MeshOptions, mesh};
use std::hint::black_box;
use std::time::Instant;

/// Depth of the overlaps over the radius of the bodies.
const DEPTH: f64 = 0.006;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = |i: usize| std::env::args().nth(i);
    let name = argument(1).unwrap_or_else(|| "dolos".to_owned());
    let count: u32 = argument(2).map_or(Ok(60), |s| s.parse())?;
    let turns: u32 = argument(3).map_or(Ok(200), |s| s.parse())?;
    let surface = name.parse::<Shape>()?.polyhedron(1.0)?;
    let (tets, _) = mesh(&surface, &MeshOptions::default())?;
    let body = FieldMesh::new(
        &tets,
        surface.mass_properties().centroid.coords,
        Field::Body,
    )?;
    let kernel = GeneralKernel::new(1e6)?;
    let mut scratch = GeneralScratch::default();
    let mut state = 7_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut vector = move || Vector3::new(random(), random(), random());
    let mut pairs = Vec::new();
    for _ in 0..count {
        let turn = UnitQuaternion::from_scaled_axis(vector() * 12.0);
        let direction = vector().normalize();
        let at = |distance: f64| Frame {
            position: direction * distance,
            rotation: turn.to_rotation_matrix().into_inner(),
        };
        let (mut near, mut far) = (0.0, 2.0 * body.radius());
        for _ in 0..20 {
            let middle = 0.5 * (near + far);
            let frame = at(middle);
            let patches = kernel.evaluate(&body, &Frame::identity(), &body, &frame, &mut scratch);
            if patches.is_empty() {
                far = middle;
            } else {
                near = middle;
            }
        }
        pairs.push((at(near - DEPTH * body.radius()), GeneralCache::default()));
    }
    let mut sums = [0; 3];
    let start = Instant::now();
    for _ in 0..=turns {
        for (frame, cache) in &mut pairs {
            let here = Frame::identity();
            let patches =
                kernel.evaluate_cached(&body, &here, &body, frame, cache, 0.0, &mut scratch);
            sums[0] += black_box(patches).len();
            let [candidates, overlaps] = scratch.counts();
            sums[1] += candidates;
            sums[2] += overlaps;
        }
    }
    let time = start.elapsed().as_secs_f64();
    let n = f64::from(count) * f64::from(turns + 1);
    let [patches, candidates, overlaps] = sums.map(|sum| sum as f64 / n);
    println!(
        "{name}, {} tetrahedra: {patches:.2} patches, {candidates:.1} candidates and {overlaps:.1} with skin per pair",
        body.tet_count()
    );
    println!(
        "{:.0} ns per pair, {:.0} ns per one with skin",
        1e9 * time / n,
        1e9 * time / (n * overlaps)
    );
    Ok(())
}
