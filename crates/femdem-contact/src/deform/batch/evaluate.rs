//! Narrow phase of the batch: one outcome per pair, in its own slot.

use super::body::SoftBody;
use super::context::Context;
use super::look::{Due, Look};
use super::pair::SoftPair;
use super::periodic::Seen;
use crate::deform::add_up::{Way, run as run_kernel};
use crate::deform::kernel::DeformableKernel;
use crate::deform::near::{Sides, Tree};
use crate::deform::operand::Operand;
use crate::deform::pair::{Mover, Pair};
use crate::deform::scratch::{DeformableScratch, Lent, Scratches};
use crate::deform::shape::Modulus;
use crate::deform::side::Side;
use crate::error::ContactError;

/// At most so many pairs are one piece of work: a pair that renews its candidates takes ten times as long as others.
#[cfg(feature = "parallel")]
const GRAIN: usize = 4;

impl Context<'_> {
    /// Evaluates one pair in place.
    fn evaluate(&self, pair: &mut SoftPair, bodies: &[SoftBody], scratch: &mut DeformableScratch) {
        let motion = self.motion(pair, bodies);
        if self.touch(pair, bodies, motion, scratch).is_none() {
            pair.outcome.clear();
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
        let swapped = pair.swapped;
        let (a, b) = pair.sides();
        let body = bodies.get(b as usize)?;
        let of_b = self.soft(b, body)?;
        let tree_b = tree(body)?;
        let moduli_b = body.modulus;
        let law = self.around.materials.law(a.into(), b);
        let rigid = Modulus::Penalty(law.penalty);
        let way = if pair.is_own() {
            Way::Itself
        } else {
            Way::Skins
        };
        let (mut turning, mut frequency) = (None, 0.0);
        let seen = self.seen(a, bodies, pair.image, swapped);
        let (of_a, tree_a, modulus, mover) = match a {
            Side::Deformable(i) => {
                let body = bodies.get(i as usize)?;
                let mut state = *self.states.get(i as usize)?;
                let mut tree = tree(body)?;
                (turning, frequency) = (body.turning.as_ref(), body.frequency);
                if let Some(Seen::Nodes {
                    positions,
                    velocities,
                    turning: of_image,
                    way,
                }) = &seen
                {
                    (state.positions, state.velocities) = (positions, velocities);
                    turning = of_image.as_ref();
                    tree.away = *way;
                }
                let shape = self.shapes.get(body.shape as usize)?;
                let operand = Operand::Deformable(shape, state.positions);
                (operand, tree, body.modulus, Mover::Nodes(state))
            }
            Side::Rigid(i) => {
                let motion = match &seen {
                    Some(Seen::Rigid(motion)) => motion,
                    _ => self.around.rigid.get(i as usize)?,
                };
                let kind = (*self.around.rigid_kinds.get(i as usize)?)?;
                let mesh = self.around.rigid_meshes.get(kind as usize)?;
                let operand = Operand::Rigid(mesh, &motion.frame);
                (operand, mesh.cells.tree(), rigid, Mover::Rigid(motion))
            }
            Side::Wall(w) => {
                let motion = self.around.walls.get(w as usize)?;
                let solid = self.wall(&mut pair.local, w, body).0?;
                let operand = Operand::Wall(solid, &motion.frame);
                (operand, solid.cells.tree(), rigid, Mover::Rigid(motion))
            }
        };
        let sides = Sides {
            operands: [of_a, of_b],
            trees: [tree_a, tree_b],
        };
        let kernel = DeformableKernel::default().with_walls(law.wall_response);
        let pressures = kernel.pressures(&sides, [modulus, moduli_b]);
        let touches = match run_kernel(
            &sides,
            pressures,
            way,
            &mut pair.candidates,
            motion,
            scratch,
        ) {
            Ok(touches) => touches,
            Err((side, inverted)) => {
                let body = match a {
                    Side::Deformable(i) if side == 0 => i,
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
            ids: (pair.a.into(), pair.b),
            sides: sides.operands,
            movers: [mover, Mover::Nodes(*self.states.get(b as usize)?)],
            frequencies: [frequency, body.frequency],
            turnings: [turning, body.turning.as_ref()],
            near: pair.candidates.near()?,
            law: &law,
            begins: pair.begins.take().map(|start| start.seen_from(swapped)),
            dt: self.around.dt,
        };
        pair.outcome.take(&of_pair, scratch);
        if swapped {
            pair.outcome.swap_sides();
        }
        pair.branch = self.branch(pair, bodies);
        Some(())
    }
}

fn tree(body: &SoftBody) -> Option<Tree<'_>> {
    let (tree, boxes) = body.tree.as_deref()?;
    Some(Tree::here(tree, boxes))
}

/// Evaluates the pairs that are due. Each is written to its own slot, so the results are the same bits in any order and
/// with any number of threads.
pub(crate) fn run(
    context: &Context,
    bodies: &[SoftBody],
    pairs: &mut [SoftPair],
    looks: &mut [Look],
    scratches: &Scratches,
) -> Result<(), ContactError> {
    evaluate_all(context, bodies, pairs, looks, scratches);
    match looks.iter().find_map(|look| look.failure) {
        Some((body, tet)) => Err(ContactError::InvertedTet {
            body: body as usize,
            tet: tet as usize,
        }),
        None => Ok(()),
    }
}

fn evaluate_all(
    context: &Context,
    bodies: &[SoftBody],
    pairs: &mut [SoftPair],
    looks: &mut [Look],
    scratches: &Scratches,
) {
    let all = pairs.iter_mut().zip(looks);
    let due = all.filter(|(_, look)| matches!(look.due, Due::Listed | Due::Unlisted));
    let evaluate = |lent: &mut Lent, (pair, look): (&mut SoftPair, &mut Look)| {
        context.evaluate(pair, bodies, &mut lent.scratch);
        look.again(pair);
    };
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        let due: Vec<_> = due.collect();
        due.into_par_iter()
            .with_max_len(GRAIN)
            .for_each_init(|| scratches.lend(), evaluate);
        return;
    }
    let mut lent = scratches.lend();
    due.for_each(|pair| evaluate(&mut lent, pair));
}
