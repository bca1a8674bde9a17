//! Mass scaling: mass added to the few elements that would set everyone's time step.

use super::DeformableModel;
use crate::error::{SolveError, check};
use crate::material::{Deformation, Material};
use femdem_mesh::Matrix3;

impl DeformableModel {
    /// The model with mass added to every element whose critical step in the reference state is
    /// below `step` (s), just enough to bring it there. [`DeformableModel::added_mass`] reports how
    /// much that is. Forces stay what they are; inertia and weight change, so this is for
    /// quasi-static work, or where the added mass is small.
    ///
    /// # Errors
    ///
    /// [`SolveError::Parameter`] if `step` is not positive; [`SolveError::Element`] if a material has
    /// no stiffness in the reference state.
    pub fn with_mass_scaling(mut self, step: f64) -> Result<Self, SolveError> {
        check("step of mass scaling", step, step > 0.0, "positive, in s")?;
        self.mass_factors.clear();
        self.lump();
        let reference = Deformation::at_rest(Matrix3::identity());
        let mut factors = Vec::with_capacity(self.couplings.len());
        for (e, coupling) in self.couplings.iter().enumerate() {
            let material = self.material(e);
            let virgin = vec![0.0; material.history_len()];
            let stiffness = material.stiffness_bound(&reference, &virgin);
            if !stiffness.is_finite() {
                return Err(self.failure(e, &reference.gradient).into());
            }
            factors.push((stiffness * coupling * step * step / 4.0).max(1.0));
        }
        self.mass_factors = factors;
        self.lump();
        Ok(self)
    }
}
