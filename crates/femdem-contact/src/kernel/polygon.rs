//! Convex polygons in fixed storage: the fast path's cuts.

use super::clip::{Cut, Line, Point, crossing};
use super::trail::{Outcome, TOO_LONG, Told};

/// Number of corners that fit; a power of two, so that a mask keeps an index in range.
pub(crate) const MOST: usize = 32;
const MASK: usize = MOST - 1;

/// Corners are copied by as many: those that are not needed cost less than a loop of unknown length.
const BLOCK: usize = 8;

/// Room for the corners and for whole blocks beyond the last.
const ROOM: usize = MOST + 2 * BLOCK;

/// Values of a field (1 at the centre of a body) beyond this are not round-off.
const CERTAIN: f64 = 1e-10;

/// The polygon does not fit the fixed storage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TooMany;

/// A convex polygon of fewer than [`MOST`] corners, counter-clockwise. What is stored beyond the last corner means nothing.
#[derive(Debug, Clone)]
pub(crate) struct Polygon {
    len: usize,
    corners: [Point; ROOM],
}

impl Default for Polygon {
    fn default() -> Self {
        Self {
            len: 0,
            corners: [Point::default(); ROOM],
        }
    }
}

impl Polygon {
    #[inline(always)]
    pub fn corners(&self) -> &[Point] {
        self.corners.get(..self.len).unwrap_or(&[])
    }

    /// Copies the corners; false if there are too many.
    #[inline(always)]
    pub fn load(&mut self, corners: &[Point]) -> bool {
        for (to, p) in self.corners.iter_mut().zip(corners) {
            *to = *p;
        }
        self.len = corners.len().min(MASK);
        corners.len() < MOST
    }

    #[inline(always)]
    fn set(&mut self, i: usize, p: Point) {
        self.corners[i & MASK] = p;
    }

    #[inline(always)]
    fn corner(&self, i: usize) -> &Point {
        &self.corners[i & MASK]
    }

    /// Copies blocks of corners from corner `from` of another, at least up to its last one.
    #[inline(always)]
    fn copy(&mut self, to: usize, of: &Self, from: usize) {
        let (to, from) = (to & MASK, from & MASK);
        for k in 0..BLOCK {
            self.corners[to + k] = of.corners[from + k];
        }
        if of.len > BLOCK {
            for k in BLOCK..2 * BLOCK {
                self.corners[to + k] = of.corners[from + k];
            }
        }
    }

    /// Sets this polygon to the part of another where `by` is at least 0. If all of that is, or nothing, this polygon means
    /// nothing afterwards. `outcome` is what the cut is expected to do, and then what it did.
    #[inline(always)]
    pub fn set_cut(&mut self, of: &Self, by: &Line, outcome: &mut Outcome) -> Result<Cut, TooMany> {
        match self.cut_as_told(of, by, *outcome) {
            Some(cut) => Ok(cut),
            None => self.cut_edge_by_edge(of, by, outcome),
        }
    }

    /// The cut, if it certainly does what is expected.
    ///
    /// Along the corners of a convex polygon a linear function rises and falls once. Hence its signs at the ends of two
    /// crossed edges determine all others, and a corner above (below) both of its neighbours is above (below) all. Signs
    /// within round-off would determine nothing: on both sides of the line one end must be farther from it.
    #[inline(always)]
    fn cut_as_told(&mut self, of: &Self, by: &Line, outcome: Outcome) -> Option<Cut> {
        let n = of.len;
        if n >= TOO_LONG {
            return None;
        }
        let at = |i: usize| by.at(of.corner(i));
        let before = |i: usize| if i == 0 { n - 1 } else { i - 1 };
        let wrapped = |i: usize| if i >= n { i - n } else { i };
        match outcome.told() {
            Told::Part { from, count } if from < n && count < n => {
                let ends = [before(from), from, wrapped(from + count - 1)];
                let [inner, first, last] = ends;
                let next = wrapped(from + count);
                let [d_inner, d_first, d_last, d_next] = [inner, first, last, next].map(at);
                let certain = f64::min(d_first, d_last) < -CERTAIN
                    && f64::max(d_inner, d_next) > CERTAIN
                    && f64::max(d_first, d_last) < 0.0
                    && f64::min(d_inner, d_next) >= 0.0;
                if !certain {
                    return None;
                }
                let out = crossing(of.corner(inner), of.corner(first), d_inner, d_first);
                let back = crossing(of.corner(last), of.corner(next), d_last, d_next);
                if from + count < n {
                    self.copy(0, of, 0);
                    self.copy(from + 2, of, next);
                    self.set(from, out);
                    self.set(from + 1, back);
                } else {
                    self.copy(1, of, next);
                    self.set(0, back);
                    self.set(1 + from - next, out);
                }
                self.len = n - count + 2;
                Some(Cut::Part)
            }
            Told::Whole(corner) if corner < n => {
                let depth = at(corner);
                let neighbours = f64::min(at(before(corner)), at(wrapped(corner + 1)));
                (depth >= 0.0 && neighbours > depth + CERTAIN).then_some(Cut::Whole)
            }
            Told::Empty(corner) if corner < n => {
                let depth = at(corner);
                let neighbours = f64::max(at(before(corner)), at(wrapped(corner + 1)));
                (depth < 0.0 && neighbours < depth - CERTAIN).then_some(Cut::Empty)
            }
            _ => None,
        }
    }

