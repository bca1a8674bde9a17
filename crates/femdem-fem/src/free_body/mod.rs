//! Stresses in a free body under given forces: a linear static solve on a factorisation that is made once per shape.
//!
//! **Use it** for the stresses inside the bodies of a rigid simulation, from the forces of their contacts: milliseconds a body.
//! **Do not use it** where the deformation changes the loads (relax the whole world instead), at large strain, or for
//! materials that yield: the stiffness is that at rest.
//!
//! ```
//! use femdem_fem::element::Element;
//! use femdem_fem::free_body::{FreeBody, PatchLoad};
//! use femdem_fem::material::NeoHookean;
//! use femdem_fem::mesh::{Point3, TetMesh, Vector3};
//! use femdem_fem::{DeformableModel, MaterialRegion};
//! use std::sync::Arc;
//!
//! // A cube of 10 mm, squeezed by 100 N on discs of 20 mm² in the middles of two faces.
//! let mesh = TetMesh::block([4, 4, 4], &Vector3::repeat(0.01))?;
//! let stone = MaterialRegion { material: NeoHookean::new(60e9, 0.22)?.into(), density: 2650.0 };
//! let body = FreeBody::new(Arc::new(DeformableModel::new(&mesh, Element::T10, vec![stone], None)?))?;
//! let press = |z: f64, force: f64| PatchLoad {
//!     point: Point3::new(0.005, 0.005, z),
//!     normal: Vector3::z(),
//!     area: 20e-6,
//!     force: Vector3::z() * force,
//!     moment: Vector3::zeros(),
//! };
//! let loads = [press(0.0, 100.0), press(0.01, -100.0)];
//! let solved = body.solve_patches(&loads)?;
//! // Love-Weber: -F h / V along z.
//! assert!((solved.mean()[(2, 2)] + 1e6).abs() < 1.0);
//! let peaks = body.peaks(&solved, &loads);
//! assert!(peaks.tension.is_some_and(|tension| tension < body.splitting_estimate(100.0)));
//! # Ok::<(), femdem_fem::FemError>(())
//! ```
//!
//! # How
//!
//! - **Loads** are nodal forces, or [`PatchLoad`]s, spread over discs such that force and moment are kept.
//! - **Inertia relief**: the body force -rho (a + alpha x r) of the accelerations under all loads balances them. Gravity
//!   needs no number: it acts on all mass alike, and is in the balance already.
//! - **Rigid motion**: the stiffness K of a free body is singular. Six components at three nodes are held. As the loads are
//!   balanced, the six reactions vanish, so that the stresses are those of the free body, whichever nodes are held; the solver
//!   checks it. The rigid part of the displacement is then removed.
//! - **Stresses** are those of the integration points. A node's stress is the mean over its elements, weighted by volume, of the
//!   linear functions through their points: exact for uniform stress, of second order otherwise.
//!
//! # Accuracy
//!
//! The mean stress is that of the nodal forces (Love-Weber) to rounding. Under a contact the stress is that of a disc with uniform
//! pressure, as far as the mesh resolves it: with elements longer than the disc's radius the peak is that of an element's
//! length, and grows as the mesh gets finer. Away from contacts stresses converge (Saint-Venant), and these are what
//! [`Peaks::tension`] takes.

mod inertia;
mod patch;
mod peaks;
mod place;
mod solved;
mod support;

use crate::error::{FemError, check};
use crate::material::Tangent;
use crate::model::{DeformableModel, DeformableState};
use crate::statics::{BodyProblem, Factor, LowerTriangle};
use femdem_mesh::{Matrix3, Vector3};
use inertia::Inertia;
use place::Places;
use std::sync::Arc;

pub use patch::PatchLoad;
pub use peaks::{Peaks, SPLITTING};
pub use solved::Solved;

/// Largest force left over, relative to the norm of the loads: more means a body that is numerically a mechanism.
const WORST_BALANCE: f64 = 1e-6;

/// A free elastic body with its factorised stiffness; share it among bodies of the same shape and material.
#[derive(Debug)]
pub struct FreeBody {
    model: Arc<DeformableModel>,
    laws: Vec<Tangent>,
    inertia: Inertia,
    factor: Factor,
    /// Unknowns that are held.
    held: Vec<usize>,
    places: Places,
    /// Nodes of each element.
    connectivity: Vec<u32>,
    /// Mean length of the mesh's edges, m.
    edge: f64,
    inscribed: f64,
}

