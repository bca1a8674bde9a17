//! From polygons given by the positions of their corners to a checked surface.

use crate::{MeshError, Point3, Polyhedron};

/// Corners nearer than this part of the unit size are the same vertex.
const SAME: f64 = 1e-9;

/// The surface of polygons given by the positions of their corners, which agree within rounding where polygons
/// meet.
pub(super) fn surface(polygons: &[Vec<Point3>]) -> Result<Polyhedron, MeshError> {
    let corners: Vec<Point3> = polygons.iter().flatten().copied().collect();
    let mut order: Vec<usize> = (0..corners.len()).collect();
    order.sort_by(|&i, &j| corners[i].x.total_cmp(&corners[j].x).then(i.cmp(&j)));

    // Each corner is identified with the first one at its position, in the order of the polygons.
    let mut first: Vec<usize> = (0..corners.len()).collect();
    for (n, &i) in order.iter().enumerate() {
        for &j in order.iter().skip(n + 1) {
            if corners[j].x - corners[i].x > SAME {
                break;
            }
            if (corners[j] - corners[i]).amax() <= SAME {
                let low = first[i].min(first[j]);
                first[i] = low;
                first[j] = low;
            }
        }
    }
    let mut index = vec![0_u32; corners.len()];
    let mut vertices = Vec::new();
    for i in 0..corners.len() {
        if first[i] == i {
            index[i] = vertices.len() as u32;
            vertices.push(corners[i]);
        } else {
            index[i] = index[first[i]];
        }
    }
    let mut next = 0;
    let mut faces = Vec::with_capacity(polygons.len());
    for polygon in polygons {
        faces.push(index[next..next + polygon.len()].to_vec());
        next += polygon.len();
    }
    Polyhedron::new(vertices, faces)
}

/// The body moved so that its centroid is the origin.
pub(super) fn centred(body: &Polyhedron) -> Result<Polyhedron, MeshError> {
    let centroid = body.mass_properties().centroid.coords;
    let vertices = body.vertices().iter().map(|v| v - centroid).collect();
    Polyhedron::new(vertices, body.faces().map(<[u32]>::to_vec).collect())
}
