//! The gauge cells on a polygon: the parts on which each plane determines the field.
//!
//! phi is the lowest of several linear functions. The polygon is split one function at a time: each piece has
//! an owner, and a new function takes over the part where it is lower than the owner's. A polygon of a pack
//! has about two cells on average: often only one, otherwise narrow strips along cut edges.

use super::clip::{Brackets, Line, Point, PolygonIntegrals, Second, integrate, split_into};
use super::field::{PlaneField, TIE};
use femdem_mesh::Vector3;

/// Sums over the cells of a polygon.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PlaneSums {
    pub polygon: PolygonIntegrals,
    /// Stiffness weight times area, and its moments.
    pub stiffness: f64,
    pub stiffness_moment: Point,
    pub stiffness_second: Second,
    pub brackets: Brackets,
}

impl PlaneSums {
    /// Adds a polygon with the field and the stiffness weight of its owner.
    #[inline]
    pub(crate) fn add_cell(
        &mut self,
        polygon: &[Point],
        origin: &Point,
        field: &Line,
        weight: f64,
    ) {
        self.add(&integrate(polygon, origin, field), weight);
        self.brackets.add(&Brackets::new(polygon, field), 1.0);
    }

    #[inline]
    fn add(&mut self, q: &PolygonIntegrals, weight: f64) {
        let p = &mut self.polygon;
        p.area += q.area;
        p.moment.x += q.moment.x;
        p.moment.y += q.moment.y;
        p.pressure += q.pressure;
        p.pressure_moment.x += q.pressure_moment.x;
        p.pressure_moment.y += q.pressure_moment.y;
        p.pressure_second += q.pressure_second;
        self.add_stiffness(q, weight);
    }

    #[inline]
    fn add_stiffness(&mut self, q: &PolygonIntegrals, weight: f64) {
        self.stiffness += weight * q.area;
        self.stiffness_moment.x += weight * q.moment.x;
        self.stiffness_moment.y += weight * q.moment.y;
        self.stiffness_second.add(&q.second, weight);
    }

    /// Corrects what is already summed for a part of it on which the field is `line` and not `main`, and the
    /// weight is larger by `weight`.
    #[inline]
    pub(crate) fn correct(
        &mut self,
        part: &[Point],
        origin: &Point,
        [line, main]: [&Line; 2],
        weight: f64,
    ) {
        self.brackets.add(&Brackets::new(part, line), 1.0);
        self.brackets.add(&Brackets::new(part, main), -1.0);
        let q = &integrate(part, origin, &line.minus(main));
        let p = &mut self.polygon;
        p.pressure += q.pressure;
        p.pressure_moment.x += q.pressure_moment.x;
        p.pressure_moment.y += q.pressure_moment.y;
        p.pressure_second += q.pressure_second;
        self.add_stiffness(q, weight);
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
    competitors: Vec<usize>,
    pieces: Vec<Piece>,
    spare: Vec<Point>,
}

impl Cells {
    /// Integrals of the lowest field over a convex polygon of a facet with normal `n`.
    #[inline]
    pub(crate) fn integrate(
        &mut self,
        polygon: &[Point],
        field: &mut PlaneField,
        n: &Vector3,
        origin: &Point,
    ) -> PlaneSums {
        let mut sums = PlaneSums::default();
        field.competitors(polygon, &mut self.competitors);
        if let [k] = self.competitors[..] {
            sums.add_cell(polygon, origin, &field.line(k), field.weight(k, n));
            return sums;
        }
        let Some(&owner) = self.competitors.first() else {
            return sums;
        };
        self.provide(0);
        self.pieces[0].polygon.clear();
        self.pieces[0].polygon.extend_from_slice(polygon);
        self.pieces[0].owner = owner;
        let mut used = 1;
        for c in 1..self.competitors.len() {
            let k = self.competitors[c];
            let line = field.line(k);
            let before = used;
            for i in 0..before {
                let above = line.minus(&field.line(self.pieces[i].owner));
                used += usize::from(self.split(i, k, &above, used));
            }
        }
        for piece in &self.pieces[..used] {
            let k = piece.owner;
            sums.add_cell(&piece.polygon, origin, &field.line(k), field.weight(k, n));
        }
        sums
    }

    /// Makes sure that buffer `i` exists.
    fn provide(&mut self, i: usize) {
        if self.pieces.len() <= i {
            self.pieces.resize_with(i + 1, Piece::default);
        }
    }

    /// Gives plane `k` the part of piece `i` where it is lower than the owner, which is where `above` is
    /// negative. True if that made a new piece, number `used`.
    #[inline]
    fn split(&mut self, i: usize, k: usize, above: &Line, used: usize) -> bool {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in &self.pieces[i].polygon {
            let d = above.at(p);
            low = if d < low { d } else { low };
            high = if d > high { d } else { high };
        }
        if low >= -TIE {
            return false;
        }
        if high <= TIE {
            self.pieces[i].owner = k;
            return false;
        }
        self.provide(used);
        let mut taken = std::mem::take(&mut self.pieces[used].polygon);
        split_into(&self.pieces[i].polygon, above, &mut self.spare, &mut taken);
        std::mem::swap(&mut self.pieces[i].polygon, &mut self.spare);
        self.pieces[used] = Piece {
            polygon: taken,
            owner: k,
        };
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::plane::FieldPlane;
    use super::*;
    use crate::shape::PlaneFrame;

    /// A hipped roof over the square [-1,1]^2, phi = 1 - max(|x|,|y|): a pyramid of volume
    /// 4/3 whose four cells have equal area. The planes lean by 45 degrees, so each weighs
    /// scale / sqrt(2) = 1.
    #[test]
    fn a_pyramid_roof_is_integrated_exactly() {
        let polygon = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|p| Point { x: p[0], y: p[1] });
        let planes = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].map(|n| FieldPlane {
            gradient: Vector3::new(n[0], n[1], -1.0),
            level: 1.0,
        });
        let frame = PlaneFrame {
            origin: Vector3::zeros(),
            e1: Vector3::x(),
            e2: Vector3::y(),
        };
        let mut field = PlaneField::new(&planes);
        field.place(&frame);
        let mut cells = Cells::default();
        for _ in 0..2 {
            let n = Vector3::z();
            let sums = cells.integrate(&polygon, &mut field, &n, &Point::default());
            assert!((sums.polygon.pressure - 4.0 / 3.0).abs() < 1e-14);
            assert!((sums.polygon.area - 4.0).abs() < 1e-14);
            assert!((sums.stiffness - 4.0).abs() < 1e-13);
        }
    }
}
