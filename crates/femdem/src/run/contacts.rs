//! Contacts of a simulation: of rigid and deformable bodies and walls, in one list.

use femdem_contact::deform::DeformablePartner;
use femdem_contact::{Partner, mean_penetration};
use femdem_mesh::Vector3;

use super::{MemberId, Simulation};

/// A side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// A body, by its number among the members.
    Member(usize),
    /// A wall, by its number in the world.
    Wall(usize),
}

/// A contact, or a patch of one between rigid bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLine {
    /// Side A.
    pub a: Side,
    /// Side B, a body by its number among the members.
    pub b: usize,
    /// Centre of pressure \[m\].
    pub point: Vector3,
    /// Unit normal from A to B.
    pub normal: Vector3,
    /// Normal force on B along `normal` \[N\].
    pub normal_force: f64,
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
    /// On each wall.
    pub walls: Vec<Vector3>,
}

impl Simulation {
    /// All contacts: those of rigid bodies, then those of deformable ones.
    #[must_use]
    pub fn contacts(&self) -> Vec<ContactLine> {
        let place = |wanted: fn(MemberId) -> Option<u32>| -> Vec<usize> {
            let members = self.members.iter().enumerate();
            // Members are in the order in which their bodies were added to the world.
            members
                .filter(|(_, m)| wanted(m.id).is_some())
                .map(|(i, _)| i)
                .collect()
        };
        let rigid = place(|id| match id {
            MemberId::Rigid(id) => Some(id),
            MemberId::Deformable(_) => None,
        });
        let soft = place(|id| match id {
            MemberId::Deformable(id) => Some(id),
            MemberId::Rigid(_) => None,
        });
        let mut lines: Vec<ContactLine> = Vec::new();
        for contact in self.world.contacts() {
            let a = match contact.a {
                Partner::Body(body) => Side::Member(rigid[body as usize]),
                Partner::Wall(wall) => Side::Wall(wall as usize),
            };
            lines.push(ContactLine {
                a,
                b: rigid[contact.b as usize],
                point: contact.point,
                normal: contact.normal,
                normal_force: contact.normal_force,
                friction: contact.friction,
                area: contact.area,
                volume: contact.volume,
            });
        }
        for contact in self.world.deformable_contacts() {
            let a = match contact.a {
                DeformablePartner::Deformable(body) => Side::Member(soft[body as usize]),
                DeformablePartner::Rigid(body) => Side::Member(rigid[body as usize]),
                DeformablePartner::Wall(wall) => Side::Wall(wall as usize),
            };
            lines.push(ContactLine {
                a,
                b: soft[contact.b as usize],
                point: contact.point,
                normal: contact.normal,
                normal_force: contact.normal_force,
                friction: contact.friction,
                area: contact.area,
                volume: contact.volume,
            });
        }
        lines
    }

    /// Sums of the forces of these contacts by member and by wall.
    #[must_use]
    pub fn forces(&self, contacts: &[ContactLine]) -> ContactForces {
        let mut forces = ContactForces {
            members: vec![Vector3::zeros(); self.members.len()],
            walls: vec![Vector3::zeros(); self.world.walls().count()],
        };
        for contact in contacts {
            let force = contact.force();
            if let Some(on_b) = forces.members.get_mut(contact.b) {
                *on_b += force;
            }
            let on_a = match contact.a {
                Side::Member(member) => forces.members.get_mut(member),
                Side::Wall(wall) => forces.walls.get_mut(wall),
            };
            if let Some(on_a) = on_a {
                *on_a -= force;
            }
        }
        forces
    }
}
