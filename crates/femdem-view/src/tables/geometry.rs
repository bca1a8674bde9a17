//! Tables that need only poses.

use femdem_analysis::AnalysisError::{
    AboveRim, GridTooFine, NoPackInContainer, NotEnclosed, Region as BadRegion, RegionKind,
};
use femdem_analysis::{
    CoreRegion, Pack, Region, SetVoronoiOptions, Vessel, WithImages, choose_core, density_map,
    free_surface, height_profile, measure_bed, packing_density, set_voronoi, tilt_histogram, tilts,
    wall_profile,
};

use femdem_mesh::Vector3;

use super::Tables;
use crate::{Snapshot, ViewError};

/// Tables of the container.
const CONTAINER_TABLES: [&str; 2] = ["height_profile", "density_map"];

/// Mean diameters around the periodic cell in which Voronoi cells are cut, so that those of its bodies are whole.
const AROUND: f64 = 2.0;

/// Width of the free surface in mean diameters from which it has a slope: of a narrower bed it is the bodies that lie on top by
/// chance.
const WIDE: f64 = 8.0;

const PERIODIC_SIDES: &str = "space repeats itself: there are no side walls";

const NO_CONTAINER: &str = "the container is not known as a box or a cylinder; give its inside";

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
    pub(super) fn add_orientation(&mut self, pack: &Pack) -> Result<(), ViewError> {
        self.orientation = super::orientation::of_pack(pack, &self.options)?;
        if self.orientation.is_none() {
            self.miss(
                &["orientation"],
                "there are too many directions; choose fewer axes",
            );
        }
        Ok(())
    }

    pub(super) fn add_geometry(&mut self, snapshot: &Snapshot) -> Result<(), ViewError> {
        // Images in the container, and around it as far as their Voronoi cells depend on others.
        let (shapes, images) = match &snapshot.container {
            Some(region) => snapshot.with_images(region, 2.0 * AROUND * self.diameter)?,
            None => {
                let (shapes, bodies) = snapshot.posed();
                (shapes, WithImages::none(bodies))
            }
        };
        let pack = &images.pack(&shapes)?;
        self.add_surface(snapshot, pack)?;
        self.add_bed(snapshot, pack)?;
        let Some(container) = &snapshot.container else {
            self.miss(&CONTAINER_TABLES, NO_CONTAINER);
            self.miss(&CORE_TABLES, NO_CONTAINER);
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
            Ok(core) => self.add_core(snapshot, pack, container, core),
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

    /// The slope of the free surface.
    fn add_surface(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), ViewError> {
        if repeats(snapshot, 2) {
            return Ok(());
        }
        let spacing = self.options.core.column_spacing_over_d;
        let found = match free_surface(pack, snapshot.container.as_ref(), spacing) {
            Ok(Some(found)) => found,
            Ok(None) => {
                self.miss(&["surface"], "too few bodies lie side by side for a slope");
                return Ok(());
            }
            Err(GridTooFine { .. }) => {
                self.miss(&["surface"], "a body lies far from the others");
                return Ok(());
            }
            Err(other) => return Err(other.into()),
        };
        let width = (found.columns as f64).sqrt() * spacing;
        if width < WIDE {
            let reason = format!(
                "the bodies cover a square of {width:.1} mean diameters; a slope needs one of {WIDE}"
            );
            self.miss(&["surface"], &reason);
            return Ok(());
        }
        self.surface = Some(found);
        Ok(())
    }

    /// The whole bed, in the vessel or else in the container.
    fn add_bed(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), ViewError> {
        let Some(vessel) = vessel_of(snapshot) else {
            self.miss(&["bed"], NO_CONTAINER);
            return Ok(());
        };
        if repeats(snapshot, 2) {
            self.miss(
                &["bed"],
                "space repeats itself along z: there is no floor and no top",
            );
            return Ok(());
        }
        match measure_bed(pack, &vessel, self.options.core.column_spacing_over_d) {
            Ok(bed) => self.bed = Some(bed),
            Err(
                error @ (AboveRim { .. }
                | NotEnclosed { .. }
                | NoPackInContainer { .. }
                | RegionKind { .. }),
            ) => self.miss(&["bed"], &error.to_string()),
            Err(other) => return Err(other.into()),
        }
        Ok(())
    }

    /// The tilts, and their histogram near the walls of the vessel and in the core.
    pub(super) fn add_tilt(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), ViewError> {
        self.tilts = tilts(pack);
        if self.tilts.iter().all(Option::is_none) {
            let reason = "the bodies have equal moments of inertia, and thus no axis of their own";
            self.miss(&["tilt"], reason);
            return Ok(());
        }
        let vessel = vessel_of(snapshot).filter(|_| snapshot.space.is_none());
        if snapshot.space.is_some() {
            self.miss(&["tilt.side_walls", "tilt.floor"], PERIODIC_SIDES);
        }
        if matches!(vessel, Some(Vessel::Silo { .. })) {
            let reason = "the floor of a silo lies within its cone, which tilts bodies itself";
            self.miss(&["tilt.floor"], reason);
        }
        let core = self.core.as_ref().filter(|core| !core.is_thin());
        self.tilt = Some(tilt_histogram(
            pack,
            vessel.as_ref(),
            core.map(|core| &core.region),
            &self.options.tilt,
        )?);
        Ok(())
    }

    fn add_core(
        &mut self,
        snapshot: &Snapshot,
        pack: &Pack,
        container: &Region,
        core: CoreRegion,
    ) -> Result<(), ViewError> {
        if core.is_thin() {
            self.miss(&["density.core"], &thin(&core, "the density"));
        }
        let space = *core.density_region();
        let density = packing_density(pack, &space, &self.options.density)?;
        if density.grid.is_none() {
            let reason = "the region is too wide for counting cells; go by the exact density";
            self.miss(&["density.grid"], reason);
        }
        self.density = Some(density);
        // Between the heights of the core, to exclude effects of floor and top.
        let (low, high) = space.corners();
        if snapshot.space.is_some() {
            self.miss(&["wall_profile"], PERIODIC_SIDES);
        } else {
            let middle = container.slab(low.z, high.z)?;
            self.wall_profile = Some(wall_profile(pack, &middle, &self.options.profiles)?);
        }
        // Above the mean top there is air that belongs to no body.
        let filled = container.slab(f64::NEG_INFINITY, core.top.mean)?;
        let options = SetVoronoiOptions {
            core: Some(space),
            ..self.options.voronoi
        };
        let filled = widened(&filled, snapshot, AROUND * self.diameter);
        let mut found = set_voronoi(pack, &filled, &options)?;
        found.cells.retain(|cell| (cell.body as usize) < pack.own());
        self.set_voronoi = Some(found);
        self.core = Some(core);
        Ok(())
    }
}

/// What the bed lies in.
fn vessel_of(snapshot: &Snapshot) -> Option<Vessel> {
    let vessel = snapshot.vessel.clone();
    vessel.or_else(|| snapshot.container.map(Vessel::Upright))
}

/// Whether space repeats itself along an axis.
fn repeats(snapshot: &Snapshot, axis: usize) -> bool {
    snapshot.space.is_some_and(|space| space.cell.repeats(axis))
}

/// A region with a margin beyond the edges of the periodic cell (m).
fn widened(region: &Region, snapshot: &Snapshot, margin: f64) -> Region {
    match *region {
        Region::Box { min, max } => {
            let margin = |axis: usize| if repeats(snapshot, axis) { margin } else { 0.0 };
            let by = Vector3::new(margin(0), margin(1), margin(2));
            Region::Box {
                min: min - by,
                max: max + by,
            }
        }
        other => other,
    }
}

/// Why `what` is that of the whole bed and not that of the core.
pub(super) fn thin(core: &CoreRegion, what: &str) -> String {
    format!(
        "the core would be {:.2} d thin, less than one circumscribed diameter: {what} is that of the whole \
         bed, from the floor to the mean top",
        core.extent_over_d
    )
}

#[cfg(test)]
mod tests {
    use super::super::TableOptions;
    use super::*;
    use crate::testing::two_cubes;

    /// Two cubes of 1 m3 in a bed of 2.5 m x 2 m x 2 m: their core would be a box of 1 m, less than d.
    #[test]
    fn a_core_thinner_than_a_body_has_the_density_of_the_bed_and_says_so() {
        let tables = Tables::compute(&two_cubes(), &TableOptions::default()).unwrap();
        let core = tables.core.as_ref().unwrap();
        assert!(core.is_thin() && core.extent_over_d < 0.6);
        let (low, high) = core.bed.corners();
        assert_eq!((low.x, high.x, low.z), (-1.0, 1.5, 0.0));
        let bed = 2.5 * 2.0 * (core.top.mean - low.z);
        let density = tables.density.as_ref().unwrap();
        assert!(
            (density.exact - 2.0 / bed).abs() < 1e-9,
            "{}",
            density.exact
        );
        let reason = |table: &str| {
            let mut entries = tables.missing.iter().filter(|entry| entry.table == table);
            entries.next().map(|entry| entry.reason.as_str())
        };
        assert!(
            reason("density.core")
                .unwrap()
                .contains("less than one circumscribed diameter")
        );
        assert!(
            reason("radial_distribution.core")
                .unwrap()
                .contains("whole bed")
        );
        assert!(
            tables.to_string().contains("of the bed, 1.4 x 1.2 x"),
            "{tables}"
        );
    }
}
