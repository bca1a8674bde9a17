//! Joining coplanar triangles into convex polygon faces.

use crate::polyhedron::planes::Plane;
use crate::polyhedron::topology::sides;
use crate::{MeshError, Point3};
use std::collections::BTreeMap;

/// Flat regions that are not convex are searched for convex parts up to this many triangles.
const SEARCH_LIMIT: usize = 1000;

/// Larger faces are not formed: their convexity is checked corner by corner and side by side.
const OUTLINE_LIMIT: usize = 4096;

/// Vertices and faces of a surface.
pub(crate) type Surface = (Vec<Point3>, Vec<Vec<u32>>);

/// Joins the triangles of a closed surface into convex polygons, where they lie within `tolerance` \[m\] of one
/// plane, and drops vertices that then lie inside a face or an edge.
///
/// Vertices keep their order; faces are sorted by their first triangle, loops start at their first vertex.
pub(crate) fn merge_coplanar(
    vertices: &[Point3],
    triangles: &[[u32; 3]],
    tolerance: f64,
) -> Result<Surface, MeshError> {
    let patches = Patches {
        vertices,
        triangles,
        neighbours: neighbours(triangles)?,
        tolerance,
    };
    let mut loops = Vec::new();
    for region in patches.flat_regions() {
        match patches.convex_outline(&region) {
            Some(outline) => loops.push(outline),
            None => loops.extend(patches.convex_parts(&region)),
        }
    }
    Ok(compact(
        vertices,
        &without_needless_vertices(vertices, loops, tolerance),
    ))
}

/// The triangle across each side of each triangle.
fn neighbours(triangles: &[[u32; 3]]) -> Result<Vec<[usize; 3]>, MeshError> {
    let mut owner = BTreeMap::new();
    for (i, triangle) in triangles.iter().enumerate() {
        for side in sides(triangle) {
            owner.insert(side, i);
        }
    }
    let across = |face: usize, [from, to]: [u32; 2]| {
        owner
            .get(&[to, from])
            .copied()
            .ok_or(MeshError::OpenEdge { from, to, face })
    };
    triangles
        .iter()
        .enumerate()
        .map(|(i, &[a, b, c])| Ok([across(i, [a, b])?, across(i, [b, c])?, across(i, [c, a])?]))
        .collect()
}

struct Patches<'a> {
    vertices: &'a [Point3],
    triangles: &'a [[u32; 3]],
    neighbours: Vec<[usize; 3]>,
    tolerance: f64,
}

impl Patches<'_> {
    /// Splits the surface into connected regions, each within the tolerance of the plane of its
    /// largest triangle. Regions are sorted by their first triangle.
    fn flat_regions(&self) -> Vec<Vec<usize>> {
        let planes: Vec<Plane> = self
            .triangles
            .iter()
            .map(|t| Plane::through(self.vertices, t))
            .collect();
        let mut largest_first: Vec<usize> = (0..self.triangles.len()).collect();
        largest_first.sort_by(|&i, &j| planes[j].area.total_cmp(&planes[i].area).then(i.cmp(&j)));

        let mut taken = vec![false; self.triangles.len()];
        let mut regions = Vec::new();
        for seed in largest_first {
            if taken[seed] {
                continue;
            }
            taken[seed] = true;
            let plane = &planes[seed];
            let mut region = vec![seed];
            let mut next = 0;
            while let Some(&i) = region.get(next) {
                for j in self.neighbours[i] {
                    let near = |&v: &u32| {
                        plane.distance(&self.vertices[v as usize]).abs() <= self.tolerance
                    };
                    // The normal of a sliver is noise; that of a proper triangle must agree.
                    let agrees = planes[j].normal.dot(&plane.normal) > 0.0
                        || planes[j].thickness() <= self.tolerance;
                    if !taken[j] && agrees && self.triangles[j].iter().all(near) {
                        taken[j] = true;
                        region.push(j);
                    }
                }
                next += 1;
            }
            region.sort_unstable();
            regions.push(region);
        }
        regions.sort_unstable();
        regions
    }

    /// The loop around a region, if it is a single convex one.
    fn convex_outline(&self, region: &[usize]) -> Option<Vec<u32>> {
        let outline = self.outline(region)?;
        let plane = Plane::through(self.vertices, &outline);
        let convex = sides(&outline).all(|[a, b]| {
            let a = self.vertices[a as usize];
            let along = self.vertices[b as usize] - a;
            let inward = plane.normal.cross(&along);
            let allowed = -self.tolerance * along.norm();
            outline
                .iter()
                .all(|&v| inward.dot(&(self.vertices[v as usize] - a)) >= allowed)
        });
        convex.then_some(outline)
    }

    /// The loop around a sorted region, from its smallest vertex; none if there are several loops,
    /// or one that touches itself.
    fn outline(&self, region: &[usize]) -> Option<Vec<u32>> {
        let mut next = BTreeMap::new();
        for &i in region {
            for (side, j) in sides(&self.triangles[i]).zip(self.neighbours[i]) {
                let inner = region.binary_search(&j).is_ok();
                if !inner && next.insert(side[0], side[1]).is_some() {
                    return None;
                }
            }
        }
        let start = *next.keys().next()?;
        let mut outline = vec![start];
        let mut at = *next.get(&start)?;
        while at != start {
            outline.push(at);
            at = *next.get(&at)?;
            if outline.len() > next.len() {
                return None;
            }
        }
        (outline.len() == next.len() && outline.len() <= OUTLINE_LIMIT).then_some(outline)
    }

    /// Covers a flat region with convex polygons, each grown from a triangle as far as it stays convex.
    fn convex_parts(&self, region: &[usize]) -> Vec<Vec<u32>> {
        let mut free = region.to_vec();
        let mut outlines = Vec::new();
        while let Some(&seed) = free.first() {
            let mut part = vec![seed];
            let mut outline = self.triangles[seed].to_vec();
            let mut grown = region.len() <= SEARCH_LIMIT;
            while grown {
                grown = false;
                let candidates: Vec<usize> =
                    part.iter().flat_map(|&i| self.neighbours[i]).collect();
                for j in candidates {
                    if free.binary_search(&j).is_err() || part.binary_search(&j).is_ok() {
                        continue;
                    }
                    let mut larger = part.clone();
                    larger.insert(part.partition_point(|&i| i < j), j);
                    if let Some(convex) = self.convex_outline(&larger) {
                        (part, outline, grown) = (larger, convex, true);
                    }
                }
            }
            free.retain(|i| part.binary_search(i).is_err());
            outlines.push(outline);
        }
        outlines
    }
}

