//! Two rules that define force chains.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

use super::network::{ChainNetwork, Link};
use crate::blocks::Blocks;
use crate::bootstrap::BlockBootstrap;
use crate::coordination::Partner;
use crate::error::AnalysisError;
use crate::forces::{ForceMaxima, force_maxima};
use crate::network::ForceNetwork;
use crate::stress::{BodyStresses, body_stresses};

/// Options of both rules.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChainOptions {
    /// Fewest bodies of a chain, 2 or more. Default 3, as in Peters et al. (2005).
    pub least_bodies: usize,
    /// How errors of means are computed.
    pub bootstrap: BlockBootstrap,
}

impl Default for ChainOptions {
    fn default() -> Self {
        Self {
            least_bodies: 3,
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// The founding paper's rule (Xiang, Latham and Farsi 2016): contacts with F_c/W above a factor times the
/// mean of the bodies' largest F_c/W.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WeightRule {
    /// The factor, above 0. Default 1.5.
    pub factor: f64,
}

impl Default for WeightRule {
    fn default() -> Self {
        Self { factor: 1.5 }
    }
}

/// The rule of Peters, Muthuswamy, Wibowo and Tordesillas (Phys. Rev. E 72, 041307, 2005): bodies
/// with a major principal stress above the mean, linked where they touch along it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StressRule {
    /// Largest angle between the line of the centres and the direction of the major principal stress of
    /// either body, above 0 and below π/2 (rad). Default π/4, 45°.
    pub angle: f64,
}

impl Default for StressRule {
    fn default() -> Self {
        Self { angle: FRAC_PI_4 }
    }
}

/// Force chains by the founding paper's rule.
///
/// F_c is the whole force of a pair, friction included; W is the body's weight, for two bodies their mean
/// weight. Forces on walls count in the maxima and, separately, as
/// [`wall_contacts`](ChainNetwork::wall_contacts) of the network, but do not join bodies.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// // A column of four bodies that carries 9 N, and one body beside it that carries 1 N.
/// let body = |x, z| ForceBody { centre: Point3::new(x, 0.0, z), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let bodies = [body(0.0, 0.0), body(0.0, 1.0), body(0.0, 2.0), body(0.0, 3.0), body(1.0, 0.0)];
/// let contact = |first, second, normal, normal_force| ForceContact {
///     first, second: Partner::Body(second), point: Point3::origin(), normal, normal_force,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// let mut contacts: Vec<_> = (0..3).map(|i| contact(i, i + 1, Vector3::z(), 9.0)).collect();
/// contacts.push(contact(0, 4, Vector3::x(), 1.0));
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let found = chains_by_weight(&network, WeightRule { factor: 1.0 }, &ChainOptions::default())?;
/// assert_eq!(found.chains.len(), 1);
/// assert_eq!((found.chains[0].bodies, found.chains[0].cycles), (4, 0));
/// assert_eq!(found.chains[0].straightness, 1.0);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::NoWeight`], [`AnalysisError::Option`].
pub fn chains_by_weight(
    network: &ForceNetwork,
    rule: WeightRule,
    options: &ChainOptions,
) -> Result<ChainNetwork, AnalysisError> {
    let maxima = force_maxima(network, options.bootstrap)?;
    by_weight(network, rule, options, &maxima)
}

pub(crate) fn by_weight(
    network: &ForceNetwork,
    rule: WeightRule,
    options: &ChainOptions,
    maxima: &ForceMaxima,
) -> Result<ChainNetwork, AnalysisError> {
    if !rule.factor.is_finite() || rule.factor <= 0.0 {
        return Err(AnalysisError::Option {
            name: "factor",
            value: rule.factor,
            allowed: "above zero and finite",
        });
    }
    options.validate()?;
    let threshold = rule.factor * maxima.mean.mean;
    let weight = |body: u32| network.bodies()[body as usize].weight;
    let mut links = Vec::new();
    let mut wall_contacts = 0;
    for pair in network.pairs() {
        let force = pair.force.norm();
        match pair.second {
            Partner::Body(second) => {
                let mean_weight = 0.5 * (weight(pair.first) + weight(second));
                if force / mean_weight > threshold {
                    links.push(Link {
                        bodies: [pair.first, second],
                        force,
                    });
                }
            }
            Partner::Wall(_) if force / weight(pair.first) > threshold => wall_contacts += 1,
            Partner::Wall(_) => {}
        }
    }
    let blocks = Blocks::of(network, options.bootstrap)?;
    let mut found = ChainNetwork::of(network, links, options.least_bodies, &blocks);
    found.threshold = threshold;
    found.wall_contacts = wall_contacts;
    Ok(found)
}

/// Force chains by the rule of Peters et al. (2005).
///
/// A body counts if its major principal stress (Love-Weber, compression positive) is above the mean over all
/// bodies that touch anything. Two such bodies are linked if they touch and the line between their centres is
/// within the angle of the major principal direction of both. Chains may therefore branch; bodies without links
/// are in none. In a pack under gravity the mean stress grows with depth, and so do the chains.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let body = |z| ForceBody { centre: Point3::new(0.0, 0.0, z), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let bodies: Vec<_> = (0..5).map(|i| body(f64::from(i))).collect();
/// let contact = |first: u32, normal_force| ForceContact {
///     first, second: Partner::Body(first + 1), point: Point3::new(0.0, 0.0, f64::from(first) + 0.5),
///     normal: Vector3::z(), normal_force, tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// let contacts = [contact(0, 9.0), contact(1, 9.0), contact(2, 9.0), contact(3, 1.0)];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let found = chains_by_stress(&network, StressRule::default(), &ChainOptions::default())?;
/// // Stresses are 4.5, 9, 9, 5 and 0.5 Pa with a mean of 5.6 Pa: only bodies 1 and 2, no chain of three.
/// assert!(found.chains.is_empty());
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Option`].
pub fn chains_by_stress(
    network: &ForceNetwork,
    rule: StressRule,
    options: &ChainOptions,
) -> Result<ChainNetwork, AnalysisError> {
    by_stress(network, rule, options, &body_stresses(network))
}

pub(crate) fn by_stress(
    network: &ForceNetwork,
    rule: StressRule,
    options: &ChainOptions,
    stresses: &BodyStresses,
) -> Result<ChainNetwork, AnalysisError> {
    // The condition is false for NaN.
    let inside = rule.angle > 0.0 && rule.angle < FRAC_PI_2;
    if !inside {
        return Err(AnalysisError::Option {
            name: "angle",
            value: rule.angle,
            allowed: "above 0 and below pi/2 (rad)",
        });
    }
    options.validate()?;
    let touches = network.touches();
    let blocks = Blocks::of(network, options.bootstrap)?;
    let major = |body: usize| stresses.bodies[body].stress.principal[0];
    let touching = (0..touches.len()).filter(|body| touches[*body]);
    let mean = blocks.mean(touching.map(|body| (network.bodies()[body].centre, major(body))));
    let least_cosine = rule.angle.cos();
    let carries = |body: u32, line: &Vector3| {
        let direction = Vector3::from(stresses.bodies[body as usize].stress.directions[0]);
        major(body as usize) > mean.mean && line.dot(&direction).abs() >= least_cosine
    };
    let mut links = Vec::new();
    for (first, second, pair) in network.body_pairs() {
        let line = network.branch(first, second);
        let length = line.norm();
        if length > 0.0
            && [first, second]
                .iter()
                .all(|body| carries(*body, &(line / length)))
        {
            links.push(Link {
                bodies: [first, second],
                force: pair.force.norm(),
            });
        }
    }
    let mut found = ChainNetwork::of(network, links, options.least_bodies, &blocks);
    found.threshold = mean.mean;
    Ok(found)
}

impl ChainOptions {
    fn validate(&self) -> Result<(), AnalysisError> {
        if self.least_bodies < 2 {
            return Err(AnalysisError::Option {
                name: "least_bodies",
                value: self.least_bodies as f64,
                allowed: "2 or more",
            });
        }
        Ok(())
    }
}
