//! Convex bodies prepared for the contact kernel: planes, facets, vertices.

use crate::axes::complete;
use crate::error::ContactError;
use crate::kernel::{Line, Point, integrate};
use crate::sides;
use femdem_mesh::{Matrix3, Polyhedron, Pose, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Planes whose scaled normals n/h differ by less than this (times 1/h) are one
/// plane: their gauge cells cannot be told apart (physics: cells of equal gauge).
const SAME_PLANE: f64 = 1e-9;

/// A rigid motion body -> world with the rotation as a matrix, as the kernel uses it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Position of the body's origin (its centroid), m.
    pub position: Vector3,
    /// Rotation from body to world axes.
    pub rotation: Matrix3,
}

impl Frame {
    /// The frame that maps body coordinates to the same world coordinates.
    pub fn identity() -> Self {
        Self {
            position: Vector3::zeros(),
            rotation: Matrix3::identity(),
        }
    }

    /// A body-frame point in world coordinates.
    pub fn point(&self, x: &Vector3) -> Vector3 {
        self.position + self.rotation * x
    }
}

impl From<&Pose> for Frame {
    fn from(pose: &Pose) -> Self {
        Self {
            position: pose.translation.vector,
            rotation: pose.rotation.to_rotation_matrix().into_inner(),
        }
    }
}

/// A face plane n.x = h with unit outward normal, about the centroid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Plane {
    pub normal: Vector3,
    pub offset: f64,
    /// normal / offset: the gauge of this plane at x is gauge.x.
    pub gauge: Vector3,
}

impl Plane {
    fn new(normal: Vector3, offset: f64) -> Self {
        Self {
            normal,
            offset,
            gauge: normal / offset,
        }
    }
}

/// An orthonormal frame in a plane: e1 cross e2 is the plane's normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlaneFrame {
    pub origin: Vector3,
    pub e1: Vector3,
    pub e2: Vector3,
}

impl PlaneFrame {
    pub fn new(origin: Vector3, normal: &Vector3) -> Self {
        let [_, e1, e2] = complete(normal);
        Self { origin, e1, e2 }
    }

    pub fn point(&self, x: &Vector3) -> Point {
        let from = x - self.origin;
        Point {
            x: from.dot(&self.e1),
            y: from.dot(&self.e2),
        }
    }
}

/// A planar convex polygon of the skin: `corners[start..start + len]`, in coordinates of
/// `frame`, on `plane`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Facet {
    pub plane: u16,
    pub len: u16,
    pub start: u32,
    pub frame: PlaneFrame,
    /// Area, m^2.
    pub area: f64,
}

/// A convex polyhedron with its gauge field, about its own centroid.
///
/// The field is phi(x) = 1 - max_f n_f.x / h_f: 1 at the centroid, 0 on the skin
/// (physics of Xiang, Latham and Farsi 2016, eq. 3, with the gauge as potential).
///
/// ```
/// use femdem_contact::ConvexShape;
/// use femdem_mesh::{Vector3, catalogue::CatalogueShape};
///
/// // A cube of side 2 m: its field is 1 in the middle, 0 on every face, and linear in between.
/// let cube = ConvexShape::new(&"P5".parse::<CatalogueShape>()?.polyhedron(2.0 * 3_f64.sqrt())?)?;
/// assert!((cube.field(&Vector3::zeros()) - 1.0).abs() < 1e-12);
/// assert!((cube.field(&Vector3::new(0.2, -0.5, 0.1)) - 0.5).abs() < 1e-12);
/// assert!((cube.inradius() - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexShape {
    pub(crate) planes: Vec<Plane>,
    pub(crate) facets: Vec<Facet>,
    pub(crate) corners: Vec<Point>,
    pub(crate) vertices: Vec<Vector3>,
    pub(crate) edges: Vec<[u16; 2]>,
    /// Planes on the left and on the right of each edge, seen from outside.
    pub(crate) edge_planes: Vec<[u16; 2]>,
    /// Vertices of the facets, laid out as `corners`.
    pub(crate) loops: Vec<u16>,
    centroid: Vector3,
    radius: f64,
    inradius: f64,
    volume: f64,
    face_stiffness: f64,
}

