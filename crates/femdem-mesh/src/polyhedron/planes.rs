//! Planes of faces, planarity and convexity.

use super::tolerances::{CONVEXITY_TOLERANCE, PLANARITY_TOLERANCE};
use super::topology::sides;
use crate::bvh::{Aabb, Bvh};
use crate::{MeshError, Point3, Vector3};
use std::cell::Cell;

/// A face whose area is less than this part of its squared perimeter has no reliable normal.
const AREA_TOLERANCE: f64 = 1e-12;

/// Mean plane of a polygon, after Newell.
pub(crate) struct Plane {
    /// Mean of the polygon's vertices.
    pub(crate) point: Point3,
    /// Unit normal, by the right-hand rule along the loop.
    pub(crate) normal: Vector3,
    /// Area of the polygon's projection on the plane.
    pub(crate) area: f64,
    perimeter: f64,
}

impl Plane {
    /// Plane of a loop of at least one valid vertex index.
    pub(crate) fn through(vertices: &[Point3], corners: &[u32]) -> Self {
        let first = vertices[corners[0] as usize];
        let mut sum = Vector3::zeros();
        let mut twice_area = Vector3::zeros();
        let mut perimeter = 0.0;
        for [a, b] in sides(corners) {
            let a = vertices[a as usize] - first;
            let b = vertices[b as usize] - first;
            sum += a;
            twice_area += a.cross(&b);
            perimeter += (b - a).norm();
        }
        let length = twice_area.norm();
        Self {
            point: first + sum / corners.len() as f64,
            normal: if length > 0.0 {
                twice_area / length
            } else {
                twice_area
            },
            area: 0.5 * length,
            perimeter,
        }
    }

    /// Signed distance of a point, positive on the side of the normal.
    pub(crate) fn distance(&self, point: &Point3) -> f64 {
        self.normal.dot(&(point - self.point))
    }

    /// Area over perimeter: between a half and a sixth of the height of a triangle.
    pub(crate) fn thickness(&self) -> f64 {
        self.area / self.perimeter
    }

    /// Whether the loop is too thin to have a normal.
    pub(crate) fn is_degenerate(&self, largest_coordinate: f64) -> bool {
        let rounding = f64::EPSILON * largest_coordinate;
        self.area <= self.perimeter * (AREA_TOLERANCE * self.perimeter).max(rounding)
    }
}

/// Every face has an area and is planar.
pub(super) fn check(vertices: &[Point3], faces: &[Vec<u32>], extent: f64) -> Result<(), MeshError> {
    let largest = vertices.iter().map(|v| v.coords.amax()).fold(0.0, f64::max);
    let allowed = PLANARITY_TOLERANCE * extent;
    for (face, corners) in faces.iter().enumerate() {
        let plane = Plane::through(vertices, corners);
        if plane.is_degenerate(largest) {
            return Err(MeshError::DegenerateFace {
                face,
                area: plane.area,
            });
        }
        for &vertex in corners {
            let distance = plane.distance(&vertices[vertex as usize]).abs();
            if distance > allowed {
                return Err(MeshError::NotPlanar {
                    face,
                    vertex,
                    distance,
                    allowed,
                });
            }
        }
    }
    Ok(())
}

/// Whether no vertex lies outside any face.
///
/// The vertices of neighbouring faces are tried first, so that a non-convex surface of many faces is detected
/// without comparing every face with every vertex.
pub(super) fn is_convex(vertices: &[Point3], faces: &[&[u32]], planes: &[Plane]) -> bool {
    let (low, high) = super::extent::bounding_box(vertices);
    let allowed = CONVEXITY_TOLERANCE * (high - low).norm();
    let mut owners: Vec<([u32; 2], usize)> = faces
        .iter()
        .enumerate()
        .flat_map(|(i, face)| sides(face).map(move |side| (side, i)))
        .collect();
    owners.sort_unstable();
    let edges_convex = owners.iter().all(|&([a, b], i)| {
        let opposite = owners.binary_search_by_key(&[b, a], |&(side, _)| side);
        opposite.is_ok_and(|k| {
            let neighbour = faces[owners[k].1];
            neighbour
                .iter()
                .all(|&v| planes[i].distance(&vertices[v as usize]) <= allowed)
        })
    });
    if !edges_convex {
        return false;
    }
    let points: Vec<Aabb> = vertices.iter().map(|&v| Aabb::of_points([v])).collect();
    let tree = Bvh::new(&points);
    let convex = Cell::new(true);
    for plane in planes {
        let offset = plane.normal.dot(&plane.point.coords);
        tree.visit(
            // Boxes are entered with a margin for rounding; the vertices themselves decide.
            |b| convex.get() && reach(b, &plane.normal) - offset > 0.5 * allowed,
            |v| {
                if plane.distance(&vertices[v as usize]) > allowed {
                    convex.set(false);
                }
            },
        );
    }
    convex.get()
}

/// Largest `direction . x` of the points x of a box.
fn reach(b: &Aabb, direction: &Vector3) -> f64 {
    let far = |k: usize| {
        if direction[k] > 0.0 {
            b.high[k]
        } else {
            b.low[k]
        }
    };
    (0..3).map(|k| direction[k] * far(k)).sum()
}
