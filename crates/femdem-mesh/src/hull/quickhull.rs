//! Quickhull with exact orientation tests: the triangles of a convex hull.

use crate::closest_point;
use crate::{MeshError, Point3, Vector3};
use robust::Coord3D;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// A triangle of the growing hull.
struct Facet {
    corners: [u32; 3],
    /// Facet across the side from corner k to corner k + 1.
    neighbours: [usize; 3],
    normal: Vector3,
    /// Points above this facet and farther than the tolerance from the hull, not yet in it.
    outside: Vec<u32>,
    alive: bool,
}

struct Hull<'a> {
    points: &'a [Point3],
    tolerance: f64,
    facets: Vec<Facet>,
}

/// A side of a hidden facet beyond which the hull is kept: its ends and the facet that is kept.
struct Horizon {
    from: u32,
    to: u32,
    beyond: usize,
}

/// Triangles of the hull, counter-clockwise seen from outside. Points less than `tolerance` from the hull of
/// those already added are left out.
pub(super) fn triangles(points: &[Point3], tolerance: f64) -> Result<Vec<[u32; 3]>, MeshError> {
    let mut hull = Hull {
        points,
        tolerance,
        facets: Vec::new(),
    };
    hull.start(first_simplex(points, tolerance)?);
    let mut next = 0;
    while next < hull.facets.len() {
        if hull.facets[next].alive && !hull.facets[next].outside.is_empty() {
            hull.extend(next)?;
        }
        next += 1;
    }
    Ok(hull
        .facets
        .iter()
        .filter(|f| f.alive)
        .map(|f| f.corners)
        .collect())
}

/// Four points that span a volume, the last one below the triangle of the others.
fn first_simplex(points: &[Point3], tolerance: f64) -> Result<[u32; 4], MeshError> {
    let flat = |span| MeshError::FlatPoints {
        points: points.len(),
        span,
        tolerance,
    };
    let farthest = |measure: &dyn Fn(&Point3) -> f64| {
        let mut best = (0, -1.0);
        for (i, p) in points.iter().enumerate() {
            let value = measure(p);
            if value > best.1 {
                best = (i, value);
            }
        }
        best
    };
    let Some(origin) = points.first() else {
        return Err(flat("coincide"));
    };
    let (a, _) = farthest(&|p| (p - origin).norm());
    let pa = points[a];
    let (b, length) = farthest(&|p| (p - pa).norm());
    if length <= tolerance {
        return Err(flat("coincide"));
    }
    let axis = (points[b] - pa) / length;
    let (c, width) = farthest(&|p| (p - pa).cross(&axis).norm());
    if width <= tolerance {
        return Err(flat("lie on a line"));
    }
    let normal = axis.cross(&(points[c] - pa)).normalize();
    let (d, height) = farthest(&|p| (p - pa).dot(&normal).abs());
    let [a, b, c, d] = [a, b, c, d].map(|i| i as u32);
    let side = above(points, [a, b, c], d);
    if height <= tolerance || side == 0.0 {
        return Err(flat("lie in a plane"));
    }
    Ok(if side < 0.0 {
        [a, b, c, d]
    } else {
        [a, c, b, d]
    })
}

/// Exact sign: positive if `p` lies above the triangle, on the side from which it appears counter-clockwise.
fn above(points: &[Point3], triangle: [u32; 3], p: u32) -> f64 {
    let at = |i: u32| {
        let p = points[i as usize];
        Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        }
    };
    let [a, b, c] = triangle.map(at);
    -robust::orient3d(a, b, c, at(p))
}

