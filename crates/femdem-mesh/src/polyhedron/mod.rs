//! The closed polyhedral surface and what is computed from it once.

mod extent;
mod intersect;
pub(crate) mod planes;
mod shells;
mod tolerances;
pub(crate) mod topology;
mod triangulate;

use crate::bvh::{Aabb, Bvh};
use crate::pose::checked_pose;
use crate::{MassProperties, MeshError, Point3, Pose, Vector3, merge};
pub(crate) use extent::{bounding_box, check_coordinates};
pub(crate) use planes::Plane;
use serde::{Deserialize, Serialize};
pub(crate) use shells::refusal as several_shells;
use std::cell::Cell;
use std::collections::BTreeSet;
pub use tolerances::{CONVEXITY_TOLERANCE, PLANARITY_TOLERANCE};
pub(crate) use topology::{Groups, check as check_topology, check_counts, sides};
pub(crate) use triangulate::{SHARP, triangulate};

/// A closed, oriented polyhedral surface: planar polygons, vertex loops counter-clockwise seen
/// from outside.
///
/// Always valid (see [`Polyhedron::new`]); plane equations, area, convexity and mass properties
/// are computed once, at construction. Serialised as vertices and faces, and validated again when
/// read back.
///
/// ```
/// use femdem_mesh::{Point3, Polyhedron};
///
/// // A wedge: two triangles and three rectangles, counter-clockwise seen from outside.
/// let corners = [[0., 0., 0.], [2., 0., 0.], [0., 1., 0.], [0., 0., 1.], [2., 0., 1.], [0., 1., 1.]];
/// let faces = [vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![2, 0, 3, 5]];
/// let wedge = Polyhedron::new(corners.map(Point3::from).to_vec(), faces.to_vec())?;
/// assert!(wedge.is_convex());
/// assert!((wedge.mass_properties().volume - 1.0).abs() < 1e-14);
///
/// // With a face turned inside out it is refused, and the error says which edge is wrong.
/// let mut turned = faces.to_vec();
/// turned[0].reverse();
/// assert!(Polyhedron::new(corners.map(Point3::from).to_vec(), turned).is_err());
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct Polyhedron {
    vertices: Vec<Point3>,
    /// Vertex loops of all faces, one after another.
    corners: Vec<u32>,
    /// Where the loop of each face starts in `corners`; one entry more than there are faces.
    starts: Vec<u32>,
    normals: Vec<Vector3>,
    offsets: Vec<f64>,
    area: f64,
    convex: bool,
    mass: MassProperties,
    bounding_radius: f64,
    inradius: f64,
}

/// What a polyhedron is made from, and is stored as.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Polyhedron", deny_unknown_fields)]
struct Parts {
    vertices: Vec<Point3>,
    faces: Vec<Vec<u32>>,
}

impl TryFrom<Parts> for Polyhedron {
    type Error = MeshError;

    fn try_from(parts: Parts) -> Result<Self, MeshError> {
        Self::new(parts.vertices, parts.faces)
    }
}

impl From<Polyhedron> for Parts {
    fn from(polyhedron: Polyhedron) -> Self {
        Self {
            faces: polyhedron.faces().map(<[u32]>::to_vec).collect(),
            vertices: polyhedron.vertices,
        }
    }
}

impl Polyhedron {
    /// Makes a polyhedron from vertices \[m\] and faces, each a loop of vertex indices
    /// counter-clockwise seen from outside. Faces may be non-convex polygons.
    ///
    /// # Errors
    ///
    /// Refuses, naming the place: coordinates that are not finite; fewer than 4 vertices or faces;
    /// indices out of range; a face that repeats a vertex; vertices that no face uses; edges
    /// without exactly two faces of opposite direction; several surfaces, one inside another (a hollow
    /// body) or not, or surfaces that touch in a vertex; faces without area, or not planar within [`PLANARITY_TOLERANCE`]; a surface
    /// that is inside out; and bodies too small, too large or too far from the origin for the
    /// arithmetic. Surfaces that cut through themselves are not found out: see
    /// [`self_intersections`](Self::self_intersections).
    pub fn new(vertices: Vec<Point3>, faces: Vec<Vec<u32>>) -> Result<Self, MeshError> {
        topology::check_counts(vertices.len(), faces.len())?;
        let extent = check_coordinates(&vertices)?;
        topology::check(vertices.len(), &faces).map_err(|error| match error {
            MeshError::Disconnected { .. } => several_shells(&vertices, &faces),
            error => error,
        })?;
        let (corners, starts) = flatten(&faces)?;
        planes::check(&vertices, &faces, extent)?;
        let polyhedron = Self::from_valid(vertices, corners, starts);
        let volume = polyhedron.mass.volume;
        let rounding = f64::EPSILON * polyhedron.area * extent;
        if volume < -rounding {
            Err(MeshError::InsideOut { volume })
        } else if volume > rounding {
            Ok(polyhedron)
        } else {
            Err(MeshError::NoVolume { volume })
        }
    }

