//! The fast path: facets cut by the few planes that a plan names, in fixed storage.
//!
//! The general path (`side`, `field`, `cells`) is its oracle, and takes over where a polygon
//! has more corners than the storage holds.

use super::cells::PlaneSums;
use super::clip::{Cut, Line, Point, integrate};
use super::field::TIE;
use super::plan::FacetPlan;
use super::polygon::{MOST, Polygon};
use super::side::{FieldPlane, SideSums, Skin};
use crate::shape::PlaneFrame;
use femdem_mesh::Vector3;

const MOST_LINES: usize = 64;
const LINE: usize = MOST_LINES - 1;

/// The polygon does not fit the fixed storage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TooMany;

/// A convex piece of the polygon and the plane that is lowest on it so far.
#[derive(Debug, Default)]
struct Piece {
    polygon: Box<Polygon>,
    owner: usize,
}

/// Buffers of the fast path.
#[derive(Debug)]
pub(crate) struct Fast {
    /// Fields of the planes on the present facet.
    lines: [Line; MOST_LINES],
    polygon: Box<Polygon>,
    spare: Box<Polygon>,
    pieces: Vec<Piece>,
}

impl Default for Fast {
    fn default() -> Self {
        Self {
            lines: [Line::default(); MOST_LINES],
            polygon: Box::default(),
            spare: Box::default(),
            pieces: Vec::new(),
        }
    }
}

/// The numbers of the bits set, lowest first.
#[inline]
fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let k = set.trailing_zeros() as usize;
            set &= set - 1;
            k
        })
    })
}

impl Fast {
    /// Adds up one facet of the skin inside the field.
    #[inline]
    pub(crate) fn add_facet(
        &mut self,
        skin: &Skin,
        plan: &FacetPlan,
        field: &[FieldPlane],
        sums: &mut SideSums,
    ) -> Result<(), TooMany> {
        let facet = &skin.shape.facets[usize::from(plan.facet)];
        let frame = &facet.frame;
        if self.cut_corners(skin.shape.polygon(facet), frame, field, plan.cut)? == Cut::Empty {
            return Ok(());
        }
        let normal = &skin.shape.planes[usize::from(facet.plane)].normal;
        let from = skin.region.centre - frame.origin;
        let origin = Point {
            x: from.dot(&frame.e1),
            y: from.dot(&frame.e2),
        };
        self.place(frame, field, plan.own & !plan.cut);
        let q = self.sum_cells(plan.own, field, normal, &origin)?;
        sums.add_sums(&q, frame, normal, -from.dot(normal));
        sums.lever += normal.dot(&(frame.origin - skin.field_centre)) * q.polygon.pressure;
        Ok(())
    }

    /// Cuts a polygon of the plane of `frame` by the planes in `set`, which are placed.
    #[inline]
    pub(crate) fn cut_corners(
        &mut self,
        corners: &[Point],
        frame: &PlaneFrame,
        field: &[FieldPlane],
        set: u64,
    ) -> Result<Cut, TooMany> {
        let mut whole = true;
        for k in bits(set) {
            let Some(plane) = field.get(k) else { continue };
            let line = plane.on(frame);
            self.lines[k & LINE] = line;
            let from = if whole { corners } else { self.polygon.corners() };
            match self.spare.set_cut(from, &line).ok_or(TooMany)? {
                Cut::Empty => return Ok(Cut::Empty),
                Cut::Whole => {}
                Cut::Part => {
                    std::mem::swap(&mut self.polygon, &mut self.spare);
                    whole = false;
                }
            }
        }
        if whole && !self.polygon.load(corners) {
            return Err(TooMany);
        }
        Ok(Cut::Part)
    }

    /// Cuts the present polygon.
    #[inline]
    pub(crate) fn cut(&mut self, by: &Line) -> Result<Cut, TooMany> {
        let cut = self.spare.set_cut(self.polygon.corners(), by);
        if cut == Some(Cut::Part) {
            std::mem::swap(&mut self.polygon, &mut self.spare);
        }
        cut.ok_or(TooMany)
    }

