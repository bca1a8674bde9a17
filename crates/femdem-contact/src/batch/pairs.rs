//! The pair table: one slot per candidate pair, neighbour lists, and the sorted order of
//! the pairs to evaluate.

use super::history::{History, PatchRecord};
use crate::body_shape::Kind;
use crate::contact::{BodyId, Partner, RigidContact};
use crate::general::GeneralCache;
use crate::kernel::{CavityCache, PairCache};
use crate::walls::LocalSolid;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Neighbour code: bodies by index, walls by index plus this.
const WALL: u32 = 1 << 31;

/// The stored data of a candidate pair. A pair of convex bodies stores its one patch here, others store theirs in the
/// cache. Half of the pairs of a pack do not touch, so the data of a contact is boxed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Pair {
    pub a: Partner,
    pub b: BodyId,
    pub cache: Cache,
    pub touch: Option<Box<Touch>>,
    /// In periodic space: which image of A it is that B meets.
    pub image: [i32; 3],
    /// Contact energy before the last update, J.
    #[serde(skip)]
    pub was: f64,
    /// What a liquid bridge held that has broken in it, J.
    #[serde(skip)]
    pub broken: f64,
}

/// A contact and its history.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Touch {
    pub history: History,
    pub contact: RigidContact,
}

impl Pair {
    /// The contacts on record, by patch.
    pub fn contacts(&self) -> impl Iterator<Item = &RigidContact> {
        let patches: &[PatchRecord] = match &self.cache {
            Cache::Mesh(mesh) => &mesh.patches,
            Cache::Body(_) | Cache::Wall(_) | Cache::Sphere(_) => &[],
        };
        self.touch
            .as_deref()
            .map(|t| &t.contact)
            .into_iter()
            .chain(patches.iter().map(|p| &p.contact))
            .chain(self.bridge().and_then(|bridge| bridge.across_gap.as_ref()))
    }

    /// The liquid bridge of the two.
    pub(super) fn bridge(&self) -> Option<&Bridge> {
        match &self.cache {
            Cache::Sphere(ball) => ball.bridge.as_deref(),
            Cache::Body(_) | Cache::Wall(_) | Cache::Mesh(_) => None,
        }
    }

    /// Begins an update.
    pub fn begin(&mut self) {
        self.was = self.energy();
        self.broken = 0.0;
    }

    /// Contact energy on record, J.
    pub fn energy(&self) -> f64 {
        self.contacts().map(RigidContact::potential).sum()
    }

    /// Whether the two touch, by the contacts on record: a liquid bridge over a gap does not.
    pub fn touches(&self) -> bool {
        let patches = match &self.cache {
            Cache::Mesh(mesh) => !mesh.patches.is_empty(),
            Cache::Body(_) | Cache::Wall(_) | Cache::Sphere(_) => false,
        };
        self.touch.is_some() || patches
    }

    /// As [`contacts`](Self::contacts), without that of a liquid bridge.
    pub fn contacts_mut(&mut self) -> impl Iterator<Item = &mut RigidContact> {
        let patches: &mut [PatchRecord] = match &mut self.cache {
            Cache::Mesh(mesh) => &mut mesh.patches,
            Cache::Body(_) | Cache::Wall(_) | Cache::Sphere(_) => &mut [],
        };
        self.touch
            .as_deref_mut()
            .map(|t| &mut t.contact)
            .into_iter()
            .chain(patches.iter_mut().map(|p| &mut p.contact))
    }

    /// As [`contacts`](Self::contacts).
    pub fn records_mut(&mut self) -> impl Iterator<Item = &mut RigidContact> {
        let mut patches: &mut [PatchRecord] = &mut [];
        let mut bridge = None;
        match &mut self.cache {
            Cache::Mesh(mesh) => patches = &mut mesh.patches,
            Cache::Sphere(ball) => bridge = ball.bridge.as_deref_mut(),
            Cache::Body(_) | Cache::Wall(_) => {}
        }
        let touch = self.touch.as_deref_mut().map(|t| &mut t.contact);
        let across = bridge.and_then(|bridge| bridge.across_gap.as_mut());
        let of_patches = patches.iter_mut().map(|p| &mut p.contact);
        touch.into_iter().chain(of_patches).chain(across)
    }

