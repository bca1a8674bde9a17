//! Narrow phase of the batch: one outcome per pair, in its own slot.

use super::RigidShape;
use super::body::SoftBody;
use super::pairs::{PairList, SoftPair};
use super::sleep::Sleep;
use crate::deform::add_up::{Way, run as run_kernel};
use crate::deform::current::Operand;
use crate::deform::kernel::{DeformableKernel, DeformableScratch};
use crate::deform::near::{Sides, Tree};
use crate::deform::record::{DeformablePartner, NodalState};
use crate::deform::respond::{Mover, Pair};
use crate::deform::shape::{DeformableShape, Modulus};
use crate::error::ContactError;
use crate::general::SolidWall;
use crate::law::ContactParameters;
use crate::motion::Motion;
use crate::walls::WallShape;
use std::sync::Arc;

/// Data shared by all pairs of one update.
pub(crate) struct Context<'a> {
    pub parameters: &'a ContactParameters,
    /// The law of pairs whose side A is a wall.
    pub at_walls: ContactParameters,
    pub kernel: &'a DeformableKernel,
    pub shapes: &'a [Arc<DeformableShape>],
    pub rigid_shapes: &'a [RigidShape],
    pub rigid_kinds: &'a [u32],
    pub rigid_sleep: &'a [Sleep],
    pub wall_shapes: &'a [WallShape],
    pub states: &'a [NodalState<'a>],
    pub rigid: &'a [Motion],
    pub walls: &'a [Motion],
    /// Time since the last update, s.
    pub dt: f64,
}

