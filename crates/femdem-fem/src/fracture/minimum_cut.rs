//! The cheapest way to separate two sides of a small graph.

/// An edge between two vertices, and what it costs to cut it (not negative).
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub ends: [usize; 2],
    pub cost: f64,
}

/// Divides the vertices in two, those given `true` from those given `false`, so that the edges between the two parts cost
/// least in sum; returns the part of each. Where several divisions cost the same, `true` gets the fewest vertices.
///
/// Maximum flow along shortest paths (Edmonds and Karp): every path saturates an edge exactly, so that the number of paths is
/// bounded for any real costs. Vertices and edges are visited in their order.
pub(super) fn minimum_cut(sides: &[Option<bool>], edges: &[Edge]) -> Vec<bool> {
    let mut edges_of = vec![Vec::new(); sides.len()];
    for (e, edge) in edges.iter().enumerate() {
        edges_of[edge.ends[0]].push((e, 0));
        edges_of[edge.ends[1]].push((e, 1));
    }
    // What can still flow from either end to the other.
    let mut room: Vec<[f64; 2]> = edges.iter().map(|edge| [edge.cost; 2]).collect();
    loop {
        // By which edge, from which of its ends, each vertex was reached first.
        let mut by: Vec<Option<(usize, usize)>> = vec![None; sides.len()];
        let is_source = |v: &usize| sides[*v] == Some(true);
        let mut reached: Vec<usize> = (0..sides.len()).filter(is_source).collect();
        let mut seen = 0;
        let mut found = None;
        while let Some(&v) = reached.get(seen).filter(|_| found.is_none()) {
            seen += 1;
            for &(e, end) in &edges_of[v] {
                let other = edges[e].ends[1 - end];
                if room[e][end] > 0.0 && sides[other] != Some(true) && by[other].is_none() {
                    by[other] = Some((e, end));
                    reached.push(other);
                    if sides[other] == Some(false) {
                        found = Some(other);
                        break;
                    }
                }
            }
        }
        let Some(sink) = found else {
            let mut parts = vec![false; sides.len()];
            for v in reached {
                parts[v] = true;
            }
            return parts;
        };
        let mut path = Vec::new();
        let mut v = sink;
        while let Some((e, end)) = by[v] {
            path.push((e, end));
            v = edges[e].ends[end];
        }
        let flow = path
            .iter()
            .map(|&(e, end)| room[e][end])
            .fold(f64::INFINITY, f64::min);
        for (e, end) in path {
            room[e][end] -= flow;
            room[e][1 - end] += flow;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cost(edges: &[Edge], parts: &[bool]) -> f64 {
        let between = |edge: &&Edge| parts[edge.ends[0]] != parts[edge.ends[1]];
        edges.iter().filter(between).map(|edge| edge.cost).sum()
    }

    /// The cheapest of all divisions that keep the given sides.
    fn enumerated(sides: &[Option<bool>], edges: &[Edge]) -> f64 {
        let all = 0..1_u32 << sides.len();
        let parts = all.map(|bits| (0..sides.len()).map(|v| bits >> v & 1 == 1).collect());
        let kept = parts.filter(|parts: &Vec<bool>| {
            let mut both = sides.iter().zip(parts);
            both.all(|(side, part)| side.is_none_or(|s| s == *part))
        });
        kept.map(|parts| cost(edges, &parts))
            .fold(f64::INFINITY, f64::min)
    }

    /// Graphs of 2 to 9 vertices; costs with many ties and zeros, or of any size.
    fn graph() -> impl Strategy<Value = (Vec<Option<bool>>, Vec<Edge>)> {
        (2..10_usize).prop_flat_map(|count| {
            let side = prop_oneof![Just(None), any::<bool>().prop_map(Some)];
            let cost = prop_oneof![(0..4_u8).prop_map(f64::from), 1e-3..1e3_f64];
            let edge =
                (0..count, 0..count, cost).prop_map(|(a, b, cost)| Edge { ends: [a, b], cost });
            let edges = prop::collection::vec(edge, 0..25);
            (prop::collection::vec(side, count), edges).prop_map(|(sides, mut edges)| {
                edges.retain(|edge| edge.ends[0] != edge.ends[1]);
                (sides, edges)
            })
        })
    }

    proptest! {
        #[test]
        fn as_cheap_as_the_best_of_all((sides, edges) in graph()) {
            let parts = minimum_cut(&sides, &edges);
            for (side, part) in sides.iter().zip(&parts) {
                prop_assert!(side.is_none_or(|side| side == *part));
            }
            let best = enumerated(&sides, &edges);
            prop_assert!((cost(&edges, &parts) - best).abs() <= 1e-12 * (1.0 + best));
        }
    }
}
