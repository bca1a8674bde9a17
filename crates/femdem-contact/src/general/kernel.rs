//! The general kernel.

use super::assemble::assemble;
use super::cache::{GeneralCache, Placed};
use super::mesh::FieldMesh;
use super::patch::{Patch, connect};
use super::pieces::{Record, integrate};
use super::sums::Sums;
use super::wall::SolidWall;
use crate::error::{ContactError, check_pressure};
use crate::shape::Frame;
use crate::tets::cells::Cells;
use crate::tets::piece::Piece;
use crate::tets::pieces::{distance, intersect};
use crate::tets::posed::{Posed, PosedList};
use serde::{Deserialize, Serialize};

/// Buffers that the general kernel reuses from call to call.
#[derive(Debug, Default)]
pub struct GeneralScratch {
    patches: Vec<Patch>,
    in_a: PosedList,
    in_b: PosedList,
    piece: Piece,
    candidates: usize,
    pieces: Vec<Record>,
    root: Vec<u32>,
    sums: Vec<([u32; 2], Sums)>,
}

/// The penalty law of meshed bodies of any shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GeneralKernel {
    #[serde(deserialize_with = "crate::error::read_penalty")]
    penalty: f64,
}

impl GeneralKernel {
    /// A kernel with penalty `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the penalty is between 1e-100 and 1e100 Pa.
    pub fn new(penalty: f64) -> Result<Self, ContactError> {
        check_pressure("penalty", penalty)?;
        Ok(Self { penalty })
    }

    /// The penalty, Pa.
    pub fn penalty(&self) -> f64 {
        self.penalty
    }

