//! Narrow phase of a batch: one outcome per pair, in fixed slots.

use super::pairs::{Cache, Pair, PairTable};
use crate::contact::{Contact, Partner, assemble};
use crate::damping::damp;
use crate::friction::FrictionState;
use crate::kernel::{CavityKernel, PairKernel, Scratch};
use crate::law::ContactParameters;
use crate::motion::Motion;
use crate::shape::ConvexShape;
use crate::walls::Wall;
use std::sync::Arc;

#[cfg(feature = "parallel")]
use super::SERIAL_BELOW;

/// What every pair of one update shares.
pub(crate) struct Context<'a> {
    pub pair: PairKernel,
    pub cavity: CavityKernel,
    pub parameters: ContactParameters,
    pub shapes: &'a [Arc<ConvexShape>],
    pub body_shapes: &'a [u32],
    pub wall_shapes: &'a [Wall],
    pub bodies: &'a [Motion],
    pub walls: &'a [Motion],
    pub dt: f64,
}

impl Context<'_> {
    fn shape(&self, body: u32) -> &ConvexShape {
        &self.shapes[self.body_shapes[body as usize] as usize]
    }

    fn motion_a(&self, a: Partner) -> &Motion {
        match a {
            Partner::Body(i) => &self.bodies[i as usize],
            Partner::Wall(w) => &self.walls[w as usize],
        }
    }

    /// Whether the caches alone tell that the pair is apart.
    fn is_clear(&self, pair: &Pair) -> bool {
        let travelled = self.motion_a(pair.a).travelled + self.bodies[pair.b as usize].travelled;
        match &pair.cache {
            Cache::Body(cache) => cache.is_clear(travelled),
            Cache::Wall(cache) => cache.is_clear(travelled),
        }
    }

    /// Evaluates one pair in place.
    fn evaluate(&self, pair: &mut Pair, scratch: &mut Scratch) {
        let (a, b) = (self.motion_a(pair.a), &self.bodies[pair.b as usize]);
        let travelled = a.travelled + b.travelled;
        let body = self.shape(pair.b);
        let overlap = match (&mut pair.cache, pair.a) {
            (Cache::Body(cache), Partner::Body(i)) => self.pair.evaluate_cached(
                self.shape(i),
                &a.frame,
                body,
                &b.frame,
                cache,
                travelled,
                scratch,
            ),
            (Cache::Wall(cache), Partner::Wall(w)) => self.cavity.evaluate_cached(
                &self.wall_shapes[w as usize],
                &a.frame,
                body,
                &b.frame,
                cache,
                travelled,
                scratch,
            ),
            _ => None,
        };
        let Some(overlap) = overlap else {
            pair.contact = None;
            pair.friction = None;
            return;
        };
        let damped = damp(&overlap, a, b, self.parameters.damping_ratio);
        let normal_force = overlap.force_magnitude() * damped.scale;
        let state = pair
            .friction
            .get_or_insert_with(|| FrictionState::new(&overlap, a, b));
        let friction = state.update(&self.parameters, &overlap, normal_force, a, b, self.dt);
        let contact: Contact = assemble(pair.a, pair.b, &overlap, &damped, &friction, [a, b]);
        pair.contact = Some(contact);
    }
}

/// Evaluates all pairs of the order. Each pair is written in its own slot, so neither the
/// order nor the number of threads changes a bit.
pub(crate) fn run(context: &Context, pairs: &mut PairTable) {
    let mut due = Vec::with_capacity(pairs.order_len());
    for k in 0..pairs.order_len() {
        let slot = pairs.order()[k];
        let pair = pairs.slot_mut(slot);
        if context.is_clear(pair) {
            pair.contact = None;
            pair.friction = None;
        } else {
            due.push(slot);
        }
    }
    #[cfg(feature = "parallel")]
    if due.len() >= SERIAL_BELOW && rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        due.sort_unstable();
        pairs
            .slots_mut(&due)
            .into_par_iter()
            .with_min_len(16)
            .for_each_init(Scratch::default, |scratch, pair| {
                context.evaluate(pair, scratch);
            });
        return;
    }
    let mut scratch = Scratch::default();
    for slot in due {
        context.evaluate(pairs.slot_mut(slot), &mut scratch);
    }
}
