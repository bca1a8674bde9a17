//! Shapes and rigid bodies as the world keeps them.

use crate::applied::AppliedLoad;
use crate::error::{SolveError, check};
use crate::guide::Guide;
use crate::rest::RestRecord;
use femdem_contact::{
    BodyShape, ConvexShape, Field, FieldMesh, Frame, MaterialId, Motion, Sphere, Wrench,
};
use femdem_fem::Driven;
use femdem_mesh::nalgebra::{Matrix3, Translation3};
use femdem_mesh::{Polyhedron, Pose, Rotation, TetMesh, Vector3, checked_pose, shapes};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Index of a shape, by order of addition.
pub type ShapeId = u32;

/// A shape with what rigid dynamics needs of it. Inside the world bodies are posed in the
/// principal frame; outside in the coordinates of `polyhedron`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Name, as it appears in results.
    pub name: String,
    /// The surface in the coordinates it was given in; of a sphere a polyhedron of 1,280 facets inscribed in it, to be
    /// drawn.
    pub polyhedron: Polyhedron,
    /// Tetrahedra in the same coordinates with their field; `None` for a convex shape, whose
    /// contacts are those of `polyhedron`, and for a sphere.
    pub mesh: Option<(TetMesh, Field)>,
    /// Radius of a sphere about the origin, m, whose contacts and mass are those of the exact ball; `None` for any other
    /// shape.
    pub sphere: Option<f64>,
    /// Volume of the body, m^3.
    pub volume: f64,
    /// Principal axes at the centroid -> given coordinates.
    principal: Pose,
    /// Principal moments of inertia at unit density, m^5.
    moments: Vector3,
}

impl Shape {
    pub(crate) fn new(name: &str, polyhedron: &Polyhedron) -> Self {
        let mass = polyhedron.mass_properties();
        let frame = mass.principal();
        Self {
            name: name.to_owned(),
            polyhedron: polyhedron.clone(),
            mesh: None,
            sphere: None,
            volume: mass.volume,
            principal: Pose::from_parts(Translation3::from(mass.centroid.coords), frame.rotation),
            moments: frame.moments,
        }
    }

    /// A ball: V = 4/3 pi R^3, I = 2/5 V R^2 at unit density.
    pub(crate) fn sphere(name: &str, radius: f64) -> Result<Self, SolveError> {
        let radius = Sphere::new(radius)?.radius();
        let facets = shapes::Shape::from(shapes::Sphere { level: 3 });
        let volume = 4.0 / 3.0 * PI * radius.powi(3);
        Ok(Self {
            name: name.to_owned(),
            polyhedron: facets.polyhedron(2.0 * radius)?,
            mesh: None,
            sphere: Some(radius),
            volume,
            principal: Pose::identity(),
            moments: Vector3::repeat(0.4 * volume * radius * radius),
        })
    }

    /// With tetrahedra for the contacts, which have to fill the surface.
    pub(crate) fn meshed(
        name: &str,
        polyhedron: &Polyhedron,
        mesh: &TetMesh,
        field: Field,
    ) -> Result<Self, SolveError> {
        let shape = Self::new(name, polyhedron);
        let ratio = mesh.volume() / shape.volume;
        check(
            "volume of the mesh over that of the surface",
            ratio,
            (ratio - 1.0).abs() <= MESH_VOLUME,
            "between 0.9 and 1.1: the two must be the same body in the same coordinates",
        )?;
        Ok(Self {
            mesh: Some((mesh.clone(), field)),
            ..shape
        })
    }

    /// The principal axes in the world, where `pose` takes the given coordinates.
    pub(crate) fn place(&self, pose: &Pose) -> Pose {
        pose * self.principal
    }

    /// The contact shape in the principal frame.
    pub(crate) fn contact(&self) -> Result<BodyShape, SolveError> {
        if let Some(radius) = self.sphere {
            return Ok(Sphere::new(radius)?.into());
        }
        let to_principal = self.principal.inverse();
        let Some((mesh, field)) = &self.mesh else {
            let posed = self.polyhedron.transformed(&to_principal)?;
            return Ok(ConvexShape::new(&posed)?.into());
        };
        let points = mesh.points().iter().map(|x| to_principal * x).collect();
        let posed = TetMesh::new(points, mesh.tets().to_vec())?;
        Ok(FieldMesh::new(&posed, Vector3::zeros(), *field)?.into())
    }
}

/// Most that the volume of a mesh may differ from its surface's, relative.
const MESH_VOLUME: f64 = 0.1;

