//! Packing density against height and against distance from the walls.

mod deposit;
mod nest;
mod sectors;

use serde::{Deserialize, Serialize};

use crate::bootstrap::BlockBootstrap;
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::{NOT_UPRIGHT, Region};
use crate::table::{Cell, Table};
use deposit::deposits;
use nest::{Direction, Nest};
use sectors::sectors;

/// Largest number of bins of a profile.
const MOST_BINS: f64 = 100_000.0;

/// How [`height_profile`] and [`wall_profile`] measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProfileOptions {
    /// Width of a bin over the mean diameter; above 0. Default 0.1. It is changed so that a whole number
    /// of bins fits.
    pub width_over_d: f64,
    /// How the errors are computed. The blocks cut across all bins: columns of a box for a height profile, slices
    /// along its height for a wall profile, wedges of a cylinder for both.
    pub bootstrap: BlockBootstrap,
}

impl Default for ProfileOptions {
    fn default() -> Self {
        Self {
            width_over_d: 0.1,
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// The coordinate of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProfileCoordinate {
    /// Height z (m).
    Height,
    /// Distance from the nearest side wall (m).
    WallDistance,
}

/// One bin of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileBin {
    /// Where the bin begins (m).
    pub low: f64,
    /// Where it ends (m).
    pub high: f64,
    /// Volume of the bin (m³).
    pub volume: f64,
    /// Solid volume in it (m³), pair overlaps subtracted.
    pub solid: f64,
    /// Packing density: `solid / volume`.
    pub density: f64,
    /// Standard error of the density by block bootstrap; `None` with fewer than four blocks.
    pub standard_error: Option<f64>,
    /// Number of bodies with their centroid in the bin: layers at a wall show here most sharply.
    pub centroids: u32,
}

impl ProfileBin {
    /// Middle of the bin (m).
    #[must_use]
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Bodies with their centroid in the bin, over its volume (1/m³).
    #[must_use]
    pub fn bodies_per_volume(&self) -> f64 {
        f64::from(self.centroids) / self.volume
    }
}

/// Packing density against height or wall distance. As a [`Table`] one row per bin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DensityProfile {
    /// The meaning of `low` and `high` of the bins.
    pub coordinate: ProfileCoordinate,
    /// The region measured.
    pub region: Region,
    /// Mean circumscribed diameter d of the bodies (m).
    pub diameter: f64,
    /// The bins, in order and without gaps.
    pub bins: Vec<ProfileBin>,
    /// Number of blocks that the bootstrap drew from.
    pub blocks: usize,
}

/// Packing density of horizontal slabs of `region`, a box or a cylinder, from its floor to its top.
/// Bodies are clipped exactly by every slab and by the region's sides; overlaps are subtracted pair by pair
/// where they are. Bins above the pack have density 0: end the region where the profile should end.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// // An octahedron of height 2 m on its tip in a unit column: a slice has the area 2 z².
/// let octahedron = ["P4".parse::<CatalogueShape>()?.polyhedron(2.0)?];
/// let body = [PosedBody { shape: 0, pose: Pose::translation(0.0, 0.0, 1.0) }];
/// let column = Region::Box { min: Point3::new(-1.0, -1.0, 0.0), max: Point3::new(1.0, 1.0, 2.0) };
/// let options = ProfileOptions { width_over_d: 0.25, ..ProfileOptions::default() };
/// let profile = height_profile(&Pack::new(&octahedron, &body)?, &column, &options)?;
/// assert_eq!(profile.bins.len(), 4);
/// assert!((profile.bins[0].solid - 2.0 / 3.0 * 0.5_f64.powi(3)).abs() < 1e-12);
/// assert!(profile.to_csv().starts_with("low_m,high_m,volume_m3,solid_m3,density,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a sphere,
/// [`AnalysisError::Option`], also for more than 100,000 bins.
pub fn height_profile(
    pack: &Pack,
    region: &Region,
    options: &ProfileOptions,
) -> Result<DensityProfile, AnalysisError> {
    profile(pack, region, Direction::Up, options)
}

