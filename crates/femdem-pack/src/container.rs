//! Containers: a floor, possibly a cone, and upright walls or periodic space, open at the top.

mod mesh;

pub use mesh::MeshContainer;

use crate::error::{PackError, check, check_positive};
use femdem_contact::{Wall, WallPlane, WallShape};
use femdem_mesh::{PeriodicCell, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Planes that form the mantle of a cylinder; the cross-section is 0.036 % larger than the circle's.
const MANTLE_FACETS: usize = 96;

/// A container is wide enough for a body if it is narrower by no more than this part of the body's diameter.
/// This allows for rounding only; it is less than the slack of lattice layers.
const WIDTH_SLACK: f64 = 1e-10;

/// What holds a pack. Inner dimensions in m; the floor is z = 0, the z axis is the container's
/// axis, and the upright walls, if there are any, reach up without end.
///
/// ```
/// use femdem_pack::Container;
///
/// let tube = Container::Cylinder { diameter: 0.1 };
/// tube.validate(0.02)?;
/// assert!((tube.floor_area() - std::f64::consts::PI * 0.05 * 0.05).abs() < 1e-12);
/// assert!(tube.contains(0.03, 0.0, 0.01) && !tube.contains(0.045, 0.0, 0.01));
/// // Bodies of 0.2 m do not fit.
/// assert!(tube.validate(0.2).is_err());
/// # Ok::<(), femdem_pack::PackError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Container {
    /// Four walls: |x| <= width/2, |y| <= depth/2.
    Box {
        /// Inner dimension along x, m.
        width: f64,
        /// Inner dimension along y, m.
        depth: f64,
    },
    /// A floor without walls, that repeats itself with all that lies on it along x and y: the piece |x| <= width/2,
    /// |y| <= depth/2 of an endless bed.
    Periodic {
        /// Length after which space repeats itself along x, m.
        width: f64,
        /// The same along y, m.
        depth: f64,
    },
    /// An upright cylinder about the z axis.
    Cylinder {
        /// Inner diameter, m.
        diameter: f64,
    },
    /// An upright cylinder that narrows below, in a cone, to a closed flat outlet.
    Silo {
        /// Inner diameter of the cylinder, m.
        diameter: f64,
        /// Diameter of the floor at the foot of the cone, m; 0 for a pointed cone.
        outlet: f64,
        /// Angle between the cone's wall and the vertical, degrees.
        half_angle: f64,
    },
    /// A solid of any form with a hollow.
    Mesh(Box<MeshContainer>),
}

impl Container {
    /// Name of the floor's wall, which every container has.
    pub const FLOOR: &str = "floor";

    /// Checks that the dimensions are positive and that a body of the given circumscribed
    /// diameter (m) fits in any orientation, to rounding.
    ///
    /// # Errors
    /// [`PackError::Parameter`] for a dimension that is not positive and finite, or an outlet or angle of a silo out of
    /// its range, [`PackError::ContainerTooNarrow`] for a dimension smaller than a body.
    pub fn validate(&self, body_diameter: f64) -> Result<(), PackError> {
        let check_side = |name: &'static str, side: &'static str, size: f64| {
            check_positive(name, size)?;
            if size < body_diameter * (1.0 - WIDTH_SLACK) {
                return Err(PackError::ContainerTooNarrow {
                    side,
                    size,
                    diameter: body_diameter,
                });
            }
            Ok(())
        };
        match *self {
            Self::Mesh(ref mesh) => {
                check_side("container opening", "opening", 2.0 * mesh.opening())
            }
            Self::Box { width, depth } => {
                check_side("container width", "width", width)?;
                check_side("container depth", "depth", depth)
            }
            Self::Periodic { width, depth } => {
                let allowed = "at least 2.25 diameters of the largest body, so that no body meets another one on two sides";
                let least = PeriodicCell::LEAST_DIAMETERS * body_diameter;
                check(
                    "width of a periodic container",
                    width,
                    width >= least,
                    allowed,
                )?;
                check(
                    "depth of a periodic container",
                    depth,
                    depth >= least,
                    allowed,
                )
            }
            Self::Cylinder { diameter } => check_side("container diameter", "diameter", diameter),
            Self::Silo {
                diameter,
                outlet,
                half_angle,
            } => {
                check_side("container diameter", "diameter", diameter)?;
                check(
                    "silo outlet",
                    outlet,
                    (0.0..diameter).contains(&outlet),
                    "at least 0 and less than the diameter, in m",
                )?;
                check(
                    "silo half_angle",
                    half_angle,
                    (5.0..=85.0).contains(&half_angle),
                    "between 5 and 85 degrees from the vertical",
                )
            }
        }
    }

