//! What a shape is inside.

use std::sync::{Arc, OnceLock};

use femdem_solve::contact::{BodyShape, ContactError, ConvexShape, Field, FieldMesh, Sphere};
use femdem_solve::mesh::tet::{self, MeshOptions};
use femdem_solve::mesh::{MassProperties, Matrix3, Point3, Polyhedron, Pose, TetMesh, Vector3};
use femdem_solve::{ShapeId, SolveError, World};

use crate::border::Failure;

/// Centroids within this part of the radius of the origin are there to rounding.
const CENTRED: f64 = 1e-12;

/// A shape with what contacts need of it. The origin of its coordinates is its centroid.
pub(crate) struct Form {
    name: String,
    pub surface: Polyhedron,
    /// The centroid in the coordinates that were given, m.
    pub centroid: Vector3,
    /// Tetrahedra with their field, of a body that is not convex.
    mesh: Option<(TetMesh, Field)>,
    pub contact: BodyShape,
    /// A convex one as tetrahedra, made once a mesh meets it.
    fan: OnceLock<Result<Arc<FieldMesh>, ContactError>>,
}

impl Form {
    /// `mesh_size` is the size of the tetrahedra of a body that is not convex over its diameter; 0: that of the mesher.
    pub fn new(name: &str, surface: Polyhedron, mesh_size: f64) -> Result<Self, Failure> {
        if !(0.0..=1.0).contains(&mesh_size) {
            let allowed = "above 0 and at most 1, in diameters; 0 for that of the mesher";
            return Err(Failure::refused("mesh_size", mesh_size, allowed));
        }
        let centroid = surface.mass_properties().centroid.coords;
        let surface = if centroid.norm() > CENTRED * surface.bounding_radius() {
            surface.transformed(&Pose::from(-centroid))?
        } else {
            surface
        };
        let (mesh, contact) = if surface.is_convex() {
            (None, BodyShape::from(ConvexShape::new(&surface)?))
        } else {
            let length = mesh_size * 2.0 * surface.bounding_radius();
            let options = MeshOptions {
                edge_length: (mesh_size > 0.0).then_some(length),
                ..MeshOptions::default()
            };
            let (mesh, _) = tet::mesh(&surface, &options)?;
            let origin = surface.mass_properties().centroid.coords;
            let contact = FieldMesh::new(&mesh, origin, Field::Body)?;
            (Some((mesh, Field::Body)), BodyShape::from(contact))
        };
        Ok(Self {
            name: name.to_owned(),
            surface,
            centroid,
            mesh,
            contact,
            fan: OnceLock::new(),
        })
    }

    /// The exact ball of a radius in m, of which the surface is a picture.
    pub fn ball(name: &str, surface: Polyhedron, radius: f64) -> Result<Self, Failure> {
        let contact = BodyShape::from(Sphere::new(radius)?);
        Ok(Self {
            name: name.to_owned(),
            surface,
            centroid: Vector3::zeros(),
            mesh: None,
            contact,
            fan: OnceLock::new(),
        })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// Adds it to a world.
    pub fn add_to(&self, world: &mut World) -> Result<ShapeId, SolveError> {
        match (self.contact.sphere(), &self.mesh) {
            (Some(ball), _) => world.add_sphere(&self.name, ball.radius()),
            (None, Some((mesh, field))) => {
                world.add_mesh_shape(&self.name, &self.surface, mesh, *field)
            }
            (None, None) => world.add_shape(&self.name, &self.surface),
        }
    }

    /// Tetrahedra of a body that is no ball.
    pub fn tetrahedra(&self) -> Result<Option<Arc<FieldMesh>>, ContactError> {
        match &self.contact {
            BodyShape::Mesh(mesh) => Ok(Some(Arc::clone(mesh))),
            BodyShape::Sphere(_) => Ok(None),
            BodyShape::Convex(convex) => {
                let fan = self.fan.get_or_init(|| convex.fan().map(Arc::new));
                fan.clone().map(Some)
            }
        }
    }

    /// Volume and inertia at unit density.
    pub fn mass(&self) -> MassProperties {
        match self.contact.sphere() {
            Some(ball) => {
                let (radius, centroid) = (ball.radius(), Point3::origin());
                let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
                let inertia = Matrix3::identity() * (0.4 * volume * radius * radius);
                MassProperties {
                    volume,
                    centroid,
                    inertia,
                }
            }
            None => *self.surface.mass_properties(),
        }
    }
}
