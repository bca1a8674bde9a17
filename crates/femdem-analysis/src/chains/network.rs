//! The network of force chains and its statistics.

use serde::{Deserialize, Serialize};

use super::link::ChainLink;
use super::shape::{Chain, ChainSegment, chain, segments};
use crate::blocks::{Blocks, Estimate};
use crate::network::ForceNetwork;
use crate::network::graph::Graph;
use crate::ordered::ordered_map;
use crate::table::{Cell, Table};

/// A link chosen by a rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) bodies: [u32; 2],
    pub(super) force: f64,
}

/// Force chains of a pack. A chain is a connected part of the network of links with at least the required
/// number of bodies; smaller parts are left out everywhere below.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainNetwork {
    /// The threshold of the rule: F_c/W (no unit) or the mean major principal stress (Pa).
    pub threshold: f64,
    /// Bodies in chains.
    pub bodies: usize,
    /// Their share of all bodies, 0 to 1.
    pub share_of_bodies: f64,
    /// Share of the touching pairs of bodies that are links of chains, 0 to 1.
    pub share_of_pairs: f64,
    /// Share of the summed sizes of the normal forces of the touching pairs that links of chains carry, 0 to 1.
    pub share_of_force: f64,
    /// Independent loops: links − bodies + chains.
    pub cycles: usize,
    /// Contacts with walls that pass the rule; 0 for a rule without walls.
    pub wall_contacts: usize,
    /// Links at bodies with three or more links: a measure of branching.
    pub branch_bodies: usize,
    /// Mean number of bodies of a chain.
    pub chain_bodies: Estimate,
    /// Mean number of links of an unbranched segment.
    pub segment_links: Estimate,
    /// Mean straightness of the segments of two links or more: distance of the ends over the length.
    pub segment_straightness: Estimate,
    /// Mean angle between a segment's successive links (rad): 0 is straight on.
    pub turning: Estimate,
    /// The chains, most bodies first.
    pub chains: Vec<Chain>,
    /// Their unbranched segments.
    pub segments: Vec<ChainSegment>,
    /// The links, sorted by bodies.
    pub links: Vec<ChainLink>,
}

impl ChainNetwork {
    /// The parts of a network of links. The rule sets `threshold` and `wall_contacts` afterwards.
    pub(super) fn of(
        network: &ForceNetwork,
        links: Vec<Link>,
        least_bodies: usize,
        blocks: &Blocks,
    ) -> Self {
        let count = network.bodies().len();
        let edges: Vec<[u32; 2]> = links.iter().map(|link| link.bodies).collect();
        let mut parts = Graph::new(count, &edges).components();
        parts.retain(|part| part.len() >= least_bodies);
        // A stable sort: chains of equal size stay in the order of their first bodies.
        parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
        let mut chain_of = vec![u32::MAX; count];
        for (part, number) in parts.iter().zip(0_u32..) {
            for body in part {
                chain_of[*body as usize] = number;
            }
        }
        let mut chosen: Vec<ChainLink> = links
            .iter()
            .map(|link| ChainLink {
                first: link.bodies[0],
                second: link.bodies[1],
                force: link.force,
                chain: chain_of[link.bodies[0] as usize],
            })
            .collect();
        chosen.retain(|link| link.chain != u32::MAX);
        chosen.sort_by_key(|link| (link.first, link.second));
        let edges: Vec<[u32; 2]> = chosen.iter().map(|l| [l.first, l.second]).collect();
        let graph = Graph::new(count, &edges);
        let chains = ordered_map(
            parts.len(),
            || (),
            |(), k| chain(network, &graph, &parts[k], &chosen),
        );
        let segments = segments(network, &graph, &parts, &chosen);
        Self::statistics(network, blocks, &graph, &parts, chains, segments, chosen)
    }

    fn statistics(
        network: &ForceNetwork,
        blocks: &Blocks,
        graph: &Graph,
        parts: &[Vec<u32>],
        chains: Vec<Chain>,
        segments: Vec<ChainSegment>,
        links: Vec<ChainLink>,
    ) -> Self {
        let bodies: usize = parts.iter().map(Vec::len).sum();
        let over = |value: f64, all: f64| if all > 0.0 { value / all } else { 0.0 };
        let (pairs, force) = network
            .body_pairs()
            .fold((0.0, 0.0), |(n, sum), (_, _, p)| {
                (n + 1.0, sum + p.normal_force.abs())
            });
        let carried = network.body_pairs().filter(|(i, j, _)| {
            links
                .binary_search_by_key(&(*i, *j), |l| (l.first, l.second))
                .is_ok()
        });
        // Not `sum`, which is -0 where there is no chain.
        let carried = carried.fold(0.0, |sum, (_, _, p)| sum + p.normal_force.abs());
        let long = || segments.iter().filter(|s| s.links >= 2);
        let turns = || long().flat_map(|s| s.turns.iter().map(move |angle| (s.centre, *angle)));
        Self {
            threshold: 0.0,
            bodies,
            share_of_bodies: over(bodies as f64, network.bodies().len() as f64),
            share_of_pairs: over(links.len() as f64, pairs),
            share_of_force: over(carried, force),
            cycles: (links.len() + parts.len()).saturating_sub(bodies),
            wall_contacts: 0,
            branch_bodies: (0..graph.nodes() as u32)
                .filter(|body| graph.degree(*body) >= 3)
                .count(),
            chain_bodies: blocks.mean(chains.iter().map(|c| (c.centre, c.bodies as f64))),
            segment_links: blocks.mean(segments.iter().map(|s| (s.centre, s.links as f64))),
            segment_straightness: blocks.mean(long().map(|s| (s.centre, s.straightness))),
            turning: blocks.mean(turns()),
            chains,
            segments,
            links,
        }
    }

    /// The unbranched segments as a table.
    #[must_use]
    pub fn segment_table(&self) -> impl Table + '_ {
        Segments(self)
    }

    /// The links as a table.
    #[must_use]
    pub fn link_table(&self) -> impl Table + '_ {
        Links(self)
    }
}

impl Table for ChainNetwork {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "chain",
            "bodies",
            "links",
            "cycles",
            "length_m",
            "length_links",
            "end_to_end_m",
            "straightness",
            "height_m",
            "largest_force_n",
            "centre_x_m",
            "centre_y_m",
            "centre_z_m",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let rows = (0_u32..).zip(&self.chains);
        Box::new(rows.map(|(number, c)| {
            vec![
                number.into(),
                c.bodies.into(),
                c.links.into(),
                c.cycles.into(),
                c.length.into(),
                c.length_links.into(),
                c.end_to_end.into(),
                c.straightness.into(),
                c.height.into(),
                c.largest_force.into(),
                c.centre.x.into(),
                c.centre.y.into(),
                c.centre.z.into(),
            ]
        }))
    }
}

struct Segments<'a>(&'a ChainNetwork);

impl Table for Segments<'_> {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "chain",
            "links",
            "length_m",
            "end_to_end_m",
            "straightness",
            "first_body",
            "last_body",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.0.segments.iter().map(|s| {
            vec![
                s.chain.into(),
                s.links.into(),
                s.length.into(),
                s.end_to_end.into(),
                s.straightness.into(),
                s.ends[0].into(),
                s.ends[1].into(),
            ]
        }))
    }
}

struct Links<'a>(&'a ChainNetwork);

impl Table for Links<'_> {
    fn columns(&self) -> &'static [&'static str] {
        &["first", "second", "force_n", "chain"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.0.links.iter().map(|l| {
            vec![
                l.first.into(),
                l.second.into(),
                l.force.into(),
                l.chain.into(),
            ]
        }))
    }
}
