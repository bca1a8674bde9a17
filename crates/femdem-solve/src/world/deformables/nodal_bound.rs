//! Bounds of a body's frequencies node by node.

use femdem_contact::stable_step;
use femdem_fem::element::ElementFailure;
use femdem_fem::{DeformableModel, FrequencyBound};
use serde::{Deserialize, Serialize};

/// Lower limit of a node's weight over the largest weight: each must be positive.
const LEAST: f64 = 1e-100;

/// Squared frequencies f_a = c sum_b C_ab x_b/(m_a x_a) of the nodes, for weights x > 0. For any such weights
/// no frequency of the elements is above the largest f_a (L. Collatz, 1942), and with springs k_a and
/// dashpots r_a m_a at the nodes a step dt is stable if for all nodes
///
/// dt^2/4 (f_a + k_a/m_a) + dt/2 r_a <= 1.
///
/// So a contact shortens the step only as far as the elements around it leave no margin. The best weights are
/// the eigenvector of that sum; they are approached by power iteration, one iteration at a time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct NodalBound {
    weights: Vec<f64>,
    /// f_a/c, rad^2/s^2.
    frequency2: Vec<f64>,
}

impl NodalBound {
    /// Starts with the best weights of a body without contacts.
    pub fn new(model: &DeformableModel) -> Result<Self, ElementFailure> {
        let mut bound = Self {
            weights: model.frequency_weights().to_vec(),
            frequency2: Vec::new(),
        };
        bound.renew(model)?;
        Ok(bound)
    }

    fn renew(&mut self, model: &DeformableModel) -> Result<(), ElementFailure> {
        let Self {
            weights,
            frequency2,
        } = self;
        model.apply_stiffness_bound(weights, frequency2)?;
        for ((f, x), m) in frequency2.iter_mut().zip(weights).zip(model.masses()) {
            *f /= *m * *x;
        }
        Ok(())
    }

    /// One iteration of the weights towards the best ones for steps of `dt` (s). `contact` returns the
    /// stiffness of a node over its mass, 1/s^2, and its damping rate, 1/s.
    pub fn adapt(
        &mut self,
        model: &DeformableModel,
        elements: &FrequencyBound,
        contact: impl Fn(usize) -> (f64, f64),
        dt: f64,
    ) -> Result<(), ElementFailure> {
        let part = |(a, f): (usize, &f64)| {
            let (stiffness, rate) = contact(a);
            0.25 * dt * dt * (elements.stiffening * f + stiffness)
                + 0.5 * dt * (elements.viscous_rate + rate)
        };
        let parts: Vec<f64> = self.frequency2.iter().enumerate().map(part).collect();
        let top = parts.iter().copied().fold(0.0, f64::max);
        if !(top > 0.0 && top.is_finite()) {
            return Ok(());
        }
        // Half of the old weight, so that the iteration does not oscillate.
        let weights = self.weights.iter_mut().zip(&parts);
        weights.for_each(|(x, part)| *x *= 0.5 * (1.0 + part / top));
        let largest = self.weights.iter().copied().fold(0.0, f64::max);
        for x in &mut self.weights {
            *x = (*x / largest).max(LEAST);
        }
        self.renew(model)
    }

