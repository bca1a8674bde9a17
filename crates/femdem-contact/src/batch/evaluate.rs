//! Narrow phase of a batch: one outcome per pair, in fixed slots.

use super::bonds::Bonds;
use super::history::{History, PatchRecord, inherit};
use super::pairs::{Cache, MeshPair, Pair, PairTable, Touch};
use crate::body_shape::BodyShape;
use crate::contact::{BodyId, Partner, RigidContact, assemble, rolling_radius_at};
use crate::damping::{Moment, Whole, damp};
use crate::friction::Pace;
use crate::general::{FieldMesh, GeneralKernel, GeneralScratch, Patch};
use crate::kernel::{CavityKernel, Overlap, PairKernel, Scratch};
use crate::materials::Materials;
use crate::motion::Motion;
use crate::periodic::Space;
use crate::rocking::{Rocker, Turn};
use crate::rolling::{Roller, Rolling};
use crate::sphere::{SolidMeeting, SphereKernel};
use crate::walls::{Wall, WallShape};
use femdem_mesh::Vector3;
use std::borrow::Cow;
use std::sync::Arc;

#[cfg(feature = "parallel")]
use super::SERIAL_BELOW;

/// Cost of a pair with a mesh in convex pairs, for distributing pairs over threads.
#[cfg(feature = "parallel")]
const MESH_PAIR: usize = 16;

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct Workspace {
    convex: Scratch,
    general: GeneralScratch,
}

/// A convex contact that moves by less than this many of its depths within a step is not evaluated at the
/// predicted pose: hardly any becomes [much harder](HARDER).
const DEPTHS: f64 = 5.0;

/// A convex contact is evaluated at the predicted pose if its force there exceeds this factor times the
/// linear prediction F + k d.
const HARDER: f64 = 2.0;

/// Data shared by all pairs of one update.
pub(crate) struct Context<'a> {
    pub materials: &'a Materials,
    pub shapes: &'a [BodyShape],
    /// The shapes as tetrahedra; empty as long as there is no mesh.
    pub fans: &'a [Arc<FieldMesh>],
    pub body_shapes: &'a [u32],
    pub wall_shapes: &'a [Option<WallShape>],
    pub bodies: &'a [Motion],
    pub walls: &'a [Motion],
    pub space: Option<&'a Space>,
    pub bonds: &'a Bonds,
    /// Whether contacts of any law attract.
    pub attracts: bool,
    /// The last step that was not 0, s.
    pub last_step: f64,
    pub pace: Pace,
}

/// A body or wall A, a body B, and the rank of the patch.
type Ids = (Partner, BodyId, u32);

