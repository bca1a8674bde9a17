//! The bodies of periodic space, and the images of them that reach into a region.

use femdem_mesh::{PeriodicCell, Point3, Polyhedron, Vector3};
use serde::{Deserialize, Serialize};

use crate::error::AnalysisError;
use crate::pack::{Pack, PosedBody};
use crate::region::Region;

/// Periodic space, and where its cell lies.
///
/// Bodies are told once. [`WithImages`] adds the images that a measurement of volumes needs, and
/// [`ForceNetwork::in_space`](crate::ForceNetwork::in_space) takes every way between two bodies, or from a body to a
/// contact, as the shortest of all images.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeriodicSpace {
    /// The cell.
    pub cell: PeriodicCell,
    /// Lowest corner (m) of the box of the cell's sides, in which bodies are told; along an axis without edges it says nothing.
    pub lower: Point3,
}

impl PeriodicSpace {
    /// The image of a point that lies in the box (m).
    #[must_use]
    pub fn wrapped(&self, point: &Point3) -> Point3 {
        self.lower + self.cell.wrapped(&(point - self.lower))
    }

    /// The ways (m) to all images of a point, its own place included, that come within `reach` (m) of the box around a region, along
    /// the axes that repeat themselves.
    pub(crate) fn images(&self, point: &Point3, region: &Region, reach: f64) -> Vec<Vector3> {
        let (min, max) = region.corners();
        // How far the region reaches beyond the box of the cell.
        let beyond = (0..3).filter(|&k| self.cell.repeats(k)).map(|k| {
            let side = self.cell.edges()[(k, k)];
            (self.lower[k] - min[k]).max(max[k] - self.lower[k] - side)
        });
        let span = beyond.fold(0.0, f64::max) + reach;
        let mut ways = self.cell.images(&(point - self.lower), span);
        ways.retain(|way| {
            let near = |k: usize| {
                let x = point[k] + way[k];
                x + reach >= min[k] && x - reach <= max[k]
            };
            (0..3).all(|k| !self.cell.repeats(k) || near(k))
        });
        ways
    }
}

/// The bodies of a pack in periodic space, followed by the images of them that come near a region.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{PeriodicCell, Point3, Pose, catalogue::CatalogueShape};
///
/// // A cube of 1 m3 on the corner of a cell of 2 m x 2 m: a quarter of it lies in the cell, and so do those of its images.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let bodies = [PosedBody { shape: 0, pose: Pose::translation(0.0, 0.0, 0.5) }];
/// let space = PeriodicSpace { cell: PeriodicCell::new([Some(2.0), Some(2.0), None])?, lower: Point3::origin() };
/// let region = Region::Box { min: Point3::origin(), max: Point3::new(2.0, 2.0, 1.0) };
/// let images = WithImages::new(&cube, &bodies, &space, &region, 0.0)?;
/// let pack = images.pack(&cube)?;
/// assert!((exact_density(&pack, &region)?.density - 0.25).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct WithImages {
    bodies: Vec<PosedBody>,
    /// The body that each image, after the bodies themselves, is of.
    sources: Vec<u32>,
    cell: Option<PeriodicCell>,
}

impl WithImages {
    /// All images whose circumscribed spheres come within `reach` (m) of the box around a region, along the axes that repeat
    /// themselves.
    ///
    /// # Errors
    /// As [`Pack::new`], and [`AnalysisError::Region`].
    pub fn new(
        shapes: &[Polyhedron],
        bodies: &[PosedBody],
        space: &PeriodicSpace,
        region: &Region,
        reach: f64,
    ) -> Result<Self, AnalysisError> {
        region.validate()?;
        let pack = Pack::new(shapes, bodies)?;
        let mut all = bodies.to_vec();
        let mut sources = Vec::new();
        for ((body, posed), source) in bodies.iter().enumerate().zip(0_u32..) {
            let room = pack.shape(body).bounding_radius() + reach;
            for way in space.images(&pack.centroid(body), region, room) {
                if way != Vector3::zeros() {
                    let mut image = *posed;
                    image.pose.translation.vector += way;
                    all.push(image);
                    sources.push(source);
                }
            }
        }
        Ok(Self {
            bodies: all,
            sources,
            cell: Some(space.cell),
        })
    }

    /// Bodies without images, in space that does not repeat itself.
    #[must_use]
    pub fn none(bodies: Vec<PosedBody>) -> Self {
        Self {
            bodies,
            sources: Vec::new(),
            cell: None,
        }
    }

    /// The pack of all, in which only the bodies themselves count as bodies: [`Pack::own`].
    ///
    /// # Errors
    /// As [`Pack::new`].
    pub fn pack<'a>(&'a self, shapes: &'a [Polyhedron]) -> Result<Pack<'a>, AnalysisError> {
        let pack = Pack::new(shapes, &self.bodies)?;
        Ok(pack.in_cell(self.cell, &self.sources))
    }
}
