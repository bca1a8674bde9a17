//! Candidate pairs of bodies, and the stored data of each.

use super::body::{GRAIN, SoftBody};
use super::each::on_each;
use super::pair::SoftPair;
use super::state::Sleep;
use crate::contact::BodyId;
use crate::deform::side::Side;
use serde::{Deserialize, Serialize};

/// The sides of a pair.
pub(super) type Key = (Side, BodyId);

/// Candidate pairs, sorted.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct PairList {
    list: Vec<SoftPair>,
    /// By number, the place of the pair of a body with itself.
    #[serde(skip)]
    own: Vec<Option<u32>>,
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
    }

    /// Takes all pairs off the list.
    pub fn take(&mut self) -> Vec<SoftPair> {
        self.own.clear();
        std::mem::take(&mut self.list)
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
    }

    /// Makes `found`, sorted, the pairs of those for which `is_due` holds; `swaps` says of which of the new ones B comes first.
    /// Returns whether that changes the list.
    pub fn renew(
        &mut self,
        found: Vec<Key>,
        is_due: impl Fn(&Key) -> bool,
        swaps: impl Fn(Key) -> bool,
    ) -> bool {
        let present = self.list.iter().map(SoftPair::key);
        if present.filter(&is_due).eq(found.iter().copied()) {
            return false;
        }
        let stay = self.list.iter().map(SoftPair::key);
        let mut keys: Vec<Key> = stay.filter(|key| !is_due(key)).collect();
        keys.extend(found);
        keys.sort_unstable();
        self.keep(keys, swaps);
        true
    }

    /// Replaces the list by the pairs `keys`, which are sorted; pairs that stay keep their data.
    fn keep(&mut self, keys: Vec<Key>, swaps: impl Fn(Key) -> bool) {
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
