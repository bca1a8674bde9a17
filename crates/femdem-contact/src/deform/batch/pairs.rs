//! Candidate pairs of bodies, and the stored data of each.

use super::body::{SoftBody, on_each};
use super::context::Context;
use super::pair::SoftPair;
use super::prepare::Wanted;
use super::sleep::rests;
use crate::deform::near::Candidates;
use crate::deform::side::Side;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

/// How far a body may move before the next search for pairs, over its radius.
const HALF_SKIN: f64 = 0.05;

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

    /// Whether the bodies and walls of all pairs are there.
    pub fn fits(&self, is_there: impl Fn(Side) -> bool) -> bool {
        let mut pairs = self.list.iter();
        pairs.all(|pair| is_there(pair.a) && is_there(Side::Deformable(pair.b)))
    }

    /// Ends the pairs for which `ends` holds.
    pub fn end(&mut self, ends: impl Fn(&SoftPair) -> bool) {
        self.list.retain(|pair| !ends(pair));
        self.forget_search();
    }

    /// Something came or went: search in the next update.
    pub fn forget_search(&mut self) {
        self.expires = Default::default();
    }

    /// Searches for pairs if a body has moved too far since the last search, and returns whether it did.
    pub fn search(&mut self, context: &Context, bodies: &mut [SoftBody]) -> bool {
        let travelled = [
            bodies.iter().map(|b| b.travelled).collect::<Vec<_>>(),
            context.around.rigid.iter().map(|m| m.travelled).collect(),
            context.around.walls.iter().map(|m| m.travelled).collect(),
        ];
        let holds = |(now, until): (&Vec<f64>, &Vec<f64>)| {
            now.len() == until.len() && now.iter().zip(until).all(|(now, until)| now < until)
        };
        if travelled.iter().zip(&self.expires).all(holds) {
            return false;
        }
        let extents: Vec<(Aabb, f64)> = bodies.iter().map(SoftBody::extent).collect();
        let mut boxes: Vec<Aabb> = Vec::with_capacity(2 * bodies.len());
        let mut skins = [Vec::with_capacity(bodies.len()), Vec::new(), Vec::new()];
        for (body, (bounds, radius)) in bodies.iter_mut().zip(&extents) {
            if !body.is_there {
                boxes.push(Aabb::EMPTY);
                skins[0].push(f64::INFINITY);
                continue;
            }
            let skin = HALF_SKIN * radius;
            boxes.push(bounds.grown(skin));
            skins[0].push(skin);
            // A node may move one way as far as the mean moves the other way.
            body.stretch_to(*radius, 2.0 * skin);
        }
        for (motion, &kind) in context.around.rigid.iter().zip(context.around.rigid_kinds) {
            let known = kind.and_then(|kind| context.around.rigid_shapes.get(kind as usize));
            let Some(shape) = known else {
                boxes.push(Aabb::EMPTY);
                skins[1].push(f64::INFINITY);
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
        let finite = |skin: &f64| skin.is_finite();
        let wall_skin = skins[0].iter().copied().filter(finite).fold(0.0, f64::max);
        // Without bodies no wall is met.
        let until = if skins[0].iter().any(finite) {
            wall_skin
        } else {
            f64::INFINITY
        };
        skins[2] = vec![until; context.around.walls.len()];
        let mut keys = body_pairs(&boxes, bodies.len());
        let own = bodies
            .iter()
            .zip(0..)
            .filter(|(b, _)| b.bend.is_some() && b.is_there);
        keys.extend(own.map(|(_, b)| (Side::Deformable(b), b)));
        let present = bodies.iter().zip(&extents).enumerate();
        for (b, (body, (_, radius))) in present.filter(|(_, (body, _))| body.is_there) {
            let reach = radius * (1.0 + HALF_SKIN) + wall_skin;
            for (w, (motion, wall)) in context
                .around
                .walls
                .iter()
                .zip(context.around.wall_shapes)
                .enumerate()
            {
                let Some(wall) = wall else {
                    continue;
                };
                let from = body.centre - motion.frame.position;
                if wall.clearance(&motion.frame.rotation.tr_mul(&from)) < reach {
                    keys.push((Side::Wall(w as u32), b as u32));
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
    fn keep(&mut self, keys: Vec<(Side, u32)>) {
        let mut old = std::mem::take(&mut self.list).into_iter().peekable();
        self.list.reserve(keys.len());
        for key in keys {
            while old.next_if(|p| p.key() < key).is_some() {}
            let kept = old.next_if(|p| p.key() == key);
            self.list.push(kept.unwrap_or_else(|| SoftPair::new(key)));
        }
    }

    /// Measures how far the parts of bodies that may touch themselves have moved towards each other, where that matters.
    pub fn measure_bends(&self, context: &Context, bodies: &mut [SoftBody]) {
        let mut clear = vec![f64::INFINITY; bodies.len()];
        let own = self.list.iter().filter(|pair| pair.is_own());
        let mut any = false;
        for pair in own.filter(|p| !rests(p, bodies, context.rigid_sleep)) {
            if let Some(clear) = clear.get_mut(pair.b as usize) {
                *clear = pair.candidates.clear();
                any = true;
            }
        }
        if any {
            on_each(bodies, |i, body| body.measure_bend(clear[i]));
        }
    }

    /// Data of the deformable bodies needed now: their rotation, if they may touch something, and their
    /// trees, if a pair must renew its candidates.
    pub fn wanted(&mut self, context: &Context, bodies: &[SoftBody]) -> Vec<Wanted> {
        let mut wanted = vec![Wanted::default(); bodies.len()];
        let rigid = context.rigid_sleep;
        for pair in self.list.iter_mut().filter(|p| !rests(p, bodies, rigid)) {
            if let (Side::Wall(w), Some(body)) = (pair.a, bodies.get(pair.b as usize)) {
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
                    of_body.turning |= !pair.is_own();
                    of_body.tree |= is_stale;
                }
            }
        }
        wanted
    }
}

/// Pairs with a deformable body, which come first in `boxes`.
fn body_pairs(boxes: &[Aabb], soft: usize) -> Vec<(Side, u32)> {
    let tree = Bvh::new(boxes);
    let mut keys = Vec::new();
    for (b, own) in boxes[..soft].iter().enumerate() {
        tree.query(own, |i| {
            let i = i as usize;
            if boxes[i].overlaps(own) {
                if i < b {
                    keys.push((Side::Deformable(i as u32), b as u32));
                } else if i >= soft {
                    keys.push((Side::Rigid((i - soft) as u32), b as u32));
                }
            }
        });
    }
    keys
}
