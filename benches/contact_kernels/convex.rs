//! Convex bodies on the pairs of settled packs, and on the floor.

use femdem::contact::general::{GeneralCache, GeneralScratch};
use femdem::contact::kernel::{CavityCache, CavityKernel, Scratch};
use femdem::contact::{Frame, GeneralKernel, SolidWall, Wall};
use femdem::mesh::{Point3, TetMesh, Vector3};
use femdem_benches::{DIAMETER, SetUpError, frames, pack, solid};
use std::hint::black_box;

use super::pairs::{Convex, PENALTY, Pair, convex_kernels};
use super::{Kernel, fastest, print, row};

const BODIES: u32 = 100;
const SETTLING: f64 = 0.6;

/// Pairs of a pack that touch.
fn touching(body: &Convex, frames: &[Frame]) -> Result<Vec<Pair>, SetUpError> {
    let kernel = femdem::contact::PairKernel::new(PENALTY)?;
    let mut scratch = Scratch::default();
    let mut pairs = Vec::new();
    for (i, a) in frames.iter().enumerate() {
        for b in &frames[i + 1..] {
            let near = (a.position - b.position).norm() < DIAMETER;
            let shape = &body.shape;
            if near && kernel.evaluate(shape, a, shape, b, &mut scratch).is_some() {
                pairs.push([*a, *b]);
            }
        }
    }
    Ok(pairs)
}

/// A floor z <= 0 as planes, and as one large tetrahedron.
fn floor() -> Result<(Wall, SolidWall), SetUpError> {
    let size = 100.0 * DIAMETER;
    let points = [
        [size, 0.0, 0.0],
        [-size, size, 0.0],
        [-size, -size, 0.0],
        [0.0, 0.0, -size],
    ];
    let mesh = TetMesh::new(points.map(Point3::from).to_vec(), vec![[0, 2, 1, 3]])?;
    let planes = Wall::half_space("floor", Vector3::z(), 0.0)?;
    Ok((planes, SolidWall::solid(&mesh)))
}

/// The wall kernels on the bodies that lie on the floor.
fn wall_kernels<'a>(
    body: &'a Convex,
    resting: &'a [Frame],
    (planes, solid): &'a (Wall, SolidWall),
) -> Result<Vec<Kernel<'a>>, SetUpError> {
    let count = resting.len();
    let at = Frame::identity();
    let kernel = CavityKernel::new(PENALTY)?;
    let mut scratch = Scratch::default();
    let mut caches = vec![CavityCache::default(); count];
    let of_planes = move || {
        for (frame, cache) in resting.iter().zip(&mut caches) {
            let shape = &body.shape;
            black_box(kernel.evaluate_cached(planes, &at, shape, frame, cache, 0.0, &mut scratch));
        }
    };
    let kernel = GeneralKernel::new(PENALTY)?;
    let mut scratch = GeneralScratch::default();
    let mut caches = vec![GeneralCache::default(); count];
    let of_mesh = move || {
        for (frame, cache) in resting.iter().zip(&mut caches) {
            let scratch = &mut scratch;
            let fan = &body.fan;
            black_box(kernel.evaluate_wall_cached(solid, &at, fan, frame, cache, 0.0, scratch));
        }
    };
    Ok(vec![
        Kernel::new("wall of planes, warm", count, of_planes),
        Kernel::new("wall of a mesh, warm", count, of_mesh),
    ])
}

pub fn table(turns: u32) -> Result<(), SetUpError> {
    let floor = floor()?;
    let kernel = CavityKernel::new(PENALTY)?;
    let (mut names, mut rows) = (vec!["shape"], Vec::new());
    for id in ["P1", "P5", "A1", "P3", "A10"] {
        let body = Convex::new(&solid(id)?)?;
        let (_, frames) = frames(id, &pack(id, BODIES, SETTLING)?)?;
        let pairs = touching(&body, &frames)?;
        let mut scratch = Scratch::default();
        let mut rests = |f: &Frame| {
            let at = Frame::identity();
            let contact = kernel.evaluate(&floor.0, &at, &body.shape, f, &mut scratch);
            contact.is_some()
        };
        let resting: Vec<Frame> = frames.into_iter().filter(|f| rests(f)).collect();
        let mut kernels = convex_kernels(&body, &pairs)?;
        kernels.extend(wall_kernels(&body, &resting, &floor)?);
        names.truncate(1);
        names.extend(kernels.iter().map(|k| k.name));
        rows.push(row(id, &fastest(&mut kernels, turns)));
    }
    print("ns per touching pair of a settled pack:", &names, &rows);
    Ok(())
}
