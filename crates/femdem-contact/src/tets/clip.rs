//! The part of a triangle of skin that lies in a tetrahedron.

use super::current::Current;
use super::polygon::PolygonSums;
use super::row::Row;
use femdem_mesh::tet::FACES;
use femdem_mesh::{Matrix3, Vector3};

/// Room for corners: a triangle cut by four planes has at most seven, and one more is written speculatively.
/// A power of two, so that indices wrap by a bit mask.
const ROOM: usize = 8;

/// Absolute values of shape functions up to this are treated as round-off.
pub(crate) const NOISE: f64 = 1e-11;

/// Polygons that come this near to a node with pressure, measured by 1 minus its shape function, are left to
/// the sums over pieces: the flux about the node has a pole.
const POLE: f64 = 1e-3;

/// Bit of an edge that lies on face 0 of the triangle's own tetrahedron.
const OWN: u8 = 1 << 4;

/// Sizes of tetrahedra that differ by more than this factor differ much.
const LARGE: f64 = 4.0;

/// Shape functions of one tetrahedron at the corners of another, by corner.
pub(crate) type Depths = [Row; 4];

/// A corner: the four shape functions of the tetrahedron that contains it, its position (m) and the field
/// there (Pa). All of them are affine, and interpolated alike in a cut.
#[derive(Debug, Clone, Copy, Default)]
struct Corner {
    shares: Row,
    place: Row,
}

/// Result of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Left {
    Nothing,
    Polygon,
    /// It lies in a face inside the other body, so that round-off would decide which tetrahedron it belongs
    /// to.
    Unclear,
}

/// A plane convex polygon, in one of two buffers.
#[derive(Debug, Default)]
pub(crate) struct Clip {
    count: usize,
    at: [[Corner; ROOM]; 2],
    /// What the edge that ends in each corner lies on, as a bit: 0 to 3 a face of the host, 4 + k face k of the
    /// triangle's own tetrahedron.
    on: [[u8; ROOM]; 2],
    now: usize,
    /// 1 if its corners are in counter-clockwise order seen from outside, else -1.
    turn: f64,
}

/// Shape functions of `tet` at the corners of another one.
#[inline(always)]
pub(crate) fn depths(tet: &Current, other: &Current) -> Depths {
    let [a, b, c, d] = &tet.slopes;
    let x = Row([a.x, b.x, c.x, d.x]);
    let y = Row([a.y, b.y, c.y, d.y]);
    let z = Row([a.z, b.z, c.z, d.z]);
    let level = Row(tet.levels);
    let at = |p: &Vector3| level + (x * p.x + y * p.y + z * p.z);
    let [p, q, r, s] = &other.corners;
    [at(p), at(q), at(r), at(s)]
}

/// Whether all corners are outside one face.
#[inline(always)]
pub(crate) fn is_outside([a, b, c, d]: &Depths) -> bool {
    a.max(*b).max(c.max(*d)).least() <= 0.0
}

/// The corners of `tet` with pressure that lie in the other tetrahedron, as bits.
#[inline(always)]
pub(crate) fn sunken(tet: &Current, depths: &Depths) -> u8 {
    let mut bits = 0;
    for (c, depths) in depths.iter().enumerate() {
        if tet.values[c] != 0.0 {
            bits |= u8::from(depths.least() >= -NOISE) << c;
        }
    }
    bits
}

impl Clip {
    /// Sets this to the part of face `face` of `own` that lies in `host`. `in_host` are the host's shape
    /// functions at the corners of `own`, `of_host` those of `own` at the corners of the host.
    #[inline(always)]
    pub fn load(
        &mut self,
        (own, face, in_host): (&Current, usize, &Depths),
        (host, of_host): (&Current, &Depths),
    ) -> Left {
        let [i, j, k] = FACES[face];
        let [p, q, r] = [in_host[i], in_host[j], in_host[k]];
        let (low, high) = (p.min(q).min(r), p.max(q).max(r));
        if high.least() <= NOISE {
            // There is no pressure in the skin of the host.
            let outside = high.bits(|x| x <= NOISE);
            let flat = low.bits(|x| x >= -NOISE);
            return if outside & (!flat | host.skin) != 0 {
                Left::Nothing
            } else {
                Left::Unclear
            };
        }
        self.now = 0;
        // If `own` is much larger, the host's section is cut instead, so that round-off scales with the
        // smaller size.
        if own.size > LARGE * host.size {
            return self.load_section(own, face, host, of_host);
        }
        self.turn = 1.0;
        self.count = 3;
        for (room, (shares, c)) in self.at[0].iter_mut().zip([(p, i), (q, j), (r, k)]) {
            *room = Corner::new(shares, &own.corners[c], host);
        }
        for (room, c) in self.on[0].iter_mut().zip([j, k, i]) {
            *room = OWN << c;
        }
        let cut = low.bits(|x| x < 0.0);
        for k in 0..4 {
            if cut >> k & 1 == 1 && !self.cut(1 << k, |x| x.shares.0[k]) {
                return Left::Nothing;
            }
        }
        Left::Polygon
    }

