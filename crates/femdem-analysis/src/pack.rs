//! The input: shapes and posed bodies, checked once.

use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::region::Region;

/// A body: which shape it has and where it lies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PosedBody {
    /// Index into the pack's list of shapes.
    pub shape: u32,
    /// Body frame to world frame; translation in metres.
    pub pose: Pose,
}

/// What every analysis needs of a shape, worked out once.
#[derive(Clone, Debug)]
struct ShapeData {
    /// Outward unit normal and offset of each face's plane, body frame.
    planes: Vec<(Vector3, f64)>,
    /// Triangles of the surface; filled for non-convex shapes only.
    triangles: Vec<[u32; 3]>,
    diameter: f64,
}

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
    data: Vec<ShapeData>,
    bounds: Vec<Bounds>,
}

impl<'a> Pack<'a> {
    /// Checks indices and poses. A pack without bodies is allowed here and refused by what needs one.
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
        let mut bounds = Vec::with_capacity(bodies.len());
        for (i, body) in bodies.iter().enumerate() {
            let Some(shape) = shapes.get(body.shape as usize) else {
                return Err(AnalysisError::ShapeIndex {
                    body: i,
                    shape: body.shape,
                    shapes: shapes.len(),
                });
            };
            // Written so that NaN fails it too.
            let unit = (body.pose.rotation.coords.norm() - 1.0).abs() <= 1e-6;
            if !unit || body.pose.translation.vector.iter().any(|x| !x.is_finite()) {
                return Err(AnalysisError::Pose { body: i });
            }
            bounds.push(Bounds::around(
                shape.vertices().iter().map(|v| body.pose * v),
            ));
        }
        let data = shapes.iter().map(ShapeData::new).collect();
        Ok(Self {
            shapes,
            bodies,
            data,
            bounds,
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

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there is no body.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Mean over the bodies of the circumscribed diameter, twice the largest distance of a vertex
    /// from the centroid (m): the `d` in which insets and spacings are given.
    ///
    /// # Errors
    /// [`AnalysisError::EmptyPack`].
    pub fn mean_diameter(&self) -> Result<f64, AnalysisError> {
        if self.is_empty() {
            return Err(AnalysisError::EmptyPack);
        }
        let sum: f64 = (0..self.len()).map(|i| self.data(i).diameter).sum();
        Ok(sum / self.len() as f64)
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

    pub(crate) fn pose(&self, body: usize) -> &'a Pose {
        &self.bodies[body].pose
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

    /// Surface triangles in the world frame; none for convex shapes, which go by their planes.
    pub(crate) fn world_triangles(&self, body: usize) -> impl Iterator<Item = [Point3; 3]> {
        let pose = self.pose(body);
        let vertices = self.shape(body).vertices();
        let triangles = self.data(body).triangles.iter();
        triangles.map(move |t| t.map(|v| pose * vertices[v as usize]))
    }
}

impl ShapeData {
    fn new(shape: &Polyhedron) -> Self {
        Self {
            planes: (0..shape.face_count())
                .map(|i| (shape.face_normal(i), shape.face_offset(i)))
                .collect(),
            triangles: if shape.is_convex() {
                Vec::new()
            } else {
                shape.triangles()
            },
            diameter: 2.0 * shape.bounding_radius(),
        }
    }
}
