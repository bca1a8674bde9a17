//! What a body that may break shows of its cracks.

use super::Breakable;
use super::facet::CrackFacet;
use crate::fracture::Fracture;
use crate::world::deformables::{Deformable, Model};
use femdem_mesh::Vector3;
use femdem_mesh::tet::CrackedMesh;

/// The cracks of a body that may break.
#[derive(Debug, Clone, Copy)]
pub struct Cracks<'a> {
    model: &'a Model,
    breakable: &'a Breakable,
    positions: &'a [Vector3],
}

impl<'a> Cracks<'a> {
    /// By what it breaks.
    #[must_use]
    pub fn fracture(&self) -> &'a Fracture {
        &self.breakable.fracture
    }

    /// Length of the zone in which its cracks open, m: [`Fracture::process_zone`].
    #[must_use]
    pub fn process_zone(&self) -> f64 {
        self.fracture().process_zone(self.model.young)
    }

    /// Mean height of its elements beside inner facets, weighted by area, m.
    #[must_use]
    pub fn element_height(&self) -> f64 {
        self.model.sizes().0
    }

    /// The largest height of elements with which cracks take the energy given, m: [`Fracture::largest_height`].
    #[must_use]
    pub fn largest_height(&self) -> f64 {
        self.fracture().largest_height(self.model.young)
    }

    /// The largest stress, or at the front of a crack force, over strength at the last look.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.breakable.highest
    }

    /// Which facets are cut, and the nodes of the elements; `None` while the body is whole.
    #[must_use]
    pub fn mesh(&self) -> Option<&'a CrackedMesh> {
        Some(&self.breakable.cracks.as_ref()?.mesh)
    }

    /// The number of the fragment that each element belongs to: those that facets join that are whole, or not yet broken. They
    /// are numbered from 0 by their lowest elements; empty while the body is whole.
    #[must_use]
    pub fn fragments(&self) -> Vec<u32> {
        let Some(cracks) = self.breakable.cracks.as_deref() else {
            return Vec::new();
        };
        let mut broken = cracks.broken.clone();
        let joints = cracks.joints.iter();
        let facets: Vec<u32> = joints
            .filter(|joint| joint.end.is_some())
            .map(|joint| joint.facet)
            .collect();
        // The facets are those of the mesh.
        let cut = broken.cut(&facets);
        debug_assert!(cut.is_ok(), "facets of this mesh");
        broken.parts()
    }

    /// By point of its mesh (by node while it is whole), the point of the mesh of the body that broke first: by these numbers a fragment
    /// has the strengths that the body had there.
    #[must_use]
    pub fn points(&self) -> &'a [u32] {
        &self.breakable.points
    }

    /// The facets that carry nothing any more, as they were when that was seen, in that order; also those along which it broke off
    /// another body.
    #[must_use]
    pub fn spent(&self) -> &'a [CrackFacet] {
        &self.breakable.spent
    }

    /// Energy of the facets that are not spent, J: in glue, and under the pressure of their birth.
    #[must_use]
    pub fn stored(&self) -> f64 {
        let cracks = self.breakable.cracks.as_ref();
        cracks.map_or(0.0, |cracks| cracks.stored)
    }

    /// The facets that are cut and not spent, in the order in which they were cut.
    pub fn facets(&self) -> impl Iterator<Item = CrackFacet> + use<'a> {
        let (positions, nodes) = (self.positions, self.model.model.nodes());
        let cracks = self.breakable.cracks.as_deref();
        cracks.into_iter().flat_map(move |cracks| {
            let facets = cracks.mesh.facets();
            let joints = cracks.joints.iter();
            joints.map(move |joint| CrackFacet::of(joint, positions, facets, nodes))
        })
    }
}

impl<'a> Deformable<'a> {
    /// Its cracks, if it may break.
    #[must_use]
    pub fn cracks(&self) -> Option<Cracks<'a>> {
        Some(Cracks {
            model: self.own_model(),
            breakable: self.state().breakable.as_deref()?,
            positions: self.positions(),
        })
    }
}
