//! Tables that need poses alone.

use femdem_analysis::AnalysisError::{NoPackInContainer, Region as BadRegion};
use femdem_analysis::{
    Pack, Region, choose_core, density_map, height_profile, packing_density, wall_profile,
};

use super::Tables;
use crate::{Error, Snapshot};

/// Tables of the container.
const CONTAINER_TABLES: [&str; 2] = ["height_profile", "density_map"];

/// Tables of the core.
const CORE_TABLES: [&str; 5] = [
    "core",
    "density",
    "wall_profile",
    "core_coordination",
    "core_stress",
];

impl Tables {
    pub(super) fn add_geometry(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), Error> {
        let Some(container) = &snapshot.container else {
            let reason = "the container is not known; give its inside";
            self.miss(&CONTAINER_TABLES, reason);
            self.miss(&CORE_TABLES, reason);
            return Ok(());
        };
        self.height_profile = Some(height_profile(pack, container, &self.options.profiles)?);
        self.density_map = Some(density_map(pack, container, &self.options.map)?);
        match choose_core(pack, container, &self.options.core) {
            Ok(core) => {
                self.density = Some(packing_density(pack, &core.region, &self.options.density)?);
                self.add_wall_profile(pack, container, &core.region)?;
                self.core = Some(core);
            }
            Err(NoPackInContainer { .. } | BadRegion { .. }) => {
                let reason = "the pack is too low or too narrow to have a core";
                self.miss(&CORE_TABLES, reason);
            }
            Err(other) => return Err(other.into()),
        }
        Ok(())
    }

    /// Between the heights of the core, so that neither floor nor top weighs in.
    fn add_wall_profile(
        &mut self,
        pack: &Pack,
        container: &Region,
        core: &Region,
    ) -> Result<(), Error> {
        let (low, high) = core.corners();
        let middle = container.slab(low.z, high.z)?;
        self.wall_profile = Some(wall_profile(pack, &middle, &self.options.profiles)?);
        Ok(())
    }
}
