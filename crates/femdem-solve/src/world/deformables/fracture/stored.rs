//! Whether what was read of cracks fits the body.

use super::{Breakable, CrackFacet, CrackState};
use crate::error::SolveError;
use crate::world::deformables::Model;
use crate::world::stored::inconsistent;

impl Breakable {
    /// Refuses what does not fit together: `own` is the model of the body.
    pub fn check(&self, own: &Model) -> Result<(), SolveError> {
        self.fracture.validate()?;
        let wrong = |what: &str| inconsistent(format!("{what} of a body that may break is wrong"));
        let nodes = own.model.nodes().len();
        let points = match &self.cracks {
            None => nodes,
            Some(cracks) => {
                let last = cracks.mesh.points().iter().max();
                last.map_or(0, |last| *last as usize + 1)
            }
        };
        let tets = own.model.mesh().tets().len();
        let is_of = |facet: &CrackFacet| {
            let own = facet.tets.iter().flatten();
            own.into_iter().all(|t| (*t as usize) < tets)
        };
        if self.factors.len() != points || self.points.len() != points {
            return Err(wrong("the number of points"));
        }
        if !self.spent.iter().all(is_of) {
            return Err(wrong("a facet that is spent"));
        }
        match &self.cracks {
            Some(cracks) => cracks.check(own).map_err(wrong),
            None => Ok(()),
        }
    }
}

impl CrackState {
    /// What is wrong with it.
    fn check(&self, own: &Model) -> Result<(), &'static str> {
        // Nodes that are points have their numbers, and places.
        let is_own = |(node, point): (u32, &u32)| {
            let first = self.mesh.points().get(*point as usize);
            *point <= node && first == Some(point)
        };
        let nodes = own.model.nodes().len();
        let joined = self.joints.iter().all(|joint| {
            Some(joint.sides) == self.mesh.sides(joint.facet)
                && joint.law.check().is_ok()
                && joint.limits.check().is_ok()
                && joint.glued.is_of_crack(&joint.law)
        });
        if own.edge.is_none() {
            Err("the model")
        } else if !(0..).zip(self.mesh.points()).all(is_own)
            || self.mesh.tets() != own.model.mesh().tets()
        {
            Err("the mesh of the cracks")
        } else if !self.broken.whole_tets().eq(self.mesh.whole_tets()) {
            Err("the mesh of what is broken")
        } else if self.stiffness.len() != nodes || self.both.len() != nodes {
            Err("the stiffness at the nodes")
        } else if !joined {
            Err("a joint")
        } else {
            Ok(())
        }
    }
}