    /// Whether the cache shows that the two are apart when the sum of their travels is `travelled`, m.
    pub fn is_clear(&self, travelled: f64) -> bool {
        match &self.cache {
            Cache::Body(cache) => cache.is_clear(travelled),
            Cache::Wall(cache) => cache.is_clear(travelled),
            Cache::Sphere(ball) => travelled < ball.clear_until,
            Cache::Mesh(mesh) => mesh.cache.is_clear(travelled),
        }
    }

    /// Drops contacts, friction and a liquid bridge: the two are apart.
    pub fn part(&mut self) {
        self.touch = None;
        match &mut self.cache {
            Cache::Mesh(mesh) => mesh.patches.clear(),
            Cache::Sphere(ball) => ball.bridge = None,
            Cache::Body(_) | Cache::Wall(_) => {}
        }
    }
}

/// The kernel's cache for each kind of pair.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum Cache {
    Body(PairCache),
    Wall(CavityCache),
    /// A sphere with anything but a mesh.
    Sphere(BallPair),
    Mesh(Box<MeshPair>),
}

/// The stored data of a pair of a sphere with anything but a mesh.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct BallPair {
    /// The travel up to which they are apart, without a bridge, m.
    pub clear_until: f64,
    /// The liquid bridge between them.
    pub bridge: Option<Box<Bridge>>,
}

/// A liquid bridge.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Bridge {
    /// What it holds when it breaks, J.
    pub work_of_rupture: f64,
    /// Whether it formed within the last step.
    pub fresh: bool,
    /// The contact of bodies that are apart.
    pub across_gap: Option<RigidContact>,
}

/// The stored data of a pair with a mesh.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct MeshPair {
    pub cache: GeneralCache,
    /// Against a wall of planes: its part near the body.
    pub local: LocalSolid,
    pub patches: Vec<PatchRecord>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Neighbour {
    pub code: u32,
    pub slot: u32,
}

#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct PairTable {
    pub(super) slots: Vec<Pair>,
    pub(super) free: Vec<u32>,
    pub(super) neighbours: Vec<Vec<Neighbour>>,
    pub(super) order: Vec<u32>,
    pub(super) changed: bool,
    kinds: Vec<Kind>,
    /// Whether a body belongs to another batch; none does if the list is too short.
    pub(super) guests: Vec<bool>,
    /// Whether a wall is a mesh.
    mesh_walls: Vec<bool>,
    /// Bodies of pairs that ended since this was last emptied.
    #[serde(skip)]
    pub(super) left: Vec<BodyId>,
    /// What the liquid bridges of these pairs held when they broke, J.
    #[serde(skip)]
    pub(super) broken: f64,
}

impl PairTable {
    /// Notes a body that has no pairs, and its kind.
    pub fn set_body(&mut self, body: usize, kind: Kind) {
        if body == self.neighbours.len() {
            self.neighbours.push(Vec::new());
            self.kinds.push(kind);
        } else {
            self.kinds[body] = kind;
        }
        if let Some(guest) = self.guests.get_mut(body) {
            *guest = false;
        }
        self.changed = true;
    }

    /// Notes a wall that has no pairs, and whether it is a mesh.
    pub fn set_wall(&mut self, wall: usize, is_mesh: bool) {
        if wall == self.mesh_walls.len() {
            self.mesh_walls.push(is_mesh);
        } else {
            self.mesh_walls[wall] = is_mesh;
        }
    }

    /// Ends all pairs of a body.
    pub fn leave(&mut self, body: BodyId) {
        let own = self.neighbours[body as usize].clone();
        self.end(own.into_iter().map(|n| (body, n)).collect());
    }

