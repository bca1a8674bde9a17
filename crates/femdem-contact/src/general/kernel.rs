//! The general kernel.

use super::assemble::{assemble, vector_area};
use super::cache::{GeneralCache, Near, Placed};
use super::mesh::FieldMesh;
use super::patch::{Groups, Patch, Record};
use super::pieces::integrate;
use super::skins::Walk;
use super::sums::Sums;
use super::wall::SolidWall;
use crate::error::{ContactError, check_pressure};
use crate::kernel::WALL_FACTOR;
use crate::shape::Frame;
use crate::tets::cells::Cells;
use crate::tets::current::Current;
use crate::tets::piece::Piece;
use crate::tets::pieces::{distance, intersect};
use crate::tets::posed::{Posed, PosedList};
use serde::{Deserialize, Serialize};

/// Buffers that the general kernel reuses from call to call.
#[derive(Debug, Default)]
pub struct GeneralScratch {
    patches: Vec<Patch>,
    tets: [PosedList<Current>; 2],
    /// The same with planes, for pieces.
    planes: [PosedList<Posed>; 2],
    piece: Piece,
    counts: [usize; 2],
    records: Vec<Record>,
    groups: Groups,
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
        Ok(Self::of(penalty))
    }

    /// With a penalty that was checked.
    pub(crate) fn of(penalty: f64) -> Self {
        Self { penalty }
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
        let pair = Pair::bodies([a, b], [frame_a, frame_b]);
        self.run(Way::Skins, &pair, cache, motion, scratch)
    }

    /// As [`evaluate`](Self::evaluate), with sums over the common parts of tetrahedra only: slower, and an oracle, as
    /// it shares no arithmetic with sums over skins.
    pub fn evaluate_pieces<'s>(
        &self,
        a: &FieldMesh,
        frame_a: &Frame,
        b: &FieldMesh,
        frame_b: &Frame,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let pair = Pair::bodies([a, b], [frame_a, frame_b]);
        self.run(
            Way::Pieces,
            &pair,
            &mut GeneralCache::default(),
            0.0,
            scratch,
        )
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
        let pair = Pair::wall(wall, body, [frame_wall, frame_body]);
        self.run(Way::Skins, &pair, cache, motion, scratch)
    }

    /// As [`evaluate_wall`](Self::evaluate_wall), by the sums of [`evaluate_pieces`](Self::evaluate_pieces).
    pub fn evaluate_wall_pieces<'s>(
        &self,
        wall: &SolidWall,
        frame_wall: &Frame,
        body: &FieldMesh,
        frame_body: &Frame,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        let pair = Pair::wall(wall, body, [frame_wall, frame_body]);
        self.run(
            Way::Pieces,
            &pair,
            &mut GeneralCache::default(),
            0.0,
            scratch,
        )
    }

    fn run<'s>(
        &self,
        way: Way,
        pair: &Pair,
        cache: &mut GeneralCache,
        motion: f64,
        scratch: &'s mut GeneralScratch,
    ) -> &'s [Patch] {
        scratch.patches.clear();
        scratch.reset();
        if cache.is_clear(motion) {
            return &scratch.patches;
        }
        let [frame_a, frame_b] = pair.frames;
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
        let found = match way {
            Way::Skins => scratch.by_skins(pair, &placed, near, motion),
            Way::Pieces => None,
        };
        let clear = found.unwrap_or_else(|| scratch.by_pieces(pair, &placed, near, motion));
        let centre = near.centre;
        cache.set_clear(clear);
        let size = 2.0 * pair.b.radius;
        let penalty = self.penalty * pair.factor;
        for (key, sums) in &scratch.sums {
            let overlap = assemble(sums, penalty, &centre, &frame_a.rotation, &between, size);
            scratch.patches.extend(overlap.map(|overlap| Patch {
                overlap,
                key: *key,
                touching: vector_area(sums, &centre, &frame_a.rotation, &between),
            }));
        }
        &scratch.patches
    }
}

/// A small body around a node of a large one is the small difference of what the node and the skins contribute: below this
/// part of the first, too many digits are lost.
const CANCELLED: f64 = 0.01;

/// How the sums of a pair are formed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Over skins, unless round-off would decide.
    Skins,
    /// Over common parts of tetrahedra.
    Pieces,
}

/// Two solids and where they are.
struct Pair<'a> {
    a: &'a Cells,
    b: &'a Cells,
    frames: [&'a Frame; 2],
    /// The larger of the lengths over which their fields rise.
    length: f64,
    /// The overlap is one patch.
    connected: bool,
    /// On the penalty: that of walls, which have no field.
    factor: f64,
}

impl<'a> Pair<'a> {
    fn bodies([a, b]: [&'a FieldMesh; 2], frames: [&'a Frame; 2]) -> Self {
        Self {
            a: &a.cells,
            b: &b.cells,
            frames,
            length: a.inradius().max(b.inradius()),
            connected: a.is_convex() && b.is_convex(),
            factor: 1.0,
        }
    }

