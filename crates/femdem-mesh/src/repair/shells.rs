//! Shells that are whole by themselves, and touch.

use super::clean::Surface;
use crate::MeshError;
use crate::polyhedron::Groups;

/// Fewest facets of a closed shell.
const FEWEST: usize = 4;

impl Surface {
    /// The number of shells of facets that share vertices by number, if there are several and all are closed.
    pub(super) fn closed_shells(&self) -> Option<usize> {
        let mut shells = Groups::new(self.loops.len());
        let mut facet_of = vec![usize::MAX; self.points.len()];
        for (facet, corners) in self.loops.iter().enumerate() {
            for &v in corners {
                let first = &mut facet_of[v as usize];
                *first = facet.min(*first);
                shells.join(facet, *first);
            }
        }
        let roots = (0..self.loops.len()).filter(|&i| shells.root(i) == i);
        let count = roots.count();
        let polygons = self.loops.iter().all(|corners| corners.len() > 2);
        let possible = polygons && count > 1 && count <= self.loops.len() / FEWEST;
        (possible && self.check_edges().is_ok()).then_some(count)
    }

    /// The error for facets given twice; if there are so many shells that are closed by themselves, and without the
    /// copies there are edges with more than two facets, then that for shells that touch.
    pub(super) fn given_twice(mut self, shells: Option<usize>, error: MeshError) -> MeshError {
        let (Some(shells), MeshError::DuplicateFacets { facets }) = (shells, &error) else {
            return error;
        };
        let facets = facets.clone();
        match self.drop_duplicates(true).and_then(|_| self.check_edges()) {
            Err(MeshError::NonManifoldFacets { .. }) => MeshError::Touching { shells, facets },
            _ => error,
        }
    }
}

/// The same error; if facets meet where they must not and there are so many shells that are closed by themselves,
/// then that for shells that touch.
pub(super) fn touching(shells: Option<usize>, error: MeshError) -> MeshError {
    match (shells, error) {
        (Some(shells), MeshError::NonManifoldFacets { facets, .. }) => {
            MeshError::Touching { shells, facets }
        }
        (_, error) => error,
    }
}
