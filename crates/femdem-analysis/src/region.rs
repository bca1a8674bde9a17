//! Regions of space for measurements: boxes, upright cylinders, spheres.

use std::f64::consts::PI;

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::error::AnalysisError;

/// A region of space: where a density is measured, or the inside of a container.
///
/// The fields are plain data; every function that takes a region checks it first.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Region {
    /// Axis-aligned box.
    Box {
        /// Lower corner (m).
        min: Point3,
        /// Upper corner (m).
        max: Point3,
    },
    /// Cylinder with its axis along z.
    Cylinder {
        /// x and y of the axis (m).
        centre: [f64; 2],
        /// Radius (m).
        radius: f64,
        /// Height of the lower end (m).
        z_min: f64,
        /// Height of the upper end (m).
        z_max: f64,
    },
    /// Ball.
    Sphere {
        /// Centre (m).
        centre: Point3,
        /// Radius (m).
        radius: f64,
    },
}

/// The error for a sphere where upright walls are needed.
pub(crate) const NOT_UPRIGHT: AnalysisError = AnalysisError::RegionKind {
    what: "a floor with upright walls",
    instead: "a box or a cylinder",
};

/// Position of a body's box relative to a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    Outside,
    Inside,
    Crosses,
}

impl Region {
    /// Checks that every number is finite and that the region has a volume.
    ///
    /// # Errors
    /// [`AnalysisError::Region`] naming the first quantity at fault.
    pub fn validate(&self) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Region {
                name,
                value,
                allowed,
            })
        };
        let (numbers, extents) = match *self {
            Self::Box { min, max } => {
                let size = max - min;
                (
                    vec![
                        ("min.x", min.x),
                        ("min.y", min.y),
                        ("min.z", min.z),
                        ("max.x", max.x),
                        ("max.y", max.y),
                        ("max.z", max.z),
                    ],
                    vec![
                        ("max.x - min.x", size.x),
                        ("max.y - min.y", size.y),
                        ("max.z - min.z", size.z),
                    ],
                )
            }
            Self::Cylinder {
                centre,
                radius,
                z_min,
                z_max,
            } => (
                vec![
                    ("centre.x", centre[0]),
                    ("centre.y", centre[1]),
                    ("radius", radius),
                    ("z_min", z_min),
                    ("z_max", z_max),
                ],
                vec![("radius", radius), ("z_max - z_min", z_max - z_min)],
            ),
            Self::Sphere { centre, radius } => (
                vec![
                    ("centre.x", centre.x),
                    ("centre.y", centre.y),
                    ("centre.z", centre.z),
                    ("radius", radius),
                ],
                vec![("radius", radius)],
            ),
        };
        for (name, value) in numbers {
            if !value.is_finite() {
                return refuse(name, value, "a finite number of metres");
            }
        }
        for (name, value) in extents {
            if value <= 0.0 || !value.is_finite() {
                return refuse(name, value, "above zero and finite");
            }
        }
        if !self.volume().is_normal() {
            return refuse(
                "volume",
                self.volume(),
                "within the range of floating-point numbers",
            );
        }
        Ok(())
    }

    /// Volume (m³).
    pub fn volume(&self) -> f64 {
        match *self {
            Self::Box { min, max } => (max - min).product(),
            Self::Cylinder {
                radius,
                z_min,
                z_max,
                ..
            } => PI * radius * radius * (z_max - z_min),
            Self::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
        }
    }

    /// Whether `point` lies in the region or on its boundary.
    pub fn contains(&self, point: &Point3) -> bool {
        match *self {
            Self::Box { min, max } => (0..3).all(|k| min[k] <= point[k] && point[k] <= max[k]),
            Self::Cylinder {
                centre,
                radius,
                z_min,
                z_max,
            } => {
                let [x, y] = [point.x - centre[0], point.y - centre[1]];
                x * x + y * y <= radius * radius && z_min <= point.z && point.z <= z_max
            }
            Self::Sphere { centre, radius } => (point - centre).norm_squared() <= radius * radius,
        }
    }

    /// Whether the upright line through `x` and `y` (m) has a point in common with the region.
    pub(crate) fn stands_over(&self, x: f64, y: f64) -> bool {
        let height = match *self {
            Self::Box { min, .. } => min.z,
            Self::Cylinder { z_min, .. } => z_min,
            Self::Sphere { centre, .. } => centre.z,
        };
        self.contains(&Point3::new(x, y, height))
    }

    /// The region without the points within `distance` (m) of its boundary: the core by inset. A negative
    /// distance enlarges it.
    ///
    /// ```
    /// use femdem_analysis::Region;
    ///
    /// let drum = Region::Cylinder { centre: [0.0; 2], radius: 2.0, z_min: 0.0, z_max: 5.0 };
    /// let core = Region::Cylinder { centre: [0.0; 2], radius: 1.5, z_min: 0.5, z_max: 4.5 };
    /// assert_eq!(drum.inset(0.5)?, core);
    /// assert!(drum.inset(2.0).is_err());
    /// # Ok::<(), femdem_analysis::AnalysisError>(())
    /// ```
    ///
    /// # Errors
    /// [`AnalysisError::Region`] if nothing remains.
    pub fn inset(&self, distance: f64) -> Result<Self, AnalysisError> {
        let rest = match *self {
            Self::Box { min, max } => Self::Box {
                min: min.map(|x| x + distance),
                max: max.map(|x| x - distance),
            },
            Self::Cylinder {
                centre,
                radius,
                z_min,
                z_max,
            } => Self::Cylinder {
                centre,
                radius: radius - distance,
                z_min: z_min + distance,
                z_max: z_max - distance,
            },
            Self::Sphere { centre, radius } => Self::Sphere {
                centre,
                radius: radius - distance,
            },
        };
        rest.validate()?;
        Ok(rest)
    }

    /// The part of a box or a cylinder between two heights (m), over its whole width.
    ///
    /// ```
    /// use femdem_analysis::Region;
    ///
    /// let drum = Region::Cylinder { centre: [0.0; 2], radius: 2.0, z_min: 0.0, z_max: 5.0 };
    /// assert_eq!(drum.slab(1.0, 2.0)?.volume(), std::f64::consts::PI * 4.0);
    /// # Ok::<(), femdem_analysis::AnalysisError>(())
    /// ```
    ///
    /// # Errors
    /// [`AnalysisError::Region`] when nothing lies between the heights, [`AnalysisError::RegionKind`] for a
    /// sphere.
    pub fn slab(&self, low: f64, high: f64) -> Result<Self, AnalysisError> {
        let mut slab = *self;
        match &mut slab {
            Self::Box { min, max } => {
                // This form preserves NaN.
                min.z = if low < min.z { min.z } else { low };
                max.z = if high > max.z { max.z } else { high };
            }
            Self::Cylinder { z_min, z_max, .. } => {
                *z_min = if low < *z_min { *z_min } else { low };
                *z_max = if high > *z_max { *z_max } else { high };
            }
            Self::Sphere { .. } => return Err(NOT_UPRIGHT),
        }
        slab.validate()?;
        Ok(slab)
    }

    /// Lower and upper corner (m) of the smallest axis-aligned box around the region.
    pub fn corners(&self) -> (Point3, Point3) {
        match *self {
            Self::Box { min, max } => (min, max),
            Self::Cylinder {
                centre,
                radius,
                z_min,
                z_max,
            } => (
                Point3::new(centre[0] - radius, centre[1] - radius, z_min),
                Point3::new(centre[0] + radius, centre[1] + radius, z_max),
            ),
            Self::Sphere { centre, radius } => {
                (centre.map(|x| x - radius), centre.map(|x| x + radius))
            }
        }
    }

    /// Position of `bounds` relative to the region. `Inside` and `Outside` are certain; `Crosses` may be any.
    pub(crate) fn relation(&self, bounds: &Bounds) -> Relation {
        let (min, max) = self.corners();
        let around = Bounds { min, max };
        match *self {
            Self::Box { .. } => {
                if around.holds(bounds) {
                    Relation::Inside
                } else if around.meets(bounds) {
                    Relation::Crosses
                } else {
                    Relation::Outside
                }
            }
            Self::Cylinder {
                centre,
                radius,
                z_min,
                z_max,
            } => {
                let farthest = |k: usize| {
                    (bounds.min[k] - centre[k])
                        .abs()
                        .max((bounds.max[k] - centre[k]).abs())
                };
                let in_circle = farthest(0).hypot(farthest(1)) <= radius;
                if in_circle && z_min <= bounds.min.z && bounds.max.z <= z_max {
                    return Relation::Inside;
                }
                let nearest = |k: usize| {
                    (bounds.min[k] - centre[k])
                        .max(centre[k] - bounds.max[k])
                        .max(0.0)
                };
                let off_circle = nearest(0).hypot(nearest(1)) > radius;
                if off_circle || bounds.max.z < z_min || bounds.min.z > z_max {
                    return Relation::Outside;
                }
                Relation::Crosses
            }
            Self::Sphere { centre, radius } => {
                let (middle, half) = bounds.middle_and_half();
                let apart = (middle - centre).abs();
                if (apart + half).norm() <= radius {
                    Relation::Inside
                } else if (apart - half).map(|x| x.max(0.0)).norm() > radius {
                    Relation::Outside
                } else {
                    Relation::Crosses
                }
            }
        }
    }

    /// Equal parts for the block bootstrap, of side `side` or more: `floor(extent / side)` along each
    /// axis of a box (at least 1, at most 8), slices along z of a cylinder (at most 64), one for a sphere.
    pub(crate) fn blocks(&self, side: f64) -> Vec<Self> {
        // Round-off in an extent that is a whole multiple of the side must not cost a block.
        let parts =
            |extent: f64, most: f64| (extent / side + 1e-9).floor().clamp(1.0, most) as usize;
        let cut = |low: f64, high: f64, n: usize, i: usize| {
            if i == n {
                high
            } else {
                low + (high - low) * (i as f64 / n as f64)
            }
        };
        match *self {
            Self::Box { min, max } => {
                let n = [0, 1, 2].map(|k| parts(max[k] - min[k], 8.0));
                let mut blocks = Vec::with_capacity(n.iter().product());
                for z in 0..n[2] {
                    for y in 0..n[1] {
                        for x in 0..n[0] {
                            let corner = |step: usize| {
                                let at = [x + step, y + step, z + step];
                                Point3::from([0, 1, 2].map(|k| cut(min[k], max[k], n[k], at[k])))
                            };
                            blocks.push(Self::Box {
                                min: corner(0),
                                max: corner(1),
                            });
                        }
                    }
                }
                blocks
            }
            Self::Cylinder {
                centre,
                radius,
                z_min,
                z_max,
            } => {
                let n = parts(z_max - z_min, 64.0);
                let slice = |i| Self::Cylinder {
                    centre,
                    radius,
                    z_min: cut(z_min, z_max, n, i),
                    z_max: cut(z_min, z_max, n, i + 1),
                };
                (0..n).map(slice).collect()
            }
            Self::Sphere { .. } => vec![*self],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Region {
        Region::Box {
            min: Point3::origin(),
            max: Point3::new(1.0, 2.0, 3.0),
        }
    }

    fn cylinder() -> Region {
        Region::Cylinder {
            centre: [1.0, -2.0],
            radius: 0.5,
            z_min: -1.0,
            z_max: 3.0,
        }
    }

    #[test]
    fn bad_regions_are_refused_by_name() {
        let refused = |region: Region| match region.validate() {
            Err(AnalysisError::Region { name, .. }) => name,
            other => panic!("accepted or wrong error: {other:?}"),
        };
        assert_eq!(
            refused(Region::Box {
                min: Point3::new(0.0, f64::NAN, 0.0),
                max: Point3::new(1.0, 1.0, 1.0)
            }),
            "min.y"
        );
        assert_eq!(
            refused(Region::Box {
                min: Point3::origin(),
                max: Point3::new(1.0, 1.0, 0.0)
            }),
            "max.z - min.z"
        );
        let tall = Region::Cylinder {
            centre: [0.0; 2],
            radius: 1.0,
            z_min: 0.0,
            z_max: f64::INFINITY,
        };
        assert_eq!(refused(tall), "z_max");
        let thin = Region::Cylinder {
            centre: [0.0; 2],
            radius: -1.0,
            z_min: 0.0,
            z_max: 1.0,
        };
        assert_eq!(refused(thin), "radius");
        assert_eq!(
            refused(Region::Box {
                min: Point3::origin(),
                max: Point3::from([1e-200; 3])
            }),
            "volume"
        );
        assert!(unit_box().validate().is_ok() && cylinder().validate().is_ok());
    }

    #[test]
    fn blocks_tile_the_region() {
        for (region, side, count) in [
            (unit_box(), 0.9, 6),
            (unit_box(), 9.0, 1),
            (cylinder(), 1.5, 2),
        ] {
            let blocks = region.blocks(side);
            assert_eq!(blocks.len(), count);
            let sum: f64 = blocks.iter().map(Region::volume).sum();
            assert!((sum - region.volume()).abs() < 1e-12);
            assert_eq!(blocks[0].corners().0, region.corners().0);
            assert_eq!(blocks[count - 1].corners().1, region.corners().1);
        }
    }

    #[test]
    fn relation_of_boxes_to_a_cylinder() {
        let at = |x: f64, half: f64| Bounds {
            min: Point3::new(x - half, -2.0 - half, -half),
            max: Point3::new(x + half, -2.0 + half, half),
        };
        assert_eq!(cylinder().relation(&at(1.0, 0.35)), Relation::Inside);
        assert_eq!(cylinder().relation(&at(1.0, 0.36)), Relation::Crosses);
        assert_eq!(cylinder().relation(&at(1.6, 0.2)), Relation::Crosses);
        assert_eq!(cylinder().relation(&at(1.8, 0.2)), Relation::Outside);
    }

    #[test]
    fn json_round_trip() {
        for region in [unit_box(), cylinder()] {
            let text = serde_json::to_string(&region).unwrap();
            assert_eq!(serde_json::from_str::<Region>(&text).unwrap(), region);
        }
        assert!(
            serde_json::to_string(&unit_box())
                .unwrap()
                .contains(r#""min":[0.0,0.0,0.0]"#)
        );
    }
}
