//! The patches of a contact: parts in which two bodies touch apart from each other.
//!
//! A beam on two feet or a block in a clamp touches the other body in several places. Each is a contact of its own,
//! with its own normal, dashpot and friction: one dashpot for all would let a blow on one foot press the
//! other one down, and would not damp a block between two jaws, whose forces cancel.
//!
//! Triangles of B's skin that share a node belong to one patch, and so do nodes that carry force and share a tetrahedron.
//! The contact energy is known for the pair only; patches share it by F²/K, as linear springs do.

use super::near::Near;
use super::operand::Operand;
use super::sums::PairSums;
use crate::disjoint::{find, join};
use crate::foundation::FoundationSums;
use femdem_mesh::Vector3;

/// One of them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Patch {
    /// Its part of the energy and of the volume of the pair.
    pub share: f64,
    /// Elastic force and torque (about the pair's origin) on A and on B.
    pub wrench: [[Vector3; 2]; 2],
    pub stiffness: FoundationSums,
}

/// All patches of a pair.
#[derive(Debug, Default)]
pub(crate) struct Patches {
    pub list: Vec<Patch>,
    /// The patch of each load; empty if there is one only.
    of_load: Vec<u32>,
    /// That of each node on the list of a side; empty if there is one only.
    of_node: [Vec<u32>; 2],
}

impl Patches {
    pub fn new(sides: &[Operand; 2], near: &Near, sums: &PairSums) -> Self {
        let mut groups = Groups::new(sums.loads.len());
        if let Operand::Deformable(shape, _) = sides[1] {
            let mut corners: Vec<(u32, u32)> = Vec::with_capacity(3 * sums.loads.len());
            for (load, i) in sums.loads.iter().zip(0..) {
                let nodes = shape.skin()[load.triangle as usize];
                corners.extend(nodes.map(|node| (node, i)));
            }
            groups.join_equal(&mut corners);
        }
        if groups.count < 2 {
            return Self::single(sums);
        }
        Self::several(groups, sides, near, sums)
    }

    fn single(sums: &PairSums) -> Self {
        let patch = Patch {
            share: 1.0,
            wrench: sums.wrench,
            stiffness: sums.loads.iter().map(|load| load.stiffness).sum(),
        };
        Self {
            list: vec![patch],
            ..Self::default()
        }
    }

    /// `by_load` holds the loads whose triangles hang together.
    fn several(by_load: Groups, sides: &[Operand; 2], near: &Near, sums: &PairSums) -> Self {
        let loads = sums.loads.len();
        let starts = [loads, loads + near.sides[0].nodes.len()];
        let mut groups = by_load.grown(starts[1] + near.sides[1].nodes.len());
        let carries = |side: usize, node: u32| {
            let force = sums.forces[side].get(node as usize);
            force.is_some_and(|force| *force != Vector3::zeros())
        };
        let place = |side: usize, node: u32| (starts[side] + node as usize) as u32;
        let link = |groups: &mut Groups, side: usize, nodes: &[u32], with: Option<u32>| {
            let mut last = with;
            for &node in nodes.iter().filter(|node| carries(side, **node)) {
                let this = place(side, node);
                if let Some(last) = last {
                    groups.join(last, this);
                }
                last = Some(this);
            }
        };
        for (side, members) in near.sides.iter().enumerate() {
            for nodes in &members.corners {
                link(&mut groups, side, nodes, None);
            }
            for (_, masters) in &members.slaves {
                link(&mut groups, side, masters, None);
            }
            for (load, i) in sums.loads.iter().zip(0..) {
                if let Some(nodes) = members.corners.get(load.hosts[side] as usize) {
                    link(&mut groups, side, nodes, Some(i));
                }
            }
        }
        let numbers = groups.numbers(loads);
        if numbers.count < 2 {
            return Self::single(sums);
        }
        let of_load = numbers.of[..loads].to_vec();
        let of_node = [
            numbers.of[starts[0]..starts[1]].to_vec(),
            numbers.of[starts[1]..].to_vec(),
        ];
        let mut patches = Self {
            list: vec![Patch::default(); numbers.count],
            of_load,
            of_node,
        };
        patches.sum(sides, near, sums);
        patches
    }

