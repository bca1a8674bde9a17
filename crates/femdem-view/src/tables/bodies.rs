//! One row per body, from all tables with values by body.

use femdem_analysis::{Cell, ContactCount, Table, contact_counts};

use super::Tables;
use crate::{Snapshot, ViewError};

/// A body counts as inside the region of the cells if this part of its volume lies there; the rest may be
/// overlaps.
const WHOLE: f64 = 0.95;

/// The known values of each body, as a [`Table`]; unknown ones are empty.
#[derive(Clone, Debug)]
pub struct BodyTable<'a> {
    tables: &'a Tables,
    counts: Vec<ContactCount>,
    rattler: Vec<bool>,
    /// Density of the Set-Voronoi cell.
    density: Vec<Option<f64>>,
    /// Number of the chain by weight and by stress.
    chains: [Vec<Option<u32>>; 2],
}

impl<'a> BodyTable<'a> {
    /// From a snapshot and its tables.
    ///
    /// # Errors
    ///
    /// As [`Tables::compute`].
    pub fn new(snapshot: &Snapshot, tables: &'a Tables) -> Result<Self, ViewError> {
        let count = snapshot.bodies.len();
        let threshold = tables.options.force_threshold;
        let mut rattler = vec![false; count];
        for body in tables.rattlers.iter().flat_map(|r| &r.bodies) {
            if let Some(entry) = rattler.get_mut(*body as usize) {
                *entry = true;
            }
        }
        let mut density = vec![None; count];
        let volumes: Vec<f64> = snapshot
            .shapes
            .iter()
            .map(|shape| shape.polyhedron.mass_properties().volume)
            .collect();
        for cell in tables.set_voronoi.iter().flat_map(|v| &v.cells) {
            let body = snapshot.bodies.get(cell.body as usize);
            let whole = body.and_then(|body| volumes.get(body.shape as usize));
            // A body that reaches beyond the region has an incomplete cell there.
            if whole.is_some_and(|whole| cell.solid > WHOLE * whole) {
                density[cell.body as usize] = Some(cell.density);
            }
        }
        let chains = [&tables.chains_by_weight, &tables.chains_by_stress].map(|network| {
            let mut chain_of = vec![None; count];
            for link in network.iter().flat_map(|n| &n.links) {
                for body in [link.first, link.second] {
                    if let Some(entry) = chain_of.get_mut(body as usize) {
                        *entry = Some(link.chain);
                    }
                }
            }
            chain_of
        });
        Ok(Self {
            tables,
            counts: contact_counts(count, &snapshot.touches(), threshold)?,
            rattler,
            density,
            chains,
        })
    }

    fn row(&self, body: usize) -> Vec<Cell> {
        let tables = self.tables;
        let known = tables.coordination.is_some();
        let count = known.then(|| self.counts.get(body)).flatten();
        let largest = tables.force_maxima.as_ref();
        let stress = tables.body_stresses.as_ref();
        let stress = stress.and_then(|s| s.bodies.get(body)).map(|b| &b.stress);
        let rattler = tables.rattlers.as_ref();
        let mut cells = vec![
            body.into(),
            count.map(|c| c.bodies).into(),
            count.map(|c| c.walls).into(),
            rattler.map(|_| u32::from(self.rattler[body])).into(),
            self.density[body].into(),
            largest.and_then(|m| m.bodies.get(body).copied()).into(),
            self.chains[0][body].into(),
            self.chains[1][body].into(),
            stress.map(|s| s.pressure).into(),
            stress.map(|s| s.deviator).into(),
        ];
        for k in 0..3 {
            cells.push(stress.map(|s| s.principal[k]).into());
        }
        for direction in [0, 2] {
            for k in 0..3 {
                cells.push(stress.map(|s| s.directions[direction][k]).into());
            }
        }
        cells.push(tables.tilts.get(body).copied().flatten().into());
        cells
    }
}

impl Table for BodyTable<'_> {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "body",
            "touching_bodies",
            "touching_walls",
            "rattler",
            "local_density",
            "largest_force_over_weight",
            "chain_by_weight",
            "chain_by_stress",
            "pressure_pa",
            "deviator_pa",
            "principal_1_pa",
            "principal_2_pa",
            "principal_3_pa",
            "direction_1_x",
            "direction_1_y",
            "direction_1_z",
            "direction_3_x",
            "direction_3_y",
            "direction_3_z",
            "tilt_deg",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new((0..self.tables.bodies).map(|body| self.row(body)))
    }
}