    /// The cut edge by edge (Sutherland and Hodgman 1974), so that a line through several corners, whose depths
    /// differ in sign by round-off, loses nothing.
    ///
    /// Every corner is written and kept only if it belongs to the part, so that only the branches at
    /// crossings depend on the data.
    #[inline(never)]
    fn cut_edge_by_edge(
        &mut self,
        of: &Self,
        by: &Line,
        outcome: &mut Outcome,
    ) -> Result<Cut, TooMany> {
        let corners = of.corners();
        let Some(mut p) = corners.last() else {
            return Ok(Cut::Empty);
        };
        let mut dp = by.at(p);
        let (mut len, mut inside) = (0, 0_u32);
        for (i, q) in corners.iter().enumerate() {
            let dq = by.at(q);
            if (dp >= 0.0) != (dq >= 0.0) {
                self.set(len, crossing(p, q, dp, dq));
                len += 1;
            }
            self.set(len, *q);
            len += usize::from(dq >= 0.0);
            inside |= u32::from(dq >= 0.0) << i;
            (p, dp) = (q, dq);
        }
        if corners.len() < TOO_LONG {
            *outcome = outcome_of(corners, by, inside);
        }
        if len >= MOST {
            return Err(TooMany);
        }
        self.len = len;
        Ok(match inside {
            0 => Cut::Empty,
            _ if inside.count_ones() as usize == corners.len() => Cut::Whole,
            _ => Cut::Part,
        })
    }
}

/// What a line did to a polygon of which the corners in the bits of `inside` are inside.
fn outcome_of(corners: &[Point], by: &Line, inside: u32) -> Outcome {
    let n = corners.len();
    let nearest = |sign: f64| {
        let depths = corners.iter().map(|p| sign * by.at(p)).enumerate();
        let least = depths.min_by(|x, y| x.1.total_cmp(&y.1));
        least.map_or(0, |(corner, _)| corner)
    };
    let outside = !inside & ((1 << n) - 1);
    Outcome::new(if outside == 0 {
        Told::Whole(nearest(1.0))
    } else if inside == 0 {
        Told::Empty(nearest(-1.0))
    } else {
        // The first of those cut away is the one after a corner that is not.
        let from = outside & !(outside << 1 | outside >> (n - 1));
        Told::Part {
            from: from.trailing_zeros() as usize,
            count: outside.count_ones() as usize,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A regular polygon with some of its corners doubled.
    fn polygon(count: usize, turn: f64, doubled: usize) -> Polygon {
        let mut corners = Vec::new();
        for i in 0..count {
            let angle = turn + std::f64::consts::TAU * i as f64 / count as f64;
            let p = Point {
                x: angle.cos(),
                y: angle.sin(),
            };
            let copies = if i == doubled { 3 } else { 1 };
            corners.extend([p; 3].iter().take(copies));
        }
        let mut polygon = Polygon::default();
        assert!(polygon.load(&corners));
        polygon
    }

    /// Twice the area.
    fn area(polygon: &Polygon) -> f64 {
        let corners = polygon.corners();
        let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
        pairs.map(|(p, q)| p.x * q.y - p.y * q.x).sum()
    }

    fn left(cut: Cut, of: &Polygon, part: &Polygon) -> f64 {
        match cut {
            Cut::Whole => area(of),
            Cut::Part => area(part),
            Cut::Empty => 0.0,
        }
    }

    proptest! {
        /// Whatever is expected of a cut, also of one through corners or along edges, it does what it does without. What
        /// it did is then known beforehand, and gives the same bits.
        #[test]
        fn what_is_expected_of_a_cut_changes_nothing(
            count in 3..20_usize,
            turn in 0.0..6.3_f64,
            direction in 0.0..6.3_f64,
            level in -1.1..1.1_f64,
            through in prop::option::of((0..20_usize, 1..20_usize)),
            doubled in 0..40_usize,
            off in prop::sample::select(vec![0.0, 1e-17, -1e-17, 1e-12]),
        ) {
            let of = polygon(count, turn, doubled);
            let corners = of.corners();
            let mut line = Line { a: direction.cos(), b: direction.sin(), c: level };
            if let Some((i, further)) = through {
                let [p, q] = [i, i + further].map(|i| corners[i % corners.len()]);
                (line.a, line.b) = (q.y - p.y, p.x - q.x);
                line.c = line.a * p.x + line.b * p.y + off;
            }
            let mut right = Polygon::default();
            let mut known = Outcome::default();
            let cut = right.cut_edge_by_edge(&of, &line, &mut known).unwrap();
            let expected = left(cut, &of, &right);
            for corner in 0..16 {
                for count in 0..16 {
                    let told = match count {
                        0 => Told::Whole(corner),
                        15 => Told::Empty(corner),
                        _ => Told::Part { from: corner, count },
                    };
                    let mut outcome = Outcome::new(told);
                    prop_assert_eq!(outcome.told(), told);
                    let mut part = Polygon::default();
                    let cut = part.set_cut(&of, &line, &mut outcome).unwrap();
                    let found = left(cut, &of, &part);
                    prop_assert!((found - expected).abs() < 1e-9, "{told:?}: {found} {expected}");
                }
            }
            let mut part = Polygon::default();
            if let Some(again) = part.cut_as_told(&of, &line, known) {
                prop_assert_eq!(again, cut);
                if cut == Cut::Part {
                    prop_assert_eq!(part.corners(), right.corners());
                }
            } else {
                prop_assert!(through.is_some() || count >= 14 || doubled < count);
            }
        }
    }
}
