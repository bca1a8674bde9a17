use crate::{Matrix3, Point3, Rotation, Vector3};
use nalgebra::{Rotation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// Moments that differ by less than this, relative to the largest, count as equal.
const ISOTROPY_TOLERANCE: f64 = 1e-9;
/// Products of inertia below this, relative to the largest moment, count as zero.
const DIAGONAL_TOLERANCE: f64 = 1e-12;

/// Volume, centroid and inertia of a body of unit density (1 kg/m^3).
///
/// Multiply `volume` and `inertia` by a density to get the mass \[kg\] and the inertia \[kg m^2\].
///
/// ```
/// use femdem_mesh::catalogue::CatalogueShape;
///
/// // A cube of side 2 m: I = m (a^2 + a^2)/12 about every axis.
/// let cube = "P5".parse::<CatalogueShape>()?.polyhedron(2.0 * 3_f64.sqrt())?;
/// let mass = cube.mass_properties();
/// assert!((mass.volume - 8.0).abs() < 1e-12);
/// let density = 2650.0;
/// let moment = density * mass.inertia[(0, 0)];
/// assert!((moment / (density * 8.0 * 8.0 / 12.0) - 1.0).abs() < 1e-12);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MassProperties {
    /// Volume \[m^3\].
    pub volume: f64,
    /// Centroid, in the coordinates of the vertices \[m\].
    pub centroid: Point3,
    /// Inertia tensor about the centroid for unit density \[m^5\].
    pub inertia: Matrix3,
}

/// Principal axes and moments of inertia.
///
/// ```
/// use femdem_mesh::shapes::Shape;
///
/// // The long axis of a brick of 4 x 2 x 1 has the smallest moment.
/// let brick = "box:width=0.5,height=0.25".parse::<Shape>()?.polyhedron(4.0)?;
/// let frame = brick.mass_properties().principal();
/// let expected = brick.mass_properties().volume * (2.0_f64.powi(2) + 1.0) / 12.0;
/// assert!((frame.moments.min() / expected - 1.0).abs() < 1e-12);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrincipalFrame {
    /// Transforms vectors from principal axes to body axes: `inertia = R diag(moments) R^T`.
    pub rotation: Rotation,
    /// Moments about the three principal axes for unit density \[m^5\], ascending; if `rotation` is the
    /// identity, the diagonal of the inertia tensor in its order.
    pub moments: Vector3,
}

impl MassProperties {
    /// Integrates over the closed triangulated surface, by the divergence theorem.
    ///
    /// Each triangle spans a signed tetrahedron with an apex inside the body; the integrals of 1,
    /// x and x x^T over a tetrahedron are polynomials of its corners (F. Tonon, J. Math. Stat. 1
    /// (2005) 8-11). The apex is the mean of the vertices, not the origin: a body far from the
    /// origin keeps its digits.
    pub(crate) fn of_surface(
        vertices: &[Point3],
        triangles: impl Iterator<Item = [u32; 3]>,
    ) -> Self {
        let first = vertices.first().copied().unwrap_or_default();
        let mean = vertices.iter().map(|v| v - first).sum::<Vector3>() / vertices.len() as f64;
        let apex = first + mean;

        let mut volume = 0.0;
        let mut first_moment = Vector3::zeros();
        let mut second_moment = Matrix3::zeros();
        for [a, b, c] in triangles {
            let [a, b, c] = [a, b, c].map(|i| vertices[i as usize] - apex);
            let tetrahedron = a.dot(&b.cross(&c)) / 6.0;
            let sum = a + b + c;
            volume += tetrahedron;
            first_moment += tetrahedron / 4.0 * sum;
            second_moment += tetrahedron / 20.0
                * (a * a.transpose()
                    + b * b.transpose()
                    + c * c.transpose()
                    + sum * sum.transpose());
        }
        let centroid = first_moment / volume;
        let central = second_moment - volume * centroid * centroid.transpose();
        let inertia = Matrix3::identity() * central.trace() - central;
        Self {
            volume,
            centroid: apex + centroid,
            inertia: (inertia + inertia.transpose()) * 0.5,
        }
    }

    /// Principal axes and moments.
    ///
    /// The rotation is the identity where the inertia is isotropic to 1e-9 or diagonal to 1e-12. Otherwise
    /// moments ascend, the frame is right-handed, and the largest component of each of the first two axes is
    /// positive, so that the result depends on the tensor alone. An inertia that is not finite gives the
    /// identity.
    pub fn principal(&self) -> PrincipalFrame {
        let diagonal = self.inertia.diagonal();
        let aligned = PrincipalFrame {
            rotation: Rotation::identity(),
            moments: diagonal,
        };
        let scale = self.inertia.amax();
        let mean = Matrix3::identity() * (self.inertia.trace() / 3.0);
        let isotropic = (self.inertia - mean).amax() <= ISOTROPY_TOLERANCE * scale;
        let products = self.inertia - Matrix3::from_diagonal(&diagonal);
        let finite = self.inertia.iter().all(|x| x.is_finite());
        if !finite || isotropic || products.amax() <= DIAGONAL_TOLERANCE * scale {
            return aligned;
        }

        // The eigenvalue iteration uses absolute thresholds: scale to numbers near 1.
        let eigen = (self.inertia / scale).symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        let axis = |k: usize| {
            let axis: Vector3 = eigen.eigenvectors.column(order[k]).into_owned();
            axis * axis[axis.iamax()].signum()
        };
        let (x, y) = (axis(0), axis(1));
        let basis = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        PrincipalFrame {
            rotation: UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(
                basis,
            )),
            moments: Vector3::from_fn(|k, _| eigen.eigenvalues[order[k]] * scale),
        }
    }
}

#[cfg(test)]
mod tests;
