//! Friction of a body that goes on as another kind of body.

use crate::error::SolveError;
use crate::world::World;
use femdem_contact::{BodyId, ContactBatch, Partner, SpringLoad};
use std::collections::BTreeMap;

/// What the springs of the pairs of a body carry, by A and B.
pub(super) struct Friction(BTreeMap<(Partner, BodyId), SpringLoad>);

impl Friction {
    /// Starts the contact of `partner` and body `id`, which are `new` and `body` in a batch where the latter is deformable, with the
    /// friction that they have.
    pub fn begin(
        &self,
        batch: &mut ContactBatch,
        (partner, id): (Partner, BodyId),
        (new, body): (Partner, BodyId),
    ) -> Result<(), SolveError> {
        let own = self.0.get(&(partner, id)).copied();
        let own = own.or_else(|| match partner {
            Partner::Body(other) => {
                let load = self.0.get(&(Partner::Body(id), other))?;
                Some(load.seen_from(true))
            }
            Partner::Wall(_) => None,
        });
        match own {
            Some(load) => Ok(batch.begin_springs(new, body, load)?),
            None => Ok(()),
        }
    }
}

impl World {
    /// What the springs of a body's contacts carry now.
    pub(super) fn friction_of(&self, id: BodyId) -> Friction {
        Friction(self.batch.springs_of(id))
    }

    /// Evaluates the contacts of a body that has become another kind, with the friction that they had.
    pub(super) fn meet_with(&mut self, friction: &Friction) -> Result<(), SolveError> {
        let mut rigid = Vec::new();
        for (&(a, b), &load) in &friction.0 {
            match a {
                _ if self.batch.is_deformable(b) => self.batch.begin_springs(a, b, load)?,
                Partner::Body(i) if self.batch.is_deformable(i) => {
                    let load = load.seen_from(true);
                    self.batch.begin_springs(Partner::Body(b), i, load)?;
                }
                Partner::Body(i) if i > b => {
                    rigid.push((Partner::Body(b), i, load.seen_from(true)))
                }
                _ => rigid.push((a, b, load)),
            }
        }
        self.touch(0.0)?;
        if rigid.is_empty() {
            return Ok(());
        }
        for (a, b, load) in rigid {
            let motions = [&self.motions[..], &self.wall_motions];
            self.batch.set_springs((a, b), &load, motions)?;
        }
        self.touch(0.0)
    }
}