    /// Drops the contacts of a pair of bodies, the lower number first.
    pub fn part(&mut self, (a, b): (BodyId, BodyId)) {
        let list = &self.neighbours[a as usize];
        if let Ok(at) = list.binary_search_by_key(&b, |n| n.code) {
            let slot = list[at].slot;
            self.slots[slot as usize].part();
        }
    }

    /// Ends all pairs of a wall.
    pub fn leave_wall(&mut self, wall: u32) {
        let code = WALL | wall;
        let of = |(body, list): (u32, &Vec<Neighbour>)| {
            let at = list.binary_search_by_key(&code, |n| n.code).ok()?;
            Some((body, list[at]))
        };
        let own = (0..).zip(&self.neighbours).filter_map(of).collect();
        self.end(own);
    }

    /// Ends pairs between two updates: they are not among the [evaluated](Self::evaluated) ones any more.
    fn end(&mut self, pairs: Vec<(BodyId, Neighbour)>) {
        for (body, neighbour) in &pairs {
            self.unlink(*body, *neighbour);
        }
        let mut ended: Vec<u32> = pairs.into_iter().map(|(_, n)| n.slot).collect();
        ended.sort_unstable();
        self.order.retain(|slot| ended.binary_search(slot).is_err());
    }

    /// Whether any body or wall is a mesh.
    pub fn has_meshes(&self) -> bool {
        self.kinds.contains(&Kind::Mesh) || self.mesh_walls.contains(&true)
    }

    /// Whether a body belongs to another batch.
    pub fn is_guest(&self, body: BodyId) -> bool {
        self.guests.get(body as usize).is_some_and(|guest| *guest)
    }

    /// Replaces the bodies and all pairs.
    pub(super) fn give(&mut self, kinds: Vec<Kind>, guests: Vec<bool>, pairs: Vec<Pair>) {
        self.neighbours = vec![Vec::new(); kinds.len()];
        self.kinds = kinds;
        self.guests = guests;
        self.free.clear();
        self.order.clear();
        self.left.clear();
        for (slot, pair) in (0..).zip(&pairs) {
            let (a, b) = match pair.a {
                Partner::Body(a) => (a, pair.b),
                Partner::Wall(w) => (WALL | w, pair.b),
            };
            self.neighbours[b as usize].push(Neighbour { code: a, slot });
            if a < WALL {
                self.neighbours[a as usize].push(Neighbour { code: b, slot });
            }
        }
        for list in &mut self.neighbours {
            list.sort_unstable_by_key(|n| n.code);
        }
        self.slots = pairs;
        self.changed = true;
    }

    fn is_mesh(&self, code: u32) -> bool {
        if code >= WALL {
            self.mesh_walls[(code & !WALL) as usize]
        } else {
            self.kinds[code as usize] == Kind::Mesh
        }
    }

    fn is_sphere(&self, code: u32) -> bool {
        code < WALL && self.kinds[code as usize] == Kind::Sphere
    }

    /// The kind of a body's shape, if it is there.
    pub fn kind_of(&self, body: usize) -> Option<Kind> {
        self.kinds.get(body).copied()
    }

    /// Number of walls.
    pub fn wall_count(&self) -> usize {
        self.mesh_walls.len()
    }

    /// All pairs, evaluated or not.
    pub fn pairs(&self) -> impl Iterator<Item = &Pair> {
        let free: BTreeSet<u32> = self.free.iter().copied().collect();
        let slots = (0..).zip(&self.slots);
        slots.filter_map(move |(slot, pair)| (!free.contains(&slot)).then_some(pair))
    }

    /// A cache, never used, of the kind that two need.
    fn cache_for(&self, code: u32, body: BodyId) -> Cache {
        if self.is_mesh(body) || self.is_mesh(code) {
            Cache::Mesh(Box::default())
        } else if self.is_sphere(body) || self.is_sphere(code) {
            Cache::Sphere(BallPair::default())
        } else if code >= WALL {
            Cache::Wall(CavityCache::default())
        } else {
            Cache::Body(PairCache::default())
        }
    }

