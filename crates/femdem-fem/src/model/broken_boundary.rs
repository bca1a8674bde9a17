//! What becomes of the boundary conditions of a body that cracks, and breaks.

use super::Boundary;
use super::boundary::{Hold, in_order};
use super::loads::Load;
use femdem_mesh::tet::{FACES, Split};

impl Boundary {
    /// Follows the nodes of a body that have been split, in the order of the splits: what is prescribed for a node holds for the
    /// new one too, and loads stay on the faces on which they were, if their elements are there. `tets` are the nodes of the elements now, and `points`
    /// says by node which point of the mesh without cracks it was.
    pub fn follow(&mut self, splits: &[Split], tets: &[[u32; 4]], points: &[u32]) {
        for split in splits {
            let of_node: Vec<Hold> = self
                .holds
                .iter()
                .filter(|hold| hold.node == split.node)
                .map(|hold| Hold {
                    node: split.new,
                    ..*hold
                })
                .collect();
            self.holds.extend(of_node);
            for nodes in self.sets.values_mut() {
                if nodes.contains(&split.node) {
                    nodes.push(split.new);
                }
            }
        }
        self.holds = in_order(std::mem::take(&mut self.holds));
        if self.loads.is_empty() {
            return;
        }
        // A face of the skin belongs to one tetrahedron, however its nodes are numbered.
        let key = |nodes: [u32; 3]| {
            let mut key = nodes.map(|node| points.get(node as usize).copied());
            key.sort_unstable();
            key
        };
        let of_tet = |tet: &[u32; 4]| FACES.map(|face| face.map(|i| tet[i]));
        let mut faces: Vec<_> = tets
            .iter()
            .flat_map(of_tet)
            .map(|face| (key(face), face))
            .collect();
        faces.sort_unstable();
        let stays = |face: &mut Vec<u32>| {
            let Ok(nodes) = <[u32; 3]>::try_from(face.as_slice()) else {
                return true;
            };
            let at = faces.partition_point(|(other, _)| *other < key(nodes));
            let Some((_, found)) = faces.get(at).filter(|(other, _)| *other == key(nodes)) else {
                return false;
            };
            // In the order in which the face was given.
            let same = |node: u32| {
                let is_same =
                    |other: &u32| points.get(*other as usize) == points.get(node as usize);
                found.iter().copied().find(is_same)
            };
            for node in face {
                *node = same(*node).unwrap_or(*node);
            }
            true
        };
        for load in &mut self.loads {
            load.faces.retain_mut(stays);
        }
        self.loads.retain(|load| !load.faces.is_empty());
    }

    /// Those of the conditions that are on a part of the body, which has broken off: `number` gives the nodes of the part their numbers
    /// in it. Loads stay on the faces whose nodes are all of the part.
    #[must_use]
    pub fn part(&self, number: impl Fn(u32) -> Option<u32>) -> Self {
        let mut part = Self {
            gravity: self.gravity,
            ..Self::default()
        };
        let own = |hold: &Hold| number(hold.node).map(|node| Hold { node, ..*hold });
        let holds: Vec<Hold> = self.holds.iter().filter_map(own).collect();
        let mut drives = vec![0; self.drives.len()];
        for (k, drive) in self.drives.iter().enumerate() {
            drives[k] = part.drives.len() as u32;
            if holds.iter().any(|hold| hold.drive as usize == k) {
                part.drives.push(*drive);
            }
        }
        let renumbered = |hold: Hold| Hold {
            drive: drives[hold.drive as usize],
            ..hold
        };
        part.holds = in_order(holds.into_iter().map(renumbered).collect());
        for (name, nodes) in &self.sets {
            let own = nodes.iter().filter_map(|node| number(*node)).collect();
            part.sets.insert(name.clone(), own);
        }
        for load in &self.loads {
            let face = |face: &Vec<u32>| face.iter().map(|node| number(*node)).collect();
            let faces: Vec<Vec<u32>> = load.faces.iter().filter_map(face).collect();
            if !faces.is_empty() {
                part.loads.push(Load {
                    faces,
                    ..load.clone()
                });
            }
        }
        part
    }
}
