//! Overlapping spheres as one surface.

use super::family::{Value, family};
use super::level_set::LevelSet;
use super::weld::centred;
use crate::{MeshError, Point3, Polyhedron, Vector3};

/// Most spheres of a clump.
const MOST_SPHERES: usize = 1000;

/// A sphere of a [`Clump`], in units of the clump's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClumpSphere {
    /// Centre.
    pub centre: Point3,
    /// Radius.
    pub radius: f64,
}

/// The spheres of a [`Clump`]: 1 to 1000.
///
/// As text `x y z r` each, separated by `/`.
#[derive(Clone, Debug, PartialEq)]
pub struct ClumpSpheres(pub Vec<ClumpSphere>);

impl Value for ClumpSpheres {
    type Bound = &'static str;

    fn parse(text: &str) -> Option<Self> {
        let sphere = |part: &str| {
            let numbers: Option<Vec<f64>> = part
                .split_whitespace()
                .map(|word| word.parse().ok())
                .collect();
            match numbers?[..] {
                [x, y, z, radius] => Some(ClumpSphere {
                    centre: Point3::new(x, y, z),
                    radius,
                }),
                _ => None,
            }
        };
        text.split('/').map(sphere).collect::<Option<_>>().map(Self)
    }

    fn text(&self) -> String {
        let spheres: Vec<String> = self
            .0
            .iter()
            .map(|s| format!("{} {} {} {}", s.centre.x, s.centre.y, s.centre.z, s.radius))
            .collect();
        spheres.join("/")
    }

    fn within(&self, _: &&'static str, _: &&'static str) -> bool {
        // Each coordinate by itself: the largest of them may leave out one that is not a number.
        let inside = |s: &ClumpSphere| {
            s.centre.iter().all(|x| x.abs() <= 100.0) && (1e-3..=100.0).contains(&s.radius)
        };
        (1..=MOST_SPHERES).contains(&self.0.len()) && self.0.iter().all(inside)
    }
}

family! {
    /// A clump: the union of overlapping spheres as one closed surface.
    ///
    /// Vertices lie on the spheres. Creases between spheres come out bevelled over about an edge
    /// length, half a cell. The volume of two equal overlapping spheres is 1.5 % too small with 2 cells per radius,
    /// 0.6 % with 3 and 0.15 % with 6. Cells are as small as the smallest sphere asks for and span
    /// the whole clump: spheres of very different size cost many.
    Clump = "clump", "union of overlapping spheres", size: "the unit of the centres and radii" {
        /// The spheres, `x y z r` each, separated by `/`; coordinates up to 100, radii from 0.001
        /// to 100. They must hang together.
        spheres: ClumpSpheres = ClumpSpheres(vec![
            ClumpSphere { centre: Point3::new(-0.25, 0.0, 0.0), radius: 0.25 },
            ClumpSphere { centre: Point3::new(0.1, 0.0, 0.0), radius: 0.3 },
            ClumpSphere { centre: Point3::new(0.1, 0.3, 0.1), radius: 0.2 },
        ]), in "1", "1000 spheres";
        /// Cells of the sampling lattice per smallest radius.
        cells: f64 = 2.5, in 1.0, 10.0;
    }
}

impl Clump {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let spheres = &self.spheres.0;
        let smallest = spheres
            .iter()
            .map(|s| s.radius)
            .fold(f64::INFINITY, f64::min);
        let first = spheres.first().map_or_else(Point3::origin, |s| s.centre);
        let (mut low, mut high) = (first, first);
        for s in spheres {
            low = low.inf(&s.centre.map(|x| x - s.radius));
            high = high.sup(&s.centre.map(|x| x + s.radius));
        }
        let surface = LevelSet {
            distance: |p: &Point3| distance(spheres, p),
            project: |p: &Point3| project(spheres, p),
            low,
            high,
            cell: smallest / self.cells,
        };
        centred(&surface.polyhedron()?)
    }
}

/// Signed distance of a point from the union of spheres; inside it is a bound.
fn distance(spheres: &[ClumpSphere], p: &Point3) -> f64 {
    spheres
        .iter()
        .map(|s| (p - s.centre).norm() - s.radius)
        .fold(f64::INFINITY, f64::min)
}

/// The nearest point of the nearest sphere; the mean of such points for spheres equally near, so
/// that symmetry is kept.
fn project(spheres: &[ClumpSphere], p: &Point3) -> Point3 {
    let nearest = distance(spheres, p);
    let (mut sum, mut count) = (Vector3::zeros(), 0.0);
    for s in spheres {
        let out = p - s.centre;
        let length = out.norm();
        if length > 0.0 && length - s.radius <= nearest + 1e-9 * s.radius {
            sum += out * (s.radius / length - 1.0);
            count += 1.0;
        }
    }
    p + sum / f64::max(count, 1.0)
}
