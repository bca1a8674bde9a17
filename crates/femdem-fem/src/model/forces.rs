//! Internal forces: minus the gradient of the stored energy, and viscous stresses.

use super::DeformableModel;
use super::nodal::NodalAverages;
use crate::element::{Bar, Element, ElementFailure, Node, T4, T10, Table};
use crate::material::{Deformation, Material, Response};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::ops::{AddAssign, Range};

/// Energies of a body in one state.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct InternalState {
    /// Stored in the material, J.
    pub energy: f64,
    /// Turned into heat by viscosity, W.
    pub viscous_power: f64,
    /// Dissipated by plastic flow since the old history, J.
    pub plastic_work: f64,
}

impl InternalState {
    fn add(&mut self, response: &Response, weight: f64) {
        self.energy += response.energy * weight;
        self.viscous_power += response.viscous_power * weight;
        self.plastic_work += response.plastic_work * weight;
    }
}

impl AddAssign for InternalState {
    fn add_assign(&mut self, other: Self) {
        self.energy += other.energy;
        self.viscous_power += other.viscous_power;
        self.plastic_work += other.plastic_work;
    }
}

/// Scratch space, reused from call to call and from body to body.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// Per element: F, dF/dt, and the stress of Fbar.
    pub(super) gradients: Vec<Matrix3>,
    pub(super) rates: Vec<Matrix3>,
    pub(super) stresses: Vec<Matrix3>,
    /// Per node of every element, the force on it.
    #[cfg(feature = "parallel")]
    pub(super) slots: Vec<Vector3>,
    /// Per element: J, and what is averaged.
    pub(super) ratios: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Positions and forces of the nodes, in the layout of the batch.
    pub(super) nodes: Vec<Node>,
}

/// Positions and velocities of a body, and its history.
#[derive(Clone, Copy)]
pub(super) struct State<'a> {
    pub x: &'a [Vector3],
    pub v: &'a [Vector3],
    pub old: &'a [f64],
}

/// Number of elements whose energies are summed first, before these sums are added; a multiple of eight.
pub(super) const RANGE: usize = 256;

impl DeformableModel {
    /// Internal forces -dW/dx, N, viscous ones included, into `forces` (overwritten), at positions `x`
    /// (m) and velocities `v` (m/s); velocities matter to viscous materials alone. The history goes
    /// from `old` to `new`.
    ///
    /// # Errors
    ///
    /// [`ElementFailure`] with the first element that is inverted or has no stress, or with an array of a
    /// length other than the model's; `forces` and `new` are then invalid.
    pub fn internal_forces(
        &self,
        x: &[Vector3],
        v: &[Vector3],
        old: &[f64],
        new: &mut [f64],
        forces: &mut [Vector3],
        work: &mut Workspace,
    ) -> Result<InternalState, ElementFailure> {
        let state = self.forces_without_energy(x, v, old, new, forces, work)?;
        Ok(self.with_energy(state, x))
    }

    /// As [`DeformableModel::internal_forces`], with the same bits of the forces, for steps in which the
    /// energy is not needed: it is NaN where it would cost extra, which is with linear neo-Hookean
    /// tetrahedra.
    ///
    /// # Errors
    ///
    /// As [`DeformableModel::internal_forces`].
    pub fn forces_without_energy(
        &self,
        x: &[Vector3],
        v: &[Vector3],
        old: &[f64],
        new: &mut [f64],
        forces: &mut [Vector3],
        work: &mut Workspace,
    ) -> Result<InternalState, ElementFailure> {
        let state = State { x, v, old };
        self.check_arrays(state, new, forces)?;
        if let Some(batch) = &self.batch {
            Self::place_nodes(x, &mut work.nodes);
            if !batch.add_forces(&mut work.nodes) {
                return Err(self.first_inverted(state, 0..self.volumes.len()));
            }
            for (force, node) in forces.iter_mut().zip(&work.nodes) {
                *force = node.force();
            }
            return Ok(InternalState {
                energy: f64::NAN,
                ..InternalState::default()
            });
        }
        forces.fill(Vector3::zeros());
        match self.element {
            Element::T4 => self.scatter(&T4, false, state, new, forces),
            Element::T10 => self.scatter(&T10, false, state, new, forces),
            Element::T10Fbar => self.scatter(&T10, true, state, new, forces),
            Element::T4NodalPressure => match &self.averages {
                Some(averages) => self.averaged(averages, state, new, forces, work),
                None => Ok(InternalState::default()),
            },
        }
    }