impl Context<'_> {
    /// Body `i`, as input of the kernel.
    pub fn soft(&self, i: u32, body: &SoftBody) -> Option<Operand<'_>> {
        let shape = self.shapes.get(body.shape as usize)?;
        let state = self.states.get(i as usize)?;
        Some(Operand::Deformable(shape, state.positions))
    }

    /// Running bound of the sum of the travels of A and B, m.
    pub fn motion(&self, pair: &SoftPair, bodies: &[SoftBody]) -> f64 {
        let of = |i: u32| bodies[i as usize].travelled;
        let of_a = match pair.a {
            DeformablePartner::Deformable(i) => of(i),
            DeformablePartner::Rigid(i) => self.rigid[i as usize].travelled,
            DeformablePartner::Wall(w) => self.walls[w as usize].travelled,
        };
        of_a + of(pair.b)
    }

    /// The solid of the wall of a pair, and whether it was rebuilt. `None` if no part of the wall is near.
    pub fn wall<'p>(
        &'p self,
        pair_local: &'p mut crate::walls::LocalSolid,
        w: u32,
        body: &SoftBody,
    ) -> (Option<&'p SolidWall>, bool) {
        let (Some(shape), Some(motion)) =
            (self.wall_shapes.get(w as usize), self.walls.get(w as usize))
        else {
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

    /// Clears the last update of a pair, and returns whether it must be evaluated. A pair known to be clear
    /// does not touch; one at rest stays as it is.
    fn begin(&self, pair: &mut SoftPair, bodies: &[SoftBody]) -> bool {
        if pair.rests(bodies, self.rigid_sleep) {
            return false;
        }
        pair.failure = None;
        pair.counts = [0; 2];
        let is_clear = pair.candidates.is_clear(self.motion(pair, bodies));
        if is_clear {
            pair.outcome.clear();
        }
        !is_clear
    }

    /// Evaluates one pair in place.
    fn evaluate(&self, pair: &mut SoftPair, bodies: &[SoftBody], scratch: &mut DeformableScratch) {
        let motion = self.motion(pair, bodies);
        if self.touch(pair, bodies, motion, scratch).is_none() {
            pair.outcome.clear();
        }
    }

    /// The bodies of a pair as the sides of its evaluation, and whether they have changed places.
    ///
    /// The springs of friction belong to the skin of side B, one for each triangle. That has to be the finer skin:
    /// a spring of a large triangle would act on a single small one of the other skin, and shake its nodes instead of
    /// holding the body. So it does not matter either which body was added first.
    fn sides(&self, pair: &SoftPair, bodies: &[SoftBody]) -> (DeformablePartner, u32, bool) {
        let edge = |i: u32| {
            let shape = self.shapes.get(bodies.get(i as usize)?.shape as usize)?;
            Some(shape.edge())
        };
        match pair.a {
            DeformablePartner::Deformable(i) if edge(i) < edge(pair.b) => {
                (DeformablePartner::Deformable(pair.b), i, true)
            }
            _ => (pair.a, pair.b, false),
        }
    }

    /// The contact of a pair; `None` if there is none.
    fn touch(
        &self,
        pair: &mut SoftPair,
        bodies: &[SoftBody],
        motion: f64,
        scratch: &mut DeformableScratch,
    ) -> Option<()> {
        let (a, b, swapped) = self.sides(pair, bodies);
        let body = bodies.get(b as usize)?;
        let of_b = self.soft(b, body)?;
        let tree_b = tree(body)?;
        let moduli_b = body.modulus;
        let rigid = Modulus::Penalty(self.parameters.penalty);
        let (mut turning, mut frequency) = (None, 0.0);
        let (of_a, tree_a, modulus, mover) = match a {
            DeformablePartner::Deformable(i) => {
                let body = bodies.get(i as usize)?;
                let state = self.states.get(i as usize)?;
                let operand = self.soft(i, body)?;
                (turning, frequency) = (body.turning.as_ref(), body.frequency);
                (operand, tree(body)?, body.modulus, Mover::Nodes(*state))
            }
            DeformablePartner::Rigid(i) => {
                let motion = self.rigid.get(i as usize)?;
                let kind = *self.rigid_kinds.get(i as usize)?;
                let mesh = &self.rigid_shapes.get(kind as usize)?.mesh;
                let operand = Operand::Rigid(mesh, &motion.frame);
                (operand, mesh.cells.tree(), rigid, Mover::Rigid(motion))
            }
            DeformablePartner::Wall(w) => {
                let motion = self.walls.get(w as usize)?;
                let solid = self.wall(&mut pair.local, w, body).0?;
                let operand = Operand::Wall(solid, &motion.frame);
                (operand, solid.cells.tree(), rigid, Mover::Rigid(motion))
            }
        };
        let sides = Sides {
            operands: [of_a, of_b],
            trees: [tree_a, tree_b],
        };
        let pressures = self.kernel.pressures(&sides, [modulus, moduli_b]);
        let touches = match run_kernel(
            &sides,
            pressures,
            Way::Skins,
            &mut pair.candidates,
            motion,
            scratch,
        ) {
            Ok(touches) => touches,
            Err((side, inverted)) => {
                let body = match a {
                    DeformablePartner::Deformable(i) if side == 0 => i,
                    _ => b,
                };
                pair.failure = Some((body, inverted.tet));
                return None;
            }
        };
        pair.counts = scratch.counts().map(|n| n as u32);
        if !touches {
            return None;
        }
        let of_pair = Pair {
            ids: (pair.a, pair.b),
            sides: sides.operands,
            movers: [mover, Mover::Nodes(*self.states.get(b as usize)?)],
            frequencies: [frequency, body.frequency],
            turnings: [turning, body.turning.as_ref()],
            near: pair.candidates.near()?,
            law: match a {
                DeformablePartner::Wall(_) => &self.at_walls,
                _ => self.parameters,
            },
            begins: pair.begins.take().map(|start| start.seen_from(swapped)),
            dt: self.dt,
        };
        pair.outcome.take(&of_pair, scratch);
        if swapped {
            pair.outcome.swap_sides();
        }
        Some(())
    }
}

fn tree(body: &SoftBody) -> Option<Tree<'_>> {
    let (tree, boxes) = body.tree.as_deref()?;
    Some(Tree { tree, boxes })
}

/// Evaluates all pairs. Each is written to its own slot, so the results are the same bits in any order and
/// with any number of threads.
pub(crate) fn run(
    context: &Context,
    bodies: &[SoftBody],
    pairs: &mut PairList,
) -> Result<(), ContactError> {
    evaluate_all(context, bodies, pairs.list_mut());
    match pairs.list().iter().find_map(|p| p.failure) {
        Some((body, tet)) => Err(ContactError::InvertedTet {
            body: body as usize,
            tet: tet as usize,
        }),
        None => Ok(()),
    }
}

fn evaluate_all(context: &Context, bodies: &[SoftBody], list: &mut [SoftPair]) {
    let due = list.iter_mut().filter_map(|pair| {
        let is_due = context.begin(pair, bodies);
        is_due.then_some(pair)
    });
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        // Scheduled one by one: a pair that renews its candidates takes a hundred times as long as others.
        let due: Vec<_> = due.collect();
        due.into_par_iter()
            .for_each_init(DeformableScratch::default, |scratch, pair| {
                context.evaluate(pair, bodies, scratch)
            });
        return;
    }
    let mut scratch = DeformableScratch::default();
    due.for_each(|pair| context.evaluate(pair, bodies, &mut scratch));
}
