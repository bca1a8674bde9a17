//! Bodies that are rigid as long as their stresses are far below their strength, and deformable near it.
//!
//! A rigid body is looked at every few steps. By the [basis] of its model, which says how much of the strength a unit force uses, the
//! change of its contact forces since the last static solve tells about what they use now; only where that is near the strength are its
//! stresses [found again](looks). If they are near it too, the body [becomes deformable](soften): in the place in which it is, and such that its
//! contacts have the forces that they had and its elements balance them. A deformable body that has not cracked, is [at rest](looks) within
//! itself and far from its strength [becomes rigid](harden) as it is. One that has cracked is breakable for good. Both changes keep mass, momentum and angular momentum; the
//! energy that comes or goes has its own entry in the ledger.

mod basis;
mod friction;
mod harden;
mod looks;
mod query;
mod screen;
mod soften;
mod spin;
mod trial;

use super::fracture::Breakable;
use super::{ContactStiffness, ModelId};
use crate::error::SolveError;
use crate::fracture::Fracture;
use crate::world::World;
use basis::Basis;
use femdem_contact::{BodyId, ContactLaws, Field, MaterialId, WallResponse};
use femdem_fem::DeformableModel;
use screen::Screen;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

pub use query::{Fidelity, FidelityChange};

/// What a rigid body becomes near its strength, and when.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adaptive {
    /// Its model: of the tetrahedra of its shape in the same coordinates, T4, of one elastic material, as heavy as the body.
    pub model: ModelId,
    /// How it breaks.
    pub fracture: Fracture,
}

/// All adaptive bodies of a world.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Adaptives {
    bodies: BTreeMap<BodyId, AdaptiveBody>,
    /// Changes that the host has not taken yet.
    changes: Vec<FidelityChange>,
    /// By model; made when they are needed first. A model has one strength.
    #[serde(skip)]
    bases: BTreeMap<ModelId, Basis>,
}

/// What is known of an adaptive body.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct AdaptiveBody {
    adaptive: Adaptive,
    /// By node, the factor of the strength there.
    factors: Vec<f64>,
    /// The model and the shape that it alone has, once it has been deformable and rigid again.
    own_model: Option<ModelId>,
    own_shape: Option<u32>,
    /// While it is rigid: its last static solve.
    screen: Screen,
    /// While it is deformable: looks in a row at which it was at rest within itself.
    quiet: u32,
}

impl World {
    /// Lets a rigid body [become deformable](Fidelity) near its strength and then break, and rigid again when its stresses are
    /// small and it has not cracked. Its shape has to be of a mesh with [`Field::Body`], its model of the same mesh with
    /// [`ContactStiffness::Law`](crate::ContactStiffness::Law), so that its contacts are the same in both states.
    ///
    /// It is deformable from 0.7 of its strength on, and no longer adaptive once it has cracked. What it is and when are functions of the
    /// state alone.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown rigid body or model, [`SolveError::CannotAdapt`] for one that cannot change and in a world in which
    /// none can, [`SolveError::CannotBreak`] and [`SolveError::TooCoarse`] as from [`World::add_deformable`].
    pub fn set_adaptive(&mut self, id: BodyId, adaptive: Adaptive) -> Result<(), SolveError> {
        self.restored()?;
        self.not_shared("making bodies adaptive")?;
        let i = self.known_body(id)?;
        let models = self.deformables.as_deref().map_or(&[][..], |d| &d.models);
        let Some(model) = models.get(adaptive.model as usize) else {
            return Err(SolveError::NoSuch {
                what: "model",
                index: adaptive.model as usize,
                count: models.len(),
            });
        };
        self.refuse_to_adapt(id, &model.model)?;
        if !matches!(model.stiffness, ContactStiffness::Law) {
            return Err(SolveError::CannotAdapt {
                needs: "a model whose contacts have the stiffness of the law",
                found: "one with its own",
            });
        }
        model.may_crack(&adaptive.fracture)?;
        self.refuse_other_strength(id, &adaptive)?;
        let factors = Breakable::factors(model.model.mesh(), &adaptive.fracture, id);
        let body = AdaptiveBody {
            adaptive,
            factors,
            own_model: None,
            own_shape: None,
            screen: Screen::default(),
            quiet: 0,
        };
        self.bodies[i].rest.quiet_steps = 0;
        let adaptives = self.adaptives.get_or_insert_default();
        let of_model = |own: &AdaptiveBody| own.adaptive.model == adaptive.model;
        if !adaptives.bodies.values().any(of_model) {
            // That of bodies that are no more may be of another strength.
            adaptives.bases.remove(&adaptive.model);
        }
        adaptives.bodies.insert(id, body);
        Ok(())
    }

