//! A facet of a crack, as it is seen from outside.

use super::joints::Joint;
use femdem_contact::glue::MidSurface;
use femdem_fem::fracture::FractureMode;
use femdem_mesh::Vector3;
use femdem_mesh::tet::Facets;
use serde::{Deserialize, Serialize};

/// A facet that is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrackFacet {
    /// The elements beside it; `None` for one that is of another body now, which has this facet, too.
    pub tets: [Option<u32>; 2],
    /// Its corners in the reference state, m.
    pub place: [Vector3; 3],
    /// Its corners midway between its sides, m.
    pub corners: [Vector3; 3],
    /// Mean opening and slip of its sides, m.
    pub opening: f64,
    /// See `opening`.
    pub slip: f64,
    /// 0 when it is cut, 1 when nothing holds any more; the mean over its points.
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

impl CrackFacet {
    /// `facets` are those of the mesh, and `nodes` the places of its points, m.
    pub(super) fn of(
        joint: &Joint,
        positions: &[Vector3],
        facets: &Facets,
        nodes: &[Vector3],
    ) -> Self {
        let facet = &facets.all()[joint.facet as usize];
        let [a, b] = joint.places(positions);
        let openings = MidSurface::new(&a, &b).map(|middle| middle.openings(&a, &b));
        let openings = openings.unwrap_or_default();
        let damage = joint.glued.damage(&joint.law);
        Self {
            tets: facet.tets.map(Some),
            place: facet.points.map(|point| nodes[point as usize]),
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
