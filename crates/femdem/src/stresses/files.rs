//! The files of the stresses of a pack.

use std::io::{self, Write};
use std::path::Path;

use femdem_analysis::{Cell, Table};
use femdem_fem::ElementStress;
use femdem_mesh::Vector3;
use femdem_view::output::write_file;
use femdem_view::picture::{PictureOptions, draw_by};

use super::{BodyStress, Field, StressOptions, StressSummary, Stresses};
use crate::grid::{GridBody, GridMesh, write_grid};
use crate::means::COMPONENTS;
use crate::run::unit_of;
use crate::{Body, BodyValues, Error, Snapshot, Spacing};

impl Stresses {
    /// Writes `stress.csv`, `stress.png`, `stresses.json` and, if fields were kept, `stress.vtu` into a folder. Their bodies are
    /// those of `snapshot`, which the stresses were found of.
    ///
    /// # Errors
    ///
    /// [`Error::View`] for a file that cannot be written.
    pub fn write(
        &self,
        folder: &Path,
        snapshot: &Snapshot,
        options: &StressOptions,
        summary: &StressSummary,
    ) -> Result<(), Error> {
        write_file(folder.join("stress.csv"), |w| {
            let strength = options.strength;
            let bodies = &self.bodies;
            Rows { bodies, strength }.write_csv(w)
        })?;
        if !self.fields.is_empty() {
            write_file(folder.join("stress.vtu"), |w| {
                self.write_fields(snapshot, w)
            })?;
        }
        let image = draw_by(snapshot, &self.values(), &PictureOptions::default())?;
        write_file(folder.join("stress.png"), |w| image.write_png(w))?;
        write_file(folder.join("stresses.json"), |w| {
            serde_json::to_writer_pretty(&mut *w, summary)?;
            writeln!(w)
        })?;
        Ok(())
    }

    /// Whether the fields of the bodies were kept.
    #[must_use]
    pub fn has_fields(&self) -> bool {
        !self.fields.is_empty()
    }

    fn write_fields(&self, snapshot: &Snapshot, writer: impl Write) -> io::Result<()> {
        let own = || self.fields.iter().zip(&snapshot.bodies);
        let of_body = |((_, solved), body): (&Field, &Body)| -> Vec<ElementStress> {
            let turn = body.pose.rotation.to_rotation_matrix();
            let in_world = |stress: ElementStress| ElementStress {
                cauchy: turn.matrix() * stress.cauchy * turn.matrix().transpose(),
                ..stress
            };
            solved.elements().map(in_world).collect()
        };
        let stresses: Vec<Vec<ElementStress>> = own().map(of_body).collect();
        let mut bodies = Vec::new();
        for (number, ((model, solved), body)) in own().enumerate() {
            let place = |(x, u): (&Vector3, &Vector3)| {
                body.pose.rotation * (x + u) + body.pose.translation.vector
            };
            let nodes = model.nodes().iter().zip(solved.displacements());
            bodies.push(GridBody {
                number,
                placed: body.pose,
                mesh: GridMesh::of(model),
                positions: nodes.map(place).collect::<Vec<_>>().into(),
                velocities: None,
                stresses: (&*stresses[number]).into(),
                is_asleep: body.sleeping,
                plastic_strains: None,
            });
        }
        write_grid(&|take| bodies.iter().try_for_each(take), writer, |_| {})
    }

    /// The bodies' largest tensions, for a picture.
    fn values(&self) -> BodyValues {
        let values = self
            .bodies
            .iter()
            .map(|body| body.peaks.tension.unwrap_or(f64::NAN));
        let most = values.clone().fold(0.0, f64::max);
        let (unit, name) = unit_of(most);
        BodyValues {
            title: format!("largest tension / {name}"),
            note: "Largest principal stress in the body away from its contacts.".to_owned(),
            values: values.map(|tension| tension / unit).collect(),
            range: [0.0, if most > 0.0 { most / unit } else { 1.0 }],
            spacing: Spacing::Linear,
        }
    }
}

/// The table of bodies.
struct Rows<'a> {
    bodies: &'a [BodyStress],
    strength: Option<f64>,
}

const COLUMNS: [&str; 24] = [
    "body",
    "volume_m3",
    "contacts",
    "splitting_pa",
    "tension_pa",
    "von_mises_pa",
    "tension_anywhere_pa",
    "von_mises_anywhere_pa",
    "elements_xx_pa",
    "elements_yy_pa",
    "elements_zz_pa",
    "elements_yz_pa",
    "elements_zx_pa",
    "elements_xy_pa",
    "contacts_xx_pa",
    "contacts_yy_pa",
    "contacts_zz_pa",
    "contacts_yz_pa",
    "contacts_zx_pa",
    "contacts_xy_pa",
    "net_force",
    "residual",
    "strength_ratio",
    "cracks",
];

impl Table for Rows<'_> {
    fn columns(&self) -> &'static [&'static str] {
        &COLUMNS
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let known = |number: Option<f64>| number.map_or(Cell::Empty, Cell::Number);
        Box::new(self.bodies.iter().enumerate().map(move |(i, body)| {
            let peaks = &body.peaks;
            let mut row = vec![
                Cell::Count(i as u64),
                Cell::Number(body.volume),
                Cell::Count(body.contacts.into()),
                Cell::Number(body.splitting),
                known(peaks.tension),
                known(peaks.von_mises),
                Cell::Number(peaks.tension_anywhere),
                Cell::Number(peaks.von_mises_anywhere),
            ];
            for stress in [&body.elements, &body.contacts_mean] {
                row.extend(COMPONENTS.map(|place| Cell::Number(stress[place])));
            }
            row.extend([known(body.net_force), Cell::Number(body.residual)]);
            let ratio = self.strength.zip(peaks.tension);
            let ratio = ratio.map(|(strength, tension)| tension / strength);
            row.push(known(ratio));
            row.push(ratio.map_or(Cell::Empty, |ratio| Cell::Count(u64::from(ratio > 1.0))));
            row
        }))
    }
}