    /// The contact of A and B: one patch for each connected part of the overlap, none if they are
    /// apart.
    pub fn evaluate<'s>(
        &self,
        a: &FieldMesh,
        frame_a: &Frame,
        b: &FieldMesh,
        frame_b: &Frame,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let mut cache = GeneralCache::default();
        self.evaluate_cached(a, frame_a, b, frame_b, &mut cache, 0.0, scratch)
    }

    /// As [`evaluate`](Self::evaluate), with a cache carried from call to call.
    ///
    /// `motion` is a running upper bound of the distance that any point of A or of B has
    /// travelled (the sum of both), m. It must not decrease between calls with the same cache.
    #[expect(
        clippy::too_many_arguments,
        reason = "two bodies, each shape and frame"
    )]
    pub fn evaluate_cached<'s>(
        &self,
        a: &FieldMesh,
        frame_a: &Frame,
        b: &FieldMesh,
        frame_b: &Frame,
        cache: &mut GeneralCache,
        motion: f64,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let pair = Pair {
            a: &a.cells,
            b: &b.cells,
            length: a.inradius().max(b.inradius()),
            connected: a.is_convex() && b.is_convex(),
            factor: 1.0,
        };
        self.run(&pair, frame_a, frame_b, cache, motion, scratch)
    }

    /// The contact of a wall (A) with a body (B): U = 2 p int phi_B dV over the part of B in the
    /// wall, so that a face lies on a wall as stiffly as on an equal face.
    pub fn evaluate_wall<'s>(
        &self,
        wall: &SolidWall,
        frame_wall: &Frame,
        body: &FieldMesh,
        frame_body: &Frame,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let mut cache = GeneralCache::default();
        self.evaluate_wall_cached(wall, frame_wall, body, frame_body, &mut cache, 0.0, scratch)
    }

    /// As [`evaluate_wall`](Self::evaluate_wall), with a cache and the motion bound of
    /// [`evaluate_cached`](Self::evaluate_cached).
    #[expect(
        clippy::too_many_arguments,
        reason = "two bodies, each shape and frame"
    )]
    pub fn evaluate_wall_cached<'s>(
        &self,
        wall: &SolidWall,
        frame_wall: &Frame,
        body: &FieldMesh,
        frame_body: &Frame,
        cache: &mut GeneralCache,
        motion: f64,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let pair = Pair {
            a: &wall.cells,
            b: &body.cells,
            length: body.inradius(),
            connected: false,
            factor: 2.0,
        };
        self.run(&pair, frame_wall, frame_body, cache, motion, scratch)
    }

    fn run<'s>(
        &self,
        pair: &Pair,
        frame_a: &Frame,
        frame_b: &Frame,
        cache: &mut GeneralCache,
        motion: f64,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        scratch.patches.clear();
        scratch.pieces.clear();
        scratch.candidates = 0;
        if cache.is_clear(motion) {
            return &scratch.patches;
        }
        let between = frame_b.position - frame_a.position;
        let placed = Placed {
            a: pair.a,
            b: pair.b,
            rotation: frame_a.rotation.tr_mul(&frame_b.rotation),
            offset: frame_a.rotation.tr_mul(&between),
            scale: pair.length,
        };
        let motion = cache.advance(&placed, motion);
        let Some(near) = cache.candidates(&placed, motion) else {
            return &scratch.patches;
        };
        let centre = near.centre;
        scratch.in_a.reset(near.in_a.len());
        scratch.in_b.reset(near.in_b.len());
        let mut clear = f64::INFINITY;
        for candidate in &mut near.pairs {
            if motion >= candidate.clear {
                let [i, j] = candidate.places;
                let (Some(&tet_a), Some(&tet_b)) =
                    (near.in_a.get(i as usize), near.in_b.get(j as usize))
                else {
                    continue;
                };
                let pose_a = |room: &mut Posed| {
                    *room = placed.pose_a(tet_a, &centre)?;
                    Some(())
                };
                let pose_b = |room: &mut Posed| {
                    *room = placed.pose_b(tet_b, &centre)?;
                    Some(())
                };
                let (Some(a), Some(b)) = (scratch.in_a.get(i, pose_a), scratch.in_b.get(j, pose_b))
                else {
                    continue;
                };
                scratch.candidates += 1;
                match intersect(a, b, &mut scratch.piece) {
                    None => candidate.clear = motion + distance(a, b),
                    Some(flush) => {
                        let sums = integrate(a, b, flush, &mut scratch.piece);
                        scratch.pieces.extend(sums.map(|(faces, sums)| Record {
                            pair: [tet_a, tet_b],
                            faces,
                            sums,
                        }));
                    }
                }
            }
            clear = clear.min(candidate.clear);
        }
        cache.set_clear(clear);
        scratch.gather(pair);
        let size = 2.0 * pair.b.radius;
        let penalty = self.penalty * pair.factor;
        for (key, sums) in &scratch.sums {
            let overlap = assemble(sums, penalty, &centre, &frame_a.rotation, &between, size);
            scratch
                .patches
                .extend(overlap.map(|overlap| Patch { overlap, key: *key }));
        }
        &scratch.patches
    }
}

/// Two solids.
struct Pair<'a> {
    a: &'a Cells,
    b: &'a Cells,
    /// The larger of the lengths over which their fields rise.
    length: f64,
    /// The overlap is one patch.
    connected: bool,
    /// 2 for walls.
    factor: f64,
}

impl GeneralScratch {
    /// Numbers of pairs of tetrahedra that the last evaluation tested, and of those that overlap.
    pub fn counts(&self) -> [usize; 2] {
        [self.candidates, self.pieces.len()]
    }

    /// Sums over the pieces of each patch, in the order of the patches' first pairs.
    fn gather(&mut self, pair: &Pair) {
        self.sums.clear();
        if pair.connected {
            if let Some(first) = self.pieces.first() {
                let mut total = Sums::default();
                for piece in &self.pieces {
                    total += &piece.sums;
                }
                self.sums.push((first.pair, total));
            }
            return;
        }
        connect(&self.pieces, pair.a, pair.b, &mut self.root);
        for (n, piece) in self.pieces.iter().enumerate() {
            let first = self.pieces[self.root[n] as usize].pair;
            match self.sums.binary_search_by_key(&first, |s| s.0) {
                Ok(place) => self.sums[place].1 += &piece.sums,
                Err(place) => self.sums.insert(place, (first, piece.sums)),
            }
        }
    }
}
