//! Tetrahedra in the local axes of a pair.

use femdem_mesh::Vector3;

/// A tetrahedron in local coordinates.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Posed {
    pub corners: [Vector3; 4],
    /// Outward unit normals, and n.x on the faces.
    pub normals: [Vector3; 4],
    pub offsets: [f64; 4],
    /// The field: level + gradient.x.
    pub gradient: Vector3,
    pub level: f64,
    pub low: Vector3,
    pub high: Vector3,
    /// Largest extent of the box, m.
    pub size: f64,
    /// Bit k: face k lies on the skin.
    pub skin: u8,
}

/// Faces of a tetrahedron relative to another one, as bits.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Across {
    /// Faces that have a corner of the other tetrahedron outside.
    pub cut: u8,
    /// Faces that the other tetrahedron reaches: only they can coincide with one of its faces.
    pub flush: u8,
    /// Largest depth of the other tetrahedron under them, m.
    pub most: [f64; 4],
}

/// Planes within this distance, over the size of the tetrahedra, are tested for coincidence.
const CLOSE: f64 = 1e-5;

impl Posed {
    /// Depth of a point under face k, m.
    #[inline]
    pub fn depth(&self, k: usize, x: &Vector3) -> f64 {
        self.offsets[k] - self.normals[k].dot(x)
    }

