//! Rattlers, and whether the other bodies have more contacts than they need.

use serde::{Deserialize, Serialize};

use crate::coordination::Partner;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::network::graph::Graph;

/// When a body counts as held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SupportRule {
    /// By at least this many partners, walls included. The usual rule for spheres; a stack of cubes fails it,
    /// from the top down.
    Partners {
        /// 1 or more.
        least: u32,
    },
    /// By contacts whose classes remove at least six degrees of freedom from the body (see
    /// [`ContactClass::constraints`](crate::ContactClass::constraints)): in general a body with fewer unknown
    /// forces than equations of equilibrium is not held.
    Constraints {
        /// Whether friction acts.
        friction: bool,
    },
}

impl Default for SupportRule {
    fn default() -> Self {
        Self::Constraints { friction: true }
    }
}

/// Rattlers, and the count of constraints of the remaining bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rattlers {
    /// Indices of the rattlers, ascending.
    pub bodies: Vec<u32>,
    /// Their share of all bodies, 0 to 1.
    pub share: f64,
    /// Number of remaining bodies.
    pub held: usize,
    /// Mean number of partners of the remaining bodies, walls included, rattlers excluded; 0 if none remains.
    pub mean_coordination: f64,
    /// Remaining touching pairs, of bodies and with walls.
    pub pairs: usize,
    /// Degrees of freedom of the remaining bodies: six each.
    pub degrees_of_freedom: u64,
    /// Constraints by the remaining pairs without friction, by their classes.
    pub constraints_frictionless: u64,
    /// Constraints with friction.
    pub constraints_frictional: u64,
    /// Constraints without friction over degrees of freedom: 1 is isostatic, more is hyperstatic. 0 if no body
    /// remains.
    pub stiffness_ratio_frictionless: f64,
    /// The same with friction.
    pub stiffness_ratio_frictional: f64,
    /// The rule.
    pub rule: SupportRule,
}

/// Finds the rattlers: bodies that are not held, then those that are not held without them, and so on.
///
/// The result does not depend on the order in which they are removed.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// // A row on a floor: 0 lies on it by a face; 1 leans on 0 and 2 by points; 2 touches 1 alone.
/// let body = |x| ForceBody { centre: Point3::new(x, 0.0, 0.0), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let contact = |first, second, class| ForceContact {
///     first, second, point: Point3::origin(), normal: Vector3::x(), normal_force: 1.0,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: Some(class),
/// };
/// let bodies = [body(0.0), body(1.0), body(2.0)];
/// let contacts = [
///     contact(0, Partner::Wall(0), ContactClass::FaceFace),
///     contact(0, Partner::Body(1), ContactClass::Point),
///     contact(1, Partner::Body(2), ContactClass::Point),
/// ];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let found = rattlers(&network, SupportRule::default())?;
/// assert_eq!(found.bodies, [1, 2]);
/// assert_eq!(found.stiffness_ratio_frictional, 1.0);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Option`] for a rule of no partners.
pub fn rattlers(network: &ForceNetwork, rule: SupportRule) -> Result<Rattlers, AnalysisError> {
    if rule == (SupportRule::Partners { least: 0 }) {
        return Err(AnalysisError::Option {
            name: "least",
            value: 0.0,
            allowed: "1 or more",
        });
    }
    let held = held_bodies(network, rule);
    let is_left = |first: u32, second: Partner| {
        held[first as usize]
            && match second {
                Partner::Body(other) => held[other as usize],
                Partner::Wall(_) => true,
            }
    };
    let left: Vec<_> = network
        .pairs()
        .iter()
        .filter(|pair| is_left(pair.first, pair.second))
        .collect();
    let sides = |second: &Partner| match second {
        Partner::Body(_) => 2,
        Partner::Wall(_) => 1,
    };
    let bodies: Vec<u32> = (0_u32..)
        .zip(&held)
        .filter_map(|(i, held)| (!held).then_some(i))
        .collect();
    let count = held.len() - bodies.len();
    let freedom = 6 * count as u64;
    let sum = |friction| {
        left.iter()
            .map(|pair| u64::from(pair.constraints(friction)))
            .sum::<u64>()
    };
    let over = |value: u64, all: u64| {
        if all > 0 {
            value as f64 / all as f64
        } else {
            0.0
        }
    };
    let partners = left.iter().map(|pair| sides(&pair.second)).sum::<u64>();
    Ok(Rattlers {
        share: over(bodies.len() as u64, held.len() as u64),
        bodies,
        held: count,
        mean_coordination: over(partners, count as u64),
        pairs: left.len(),
        degrees_of_freedom: freedom,
        constraints_frictionless: sum(false),
        constraints_frictional: sum(true),
        stiffness_ratio_frictionless: over(sum(false), freedom),
        stiffness_ratio_frictional: over(sum(true), freedom),
        rule,
    })
}

/// Removes bodies until all remaining ones are held by the remaining contacts.
fn held_bodies(network: &ForceNetwork, rule: SupportRule) -> Vec<bool> {
    let worth = |pair: &crate::PairForce| match rule {
        SupportRule::Partners { .. } => 1,
        SupportRule::Constraints { friction } => pair.constraints(friction),
    };
    let least = match rule {
        SupportRule::Partners { least } => least,
        SupportRule::Constraints { .. } => 6,
    };
    let count = network.bodies().len();
    let mut support = vec![0_u32; count];
    let mut edges = Vec::new();
    let mut worths = Vec::new();
    for pair in network.pairs() {
        support[pair.first as usize] += worth(pair);
        if let Partner::Body(second) = pair.second {
            support[second as usize] += worth(pair);
            edges.push([pair.first, second]);
            worths.push(worth(pair));
        }
    }
    let graph = Graph::new(count, &edges);
    let mut held: Vec<bool> = support.iter().map(|s| *s >= least).collect();
    let mut gone: Vec<u32> = (0..count as u32).filter(|i| !held[*i as usize]).collect();
    while let Some(body) = gone.pop() {
        for &(other, edge) in graph.neighbours(body) {
            let other_support = &mut support[other as usize];
            *other_support -= worths[edge as usize];
            if *other_support < least && std::mem::replace(&mut held[other as usize], false) {
                gone.push(other);
            }
        }
    }
    held
}
