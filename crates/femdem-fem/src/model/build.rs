//! Building a model.

use super::comparison::Comparison;
use super::nodal::NodalAverages;
use super::{DeformableModel, MaterialRegion};
use crate::element::{Batch, BatchElement, Element};
use crate::error::{FemError, check};
use crate::material::{AnyMaterial, Material};
use femdem_mesh::tet::QuadraticMesh;
use femdem_mesh::{Matrix3, TetMesh, Vector3};
use serde::{Deserialize, Serialize};

/// The data that a model is built from and stored as.
#[derive(Serialize, Deserialize)]
#[serde(rename = "DeformableModel", deny_unknown_fields)]
pub(super) struct Parts {
    mesh: TetMesh,
    element: Element,
    regions: Vec<MaterialRegion>,
    region_of: Vec<u32>,
    mass_factors: Vec<f64>,
}

impl TryFrom<Parts> for DeformableModel {
    type Error = FemError;

    fn try_from(parts: Parts) -> Result<Self, FemError> {
        parts.check()?.build()
    }
}

impl From<DeformableModel> for Parts {
    fn from(model: DeformableModel) -> Self {
        Self {
            mesh: model.mesh,
            element: model.element,
            regions: model.regions,
            region_of: model.region_of,
            mass_factors: model.mass_factors,
        }
    }
}

impl Parts {
    pub fn new(
        mesh: &TetMesh,
        element: Element,
        regions: Vec<MaterialRegion>,
        region_of: Option<Vec<u32>>,
    ) -> Result<Self, FemError> {
        let count = mesh.tets().len();
        if region_of.is_none() {
            check(
                "number of regions",
                regions.len() as f64,
                regions.len() == 1,
                "1 if the region of every tetrahedron is not given",
            )?;
        }
        let parts = Self {
            mesh: mesh.clone(),
            element,
            regions,
            region_of: region_of.unwrap_or_else(|| vec![0; count]),
            mass_factors: Vec::new(),
        };
        parts.check()
    }

    fn check(self) -> Result<Self, FemError> {
        for region in &self.regions {
            check(
                "density",
                region.density,
                region.density > 0.0,
                "positive and finite, in kg/m^3",
            )?;
        }
        let count = self.mesh.tets().len();
        check(
            "length of region_of_tet",
            self.region_of.len() as f64,
            self.region_of.len() == count,
            "the number of tetrahedra",
        )?;
        let regions = self.regions.len();
        if let Some(&index) = self.region_of.iter().find(|&&r| r as usize >= regions) {
            return Err(FemError::NoSuch {
                what: "region",
                index: index as usize,
                count: regions,
            });
        }
        let factors = &self.mass_factors;
        check(
            "number of mass factors",
            factors.len() as f64,
            factors.is_empty() || factors.len() == count,
            "none or the number of tetrahedra",
        )?;
        for &factor in factors {
            check("mass factor", factor, factor >= 1.0, "1 or more")?;
        }
        Ok(self)
    }

    /// The model of checked parts.
    pub fn build(self) -> Result<DeformableModel, FemError> {
        let (nodes, mid_edges, connectivity) = numbered(&self.mesh, self.element)?;
        let corners = |tet: &[u32; 4]| tet.map(|i| nodes[i as usize]);
        let mut inverses = Vec::with_capacity(self.mesh.tets().len());
        let mut volumes = Vec::with_capacity(self.mesh.tets().len());
        for tet in self.mesh.tets() {
            let [a, b, c, d] = corners(tet);
            let edges = Matrix3::from_columns(&[b - a, c - a, d - a]);
            // A checked mesh has no flat tetrahedron.
            inverses.push(edges.try_inverse().unwrap_or_else(Matrix3::zeros));
            volumes.push(edges.determinant() / 6.0);
        }
        let averages = (self.element == Element::T4NodalPressure)
            .then(|| NodalAverages::new(self.mesh.tets(), &self.region_of, &volumes));
        let mut model = DeformableModel {
            history_stride: history_stride(&self.regions),
            mesh: self.mesh,
            element: self.element,
            regions: self.regions,
            region_of: self.region_of,
            masses: vec![0.0; nodes.len()],
            nodes,
            mid_edges,
            connectivity,
            inverses,
            volumes,
            mass_factors: self.mass_factors,
            couplings: Vec::new(),
            comparison: Comparison::default(),
            weights: Vec::new(),
            averages,
            batch: None,
            #[cfg(feature = "parallel")]
            incidence: super::parallel::Incidence::default(),
        };
        model.lump();
        model.check_mass()?;
        model.batch = model.batched();
        Ok(model)
    }
}

/// Nodes, ends of the edges with nodes, and the nodes of the elements.
type Numbered = (Vec<Vector3>, Vec<[u32; 2]>, Vec<u32>);

