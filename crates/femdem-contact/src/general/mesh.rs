//! Bodies with a field on a tetrahedral mesh.

use crate::error::ContactError;
use crate::shape::{self, ConvexShape};
use crate::sides;
use crate::tets::cells::{Cells, NONE};
use femdem_mesh::tet::FACES;
use femdem_mesh::{Matrix3, Point3, Polyhedron, TetMesh, Vector3};
use serde::{Deserialize, Serialize};

/// The pressure field that a meshed body carries: nodal values, linear in every tetrahedron, 0 on
/// the skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum Field {
    /// The distance to the skin over the largest such distance h0 of a node. For bodies of any shape; the
    /// stiffness of a face, 1/h0, does not depend on the mesh.
    #[default]
    Body,
    /// 1 - gauge, as in the convex kernel. For convex bodies; on a centroid fan the field is exactly the
    /// convex kernel's.
    Gauge,
}

/// A body given by tetrahedra with a field, about its centroid. Immutable; share it among bodies.
///
/// ```
/// use femdem_contact::{Field, FieldMesh};
/// use femdem_mesh::{TetMesh, Vector3};
///
/// // A plate of 1 x 1 x 0.2 m: the field rises over half of its thickness.
/// let mesh = TetMesh::block([5, 5, 2], &Vector3::new(1.0, 1.0, 0.2))?;
/// let centroid = Vector3::new(0.5, 0.5, 0.1);
/// let plate = FieldMesh::new(&mesh, centroid, Field::Body)?;
/// assert!((plate.inradius() - 0.1).abs() < 1e-12);
/// assert!(plate.is_convex() && plate.centroid() == centroid);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FieldMesh {
    pub(crate) cells: Cells,
    vertices: Vec<Vector3>,
    field: Field,
    convex: bool,
    centroid: Vector3,
    radius: f64,
    inradius: f64,
    face_stiffness: f64,
}

impl FieldMesh {
    /// Prepares a meshed body with a field. `centroid` is the body's centre of mass in the mesh's
    /// coordinates, m: the origin of the kernel's body frame.
    ///
    /// Tetrahedra whose four points all lie on the skin are split first, so that the field is
    /// positive in all of them.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] if the centroid is not finite. For [`Field::Gauge`] also the
    /// errors of [`ConvexShape::new`] for the mesh's surface.
    pub fn new(mesh: &TetMesh, centroid: Vector3, field: Field) -> Result<Self, ContactError> {
        for x in centroid.iter() {
            crate::error::check("centroid", *x, true, "finite, in m")?;
        }
        let surface = mesh.surface().ok();
        let convex = surface.as_ref().is_some_and(Polyhedron::is_convex);
        let mesh = if mesh.every_tet_has_interior_point() {
            mesh.clone()
        } else {
            mesh.with_interior_points()
        };
        let (values, inradius) = match field {
            Field::Gauge => gauge(&mesh)?,
            Field::Body => {
                let distance = mesh.distance_to_skin();
                let h0 = largest(&distance);
                (distance.iter().map(|d| (d / h0).min(1.0)).collect(), h0)
            }
        };
        Ok(Self::build(
            &mesh, centroid, &values, field, convex, inradius,
        ))
    }

    /// A convex body as the fan of tetrahedra about its centroid, with the gauge field: the same
    /// contact as a [`ConvexShape`]'s.
    ///
    /// # Errors
    /// As [`ConvexShape::new`].
    pub fn from_convex(polyhedron: &Polyhedron) -> Result<Self, ContactError> {
        let centroid = polyhedron.mass_properties().centroid.coords;
        ConvexShape::new(polyhedron)?;
        let mesh = TetMesh::centroid_fan(polyhedron)?;
        Self::new(&mesh, centroid, Field::Gauge)
    }

