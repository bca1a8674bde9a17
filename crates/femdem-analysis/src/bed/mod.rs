//! The whole bed: its void fraction, and what it holds per volume.

mod section;

use std::f64::consts::PI;

use femdem_mesh::{Point3, Polyhedron};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::density::{exact_density, volumes_of_bodies};
use crate::error::AnalysisError;
use crate::lines::crossing;
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::region::{NOT_UPRIGHT, Region};
use crate::top::{TopPlane, top_plane};
use section::hollow_volume;

/// What a bed lies in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Vessel {
    /// Upright walls on a level floor: a box or a cylinder, its faces being walls and floor.
    Upright(Region),
    /// An upright cylinder that narrows below, in a cone, to a level floor.
    Silo {
        /// Axis (m).
        centre: [f64; 2],
        /// Radius of the cylinder (m).
        radius: f64,
        /// Radius of the floor at the foot of the cone (m), 0 or more and below that of the cylinder.
        outlet_radius: f64,
        /// Height of the floor (m).
        floor: f64,
        /// Height (m) where the cone ends and the cylinder begins.
        waist: f64,
    },
    /// The hollow of a solid that is open at the top, above a level floor.
    Solid {
        /// Surface of the solid, in the world.
        surface: Box<Polyhedron>,
        /// Height of the floor that closes what is open below (m).
        floor: f64,
    },
}

/// A whole bed, over the whole cross-section of its vessel and from the floor to its top. Lengths in m.
///
/// **The top** is the mean, over upright lines on a square grid, of the height of the highest solid point on each
/// line ([`top_plane`]): the level to which the bed would be filled if its surface were smoothed out without
/// changing the space below it. The highest point of all would count air above the bed as voids of the bed, and the
/// highest centroid would cut off solid. Bodies that the top cuts count with their parts below it, cut exactly. The
/// uppermost half diameter is looser than the rest and counts, as does the looser zone at the walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bed {
    /// Height of the floor (m).
    pub floor: f64,
    /// Height of the top (m): the mean of `surface`, or the upper end of the container where that is lower.
    pub top: f64,
    /// Heights of the surface of the bed.
    pub surface: TopPlane,
    /// Volume of the vessel between floor and top (m³).
    pub volume: f64,
    /// Solid volume there (m³), volumes shared by pairs of bodies counted once.
    pub solid: f64,
    /// Packing density: `solid / volume`.
    pub density: f64,
    /// Void fraction: the rest, `1 - density`.
    pub void_fraction: f64,
    /// Number of bodies, each as the part of its volume that lies there.
    pub bodies: f64,
    /// Bodies per volume of the bed (1/m³).
    pub bodies_per_volume: f64,
    /// Surface area of the bodies per volume of the bed (1/m), each with the same part of its area as of its volume;
    /// areas in contact are not subtracted.
    pub area_per_volume: f64,
}

/// Measures the whole bed. `column_spacing_over_d` is the distance of the lines that find the top, in mean
/// diameters, as in [`CoreOptions`](crate::CoreOptions).
///
/// Volumes of bodies and of vessels are exact to round-off (of a solid: for up to 4096 different heights of
/// its vertices). Bodies in a silo or a solid are cut by floor and top only, so that their small overlaps with the
/// walls count as solid. Closed hollows of a solid count as space of the bed.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, Region, Vessel, measure_bed};
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// // A cube of side 1 m in the corner of a floor of 2 m x 1 m, and one on it.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let at = |z| PosedBody { shape: 0, pose: Pose::translation(0.5, 0.5, z) };
/// let bodies = [at(0.5), at(1.5)];
/// let container = Region::Box { min: Point3::origin(), max: Point3::new(2.0, 1.0, 9.0) };
/// let bed = measure_bed(&Pack::new(&cube, &bodies)?, &Vessel::Upright(container), 0.25)?;
/// // Lines that meet no body do not count for the top.
/// assert!((bed.top - 2.0).abs() < 1e-12 && (bed.void_fraction - 0.5).abs() < 1e-12);
/// assert!((bed.area_per_volume - 12.0 / 4.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a sphere,
/// [`AnalysisError::Option`] for the spacing or a silo's dimensions, [`AnalysisError::NoPackInContainer`],
/// [`AnalysisError::GridTooFine`]; of a solid [`AnalysisError::AboveRim`] and [`AnalysisError::NotEnclosed`].
pub fn measure_bed(
    pack: &Pack,
    vessel: &Vessel,
    column_spacing_over_d: f64,
) -> Result<Bed, AnalysisError> {
    let diameter = pack.mean_diameter()?;
    let (floor, footprint) = vessel.footprint(pack, diameter)?;
    let surface = top_plane(pack, &footprint, column_spacing_over_d * diameter)?;
    let top = match vessel {
        Vessel::Upright(region) => surface.mean.min(region.corners().1.z),
        _ => surface.mean,
    };
    if top <= floor {
        return Err(AnalysisError::NoPackInContainer {
            mean_top: surface.mean,
            floor,
        });
    }
    let (region, volume) = vessel.below(pack, &footprint, top)?;
    let solid = exact_density(pack, &region)?;
    let solid = solid.body_volume - solid.overlap_volume;
    let (mut bodies, mut area) = (0.0, 0.0);
    for (body, part) in volumes_of_bodies(pack, &region).into_iter().enumerate() {
        let shape = pack.shape(body);
        let part = part / shape.mass_properties().volume;
        bodies += part;
        area += part * shape.area();
    }
    let density = solid / volume;
    Ok(Bed {
        floor,
        top,
        surface,
        volume,
        solid,
        density,
        void_fraction: 1.0 - density,
        bodies,
        bodies_per_volume: bodies / volume,
        area_per_volume: area / volume,
    })
}

