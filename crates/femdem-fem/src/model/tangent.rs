//! The stiffness of a body: the derivative of its nodal forces.

use super::forces::{Bars, State};
use super::nodal::NodalAverages;
use super::{DeformableModel, Workspace};
use crate::element::{Bar, BarChange, Element, ElementFailure, T4, T10, Table};
use crate::material::{Deformation, Material, Tangent};
use femdem_mesh::nalgebra::SVector;
use femdem_mesh::{Matrix3, Vector3};

/// A point of the linearised body.
#[derive(Debug, Clone, Copy)]
struct LinearPoint {
    /// dP/dF of the law at the deformation that it gets.
    law: Tangent,
    /// Its stress.
    piola: Matrix3,
}

impl LinearPoint {
    /// dP for a change of that deformation.
    fn stress_change(&self, change: &Matrix3) -> Matrix3 {
        // Rows of a tangent are those of the transposed column order of a matrix.
        let flat = SVector::<f64, 9>::from_column_slice(change.transpose().as_slice());
        Matrix3::from_row_slice((self.law * flat).as_slice())
    }
}

/// A linearised element: its points, and the averaged volume change if it has one.
struct LinearElement<const Q: usize> {
    points: [LinearPoint; Q],
    bars: Option<Bars<Q>>,
}

impl<const Q: usize> LinearElement<Q> {
    /// Changes of the stresses at the points for changes of F.
    fn stress_changes(&self, changes: &[Matrix3; Q]) -> [Matrix3; Q] {
        let Some(bars) = &self.bars else {
            return std::array::from_fn(|q| self.points[q].stress_change(&changes[q]));
        };
        let mean_change = bars.mean_change(changes);
        let felt: [Matrix3; Q] =
            std::array::from_fn(|q| bars.points[q].gradient_change(&changes[q], mean_change));
        let piolas: [Matrix3; Q] = std::array::from_fn(|q| self.points[q].stress_change(&felt[q]));
        let traces: [f64; Q] = std::array::from_fn(|q| {
            bars.points[q].trace_change(&self.points[q].piola, &piolas[q], &felt[q])
        });
        let pressure = bars.pressure(&self.points.map(|p| p.piola));
        let pressure_change =
            (traces.iter().sum::<f64>() / (3.0 * Q as f64) - pressure * mean_change) / bars.mean;
        std::array::from_fn(|q| {
            let change = BarChange {
                gradient: changes[q],
                mean: mean_change,
                piola: piolas[q],
                trace: traces[q],
                pressure: pressure_change,
            };
            bars.points[q].stress_change(&self.points[q].piola, pressure, &change)
        })
    }
}

impl DeformableModel {
    /// K dx into `out` (overwritten), N, for displacements `dx` (m) of the nodes from `x`: the
    /// derivative of minus the internal forces, exact for all elements.
    ///
    /// # Errors
    ///
    /// [`ElementFailure`] as from [`DeformableModel::internal_forces`].
    pub fn tangent_apply(
        &self,
        x: &[Vector3],
        old: &[f64],
        dx: &[Vector3],
        out: &mut [Vector3],
    ) -> Result<(), ElementFailure> {
        self.check_lengths(x, old)?;
        for (what, found) in [("dx", dx.len()), ("out", out.len())] {
            if found != self.nodes.len() {
                let expected = self.nodes.len();
                return Err(ElementFailure::Length {
                    what,
                    found,
                    expected,
                });
            }
        }
        out.fill(Vector3::zeros());
        let state = State { x, v: &[], old };
        match self.element {
            Element::T4 => self.apply_elements(&T4, false, state, dx, out),
            Element::T10 => self.apply_elements(&T10, false, state, dx, out),
            Element::T10Fbar => self.apply_elements(&T10, true, state, dx, out),
            Element::T4NodalPressure => self.apply_averaged(state, dx, out),
        }
    }