    /// The same, starting from the section of the host by the plane of the face.
    #[inline(never)]
    fn load_section(
        &mut self,
        own: &Current,
        face: usize,
        host: &Current,
        of_host: &Depths,
    ) -> Left {
        let depth = of_host.map(|d| d.0[face]);
        if !self.section(&depth, host) {
            return Left::Nothing;
        }
        let at = |c: usize| self.at[0][c].point();
        let (x, y, z) = (at(0), at(1), at(2));
        let area = (y - x).cross(&(z - x)) + (z - x).cross(&(at(self.count - 1) - x));
        let inwards = area.dot(&own.slopes[face]) > 0.0;
        self.turn = if inwards { -1.0 } else { 1.0 };
        for k in (0..4).filter(|k| *k != face && of_host.iter().any(|d| d.0[*k] < 0.0)) {
            let (level, slope) = (own.levels[k], own.slopes[k]);
            if !self.cut(OWN << k, |x| level + slope.dot(&x.point())) {
                return Left::Nothing;
            }
        }
        Left::Polygon
    }

    /// Sets this to the section of a tetrahedron by a plane, from the depths of its corners under the plane;
    /// `false` if there is none.
    fn section(&mut self, depth: &[f64; 4], host: &Current) -> bool {
        let mut order = [0, 1, 2, 3];
        order.sort_by_key(|c| depth[*c] < 0.0);
        let [i, j, k, l] = order;
        let inside = depth.iter().filter(|d| **d >= 0.0).count();
        let edges = match inside {
            1 => [[i, j], [i, k], [i, l], [i, l]],
            2 => [[i, k], [i, l], [j, l], [j, k]],
            3 => [[i, l], [j, l], [k, l], [k, l]],
            _ => return false,
        };
        self.count = if inside == 2 { 4 } else { 3 };
        let end = |c: usize| {
            let mut shares = Row::default();
            shares.0[c] = 1.0;
            Corner::new(shares, &host.corners[c], host)
        };
        for (room, [from, to]) in self.at[0].iter_mut().zip(edges) {
            let share = depth[from] / (depth[from] - depth[to]);
            *room = end(from).towards(&end(to), share);
        }
        let bits = edges.map(|[from, to]| 1 << from | 1 << to);
        for (at, room) in self.on[0][..self.count].iter_mut().enumerate() {
            // The face without the corner that is on neither of two edges.
            let before = (at + self.count - 1) % self.count;
            *room = !(bits[at] | bits[before]) & 0b1111;
        }
        true
    }

    /// Keeps the part where `depth` (affine) is at least 0; `false` if none is left. The new edge lies on `side`.
    #[inline(always)]
    fn cut(&mut self, side: u8, depth: impl Fn(&Corner) -> f64) -> bool {
        let ([first, second], [of_first, of_second]) = (&mut self.at, &mut self.on);
        let (old, new, on, newly_on) = if self.now == 0 {
            (&*first, second, &*of_first, of_second)
        } else {
            (&*second, first, &*of_second, of_first)
        };
        let mut depths = [0.0; ROOM];
        let mut inside = 0;
        for (d, x) in depths.iter_mut().zip(old).take(self.count) {
            *d = depth(x);
            inside += usize::from(*d >= 0.0);
        }
        if inside == self.count || inside == 0 {
            return inside > 0;
        }
        let mut last = (self.count - 1) % ROOM;
        let mut count = 0;
        for at in 0..self.count.min(ROOM) {
            // Both points are written, and later ones overwrite those that do not count: no branch to
            // mispredict.
            let (dx, dy) = (depths[last], depths[at]);
            new[count % ROOM] = old[last].towards(&old[at], dx / (dx - dy));
            newly_on[count % ROOM] = if dx >= 0.0 { on[at] } else { side };
            count += usize::from((dx >= 0.0) != (dy >= 0.0));
            new[count % ROOM] = old[at];
            newly_on[count % ROOM] = on[at];
            count += usize::from(dy >= 0.0);
            last = at;
        }
        self.count = count;
        self.now = 1 - self.now;
        count >= 3
    }

    /// What the polygon's edges lie on, as bits: 0 to 3 the host's faces, 4 + k face k of the triangle's own
    /// tetrahedron.
    #[inline(always)]
    pub fn edges(&self) -> u8 {
        let on = self.on[self.now].iter().take(self.count);
        on.fold(0, |bits, on| bits | on)
    }

