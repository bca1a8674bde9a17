//! Packing density by clipping.

use femdem_mesh::{Polyhedron, Pose};
use serde::{Deserialize, Serialize};

use crate::clip::Clipper;
use crate::error::AnalysisError;
use crate::neighbours::neighbour_pairs;
use crate::ordered::ordered_map;
use crate::overlap::{Pair, measure_pairs};
use crate::pack::{Pack, PosedBody};
use crate::region::{Region, Relation};

/// Packing density by exact clipping, with its parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExactDensity {
    /// Solid volume over region volume: `(body_volume - overlap_volume) / region_volume`.
    pub density: f64,
    /// Volume of the region (m³).
    pub region_volume: f64,
    /// Sum of the volumes of the bodies' parts inside the region (m³).
    pub body_volume: f64,
    /// Sum of the volumes shared by pairs inside the region (m³). Volume shared by three bodies is subtracted
    /// once too often; in a pack this is of the third order in the penetration.
    pub overlap_volume: f64,
    /// Bodies whose box reaches into the region.
    pub bodies: usize,
}

/// Packing density of `region`: every body clipped by it (divergence theorem) minus pair overlaps.
///
/// Accurate to about 1e-13, whatever the form of the bodies. Parts of the region without bodies count as void,
/// also where the region extends beyond the pack; a region without any body has density 0.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, Region, exact_density};
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// let octahedron = ["P4".parse::<CatalogueShape>()?.polyhedron(2.0)?];
/// let body = [PosedBody { shape: 0, pose: Pose::identity() }];
/// let octant = Region::Box { min: Point3::origin(), max: Point3::new(1.0, 1.0, 1.0) };
/// let result = exact_density(&Pack::new(&octahedron, &body)?, &octant)?;
/// assert!((result.density - 1.0 / 6.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`].
pub fn exact_density(pack: &Pack, region: &Region) -> Result<ExactDensity, AnalysisError> {
    region.validate()?;
    if pack.is_empty() {
        return Err(AnalysisError::EmptyPack);
    }
    Ok(Measured::new(pack, region).density(region))
}

/// Volume (m³) of the part of a body inside `region`, exact to round-off for bodies of any form.
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::Pose`].
pub fn volume_inside(
    shape: &Polyhedron,
    pose: &Pose,
    region: &Region,
) -> Result<f64, AnalysisError> {
    region.validate()?;
    let shapes = std::slice::from_ref(shape);
    let bodies = [PosedBody {
        shape: 0,
        pose: *pose,
    }];
    Ok(body_volume(
        &mut Clipper::default(),
        &Pack::new(shapes, &bodies)?,
        0,
        region,
    ))
}

/// The bodies and pairs that take part in a region, with their summed volumes.
pub(crate) struct Measured {
    members: Vec<usize>,
    /// Pairs that share volume.
    pairs: Vec<Pair>,
    body_volume: f64,
    overlap_volume: f64,
}

impl Measured {
    pub(crate) fn new(pack: &Pack, region: &Region) -> Self {
        let members: Vec<usize> = (0..pack.len())
            .filter(|&i| region.relation(pack.bounds(i)) != Relation::Outside)
            .collect();
        let pairs = neighbour_pairs(pack, &members);
        Self::of(pack, region, members, &pairs)
    }

    /// The same for a part of the region.
    pub(crate) fn within(&self, pack: &Pack, part: &Region) -> Self {
        let reaches = |&i: &usize| part.relation(pack.bounds(i)) != Relation::Outside;
        let members = self.members.iter().copied().filter(reaches).collect();
        let pairs: Vec<_> = self
            .pairs
            .iter()
            .copied()
            .filter(|(i, j)| reaches(i) && reaches(j))
            .collect();
        Self::of(pack, part, members, &pairs)
    }

    fn of(pack: &Pack, region: &Region, members: Vec<usize>, pairs: &[Pair]) -> Self {
        let volumes = ordered_map(members.len(), Clipper::default, |clipper, k| {
            body_volume(clipper, pack, members[k], region)
        });
        let sharing = measure_pairs(pack, pairs, Some(region));
        Self {
            members,
            // Not `sum`, which is -0 without bodies or pairs.
            body_volume: volumes.iter().fold(0.0, |sum, volume| sum + volume),
            overlap_volume: sharing.iter().fold(0.0, |sum, (_, volume)| sum + volume),
            pairs: sharing.into_iter().map(|(pair, _)| pair).collect(),
        }
    }

    pub(crate) fn density(&self, region: &Region) -> ExactDensity {
        let region_volume = region.volume();
        ExactDensity {
            density: (self.body_volume - self.overlap_volume) / region_volume,
            region_volume,
            body_volume: self.body_volume,
            overlap_volume: self.overlap_volume,
            bodies: self.members.len(),
        }
    }
}

/// Volume of every body inside `region` (m³).
pub(crate) fn volumes_of_bodies(pack: &Pack, region: &Region) -> Vec<f64> {
    ordered_map(pack.len(), Clipper::default, |clipper, body| {
        body_volume(clipper, pack, body, region)
    })
}

/// Solid volume of every body inside `region` (m³), minus half of the volume that it shares with each other
/// body there.
pub(crate) fn solid_of_bodies(pack: &Pack, region: &Region) -> Vec<f64> {
    let mut solids = volumes_of_bodies(pack, region);
    let members: Vec<usize> = (0..pack.len()).filter(|&i| solids[i] > 0.0).collect();
    for ((i, j), volume) in measure_pairs(pack, &neighbour_pairs(pack, &members), Some(region)) {
        solids[i] -= 0.5 * volume;
        solids[j] -= 0.5 * volume;
    }
    solids
}

fn body_volume(clipper: &mut Clipper, pack: &Pack, body: usize, region: &Region) -> f64 {
    match region.relation(pack.bounds(body)) {
        Relation::Outside => 0.0,
        Relation::Inside => pack.shape(body).mass_properties().volume,
        Relation::Crosses => {
            clipper.load(pack.shape(body), pack.pose(body));
            clipper.volume_in(region)
        }
    }
}
