//! A closed surface like that of a scanned stone, made by rule.

use femdem_mesh::Point3;
use std::collections::BTreeMap;

/// Points and triangles of an octahedron whose triangles are cut in four `levels` times, drawn to
/// a bumpy sphere of about 1 m with noise of some mm: 8 x 4^levels triangles.
pub fn stone(levels: usize) -> (Vec<Point3>, Vec<[u32; 3]>) {
    let mut points: Vec<Point3> = [
        [1, 0, 0],
        [0, 1, 0],
        [-1, 0, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
    ]
    .map(|c| c.map(f64::from).into())
    .to_vec();
    let mut triangles: Vec<[u32; 3]> = (0..4)
        .flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]])
        .collect();
    for _ in 0..levels {
        let mut middles = BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                    let sum = points[i as usize].coords + points[j as usize].coords;
                    points.push(sum.normalize().into());
                    points.len() as u32 - 1
                })
            };
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = finer;
    }
    let mut state = 1_u32;
    for p in &mut points {
        let [x, y, z] = [p.x, p.y, p.z];
        let bumps =
            0.12 * (3.0 * x + 1.0).sin() * (2.5 * y).cos() + 0.08 * (4.0 * z + 2.0 * x).sin();
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = 0.004 * (f64::from(state >> 8) / f64::from(1 << 24) - 0.5);
        *p *= 0.5 * (1.0 + bumps + noise);
    }
    (points, triangles)
}

/// The bytes of a binary STL file of triangles.
pub fn binary_stl(points: &[Point3], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut file = vec![0; 80];
    file.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        file.extend([0; 12]);
        for p in triangle.map(|i| points[i as usize]) {
            file.extend(
                [p.x, p.y, p.z]
                    .iter()
                    .flat_map(|&x| (x as f32).to_le_bytes()),
            );
        }
        file.extend([0; 2]);
    }
    file
}
