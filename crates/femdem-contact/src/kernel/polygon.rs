//! Convex polygons in fixed storage: the fast path's cuts.

use super::clip::{Line, Point, crossing};

/// Number of corners that fit; a power of two, so that a mask keeps an index in range.
pub(crate) const MOST: usize = 32;
const MASK: usize = MOST - 1;

/// The polygon does not fit the fixed storage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TooMany;

/// A convex polygon of fewer than [`MOST`] corners, counter-clockwise.
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

impl Polygon {
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    #[inline]
    pub fn corners(&self) -> &[Point] {
        self.corners.get(..self.len).unwrap_or(&[])
    }

    /// Copies the corners; false if there are too many.
    #[inline]
    pub fn load(&mut self, corners: &[Point]) -> bool {
        for (to, p) in self.corners.iter_mut().zip(corners) {
            *to = *p;
        }
        self.len = corners.len();
        self.fits()
    }

    #[inline]
    fn fits(&self) -> bool {
        self.len < MOST
    }

    /// Sets this polygon to the part of another where `by` is at least 0, edge by edge
    /// (Sutherland and Hodgman 1974), so that a line through several corners, whose depths
    /// differ in sign by round-off, loses nothing; false if it has too many corners.
    ///
    /// Every corner is written and kept only if it belongs to the part, so that only the branches at
    /// crossings depend on the data.
    #[inline(always)]
    pub fn set_cut(&mut self, of: &[Point], by: &Line) -> bool {
        let Some(mut p) = of.last() else {
            self.len = 0;
            return true;
        };
        let mut dp = by.at(p);
        let mut len = 0;
        for q in of {
            let dq = by.at(q);
            if (dp >= 0.0) != (dq >= 0.0) {
                self.corners[len & MASK] = crossing(p, q, dp, dq);
                len += 1;
            }
            self.corners[len & MASK] = *q;
            len += usize::from(dq >= 0.0);
            (p, dp) = (q, dq);
        }
        self.len = len;
        self.fits()
    }
}