    fn sum(&mut self, sides: &[Operand; 2], near: &Near, sums: &PairSums) {
        let mut pressing = vec![0.0; self.list.len()];
        for (i, load) in sums.loads.iter().enumerate() {
            let patch = &mut self.list[self.of_load[i] as usize];
            pressing[self.of_load[i] as usize] += load.force.norm();
            patch.stiffness += load.stiffness;
        }
        let springs = self.list.iter().zip(&pressing);
        let energies: Vec<f64> = springs
            .map(|(patch, force)| force * force / patch.stiffness.total)
            .map(|energy| if energy.is_finite() { energy } else { 0.0 })
            .collect();
        let total: f64 = energies.iter().sum();
        for (patch, energy) in self.list.iter_mut().zip(&energies) {
            patch.share = if total > 0.0 { energy / total } else { 0.0 };
        }
        let Operand::Deformable(shape, positions) = sides[1] else {
            return;
        };
        for (at, force) in sums.forces[1].iter().enumerate() {
            let node = near.sides[1].nodes.get(at);
            let Some(x) = node.and_then(|node| shape.place(*node, positions)) else {
                continue;
            };
            let [of_a, of_b] = &mut self.list[self.of_node[1][at] as usize].wrench;
            let torque = (x - near.origin).cross(force);
            for (wrench, sign) in [(of_a, -1.0), (of_b, 1.0)] {
                wrench[0] += force * sign;
                wrench[1] += torque * sign;
            }
        }
    }

    /// The patch of a load.
    pub fn of_load(&self, load: usize) -> usize {
        patch_of(&self.of_load, load)
    }

    /// The patch of a node on the list of a side.
    pub fn of_node(&self, side: usize, node: usize) -> usize {
        patch_of(&self.of_node[side], node)
    }
}

/// The patch of an entry; the first one if there is one only, and so no list.
fn patch_of(list: &[u32], entry: usize) -> usize {
    if list.is_empty() {
        0
    } else {
        list[entry] as usize
    }
}

/// Things that hang together.
struct Groups {
    root: Vec<u32>,
    count: usize,
}

/// The numbers of the groups of things.
struct Numbers {
    of: Vec<u32>,
    count: usize,
}

impl Groups {
    fn new(things: usize) -> Self {
        Self {
            root: (0..things as u32).collect(),
            count: things,
        }
    }

    /// With more things, each by itself.
    fn grown(mut self, things: usize) -> Self {
        let more = self.root.len() as u32..things as u32;
        self.count += more.len();
        self.root.extend(more);
        self
    }

    fn join(&mut self, a: u32, b: u32) {
        self.count -= usize::from(join(&mut self.root, a, b));
    }

    /// Joins all things with the same key.
    fn join_equal(&mut self, keyed: &mut [(u32, u32)]) {
        keyed.sort_unstable();
        for pair in keyed.windows(2) {
            if pair[0].0 == pair[1].0 {
                self.join(pair[0].1, pair[1].1);
            }
        }
    }

    /// Numbers of the groups of the first `loads` things, in their order; what belongs to none of them goes with the first.
    fn numbers(&self, loads: usize) -> Numbers {
        let mut of_root = vec![0; self.root.len()];
        let mut count = 0;
        for load in 0..loads as u32 {
            if find(&self.root, load) == load {
                of_root[load as usize] = count;
                count += 1;
            }
        }
        let things = 0..self.root.len() as u32;
        Numbers {
            of: things
                .map(|thing| of_root[find(&self.root, thing) as usize])
                .collect(),
            count: count as usize,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_numbered_by_their_first_members() {
        let mut groups = Groups::new(4);
        groups.join_equal(&mut [(7, 0), (9, 1), (7, 2), (8, 3), (9, 1)]);
        assert_eq!(groups.count, 3);
        let mut groups = groups.grown(7);
        groups.join(3, 5);
        groups.join(6, 1);
        let numbers = groups.numbers(4);
        assert_eq!(numbers.count, 3);
        assert_eq!(numbers.of, [0, 1, 0, 2, 0, 2, 1]);
    }
}