    /// Whether the boxes overlap.
    #[inline]
    pub fn is_near(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Positions of the face planes relative to `other`; `None` if it lies outside one of them.
    #[inline]
    pub fn faces_across(&self, other: &Self) -> Option<Across> {
        let mut across = Across::default();
        let close = CLOSE * self.size.max(other.size);
        let [least, most] = self.depths(other);
        for k in 0..4 {
            if most[k] <= 0.0 {
                return None;
            }
            across.cut |= u8::from(least[k] < 0.0) << k;
            across.flush |= u8::from(least[k].abs() <= close) << k;
        }
        across.most = most;
        Some(across)
    }

    /// Its volume, m³.
    pub fn volume(&self) -> f64 {
        let [a, b, c, d] = &self.corners;
        (b - a).cross(&(c - a)).dot(&(d - a)).abs() / 6.0
    }

    /// Least and largest depth of the other's corners under each face, m.
    #[inline]
    fn depths(&self, other: &Self) -> [[f64; 4]; 2] {
        // Component by component, so that several faces are processed at a time.
        let [a, b, c, d] = &self.normals;
        let x = [a.x, b.x, c.x, d.x];
        let y = [a.y, b.y, c.y, d.y];
        let z = [a.z, b.z, c.z, d.z];
        let mut least = [f64::INFINITY; 4];
        let mut most = [f64::NEG_INFINITY; 4];
        for p in &other.corners {
            for k in 0..4 {
                let depth = self.offsets[k] - (x[k] * p.x + y[k] * p.y + z[k] * p.z);
                least[k] = if depth < least[k] { depth } else { least[k] };
                most[k] = if depth > most[k] { depth } else { most[k] };
            }
        }
        [least, most]
    }

    /// A lower bound of the distance along the normals of the faces, m; not above 0 if they do not separate
    /// the two. The other's faces are not tried if those of `self` give more than `enough`.
    pub fn gap(&self, other: &Self, enough: f64) -> f64 {
        let mut gap = f64::NEG_INFINITY;
        for [_, most] in [self.depths(other), other.depths(self)] {
            for most in most {
                gap = if -most > gap { -most } else { gap };
            }
            if gap > enough {
                return gap;
            }
        }
        gap
    }

    /// The part of the volume of another tetrahedron that lies under one of the faces, the least of those under which one corner of it
    /// lies and no more; infinite if there is none. The two have no more than that in common.
    pub fn part_under(&self, other: &Self) -> f64 {
        let mut least = f64::INFINITY;
        for k in 0..4 {
            let depths = other.corners.map(|x| self.depth(k, &x));
            let (mut deepest, mut count) = (0.0, 0);
            for depth in depths {
                if depth > 0.0 {
                    deepest = depth;
                    count += 1;
                }
            }
            if count == 1 {
                // The edges from the corner are cut at d/(d - d_i); its own factor is 1.
                let cut = |depth: f64| {
                    if depth > 0.0 {
                        1.0
                    } else {
                        deepest / (deepest - depth)
                    }
                };
                let part = depths.into_iter().map(cut).product::<f64>();
                least = if part < least { part } else { least };
            }
        }
        least
    }

    /// The motion of the corners towards each other, m, up to which a face separates two tetrahedra with common corners, which stay
    /// so; 0 if none does now. `common`: bit k for corner k of self and of the other.
    pub fn hinge_gap(&self, other: &Self, common: [u8; 2]) -> f64 {
        let gap = self.under_hinge(other, common);
        let turned = other.under_hinge(self, [common[1], common[0]]);
        if turned > gap { turned } else { gap }
    }

    /// The same by the faces of self.
    fn under_hinge(&self, other: &Self, common: [u8; 2]) -> f64 {
        let mut gap = 0.0;
        let own = |k: &usize| common[0] & (1 << k) == 0;
        // Faces that all common corners belong to.
        for k in (0..4).filter(own) {
            let [a, b, c] = [1, 2, 3].map(|i| self.corners[(k + i) % 4]);
            let [p, q, r] = [b - a, c - b, a - c];
            let longest = p.norm_squared().max(q.norm_squared()).max(r.norm_squared());
            let height = p.cross(&r).norm() / longest.sqrt();
            let mut least = f64::INFINITY;
            for (j, x) in other.corners.iter().enumerate() {
                if common[1] & (1 << j) == 0 {
                    // Where its corners move by m, the plane turns by less than m over half its height.
                    let arm = (x - a).norm().max((x - b).norm()).max((x - c).norm());
                    let clear = -self.depth(k, x) / (1.0 + 2.0 * arm / height);
                    least = if clear < least { clear } else { least };
                }
            }
            if least.is_finite() && least > gap {
                gap = least;
            }
        }
        gap
    }

    /// As [`gap`](Self::gap), along normals of an edge of each, m.
    pub fn edge_gap(&self, other: &Self) -> f64 {
        let mut gap = f64::NEG_INFINITY;
        for [i, j] in EDGES {
            let e = self.corners[j] - self.corners[i];
            for [k, l] in EDGES {
                let axis = e.cross(&(other.corners[l] - other.corners[k]));
                let square = axis.norm_squared();
                if square > 0.0 {
                    let (a, b) = (along(&self.corners, &axis), along(&other.corners, &axis));
                    let apart = (a[0] - b[1]).max(b[0] - a[1]);
                    if apart > 0.0 {
                        gap = gap.max(apart / square.sqrt());
                    }
                }
            }
        }
        gap
    }
}

/// The corners of the box around four finite points. (Plain comparisons: `f64::min` also handles NaN.)
#[inline(always)]
pub(crate) fn bounds(corners: &[Vector3; 4]) -> [Vector3; 2] {
    let [first, rest @ ..] = corners;
    let (mut low, mut high) = (*first, *first);
    for x in rest {
        low.zip_apply(x, |l, x| *l = if x < *l { x } else { *l });
        high.zip_apply(x, |h, x| *h = if x > *h { x } else { *h });
    }
    [low, high]
}

/// Largest extent of a box.
#[inline(always)]
pub(crate) fn extent(low: &Vector3, high: &Vector3) -> f64 {
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let d = high - low;
    larger(larger(d.x, d.y), d.z)
}

/// The edges of a tetrahedron.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Least and largest n.x of four corners.
#[inline]
fn along(corners: &[Vector3; 4], n: &Vector3) -> [f64; 2] {
    let [a, b, c, d] = corners.map(|x| n.dot(&x));
    [a.min(b).min(c.min(d)), a.max(b).max(c.max(d))]
}

/// Place of a tetrahedron that has not been posed.
const NOT_YET: u32 = u32::MAX;

/// Tetrahedra of one body, each posed on its first use.
#[derive(Debug)]
pub(crate) struct PosedList<T = Posed> {
    /// Index in `list` by place, or [`NOT_YET`].
    at: Vec<u32>,
    /// The first `used` are posed; the rest is kept as storage.
    list: Vec<T>,
    used: usize,
}

impl<T> Default for PosedList<T> {
    fn default() -> Self {
        Self {
            at: Vec::new(),
            list: Vec::new(),
            used: 0,
        }
    }
}

impl<T: Default> PosedList<T> {
    /// Clears all and provides for `count` places.
    pub fn reset(&mut self, count: usize) {
        self.used = 0;
        self.at.clear();
        self.at.resize(count, NOT_YET);
    }

