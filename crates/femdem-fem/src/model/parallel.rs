//! Internal forces of one large body on the caller's thread pool.

use super::forces::{RANGE, State};
use super::{DeformableModel, InternalState, Workspace};
use crate::element::{Element, ElementFailure, T4, T10, Table};
use femdem_mesh::Vector3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// The slots of each node among those of all elements, ascending; computed on first use.
#[derive(Debug, Clone, Default)]
pub(super) struct Incidence(OnceLock<(Vec<u32>, Vec<u32>)>);

/// Determined by the rest of the model, so always equal.
impl PartialEq for Incidence {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Incidence {
    /// Where each node's slots start, and the slots.
    fn of(&self, nodes: usize, connectivity: &[u32]) -> &(Vec<u32>, Vec<u32>) {
        self.0.get_or_init(|| {
            let mut starts = vec![0; nodes + 1];
            for &node in connectivity {
                starts[node as usize + 1] += 1;
            }
            for node in 0..nodes {
                starts[node + 1] += starts[node];
            }
            let (mut next, mut slots) = (starts.clone(), vec![0; connectivity.len()]);
            for (slot, &node) in connectivity.iter().enumerate() {
                let place = &mut next[node as usize];
                slots[*place as usize] = slot as u32;
                *place += 1;
            }
            (starts, slots)
        })
    }
}

/// Nodes that are summed by one task.
const NODES: usize = 1024;

impl DeformableModel {
    /// As [`DeformableModel::internal_forces`], with the same bits, on the threads of the caller's rayon
    /// pool: for single bodies of many thousand elements. Worlds of many bodies run whole bodies in
    /// parallel instead. Averaged nodal pressures are evaluated on one thread.
    ///
    /// # Errors
    ///
    /// As [`DeformableModel::internal_forces`].
    pub fn internal_forces_parallel(
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
        match self.element {
            Element::T4 => self.gather(&T4, false, state, new, forces, work),
            Element::T10 => self.gather(&T10, false, state, new, forces, work),
            Element::T10Fbar => self.gather(&T10, true, state, new, forces, work),
            Element::T4NodalPressure => self.internal_forces(x, v, old, new, forces, work),
        }
    }

    /// Writes the forces of the elements into slots, then sums them per node in the order of the elements, as
    /// a single thread does.
    fn gather<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
        new: &mut [f64],
        forces: &mut [Vector3],
        work: &mut Workspace,
    ) -> Result<InternalState, ElementFailure> {
        work.slots.resize(self.connectivity.len(), Vector3::zeros());
        let slots = work.slots.chunks_mut(RANGE * N);
        let tasks: Vec<_> = self.ranges(new).zip(slots).collect();
        if self.batch.is_some() {
            Self::place_nodes(state.x, &mut work.nodes);
        }
        let nodes = &work.nodes;
        let states: Vec<Result<InternalState, ElementFailure>> = tasks
            .into_par_iter()
            .map(|((range, new), slots)| {
                if let Some(batch) = &self.batch {
                    if !batch.forces_of(range.clone(), nodes, slots) {
                        return Err(self.first_inverted(state, range));
                    }
                    return Ok(InternalState {
                        energy: batch.energy(range, state.x),
                        ..InternalState::default()
                    });
                }
                let first = range.start;
                self.range(table, bar, range, state, new, |e, _, of_element| {
                    slots[(e - first) * N..][..N].copy_from_slice(of_element);
                })
            })
            .collect();
        let mut total = InternalState::default();
        for state in states {
            total += state?;
        }
        let (starts, order) = self.incidence.of(self.nodes.len(), &self.connectivity);
        let slots = &work.slots;
        forces
            .par_chunks_mut(NODES)
            .enumerate()
            .for_each(|(k, forces)| {
                let starts = &starts[k * NODES..][..=forces.len()];
                for (force, place) in forces.iter_mut().zip(starts.windows(2)) {
                    let own = &order[place[0] as usize..place[1] as usize];
                    *force = own
                        .iter()
                        .fold(Vector3::zeros(), |sum, &slot| sum + slots[slot as usize]);
                }
            });
        Ok(total)
    }
}
