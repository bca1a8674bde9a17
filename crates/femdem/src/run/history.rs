//! Tables over time: `history.csv`, and `members.csv` with a row for every body.

use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::Path;

use femdem_contact::BodyId;
use femdem_mesh::Vector3;
use femdem_solve::World;
use femdem_view::ViewError;
use femdem_view::output::csv::quoted;
use serde::{Deserialize, Serialize};

use super::measured::Measured;
use super::{NamedWall, Simulation};
use crate::Error;

/// Columns of `history.csv` before those of the walls and supports.
pub const HISTORY_COLUMNS: [&str; 36] = [
    "time",
    "step",
    "time_step",
    "kinetic",
    "potential",
    "strain",
    "contact",
    "friction_springs",
    "cracks",
    "bonds",
    "dissipated_friction",
    "dissipated_damping",
    "dissipated_medium",
    "dissipated_viscous",
    "dissipated_plastic",
    "dissipated_bridges",
    "dissipated_fracture",
    "dissipated_bonds",
    "dissipated_release",
    "frozen",
    "work_in",
    "by_hand",
    "lent",
    "fidelity",
    "energy_error",
    "px",
    "py",
    "pz",
    "x_mean",
    "y_mean",
    "z_mean",
    "contacts",
    "fragments",
    "bonds_holding",
    "bonds_broken",
    "deformable_share",
];

/// Columns of `members.csv`.
pub const MEMBER_COLUMNS: [&str; 17] = [
    "time", "body", "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz", "kinetic", "strain", "qw",
    "qx", "qy", "qz",
];

/// Bytes of rows that are kept in memory, where there are many.
const MANY: usize = 1 << 22;

/// A text file that grows by rows. The rows since the last flush are kept in memory, so that a file can be
/// taken back to the state of a checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Table {
    /// Bytes in the file.
    written: u64,
    pending: String,
}

impl Table {
    /// Without rows.
    pub const EMPTY: Self = Self {
        written: 0,
        pending: String::new(),
    };

    pub fn row(&mut self, fields: impl IntoIterator<Item = String>) {
        for (i, field) in fields.into_iter().enumerate() {
            if i > 0 {
                self.pending.push(',');
            }
            self.pending.push_str(&field);
        }
        self.pending.push('\n');
    }

    /// A row of so many that they are appended to the file on the way.
    pub fn row_of_many(
        &mut self,
        fields: impl IntoIterator<Item = String>,
        path: &Path,
    ) -> Result<(), Error> {
        self.row(fields);
        match self.pending.len() > MANY {
            true => self.flush(path),
            false => Ok(()),
        }
    }

    /// Appends the new rows to the file, after cutting off anything beyond the bytes written before.
    pub fn flush(&mut self, path: &Path) -> Result<(), Error> {
        let append = || -> std::io::Result<()> {
            let mut file = open(path, self.written)?;
            file.write_all(self.pending.as_bytes())
        };
        append().map_err(|source| ViewError::Write {
            path: path.to_path_buf(),
            source,
        })?;
        self.written += self.pending.len() as u64;
        self.pending.clear();
        Ok(())
    }
}

/// The file cut to its first `length` bytes, for appending. A shorter file is left unchanged.
fn open(path: &Path, length: u64) -> std::io::Result<File> {
    use std::io::{Seek, SeekFrom};
    let mut file = OpenOptions::new()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path)?;
    if file.metadata()?.len() > length {
        file.set_len(length)?;
    }
    file.seek(SeekFrom::End(0))?;
    Ok(file)
}

/// Header of `history.csv`.
pub(super) fn history_header(simulation: &Simulation) -> Vec<String> {
    let of_wall =
        |wall: &NamedWall| ["fx", "fy", "fz"].map(|f| quoted(&format!("{f} {}", wall.name)));
    let walls = simulation.walls.iter().flat_map(of_wall);
    let of_support = |support| {
        let name = simulation.support_name(support);
        ["rx", "ry", "rz"].map(|r| quoted(&format!("{r} {name}")))
    };
    let supports = simulation.supports.iter().flat_map(of_support);
    HISTORY_COLUMNS
        .map(str::to_owned)
        .into_iter()
        .chain(walls)
        .chain(supports)
        .collect()
}

