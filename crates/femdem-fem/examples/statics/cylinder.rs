//! A quarter of a cylinder, of prisms.

use femdem_mesh::{MeshError, Point3, TetMesh};
use std::f64::consts::FRAC_PI_2;

/// The quarter x, y >= 0 of a cylinder on the plane z = 0: `rings` of triangles about the axis, and
/// `layers` of prisms, each of three tetrahedra.
pub fn quarter_cylinder(
    radius: f64,
    length: f64,
    rings: u32,
    layers: u32,
) -> Result<TetMesh, MeshError> {
    let first = |ring: u32| ring * (ring + 1) / 2;
    let per_layer = first(rings + 1);
    let mut points = Vec::new();
    for layer in 0..=layers {
        let z = length * f64::from(layer) / f64::from(layers);
        for ring in 0..=rings {
            let r = radius * f64::from(ring) / f64::from(rings);
            for k in 0..=ring {
                points.push(on_ring(r, k, ring, z));
            }
        }
    }
    let mut tets = Vec::new();
    for layer in 0..layers {
        for ring in 0..rings {
            for k in 0..=ring {
                let (inner, outer) = (first(ring) + k, first(ring + 1) + k);
                prism(
                    &mut tets,
                    [inner, outer, outer + 1],
                    layer * per_layer,
                    per_layer,
                );
                if k < ring {
                    prism(
                        &mut tets,
                        [inner, inner + 1, outer + 1],
                        layer * per_layer,
                        per_layer,
                    );
                }
            }
        }
    }
    for tet in &mut tets {
        let [a, b, c, d] = tet.map(|i| points[i as usize]);
        if (b - a).dot(&(c - a).cross(&(d - a))) < 0.0 {
            tet.swap(2, 3);
        }
    }
    TetMesh::new(points, tets)
}

fn on_ring(r: f64, k: u32, ring: u32, z: f64) -> Point3 {
    // Exact on the planes of symmetry.
    if k == 0 {
        Point3::new(r, 0.0, z)
    } else if k == ring {
        Point3::new(0.0, r, z)
    } else {
        let angle = FRAC_PI_2 * f64::from(k) / f64::from(ring);
        Point3::new(r * angle.cos(), r * angle.sin(), z)
    }
}

/// Splits a prism along diagonals that rise towards the higher index, the same on either side of a face.
fn prism(tets: &mut Vec<[u32; 4]>, triangle: [u32; 3], offset: u32, per_layer: u32) {
    let [a, b, c] = triangle.map(|i| i + offset);
    let [d, e, f] = [a, b, c].map(|i| i + per_layer);
    tets.extend([[a, b, c, f], [a, b, e, f], [a, d, e, f]]);
}