impl ConvexShape {
    /// Prepares a convex polyhedron. Its centroid becomes the origin of the kernel's body frame;
    /// [`centroid`](Self::centroid) returns its original position.
    ///
    /// # Errors
    /// [`ContactError::NotConvex`], [`ContactError::TooThin`] or
    /// [`ContactError::TooLarge`] (more than 65,535 faces, vertices or edges).
    pub fn new(polyhedron: &Polyhedron) -> Result<Self, ContactError> {
        if !polyhedron.is_convex() {
            return Err(ContactError::NotConvex);
        }
        let mass = polyhedron.mass_properties();
        let centroid = mass.centroid.coords;
        let vertices: Vec<Vector3> = polyhedron
            .vertices()
            .iter()
            .map(|v| v.coords - centroid)
            .collect();
        let radius = vertices.iter().map(Vector3::norm).fold(0.0, f64::max);
        let edges = polyhedron.edges();
        let most = usize::from(u16::MAX);
        for (what, count) in [
            ("faces", polyhedron.face_count()),
            ("vertices", vertices.len()),
            ("edges", edges.len()),
        ] {
            if count > most {
                return Err(ContactError::TooLarge { what, count, most });
            }
        }
        let mut shape = Self {
            planes: Vec::new(),
            facets: Vec::with_capacity(polyhedron.face_count()),
            corners: Vec::new(),
            edges: edges.iter().map(|e| [e[0] as u16, e[1] as u16]).collect(),
            edge_planes: Vec::new(),
            loops: Vec::new(),
            vertices,
            centroid,
            radius,
            inradius: f64::INFINITY,
            volume: mass.volume,
            face_stiffness: 0.0,
        };
        for (i, face) in polyhedron.faces().enumerate() {
            shape.push_face(i, face, polyhedron.face_normal(i))?;
        }
        shape.edge_planes = shape.planes_at_edges();
        let facets = shape.facets.iter().map(|facet| {
            let plane = &shape.planes[usize::from(facet.plane)];
            (plane.normal, 2.0 * facet.area / plane.offset)
        });
        shape.face_stiffness = sides::stiffest(&facets.collect::<Vec<_>>());
        Ok(shape)
    }

    fn push_face(&mut self, i: usize, face: &[u32], normal: Vector3) -> Result<(), ContactError> {
        let loop_points: Vec<Vector3> = face.iter().map(|&v| self.vertices[v as usize]).collect();
        let offset =
            loop_points.iter().map(|x| normal.dot(x)).sum::<f64>() / loop_points.len() as f64;
        let least = 1e-6 * self.radius;
        if offset.is_nan() || offset <= least {
            return Err(ContactError::TooThin {
                face: i,
                distance: offset,
                least,
            });
        }
        self.inradius = self.inradius.min(offset);
        let plane = self.plane_index(Plane::new(normal, offset));
        let normal = self.planes[plane].normal;
        let frame = PlaneFrame::new(loop_points[0], &normal);
        let polygon: Vec<Point> = loop_points.iter().map(|x| frame.point(x)).collect();
        self.facets.push(Facet {
            plane: plane as u16,
            len: polygon.len() as u16,
            start: self.corners.len() as u32,
            frame,
            area: integrate(&polygon, &Point::default(), &Line::default()).area,
        });
        self.corners.extend(polygon);
        self.loops.extend(face.iter().map(|&v| v as u16));
        Ok(())
    }