    /// The largest stable step, s, with `contact` as for [`adapt`](Self::adapt); 0 for elements without such
    /// a bound.
    pub fn step(&self, elements: &FrequencyBound, contact: impl Fn(usize) -> (f64, f64)) -> f64 {
        let mut step = f64::INFINITY;
        for (a, f) in self.frequency2.iter().enumerate() {
            let (stiffness, rate) = contact(a);
            let frequency2 = elements.stiffening * f + stiffness;
            let rate = elements.viscous_rate + rate;
            let holds = 0.25 * step * step * frequency2 + 0.5 * step * rate <= 1.0;
            if !holds {
                step = stable_step(frequency2, rate);
            }
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_fem::MaterialRegion;
    use femdem_fem::element::Element;
    use femdem_fem::material::NeoHookean;
    use femdem_mesh::shapes::{Boulder, Shape};
    use femdem_mesh::{TetMesh, Vector3};

    fn boulder(seed: u64, element: Element) -> DeformableModel {
        let boulder = Boulder {
            seed,
            angularity: 0.15,
            ..Boulder::default()
        };
        let surface = Shape::from(boulder).polyhedron(0.3).unwrap();
        let mesh = TetMesh::centroid_fan(&surface).unwrap();
        let region = MaterialRegion {
            material: NeoHookean::new(1e8, 0.2).unwrap().into(),
            density: 2700.0,
        };
        DeformableModel::new(&mesh, element, vec![region], None).unwrap()
    }

    /// The largest eigenvalue of M^-1 (dt^2/4 (K + k) + dt/2 R), from below.
    fn largest(model: &DeformableModel, dt: f64, contact: impl Fn(usize) -> (f64, f64)) -> f64 {
        let (x, masses) = (model.nodes().to_vec(), model.masses());
        let wave = |a: usize, k: f64| (7.31 * a as f64 + 1.7 * k).sin();
        let at = |a| Vector3::new(wave(a, 1.0), wave(a, 2.0), wave(a, 3.0));
        let mut shape: Vec<Vector3> = (0..x.len()).map(at).collect();
        let mut out = shape.clone();
        let mut value = 0.0;
        for _ in 0..600 {
            model.tangent_apply(&x, &[], &shape, &mut out).unwrap();
            let (mut above, mut below) = (0.0, 0.0);
            for (a, (s, f)) in shape.iter_mut().zip(&out).enumerate() {
                let (stiffness, rate) = contact(a);
                let next = f * (0.25 * dt * dt / masses[a])
                    + *s * (0.25 * dt * dt * stiffness + 0.5 * dt * rate);
                above += masses[a] * s.dot(&next);
                below += masses[a] * s.norm_squared();
                *s = next;
            }
            value = above / below;
            let size = below.sqrt();
            shape.iter_mut().for_each(|s| *s /= size);
        }
        value
    }

    /// Contacts at a few nodes. The bound is valid for any weights, adapted or not. It is never much smaller
    /// than the one that adds the largest frequencies, and larger where the worst elements are elsewhere.
    #[test]
    fn contacts_count_where_they_are() {
        let mut gained = 0;
        for (seed, element) in [1, 2, 3, 4, 5]
            .map(|s| (s, Element::T4))
            .into_iter()
            .chain([(6, Element::T10)])
        {
            let model = boulder(seed, element);
            let elements = model.stable_frequency2(model.nodes(), &[]).unwrap();
            let first = 5 * seed as usize;
            let contact = |a: usize| {
                let near = (first..first + 4).contains(&a);
                let omega2 = elements.frequency2;
                if near {
                    (0.1 * omega2, 0.3 * omega2.sqrt())
                } else {
                    (0.0, 0.0)
                }
            };
            let mut bound = NodalBound::new(&model).unwrap();
            let alone = bound.step(&elements, |_| (0.0, 0.0));
            assert!(alone > 0.9 * elements.critical_step(), "{seed}: {alone}");
            let before = bound.step(&elements, contact);
            for _ in 0..100 {
                bound.adapt(&model, &elements, contact, before).unwrap();
            }
            let after = bound.step(&elements, contact);
            for step in [before, after] {
                let most = largest(&model, step, contact);
                assert!(most < 1.0 + 1e-9, "{seed}: {most}");
            }
            let apart = stable_step(1.1 * elements.frequency2, 0.3 * elements.frequency2.sqrt());
            assert!(after > 0.99 * apart, "{seed}: {after} {apart}");
            gained += usize::from(after > 1.1 * apart);
        }
        assert!(gained >= 4, "{gained}");
    }

    /// Elements whose stiffness depends on others have no bound by nodes.
    #[test]
    fn averaged_elements_have_none() {
        for element in [Element::T10Fbar, Element::T4NodalPressure] {
            let model = boulder(1, element);
            let elements = model.stable_frequency2(model.nodes(), &[]).unwrap();
            let step = NodalBound::new(&model)
                .unwrap()
                .step(&elements, |_| (0.0, 0.0));
            assert_eq!(step, 0.0, "{element:?}");
        }
    }
}
