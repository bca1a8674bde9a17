//! What a case of OpenFOAM is made for.

use femdem_analysis::Region;
use femdem_mesh::Point3;

/// What a patch is to the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchKind {
    /// The bodies: a wall, with the finest cells.
    Bodies,
    /// A wall.
    Wall,
    /// A plane that the fluid slides along without friction.
    Slip,
    /// Where the fluid comes in.
    Inlet,
    /// Where it leaves.
    Outlet,
}

/// A surface file of the case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CasePatch {
    /// Name of the patch, and of its file without `.stl`.
    pub name: String,
    /// What it is to the flow.
    pub kind: PatchKind,
}

/// What a case is made for: steady laminar flow along z.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowCase {
    /// The space that the surfaces lie in.
    pub region: Region,
    /// Axes along which it repeats itself. Its sides there are patches of the block and need no surface.
    pub repeats: [bool; 3],
    /// The surfaces elsewhere.
    pub patches: Vec<CasePatch>,
    /// A point in the void, away from all surfaces and not in a face of the cells (m).
    pub inside: Point3,
    /// Width of the cells far from the surfaces (m).
    pub cell: f64,
    /// How often cells at the bodies are halved.
    pub level: u32,
    /// Superficial velocity along z: flow over the whole cross-section (m/s).
    pub velocity: f64,
    /// Kinematic viscosity of the fluid (m²/s).
    pub viscosity: f64,
    /// Share of the void in the region.
    pub porosity: f64,
}

/// Names of the sides along an axis on which space repeats itself, the lower one first.
pub(super) const PAIRS: [[&str; 2]; 3] = [
    ["x_low", "x_high"],
    ["y_low", "y_high"],
    ["z_low", "z_high"],
];

impl FlowCase {
    /// The pairs of sides that repeat each other.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [&'static str; 2]> {
        let pairs = PAIRS.into_iter().zip(self.repeats);
        pairs.filter_map(|(pair, repeats)| repeats.then_some(pair))
    }
}
