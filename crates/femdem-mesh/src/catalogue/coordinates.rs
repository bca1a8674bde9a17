//! Vertices from closed formulas.

use super::Solid;
use crate::{Matrix3, Point3, Vector3};
use std::f64::consts::SQRT_2;

/// Which permutations of the coordinates of a seed, and which signs, give vertices.
#[derive(Clone, Copy)]
enum Symmetry {
    /// Cyclic permutations, all signs (pyritohedral).
    Cyclic,
    /// All permutations, all signs (octahedral).
    All,
    /// Cyclic permutations, an even number of signs changed (rotations of the tetrahedron).
    Tetrahedral,
    /// Permutations and sign changes both even or both odd (rotations of the cube).
    Rotations,
}

const EVEN_PERMUTATIONS: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
const ODD_PERMUTATIONS: [[usize; 3]; 3] = [[1, 0, 2], [0, 2, 1], [2, 1, 0]];

/// Vertices of a solid in the sphere of `radius` about the origin.
pub(super) fn vertices(solid: Solid, radius: f64) -> Vec<Point3> {
    let (symmetry, seeds) = seeds(solid);
    seeds
        .into_iter()
        .flat_map(|seed| orbit(seed.normalize() * radius, symmetry))
        .map(Point3::from)
        .collect()
}

/// One vertex of each orbit, of any length.
fn seeds(solid: Solid) -> (Symmetry, Vec<Vector3>) {
    use Symmetry::{All, Cyclic, Rotations, Tetrahedral};
    // The golden ratio, with its powers 1 + phi and 1 + 2 phi.
    let phi = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let (phi2, phi3) = (phi + 1.0, 2.0 * phi + 1.0);
    let silver = 1.0 + SQRT_2;
    let (symmetry, seeds): (_, &[[f64; 3]]) = match solid {
        Solid::P1 => (Tetrahedral, &[[1.0, 1.0, 1.0]]),
        Solid::P2 => (Cyclic, &[[0.0, 1.0, phi]]),
        Solid::P3 => (Cyclic, &[[0.0, 1.0, phi2], [phi, phi, phi]]),
        Solid::P4 => (All, &[[0.0, 0.0, 1.0]]),
        Solid::P5 => (All, &[[1.0, 1.0, 1.0]]),
        Solid::A1 => (Tetrahedral, &[[1.0, 1.0, 3.0]]),
        Solid::A2 => (
            Cyclic,
            &[
                [0.0, 1.0, 3.0 * phi],
                [phi, 2.0, phi3],
                [1.0, 2.0 + phi, 2.0 * phi],
            ],
        ),
        Solid::A3 => {
            let t = tribonacci();
            (Rotations, &[[1.0 / t, 1.0, t]])
        }
        Solid::A4 => return (Tetrahedral, snub_dodecahedron_seeds(phi)),
        Solid::A5 => (
            Cyclic,
            &[
                [1.0, 1.0, phi3],
                [0.0, phi2, 2.0 + phi],
                [phi, 2.0 * phi, phi2],
            ],
        ),
        Solid::A6 => (
            Cyclic,
            &[
                [1.0, 1.0, 4.0 * phi + 1.0],
                [2.0, phi2, 3.0 * phi + 2.0],
                [1.0, phi3, 2.0 * phi + 3.0],
                [2.0 + phi, 2.0 * phi, 3.0 * phi + 1.0],
                [phi2, 3.0 * phi, 2.0 * phi2],
            ],
        ),
        Solid::A7 => (All, &[[1.0, silver, 1.0 + 2.0 * SQRT_2]]),
        Solid::A8 => (Cyclic, &[[0.0, 0.0, 2.0 * phi], [1.0, phi, phi2]]),
        Solid::A9 => (All, &[[1.0, 1.0, silver]]),
        Solid::A10 => (
            Cyclic,
            &[
                [0.0, 1.0, 3.0 * phi + 1.0],
                [1.0, phi2, 2.0 * phi2],
                [phi2, 2.0 * phi, phi3],
            ],
        ),
        Solid::A11 => (All, &[[0.0, 1.0, 1.0]]),
        Solid::A12 => (All, &[[1.0, silver, silver]]),
        Solid::A13 => (All, &[[0.0, 1.0, 2.0]]),
    };
    (
        symmetry,
        seeds.iter().map(|&seed| Vector3::from(seed)).collect(),
    )
}

/// The real root of t^3 = t^2 + t + 1.
fn tribonacci() -> f64 {
    let root = 3.0 * 33.0_f64.sqrt();
    (1.0 + (19.0 + root).cbrt() + (19.0 - root).cbrt()) / 3.0
}

/// A vertex and its images under turns of 72 degrees about the five-fold axis (0, 1, phi): one
/// for each of the five orbits under the rotations of the tetrahedron.
///
/// The vertex is (phi^2 (x - 1), phi x (1 + 2 x) - phi^3, x), where x is the real root of
/// x^3 + 2 x^2 = phi^2.
fn snub_dodecahedron_seeds(phi: f64) -> Vec<Vector3> {
    let phi2 = phi + 1.0;
    // x = y - 2/3 leaves y^3 - 4 y / 3 = 2 q, which Cardano's formula solves.
    let q = phi2 / 2.0 - 8.0 / 27.0;
    let root = (q * q - 64.0 / 729.0).sqrt();
    let x = (q + root).cbrt() + (q - root).cbrt() - 2.0 / 3.0;
    let seed = Vector3::new(
        phi2 * (x - 1.0),
        phi * x * (1.0 + 2.0 * x) - (2.0 * phi + 1.0),
        x,
    );
    let (long, short) = (phi / 2.0, 0.5 / phi);
    let turn = Matrix3::new(short, -long, 0.5, long, 0.5, short, -0.5, short, long);
    std::iter::successors(Some(seed), |v| Some(turn * v))
        .take(5)
        .collect()
}

/// All different images of a point.
fn orbit(seed: Vector3, symmetry: Symmetry) -> Vec<Vector3> {
    use Symmetry::{All, Cyclic, Rotations, Tetrahedral};
    let mut images: Vec<Vector3> = Vec::new();
    let even = EVEN_PERMUTATIONS.into_iter().map(|p| (p, true));
    let odd = ODD_PERMUTATIONS.into_iter().map(|p| (p, false));
    for (permutation, is_even) in even.chain(odd) {
        for signs in 0..8_u32 {
            let changes_even = signs.count_ones() % 2 == 0;
            let belongs = match symmetry {
                Cyclic => is_even,
                All => true,
                Tetrahedral => is_even && changes_even,
                Rotations => is_even == changes_even,
            };
            let image = Vector3::from_fn(|k, _| {
                let value = seed[permutation[k]];
                // Zero has no sign: -0.0 would print as another number.
                if signs >> k & 1 == 1 && value != 0.0 {
                    -value
                } else {
                    value
                }
            });
            if belongs && !images.contains(&image) {
                images.push(image);
            }
        }
    }
    images
}
