//! Containers of any form.

use crate::error::{PackError, check};
use femdem_contact::{ContactError, MeshWall};
use femdem_mesh::nalgebra::{Point2, Translation3, UnitQuaternion, Vector2};
use femdem_mesh::tet::{self, MeshOptions};
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};
use serde::{Deserialize, Serialize};

/// The opening is measured below the highest point by this part of the height.
const BELOW_RIM: f64 = 1e-3;

/// Depth of the walls' contact skin, over the solid's volume divided by its area (half the thickness of a
/// plate).
const SKIN: f64 = 0.8;

/// A container of any form: a solid with a hollow that is open at the top.
///
/// The solid is placed with its lowest point at z = 0 and the middle of its bounding box on the z
/// axis. Bodies come in through the largest circle about that axis that is free at the rim; a floor
/// at z = 0 closes what is open below.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct MeshContainer {
    name: String,
    surface: Polyhedron,
    /// Radius of the opening, m.
    opening: f64,
    /// Upper corner of the bounding box, m.
    high: Vector3,
}

/// The stored form of a container.
#[derive(Serialize, Deserialize)]
#[serde(rename = "MeshContainer", deny_unknown_fields)]
struct Parts {
    name: String,
    surface: Polyhedron,
}

impl TryFrom<Parts> for MeshContainer {
    type Error = PackError;

    fn try_from(parts: Parts) -> Result<Self, PackError> {
        Self::new(parts.name, &parts.surface)
    }
}

impl From<MeshContainer> for Parts {
    fn from(container: MeshContainer) -> Self {
        Self {
            name: container.name,
            surface: container.surface,
        }
    }
}

impl MeshContainer {
    /// A container from the surface of its solid; `name` is that of its wall in results.
    ///
    /// # Errors
    /// [`PackError::Parameter`] if it has no opening about its axis at the top.
    pub fn new(name: impl Into<String>, surface: &Polyhedron) -> Result<Self, PackError> {
        let (low, high) = corners(surface);
        let middle = (low.coords + high.coords) / 2.0;
        let foot = Vector3::new(middle.x, middle.y, low.z);
        // A container that is already placed keeps its bits.
        let placed = if foot.norm() <= 1e-12 * (high - low).norm() {
            surface.clone()
        } else {
            surface.transformed(&Pose::from_parts(
                Translation3::from(-foot),
                UnitQuaternion::identity(),
            ))?
        };
        let opening = opening(&placed);
        check(
            "radius of the container's opening",
            opening,
            opening > 0.0,
            "above 0: the middle of the container must be open at the top, and z must point upwards",
        )?;
        let high = corners(&placed).1.coords;
        Ok(Self {
            name: name.into(),
            surface: placed,
            opening,
            high,
        })
    }

    /// The surface of the solid, as placed.
    pub fn surface(&self) -> &Polyhedron {
        &self.surface
    }

    /// Radius of the opening, m.
    pub fn opening(&self) -> f64 {
        self.opening
    }

    /// Height of the rim, m.
    pub fn height(&self) -> f64 {
        self.high.z
    }

    /// Whether a point lies above the floor and outside the solid.
    pub(super) fn holds(&self, p: &Vector3) -> bool {
        p.z >= 0.0 && p.x.abs() <= self.high.x && p.y.abs() <= self.high.y
    }

    /// The wall: the exact skin of the solid or, if its edges do not allow that, its tetrahedra.
    pub(super) fn wall(&self) -> Result<MeshWall, PackError> {
        let solid = &self.surface;
        let thickness = SKIN * solid.mass_properties().volume / solid.area();
        let points = solid.vertices().to_vec();
        match MeshWall::sheet(&self.name, points, solid.triangles(), thickness) {
            Ok(wall) => Ok(wall),
            Err(ContactError::Wall { .. }) => {
                let (mesh, _) = tet::mesh(solid, &MeshOptions::default())?;
                Ok(MeshWall::solid(&self.name, &mesh))
            }
            Err(other) => Err(other.into()),
        }
    }
}

