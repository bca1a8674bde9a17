//! Triangles of the surface where a distance function vanishes, by marching tetrahedra.

use crate::{MeshError, Point3, Polyhedron, Vector3};
use std::collections::BTreeMap;

/// Most cells of the lattice.
const MOST_CELLS: f64 = 4e6;
/// Cut points stay at least this part of a lattice edge away from its ends, so that no two coincide.
const CLEARANCE: f64 = 0.15;
/// Rounds of smoothing that make the triangles well-shaped.
const ROUNDS: usize = 12;

/// Triangles with a smaller altitude than this part of a cell count as slivers.
const SMALLEST_ALTITUDE: f64 = 0.1;
/// Number of times that vertices near slivers and cuts go halfway back before all go back completely.
const RETREATS: usize = 24;
/// Largest number of cuts searched for at a time.
const MOST_CUTS: usize = 1000;

/// A body given by its signed distance, negative inside.
pub(super) struct LevelSet<Distance, Project> {
    pub(super) distance: Distance,
    /// A point of the surface near a point near the surface.
    pub(super) project: Project,
    /// Lower corner of a box that holds the body.
    pub(super) low: Point3,
    /// Upper corner of that box.
    pub(super) high: Point3,
    /// Edge of the cubes of the lattice.
    pub(super) cell: f64,
}

/// Position in the body-centred lattice: twice its coordinates in cells. All even: a cube's corner; all odd: a
/// cube's middle.
type Site = [i32; 3];

impl<Distance, Project> LevelSet<Distance, Project>
where
    Distance: Fn(&Point3) -> f64,
    Project: Fn(&Point3) -> Point3,
{
    /// The surface, closed and manifold: every tetrahedron of a body-centred cubic lattice is cut between the
    /// corners inside and outside, then vertices are smoothed along the surface. Where that would make slivers
    /// or let faces cut each other, vertices stay nearer to the cuts of the lattice, with which faces never
    /// cross.
    pub(super) fn polyhedron(&self) -> Result<Polyhedron, MeshError> {
        let size = (self.high - self.low) / self.cell;
        let count = size.map(|x| x.ceil() + 4.0);
        if count.product() > MOST_CELLS {
            return Err(MeshError::OutOfRange {
                what: "the number of cells of the lattice of a clump",
                value: count.product(),
                allowed: "at most 4e6: choose fewer cells, or leave out the smallest spheres",
            });
        }
        let mut cut = Cut {
            surface: self,
            middle: self.low + 0.5 * (self.high - self.low),
            distances: BTreeMap::new(),
            cuts: BTreeMap::new(),
            vertices: Vec::new(),
            polygons: Vec::new(),
        };
        let half = count.map(|x| (0.5 * x).ceil() as i32);
        for i in -half.x..=half.x {
            for j in -half.y..=half.y {
                for k in -half.z..=half.z {
                    cut.tetrahedra_at([2 * i + 1, 2 * j + 1, 2 * k + 1]);
                }
            }
        }
        let Cut {
            vertices: rough,
            polygons,
            ..
        } = cut;
        let mut smooth = rough.clone();
        for _ in 0..ROUNDS {
            smooth = self.smoothed(&smooth, &polygons);
        }
        // The fraction of the way from cut to smoothed position that each vertex moves.
        let mut part = vec![1.0; rough.len()];
        let fallback = body(rough.clone(), &polygons)?;
        for _ in 0..RETREATS {
            let place = |i: usize| rough[i] + (smooth[i] - rough[i]) * part[i];
            match body((0..rough.len()).map(place).collect(), &polygons) {
                Ok(body) => {
                    let bad = self.bad_faces(&body);
                    if bad.is_empty() {
                        return Ok(body);
                    }
                    retreat(&mut part, &body, &bad);
                }
                Err(_) => part.iter_mut().for_each(|part| *part *= 0.5),
            }
        }
        Ok(fallback)
    }

    /// Faces that cut each other, and slivers.
    fn bad_faces(&self, body: &Polyhedron) -> Vec<usize> {
        let floor = SMALLEST_ALTITUDE * self.cell;
        let is_sliver = |face: &[u32]| {
            let at = |k: usize| body.vertices()[face[k % face.len()] as usize];
            let longest = (0..3)
                .map(|k| (at(k + 1) - at(k)).norm())
                .fold(0.0, f64::max);
            (at(1) - at(0)).cross(&(at(2) - at(0))).norm() < floor * longest
        };
        let slivers = body.faces().enumerate().filter(|(_, face)| is_sliver(face));
        let cuts = body.self_intersections(MOST_CUTS);
        slivers
            .map(|(i, _)| i)
            .chain(cuts.into_iter().flatten())
            .collect()
    }

    /// Each vertex moved to the mean of the polygons around it, weighted by area, and projected back to the
    /// surface.
    fn smoothed(&self, vertices: &[Point3], polygons: &[Vec<u32>]) -> Vec<Point3> {
        let mut sums = vec![(Vector3::zeros(), 0.0); vertices.len()];
        for polygon in polygons {
            let at = |k: usize| vertices[polygon[k % polygon.len()] as usize].coords;
            // Of a quadrilateral half the product of the diagonals, of a triangle that of two sides.
            let area = (at(2) - at(0)).cross(&(at(3) - at(1))).norm();
            let middle = (0..polygon.len()).map(at).sum::<Vector3>() / polygon.len() as f64;
            for &i in polygon {
                let sum = &mut sums[i as usize];
                sum.0 += middle * area;
                sum.1 += area;
            }
        }
        sums.iter()
            .map(|(sum, area)| (self.project)(&Point3::from(sum / *area)))
            .collect()
    }
}

