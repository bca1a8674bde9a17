//! Which nodes are split, and along which facets.

use super::min_cut::Graph;
use super::{FractureMode, Strength};
use crate::error::{FemError, check};
use crate::model::ElementStress;
use femdem_mesh::tet::{CrackedMesh, Split};
use femdem_mesh::{Matrix3, Vector3};

/// A tetrahedron whose centroid is farther from the plane than this, over the size of the elements, is on one side of it.
const CLEAR: f64 = 0.35;
/// The least that the farthest one on a side has to be away.
const SOME: f64 = 0.1;

/// What a facet costs beyond its area if it is perpendicular to the plane.
const ASKEW: f64 = 1.5;

/// The smallest part of its energy that a facet takes, however askew.
const LEAST: f64 = 0.05;

/// Beside a node that has just been split, one that is not on a crack waits for the next decision unless its stress is above
/// this part of its strength: the split relieves it.
const BESIDE: f64 = 1.15;

/// A facet to be cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Its number.
    pub facet: u32,
    /// The part of its area that lies in the plane of fracture, |n·d|, at least 0.05. The energy of fracture times this, summed
    /// over a zigzag of facets, is that of the plane.
    pub projection: f64,
    /// The criterion of the node at which it is cut.
    pub mode: FractureMode,
}

/// What a decision cuts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decision {
    /// The facets that are cut now.
    pub cuts: Vec<Cut>,
    /// The nodes that this splits.
    pub splits: Vec<Split>,
    /// Largest stress over strength of a node before; 0 if all are far below 1.
    pub highest: f64,
}

/// What is known when it is decided where a body cracks.
#[derive(Clone, Copy, Debug)]
pub struct NodalDecision<'a> {
    /// Strength of the material.
    pub strength: &'a Strength,
    /// By point of the mesh without cracks, a factor of the strength: see [`Weibull`](super::Weibull).
    pub factors: &'a [f64],
    /// By node, m.
    pub positions: &'a [Vector3],
    /// By tetrahedron, its stress now and its volume in the reference state, m³.
    pub stresses: &'a [ElementStress],
    /// See `stresses`.
    pub volumes: &'a [f64],
}

/// A node at which the strength is exceeded.
struct Failed {
    node: u32,
    ratio: f64,
    mean: Matrix3,
    /// Of the tetrahedra around it, m³.
    volume: f64,
}

/// Facets that separate the tetrahedra around a node along a plane.
struct Separation {
    facets: Vec<u32>,
    normal: Vector3,
    cost: f64,
}

impl NodalDecision<'_> {
    /// Splits the nodes whose mean stress, weighted by the volumes of the tetrahedra around them, exceeds the strength. Nodes
    /// are visited by descending ratio.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] if a list has not the length of the mesh's nodes, points or tetrahedra, or a stress is not
    /// finite.
    pub fn decide(&self, mesh: &mut CrackedMesh) -> Result<Decision, FemError> {
        let tets = mesh.tets().len();
        let nodes = mesh.points().len();
        let points = mesh
            .points()
            .iter()
            .max()
            .map_or(0, |most| *most as usize + 1);
        for (name, found, expected) in [
            ("number of factors of strength", self.factors.len(), points),
            ("number of positions", self.positions.len(), nodes),
            ("number of stresses", self.stresses.len(), tets),
            ("number of volumes", self.volumes.len(), tets),
        ] {
            let allowed = "that of the points, nodes or tetrahedra of the mesh";
            check(name, found as f64, found == expected, allowed)?;
        }
        let failed = self.failed(mesh)?;
        let mut decision = Decision {
            highest: failed.iter().map(|f| f.ratio).fold(0.0, f64::max),
            ..Decision::default()
        };
        let mut positions = self.positions.to_vec();
        let mut beside = vec![false; nodes];
        for failed in failed.iter().take_while(|failed| failed.ratio >= 1.0) {
            let node = failed.node;
            if beside[node as usize] && failed.ratio < BESIDE && !on_crack(mesh, node) {
                continue;
            }
            let (mode, planes) = self.strength.planes(&failed.mean);
            let separations = planes
                .iter()
                .filter_map(|normal| separation(mesh, &positions, failed, normal));
            let cheapest = separations.reduce(|a, b| if b.cost < a.cost { b } else { a });
            let Some(Separation { facets, normal, .. }) = cheapest else {
                continue;
            };
            for t in mesh.around(node) {
                for other in mesh.tets()[*t as usize] {
                    if let Some(beside) = beside.get_mut(other as usize) {
                        *beside = true;
                    }
                }
            }
            for &facet in &facets {
                let projection = of_facet(mesh, facet, &positions)
                    .normalize()
                    .dot(&normal)
                    .abs()
                    .max(LEAST);
                decision.cuts.push(Cut {
                    facet,
                    projection,
                    mode,
                });
            }
            let splits = mesh.cut(&facets)?;
            for split in &splits {
                positions.push(positions[split.node as usize]);
            }
            decision.splits.extend(splits);
        }
        Ok(decision)
    }

    /// The nodes that may be near failure, by descending ratio; those whose ratio is the same, by number.
    fn failed(&self, mesh: &CrackedMesh) -> Result<Vec<Failed>, FemError> {
        let weakest = self.factors.iter().copied().fold(f64::INFINITY, f64::min);
        let mut near = Vec::new();
        for (stress, tet) in self.stresses.iter().zip(mesh.tets()) {
            let bound = self.strength.bound(&stress.cauchy);
            check("stress over strength", bound, bound.is_finite(), "finite")?;
            // A mean is within the bounds of what it is of.
            if bound >= weakest {
                let factor = |node: &u32| self.factors[mesh.points()[*node as usize] as usize];
                near.extend(tet.iter().copied().filter(|node| bound >= factor(node)));
            }
        }
        near.sort_unstable();
        near.dedup();
        let mut failed: Vec<Failed> = near.iter().map(|node| self.at(mesh, *node)).collect();
        failed.sort_by(|a, b| b.ratio.total_cmp(&a.ratio).then(a.node.cmp(&b.node)));
        Ok(failed)
    }

    fn at(&self, mesh: &CrackedMesh, node: u32) -> Failed {
        let (mut mean, mut volume) = (Matrix3::zeros(), 0.0);
        for &t in mesh.around(node) {
            let stress = &self.stresses[t as usize];
            let own = self.volumes[t as usize] * stress.volume_ratio;
            mean += stress.cauchy * own;
            volume += own;
        }
        mean /= volume;
        let factor = self.factors[mesh.points()[node as usize] as usize];
        Failed {
            node,
            ratio: self.strength.ratio(&mean) / factor,
            mean,
            volume,
        }
    }
}

