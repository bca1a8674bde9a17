//! Connectivity of a tetrahedral mesh: neighbours across triangles, and the skin.

use super::FACES;
use crate::MeshError;

/// Neighbours per tetrahedron, and the triangles that have none.
pub(super) type Connected = (Vec<[Option<u32>; 4]>, Vec<[u32; 3]>);

/// There are tetrahedra; every index names a point, no tetrahedron repeats one, and every point is
/// used.
pub(super) fn check_indices(point_count: usize, tets: &[[u32; 4]]) -> Result<(), MeshError> {
    if tets.is_empty() {
        return Err(MeshError::NoTetrahedra);
    }
    for (what, count) in [("points", point_count), ("tetrahedra", tets.len())] {
        if u32::try_from(count).is_err() {
            let allowed = u32::MAX as usize;
            return Err(MeshError::TooMany {
                what,
                count,
                allowed,
            });
        }
    }
    let mut used = vec![false; point_count];
    for (tet, corners) in tets.iter().enumerate() {
        for (k, &index) in corners.iter().enumerate() {
            match used.get_mut(index as usize) {
                Some(used) if !corners[..k].contains(&index) => *used = true,
                _ => {
                    return Err(MeshError::TetrahedronIndex {
                        tet,
                        index,
                        count: point_count,
                    });
                }
            }
        }
    }
    match used.iter().position(|used| !used) {
        Some(point) => Err(MeshError::UnusedPoint { point }),
        None => Ok(()),
    }
}

/// One side of a triangle: sorted points, the owner, and whether sorting was an odd permutation.
type Side = ([u32; 3], u32, u8, bool);

fn side(tet: usize, corners: &[u32; 4], k: usize) -> Side {
    let [a, b, c] = FACES[k].map(|i| corners[i]);
    let mut sorted = [a, b, c];
    sorted.sort_unstable();
    let odd = [a > b, b > c, a > c].iter().filter(|&&x| x).count() % 2 == 1;
    (sorted, tet as u32, k as u8, odd)
}

/// All sides of tetrahedra, ascending: dealt out by their lowest points, which few of them share, then sorted.
fn sides(tets: &[[u32; 4]]) -> Vec<Side> {
    let all = || {
        let each = tets.iter().enumerate();
        each.flat_map(|(tet, corners)| (0..4).map(move |k| side(tet, corners, k)))
    };
    let highest = tets.iter().flatten().max();
    let mut next = vec![0; highest.map_or(0, |highest| *highest as usize + 2)];
    for (points, ..) in all() {
        next[points[0] as usize + 1] += 1;
    }
    for point in 1..next.len() {
        next[point] += next[point - 1];
    }
    let mut sides = vec![Side::default(); 4 * tets.len()];
    for side in all() {
        let next = &mut next[side.0[0] as usize];
        sides[*next] = side;
        *next += 1;
    }
    for group in sides.chunk_by_mut(|a, b| a.0[0] == b.0[0]) {
        group.sort_unstable();
    }
    sides
}

/// Finds neighbours and skin of tetrahedra with valid indices.
pub(super) fn connect(tets: &[[u32; 4]]) -> Result<Connected, MeshError> {
    let sides = sides(tets);
    let mut neighbours = vec![[None; 4]; tets.len()];
    for group in sides.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [_] => {}
            [(_, i, k, odd), (_, j, l, opposite)] if odd != opposite => {
                neighbours[i as usize][k as usize] = Some(j);
                neighbours[j as usize][l as usize] = Some(i);
            }
            [(points, first, ..), (_, second, ..), ..] => {
                return Err(MeshError::NonManifoldTriangle {
                    points,
                    first: first as usize,
                    second: second as usize,
                    count: group.len(),
                });
            }
            [] => {}
        }
    }
    let mut skin = Vec::new();
    for (corners, across) in tets.iter().zip(&neighbours) {
        for (face, neighbour) in FACES.iter().zip(across) {
            if neighbour.is_none() {
                skin.push(face.map(|i| corners[i]));
            }
        }
    }
    Ok((neighbours, skin))
}

/// Number of the pieces whose tetrahedra can be reached from one another through shared triangles.
pub(super) fn pieces(neighbours: &[[Option<u32>; 4]]) -> usize {
    let mut reached = vec![false; neighbours.len()];
    let mut pieces = 0;
    let mut stack = Vec::new();
    for start in 0..neighbours.len() {
        if reached[start] {
            continue;
        }
        pieces += 1;
        reached[start] = true;
        stack.push(start);
        while let Some(tet) = stack.pop() {
            for &next in neighbours[tet].iter().flatten() {
                if !std::mem::replace(&mut reached[next as usize], true) {
                    stack.push(next as usize);
                }
            }
        }
    }
    pieces
}