fn body(vertices: Vec<Point3>, polygons: &[Vec<u32>]) -> Result<Polyhedron, MeshError> {
    let triangles = polygons
        .iter()
        .flat_map(|polygon| along_shorter_diagonal(&vertices, polygon))
        .collect();
    Polyhedron::new(vertices, triangles)
}

/// Halves the fraction of the vertices of bad faces and of their neighbours.
fn retreat(part: &mut [f64], body: &Polyhedron, bad: &[usize]) {
    let mut marked = vec![false; part.len()];
    for &face in bad {
        for &v in body.face(face) {
            marked[v as usize] = true;
        }
    }
    let mut near = marked.clone();
    for face in body
        .faces()
        .filter(|face| face.iter().any(|&v| marked[v as usize]))
    {
        for &v in face {
            near[v as usize] = true;
        }
    }
    for (part, _) in part.iter_mut().zip(near).filter(|(_, near)| *near) {
        *part *= 0.5;
    }
}

/// A triangle unchanged; a quadrilateral as two triangles.
fn along_shorter_diagonal(vertices: &[Point3], polygon: &[u32]) -> Vec<Vec<u32>> {
    let length = |i: u32, j: u32| (vertices[i as usize] - vertices[j as usize]).norm();
    match *polygon {
        [p, q, r, s] if length(p, r) <= length(q, s) => vec![vec![p, q, r], vec![p, r, s]],
        [p, q, r, s] => vec![vec![p, q, s], vec![q, r, s]],
        _ => vec![polygon.to_vec()],
    }
}

struct Cut<'a, Distance, Project> {
    surface: &'a LevelSet<Distance, Project>,
    /// Origin of the lattice: the middle of the box, for symmetry.
    middle: Point3,
    distances: BTreeMap<Site, f64>,
    cuts: BTreeMap<[Site; 2], u32>,
    vertices: Vec<Point3>,
    /// Triangles and quadrilaterals.
    polygons: Vec<Vec<u32>>,
}

impl<Distance, Project> Cut<'_, Distance, Project>
where
    Distance: Fn(&Point3) -> f64,
    Project: Fn(&Point3) -> Point3,
{
    fn place(&self, site: Site) -> Point3 {
        let [x, y, z] = site.map(|i| 0.5 * f64::from(i) * self.surface.cell);
        self.middle + Vector3::new(x, y, z)
    }

    fn distance(&mut self, site: Site) -> f64 {
        let place = self.place(site);
        *self
            .distances
            .entry(site)
            .or_insert_with(|| (self.surface.distance)(&place))
    }

    /// The tetrahedra around the three faces on the upper sides of a cube's middle.
    fn tetrahedra_at(&mut self, middle: Site) {
        // All sites of these tetrahedra are within twice a cell.
        if self.distance(middle).abs() > 2.0 * self.surface.cell {
            return;
        }
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut beyond = middle;
            beyond[axis] += 2;
            let corner = |du: i32, dv: i32| {
                let mut corner = middle;
                corner[axis] += 1;
                corner[u] += du;
                corner[v] += dv;
                corner
            };
            let around = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
            for k in 0..4 {
                self.tetrahedron([middle, beyond, around[k], around[(k + 1) % 4]]);
            }
        }
    }

    /// Cuts a tetrahedron, positively oriented, between its corners inside and outside.
    fn tetrahedron(&mut self, sites: [Site; 4]) {
        let inside = sites.map(|site| self.distance(site) < 0.0);
        // Even permutations: the corner that is alone, or the two inside, come first.
        let order: [usize; 4] = match inside {
            [true, false, false, false] | [false, true, true, true] => [0, 1, 2, 3],
            [false, true, false, false] | [true, false, true, true] => [1, 0, 3, 2],
            [false, false, true, false] | [true, true, false, true] => [2, 3, 0, 1],
            [false, false, false, true] | [true, true, true, false] => [3, 2, 1, 0],
            [true, true, false, false] => [0, 1, 2, 3],
            [true, false, true, false] => [0, 2, 3, 1],
            [true, false, false, true] => [0, 3, 1, 2],
            [false, true, true, false] => [1, 2, 0, 3],
            [false, true, false, true] => [1, 3, 2, 0],
            [false, false, true, true] => [2, 3, 0, 1],
            [true, true, true, true] | [false, false, false, false] => return,
        };
        let [a, b, c, d] = order.map(|i| sites[i]);
        let polygon = match inside.iter().filter(|&&is| is).count() {
            1 => vec![self.cut(a, b), self.cut(a, c), self.cut(a, d)],
            2 => vec![
                self.cut(a, c),
                self.cut(a, d),
                self.cut(b, d),
                self.cut(b, c),
            ],
            _ => vec![self.cut(b, a), self.cut(d, a), self.cut(c, a)],
        };
        self.polygons.push(polygon);
    }

    /// The vertex on the lattice edge between a site inside and one outside.
    fn cut(&mut self, inside: Site, outside: Site) -> u32 {
        let (from, to) = (self.distance(inside), self.distance(outside));
        let (a, b) = (self.place(inside), self.place(outside));
        let vertices = &mut self.vertices;
        *self.cuts.entry([inside, outside]).or_insert_with(|| {
            let part = (from / (from - to)).clamp(CLEARANCE, 1.0 - CLEARANCE);
            vertices.push(a + (b - a) * part);
            vertices.len() as u32 - 1
        })
    }
}
