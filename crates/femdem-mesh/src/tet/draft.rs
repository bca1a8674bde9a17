//! A mesh whose points still move: on their patch or sharp edge of the surface, or freely inside.

use super::features::{Features, Place};
use super::quality::radius_ratio;
use super::stuffing::Stuffed;
use super::{TetMesh, topology};
use crate::{MeshError, Point3, Vector3};

/// Points within this part of the lattice's length of a sharp edge or corner lie on it.
const ON_FEATURE: f64 = 1e-5;
/// Tetrahedra of a radius ratio below this are worth improving.
const GOAL: f64 = 0.35;

/// Points, tetrahedra and the constraints on their motion.
pub(super) struct Draft<'a> {
    features: &'a Features,
    length: f64,
    pub(super) points: Vec<Point3>,
    pub(super) places: Vec<Place>,
    pub(super) tets: Vec<[u32; 4]>,
    /// The tetrahedra at each point.
    pub(super) at: Vec<Vec<u32>>,
}

impl<'a> Draft<'a> {
    /// Determines where the points of a stuffed lattice lie.
    pub(super) fn new(
        features: &'a Features,
        stuffed: Stuffed,
        length: f64,
    ) -> Result<Self, MeshError> {
        let Stuffed { points, tets } = stuffed;
        let mut at = vec![Vec::new(); points.len()];
        for (i, tet) in tets.iter().enumerate() {
            tet.iter().for_each(|&p| at[p as usize].push(i as u32));
        }
        let mut places = vec![Place::Inside; points.len()];
        for point in topology::connect(&tets)?.1.into_iter().flatten() {
            let i = point as usize;
            if places[i] == Place::Inside {
                places[i] = features.place(&points[i], ON_FEATURE * length);
            }
        }
        Ok(Self {
            features,
            length,
            points,
            places,
            tets,
            at,
        })
    }

    /// The skin's triangles.
    pub(super) fn skin(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        Ok(topology::connect(&self.tets)?.1)
    }

    pub(super) fn finish(self) -> Result<TetMesh, MeshError> {
        TetMesh::new(self.points, self.tets)
    }

    /// Smallest radius ratio at a point, if it lay at `position`; stops early below `enough`.
    pub(super) fn worst_at(&self, point: u32, position: Point3, enough: f64) -> f64 {
        let mut worst = f64::INFINITY;
        for &tet in &self.at[point as usize] {
            let corners = self.tets[tet as usize].map(|i| {
                if i == point {
                    position
                } else {
                    self.points[i as usize]
                }
            });
            worst = worst.min(radius_ratio(corners));
            if worst < enough {
                break;
            }
        }
        worst
    }

    /// Moves a point to `position` in a new place, unless this leaves a tetrahedron with a radius ratio below
    /// `floor`.
    pub(super) fn try_move(
        &mut self,
        point: u32,
        position: Point3,
        place: Place,
        floor: f64,
    ) -> bool {
        let accepted = self.worst_at(point, position, floor) >= floor;
        if accepted {
            self.points[point as usize] = position;
            self.places[point as usize] = place;
        }
        accepted
    }

    /// The position allowed for a point in its place that is nearest to `position`.
    fn allowed(&self, point: u32, position: &Point3) -> Option<Point3> {
        match self.places[point as usize] {
            Place::Inside => Some(*position),
            Place::Patch(patch) => self.features.nearest_on_patch(position, patch),
            Place::Chain(chain) => self.features.nearest_on_chain(position, chain),
            Place::Corner(_) => None,
        }
    }

    /// Moves the points of badly shaped tetrahedra, one at a time, where that improves the worst
    /// shape at the point.
    pub(super) fn smooth(&mut self, sweeps: usize) {
        for _ in 0..sweeps {
            let mut moved = false;
            for tet in 0..self.tets.len() {
                let corners = self.tets[tet];
                for point in corners {
                    let shape = self.tets[tet].map(|i| self.points[i as usize]);
                    if radius_ratio(shape) < GOAL {
                        moved |= self.improve(point);
                    }
                }
            }
            if !moved {
                break;
            }
        }
    }

