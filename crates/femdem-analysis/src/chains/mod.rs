//! Force chains: which contacts carry the load, and what network they form.

mod link;
mod network;
mod rules;
mod shape;
mod threshold;

pub use link::ChainLink;
pub use network::ChainNetwork;
pub use rules::{ChainOptions, StressRule, WeightRule, chains_by_stress, chains_by_weight};
pub use shape::{Chain, ChainSegment};
pub use threshold::{ThresholdCurve, ThresholdOptions, ThresholdPoint, threshold_curve};
