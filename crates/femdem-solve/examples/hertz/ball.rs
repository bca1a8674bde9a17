//! Balls meshed finely around their lowest point.

use femdem_mesh::{MeshError, Point3, TetMesh, Vector3};
use std::collections::BTreeMap;

/// Cells of the lattice along half an edge of the cube that becomes the ball. Even, so that lattices of
/// whole and of half balls are mirrored in the same way.
const CELLS: i32 = 2;

/// The ways from a corner of a cell to the opposite one along its edges: six tetrahedra (H. W. Kuhn).
const WAYS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

/// A ball, or its lower half, about the origin.
#[derive(Debug, Clone, Copy)]
pub struct Ball {
    pub radius: f64,
    /// Whether it is a whole ball, with the upper half.
    pub whole: bool,
    /// Edge length, m, up to the distance `reach` (m) from the lowest point; beyond, edges grow in proportion
    /// to the distance, up to `coarsest`.
    pub finest: f64,
    pub reach: f64,
    pub coarsest: f64,
}

/// Image in the unit ball of a point of the cube of half edge 1.
fn rounded(p: &Vector3) -> Vector3 {
    let [x, y, z] = [p.x * p.x, p.y * p.y, p.z * p.z];
    let factor = |a: f64, b: f64| (1.0 - 0.5 * (a + b) + a * b / 3.0).sqrt();
    Vector3::new(p.x * factor(y, z), p.y * factor(z, x), p.z * factor(x, y))
}

/// Tetrahedra of a mesh that is bisected, with the corner that makes the next edge to be cut with the
/// first (J. M. Maubach, SIAM J. Sci. Comput. 16 (1995) 210-227).
struct Bisection {
    /// In the cube.
    points: Vec<Vector3>,
    tets: Vec<([u32; 4], usize)>,
    middles: BTreeMap<[u32; 2], u32>,
}

impl Bisection {
    /// A lattice over the cube, or over its lower half.
    fn lattice(whole: bool) -> Self {
        let mut index = BTreeMap::new();
        let mut points = Vec::new();
        let mut at = |c: [i32; 3]| {
            *index.entry(c).or_insert_with(|| {
                points.push(Vector3::from(c.map(f64::from)) / f64::from(CELLS));
                points.len() as u32 - 1
            })
        };
        let mut tets = Vec::new();
        let top = if whole { CELLS } else { 0 };
        for z in -CELLS..top {
            for y in -CELLS..CELLS {
                for x in -CELLS..CELLS {
                    // Neighbours are mirror images of each other.
                    let odd = [x, y, z].map(|c| c.rem_euclid(2));
                    let start = [x + odd[0], y + odd[1], z + odd[2]];
                    for way in WAYS {
                        let mut c = start;
                        let mut tet = [at(c); 4];
                        for (corner, axis) in tet[1..].iter_mut().zip(way) {
                            c[axis] += 1 - 2 * odd[axis];
                            *corner = at(c);
                        }
                        tets.push((tet, 3));
                    }
                }
            }
        }
        Self {
            points,
            tets,
            middles: BTreeMap::new(),
        }
    }

    fn middle(&mut self, a: u32, b: u32) -> u32 {
        let points = &mut self.points;
        *self.middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]) * 0.5);
            points.len() as u32 - 1
        })
    }

    /// Bisects all tetrahedra for which `coarse` holds, until there are none and no edge has a point on it.
    fn refine(&mut self, coarse: impl Fn([Vector3; 4]) -> bool) {
        loop {
            let mut changed = false;
            for (tet, k) in std::mem::take(&mut self.tets) {
                let hangs = (0..4)
                    .flat_map(|i| (0..i).map(move |j| (i, j)))
                    .any(|(i, j)| {
                        let (a, b) = (tet[i], tet[j]);
                        self.middles.contains_key(&[a.min(b), a.max(b)])
                    });
                if !hangs && !coarse(tet.map(|i| self.points[i as usize])) {
                    self.tets.push((tet, k));
                    continue;
                }
                changed = true;
                let middle = self.middle(tet[0], tet[k]);
                let (mut first, mut second) = (tet, tet);
                first[k] = middle;
                second.copy_within(1..=k, 0);
                second[k] = middle;
                let next = if k > 1 { k - 1 } else { 3 };
                self.tets.extend([(first, next), (second, next)]);
            }
            if !changed {
                return;
            }
        }
    }
}

