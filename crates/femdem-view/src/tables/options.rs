//! How a pack is measured.

use femdem_analysis::{
    BlockBootstrap, BodyAxes, ChainOptions, CoreOptions, DensityMapOptions, DensityOptions,
    FieldOptions, ForceDistributionOptions, MixingOptions, OrientationOptions, ProfileOptions,
    RadialOptions, SetVoronoiOptions, StereonetOptions, StressRule, SupportRule, ThresholdOptions,
    TiltOptions, WeightRule,
};
use serde::{Deserialize, Serialize};

/// Sizes that differ by at most this share are one.
pub(crate) const SAME_SIZE: f64 = 0.01;

/// How [`Tables::compute`](super::Tables::compute) measures. The defaults are those of the single analyses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TableOptions {
    /// Size of the normal force, pressing or pulling, above which a pair touches \[N\].
    pub force_threshold: f64,
    /// How the core is chosen.
    pub core: CoreOptions,
    /// How the density of the core is measured.
    pub density: DensityOptions,
    /// Density profiles over height and wall distance.
    pub profiles: ProfileOptions,
    /// The map of local density.
    pub map: DensityMapOptions,
    /// Set-Voronoi cells; their core is that of the pack.
    pub voronoi: SetVoronoiOptions,
    /// Axes of the stereonet and of the order parameters. `None`: those of
    /// [`telling_axes`](super::telling_axes), and the axes of the body's frame for the order of bodies with
    /// equal moments of inertia.
    pub axes: Option<BodyAxes>,
    /// The net of directions.
    pub net: StereonetOptions,
    /// Order of the directions, and its random baseline.
    pub order: OrientationOptions,
    /// The histogram of tilts.
    pub tilt: TiltOptions,
    /// Mixing of shapes and of sizes.
    pub mixing: MixingOptions,
    /// Coarse-grained fields; `None`: they are not computed.
    pub fields: Option<FieldOptions>,
    /// The radial distribution function.
    pub radial: RadialOptions,
    /// P(f) and its tail.
    pub forces: ForceDistributionOptions,
    /// The definition of a rattler.
    pub support: SupportRule,
    /// The founding paper's rule for force chains.
    pub weight_rule: WeightRule,
    /// The rule of Peters et al. (2005).
    pub stress_rule: StressRule,
    /// Options of both rules.
    pub chains: ChainOptions,
    /// Thresholds of the curve of components and cycles.
    pub thresholds: ThresholdOptions,
    /// Errors of the other means.
    pub bootstrap: BlockBootstrap,
}