    /// What [`forces_without_energy`](Self::forces_without_energy) has returned at positions `x`, with the energy: NaN
    /// if an element is inverted there, or if `x` is not as long as the nodes.
    pub fn with_energy(&self, state: InternalState, x: &[Vector3]) -> InternalState {
        let Some(batch) = self.batch.as_ref().filter(|_| x.len() == self.nodes.len()) else {
            return state;
        };
        let count = self.volumes.len();
        let ranges = (0..count).step_by(RANGE);
        let each = ranges.map(|start| batch.energy(start..count.min(start + RANGE), x));
        InternalState {
            energy: each.sum(),
            ..state
        }
    }

    /// Sets the nodes to their positions, with zero forces.
    pub(super) fn place_nodes(x: &[Vector3], nodes: &mut Vec<Node>) {
        nodes.clear();
        nodes.extend(x.iter().map(Node::at));
    }

    /// Identifies an element of a batch that cannot be evaluated.
    pub(super) fn first_inverted(&self, state: State, mut range: Range<usize>) -> ElementFailure {
        let first = range.start;
        let (elements, _) = self.connectivity.as_chunks::<4>();
        let failure = range.find_map(|e| {
            let [point] = self.points(&T4, e, &elements[e], state);
            self.respond(e, &point, &[], &mut []).err()
        });
        failure.unwrap_or(ElementFailure::Inverted {
            element: first,
            volume_ratio: 0.0,
        })
    }

    pub(super) fn check_arrays(
        &self,
        state: State,
        new: &[f64],
        forces: &[Vector3],
    ) -> Result<(), ElementFailure> {
        self.check_lengths(state.x, state.old)?;
        check_length("v", state.v.len(), self.nodes.len())?;
        check_length("forces", forces.len(), self.nodes.len())?;
        check_length("new", new.len(), self.history_len())
    }

    pub(crate) fn check_lengths(&self, x: &[Vector3], old: &[f64]) -> Result<(), ElementFailure> {
        check_length("x", x.len(), self.nodes.len())?;
        check_length("old", old.len(), self.history_len())
    }

