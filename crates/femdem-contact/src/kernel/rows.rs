//! The side loop for up to 12 field planes at once: the fast path of the pair kernel.
//!
//! Every vertex of a clipped facet carries the fields of all planes there, a row. All of
//! them are linear over the facet, so a cut interpolates whole rows, and neither cutting
//! nor splitting into cells evaluates a plane again. The rows have a fixed width K, so
//! that the compiler turns each row operation into a few vector instructions. The general
//! path (`side`, `field`, `cells`) is its oracle.

use super::candidates::ContactBox;
use super::cells::PlaneSums;
use super::clip::{Line, Point, PolygonIntegrals};
use super::field::TIE;
use super::side::{FieldPlane, SideSums, Skin};
use crate::shape::{ConvexShape, Facet, PlaneFrame};
use femdem_mesh::Vector3;

/// A vertex with the field of every plane.
#[derive(Debug, Clone, Copy)]
struct Row<const K: usize> {
    x: f64,
    y: f64,
    phi: [f64; K],
}

impl<const K: usize> Row<K> {
    /// The point of the edge at fraction `t` from `inside` to `out`.
    #[inline]
    fn between(inside: &Self, out: &Self, t: f64) -> Self {
        Self {
            x: inside.x + (out.x - inside.x) * t,
            y: inside.y + (out.y - inside.y) * t,
            phi: std::array::from_fn(|k| inside.phi[k] + (out.phi[k] - inside.phi[k]) * t),
        }
    }
}

/// Field planes by component, scaled so that phi = c - n.x; padded with planes that never
/// cut and never own a cell.
#[derive(Debug, Clone, Copy)]
struct Block<const K: usize> {
    n: [[f64; K]; 3],
    c: [f64; K],
}

/// The same on the plane of a facet: phi = c - a x - b y.
#[derive(Debug, Clone, Copy)]
struct Lines<const K: usize> {
    a: [f64; K],
    b: [f64; K],
    c: [f64; K],
}

impl<const K: usize> Block<K> {
    fn new(field: &[FieldPlane]) -> Self {
        let mut block = Self {
            n: [[0.0; K]; 3],
            c: [1e300; K],
        };
        for (k, plane) in field.iter().take(K).enumerate() {
            for axis in 0..3 {
                block.n[axis][k] = plane.normal[axis] * plane.scale;
            }
            block.c[k] = plane.offset * plane.scale;
        }
        block
    }

    #[inline]
    fn along(&self, e: &Vector3, k: usize) -> f64 {
        self.n[0][k] * e.x + self.n[1][k] * e.y + self.n[2][k] * e.z
    }

    #[inline]
    fn on(&self, frame: &PlaneFrame) -> Lines<K> {
        Lines {
            a: std::array::from_fn(|k| self.along(&frame.e1, k)),
            b: std::array::from_fn(|k| self.along(&frame.e2, k)),
            c: std::array::from_fn(|k| self.c[k] - self.along(&frame.origin, k)),
        }
    }

    #[inline]
    fn first_on(&self, frame: &PlaneFrame) -> Line {
        Line {
            a: self.along(&frame.e1, 0),
            b: self.along(&frame.e2, 0),
            c: self.c[0] - self.along(&frame.origin, 0),
        }
    }
}

impl<const K: usize> Lines<K> {
    #[inline]
    fn row(&self, x: f64, y: f64) -> Row<K> {
        Row {
            x,
            y,
            phi: std::array::from_fn(|k| self.c[k] - self.a[k] * x - self.b[k] * y),
        }
    }
}

#[derive(Debug)]
struct Piece<const K: usize> {
    rows: Vec<Row<K>>,
    owner: usize,
}

/// Buffers for one row width.
#[derive(Debug)]
pub(crate) struct Rows<const K: usize> {
    depths: Vec<f64>,
    polygon: Vec<Row<K>>,
    spare: Vec<Row<K>>,
    pieces: Vec<Piece<K>>,
}

impl<const K: usize> Default for Rows<K> {
    fn default() -> Self {
        Self {
            depths: Vec::new(),
            polygon: Vec::new(),
            spare: Vec::new(),
            pieces: Vec::new(),
        }
    }
}

/// Keeps the part of a polygon where `depth` is at least 0 (Sutherland and Hodgman 1974).
#[inline]
fn cut<const K: usize>(polygon: &[Row<K>], depth: impl Fn(&Row<K>) -> f64, out: &mut Vec<Row<K>>) {
    out.clear();
    let Some(mut p) = polygon.last() else {
        return;
    };
    let mut dp = depth(p);
    for q in polygon {
        let dq = depth(q);
        if dq >= 0.0 {
            if dp < 0.0 {
                out.push(Row::between(q, p, dq / (dq - dp)));
            }
            out.push(*q);
        } else if dp >= 0.0 {
            out.push(Row::between(p, q, dp / (dp - dq)));
        }
        (p, dp) = (q, dq);
    }
}