    /// Calls `f` with nodes and a matrix, as many times as needed for the sum of the matrices to be the
    /// stiffness K = -df/dx at `x`, N/m. A matrix is square, by rows; row 3 a + i is component i of the a-th
    /// of the nodes. There is one matrix per element; averaged nodal pressures add one per element over all
    /// nodes of its neighbours.
    ///
    /// # Errors
    ///
    /// [`ElementFailure`] as from [`DeformableModel::internal_forces`].
    pub fn for_element_tangents(
        &self,
        x: &[Vector3],
        old: &[f64],
        mut f: impl FnMut(&[u32], &[f64]),
    ) -> Result<(), ElementFailure> {
        self.check_lengths(x, old)?;
        let state = State { x, v: &[], old };
        match self.element {
            Element::T4 => self.element_matrices(&T4, false, state, &mut f),
            Element::T10 => self.element_matrices(&T10, false, state, &mut f),
            Element::T10Fbar => self.element_matrices(&T10, true, state, &mut f),
            Element::T4NodalPressure => self.averaged_matrices(state, &mut f),
        }
    }

    fn linear_point(
        &self,
        e: usize,
        felt: &Deformation,
        old: &[f64],
        next: &mut [f64],
    ) -> Result<LinearPoint, ElementFailure> {
        let law = self.material(e).tangent(felt, old);
        Ok(LinearPoint {
            law: law.ok_or_else(|| self.failure(e, &felt.gradient))?,
            piola: self.respond(e, felt, old, next)?.piola,
        })
    }