/// A row of `history.csv`.
pub(super) fn history_row(world: &World, seen: &Measured) -> Vec<String> {
    let Measured {
        ledger,
        momentum: p,
        centre: x,
        ..
    } = seen;
    let mut row = vec![number(world.time()), world.steps().to_string()];
    let numbers = [
        world.time_step(),
        ledger.kinetic,
        ledger.potential,
        ledger.strain,
        ledger.elastic,
        ledger.friction_springs,
        ledger.cracks,
        ledger.bonds,
        ledger.dissipated_friction,
        ledger.dissipated_damping,
        ledger.dissipated_medium,
        ledger.dissipated_viscous,
        ledger.dissipated_plastic,
        ledger.dissipated_bridges,
        ledger.dissipated_fracture,
        ledger.dissipated_bonds,
        ledger.dissipated_release,
        ledger.frozen,
        ledger.work_in + ledger.load_work,
        ledger.by_hand,
        ledger.lent,
        ledger.fidelity,
        ledger.error(),
        p.x,
        p.y,
        p.z,
        x.x,
        x.y,
        x.z,
    ];
    row.extend(numbers.map(number));
    row.push(seen.contacts.to_string());
    row.push(seen.pieces.to_string());
    row.extend(seen.bonds.map(|count| count.to_string()));
    row.push(number(seen.deformable_share));
    row.extend(seen.walls.iter().flat_map(vector));
    row.extend(seen.reactions.iter().flat_map(vector));
    row
}

/// What `members.csv` says of a body.
#[derive(Serialize, Deserialize)]
pub(super) struct MemberState {
    place: Vector3,
    velocity: Vector3,
    /// From contacts.
    force: Vector3,
    kinetic: f64,
    strain: f64,
    /// w, x, y and z of the quaternion of a rigid body.
    turned: Option<[f64; 4]>,
}

impl MemberState {
    /// Of a body of a world; `None` if it is not there.
    pub fn of(world: &World, id: BodyId, force: &Vector3) -> Option<Self> {
        let turned = world.pose(id).map(|pose| {
            let q = pose.rotation;
            [q.w, q.i, q.j, q.k]
        });
        let strain = world.deformable(id).map(|body| body.internal().energy);
        Some(Self {
            place: world.position(id)?,
            velocity: world.velocity(id)?,
            force: *force,
            kinetic: world.body_kinetic_energy(id)?,
            strain: strain.unwrap_or(0.0),
            turned,
        })
    }

    /// Its row of `members.csv`.
    pub fn row(&self, time: f64, name: &str) -> Vec<String> {
        let mut row = vec![number(time), quoted(name)];
        let vectors = [&self.place, &self.velocity, &self.force];
        row.extend(vectors.into_iter().flat_map(vector));
        row.extend([self.kinetic, self.strain].map(number));
        let turned = self.turned.map(|q| q.map(number));
        row.extend(turned.unwrap_or([const { String::new() }; 4]));
        row
    }
}

pub(super) fn vector(v: &Vector3) -> [String; 3] {
    <[f64; 3]>::from(*v).map(number)
}

/// All digits; large and small numbers with powers of ten, and no -0.
pub(super) fn number(value: f64) -> String {
    let value = value + 0.0;
    let mut text = String::new();
    let size = value.abs();
    // Writing to a string cannot fail.
    let _ = if size != 0.0 && !(1e-4..1e7).contains(&size) {
        write!(text, "{value:e}")
    } else {
        write!(text, "{value}")
    };
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_goes_on_where_its_record_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let mut table = Table::EMPTY;
        table.row(["a".to_owned(), "b".to_owned()]);
        table.flush(&path).unwrap();
        let mut saved = table.clone();
        table.row(["lost".to_owned()]);
        table.flush(&path).unwrap();
        saved.row(["kept".to_owned()]);
        saved.flush(&path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "a,b\nkept\n");
    }

    #[test]
    fn numbers_keep_all_digits() {
        for value in [0.1 + 0.2, -1e-300, 123_456_789.125, 0.0, 5.0, f64::MAX] {
            assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!(number(1e-9), "1e-9");
    }
}