impl<const K: usize> Rows<K> {
    /// As `side::integrate_side`, for at most K planes.
    pub(crate) fn integrate_side(
        &mut self,
        skin: &Skin,
        field: &[FieldPlane],
        bounding: usize,
    ) -> SideSums {
        let mut sums = SideSums::default();
        let block = Block::<K>::new(field);
        for &i in skin.facets {
            let facet = &skin.shape.facets[usize::from(i)];
            if !self.clip(skin.shape, facet, &block, bounding, &skin.region) {
                continue;
            }
            let frame = &facet.frame;
            let normal = &skin.shape.planes[usize::from(facet.plane)].normal;
            let from = skin.region.centre - frame.origin;
            let origin = Point {
                x: from.dot(&frame.e1),
                y: from.dot(&frame.e2),
            };
            let q = self.sum_cells(field.len(), &origin, |k| (-block.along(normal, k)).max(0.0));
            sums.add_sums(&q, frame, normal, -from.dot(normal));
            sums.lever += normal.dot(&(frame.origin - skin.field_centre)) * q.polygon.pressure;
        }
        sums
    }

    /// Clips a facet by the field's planes and the box; false if nothing is left.
    #[inline]
    fn clip(
        &mut self,
        skin: &ConvexShape,
        facet: &Facet,
        block: &Block<K>,
        bounding: usize,
        region: &ContactBox,
    ) -> bool {
        let corners = skin.polygon(facet);
        let nearest = block.first_on(&facet.frame);
        let mut any = false;
        self.depths.clear();
        self.depths.extend(corners.iter().map(|p| {
            let d = nearest.at(p);
            any |= d >= 0.0;
            d
        }));
        if !any {
            return false;
        }
        self.load(corners, &block.on(&facet.frame));
        let bounding = bounding.min(K);
        let mut k = 1;
        while k < bounding {
            let outside = |r: &Row<K>| r.phi[k] < 0.0;
            if self.polygon.iter().any(outside) {
                cut(&self.polygon, |r| r.phi[k], &mut self.spare);
                std::mem::swap(&mut self.polygon, &mut self.spare);
            }
            k += 1;
        }
        self.cut_by_box(region, &facet.frame);
        self.polygon.len() >= 3
    }

    /// Loads the corners cut by the first plane, whose depths are known, as rows.
    #[inline]
    fn load(&mut self, corners: &[Point], lines: &Lines<K>) {
        self.polygon.clear();
        let (Some(mut p), Some(&last)) = (corners.last(), self.depths.last()) else {
            return;
        };
        let mut dp = last;
        for (q, &dq) in corners.iter().zip(&self.depths) {
            if (dq >= 0.0) != (dp >= 0.0) {
                let t = dp / (dp - dq);
                let (x, y) = (p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t);
                self.polygon.push(lines.row(x, y));
            }
            if dq >= 0.0 {
                self.polygon.push(lines.row(q.x, q.y));
            }
            (p, dp) = (q, dq);
        }
    }

    #[inline]
    fn cut_by_box(&mut self, region: &ContactBox, frame: &PlaneFrame) {
        let from = region.centre - frame.origin;
        for k in 0..3 {
            let axis = &region.axes[k];
            let (a, b) = (axis.dot(&frame.e1), axis.dot(&frame.e2));
            let mid = axis.dot(&from);
            let half = region.half[k];
            let along = |r: &Row<K>| a * r.x + b * r.y - mid;
            let beyond = |r: &Row<K>| along(r).abs() > half;
            if self.polygon.iter().any(beyond) {
                cut(&self.polygon, |r| half - along(r), &mut self.spare);
                cut(&self.spare, |r| half + along(r), &mut self.polygon);
            }
        }
    }

    /// Integrals of the lowest field over the polygon, cell by cell.
    #[inline]
    fn sum_cells(
        &mut self,
        planes: usize,
        origin: &Point,
        weight: impl Fn(usize) -> f64,
    ) -> PlaneSums {
        let mut sums = PlaneSums::default();
        if let Some(owner) = self.single_owner(planes.min(K)) {
            let q = integrate(&self.polygon, owner, origin);
            sums.add(&q, weight(owner));
            return sums;
        }
        let winners = self.winners();
        let owner = winners.trailing_zeros() as usize;
        let competes = |k: &usize| winners >> k & 1 == 1 || !self.is_undercut(*k, winners);
        let competitors = (0..planes.min(K))
            .filter(competes)
            .fold(0_u32, |set, k| set | 1 << k);
        self.provide(0);
        std::mem::swap(&mut self.pieces[0].rows, &mut self.polygon);
        self.pieces[0].owner = owner;
        let mut used = 1;
        for k in (0..K).filter(|k| *k != owner && competitors >> k & 1 == 1) {
            for i in 0..used {
                used += usize::from(self.split(i, k, used));
            }
        }
        for piece in &self.pieces[..used] {
            let q = integrate(&piece.rows, piece.owner, origin);
            sums.add(&q, weight(piece.owner));
        }
        sums
    }

