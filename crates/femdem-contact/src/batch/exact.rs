//! Sums over the contacts of a whole that several batches may share: exact, so that they do not depend on who has which body.
//! Each contact is in that of the batch that its B belongs to.

use super::ContactBatch;
use crate::contact::{Load, Partner, RigidContact};
use crate::exact::ExactSum;
use femdem_mesh::Vector3;

/// Stiffness of springs along and across a normal against a motion along `direction`, N/m.
fn against(direction: &Vector3, normal: &Vector3, [along, across]: [f64; 2]) -> f64 {
    let share = normal.dot(direction).powi(2);
    along * share + across * (1.0 - share)
}

impl ContactBatch {
    /// What walls meet that are pushed along unit directions: the force with which each presses along it, without dashpots, N, and
    /// the stiffness of its contacts, N/m: the sum of k_n (n·d)² + k_t (1 - (n·d)²) with their normals n.
    pub fn pushes(&self, walls: &[(u32, Vector3)]) -> Vec<[ExactSum; 2]> {
        let mut sums = vec![<[ExactSum; 2]>::default(); walls.len()];
        let mut add = |wall: u32, force: &Vector3, stiffness: &dyn Fn(&Vector3) -> f64| {
            for (sum, (_, direction)) in sums.iter_mut().zip(walls).filter(|(_, own)| own.0 == wall)
            {
                sum[0].add(-force.dot(direction));
                sum[1].add(stiffness(direction));
            }
        };
        for contact in self.booked_contacts() {
            let Partner::Wall(wall) = contact.a else {
                continue;
            };
            let mut load = Load::default();
            load.add(contact, 0);
            let springs = [contact.foundation.stiffness, contact.tangential_stiffness];
            let stiffness = |direction: &Vector3| against(direction, &contact.normal, springs);
            add(wall, &load.static_part().force, &stiffness);
        }
        let part = self.deformable.as_deref();
        for (wall, force, contacts) in part.into_iter().flat_map(|part| part.wall_pairs()) {
            let stiffness = |direction: &Vector3| {
                let each = contacts.iter().map(|contact| {
                    let springs = [contact.stiffness, contact.tangential_stiffness];
                    against(direction, &contact.normal, springs)
                });
                each.sum()
            };
            add(wall, &force, &stiffness);
        }
        sums
    }

    /// Elastic energy of the recorded contacts and bonds and that of their attraction, without that of friction springs, J.
    pub fn exact_energy(&self) -> ExactSum {
        let mut sum: ExactSum = self
            .booked_contacts()
            .map(RigidContact::potential)
            .collect();
        let part = self.deformable.as_deref();
        sum.extend(part.into_iter().flat_map(|part| part.energies()));
        sum.extend(self.booked_bonds().map(|bond| bond.state().energy));
        sum
    }

    /// What makes the stress of a periodic cell: Σ f lᵀ, J, as of [`virial`](Self::virial), by columns.
    pub fn exact_virial(&self) -> [ExactSum; 9] {
        let mut sums = <[ExactSum; 9]>::default();
        let part = self.deformable.as_deref();
        let rigid = self.between_bodies().map(RigidContact::moment_of_force);
        for term in rigid.chain(part.into_iter().flat_map(|part| part.virials())) {
            for (sum, term) in sums.iter_mut().zip(&term) {
                sum.add(*term);
            }
        }
        sums
    }

    /// Stiffness of all contacts of two bodies against strains along the axes, J: Σ (k_n n² + k_t (1 - n²)) l² with the components n
    /// of the normal and l of the vector between the centroids along the axis.
    pub fn exact_stiffness(&self) -> [ExactSum; 3] {
        let part = self.deformable.as_deref();
        [0, 1, 2].map(|axis| {
            let rigid = self
                .between_bodies()
                .map(|contact| contact.stiffness_along(axis));
            let soft = part
                .into_iter()
                .flat_map(|part| part.stiffnesses_along(axis));
            rigid.chain(soft).collect()
        })
    }

    /// The contacts whose B belongs to this batch.
    pub fn booked_contacts(&self) -> impl Iterator<Item = &RigidContact> {
        let contacts = self.rigid_contacts().into_iter();
        contacts.filter(|contact| !self.is_guest(contact.b))
    }

    /// Those of two bodies.
    pub(super) fn between_bodies(&self) -> impl Iterator<Item = &RigidContact> {
        let contacts = self.booked_contacts();
        contacts.filter(|contact| matches!(contact.a, Partner::Body(_)))
    }
}
