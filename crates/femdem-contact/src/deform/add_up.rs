//! The sums of a pair: over skins where these suffice, else over pieces.

use super::folds::Folds;
use super::itself::Itself;
use super::near::{Candidates, Failure, Near, Sides};
use super::operand::Operand;
use super::scratch::DeformableScratch;
use super::skins::SkinScratch;
use super::sums::{PairSums, Place, Triangles};
use super::walk::{Meet, Walk};
use crate::tets::piece::Piece;
use crate::tets::pieces::intersect;
use crate::tets::posed::{Posed, PosedList};
use crate::tets::row::{Lanes, Plain};
use crate::tets::skins::Met;

/// How the sums of a pair are formed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// Over skins, unless round-off would decide.
    Skins,
    /// Over common parts of tetrahedra.
    Pieces,
    /// The same of a body with itself: both sides are that body.
    Itself,
}

/// Computes the sums of the pair in the scratch and returns whether there is an overlap. `pressures`: of the
/// fields of A and B, Pa. `motion` is the running bound of the distance that any point of A or B has travelled
/// (the sum of both), m.
pub(crate) fn run(
    sides: &Sides,
    pressures: [f64; 2],
    way: Way,
    candidates: &mut Candidates,
    motion: f64,
    scratch: &mut DeformableScratch,
) -> Result<bool, Failure> {
    scratch.candidates = 0;
    scratch.sums.reset([0, 0]);
    if candidates.is_clear(motion) {
        return Ok(false);
    }
    let near = match way {
        Way::Itself if candidates.is_expired(motion) => {
            let folds = Folds::new(sides, candidates.near());
            candidates.renewed(&folds, motion)?
        }
        _ => candidates.renewed(sides, motion)?,
    };
    let Some(near) = near else {
        return Ok(false);
    };
    let found = match way {
        Way::Skins => by_skins(sides, pressures, near, motion, scratch, false)?,
        Way::Pieces | Way::Itself => None,
    };
    let clear = match (found, way, sides.operands[1]) {
        (Some(clear), ..) => clear,
        (None, Way::Itself, Operand::Deformable(shape, x)) => Itself {
            shape,
            x,
            pressures,
        }
        .sum(near, motion, scratch),
        (None, ..) => by_pieces(sides, pressures, near, motion, scratch)?,
    };
    for (side, members) in near.sides.iter().enumerate() {
        scratch.sums.fold(side, &members.slaves);
    }
    candidates.set_clear(clear);
    Ok(scratch.sums.energy > 0.0)
}

/// Sums over the skins of either body in the other: see [`skins`](super::skins). Returns up to which motion
/// no candidates touch; `None` if the sums must be computed over pieces. `plain`: without processor-specific
/// instructions.
fn by_skins(
    sides: &Sides,
    pressures: [f64; 2],
    near: &mut Near,
    motion: f64,
    scratch: &mut DeformableScratch,
    plain: bool,
) -> Result<Option<f64>, Failure> {
    let DeformableScratch {
        tets,
        sums,
        skins,
        candidates,
        ..
    } = scratch;
    sums.reset(near.node_counts());
    skins.reset(near.tet_counts());
    let walk = Walk {
        sides,
        pressures,
        near,
        motion,
        tets,
        candidates,
    };
    let task = &mut SkinsOf { sums, skins };
    let clear = if plain {
        walk.all(Plain, task)?
    } else {
        walk.all_at_once(task)?
    };
    if clear.is_some() {
        sums.close_skins(skins, |side, place| {
            Some(Place {
                tet: tets[side].known(place)?,
                place,
                nodes: near.sides[side].corners.get(place as usize),
            })
        });
    }
    Ok(clear)
}

/// Sums over the common parts of tetrahedra. Returns up to which motion no candidates touch.
fn by_pieces(
    sides: &Sides,
    pressures: [f64; 2],
    near: &mut Near,
    motion: f64,
    scratch: &mut DeformableScratch,
) -> Result<f64, Failure> {
    let DeformableScratch {
        tets,
        planes,
        piece,
        sums,
        candidates,
        ..
    } = scratch;
    sums.reset(near.node_counts());
    for (list, count) in planes.iter_mut().zip(near.tet_counts()) {
        list.reset(count);
    }
    let walk = Walk {
        sides,
        pressures,
        near,
        motion,
        tets,
        candidates,
    };
    let task = &mut PiecesOf {
        planes,
        piece,
        sums,
    };
    Ok(walk.all(Plain, task)?.unwrap_or(motion))
}

