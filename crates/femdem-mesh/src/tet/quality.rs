//! Shape measures of tetrahedra.

use super::{EDGES, FACES, six_volumes};
use crate::{Point3, Vector3};

/// Shape measures of the tetrahedra of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Smallest radius ratio: 3 times the inscribed over the circumscribed radius, 1 for the
    /// regular tetrahedron, 0 for a flat one.
    pub min_radius_ratio: f64,
    /// Mean radius ratio.
    pub mean_radius_ratio: f64,
    /// Smallest dihedral angle \[rad\].
    pub min_dihedral: f64,
    /// Largest dihedral angle \[rad\].
    pub max_dihedral: f64,
    /// Smallest height of a point over the opposite triangle \[m\]; it limits the time step of explicit
    /// dynamics.
    pub smallest_height: f64,
}

impl Quality {
    /// The worst and mean shapes of some tetrahedra.
    pub(crate) fn of(tets: impl Iterator<Item = [Point3; 4]>) -> Self {
        let mut count = 0.0;
        let mut quality = Self {
            min_radius_ratio: f64::INFINITY,
            mean_radius_ratio: 0.0,
            min_dihedral: f64::INFINITY,
            max_dihedral: 0.0,
            smallest_height: f64::INFINITY,
        };
        for tet in tets {
            let ratio = radius_ratio(tet);
            let [low, high] = dihedral_range(tet);
            count += 1.0;
            quality.min_radius_ratio = quality.min_radius_ratio.min(ratio);
            quality.mean_radius_ratio += ratio;
            quality.min_dihedral = quality.min_dihedral.min(low);
            quality.max_dihedral = quality.max_dihedral.max(high);
            quality.smallest_height = quality.smallest_height.min(smallest_height(tet));
        }
        quality.mean_radius_ratio /= count;
        quality
    }
}

/// Outward area vectors of the four triangles, opposite points 0 to 3 \[m^2\].
fn area_vectors(tet: [Point3; 4]) -> [Vector3; 4] {
    FACES.map(|[i, j, k]| 0.5 * (tet[j] - tet[i]).cross(&(tet[k] - tet[i])))
}

/// Three times the inscribed over the circumscribed radius; negative if inverted.
pub(crate) fn radius_ratio(tet: [Point3; 4]) -> f64 {
    let volume = six_volumes(tet) / 6.0;
    let area: f64 = area_vectors(tet).iter().map(Vector3::norm).sum();
    let [a, b, c] = [1, 2, 3].map(|i| tet[i] - tet[0]);
    let numerator = a.norm_squared() * b.cross(&c)
        + b.norm_squared() * c.cross(&a)
        + c.norm_squared() * a.cross(&b);
    let product = area * numerator.norm();
    // r = 3 V / A and R = |numerator| / (12 V).
    if product > 0.0 {
        108.0 * volume * volume.abs() / product
    } else {
        0.0
    }
}

/// Smallest and largest dihedral angle \[rad\]; meaningless for an inverted tetrahedron.
pub(crate) fn dihedral_range(tet: [Point3; 4]) -> [f64; 2] {
    let normals = area_vectors(tet);
    let mut range = [f64::INFINITY, 0.0_f64];
    for [i, j] in EDGES {
        let (a, b) = (normals[i], normals[j]);
        let angle = a.cross(&b).norm().atan2(-a.dot(&b));
        range = [range[0].min(angle), range[1].max(angle)];
    }
    range
}

/// Smallest height of a point over the opposite triangle \[m\].
pub(crate) fn smallest_height(tet: [Point3; 4]) -> f64 {
    let largest = area_vectors(tet)
        .iter()
        .map(Vector3::norm)
        .fold(0.0, f64::max);
    0.5 * six_volumes(tet) / largest
}