    fn build(
        mesh: &TetMesh,
        centroid: Vector3,
        values: &[f64],
        field: Field,
        convex: bool,
        inradius: f64,
    ) -> Self {
        let on_skin = |i: &usize| mesh.is_skin_point(*i);
        let vertices: Vec<Vector3> = (0..mesh.points().len())
            .filter(on_skin)
            .map(|i| mesh.points()[i].coords - centroid)
            .collect();
        let cells = Cells::new(mesh, &centroid, values);
        let face_stiffness = face_stiffness(&cells);
        Self {
            radius: vertices.iter().map(Vector3::norm).fold(0.0, f64::max),
            cells,
            vertices,
            field,
            convex,
            centroid,
            inradius,
            face_stiffness,
        }
    }

    /// Which field the body carries.
    pub fn kind(&self) -> Field {
        self.field
    }

    /// Whether the body is convex.
    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// The body's centre of mass in the mesh's coordinates, m: the origin of the kernel's body
    /// frame.
    pub fn centroid(&self) -> Vector3 {
        self.centroid
    }

    /// Largest distance of a vertex from the centroid, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The field's length scale h0, m: the largest distance of a node from the skin; with
    /// [`Field::Gauge`] the smallest distance of a face plane from the centroid.
    pub fn inradius(&self) -> f64 {
        self.inradius
    }

    /// Stiffness per unit penalty of a contact over a whole side of the body against an equal
    /// body, m: an upper bound for flat sides.
    pub fn face_stiffness(&self) -> f64 {
        self.face_stiffness
    }

    /// Points of the skin about the centroid, m.
    pub fn vertices(&self) -> &[Vector3] {
        &self.vertices
    }

    /// Number of tetrahedra, after splitting.
    pub fn tet_count(&self) -> usize {
        self.cells.list.len()
    }

    /// The field at a point in body axes: 0 on the skin and outside.
    pub fn field(&self, x: &Vector3) -> f64 {
        let mut value = 0.0_f64;
        self.cells.tree.visit(
            |b| b.distance_squared(&Point3::from(*x)) <= 0.0,
            |i| {
                let cell = &self.cells.list[i as usize];
                if cell.holds(x) {
                    value = value.max(cell.field(x));
                }
            },
        );
        value
    }

    /// Largest n.x over the body, for any direction n in body axes.
    pub fn support(&self, direction: &Vector3) -> f64 {
        shape::support(&self.vertices, direction)
    }

    /// The axis-aligned box around this body under a rotation, as (lowest, highest) corner
    /// relative to the centroid, m.
    pub fn bounds(&self, rotation: &Matrix3) -> (Vector3, Vector3) {
        shape::bounds(&self.vertices, rotation)
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Values of 1 - gauge at the nodes of a convex body, and the inradius.
pub(crate) fn gauge(mesh: &TetMesh) -> Result<(Vec<f64>, f64), ContactError> {
    let surface = mesh.surface().ok().filter(Polyhedron::is_convex);
    let shape = ConvexShape::new(&surface.ok_or(ContactError::NotConvex)?)?;
    let value = |(i, p): (usize, &Point3)| {
        if mesh.is_skin_point(i) {
            0.0
        } else {
            shape.field(&(p.coords - shape.centroid())).max(0.0)
        }
    };
    let values = mesh.points().iter().enumerate().map(value).collect();
    Ok((values, shape.inradius()))
}

/// Twice the largest integral of |grad phi| over a side of the skin.
fn face_stiffness(cells: &Cells) -> f64 {
    let mut facets: Vec<(Vector3, f64)> = Vec::new();
    for cell in &cells.list {
        for (face, next) in FACES.iter().zip(cell.neighbours) {
            if next == NONE {
                let [a, b, c] = face.map(|corner| cell.tet.corners[corner]);
                let vector = (b - a).cross(&(c - a)) * 0.5;
                let area = vector.norm();
                facets.push((vector / area, 2.0 * area * cell.tet.gradient.norm()));
            }
        }
    }
    sides::stiffest(&facets)
}
