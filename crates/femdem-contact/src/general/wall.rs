//! Rigid walls given as solids of tetrahedra, without a field.

use crate::error::ContactError;
use crate::tets::cells::Cells;
use femdem_mesh::{Point3, TetMesh, Vector3};

/// A rigid wall of any shape: the space that its tetrahedra fill is solid.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidWall {
    pub(crate) cells: Cells,
}

impl SolidWall {
    /// A wall that fills the volume of a mesh, in the mesh's coordinates.
    pub fn solid(mesh: &TetMesh) -> Self {
        let values = vec![0.0; mesh.points().len()];
        Self {
            cells: Cells::new(mesh, &Vector3::zeros(), &values),
        }
    }

    /// A wall behind an open or closed sheet of triangles, `thickness` (m) deep. Bodies are on the side to
    /// which the triangles' normals point (from which their points run counter-clockwise).
    ///
    /// Points move back along the mean normal of their triangles, weighted by angle, such that the mean
    /// thickness over these triangles is `thickness`. A body must not pass through: choose a thickness well
    /// above any penetration, but below the radius of curvature of the sheet where it bends towards its back.
    ///
    /// # Errors
    /// [`ContactError::Wall`] if the thickness is not positive and finite, or if the triangles have no area,
    /// refer to points that do not exist, are not connected, are not oriented consistently, or are bent too
    /// sharply for the thickness.
    pub fn sheet(
        points: &[Point3],
        triangles: &[[u32; 3]],
        thickness: f64,
    ) -> Result<Self, ContactError> {
        thicken(points, triangles, thickness)
            .map(|mesh| Self::solid(&mesh))
            .map_err(|why| ContactError::Wall {
                name: "sheet".to_owned(),
                why,
            })
    }

    /// The axis-aligned box around the wall in its own axes, as (lowest, highest) corner, m.
    pub fn bounds(&self) -> (Vector3, Vector3) {
        let b = self.cells.tree.bounds();
        (b.low.coords, b.high.coords)
    }
}

/// The mesh of prisms behind a sheet, each of three tetrahedra.
fn thicken(points: &[Point3], triangles: &[[u32; 3]], thickness: f64) -> Result<TetMesh, String> {
    if !(thickness.is_finite() && thickness > 0.0) {
        return Err(format!(
            "its thickness is {thickness} m; it must be positive and finite"
        ));
    }
    let normals = point_normals(points, triangles)?;
    let count = points.len() as u32;
    let back = points.iter().zip(&normals).map(|(p, n)| p - n * thickness);
    let all: Vec<Point3> = points.iter().copied().chain(back).collect();
    let mut tets = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles {
        // The lower of two points keeps the diagonal in front, so that neighbours agree on it.
        let mut sorted = *triangle;
        sorted.sort_unstable();
        let [a, b, c] = sorted;
        let even = (0..3).any(|k| [a, b, c] == [0, 1, 2].map(|j| triangle[(j + k) % 3]));
        let behind = |i: u32| i + count;
        for tet in [
            [a, b, c, behind(c)],
            [a, b, behind(c), behind(b)],
            [a, behind(b), behind(c), behind(a)],
        ] {
            let [p, q, r, s] = tet;
            tets.push(if even { [q, p, r, s] } else { tet });
        }
    }
    TetMesh::new(all, tets).map_err(|e| {
        format!("the sheet, {thickness} m thick, is no valid solid: {e}; try a thinner one")
    })
}

/// Normals of the points, scaled so that their mean projection on their triangles' normals is 1.
fn point_normals(points: &[Point3], triangles: &[[u32; 3]]) -> Result<Vec<Vector3>, String> {
    let mut sums = vec![Vector3::zeros(); points.len()];
    let mut angles = vec![0.0; points.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        if triangle.iter().any(|&i| i as usize >= points.len()) {
            return Err(format!(
                "triangle {t} names a point that does not exist ({triangle:?}); there are {}",
                points.len()
            ));
        }
        let x = triangle.map(|i| points[i as usize]);
        let vector = (x[1] - x[0]).cross(&(x[2] - x[0]));
        let Some(normal) = vector.try_normalize(0.0) else {
            return Err(format!("triangle {t} has no area"));
        };
        for k in 0..3 {
            let (u, v) = (x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
            let angle = u.angle(&v);
            sums[triangle[k] as usize] += normal * angle;
            angles[triangle[k] as usize] += angle;
        }
    }
    // |sum| / angle is the mean cosine between the direction of the sum and the normals.
    let scaled = |(i, (s, angle)): (usize, (&Vector3, &f64))| {
        let squared = s.norm_squared();
        if squared > 1e-12 * angle * angle {
            Ok(s * (angle / squared))
        } else {
            Err(format!(
                "point {i} has no triangles, or ones that are folded back"
            ))
        }
    };
    sums.iter().zip(&angles).enumerate().map(scaled).collect()
}
