//! Coarse-grained fields.

use femdem_analysis::{ForceNetwork, coarse_grained_fields};

use super::Tables;
use crate::{Snapshot, ViewError};

impl Tables {
    /// The fields that the data allow: those of forces that are not known are left empty.
    pub(super) fn add_fields(
        &mut self,
        snapshot: &Snapshot,
        network: &ForceNetwork,
    ) -> Result<(), ViewError> {
        let Some(options) = self.options.fields else {
            return Ok(());
        };
        if snapshot.space.is_some() {
            self.miss(
                &["fields"],
                "space repeats itself, and fields would not know the images",
            );
            return Ok(());
        }
        let (masses, velocities) = (&snapshot.masses, &snapshot.velocities);
        let mut fields = coarse_grained_fields(network, masses, velocities, &options)?;
        let gaps = snapshot.gaps;
        if gaps.contacts || gaps.forces || gaps.friction {
            fields.contact_stress.clear();
            let reason = "the forces of the contacts are not known as vectors; give contacts.csv with tx, ty, tz";
            self.miss(&["fields.contact_stress"], reason);
        }
        if gaps.contacts {
            fields.fabric.clear();
            self.miss(
                &["fields.fabric"],
                "there is no list of contacts; give contacts.csv",
            );
        }
        if masses.is_empty() {
            let reason = "the masses of the bodies are not known; give their density";
            self.miss(&["fields.density"], reason);
        }
        if masses.is_empty() || velocities.is_empty() {
            let names = [
                "fields.momentum",
                "fields.velocity",
                "fields.kinetic_stress",
            ];
            let reason = "the masses or the velocities of the bodies are not known; give the columns mass, velocity_x, velocity_y, velocity_z";
            self.miss(&names, reason);
        }
        self.fields = Some(fields);
        Ok(())
    }
}