    /// Tries positions around a point, and the mean of its neighbours; takes the best.
    fn improve(&mut self, point: u32) -> bool {
        let here = self.points[point as usize];
        if matches!(self.places[point as usize], Place::Corner(_)) {
            return false;
        }
        let old = self.worst_at(point, here, f64::NEG_INFINITY);
        let (mut best, mut best_position) = (old, here);
        let mean = self.mean_around(point);
        let steps = [0.2, 0.07, 0.02].map(|s| s * self.length);
        let ways = (0..14).map(|i| match i {
            0..8 => {
                Vector3::from([0, 1, 2].map(|k| f64::from(2 * (i >> k & 1) - 1))) / 3_f64.sqrt()
            }
            _ => Vector3::from([0, 1, 2].map(|k| {
                if (i - 8) / 2 == k {
                    f64::from(2 * (i & 1) - 1)
                } else {
                    0.0
                }
            })),
        });
        let around = ways.flat_map(|way| steps.map(|step| here + step * way));
        let towards = [0.25, 0.5, 1.0].map(|part| here + part * (mean - here));
        for position in towards.into_iter().chain(around) {
            let Some(position) = self.allowed(point, &position) else {
                continue;
            };
            let worst = self.worst_at(point, position, best);
            if worst > best {
                (best, best_position) = (worst, position);
            }
        }
        self.points[point as usize] = best_position;
        best > old + 1e-3
    }

    fn mean_around(&self, point: u32) -> Point3 {
        let tets = self.at[point as usize]
            .iter()
            .map(|&t| self.tets[t as usize]);
        let mut others: Vec<u32> = tets.flatten().filter(|&i| i != point).collect();
        others.sort_unstable();
        others.dedup();
        let here = self.points[point as usize];
        let offsets = others.iter().map(|&i| self.points[i as usize] - here);
        here + offsets.sum::<Vector3>() / others.len().max(1) as f64
    }

    /// Cuts all tetrahedra at the edge from a to b in two, by a new point, unless that leaves a
    /// radius ratio below `floor`.
    pub(super) fn try_split(
        &mut self,
        [a, b]: [u32; 2],
        position: Point3,
        place: Place,
        floor: f64,
    ) -> bool {
        let new = self.points.len() as u32;
        let with_b = |tet: &&u32| self.tets[**tet as usize].contains(&b);
        let ring: Vec<u32> = self.at[a as usize].iter().filter(with_b).copied().collect();
        let half =
            |tet: u32, end: u32| self.tets[tet as usize].map(|i| if i == end { new } else { i });
        let point = |i: u32| {
            if i == new {
                position
            } else {
                self.points[i as usize]
            }
        };
        let shape = |tet: [u32; 4]| tet.map(point);
        let good = |tet: [u32; 4]| radius_ratio(shape(tet)) >= floor;
        if !ring
            .iter()
            .all(|&tet| good(half(tet, a)) && good(half(tet, b)))
        {
            return false;
        }
        self.points.push(position);
        self.places.push(place);
        self.at.push(Vec::new());
        for tet in ring {
            let old = self.tets[tet as usize];
            let (first, second) = (
                old.map(|i| if i == b { new } else { i }),
                old.map(|i| if i == a { new } else { i }),
            );
            let added = self.tets.len() as u32;
            self.tets[tet as usize] = first;
            self.tets.push(second);
            self.at[b as usize].retain(|&t| t != tet);
            for point in second {
                self.at[point as usize].push(added);
            }
            self.at[new as usize].push(tet);
        }
        true
    }
}

/// The edges of triangles, each once, sorted.
pub(super) fn edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let all = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<[u32; 2]> = all.filter(|[a, b]| a < b).collect();
    edges.sort_unstable();
    edges
}
