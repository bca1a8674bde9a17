//! Tetrahedral meshes of bodies, and how to make them.
//!
//! A [`TetMesh`] is checked: every triangle has one or two tetrahedra, all of positive volume. [`mesh`] makes
//! one from any closed surface and describes it in a [`MeshReport`]:
//!
//! - convex bodies: tetrahedra about the centroid; star-shaped ones: about the centre of the largest sphere in
//!   the kernel. They are refined by cutting edges in half. The skin is exactly the surface.
//! - all others: isosurface stuffing. A body-centred cubic lattice is warped and cut to the surface; then
//!   points of the skin are moved to the surface's corners and sharp edges, where shapes allow, and shapes are
//!   improved. Blocks whose faces are perpendicular are represented to rounding, in any orientation; curved
//!   surfaces to the second order of the edge length.
//!
//! A mesh that does not meet [`MeshOptions`], or has other holes than the body, is refused after a few attempts
//! with finer lattices. Every tetrahedron has a point inside the body, as required for a field that is zero on
//! the skin.
//!
//! ```
//! use femdem_mesh::shapes::{Dolos, Shape};
//! use femdem_mesh::tet::{MeshOptions, mesh};
//!
//! let dolos = Shape::from(Dolos::default()).polyhedron(1.0)?;
//! let options = MeshOptions { edge_length: Some(0.08), ..MeshOptions::default() };
//! let (mesh, report) = mesh(&dolos, &options)?;
//! assert!(report.volume_error.abs() < 0.02);
//! assert!(report.quality.min_dihedral.to_degrees() > 5.0);
//! assert!(mesh.every_tet_has_interior_point());
//! # Ok::<(), femdem_mesh::MeshError>(())
//! ```
//!
//! Parts thinner than the edge length are invisible to the lattice. If that changes the number of parts or
//! holes, the mesh is refused; a thin fin or spike can be lost, which [`MeshReport::distance`] shows. Noise of
//! a surface on the scale of the edge length is smoothed. The surface must not cut through itself; if it does,
//! its inside is where its winding number exceeds one half.

mod body;
mod cracked;
mod cracked_part;
pub(crate) mod distance;
mod draft;
mod facets;
mod fan;
mod features;
mod interior;
mod lattice;
mod lp;
mod mesher;
mod quadratic;
mod quality;
mod rectangular;
mod refine;
mod revolved;
mod snap;
mod structured;
mod stuffing;
mod topology;
mod winding;

use crate::polyhedron::check_coordinates;
use crate::{MassProperties, MeshError, Point3, Polyhedron, Vector3};
pub use cracked::{CrackedMesh, Split};
pub use cracked_part::CrackedPart;
pub(crate) use distance::Triangles;
pub use facets::{Facet, Facets};
pub use mesher::{MeshOptions, MeshReport, Method, mesh};
pub use quadratic::{MID_EDGES, QuadraticMesh};
pub use quality::Quality;
pub use rectangular::RectangularShell;
pub use revolved::RevolvedShell;
use serde::{Deserialize, Serialize};
pub(crate) use winding::Winding;

/// The triangles of a tetrahedron of positive volume, opposite its points 0 to 3, each
/// counter-clockwise seen from outside.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// A tetrahedron counts as flat if six times its volume is below this part of the cube of its
/// longest edge.
const FLATNESS_TOLERANCE: f64 = 1e-12;

/// A tetrahedral mesh of one solid body.
///
/// Always valid (see [`TetMesh::new`]). Serialised as points and tetrahedra, and validated again
/// when read back.
///
/// ```
/// use femdem_mesh::{TetMesh, Vector3};
///
/// // A bar of 4 x 1 x 1 cells.
/// let bar = TetMesh::block([4, 1, 1], &Vector3::new(0.4, 0.1, 0.1))?;
/// assert!((bar.volume() - 4e-3).abs() < 1e-15);
/// assert_eq!(bar.tets().len(), bar.neighbours().len());
/// // Every triangle of the skin belongs to its surface, which is a body again.
/// assert!((bar.surface()?.area() - (4.0 * 0.04 + 2.0 * 0.01)).abs() < 1e-12);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct TetMesh {
    points: Vec<Point3>,
    tets: Vec<[u32; 4]>,
    neighbours: Vec<[Option<u32>; 4]>,
    skin: Vec<[u32; 3]>,
    on_skin: Vec<bool>,
}

/// The parts from which a mesh is made; its stored form.
#[derive(Serialize, Deserialize)]
#[serde(rename = "TetMesh", deny_unknown_fields)]
struct Parts {
    points: Vec<Point3>,
    tets: Vec<[u32; 4]>,
    #[serde(default)]
    in_pieces: bool,
}

impl TryFrom<Parts> for TetMesh {
    type Error = MeshError;