    /// Computes what is stored beside the surface. The connectivity must be valid.
    fn from_valid(vertices: Vec<Point3>, corners: Vec<u32>, starts: Vec<u32>) -> Self {
        let faces: Vec<&[u32]> = loops(&corners, &starts).collect();
        let planes: Vec<Plane> = faces
            .iter()
            .map(|face| Plane::through(&vertices, face))
            .collect();
        let convex = planes::is_convex(&vertices, &faces, &planes);
        let fans = faces.iter().flat_map(|face| triangulate::fan(face));
        let mass = MassProperties::of_surface(&vertices, fans);
        let depth = |plane: &Plane| -plane.distance(&mass.centroid);
        let reach = |vertex: &Point3| (vertex - mass.centroid).norm();
        Self {
            normals: planes.iter().map(|plane| plane.normal).collect(),
            offsets: planes
                .iter()
                .map(|plane| plane.normal.dot(&plane.point.coords))
                .collect(),
            area: planes.iter().map(|plane| plane.area).sum(),
            convex,
            mass,
            bounding_radius: vertices.iter().map(reach).fold(0.0, f64::max),
            inradius: planes.iter().map(depth).fold(f64::INFINITY, f64::min),
            vertices,
            corners,
            starts,
        }
    }

    /// The vertices \[m\].
    pub fn vertices(&self) -> &[Point3] {
        &self.vertices
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Vertex loop of face `i`, counter-clockwise seen from outside.
    ///
    /// # Panics
    ///
    /// If `i` is not less than [`face_count`](Self::face_count), as for slices.
    pub fn face(&self, i: usize) -> &[u32] {
        &self.corners[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// The vertex loops of all faces, in order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> + '_ {
        loops(&self.corners, &self.starts)
    }

    /// The edges, each once as its smaller and larger vertex, sorted.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self
            .faces()
            .flat_map(topology::sides)
            .filter(|[a, b]| a < b)
            .collect();
        edges.sort_unstable();
        edges
    }

    /// Unit normal of face `i`, outward.
    ///
    /// # Panics
    ///
    /// If `i` is not less than [`face_count`](Self::face_count), as for slices.
    pub fn face_normal(&self, i: usize) -> Vector3 {
        self.normals[i]
    }

    /// Offset of face `i`'s plane: `n . x` of its points x \[m\], with n the outward normal.
    ///
    /// # Panics
    ///
    /// If `i` is not less than [`face_count`](Self::face_count), as for slices.
    pub fn face_offset(&self, i: usize) -> f64 {
        self.offsets[i]
    }

    /// Whether the body is convex within [`CONVEXITY_TOLERANCE`].
    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// Area of the surface \[m^2\].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Volume, centroid and inertia for unit density, by exact integration.
    pub fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }

    /// Largest distance of a vertex from the centroid \[m\].
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// Smallest signed distance from the centroid to the plane of a face \[m\].
    ///
    /// For a convex body this is the radius of the largest sphere about the centroid that fits
    /// inside. It is negative if a non-convex body's centroid lies outside some face's plane.
    pub fn inradius(&self) -> f64 {
        self.inradius
    }

