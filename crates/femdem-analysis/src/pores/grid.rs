//! Regular voxels over a region.

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

/// Regular voxels. Lists over them have x running fastest, then y, then z, as in VTK's image data.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VoxelGrid {
    /// Lower corner of the first voxel (m).
    pub origin: Point3,
    /// Sides of a voxel along x, y, z (m).
    pub spacing: [f64; 3],
    /// Number of voxels along x, y, z.
    pub counts: [usize; 3],
}

impl VoxelGrid {
    /// Number of voxels.
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Whether there is no voxel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Volume of a voxel (m³).
    pub fn voxel_volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Number of a voxel in the lists.
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// Position of a voxel by its number; that of the first voxel in an empty grid.
    pub fn position(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.counts.map(|n| n.max(1));
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    /// Centre of a voxel (m).
    pub fn centre(&self, position: [usize; 3]) -> Point3 {
        let at = |k: usize| self.origin[k] + (position[k] as f64 + 0.5) * self.spacing[k];
        Point3::from([0, 1, 2].map(at))
    }

    /// Number of voxels in one layer.
    pub(super) fn layer(&self) -> usize {
        self.counts[0] * self.counts[1]
    }
}