    /// The periodic cell, if it is [`Periodic`](Self::Periodic).
    ///
    /// # Errors
    /// [`PackError::Mesh`] for a dimension that is not positive and finite.
    pub fn cell(&self) -> Result<Option<PeriodicCell>, PackError> {
        match *self {
            Self::Periodic { width, depth } => {
                Ok(Some(PeriodicCell::new([Some(width), Some(depth), None])?))
            }
            _ => Ok(None),
        }
    }

    /// The walls, in the order in which a pack adds them: [`FLOOR`](Self::FLOOR), then "x-", "x+", "y-", "y+"
    /// or "mantle", and "cone", or a solid of its own name.
    ///
    /// # Errors
    /// [`PackError::Contact`] if a dimension cannot bound a wall.
    pub fn walls(&self) -> Result<Vec<WallShape>, PackError> {
        let mut walls = vec![Wall::half_space(Self::FLOOR, Vector3::z(), 0.0)?];
        match *self {
            Self::Mesh(ref mesh) => {
                let floor = walls.into_iter().map(WallShape::from);
                return Ok(floor.chain([mesh.wall()?.into()]).collect());
            }
            Self::Box { width, depth } => {
                for (name, normal, size) in [
                    ("x-", Vector3::x(), width),
                    ("x+", -Vector3::x(), width),
                    ("y-", Vector3::y(), depth),
                    ("y+", -Vector3::y(), depth),
                ] {
                    walls.push(Wall::half_space(name, normal, -size / 2.0)?);
                }
            }
            Self::Periodic { .. } => {}
            Self::Cylinder { diameter } => {
                walls.push(Wall::cylinder("mantle", diameter / 2.0, MANTLE_FACETS)?);
            }
            Self::Silo {
                diameter,
                outlet,
                half_angle,
            } => {
                walls.push(Wall::cylinder("mantle", diameter / 2.0, MANTLE_FACETS)?);
                walls.push(cone(outlet / 2.0, half_angle.to_radians())?);
            }
        }
        Ok(walls.into_iter().map(WallShape::from).collect())
    }

    /// Height, m, above which the container has its full width: 0, except for a silo, where it is the upper end
    /// of the cone, and for a solid of any form, where it is the rim.
    pub fn base(&self) -> f64 {
        match *self {
            Self::Mesh(ref mesh) => mesh.height(),
            Self::Box { .. } | Self::Periodic { .. } | Self::Cylinder { .. } => 0.0,
            Self::Silo {
                diameter,
                outlet,
                half_angle,
            } => (diameter - outlet) / 2.0 / half_angle.to_radians().tan(),
        }
    }

    /// Height, m, to which a volume, m^3, fills the container; a solid of any form counts as wide as its
    /// opening all the way down.
    pub fn level(&self, volume: f64) -> f64 {
        let Self::Silo {
            diameter,
            outlet,
            half_angle,
        } = *self
        else {
            return volume / self.floor_area();
        };
        let slope = half_angle.to_radians().tan();
        let (low, high) = (outlet / 2.0, diameter / 2.0);
        // A frustum of radii r and R holds pi (R^3 - r^3)/(3 tan).
        let cubes = low.powi(3) + 3.0 * slope * volume / PI;
        let radius = cubes.cbrt();
        if radius <= high {
            (radius - low) / slope
        } else {
            let cone = PI * (high.powi(3) - low.powi(3)) / (3.0 * slope);
            self.base() + (volume - cone) / self.floor_area()
        }
    }

    /// Area between the upright walls, or of the opening, m^2.
    pub fn floor_area(&self) -> f64 {
        match *self {
            Self::Mesh(ref mesh) => PI * mesh.opening() * mesh.opening(),
            Self::Box { width, depth } | Self::Periodic { width, depth } => width * depth,
            Self::Cylinder { diameter } | Self::Silo { diameter, .. } => {
                PI * diameter * diameter / 4.0
            }
        }
    }

    /// Length of the upright walls in plan, or around the opening, m.
    pub fn perimeter(&self) -> f64 {
        match *self {
            Self::Mesh(ref mesh) => TAU * mesh.opening(),
            Self::Box { width, depth } => 2.0 * (width + depth),
            Self::Periodic { .. } => 0.0,
            Self::Cylinder { diameter } | Self::Silo { diameter, .. } => PI * diameter,
        }
    }

