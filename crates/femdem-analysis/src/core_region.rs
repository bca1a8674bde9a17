//! The part of a pack in which its density is measured.

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::{NOT_UPRIGHT, Region};
use crate::top::{TopPlane, top_plane};

/// How [`choose_core`] chooses the inset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CoreOptions {
    /// Largest inset from walls, floor and mean top, over the mean diameter; 0 or more. Default 5, as in the
    /// founding paper.
    pub inset_over_d: f64,
    /// Extent over the mean diameter that the core keeps where possible, by reducing the inset; above 0.
    /// Default 3.
    pub minimum_core_over_d: f64,
    /// Spacing over the mean diameter of the columns used to find the mean top; above 0. Default 1/4.
    pub column_spacing_over_d: f64,
}

impl Default for CoreOptions {
    fn default() -> Self {
        Self {
            inset_over_d: 5.0,
            minimum_core_over_d: 3.0,
            column_spacing_over_d: 0.25,
        }
    }
}

/// The reason for the inset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InsetLimit {
    /// None: it is the inset of the options.
    None,
    /// The container is too narrow for the inset of the options.
    Width,
    /// The pack is too low for the inset of the options.
    Height,
}

/// A core region and how it was chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoreRegion {
    /// The core.
    pub region: Region,
    /// Its distance from walls, floor and mean top (m).
    pub inset: f64,
    /// The same over the mean diameter.
    pub inset_over_d: f64,
    /// Why the inset is smaller than that of the options.
    pub limit: InsetLimit,
    /// The top of the pack from which the inset is measured.
    pub top: TopPlane,
    /// Smallest of the core's widths and its height, over the mean diameter.
    pub extent_over_d: f64,
    /// The whole bed: the inside of the container from the floor to the mean top.
    pub bed: Region,
}

impl CoreRegion {
    /// Whether the core is thinner than one mean diameter: its faces then cut nearly every body in it, and what
    /// it holds of them says little of the pack.
    pub fn is_thin(&self) -> bool {
        self.extent_over_d < 1.0
    }

    /// Where densities are measured: the core, or the whole bed if the core [is thin](Self::is_thin).
    ///
    /// ```
    /// use femdem_analysis::{CoreOptions, Pack, PosedBody, Region, choose_core};
    /// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
    ///
    /// // One layer of cubes of side 1 m, d = sqrt(3) m: half of its height would be the core.
    /// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
    /// let at = |i: i32| Pose::translation(f64::from(i % 7) + 0.5, f64::from(i / 7) + 0.5, 0.5);
    /// let bodies: Vec<_> = (0..49).map(|i| PosedBody { shape: 0, pose: at(i) }).collect();
    /// let container = Region::Box { min: Point3::origin(), max: Point3::new(7.0, 7.0, 20.0) };
    /// let core = choose_core(&Pack::new(&cube, &bodies)?, &container, &CoreOptions::default())?;
    /// assert!(core.is_thin());
    /// assert!((core.density_region().volume() - 49.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn density_region(&self) -> &Region {
        if self.is_thin() {
            &self.bed
        } else {
            &self.region
        }
    }
}

