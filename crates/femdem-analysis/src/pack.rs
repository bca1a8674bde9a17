//! The input: shapes and posed bodies, checked once.

use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{PeriodicCell, Point3, Polyhedron, Pose, Vector3, closest_point, unit_pose};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::lines::crossing;
use crate::region::Region;

/// A body: its shape and pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PosedBody {
    /// Index into the pack's list of shapes.
    pub shape: u32,
    /// Body frame to world frame; translation in metres.
    pub pose: Pose,
}

/// Data of a shape that the analyses need, computed once.
#[derive(Clone, Debug)]
struct ShapeData {
    /// Outward unit normal and offset of each face's plane, body frame.
    planes: Vec<(Vector3, f64)>,
    /// Whether the shape is handled by its planes: it is convex and has few of them.
    by_planes: bool,
    /// Triangles of the surface, and a tree over them; filled only for shapes that are handled by triangles.
    triangles: Vec<[u32; 3]>,
    tree: Bvh,
    /// Largest coordinate of a vertex.
    farthest: f64,
    diameter: f64,
}

/// Largest number of faces for which cutting by all planes is faster than looking up triangles in a tree.
const MOST_PLANES: usize = 64;

/// Regions are as wide as the cell, or as each other, to this part of their width: numbers are typed with 7 digits or more.
pub(crate) const WHOLE: f64 = 1e-6;

/// A checked pack: shapes, the bodies that use them, and a box around each body.
///
/// The bodies can come from a simulation, a file, or someone else's code.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody};
/// use femdem_mesh::{Pose, catalogue::CatalogueShape};
///
/// let shapes = ["P5".parse::<CatalogueShape>()?.polyhedron(0.1)?];
/// let bodies = [PosedBody { shape: 0, pose: Pose::translation(0.0, 0.0, 0.05) }];
/// let pack = Pack::new(&shapes, &bodies)?;
/// assert!((pack.mean_diameter()? - 0.1).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Pack<'a> {
    shapes: &'a [Polyhedron],
    bodies: &'a [PosedBody],
    /// Their poses, with quaternions of unit length to rounding.
    poses: Vec<Pose>,
    data: Vec<ShapeData>,
    bounds: Vec<Bounds>,
    /// How many of the bodies, the first ones, are no images.
    own: usize,
    /// The body that each of the others is an image of.
    sources: &'a [u32],
    /// Periodic space.
    cell: Option<PeriodicCell>,
}

impl<'a> Pack<'a> {
    /// Checks indices and poses. An empty pack is allowed here and refused by analyses that need a body.
    /// Quaternions that differ a little from unit length are normalised, so that they turn bodies without
    /// stretching them.
    ///
    /// # Errors
    /// [`AnalysisError::TooManyBodies`], [`AnalysisError::ShapeIndex`], or [`AnalysisError::Pose`]
    /// when a pose is not finite or its quaternion's length differs from 1 by more than 1e-6.
    pub fn new(shapes: &'a [Polyhedron], bodies: &'a [PosedBody]) -> Result<Self, AnalysisError> {
        if u32::try_from(bodies.len()).is_err() {
            return Err(AnalysisError::TooManyBodies {
                bodies: bodies.len(),
            });
        }
        let mut poses = Vec::with_capacity(bodies.len());
        let mut bounds = Vec::with_capacity(bodies.len());
        for (i, body) in bodies.iter().enumerate() {
            let Some(shape) = shapes.get(body.shape as usize) else {
                return Err(AnalysisError::ShapeIndex {
                    body: i,
                    shape: body.shape,
                    shapes: shapes.len(),
                });
            };
            let Some(pose) = unit_pose(&body.pose) else {
                return Err(AnalysisError::Pose {
                    body: i,
                    translation: body.pose.translation.vector.into(),
                    length: body.pose.rotation.coords.norm(),
                });
            };
            poses.push(pose);
            bounds.push(Bounds::around(shape.vertices().iter().map(|v| pose * v)));
        }
        let data = shapes.iter().map(ShapeData::new).collect();
        Ok(Self {
            shapes,
            bodies,
            poses,
            data,
            bounds,
            own: bodies.len(),
            sources: &[],
            cell: None,
        })
    }

