//! Tables that need only poses.

use femdem_analysis::AnalysisError::{NoPackInContainer, Region as BadRegion};
use femdem_analysis::{
    CoreRegion, Pack, Region, SetVoronoiOptions, choose_core, density_map, height_profile,
    packing_density, set_voronoi, wall_profile,
};

use super::Tables;
use crate::{Error, Snapshot};

/// Tables of the container.
const CONTAINER_TABLES: [&str; 2] = ["height_profile", "density_map"];

/// Tables of the core.
const CORE_TABLES: [&str; 6] = [
    "core",
    "density",
    "set_voronoi",
    "wall_profile",
    "core_coordination",
    "core_stress",
];

impl Tables {
    pub(super) fn add_geometry(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), Error> {
        self.orientation = super::orientation::of_pack(pack, &self.options)?;
        if self.orientation.is_none() {
            self.miss(
                &["orientation"],
                "there are too many directions; choose fewer axes",
            );
        }
        let Some(container) = &snapshot.container else {
            let reason = "the container is not known; give its inside";
            self.miss(&CONTAINER_TABLES, reason);
            self.miss(&CORE_TABLES, reason);
            return Ok(());
        };
        self.density_map = Some(density_map(pack, container, &self.options.map)?);
        if matches!(container, Region::Sphere { .. }) {
            let reason = "a sphere has no upright walls; give a box or a cylinder";
            self.miss(&["height_profile"], reason);
            self.miss(&CORE_TABLES, reason);
            return Ok(());
        }
        self.height_profile = Some(height_profile(pack, container, &self.options.profiles)?);
        match choose_core(pack, container, &self.options.core) {
            Ok(core) => self.add_core(pack, container, core),
            Err(error @ NoPackInContainer { .. }) => {
                self.miss(&CORE_TABLES, &error.to_string());
                Ok(())
            }
            Err(BadRegion { .. }) => {
                let reason = "the pack is too low or too narrow to have a core";
                self.miss(&CORE_TABLES, reason);
                Ok(())
            }
            Err(other) => Err(other.into()),
        }
    }

    fn add_core(&mut self, pack: &Pack, container: &Region, core: CoreRegion) -> Result<(), Error> {
        let density = packing_density(pack, &core.region, &self.options.density)?;
        if density.grid.is_none() {
            let reason = "the core is too wide for counting cells; go by the exact density";
            self.miss(&["density.grid"], reason);
        }
        self.density = Some(density);
        // Between the heights of the core, to exclude effects of floor and top.
        let (low, high) = core.region.corners();
        let middle = container.slab(low.z, high.z)?;
        self.wall_profile = Some(wall_profile(pack, &middle, &self.options.profiles)?);
        // Above the mean top there is air that belongs to no body.
        let filled = container.slab(f64::NEG_INFINITY, core.top.mean)?;
        let options = SetVoronoiOptions {
            core: Some(core.region),
            ..self.options.voronoi
        };
        self.set_voronoi = Some(set_voronoi(pack, &filled, &options)?);
        self.core = Some(core);
        Ok(())
    }
}
