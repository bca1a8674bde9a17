//! What a body that may break shows of its cracks.

use super::Breakable;
use super::joints::Joint;
use crate::fracture::Fracture;
use crate::world::deformables::Deformable;
use femdem_contact::glue::MidSurface;
use femdem_fem::fracture::FractureMode;
use femdem_mesh::Vector3;
use femdem_mesh::tet::CrackedMesh;
use serde::{Deserialize, Serialize};

/// The cracks of a body that may break.
#[derive(Debug, Clone, Copy)]
pub struct Cracks<'a> {
    breakable: &'a Breakable,
    positions: &'a [Vector3],
}

/// A facet that is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrackFacet {
    /// Its number among the facets of the mesh.
    pub facet: u32,
    /// Its corners midway between its sides, m.
    pub corners: [Vector3; 3],
    /// Mean opening and slip of its sides, m.
    pub opening: f64,
    /// See `opening`.
    pub slip: f64,
    /// 0 when it is cut, 1 when nothing holds any more; the mean over its corners, of which those whose node is not split are 0.
    pub damage: f64,
    /// By which criterion it was cut.
    pub mode: FractureMode,
    /// When it was cut, s.
    pub birth: f64,
    /// When it broke: when nothing held any more, s.
    pub end: Option<f64>,
    /// Energy that it has taken to break, without friction, J.
    pub taken: f64,
}

impl<'a> Cracks<'a> {
    /// By what it breaks.
    #[must_use]
    pub fn fracture(&self) -> &'a Fracture {
        &self.breakable.fracture
    }

    /// The largest stress over strength at the last look.
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
        let mut broken = cracks.skin.clone();
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

    /// The facets whose sides have become skin, as they were when they did, in the order in which they did.
    #[must_use]
    pub fn released(&self) -> &'a [CrackFacet] {
        let cracks = self.breakable.cracks.as_deref();
        cracks.map_or(&[], |cracks| &cracks.released)
    }

    /// Energy in glue, pressure and friction springs of the facets, J.
    #[must_use]
    pub fn stored(&self) -> f64 {
        let cracks = self.breakable.cracks.as_ref();
        cracks.map_or(0.0, |cracks| cracks.stored)
    }

    /// The facets that are cut and not released, in the order in which they were cut.
    pub fn facets(&self) -> impl Iterator<Item = CrackFacet> + use<'a> {
        let positions = self.positions;
        let cracks = self.breakable.cracks.as_deref();
        let joints = cracks.map_or(&[][..], |cracks| &cracks.joints);
        joints.iter().map(|joint| CrackFacet::of(joint, positions))
    }
}

impl CrackFacet {
    pub(super) fn of(joint: &Joint, positions: &[Vector3]) -> Self {
        let [a, b] = joint.places(positions);
        let openings = MidSurface::new(&a, &b).map(|middle| middle.openings(&a, &b));
        let openings = openings.unwrap_or_default();
        let damage = joint.glued.damage(&joint.law);
        Self {
            facet: joint.facet,
            corners: [0, 1, 2].map(|q| (a[q] + b[q]) * 0.5),
            opening: openings.iter().map(|o| o[0]).sum::<f64>() / 3.0,
            slip: openings.iter().map(|o| o[1].hypot(o[2])).sum::<f64>() / 3.0,
            damage: damage.iter().sum::<f64>() / 3.0,
            mode: joint.mode,
            birth: joint.birth,
            end: joint.end,
            taken: joint.taken,
        }
    }
}

impl<'a> Deformable<'a> {
    /// Its cracks, if it may break.
    #[must_use]
    pub fn cracks(&self) -> Option<Cracks<'a>> {
        Some(Cracks {
            breakable: self.state().breakable.as_deref()?,
            positions: self.positions(),
        })
    }
}
