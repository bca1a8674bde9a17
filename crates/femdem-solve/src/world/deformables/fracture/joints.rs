//! Facets that a crack has cut and that glue, pressure and friction still join.

use femdem_contact::glue::{GlueLaw, GluedFacet, MidSurface};
use femdem_fem::fracture::FractureMode;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A facet of the mesh that is cut and not released.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Joint {
    pub facet: u32,
    /// Its nodes in the first and in the second of its tetrahedra.
    pub sides: [[u32; 3]; 2],
    pub law: GlueLaw,
    pub glued: GluedFacet,
    /// Height of the elements beside it, m.
    pub height: f64,
    /// When it was cut, s.
    pub birth: f64,
    pub mode: FractureMode,
    /// When nothing of its glue was left, s.
    pub end: Option<f64>,
    /// What its glue has dissipated beyond what it was lent, J.
    pub taken: f64,
}

impl Joint {
    /// Where its nodes are, m.
    pub fn places(&self, positions: &[Vector3]) -> [[Vector3; 3]; 2] {
        self.sides
            .map(|side| side.map(|node| positions[node as usize]))
    }
}

/// A traction (Pa) in the axes of the triangle that it acts on.
pub(super) fn in_axes(
    triangle: &[Vector3; 3],
    traction: impl Fn(&Vector3) -> Vector3,
) -> Option<[f64; 3]> {
    let middle = MidSurface::new(triangle, triangle)?;
    let traction = traction(&middle.axes[0]);
    Some(middle.axes.map(|axis| axis.dot(&traction)))
}
