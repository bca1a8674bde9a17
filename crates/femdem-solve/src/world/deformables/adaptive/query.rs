//! What a host learns of adaptive bodies.

use crate::error::SolveError;
use crate::world::World;
use femdem_contact::BodyId;
use femdem_contact::deform::Modulus;
use serde::{Deserialize, Serialize};

/// How a body responds to forces now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fidelity {
    /// It moves as a whole.
    Rigid,
    /// It strains, and may crack.
    Deformable,
}

/// An adaptive body that has become deformable, or rigid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FidelityChange {
    /// The body.
    pub body: BodyId,
    /// What it is from then on.
    pub to: Fidelity,
    /// When, s.
    pub time: f64,
    /// Its largest stress over its strength then: above 1 it became deformable too late.
    pub ratio: f64,
    /// Energy that it was given, J; negative if it was taken.
    pub energy: f64,
}

impl World {
    /// The changes of adaptive bodies since the last call, in their order. They are kept until they are taken.
    #[must_use]
    pub fn take_fidelity_changes(&mut self) -> Vec<FidelityChange> {
        let adaptives = self.adaptives.as_deref_mut();
        adaptives.map_or_else(Vec::new, |all| std::mem::take(&mut all.changes))
    }

    /// The adaptive bodies, ascending, with what they are now. One that has cracked is none any more, nor are its fragments.
    pub fn adaptive_bodies(&self) -> impl Iterator<Item = (BodyId, Fidelity)> {
        let all = self.adaptives.iter().flat_map(|all| all.bodies.keys());
        all.map(|&id| {
            let fidelity = match self.batch.is_deformable(id) {
                true => Fidelity::Deformable,
                false => Fidelity::Rigid,
            };
            (id, fidelity)
        })
    }

    /// The penalty of the law by which the contacts of an adaptive body have a foundation of the modulus `ratio` E/h, Pa: see
    /// [`ContactStiffness::Ratio`](crate::ContactStiffness::Ratio).
    #[must_use]
    pub fn penalty_of_ratio(&self, id: BodyId, ratio: f64) -> Option<f64> {
        let model = self.adaptives.as_deref()?.bodies.get(&id)?.adaptive.model;
        let young = self
            .deformables
            .as_deref()?
            .models
            .get(model as usize)?
            .young;
        let shape = self.batch.deformable_shapes().get(model as usize)?;
        Some(Modulus::of_material(young, ratio, shape).penalty(shape.inradius()))
    }

    /// Whether a body is adaptive.
    #[must_use]
    pub fn is_adaptive(&self, id: BodyId) -> bool {
        let adaptives = self.adaptives.as_deref();
        adaptives.is_some_and(|all| all.bodies.contains_key(&id))
    }

    /// Refuses what adaptive bodies cannot have.
    pub(in crate::world) fn refuse_adaptive(
        &self,
        id: Option<BodyId>,
        needs: &'static str,
        found: &'static str,
    ) -> Result<(), SolveError> {
        let is_there = match id {
            Some(id) => self.is_adaptive(id),
            None => self
                .adaptives
                .as_deref()
                .is_some_and(|all| !all.bodies.is_empty()),
        };
        match is_there {
            true => Err(SolveError::CannotAdapt { needs, found }),
            false => Ok(()),
        }
    }

    /// Forgets a body that is removed, or has cracked.
    pub(in crate::world) fn forget_adaptive(&mut self, id: BodyId) {
        if let Some(adaptives) = self.adaptives.as_deref_mut() {
            adaptives.bodies.remove(&id);
        }
    }
}