struct SkinsOf<'a> {
    sums: &'a mut PairSums,
    skins: &'a mut SkinScratch,
}

impl Meet for SkinsOf<'_> {
    #[inline(always)]
    fn meet(&mut self, lanes: impl Lanes, places: &[Place; 2], triangles: &Triangles) -> Met {
        self.sums.add_skins(lanes, places, triangles, self.skins)
    }
}

struct PiecesOf<'a> {
    planes: &'a mut [PosedList<Posed>; 2],
    piece: &'a mut Piece,
    sums: &'a mut PairSums,
}

impl Meet for PiecesOf<'_> {
    fn meet(&mut self, _: impl Lanes, places: &[Place; 2], triangles: &Triangles) -> Met {
        let [planes_a, planes_b] = &mut *self.planes;
        let planes_of = |place: &Place, room: &mut Posed| {
            *room = place.tet.planes();
            Some(())
        };
        let (Some(a), Some(b)) = (
            planes_a.get(places[0].place, |room| planes_of(&places[0], room)),
            planes_b.get(places[1].place, |room| planes_of(&places[1], room)),
        ) else {
            return Met::Inside;
        };
        match intersect(a, b, self.piece) {
            None => Met::Apart,
            Some(flush) => {
                self.sums.add(*places, [a, b], triangles, flush, self.piece);
                Met::Skins
            }
        }
    }
}

impl Near {
    fn node_counts(&self) -> [usize; 2] {
        [0, 1].map(|side| self.sides[side].nodes.len())
    }

    fn tet_counts(&self) -> [usize; 2] {
        [0, 1].map(|side| self.sides[side].tets.len())
    }
}

#[cfg(test)]
mod tests {
    use super::super::near::Tree;
    use super::super::operand::Operand;
    use super::super::shape::DeformableShape;
    use super::*;
    use femdem_mesh::catalogue::{CatalogueShape, Solid};
    use femdem_mesh::{TetMesh, Vector3};

    /// The sums of two dodecahedra over skins, by plain instructions or the best that there are.
    fn sums(plain: bool) -> PairSums {
        let solid = CatalogueShape::from(Solid::P4).polyhedron(1.0).unwrap();
        let mesh = TetMesh::centroid_fan(&solid).unwrap();
        let shape = DeformableShape::new(&mesh).unwrap();
        let at =
            |by: Vector3| -> Vec<Vector3> { mesh.points().iter().map(|p| p.coords + by).collect() };
        let places = [at(Vector3::zeros()), at(Vector3::new(0.4, 0.31, 0.23))];
        let operands = [0, 1].map(|k| Operand::Deformable(&shape, &places[k]));
        let own = operands.map(|operand| {
            let mut boxes = Vec::new();
            operand.boxes(&mut boxes);
            let mut tree = shape.tree().clone();
            tree.refit(&boxes);
            (tree, boxes)
        });
        let trees = [0, 1].map(|k| Tree::here(&own[k].0, &own[k].1));
        let sides = Sides { operands, trees };
        let mut list = Candidates::default();
        let near = list.renewed(&sides, 0.0).unwrap().unwrap();
        let mut scratch = DeformableScratch::default();
        by_skins(&sides, [3.0, 2.0], near, 0.0, &mut scratch, plain)
            .unwrap()
            .unwrap();
        scratch.sums
    }

    #[test]
    fn every_processor_gives_the_same_bits() {
        let (plain, best) = (sums(true), sums(false));
        assert!(plain.pieces > 4 && plain.energy > 0.0);
        assert_eq!(plain.forces, best.forces);
        assert_eq!(plain.stiffness, best.stiffness);
        assert_eq!(plain.loads, best.loads);
        assert_eq!(plain.wrench, best.wrench);
        assert_eq!([plain.energy, plain.volume], [best.energy, best.volume]);
    }
}