    fn try_from(parts: Parts) -> Result<Self, MeshError> {
        if parts.in_pieces {
            Self::in_pieces(parts.points, parts.tets)
        } else {
            Self::new(parts.points, parts.tets)
        }
    }
}

impl From<TetMesh> for Parts {
    fn from(mesh: TetMesh) -> Self {
        Self {
            in_pieces: mesh.pieces() > 1,
            points: mesh.points,
            tets: mesh.tets,
        }
    }
}

impl TetMesh {
    /// Makes a mesh from points \[m\] and tetrahedra, each given by four indices of points (a, b, c, d) with
    /// (b - a) . ((c - a) x (d - a)) > 0.
    ///
    /// # Errors
    ///
    /// Refuses, naming the place: coordinates that are not finite, or too small, large or far from the origin
    /// for the arithmetic; no tetrahedra; indices out of range; points that no tetrahedron uses; tetrahedra
    /// that are inverted or flat; triangles shared by more than two tetrahedra, or by two on the same side; and
    /// meshes in several pieces (pieces that share no triangle). Tetrahedra that overlap without sharing a
    /// triangle are not detected.
    pub fn new(points: Vec<Point3>, tets: Vec<[u32; 4]>) -> Result<Self, MeshError> {
        let mesh = Self::in_pieces(points, tets)?;
        match mesh.pieces() {
            1 => Ok(mesh),
            pieces => Err(MeshError::SeveralPieces { pieces }),
        }
    }

    /// As [`new`](Self::new), of a body that may be in several pieces, such as one that cracks have broken.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new), but for that.
    pub fn in_pieces(points: Vec<Point3>, tets: Vec<[u32; 4]>) -> Result<Self, MeshError> {
        topology::check_indices(points.len(), &tets)?;
        check_coordinates(&points)?;
        for (tet, corners) in tets.iter().enumerate() {
            check_volume(tet, corners.map(|i| points[i as usize]))?;
        }
        let (neighbours, skin) = topology::connect(&tets)?;
        let mut on_skin = vec![false; points.len()];
        for &i in skin.iter().flatten() {
            on_skin[i as usize] = true;
        }
        Ok(Self {
            points,
            tets,
            neighbours,
            skin,
            on_skin,
        })
    }

    /// Tetrahedra about the centroid of a convex body, one for each triangle of its surface.
    ///
    /// # Errors
    ///
    /// If the body is not convex, or a tetrahedron would be flat.
    pub fn centroid_fan(polyhedron: &Polyhedron) -> Result<Self, MeshError> {
        fan::about_centroid(polyhedron)
    }

    /// Tetrahedra about one point from which all of the surface can be seen, one for each triangle
    /// of the surface. The point is the centre of the largest sphere in the kernel.
    ///
    /// # Errors
    ///
    /// If there is no such point: the error names faces that no point sees together.
    pub fn star_fan(polyhedron: &Polyhedron) -> Result<Self, MeshError> {
        fan::about_kernel(polyhedron)
    }

    /// A block from the origin to `size` \[m\], cut into `cells` along x, y and z, each of six tetrahedra. With
    /// one or two cells along an axis some tetrahedra have no point inside the body; use
    /// [`TetMesh::with_interior_points`] where that matters.
    ///
    /// # Errors
    ///
    /// If a length is not positive or a number of cells zero, or there would be more points or
    /// tetrahedra than 32-bit indices can name.
    pub fn block(cells: [u32; 3], size: &Vector3) -> Result<Self, MeshError> {
        structured::block(cells, size)
    }

    /// The eighth of a hollow sphere about the origin that lies in x, y, z >= 0, between two radii \[m\]:
    /// `around` cells along each curved edge, `through` layers. The three plane faces are exactly plane; points
    /// of the spheres lie on them.
    ///
    /// # Errors
    ///
    /// If 0 < `inner` < `outer` does not hold, a number of cells is zero, or there would be more
    /// points or tetrahedra than 32-bit indices can name.
    pub fn shell_octant(
        inner: f64,
        outer: f64,
        around: u32,
        through: u32,
    ) -> Result<Self, MeshError> {
        structured::shell_octant(inner, outer, around, through)
    }

    /// The points \[m\].
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// The tetrahedra, as four indices of points each.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// Per tetrahedron its neighbours across the triangles opposite its points 0 to 3 (see
    /// [`FACES`]); none where that triangle is on the skin.
    pub fn neighbours(&self) -> &[[Option<u32>; 4]] {
        &self.neighbours
    }

    /// The triangles of the skin, counter-clockwise seen from outside, in the order of the
    /// tetrahedra that own them.
    pub fn skin(&self) -> &[[u32; 3]] {
        &self.skin
    }

    /// Whether point `i` lies on the skin; false for points that do not exist.
    pub fn is_skin_point(&self, i: usize) -> bool {
        self.on_skin.get(i).copied().unwrap_or(false)
    }

