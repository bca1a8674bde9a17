//! The depths of the contacts of all ranks.

use std::cmp::Reverse;

use femdem_contact::Partner;
use femdem_solve::{Halo, SolveError};
use serde::{Deserialize, Serialize};

use super::Simulation;
use super::contacts::Side;
use crate::gather::of_all;

/// Steps between looks.
pub(super) const EVERY: u64 = 16;

/// A run warns of overlaps above this share of the thickness of the smaller body.
const DEEP: f64 = 0.1;

/// A run warns of overlaps above this share of the least extent of a deformable body.
const SOFT: f64 = 0.05;

/// A depth of two sides, bodies by their numbers in the whole.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Depth {
    pub sides: [Partner; 2],
    /// m.
    pub depth: f64,
}

/// A contact that is deep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Deep {
    pub at: Depth,
    pub of: Beside,
}

/// Beside what it is deep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum Beside {
    /// That of the thinner rigid body \[m\], with the penalty of the contact \[Pa\].
    Thickness(f64, f64),
    /// The least extent of a deformable body \[m\].
    Extent(f64),
}

/// What there is to record of the depths of the contacts of all ranks.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Depths {
    /// The deepest, if it is deeper than all before.
    pub deepest: Option<Depth>,
    /// The first that is deep, if there was none before.
    pub deep: Option<Deep>,
}

impl Depths {
    /// Those of this and of another rank.
    fn join(&mut self, other: Self) {
        let rank = |own: &Depth| (own.depth, Reverse(own.sides));
        if let Some(depth) = other.deepest
            && self
                .deepest
                .as_ref()
                .is_none_or(|own| rank(&depth) > rank(own))
        {
            self.deepest = Some(depth);
        }
        let is_later = |own: &Deep, deep: &Deep| own.at.sides > deep.at.sides;
        if let Some(deep) = other.deep
            && self.deep.as_ref().is_none_or(|own| is_later(own, &deep))
        {
            self.deep = Some(deep);
        }
    }
}

impl Simulation {
    /// What there is to record of the contacts of all ranks, of which this has those of one, if `most` is the deepest before \[m\],
    /// and if one was deep already. The first rank says so.
    pub(super) fn depths(
        &self,
        most: f64,
        warned: bool,
        halo: &mut dyn Halo,
    ) -> Result<Depths, SolveError> {
        let world = &self.world;
        let is_new = |volume: f64, area: f64| volume > most * area;
        let mut rigid = world.rigid_contacts().into_iter();
        let mut soft = world.deformable_contacts();
        let news =
            rigid.any(|c| is_new(c.volume, c.area)) || soft.any(|c| is_new(c.volume, c.area));
        let mut news = [u64::from(news)];
        halo.sum(&mut news)?;
        let due = !warned && world.steps().is_multiple_of(EVERY);
        let mut found = Depths::default();
        if news[0] == 0 && !due {
            return Ok(found);
        }
        for contact in self.own_contacts() {
            let depth = self.depth_of(&contact);
            let sides = [contact.a, Side::Member(contact.b)];
            let here = || Depth {
                sides: sides.map(|side| self.in_whole(side)),
                depth,
            };
            if depth > found.deepest.as_ref().map_or(most, |own| own.depth) {
                found.deepest = Some(here());
            }
            if warned || found.deep.is_some() {
                continue;
            }
            let of = match self.thickness_of(sides) {
                Some(thickness) => (depth > DEEP * thickness)
                    .then(|| Beside::Thickness(thickness, self.penalty_between(sides))),
                None => self.softness(sides, depth).map(Beside::Extent),
            };
            found.deep = of.map(|of| Deep { at: here(), of });
        }
        let mut all = of_all(vec![found], halo)?.into_iter();
        let first = all.next().unwrap_or_default();
        Ok(all.fold(first, |mut joined, other| {
            joined.join(other);
            joined
        }))
    }

    /// A side, a body by its number in the whole.
    fn in_whole(&self, side: Side) -> Partner {
        match side {
            Side::Member(member) => {
                let id = self.members[member].id;
                let number = self.world.number_in_whole(id);
                debug_assert!(number.is_some(), "contacts are of bodies of the world");
                Partner::Body(number.unwrap_or(id))
            }
            Side::Wall(wall) => Partner::Wall(wall as u32),
        }
    }

    /// The name of a side.
    pub(super) fn name_of_partner(&self, side: Partner) -> String {
        match side {
            Partner::Body(body) => self.name_of_body(body),
            Partner::Wall(wall) => self.name_of(Side::Wall(wall as usize)),
        }
    }

    /// Thickness of the thinner of the rigid bodies of a contact \[m\]; `None` with a deformable one, whose depth is its own
    /// affair.
    fn thickness_of(&self, sides: [Side; 2]) -> Option<f64> {
        let mut least = f64::INFINITY;
        for side in sides {
            let Side::Member(member) = side else { continue };
            let shape = self.world.shape_of(self.members[member].id)?;
            least = least.min(2.0 * self.world.field_depth(shape)?);
        }
        Some(least)
    }

    /// The least extent of a deformable body of a contact \[m\], if the contact is deep beside it, so that it is the contact that
    /// gives way.
    fn softness(&self, sides: [Side; 2], depth: f64) -> Option<f64> {
        let extents = sides.into_iter().filter_map(|side| {
            let Side::Member(member) = side else {
                return None;
            };
            let body = self.world.deformable(self.members[member].id)?;
            let positions = body.positions();
            let first = positions.first()?;
            let each = positions.iter();
            let (low, high) =
                each.fold((*first, *first), |(low, high), x| (low.inf(x), high.sup(x)));
            Some((high - low).min())
        });
        let least = extents.fold(f64::INFINITY, f64::min);
        (depth > SOFT * least).then_some(least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whichever of two ranks comes first.
    #[test]
    fn the_deepest_and_the_first_deep_contact_are_those_of_all_ranks() {
        let at = |a, b, depth| Depth {
            sides: [Partner::Body(a), Partner::Body(b)],
            depth,
        };
        let of_rank = |deepest, deep| Depths {
            deepest: Some(deepest),
            deep: Some(Deep {
                at: deep,
                of: Beside::Extent(1.0),
            }),
        };
        let parts = [
            of_rank(at(5, 6, 2.0), at(3, 9, 1.0)),
            of_rank(at(4, 8, 2.0), at(3, 7, 0.5)),
            of_rank(at(1, 2, 1.0), at(4, 5, 3.0)),
        ];
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            let mut all = Depths::default();
            for k in order {
                all.join(parts[k].clone());
            }
            let sides = |depth: &Depth| depth.sides;
            let deepest = all.deepest.as_ref().map(sides);
            assert_eq!(deepest, Some([Partner::Body(4), Partner::Body(8)]));
            let deep = all.deep.as_ref().map(|deep| sides(&deep.at));
            assert_eq!(deep, Some([Partner::Body(3), Partner::Body(7)]));
        }
    }
}
