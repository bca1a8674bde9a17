//! Undirected graphs over bodies.

/// An undirected graph in compressed rows. Neighbours are in the order of the edges.
#[derive(Clone, Debug)]
pub(crate) struct Graph {
    starts: Vec<usize>,
    /// Neighbour and edge, node after node.
    entries: Vec<(u32, u32)>,
}

impl Graph {
    /// Nodes `0..nodes`; ends of edges must be among them.
    pub(crate) fn new(nodes: usize, edges: &[[u32; 2]]) -> Self {
        let mut starts = vec![0; nodes + 1];
        for edge in edges {
            for end in edge {
                starts[*end as usize + 1] += 1;
            }
        }
        for i in 0..nodes {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut entries = vec![(0, 0); 2 * edges.len()];
        for (&[a, b], number) in edges.iter().zip(0_u32..) {
            for (from, to) in [(a, b), (b, a)] {
                let slot = &mut next[from as usize];
                entries[*slot] = (to, number);
                *slot += 1;
            }
        }
        Self { starts, entries }
    }

    /// The subgraph of some of the nodes, which must be sorted and include all their neighbours, numbered by
    /// their positions in the list.
    pub(crate) fn part(&self, nodes: &[u32]) -> Self {
        let place = |node: u32| nodes.partition_point(|other| *other < node) as u32;
        let mut starts = vec![0];
        let mut entries = Vec::new();
        for &node in nodes {
            let neighbours = self.neighbours(node).iter();
            entries.extend(neighbours.map(|(next, edge)| (place(*next), *edge)));
            starts.push(entries.len());
        }
        Self { starts, entries }
    }

    pub(crate) fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Neighbours of a node, each with the number of its edge.
    pub(crate) fn neighbours(&self, node: u32) -> &[(u32, u32)] {
        let node = node as usize;
        &self.entries[self.starts[node]..self.starts[node + 1]]
    }

    pub(crate) fn degree(&self, node: u32) -> usize {
        self.neighbours(node).len()
    }

    /// Components of two nodes or more, each sorted, in the order of their first nodes.
    pub(crate) fn components(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.nodes()];
        let mut components = Vec::new();
        for start in 0..self.nodes() as u32 {
            if seen[start as usize] || self.degree(start) == 0 {
                continue;
            }
            seen[start as usize] = true;
            let mut members = vec![start];
            let mut at = 0;
            while let Some(&node) = members.get(at) {
                at += 1;
                for &(next, _) in self.neighbours(node) {
                    if !std::mem::replace(&mut seen[next as usize], true) {
                        members.push(next);
                    }
                }
            }
            members.sort_unstable();
            components.push(members);
        }
        components
    }
}

/// Disjoint sets, joined by size.
#[derive(Clone, Debug)]
pub(crate) struct Sets {
    parent: Vec<u32>,
    size: Vec<u32>,
}

impl Sets {
    pub(crate) fn new(count: usize) -> Self {
        Self {
            parent: (0..count as u32).collect(),
            size: vec![1; count],
        }
    }

    pub(crate) fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            // Path halving.
            let up = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = up;
            i = up;
        }
        i
    }

    /// Joins the sets of `a` and `b` and returns the sizes that they had; `None` if they were the same set.
    pub(crate) fn join(&mut self, a: u32, b: u32) -> Option<[u32; 2]> {
        let [a, b] = [self.root(a), self.root(b)];
        if a == b {
            return None;
        }
        let [small, large] = if self.size[a as usize] < self.size[b as usize] {
            [a, b]
        } else {
            [b, a]
        };
        let sizes = [self.size[small as usize], self.size[large as usize]];
        self.parent[small as usize] = large;
        self.size[large as usize] += sizes[0];
        Some(sizes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn two_components_and_a_lone_node() {
        let graph = Graph::new(6, &[[4, 1], [1, 2], [5, 3]]);
        assert_eq!(graph.components(), [vec![1, 2, 4], vec![3, 5]]);
        assert_eq!(graph.neighbours(1), [(4, 0), (2, 1)]);
        assert_eq!(graph.degree(0), 0);
    }

    proptest! {
        /// Both ways of finding components agree.
        #[test]
        fn sets_are_components(edges in prop::collection::vec([0_u32..20, 0_u32..20], 0..30)) {
            let graph = Graph::new(20, &edges);
            let mut sets = Sets::new(20);
            let joined = edges.iter().filter(|[a, b]| sets.join(*a, *b).is_some()).count();
            for component in graph.components() {
                let root = sets.root(component[0]);
                let together: Vec<u32> = (0..20).filter(|i| sets.root(*i) == root).collect();
                prop_assert_eq!(together, component);
            }
            // The number of edges of a forest is nodes minus trees.
            let roots = (0..20).filter(|i| sets.root(*i) == *i).count();
            prop_assert_eq!(roots + joined, 20);
        }
    }
}