    /// Half the inner dimensions along x and y, m.
    pub fn half_extent(&self) -> [f64; 2] {
        match *self {
            Self::Box { width, depth } | Self::Periodic { width, depth } => {
                [width / 2.0, depth / 2.0]
            }
            Self::Cylinder { diameter } | Self::Silo { diameter, .. } => [diameter / 2.0; 2],
            Self::Mesh(ref mesh) => [mesh.opening(); 2],
        }
    }

    /// Whether a point lies inside the container, m.
    pub fn holds(&self, p: &Vector3) -> bool {
        let below = match *self {
            Self::Mesh(ref mesh) => return mesh.holds(p),
            Self::Silo {
                outlet, half_angle, ..
            } => {
                let wall = outlet / 2.0 + p.z * half_angle.to_radians().tan();
                p.x.hypot(p.y) <= wall
            }
            _ => true,
        };
        p.z >= 0.0 && below && self.contains(p.x, p.y, 0.0)
    }

    /// Whether the point (x, y) lies inside the upright walls, or the opening, by at least `margin` (m). A periodic
    /// container has all of the plane inside.
    pub fn contains(&self, x: f64, y: f64, margin: f64) -> bool {
        match *self {
            Self::Box { width, depth } => {
                x.abs() <= width / 2.0 - margin && y.abs() <= depth / 2.0 - margin
            }
            Self::Periodic { .. } => true,
            Self::Cylinder { diameter } | Self::Silo { diameter, .. } => {
                x.hypot(y) <= diameter / 2.0 - margin
            }
            Self::Mesh(ref mesh) => x.hypot(y) <= mesh.opening() - margin,
        }
    }

    /// Area of the points that lie inside the upright walls by at least `margin` (m), m^2.
    pub fn area_inside(&self, margin: f64) -> f64 {
        let [a, b] = self.free_extent(margin);
        match self {
            Self::Box { .. } | Self::Periodic { .. } => 4.0 * a * b,
            _ => PI * a * a,
        }
    }

    /// Half the dimensions of the plan that lies inside the upright walls by `margin`, m.
    fn free_extent(&self, margin: f64) -> [f64; 2] {
        let margin = match self {
            Self::Periodic { .. } => 0.0,
            _ => margin,
        };
        self.half_extent().map(|h| (h - margin).max(0.0))
    }

    /// The point at which the unit square (u, v) in [0, 1)^2 meets the part of the plan that
    /// lies inside the upright walls by `margin`; uniform if u and v are.
    pub(crate) fn point(&self, u: f64, v: f64, margin: f64) -> [f64; 2] {
        let [a, b] = self.free_extent(margin);
        match self {
            Self::Box { .. } | Self::Periodic { .. } => [a * (2.0 * u - 1.0), b * (2.0 * v - 1.0)],
            _ => {
                let (sin, cos) = (TAU * v).sin_cos();
                let r = a * u.sqrt();
                [r * cos, r * sin]
            }
        }
    }
}