impl Context<'_> {
    pub(super) fn shape(&self, body: BodyId) -> &BodyShape {
        &self.shapes[self.body_shapes[body as usize] as usize]
    }

    /// Who looks ahead, without dashpots, steps far.
    pub(super) fn pair_kernel(&self, penalty: f64) -> PairKernel {
        let kernel = PairKernel::of(penalty);
        if self.pace.dashpots {
            kernel
        } else {
            kernel.for_large_steps()
        }
    }

    fn mesh(&self, body: BodyId) -> Option<&FieldMesh> {
        let shape = self.body_shapes[body as usize] as usize;
        self.fans.get(shape).map(Arc::as_ref)
    }

    pub(super) fn planes(&self, wall: u32) -> Option<&Wall> {
        self.wall_shapes[wall as usize].as_ref()?.planes()
    }

    /// The motion of A as B sees it, and in periodic space which image that is.
    fn seen(&self, a: Partner, b: BodyId) -> (Cow<'_, Motion>, [i32; 3]) {
        match (a, self.space) {
            (Partner::Body(i), None) => (Cow::Borrowed(&self.bodies[i as usize]), [0; 3]),
            (Partner::Body(i), Some(space)) => {
                let (seen, image) = space.image(&self.bodies[i as usize], &self.bodies[b as usize]);
                (Cow::Owned(seen), image)
            }
            (Partner::Wall(w), _) => (Cow::Borrowed(&self.walls[w as usize]), [0; 3]),
        }
    }

    /// The motions of A, as B sees it, and of B.
    pub(super) fn motions(&self, a: Partner, b: BodyId) -> (Cow<'_, Motion>, &Motion) {
        (self.seen(a, b).0, &self.bodies[b as usize])
    }

    /// Whether the caches alone show that the pair is apart.
    fn is_clear(&self, pair: &Pair) -> bool {
        let (a, b) = self.motions(pair.a, pair.b);
        pair.is_clear(a.travelled + b.travelled)
            && match &pair.cache {
                Cache::Mesh(mesh) => self.sees_wall(pair, mesh),
                Cache::Body(_) | Cache::Wall(_) | Cache::Sphere(_) => true,
            }
    }

    /// Whether the cached part of the wall contains all that the body can reach. True for pairs without such
    /// a part.
    fn sees_wall(&self, pair: &Pair, mesh: &MeshPair) -> bool {
        let Partner::Wall(w) = pair.a else {
            return true;
        };
        let body = self.mesh(pair.b);
        let local = self.planes(w).zip(body);
        local.is_none_or(|(_, body)| mesh.local.holds(&self.in_wall(w, pair.b), body.radius()))
    }

    /// Position of a body in the axes of a wall, m.
    fn in_wall(&self, wall: u32, body: BodyId) -> Vector3 {
        let frame = &self.walls[wall as usize].frame;
        let from_wall = self.bodies[body as usize].frame.position - frame.position;
        frame.rotation.tr_mul(&from_wall)
    }

    /// Evaluates one pair in place.
    fn evaluate(&self, pair: &mut Pair, work: &mut Workspace) {
        let (a, image) = self.seen(pair.a, pair.b);
        let b = &self.bodies[pair.b as usize];
        pair.image = image;
        let overlap = match &mut pair.cache {
            Cache::Mesh(mesh) => {
                self.evaluate_mesh(pair.a, pair.b, mesh, &mut work.general);
                return;
            }
            cache => self.evaluate_whole(pair.a, pair.b, cache, &mut work.convex),
        };
        let Some(overlap) = overlap else {
            pair.touch = None;
            self.stretch(pair);
            return;
        };
        let key = (pair.a, pair.b, 0);
        let is_new = pair.touch.is_none();
        if let Some(Touch { history, contact }) = pair.touch.as_deref_mut() {
            *contact = self.touch(key, &overlap, None, history);
        } else {
            let mut history = History::new(&overlap, &a, b);
            let contact = self.touch(key, &overlap, None, &mut history);
            pair.touch = Some(Box::new(Touch { history, contact }));
        }
        if let Some(touch) = pair.touch.as_deref_mut() {
            self.date(&mut touch.history.fresh, is_new);
        }
        // A bridge from a law of before ends here, too.
        if self.attracts || pair.bridge().is_some() {
            self.attract(pair, &overlap, &mut work.convex);
        }
    }

    /// Replaces a contact by the one at the predicted pose if its force is much larger there than its
    /// stiffness says, as when a body tips over an edge and a face comes down.
    fn foresee_if_harder(&self, pair: &mut Pair, scratch: &mut Scratch) {
        let (a, b) = self.motions(pair.a, pair.b);
        let Some(Touch { history, contact }) = pair.touch.as_deref_mut() else {
            return;
        };
        let velocity = b.velocity_at(&contact.arm_b) - a.velocity_at(&contact.arm_a);
        let turning = b.angular_velocity - a.angular_velocity;
        let dt = self.pace.dt;
        let closing = (-contact.normal.dot(&velocity) * dt).max(0.0);
        let tipping = contact.normal.cross(&turning).norm() * contact.arm_b.norm() * dt;
        if closing + tipping <= DEPTHS * contact.penetration() {
            return;
        }
        let expected = contact.elastic_force + contact.foundation.stiffness * closing;
        let Some(overlap) = self.evaluate_whole(pair.a, pair.b, &mut pair.cache, scratch) else {
            return;
        };
        if overlap.force_magnitude() > HARDER * expected {
            // The stored history stays that of the present pose.
            let mut history = *history;
            let energy = contact.energy;
            *contact = self.touch((pair.a, pair.b, 0), &overlap, None, &mut history);
            contact.foreseen = true;
            contact.energy = energy;
        }
    }

    /// The contact of a pair that touches in one patch at most.
    fn evaluate_whole(
        &self,
        a: Partner,
        b: BodyId,
        cache: &mut Cache,
        scratch: &mut Scratch,
    ) -> Option<Overlap> {
        let (of_a, of_b) = self.motions(a, b);
        let (frame_a, frame_b) = (&of_a.frame, &of_b.frame);
        let travelled = of_a.travelled + of_b.travelled;
        let penalty = self.materials.law(a, b).penalty;
        match (cache, a) {
            (Cache::Body(cache), Partner::Body(i)) => {
                let (shape, body) = (self.shape(i).convex()?, self.shape(b).convex()?);
                self.pair_kernel(penalty)
                    .evaluate_cached(shape, frame_a, body, frame_b, cache, travelled, scratch)
            }
            (Cache::Wall(cache), Partner::Wall(w)) => {
                let (wall, body) = (self.planes(w)?, self.shape(b).convex()?);
                CavityKernel::of(penalty)
                    .evaluate_cached(wall, frame_a, body, frame_b, cache, travelled, scratch)
            }
            (Cache::Sphere(ball), _) => {
                if travelled < ball.clear_until {
                    return None;
                }
                let meeting = self.meeting(a, b, [frame_a, frame_b])?;
                let (gap, _) = meeting.gap();
                ball.clear_until = match ball.bridge {
                    Some(_) => 0.0,
                    None => travelled + gap.max(0.0),
                };
                (gap < 0.0)
                    .then(|| meeting.overlap(&SphereKernel::of(penalty)))
                    .flatten()
            }
            _ => None,
        }
    }

    /// Evaluates a pair with a mesh and matches its patches with those of the last step.
    fn evaluate_mesh(
        &self,
        a: Partner,
        b: BodyId,
        pair: &mut MeshPair,
        scratch: &mut GeneralScratch,
    ) {
        let of_ball = self.ball_patches(a, b, pair);
        let patches = match &of_ball {
            Some(patches) => patches,
            None => self.patches(a, b, pair, scratch).unwrap_or_default(),
        };
        if patches.is_empty() {
            pair.patches.clear();
            return;
        }
        let (of_a, of_b) = self.motions(a, b);
        let motions = [&*of_a, of_b];
        let found: Vec<([u32; 2], &Overlap)> =
            patches.iter().map(|p| (p.key, &p.overlap)).collect();
        let law = self.materials.law(a, b);
        let ratio = law.tangential_ratio;
        let states = inherit(&pair.patches, &found, motions, ratio);
        let overlaps = patches.iter().map(|p| &p.overlap);
        let whole = (patches.len() > 1).then(|| Whole::new(overlaps, motions[0], motions[1]));
        pair.patches.clear();
        for (rank, ((key, overlap), mut state)) in found.into_iter().zip(states).enumerate() {
            let is_new = state.friction.is_new();
            self.date(&mut state.fresh, is_new);
            let mut contact = self.touch((a, b, rank as u32), overlap, whole.as_ref(), &mut state);
            if law.cohesion > 0.0 {
                let area = &patches[rank].touching;
                contact.adhesion = self.cohere((a, b), &law, area, overlap, state.fresh);
            }
            let record = PatchRecord::new(key, overlap, motions, state, contact);
            pair.patches.push(record);
        }
    }

    /// The patches of a pair of a sphere with a mesh; `None` for other pairs.
    fn ball_patches(&self, a: Partner, b: BodyId, pair: &mut MeshPair) -> Option<Vec<Patch>> {
        let (of_a, of_b) = self.motions(a, b);
        let frames = [&of_a.frame, &of_b.frame];
        let body = self.shape(b);
        let meeting = match a {
            Partner::Body(i) => SolidMeeting::of_bodies([self.shape(i), body], frames)?,
            Partner::Wall(w) => {
                let WallShape::Mesh(wall) = self.wall_shapes[w as usize].as_ref()? else {
                    return None;
                };
                SolidMeeting::with_wall(wall.solid_wall(), frames, body)?
            }
        };
        let patches = meeting.patches(&SphereKernel::of(self.materials.law(a, b).penalty));
        if patches.is_empty() {
            let travelled = of_a.travelled + of_b.travelled;
            pair.cache.set_apart(travelled + meeting.gap().max(0.0));
        }
        Some(patches)
    }

    fn patches<'s>(
        &self,
        a: Partner,
        b: BodyId,
        pair: &mut MeshPair,
        scratch: &'s mut GeneralScratch,
    ) -> Option<&'s [Patch]> {
        let (of_a, of_b) = self.motions(a, b);
        let (frame_a, frame_b) = (&of_a.frame, &of_b.frame);
        let travelled = of_a.travelled + of_b.travelled;
        let body = self.mesh(b)?;
        let kernel = GeneralKernel::of(self.materials.law(a, b).penalty);
        let cache = &mut pair.cache;
        let wall = match a {
            Partner::Body(i) => {
                let mesh = self.mesh(i)?;
                return Some(
                    kernel.evaluate_cached(mesh, frame_a, body, frame_b, cache, travelled, scratch),
                );
            }
            Partner::Wall(w) => match self.wall_shapes[w as usize].as_ref()? {
                WallShape::Mesh(wall) => wall.solid_wall(),
                WallShape::Planes(wall) => {
                    let x = self.in_wall(w, b);
                    let (solid, renewed) = pair.local.near(wall, &x, body.radius());
                    if renewed {
                        *cache = Default::default();
                        for patch in &mut pair.patches {
                            patch.forget_key();
                        }
                    }
                    solid?
                }
            },
        };
        Some(kernel.evaluate_wall_cached(wall, frame_a, body, frame_b, cache, travelled, scratch))
    }

    /// Damping and friction of one patch, whose state is advanced; `whole` is the whole pair if it has
    /// several patches.
    fn touch(
        &self,
        ids: Ids,
        overlap: &Overlap,
        whole: Option<&Whole>,
        history: &mut History,
    ) -> RigidContact {
        let (a, b) = self.motions(ids.0, ids.1);
        let a = &*a;
        // A host that asks for springs alone applies the dashpots itself, without these corrections.
        let moment = if self.pace.dashpots {
            Moment {
                dt: self.pace.dt,
                fresh: history.friction.is_new(),
            }
        } else {
            Moment::default()
        };
        let law = self.materials.law(ids.0, ids.1);
        let zeta = law.damping_ratio;
        let mut damped = damp(overlap, whole, a, b, zeta, moment);
        let rocker = Rocker {
            foundation: &overlap.foundation,
            normal: &overlap.normal,
            force: overlap.force,
            moment: overlap.moment,
            scale: damped.scale,
            zeta,
        };
        let turn = Turn::of_bodies([a, b]);
        let mut rocking = history.rocking.update(&rocker, &turn, self.pace.dt);
        let normal_force = overlap.force_magnitude() * damped.scale;
        if !self.pace.dashpots {
            damped.scale = 1.0;
            rocking.leave_springs();
        }
        let share = whole.map_or(1.0, |all| all.friction_share(overlap));
        let pace = Pace {
            share,
            birth: damped.birth,
            ..self.pace
        };
        let friction = history
            .friction
            .update(&law, overlap, normal_force, a, b, pace);
        let mut rolling = Rolling::default();
        if law.rolling_friction > 0.0 {
            let arms = [&overlap.arm_a, &overlap.arm_b];
            let radius = rolling_radius_at(ids.0, &overlap.normal, arms);
            let roller = Roller {
                normal: overlap.normal,
                most: law.rolling_friction * normal_force * radius,
                stiffness: friction.stiffness * radius * radius,
                zeta: law.tangential_damping,
            };
            let (dt, dashpots) = (self.pace.dt, self.pace.dashpots);
            rolling = history.rolling.update(&roller, &turn, dt, dashpots);
        }
        let turning = (&rocking, &rolling);
        assemble(ids, overlap, &damped, turning, &friction, [a, b])
    }
}

