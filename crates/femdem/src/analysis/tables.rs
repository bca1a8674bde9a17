//! All tables of a pack.

use femdem_analysis::{
    BlockBootstrap, BodyStresses, ChainNetwork, ChainOptions, ContactClasses, ContactFabric,
    Coordination, CoordinationOptions, CoreOptions, CoreRegion, DensityOptions, DensityProfile,
    ForceDistribution, ForceDistributionOptions, ForceMaxima, ForceNetwork, Pack, PackingDensity,
    PosedBody, ProfileOptions, Rattlers, Region, RegionStress, StressProfile, StressRule,
    SupportRule, ThresholdCurve, ThresholdOptions, VerticalBalance, WallForces, WeightRule,
    body_stresses, chains_by_stress, chains_by_weight, choose_core, contact_classes,
    contact_fabric, coordination, force_distribution, force_maxima, height_profile,
    packing_density, rattlers, region_stress, stress_profile, threshold_curve, vertical_balance,
    wall_forces, wall_profile,
};
use femdem_mesh::Polyhedron;
use serde::{Deserialize, Serialize};

use super::network::Data;
use crate::{Error, Snapshot};

/// Version of the keys of `analysis.json`.
const SCHEMA: u32 = 1;

/// Tables that need a core.
const CORE_TABLES: [&str; 5] = [
    "core",
    "density",
    "wall_profile",
    "core_coordination",
    "core_stress",
];

/// How [`Tables::compute`] measures. The defaults are those of the parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TableOptions {
    /// Normal force above which a pair touches \[N\].
    pub force_threshold: f64,
    /// How the density of the core is measured.
    pub density: DensityOptions,
    /// The bins of the density profiles.
    pub profiles: ProfileOptions,
    /// P(f) and its tail.
    pub forces: ForceDistributionOptions,
    /// What a rattler is.
    pub support: SupportRule,
    /// The founding paper's rule for force chains.
    pub weight_rule: WeightRule,
    /// The rule of Peters et al. (2005).
    pub stress_rule: StressRule,
    /// What the rules share.
    pub chains: ChainOptions,
    /// Thresholds of the curve of components and cycles.
    pub thresholds: ThresholdOptions,
    /// Errors of the other means.
    pub bootstrap: BlockBootstrap,
}

/// A table that could not be made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Missing {
    /// Name of the table: its field in [`Tables`].
    pub table: String,
    /// Why, and what to give.
    pub reason: String,
}

/// Everything that was found about a pack. A table that could not be made is `None` and has a line in
/// [`missing`](Self::missing).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tables {
    /// Version of these keys.
    pub schema: u32,
    /// How it was measured.
    pub options: TableOptions,
    /// What could not be found, and why.
    pub missing: Vec<Missing>,
    /// Number of bodies.
    pub bodies: usize,
    /// Number of contacts.
    pub contacts: usize,
    /// Mean circumscribed diameter d \[m\].
    pub diameter: f64,
    /// Names of the walls, by the numbers that tables use.
    pub walls: Vec<String>,
    /// The core region.
    pub core: Option<CoreRegion>,
    /// Packing density of the core.
    pub density: Option<PackingDensity>,
    /// Packing density over the height of the container, up to the highest body.
    pub height_profile: Option<DensityProfile>,
    /// Packing density over the distance from the side walls, of the core's range of heights.
    pub wall_profile: Option<DensityProfile>,
    /// Coordination number over all bodies.
    pub coordination: Option<Coordination>,
    /// Coordination number over the bodies with their centre in the core.
    pub core_coordination: Option<Coordination>,
    /// Contacts by class.
    pub classes: Option<ContactClasses>,
    /// Rattlers, and the count of constraints.
    pub rattlers: Option<Rattlers>,
    /// P(f).
    pub force_distribution: Option<ForceDistribution>,
    /// Largest contact force of each body over its weight.
    pub force_maxima: Option<ForceMaxima>,
    /// Force chains by the founding paper's rule.
    pub chains_by_weight: Option<ChainNetwork>,
    /// Force chains by the rule of Peters et al. (2005).
    pub chains_by_stress: Option<ChainNetwork>,
    /// Components and cycles against threshold.
    pub threshold_curve: Option<ThresholdCurve>,
    /// Love-Weber stress of each body; in CSV only, as it is long.
    #[serde(skip)]
    pub body_stresses: Option<BodyStresses>,
    /// Mean stress of the core.
    pub core_stress: Option<RegionStress>,
    /// Stress over the height of the container.
    pub stress_profile: Option<StressProfile>,
    /// Vertical balance.
    pub vertical_balance: Option<VerticalBalance>,
    /// Forces on the walls.
    pub wall_forces: Option<WallForces>,
    /// Fabric of the contacts between bodies.
    pub fabric: Option<ContactFabric>,
}