fn numbered(mesh: &TetMesh, element: Element) -> Result<Numbered, FemError> {
    if element.is_quadratic() {
        let quadratic = QuadraticMesh::new(mesh)?;
        let nodes = quadratic.nodes().iter().map(|p| p.coords).collect();
        let connectivity = quadratic.elements().as_flattened().to_vec();
        return Ok((nodes, quadratic.mid_edges().to_vec(), connectivity));
    }
    let nodes = mesh.points().iter().map(|p| p.coords).collect();
    Ok((nodes, Vec::new(), mesh.tets().as_flattened().to_vec()))
}

pub(super) fn history_stride(regions: &[MaterialRegion]) -> usize {
    let lengths = regions.iter().map(|r| r.material.history_len());
    lengths.max().unwrap_or(0)
}

impl DeformableModel {
    /// The model of the same body after cracks have split some of its nodes: `mesh` has the same tetrahedra in the same order,
    /// at the same places, with other numbers of the nodes, as from
    /// [`CrackedMesh::mesh`](femdem_mesh::tet::CrackedMesh::mesh). Histories stay valid.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] for another number of tetrahedra, and for elements other than [`Element::T4`]: the others have
    /// nodes on edges, or averages over the elements around a node.
    pub fn cracked(&self, mesh: TetMesh) -> Result<Self, FemError> {
        self.check_linear()?;
        let count = mesh.tets().len();
        check(
            "number of tetrahedra",
            count as f64,
            count == self.volumes.len(),
            "that of the body without cracks",
        )?;
        Parts {
            mesh,
            element: self.element,
            regions: self.regions.clone(),
            region_of: self.region_of.clone(),
            mass_factors: self.mass_factors.clone(),
        }
        .build()
    }

    /// The model of some of the tetrahedra of a body, such as a part that has broken off: `mesh` has the tetrahedra `tets` of this one's
    /// mesh in that order. [`part_of_history`](Self::part_of_history) gives it the histories that it had.
    ///
    /// # Errors
    ///
    /// As [`cracked`](Self::cracked), and [`FemError::NoSuch`] for a number that is no tetrahedron.
    pub fn part(&self, tets: &[u32], mesh: TetMesh) -> Result<Self, FemError> {
        self.check_linear()?;
        let (found, count) = (mesh.tets().len(), tets.len());
        check(
            "number of tetrahedra",
            found as f64,
            found == count,
            "that of the part",
        )?;
        let known = self.volumes.len();
        if let Some(t) = tets.iter().find(|t| **t as usize >= known) {
            return Err(FemError::NoSuch {
                what: "tetrahedron",
                index: *t as usize,
                count: known,
            });
        }
        let of = |t: &u32| self.region_of[*t as usize];
        let factor = |t: &u32| self.mass_factors.get(*t as usize).copied();
        Parts {
            mesh,
            element: self.element,
            regions: self.regions.clone(),
            region_of: tets.iter().map(of).collect(),
            mass_factors: tets.iter().filter_map(factor).collect(),
        }
        .build()
    }

    /// What belongs to some linear tetrahedra in a history of a body of this model. Numbers that are no tetrahedra are left out.
    #[must_use]
    pub fn part_of_history(&self, history: &[f64], tets: &[u32]) -> Vec<f64> {
        let stride = self.history_stride;
        let of = |t: &u32| history.get(*t as usize * stride..(*t as usize + 1) * stride);
        tets.iter().filter_map(of).flatten().copied().collect()
    }

    /// Refuses elements that are not linear.
    fn check_linear(&self) -> Result<(), FemError> {
        check(
            "nodes of an element of a cracked body",
            self.element.node_count() as f64,
            self.element == Element::T4,
            "4, of T4",
        )
    }

    /// Refuses masses that overflow.
    pub(super) fn check_mass(&self) -> Result<(), FemError> {
        let mass: f64 = self.masses.iter().sum();
        check(
            "mass of the body",
            mass,
            mass > 0.0,
            "positive and finite, in kg",
        )
    }

    /// Density of an element, added mass included, kg/m^3.
    pub(super) fn density(&self, element: usize) -> f64 {
        let factor = self.mass_factors.get(element).copied().unwrap_or(1.0);
        self.regions[self.region_of[element] as usize].density * factor
    }

    /// The elements in blocks, if all are linear and neo-Hookean.
    fn batched(&self) -> Option<Batch> {
        if self.element != Element::T4 {
            return None;
        }
        let (connectivity, _) = self.connectivity.as_chunks::<4>();
        let element = |(e, nodes): (usize, &[u32; 4])| match self.material(e) {
            AnyMaterial::NeoHookean(material) => Some(BatchElement {
                nodes: *nodes,
                inverse: &self.inverses[e],
                volume: self.volumes[e],
                material,
            }),
            _ => None,
        };
        let elements: Option<Vec<_>> = connectivity.iter().enumerate().map(element).collect();
        Some(Batch::new(&elements?))
    }
}