impl Vessel {
    /// Height of the floor, and a region over which lines find the top.
    fn footprint(&self, pack: &Pack, diameter: f64) -> Result<(f64, Region), AnalysisError> {
        Ok(match *self {
            Self::Upright(Region::Sphere { .. }) => return Err(NOT_UPRIGHT),
            Self::Upright(region) => {
                region.validate()?;
                (region.corners().0.z, region)
            }
            Self::Silo {
                centre,
                radius,
                outlet_radius,
                floor,
                waist,
            } => {
                let refuse = |name, value, allowed| AnalysisError::Option {
                    name,
                    value,
                    allowed,
                };
                if !(0.0..radius).contains(&outlet_radius) {
                    let allowed = "0 or more, and below the radius of the cylinder (m)";
                    return Err(refuse("outlet_radius", outlet_radius, allowed));
                }
                if !(waist > floor && waist.is_finite()) {
                    return Err(refuse("waist", waist, "above the floor, and finite (m)"));
                }
                let cylinder = Region::Cylinder {
                    centre,
                    radius,
                    z_min: floor,
                    z_max: floor + diameter,
                };
                cylinder.validate()?;
                (floor, cylinder)
            }
            Self::Solid { floor, .. } => {
                let around = around(pack);
                let footprint = Region::Box {
                    min: Point3::new(around.min.x, around.min.y, floor),
                    max: Point3::new(around.max.x, around.max.y, floor + diameter),
                };
                footprint.validate()?;
                (floor, footprint)
            }
        })
    }

    /// The region that cuts the bodies, and the volume of the vessel from the floor to `top`.
    fn below(
        &self,
        pack: &Pack,
        footprint: &Region,
        top: f64,
    ) -> Result<(Region, f64), AnalysisError> {
        let around = around(pack);
        let (floor, volume) = match *self {
            Self::Upright(_) => {
                let bed = footprint.slab(f64::NEG_INFINITY, top)?;
                return Ok((bed, bed.volume()));
            }
            Self::Silo {
                radius,
                outlet_radius,
                floor,
                waist,
                ..
            } => {
                let height = top.min(waist) - floor;
                let wide = outlet_radius + (radius - outlet_radius) * height / (waist - floor);
                let cone =
                    (outlet_radius * outlet_radius + outlet_radius * wide + wide * wide) / 3.0;
                let above = radius * radius * (top - waist).max(0.0);
                (floor, PI * (cone * height + above))
            }
            Self::Solid { ref surface, floor } => {
                let rim = surface.vertices().iter().map(|v| v.z);
                let rim = rim.fold(f64::NEG_INFINITY, f64::max);
                if top > rim {
                    return Err(AnalysisError::AboveRim { top, rim });
                }
                let outside = first_not_enclosed(pack, surface, floor, top)?;
                if let Some(body) = outside {
                    return Err(AnalysisError::NotEnclosed { body });
                }
                (floor, hollow_volume(surface, floor, top))
            }
        };
        let region = Region::Box {
            min: Point3::new(around.min.x, around.min.y, floor),
            max: Point3::new(around.max.x, around.max.y, top),
        };
        region.validate()?;
        Ok((region, volume))
    }
}

/// Box around all bodies.
fn around(pack: &Pack) -> Bounds {
    let corners = (0..pack.len()).map(|i| pack.bounds(i));
    Bounds::around(corners.flat_map(|bounds| [bounds.min, bounds.max]))
}

/// The first body with its centroid between floor and top that does not have the solid on all four sides, along x
/// and y: the solid is open there, or the body lies outside.
fn first_not_enclosed(
    pack: &Pack,
    surface: &Polyhedron,
    floor: f64,
    top: f64,
) -> Result<Option<usize>, AnalysisError> {
    let triangles: Vec<[Point3; 3]> = surface
        .triangles()
        .into_iter()
        .map(|t| t.map(|v| surface.vertices()[v as usize]))
        .collect();
    let enclosed = ordered_map(
        pack.len(),
        || (),
        |(), body| {
            let centre = pack.centroid(body);
            if !(floor..=top).contains(&centre.z) {
                return true;
            }
            let mut sides = [[false; 2]; 2];
            for triangle in &triangles {
                for (axis, sides) in sides.iter_mut().enumerate() {
                    if let Some(at) = crossing(triangle, axis, &centre) {
                        sides[usize::from(at > centre[axis])] = true;
                    }
                }
            }
            sides == [[true; 2]; 2]
        },
    );
    Ok(enclosed.iter().position(|enclosed| !enclosed))
}
