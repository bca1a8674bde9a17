//! Division of space among bodies: cubes that are halved until each has one owner, or is a leaf.

use femdem_mesh::{Point3, Vector3};

use super::field::Fields;
use super::plane_cut::share_below;
use crate::bounds::Bounds;
use crate::clip::Clipper;
use crate::region::{Region, Relation};

/// Parts of a cube up to this share of it are rounding errors in a cube that others own, not parts of a cell.
const ROUNDING: f64 = 1e-10;

/// A body that may own a part of a cube, with its distance from the cube's centre and its gradient.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    body: usize,
    distance: f64,
    gradient: Vector3,
}

/// A part of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub(super) body: usize,
    /// Volume (m³).
    pub(super) volume: f64,
    /// Whether the part lies at the region's boundary.
    pub(super) at_boundary: bool,
}

/// Memory to be reused.
#[derive(Default)]
pub(super) struct Memory {
    heights: Vec<f64>,
    clipper: Clipper,
    shares: Vec<Share>,
}

pub(super) struct Octree<'a> {
    pub(super) fields: &'a Fields<'a>,
    pub(super) region: &'a Region,
    /// How often a root is halved, and once more where three bodies or more meet.
    pub(super) levels: u32,
}

impl Octree<'_> {
    /// Divides the part of a root in the region among `bodies`, which must include all that own some of it.
    pub(super) fn share_out(
        &self,
        memory: &mut Memory,
        root: &Bounds,
        bodies: impl Iterator<Item = usize>,
    ) -> Vec<Share> {
        memory.shares.clear();
        let unknown = |body| Candidate {
            body,
            distance: f64::NEG_INFINITY,
            gradient: Vector3::zeros(),
        };
        let candidates: Vec<Candidate> = bodies.map(unknown).collect();
        self.visit(memory, root, &candidates, 0);
        merged(&mut memory.shares)
    }

    fn visit(&self, memory: &mut Memory, cube: &Bounds, from: &[Candidate], level: u32) {
        let relation = self.region.relation(cube);
        if relation == Relation::Outside {
            return;
        }
        let (centre, half) = cube.middle_and_half();
        let kept = self.nearest(memory, &centre, half.norm(), from);
        let near_leaf = level >= self.levels;
        let kept = if near_leaf {
            owners_if_linear(kept, &half)
        } else {
            kept
        };
        if let [owner] = kept.as_slice() {
            let volume = self.volume_in_region(memory, cube, relation);
            self.give(memory, cube, owner.body, volume);
        } else if level > self.levels || near_leaf && kept.len() == 2 {
            self.share_leaf(memory, cube, &kept, relation);
        } else {
            for octant in 0..8_usize {
                let mut part = Bounds {
                    min: cube.min,
                    max: centre,
                };
                for k in 0..3 {
                    if octant >> k & 1 == 1 {
                        part.min[k] = centre[k];
                        part.max[k] = cube.max[k];
                    }
                }
                self.visit(memory, &part, &kept, level + 1);
            }
        }
    }

    /// The candidates that may be nearest somewhere within `radius` of `centre`, nearest first. Distances
    /// change by no more than the displacement of the point, so that theirs are at most the smallest one plus
    /// two radii.
    fn nearest(
        &self,
        memory: &mut Memory,
        centre: &Point3,
        radius: f64,
        from: &[Candidate],
    ) -> Vec<Candidate> {
        let mut least = f64::INFINITY;
        let mut kept = Vec::with_capacity(from.len());
        for candidate in from {
            let limit = least + 2.0 * radius;
            // Its distance was computed at the centre of the parent cube, one radius away.
            if candidate.distance - radius > limit {
                continue;
            }
            let found = self
                .fields
                .distance(&mut memory.heights, candidate.body, centre, limit);
            if let Some((distance, gradient)) = found {
                least = least.min(distance);
                kept.push(Candidate {
                    body: candidate.body,
                    distance,
                    gradient,
                });
            }
        }
        kept.retain(|c| c.distance <= least + 2.0 * radius);
        kept.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.body.cmp(&b.body)));
        kept
    }

    /// In a leaf distances are linearised, so that the border of two bodies is a plane.
    fn share_leaf(
        &self,
        memory: &mut Memory,
        cube: &Bounds,
        kept: &[Candidate],
        relation: Relation,
    ) {
        let (centre, half) = cube.middle_and_half();
        if let ([near, far], Relation::Inside) = (kept, relation) {
            let volume = 8.0 * half.product();
            let slope = near.gradient - far.gradient;
            let share = share_below(&slope.component_mul(&half), far.distance - near.distance);
            self.give(memory, cube, near.body, volume * share);
            self.give(memory, cube, far.body, volume * (1.0 - share));
            return;
        }
        let mut left = self.volume_in_region(memory, cube, relation);
        for (k, owner) in kept.iter().enumerate() {
            if k + 1 == kept.len() {
                self.give(memory, cube, owner.body, left);
                continue;
            }
            memory.clipper.load_box(cube);
            for other in kept.iter().take(k).chain(kept.iter().skip(k + 1)) {
                let slope = owner.gradient - other.gradient;
                let offset = other.distance - owner.distance;
                memory
                    .clipper
                    .clip(&slope, offset + slope.dot(&centre.coords));
            }
            let volume = match relation {
                Relation::Inside => memory.clipper.volume(),
                _ => memory.clipper.volume_in(self.region),
            };
            left -= volume;
            self.give(memory, cube, owner.body, volume);
        }
    }

    fn volume_in_region(&self, memory: &mut Memory, cube: &Bounds, relation: Relation) -> f64 {
        if relation == Relation::Inside {
            return (cube.max - cube.min).product();
        }
        memory.clipper.load_box(cube);
        memory.clipper.volume_in(self.region)
    }

    fn give(&self, memory: &mut Memory, cube: &Bounds, body: usize, volume: f64) {
        if volume > ROUNDING * (cube.max - cube.min).product() {
            let at_boundary = !self.is_interior(cube);
            memory.shares.push(Share {
                body,
                volume,
                at_boundary,
            });
        }
    }

    /// Whether a cube is wholly in the region and does not touch its boundary.
    fn is_interior(&self, cube: &Bounds) -> bool {
        let margin = (cube.max - cube.min) * 1e-6;
        let grown = Bounds {
            min: cube.min - margin,
            max: cube.max + margin,
        };
        self.region.relation(&grown) == Relation::Inside
    }
}

/// Those of the candidates, nearest first, that own a part of a cube where distances are linear: the first, and
/// those that are below it in a corner.
fn owners_if_linear(mut candidates: Vec<Candidate>, half: &Vector3) -> Vec<Candidate> {
    if let Some(first) = candidates.first().copied() {
        let comes_below = |c: &Candidate| {
            c.distance - first.distance < (c.gradient - first.gradient).abs().dot(half)
        };
        let mut index = 0;
        candidates.retain(|c| {
            index += 1;
            index == 1 || comes_below(c)
        });
    }
    candidates
}

/// One share per body, ascending.
fn merged(shares: &mut [Share]) -> Vec<Share> {
    // A stable sort: a body's shares are summed in the order in which they were found.
    shares.sort_by_key(|s| s.body);
    let one = |group: &[Share]| Share {
        body: group[0].body,
        volume: group.iter().map(|s| s.volume).sum(),
        at_boundary: group.iter().any(|s| s.at_boundary),
    };
    shares.chunk_by(|a, b| a.body == b.body).map(one).collect()
}