    /// The planes on both sides of each edge.
    fn planes_at_edges(&self) -> Vec<[u16; 2]> {
        let mut left = BTreeMap::new();
        for facet in &self.facets {
            let start = facet.start as usize;
            let own = &self.loops[start..start + usize::from(facet.len)];
            for (k, &v) in own.iter().enumerate() {
                left.insert([v, own[(k + 1) % own.len()]], facet.plane);
            }
        }
        let side = |edge: [u16; 2]| left.get(&edge).copied().unwrap_or_default();
        let both = |&[p, q]: &[u16; 2]| [side([p, q]), side([q, p])];
        self.edges.iter().map(both).collect()
    }

    /// Index of an equal plane, or of `plane` newly added.
    fn plane_index(&mut self, plane: Plane) -> usize {
        let same = |p: &Plane| (p.gauge - plane.gauge).norm() * plane.offset < SAME_PLANE;
        if let Some(k) = self.planes.iter().position(same) {
            return k;
        }
        self.planes.push(plane);
        self.planes.len() - 1
    }

    /// Centroid of the polyhedron in its own coordinates, m: the origin of the
    /// kernel's body frame.
    pub fn centroid(&self) -> Vector3 {
        self.centroid
    }

    /// Largest distance of a vertex from the centroid, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Smallest distance of a face plane from the centroid, m.
    pub fn inradius(&self) -> f64 {
        self.inradius
    }

    /// Stiffness per unit penalty of a contact over the whole stiffest side against an equal body, m: 2 A/h.
    /// All facets whose normals lie within 18 degrees of that of one facet count as one side.
    pub fn face_stiffness(&self) -> f64 {
        self.face_stiffness
    }

    /// Vertices about the centroid, m.
    pub fn vertices(&self) -> &[Vector3] {
        &self.vertices
    }

    /// The gauge field at a body-frame point: 1 at the centroid, 0 on the skin,
    /// negative outside.
    pub fn field(&self, x: &Vector3) -> f64 {
        let gauge = |p: &Plane| p.gauge.dot(x);
        1.0 - self.planes.iter().map(gauge).fold(0.0, f64::max)
    }

    /// Whether a body-frame point lies inside.
    pub(crate) fn holds(&self, x: &Vector3) -> bool {
        // Nothing farther from the centroid lies inside; most pairs end here.
        x.norm_squared() < self.radius * self.radius
            && self.planes.iter().all(|plane| plane.gauge.dot(x) < 1.0)
    }

    /// m^3.
    pub(crate) fn volume(&self) -> f64 {
        self.volume
    }

    /// Largest n.x over the vertices, for any direction n in body axes.
    pub fn support(&self, direction: &Vector3) -> f64 {
        support(&self.vertices, direction)
    }

    /// The vertex farthest along a direction in body axes, and its coordinate along it.
    pub(crate) fn support_vertex(&self, direction: &Vector3) -> (usize, f64) {
        let mut best = (0, f64::NEG_INFINITY);
        for (i, v) in self.vertices.iter().enumerate() {
            let u = direction.dot(v);
            if u > best.1 {
                best = (i, u);
            }
        }
        best
    }

    pub(crate) fn polygon(&self, facet: &Facet) -> &[Point] {
        let start = facet.start as usize;
        &self.corners[start..start + usize::from(facet.len)]
    }

    /// The axis-aligned box around this shape under a rotation, as (lowest, highest) corner
    /// relative to the centroid, m.
    pub fn bounds(&self, rotation: &Matrix3) -> (Vector3, Vector3) {
        bounds(&self.vertices, rotation)
    }
}

/// Largest n.x over points, for a direction n.
pub(crate) fn support(points: &[Vector3], direction: &Vector3) -> f64 {
    points
        .iter()
        .map(|v| direction.dot(v))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The axis-aligned box around points under a rotation about their origin: lowest and highest corner.
pub(crate) fn bounds(points: &[Vector3], rotation: &Matrix3) -> (Vector3, Vector3) {
    let mut low = Vector3::zeros();
    let mut high = Vector3::zeros();
    for axis in 0..3 {
        let direction = rotation.row(axis).transpose();
        high[axis] = support(points, &direction);
        low[axis] = -support(points, &-direction);
    }
    (low, high)
}
