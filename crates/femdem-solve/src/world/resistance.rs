//! What walls and the periodic cell meet when they are moved: sums over the contacts of all ranks, the same for any number of
//! them.

use super::World;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::servo::Resistance;
use femdem_contact::ExactSum;
use femdem_mesh::{Matrix3, Vector3};

/// What the periodic cell meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellResistance {
    /// As [`World::cell_stress`], Pa.
    pub stress: Matrix3,
    /// Against a change of its length along each axis, if all bodies move with it, N/m.
    pub stiffness: [f64; 3],
    /// Elastic energy of what it presses, J.
    pub energy: f64,
}

impl World {
    /// What walls meet that are moved along unit directions, for a [`Servo`](crate::Servo). Forces are without dashpots.
    ///
    /// The sums are exact and rounded once, so that the ranks of a world that is [shared out](Self::share_out) get the same bits as
    /// a world of its own, for which [`Alone`](crate::Alone) is the halo.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] if the world was not shared out over these ranks, and what `halo` reports.
    pub fn resistances(
        &self,
        walls: &[(u32, Vector3)],
        halo: &mut dyn Halo,
    ) -> Result<Vec<Resistance>, SolveError> {
        let each = self.batch.pushes(walls).into_iter().flatten();
        let own = [self.exact_energy()].into_iter().chain(each).collect();
        let sums = self.sums_on(own, halo)?;
        let [energy, each @ ..] = &sums[..] else {
            return Ok(Vec::new());
        };
        let met = each.chunks_exact(2).map(|pair| Resistance {
            force: pair[0],
            stiffness: pair[1],
            energy: *energy,
        });
        Ok(met.collect())
    }

    /// What the periodic cell meets, as [`resistances`](Self::resistances); `None` unless space repeats itself along all axes.
    ///
    /// # Errors
    /// As [`resistances`](Self::resistances).
    pub fn cell_resistance(
        &self,
        halo: &mut dyn Halo,
    ) -> Result<Option<CellResistance>, SolveError> {
        let Some((cell, volume)) = self.cell().and_then(|cell| Some((cell, cell.volume()?))) else {
            return Ok(None);
        };
        let moments = self.batch.exact_virial();
        let moments = self.sums_of_all(moments, halo)?;
        let stiffness = self.sums_of_all(self.batch.exact_stiffness(), halo)?;
        let [energy] = self.sums_of_all([self.exact_energy()], halo)?;
        let edges = cell.edges();
        Ok(Some(CellResistance {
            stress: Matrix3::from_column_slice(&moments) / volume,
            stiffness: [0, 1, 2].map(|axis| stiffness[axis] / edges[(axis, axis)].powi(2)),
            energy,
        }))
    }

    /// Mass of the free bodies, rigid ones if they are awake, kg, and the sums of mass times place of their centres, kg m.
    pub(super) fn moments_of_free(&self) -> [ExactSum; 4] {
        let free = self.awake.iter().map(|&i| &self.bodies[i as usize]);
        let free = free.filter(|body| body.driven.is_none());
        let rigid = free.map(|body| (body.mass, body.position * body.mass));
        let soft = self.own_nodes();
        let soft = soft.filter_map(|(_, nodes, model)| nodes.first_moment(model.model.masses()));
        let mut sums = <[ExactSum; 4]>::default();
        for (mass, moment) in rigid.chain(soft) {
            let terms = [mass, moment.x, moment.y, moment.z];
            for (sum, term) in sums.iter_mut().zip(terms) {
                sum.add(term);
            }
        }
        sums
    }

    /// As [`stored_energy`](Self::stored_energy).
    fn exact_energy(&self) -> ExactSum {
        let mut sum = self.batch.exact_energy();
        for (id, ..) in self.own_nodes() {
            let body = self.deformable(id);
            sum.extend(body.map(|body| {
                let cracks = body.cracks().map_or(0.0, |cracks| cracks.stored());
                body.internal().energy + cracks
            }));
        }
        sum
    }
}
