//! Sums over all ranks that are the same for any number of them.

use super::World;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::ledger::Ledger;
use femdem_contact::ExactSum;
use femdem_mesh::Vector3;

impl World {
    /// Kinetic energy of all bodies of all ranks except driven ones, J: exact, as [`resistances`](Self::resistances).
    ///
    /// # Errors
    /// As [`resistances`](Self::resistances).
    pub fn kinetic_energy_on(&self, halo: &mut dyn Halo) -> Result<f64, SolveError> {
        let rigid = self.free_bodies().map(|(_, body)| body.kinetic_energy());
        let soft = self.own_nodes();
        let soft = soft.map(|(_, nodes, model)| nodes.kinetic_energy(model.model.masses()));
        let [energy] = self.sums_of_all([rigid.chain(soft).collect()], halo)?;
        Ok(energy)
    }

    /// As [`linear_momentum`](Self::linear_momentum), of all ranks: exact, as [`resistances`](Self::resistances), kg m/s.
    ///
    /// # Errors
    /// As [`resistances`](Self::resistances).
    pub fn linear_momentum_on(&self, halo: &mut dyn Halo) -> Result<Vector3, SolveError> {
        let rigid = self
            .free_bodies()
            .map(|(_, body)| body.velocity * body.mass);
        let soft = self.deformables().map(|body| body.momentum());
        let [x, y, z] = self.sums_of_all(of_vectors(rigid.chain(soft)), halo)?;
        Ok(Vector3::new(x, y, z))
    }

    /// As [`centre_of_mass`](Self::centre_of_mass), of all ranks: exact sums, as [`resistances`](Self::resistances), m.
    ///
    /// # Errors
    /// As [`resistances`](Self::resistances).
    pub fn centre_of_mass_on(&self, halo: &mut dyn Halo) -> Result<Vector3, SolveError> {
        let masses = self.free_bodies().map(|(_, body)| body.mass);
        let masses = masses.chain(self.deformables().map(|body| body.mass()));
        let rigid = self
            .free_bodies()
            .map(|(_, body)| body.position * body.mass);
        let soft = self.deformables().map(|body| body.centroid() * body.mass());
        let [x, y, z] = of_vectors(rigid.chain(soft));
        let [mass, x, y, z] = self.sums_of_all([masses.collect(), x, y, z], halo)?;
        let moment = Vector3::new(x, y, z);
        Ok(if mass > 0.0 { moment / mass } else { moment })
    }

    /// The ledger of all ranks: exact sums of what each has summed up.
    ///
    /// # Errors
    /// As [`resistances`](Self::resistances).
    pub fn ledger_on(&self, halo: &mut dyn Halo) -> Result<Ledger, SolveError> {
        let mut ledger = self.ledger();
        let own = ledger.terms().map(|term| ExactSum::from_iter([*term]));
        let sums = self.sums_of_all(own, halo)?;
        for (term, sum) in ledger.terms().into_iter().zip(sums) {
            *term = sum;
        }
        Ok(ledger)
    }

    /// The values of sums over all ranks, each of which gives its own terms: exact and rounded once, as those of
    /// [`resistances`](Self::resistances).
    ///
    /// # Errors
    /// As [`resistances`](Self::resistances).
    pub fn sums_on(&self, own: Vec<ExactSum>, halo: &mut dyn Halo) -> Result<Vec<f64>, SolveError> {
        self.fits(halo)?;
        if halo.size() == 1 {
            return Ok(own.iter().map(ExactSum::value).collect());
        }
        let mut words: Vec<u64> = own.into_iter().flat_map(ExactSum::words).collect();
        halo.sum(&mut words)?;
        let (sums, _) = words.as_chunks();
        let value = |words| ExactSum::of_words(words).value();
        Ok(sums.iter().map(value).collect())
    }

    /// The values of sums over all ranks.
    pub(super) fn sums_of_all<const N: usize>(
        &self,
        own: [ExactSum; N],
        halo: &mut dyn Halo,
    ) -> Result<[f64; N], SolveError> {
        let all = self.sums_on(own.into(), halo)?;
        Ok(std::array::from_fn(|k| all[k]))
    }
}

/// The sums of vectors, by component.
fn of_vectors(vectors: impl Iterator<Item = Vector3>) -> [ExactSum; 3] {
    let mut sums = <[ExactSum; 3]>::default();
    for vector in vectors {
        for (sum, term) in sums.iter_mut().zip(&vector) {
            sum.add(*term);
        }
    }
    sums
}