    /// Expresses the fields of the planes in `set` on the plane of a facet.
    #[inline]
    pub(crate) fn place(&mut self, frame: &PlaneFrame, field: &[FieldPlane], set: u64) {
        for k in bits(set) {
            if let Some(plane) = field.get(k) {
                self.lines[k & LINE] = plane.on(frame);
            }
        }
    }

    #[inline]
    fn line(&self, k: usize) -> Line {
        self.lines[k & LINE]
    }

    /// Integrals of the lowest field in `own`, placed, over the present polygon with unit
    /// normal `n`.
    #[inline]
    pub(crate) fn sum_cells(
        &mut self,
        own: u64,
        field: &[FieldPlane],
        n: &Vector3,
        origin: &Point,
    ) -> Result<PlaneSums, TooMany> {
        let mut sums = PlaneSums::default();
        let weight = |k: usize| field.get(k).map_or(0.0, |plane| plane.weight(n));
        let winners = if own & own.wrapping_sub(1) == 0 {
            own
        } else {
            self.winners(own)
        };
        let owner = winners.trailing_zeros() as usize;
        if winners & winners.wrapping_sub(1) == 0 {
            let q = integrate(self.polygon.corners(), origin, &self.line(owner));
            sums.add(&q, weight(owner));
            return Ok(sums);
        }
        self.provide(0);
        std::mem::swap(&mut self.pieces[0].polygon, &mut self.polygon);
        self.pieces[0].owner = owner;
        let mut used = 1;
        // The planes that surely own something first: the others then mostly own nothing.
        for k in bits(winners & !(1 << owner)).chain(bits(own & !winners)) {
            for i in 0..used {
                used += usize::from(self.split(i, k, used)?);
            }
        }
        for piece in &self.pieces[..used] {
            let q = integrate(piece.polygon.corners(), origin, &self.line(piece.owner));
            sums.add(&q, weight(piece.owner));
        }
        Ok(sums)
    }

    /// The planes of `own` that are lowest at a corner of the polygon.
    #[inline]
    fn winners(&self, own: u64) -> u64 {
        let mut lowest = [(f64::INFINITY, 0_u64); MOST];
        let corners = self.polygon.corners();
        for k in bits(own) {
            let line = self.line(k);
            for (p, low) in corners.iter().zip(&mut lowest) {
                let v = line.at(p);
                if v < low.0 {
                    *low = (v, 1 << k);
                }
            }
        }
        let found = corners.iter().zip(&lowest);
        found.fold(0, |set, (_, low)| set | low.1)
    }

    /// Makes sure that piece `i` exists.
    #[inline]
    fn provide(&mut self, i: usize) {
        if self.pieces.len() <= i {
            self.pieces.resize_with(i + 1, Piece::default);
        }
    }

    /// Gives plane `k` the part of piece `i` where it is lower than the owner; true if
    /// that made a new piece, number `used`.
    #[inline]
    fn split(&mut self, i: usize, k: usize, used: usize) -> Result<bool, TooMany> {
        let piece = &self.pieces[i];
        let above = self.line(k).minus(&self.line(piece.owner));
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in piece.polygon.corners() {
            let d = above.at(p);
            low = if d < low { d } else { low };
            high = if d > high { d } else { high };
        }
        if low >= -TIE {
            return Ok(false);
        }
        if high <= TIE {
            self.pieces[i].owner = k;
            return Ok(false);
        }
        self.provide(used);
        let [old, new] = self
            .pieces
            .get_disjoint_mut([i, used])
            .map_err(|_| TooMany)?;
        let corners = old.polygon.corners();
        new.polygon
            .set_cut(corners, &above.flipped())
            .ok_or(TooMany)?;
        new.owner = k;
        self.spare.set_cut(corners, &above).ok_or(TooMany)?;
        std::mem::swap(&mut old.polygon, &mut self.spare);
        Ok(true)
    }
}