impl Tables {
    /// Measures a pack in every way that its data allow.
    ///
    /// # Errors
    ///
    /// As [`Snapshot::check`], and [`Error::Analysis`] for a pack without bodies, a contact that means
    /// nothing or an option out of its range.
    pub fn compute(snapshot: &Snapshot, options: &TableOptions) -> Result<Self, Error> {
        snapshot.check()?;
        let shapes: Vec<Polyhedron> = snapshot
            .shapes
            .iter()
            .map(|shape| shape.polyhedron.clone())
            .collect();
        let posed = |b: &crate::Body| PosedBody {
            shape: b.shape,
            pose: b.pose,
        };
        let bodies: Vec<PosedBody> = snapshot.bodies.iter().map(posed).collect();
        let pack = Pack::new(&shapes, &bodies)?;
        let data = Data::of(snapshot);
        let network = ForceNetwork::new(&data.bodies, &data.contacts, options.force_threshold)?;
        let mut tables = Self::empty(snapshot, options, &network, data.walls.clone());
        tables.add_geometry(snapshot, &pack)?;
        tables.add_contacts(snapshot, &pack)?;
        tables.add_forces(snapshot, &network)?;
        Ok(tables)
    }

    fn empty(
        snapshot: &Snapshot,
        options: &TableOptions,
        network: &ForceNetwork,
        walls: Vec<String>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            options: options.clone(),
            missing: Vec::new(),
            bodies: snapshot.bodies.len(),
            contacts: snapshot.contacts.len(),
            diameter: network.mean_diameter(),
            walls,
            core: None,
            density: None,
            height_profile: None,
            wall_profile: None,
            coordination: None,
            core_coordination: None,
            classes: None,
            rattlers: None,
            force_distribution: None,
            force_maxima: None,
            chains_by_weight: None,
            chains_by_stress: None,
            threshold_curve: None,
            body_stresses: None,
            core_stress: None,
            stress_profile: None,
            vertical_balance: None,
            wall_forces: None,
            fabric: None,
        }
    }

    fn miss(&mut self, tables: &[&str], reason: &str) {
        self.missing.extend(tables.iter().map(|table| Missing {
            table: (*table).to_owned(),
            reason: reason.to_owned(),
        }));
    }

    /// What needs poses alone.
    fn add_geometry(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), Error> {
        use femdem_analysis::AnalysisError::{NoPackInContainer, Region as BadRegion};
        let Some(container) = &snapshot.container else {
            let reason = "the container is not known, hence no core; give its inside";
            self.miss(&CORE_TABLES, reason);
            self.miss(&["height_profile"], reason);
            return Ok(());
        };
        self.add_height_profile(container, pack)?;
        match choose_core(pack, container, &CoreOptions::default()) {
            Ok(core) => self.core = Some(core),
            Err(NoPackInContainer { .. } | BadRegion { .. }) => {
                let reason = "the pack is too low or too narrow to have a core";
                self.miss(&CORE_TABLES, reason);
                return Ok(());
            }
            Err(other) => return Err(other.into()),
        }
        if let Some(region) = self.core_region() {
            self.density = Some(packing_density(pack, &region, &self.options.density)?);
            let (low, high) = region.corners();
            let core_heights = container.slab(low.z, high.z)?;
            self.wall_profile = Some(wall_profile(pack, &core_heights, &self.options.profiles)?);
        }
        Ok(())
    }

    fn add_height_profile(&mut self, container: &Region, pack: &Pack) -> Result<(), Error> {
        if matches!(container, Region::Sphere { .. }) {
            self.miss(
                &["height_profile"],
                "a sphere has no upright walls; give a box or a cylinder",
            );
            return Ok(());
        }
        self.height_profile = Some(height_profile(pack, container, &self.options.profiles)?);
        Ok(())
    }

    fn core_region(&self) -> Option<Region> {
        self.core.as_ref().map(|core| core.region)
    }

    /// What needs to know who touches whom, and how hard.
    fn add_contacts(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), Error> {
        if snapshot.gaps.contacts {
            let reason = "there is no list of contacts; give contacts.csv";
            self.miss(&["coordination"], reason);
            if self.core.is_some() {
                self.miss(&["core_coordination"], reason);
            }
            return Ok(());
        }
        let touches = snapshot.touches();
        let options = CoordinationOptions {
            force_threshold: self.options.force_threshold,
            among: None,
        };
        self.coordination = Some(coordination(snapshot.bodies.len(), &touches, &options)?);
        if let Some(region) = self.core_region() {
            let inside = pack.bodies_in(&region)?;
            if inside.is_empty() {
                self.miss(&["core_coordination"], "no body has its centre in the core");
                return Ok(());
            }
            let options = CoordinationOptions {
                among: Some(&inside),
                ..options
            };
            let found = coordination(snapshot.bodies.len(), &touches, &options)?;
            self.core_coordination = Some(found);
        }
        Ok(())
    }

    fn add_forces(&mut self, snapshot: &Snapshot, network: &ForceNetwork) -> Result<(), Error> {
        if snapshot.gaps.contacts {
            let reason = "there is no list of contacts; give contacts.csv";
            self.miss(&CONTACT_TABLES, reason);
            self.miss(&WEIGHT_TABLES, reason);
            self.miss(&FORCE_TABLES, reason);
            if self.core.is_some() {
                self.miss(&["core_stress"], reason);
            }
            return Ok(());
        }
        let options = self.options.clone();
        if snapshot.gaps.classes {
            self.miss(
                &["classes"],
                "the contacts have no classes; add the column class",
            );
        } else {
            self.classes = Some(contact_classes(network));
        }
        self.rattlers = Some(rattlers(network, options.support)?);
        self.force_distribution = force_distribution(network, &options.forces)?;
        if self.force_distribution.is_none() {
            self.miss(&["force_distribution"], "no two bodies touch");
        }
        self.threshold_curve = Some(threshold_curve(network, &options.thresholds)?);
        self.fabric = Some(contact_fabric(network));
        if snapshot.gaps.friction {
            let reason =
                "the contacts have no friction forces as vectors; add the columns tx, ty, tz";
            self.miss(&FORCE_TABLES, reason);
            self.miss(&WEIGHT_TABLES, reason);
            if self.core.is_some() {
                self.miss(&["core_stress"], reason);
            }
            return Ok(());
        }
        self.wall_forces = Some(wall_forces(network));
        self.body_stresses = Some(body_stresses(network));
        self.chains_by_stress = Some(chains_by_stress(
            network,
            options.stress_rule,
            &options.chains,
        )?);
        if let Some(region) = self.core_region() {
            self.core_stress = Some(region_stress(network, &region, options.bootstrap)?);
        }
        self.add_profile(snapshot, network)?;
        self.add_weights(snapshot, network)
    }

    fn add_profile(&mut self, snapshot: &Snapshot, network: &ForceNetwork) -> Result<(), Error> {
        let Some(container) = snapshot.container else {
            let reason = "the container is not known; give its inside";
            self.miss(&["stress_profile"], reason);
            return Ok(());
        };
        let (low, high) = container.corners();
        // Slabs of about one diameter.
        let slabs = ((high.z - low.z) / self.diameter)
            .round()
            .clamp(1.0, 1000.0);
        self.stress_profile = Some(stress_profile(network, &container, slabs as usize)?);
        Ok(())
    }

    /// What compares forces with weights.
    fn add_weights(&mut self, snapshot: &Snapshot, network: &ForceNetwork) -> Result<(), Error> {
        if snapshot.masses.is_empty() || snapshot.gravity <= 0.0 {
            let reason =
                "the masses of the bodies or gravity are not known; give the density and gravity";
            self.miss(&WEIGHT_TABLES, reason);
            return Ok(());
        }
        let options = self.options.clone();
        self.force_maxima = Some(force_maxima(network, options.bootstrap)?);
        self.chains_by_weight = Some(chains_by_weight(
            network,
            options.weight_rule,
            &options.chains,
        )?);
        let heights = network.bodies().iter().map(|b| b.centre.z);
        let low = heights.clone().fold(f64::INFINITY, f64::min);
        let high = heights.fold(f64::NEG_INFINITY, f64::max);
        // Between the lowest and the highest centre, so that every cut has something above it.
        let cuts: Vec<f64> = (0..CUTS)
            .map(|k| low + (high - low) * (f64::from(k) + 0.5) / f64::from(CUTS))
            .collect();
        self.vertical_balance = Some(vertical_balance(network, &cuts)?);
        Ok(())
    }
}

/// Number of cuts of the vertical balance.
const CUTS: u32 = 20;

/// Tables that need contacts.
const CONTACT_TABLES: [&str; 5] = [
    "classes",
    "rattlers",
    "force_distribution",
    "threshold_curve",
    "fabric",
];

/// Tables that need the whole contact forces.
const FORCE_TABLES: [&str; 4] = [
    "wall_forces",
    "body_stresses",
    "chains_by_stress",
    "stress_profile",
];

/// Tables that need the weights of the bodies too.
const WEIGHT_TABLES: [&str; 3] = ["force_maxima", "chains_by_weight", "vertical_balance"];