    /// Whether the cache of a pair is of the kind that its sides need.
    pub fn has_its_cache(&self, pair: &Pair) -> bool {
        let code = match pair.a {
            Partner::Body(a) => a,
            Partner::Wall(w) => WALL | w,
        };
        let wanted = self.cache_for(code, pair.b);
        std::mem::discriminant(&wanted) == std::mem::discriminant(&pair.cache)
    }

    /// Whether all slots in the lists are there.
    pub fn indices_fit(&self) -> bool {
        let mut slots = self.free.iter().chain(&self.order);
        slots.all(|&slot| (slot as usize) < self.slots.len())
    }

    /// Whether a neighbour's slot holds its pair with `body`.
    pub fn is_pair_of(&self, body: BodyId, neighbour: &Neighbour) -> bool {
        let code = neighbour.code;
        let wanted = if code >= WALL {
            (Partner::Wall(code & !WALL), body)
        } else {
            (Partner::Body(body.min(code)), body.max(code))
        };
        let pair = self.slots.get(neighbour.slot as usize);
        pair.is_some_and(|pair| (pair.a, pair.b) == wanted && body != code)
    }

    pub fn mark_changed(&mut self) {
        self.changed = true;
    }

    /// Makes the bodies of `list` (sorted) the body neighbours of `body`.
    pub fn set_neighbours(&mut self, body: BodyId, list: &[u32]) {
        let old: Vec<Neighbour> = self.neighbours[body as usize]
            .iter()
            .copied()
            .filter(|n| n.code < WALL)
            .collect();
        self.replace(body, &old, list);
    }

    /// Makes the walls of `list` (sorted) the wall neighbours of `body`.
    pub fn set_walls(&mut self, body: BodyId, list: &[u32]) {
        let old: Vec<Neighbour> = self.neighbours[body as usize]
            .iter()
            .copied()
            .filter(|n| n.code >= WALL)
            .collect();
        let codes: Vec<u32> = list.iter().map(|w| WALL | w).collect();
        self.replace(body, &old, &codes);
    }

    fn replace(&mut self, body: BodyId, old: &[Neighbour], codes: &[u32]) {
        for n in old {
            if codes.binary_search(&n.code).is_err() {
                self.unlink(body, *n);
            }
        }
        for &code in codes {
            if old.binary_search_by_key(&code, |n| n.code).is_err() {
                self.link(body, code);
            }
        }
    }

    fn link(&mut self, body: BodyId, code: u32) {
        let (a, b) = if code >= WALL {
            (Partner::Wall(code & !WALL), body)
        } else {
            (Partner::Body(body.min(code)), body.max(code))
        };
        let pair = Pair {
            a,
            b,
            cache: self.cache_for(code, body),
            touch: None,
            image: [0; 3],
            was: 0.0,
            broken: 0.0,
        };
        let slot = if let Some(slot) = self.free.pop() {
            self.slots[slot as usize] = pair;
            slot
        } else {
            reserve_one(&mut self.slots);
            self.slots.push(pair);
            self.slots.len() as u32 - 1
        };
        self.insert(body, Neighbour { code, slot });
        if code < WALL {
            self.insert(code, Neighbour { code: body, slot });
        }
        self.changed = true;
    }

    fn insert(&mut self, body: BodyId, neighbour: Neighbour) {
        let list = &mut self.neighbours[body as usize];
        if let Err(at) = list.binary_search_by_key(&neighbour.code, |n| n.code) {
            list.insert(at, neighbour);
        }
    }

    fn unlink(&mut self, body: BodyId, neighbour: Neighbour) {
        self.neighbours[body as usize].retain(|n| n.code != neighbour.code);
        self.left.push(body);
        if neighbour.code < WALL {
            self.neighbours[neighbour.code as usize].retain(|n| n.code != body);
            self.left.push(neighbour.code);
        }
        let is_booked = !self.is_guest(self.slots[neighbour.slot as usize].b);
        let pair = &mut self.slots[neighbour.slot as usize];
        if is_booked {
            self.broken += pair.bridge().map_or(0.0, |bridge| bridge.work_of_rupture);
        }
        pair.part();
        self.free.push(neighbour.slot);
        self.changed = true;
    }

