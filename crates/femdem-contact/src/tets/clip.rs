//! The part of a triangle of skin that lies in a tetrahedron.

use super::current::Current;
use super::polygon::PolygonSums;
use super::row::{Lanes, Row};
use femdem_mesh::tet::FACES;
use femdem_mesh::{Matrix3, Vector3};

/// Room for corners: a triangle cut by four planes has at most seven. A power of two, so that indices wrap by a bit
/// mask.
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
pub(crate) type Depths<L> = [Row<L>; 4];

/// A corner: the four shape functions of the tetrahedron that contains it, its position (m) and the field
/// there (Pa). All of them are affine, and interpolated alike in a cut.
#[derive(Clone, Copy)]
struct Corner<L: Lanes> {
    shares: Row<L>,
    place: Row<L>,
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
pub(crate) struct Clip<L: Lanes> {
    lanes: L,
    count: usize,
    at: [[Corner<L>; ROOM]; 2],
    /// What the edge that ends in each corner lies on, as a bit: 0 to 3 a face of the host, 4 + k face k of the
    /// triangle's own tetrahedron.
    on: [[u8; ROOM]; 2],
    now: usize,
    /// 1 if its corners are in counter-clockwise order seen from outside, else -1.
    turn: f64,
}

/// Shape functions of `tet` at the corners of another one.
#[inline(always)]
pub(crate) fn depths<L: Lanes>(lanes: L, tet: &Current, other: &Current) -> Depths<L> {
    let [a, b, c, d] = &tet.slopes;
    let x = Row::new(lanes, [a.x, b.x, c.x, d.x]);
    let y = Row::new(lanes, [a.y, b.y, c.y, d.y]);
    let z = Row::new(lanes, [a.z, b.z, c.z, d.z]);
    let level = Row::new(lanes, tet.levels);
    let [p, q, r, s] = &other.corners;
    [
        level + (x * p.x + y * p.y + z * p.z),
        level + (x * q.x + y * q.y + z * q.z),
        level + (x * r.x + y * r.y + z * r.z),
        level + (x * s.x + y * s.y + z * s.z),
    ]
}

/// Whether all corners are outside one face.
#[inline(always)]
pub(crate) fn is_outside<L: Lanes>([a, b, c, d]: &Depths<L>) -> bool {
    a.max(*b).max(c.max(*d)).at_most(0.0) != 0
}

/// The corners of `tet` with pressure that lie in the other tetrahedron, as bits.
#[inline(always)]
pub(crate) fn sunken<L: Lanes>(tet: &Current, depths: &Depths<L>) -> u8 {
    let mut bits = 0;
    for (c, depths) in depths.iter().enumerate() {
        if tet.values[c] != 0.0 {
            bits |= u8::from(depths.at_least(-NOISE) == 0b1111) << c;
        }
    }
    bits
}

impl<L: Lanes> Clip<L> {
    /// An empty one.
    #[inline(always)]
    pub fn new(lanes: L) -> Self {
        let zero = Row::all(lanes, 0.0);
        let corner = Corner {
            shares: zero,
            place: zero,
        };
        Self {
            lanes,
            count: 0,
            at: [[corner; ROOM]; 2],
            on: [[0; ROOM]; 2],
            now: 0,
            turn: 1.0,
        }
    }

    /// Sets this to the part of face `face` of `own` that lies in `host`. `in_host` are the host's shape
    /// functions at the corners of `own`, `of_host` those of `own` at the corners of the host.
    #[inline(always)]
    pub fn load(
        &mut self,
        (own, face, in_host): (&Current, usize, &Depths<L>),
        (host, of_host): (&Current, &Depths<L>),
    ) -> Left {
        let [i, j, k] = FACES[face];
        let [p, q, r] = [in_host[i], in_host[j], in_host[k]];
        let (low, high) = (p.min(q).min(r), p.max(q).max(r));
        let outside = high.at_most(NOISE);
        if outside != 0 {
            // There is no pressure in the skin of the host.
            let flat = low.at_least(-NOISE);
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
            *room = Corner::new(self.lanes, shares, &own.corners[c], host);
        }
        for (room, c) in self.on[0].iter_mut().zip([j, k, i]) {
            *room = OWN << c;
        }
        let inside = low.at_least(0.0);
        for k in 0..4 {
            if inside >> k & 1 == 0 && !self.cut(1 << k, |x| x.shares.get()[k]) {
                return Left::Nothing;
            }
        }
        Left::Polygon
    }