    /// The corners of a tetrahedron of this mesh.
    pub(crate) fn corners(&self, tet: [u32; 4]) -> [Point3; 4] {
        tet.map(|i| self.points[i as usize])
    }

    /// Number of its pieces, which share no triangle with each other: 1, but for those made by [`in_pieces`](Self::in_pieces).
    #[must_use]
    pub fn pieces(&self) -> usize {
        topology::pieces(&self.neighbours)
    }

    /// Volume \[m^3\].
    pub fn volume(&self) -> f64 {
        self.mass_properties().volume
    }

    /// Volume, centroid and inertia for unit density, by exact integration.
    pub fn mass_properties(&self) -> MassProperties {
        MassProperties::of_surface(&self.points, self.skin.iter().copied())
    }

    /// Shapes of the tetrahedra: the worst and the mean.
    pub fn quality(&self) -> Quality {
        Quality::of(self.tets.iter().map(|&tet| self.corners(tet)))
    }

    /// The skin as a surface of triangles. Its vertices are the skin's points in their order.
    ///
    /// # Errors
    ///
    /// If the skin is not one valid surface: it touches itself in a point or an edge, or has
    /// several parts ([`MeshError::Hollow`] if one lies inside another).
    pub fn surface(&self) -> Result<Polyhedron, MeshError> {
        self.moved_surface(|i| self.points[i])
    }

    /// The same with its points elsewhere, as those of a body that has deformed: `place` says where a point is, by its
    /// index.
    ///
    /// # Errors
    ///
    /// As [`surface`](Self::surface).
    pub fn moved_surface(&self, place: impl Fn(usize) -> Point3) -> Result<Polyhedron, MeshError> {
        let mut new_index = vec![0; self.points.len()];
        let mut vertices = Vec::new();
        for i in (0..self.points.len()).filter(|&i| self.on_skin[i]) {
            new_index[i] = vertices.len() as u32;
            vertices.push(place(i));
        }
        let renumbered = |t: &[u32; 3]| t.map(|i| new_index[i as usize]).to_vec();
        Polyhedron::new(vertices, self.skin.iter().map(renumbered).collect())
    }

    /// The mesh with every tetrahedron split whose four points all lie on the skin.
    ///
    /// A field that is zero on the skin is zero throughout such a tetrahedron, which would offer no resistance.
    /// The tetrahedron is cut at the middle of an edge that runs through the body, together with all tetrahedra
    /// around that edge, or at its centroid, whichever leaves the better shapes.
    pub fn with_interior_points(&self) -> Self {
        interior::with_interior_points(self)
    }

    /// The mesh with every tetrahedron cut into eight, at the middles of all edges.
    ///
    /// # Errors
    ///
    /// If there would be more points or tetrahedra than 32-bit indices can name, or if halving
    /// lengths exhausts the digits of coordinates.
    pub fn refined(&self) -> Result<Self, MeshError> {
        refine::refined(self)
    }

    /// Whether every tetrahedron has a point that does not lie on the skin.
    pub fn every_tet_has_interior_point(&self) -> bool {
        let dead = |tet: &[u32; 4]| tet.iter().all(|&i| self.on_skin[i as usize]);
        !self.tets.iter().any(dead)
    }

    /// Distance of every point to the nearest triangle of the skin \[m\]; 0 for points of the skin.
    pub fn distance_to_skin(&self) -> Vec<f64> {
        let triangles =
            Triangles::new(self.skin.iter().map(|t| t.map(|i| self.points[i as usize])));
        self.points
            .iter()
            .zip(&self.on_skin)
            .map(|(p, &on_skin)| if on_skin { 0.0 } else { triangles.distance(p) })
            .collect()
    }
}

/// Six times the signed volume of a tetrahedron \[m^3\].
pub(crate) fn six_volumes([a, b, c, d]: [Point3; 4]) -> f64 {
    (b - a).dot(&(c - a).cross(&(d - a)))
}

/// The tetrahedron with its last two points in the order that gives it a positive volume.
pub(crate) fn oriented(tet: [u32; 4], points: &[Point3]) -> [u32; 4] {
    let [a, b, c, d] = tet;
    if six_volumes(tet.map(|i| points[i as usize])) < 0.0 {
        [a, b, d, c]
    } else {
        tet
    }
}

/// The six edges of a tetrahedron, as pairs of its points.
pub(crate) const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

fn check_volume(tet: usize, corners: [Point3; 4]) -> Result<(), MeshError> {
    let longest = EDGES
        .iter()
        .map(|&[i, j]| (corners[i] - corners[j]).norm())
        .fold(0.0, f64::max);
    let volume = six_volumes(corners) / 6.0;
    if 6.0 * volume > FLATNESS_TOLERANCE * longest.powi(3) {
        Ok(())
    } else {
        Err(MeshError::FlatTetrahedron { tet, volume })
    }
}

#[cfg(test)]
mod tests;