/// Chooses the core of a pack that lies in `container` (its inside, walls and floor being its faces).
///
/// The founding paper (Xiang, Latham and Farsi 2016) keeps 5 diameters from the walls and from the mean top
/// plane. Small packs do not allow that. Here the inset, the same on all sides and from the floor, is
///
/// `min(inset of the options, max((L - minimum core)/2, L/4))`
///
/// with `L` the smallest of the container's widths and the pack's height (floor to mean top, or to the
/// container's own top where that is lower). The core thus keeps the minimum extent, or half of `L` where the
/// pack is smaller still; [`CoreRegion::limit`] states which extent was decisive. A core may so be thinner than a
/// body: [`CoreRegion::density_region`] is the whole bed then. In [periodic space](crate::WithImages) the core reaches over
/// the whole container along the axes that repeat themselves.
///
/// ```
/// use femdem_analysis::{CoreOptions, InsetLimit, Pack, PosedBody, Region, choose_core};
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// // 7 x 7 x 7 cubes of side 1 m, d = sqrt(3) m.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let mut bodies = Vec::new();
/// for (x, y, z) in (0..343).map(|i| (i % 7, i / 7 % 7, i / 49)) {
///     let pose = Pose::translation(f64::from(x) + 0.5, f64::from(y) + 0.5, f64::from(z) + 0.5);
///     bodies.push(PosedBody { shape: 0, pose });
/// }
/// let container = Region::Box { min: Point3::origin(), max: Point3::new(7.0, 7.0, 20.0) };
/// let core = choose_core(&Pack::new(&cube, &bodies)?, &container, &CoreOptions::default())?;
/// assert_eq!(core.limit, InsetLimit::Width); // 5 d = 8.7 m would leave nothing
/// assert!((core.inset - 7.0 / 4.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`] for the container, [`AnalysisError::RegionKind`] for
/// a sphere (use [`Region::inset`]), [`AnalysisError::Option`], [`AnalysisError::NoPackInContainer`],
/// [`AnalysisError::GridTooFine`] for the columns.
pub fn choose_core(
    pack: &Pack,
    container: &Region,
    options: &CoreOptions,
) -> Result<CoreRegion, AnalysisError> {
    options.validate()?;
    container.validate()?;
    if matches!(container, Region::Sphere { .. }) {
        return Err(NOT_UPRIGHT);
    }
    let diameter = pack.mean_diameter()?;
    let (min, max) = container.corners();
    let top = match pack.repeats(2) {
        // Space goes on above.
        true => TopPlane {
            mean: max.z,
            deviation: 0.0,
            columns: 0,
            empty_columns: 0,
        },
        false => top_plane(pack, container, options.column_spacing_over_d * diameter)?,
    };
    let ceiling = top.mean.min(max.z);
    let height = ceiling - min.z;
    if height <= 0.0 {
        return Err(AnalysisError::NoPackInContainer {
            mean_top: top.mean,
            floor: min.z,
        });
    }
    // Where space repeats itself there is nothing to keep away from.
    let bounded = |axis: usize, extent: f64| match pack.repeats(axis) {
        true => f64::INFINITY,
        false => extent,
    };
    let width = bounded(0, max.x - min.x).min(bounded(1, max.y - min.y));
    let extent = width.min(bounded(2, height));
    let asked = options.inset_over_d * diameter;
    let room = (0.5 * (extent - options.minimum_core_over_d * diameter)).max(0.25 * extent);
    let inset = match extent.is_finite() {
        true => asked.min(room),
        false => 0.0,
    };
    let limit = if asked <= room {
        InsetLimit::None
    } else if width <= height {
        InsetLimit::Width
    } else {
        InsetLimit::Height
    };
    let off = [0, 1, 2].map(|axis| if pack.repeats(axis) { 0.0 } else { inset });
    let (z_min, z_max) = (min.z + off[2], ceiling - off[2]);
    let region = match *container {
        Region::Box { .. } => Region::Box {
            min: Point3::new(min.x + off[0], min.y + off[1], z_min),
            max: Point3::new(max.x - off[0], max.y - off[1], z_max),
        },
        Region::Cylinder { centre, radius, .. } => Region::Cylinder {
            centre,
            radius: radius - inset,
            z_min,
            z_max,
        },
        Region::Sphere { .. } => return Err(NOT_UPRIGHT),
    };
    region.validate()?;
    let (low, high) = region.corners();
    Ok(CoreRegion {
        extent_over_d: (high - low).min() / diameter,
        bed: container.slab(f64::NEG_INFINITY, ceiling)?,
        region,
        inset,
        inset_over_d: inset / diameter,
        limit,
        top,
    })
}

impl CoreOptions {
    fn validate(&self) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        if !self.inset_over_d.is_finite() || self.inset_over_d < 0.0 {
            return refuse("inset_over_d", self.inset_over_d, "finite and not negative");
        }
        for (name, value) in [
            ("minimum_core_over_d", self.minimum_core_over_d),
            ("column_spacing_over_d", self.column_spacing_over_d),
        ] {
            if !value.is_finite() || value <= 0.0 {
                return refuse(name, value, "above zero and finite");
            }
        }
        Ok(())
    }
}
