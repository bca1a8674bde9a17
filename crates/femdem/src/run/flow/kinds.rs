//! The sizes of the bodies of a source.

use super::SourceEntry;
use super::bring::reach_of;
use super::state::Kind;
use crate::Error;
use crate::run::Simulation;
use crate::run::geometry::Geometry;

/// Bodies whose sizes stand for those of a curve.
const OF_CURVE: u32 = 1000;

impl SourceEntry {
    /// The kinds of its bodies of a density \[kg/m^3\], with their shapes in the world.
    pub(super) fn kinds(
        &self,
        simulation: &mut Simulation,
        name: &str,
        density: f64,
    ) -> Result<Vec<Kind>, Error> {
        let grading = self.grading()?;
        let geometry = self.geometry(grading.is_some())?;
        simulation.note(geometry.note.as_ref());
        let mut kind = |geometry: &Geometry, share: f64| -> Result<Kind, Error> {
            let shape = simulation.add_shape(name, geometry)?;
            let mass = density * simulation.world.shapes()[shape as usize].volume;
            let radius = reach_of(&simulation.world, shape);
            Ok(Kind {
                shape,
                mass,
                radius,
                part: share / mass,
                come: 0,
            })
        };
        let mut kinds = match grading {
            None => vec![kind(&geometry, 1.0)?],
            Some(grading) => {
                let shares = grading.mass_shares(OF_CURVE).into_iter();
                let each = shares.map(|[size, share]| kind(&geometry.scaled(size)?, share));
                each.collect::<Result<_, _>>()?
            }
        };
        let total: f64 = kinds.iter().map(|kind| kind.part).sum();
        kinds.iter_mut().for_each(|kind| kind.part /= total);
        Ok(kinds)
    }
}
