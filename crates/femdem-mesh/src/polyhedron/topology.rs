//! Checks of the connectivity: closed, manifold, consistently oriented, in one piece.

use crate::MeshError;

/// The directed sides of a vertex loop.
pub(crate) fn sides(face: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    let next = face.iter().cycle().skip(1);
    face.iter().zip(next).map(|(&a, &b)| [a, b])
}

/// A directed side of a face, and the corners at its two ends.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    from: u32,
    to: u32,
    face: usize,
    corner: usize,
    next_corner: usize,
}

/// There are enough vertices and faces, and not too many.
pub(crate) fn check_counts(vertex_count: usize, face_count: usize) -> Result<(), MeshError> {
    if vertex_count < 4 || face_count < 4 {
        return Err(MeshError::TooFew {
            vertices: vertex_count,
            faces: face_count,
        });
    }
    if u32::try_from(vertex_count).is_err() {
        return Err(MeshError::TooMany {
            what: "vertices",
            count: vertex_count,
            allowed: u32::MAX as usize,
        });
    }
    Ok(())
}

/// Checks the faces of a surface with `vertex_count` vertices.
pub(crate) fn check(vertex_count: usize, faces: &[Vec<u32>]) -> Result<(), MeshError> {
    check_loops(vertex_count, faces)?;
    let sides = sorted_sides(faces);
    check_single(&sides)?;
    check_one_piece(vertex_count, faces, &sides)
}

/// Every loop has three different vertices or more, and every vertex has a loop.
fn check_loops(vertex_count: usize, faces: &[Vec<u32>]) -> Result<(), MeshError> {
    let mut last_face_of = vec![usize::MAX; vertex_count];
    for (face, corners) in faces.iter().enumerate() {
        if corners.len() < 3 {
            return Err(MeshError::FaceTooShort {
                face,
                count: corners.len(),
            });
        }
        for &vertex in corners {
            let Some(last) = last_face_of.get_mut(vertex as usize) else {
                return Err(MeshError::IndexOutOfRange {
                    face,
                    index: vertex,
                    count: vertex_count,
                });
            };
            if *last == face {
                return Err(MeshError::RepeatedVertex { face, vertex });
            }
            *last = face;
        }
    }
    match last_face_of.iter().position(|&face| face == usize::MAX) {
        Some(vertex) => Err(MeshError::UnreferencedVertex { vertex }),
        None => Ok(()),
    }
}

fn sorted_sides(faces: &[Vec<u32>]) -> Vec<Side> {
    let mut all = Vec::with_capacity(faces.iter().map(Vec::len).sum());
    let mut start = 0;
    for (face, corners) in faces.iter().enumerate() {
        for (i, [from, to]) in sides(corners).enumerate() {
            let next_corner = start + (i + 1) % corners.len();
            all.push(Side {
                from,
                to,
                face,
                corner: start + i,
                next_corner,
            });
        }
        start += corners.len();
    }
    all.sort_unstable();
    all
}

/// The sides that run from `from` to `to`.
fn between(sides: &[Side], from: u32, to: u32) -> &[Side] {
    let low = sides.partition_point(|s| (s.from, s.to) < (from, to));
    let high = sides.partition_point(|s| (s.from, s.to) <= (from, to));
    &sides[low..high]
}

/// Each side exists once, and once in the opposite direction.
fn check_single(sides: &[Side]) -> Result<(), MeshError> {
    for side in sides {
        let Side { from, to, face, .. } = *side;
        let along = between(sides, from, to);
        let against = between(sides, to, from);
        match (along.len(), against.len()) {
            (1, 1) => {}
            (1, 0) => return Err(MeshError::OpenEdge { from, to, face }),
            (2, 0) => {
                return Err(MeshError::InconsistentOrientation {
                    from,
                    to,
                    first: along[0].face,
                    second: along[1].face,
                });
            }
            (m, n) => {
                return Err(MeshError::NonManifoldEdge {
                    from,
                    to,
                    count: m + n,
                });
            }
        }
    }
    Ok(())
}

/// For each face the first face of its closed shell: the faces that are connected with it through edges. The
/// connectivity must be valid otherwise.
pub(super) fn shell_of(faces: &[Vec<u32>]) -> Vec<usize> {
    let sides = sorted_sides(faces);
    let mut shells = Groups::new(faces.len());
    for side in &sides {
        for opposite in between(&sides, side.to, side.from) {
            shells.join(side.face, opposite.face);
        }
    }
    (0..faces.len()).map(|face| shells.root(face)).collect()
}

/// The faces form one surface, and those around a vertex one fan.
fn check_one_piece(
    vertex_count: usize,
    faces: &[Vec<u32>],
    sides: &[Side],
) -> Result<(), MeshError> {
    let mut surfaces = Groups::new(faces.len());
    let mut fans = Groups::new(sides.len());
    for side in sides {
        for opposite in between(sides, side.to, side.from) {
            surfaces.join(side.face, opposite.face);
            fans.join(side.corner, opposite.next_corner);
            fans.join(side.next_corner, opposite.corner);
        }
    }
    let components = (0..faces.len()).filter(|&i| surfaces.root(i) == i).count();
    if components != 1 {
        return Err(MeshError::Disconnected { components });
    }
    let mut fan_count = vec![0; vertex_count];
    for (corner, &vertex) in faces.iter().flatten().enumerate() {
        if fans.root(corner) == corner {
            fan_count[vertex as usize] += 1;
        }
    }
    match fan_count.iter().position(|&fans| fans != 1) {
        Some(vertex) => Err(MeshError::NonManifoldVertex {
            vertex,
            fans: fan_count[vertex],
        }),
        None => Ok(()),
    }
}

/// Disjoint groups of the numbers 0 to n - 1 (union-find with path halving).
pub(crate) struct Groups {
    parent: Vec<usize>,
}

impl Groups {
    /// Each number by itself.
    pub(crate) fn new(n: usize) -> Self {
        Self {
            parent: (0..n).collect(),
        }
    }

    /// The smallest number of the group.
    pub(crate) fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Makes one group of two.
    pub(crate) fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        self.parent[i.max(j)] = i.min(j);
    }
}
