//! The files of the tables.

use std::fs;
use std::io::Write;
use std::path::Path;

use femdem_analysis::Table;

use super::{BodyTable, MixingSeries, Tables};
use crate::output::{vti, write_file};
use crate::{Snapshot, ViewError};

/// Folder of the tables within that of a pack.
pub const FOLDER: &str = "analysis";

/// Name of the file of everything except the long lists.
pub const JSON: &str = "analysis.json";

impl Tables {
    /// Writes `analysis/*.csv`, `analysis/density-map.vti` and `analysis/fields.vti` for the tables that exist, and `analysis.json`
    /// last. Files of an earlier analysis that are not written again are removed, so that the files there
    /// belong together.
    ///
    /// # Errors
    ///
    /// [`ViewError::Write`] with the file that could not be written; as [`Tables::compute`].
    pub fn write(&self, snapshot: &Snapshot, folder: impl AsRef<Path>) -> Result<(), ViewError> {
        let folder = folder.as_ref();
        let tables = folder.join(FOLDER);
        fs::create_dir_all(&tables).map_err(|source| ViewError::Write {
            path: tables.clone(),
            source,
        })?;
        let bodies = BodyTable::new(snapshot, self)?;
        let segments = [&self.chains_by_weight, &self.chains_by_stress]
            .map(|chains| chains.as_ref().map(|c| (c.segment_table(), c.link_table())));
        let [by_weight, by_stress] = &segments;
        let net = self
            .orientation
            .as_ref()
            .and_then(|found| found.net.as_ref());
        let all: [(&str, Option<&dyn Table>); 30] = [
            ("bodies.csv", Some(&bodies)),
            ("sieve.csv", table(&self.sieve)),
            ("height-profile.csv", table(&self.height_profile)),
            ("wall-profile.csv", table(&self.wall_profile)),
            ("density-map.csv", table(&self.density_map)),
            ("set-voronoi.csv", table(&self.set_voronoi)),
            ("stereonet.csv", net.map(|net| net as _)),
            ("tilt.csv", table(&self.tilt)),
            ("mixing-by-shape.csv", table(&self.mixing_by_shape)),
            ("mixing-by-size.csv", table(&self.mixing_by_size)),
            ("radial-distribution.csv", table(&self.radial_distribution)),
            ("coordination.csv", table(&self.coordination)),
            ("core-coordination.csv", table(&self.core_coordination)),
            ("contact-classes.csv", table(&self.classes)),
            ("force-distribution.csv", table(&self.force_distribution)),
            ("chains-by-weight.csv", table(&self.chains_by_weight)),
            (
                "chains-by-weight-segments.csv",
                by_weight.as_ref().map(|t| &t.0 as _),
            ),
            (
                "chains-by-weight-links.csv",
                by_weight.as_ref().map(|t| &t.1 as _),
            ),
            ("chains-by-stress.csv", table(&self.chains_by_stress)),
            (
                "chains-by-stress-segments.csv",
                by_stress.as_ref().map(|t| &t.0 as _),
            ),
            (
                "chains-by-stress-links.csv",
                by_stress.as_ref().map(|t| &t.1 as _),
            ),
            ("threshold-curve.csv", table(&self.threshold_curve)),
            ("body-stresses.csv", table(&self.body_stresses)),
            ("stress-profile.csv", table(&self.stress_profile)),
            ("vertical-balance.csv", table(&self.vertical_balance)),
            ("wall-forces.csv", table(&self.wall_forces)),
            ("fabric.csv", table(&self.fabric)),
            (MixingSeries::FILE, None),
            ("density-map.vti", None),
            ("fields.vti", None),
        ];
        for (name, table) in all {
            let path = tables.join(name);
            match table {
                Some(table) => write_file(path, |w| table.write_csv(w))?,
                None => remove(&path)?,
            }
        }
        if let Some(map) = &self.density_map {
            write_file(tables.join("density-map.vti"), |w| vti::write(map, w))?;
        }
        if let Some(fields) = &self.fields {
            write_file(tables.join("fields.vti"), |w| {
                vti::write_continuum(fields, w)
            })?;
        }
        write_file(folder.join(JSON), |w| {
            serde_json::to_writer_pretty(&mut *w, self)?;
            w.write_all(b"\n")
        })
    }
}

fn table<T: Table>(table: &Option<T>) -> Option<&dyn Table> {
    table.as_ref().map(|table| table as &dyn Table)
}

fn remove(path: &Path) -> Result<(), ViewError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(ViewError::Write {
            path: path.to_path_buf(),
            source,
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::TableOptions;
    use crate::testing::two_cubes;

    #[test]
    fn files_of_an_earlier_analysis_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let tables = folder.path().join(FOLDER);
        fs::create_dir(&tables).unwrap();
        for name in [MixingSeries::FILE, "fields.vti"] {
            fs::write(tables.join(name), "old").unwrap();
        }
        let snapshot = two_cubes();
        let found = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
        found.write(&snapshot, folder.path()).unwrap();
        for name in [MixingSeries::FILE, "fields.vti"] {
            assert!(!tables.join(name).exists(), "{name}");
        }
        assert!(tables.join("bodies.csv").is_file());
    }
}