/// The cone of a silo from the radius of its outlet up: one wall of as many facets as a mantle.
fn cone(outlet: f64, half_angle: f64) -> Result<Wall, PackError> {
    let (sin, cos) = half_angle.sin_cos();
    let planes = (0..MANTLE_FACETS)
        .map(|k| {
            let (s, c) = (TAU * k as f64 / MANTLE_FACETS as f64).sin_cos();
            WallPlane {
                normal: Vector3::new(-cos * c, -cos * s, sin),
                offset: -outlet * cos,
            }
        })
        .collect();
    Ok(Wall::new("cone", planes)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Container = Container::Box {
        width: 0.2,
        depth: 0.1,
    };
    const PERIODIC: Container = Container::Periodic {
        width: 0.2,
        depth: 0.1,
    };
    const CYLINDER: Container = Container::Cylinder { diameter: 0.2 };
    const SILO: Container = Container::Silo {
        diameter: 0.2,
        outlet: 0.05,
        half_angle: 30.0,
    };

    #[test]
    fn walls_enclose_what_the_container_contains() {
        for container in [BOX, CYLINDER, SILO] {
            let walls = container.walls().unwrap();
            for i in -12..=12 {
                for j in -12..=12 {
                    let (x, y) = (0.0101 * f64::from(i), 0.0101 * f64::from(j));
                    let gap = walls
                        .iter()
                        .map(|w| w.clearance(&Vector3::new(x, y, 1.0)))
                        .fold(f64::INFINITY, f64::min);
                    // The facets of the mantle are tangent to the circle: up to 0.06 % outside.
                    let slack = 0.1 * 6e-4;
                    if container.contains(x, y, 0.0) {
                        assert!(gap >= 0.0, "{container:?} {x} {y}: {gap}");
                    } else {
                        assert!(gap <= slack, "{container:?} {x} {y}: {gap}");
                    }
                }
            }
        }
    }

    /// Inside and outside of a silo's cone agree with the clearance of its walls, at every height.
    #[test]
    fn a_silo_holds_what_its_walls_enclose() {
        let walls = SILO.walls().unwrap();
        for i in -11..=11 {
            for k in -2..=20 {
                let p = Vector3::new(0.0101 * f64::from(i), 0.0, 0.0103 * f64::from(k));
                let gaps = walls.iter().map(|w| w.clearance(&p));
                let gap = gaps.fold(f64::INFINITY, f64::min);
                assert_eq!(SILO.holds(&p), gap >= 0.0, "{p:?}: {gap}");
            }
        }
        assert!((SILO.base() - 0.075 * 3.0_f64.sqrt()).abs() < 1e-15);
    }

    /// The volume below a level, integrated over slices, is the one that was filled in.
    #[test]
    fn a_volume_fills_a_silo_to_its_level() {
        for volume in [1e-5, 5e-4, 1.6e-3, 2e-3, 5e-3] {
            let level = SILO.level(volume);
            let n = 20_000;
            let slices = (0..n).map(|i| {
                let z = level * (f64::from(i) + 0.5) / f64::from(n);
                let radius = (0.025 + z / 3.0_f64.sqrt()).min(0.1);
                PI * radius * radius * level / f64::from(n)
            });
            let filled: f64 = slices.sum();
            assert!((filled / volume - 1.0).abs() < 1e-6, "{volume}: {filled}");
        }
        assert!((BOX.level(0.004) - 0.2).abs() < 1e-15);
    }

    #[test]
    fn walls_are_named_floor_first() {
        let names = |c: Container| -> Vec<String> {
            let walls = c.walls().unwrap();
            walls.iter().map(|w| w.name().to_owned()).collect()
        };
        assert_eq!(names(BOX), ["floor", "x-", "x+", "y-", "y+"]);
        assert_eq!(names(PERIODIC), ["floor"]);
        assert_eq!(names(CYLINDER), ["floor", "mantle"]);
        assert_eq!(names(SILO), ["floor", "mantle", "cone"]);
    }

    /// Mean of x^2 over a rectangle of half width a is a^2/3, over a disc of radius a it is a^2/4.
    #[test]
    fn points_cover_the_free_floor_evenly() {
        let margin = 0.02;
        for (container, expected) in [
            (BOX, [0.08_f64.powi(2) / 3.0, 0.03_f64.powi(2) / 3.0]),
            // Without walls there is nothing to keep clear of.
            (PERIODIC, [0.1_f64.powi(2) / 3.0, 0.05_f64.powi(2) / 3.0]),
            (CYLINDER, [0.08_f64.powi(2) / 4.0; 2]),
        ] {
            let n = 200;
            let mut square = [0.0; 2];
            for i in 0..n {
                for j in 0..n {
                    let place = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
                    let [x, y] = container.point(place(i), place(j), margin);
                    assert!(container.contains(x, y, margin - 1e-12));
                    square[0] += x * x / f64::from(n * n);
                    square[1] += y * y / f64::from(n * n);
                }
            }
            for (s, e) in square.iter().zip(expected) {
                assert!((s / e - 1.0).abs() < 1e-3, "{container:?}: {s} for {e}");
            }
        }
    }

    #[test]
    fn narrow_and_impossible_containers_are_refused_by_name() {
        let says = |c: Container| c.validate(0.15).unwrap_err().to_string();
        assert!(BOX.validate(0.1).is_ok());
        assert!(says(BOX).contains("depth is 0.1 m"));
        assert!(says(BOX).contains("at least 0.15 m"));
        assert!(PERIODIC.validate(0.044).is_ok());
        assert!(
            PERIODIC
                .validate(0.05)
                .unwrap_err()
                .to_string()
                .contains("2.25 diameters")
        );
        assert!(
            PERIODIC
                .cell()
                .unwrap()
                .is_some_and(|cell| cell.repeats(1) && !cell.repeats(2))
        );
        let cylinder = |diameter| Container::Cylinder { diameter };
        assert!(says(cylinder(0.149)).contains("diameter is 0.149 m"));
        assert!(says(cylinder(f64::NAN)).contains("diameter = NaN"));
        assert!(says(cylinder(-1.0)).contains("diameter = -1"));
        let silo = |outlet, half_angle| Container::Silo {
            diameter: 0.2,
            outlet,
            half_angle,
        };
        assert!(says(silo(0.2, 30.0)).contains("outlet = 0.2"));
        assert!(says(silo(0.1, 90.0)).contains("half_angle = 90"));
    }
}
