//! Candidate pairs of bodies, and the stored data of each.

use super::RigidShape;
use super::body::{SoftBody, Wanted};
use super::evaluate::Context;
use super::sleep::Sleep;
use crate::deform::near::Candidates;
use crate::deform::record::{DeformablePartner, DeformableTotals};
use crate::deform::respond::{FrictionStart, Outcome};
use crate::walls::LocalSolid;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

/// How far a body may move before the next search for pairs, over its radius.
const HALF_SKIN: f64 = 0.05;

/// A body or wall A, and a deformable body B.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct SoftPair {
    pub a: DeformablePartner,
    pub b: u32,
    pub candidates: Candidates,
    /// The part of a wall of planes near the body.
    pub local: LocalSolid,
    pub outcome: Outcome,
    /// Inverted tetrahedron in the last evaluation: the side and the index.
    pub failure: Option<(u32, u32)>,
    pub counts: [u32; 2],
    /// Initial friction of its springs.
    pub begins: Option<FrictionStart>,
}

impl SoftPair {
    fn new((a, b): (DeformablePartner, u32)) -> Self {
        Self {
            a,
            b,
            candidates: Candidates::default(),
            local: LocalSolid::default(),
            outcome: Outcome::default(),
            failure: None,
            counts: [0; 2],
            begins: None,
        }
    }

    pub fn key(&self) -> (DeformablePartner, u32) {
        (self.a, self.b)
    }

    /// Its deformable bodies.
    pub fn deformables(&self) -> impl Iterator<Item = u32> + use<> {
        let of_a = match self.a {
            DeformablePartner::Deformable(i) => Some(i),
            _ => None,
        };
        of_a.into_iter().chain([self.b])
    }

    /// Whether all its bodies are frozen, so that it need not be evaluated.
    pub fn rests(&self, bodies: &[SoftBody], rigid: &[Sleep]) -> bool {
        let frozen = |i: u32| {
            let body = bodies.get(i as usize);
            body.is_some_and(|body| body.sleep == Sleep::Frozen)
        };
        frozen(self.b)
            && match self.a {
                DeformablePartner::Deformable(i) => frozen(i),
                DeformablePartner::Rigid(i) => rigid.get(i as usize) == Some(&Sleep::Frozen),
                DeformablePartner::Wall(_) => true,
            }
    }

    pub fn totals(&self) -> DeformableTotals {
        DeformableTotals {
            pairs: 1,
            candidates: self.counts[0] as usize,
            pieces: self.counts[1] as usize,
            ..self.outcome.totals
        }
    }
}

/// Candidate pairs, sorted.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct PairList {
    list: Vec<SoftPair>,
    /// Travel of the deformable bodies, the rigid ones and the walls at which a new search is due, m; empty
    /// before the first one.
    expires: [Vec<f64>; 3],
}

impl PairList {
    pub fn list(&self) -> &[SoftPair] {
        &self.list
    }

    pub fn list_mut(&mut self) -> &mut [SoftPair] {
        &mut self.list
    }

    /// Whether the bodies and walls of all pairs are among so many deformable bodies, rigid ones and walls.
    pub fn fits(&self, [soft, rigid, walls]: [usize; 3]) -> bool {
        self.list.iter().all(|pair| {
            let a_is_there = match pair.a {
                DeformablePartner::Deformable(i) => (i as usize) < soft,
                DeformablePartner::Rigid(i) => (i as usize) < rigid,
                DeformablePartner::Wall(w) => (w as usize) < walls,
            };
            a_is_there && (pair.b as usize) < soft
        })
    }

    /// Something was added: search in the next update.
    pub fn forget_search(&mut self) {
        self.expires = Default::default();
    }

