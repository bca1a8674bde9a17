//! Convex polygons in fixed storage: the fast path's cuts and splits.
//!
//! A cut of a convex polygon keeps one run of its corners between two crossings. The run is
//! found from the signs of all corners held as bits. Where round-off makes more than one
//! run, the cut goes corner by corner instead, so that nothing is lost.

use super::clip::{Cut, Line, Point, crossing, crossing_of};

/// Corners a polygon can hold; a power of two, so that an index is kept in range by a mask.
pub(crate) const MOST: usize = 32;
const MASK: usize = MOST - 1;

/// A convex polygon of at most [`MOST`] corners, counter-clockwise.
#[derive(Debug, Clone)]
pub(crate) struct Polygon {
    len: usize,
    corners: [Point; MOST],
}

impl Default for Polygon {
    fn default() -> Self {
        Self {
            len: 0,
            corners: [Point::default(); MOST],
        }
    }
}

/// Signs of a linear function at the corners of a polygon, a bit for each.
#[derive(Clone, Copy)]
struct Signs {
    inside: u64,
    all: u64,
}

impl Signs {
    #[inline]
    fn new(corners: &[Point], by: &Line) -> Self {
        let (mut inside, mut bit) = (0, 1);
        for p in corners {
            inside |= if by.at(p) >= 0.0 { bit } else { 0 };
            bit <<= 1;
        }
        Self {
            inside,
            all: bit - 1,
        }
    }

    /// First and last corner of the one run inside; `None` if there are several.
    #[inline]
    fn run(&self, len: usize) -> Option<[usize; 2]> {
        let set = self.inside;
        let before = (set << 1 | set >> (len - 1)) & self.all;
        let after = set >> 1 | (set & 1) << (len - 1);
        let (starts, ends) = (set & !before, set & !after);
        (starts & (starts - 1) == 0).then(|| {
            [
                starts.trailing_zeros() as usize,
                ends.trailing_zeros() as usize,
            ]
        })
    }
}

impl Polygon {
    #[inline]
    pub fn corners(&self) -> &[Point] {
        self.corners.get(..self.len).unwrap_or(&[])
    }

    /// Takes a copy of the corners; false if they are too many.
    #[inline]
    pub fn load(&mut self, corners: &[Point]) -> bool {
        self.len = 0;
        for &p in corners {
            self.push(p);
        }
        self.fits()
    }

    /// Adds a corner; one too many is counted but not kept.
    #[inline]
    fn push(&mut self, p: Point) {
        self.corners[self.len & MASK] = p;
        self.len += 1;
    }

    #[inline]
    fn fits(&self) -> bool {
        self.len <= MOST
    }

    /// Sets this polygon to the part of another where `by` is at least 0. If that is all or
    /// nothing of it, this one is left as it was. `None`: too many corners.
    #[inline(always)]
    pub fn set_cut(&mut self, of: &[Point], by: &Line) -> Option<Cut> {
        if of.len() > MOST {
            return None;
        }
        let signs = Signs::new(of, by);
        if signs.inside == signs.all {
            return Some(Cut::Whole);
        }
        if signs.inside == 0 {
            return Some(Cut::Empty);
        }
        self.set_part(of, by.a, by.b, by.c, signs)
            .then_some(Cut::Part)
    }

    /// As [`set_cut`](Self::set_cut), if there are corners on both sides; false: too many.
    ///
    /// The line comes in three numbers, so that they stay in registers: read back as a
    /// vector right after they were written one by one, they would have to wait.
    #[inline(never)]
    fn set_part(&mut self, of: &[Point], a: f64, b: f64, c: f64, signs: Signs) -> bool {
        let by = &Line { a, b, c };
        if let Some([first, last]) = signs.run(of.len()) {
            self.set_run(of, by, first, last);
        } else {
            self.set_corner_by_corner(of, by);
        }
        self.fits()
    }

    /// Corners `first` to `last` of a polygon, between the crossings at either end.
    #[inline]
    fn set_run(&mut self, of: &[Point], by: &Line, first: usize, last: usize) {
        let n = of.len();
        let before = of[if first == 0 { n - 1 } else { first - 1 }];
        let after = of[if last + 1 == n { 0 } else { last + 1 }];
        let mut p = of[first];
        let mut i = first;
        self.len = 0;
        self.push(crossing(&p, &before, by.at(&p), by.at(&before)));
        while i != last {
            self.push(p);
            i = if i + 1 == n { 0 } else { i + 1 };
            p = of[i];
        }
        self.push(p);
        self.push(crossing(&p, &after, by.at(&p), by.at(&after)));
    }

    /// Edge by edge (Sutherland and Hodgman 1974).
    #[cold]
    fn set_corner_by_corner(&mut self, of: &[Point], by: &Line) {
        self.len = 0;
        let Some(mut p) = of.last() else {
            return;
        };
        let mut dp = by.at(p);
        for q in of {
            let dq = by.at(q);
            if (dq >= 0.0) != (dp >= 0.0) {
                self.push(crossing_of(p, q, dp, dq));
            }
            if dq >= 0.0 {
                self.push(*q);
            }
            (p, dp) = (q, dq);
        }
    }
}
