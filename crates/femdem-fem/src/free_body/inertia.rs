//! Inertia relief: the body force that balances the loads of a free body.

use crate::element::Element;
use crate::error::{FemError, check};
use crate::model::DeformableModel;
use femdem_mesh::tet::MID_EDGES;
use femdem_mesh::{Matrix3, Vector3};

/// Mass, centre of mass and moment of inertia of a meshed body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inertia {
    pub mass: f64,
    pub centre: Vector3,
    /// Of the moment of inertia about the centre, 1/(kg m^2).
    inverse: Matrix3,
}

impl Inertia {
    /// # Errors
    ///
    /// [`FemError::Parameter`] for a moment of inertia without an inverse.
    pub fn of(model: &DeformableModel) -> Result<Self, FemError> {
        let (mut mass, mut moment) = (0.0, Vector3::zeros());
        for_corners(model, |_, own, corners| {
            mass += own;
            moment += corners.iter().sum::<Vector3>() * (own / 4.0);
        });
        let centre = moment / mass;
        // Integral of r (x) r over a tetrahedron: V/20 (sum r_k (x) r_k + s (x) s), s the sum of its corners r_k.
        let mut second = Matrix3::zeros();
        for_corners(model, |_, own, corners| {
            let r = corners.map(|x| x - centre);
            let sum: Vector3 = r.iter().sum();
            let squares: Matrix3 = r.iter().map(|r| r * r.transpose()).sum();
            second += (squares + sum * sum.transpose()) * (own / 20.0);
        });
        let moment = Matrix3::identity() * second.trace() - second;
        Ok(Self {
            mass,
            centre,
            inverse: inverse(&moment)?,
        })
    }

    /// Adds to nodal forces those of the body force b = -rho (a + alpha x r), with the accelerations a = F/m and
    /// alpha = J^-1 M of the body under the resultants F and M of the forces. The sum then has neither force nor moment.
    /// Gravity is included: it acts on all mass alike, and a is counted from free fall.
    pub fn relieve(&self, model: &DeformableModel, forces: &mut [Vector3]) {
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for (f, x) in forces.iter().zip(model.nodes()) {
            force += f;
            moment += (x - self.centre).cross(f);
        }
        let [linear, angular] = [force / self.mass, self.inverse * moment];
        for_corners(model, |nodes, mass, corners| {
            let b = corners.map(|x| -(linear + angular.cross(&(x - self.centre))) * mass);
            let mut add = |node: usize, f: Vector3| forces[nodes[node] as usize] += f;
            let sum: Vector3 = b.iter().sum();
            // Integrals of N_i b over a tetrahedron, with b linear between its corners.
            if model.element() == Element::T10 {
                for (i, b) in b.iter().enumerate() {
                    // Integral of L_i (2 L_i - 1) L_j: -V/60, and 0 for j = i.
                    add(i, (b - sum) / 60.0);
                }
                for (k, &[i, j]) in MID_EDGES.iter().enumerate() {
                    // Integral of 4 L_i L_j L_k: V/15 at the ends of the edge, V/30 elsewhere.
                    add(4 + k, (sum + b[i] + b[j]) / 30.0);
                }
            } else {
                for (i, b) in b.iter().enumerate() {
                    // Integral of L_i L_j: V/20, and V/10 for j = i.
                    add(i, (sum + b) / 20.0);
                }
            }
        });
    }
}

/// Inverse of a moment of inertia.
///
/// # Errors
///
/// [`FemError::Parameter`] if it has none.
pub(super) fn inverse(moment: &Matrix3) -> Result<Matrix3, FemError> {
    let (name, allowed) = ("determinant of a moment of inertia", "above 0");
    let determinant = moment.determinant();
    check(name, determinant, determinant > 0.0, allowed)?;
    moment.try_inverse().ok_or(FemError::Parameter {
        name,
        value: determinant,
        allowed,
    })
}

/// Calls `f` with nodes, mass and corners of every tetrahedron.
fn for_corners(model: &DeformableModel, mut f: impl FnMut(&[u32], f64, [Vector3; 4])) {
    let elements = model.elements().zip(model.mesh().tets());
    let masses = model.volumes().iter().zip(model.region_of_tet());
    for ((nodes, tet), (volume, &region)) in elements.zip(masses) {
        let density = model.regions()[region as usize].density;
        f(
            nodes,
            volume * density,
            tet.map(|i| model.nodes()[i as usize]),
        );
    }
}
