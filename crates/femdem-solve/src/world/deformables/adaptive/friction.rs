//! Friction of a body that goes on as another kind of body.

use crate::error::SolveError;
use crate::world::World;
use femdem_contact::{BodyId, ContactBatch, Partner};
use femdem_mesh::Vector3;
use std::collections::BTreeMap;

/// What the friction springs of a pair carry.
#[derive(Debug, Clone, Copy, Default)]
struct Carried {
    /// On B, N.
    force: Vector3,
    /// On B about the normal, N m.
    torsion: f64,
}

/// The friction of the pairs of a body, by A and B.
pub(super) struct Friction(BTreeMap<(Partner, BodyId), Carried>);

impl Friction {
    /// Starts the contact of `partner` and body `id`, which are `new` and `body` in a batch where the latter is deformable, with the
    /// friction that they have.
    pub fn begin(
        &self,
        batch: &mut ContactBatch,
        (partner, id): (Partner, BodyId),
        (new, body): (Partner, BodyId),
    ) -> Result<(), SolveError> {
        let seen_from_it = self.0.get(&(partner, id)).map(|own| (own.force, own.torsion));
        let own = seen_from_it.or_else(|| match partner {
            // The moment about the normal is the same seen from either.
            Partner::Body(other) => {
                let own = self.0.get(&(Partner::Body(id), other))?;
                Some((-own.force, own.torsion))
            }
            Partner::Wall(_) => None,
        });
        if let Some((force, torsion)) = own {
            batch.begin_friction(new, body, force, torsion)?;
        }
        Ok(())
    }
}

impl World {
    /// What the friction springs of a body carry now.
    pub(super) fn friction_of(&self, id: BodyId) -> Friction {
        let mut pairs: BTreeMap<(Partner, BodyId), Carried> = BTreeMap::new();
        if self.batch.is_rigid(id) {
            for contact in self.batch.rigid_contacts_of(id) {
                let pair = pairs.entry((contact.a, contact.b)).or_default();
                pair.force += contact.friction - contact.drag;
                pair.torsion += contact.torsion - contact.drag_torsion;
            }
        }
        let thing = Partner::Body(id);
        let own = |a: Partner, b: BodyId| (a == thing) != (b == id);
        let soft = self.batch.deformable_contacts();
        for contact in soft.filter(|contact| own(contact.a, contact.b)) {
            let pair = pairs.entry((contact.a, contact.b)).or_default();
            pair.force += contact.friction;
        }
        Friction(pairs)
    }

    /// Evaluates the contacts of a body that has become another kind, with the friction that they had.
    pub(super) fn meet_with(&mut self, friction: &Friction) -> Result<(), SolveError> {
        let mut rigid = Vec::new();
        for (&(a, b), &Carried { force, torsion }) in &friction.0 {
            match a {
                _ if self.batch.is_deformable(b) => {
                    self.batch.begin_friction(a, b, force, torsion)?;
                }
                // The moment about the normal is the same seen from either.
                Partner::Body(i) if self.batch.is_deformable(i) => {
                    self.batch
                        .begin_friction(Partner::Body(b), i, -force, torsion)?;
                }
                Partner::Body(i) if i > b => {
                    rigid.push((Partner::Body(b), i, -force, torsion));
                }
                _ => rigid.push((a, b, force, torsion)),
            }
        }
        self.touch(0.0)?;
        if rigid.is_empty() {
            return Ok(());
        }
        for (a, b, force, torsion) in rigid {
            let motions = [&self.motions[..], &self.wall_motions];
            self.batch.set_friction((a, b), force, torsion, motions)?;
        }
        self.touch(0.0)
    }
}
