//! The 5 Platonic and 13 Archimedean solids.
//!
//! Named P1 to P5 and A1 to A13 as in Xiang, Latham and Farsi (7th International Conference on
//! Discrete Element Methods, 2016), after Torquato and Jiao, "Dense packings of the Platonic and
//! Vertices are computed from closed formulas, faces as their convex hull. The two chiral solids, A3 and A4,
//! exist in both hands: the default one, and its image in the plane x = 0, A3m and A4m.

mod coordinates;

use crate::{MeshError, Polyhedron, convex_hull};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A Platonic or Archimedean solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Solid {
    /// Tetrahedron.
    P1,
    /// Icosahedron.
    P2,
    /// Dodecahedron.
    P3,
    /// Octahedron.
    P4,
    /// Cube.
    P5,
    /// Truncated tetrahedron.
    A1,
    /// Truncated icosahedron.
    A2,
    /// Snub cube (chiral).
    A3,
    /// Snub dodecahedron (chiral).
    A4,
    /// Rhombicosidodecahedron.
    A5,
    /// Truncated icosidodecahedron.
    A6,
    /// Truncated cuboctahedron.
    A7,
    /// Icosidodecahedron.
    A8,
    /// Rhombicuboctahedron.
    A9,
    /// Truncated dodecahedron.
    A10,
    /// Cuboctahedron.
    A11,
    /// Truncated cube.
    A12,
    /// Truncated octahedron.
    A13,
}

impl Solid {
    /// All 18, Platonic solids first.
    pub const ALL: [Self; 18] = [
        Self::P1,
        Self::P2,
        Self::P3,
        Self::P4,
        Self::P5,
        Self::A1,
        Self::A2,
        Self::A3,
        Self::A4,
        Self::A5,
        Self::A6,
        Self::A7,
        Self::A8,
        Self::A9,
        Self::A10,
        Self::A11,
        Self::A12,
        Self::A13,
    ];

    /// Identifier and name.
    const fn labels(self) -> (&'static str, &'static str) {
        match self {
            Self::P1 => ("P1", "tetrahedron"),
            Self::P2 => ("P2", "icosahedron"),
            Self::P3 => ("P3", "dodecahedron"),
            Self::P4 => ("P4", "octahedron"),
            Self::P5 => ("P5", "cube"),
            Self::A1 => ("A1", "truncated tetrahedron"),
            Self::A2 => ("A2", "truncated icosahedron"),
            Self::A3 => ("A3", "snub cube"),
            Self::A4 => ("A4", "snub dodecahedron"),
            Self::A5 => ("A5", "rhombicosidodecahedron"),
            Self::A6 => ("A6", "truncated icosidodecahedron"),
            Self::A7 => ("A7", "truncated cuboctahedron"),
            Self::A8 => ("A8", "icosidodecahedron"),
            Self::A9 => ("A9", "rhombicuboctahedron"),
            Self::A10 => ("A10", "truncated dodecahedron"),
            Self::A11 => ("A11", "cuboctahedron"),
            Self::A12 => ("A12", "truncated cube"),
            Self::A13 => ("A13", "truncated octahedron"),
        }
    }

    /// Identifier: "P1" to "P5", "A1" to "A13".
    pub const fn id(self) -> &'static str {
        self.labels().0
    }

    /// Name, such as "truncated cube".
    pub const fn name(self) -> &'static str {
        self.labels().1
    }

    /// Whether the solid differs from its mirror image: A3 and A4.
    pub const fn is_chiral(self) -> bool {
        matches!(self, Self::A3 | Self::A4)
    }
}

impl fmt::Display for Solid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

/// A solid of the catalogue, in one of its two hands.
///
/// Written and serialised as its identifier ("A10", "A3m"); read from the identifier or the name,
/// in any case, with spaces, hyphens or underscores ("truncated-dodecahedron",
/// "snub cube (mirror image)").
///
/// ```
/// use femdem_mesh::catalogue::{CatalogueShape, Solid};
/// let shape: CatalogueShape = "truncated dodecahedron".parse()?;
/// assert_eq!(shape, Solid::A10.into());
/// let body = shape.polyhedron(0.02)?;
/// assert_eq!((body.vertices().len(), body.face_count()), (60, 32));
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct CatalogueShape {
    /// Which solid.
    pub solid: Solid,
    /// Whether it is the mirror image. Without effect on solids that are not chiral.
    pub mirrored: bool,
}

impl CatalogueShape {
    /// The 18 solids, chiral ones in their default hand.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        Solid::ALL.into_iter().map(Self::from)
    }

    /// The 18 solids, then the mirror images of the two chiral ones.
    pub fn all_with_mirror_images() -> impl Iterator<Item = Self> {
        Self::all().chain(Self::all().filter_map(Self::mirror_image))
    }

    /// The other hand of a chiral solid; none if the solid is its own mirror image.
    pub fn mirror_image(self) -> Option<Self> {
        let mirror_image = Self {
            solid: self.solid,
            mirrored: !self.mirrored,
        };
        self.solid.is_chiral().then_some(mirror_image)
    }

    fn is_mirror_image(self) -> bool {
        self.mirrored && self.solid.is_chiral()
    }

    /// Name, such as "truncated cube" or "snub cube (mirror image)".
    pub fn name(&self) -> &'static str {
        match (self.is_mirror_image(), self.solid) {
            (true, Solid::A3) => "snub cube (mirror image)",
            (true, Solid::A4) => "snub dodecahedron (mirror image)",
            (_, solid) => solid.name(),
        }
    }

    /// Identifier: "P1" to "P5", "A1" to "A13", "A3m", "A4m".
    pub fn id(&self) -> String {
        let hand = if self.is_mirror_image() { "m" } else { "" };
        format!("{}{hand}", self.solid)
    }

    /// The body with its centroid at the origin.
    ///
    /// `diameter` is that of the circumscribed sphere, on which all vertices lie \[m\].
    ///
    /// # Errors
    ///
    /// If `diameter` is not between 1e-20 and 1e20 m.
    pub fn polyhedron(&self, diameter: f64) -> Result<Polyhedron, MeshError> {
        if !(1e-20..=1e20).contains(&diameter) {
            return Err(MeshError::OutOfRange {
                what: "the diameter of a shape in metres",
                value: diameter,
                allowed: "1e-20 to 1e20",
            });
        }
        let body = convex_hull(&coordinates::vertices(self.solid, diameter / 2.0))?;
        Ok(if self.is_mirror_image() {
            body.mirrored()
        } else {
            body
        })
    }
}

impl From<Solid> for CatalogueShape {
    fn from(solid: Solid) -> Self {
        Self {
            solid,
            mirrored: false,
        }
    }
}

impl fmt::Display for CatalogueShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.id())
    }
}

impl FromStr for CatalogueShape {
    type Err = MeshError;

    fn from_str(name: &str) -> Result<Self, MeshError> {
        let plain = |s: &str| s.to_ascii_lowercase().replace(['-', '_'], " ");
        let wanted = plain(name.trim());
        Self::all_with_mirror_images()
            .find(|shape| wanted == plain(&shape.id()) || wanted == plain(shape.name()))
            .ok_or_else(|| MeshError::UnknownShape {
                name: name.chars().take(80).collect(),
            })
    }
}

impl TryFrom<String> for CatalogueShape {
    type Error = MeshError;

    fn try_from(name: String) -> Result<Self, MeshError> {
        name.parse()
    }
}

impl From<CatalogueShape> for String {
    fn from(shape: CatalogueShape) -> Self {
        shape.id()
    }
}