/// The bodies at their present poses and, if requested, at those predicted for the end of the step.
#[derive(Clone, Copy)]
pub(crate) struct Views<'a> {
    pub now: &'a Context<'a>,
    pub ahead: Option<&'a Context<'a>>,
}

impl Views<'_> {
    /// Whether the caches alone show that the pair is apart, now and at the predicted poses; or bonds act between the two.
    fn is_clear(&self, pair: &Pair) -> bool {
        if matches!(pair.a, Partner::Body(a) if self.now.bonds.hold((a, pair.b))) {
            return true;
        }
        match self.ahead {
            Some(ahead) => !pair.touches() && ahead.is_clear(pair),
            None => self.now.is_clear(pair),
        }
    }

    /// Evaluates one pair in place: at the present poses if it touches and does not become much harder, else
    /// at the predicted ones.
    fn evaluate(&self, pair: &mut Pair, work: &mut Workspace) {
        let Some(ahead) = self.ahead else {
            self.now.evaluate(pair, work);
            return;
        };
        if pair.touches() {
            self.now.evaluate(pair, work);
            if pair.touches() {
                ahead.foresee_if_harder(pair, &mut work.convex);
                return;
            }
        }
        ahead.evaluate(pair, work);
        for contact in pair.contacts_mut() {
            contact.foreseen = true;
            contact.energy = 0.0;
        }
    }
}

