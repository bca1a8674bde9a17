//! Mass scaling: mass added to the few elements that would determine the time step of the whole body.

use super::DeformableModel;
use crate::error::{FemError, check};
use crate::material::{Deformation, Material};
use femdem_mesh::Matrix3;

/// Largest number of iterations of adding mass, and the relative excess of a squared frequency at which they
/// end.
const ROUNDS: usize = 20;
const CLOSE: f64 = 1e-3;

impl DeformableModel {
    /// The model with mass added to every element whose critical step in the reference state is below `step`
    /// (s), just enough to reach it. [`DeformableModel::added_mass`] returns the added mass. Forces do not
    /// change; inertia and weight do, so this is for quasi-static work, or where the added mass is small.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] if `step` is not positive, or so long that the mass is not finite;
    /// [`FemError::Element`] if a material has no stiffness in the reference state.
    pub fn with_mass_scaling(mut self, step: f64) -> Result<Self, FemError> {
        check("step of mass scaling", step, step > 0.0, "positive, in s")?;
        let count = self.volumes.len();
        self.mass_factors = vec![1.0; count];
        self.lump();
        let mut worst = f64::INFINITY;
        for round in 0..=ROUNDS {
            let excess = self.excess(step)?;
            worst = excess.iter().copied().fold(1.0, f64::max);
            if worst <= 1.0 + CLOSE || round == ROUNDS {
                break;
            }
            for (factor, excess) in self.mass_factors.iter_mut().zip(excess) {
                *factor *= excess.max(1.0);
            }
            self.lump();
        }
        if worst > 1.0 {
            // The remaining excess is added to all elements, which scales every frequency alike.
            self.mass_factors.iter_mut().for_each(|f| *f *= worst);
            self.lump();
        }
        if self.mass_factors.iter().all(|f| *f == 1.0) {
            self.mass_factors.clear();
        }
        self.check_mass()?;
        Ok(self)
    }

    /// By element, omega^2 step^2/4 of its bound in the reference state.
    fn excess(&self, step: f64) -> Result<Vec<f64>, FemError> {
        let reference = Deformation::at_rest(Matrix3::identity());
        let each = self.couplings.iter().enumerate().map(|(e, coupling)| {
            let material = self.material(e);
            let virgin = vec![0.0; material.history_len()];
            let stiffness = material.stiffness_bound(&reference, &virgin);
            if stiffness.is_finite() {
                Ok(stiffness * coupling * step * step / 4.0)
            } else {
                Err(self.failure(e, &reference.gradient).into())
            }
        });
        each.collect()
    }
}
