//! Tilt of bodies: the angle between their axis and the vertical.

use femdem_mesh::{Point3, Polyhedron};
use serde::{Deserialize, Serialize};

use super::{BodyAxes, axes_of};
use crate::bed::Vessel;
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::Region;
use crate::table::{Cell, Table};

/// Principal moments of inertia that differ by less than this share count as equal.
const ISOTROPIC: f64 = 0.02;

/// Largest number of bins.
const MOST_BINS: u32 = 900;

/// The axis of a shape: the principal axis of inertia whose moment differs most from the other two, which is the long
/// axis of a rod and the axis of symmetry of a disc. `None` where the moments are equal to 2 %, as those of spheres,
/// cubes and the other regular solids are.
///
/// ```
/// use femdem_analysis::{BodyAxes, distinct_axis};
/// use femdem_mesh::{catalogue::CatalogueShape, shapes::Shape};
///
/// let rod = "box:width=0.2,height=0.2".parse::<Shape>()?.polyhedron(1.0)?;
/// assert_eq!(distinct_axis(&rod), Some(BodyAxes::Long));
/// assert_eq!(distinct_axis(&"P5".parse::<CatalogueShape>()?.polyhedron(1.0)?), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn distinct_axis(shape: &Polyhedron) -> Option<BodyAxes> {
    let mut moments: [f64; 3] = shape.mass_properties().principal().moments.into();
    moments.sort_by(f64::total_cmp);
    let [low, middle, high] = moments;
    if high - low <= ISOTROPIC * high {
        None
    } else if middle - low > high - middle {
        Some(BodyAxes::Long)
    } else {
        Some(BodyAxes::Short)
    }
}

/// Tilt of each body in degrees, 0 to 90: the angle between the vertical and the axis that [`distinct_axis`]
/// chooses for its shape. `None` for bodies without such an axis.
#[must_use]
pub fn tilts(pack: &Pack) -> Vec<Option<f64>> {
    let axes: Vec<_> = pack
        .shapes()
        .iter()
        .map(|shape| axes_of(shape, &distinct_axis(shape)?).first().copied())
        .collect();
    let tilt = |body: usize| {
        let axis = pack.pose(body).rotation * axes[pack.bodies()[body].shape as usize]?;
        // Exact at both ends, where an arc cosine is not.
        Some(axis.xy().norm().atan2(axis.z.abs()).to_degrees())
    };
    (0..pack.len()).map(tilt).collect()
}

/// How [`tilt_histogram`] counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TiltOptions {
    /// Bins between 0 and 90 degrees, 1 to 900. Default 9.
    pub bins: u32,
    /// Distance over the mean diameter within which a centroid is near a wall; above 0. Default 1.
    pub near_over_d: f64,
}

impl Default for TiltOptions {
    fn default() -> Self {
        Self {
            bins: 9,
            near_over_d: 1.0,
        }
    }
}

/// Tilts of a group of bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TiltGroup {
    /// Bodies in it that have an axis.
    pub bodies: u32,
    /// Mean tilt (degrees); 57.3 for axes of random direction. `None` without bodies.
    pub mean: Option<f64>,
    /// Order (3 ⟨cos² θ⟩ − 1)/2 about the vertical: 1 for upright, 0 for random, −1/2 for level axes. `None` without
    /// bodies.
    pub vertical_order: Option<f64>,
    /// Bodies in each bin.
    pub counts: Vec<u32>,
}

/// Histogram of the tilts of all bodies, and of those near walls and in the core. As a [`Table`] one row per bin, with
/// the share that axes of random direction have: their density is sin θ, hence a share cos θ₁ − cos θ₂.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TiltHistogram {
    /// Edges of the bins (degrees).
    pub edges: Vec<f64>,
    /// Share of each bin for axes of random direction.
    pub random: Vec<f64>,
    /// All bodies.
    pub all: TiltGroup,
    /// Bodies whose centroid is near a side wall, and not below it; `None` without a vessel of upright walls. Those of
    /// a silo begin above its cone.
    pub side_walls: Option<TiltGroup>,
    /// Bodies whose centroid is near the floor; `None` also for a silo, whose cone lies around it.
    pub floor: Option<TiltGroup>,
    /// Bodies whose centroid lies in the core; `None` without one.
    pub core: Option<TiltGroup>,
}

