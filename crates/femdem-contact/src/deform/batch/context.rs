//! What the stages of an update share: shapes, places and laws.

use super::Around;
use super::bend::Bend;
use super::body::SoftBody;
use super::pair::SoftPair;
use super::state::Sleep;
use crate::deform::operand::Operand;
use crate::deform::record::NodalState;
use crate::deform::shape::DeformableShape;
use crate::deform::side::Side;
use crate::general::SolidWall;
use crate::walls::WallShape;
use std::sync::Arc;

/// Data shared by all pairs of one update.
pub(crate) struct Context<'a> {
    pub around: &'a Around<'a>,
    pub shapes: &'a [Arc<DeformableShape>],
    pub rigid_sleep: &'a [Sleep],
    pub states: &'a [NodalState<'a>],
}

impl Context<'_> {
    /// Body `i`, as input of the kernel.
    pub fn soft(&self, i: u32, body: &SoftBody) -> Option<Operand<'_>> {
        let shape = self.shapes.get(body.shape as usize)?;
        let state = self.states.get(i as usize)?;
        Some(Operand::Deformable(shape, state.positions))
    }

    /// Running bound of the sum of the travels of A and B, m: no part of one moves farther than this towards the other.
    pub fn motion(&self, pair: &SoftPair, bodies: &[SoftBody]) -> f64 {
        if pair.is_own() {
            let bend = bodies[pair.b as usize].bend.as_ref();
            return bend.map_or(0.0, Bend::motion);
        }
        let of = |i: u32| bodies[i as usize].travelled;
        let of_a = match pair.a {
            Side::Deformable(i) => of(i),
            Side::Rigid(i) => self.around.rigid[i as usize].travelled,
            Side::Wall(w) => self.around.walls[w as usize].travelled,
        };
        let edges = self
            .around
            .space
            .map_or(0.0, |space| space.path(pair.image));
        of_a + of(pair.b) + edges
    }

    /// The solid of the wall of a pair, and whether it was rebuilt. `None` if no part of the wall is near.
    pub fn wall<'p>(
        &'p self,
        pair_local: &'p mut crate::walls::LocalSolid,
        w: u32,
        body: &SoftBody,
    ) -> (Option<&'p SolidWall>, bool) {
        let (Some(Some(shape)), Some(motion)) = (
            self.around.wall_shapes.get(w as usize),
            self.around.walls.get(w as usize),
        ) else {
            return (None, false);
        };
        match shape {
            WallShape::Mesh(wall) => (Some(wall.solid_wall()), false),
            WallShape::Planes(wall) => {
                let from = body.centre - motion.frame.position;
                let x = motion.frame.rotation.tr_mul(&from);
                pair_local.near(wall, &x, body.reach)
            }
        }
    }
}
