//! Shapes beyond the solids of the [catalogue](crate::catalogue): round and square bodies, pellets,
//! boulders, armour units, clumps.
//!
//! Each family is a struct of named parameters with defaults ([`Cylinder`], [`Dolos`], ...); a [`Shape`] is one
//! of them and can be parsed from text such as `dolos:waist=0.34`. A shape has one size, a length whose meaning
//! the family states; all its parameters are ratios. Bodies have their centroid at the origin. Round surfaces
//! are polyhedral, with their vertices on the true surface: volumes are smaller than the smooth body's by the
//! amount that each family states.
//!
//! Sphere, ellipsoid, superquadric, box, rounded cube, cylinder and boulder are convex. Lobed
//! extrudates, tetrapods and many clumps are star-shaped: their centroid sees all of the surface.
//! Hollow cylinder, pellet, Antifer cube and dolos are neither.
//!
//! ```
//! use femdem_mesh::shapes::{Boulder, Shape};
//! let ring: Shape = "hollow_cylinder:bore=0.4,aspect=2".parse()?;
//! let body = ring.polyhedron(0.01)?;
//! assert_eq!(body.euler_characteristic(), 0); // One hole through it.
//!
//! let rock = Shape::from(Boulder { seed: 7, angularity: 0.8, ..Boulder::default() });
//! let body = rock.polyhedron(Boulder::size_for_mass(40.0, 2700.0)?)?;
//! assert!((body.mass_properties().volume * 2700.0 - 40.0).abs() < 1e-9);
//! # Ok::<(), femdem_mesh::MeshError>(())
//! ```

mod armour;
mod blocks;
mod boulder;
mod clump;
mod extruded;
mod family;
mod level_set;
mod listing;
mod planar;
mod random;
mod round;
mod superquadric;
mod text;
mod weld;

use crate::catalogue::CatalogueShape;
use crate::{MeshError, Polyhedron};
pub use armour::{Antifer, Dolos, Tetrapod};
pub use blocks::{Cuboid, RoundedCube};
pub use boulder::{BOULDER_SMALLEST_ALTITUDE, Boulder};
pub use clump::{Clump, ClumpSphere, ClumpSpheres};
pub use extruded::{Cylinder, HollowCylinder, Lobed, Pellet};
use family::Family;
pub use family::Parameter;
pub use listing::listing;
pub use round::{Ellipsoid, Sphere};
use serde::{Deserialize, Serialize};
pub use superquadric::Superquadric;

macro_rules! shapes {
    ($($(#[doc = $doc:literal])+ $family:ident,)*) => {
        /// A shape of any family, or a solid of the catalogue.
        ///
        /// Written as its family and the parameters that differ from their defaults
        /// (`cylinder:aspect=2,sides=24`); with `{:#}`, and serialised, with all of them. Read from
        /// the same, in any order of parameters.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(try_from = "String", into = "String")]
        #[non_exhaustive]
        pub enum Shape {
            /// A Platonic or Archimedean solid; the size is the diameter of the circumscribed sphere.
            Solid(CatalogueShape),
            $($(#[doc = $doc])+ $family($family),)*
        }

        $(
            impl From<$family> for Shape {
                fn from(shape: $family) -> Self {
                    Self::$family(shape)
                }
            }
        )*

        impl Shape {
            /// One of each family, with default parameters; without the catalogue's solids.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$family($family::default()),)*]
            }

            fn family(&self) -> &dyn Family {
                match self {
                    Self::Solid(solid) => solid,
                    $(Self::$family(shape) => shape,)*
                }
            }

            fn family_mut(&mut self) -> &mut dyn Family {
                match self {
                    Self::Solid(solid) => solid,
                    $(Self::$family(shape) => shape,)*
                }
            }
        }
    };
}

shapes! {
    /// Sphere.
    Sphere,
    /// Ellipsoid.
    Ellipsoid,
    /// Superquadric.
    Superquadric,
    /// Box.
    Cuboid,
    /// Cube with rounded edges.
    RoundedCube,
    /// Cylinder.
    Cylinder,
    /// Hollow cylinder.
    HollowCylinder,
    /// Catalyst pellet with several holes.
    Pellet,
    /// Trilobe, quadrilobe and their like.
    Lobed,
    /// Boulder.
    Boulder,
    /// Antifer cube.
    Antifer,
    /// Dolos.
    Dolos,
    /// Tetrapod.
    Tetrapod,
    /// Clump of spheres.
    Clump,
}

impl From<CatalogueShape> for Shape {
    fn from(solid: CatalogueShape) -> Self {
        Self::Solid(solid)
    }
}

impl Shape {
    /// Name of the family: "sphere", "dolos"; of a solid its identifier.
    pub fn name(&self) -> String {
        self.family().name()
    }

    /// The family in a few words.
    pub fn summary(&self) -> &'static str {
        self.family().summary()
    }

    /// The length of the body that is its size.
    pub fn size_meaning(&self) -> &'static str {
        self.family().size_meaning()
    }

    /// The parameters with their values, in order.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.family().parameters()
    }

    /// Sets the parameter called `name` from text.
    ///
    /// # Errors
    ///
    /// If the family has no such parameter, or the text is not a valid value. Ranges are checked by
    /// [`polyhedron`](Self::polyhedron).
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), MeshError> {
        self.family_mut().set(name, text)
    }

    /// The body with its centroid at the origin.
    ///
    /// `size` \[m\] is the length described by [`size_meaning`](Self::size_meaning).
    ///
    /// # Errors
    ///
    /// If `size` is not between 1e-20 and 1e20 m, a parameter lies outside its range, or parameters
    /// contradict each other (holes that overlap, spheres of a clump that do not touch).
    pub fn polyhedron(&self, size: f64) -> Result<Polyhedron, MeshError> {
        if !(1e-20..=1e20).contains(&size) {
            return Err(MeshError::OutOfRange {
                what: "the size of a shape in metres",
                value: size,
                allowed: "1e-20 to 1e20",
            });
        }
        self.family().check()?;
        self.family().unit()?.scaled(size)
    }

    /// The size \[m\] at which the body has a volume \[m^3\].
    ///
    /// # Errors
    ///
    /// If the volume is not positive and finite, or as for [`polyhedron`](Self::polyhedron).
    pub fn size_for_volume(&self, volume: f64) -> Result<f64, MeshError> {
        if !(volume > 0.0 && volume.is_finite()) {
            return Err(MeshError::OutOfRange {
                what: "the volume of a shape in cubic metres",
                value: volume,
                allowed: "a positive, finite number",
            });
        }
        let unit = self.polyhedron(1.0)?;
        Ok((volume / unit.mass_properties().volume).cbrt())
    }
}

impl Family for CatalogueShape {
    fn name(&self) -> String {
        self.id()
    }

    fn summary(&self) -> &'static str {
        CatalogueShape::name(self)
    }

    fn size_meaning(&self) -> &'static str {
        "the diameter of the circumscribed sphere"
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn set(&mut self, name: &str, _: &str) -> Result<(), MeshError> {
        Err(MeshError::UnknownParameter {
            shape: self.id(),
            parameter: name.chars().take(80).collect(),
            allowed: "none".to_owned(),
        })
    }

    fn check(&self) -> Result<(), MeshError> {
        Ok(())
    }

    fn unit(&self) -> Result<Polyhedron, MeshError> {
        CatalogueShape::polyhedron(self, 1.0)
    }
}
