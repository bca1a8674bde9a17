//! Contacts of a simulation: of rigid and deformable bodies and walls, in one list.

use femdem_contact::{Contact, ExactSum, Partner, mean_penetration};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

use super::{NamedWall, Simulation};

/// A side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Side {
    /// A body, by its number among the members.
    Member(usize),
    /// A wall, by its number in the world.
    Wall(usize),
}

/// A contact, or a patch of one between rigid bodies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactLine {
    /// Side A.
    pub a: Side,
    /// Side B, a body by its number among the members.
    pub b: usize,
    /// Centre of pressure \[m\].
    pub point: Vector3,
    /// Unit normal from A to B.
    pub normal: Vector3,
    /// Normal force on B along `normal`, negative where it pulls \[N\].
    pub normal_force: f64,
    /// What all parts of it press, each along its own normal \[N\].
    pub pressing: f64,
    /// Friction force on B \[N\].
    pub friction: Vector3,
    /// Contact area \[m²\].
    pub area: f64,
    /// Overlap volume \[m³\].
    pub volume: f64,
}

impl ContactLine {
    /// Force on B \[N\].
    #[must_use]
    pub fn force(&self) -> Vector3 {
        self.normal * self.normal_force + self.friction
    }

    /// Mean depth of the overlap \[m\]; 0 without an area.
    #[must_use]
    pub fn penetration(&self) -> f64 {
        mean_penetration(self.volume, self.area)
    }
}

/// Forces of the contacts \[N\].
#[derive(Clone, Debug, PartialEq)]
pub struct ContactForces {
    /// On each member.
    pub members: Vec<Vector3>,
    /// On each wall, in the order of [`Simulation::walls`].
    pub walls: Vec<Vector3>,
    /// What all parts of the contacts press on each wall, each along its own normal.
    pub pressing: Vec<f64>,
}

impl Simulation {
    /// All contacts, sorted by pair.
    #[must_use]
    pub fn contacts(&self) -> Vec<ContactLine> {
        let mut members = BTreeMap::new();
        for (i, member) in self.members.iter().enumerate() {
            members.insert(member.id, i);
        }
        let side = |partner| match partner {
            Partner::Body(body) => Side::Member(members[&body]),
            Partner::Wall(wall) => Side::Wall(wall as usize),
        };
        let contacts = self.world.contacts().into_iter();
        let line = |c: Contact| {
            let (normal_force, friction) = c.parts();
            ContactLine {
                a: side(c.a),
                b: members[&c.b],
                point: self.wrapped(&c.point),
                normal: c.normal,
                normal_force,
                pressing: c.pressing,
                friction,
                area: c.area,
                volume: c.volume,
            }
        };
        contacts.map(line).collect()
    }

    /// Those that belong to no other rank: each contact belongs to one.
    pub(super) fn own_contacts(&self) -> Vec<ContactLine> {
        let mut contacts = self.contacts();
        contacts.retain(|contact| !self.world.is_guest(self.members[contact.b].id));
        contacts
    }

    /// Sums of the forces of these contacts by member and by wall.
    #[must_use]
    pub fn forces(&self, contacts: &[ContactLine]) -> ContactForces {
        let mut members = vec![Vector3::zeros(); self.members.len()];
        for contact in contacts {
            let force = contact.force();
            if let Some(on_b) = members.get_mut(contact.b) {
                *on_b += force;
            }
            if let Side::Member(member) = contact.a
                && let Some(on_a) = members.get_mut(member)
            {
                *on_a -= force;
            }
        }
        let sums = self.wall_sums(contacts);
        let sums: Vec<f64> = sums.iter().map(ExactSum::value).collect();
        let (walls, pressing) = by_wall(&sums);
        ContactForces {
            members,
            walls,
            pressing,
        }
    }

    /// For each wall four sums over these contacts, the same in any order: the force on it, and what they press. See [`by_wall`].
    pub(super) fn wall_sums(&self, contacts: &[ContactLine]) -> Vec<ExactSum> {
        let mut sums = vec![ExactSum::default(); 4 * self.walls.len()];
        for contact in contacts {
            let Side::Wall(wall) = contact.a else {
                continue;
            };
            let known = |other: &NamedWall| other.id as usize;
            let Ok(place) = self.walls.binary_search_by_key(&wall, known) else {
                continue;
            };
            let force = contact.force();
            let terms = [-force.x, -force.y, -force.z, contact.pressing];
            for (sum, term) in sums[4 * place..].iter_mut().zip(terms) {
                sum.add(term);
            }
        }
        sums
    }
}

/// The forces on walls \[N\] and what presses on them, from the values of their sums.
pub(super) fn by_wall(sums: &[f64]) -> (Vec<Vector3>, Vec<f64>) {
    let (sums, _) = sums.as_chunks::<4>();
    let each = sums.iter();
    each.map(|[x, y, z, pressing]| (Vector3::new(*x, *y, *z), *pressing))
        .unzip()
}
