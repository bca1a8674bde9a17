//! Supports, prescribed motions and dead loads of a body, node by node.

use crate::SolveError;
use crate::deformable::DeformableModel;
use crate::error::check;
use femdem_mesh::Vector3;

/// What holds and loads the nodes of a body. In a static solution motions and forces grow together
/// from zero to what is stated here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loading {
    /// Whether a node is held, along x, y and z.
    pub held: Vec<[bool; 3]>,
    /// How far a node is moved along the axes on which it is held, m; other components mean nothing.
    pub motion: Vec<Vector3>,
    /// Forces on the nodes, N. They keep their direction.
    pub forces: Vec<Vector3>,
}

impl Loading {
    /// No support and no load on any node of a model.
    #[must_use]
    pub fn free(model: &DeformableModel) -> Self {
        let nodes = model.nodes().len();
        Self {
            held: vec![[false; 3]; nodes],
            motion: vec![Vector3::zeros(); nodes],
            forces: vec![Vector3::zeros(); nodes],
        }
    }

    /// # Errors
    /// Unless there is one finite entry for each node of the model.
    pub(super) fn check(&self, model: &DeformableModel) -> Result<(), SolveError> {
        let wanted = model.nodes().len();
        let lengths = [
            ("supports", self.held.len()),
            ("motions of nodes", self.motion.len()),
            ("forces on nodes", self.forces.len()),
        ];
        for (what, given) in lengths {
            if given != wanted {
                return Err(SolveError::WrongLength {
                    what,
                    given,
                    wanted,
                });
            }
        }
        for value in self.motion.iter().chain(&self.forces).flatten() {
            check("a motion or force of a node", *value, true, "finite")?;
        }
        Ok(())
    }

    /// Forces at a part of the load.
    pub(super) fn forces_at(&self, part: f64) -> Vec<Vector3> {
        self.forces.iter().map(|f| f * part).collect()
    }

    /// Motion of what is held over a part of the load.
    pub(super) fn motion_of(&self, part: f64) -> Vec<Vector3> {
        let nodes = self.motion.iter().zip(&self.held);
        nodes
            .map(|(motion, held)| super::body::only(held, motion * part))
            .collect()
    }
}
