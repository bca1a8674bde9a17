//! Tables that need contacts: touching pairs, forces, and forces compared with weights.

use femdem_analysis::{
    CoordinationOptions, ForceNetwork, Pack, Region, body_stresses, chains_by_stress,
    chains_by_weight, contact_classes, contact_fabric, coordination, force_distribution,
    force_maxima, mean_coordination, rattlers, region_stress, stress_profile, threshold_curve,
    vertical_balance, wall_forces,
};

use super::Tables;
use crate::{Snapshot, ViewError};

/// Number of cuts of the vertical balance.
const CUTS: u32 = 20;

const NO_CONTACTS: &str = "there is no list of contacts; give contacts.csv";

const NO_FORCES: &str = "the contacts were found from the overlaps of the bodies, which do not tell the forces; give contacts.csv";

const NO_MASSES: &str = "the masses of the bodies are not known; give their density";

const NO_WEIGHT: &str = "gravity along -z is zero: nothing has a weight";

/// Tables that need contacts with classes, and tables that need normal forces.
const RATTLERS: &str = "rattlers";
const NORMAL_TABLES: [&str; 4] = ["classes", "force_distribution", "threshold_curve", "fabric"];

/// Tables that need whole contact forces.
const FORCE_TABLES: [&str; 4] = [
    "wall_forces",
    "body_stresses",
    "chains_by_stress",
    "stress_profile",
];

/// Tables that compare forces with weights.
const WEIGHT_TABLES: [&str; 3] = ["force_maxima", "chains_by_weight", "vertical_balance"];

impl Tables {
    /// Coordination numbers.
    pub(super) fn add_contacts(
        &mut self,
        snapshot: &Snapshot,
        pack: &Pack,
    ) -> Result<(), ViewError> {
        if snapshot.gaps.contacts {
            self.miss(&["coordination"], NO_CONTACTS);
            if self.core.is_some() {
                self.miss(&["core_coordination"], NO_CONTACTS);
            }
            return Ok(());
        }
        let touches = snapshot.touches();
        let options = CoordinationOptions {
            force_threshold: self.options.force_threshold,
            among: None,
        };
        self.coordination = Some(coordination(pack.len(), &touches, &options)?);
        if let Some(core) = &self.core {
            let inside = pack.bodies_in(&core.region)?;
            if inside.is_empty() {
                self.miss(&["core_coordination"], "no body has its centre in the core");
                return Ok(());
            }
            let options = CoordinationOptions {
                among: Some(&inside),
                ..options
            };
            self.core_coordination = Some(coordination(pack.len(), &touches, &options)?);
        }
        Ok(())
    }

    pub(super) fn add_forces(
        &mut self,
        snapshot: &Snapshot,
        network: &ForceNetwork,
    ) -> Result<(), ViewError> {
        if snapshot.gaps.contacts {
            self.miss(&[RATTLERS], NO_CONTACTS);
            self.miss(&NORMAL_TABLES, NO_CONTACTS);
            self.miss_forces(NO_CONTACTS);
            return Ok(());
        }
        let bootstrap = self.options.bootstrap;
        self.mean_coordination = Some(mean_coordination(network, None, bootstrap)?);
        if self.core_coordination.is_some() {
            let region = self.core.as_ref().map(|core| &core.region);
            self.core_mean_coordination = Some(mean_coordination(network, region, bootstrap)?);
        }
        if snapshot.gaps.forces {
            self.rattlers = Some(rattlers(network, self.options.support)?);
            self.miss(&NORMAL_TABLES, NO_FORCES);
            self.miss_forces(NO_FORCES);
            return Ok(());
        }
        self.add_normal_forces(snapshot, network)?;
        if snapshot.gaps.friction {
            self.miss_forces(
                "the contacts have no friction forces as vectors; add the columns tx, ty, tz",
            );
            return Ok(());
        }
        self.add_whole_forces(snapshot, network)?;
        if snapshot.masses.is_empty() {
            self.miss(&WEIGHT_TABLES, NO_MASSES);
            return Ok(());
        }
        if snapshot.gravity <= 0.0 {
            self.miss(&WEIGHT_TABLES, NO_WEIGHT);
            return Ok(());
        }
        self.add_weights(network)
    }

