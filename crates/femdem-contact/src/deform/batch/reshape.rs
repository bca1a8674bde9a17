//! Bodies whose skin changes because they crack.

use super::DeformablePart;
use super::body::SoftBody;
use crate::contact::BodyId;
use crate::deform::bristle::{Anchor, Bristle};
use crate::deform::near::Candidates;
use crate::deform::shape::DeformableShape;
use crate::deform::side::Side;
use std::sync::Arc;

impl DeformablePart {
    /// Whether a body other than `body` has a shape.
    pub fn has_another(&self, body: BodyId, shape: u32) -> bool {
        let has =
            |(other, i): (&SoftBody, BodyId)| i != body && other.is_there && other.shape == shape;
        self.bodies.iter().zip(0..).any(has)
    }

    /// Gives a body the shape of number `index`, which is replaced by `cracked` if that is given: see
    /// [`ContactBatch::crack_deformable`](crate::ContactBatch::crack_deformable).
    pub fn crack(&mut self, body: BodyId, index: u32, cracked: Option<Arc<DeformableShape>>) {
        let old = self.bodies[body as usize].shape;
        let old = Arc::clone(&self.shapes[old as usize]);
        if let Some(cracked) = cracked {
            self.shapes[index as usize] = cracked;
        }
        let new = Arc::clone(&self.shapes[index as usize]);
        let of_body = &mut self.bodies[body as usize];
        of_body.shape = index;
        // The pressure at a depth stays, though the depth of the field may not.
        of_body.modulus = of_body.modulus.kept(old.inradius());
        of_body.sleep.stir();
        if Arc::ptr_eq(&old, &new) {
            return;
        }
        of_body.crack(&new);
        let renumbering = Renumbering::new(&old, &new, Some);
        for pair in self.pairs.list_mut() {
            for (side, own) in [pair.a, Side::Deformable(pair.b)].into_iter().enumerate() {
                if own == Side::Deformable(body) {
                    let of_kernel = if pair.swapped { 1 - side } else { side };
                    pair.candidates = Candidates::default();
                    pair.outcome.nodes[side].clear();
                    renumbering.apply(&mut pair.outcome.bristles, of_kernel);
                }
            }
        }
    }
}

impl SoftBody {
    fn crack(&mut self, shape: &DeformableShape) {
        self.displaced();
        if shape.is_in_pieces() {
            // Dashpots then know the mass of the touching nodes only.
            self.frequency = 0.0;
        }
        let reach = self.reach;
        self.restore(shape);
        self.reach = reach;
    }
}

/// What becomes of tetrahedra and triangles.
pub(super) struct Renumbering<'a, M> {
    old: &'a DeformableShape,
    new: &'a DeformableShape,
    /// The number of a tetrahedron of the old mesh in the new one, if it is of it.
    of_whole: M,
    /// By triangle of the old skin, that of the new one.
    triangles: Vec<Option<u32>>,
}

impl<'a, M: Fn(u32) -> Option<u32>> Renumbering<'a, M> {
    pub fn new(old: &'a DeformableShape, new: &'a DeformableShape, of_whole: M) -> Self {
        let mut triangles = vec![None; old.skin().len()];
        for (tet, i) in old.tets().iter().zip(0..) {
            for k in (0..4).filter(|k| tet.skin & (1 << k) != 0) {
                // The face of a part that lies in the skin is that of the whole opposite the same corner.
                let whole = old.parent(i).and_then(|(parent, _)| of_whole(parent));
                let child = whole.and_then(|whole| new.child(whole));
                let place = child.map(|(first, split)| first + if split { k } else { 0 });
                let now = place.and_then(|place| new.tets().get(place as usize));
                triangles[tet.triangles[k as usize] as usize] = now
                    .filter(|now| now.skin & (1 << k) != 0)
                    .map(|now| now.triangles[k as usize]);
            }
        }
        Self {
            old,
            new,
            of_whole,
            triangles,
        }
    }

    /// Numbers springs anew on a side of their evaluation, and takes those off the list that are not on the new skin.
    pub fn apply(&self, bristles: &mut Vec<Bristle>, of_kernel: usize) {
        bristles.retain_mut(|bristle| {
            if let Anchor::Tet(tet, weights) = bristle.anchors[of_kernel] {
                let Some(anchor) = self.anchor(tet, weights) else {
                    return false;
                };
                bristle.anchors[of_kernel] = anchor;
            }
            if of_kernel == 1 {
                let Some(triangle) = self.triangles[bristle.triangle as usize] else {
                    return false;
                };
                bristle.triangle = triangle;
            }
            true
        });
        bristles.sort_by_key(|bristle| bristle.triangle);
    }

    /// The same point of the material.
    fn anchor(&self, tet: u32, weights: [f64; 4]) -> Option<Anchor> {
        let (parent, part) = self.old.parent(tet)?;
        // In a part, the centroid stands for corner k, which is a quarter of each.
        let whole = part.map_or(weights, |k| {
            let centre = weights[usize::from(k)] / 4.0;
            let mut whole = weights.map(|w| w + centre);
            whole[usize::from(k)] = centre;
            whole
        });
        let (first, is_split) = self.new.child((self.of_whole)(parent)?)?;
        if !is_split {
            return Some(Anchor::Tet(first, whole));
        }
        // The part opposite the corner that has least of the point: it lies in it.
        let least = (0..4).fold(0, |k, i| if whole[i] < whole[k] { i } else { k });
        let mut inside = whole.map(|w| w - whole[least]);
        inside[least] = 4.0 * whole[least];
        Some(Anchor::Tet(first + least as u32, inside))
    }
}
