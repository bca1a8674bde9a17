//! The constant data of a deformable body, and what follows from the positions of its nodes.

mod body;
mod bound;
mod boundary;
mod broken_boundary;
mod build;
mod comparison;
mod coupling;
mod forces;
mod ledger;
#[cfg(feature = "implicit")]
mod linear;
mod loads;
mod nodal;
#[cfg(feature = "parallel")]
mod parallel;
mod scaling;
mod selection;
mod stress;
mod tangent;

pub use body::{DeformableBody, DeformableState};
pub use bound::FrequencyBound;
pub use boundary::Boundary;
pub use forces::{InternalState, Workspace};
pub use ledger::BodyLedger;
pub use loads::Curve;
pub use selection::{NodeSets, Selection};
pub use stress::{ElementStress, von_mises};

use crate::element::{Batch, Element};
use crate::error::FemError;
use crate::material::{AnyMaterial, Material};
use comparison::Comparison;
use femdem_mesh::{Matrix3, TetMesh, Vector3};
use nodal::NodalAverages;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A material and its density.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MaterialRegion {
    /// The law.
    pub material: AnyMaterial,
    /// Density in the reference state, kg/m^3.
    pub density: f64,
}

/// The constant data of a deformable body: reference nodes, elements, materials, lumped masses. Large; share
/// it by `Arc` among bodies of the same shape and material.
///
/// Arrays over nodes (`x`, `v`, forces) must have the length of [`DeformableModel::nodes`], histories that of
/// [`DeformableModel::history_len`]; others are refused.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "build::Parts", into = "build::Parts")]
pub struct DeformableModel {
    mesh: TetMesh,
    element: Element,
    regions: Vec<MaterialRegion>,
    region_of: Vec<u32>,
    nodes: Vec<Vector3>,
    mid_edges: Vec<[u32; 2]>,
    /// Nodes of the elements, one element after the other.
    connectivity: Vec<u32>,
    /// Per element the gradients of the barycentric coordinates of corners 1 to 3, as rows, 1/m.
    inverses: Vec<Matrix3>,
    /// m^3.
    volumes: Vec<f64>,
    masses: Vec<f64>,
    /// For each element its mass with added mass over that without; empty if all are 1.
    mass_factors: Vec<f64>,
    /// Per element t, m/kg, such that omega^2 <= c t for a material of stiffness bound c.
    couplings: Vec<f64>,
    comparison: Comparison,
    /// Weights of the nodes for the comparison.
    weights: Vec<f64>,
    /// Length of the history per integration point.
    history_stride: usize,
    /// Averages, for nodal pressures.
    averages: Option<NodalAverages>,
    /// The batch, if all elements are linear and neo-Hookean.
    batch: Option<Batch>,
    #[cfg(feature = "parallel")]
    incidence: parallel::Incidence,
}

impl DeformableModel {
    /// The model of a mesh with one material per region. `region_of_tet` names the region of every
    /// tetrahedron; without it there must be one region.
    ///
    /// # Errors
    ///
    /// [`FemError`] if there is no region, a density is not positive, a custom law is not bound, or
    /// `region_of_tet` has a length other than the mesh or refers to a region that does not exist.
    pub fn new(
        mesh: &TetMesh,
        element: Element,
        regions: Vec<MaterialRegion>,
        region_of_tet: Option<Vec<u32>>,
    ) -> Result<Self, FemError> {
        if let Some(name) = regions.iter().find_map(|r| r.material.unbound()) {
            return Err(FemError::UnboundMaterial {
                name: name.to_owned(),
                given: "none".to_owned(),
            });
        }
        build::Parts::new(mesh, element, regions, region_of_tet)?.build()
    }

    /// The kind of the elements.
    #[must_use]
    pub fn element(&self) -> Element {
        self.element
    }

    /// The mesh of the corners, in the reference state.
    #[must_use]
    pub fn mesh(&self) -> &TetMesh {
        &self.mesh
    }

    /// Reference positions of the nodes, m: the mesh's points, then the middles of its edges where
    /// the element has nodes there.
    #[must_use]
    pub fn nodes(&self) -> &[Vector3] {
        &self.nodes
    }

    /// The ends of the edge whose middle is node `points + k`; empty for linear elements.
    #[must_use]
    pub fn mid_edges(&self) -> &[[u32; 2]] {
        &self.mid_edges
    }

    /// The nodes of the elements, in the order of the mesh's tetrahedra.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.connectivity.chunks_exact(self.element.node_count())
    }

    /// Lumped masses of the nodes, kg, added mass included.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Mass that scaling has added, kg.
    #[must_use]
    pub fn added_mass(&self) -> f64 {
        let added = |(e, factor): (usize, &f64)| {
            (factor - 1.0) * self.volumes[e] * self.regions[self.region_of[e] as usize].density
        };
        // An empty sum is -0.
        0.0 + self.mass_factors.iter().enumerate().map(added).sum::<f64>()
    }

    /// The materials.
    #[must_use]
    pub fn regions(&self) -> &[MaterialRegion] {
        &self.regions
    }

    /// The region of every element.
    #[must_use]
    pub fn region_of_tet(&self) -> &[u32] {
        &self.region_of
    }

    /// Volume of every element in the reference state, m^3.
    #[must_use]
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// Length of the history of a body of this model; all zero is the virgin state.
    #[must_use]
    pub fn history_len(&self) -> usize {
        self.volumes.len() * self.element.point_count() * self.history_stride
    }

    /// Binds custom laws that are known by name alone (after a file was read) to their law among `laws`.
    ///
    /// # Errors
    ///
    /// [`FemError::UnboundMaterial`] if one is not among them.
    pub fn bind(&mut self, laws: &[Arc<dyn crate::material::Material>]) -> Result<(), FemError> {
        for region in &mut self.regions {
            region.material.bind(laws)?;
        }
        self.history_stride = build::history_stride(&self.regions);
        // Bounds of the step and weights of the nodes follow the laws' moduli.
        self.lump();
        Ok(())
    }

    /// The law of an element.
    fn material(&self, element: usize) -> &AnyMaterial {
        &self.regions[self.region_of[element] as usize].material
    }

    /// The history of point `q` of an element.
    fn history_at(&self, element: usize, q: usize) -> std::ops::Range<usize> {
        let point = element * self.element.point_count() + q;
        let start = point * self.history_stride;
        start..start + self.material(element).history_len()
    }
}