/// Evaluates all pairs in order and passes them to `seen` in that order. Each pair is written to its own
/// slot, so the results are the same bits with any number of threads.
///
/// A single thread evaluates a pair and passes it on at once: in a large pack a second visit to a pair would
/// be a cache miss.
pub(crate) fn run(views: Views, pairs: &mut PairTable, mut seen: impl FnMut(&Pair)) {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 && hand_out(views, pairs) {
        pairs.evaluated().for_each(seen);
        return;
    }
    let mut work = Workspace::default();
    for k in 0..pairs.order_len() {
        let pair = pairs.slot_mut(pairs.order()[k]);
        pair.begin();
        if views.is_clear(pair) {
            pair.part();
        } else {
            views.evaluate(pair, &mut work);
        }
        seen(pair);
    }
}

/// Evaluates the pairs on all threads, or returns false if they are too few.
#[cfg(feature = "parallel")]
fn hand_out(views: Views, pairs: &mut PairTable) -> bool {
    use rayon::prelude::*;
    if !pairs.has_meshes() && pairs.order_len() < SERIAL_BELOW {
        return false;
    }
    let mut due = Vec::with_capacity(pairs.order_len());
    let mut meshes = 0;
    for k in 0..pairs.order_len() {
        let slot = pairs.order()[k];
        let pair = pairs.slot_mut(slot);
        pair.begin();
        if views.is_clear(pair) {
            pair.part();
        } else {
            meshes += usize::from(matches!(pair.cache, Cache::Mesh(_)));
            due.push(slot);
        }
    }
    if due.len() + MESH_PAIR * meshes < SERIAL_BELOW {
        return false;
    }
    due.sort_unstable();
    pairs
        .slots_mut(&due)
        .into_par_iter()
        .with_min_len(if meshes > 0 { 1 } else { MESH_PAIR })
        .for_each_init(Workspace::default, |work, pair| {
            views.evaluate(pair, work);
        });
    true
}
