//! `pores.json`.

use femdem::analysis::Region;
use serde::Serialize;

use super::flow::FlowSummary;
use super::image::VoxelSummary;
use super::space::{Read, Space};

/// Version of the keys.
const SCHEMA: u32 = 1;

/// The results in numbers.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    schema: u32,
    /// Number of the frame that was asked for.
    frame: Option<usize>,
    /// Its time \[s\].
    time: Option<f64>,
    bodies: usize,
    /// Mean circumscribed diameter \[m\].
    diameter: f64,
    region: Region,
    sides: &'static str,
    /// Axes along which the region repeats itself.
    periodic: [bool; 3],
    #[serde(flatten)]
    voxels: VoxelSummary,
    /// `None` without surfaces.
    surface: Option<FlowSummary>,
}

impl Summary {
    pub(super) fn new(
        space: &Space,
        read: &Read,
        voxels: VoxelSummary,
        surface: Option<FlowSummary>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            frame: read.frame.map(|(number, _)| number),
            time: read.frame.map(|(_, time)| time),
            bodies: read.bodies.len(),
            diameter: space.diameter,
            region: space.region,
            sides: space.sides_word(),
            periodic: space.repeats,
            voxels,
            surface,
        }
    }
}