/// A body to add.
///
/// ```
/// use femdem_mesh::{Pose, Vector3, catalogue::CatalogueShape};
/// use femdem_solve::{BodySpec, World, WorldParameters};
///
/// // A stone thrown upwards at 5 m/s is 1.25 m higher after 0.5 s, if g = 10 m/s^2.
/// let mut world = World::new(WorldParameters { gravity: -10.0 * Vector3::z(), ..WorldParameters::default() })?;
/// let shape = world.add_shape("stone", &"A10".parse::<CatalogueShape>()?.polyhedron(0.05)?)?;
/// let stone = world.add_body(BodySpec {
///     velocity: Vector3::new(0.0, 0.0, 5.0),
///     ..BodySpec::at_rest(shape, 2650.0, Pose::identity())
/// })?;
/// while world.time() < 0.5 {
///     world.step()?;
/// }
/// let height = world.position(stone).map_or(0.0, |x| x.z);
/// let expected = 5.0 * world.time() - 5.0 * world.time().powi(2);
/// assert!((height - expected).abs() < 1e-9, "{height} {expected}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySpec {
    /// Its shape.
    pub shape: ShapeId,
    /// Density, kg/m^3.
    pub density: f64,
    /// Coordinates of the shape's polyhedron -> world.
    pub pose: Pose,
    /// Velocity of the centroid, m/s.
    pub velocity: Vector3,
    /// Angular velocity, world axes, rad/s.
    pub angular_velocity: Vector3,
    /// Its material, by which its contacts find [their laws](crate::World::set_law).
    #[serde(default)]
    pub material: MaterialId,
}

impl BodySpec {
    /// A body at rest.
    pub fn at_rest(shape: ShapeId, density: f64, pose: Pose) -> Self {
        Self {
            shape,
            density,
            pose,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            material: MaterialId::default(),
        }
    }
}

/// Refuses velocities that are not finite.
pub(crate) fn check_velocities(
    velocity: &Vector3,
    angular_velocity: &Vector3,
) -> Result<(), SolveError> {
    let allowed = "finite in every component";
    check("velocity", velocity.norm(), true, allowed)?;
    check("angular_velocity", angular_velocity.norm(), true, allowed)
}

/// The state of a rigid body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Body {
    pub shape: ShapeId,
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia, kg m^2.
    pub moments: Vector3,
    /// Centroid, m.
    pub position: Vector3,
    /// Principal axes -> world.
    pub orientation: Rotation,
    /// m/s.
    pub velocity: Vector3,
    /// Angular momentum in principal axes, kg m^2/s.
    pub momentum: Vector3,
    /// Running bound of the distance any point has travelled, m.
    pub travelled: f64,
    /// Bounding radius, m.
    pub radius: f64,
    /// What the active set judges by.
    pub rest: RestRecord,
    /// External load; what of it follows the body is in principal axes. `None`: none.
    load: Option<Box<AppliedLoad>>,
    /// Prescribed motion, with the pose of the principal axes that it counts from.
    pub driven: Option<Box<(Guide, Pose)>>,
}

impl Body {
    /// What stands for a number that is not a rigid body's.
    pub fn vacant() -> Self {
        Self {
            shape: 0,
            mass: 1.0,
            moments: Vector3::repeat(1.0),
            position: Vector3::zeros(),
            orientation: Rotation::identity(),
            velocity: Vector3::zeros(),
            momentum: Vector3::zeros(),
            travelled: 0.0,
            radius: 1.0,
            rest: RestRecord::default(),
            load: None,
            driven: None,
        }
    }

    pub fn new(spec: &BodySpec, shape: &Shape, radius: f64) -> Result<Self, SolveError> {
        check(
            "density",
            spec.density,
            spec.density > 0.0,
            "positive and finite, in kg/m^3",
        )?;
        let place = shape.place(&checked_pose(&spec.pose)?);
        let position = place.translation.vector;
        check_velocities(&spec.velocity, &spec.angular_velocity)?;
        let mass = shape.volume * spec.density;
        let moments = shape.moments * spec.density;
        for (name, value, allowed) in [
            ("mass of the body", mass, "positive and finite, in kg"),
            (
                "least moment of inertia of the body",
                moments.min(),
                "positive and finite, in kg m^2",
            ),
        ] {
            check(name, value, value > 0.0, allowed)?;
        }
        let body_rate = place.rotation.inverse() * spec.angular_velocity;
        Ok(Self {
            shape: spec.shape,
            mass,
            moments,
            position,
            orientation: place.rotation,
            velocity: spec.velocity,
            momentum: body_rate.component_mul(&moments),
            travelled: 0.0,
            radius,
            rest: RestRecord::default(),
            load: None,
            driven: None,
        })
    }