    /// Integrals over the polygon with the given unit normal, and its fluxes. `None` if it comes too near to a node with pressure.
    #[inline(always)]
    pub fn integrate(&self, normal: &Vector3, host: &Current) -> Option<(PolygonSums, Flux)> {
        let corners = self.at[self.now].get(..self.count)?;
        let (x, rest) = corners.split_first()?;
        // Areas are projected along the largest component of the normal.
        let size = normal.abs();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (u, v) = ([1, 2, 0][axis], [2, 0, 1][axis]);
        let scale = self.turn / normal[axis];
        // Integrals of position and field, of the field times both, and of the squares of both.
        let (mut first, mut moment) = (Row::default(), Row::default());
        // Of the field times x x, y y, z z.
        let mut spread = Row::default();
        // Of x x, y y, z z and of x y, y z, z x.
        let (mut squares, mut products) = (Row::default(), Row::default());
        let (mut area, mut flux, mut volume_flux) = (0.0, Row::default(), Row::default());
        let mut nearest = x.shares;
        for edge in rest.windows(2) {
            let (y, z) = (&edge[0], &edge[1]);
            let (p, q, r) = (x.place, y.place, z.place);
            let (along, across) = (q - p, r - p);
            let doubled = (along.0[u] * across.0[v] - along.0[v] * across.0[u]) * scale;
            let sum = p + q + r;
            area += doubled;
            first += sum * doubled;
            let weighted = p * p.0[3] + q * q.0[3] + r * r.0[3];
            moment += (sum * sum.0[3] + weighted) * doubled;
            let square = sum * sum + p * p + q * q + r * r;
            squares += square * doubled;
            let cubes = p * p * p.0[3] + q * q * q.0[3] + r * r * r.0[3];
            spread += (square * sum.0[3] + (sum * weighted + cubes) * 2.0) * doubled;
            let product = |x: Row| x * x.turned();
            products += (product(sum) + product(p) + product(q) + product(r)) * doubled;
            let [energy, volume] = flux_of(x.shares, y.shares, z.shares);
            flux += energy * doubled;
            volume_flux += volume * doubled;
            nearest = nearest.max(y.shares).max(z.shares);
        }
        let mut total = 0.0;
        for k in 0..4 {
            if host.values[k] != 0.0 {
                if nearest.0[k] > 1.0 - POLE {
                    return None;
                }
                let height = normal.dot(&(x.point() - host.corners[k]));
                total -= host.values[k] * height * flux.0[k];
            }
        }
        let pole = host.pole();
        let height = normal.dot(&(x.point() - host.corners[pole]));
        let volume = -height * volume_flux.0[pole];
        let vector = |row: Row, by: f64| Vector3::new(row.0[0], row.0[1], row.0[2]) * by;
        let sums = PolygonSums {
            area: area / 2.0,
            first: vector(first, 1.0 / 6.0),
            second: symmetric(&squares, &products) / 24.0,
            pressure: first.0[3] / 6.0,
            moment: vector(moment, 1.0 / 24.0),
            spread: (spread.0[0] + spread.0[1] + spread.0[2]) / 120.0,
        };
        Some((
            sums,
            Flux {
                energy: total / 24.0,
                volume: volume / 6.0,
            },
        ))
    }
}

/// Contributions of a polygon to integrals over the part of the host behind it: see [`skins`](super::skins).
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Flux {
    /// To ∫ p φ dV, J.
    pub energy: f64,
    /// To ∫ dV, m^3.
    pub volume: f64,
}

/// The symmetric matrix with a diagonal and with the elements xy, yz, zx beside it.
#[inline(always)]
fn symmetric(diagonal: &Row, beside: &Row) -> Matrix3 {
    let (Row([xx, yy, zz, _]), Row([xy, yz, zx, _])) = (diagonal, beside);
    Matrix3::new(*xx, *xy, *zx, *xy, *yy, *yz, *zx, *yz, *zz)
}

/// (e_1² - e_2 + e_3 - e_1 e_2 + e_1 e_3)/P and (e_1 - e_2 + e_3)/P with P = (1 - a)(1 - b)(1 - c), see
/// [`skins`](super::skins).
#[inline(always)]
fn flux_of(a: Row, b: Row, c: Row) -> [Row; 2] {
    let one = Row::all(1.0);
    let (e1, e2, e3) = (a + b + c, a * b + b * c + c * a, a * b * c);
    let product = (one - a) * (one - b) * (one - c);
    let lost = e1 - e2 + e3;
    [(e1 * lost - e2 + e3) / product, lost / product]
}

impl Corner {
    #[inline(always)]
    fn new(shares: Row, x: &Vector3, host: &Current) -> Self {
        let Row([a, b, c, d]) = shares * Row(host.values);
        Self {
            shares,
            place: Row([x.x, x.y, x.z, a + b + c + d]),
        }
    }

    #[inline(always)]
    fn point(&self) -> Vector3 {
        let Row([x, y, z, _]) = self.place;
        Vector3::new(x, y, z)
    }

    #[inline(always)]
    fn towards(&self, other: &Self, share: f64) -> Self {
        Self {
            shares: self.shares + (other.shares - self.shares) * share,
            place: self.place + (other.place - self.place) * share,
        }
    }
}
