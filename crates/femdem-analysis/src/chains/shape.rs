//! Length, straightness and loops of force chains.

use std::collections::VecDeque;

use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::link::ChainLink;
use crate::network::ForceNetwork;
use crate::network::graph::Graph;

/// One force chain: a connected part of the network.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Chain {
    /// Number of bodies.
    pub bodies: usize,
    /// Number of links.
    pub links: usize,
    /// Independent loops: links − bodies + 1.
    pub cycles: usize,
    /// Length of its backbone (m): of the shortest paths, counted in links, between any two of its bodies, one
    /// with the most links. The length is the sum of the distances between successive centres.
    pub length: f64,
    /// Links of the backbone.
    pub length_links: usize,
    /// Distance between the ends of the backbone (m).
    pub end_to_end: f64,
    /// End-to-end distance over length: 1 is straight.
    pub straightness: f64,
    /// Height from the lowest to the highest centre (m).
    pub height: f64,
    /// Largest force of a link (N).
    pub largest_force: f64,
    /// Mean of the centres (m).
    pub centre: Point3,
}

/// An unbranched part of a chain: from a body with one link, or with three or more, along bodies with two links
/// to the next such body; or a loop of bodies with two links.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainSegment {
    /// Number of its chain.
    pub chain: u32,
    /// Number of links.
    pub links: usize,
    /// Sum of the distances between successive centres (m).
    pub length: f64,
    /// Distance between the ends (m); 0 for a loop.
    pub end_to_end: f64,
    /// End-to-end distance over length: 1 is straight, 0 a loop.
    pub straightness: f64,
    /// The bodies at its ends.
    pub ends: [u32; 2],
    /// Angles between successive links (rad): 0 is straight on.
    pub turns: Vec<f64>,
    /// Mean of the centres of its bodies (m).
    pub centre: Point3,
}

/// The backbone of a chain of up to this many bodies is searched for from each of them.
const EVERY_START: usize = 1500;

/// That of a larger chain is searched for from this many of them, evenly spread, and from the body farthest
/// from each; this may miss a link or two.
const STARTS: usize = 64;

/// Measures one connected part.
pub(super) fn chain(
    network: &ForceNetwork,
    graph: &Graph,
    part: &[u32],
    links: &[ChainLink],
) -> Chain {
    let centres = unfolded(network, graph, part);
    let number: usize = part.iter().map(|body| graph.degree(*body)).sum::<usize>() / 2;
    let backbone = backbone(graph, part);
    let (length, end_to_end, straightness) = measures(network, &backbone);
    let heights = centres.iter().map(|c| c.z);
    let lowest = heights.clone().fold(f64::INFINITY, f64::min);
    let highest = heights.fold(f64::NEG_INFINITY, f64::max);
    let forces = part
        .iter()
        .flat_map(|body| graph.neighbours(*body))
        .map(|(_, link)| links[*link as usize].force);
    Chain {
        bodies: part.len(),
        links: number,
        cycles: (number + 1).saturating_sub(part.len()),
        length,
        length_links: backbone.len().saturating_sub(1),
        end_to_end,
        straightness,
        height: highest - lowest,
        largest_force: forces.fold(0.0, f64::max),
        centre: mean_point(centres.into_iter()),
    }
}

/// The centres of the bodies of a connected part (m); in periodic space those of images that hang together.
fn unfolded(network: &ForceNetwork, graph: &Graph, part: &[u32]) -> Vec<Point3> {
    if network.space().is_none() {
        return part.iter().map(|body| network.centre(*body)).collect();
    }
    let local = graph.part(part);
    let mut places: Vec<Option<Point3>> = vec![None; part.len()];
    let mut queue = VecDeque::new();
    if let Some(&first) = part.first() {
        places[0] = Some(network.centre(first));
        queue.push_back((0_u32, network.centre(first)));
    }
    while let Some((node, place)) = queue.pop_front() {
        for &(next, _) in local.neighbours(node) {
            if places[next as usize].is_none() {
                let onward = place + network.branch(part[node as usize], part[next as usize]);
                places[next as usize] = Some(onward);
                queue.push_back((next, onward));
            }
        }
    }
    places.into_iter().flatten().collect()
}

/// The centres along a path through bodies (m); in periodic space those of images that follow one another.
fn along(network: &ForceNetwork, way: &[u32]) -> Vec<Point3> {
    if network.space().is_none() {
        return way.iter().map(|body| network.centre(*body)).collect();
    }
    let first = way.first().map(|body| network.centre(*body));
    let mut places: Vec<Point3> = first.into_iter().collect();
    for step in way.windows(2) {
        places.push(places[places.len() - 1] + network.branch(step[0], step[1]));
    }
    places
}

fn mean_point(points: impl Iterator<Item = Point3>) -> Point3 {
    let (sum, count) = points.fold((Vector3::zeros(), 0.0), |(sum, n), p| {
        (sum + p.coords, n + 1.0)
    });
    Point3::from(sum / f64::max(count, 1.0))
}

