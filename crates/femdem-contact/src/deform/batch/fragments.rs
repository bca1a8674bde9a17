//! Bodies that fall into parts.

use super::DeformablePart;
use super::bend::Bend;
use super::pair::SoftPair;
use super::reshape::Renumbering;
use crate::contact::BodyId;
use crate::deform::bristle::{Anchor, Bristle};
use crate::deform::shape::DeformableShape;
use crate::deform::side::Side;
use crate::error::ContactError;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A part into which a deformable body falls.
#[derive(Debug, Clone)]
pub struct FragmentShape {
    /// Its shape, of the tetrahedra `tets` of the body's mesh in that order: see
    /// [`DeformableShape::cracked`](crate::deform::DeformableShape::cracked).
    pub shape: Arc<DeformableShape>,
    /// Numbers of its tetrahedra in the body's mesh.
    pub tets: Vec<u32>,
}

impl DeformablePart {
    /// Refuses parts that are not all of a body, and a body whose shape is another's too.
    pub fn check_parts(&self, body: BodyId, parts: &[FragmentShape]) -> Result<(), ContactError> {
        let index = self.bodies[body as usize].shape;
        let shape = &self.shapes[index as usize];
        let wrong = |what, index, count| Err(ContactError::NoSuch { what, index, count });
        if self.has_another(body, index) {
            let count = self.shapes.len();
            return wrong("shape of this deformable body alone", index as usize, count);
        }
        let count = shape.wholes().len();
        let mut all: Vec<u32> = parts.iter().flat_map(|part| &part.tets).copied().collect();
        all.sort_unstable();
        if let Some(missing) = (0..count).find(|t| all.get(*t) != Some(&(*t as u32))) {
            return wrong("one part with each tetrahedron of the body", missing, count);
        }
        let fits = |part: &FragmentShape| part.shape.wholes().len() == part.tets.len();
        if all.len() > count || !parts.iter().all(fits) {
            return wrong("tetrahedra in the shapes of the parts", all.len(), count);
        }
        Ok(())
    }

    /// Makes bodies `ids`, of which the first is there, of the parts of the first: see
    /// [`ContactBatch::fragment_deformable`](crate::ContactBatch::fragment_deformable).
    pub fn part(&mut self, ids: &[BodyId], parts: Vec<FragmentShape>) {
        let Some(&body) = ids.first() else {
            return;
        };
        let whole = &self.bodies[body as usize];
        let (index, touches_itself) = (whole.shape, whole.bend.is_some());
        let old = Arc::clone(&self.shapes[index as usize]);
        let modulus = whole.modulus.kept(old.inradius());
        // By tetrahedron of the whole, its part and its number there.
        let mut places = vec![None; old.wholes().len()];
        for (part, own) in parts.iter().enumerate() {
            for (t, number) in own.tets.iter().zip(0..) {
                places[*t as usize] = Some((part, number));
            }
        }
        self.stir_around(Side::Deformable(body));
        let pairs = self.pairs.take_of(body);
        let mut shapes = Vec::with_capacity(parts.len());
        for (number, (id, part)) in ids.iter().zip(parts).enumerate() {
            shapes.push(Arc::clone(&part.shape));
            let index = match number {
                0 => index,
                _ => self.add_shape(Arc::clone(&part.shape)),
            };
            self.shapes[index as usize] = part.shape;
            self.count -= usize::from(number == 0);
            self.add_body(*id, index, modulus);
            let new = &mut self.bodies[*id as usize];
            new.bend = touches_itself.then(Bend::default);
        }
        let numbered: Vec<_> = shapes
            .iter()
            .enumerate()
            .map(|(part, shape)| {
                let places = &places;
                let of_whole = move |t: u32| {
                    let place: Option<(usize, u32)> = *places.get(t as usize)?;
                    place.filter(|(own, _)| *own == part).map(|(_, t)| t)
                };
                Renumbering::new(&old, shape, of_whole)
            })
            .collect();
        let part_of = |bristle: &Bristle, side: usize| match bristle.anchors[side] {
            Anchor::Tet(t, _) => {
                let (whole, _) = old.parent(t)?;
                Some((*places.get(whole as usize)?)?.0)
            }
            Anchor::Point(_) => None,
        };
        let mut found: BTreeMap<(Side, BodyId), SoftPair> = BTreeMap::new();
        for pair in pairs {
            // By parts on both sides of the evaluation; one that is `None` is not of the body.
            let mut groups: BTreeMap<[Option<usize>; 2], Vec<Bristle>> = BTreeMap::new();
            let (first, second) = pair.sides();
            let own = [first, Side::Deformable(second)].map(|s| s == Side::Deformable(body));
            for bristle in pair.outcome.bristles {
                let parts = [0, 1].map(|side| own[side].then(|| part_of(&bristle, side)));
                if parts.iter().all(|part| *part != Some(None)) {
                    let key = parts.map(Option::flatten);
                    groups.entry(key).or_default().push(bristle);
                }
            }
            for (parts, mut bristles) in groups {
                for (side, part) in parts.iter().enumerate() {
                    if let Some(part) = part {
                        numbered[*part].apply(&mut bristles, side);
                    }
                }
                let first = parts[0].map_or(first, |part| Side::Deformable(ids[part]));
                let second = parts[1].map_or(second, |part| ids[part]);
                let mut new = SoftPair::between(first, second);
                new.outcome.bristles = bristles;
                // Springs of two bodies are on the skin of one of them: that which has more. The others end.
                let count = |pair: &SoftPair| pair.outcome.bristles.len();
                if found
                    .get(&new.key())
                    .is_none_or(|other| count(other) < count(&new))
                {
                    found.insert(new.key(), new);
                }
            }
        }
        self.pairs.add(found.into_values());
    }
}