/// Packing density of shells of `region`, a box or a cylinder, at equal distance from its side walls: square
/// frames in a box, tubes in a cylinder, from its lower to its upper end. The last bin ends at the axis.
///
/// Clipping is exact, as in [`height_profile`]. The walls are the sides of `region`; the floor is not treated
/// as a wall, since the height profile shows it. To exclude effects of floor and top, pass the container
/// without its ends ([`Region::slab`]).
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Pose, catalogue::CatalogueShape};
///
/// // One cube, its centre on the axis of a drum: the part within 0.5 m of the axis is a cylinder.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let body = [PosedBody { shape: 0, pose: Pose::identity() }];
/// let drum = Region::Cylinder { centre: [0.0; 2], radius: 1.0, z_min: -0.5, z_max: 0.5 };
/// let options = ProfileOptions { width_over_d: 0.5 / 3_f64.sqrt(), ..ProfileOptions::default() };
/// let profile = wall_profile(&Pack::new(&cube, &body)?, &drum, &options)?;
/// assert!((profile.bins[1].density - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`height_profile`].
pub fn wall_profile(
    pack: &Pack,
    region: &Region,
    options: &ProfileOptions,
) -> Result<DensityProfile, AnalysisError> {
    profile(pack, region, Direction::Inwards, options)
}

fn profile(
    pack: &Pack,
    region: &Region,
    direction: Direction,
    options: &ProfileOptions,
) -> Result<DensityProfile, AnalysisError> {
    region.validate()?;
    options.bootstrap.validate()?;
    if matches!(region, Region::Sphere { .. }) {
        return Err(NOT_UPRIGHT);
    }
    let diameter = pack.mean_diameter()?;
    let width = options.width_over_d * diameter;
    let (min, max) = region.corners();
    let bins = (max - min).amax() / width;
    // The condition is false for NaN.
    if !(width > 0.0 && width.is_finite() && bins < MOST_BINS) {
        return Err(AnalysisError::Option {
            name: "width_over_d",
            value: options.width_over_d,
            allowed: "above zero, finite, and wide enough for fewer than 100000 bins",
        });
    }
    let nest = Nest::new(region, direction, width);
    let blocks = sectors(region, direction, options.bootstrap.block_over_d * diameter);
    let mut solid = vec![vec![0.0; nest.count]; blocks.len()];
    for deposit in deposits(pack, region, &nest, &blocks) {
        let bins = &mut solid[deposit.block][deposit.first..];
        for (bin, volume) in bins.iter_mut().zip(&deposit.volumes) {
            *bin += volume;
        }
    }
    let mut centroids = vec![0; nest.count];
    for bin in pack.centroids().iter().filter_map(|c| nest.bin_of(c)) {
        centroids[bin] += 1;
    }
    let bin = |k: usize| {
        let share = nest.bin_volume(k) / blocks.len() as f64;
        let parts: Vec<[f64; 2]> = solid.iter().map(|bins| [bins[k], share]).collect();
        let solid: f64 = parts.iter().map(|p| p[0]).sum();
        ProfileBin {
            low: nest.edge(k),
            high: nest.edge(k + 1),
            volume: nest.bin_volume(k),
            solid,
            density: solid / nest.bin_volume(k),
            standard_error: options.bootstrap.ratio_error(&parts),
            centroids: centroids[k],
        }
    };
    Ok(DensityProfile {
        coordinate: match direction {
            Direction::Up => ProfileCoordinate::Height,
            Direction::Inwards => ProfileCoordinate::WallDistance,
        },
        region: *region,
        diameter,
        bins: (0..nest.count).map(bin).collect(),
        blocks: blocks.len(),
    })
}

impl Table for DensityProfile {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "low_m",
            "high_m",
            "volume_m3",
            "solid_m3",
            "density",
            "standard_error",
            "centroids",
            "middle_mm",
            "middle_over_d",
            "bodies_per_m3",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.bins.iter().map(|bin| {
            vec![
                bin.low.into(),
                bin.high.into(),
                bin.volume.into(),
                bin.solid.into(),
                bin.density.into(),
                bin.standard_error.into(),
                bin.centroids.into(),
                (1e3 * bin.middle()).into(),
                (bin.middle() / self.diameter).into(),
                bin.bodies_per_volume().into(),
            ]
        }))
    }
}