/// Whether a facet that contains the node is cut.
fn on_crack(mesh: &CrackedMesh, node: u32) -> bool {
    let of = |t: &u32| facets_at(mesh, *t, node);
    let mut facets = mesh.around(node).iter().flat_map(of);
    facets.any(|facet| mesh.is_cut()[facet as usize])
}

/// The facets of a tetrahedron that contain a node of it.
fn facets_at(mesh: &CrackedMesh, tet: u32, node: u32) -> impl Iterator<Item = u32> + '_ {
    let corners = mesh.tets()[tet as usize];
    let facets = mesh.facets().of_tets()[tet as usize];
    let opposite = facets.into_iter().zip(corners);
    opposite.filter_map(move |(facet, corner)| facet.filter(|_| corner != node))
}

/// Twice the area of a facet as a vector, m².
fn of_facet(mesh: &CrackedMesh, facet: u32, positions: &[Vector3]) -> Vector3 {
    let sides = mesh.sides(facet).unwrap_or_default();
    let [a, b, c] = sides[0].map(|node| positions[node as usize]);
    (b - a).cross(&(c - a))
}

/// The cheapest facets that separate the tetrahedra around a node along a plane through it; `None` if they are all on one side.
fn separation(
    mesh: &CrackedMesh,
    positions: &[Vector3],
    failed: &Failed,
    normal: &Vector3,
) -> Option<Separation> {
    let around = mesh.around(failed.node);
    let origin = positions[failed.node as usize];
    let size = (6.0 * failed.volume / around.len() as f64).cbrt();
    let height = |t: &u32| {
        let corners = mesh.tets()[*t as usize].map(|node| positions[node as usize]);
        let centre = corners.iter().sum::<Vector3>() * 0.25;
        (centre - origin).dot(normal) / size
    };
    let heights: Vec<f64> = around.iter().map(height).collect();
    let farthest = |sign: f64| heights.iter().map(|z| sign * z).fold(0.0, f64::max);
    let [above, below] = [farthest(1.0), farthest(-1.0)];
    if above < SOME || below < SOME {
        return None;
    }
    // The last two nodes of the graph are the two sides.
    let (source, sink) = (around.len(), around.len() + 1);
    let mut graph = Graph::new(around.len() + 2);
    for (i, z) in heights.iter().enumerate() {
        if *z >= above.min(CLEAR) {
            graph.join(source, i, f64::INFINITY);
        } else if -*z >= below.min(CLEAR) {
            graph.join(i, sink, f64::INFINITY);
        }
    }
    let mut joints = Vec::new();
    for (i, &t) in around.iter().enumerate() {
        for facet in facets_at(mesh, t, failed.node) {
            let [first, second] = mesh.facets().all()[facet as usize].tets;
            // Each once, and what is cut costs nothing.
            if first != t || mesh.is_cut()[facet as usize] {
                continue;
            }
            let Ok(j) = around.binary_search(&second) else {
                continue;
            };
            let twice = of_facet(mesh, facet, positions);
            let area = 0.5 * twice.norm();
            let cost = area * (1.0 + ASKEW) - ASKEW * 0.5 * twice.dot(normal).abs();
            graph.join(i, j, cost);
            joints.push((facet, i, j));
        }
    }
    let (side, cost) = graph.cut(source, sink);
    let cut = joints.iter().filter(|(_, i, j)| side[*i] != side[*j]);
    let facets: Vec<u32> = cut.map(|(facet, ..)| *facet).collect();
    (cost.is_finite() && !facets.is_empty()).then_some(Separation {
        facets,
        normal: *normal,
        cost,
    })
}
