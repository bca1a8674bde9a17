//! Planes that separate two tetrahedra, which may have corners in common and stay joined there.
//!
//! The normals of all planes that separate two convex bodies are a convex cone. Its extreme ones belong to faces, or to an edge of
//! each. Their mean lies inside, so that its plane separates for longer than those of the faces as the corners move.

use super::posed::{EDGES, Posed};
use femdem_mesh::Vector3;

/// Planes may be passed by this part of the size where only their mean is used.
const SLACK: f64 = 1e-12;

/// Corners that two tetrahedra have in common: bit k for corner k of the first and of the second.
pub(crate) type Common = [u8; 2];

impl Posed {
    /// The motion up to which a plane across `normal`, from self to the other, separates the two, m: the sum of the ways of
    /// a corner of each. Below 0 if it does not separate them. It goes through the common corners, if any; two of them must lie
    /// across the normal.
    #[inline]
    pub fn gap_along(&self, other: &Self, common: Common, normal: &Vector3) -> f64 {
        let (mut top, mut hinge) = (f64::NEG_INFINITY, 0.0);
        for (k, x) in self.corners.iter().enumerate() {
            let height = normal.dot(x);
            if common[0] >> k & 1 == 1 {
                hinge = height;
            } else if height > top {
                top = height;
            }
        }
        let mut bottom = f64::INFINITY;
        for (k, x) in other.corners.iter().enumerate() {
            let height = normal.dot(x);
            if common[1] >> k & 1 == 0 && height < bottom {
                bottom = height;
            }
        }
        if common[0] == 0 {
            return bottom - top;
        }
        let gap = if hinge - top < bottom - hinge {
            hinge - top
        } else {
            bottom - hinge
        };
        gap / self.turning(other, common)
    }

    /// How much faster than its corners a plane through the common ones may move at the others. A plane through one keeps its
    /// normal; one through an edge turns with it, by less than twice the way of the ends over its length.
    fn turning(&self, other: &Self, common: Common) -> f64 {
        let of_edge = |k: &usize| common[0] >> k & 1 == 1;
        let mut ends = (0..4).filter(of_edge).map(|k| self.corners[k]);
        let (Some(a), Some(b)) = (ends.next(), ends.next()) else {
            return 1.0;
        };
        let mut arm = 0.0;
        for x in self.corners.iter().chain(&other.corners) {
            let far = (x - a).norm().max((x - b).norm());
            arm = if far > arm { far } else { arm };
        }
        1.0 + 2.0 * arm / (b - a).norm()
    }

    /// The normal, from self to the other, of a plane that separates two tetrahedra, through their common corners if they have any.
    pub fn separating_normal(&self, other: &Self, common: Common) -> Option<Vector3> {
        let slack = -SLACK * self.size.max(other.size);
        let mut mean = Vector3::zeros();
        let mut add = |normal: Vector3| {
            if self.gap_along(other, common, &normal) >= slack {
                mean += normal;
            }
        };
        // Faces and edges at all common corners.
        for k in (0..4).filter(|k| common[0] >> k & 1 == 0) {
            add(self.normals[k]);
        }
        for k in (0..4).filter(|k| common[1] >> k & 1 == 0) {
            add(-other.normals[k]);
        }
        if common[0].count_ones() < 2 {
            let has = |ends: [usize; 2], common: u8| {
                common == 0 || ends.iter().any(|k| common >> k & 1 == 1)
            };
            for [i, j] in EDGES.into_iter().filter(|ends| has(*ends, common[0])) {
                let own = self.corners[j] - self.corners[i];
                for [k, l] in EDGES.into_iter().filter(|ends| has(*ends, common[1])) {
                    let normal = own.cross(&(other.corners[l] - other.corners[k]));
                    let length = normal.norm();
                    if length > 0.0 {
                        add(normal / length);
                        add(normal / -length);
                    }
                }
            }
        }
        let length = mean.norm();
        let normal = mean / length;
        (length > 0.0 && self.gap_along(other, common, &normal) >= 0.0).then_some(normal)
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
        let corners = corners.map(Vector3::from);
        assert!(tet.deform(corners, &[0.0; 4], 1.0, 0));
        tet.planes()
    }

    /// Two wedges that meet in a corner, edge across edge: no plane of a face separates them, the plane between the edges does.
    #[test]
    fn wedges_that_meet_in_a_corner() {
        let below = tet([
            [0.0, 0.0, 0.0],
            [2.0, 0.0, -0.1],
            [1.0, -2.0, -1.0],
            [1.0, 2.0, -1.0],
        ]);
        let above = tet([
            [0.0, 0.0, 0.0],
            [0.0, 2.0, 0.1],
            [-2.0, 1.0, 1.0],
            [2.0, 1.0, 1.0],
        ]);
        assert!(below.gap(&above, f64::INFINITY) <= 0.0);
        for common in [[1, 1], [0, 0]] {
            let normal = below.separating_normal(&above, common).unwrap();
            assert!(normal.z > 0.9, "{normal}");
            let gap = below.gap_along(&above, common, &normal);
            // Joined, their ends count, farther away than from the plane z = 0; else the corners that coincide.
            if common[0] == 1 {
                assert!(gap > 0.1, "{gap}");
            } else {
                assert!((0.0..1e-15).contains(&gap), "{gap}");
            }
            let back = above.separating_normal(&below, common).unwrap();
            assert!((back + normal).norm() < 1e-12);
        }
    }

    /// Numbers from -1 to 1.
    fn noise(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f64 / (1_u64 << 23) as f64 - 1.0
    }

    /// Corners that all move by half the gap do not make two tetrahedra overlap that are joined at none, one or two of them.
    #[test]
    fn nothing_overlaps_before_the_gap_is_used_up() {
        let mut state = 7;
        let mut piece = Piece::default();
        let mut seen = [0; 3];
        for trial in 0..30_000 {
            let joined = trial % 3;
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
            let Some(normal) = a.separating_normal(&b, common) else {
                continue;
            };
            let gap = a.gap_along(&b, common, &normal);
            for (x, way) in corners.iter_mut().zip(&ways) {
                *x += way * (0.4999 * gap);
            }
            if let Some([a, b]) = build(&corners) {
                seen[joined] += 1;
                let common = intersect(&a, &b, &mut piece).map_or(0.0, |_| {
                    piece.moments_and_faces(0, &mut 0, |_, _| ()).volume
                });
                assert!(common < 1e-12, "{joined} {trial} {common}");
            }
        }
        assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
    }

    /// What overlaps has no such plane, with and without a common corner.
    #[test]
    fn what_overlaps_is_not_separated() {
        let one = tet([
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ]);
        let two = tet([
            [0.0, 0.0, 0.0],
            [1.0, 0.5, 0.1],
            [0.1, 1.0, 0.2],
            [0.2, 0.1, 1.0],
        ]);
        assert_eq!(one.separating_normal(&two, [1, 1]), None);
        assert_eq!(one.separating_normal(&two, [0, 0]), None);
    }

    /// A common edge: the plane between the two faces beside it.
    #[test]
    fn hinged_at_an_edge() {
        let below = tet([
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.5, -1.0, -0.2],
            [0.5, 1.0, -0.4],
        ]);
        let above = tet([
            [1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.5, -1.0, 0.4],
            [0.5, 1.0, 0.2],
        ]);
        let normal = below.separating_normal(&above, [3, 3]).unwrap();
        assert!(normal.x.abs() < 1e-12 && below.gap_along(&above, [3, 3], &normal) > 0.05);
    }
}