/// Length, distance of the ends, and their ratio, of a path through bodies.
fn measures(network: &ForceNetwork, way: &[u32]) -> (f64, f64, f64) {
    let places = along(network, way);
    let length: f64 = places.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let ends = match places.as_slice() {
        [first, .., last] => (last - first).norm(),
        _ => 0.0,
    };
    let straightness = if length > 0.0 { ends / length } else { 0.0 };
    (length, ends, straightness)
}

/// The shortest path between the two bodies that are farthest apart, counted in links; among equals the one
/// with the lowest start, then the lowest end.
fn backbone(graph: &Graph, part: &[u32]) -> Vec<u32> {
    let local = graph.part(part);
    let mut search = Search::new(&local);
    let mut best: Option<(usize, u32)> = None;
    let mut consider = |search: &mut Search, start: u32| {
        let (end, steps) = search.farthest(start);
        if best.is_none_or(|(most, from)| steps > most || (steps == most && start < from)) {
            best = Some((steps, start));
        }
        end
    };
    let every = part.len() <= EVERY_START;
    let stride = if every { 1 } else { part.len() / STARTS };
    for start in (0..part.len() as u32).step_by(stride) {
        let end = consider(&mut search, start);
        if !every {
            consider(&mut search, end);
        }
    }
    let Some((_, start)) = best else {
        return Vec::new();
    };
    let (end, _) = search.farthest(start);
    let way = search.way_to(end);
    way.into_iter().map(|node| part[node as usize]).collect()
}

/// Breadth-first search with memory that is reused.
struct Search<'a> {
    graph: &'a Graph,
    /// For each node the distance in links, the node before, and the number of the search that wrote them.
    found: Vec<(usize, u32, u32)>,
    round: u32,
    queue: VecDeque<u32>,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph) -> Self {
        Self {
            graph,
            found: vec![(0, 0, 0); graph.nodes()],
            round: 0,
            queue: VecDeque::new(),
        }
    }

    /// The node farthest from `start` in links, the lowest among equals, and its distance.
    fn farthest(&mut self, start: u32) -> (u32, usize) {
        self.round += 1;
        self.queue.clear();
        self.queue.push_back(start);
        self.found[start as usize] = (0, start, self.round);
        let mut best = (start, 0);
        while let Some(node) = self.queue.pop_front() {
            let (steps, _, _) = self.found[node as usize];
            if steps > best.1 || (steps == best.1 && node < best.0) {
                best = (node, steps);
            }
            for &(next, _) in self.graph.neighbours(node) {
                let entry = &mut self.found[next as usize];
                if entry.2 != self.round {
                    *entry = (steps + 1, node, self.round);
                    self.queue.push_back(next);
                }
            }
        }
        best
    }

    /// The path of the last search from its start to `end`.
    fn way_to(&self, end: u32) -> Vec<u32> {
        let mut way = vec![end];
        let mut at = end;
        loop {
            let (steps, before, _) = self.found[at as usize];
            if steps == 0 {
                break;
            }
            at = before;
            way.push(at);
        }
        way.reverse();
        way
    }
}

/// Cuts the chains at the bodies that do not have two links.
pub(super) fn segments(
    network: &ForceNetwork,
    graph: &Graph,
    parts: &[Vec<u32>],
    links: &[ChainLink],
) -> Vec<ChainSegment> {
    let mut used = vec![false; links.len()];
    let mut segments = Vec::new();
    for (part, chain) in parts.iter().zip(0_u32..) {
        // Ends and branches first; the rest are loops of bodies with two links.
        let ends = part.iter().filter(|body| graph.degree(**body) != 2);
        for &start in ends.chain(part) {
            for &(next, link) in graph.neighbours(start) {
                if !std::mem::replace(&mut used[link as usize], true) {
                    let way = follow(graph, start, next, &mut used);
                    segments.push(segment(network, chain, &way));
                }
            }
        }
    }
    segments
}

/// Follows bodies with two links from `start` through `next`.
fn follow(graph: &Graph, start: u32, next: u32, used: &mut [bool]) -> Vec<u32> {
    let mut way = vec![start, next];
    let mut at = next;
    while at != start && graph.degree(at) == 2 {
        let onward = graph
            .neighbours(at)
            .iter()
            .find(|(_, link)| !used[*link as usize]);
        let Some(&(to, link)) = onward else {
            break;
        };
        used[link as usize] = true;
        way.push(to);
        at = to;
    }
    way
}

fn segment(network: &ForceNetwork, chain: u32, way: &[u32]) -> ChainSegment {
    let (length, end_to_end, straightness) = measures(network, way);
    let steps: Vec<Vector3> = way.windows(2).map(|w| network.branch(w[0], w[1])).collect();
    ChainSegment {
        chain,
        links: way.len().saturating_sub(1),
        length,
        end_to_end,
        straightness,
        ends: match way {
            [first, .., last] => [*first, *last],
            _ => [0; 2],
        },
        turns: steps.windows(2).map(|s| s[0].angle(&s[1])).collect(),
        centre: mean_point(along(network, way).into_iter()),
    }
}