    /// The surface as triangles, face by face in order, with the orientation of the faces.
    ///
    /// Convex faces are cut as fans from their first vertex, others by ear clipping.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.corners.len());
        for (face, normal) in self.faces().zip(&self.normals) {
            triangulate(&self.vertices, face, normal, SHARP, &mut triangles);
        }
        triangles
    }

    /// Pairs of faces that cut or touch each other outside their common edges and vertices, each
    /// as its smaller and larger face, sorted; a face that cuts itself is paired with itself. Stops
    /// at `limit` pairs. Empty for a surface that is the skin of a body.
    ///
    /// Exact for the surface as [`triangles`](Self::triangles) has it: no tolerance. In the order
    /// of n log n steps for n triangles of which few overlap in their boxes.
    pub fn self_intersections(&self, limit: usize) -> Vec<[usize; 2]> {
        self.self_intersections_within(limit, u64::MAX)
            .unwrap_or_default()
    }

    /// The same, or nothing if more than `budget` pairs of triangles would have to be compared.
    pub(crate) fn self_intersections_within(
        &self,
        limit: usize,
        mut budget: u64,
    ) -> Option<Vec<[usize; 2]>> {
        let mut triangles = Vec::with_capacity(self.corners.len());
        let mut face_of = Vec::with_capacity(self.corners.len());
        for (i, (face, normal)) in self.faces().zip(&self.normals).enumerate() {
            triangulate(&self.vertices, face, normal, SHARP, &mut triangles);
            face_of.resize(triangles.len(), i);
        }
        let corners = |t: &[u32; 3]| t.map(|v| self.vertices[v as usize]);
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|t| Aabb::of_points(corners(t)))
            .collect();
        let tree = Bvh::new(&boxes);
        // The search prunes everything once it is over.
        let over = Cell::new(limit == 0);
        let mut found = BTreeSet::new();
        tree.visit_pairs(
            &tree,
            |a, b| !over.get() && a.overlaps(b),
            |i, j| {
                let (i, j) = (i as usize, j as usize);
                if i >= j || over.get() || !boxes[i].overlaps(&boxes[j]) {
                    return;
                }
                if budget == 0 {
                    over.set(true);
                    return;
                }
                budget -= 1;
                if intersect::meet(&self.vertices, triangles[i], triangles[j]) {
                    found.insert([face_of[i], face_of[j]]);
                    over.set(found.len() >= limit);
                }
            },
        );
        let finished = !over.get() || found.len() >= limit;
        finished.then(|| found.into_iter().collect())
    }

    /// The body with all coordinates multiplied by `factor`.
    ///
    /// # Errors
    ///
    /// If `factor` is not positive and finite, or the result is too small or too large.
    pub fn scaled(&self, factor: f64) -> Result<Self, MeshError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(MeshError::OutOfRange {
                what: "the scale factor",
                value: factor,
                allowed: "a positive, finite number",
            });
        }
        let vertices: Vec<Point3> = self.vertices.iter().map(|v| v * factor).collect();
        check_coordinates(&vertices)?;
        Ok(Self::from_valid(
            vertices,
            self.corners.clone(),
            self.starts.clone(),
        ))
    }

    /// The body after a rigid motion.
    ///
    /// A quaternion whose length differs from 1 by up to 1e-6 is made of unit length ([`unit_pose`](crate::unit_pose)).
    ///
    /// # Errors
    ///
    /// [`MeshError::OutOfRange`] for a pose that is not finite or no rotation, and
    /// [`MeshError::TooFarFromOrigin`] for one that carries the body so far from the origin that its coordinates
    /// lose their digits.
    pub fn transformed(&self, pose: &Pose) -> Result<Self, MeshError> {
        let pose = checked_pose(pose)?;
        let vertices: Vec<Point3> = self.vertices.iter().map(|v| pose * v).collect();
        check_coordinates(&vertices)?;
        Ok(Self::from_valid(
            vertices,
            self.corners.clone(),
            self.starts.clone(),
        ))
    }

    /// The mirror image in the plane x = 0, with loops reversed so that faces still look outward.
    pub fn mirrored(&self) -> Self {
        let vertices = self
            .vertices
            .iter()
            .map(|v| Point3::new(-v.x, v.y, v.z))
            .collect();
        // Each loop runs the other way round from the same first corner, so that faces planar only
        // within the tolerance are cut into the same triangles and enclose the same volume.
        let corners = self
            .faces()
            .flat_map(|face| face[..1].iter().chain(face[1..].iter().rev()).copied())
            .collect();
        Self::from_valid(vertices, corners, self.starts.clone())
    }

    /// The same surface with neighbouring coplanar faces joined where the union is a convex
    /// polygon, and vertices dropped that then lie inside a face or an edge.
    ///
    /// Contact costs go by the face: a cube of 12 triangles becomes one of 6 squares. Faces count
    /// as coplanar within half of [`PLANARITY_TOLERANCE`].
    pub fn with_merged_faces(&self) -> Self {
        let (low, high) = bounding_box(&self.vertices);
        let tolerance = 0.5 * PLANARITY_TOLERANCE * (high - low).norm();
        merge::merge_coplanar(&self.vertices, &self.triangles(), tolerance)
            .and_then(|(vertices, faces)| Self::new(vertices, faces))
            .unwrap_or_else(|_| self.clone())
    }

    /// Vertices - edges + faces: 2 for a body without holes through it.
    pub fn euler_characteristic(&self) -> i64 {
        self.vertices.len() as i64 - self.corners.len() as i64 / 2 + self.face_count() as i64
    }
}

/// The loops that [`flatten`] put one after another.
fn loops<'a>(corners: &'a [u32], starts: &'a [u32]) -> impl ExactSizeIterator<Item = &'a [u32]> {
    starts
        .windows(2)
        .map(|ends| &corners[ends[0] as usize..ends[1] as usize])
}

/// Loops one after another, and where each starts.
fn flatten(faces: &[Vec<u32>]) -> Result<(Vec<u32>, Vec<u32>), MeshError> {
    let count = faces.iter().map(Vec::len).sum();
    if u32::try_from(count).is_err() {
        return Err(MeshError::TooMany {
            what: "face corners",
            count,
            allowed: u32::MAX as usize,
        });
    }
    let mut starts = Vec::with_capacity(faces.len() + 1);
    let mut corners = Vec::with_capacity(count);
    for face in faces {
        starts.push(corners.len() as u32);
        corners.extend_from_slice(face);
    }
    starts.push(corners.len() as u32);
    Ok((corners, starts))
}

#[cfg(test)]
mod tests;