impl Ball {
    /// The mesh.
    ///
    /// # Errors
    /// If lengths make no mesh.
    pub fn mesh(&self) -> Result<TetMesh, MeshError> {
        let place = |p: &Vector3| rounded(p) * self.radius;
        let pole = Vector3::new(0.0, 0.0, -self.radius);
        let coarse = |corners: [Vector3; 4]| {
            let corners = corners.map(|p| place(&p));
            let near = corners.map(|x| (x - pole).norm());
            let near = near.into_iter().fold(f64::INFINITY, f64::min);
            let wanted = (self.finest * (near / self.reach).max(1.0)).min(self.coarsest);
            let mut longest = 0.0_f64;
            for i in 0..4 {
                for j in 0..i {
                    longest = longest.max((corners[i] - corners[j]).norm());
                }
            }
            // The longest edge of such tetrahedra is about 1.5 times the mean.
            longest > 1.5 * wanted
        };
        let mut parts = Bisection::lattice(self.whole);
        parts.refine(coarse);
        let points: Vec<Point3> = parts.points.iter().map(|p| place(p).into()).collect();
        let tets = parts.tets.iter().map(|(tet, _)| {
            let [a, b, c, d] = tet.map(|i| points[i as usize]);
            let right = (b - a).dot(&(c - a).cross(&(d - a))) > 0.0;
            if right {
                *tet
            } else {
                [tet[1], tet[0], tet[2], tet[3]]
            }
        });
        let tets = tets.collect();
        TetMesh::new(points, tets)
    }

    /// Mean edge of the skin's triangles within the reach of the lowest point, m.
    pub fn edge(&self, mesh: &TetMesh) -> f64 {
        let pole = Point3::new(0.0, 0.0, -self.radius);
        let (mut sum, mut count) = (0.0, 0);
        for triangle in mesh.skin() {
            let corners = triangle.map(|i| mesh.points()[i as usize]);
            if corners.iter().all(|x| (x - pole).norm() < self.reach) {
                for k in 0..3 {
                    sum += (corners[k] - corners[(k + 1) % 3]).norm();
                    count += 1;
                }
            }
        }
        sum / f64::from(count)
    }
}

/// Hertz's contact of elastic bodies, in the form common to a ball on a rigid plane and to each of two equal
/// balls: the plane between them does not move.
#[derive(Debug, Clone, Copy)]
pub struct Hertz {
    pub young: f64,
    pub poisson: f64,
    pub radius: f64,
}

impl Hertz {
    fn modulus(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }

    /// Force, N, at the approach `d` of the centre and the plane, m.
    pub fn force(&self, d: f64) -> f64 {
        4.0 / 3.0 * self.modulus() * self.radius.sqrt() * d.powf(1.5)
    }

    /// Contact radius, m.
    pub fn contact_radius(&self, d: f64) -> f64 {
        (self.radius * d).sqrt()
    }

    /// Largest pressure, Pa.
    pub fn peak_pressure(&self, d: f64) -> f64 {
        2.0 / std::f64::consts::PI * self.modulus() * (d / self.radius).sqrt()
    }

    /// Largest approach to the plane, m, of a ball of mass `m` that hits it at speed `v`.
    pub fn largest_approach(&self, m: f64, v: f64) -> f64 {
        (15.0 * m * v * v / (16.0 * self.modulus() * self.radius.sqrt())).powf(0.4)
    }

    /// Time in contact of such an impact, s: 2.9432 d/v.
    pub fn duration(&self, m: f64, v: f64) -> f64 {
        2.943_275 * self.largest_approach(m, v) / v
    }
}
