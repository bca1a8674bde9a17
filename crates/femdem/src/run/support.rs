//! Supports: nodes of deformable bodies that are held or moved, and their reactions.

use std::collections::{BTreeMap, BTreeSet};

use femdem_fem::{Boundary, DeformableModel};
use femdem_mesh::Vector3;
use femdem_solve::Deformable;

use super::{BodyEntry, Member, Simulation, Support};
use crate::Error;
use crate::error::wrong;

impl BodyEntry {
    /// The supports of a body that gets the number `member`: the nodes that each `fix` and `motion` holds. If
    /// several conditions act on a direction of a node, the last one counts, as in [`Boundary`].
    pub(super) fn supports(
        &self,
        member: usize,
        model: &DeformableModel,
        body_radius: f64,
    ) -> Result<Vec<Support>, Error> {
        let mut owners = BTreeMap::new();
        let mut supports = Vec::new();
        let (mut names, sets) = (BTreeSet::new(), Boundary::default());
        for (number, condition) in (1..).zip(&self.boundary) {
            if !condition.holds() {
                continue;
            }
            let name = match condition.name.as_str() {
                "" => format!("boundary {number}"),
                given => given.to_owned(),
            };
            if !names.insert(name.clone()) {
                return Err(Error::Option {
                    name: "boundary.name",
                    value: format!("\"{name}\""),
                    allowed: "another condition of the body has it: give each its own",
                });
            }
            let selection = condition.select.selection(body_radius);
            for node in model.select(&selection, sets.sets())? {
                for direction in (0..3_u8).filter(|&k| condition.directions[usize::from(k)]) {
                    owners.insert((node, direction), supports.len());
                }
            }
            supports.push(Support {
                member,
                name,
                holds: Vec::new(),
            });
        }
        for (hold, owner) in owners {
            supports[owner].holds.push(hold);
        }
        match supports.iter().find(|support| support.holds.is_empty()) {
            Some(idle) => Err(wrong(
                "boundary",
                &format!("\"{}\"", idle.name),
                "later conditions hold all its nodes in all its directions: take it out, or put it last",
            )),
            None => Ok(supports),
        }
    }
}

impl Simulation {
    /// Name of a support in results: that of the body and that of the condition.
    #[must_use]
    pub fn support_name(&self, support: &Support) -> String {
        let member = self.members.get(support.member);
        let body = member.map_or("", |member| member.name.as_str());
        format!("{body} {}", support.name)
    }

    /// Force of each support on its body now \[N\], over ranks on the bodies of this one: it balances the forces of elements,
    /// contacts, loads and gravity on the nodes in the held directions. The inertia of these nodes is not included. Before the
    /// first step no force is known, and all are zero.
    #[must_use]
    pub fn reactions(&self) -> Vec<Vector3> {
        self.supports
            .iter()
            .map(|support| self.reaction(support).unwrap_or_default())
            .collect()
    }

    fn reaction(&self, support: &Support) -> Option<Vector3> {
        let world = &self.world;
        if world.steps() == 0 {
            return None;
        }
        let number = support.member as u32;
        let of = |(k, member): &(u32, &Member)| *k == number || member.of == Some(number);
        let own = (0_u32..).zip(&self.members).filter(of);
        let own = own.filter(|(_, member)| !world.is_guest(member.id));
        let bodies = own.filter_map(|(_, member)| world.deformable(member.id));
        let sum = |sum: Vector3, body| sum + self.reaction_of(support, &body);
        // Adding zero avoids -0.
        Some(bodies.fold(Vector3::zeros(), sum) + Vector3::zeros())
    }

    /// The part of it on one body.
    fn reaction_of(&self, support: &Support, body: &Deformable) -> Vector3 {
        let world = &self.world;
        let (masses, gravity) = (body.model().masses(), world.parameters().gravity);
        let mut sum = Vector3::zeros();
        for (node, direction) in holds_now(support, body) {
            let (node, k) = (node as usize, usize::from(direction));
            // A support made by a caller may name nodes and directions that do not exist.
            let (Some(sum), Some(mass)) = (sum.get_mut(k), masses.get(node)) else {
                continue;
            };
            let on_node = |forces: &[Vector3]| forces.get(node).map_or(0.0, |f| f[k]);
            let inside = on_node(body.internal_forces()) + on_node(body.loads());
            *sum -= inside + on_node(body.contact_forces()) + mass * gravity[k];
        }
        sum
    }
}

/// The nodes and directions that a support holds in a body, or in a fragment of it.
fn holds_now(support: &Support, body: &Deformable) -> Vec<(u32, u8)> {
    let Some(firsts) = first_points(body) else {
        return support.holds.clone();
    };
    let held: BTreeSet<(u32, u8)> = support.holds.iter().copied().collect();
    let nodes = firsts.into_iter().zip(0_u32..);
    let each = nodes.flat_map(|(point, node)| (0..3).map(move |k| (point, node, k)));
    each.filter(|(point, _, k)| held.contains(&(*point, *k)))
        .map(|(_, node, k)| (node, k))
        .collect()
}

/// By node of a body that may break, or of a fragment of one, the node of the body when it was whole.
pub(super) fn first_points(body: &Deformable) -> Option<Vec<u32>> {
    let cracks = body.cracks()?;
    let points = cracks.points();
    Some(match cracks.mesh() {
        None => points.to_vec(),
        Some(mesh) => mesh.points().iter().map(|p| points[*p as usize]).collect(),
    })
}