    /// Angular velocity in world axes, rad/s.
    pub fn angular_velocity(&self) -> Vector3 {
        self.orientation * self.momentum.component_div(&self.moments)
    }

    /// Turns at an angular velocity in world axes, rad/s.
    pub fn turn_at(&mut self, angular_velocity: &Vector3) {
        let in_body = self.orientation.inverse_transform_vector(angular_velocity);
        self.momentum = in_body.component_mul(&self.moments);
    }

    /// A bound of the speed of its points within a step, m/s.
    pub fn fastest(&self) -> f64 {
        // The rate of a free body varies within a step by its nutation; half as much again bounds
        // it at any step a stable simulation takes.
        let rate = self.momentum.component_div(&self.moments).norm();
        self.velocity.norm() + 1.5 * rate * self.radius
    }

    /// Largest acceleration of its points by the external load, m/s^2.
    pub fn pulled(&self) -> f64 {
        let [force, torque] = self.load.as_deref().map_or([0.0; 2], AppliedLoad::largest);
        force / self.mass + torque / self.moments.min() * self.radius
    }

    /// Whether the external load has a torque, or turns with the body.
    pub fn turns_by_load(&self) -> bool {
        let load = self.load.as_deref();
        load.is_some_and(|load| load.largest()[1] > 0.0 || load.follows())
    }

    /// The external load about the centroid in world axes.
    pub fn applied(&self) -> Wrench {
        self.applied_at(&self.orientation)
    }

    /// The same in another orientation.
    pub fn applied_at(&self, orientation: &Rotation) -> Wrench {
        let load = self.load.as_deref();
        load.map_or(Wrench::default(), |load| load.wrench(orientation))
    }

    /// Replaces the external load, whose following parts are in the axes of the shape; returns whether it was another one.
    pub fn set_load(&mut self, load: &AppliedLoad, shape: &Shape) -> bool {
        let seen = load.seen_from(&shape.principal.rotation.inverse());
        let load = (seen != AppliedLoad::default()).then(|| Box::new(seen));
        let is_new = self.load != load;
        self.load = load;
        is_new
    }

    /// J.
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.mass * self.velocity.norm_squared()
            + 0.5
                * self
                    .momentum
                    .component_div(&self.moments)
                    .dot(&self.momentum)
    }

    /// Kinetic energy, and potential energy in gravity (m/s^2), J: what a ledger of free bodies counts.
    pub fn energy(&self, gravity: &Vector3) -> f64 {
        if self.driven.is_some() {
            return 0.0;
        }
        self.kinetic_energy() - self.mass * gravity.dot(&self.position)
    }

    /// Given coordinates of the shape -> world.
    pub fn pose(&self, shape: &Shape) -> Pose {
        self.place() * shape.principal.inverse()
    }

    /// Principal axes -> world.
    pub fn place(&self) -> Pose {
        Pose::from_parts(Translation3::from(self.position), self.orientation)
    }

    /// Takes the place and the velocities of its drive.
    pub fn follow(&mut self, driven: &Driven, place: &Pose) {
        self.position = place.translation.vector;
        self.orientation = place.rotation;
        self.velocity = driven.velocity_at(&self.position);
        self.turn_at(&driven.angular_velocity());
    }

    /// What the contact stage sees.
    pub fn motion(&self) -> Motion {
        let rotation = self.orientation.to_rotation_matrix().into_inner();
        let frame = Frame {
            position: self.position,
            rotation,
        };
        if self.driven.is_some() {
            return Motion {
                velocity: self.velocity,
                angular_velocity: self.angular_velocity(),
                travelled: self.travelled,
                ..Motion::fixed(frame)
            };
        }
        let inverse = self.moments.map(|i| 1.0 / i);
        let isotropic = inverse.x == inverse.y && inverse.y == inverse.z;
        let inverse_inertia = if isotropic {
            Matrix3::from_diagonal(&inverse)
        } else {
            rotation * Matrix3::from_diagonal(&inverse) * rotation.transpose()
        };
        Motion {
            frame,
            velocity: self.velocity,
            angular_velocity: rotation * self.momentum.component_mul(&inverse),
            inverse_mass: 1.0 / self.mass,
            inverse_inertia,
            inverse_inertia_max: inverse.max(),
            travelled: self.travelled,
        }
    }
}