    fn linear_element<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
        (e, nodes): (usize, &[u32; N]),
    ) -> Result<LinearElement<Q>, ElementFailure> {
        let points = self.points(table, e, nodes, state);
        let bars = if bar {
            Some(self.bars(e, &points)?)
        } else {
            None
        };
        let mut next = vec![0.0; self.history_stride];
        let mut linear = [LinearPoint {
            law: Tangent::zeros(),
            piola: Matrix3::zeros(),
        }; Q];
        for (q, point) in linear.iter_mut().enumerate() {
            let felt = bars
                .as_ref()
                .map_or(points[q], |bars| bars.felt(q, &points));
            let history = self.history_at(e, q);
            let next = &mut next[..history.len()];
            *point = self.linear_point(e, &felt, &state.old[history], next)?;
        }
        Ok(LinearElement {
            points: linear,
            bars,
        })
    }

    fn apply_elements<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
        dx: &[Vector3],
        out: &mut [Vector3],
    ) -> Result<(), ElementFailure> {
        let (elements, _) = self.connectivity.as_chunks::<N>();
        for (e, nodes) in elements.iter().enumerate() {
            let linear = self.linear_element(table, bar, state, (e, nodes))?;
            let of_nodes = nodes.map(|i| dx[i as usize]);
            let forces = self.force_changes(table, e, &linear, &of_nodes);
            for (&node, force) in nodes.iter().zip(&forces) {
                out[node as usize] += force;
            }
        }
        Ok(())
    }

    /// Minus the changes of an element's nodal forces for displacements of its nodes.
    fn force_changes<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        e: usize,
        linear: &LinearElement<Q>,
        dx: &[Vector3; N],
    ) -> [Vector3; N] {
        let inverse = &self.inverses[e];
        let stresses = linear.stress_changes(&table.gradients(dx, inverse));
        let mut forces = [Vector3::zeros(); N];
        for (q, stress) in stresses.iter().enumerate() {
            table.add_stress(q, stress, self.volumes[e] / Q as f64, inverse, &mut forces);
        }
        forces
    }

    fn element_matrices<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
        f: &mut impl FnMut(&[u32], &[f64]),
    ) -> Result<(), ElementFailure> {
        let (elements, _) = self.connectivity.as_chunks::<N>();
        let size = 3 * N;
        let mut matrix = vec![0.0; size * size];
        for (e, nodes) in elements.iter().enumerate() {
            let linear = self.linear_element(table, bar, state, (e, nodes))?;
            for column in 0..size {
                let mut dx = [Vector3::zeros(); N];
                dx[column / 3][column % 3] = 1.0;
                let forces = self.force_changes(table, e, &linear, &dx);
                for (row, force) in forces.iter().flat_map(|f| f.iter()).enumerate() {
                    matrix[row * size + column] = *force;
                }
            }
            f(nodes, &matrix);
        }
        Ok(())
    }

    /// The linearised elements of averaged nodal pressure.
    fn linear_averaged(
        &self,
        averages: &NodalAverages,
        state: State,
    ) -> Result<LinearAveraged, ElementFailure> {
        let bars: Vec<Bar> = self
            .nodal_bars(averages, state, &mut Workspace::default())?
            .into_iter()
            .map(|(bar, _)| bar)
            .collect();
        let mut next = vec![0.0; self.history_stride];
        let mut points = Vec::with_capacity(bars.len());
        let mut pressures = Vec::with_capacity(bars.len());
        for (e, bar) in bars.iter().enumerate() {
            let felt = Deformation::at_rest(bar.gradient());
            let history = self.history_at(e, 0);
            let next = &mut next[..history.len()];
            let point = self.linear_point(e, &felt, &state.old[history], next)?;
            pressures.push(bar.trace(&point.piola) / (3.0 * bar.mean));
            points.push(point);
        }
        Ok(LinearAveraged {
            smoothed: averages.smoothed(&self.volumes, &pressures),
            bars,
            points,
            pressures,
        })
    }

    fn apply_averaged(
        &self,
        state: State,
        dx: &[Vector3],
        out: &mut [Vector3],
    ) -> Result<(), ElementFailure> {
        let Some(averages) = &self.averages else {
            return Ok(());
        };
        let linear = self.linear_averaged(averages, state)?;
        let (elements, _) = self.connectivity.as_chunks::<4>();
        let changes: Vec<Matrix3> = elements
            .iter()
            .zip(&self.inverses)
            .map(|(nodes, inverse)| {
                let [change] = T4.gradients(&nodes.map(|i| dx[i as usize]), inverse);
                change
            })
            .collect();
        let means = self.mean_changes(averages, &linear.bars, &changes);
        let mut bar_changes = Vec::with_capacity(elements.len());
        for (e, (bar, point)) in linear.bars.iter().zip(&linear.points).enumerate() {
            bar_changes.push(local_change(bar, point, &changes[e], means[e]));
        }
        let of_pressures: Vec<f64> = bar_changes
            .iter()
            .enumerate()
            .map(|(e, change)| linear.pressure_change(e, change))
            .collect();
        let smoothed = averages.smoothed(&self.volumes, &of_pressures);
        for (e, nodes) in elements.iter().enumerate() {
            bar_changes[e].pressure = smoothed[e];
            let stress = linear.bars[e].stress_change(
                &linear.points[e].piola,
                linear.smoothed[e],
                &bar_changes[e],
            );
            let mut forces = [Vector3::zeros(); 4];
            T4.add_stress(0, &stress, self.volumes[e], &self.inverses[e], &mut forces);
            for (&node, force) in nodes.iter().zip(&forces) {
                out[node as usize] += force;
            }
        }
        Ok(())
    }

    /// The energy of element e depends on its own F and on its mean volume ratio theta. Passes its own
    /// matrix to `f`, including the curvature of all volume ratios with the smoothed pressures, and a matrix over
    /// the patch of d theta with the cross terms.
    fn averaged_matrices(
        &self,
        state: State,
        f: &mut impl FnMut(&[u32], &[f64]),
    ) -> Result<(), ElementFailure> {
        let Some(averages) = &self.averages else {
            return Ok(());
        };
        let linear = self.linear_averaged(averages, state)?;
        let (elements, _) = self.connectivity.as_chunks::<4>();
        let mut around = vec![Vec::new(); averages.volumes.len()];
        for (e, of) in averages.of.iter().enumerate() {
            of.iter().for_each(|&n| around[n as usize].push(e));
        }
        // dJ of every element by its nodes.
        let ratio_gradients: Vec<[Vector3; 4]> = (0..elements.len())
            .map(|e| {
                let mut gradient = [Vector3::zeros(); 4];
                let cofactor = linear.bars[e].cofactor();
                T4.add_stress(0, &cofactor, 1.0, &self.inverses[e], &mut gradient);
                gradient
            })
            .collect();
        for (e, nodes) in elements.iter().enumerate() {
            let (bar, point) = (&linear.bars[e], &linear.points[e]);
            // Own part: at constant theta and pressure.
            let mut own = [0.0; 144];
            let held = |change: &Matrix3| local_change(bar, point, change, 0.0);
            for column in 0..12 {
                let mut dx = [Vector3::zeros(); 4];
                dx[column / 3][column % 3] = 1.0;
                let [change] = T4.gradients(&dx, &self.inverses[e]);
                let stress = bar.stress_change(&point.piola, linear.smoothed[e], &held(&change));
                let mut forces = [Vector3::zeros(); 4];
                T4.add_stress(0, &stress, self.volumes[e], &self.inverses[e], &mut forces);
                for (row, force) in forces.iter().flat_map(|f| f.iter()).enumerate() {
                    own[row * 12 + column] = *force;
                }
            }
            f(nodes, &own);

            // Part of the pressure of this element: dtheta (x) dtheta and the cross terms.
            let change = local_change(bar, point, &Matrix3::zeros(), 1.0);
            let by_mean = bar.stress_change(&point.piola, linear.smoothed[e], &change);
            let mut cross = [Vector3::zeros(); 4];
            T4.add_stress(0, &by_mean, self.volumes[e], &self.inverses[e], &mut cross);
            let second = self.volumes[e] * linear.pressure_change(e, &change);
            let mut patch = Patch::default();
            for &n in &averages.of[e] {
                let share = 0.25 / averages.volumes[n as usize];
                for &other in &around[n as usize] {
                    let weight = share * self.volumes[other];
                    patch.add(&elements[other], &ratio_gradients[other], weight);
                }
            }
            let (nodes, matrix) = patch.matrix(nodes, &cross, second);
            f(&nodes, &matrix);
        }
        Ok(())
    }
}