impl FreeBody {
    /// Factorises the stiffness of a model at rest, for its elements [`Element::T4`](crate::element::Element::T4) or
    /// [`Element::T10`](crate::element::Element::T10).
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] for other elements, [`FemError::Element`] for a law without a tangent, and
    /// [`FemError::Factorisation`] if memory does not suffice, or the stiffness is not positive definite, as of a mesh in
    /// pieces.
    pub fn new(model: Arc<DeformableModel>) -> Result<Self, FemError> {
        let supports = support::nodes(&model);
        Self::with_supports(model, supports)
    }

    fn with_supports(model: Arc<DeformableModel>, supports: [u32; 3]) -> Result<Self, FemError> {
        let laws = model.stiffness_at_rest()?;
        let boundary = support::hold(&model, supports)?;
        let state = DeformableState::reference(&model);
        let mut matrix = LowerTriangle::default();
        let x: Vec<f64> = state.x.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
        matrix.assemble(&mut BodyProblem::new(&model, &boundary, &state)?, &x)?;
        let mut factor = Factor::of_pattern(&matrix)?;
        let mut memory = factor.memory()?;
        if !factor.factorise(&matrix, &mut memory) {
            return Err(FemError::Factorisation {
                unknowns: x.len(),
                why: "it is not positive definite: the body is in pieces, or its elements are far too slender".to_owned(),
            });
        }
        let places = Places::new(model.mesh());
        let inscribed = places.inscribed_diameter();
        check(
            "diameter of the largest ball in a body",
            inscribed,
            inscribed > 0.0,
            "above 0",
        )?;
        Ok(Self {
            laws,
            inertia: Inertia::of(&model)?,
            factor,
            held: boundary
                .held()
                .map(|(node, k)| 3 * node as usize + k)
                .collect(),
            inscribed,
            places,
            connectivity: model.elements().flatten().copied().collect(),
            edge: mean_edge(&model),
            model,
        })
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Arc<DeformableModel> {
        &self.model
    }

    /// Centre of mass, m.
    #[must_use]
    pub fn centre(&self) -> Vector3 {
        self.inertia.centre
    }

    /// Diameter of the largest ball inside, m.
    #[must_use]
    pub fn inscribed_diameter(&self) -> f64 {
        self.inscribed
    }

    /// Displacements and stresses under nodal forces (N), which inertia balances.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] for another length than the model's nodes and for forces that are not finite, and
    /// [`FemError::NotConverged`] if rounding spoils the solution.
    pub fn solve(&self, forces: &[Vector3]) -> Result<Solved, FemError> {
        self.check_length(forces.len())?;
        let scale = forces.iter().map(Vector3::norm_squared).sum::<f64>().sqrt();
        check("norm of the nodal forces", scale, true, "finite")?;
        let mut balanced = forces.to_vec();
        self.inertia.relieve(&self.model, &mut balanced);
        let mut u: Vec<f64> = balanced.iter().flat_map(|f| [f.x, f.y, f.z]).collect();
        for &unknown in &self.held {
            u[unknown] = 0.0;
        }
        let mut memory = self.factor.memory_to_solve()?;
        self.factor.solve(&mut u, &mut memory);
        let (triples, _) = u.as_chunks::<3>();
        let mut displacements: Vec<Vector3> = triples.iter().map(|u| Vector3::from(*u)).collect();
        self.take_rigid_motion(&mut displacements)?;
        let points = self
            .model
            .small_stresses(&self.laws, &displacements, &mut balanced);
        // What is left of the forces, those on the supports included.
        let rest = balanced
            .iter()
            .map(Vector3::norm_squared)
            .sum::<f64>()
            .sqrt();
        let residual = if rest == 0.0 { 0.0 } else { rest / scale };
        if residual <= WORST_BALANCE {
            return Ok(Solved::new(&self.model, displacements, points, residual));
        }
        Err(FemError::NotConverged {
            method: "the static solve of a free body",
            iterations: 1,
            residual,
            tolerance: WORST_BALANCE,
            advice: "its mesh has elements that are far too slender: give another mesh size"
                .to_owned(),
        })
    }

    /// [`solve`](Self::solve) with the forces of patches.
    ///
    /// # Errors
    ///
    /// As [`add_patch`](Self::add_patch) and [`solve`](Self::solve).
    pub fn solve_patches(&self, loads: &[PatchLoad]) -> Result<Solved, FemError> {
        let mut forces = vec![Vector3::zeros(); self.model.nodes().len()];
        for load in loads {
            self.add_patch(load, &mut forces)?;
        }
        self.solve(&forces)
    }

    /// Takes the mean translation and rotation, weighted by the nodes' masses, from displacements.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] for masses on a line.
    fn take_rigid_motion(&self, u: &mut [Vector3]) -> Result<(), FemError> {
        let (nodes, masses) = (self.model.nodes(), self.model.masses());
        let total: f64 = masses.iter().sum();
        let mean = |of: &[Vector3]| -> Vector3 {
            of.iter().zip(masses).map(|(x, m)| x * *m).sum::<Vector3>() / total
        };
        let (centre, shift) = (mean(nodes), mean(u));
        let mut moment = Vector3::zeros();
        let mut inertia = Matrix3::zeros();
        for ((x, u), m) in nodes.iter().zip(&*u).zip(masses) {
            let r = x - centre;
            moment += r.cross(&(u - shift)) * *m;
            inertia += (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * *m;
        }
        let turn = inertia::inverse(&inertia)? * moment;
        for (x, u) in nodes.iter().zip(u) {
            *u -= shift + turn.cross(&(x - centre));
        }
        Ok(())
    }

    fn check_length(&self, length: usize) -> Result<(), FemError> {
        let count = self.model.nodes().len();
        check(
            "number of nodal forces",
            length as f64,
            length == count,
            "the number of nodes",
        )
    }

    fn nodes_of(&self, tet: usize) -> &[u32] {
        let count = self.model.element().node_count();
        &self.connectivity[tet * count..(tet + 1) * count]
    }
}

/// Mean length of the edges of the tetrahedra, each counted once per tetrahedron, m.
fn mean_edge(model: &DeformableModel) -> f64 {
    let corner = |i: u32| model.nodes()[i as usize];
    let tets = model.mesh().tets();
    let lengths = tets.iter().flat_map(|tet| {
        femdem_mesh::tet::MID_EDGES.map(|[i, j]| (corner(tet[i]) - corner(tet[j])).norm())
    });
    lengths.sum::<f64>() / (6 * tets.len()) as f64
}

#[cfg(test)]
mod tests;