    /// Adds the forces of all elements to their nodes, in the order of the elements.
    fn scatter<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
        new: &mut [f64],
        forces: &mut [Vector3],
    ) -> Result<InternalState, ElementFailure> {
        let mut total = InternalState::default();
        for (range, new) in self.ranges(new) {
            total += self.range(table, bar, range, state, new, |_, nodes, of_element| {
                for (&node, force) in nodes.iter().zip(of_element) {
                    forces[node as usize] += force;
                }
            })?;
        }
        Ok(total)
    }

    /// All elements in ranges that are summed together, each with its part of the new history.
    pub(super) fn ranges<'a>(
        &self,
        mut new: &'a mut [f64],
    ) -> impl Iterator<Item = (Range<usize>, &'a mut [f64])> {
        let (count, per_element) = (self.volumes.len(), self.history_per_element());
        (0..count).step_by(RANGE).map(move |start| {
            let range = start..count.min(start + RANGE);
            let (part, rest) = std::mem::take(&mut new).split_at_mut(range.len() * per_element);
            new = rest;
            (range, part)
        })
    }

    fn history_per_element(&self) -> usize {
        self.element.point_count() * self.history_stride
    }

    /// The forces of a range of elements, whose new history is `new`, passed to `sink` with the element's
    /// index and nodes.
    pub(super) fn range<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        range: Range<usize>,
        state: State,
        new: &mut [f64],
        mut sink: impl FnMut(usize, &[u32], &[Vector3]),
    ) -> Result<InternalState, ElementFailure> {
        let mut total = InternalState::default();
        let (elements, _) = self.connectivity.as_chunks::<N>();
        let first = range.start * Q * self.history_stride;
        for e in range {
            let points = self.points(table, e, &elements[e], state);
            let bars = if bar {
                Some(self.bars(e, &points)?)
            } else {
                None
            };
            let mut stresses = [Matrix3::zeros(); Q];
            let weight = self.volumes[e] / Q as f64;
            for q in 0..Q {
                let felt = bars
                    .as_ref()
                    .map_or(points[q], |bars| bars.felt(q, &points));
                let history = self.history_at(e, q);
                let next = &mut new[history.start - first..history.end - first];
                let response = self.respond(e, &felt, &state.old[history], next)?;
                total.add(&response, weight);
                stresses[q] = response.piola;
            }
            if let Some(bars) = &bars {
                stresses = bars.stresses(&stresses);
            }
            let mut forces = [Vector3::zeros(); N];
            for (q, stress) in stresses.iter().enumerate() {
                table.add_stress(q, stress, -weight, &self.inverses[e], &mut forces);
            }
            sink(e, &elements[e], &forces);
        }
        Ok(total)
    }

    /// Deformation at the points of an element; rates only if the material is viscous.
    pub(super) fn points<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        e: usize,
        nodes: &[u32; N],
        state: State,
    ) -> [Deformation; Q] {
        let inverse = &self.inverses[e];
        let gradients = table.gradients(&nodes.map(|i| state.x[i as usize]), inverse);
        let mut points = gradients.map(Deformation::at_rest);
        if !state.v.is_empty() && self.material(e).viscosity() > 0.0 {
            let rates = table.gradients(&nodes.map(|i| state.v[i as usize]), inverse);
            for (point, rate) in points.iter_mut().zip(rates) {
                point.rate = rate;
            }
        }
        points
    }

    /// The response of a point of element `e`, or its failure.
    pub(super) fn respond(
        &self,
        e: usize,
        felt: &Deformation,
        old: &[f64],
        new: &mut [f64],
    ) -> Result<Response, ElementFailure> {
        let material = self.material(e);
        let response = material.respond(felt, old, new);
        response.ok_or_else(|| self.failure(e, &felt.gradient))
    }

    /// Why element `e` has no stress at F.
    pub(super) fn failure(&self, element: usize, gradient: &Matrix3) -> ElementFailure {
        let volume_ratio = gradient.determinant();
        if volume_ratio > 0.0 && volume_ratio.is_finite() {
            ElementFailure::NoStress {
                element,
                volume_ratio,
                material: self.material(element).name().to_owned(),
            }
        } else {
            ElementFailure::Inverted {
                element,
                volume_ratio,
            }
        }
    }

    /// The points of an element with their mean volume ratio.
    pub(super) fn bars<const Q: usize>(
        &self,
        e: usize,
        points: &[Deformation; Q],
    ) -> Result<Bars<Q>, ElementFailure> {
        let mut ratios = [0.0; Q];
        for (ratio, point) in ratios.iter_mut().zip(points) {
            *ratio = volume_ratio(e, point)?;
        }
        let mean = ratios.iter().sum::<f64>() / Q as f64;
        let mut bars = [None; Q];
        for (q, point) in points.iter().enumerate() {
            bars[q] = Bar::new(point.gradient, ratios[q], mean);
            if bars[q].is_none() {
                return Err(ElementFailure::Inverted {
                    element: e,
                    volume_ratio: ratios[q],
                });
            }
        }
        let found = bars.map(|bar| bar.unwrap_or(UNDEFORMED));
        Ok(Bars {
            points: found,
            mean,
        })
    }

    /// Averaged nodal pressure: volume ratios to the nodes and back, stresses, pressures to the nodes
    /// and back, forces.
    fn averaged(
        &self,
        averages: &NodalAverages,
        state: State,
        new: &mut [f64],
        forces: &mut [Vector3],
        work: &mut Workspace,
    ) -> Result<InternalState, ElementFailure> {
        let bars = self.nodal_bars(averages, state, work)?;
        let mut total = InternalState::default();
        work.stresses.clear();
        work.values.clear();
        for (e, (bar, mean_rate)) in bars.iter().enumerate() {
            let felt = Deformation {
                gradient: bar.gradient(),
                rate: match work.rates.get(e) {
                    Some(rate) => bar.gradient_change(rate, *mean_rate),
                    None => Matrix3::zeros(),
                },
            };
            let history = self.history_at(e, 0);
            let response =
                self.respond(e, &felt, &state.old[history.clone()], &mut new[history])?;
            total.add(&response, self.volumes[e]);
            work.values
                .push(bar.trace(&response.piola) / (3.0 * bar.mean));
            work.stresses.push(response.piola);
        }
        let pressures = averages.smoothed(&self.volumes, &work.values);
        let (elements, _) = self.connectivity.as_chunks::<4>();
        for (e, (bar, _)) in bars.iter().enumerate() {
            let stress = bar.stress(&work.stresses[e], pressures[e]);
            let mut of_element = [Vector3::zeros(); 4];
            T4.add_stress(
                0,
                &stress,
                -self.volumes[e],
                &self.inverses[e],
                &mut of_element,
            );
            for (&node, force) in elements[e].iter().zip(&of_element) {
                forces[node as usize] += force;
            }
        }
        Ok(total)
    }

    /// The point of each element with the averaged volume ratio, and the rate of that. Rates of F are left in
    /// `work.rates`, which is empty if no material is viscous.
    pub(super) fn nodal_bars(
        &self,
        averages: &NodalAverages,
        state: State,
        work: &mut Workspace,
    ) -> Result<Vec<(Bar, f64)>, ElementFailure> {
        let (elements, _) = self.connectivity.as_chunks::<4>();
        work.gradients.clear();
        work.rates.clear();
        work.ratios.clear();
        for (e, nodes) in elements.iter().enumerate() {
            let [point] = self.points(&T4, e, nodes, state);
            work.gradients.push(point.gradient);
            work.rates.push(point.rate);
            work.ratios.push(volume_ratio(e, &point)?);
        }
        if !self.regions.iter().any(|r| r.material.viscosity() > 0.0) {
            work.rates.clear();
        }
        let means = averages.smoothed(&self.volumes, &work.ratios);
        let mut bars = Vec::with_capacity(elements.len());
        for (e, &mean) in means.iter().enumerate() {
            let bar = Bar::new(work.gradients[e], work.ratios[e], mean);
            bars.push(bar.ok_or(ElementFailure::Inverted {
                element: e,
                volume_ratio: work.ratios[e],
            })?);
        }
        let rates = self.mean_changes(averages, &bars, &work.rates);
        Ok(bars.into_iter().zip(rates).collect())
    }

    /// dJbar of every element for changes of F; all zero if `changes` is empty.
    pub(super) fn mean_changes(
        &self,
        averages: &NodalAverages,
        bars: &[Bar],
        changes: &[Matrix3],
    ) -> Vec<f64> {
        if changes.is_empty() {
            return vec![0.0; bars.len()];
        }
        let of_ratios: Vec<f64> = bars
            .iter()
            .zip(changes)
            .map(|(bar, change)| bar.ratio_change(change))
            .collect();
        averages.smoothed(&self.volumes, &of_ratios)
    }
}