    /// The plane whose field is lowest at every vertex, if there is one.
    #[inline]
    fn single_owner(&self, planes: usize) -> Option<usize> {
        let first = self.polygon.first()?;
        let mut owner = 0;
        for k in 1..planes {
            if first.phi[k] < first.phi[owner] {
                owner = k;
            }
        }
        let lowest = |r: &Row<K>| {
            let bound = r.phi[owner] - TIE;
            let mut below = false;
            for k in 0..K {
                below |= r.phi[k] < bound;
            }
            !below
        };
        self.polygon.iter().all(lowest).then_some(owner)
    }

    /// The planes that are lowest at a vertex, as bits.
    #[inline]
    fn winners(&self) -> u32 {
        self.polygon.iter().fold(0, |set, r| {
            let mut owner = 0;
            for k in 1..K {
                if r.phi[k] < r.phi[owner] {
                    owner = k;
                }
            }
            set | 1 << owner
        })
    }

    /// Whether a plane that is lowest at a vertex lies below plane `k` at all of them: then
    /// `k` owns nothing.
    #[inline]
    fn is_undercut(&self, k: usize, winners: u32) -> bool {
        (0..K).any(|w| winners >> w & 1 == 1 && self.polygon.iter().all(|r| r.phi[w] <= r.phi[k]))
    }

    /// Makes sure that piece `i` exists.
    fn provide(&mut self, i: usize) {
        while self.pieces.len() <= i {
            self.pieces.push(Piece {
                rows: Vec::new(),
                owner: 0,
            });
        }
    }

    /// Gives plane `k` the part of piece `i` where it is lower than the owner; true if
    /// that made a new piece, number `used`.
    #[inline]
    fn split(&mut self, i: usize, k: usize, used: usize) -> bool {
        let piece = &self.pieces[i];
        let owner = piece.owner;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for r in &piece.rows {
            let d = r.phi[k] - r.phi[owner];
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
        let mut taken = std::mem::take(&mut self.pieces[used].rows);
        let rows = &self.pieces[i].rows;
        cut(rows, |r| r.phi[owner] - r.phi[k], &mut taken);
        cut(rows, |r| r.phi[k] - r.phi[owner], &mut self.spare);
        std::mem::swap(&mut self.pieces[i].rows, &mut self.spare);
        self.pieces[used] = Piece {
            rows: taken,
            owner: k,
        };
        true
    }
}

/// Exact integrals of one plane's field over a polygon: fan triangles about the first
/// vertex, then a shift of the moments to the origin.
#[inline]
fn integrate<const K: usize>(rows: &[Row<K>], owner: usize, origin: &Point) -> PolygonIntegrals {
    let mut sum = PolygonIntegrals::default();
    let Some((a, rest)) = rows.split_first() else {
        return sum;
    };
    let at = |r: &Row<K>| [r.x - a.x, r.y - a.y, r.phi[owner]];
    let mut corners = rest.iter().map(at);
    let Some(mut b) = corners.next() else {
        return sum;
    };
    let phi_a = a.phi[owner];
    let mut bb = b[0] * b[0] + b[1] * b[1];
    for c in corners {
        let cc = c[0] * c[0] + c[1] * c[1];
        let t = 0.5 * (b[0] * c[1] - b[1] * c[0]);
        let s = [b[0] + c[0], b[1] + c[1], phi_a + b[2] + c[2]];
        let w = [b[2] * b[0] + c[2] * c[0], b[2] * b[1] + c[2] * c[1]];
        let squares = s[0] * s[0] + s[1] * s[1] + bb + cc;
        let (t3, t12) = (t * (1.0 / 3.0), t * (1.0 / 12.0));
        sum.area += t;
        sum.moment.x += t3 * s[0];
        sum.moment.y += t3 * s[1];
        sum.second += t12 * squares;
        sum.pressure += t3 * s[2];
        sum.pressure_moment.x += t12 * (s[0] * s[2] + w[0]);
        sum.pressure_moment.y += t12 * (s[1] * s[2] + w[1]);
        let cross = 2.0 * (w[0] * s[0] + w[1] * s[1] + b[2] * bb + c[2] * cc);
        sum.pressure_second += t * (1.0 / 60.0) * (s[2] * squares + cross);
        (b, bb) = (c, cc);
    }
    sum.shifted(a.x - origin.x, a.y - origin.y)
}