    fn wall(wall: &'a SolidWall, body: &'a FieldMesh, frames: [&'a Frame; 2]) -> Self {
        Self {
            a: &wall.cells,
            b: &body.cells,
            frames,
            length: body.inradius(),
            connected: false,
            factor: WALL_FACTOR,
        }
    }
}

impl GeneralScratch {
    /// Numbers of pairs of tetrahedra that the last evaluation tested, and of those in which the skin of one lies in
    /// the other (in sums over common parts: of those that overlap).
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    fn reset(&mut self) {
        self.records.clear();
        self.counts = [0; 2];
    }

    /// Sums over skins of all patches. Returns up to which motion nothing touches; `None` if round-off would decide, or if
    /// the skins do not tell the patches.
    fn by_skins(
        &mut self,
        pair: &Pair,
        placed: &Placed,
        near: &mut Near,
        motion: f64,
    ) -> Option<f64> {
        self.reset();
        for (list, tets) in self.tets.iter_mut().zip(&near.tets) {
            list.reset(tets.len());
        }
        let walk = Walk {
            placed,
            near,
            motion,
            tets: &mut self.tets,
            records: &mut self.records,
            is_one: pair.connected,
            counts: &mut self.counts,
        };
        let (clear, sunken) = walk.run()?;
        self.gather(pair);
        match (sunken, self.sums.as_mut_slice()) {
            (None, [] | [_]) => Some(clear),
            (None, several) => {
                let outer = several.iter().all(|(_, sums)| sums.is_outer());
                let whole = || self.groups.are_whole(&self.records, [pair.a, pair.b]);
                (outer && whole()).then_some(clear)
            }
            (Some([energy, volume]), [(_, sums)]) => {
                sums.energy += energy;
                sums.volume += volume;
                let has_digits =
                    sums.energy >= CANCELLED * energy && sums.volume >= CANCELLED * volume;
                has_digits.then_some(clear)
            }
            // To which patch the nodes belong is not known.
            _ => None,
        }
    }

    /// Sums over common parts of all patches. Returns up to which motion nothing touches.
    fn by_pieces(&mut self, pair: &Pair, placed: &Placed, near: &mut Near, motion: f64) -> f64 {
        self.reset();
        for (list, tets) in self.planes.iter_mut().zip(&near.tets) {
            list.reset(tets.len());
        }
        let mut clear = f64::INFINITY;
        let [list_a, list_b] = &mut self.planes;
        for candidate in near.pairs.iter_mut().chain(&mut near.inside) {
            if motion >= candidate.clear {
                let [i, j] = candidate.places;
                let (Some(&tet_a), Some(&tet_b)) =
                    (near.tets[0].get(i as usize), near.tets[1].get(j as usize))
                else {
                    continue;
                };
                let pose = |side: usize, tet: u32, room: &mut Posed| {
                    let mut posed = Current::default();
                    placed.pose(side, tet, &near.centre, &mut posed)?;
                    *room = posed.planes();
                    Some(())
                };
                let (Some(a), Some(b)) = (
                    list_a.get(i, |room| pose(0, tet_a, room)),
                    list_b.get(j, |room| pose(1, tet_b, room)),
                ) else {
                    continue;
                };
                self.counts[0] += 1;
                match intersect(a, b, &mut self.piece) {
                    None => candidate.clear = motion + distance(a, b),
                    Some(flush) => {
                        let record = integrate(a, b, flush, &mut self.piece);
                        self.records.extend(record.map(|record| Record {
                            pair: [tet_a, tet_b],
                            ..record
                        }));
                    }
                }
            }
            clear = clear.min(candidate.clear);
        }
        self.counts[1] = self.records.len();
        self.records.sort_unstable_by_key(|record| record.pair);
        self.gather(pair);
        clear
    }

    /// Sums of each patch, in the order of their keys.
    fn gather(&mut self, pair: &Pair) {
        self.sums.clear();
        if pair.connected {
            let key = self.records.iter().find(|record| record.has_skin);
            if let Some(first) = key.or(self.records.first()) {
                let mut total = Sums::default();
                for record in &self.records {
                    total += &record.sums;
                }
                self.sums.push((first.pair, total));
            }
            return;
        }
        self.groups.connect(&self.records, [pair.a, pair.b]);
        // By root first.
        for (n, record) in self.records.iter().enumerate() {
            let first = self.records[self.groups.root[n] as usize].pair;
            match self.sums.binary_search_by_key(&first, |s| s.0) {
                Ok(place) => self.sums[place].1 += &record.sums,
                Err(place) => self.sums.insert(place, (first, record.sums)),
            }
        }
        if self.records.iter().all(|record| record.has_skin) {
            return;
        }
        for (key, _) in &mut self.sums {
            let root = self.records.binary_search_by_key(key, |record| record.pair);
            let mut members = self.records.iter().zip(&self.groups.root);
            let first = members.find(|(record, of)| record.has_skin && Ok(**of as usize) == root);
            if let Some((record, _)) = first {
                *key = record.pair;
            }
        }
        self.sums.sort_unstable_by_key(|(key, _)| *key);
    }
}
