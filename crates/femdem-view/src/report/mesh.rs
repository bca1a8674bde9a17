//! A shape's surface in the form that the graphics processor takes.

use femdem_mesh::{Polyhedron, Vector3};

/// Triangles over shared vertices, where the last corner of each triangle carries its face's normal.
///
/// A flat-shaded triangle takes its normal from its last corner only, so that a vertex may be shared with
/// triangles of other faces as a first or second corner: few vertices are duplicated.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Surface {
    /// Three coordinates for each vertex, relative to the centroid \[m\].
    pub points: Vec<f32>,
    /// Three components for each vertex.
    pub normals: Vec<f32>,
    /// Three corners for each triangle.
    pub corners: Vec<u32>,
}

impl Surface {
    pub fn of(shape: &Polyhedron) -> Self {
        let centroid = shape.mass_properties().centroid;
        // For each vertex made: the vertex of the shape, and the face whose normal it carries.
        let mut made: Vec<(u32, Option<usize>)> = Vec::new();
        made.extend((0..shape.vertices().len() as u32).map(|v| (v, None)));
        let mut corners = Vec::new();
        let mut triangles = shape.triangles().into_iter();
        for (face, outline) in shape.faces().enumerate() {
            // A face of n corners has n - 2 triangles, listed face by face.
            let listed = triangles.by_ref().take(outline.len().saturating_sub(2));
            let mut listed: Vec<[u32; 3]> = listed.collect();
            if shape.is_convex() {
                let free = outline.iter().position(|v| made[*v as usize].1.is_none());
                // If all corners carry normals of other faces, any serves, and is doubled below.
                listed = fan(outline, free.unwrap_or(0));
            }
            // Duplicates of vertices made for this face.
            let mut doubled: Vec<u32> = Vec::new();
            for triangle in listed {
                corners.extend(carried(triangle, face, &mut made, &mut doubled));
            }
        }
        let mut surface = Self {
            corners,
            ..Self::default()
        };
        for (vertex, face) in made {
            let from = shape.vertices()[vertex as usize] - centroid;
            let normal = face.map_or(Vector3::zeros(), |face| shape.face_normal(face));
            surface.points.extend(from.iter().map(|x| *x as f32));
            surface.normals.extend(normal.iter().map(|x| *x as f32));
        }
        surface
    }
}

/// A convex outline as triangles that share its corner `first`.
fn fan(outline: &[u32], first: usize) -> Vec<[u32; 3]> {
    let (behind, ahead) = outline.split_at(first);
    let turned: Vec<u32> = ahead.iter().chain(behind).copied().collect();
    let triangles = turned.windows(2).skip(1);
    triangles
        .map(|pair| [turned[0], pair[0], pair[1]])
        .collect()
}

/// The corners of a triangle, turned so that the last one carries the face's normal.
fn carried(
    triangle: [u32; 3],
    face: usize,
    made: &mut Vec<(u32, Option<usize>)>,
    doubled: &mut Vec<u32>,
) -> [u32; 3] {
    let [a, b, c] = triangle;
    let turns = [[b, c, a], [c, a, b], [a, b, c]];
    let owner = |v: u32, made: &[(u32, Option<usize>)]| made.get(v as usize).and_then(|m| m.1);
    if let Some(turn) = turns.iter().find(|turn| owner(turn[2], made) == Some(face)) {
        return *turn;
    }
    let known = |v: u32| {
        doubled
            .iter()
            .find(|d| made.get(**d as usize).is_some_and(|m| m.0 == v))
    };
    for [p, q, last] in turns {
        if let Some(double) = known(last) {
            return [p, q, *double];
        }
    }
    if let Some(turn) = turns.iter().find(|turn| owner(turn[2], made).is_none()) {
        if let Some(free) = made.get_mut(turn[2] as usize) {
            free.1 = Some(face);
        }
        return *turn;
    }
    let double = made.len() as u32;
    made.push((a, Some(face)));
    doubled.push(double);
    [b, c, double]
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::catalogue::{CatalogueShape, Solid};

    /// Each triangle lies in a plane with the normal that its last corner carries.
    #[test]
    fn last_corners_carry_the_normals_of_their_triangles() {
        for solid in Solid::ALL {
            let shape = CatalogueShape::from(solid).polyhedron(1.0).unwrap();
            let surface = Surface::of(&shape);
            let vector = |list: &[f32], v: u32| {
                let at = 3 * v as usize;
                Vector3::from_fn(|k, _| f64::from(list[at + k]))
            };
            assert_eq!(surface.corners.len(), 3 * shape.triangles().len());
            for corners in surface.corners.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| vector(&surface.points, corners[k]));
                let normal = (b - a).cross(&(c - a)).normalize();
                let carried = vector(&surface.normals, corners[2]);
                assert!((normal - carried).norm() < 1e-4, "{solid:?}");
            }
        }
    }

    #[test]
    fn a_truncated_dodecahedron_needs_no_vertex_twice() {
        let shape = CatalogueShape::from(Solid::A10).polyhedron(1.0).unwrap();
        assert!(Surface::of(&shape).points.len() / 3 <= 66);
    }
}
