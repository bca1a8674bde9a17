//! Cost against the number of faces: hulls of points on a sphere, 4 to 1,000 triangles.

use femdem::contact::PairKernel;
use femdem::contact::kernel::Scratch;
use femdem::mesh::{Point3, Polyhedron, Vector3, convex_hull};
use femdem_benches::{DIAMETER, SetUpError};
use std::f64::consts::TAU;

use super::pairs::{Convex, PENALTY, Pair, approached, convex_kernels, noise};
use super::{fastest, print, row};

const PAIRS: u32 = 60;

/// A hull of 2 n - 4 triangles: n points along a spiral on a sphere, moved a little on it.
fn ball(n: u32) -> Result<Polyhedron, SetUpError> {
    let golden = 0.5 * (5_f64.sqrt() - 1.0);
    let point = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
        let (sin, cos) = (TAU * golden * f64::from(i)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        let shift = Vector3::new(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)).add_scalar(-0.5);
        let moved = Vector3::new(r * cos, r * sin, z) + shift * (0.5 / f64::from(n).sqrt());
        Point3::from(moved.normalize() * (0.5 * DIAMETER))
    };
    Ok(convex_hull(&(0..n).map(point).collect::<Vec<_>>())?)
}

pub fn table(turns: u32) -> Result<(), SetUpError> {
    let kernel = PairKernel::new(PENALTY)?;
    let (mut names, mut rows) = (vec!["faces"], Vec::new());
    for points in [4, 6, 12, 22, 52, 127, 252, 502] {
        let surface = ball(points)?;
        let body = Convex::new(&surface)?;
        let touch = |[a, b]: &Pair| {
            let shape = &body.shape;
            let mut scratch = Scratch::default();
            kernel.evaluate(shape, a, shape, b, &mut scratch).is_some()
        };
        let pairs = approached(touch, body.shape.radius(), PAIRS);
        let mut kernels = convex_kernels(&body, &pairs)?;
        names.truncate(1);
        names.extend(kernels.iter().map(|k| k.name));
        let times = fastest(&mut kernels, turns);
        rows.push(row(&surface.face_count().to_string(), &times));
    }
    print(
        "ns per touching pair against the faces of each, 0.3 % deep:",
        &names,
        &rows,
    );
    Ok(())
}
