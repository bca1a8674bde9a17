//! Whether what was read of cracks fits the body.

use super::{Breakable, CrackState};
use crate::error::SolveError;
use crate::world::deformables::Model;
use crate::world::stored::inconsistent;
use femdem_mesh::TetMesh;
use femdem_mesh::tet::CrackedMesh;

impl Breakable {
    /// Refuses what does not fit together: `models` are those of the world, `own` that of the body.
    pub fn check(&self, models: &[Model], own: &Model) -> Result<(), SolveError> {
        self.fracture.validate()?;
        let base = match &self.cracks {
            None => Some(own),
            Some(cracks) => models.get(cracks.base as usize),
        };
        let wrong = |what: &str| inconsistent(format!("{what} of a body that may break is wrong"));
        let whole = base
            .filter(|base| base.cracked.is_none())
            .ok_or_else(|| wrong("the model without cracks"))?;
        let mesh = whole.model.mesh();
        if self.factors.len() != mesh.points().len() {
            return Err(wrong("the number of factors of strength"));
        }
        match &self.cracks {
            Some(cracks) => cracks.check(mesh, own).map_err(wrong),
            None => Ok(()),
        }
    }
}

impl CrackState {
    /// What is wrong with it.
    fn check(&self, whole: &TetMesh, own: &Model) -> Result<(), &'static str> {
        let is_of = |mesh: &CrackedMesh| {
            let point = |node: u32| mesh.points()[node as usize];
            let tets = mesh.tets().iter().map(|tet| tet.map(point));
            tets.eq(whole.tets().iter().copied())
        };
        let nodes = own.model.nodes().len();
        let joined = self.joints.iter().all(|joint| {
            Some(joint.sides) == self.mesh.sides(joint.facet) && joint.law.check().is_ok()
        });
        if own.cracked.is_none() {
            Err("the model")
        } else if !is_of(&self.mesh) || self.mesh.tets() != own.model.mesh().tets() {
            Err("the mesh of the cracks")
        } else if !is_of(&self.broken) {
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