/// The linearised body of averaged nodal pressure.
struct LinearAveraged {
    bars: Vec<Bar>,
    points: Vec<LinearPoint>,
    /// c/(3 Jbar) of the elements, before and after averaging.
    pressures: Vec<f64>,
    smoothed: Vec<f64>,
}

impl LinearAveraged {
    /// Change of c/(3 Jbar) of an element.
    fn pressure_change(&self, e: usize, change: &BarChange) -> f64 {
        (change.trace / 3.0 - self.pressures[e] * change.mean) / self.bars[e].mean
    }
}

/// Change of a point with its own F and its mean volume ratio, at constant averaged pressure.
fn local_change(bar: &Bar, point: &LinearPoint, gradient: &Matrix3, mean: f64) -> BarChange {
    let felt = bar.gradient_change(gradient, mean);
    let piola = point.stress_change(&felt);
    BarChange {
        gradient: *gradient,
        mean,
        piola,
        trace: bar.trace_change(&point.piola, &piola, &felt),
        pressure: 0.0,
    }
}

/// d theta of an element by the nodes of all its neighbours.
#[derive(Default)]
struct Patch {
    gradient: std::collections::BTreeMap<u32, Vector3>,
}

impl Patch {
    fn add(&mut self, nodes: &[u32; 4], gradient: &[Vector3; 4], weight: f64) {
        for (&node, g) in nodes.iter().zip(gradient) {
            *self.gradient.entry(node).or_insert_with(Vector3::zeros) += g * weight;
        }
    }

    /// second d theta (x) d theta + cross (x) d theta + d theta (x) cross.
    fn matrix(&self, own: &[u32; 4], cross: &[Vector3; 4], second: f64) -> (Vec<u32>, Vec<f64>) {
        let nodes: Vec<u32> = self.gradient.keys().copied().collect();
        let theta: Vec<f64> = self
            .gradient
            .values()
            .flat_map(|&g| <[f64; 3]>::from(g))
            .collect();
        let crossed: Vec<f64> = nodes
            .iter()
            .flat_map(|node| {
                let place = own.iter().position(|n| n == node);
                <[f64; 3]>::from(place.map_or_else(Vector3::zeros, |a| cross[a]))
            })
            .collect();
        let mut matrix = Vec::with_capacity(theta.len() * theta.len());
        for (t, c) in theta.iter().zip(&crossed) {
            let columns = theta.iter().zip(&crossed);
            matrix.extend(columns.map(|(u, d)| second * t * u + c * u + t * d));
        }
        (nodes, matrix)
    }
}
