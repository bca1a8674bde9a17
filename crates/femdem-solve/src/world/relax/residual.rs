//! Residual forces, and the reference force that they are divided by.

use super::WorldRelaxed;
use crate::world::{Deformable, World};
use femdem_mesh::Vector3;

/// Forces on the nodes of a deformable body.
struct Nodal {
    /// Net forces, N; zero where nodes are prescribed.
    net: Vec<Vector3>,
    /// Sum of the norms of gravity and loads, or of the reactions if that is larger, N.
    given: f64,
}

impl World {
    /// Largest net force of a node or of a whole deformable body over the mean contact force or, where nothing touches, over the
    /// reference of [`WorldRelaxation::tolerance`](super::WorldRelaxation::tolerance); `None` without deformable bodies.
    pub fn deformable_residual(&self) -> Option<f64> {
        let mut report = WorldRelaxed::default();
        let rigid = self.measure(&mut report);
        (self.deformable_count() > 0).then_some(rigid.max(report.residual))
    }

    /// Computes the residuals; returns that of the deformable bodies as wholes.
    pub(super) fn measure(&self, report: &mut WorldRelaxed) -> f64 {
        let nodal: Vec<(u32, Nodal)> = self
            .deformable_ids()
            .filter_map(|id| Some((id, self.nodal_forces(self.deformable(id)?))))
            .collect();
        report.mean_contact_force = self
            .mean_contact_force()
            .or_else(|| self.least_given(&nodal))
            .unwrap_or(1.0);
        let (mut rigid, mut whole, mut node) = (0.0_f64, 0.0_f64, 0.0_f64);
        // What bears nothing and is borne by nothing falls, however little it weighs beside the forces of others.
        let falling = |net: f64, given: f64, touches: bool| {
            let share = if touches || given <= 0.0 {
                0.0
            } else {
                net / given
            };
            net.max(share * report.mean_contact_force)
        };
        let g = self.parameters.gravity.norm();
        for (i, body) in self.free_bodies() {
            let load = self.batch.load_of(i as u32);
            let moment = self.net_torque(i, &load).norm() / (2.0 * body.radius);
            let net = self.net_force(i, &load).norm();
            let net = falling(net, body.mass * g, load.contacts > 0);
            rigid = rigid.max(net).max(moment);
        }
        for (id, Nodal { net, given }) in &nodal {
            node = net.iter().map(Vector3::norm).fold(node, f64::max);
            if !self.is_held(*id as usize) {
                let touches = self.batch.touches(*id);
                let net = net.iter().sum::<Vector3>().norm();
                whole = whole.max(falling(net, *given, touches));
            }
        }
        report.body_residual = rigid.max(whole) / report.mean_contact_force;
        report.residual = report.body_residual.max(node / report.mean_contact_force);
        whole / report.mean_contact_force
    }

    /// Mean normal force of the contacts, N, if there is any.
    fn mean_contact_force(&self) -> Option<f64> {
        let each = self.contacts().into_iter().map(|c| c.normal_force);
        let (sum, count) = each.fold((0.0, 0.0), |(sum, count), force| (sum + force, count + 1.0));
        (sum > 0.0).then_some(sum / count)
    }

    /// The smallest positive force given by gravity, loads and reactions over all bodies, N, if there is any.
    fn least_given(&self, nodal: &[(u32, Nodal)]) -> Option<f64> {
        let g = self.parameters.gravity.norm();
        let rigid = self.free_bodies().map(|(_, body)| body.mass * g);
        let all = rigid.chain(nodal.iter().map(|(_, forces)| forces.given));
        all.filter(|force| *force > 0.0).reduce(f64::min)
    }

    fn nodal_forces(&self, d: Deformable) -> Nodal {
        let gravity = self.parameters.gravity + d.pull();
        let (mut net, mut given) = (Vec::new(), 0.0);
        for (a, mass) in d.model().masses().iter().enumerate() {
            let load = d.loads()[a] + gravity * *mass;
            given += load.norm();
            net.push(d.internal_forces()[a] + d.contact_forces()[a] + load);
        }
        let mut reactions = vec![Vector3::zeros(); net.len()];
        for (node, i) in d.boundary().held() {
            let node = node as usize;
            reactions[node][i] = std::mem::take(&mut net[node][i]);
        }
        let supported = reactions.iter().map(Vector3::norm).sum();
        Nodal {
            net,
            given: f64::max(given, supported),
        }
    }
}
