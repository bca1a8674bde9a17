//! The fast path: facets cut by the few planes that a plan names, in fixed storage.
//!
//! The general path (`side`, `field`, `cells`) is its oracle, and takes over where a polygon
//! has more corners than the storage holds.

use super::cells::PlaneSums;
use super::clip::{Cut, Line, Point};
use super::field::TIE;
use super::plan::{FacetPlan, Reach};
use super::plane::FieldPlane;
use super::polygon::{Polygon, TooMany};
use super::skin::{SideSums, Skin};
use super::trail::Trail;
use crate::shape::PlaneFrame;
use femdem_mesh::Vector3;

/// Where the main plane's field exceeds this, the general path takes over.
const DEEP: f64 = 0.9;

const MOST_LINES: usize = 64;
const LINE: usize = MOST_LINES - 1;

/// Fields of the planes on the present facet, as three arrays. (Numbers written one by one and read back as a
/// vector stall the processor.)
#[derive(Debug)]
struct Lines {
    a: [f64; MOST_LINES],
    b: [f64; MOST_LINES],
    c: [f64; MOST_LINES],
}

impl Default for Lines {
    fn default() -> Self {
        Self {
            a: [0.0; MOST_LINES],
            b: [0.0; MOST_LINES],
            c: [0.0; MOST_LINES],
        }
    }
}

impl Lines {
    #[inline]
    fn set(&mut self, k: usize, line: &Line) {
        self.a[k & LINE] = line.a;
        self.b[k & LINE] = line.b;
        self.c[k & LINE] = line.c;
    }

    #[inline]
    fn get(&self, k: usize) -> Line {
        Line {
            a: self.a[k & LINE],
            b: self.b[k & LINE],
            c: self.c[k & LINE],
        }
    }
}

/// Buffers of the fast path.
#[derive(Debug, Default)]
pub(crate) struct Fast {
    lines: Lines,
    polygon: Box<Polygon>,
    spare: Box<Polygon>,
    cell: Box<Polygon>,
    /// What the cuts of the present contact did the last time.
    pub trail: Trail,
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
        let normal = &skin.shape.planes[usize::from(facet.plane)].normal;
        let (frame, reach) = (&facet.frame, plan.reach());
        if self.cut_corners(skin.shape.polygon(facet), frame, field, reach.cut)? == Cut::Empty {
            return Ok(());
        }
        let from = skin.origin - frame.origin;
        let origin = Point {
            x: from.dot(&frame.e1),
            y: from.dot(&frame.e2),
        };
        self.place(frame, field, &reach);
        let mut q = PlaneSums::default();
        self.sum_cells(&reach, field, normal, &origin, &mut q)?;
        let lever = skin.lever(frame, normal);
        sums.add_sums(&q, frame, normal, -from.dot(normal), lever);
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
        if !self.polygon.load(corners) {
            return Err(TooMany);
        }
        for k in bits(set) {
            let line = field.get(k).ok_or(TooMany)?.on(frame);
            self.lines.set(k, &line);
            if self.cut(&line)? == Cut::Empty {
                return Ok(Cut::Empty);
            }
        }
        Ok(Cut::Part)
    }

    /// Cuts the present polygon.
    #[inline]
    pub(crate) fn cut(&mut self, by: &Line) -> Result<Cut, TooMany> {
        let outcome = self.trail.next();
        let cut = self.spare.set_cut(&self.polygon, by, outcome)?;
        if cut == Cut::Part {
            std::mem::swap(&mut self.polygon, &mut self.spare);
        }
        Ok(cut)
    }

    /// Expresses the fields of the owners on the plane of a facet; the cutting planes already have theirs.
    #[inline]
    pub(crate) fn place(&mut self, frame: &PlaneFrame, field: &[FieldPlane], reach: &Reach) {
        for k in bits(reach.own & !reach.cut) {
            if let Some(plane) = field.get(k) {
                self.lines.set(k, &plane.on(frame));
            }
        }
    }

    /// Adds to `sums` the integrals of the lowest field of the owners, placed, over the present
    /// polygon with unit normal `n`.
    /// One plane is first taken as the owner of the whole polygon. The difference of each other plane, in its
    /// own cell, is then added. Cells are mostly narrow strips along cut edges, so the plane that is lowest
    /// in the middle needs the fewest and smallest corrections.
    #[inline]
    pub(crate) fn sum_cells(
        &mut self,
        reach: &Reach,
        field: &[FieldPlane],
        n: &Vector3,
        origin: &Point,
        sums: &mut PlaneSums,
    ) -> Result<(), TooMany> {
        let weight = |k: usize| field.get(k).map_or(0.0, |plane| plane.weight(n));
        let main = usize::from(reach.main);
        let (line, main_weight) = (self.lines.get(main), weight(main));
        let corners = self.polygon.corners();
        // Behind the field's centre the main plane is no owner of anything.
        if corners.iter().any(|p| line.at(p) > DEEP) {
            return Err(TooMany);
        }
        sums.add_cell(corners, origin, &line, main_weight);
        let others = reach.own & !(1 << (reach.main & LINE as u8));
        for k in bits(others) {
            let excess = self.lines.get(k).minus(&line);
            if self.cut_cell(k, others, &excess)? {
                let lines = [&self.lines.get(k), &line];
                sums.correct(self.cell.corners(), origin, lines, weight(k) - main_weight);
            }
        }
        Ok(())
    }

    /// Cuts out the part of the polygon where plane `k` is below the main owner, `excess` =
    /// phi_k - phi_main, and below the `others`; false if there is none. Of two planes that
    /// are equal to round-off, the first takes all.
    #[inline]
    fn cut_cell(&mut self, k: usize, others: u64, excess: &Line) -> Result<bool, TooMany> {
        let mut below = excess.flipped();
        below.c -= TIE;
        match self
            .cell
            .set_cut(&self.polygon, &below, self.trail.next())?
        {
            Cut::Empty => return Ok(false),
            Cut::Whole => self.cell.clone_from(&self.polygon),
            Cut::Part => {}
        }
        let line = self.lines.get(k);
        for j in bits(others & !(1 << k)) {
            let mut below = self.lines.get(j).minus(&line);
            below.c += if j < k { -TIE } else { TIE };
            match self.spare.set_cut(&self.cell, &below, self.trail.next())? {
                Cut::Empty => return Ok(false),
                Cut::Whole => {}
                Cut::Part => std::mem::swap(&mut self.cell, &mut self.spare),
            }
        }
        Ok(true)
    }
}
