//! A surface like those of scanners: irregular triangles, rough, in millimetres and single precision.

use std::f64::consts::{PI, TAU};

type Point = [f64; 3];

/// Points around and along the stone: 2 * 40 * 25 triangles.
const AROUND: usize = 40;
const ALONG: usize = 25;

/// Half the length and half the width of the stone before it is bent, mm.
const LENGTH: f64 = 45.0;
const WIDTH: f64 = 16.0;

/// Angle over which the stone is bent, rad.
const BEND: f64 = 2.6;

/// The triangles of a bent, rough stone.
pub(crate) fn stone() -> Vec<[Point; 3]> {
    let poles = [surface(0.0, 0.0), surface(PI, 0.0)];
    let ring = |i: usize, j: usize| {
        // Points of a scan do not lie on a grid.
        let (a, b) = (noise(i, j % AROUND), noise(j % AROUND + 100, i));
        let along = PI * (i as f64 + 1.0 + 0.35 * a) / (ALONG as f64 + 1.0);
        let around = TAU * ((j % AROUND) as f64 + 0.35 * b + 0.5 * (i % 2) as f64) / AROUND as f64;
        surface(along, around)
    };
    let mut triangles = Vec::with_capacity(2 * AROUND * ALONG);
    for j in 0..AROUND {
        triangles.push([poles[0], ring(0, j), ring(0, j + 1)]);
        triangles.push([poles[1], ring(ALONG - 1, j + 1), ring(ALONG - 1, j)]);
        for i in 0..ALONG - 1 {
            let (a, b) = (ring(i, j), ring(i, j + 1));
            let (c, d) = (ring(i + 1, j), ring(i + 1, j + 1));
            // Odd rings are turned by half a step.
            if i % 2 == 0 {
                triangles.extend([[a, c, b], [b, c, d]]);
            } else {
                triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
    }
    triangles
}

/// The point of the surface at an angle from the pole and around the long axis.
fn surface(along: f64, around: f64) -> Point {
    let (sin, cos) = along.sin_cos();
    let (y, z) = (sin * around.cos(), sin * around.sin());
    let waves = [
        (0.06, 3.1, 0.7, 2.0),
        (0.05, -5.3, 4.1, 0.4),
        (0.03, 7.9, -6.2, 1.1),
        (0.02, 11.7, 9.3, 5.2),
    ];
    let rough = waves.iter().fold(1.0, |sum, (size, p, q, shift)| {
        sum + size * (p * cos + shift).sin() * (q * y + p * z + 2.0 * shift).cos()
    });
    // Bent about an axis beside it: the long axis becomes an arc.
    let radius = 2.0 * LENGTH / BEND;
    let angle = rough * cos * BEND / 2.0;
    let from_axis = radius + rough * WIDTH * z;
    [
        from_axis * angle.sin(),
        rough * WIDTH * 0.8 * y,
        from_axis * angle.cos() - radius,
    ]
}

/// A number from -1 to 1 for two whole numbers.
fn noise(i: usize, j: usize) -> f64 {
    let x = (12.9898 * i as f64 + 78.233 * j as f64).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

/// Triangles as a binary STL.
pub(crate) fn binary_stl(triangles: &[[Point; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        // Readers use the order of the corners; the normal may be left out.
        bytes.extend([0; 12]);
        for x in triangle.iter().flatten() {
            bytes.extend((*x as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stone_is_closed_looks_outward_and_has_2000_triangles() {
        let triangles = stone();
        assert_eq!(triangles.len(), 2000);
        let key = |p: Point| p.map(|x| (x as f32).to_bits());
        let mut sides = std::collections::BTreeMap::new();
        let mut volume = 0.0;
        for [a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *sides.entry((key(from), key(to))).or_insert(0) += 1;
            }
            let cross = [
                b[1] * c[2] - b[2] * c[1],
                b[2] * c[0] - b[0] * c[2],
                b[0] * c[1] - b[1] * c[0],
            ];
            volume += (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0;
        }
        for ((from, to), count) in &sides {
            assert_eq!((count, sides.get(&(*to, *from))), (&1, Some(&1)));
        }
        let smooth = 4.0 / 3.0 * PI * LENGTH * WIDTH * WIDTH * 0.8;
        assert!((0.7..1.3).contains(&(volume / smooth)), "{volume}");
    }

    #[test]
    fn the_file_has_a_header_a_count_and_50_bytes_for_each_triangle() {
        let bytes = binary_stl(&stone());
        assert_eq!(bytes.len(), 84 + 50 * 2000);
        assert_eq!(bytes[80..84], 2000_u32.to_le_bytes());
    }
}
