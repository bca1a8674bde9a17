//! Candidate pairs of bodies, and the stored data of each.

use super::body::{GRAIN, SoftBody};
use super::context::Context;
use super::each::on_each;
use super::pair::SoftPair;
use super::state::Sleep;
use crate::contact::BodyId;
use crate::deform::side::Side;
use crate::error::{ContactError, check};
use crate::motion::Motion;
use crate::periodic::Space;
use femdem_mesh::PeriodicCell;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

/// How far a body may move before the next search for pairs, over its radius.
const HALF_SKIN: f64 = 0.05;

/// Candidate pairs, sorted.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct PairList {
    list: Vec<SoftPair>,
    /// By number, the place of the pair of a body with itself.
    #[serde(skip)]
    own: Vec<Option<u32>>,
    /// Travel of the deformable bodies, the rigid ones and the walls at which a new search is due, m; empty
    /// before the first one.
    expires: [Vec<f64>; 3],
    /// In periodic space the same of its edges, m.
    edges_expire: f64,
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
        self.note_own();
        self.forget_search();
    }

    /// Takes the pairs of a body off the list.
    pub fn take_of(&mut self, body: BodyId) -> Vec<SoftPair> {
        let is_own = |pair: &SoftPair| pair.deformables().any(|other| other == body);
        let (own, rest) = std::mem::take(&mut self.list).into_iter().partition(is_own);
        self.list = rest;
        own
    }

    /// Adds pairs that are not on the list.
    pub fn add(&mut self, pairs: impl IntoIterator<Item = SoftPair>) {
        self.list.extend(pairs);
        self.list.sort_by_key(SoftPair::key);
        self.note_own();
        self.forget_search();
    }

    /// Something came or went: search in the next update.
    pub fn forget_search(&mut self) {
        self.expires = Default::default();
    }

    /// Searches for pairs if a body has moved too far since the last search, and returns whether it did.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] for a periodic cell that is too small for a body.
    pub fn search(
        &mut self,
        context: &Context,
        bodies: &mut [SoftBody],
    ) -> Result<bool, ContactError> {
        let space = context.around.space;
        let rigid = context.around.rigid;
        let walls = context.around.walls;
        let [of_soft, of_rigid, of_walls] = &self.expires;
        let is_valid = stay(bodies.iter().map(|b| b.travelled), of_soft)
            && stay(travels(rigid), of_rigid)
            && stay(travels(walls), of_walls)
            && space.is_none_or(|space| space.path([1; 3]) < self.edges_expire);
        if is_valid {
            return Ok(false);
        }
        let extents = on_each(bodies, GRAIN, |_, body| {
            if !body.is_there {
                return (Aabb::EMPTY, f64::INFINITY);
            }
            let (bounds, radius) = body.extent();
            // A node may move one way as far as the mean moves the other way.
            body.stretch_to(radius, 2.0 * HALF_SKIN * radius);
            (bounds, radius)
        });
        let mut things: Vec<(Side, Aabb)> = Vec::with_capacity(bodies.len());
        let mut skins = [Vec::with_capacity(bodies.len()), Vec::new(), Vec::new()];
        for (i, (body, (bounds, radius))) in (0..).zip(bodies.iter().zip(&extents)) {
            let skin = HALF_SKIN * radius;
            if body.is_there {
                things.push((Side::Deformable(i), bounds.grown(skin)));
            }
            skins[0].push(skin);
        }
        for (i, (motion, &kind)) in (0..).zip(rigid.iter().zip(context.around.rigid_kinds)) {
            let known = kind.and_then(|kind| context.around.rigid_shapes.get(kind as usize));
            let Some(shape) = known else {
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
            things.push((Side::Rigid(i), bounds.grown(skin)));
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
        skins[2] = vec![until; walls.len()];
        let mut keys = match space {
            Some(space) => {
                let skins = skins[0].iter().chain(&skins[1]).copied();
                let skin = skins.filter(finite).fold(f64::INFINITY, f64::min);
                let largest = extents.iter().map(|(_, radius)| *radius).filter(finite);
                check_fits(space, largest.fold(0.0, f64::max))?;
                let (keys, edges) = pairs_of_images(&things, space, skin);
                self.edges_expire = space.path([1; 3]) + skin / edges;
                keys
            }
            None => body_pairs(&things),
        };
        let own = bodies
            .iter()
            .zip(0..)
            .filter(|(b, _)| b.bend.is_some() && b.is_there);
        keys.extend(own.map(|(_, b)| (Side::Deformable(b), b)));
        let present = bodies.iter().zip(&extents).enumerate();
        for (b, (body, (_, radius))) in present.filter(|(_, (body, _))| body.is_there) {
            let reach = radius * (1.0 + HALF_SKIN) + wall_skin;
            let shapes = context.around.wall_shapes;
            for (w, (motion, wall)) in walls.iter().zip(shapes).enumerate() {
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
        let edge = |i: BodyId| context.shapes[bodies[i as usize].shape as usize].edge();
        self.keep(
            keys,
            |(a, b)| matches!(a, Side::Deformable(i) if edge(i) < edge(b)),
        );
        let [of_soft, of_rigid, of_walls] = skins;
        let until = |(now, skin): (f64, f64)| now + skin;
        let soft = bodies.iter().map(|b| b.travelled);
        self.expires = [
            soft.zip(of_soft).map(until).collect(),
            travels(rigid).zip(of_rigid).map(until).collect(),
            travels(walls).zip(of_walls).map(until).collect(),
        ];
        Ok(true)
    }

    /// Replaces the list by the pairs `keys`, which are sorted; pairs that stay keep their data. `swaps` says of which of the others B
    /// comes first.
    fn keep(&mut self, keys: Vec<(Side, u32)>, swaps: impl Fn((Side, u32)) -> bool) {
        let mut old = std::mem::take(&mut self.list).into_iter().peekable();
        self.list.reserve(keys.len());
        for key in keys {
            while old.next_if(|p| p.key() < key).is_some() {}
            let kept = old.next_if(|p| p.key() == key);
            self.list
                .push(kept.unwrap_or_else(|| SoftPair::new(key, swaps(key))));
        }
        self.note_own();
    }

    /// Notes where the pairs of bodies with themselves are: after a change of the list.
    pub fn note_own(&mut self) {
        self.own.clear();
        for (place, pair) in (0..).zip(&self.list).filter(|(_, pair)| pair.is_own()) {
            let b = pair.b as usize;
            self.own.resize(self.own.len().max(b + 1), None);
            self.own[b] = Some(place);
        }
    }

    /// Measures how far the parts of bodies that may touch themselves have moved towards each other, where that matters.
    pub fn measure_bends(&self, bodies: &mut [SoftBody]) {
        if self.own.is_empty() {
            return;
        }
        on_each(bodies, GRAIN, |i, body| {
            if let Some(&Some(place)) = self.own.get(i)
                && body.sleep != Sleep::Frozen
            {
                body.measure_bend(self.list[place as usize].candidates.clear());
            }
        });
    }

    /// The pairs with rigid bodies, and these.
    pub fn with_rigid(&self) -> impl Iterator<Item = (BodyId, &SoftPair)> {
        // Pairs are sorted, and those with deformable bodies come first.
        let start = self.list.partition_point(|pair| pair.a < Side::Rigid(0));
        self.list[start..].iter().map_while(|pair| match pair.a {
            Side::Rigid(i) => Some((i, pair)),
            Side::Deformable(_) | Side::Wall(_) => None,
        })
    }
}

fn travels(motions: &[Motion]) -> impl ExactSizeIterator<Item = f64> {
    motions.iter().map(|motion| motion.travelled)
}

/// Whether nothing has travelled as far as to where it must be looked for again.
fn stay(travelled: impl ExactSizeIterator<Item = f64>, expires: &[f64]) -> bool {
    travelled.len() == expires.len() && travelled.zip(expires).all(|(now, until)| now < *until)
}

/// Refuses a cell in which a body whose nodes are within `radius` (m) of its centre could meet another one on two sides.
fn check_fits(space: &Space, radius: f64) -> Result<(), ContactError> {
    let edges = space.cell.edges();
    let largest = 2.0 * (1.0 + HALF_SKIN) * radius;
    for axis in (0..3).filter(|&axis| space.cell.repeats(axis)) {
        check(
            "side of a periodic cell over the diameter of the largest deformable body, with a margin for its motion",
            edges[(axis, axis)] / largest,
            edges[(axis, axis)] >= PeriodicCell::LEAST_DIAMETERS * largest,
            "at least 2.25, so that no body meets another one on two sides",
        )?;
    }
    Ok(())
}

/// The same in periodic space, sorted, where edges may move by `skin` (m) in all over the number of edges between two places, which is
/// returned, too.
fn pairs_of_images(
    things: &[(Side, Aabb)],
    space: &Space,
    skin: f64,
) -> (Vec<(Side, BodyId)>, f64) {
    let mut farthest = 0;
    let mut largest = 0.0_f64;
    let mut place = |(side, bounds): &(Side, Aabb)| {
        let (image, _) = space.cell.split(&bounds.center().coords);
        farthest = image.iter().fold(farthest, |most, n| n.abs().max(most));
        let bounds = bounds.grown(0.5 * skin);
        largest = largest.max(0.5 * (bounds.high - bounds.low).norm());
        (*side, shifted(&bounds, &-space.cell.offset(image)))
    };
    let placed: Vec<(Side, Aabb)> = things.iter().map(&mut place).collect();
    let boxes: Vec<Aabb> = placed.iter().map(|(_, bounds)| *bounds).collect();
    let tree = Bvh::new(&boxes);
    let mut keys = Vec::new();
    for (thing, own) in &placed {
        let Side::Deformable(b) = *thing else {
            break;
        };
        space.beside(&own.center().coords, 2.0 * largest, |away| {
            let own = shifted(own, away);
            tree.query(&own, |i| {
                let (other, bounds) = &placed[i as usize];
                let is_partner = match *other {
                    Side::Deformable(a) => a < b,
                    Side::Rigid(_) | Side::Wall(_) => true,
                };
                if is_partner && bounds.overlaps(&own) {
                    keys.push((*other, b));
                }
            });
        });
    }
    keys.sort_unstable();
    keys.dedup();
    (keys, f64::from(2 * farthest + 1))
}

fn shifted(bounds: &Aabb, way: &Vector3) -> Aabb {
    Aabb {
        low: bounds.low + way,
        high: bounds.high + way,
    }
}

/// Pairs with a deformable body of things that are in ascending order, deformable bodies first.
fn body_pairs(things: &[(Side, Aabb)]) -> Vec<(Side, BodyId)> {
    let boxes: Vec<Aabb> = things.iter().map(|(_, bounds)| *bounds).collect();
    let tree = Bvh::new(&boxes);
    let mut keys = Vec::new();
    for (thing, own) in things {
        let Side::Deformable(b) = *thing else {
            break;
        };
        tree.query(own, |i| {
            let (other, bounds) = &things[i as usize];
            let is_partner = match *other {
                Side::Deformable(a) => a < b,
                Side::Rigid(_) | Side::Wall(_) => true,
            };
            if is_partner && bounds.overlaps(own) {
                keys.push((*other, b));
            }
        });
    }
    keys
}