    /// Records the tables that need whole forces as missing; those that also need the core only if there is
    /// one.
    fn miss_forces(&mut self, reason: &str) {
        self.miss(&FORCE_TABLES, reason);
        self.miss(&WEIGHT_TABLES, reason);
        if self.core.is_some() {
            self.miss(&["core_stress"], reason);
        }
    }

    fn add_normal_forces(
        &mut self,
        snapshot: &Snapshot,
        network: &ForceNetwork,
    ) -> Result<(), ViewError> {
        if snapshot.gaps.classes {
            let reason = "the contacts have no classes; add the column class";
            self.miss(&["classes", "rattlers"], reason);
        } else {
            self.classes = Some(contact_classes(network));
            self.rattlers = Some(rattlers(network, self.options.support)?);
        }
        self.force_distribution = force_distribution(network, &self.options.forces)?;
        match &self.force_distribution {
            None => self.miss(&["force_distribution"], "no two bodies press on each other"),
            Some(found) if found.tail.is_none() => self.miss(
                &["force_distribution.tail"],
                "there are fewer than 20 forces in a tail, or they are all alike",
            ),
            Some(_) => {}
        }
        self.threshold_curve = Some(threshold_curve(network, &self.options.thresholds)?);
        self.fabric = Some(contact_fabric(network));
        Ok(())
    }

    fn add_whole_forces(
        &mut self,
        snapshot: &Snapshot,
        network: &ForceNetwork,
    ) -> Result<(), ViewError> {
        let (rule, chains) = (self.options.stress_rule, self.options.chains);
        self.wall_forces = Some(wall_forces(network));
        self.body_stresses = Some(body_stresses(network));
        self.chains_by_stress = Some(chains_by_stress(network, rule, &chains)?);
        if let Some(core) = &self.core {
            let bootstrap = self.options.bootstrap;
            self.core_stress = Some(region_stress(network, &core.region, bootstrap)?);
        }
        let upright = |c: &Region| !matches!(c, Region::Sphere { .. });
        let Some(container) = snapshot.container.filter(upright) else {
            let reason = "the container is not known as a box or a cylinder; give its inside";
            self.miss(&["stress_profile"], reason);
            return Ok(());
        };
        if snapshot.space.is_some_and(|space| space.cell.repeats(2)) {
            self.miss(&["stress_profile"], "space repeats itself along z");
            return Ok(());
        }
        let (low, high) = container.corners();
        // Slabs of about one diameter.
        let slabs = ((high.z - low.z) / self.diameter)
            .round()
            .clamp(1.0, 1000.0);
        self.stress_profile = Some(stress_profile(network, &container, slabs as usize)?);
        Ok(())
    }

    fn add_weights(&mut self, network: &ForceNetwork) -> Result<(), ViewError> {
        let (rule, chains) = (self.options.weight_rule, self.options.chains);
        self.force_maxima = Some(force_maxima(network, self.options.bootstrap)?);
        self.chains_by_weight = Some(chains_by_weight(network, rule, &chains)?);
        let heights = network.bodies().iter().map(|b| b.centre.z);
        let low = heights.clone().fold(f64::INFINITY, f64::min);
        let high = heights.fold(f64::NEG_INFINITY, f64::max);
        // Between the lowest and the highest centre, so that every cut has weight above it.
        let cuts: Vec<f64> = (0..CUTS)
            .map(|k| low + (high - low) * (f64::from(k) + 0.5) / f64::from(CUTS))
            .collect();
        self.vertical_balance = Some(vertical_balance(network, &cuts)?);
        Ok(())
    }
}
