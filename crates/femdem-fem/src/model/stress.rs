//! Stresses inside a body.

use super::forces::State;
use super::{DeformableModel, Workspace};
use crate::element::{Element, ElementFailure, T4, T10, Table};
use femdem_mesh::Matrix3;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// The state of stress of an element: the mean over its points, weighted by their current volumes, so that
/// sums of stress times current volume balance the nodal forces exactly: sum V sigma = -sum f (x) x over
/// elements and nodes. With F-bar and averaged pressures it contains the averaged pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ElementStress {
    /// Cauchy stress, Pa; tension is positive.
    pub cauchy: Matrix3,
    /// Volume over that in the reference state.
    pub volume_ratio: f64,
}

/// Von Mises stress of a Cauchy stress, sqrt(3/2 s : s) with the deviator s, Pa.
#[must_use]
pub fn von_mises(cauchy: &Matrix3) -> f64 {
    let deviator = cauchy - Matrix3::identity() * (cauchy.trace() / 3.0);
    (1.5 * deviator.norm_squared()).sqrt()
}

impl ElementStress {
    /// Mean pressure, -tr sigma / 3, Pa; compression is positive.
    #[must_use]
    pub fn pressure(&self) -> f64 {
        -self.cauchy.trace() / 3.0
    }

    /// [`von_mises`] of the Cauchy stress.
    #[must_use]
    pub fn von_mises(&self) -> f64 {
        von_mises(&self.cauchy)
    }

    /// Principal stresses, Pa, the largest (most tensile) first.
    #[must_use]
    pub fn principal(&self) -> [f64; 3] {
        let symmetric = 0.5 * (self.cauchy + self.cauchy.transpose());
        let mut values: [f64; 3] = symmetric.symmetric_eigenvalues().into();
        values.sort_by(|a, b| b.total_cmp(a));
        values
    }
}

impl DeformableModel {
    /// Equivalent plastic strain of every element, the mean over its points; 0 for elements without
    /// plasticity. `None` if no material is plastic.
    ///
    /// # Errors
    ///
    /// [`ElementFailure::Length`] for a history of another length than the model's.
    pub fn plastic_strains(&self, history: &[f64]) -> Result<Option<Vec<f64>>, ElementFailure> {
        if history.len() != self.history_len() {
            return Err(ElementFailure::Length {
                what: "history",
                found: history.len(),
                expected: self.history_len(),
            });
        }
        let points = self.element.point_count();
        let mut plastic = false;
        let mut of_element = |e: usize| {
            let at_point = |q| {
                self.material(e)
                    .plastic_strain(&history[self.history_at(e, q)])
            };
            let strains: Vec<f64> = (0..points).filter_map(at_point).collect();
            plastic |= !strains.is_empty();
            strains.iter().sum::<f64>() / points as f64
        };
        let strains = (0..self.volumes.len()).map(&mut of_element).collect();
        Ok(plastic.then_some(strains))
    }

    /// Stress of every element at positions `x` (m) with the history `old` of these positions; at rest,
    /// without viscous stresses.
    ///
    /// # Errors
    ///
    /// [`ElementFailure`] as from [`DeformableModel::internal_forces`].
    pub fn stresses(
        &self,
        x: &[Vector3],
        old: &[f64],
    ) -> Result<Vec<ElementStress>, ElementFailure> {
        self.check_lengths(x, old)?;
        let state = State { x, v: &[], old };
        match self.element {
            Element::T4 => self.own_stresses(&T4, false, state),
            Element::T10 => self.own_stresses(&T10, false, state),
            Element::T10Fbar => self.own_stresses(&T10, true, state),
            Element::T4NodalPressure => self.averaged_stresses(state),
        }
    }

    fn own_stresses<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
    ) -> Result<Vec<ElementStress>, ElementFailure> {
        let mut next = vec![0.0; self.history_stride];
        let (elements, _) = self.connectivity.as_chunks::<N>();
        let mut all = Vec::with_capacity(elements.len());
        for (e, nodes) in elements.iter().enumerate() {
            let points = self.points(table, e, nodes, state);
            let bars = if bar {
                Some(self.bars(e, &points)?)
            } else {
                None
            };
            let mut stresses = [Matrix3::zeros(); Q];
            for (q, stress) in stresses.iter_mut().enumerate() {
                let felt = bars
                    .as_ref()
                    .map_or(points[q], |bars| bars.felt(q, &points));
                let history = self.history_at(e, q);
                let next = &mut next[..history.len()];
                *stress = self.respond(e, &felt, &state.old[history], next)?.piola;
            }
            if let Some(bars) = &bars {
                stresses = bars.stresses(&stresses);
            }
            let kirchhoff = |q: usize| stresses[q] * points[q].gradient.transpose();
            let ratio: f64 = points.iter().map(|p| p.gradient.determinant()).sum();
            all.push(ElementStress {
                cauchy: (0..Q).fold(Matrix3::zeros(), |sum, q| sum + kirchhoff(q)) / ratio,
                volume_ratio: ratio / Q as f64,
            });
        }
        Ok(all)
    }

    fn averaged_stresses(&self, state: State) -> Result<Vec<ElementStress>, ElementFailure> {
        let Some(averages) = &self.averages else {
            return Ok(Vec::new());
        };
        let mut work = Workspace::default();
        let mut next = vec![0.0; self.history_stride];
        let bars = self.nodal_bars(averages, state, &mut work)?;
        let mut piolas = Vec::with_capacity(bars.len());
        for (e, (bar, _)) in bars.iter().enumerate() {
            let felt = crate::material::Deformation::at_rest(bar.gradient());
            let history = self.history_at(e, 0);
            let next = &mut next[..history.len()];
            piolas.push(self.respond(e, &felt, &state.old[history], next)?.piola);
        }
        let values: Vec<f64> = bars
            .iter()
            .zip(&piolas)
            .map(|((bar, _), piola)| bar.trace(piola) / (3.0 * bar.mean))
            .collect();
        let pressures = averages.smoothed(&self.volumes, &values);
        let of_element = |(e, (bar, _)): (usize, &(crate::element::Bar, f64))| ElementStress {
            cauchy: bar.stress(&piolas[e], pressures[e]) * work.gradients[e].transpose()
                / work.ratios[e],
            volume_ratio: work.ratios[e],
        };
        Ok(bars.iter().enumerate().map(of_element).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stress(cauchy: Matrix3) -> ElementStress {
        ElementStress {
            cauchy,
            volume_ratio: 1.0,
        }
    }

    #[test]
    fn uniaxial_tension_and_pressure() {
        let pulled = stress(Matrix3::from_diagonal(&Vector3::new(0.0, 5.0, 0.0)));
        assert!((pulled.von_mises() - 5.0).abs() < 1e-14);
        assert!((pulled.pressure() + 5.0 / 3.0).abs() < 1e-14);
        assert_eq!(pulled.principal(), [5.0, 0.0, 0.0]);
        assert_eq!(stress(Matrix3::identity() * -3.0).von_mises(), 0.0);
    }

    #[test]
    fn pure_shear() {
        // Shear t: von Mises sqrt(3) t, principal t, 0, -t.
        let mut cauchy = Matrix3::zeros();
        (cauchy[(0, 1)], cauchy[(1, 0)]) = (2.0, 2.0);
        let sheared = stress(cauchy);
        assert!((sheared.von_mises() - 12_f64.sqrt()).abs() < 1e-14);
        let [most, middle, least] = sheared.principal();
        assert!((most - 2.0).abs() + middle.abs() + (least + 2.0).abs() < 1e-14);
    }
}