    /// The same, starting from the section of the host by the plane of the face.
    #[inline(always)]
    fn load_section(
        &mut self,
        own: &Current,
        face: usize,
        host: &Current,
        of_host: &Depths<L>,
    ) -> Left {
        let [a, b, c, d] = of_host;
        let depth = [a.get()[face], b.get()[face], c.get()[face], d.get()[face]];
        if !self.section(&depth, host) {
            return Left::Nothing;
        }
        let at = |c: usize| self.at[0][c].point();
        let (x, y, z) = (at(0), at(1), at(2));
        let area = (y - x).cross(&(z - x)) + (z - x).cross(&(at(self.count - 1) - x));
        let inwards = area.dot(&own.slopes[face]) > 0.0;
        self.turn = if inwards { -1.0 } else { 1.0 };
        for k in (0..4).filter(|k| *k != face && of_host.iter().any(|d| d.get()[*k] < 0.0)) {
            let (level, slope) = (own.levels[k], own.slopes[k]);
            if !self.cut(OWN << k, |x| level + slope.dot(&x.point())) {
                return Left::Nothing;
            }
        }
        Left::Polygon
    }

    /// Sets this to the section of a tetrahedron by a plane, from the depths of its corners under the plane;
    /// `false` if there is none.
    #[inline(always)]
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
        // A loop: what maps an array would not be compiled for the instruction set of the lanes.
        for (room, [from, to]) in self.at[0].iter_mut().zip(edges) {
            let share = depth[from] / (depth[from] - depth[to]);
            let [from, to] = [
                Corner::of_host(self.lanes, host, from),
                Corner::of_host(self.lanes, host, to),
            ];
            *room = from.towards(&to, share);
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
    fn cut(&mut self, side: u8, depth: impl Fn(&Corner<L>) -> f64) -> bool {
        let ([first, second], [of_first, of_second]) = (&mut self.at, &mut self.on);
        let (old, new, on, newly_on) = if self.now == 0 {
            (&*first, second, &*of_first, of_second)
        } else {
            (&*second, first, &*of_second, of_first)
        };
        let count = self.count.min(ROOM - 1);
        let all = (1_u32 << count) - 1;
        let mut depths = [0.0; ROOM];
        let mut inside = 0;
        for at in 0..count {
            depths[at] = depth(&old[at]);
            inside |= u32::from(depths[at] >= 0.0) << at;
        }
        if inside == all || inside == 0 {
            return inside > 0;
        }
        // Corners inside after one outside: one, unless the polygon lies in the plane up to round-off.
        let starts = inside & !(inside << 1 | inside >> (count - 1));
        let after = |at: usize| if at + 1 == count { 0 } else { at + 1 };
        let before = |at: usize| if at == 0 { count - 1 } else { at - 1 };
        let mut at = starts.trailing_zeros() as usize;
        new[0] = crossing(old, &depths, [before(at), at]);
        newly_on[0] = side;
        let mut kept = 1;
        while inside >> at & 1 == 1 {
            new[kept % ROOM] = old[at % ROOM];
            newly_on[kept % ROOM] = on[at % ROOM];
            kept += 1;
            at = after(at);
        }
        new[kept % ROOM] = crossing(old, &depths, [before(at), at]);
        newly_on[kept % ROOM] = on[at % ROOM];
        self.count = kept + 1;
        self.now = 1 - self.now;
        true
    }

    /// What the polygon's edges lie on, as bits: 0 to 3 the host's faces, 4 + k face k of the triangle's own
    /// tetrahedron.
    #[inline(always)]
    pub fn edges(&self) -> u8 {
        let on = self.on[self.now].iter().take(self.count);
        on.fold(0, |bits, on| bits | on)
    }

    /// Integrals over the polygon with the given unit normal, and its fluxes; `None` if it comes too near to a node with
    /// pressure. `depths` are those of the host's corners under the plane of the polygon, m.
    #[inline(always)]
    pub fn integrate(
        &self,
        normal: &Vector3,
        host: &Current,
        depths: [f64; 4],
    ) -> Option<(PolygonSums, Flux)> {
        let corners = self.at[self.now].get(..self.count)?;
        let [x, y, rest @ ..] = corners else {
            return None;
        };
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
        let beside_x = |corner: &Corner<L>| {
            let (from, to) = (x.place.get(), corner.place.get());
            [to[u] - from[u], to[v] - from[v]]
        };
        let zero = Row::all(self.lanes, 0.0);
        // Integrals of position and field, of the field times both, and of the squares of both.
        let (mut first, mut moment) = (zero, zero);
        // Of the field times x x, y y, z z.
        let mut spread = zero;
        // Of x x, y y, z z and of x y, y z, z x.
        let (mut squares, mut products) = (zero, zero);
        let (mut area, mut flux, mut volume_flux) = (0.0, zero, zero);
        let mut nearest = x.shares.max(y.shares);
        let of_x = Terms::new(x);
        let (mut y, mut of_y, mut along) = (y, Terms::new(y), beside_x(y));
        for z in rest {
            let (of_z, across) = (Terms::new(z), beside_x(z));
            nearest = nearest.max(z.shares);
            let doubled = (along[0] * across[1] - along[1] * across[0]) * scale;
            area += doubled;
            let sum = x.place + y.place + z.place;
            let field = sum.fourth();
            first += sum * doubled;
            let weighted = of_x.weighted + of_y.weighted + of_z.weighted;
            moment += (sum * field + of_x.weighted + of_y.weighted + of_z.weighted) * doubled;
            let square = sum * sum + of_x.square + of_y.square + of_z.square;
            squares += square * doubled;
            let cubes = of_x.cube + of_y.cube + of_z.cube;
            spread += (square * field + (sum * weighted + cubes) * 2.0) * doubled;
            let product = sum * sum.turned() + of_x.product + of_y.product + of_z.product;
            products += product * doubled;
            let [energy, volume] = flux_of(self.lanes, x.shares, y.shares, z.shares);
            flux += energy * doubled;
            volume_flux += volume * doubled;
            (y, of_y, along) = (z, of_z, across);
        }
        let (first, spread) = (first.get(), spread.get());
        let at_pole = nearest.at_least(1.0 - POLE);
        let values = Row::new(self.lanes, host.values);
        if at_pole & !values.at_most(0.0) != 0 {
            return None;
        }
        let depths = Row::new(self.lanes, depths);
        let energies = (values * depths * flux).get();
        let mut energy = 0.0;
        for (value, part) in host.values.iter().zip(energies) {
            // The flux about a corner without pressure may be infinite.
            if *value > 0.0 {
                energy -= part;
            }
        }
        let volumes = (depths * volume_flux).get();
        let vector = |[x, y, z, _]: [f64; 4], by: f64| Vector3::new(x, y, z) * by;
        let sums = PolygonSums {
            area: area / 2.0,
            first: vector(first, 1.0 / 6.0),
            second: symmetric(squares.get(), products.get()) / 24.0,
            pressure: first[3] / 6.0,
            moment: vector(moment.get(), 1.0 / 24.0),
            spread: (spread[0] + spread[1] + spread[2]) / 120.0,
        };
        Some((
            sums,
            Flux {
                energy: energy / 24.0,
                volume: -volumes[host.pole()] / 6.0,
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
fn symmetric([xx, yy, zz, _]: [f64; 4], [xy, yz, zx, _]: [f64; 4]) -> Matrix3 {
    Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)
}

/// (e_1² - e_2 + e_3 - e_1 e_2 + e_1 e_3)/P and (e_1 - e_2 + e_3)/P with P = (1 - a)(1 - b)(1 - c), see
/// [`skins`](super::skins).
#[inline(always)]
fn flux_of<L: Lanes>(lanes: L, a: Row<L>, b: Row<L>, c: Row<L>) -> [Row<L>; 2] {
    let one = Row::all(lanes, 1.0);
    let (sum, both) = (a + b, a * b);
    let (e1, e2, e3) = (sum + c, both + sum * c, both * c);
    let inverse = one / ((one - a) * (one - b) * (one - c));
    let lost = e1 - e2 + e3;
    [(e1 * lost - e2 + e3) * inverse, lost * inverse]
}

/// Products of position and field at a corner.
#[derive(Clone, Copy)]
struct Terms<L: Lanes> {
    /// Position and field times the field.
    weighted: Row<L>,
    /// x x, y y, z z; the same times the field; x y, y z, z x.
    square: Row<L>,
    cube: Row<L>,
    product: Row<L>,
}

impl<L: Lanes> Terms<L> {
    #[inline(always)]
    fn new(corner: &Corner<L>) -> Self {
        let p = corner.place;
        let (square, field) = (p * p, p.fourth());
        Self {
            weighted: p * field,
            square,
            cube: square * field,
            product: p * p.turned(),
        }
    }
}

/// Where the edge from one corner to another meets the plane from which they have the given depths.
#[inline(always)]
fn crossing<L: Lanes>(
    corners: &[Corner<L>; ROOM],
    depths: &[f64; ROOM],
    [from, to]: [usize; 2],
) -> Corner<L> {
    let (dx, dy) = (depths[from % ROOM], depths[to % ROOM]);
    corners[from % ROOM].towards(&corners[to % ROOM], dx / (dx - dy))
}

impl<L: Lanes> Corner<L> {
    #[inline(always)]
    fn new(lanes: L, shares: Row<L>, x: &Vector3, host: &Current) -> Self {
        let [a, b, c, d] = (shares * Row::new(lanes, host.values)).get();
        Self {
            shares,
            place: Row::new(lanes, [x.x, x.y, x.z, a + b + c + d]),
        }
    }

    /// A corner of the host itself.
    #[inline(always)]
    fn of_host(lanes: L, host: &Current, c: usize) -> Self {
        let mut shares = [0.0; 4];
        shares[c] = 1.0;
        Self::new(lanes, Row::new(lanes, shares), &host.corners[c], host)
    }

    #[inline(always)]
    fn point(&self) -> Vector3 {
        let [x, y, z, _] = self.place.get();
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