    /// The tetrahedron of a place, if it has been posed.
    pub fn known(&self, place: u32) -> Option<&T> {
        self.list.get(*self.at.get(place as usize)? as usize)
    }

    /// The tetrahedron of a place, posed on its first use; `None` if there is no such place, or if `pose`
    /// returns no tetrahedron.
    #[inline]
    pub fn get(&mut self, place: u32, pose: impl FnOnce(&mut T) -> Option<()>) -> Option<&T> {
        let at = self.at.get_mut(place as usize)?;
        if *at == NOT_YET {
            if self.used == self.list.len() {
                self.list.push(T::default());
            }
            pose(self.list.get_mut(self.used)?)?;
            *at = self.used as u32;
            self.used += 1;
        }
        self.list.get(*at as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::super::current::Current;
    use super::super::piece::Piece;
    use super::super::pieces::intersect;
    use super::*;

    fn tet(corners: [[f64; 3]; 4]) -> Posed {
        let mut tet = Current::default();
        assert!(tet.deform(
            corners.map(Vector3::from),
            &[0.0, 0.0, 0.0, 1.0],
            1.0,
            0b1111
        ));
        tet.planes()
    }

    /// Two wedges, edge across edge: only the plane along both edges separates them, and the
    /// distance is that of the edges.
    #[test]
    fn crossed_edges_have_their_distance() {
        let below = tet([
            [-1.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, -1.0, -0.5],
            [0.0, 1.0, -0.5],
        ]);
        let above = tet([
            [0.0, -1.0, 0.01],
            [0.0, 1.0, 0.01],
            [-1.0, 0.0, 0.51],
            [1.0, 0.0, 0.51],
        ]);
        assert!(below.gap(&above, f64::INFINITY) <= 0.0);
        assert!((below.edge_gap(&above) - 0.01).abs() < 1e-15);
        assert!((above.edge_gap(&below) - 0.01).abs() < 1e-15);
        assert_eq!(below.edge_gap(&below), f64::NEG_INFINITY);
    }

    /// Numbers from -1 to 1.
    fn noise(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f64 / (1_u64 << 23) as f64 - 1.0
    }

    /// Corners that all move by half the gap do not make two tetrahedra overlap that are joined at one or two of them.
    #[test]
    fn nothing_overlaps_before_the_gap_is_used_up() {
        let mut state = 7;
        let mut piece = Piece::default();
        let mut seen = [0; 2];
        for trial in 0..30_000 {
            let joined = 1 + trial % 2;
            let mut point = || Vector3::from([0; 3].map(|_| noise(&mut state)));
            let mut corners: Vec<Vector3> = (0..8).map(|_| point()).collect();
            let ways: Vec<Vector3> = (0..8).map(|_| point().normalize()).collect();
            // The second begins with the common corners.
            let build = |corners: &[Vector3]| {
                let mut second = [corners[4], corners[5], corners[6], corners[7]];
                second[..joined].copy_from_slice(&corners[..joined]);
                let first = [corners[0], corners[1], corners[2], corners[3]];
                let mut tets = [Current::default(), Current::default()];
                let good = tets[0].deform(first, &[0.0; 4], 1.0, 0)
                    & tets[1].deform(second, &[0.0; 4], 1.0, 0);
                good.then(|| tets.map(|tet| tet.planes()))
            };
            let common = [(1 << joined) - 1; 2];
            let Some([a, b]) = build(&corners) else {
                continue;
            };
            let gap = a.hinge_gap(&b, common);
            if gap == 0.0 {
                continue;
            }
            for (x, way) in corners.iter_mut().zip(&ways) {
                *x += way * (0.4999 * gap);
            }
            if let Some([a, b]) = build(&corners) {
                seen[joined - 1] += 1;
                let common = intersect(&a, &b, &mut piece).map_or(0.0, |_| {
                    piece.moments_and_faces(0, &mut 0, |_, _| ()).volume
                });
                assert!(common < 1e-12, "{joined} {trial} {common}");
            }
        }
        assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
    }

    /// Two tetrahedra have no more in common than is under a face that one corner is under; just that if the other faces cut nothing.
    #[test]
    fn one_corner_bounds_what_two_have_in_common() {
        let mut state = 11;
        let mut piece = Piece::default();
        let (mut bounded, mut met) = (0, 0);
        for trial in 0..20_000 {
            // Half of them lie apart by so much that corners hardly reach each other.
            let away = if trial % 2 == 0 { 0.0 } else { 0.7 };
            let mut build = |middle: f64| {
                let mut point = || Vector3::from([0; 3].map(|_| noise(&mut state)));
                let corners = [0; 4].map(|_| point() + Vector3::x() * middle);
                let mut tet = Current::default();
                tet.deform(corners, &[0.0; 4], 1.0, 0).then(|| tet.planes())
            };
            let (Some(a), Some(b)) = (build(away), build(-away)) else {
                continue;
            };
            let most = a.part_under(&b) * b.volume();
            if most.is_finite() {
                bounded += 1;
                if intersect(&a, &b, &mut piece).is_some() {
                    let common = piece.moments_and_faces(0, &mut 0, |_, _| ()).volume;
                    assert!(common <= most + 1e-14, "{trial} {common} {most}");
                    met += 1;
                }
            }
        }
        assert!(bounded > 1000 && met > 300, "{bounded} {met}");

        let wide = tet([
            [0.0, 0.0, -9.0],
            [9.0, -9.0, 0.0],
            [0.0, 9.0, 0.0],
            [-9.0, -9.0, 0.0],
        ]);
        let peak = tet([
            [0.0, 0.0, -0.01],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 2.0],
            [-1.0, -1.0, 3.0],
        ]);
        intersect(&wide, &peak, &mut piece).expect("they meet");
        let common = piece.moments_and_faces(0, &mut 0, |_, _| ()).volume;
        let most = wide.part_under(&peak) * peak.volume();
        assert!((most / common - 1.0).abs() < 1e-9, "{most} {common}");
        assert!(peak.part_under(&wide) * wide.volume() > most);
    }

    /// A corner over a face: the plane of the face gives the distance.
    #[test]
    fn a_corner_over_a_face_has_its_distance() {
        let below = tet([
            [0.0, 0.0, -1.0],
            [2.0, -2.0, 0.0],
            [0.0, 2.0, 0.0],
            [-2.0, -2.0, 0.0],
        ]);
        let above = tet([
            [0.0, 0.0, 0.02],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
            [-1.0, -1.0, 1.0],
        ]);
        assert!((below.gap(&above, f64::INFINITY) - 0.02).abs() < 1e-15);
        assert!((above.gap(&below, f64::INFINITY) - 0.02).abs() < 1e-15);
    }
}
