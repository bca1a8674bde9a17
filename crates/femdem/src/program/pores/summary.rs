//! `pores.json`.

use femdem::analysis::Region;
use femdem::analysis::pores::Sides;
use serde::Serialize;

use super::flow::FlowSummary;
use super::image::VoxelSummary;
use super::space::Space;

/// Version of the keys.
const SCHEMA: u32 = 1;

/// The results in numbers.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    schema: u32,
    bodies: usize,
    /// Mean circumscribed diameter \[m\].
    diameter: f64,
    region: Region,
    sides: &'static str,
    #[serde(flatten)]
    voxels: VoxelSummary,
    /// `None` without surfaces.
    surface: Option<FlowSummary>,
}

impl Summary {
    pub(super) fn new(
        space: &Space,
        bodies: usize,
        voxels: VoxelSummary,
        surface: Option<FlowSummary>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            bodies,
            diameter: space.diameter,
            region: space.region,
            sides: match space.sides {
                Sides::Wall => "wall",
                Sides::Open => "open",
            },
            voxels,
            surface,
        }
    }
}