    /// Rebuilds the list of pairs with an awake body, and with one that is no guest, sorted by (a, b), walls last.
    pub fn refresh_order(&mut self, awake: &[bool], awake_list: &[BodyId]) {
        if !self.changed {
            return;
        }
        self.changed = false;
        let mut keyed: Vec<(u64, u32)> = Vec::with_capacity(self.order.len());
        for &i in awake_list {
            for n in &self.neighbours[i as usize] {
                let j = n.code;
                let other_lists_it = j < WALL && awake[j as usize] && j < i;
                let is_own = !self.is_guest(i) || (j < WALL && !self.is_guest(j));
                if is_own && !other_lists_it {
                    let (first, second) = if j < WALL {
                        (i.min(j), i.max(j))
                    } else {
                        (i, j)
                    };
                    keyed.push((u64::from(first) << 32 | u64::from(second), n.slot));
                }
            }
        }
        keyed.sort_unstable();
        self.order.clear();
        self.order.extend(keyed.iter().map(|k| k.1));
        self.lay_out();
    }

    pub fn order(&self) -> &[u32] {
        &self.order
    }

    pub fn order_len(&self) -> usize {
        self.order.len()
    }

    pub fn slot(&self, slot: u32) -> &Pair {
        &self.slots[slot as usize]
    }

    pub fn slot_mut(&mut self, slot: u32) -> &mut Pair {
        &mut self.slots[slot as usize]
    }

    /// The pairs in the given slots, which must be ascending.
    #[cfg(feature = "parallel")]
    pub fn slots_mut(&mut self, ascending: &[u32]) -> Vec<&mut Pair> {
        let mut rest = self.slots.as_mut_slice();
        let mut passed = 0;
        let mut list = Vec::with_capacity(ascending.len());
        for &slot in ascending {
            let skip = (slot as usize).saturating_sub(passed).min(rest.len());
            let Some((pair, after)) = rest.split_at_mut(skip).1.split_first_mut() else {
                break;
            };
            list.push(pair);
            passed += skip + 1;
            rest = after;
        }
        list
    }

    /// The pairs of the last update, in order.
    pub fn evaluated(&self) -> impl Iterator<Item = &Pair> {
        self.order.iter().map(|&slot| self.slot(slot))
    }

    pub fn contacts(&self) -> Vec<&RigidContact> {
        self.all().flat_map(Pair::contacts).collect()
    }

    /// All pairs, sorted by A and B: those with walls come last of a body.
    pub fn all(&self) -> impl Iterator<Item = &Pair> {
        let lists = (0..).zip(&self.neighbours);
        lists.flat_map(|(i, list)| {
            let own = list.iter().filter(move |n| n.code > i);
            own.map(|n| self.slot(n.slot))
        })
    }

    /// The pairs that a body is in.
    pub fn of(&self, body: BodyId) -> impl Iterator<Item = &Pair> {
        let list = self.neighbours.get(body as usize);
        list.into_iter().flatten().map(|n| self.slot(n.slot))
    }

    /// The pair of two sides, if it is a candidate.
    pub fn between_mut(&mut self, a: Partner, b: BodyId) -> Option<&mut Pair> {
        let list = self.neighbours.get(b as usize)?;
        let is_it = |n: &&Neighbour| self.slot(n.slot).a == a && self.slot(n.slot).b == b;
        let slot = list.iter().find(is_it)?.slot;
        Some(self.slot_mut(slot))
    }

    pub fn contacts_of(&self, body: BodyId) -> impl Iterator<Item = &RigidContact> {
        self.of(body).flat_map(Pair::contacts)
    }
}

/// Reserves room for one more entry in a list that may be long: grows by an eighth instead of doubling.
fn reserve_one<T>(list: &mut Vec<T>) {
    if list.len() == list.capacity() {
        list.reserve_exact(list.len() / 8 + 16);
    }
}