const UNDEFORMED: Bar = Bar::undeformed();

/// The points of one element with their common mean volume ratio.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bars<const Q: usize> {
    pub points: [Bar; Q],
    pub mean: f64,
}

impl<const Q: usize> Bars<Q> {
    /// Deformation that the law gets at point `q`.
    pub fn felt(&self, q: usize, points: &[Deformation; Q]) -> Deformation {
        let bar = &self.points[q];
        let mean_rate = self.mean_change(&points.each_ref().map(|p| p.rate));
        Deformation {
            gradient: bar.gradient(),
            rate: bar.gradient_change(&points[q].rate, mean_rate),
        }
    }

    /// dJbar for changes of F.
    pub fn mean_change(&self, changes: &[Matrix3; Q]) -> f64 {
        let each = self.points.iter().zip(changes);
        each.map(|(bar, change)| bar.ratio_change(change))
            .sum::<f64>()
            / Q as f64
    }

    /// The averaged pressure, from the stresses of Fbar.
    pub fn pressure(&self, stresses: &[Matrix3; Q]) -> f64 {
        let each = self.points.iter().zip(stresses);
        let trace = each.map(|(bar, stress)| bar.trace(stress)).sum::<f64>();
        trace / (3.0 * Q as f64 * self.mean)
    }

    /// Stresses work conjugate to F, from those of Fbar.
    pub fn stresses(&self, stresses: &[Matrix3; Q]) -> [Matrix3; Q] {
        let pressure = self.pressure(stresses);
        std::array::from_fn(|q| self.points[q].stress(&stresses[q], pressure))
    }
}

/// J, or the failure of element `e` if it is inverted there.
fn volume_ratio(element: usize, point: &Deformation) -> Result<f64, ElementFailure> {
    point.volume_ratio().ok_or(ElementFailure::Inverted {
        element,
        volume_ratio: point.gradient.determinant(),
    })
}

pub(super) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), ElementFailure> {
    if found == expected {
        return Ok(());
    }
    Err(ElementFailure::Length {
        what,
        found,
        expected,
    })
}