/// Counts the tilts of the bodies of a pack in a `vessel`, near its walls, and in its `core`.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Pose, Vector3, shapes::Shape};
///
/// // A rod along x: level.
/// let rod = ["box:width=0.2,height=0.2".parse::<Shape>()?.polyhedron(1.0)?];
/// let body = [PosedBody { shape: 0, pose: Pose::identity() }];
/// let found = tilt_histogram(&Pack::new(&rod, &body)?, None, None, &TiltOptions::default())?;
/// assert_eq!(found.all.counts, [0, 0, 0, 0, 0, 0, 0, 0, 1]);
/// assert_eq!(found.all.vertical_order, Some(-0.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Option`], [`AnalysisError::Region`].
pub fn tilt_histogram(
    pack: &Pack,
    vessel: Option<&Vessel>,
    core: Option<&Region>,
    options: &TiltOptions,
) -> Result<TiltHistogram, AnalysisError> {
    options.validate()?;
    let diameter = pack.mean_diameter()?;
    let upright = vessel.and_then(|vessel| between_upright_walls(vessel, diameter));
    for region in upright.iter().chain(core) {
        region.validate()?;
    }
    let has_floor = matches!(vessel, Some(Vessel::Upright(_)));
    let near = options.near_over_d * diameter;
    let (tilts, centroids) = (tilts(pack), pack.centroids());
    let bins = options.bins as usize;
    let group = |is_in: &dyn Fn(&Point3) -> bool| {
        let bodies = tilts.iter().zip(&centroids);
        let inside = bodies.filter(|(_, centroid)| is_in(centroid));
        TiltGroup::of(inside.filter_map(|(tilt, _)| *tilt), bins)
    };
    let edge = |k: usize| 90.0 * (k as f64 / bins as f64);
    Ok(TiltHistogram {
        edges: (0..=bins).map(edge).collect(),
        random: (0..bins)
            .map(|k| edge(k).to_radians().cos() - edge(k + 1).to_radians().cos())
            .collect(),
        all: group(&|_| true),
        side_walls: upright.map(|region| {
            let low = region.corners().0.z;
            group(&|p| p.z >= low && from_side_walls(&region, p) <= near)
        }),
        floor: upright
            .filter(|_| has_floor)
            .map(|region| group(&|p| p.z - region.corners().0.z <= near)),
        core: core.map(|region| group(&|p| region.contains(p))),
    })
}

/// The part of a vessel between upright side walls, if it has such; of a silo, one diameter (m) of it.
fn between_upright_walls(vessel: &Vessel, diameter: f64) -> Option<Region> {
    match *vessel {
        Vessel::Upright(Region::Sphere { .. }) | Vessel::Solid { .. } => None,
        Vessel::Upright(region) => Some(region),
        Vessel::Silo {
            centre,
            radius,
            waist,
            ..
        } => Some(Region::Cylinder {
            centre,
            radius,
            z_min: waist,
            z_max: waist + diameter,
        }),
    }
}

/// Distance of a point from the nearest side wall (m), negative outside.
fn from_side_walls(region: &Region, p: &Point3) -> f64 {
    match *region {
        Region::Box { min, max } => {
            let of = |k: usize| (p[k] - min[k]).min(max[k] - p[k]);
            of(0).min(of(1))
        }
        Region::Cylinder { centre, radius, .. } => {
            radius - (p.x - centre[0]).hypot(p.y - centre[1])
        }
        Region::Sphere { centre, radius } => radius - (p - centre).norm(),
    }
}

impl TiltOptions {
    fn validate(&self) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        if !(1..=MOST_BINS).contains(&self.bins) {
            return refuse("bins", self.bins.into(), "1 to 900");
        }
        if !self.near_over_d.is_finite() || self.near_over_d <= 0.0 {
            return refuse("near_over_d", self.near_over_d, "above zero and finite");
        }
        Ok(())
    }
}

impl TiltGroup {
    fn of(tilts: impl Iterator<Item = f64>, bins: usize) -> Self {
        let mut counts = vec![0; bins];
        let (mut bodies, mut sum, mut squares) = (0, 0.0, 0.0);
        for tilt in tilts {
            // 90 degrees belong to the last bin.
            let bin = (tilt / 90.0 * bins as f64) as usize;
            counts[bin.min(bins - 1)] += 1;
            bodies += 1;
            sum += tilt;
            squares += tilt.to_radians().cos().powi(2);
        }
        let mean = |sum: f64| (bodies > 0).then(|| sum / f64::from(bodies));
        Self {
            bodies,
            mean: mean(sum),
            vertical_order: mean(squares).map(|square| 1.5 * square - 0.5),
            counts,
        }
    }
}

impl Table for TiltHistogram {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "low_deg",
            "high_deg",
            "random_share",
            "bodies",
            "share",
            "side_wall_bodies",
            "side_wall_share",
            "floor_bodies",
            "floor_share",
            "core_bodies",
            "core_share",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let groups = [
            Some(&self.all),
            self.side_walls.as_ref(),
            self.floor.as_ref(),
            self.core.as_ref(),
        ];
        Box::new(self.random.iter().enumerate().map(move |(k, random)| {
            let mut cells = vec![
                self.edges[k].into(),
                self.edges[k + 1].into(),
                (*random).into(),
            ];
            for group in groups {
                let count = group.map(|group| group.counts[k]);
                let share = group
                    .filter(|group| group.bodies > 0)
                    .map(|group| f64::from(group.counts[k]) / f64::from(group.bodies));
                cells.extend([count.into(), share.into()]);
            }
            cells
        }))
    }
}
