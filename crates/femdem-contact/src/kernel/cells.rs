//! The gauge cells on a polygon: where which plane carries the field.
//!
//! phi is the lowest of several linear functions. The polygon is split one function at a
//! time: each piece has an owner, and a new function takes what lies below the owner's.
//! Most polygons of a pack lie in one cell and are never split.

use super::clip::{Line, Point, PolygonIntegrals, close_run, integrate};

/// Sums over the cells of a polygon.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PlaneSums {
    pub polygon: PolygonIntegrals,
    /// Stiffness weight times area, and its moments.
    pub stiffness: f64,
    pub stiffness_moment: Point,
    pub stiffness_second: f64,
}

impl PlaneSums {
    #[inline]
    pub(crate) fn add(&mut self, q: &PolygonIntegrals, weight: f64) {
        let p = &mut self.polygon;
        p.area += q.area;
        p.moment.x += q.moment.x;
        p.moment.y += q.moment.y;
        p.second += q.second;
        p.pressure += q.pressure;
        p.pressure_moment.x += q.pressure_moment.x;
        p.pressure_moment.y += q.pressure_moment.y;
        p.pressure_second += q.pressure_second;
        self.stiffness += weight * q.area;
        self.stiffness_moment.x += weight * q.moment.x;
        self.stiffness_moment.y += weight * q.moment.y;
        self.stiffness_second += weight * q.second;
    }
}

/// A convex piece of the polygon and the function that is lowest on it so far.
#[derive(Debug, Default)]
struct Piece {
    polygon: Vec<Point>,
    owner: usize,
}

/// Buffers of the splitting, reused from call to call.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    pieces: Vec<Piece>,
    used: usize,
    depths: Vec<f64>,
    spare: Vec<Point>,
}

/// Round-off of phi; a wrong owner within it changes nothing.
pub(crate) const TIE: f64 = 1e-15;

impl Cells {
    /// Integrals of the lowest of `lines` over a convex polygon; `weight` gives the
    /// stiffness weight of each line.
    pub(crate) fn integrate(
        &mut self,
        polygon: &[Point],
        lines: &[Line],
        origin: &Point,
        weight: impl Fn(usize) -> f64,
    ) -> PlaneSums {
        let mut sums = PlaneSums::default();
        self.used = 0;
        self.push(0).extend_from_slice(polygon);
        for k in 1..lines.len() {
            for i in 0..self.used {
                self.split(i, k, lines);
            }
        }
        for piece in &self.pieces[..self.used] {
            let q = integrate(&piece.polygon, origin, &lines[piece.owner]);
            sums.add(&q, weight(piece.owner));
        }
        sums
    }

    /// A fresh, empty piece.
    fn push(&mut self, owner: usize) -> &mut Vec<Point> {
        if self.used == self.pieces.len() {
            self.pieces.push(Piece::default());
        }
        let piece = &mut self.pieces[self.used];
        self.used += 1;
        piece.owner = owner;
        piece.polygon.clear();
        &mut piece.polygon
    }

    /// Gives function `k` the part of piece `i` where it is lower than the owner's.
    #[inline]
    fn split(&mut self, i: usize, k: usize, lines: &[Line]) {
        let piece = &self.pieces[i];
        let above = lines[k].minus(&lines[piece.owner]);
        self.depths.clear();
        self.depths
            .extend(piece.polygon.iter().map(|p| above.at(p)));
        let lowest = self.depths.iter().copied().fold(f64::INFINITY, f64::min);
        if lowest >= -TIE {
            return;
        }
        let highest = self
            .depths
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        if highest <= TIE {
            self.pieces[i].owner = k;
            return;
        }
        let stays = self.depths.iter().filter(|d| **d >= 0.0).count();
        if stays == 0 || stays == piece.polygon.len() {
            return;
        }
        let mut rest = std::mem::take(&mut self.spare);
        close_run(&self.pieces[i].polygon, &self.depths, stays, &mut rest);
        self.depths.iter_mut().for_each(|d| *d = -*d);
        let goes = self.depths.iter().filter(|d| **d >= 0.0).count();
        let from = std::mem::replace(&mut self.pieces[i].polygon, rest);
        if goes > 0 && goes < from.len() {
            let depths = std::mem::take(&mut self.depths);
            close_run(&from, &depths, goes, self.push(k));
            self.depths = depths;
        }
        self.spare = from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hipped roof over the square [-1,1]^2, phi = 1 - max(|x|,|y|): a pyramid of volume
    /// 4/3 whose four cells have equal area.
    #[test]
    fn a_pyramid_roof_is_integrated_exactly() {
        let polygon = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|p| Point { x: p[0], y: p[1] });
        let lines = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|n| Line {
            a: n[0],
            b: n[1],
            c: 1.0,
        });
        let mut cells = Cells::default();
        for _ in 0..2 {
            let sums = cells.integrate(&polygon, &lines, &Point::default(), |k| (k + 1) as f64);
            assert!((sums.polygon.pressure - 4.0 / 3.0).abs() < 1e-14);
            assert!((sums.polygon.area - 4.0).abs() < 1e-14);
            assert!((sums.stiffness - 10.0).abs() < 1e-13);
        }
    }
}
