//! Containers: a floor and upright walls, open at the top.

use crate::error::{PackError, check_positive};
use femdem_contact::Wall;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Planes that make the mantle of a cylinder; the cross-section is 0.036 % larger than the
/// circle's.
const MANTLE_FACETS: usize = 96;

/// What holds a pack. Inner dimensions in m; the floor is z = 0, the z axis is the container's
/// axis, and the walls reach up without end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Container {
    /// Four walls: |x| <= width/2, |y| <= depth/2.
    Box {
        /// Inner dimension along x, m.
        width: f64,
        /// Inner dimension along y, m.
        depth: f64,
    },
    /// An upright cylinder about the z axis.
    Cylinder {
        /// Inner diameter, m.
        diameter: f64,
    },
}

impl Container {
    /// Checks that the dimensions are positive and that a body of the given circumscribed
    /// diameter fits in any orientation.
    ///
    /// # Errors
    /// [`PackError::Parameter`] for a dimension that is not positive and finite,
    /// [`PackError::ContainerTooNarrow`] for one smaller than a body.
    pub fn validate(&self, body_diameter: f64) -> Result<(), PackError> {
        let check_side = |name: &'static str, side: &'static str, size: f64| {
            check_positive(name, size)?;
            if size < body_diameter {
                return Err(PackError::ContainerTooNarrow {
                    side,
                    size,
                    diameter: body_diameter,
                });
            }
            Ok(())
        };
        match *self {
            Self::Box { width, depth } => {
                check_side("container width", "width", width)?;
                check_side("container depth", "depth", depth)
            }
            Self::Cylinder { diameter } => check_side("container diameter", "diameter", diameter),
        }
    }

    /// The walls, in the order in which a pack adds them: "floor", then "x-", "x+", "y-", "y+"
    /// or "mantle".
    ///
    /// # Errors
    /// [`PackError::Contact`] if a dimension cannot bound a wall.
    pub fn walls(&self) -> Result<Vec<Wall>, PackError> {
        let mut walls = vec![Wall::half_space("floor", Vector3::z(), 0.0)?];
        match *self {
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
            Self::Cylinder { diameter } => {
                walls.push(Wall::cylinder("mantle", diameter / 2.0, MANTLE_FACETS)?);
            }
        }
        Ok(walls)
    }

    /// Area of the floor, m^2.
    pub fn floor_area(&self) -> f64 {
        match *self {
            Self::Box { width, depth } => width * depth,
            Self::Cylinder { diameter } => std::f64::consts::PI * diameter * diameter / 4.0,
        }
    }

    /// Length of the floor's edge, m.
    pub fn perimeter(&self) -> f64 {
        match *self {
            Self::Box { width, depth } => 2.0 * (width + depth),
            Self::Cylinder { diameter } => std::f64::consts::PI * diameter,
        }
    }

    /// Half the inner dimensions along x and y, m.
    pub fn half_extent(&self) -> [f64; 2] {
        match *self {
            Self::Box { width, depth } => [width / 2.0, depth / 2.0],
            Self::Cylinder { diameter } => [diameter / 2.0; 2],
        }
    }

    /// Whether the point (x, y) lies inside the walls by at least `margin` (m).
    pub fn contains(&self, x: f64, y: f64, margin: f64) -> bool {
        match *self {
            Self::Box { width, depth } => {
                x.abs() <= width / 2.0 - margin && y.abs() <= depth / 2.0 - margin
            }
            Self::Cylinder { diameter } => x.hypot(y) <= diameter / 2.0 - margin,
        }
    }

    /// Area of the points that lie inside the walls by at least `margin` (m), m^2.
    pub fn area_inside(&self, margin: f64) -> f64 {
        let [a, b] = self.half_extent().map(|h| (h - margin).max(0.0));
        match self {
            Self::Box { .. } => 4.0 * a * b,
            Self::Cylinder { .. } => std::f64::consts::PI * a * a,
        }
    }

    /// The point at which the unit square (u, v) in [0, 1)^2 meets the part of the floor that
    /// lies inside the walls by `margin`; uniform if u and v are.
    pub(crate) fn point(&self, u: f64, v: f64, margin: f64) -> [f64; 2] {
        let [a, b] = self.half_extent().map(|h| (h - margin).max(0.0));
        match self {
            Self::Box { .. } => [a * (2.0 * u - 1.0), b * (2.0 * v - 1.0)],
            Self::Cylinder { .. } => {
                let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
                let r = a * u.sqrt();
                [r * cos, r * sin]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Container = Container::Box {
        width: 0.2,
        depth: 0.1,
    };
    const CYLINDER: Container = Container::Cylinder { diameter: 0.2 };

    #[test]
    fn walls_enclose_what_the_container_contains() {
        for container in [BOX, CYLINDER] {
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

    #[test]
    fn walls_are_named_floor_first() {
        let names = |c: Container| -> Vec<String> {
            let walls = c.walls().unwrap();
            walls.iter().map(|w| w.name().to_owned()).collect()
        };
        assert_eq!(names(BOX), ["floor", "x-", "x+", "y-", "y+"]);
        assert_eq!(names(CYLINDER), ["floor", "mantle"]);
    }

    /// Mean of x^2 over a rectangle of half width a is a^2/3, over a disc of radius a it is a^2/4.
    #[test]
    fn points_cover_the_free_floor_evenly() {
        let margin = 0.02;
        for (container, expected) in [
            (BOX, [0.08_f64.powi(2) / 3.0, 0.03_f64.powi(2) / 3.0]),
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
        let cylinder = |diameter| Container::Cylinder { diameter };
        assert!(says(cylinder(0.149)).contains("diameter is 0.149 m"));
        assert!(says(cylinder(f64::NAN)).contains("diameter = NaN"));
        assert!(says(cylinder(-1.0)).contains("diameter = -1"));
    }
}
