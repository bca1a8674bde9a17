//! What an update finds out about each pair. Pairs are worked on by all threads; what follows in the order of the pairs
//! reads these short records instead of the pairs.

use super::body::SoftBody;
use super::context::Context;
use super::each::on_each;
use super::pair::SoftPair;
use super::prepare::Wanted;
use super::sleep::rests;
use super::state::Sleep;
use super::touching::{Part, Touching};
use crate::contact::BodyId;
use crate::deform::near::Candidates;
use crate::deform::record::DeformableTotals;
use crate::deform::side::Side;

/// Pairs that a thread looks at in one go.
const GRAIN: usize = 32;

/// What an update does with a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Due {
    /// Its bodies are frozen: it stays as it is.
    Rests,
    /// It is known to be apart.
    Apart,
    /// It is evaluated by its list of what is near.
    Listed,
    /// It is evaluated, and needs a new list.
    Unlisted,
}

/// What an update finds out about a pair.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    pub a: Side,
    pub b: BodyId,
    pub due: Due,
    touches: bool,
    /// Body and index of an inverted tetrahedron.
    pub failure: Option<(BodyId, u32)>,
    pub totals: DeformableTotals,
}

impl Look {
    fn new(pair: &SoftPair, due: Due) -> Self {
        Self {
            a: pair.a,
            b: pair.b,
            due,
            touches: !pair.outcome.contacts.is_empty(),
            failure: pair.failure,
            totals: pair.totals(),
        }
    }

    /// A pair as it is after the last update.
    pub fn back(pair: &SoftPair, bodies: &[SoftBody], rigid: &[Sleep]) -> Self {
        let at_rest = rests(pair, bodies, rigid);
        Self::new(pair, if at_rest { Due::Rests } else { Due::Apart })
    }

    /// Notes the result of the pair's evaluation.
    pub fn again(&mut self, pair: &SoftPair) {
        *self = Self::new(pair, self.due);
    }

    /// Its deformable bodies; one that meets itself twice.
    fn deformables(&self) -> impl Iterator<Item = BodyId> + use<> {
        self.a.deformable().into_iter().chain([self.b])
    }
}

/// Clears the last update of all pairs but those at rest, and looks which must be evaluated.
pub(super) fn all(context: &Context, bodies: &[SoftBody], pairs: &mut [SoftPair]) -> Vec<Look> {
    on_each(pairs, GRAIN, |_, pair| {
        let due = context.begin(pair, bodies);
        Look::new(pair, due)
    })
}

impl Context<'_> {
    fn begin(&self, pair: &mut SoftPair, bodies: &[SoftBody]) -> Due {
        if rests(pair, bodies, self.rigid_sleep) {
            return Due::Rests;
        }
        pair.failure = None;
        pair.counts = [0; 2];
        self.choose_image(pair, bodies);
        let mut is_apart = false;
        if let Side::Wall(w) = pair.a {
            let (solid, fresh) = self.wall(&mut pair.local, w, &bodies[pair.b as usize]);
            is_apart = solid.is_none();
            if fresh {
                pair.candidates = Candidates::default();
            }
        }
        let motion = self.motion(pair, bodies);
        if is_apart || pair.candidates.is_clear(motion) {
            pair.outcome.clear();
            Due::Apart
        } else if pair.candidates.is_expired(motion) {
            Due::Unlisted
        } else {
            Due::Listed
        }
    }
}

/// Data of the bodies needed now: their rotation, if they may touch something, and their trees, if a pair needs a new
/// list.
pub(super) fn wanted(looks: &[Look], bodies: usize) -> Vec<Wanted> {
    let mut wanted = vec![Wanted::default(); bodies];
    let due = |look: &&Look| matches!(look.due, Due::Listed | Due::Unlisted);
    for look in looks.iter().filter(due) {
        let is_own = look.a == Side::Deformable(look.b);
        for i in look.deformables() {
            let of_body = &mut wanted[i as usize];
            of_body.turning |= !is_own;
            of_body.tree |= look.due == Due::Unlisted;
        }
    }
    wanted
}

/// Which bodies are in pairs that do not rest.
pub(super) fn stirred(looks: &[Look], bodies: usize) -> Vec<bool> {
    let mut stirred = vec![false; bodies];
    for look in looks.iter().filter(|look| look.due != Due::Rests) {
        for i in look.deformables() {
            stirred[i as usize] = true;
        }
    }
    stirred
}

/// The touching pairs of each body, and the places of those with a rigid body or a wall.
pub(super) fn touching(looks: &[Look], bodies: usize) -> (Touching, Vec<u32>) {
    let mut parts = Vec::with_capacity(2 * looks.len());
    let mut rigid = Vec::new();
    for (place, look) in (0..).zip(looks).filter(|(_, look)| look.touches) {
        parts.push((look.b, Part { place, side: 1 }));
        match look.a.deformable() {
            Some(i) => parts.push((i, Part { place, side: 0 })),
            None => rigid.push(place),
        }
    }
    (Touching::new(&parts, bodies), rigid)
}
