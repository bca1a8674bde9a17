//! The cheapest way to separate two sets of a small graph.

/// A graph whose edges have a cost in both directions.
pub(super) struct Graph {
    /// By node: the other node, and the place of the edge back in that node's list.
    edges: Vec<Vec<(usize, usize)>>,
    /// What an edge can still carry.
    left: Vec<Vec<f64>>,
}

impl Graph {
    pub fn new(nodes: usize) -> Self {
        Self {
            edges: vec![Vec::new(); nodes],
            left: vec![Vec::new(); nodes],
        }
    }

    /// Joins two nodes; to separate them costs `cost`, which may be infinite.
    pub fn join(&mut self, a: usize, b: usize, cost: f64) {
        let (at_a, at_b) = (self.edges[a].len(), self.edges[b].len());
        self.edges[a].push((b, at_b));
        self.edges[b].push((a, at_a));
        self.left[a].push(cost);
        self.left[b].push(cost);
    }

    /// Finds the cheapest set of edges without which no way leads from `source` to `sink`, as the nodes that are still
    /// reached from the source, and its cost; infinite if there is none. By flows along shortest paths (Edmonds and Karp 1972):
    /// each saturates an edge, so rounding cannot keep it going.
    pub fn cut(mut self, source: usize, sink: usize) -> (Vec<bool>, f64) {
        let mut total = 0.0;
        loop {
            // By node, from where it is reached, and by which edge.
            let mut from: Vec<Option<(usize, usize)>> = vec![None; self.edges.len()];
            let mut reached = vec![source];
            let mut next = 0;
            while let Some(&a) = reached.get(next) {
                next += 1;
                for (k, &(b, _)) in self.edges[a].iter().enumerate() {
                    if self.left[a][k] > 0.0 && b != source && from[b].is_none() {
                        from[b] = Some((a, k));
                        reached.push(b);
                    }
                }
            }
            if from[sink].is_none() {
                let is_reached = |node: usize| node == source || from[node].is_some();
                return ((0..from.len()).map(is_reached).collect(), total);
            }
            let mut path = Vec::new();
            let mut at = sink;
            while let Some((a, k)) = from[at] {
                path.push((a, k));
                at = a;
            }
            let flow = path.iter().map(|&(a, k)| self.left[a][k]);
            let flow = flow.fold(f64::INFINITY, f64::min);
            if flow.is_infinite() {
                return (vec![false; from.len()], f64::INFINITY);
            }
            total += flow;
            for (a, k) in path {
                let (b, back) = self.edges[a][k];
                self.left[a][k] -= flow;
                self.left[b][back] += flow;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all ways to separate the ends of random graphs.
    #[test]
    fn no_separation_is_cheaper() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        };
        for _ in 0..200 {
            let nodes = 3 + (random() * 6.0) as usize;
            let mut edges = Vec::new();
            for a in 0..nodes {
                for b in 0..a {
                    if random() < 0.6 {
                        edges.push((a, b, random()));
                    }
                }
            }
            let mut graph = Graph::new(nodes);
            edges
                .iter()
                .for_each(|&(a, b, cost)| graph.join(a, b, cost));
            let (side, cost) = graph.cut(0, 1);
            assert!(side[0] && !side[1]);
            let cost_of = |of: &dyn Fn(usize) -> bool| -> f64 {
                let cut = edges.iter().filter(|(a, b, _)| of(*a) != of(*b));
                cut.map(|(_, _, cost)| cost).sum()
            };
            let least = (0..1_usize << nodes)
                .filter(|set| set & 1 == 1 && set & 2 == 0)
                .map(|set| cost_of(&|node| set >> node & 1 == 1))
                .fold(f64::INFINITY, f64::min);
            assert!(
                (cost - least).abs() < 1e-12 && (cost_of(&|node| side[node]) - least).abs() < 1e-12
            );
        }
    }
}