    /// Refuses a body of another strength than those of its model: they share what a unit force uses.
    fn refuse_other_strength(&self, id: BodyId, new: &Adaptive) -> Result<(), SolveError> {
        let all = self.adaptives.iter().flat_map(|all| &all.bodies);
        let mut others = all
            .filter(|(other, _)| **other != id)
            .map(|(_, own)| own.adaptive);
        let differs = |own: Adaptive| {
            own.model == new.model && own.fracture.strength != new.fracture.strength
        };
        if others.any(differs) {
            return Err(SolveError::CannotAdapt {
                needs: "the strength of the other bodies of its model",
                found: "another one",
            });
        }
        Ok(())
    }

    /// Refuses what cannot change between rigid and deformable.
    fn refuse_to_adapt(&self, id: BodyId, model: &DeformableModel) -> Result<(), SolveError> {
        let body = &self.bodies[id as usize];
        let shape = &self.shapes[body.shape as usize];
        let own = shape.mesh.as_ref();
        let is_meshed =
            own.is_some_and(|(mesh, field)| *field == Field::Body && mesh == model.mesh());
        let mass: f64 = model.masses().iter().sum();
        for (is_so, needs, found) in [
            (
                !is_meshed,
                "a shape of the tetrahedra of its model, with the field of a body",
                "another shape",
            ),
            (
                (mass / body.mass - 1.0).abs() > SAME_MASS,
                "the mass of its model",
                "another mass",
            ),
            (
                model.regions().len() != 1 || model.history_len() > 0,
                "one elastic material",
                "several materials, or one that flows",
            ),
            (
                model.added_mass() > 0.0,
                "a model without mass scaling",
                "a scaled mass",
            ),
            (
                body.turns_by_load(),
                "loads without a torque",
                "a torque, or a load that turns with it",
            ),
            (
                body.driven.is_some(),
                "to move freely",
                "a prescribed motion",
            ),
            (
                self.batch
                    .bonds()
                    .any(|(_, bond)| !bond.has_ended() && bond.bodies().contains(&id)),
                "to be free of bonds",
                "a bond",
            ),
            (
                self.cell().is_some(),
                "space that does not repeat itself",
                "a periodic cell",
            ),
            (
                self.parameters.time_step.implicit.is_some(),
                "explicit steps",
                "implicit steps",
            ),
        ] {
            if is_so {
                return Err(SolveError::CannotAdapt { needs, found });
            }
        }
        let material = self.batch.material(id).unwrap_or_default();
        check_laws(self.batch.laws(), material)
    }

    /// Refuses laws that change when an adaptive body does.
    pub(in crate::world) fn check_adaptive_laws(
        &self,
        laws: &ContactLaws,
    ) -> Result<(), SolveError> {
        let adaptives = self.adaptives.as_deref();
        let ids = adaptives.into_iter().flat_map(|all| all.bodies.keys());
        let materials: BTreeSet<MaterialId> =
            ids.filter_map(|id| self.batch.material(*id)).collect();
        materials.iter().try_for_each(|m| check_laws(laws, *m))
    }
}

/// Refuses laws of a material that give other forces to a deformable body than to a rigid one.
pub(in crate::world) fn check_laws(
    laws: &ContactLaws,
    material: MaterialId,
) -> Result<(), SolveError> {
    let own = laws.between([material; 2]).penalty;
    for law in laws.of(material) {
        if law.penalty != own {
            let needs = "one penalty in all laws of its material, by which it has the same contacts when it is deformable";
            return Err(SolveError::CannotAdapt {
                needs,
                found: "a pair of materials with another penalty",
            });
        }
        if law.attracts() {
            let (needs, found) = ("contacts that only press", "contacts that attract");
            return Err(SolveError::CannotAdapt { needs, found });
        }
        if law.wall_response != WallResponse::Rigid {
            let needs = "walls that meet it as they meet rigid bodies";
            let found = "the wall response \"mirror\"";
            return Err(SolveError::CannotAdapt { needs, found });
        }
    }
    Ok(())
}

/// Largest relative difference of the masses of a body and of its model.
const SAME_MASS: f64 = 1e-6;