/// Corners of the bounding box.
fn corners(solid: &Polyhedron) -> (Point3, Point3) {
    let first = solid.vertices().first().copied().unwrap_or_default();
    let vertices = solid.vertices().iter();
    vertices.fold((first, first), |(low, high), p| (low.inf(p), high.sup(p)))
}

/// Radius of the largest free circle about the z axis just below the highest point, m; 0 if the axis
/// runs through the solid there.
fn opening(solid: &Polyhedron) -> f64 {
    let (low, high) = corners(solid);
    let level = high.z - BELOW_RIM * (high.z - low.z);
    let mut nearest = f64::INFINITY;
    let mut crossings = 0;
    for triangle in solid.triangles() {
        let corners = triangle.map(|i| solid.vertices()[i as usize]);
        let Some([a, b]) = cut(corners, level) else {
            continue;
        };
        nearest = nearest.min(distance(a, b));
        // Sides that cross the positive x axis: an odd number of them encloses the origin.
        if (a.y > 0.0) != (b.y > 0.0) {
            let x = a.x - a.y * (b.x - a.x) / (b.y - a.y);
            crossings += usize::from(x > 0.0);
        }
    }
    // An even number of sides: the axis is outside the solid. None: nothing is around it.
    if crossings % 2 == 0 && crossings > 0 {
        nearest
    } else {
        0.0
    }
}

/// Where a triangle crosses a level.
fn cut(corners: [Point3; 3], level: f64) -> Option<[Point2<f64>; 2]> {
    let mut ends = (0..3).filter_map(|k| {
        let (p, q) = (corners[k], corners[(k + 1) % 3]);
        ((p.z > level) != (q.z > level)).then(|| {
            let t = (level - p.z) / (q.z - p.z);
            (p + (q - p) * t).xy()
        })
    });
    Some([ends.next()?, ends.next()?])
}

/// Distance of a segment from the origin.
fn distance(a: Point2<f64>, b: Point2<f64>) -> f64 {
    let along: Vector2<f64> = b - a;
    let square = along.norm_squared();
    let t = if square > 0.0 {
        (-a.coords.dot(&along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a.coords + along * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::tet::RevolvedShell;

    /// A funnel 0.5 m wide above and 0.1 m below, moved and turned away from its place.
    fn funnel() -> Polyhedron {
        let hopper = RevolvedShell {
            profile: vec![[0.05, 0.0], [0.25, 0.3]],
            thickness: 0.02,
            facets: 24,
        };
        let surface = hopper.mesh().unwrap().surface().unwrap();
        surface
            .transformed(&Pose::translation(3.0, -2.0, 1.0))
            .unwrap()
    }

    #[test]
    fn a_funnel_is_placed_and_its_opening_found() {
        let container = MeshContainer::new("funnel", &funnel()).unwrap();
        // The plates end at right angles to themselves, so that the solid is a little higher inside.
        assert!(
            (container.opening() - 0.25).abs() < 2e-3,
            "{}",
            container.opening()
        );
        assert!((0.3..0.33).contains(&container.height()));
        let lowest = container.surface().vertices().iter().map(|p| p.z);
        assert!(lowest.fold(f64::INFINITY, f64::min).abs() < 1e-12);
        let again = MeshContainer::new("funnel", container.surface()).unwrap();
        assert!(again == container, "placing it again moves it");
    }

    /// The wall has the clearance of the funnel's inner cone, and no body gets under it.
    #[test]
    fn the_wall_is_where_the_solid_is() {
        let wall = MeshContainer::new("funnel", &funnel())
            .unwrap()
            .wall()
            .unwrap();
        assert_eq!(wall.name(), "funnel");
        let (low, high) = wall.solid_wall().bounds();
        assert!(
            low.z > -1e-9 && high.z < 0.33 && high.x > 0.25 && high.x < 0.3,
            "{low} {high}"
        );
    }

    #[test]
    fn a_solid_without_a_hollow_is_refused() {
        let block = femdem_mesh::shapes::Shape::from(femdem_mesh::shapes::Cuboid::default());
        let error = MeshContainer::new("block", &block.polyhedron(1.0).unwrap()).unwrap_err();
        assert!(error.to_string().contains("open at the top"), "{error}");
    }
}