/// Drops the vertices that belong to two loops only and lie straight between their neighbours.
fn without_needless_vertices(
    vertices: &[Point3],
    loops: Vec<Vec<u32>>,
    tolerance: f64,
) -> Vec<Vec<u32>> {
    let mut passes = vec![0_u32; vertices.len()];
    for &v in loops.iter().flatten() {
        passes[v as usize] += 1;
    }
    let mut kept: Vec<bool> = passes.iter().map(|&n| n > 2).collect();
    // Keeping a vertex changes the lines with which others are compared: repeat until all agree.
    loop {
        let mut changed = false;
        for outline in &loops {
            for v in bends(vertices, outline, &kept, tolerance) {
                kept[v as usize] = true;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    loops
        .into_iter()
        .map(|outline| outline.into_iter().filter(|&v| kept[v as usize]).collect())
        .collect()
}

/// Vertices of a loop that must be kept in addition to those already kept: all, if fewer than three are kept;
/// otherwise those that lie off the line between the kept vertices before and after them.
fn bends(vertices: &[Point3], outline: &[u32], kept: &[bool], tolerance: f64) -> Vec<u32> {
    let corners: Vec<usize> = (0..outline.len())
        .filter(|&i| kept[outline[i] as usize])
        .collect();
    let [first, _, .., last] = corners[..] else {
        return outline
            .iter()
            .copied()
            .filter(|&v| !kept[v as usize])
            .collect();
    };
    if corners.len() < 3 {
        return outline
            .iter()
            .copied()
            .filter(|&v| !kept[v as usize])
            .collect();
    }
    let at = |i: usize| vertices[outline[i % outline.len()] as usize];
    let wrap = (last, first + outline.len());
    corners
        .windows(2)
        .map(|w| (w[0], w[1]))
        .chain([wrap])
        .flat_map(|(i, j)| (i + 1..j).map(move |k| (i, j, k)))
        .filter(|&(i, j, k)| {
            let along = at(j) - at(i);
            along.cross(&(at(k) - at(i))).norm() > 2.0 * tolerance * along.norm()
        })
        .map(|(_, _, k)| outline[k % outline.len()])
        .collect()
}

/// Keeps the vertices that the faces use, in their order.
pub(crate) fn compact(vertices: &[Point3], faces: &[Vec<u32>]) -> Surface {
    let mut new_index = vec![None; vertices.len()];
    for &v in faces.iter().flatten() {
        new_index[v as usize] = Some(0);
    }
    let mut used = Vec::new();
    for (index, vertex) in new_index.iter_mut().zip(vertices) {
        if let Some(index) = index {
            *index = used.len() as u32;
            used.push(*vertex);
        }
    }
    let faces = faces
        .iter()
        .map(|face| face.iter().filter_map(|&v| new_index[v as usize]).collect())
        .collect();
    (used, faces)
}

#[cfg(test)]
mod tests;