    /// Searches for pairs if a body has moved too far since the last search, and returns whether it did.
    pub fn search(&mut self, context: &Context, bodies: &mut [SoftBody]) -> bool {
        let travelled = [
            bodies.iter().map(|b| b.travelled).collect::<Vec<_>>(),
            context.rigid.iter().map(|m| m.travelled).collect(),
            context.walls.iter().map(|m| m.travelled).collect(),
        ];
        let holds = |(now, until): (&Vec<f64>, &Vec<f64>)| {
            now.len() == until.len() && now.iter().zip(until).all(|(now, until)| now < until)
        };
        if travelled.iter().zip(&self.expires).all(holds) {
            return false;
        }
        let extents: Vec<(Aabb, f64)> = bodies.iter().map(SoftBody::extent).collect();
        let mut boxes: Vec<Aabb> = Vec::with_capacity(bodies.len() + context.rigid.len());
        let mut skins = [Vec::with_capacity(bodies.len()), Vec::new(), Vec::new()];
        for (body, (bounds, radius)) in bodies.iter_mut().zip(&extents) {
            let skin = HALF_SKIN * radius;
            boxes.push(bounds.grown(skin));
            skins[0].push(skin);
            // A node may move one way as far as the mean moves the other way.
            body.stretch_to(*radius, 2.0 * skin);
        }
        for (motion, &kind) in context.rigid.iter().zip(context.rigid_kinds) {
            let Some(RigidShape { shape, .. }) = context.rigid_shapes.get(kind as usize) else {
                boxes.push(Aabb::EMPTY);
                skins[1].push(0.0);
                continue;
            };
            let skin = HALF_SKIN * shape.radius();
            let (low, high) = shape.bounds(&motion.frame.rotation);
            let at = |x: Vector3| Point3::from(x + motion.frame.position);
            let bounds = Aabb {
                low: at(low),
                high: at(high),
            };
            boxes.push(bounds.grown(skin));
            skins[1].push(skin);
        }
        let wall_skin = skins[0].iter().copied().fold(0.0, f64::max);
        skins[2] = vec![wall_skin; context.walls.len()];
        let mut keys = body_pairs(&boxes, bodies.len());
        for (b, (body, (_, radius))) in bodies.iter().zip(&extents).enumerate() {
            let reach = radius * (1.0 + HALF_SKIN) + wall_skin;
            for (w, (motion, wall)) in context.walls.iter().zip(context.wall_shapes).enumerate() {
                let from = body.centre - motion.frame.position;
                if wall.clearance(&motion.frame.rotation.tr_mul(&from)) < reach {
                    keys.push((DeformablePartner::Wall(w as u32), b as u32));
                }
            }
        }
        keys.sort_unstable();
        self.keep(keys);
        for (k, skins) in skins.iter().enumerate() {
            let until = travelled[k].iter().zip(skins).map(|(now, skin)| now + skin);
            self.expires[k] = until.collect();
        }
        true
    }

    /// Replaces the list by the pairs `keys`, which are sorted; pairs that stay keep their data.
    fn keep(&mut self, keys: Vec<(DeformablePartner, u32)>) {
        let mut old = std::mem::take(&mut self.list).into_iter().peekable();
        self.list.reserve(keys.len());
        for key in keys {
            while old.next_if(|p| p.key() < key).is_some() {}
            let kept = old.next_if(|p| p.key() == key);
            self.list.push(kept.unwrap_or_else(|| SoftPair::new(key)));
        }
    }

    /// Data of the deformable bodies needed now: their rotation, if they may touch something, and their
    /// trees, if a pair must renew its candidates.
    pub fn wanted(&mut self, context: &Context, bodies: &[SoftBody]) -> Vec<Wanted> {
        let mut wanted = vec![Wanted::default(); bodies.len()];
        let rigid = context.rigid_sleep;
        for pair in self.list.iter_mut().filter(|p| !p.rests(bodies, rigid)) {
            if let (DeformablePartner::Wall(w), Some(body)) = (pair.a, bodies.get(pair.b as usize))
            {
                let (solid, fresh) = context.wall(&mut pair.local, w, body);
                let is_near = solid.is_some();
                if fresh {
                    pair.candidates = Candidates::default();
                }
                if !is_near {
                    continue;
                }
            }
            let motion = context.motion(pair, bodies);
            if pair.candidates.is_clear(motion) {
                continue;
            }
            let is_stale = pair.candidates.is_expired(motion);
            for i in pair.deformables() {
                if let Some(of_body) = wanted.get_mut(i as usize) {
                    of_body.turning = true;
                    of_body.tree |= is_stale;
                }
            }
        }
        wanted
    }
}

/// A pair, and the side of a body in it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Part {
    /// Index of the pair in the list.
    pub place: u32,
    pub side: u8,
}

/// The touching pairs of each body, in their order.
pub(crate) struct Touching {
    /// Start of the entries of each body.
    starts: Vec<u32>,
    parts: Vec<Part>,
}

impl Touching {
    /// From (body, part) in the order of the pairs; bodies are below `bodies`.
    pub fn new(all: &[(u32, Part)], bodies: usize) -> Self {
        let known = || all.iter().filter(|(body, _)| (*body as usize) < bodies);
        let mut starts = vec![0; bodies + 1];
        for (body, _) in known() {
            starts[*body as usize + 1] += 1;
        }
        for body in 0..bodies {
            starts[body + 1] += starts[body];
        }
        let mut next = starts.clone();
        let mut parts = vec![Part::default(); starts[bodies] as usize];
        for (body, part) in known() {
            let next = &mut next[*body as usize];
            parts[*next as usize] = *part;
            *next += 1;
        }
        Self { starts, parts }
    }

    pub fn of(&self, body: usize) -> &[Part] {
        &self.parts[self.starts[body] as usize..self.starts[body + 1] as usize]
    }
}

/// Pairs with a deformable body, which come first in `boxes`.
fn body_pairs(boxes: &[Aabb], soft: usize) -> Vec<(DeformablePartner, u32)> {
    let tree = Bvh::new(boxes);
    let mut keys = Vec::new();
    for (b, own) in boxes[..soft].iter().enumerate() {
        tree.query(own, |i| {
            let i = i as usize;
            if boxes[i].overlaps(own) {
                if i < b {
                    keys.push((DeformablePartner::Deformable(i as u32), b as u32));
                } else if i >= soft {
                    keys.push((DeformablePartner::Rigid((i - soft) as u32), b as u32));
                }
            }
        });
    }
    keys
}