    /// The shapes.
    pub fn shapes(&self) -> &'a [Polyhedron] {
        self.shapes
    }

    /// The bodies, in the order given.
    pub fn bodies(&self) -> &'a [PosedBody] {
        self.bodies
    }

    /// The same in periodic space, in which the last bodies are images of the ones listed.
    pub(crate) fn in_cell(self, cell: Option<PeriodicCell>, sources: &'a [u32]) -> Self {
        Self {
            own: self.bodies.len() - sources.len(),
            sources,
            cell,
            ..self
        }
    }

    /// Number of bodies that are no images of others: all, but in [periodic space](crate::WithImages).
    pub fn own(&self) -> usize {
        self.own
    }

    /// Whether space repeats itself along an axis, 0 to 2.
    pub(crate) fn repeats(&self, axis: usize) -> bool {
        self.cell.is_some_and(|cell| cell.repeats(axis))
    }

    /// The body itself, of an image.
    pub(crate) fn source(&self, body: usize) -> usize {
        match body.checked_sub(self.own) {
            Some(image) => self.sources[image] as usize,
            None => body,
        }
    }

    /// The axes along which a region repeats itself: those of [periodic space](crate::WithImages) along which it is a box, or a
    /// cylinder on end, as long as the cell.
    ///
    /// # Errors
    /// [`AnalysisError::TiltedCell`] if it is, but the edges of the cell lean.
    pub fn repeats_over(&self, region: &Region) -> Result<[bool; 3], AnalysisError> {
        let Some(cell) = self.cell else {
            return Ok([false; 3]);
        };
        let (min, max) = region.corners();
        let is_flat = match region {
            Region::Box { .. } => [true; 3],
            Region::Cylinder { .. } => [false, false, true],
            Region::Sphere { .. } => [false; 3],
        };
        let edges = cell.edges();
        let whole = |k: usize| {
            let is_as_long = ((max[k] - min[k]) / edges[(k, k)] - 1.0).abs() <= WHOLE;
            is_flat[k] && cell.repeats(k) && is_as_long
        };
        let repeats = [0, 1, 2].map(whole);
        for k in (0..3).filter(|&k| repeats[k]) {
            let mut edge = edges.column(k).into_owned();
            let side = std::mem::take(&mut edge[k]);
            if edge.norm() > WHOLE * side {
                return Err(AnalysisError::TiltedCell {
                    axis: ["x", "y", "z"][k],
                    lean: edge.norm(),
                });
            }
        }
        Ok(repeats)
    }

    /// Whether a region has the upright sides of another one, but along axes along which it repeats itself: there it has none.
    ///
    /// # Errors
    /// As [`repeats_over`](Self::repeats_over).
    pub fn has_sides_of(&self, region: &Region, other: &Region) -> Result<bool, AnalysisError> {
        let repeats = self.repeats_over(region)?;
        Ok(match (*region, *other) {
            (
                Region::Box { min, max },
                Region::Box {
                    min: low,
                    max: high,
                },
            ) => (0..2).filter(|&k| !repeats[k]).all(|k| {
                let off = (min[k] - low[k]).abs() + (max[k] - high[k]).abs();
                off <= WHOLE * (high[k] - low[k])
            }),
            (
                Region::Cylinder { centre, radius, .. },
                Region::Cylinder {
                    centre: middle,
                    radius: whole,
                    ..
                },
            ) => {
                let off = (centre[0] - middle[0]).hypot(centre[1] - middle[1]);
                off + (radius - whole).abs() <= WHOLE * whole
            }
            _ => false,
        })
    }

    /// Number of bodies, images included.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there is no body.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Mean over the bodies, without images, of the circumscribed diameter, twice the largest distance of a vertex from the
    /// centroid (m): the `d` used for insets and spacings.
    ///
    /// # Errors
    /// [`AnalysisError::EmptyPack`].
    pub fn mean_diameter(&self) -> Result<f64, AnalysisError> {
        if self.is_empty() {
            return Err(AnalysisError::EmptyPack);
        }
        let sum: f64 = (0..self.own).map(|i| self.data(i).diameter).sum();
        Ok(sum / self.own as f64)
    }

    /// Centroids in the world frame (m), one per body.
    pub fn centroids(&self) -> Vec<Point3> {
        (0..self.len()).map(|i| self.centroid(i)).collect()
    }

    /// Indices of the bodies whose centroid lies in `region`, ascending.
    ///
    /// # Errors
    /// [`AnalysisError::Region`].
    pub fn bodies_in(&self, region: &Region) -> Result<Vec<u32>, AnalysisError> {
        region.validate()?;
        let inside = self.centroids().into_iter().map(|c| region.contains(&c));
        // The constructor has checked that the indices fit.
        Ok(inside
            .zip(0_u32..)
            .filter_map(|(is_in, i)| is_in.then_some(i))
            .collect())
    }

    fn data(&self, body: usize) -> &ShapeData {
        &self.data[self.bodies[body].shape as usize]
    }

    pub(crate) fn shape(&self, body: usize) -> &'a Polyhedron {
        &self.shapes[self.bodies[body].shape as usize]
    }

    pub(crate) fn pose(&self, body: usize) -> &Pose {
        &self.poses[body]
    }

    pub(crate) fn bounds(&self, body: usize) -> &Bounds {
        &self.bounds[body]
    }

    pub(crate) fn centroid(&self, body: usize) -> Point3 {
        self.pose(body) * self.shape(body).mass_properties().centroid
    }

    /// Face planes in the body frame.
    pub(crate) fn planes(&self, body: usize) -> &[(Vector3, f64)] {
        &self.data(body).planes
    }

    /// Face planes in the world frame.
    pub(crate) fn world_planes(&self, body: usize) -> impl Iterator<Item = (Vector3, f64)> {
        let pose = self.pose(body);
        self.planes(body).iter().map(move |(normal, offset)| {
            let turned = pose.rotation * normal;
            (turned, offset + turned.dot(&pose.translation.vector))
        })
    }

    /// Whether a body is convex with few enough faces to be handled by its planes; all others are handled by
    /// their triangles.
    pub(crate) fn by_planes(&self, body: usize) -> bool {
        self.data(body).by_planes
    }

    /// The same for a shape.
    pub(crate) fn shape_by_planes(&self, shape: usize) -> bool {
        self.data[shape].by_planes
    }

    /// The point of a body's surface nearest to `point`, by its triangles; for bodies that are not handled by
    /// planes.
    pub(crate) fn nearest_on_surface(&self, body: usize, point: &Point3) -> Point3 {
        let (pose, shape, data) = (self.pose(body), self.shape(body), self.data(body));
        let local = pose.inverse_transform_point(point);
        let closest = |i: u32| {
            let triangle = data.triangles[i as usize].map(|v| shape.vertices()[v as usize]);
            closest_point(&triangle, &local)
        };
        let square = |i| (closest(i) - local).norm_squared();
        // A shape has triangles, so there is a nearest.
        let nearest = data.tree.nearest(&local, square);
        pose * nearest.map_or(local, |(i, _)| closest(i))
    }

    /// Whether a body contains `point`, by the crossings of a line; for bodies that are not handled by planes.
    pub(crate) fn holds(&self, body: usize, point: &Point3) -> bool {
        if !self.bounds(body).holds(&Bounds {
            min: *point,
            max: *point,
        }) {
            return false;
        }
        let mut beyond = *point;
        beyond.x = f64::INFINITY;
        let ray = Bounds {
            min: *point,
            max: beyond,
        };
        let mut inside = false;
        self.triangles_in(body, &ray, |triangle| {
            let x = crossing(&triangle, 0, point);
            inside ^= x.is_some_and(|x| x > point.x);
        });
        inside
    }

    /// Calls `hit` with the surface triangles of a body (world frame) that overlap `window`, in an order that
    /// depends on the shape alone. For bodies that are not handled by planes.
    pub(crate) fn triangles_in(
        &self,
        body: usize,
        window: &Bounds,
        mut hit: impl FnMut([Point3; 3]),
    ) {
        let (pose, shape, data) = (self.pose(body), self.shape(body), self.data(body));
        let (middle, half) = window.clamped_to(self.bounds(body)).middle_and_half();
        // More than the round-off of coordinates in the world.
        let slack = 64.0 * f64::EPSILON * (pose.translation.vector.amax() + data.farthest);
        let half = half.add_scalar(slack);
        let turn = pose.rotation.to_rotation_matrix();
        let spread = turn.matrix().abs();
        // Whether the world box of a box of the tree overlaps the window.
        let enter = |local: &Aabb| {
            let reach = spread * (local.high - local.low) * 0.5 + half;
            let apart = pose * local.center() - middle;
            (0..3).all(|k| apart[k].abs() <= reach[k])
        };
        let vertices = shape.vertices();
        data.tree.visit(enter, |i| {
            let triangle = data.triangles[i as usize].map(|v| pose * vertices[v as usize]);
            if Bounds::around(triangle).meets(window) {
                hit(triangle);
            }
        });
    }
}

impl ShapeData {
    fn new(shape: &Polyhedron) -> Self {
        let by_planes = shape.is_convex() && shape.face_count() <= MOST_PLANES;
        let triangles = if by_planes {
            Vec::new()
        } else {
            shape.triangles()
        };
        let corners = |t: &[u32; 3]| t.map(|v| shape.vertices()[v as usize]);
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|t| Aabb::of_points(corners(t)))
            .collect();
        Self {
            planes: (0..shape.face_count())
                .map(|i| (shape.face_normal(i), shape.face_offset(i)))
                .collect(),
            by_planes,
            triangles,
            tree: Bvh::new(&boxes),
            farthest: shape
                .vertices()
                .iter()
                .map(|v| v.coords.amax())
                .fold(0.0, f64::max),
            diameter: 2.0 * shape.bounding_radius(),
        }
    }
}
