//! Facets before they form a body, and removal of invalid ones.

use super::FacetList;
use crate::polyhedron::{
    Plane, SHARP, check_coordinates, check_topology, several_shells, triangulate,
};
use crate::{MeshError, PLANARITY_TOLERANCE, Point3, Polyhedron, merge};

/// Largest number of pairs of triangles compared in a search for cuts, per triangle.
const PAIRS_PER_TRIANGLE: u64 = 500;

/// Pairs of facets that cut each other named in a message.
const CUTS_NAMED: usize = 8;

/// Loops of vertex numbers, each with its facet number in the file.
pub(super) struct Surface {
    pub(super) points: Vec<Point3>,
    pub(super) loops: Vec<Vec<u32>>,
    pub(super) origin: Vec<usize>,
}

impl Surface {
    pub(super) fn new(points: Vec<Point3>, loops: Vec<Vec<u32>>) -> Result<Self, MeshError> {
        check_indices(points.len(), &loops)?;
        Ok(Self {
            points,
            origin: (0..loops.len()).collect(),
            loops,
        })
    }

    /// Drops the vertices that no loop uses and returns their number.
    pub(super) fn compact(&mut self) -> usize {
        let before = self.points.len();
        (self.points, self.loops) = merge::compact(&self.points, &self.loops);
        before - self.points.len()
    }

    /// The file's numbers of some facets.
    pub(super) fn list(&self, facets: impl IntoIterator<Item = usize>) -> FacetList {
        FacetList::of(facets.into_iter().map(|i| self.origin[i]))
    }

    /// Drops facets and returns their number if that is allowed, else returns an error.
    fn drop_if(
        &mut self,
        bad: &[bool],
        allowed: bool,
        error: fn(FacetList) -> MeshError,
    ) -> Result<usize, MeshError> {
        let facets = || (0..bad.len()).filter(|&i| bad[i]);
        let count = facets().count();
        if count > 0 && !allowed {
            return Err(error(self.list(facets())));
        }
        retain_good(&mut self.loops, bad);
        retain_good(&mut self.origin, bad);
        Ok(count)
    }

    /// Facets of fewer than three different vertices, or whose vertices lie on a line.
    pub(super) fn drop_degenerate(&mut self, allowed: bool) -> Result<usize, MeshError> {
        let largest = self
            .points
            .iter()
            .map(|p| p.coords.amax())
            .fold(0.0, f64::max);
        let without_area = |corners: &Vec<u32>| {
            corners.len() < 3 || Plane::through(&self.points, corners).is_degenerate(largest)
        };
        let bad: Vec<bool> = self.loops.iter().map(without_area).collect();
        self.drop_if(&bad, allowed, |facets| MeshError::DegenerateFacets {
            facets,
        })
    }

    /// Facets whose vertices are those of an earlier one.
    pub(super) fn drop_duplicates(&mut self, allowed: bool) -> Result<usize, MeshError> {
        let sorted = |corners: &Vec<u32>| {
            let mut corners = corners.clone();
            corners.sort_unstable();
            corners
        };
        let mut all: Vec<(Vec<u32>, usize)> = self.loops.iter().map(sorted).zip(0..).collect();
        all.sort_unstable();
        let mut bad = vec![false; self.loops.len()];
        for same in all.chunk_by(|a, b| a.0 == b.0) {
            for (_, i) in &same[1..] {
                bad[*i] = true;
            }
        }
        self.drop_if(&bad, allowed, |facets| MeshError::DuplicateFacets {
            facets,
        })
    }

    /// Cuts facets that are not planar into triangles and returns their number.
    pub(super) fn split_bent(&mut self) -> Result<usize, MeshError> {
        let allowed = PLANARITY_TOLERANCE * check_coordinates(&self.points)?;
        let mut split = 0;
        let loops = std::mem::take(&mut self.loops);
        let origin = std::mem::take(&mut self.origin);
        for (corners, from) in loops.into_iter().zip(origin) {
            let plane = Plane::through(&self.points, &corners);
            let off = |&v: &u32| plane.distance(&self.points[v as usize]).abs() > allowed;
            if corners.len() > 3 && corners.iter().any(off) {
                let mut triangles = Vec::new();
                triangulate(&self.points, &corners, &plane.normal, SHARP, &mut triangles);
                split += 1;
                self.origin.extend(triangles.iter().map(|_| from));
                self.loops.extend(triangles.iter().map(|t| t.to_vec()));
            } else {
                self.loops.push(corners);
                self.origin.push(from);
            }
        }
        Ok(split)
    }

    /// An error of the connectivity, with the facets' numbers in the file.
    fn named(&self, error: MeshError) -> MeshError {
        match error {
            MeshError::NonManifoldVertex { vertex, fans } => {
                let around = (0..self.loops.len())
                    .filter(|&i| self.loops[i].iter().any(|&v| v as usize == vertex));
                MeshError::NonManifoldFacets {
                    what: "vertex",
                    facets: self.list(around),
                    count: fans,
                }
            }
            MeshError::Disconnected { .. } => {
                renumbered(several_shells(&self.points, &self.loops), &self.origin)
            }
            other => renumbered(other, &self.origin),
        }
    }

    /// The body, after all checks.
    pub(super) fn into_body(self) -> Result<Polyhedron, MeshError> {
        check_topology(self.points.len(), &self.loops).map_err(|error| self.named(error))?;
        let Self {
            points,
            loops,
            origin,
        } = self;
        let body = Polyhedron::new(points, loops).map_err(|error| renumbered(error, &origin))?;
        let budget = PAIRS_PER_TRIANGLE * (10_000 + 2 * body.face_count() as u64);
        match body.self_intersections_within(CUTS_NAMED, budget) {
            None => Err(MeshError::Tangled {
                facets: origin.len(),
            }),
            Some(pairs) if pairs.is_empty() => Ok(body),
            Some(pairs) => Err(MeshError::SelfIntersecting {
                pairs: pairs
                    .into_iter()
                    .map(|pair| pair.map(|i| origin[i]))
                    .collect(),
            }),
        }
    }
}

/// Drops the entries of a list that are marked in one as long.
fn retain_good<T>(list: &mut Vec<T>, bad: &[bool]) {
    debug_assert_eq!(list.len(), bad.len());
    let mut place = 0;
    list.retain(|_| {
        place += 1;
        !bad[place - 1]
    });
}

/// Checks that loops name existing vertices. Other faults are checked after welding.
fn check_indices(count: usize, loops: &[Vec<u32>]) -> Result<(), MeshError> {
    for (face, corners) in loops.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&v| v as usize >= count) {
            return Err(MeshError::IndexOutOfRange { face, index, count });
        }
    }
    Ok(())
}

/// The error with the facets' numbers in the file.
fn renumbered(mut error: MeshError, origin: &[usize]) -> MeshError {
    let number = |face: &mut usize| *face = origin.get(*face).copied().unwrap_or(*face);
    match &mut error {
        MeshError::FaceTooShort { face, .. }
        | MeshError::IndexOutOfRange { face, .. }
        | MeshError::RepeatedVertex { face, .. }
        | MeshError::OpenEdge { face, .. }
        | MeshError::DegenerateFace { face, .. }
        | MeshError::Hollow { face, .. }
        | MeshError::NotPlanar { face, .. } => number(face),
        MeshError::InconsistentOrientation { first, second, .. } => {
            number(first);
            number(second);
        }
        _ => {}
    }
    error
}