impl Hull<'_> {
    fn facet(&self, corners: [u32; 3], neighbours: [usize; 3]) -> Facet {
        let [a, b, c] = corners.map(|i| self.points[i as usize]);
        let normal = (b - a).cross(&(c - a));
        let normal = normal.try_normalize(0.0).unwrap_or(normal);
        Facet {
            corners,
            neighbours,
            normal,
            outside: Vec::new(),
            alive: true,
        }
    }

    fn start(&mut self, [a, b, c, d]: [u32; 4]) {
        let corners = [[a, b, c], [b, a, d], [c, b, d], [a, c, d]];
        let neighbours = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        for (corners, neighbours) in corners.into_iter().zip(neighbours) {
            let facet = self.facet(corners, neighbours);
            self.facets.push(facet);
        }
        self.distribute((0..self.points.len() as u32).collect(), 0);
    }

    fn height(&self, facet: usize, p: u32) -> f64 {
        let Facet {
            corners, normal, ..
        } = &self.facets[facet];
        normal.dot(&(self.points[p as usize] - self.points[corners[0] as usize]))
    }

    fn sees(&self, p: u32, facet: usize) -> bool {
        above(self.points, self.facets[facet].corners, p) > 0.0
    }

    /// Assigns each point to the facet, from `first` on, above which it is highest. Points near the hull are
    /// left out.
    fn distribute(&mut self, loose: Vec<u32>, first: usize) {
        for p in loose {
            let mut best = None;
            let mut highest = -self.tolerance;
            for facet in first..self.facets.len() {
                let height = self.height(facet, p);
                if height > highest && self.sees(p, facet) {
                    (best, highest) = (Some(facet), height);
                }
            }
            if let Some(facet) = best
                && (highest > self.tolerance || !self.is_near(p))
            {
                self.facets[facet].outside.push(p);
            }
        }
    }

    /// Whether a point outside is within the tolerance of the hull. Beyond a sharp rim a point may be far from
    /// the hull and hardly above any of its planes.
    fn is_near(&self, p: u32) -> bool {
        let p = &self.points[p as usize];
        let mut facets = self.facets.iter().filter(|f| f.alive);
        facets.any(|f| {
            let triangle = f.corners.map(|i| self.points[i as usize]);
            (closest_point(&triangle, p) - p).norm() <= self.tolerance
        })
    }

    /// Adds the point highest above a facet to the hull.
    fn extend(&mut self, facet: usize) -> Result<(), MeshError> {
        let mut apex = self.facets[facet].outside[0];
        let mut highest = self.height(facet, apex);
        for &p in &self.facets[facet].outside {
            let height = self.height(facet, p);
            if height > highest {
                (apex, highest) = (p, height);
            }
        }
        let (hidden, horizon) = self.hidden_by(apex, facet);
        let mut loose = Vec::new();
        for &i in &hidden {
            self.facets[i].alive = false;
            loose.append(&mut self.facets[i].outside);
        }
        loose.retain(|&p| p != apex);

        let first = self.facets.len();
        let starting_at: BTreeMap<u32, usize> = horizon
            .iter()
            .enumerate()
            .map(|(k, h)| (h.from, first + k))
            .collect();
        let ending_at: BTreeMap<u32, usize> = horizon
            .iter()
            .enumerate()
            .map(|(k, h)| (h.to, first + k))
            .collect();
        for (k, &Horizon { from, to, beyond }) in horizon.iter().enumerate() {
            let (Some(&next), Some(&previous)) = (starting_at.get(&to), ending_at.get(&from))
            else {
                return Err(self.unresolved());
            };
            let facet = self.facet([from, to, apex], [beyond, next, previous]);
            self.facets.push(facet);
            let across = &mut self.facets[beyond];
            let Some(side) = (0..3).find(|&s| across.corners[s] == to) else {
                return Err(self.unresolved());
            };
            across.neighbours[side] = first + k;
        }
        if starting_at.len() != horizon.len() || ending_at.len() != horizon.len() {
            return Err(self.unresolved());
        }
        self.distribute(loose, first);
        Ok(())
    }

    /// The facets that `apex` sees, and the loop of sides around them.
    fn hidden_by(&self, apex: u32, facet: usize) -> (Vec<usize>, Vec<Horizon>) {
        let mut hidden = vec![facet];
        let mut verdict = BTreeMap::from([(facet, true)]);
        let mut next = 0;
        while let Some(&i) = hidden.get(next) {
            for neighbour in self.facets[i].neighbours {
                if let Entry::Vacant(entry) = verdict.entry(neighbour)
                    && *entry.insert(self.sees(apex, neighbour))
                {
                    hidden.push(neighbour);
                }
            }
            next += 1;
        }
        let mut horizon = Vec::new();
        for &i in &hidden {
            let Facet {
                corners,
                neighbours,
                ..
            } = &self.facets[i];
            for (side, &beyond) in neighbours.iter().enumerate() {
                if verdict.get(&beyond) != Some(&true) {
                    let (from, to) = (corners[side], corners[(side + 1) % 3]);
                    horizon.push(Horizon { from, to, beyond });
                }
            }
        }
        (hidden, horizon)
    }

    fn unresolved(&self) -> MeshError {
        MeshError::HullUnresolved {
            points: self.points.len(),
            tolerance: self.tolerance,
        }
    }
}
