//! The shape: a radius.

use crate::error::{ContactError, check};
use crate::general::FieldMesh;
use crate::shape::ConvexShape;
use crate::sides::ONE_SIDE;
use femdem_mesh::shapes;
use std::f64::consts::PI;

/// Radii, m, whose powers neither overflow nor underflow.
const RADII: std::ops::RangeInclusive<f64> = 1e-40..=1e40;

/// A ball of radius R with its gauge field phi = 1 - r/R, r the distance from its centre.
///
/// It is the limit of ever finer polyhedra ([`ConvexShape`](crate::ConvexShape)) on the sphere. Contacts with rigid
/// bodies and walls of every kind are those of the exact ball ([`SphereKernel`](crate::SphereKernel)). With
/// deformable bodies the ball is replaced by an inscribed polyhedron of 1,280 facets, at most 0.46 % of the radius
/// below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    radius: f64,
}

impl Sphere {
    /// A sphere of a radius in m.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the radius is between 1e-40 and 1e40 m.
    pub fn new(radius: f64) -> Result<Self, ContactError> {
        let allowed = "between 1e-40 and 1e40 m";
        check("radius", radius, RADII.contains(&radius), allowed)?;
        Ok(Self { radius })
    }

    /// Its radius, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Stiffness per unit penalty of a contact over the stiffest side against an equal body, m: 2 A/R with the area
    /// A of the cap whose normals lie within 18 degrees of its axis, as for the facets of a
    /// [`ConvexShape`](crate::ConvexShape::face_stiffness).
    pub fn face_stiffness(&self) -> f64 {
        4.0 * PI * (1.0 - ONE_SIDE) * self.radius
    }

    /// The tetrahedra that stand for the ball among deformable bodies.
    pub(crate) fn stand_in(&self) -> Result<FieldMesh, ContactError> {
        let facets = shapes::Shape::from(shapes::Sphere { level: 3 });
        ConvexShape::new(&facets.polyhedron(2.0 * self.radius)?)?.fan()
    }
}
