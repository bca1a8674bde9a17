//! A run that starts from a pack: its bodies and its container, with the settings of the scene laid over.

use std::collections::BTreeSet;
use std::path::Path;

use femdem_contact::{MaterialId, WallResponse};
use femdem_mesh::Vector3;
use femdem_solve::{World, WorldParameters};

use super::{
    BodyLoads, ContactEntry, Controls, FidelityRecord, Flow, MaterialEntry, Member, NamedWall,
    Origin, Penalty, Scenario, Simulation, WallEntry,
};
use crate::Error;
use crate::error::wrong;
use crate::results::SavedPack;
use crate::scene::PairEntry;

/// Why a penalty has its value.
pub(super) const OF_PACK: &str = "that of the pack";

impl Scenario {
    /// The same scene with gravity and the contact law written out. What it does not give is that of `usual`; the penalty only
    /// if that is the one of a pack.
    pub(super) fn filled(&self, usual: &WorldParameters, of_pack: bool) -> Self {
        let law = &usual.contact;
        let own = &self.contact;
        let chooses = own.penalty.is_some() || own.penetration.is_some();
        let contact = ContactEntry {
            penalty: own.penalty.or((of_pack && !chooses).then_some(law.penalty)),
            penetration: own.penetration,
            friction: own.friction.or(Some(law.friction)),
            wall_friction: own.wall_friction.or(law.wall_friction),
            rolling_friction: own.rolling_friction.or(Some(law.rolling_friction)),
            damping: own.damping.or(Some(law.damping_ratio)),
            tangential_ratio: own.tangential_ratio.or(Some(law.tangential_ratio)),
            tangential_damping: own.tangential_damping.or(Some(law.tangential_damping)),
            wall_response: own.wall_response.or(Some(match self.has_adaptive() {
                true => WallResponse::Rigid,
                false => law.wall_response,
            })),
            cohesion: own.cohesion.or(Some(law.cohesion)),
            adhesion_energy: own.adhesion_energy.or(Some(law.adhesion_energy)),
            liquid_bridge: own.liquid_bridge.or(law.liquid_bridge.map(Into::into)),
        };
        Self {
            gravity: self.gravity.or(Some(usual.gravity.into())),
            contact,
            ..self.clone()
        }
    }

    /// The same scene with those materials of bodies of a pack, and those laws of pairs, that it does not give.
    pub(super) fn with_pairs<'a>(
        mut self,
        materials: impl IntoIterator<Item = &'a String>,
        pairs: impl IntoIterator<Item = PairEntry>,
    ) -> Self {
        for name in materials {
            self.material.entry(name.clone()).or_default();
        }
        for pair in pairs {
            let known = self.pair.iter().any(|own| own.is_of(&pair.materials));
            let there = |name: &String| self.material.contains_key(name);
            if !known && pair.materials.iter().all(there) {
                self.pair.push(pair);
            }
        }
        self
    }

    /// The same scene, where a run with this one started from a pack, with what that has of the pack.
    pub(super) fn with_pairs_of(self, before: &Self) -> Self {
        let empty = |(_, entry): &(&String, &MaterialEntry)| **entry == MaterialEntry::default();
        let of_pack = before.material.iter().filter(empty);
        self.with_pairs(of_pack.map(|(name, _)| name), before.pair.iter().cloned())
    }

    /// Gives the materials of a pack, and their laws, the numbers that their names have in this scene.
    fn set_pack_materials(&self, names: &[String], world: &mut World) -> Result<(), Error> {
        let mut found = vec![MaterialId::default()];
        for name in names {
            found.push(self.material_id(name)?);
        }
        Ok(world.renumber_materials(&found)?)
    }

    /// The walls of the pack that `remove` opens, by number in its world.
    fn opened(&self, world: &World) -> Result<Vec<u32>, Error> {
        let known = || {
            let names: Vec<&str> = world.walls().map(|(_, wall)| wall.name()).collect();
            format!("the walls of the pack: {}", names.join(", "))
        };
        let mut found = BTreeSet::new();
        for name in &self.remove {
            let mut walls = world.walls();
            let wall = walls.find(|(_, wall)| wall.name() == name);
            let (wall, _) = wall.ok_or_else(|| Error::Unknown {
                name: "remove",
                value: name.clone(),
                known: known(),
            })?;
            if !found.insert(wall) {
                return Err(wrong("remove", &format!("\"{name}\" twice"), "each once"));
            }
        }
        Ok(found.into_iter().collect())
    }

    /// Refuses keys that need a pack to start from.
    pub(super) fn check_origin(&self, is_of_pack: bool) -> Result<(), Error> {
        if self.remove.is_empty() || is_of_pack {
            return Ok(());
        }
        Err(wrong(
            "remove",
            &format!("{:?}", self.remove),
            "walls of a pack: give `from` with the folder of `femdem pack` too, or take it out",
        ))
    }
}

impl Simulation {
    /// The pack in the folder of `femdem pack`, at time 0 under the settings of `scene`; returned with the scene, which has
    /// gravity, the contact law and the laws of pairs of the pack where it gives none.
    pub(super) fn of_pack(folder: &Path, scene: &Scenario) -> Result<(Scenario, Self), Error> {
        let packing = SavedPack::read(folder)?.packing;
        if !packing.is_done() {
            let at = packing.progress();
            return Err(Error::Option {
                name: "from",
                value: format!("\"{}\"", folder.display()),
                allowed: match at.placed == at.count {
                    true => "the pack has not settled yet: go on with it first, by `femdem resume`",
                    false => {
                        "not all bodies of the pack are placed: go on with it first, by `femdem resume`"
                    }
                },
            });
        }
        let spec = packing.spec();
        let names = spec.materials.clone();
        let named = |pair| {
            let allowed = "a pack whose [[pair]] laws are all of named materials";
            PairEntry::of(pair, &names)
                .ok_or_else(|| wrong("from", &format!("\"{}\"", folder.display()), allowed))
        };
        let pairs = spec.pairs.iter().map(named);
        let pairs: Vec<PairEntry> = pairs.collect::<Result<_, _>>()?;
        let mut world = packing.into_world();
        let before = *world.parameters();
        let filled = scene.filled(&before, true).with_pairs(&names, pairs);
        let wanted = filled.parameters();
        world.step_explicitly()?;
        filled.set_pack_materials(&names, &mut world)?;
        if before.gravity != wanted.gravity {
            world.set_gravity(wanted.gravity)?;
        }
        if before.contact != wanted.contact {
            world.set_contact(wanted.contact)?;
        }
        world.set_time_step(wanted.time_step)?;
        if before.medium != wanted.medium {
            world.set_medium(wanted.medium)?;
        }
        if before.sleeping != wanted.sleeping {
            world.set_sleep_rule(wanted.sleeping)?;
        }
        for wall in scene.opened(&world)? {
            world.remove_wall(wall)?;
        }
        world.restart_clock();
        let ids: Vec<_> = world.body_ids().collect();
        let members = ids.iter().enumerate().filter_map(|(number, &id)| {
            Some(Member {
                name: format!("pack {number}"),
                id,
                placed: world.pose(id)?,
                of: None,
            })
        });
        let members: Vec<Member> = members.collect();
        let simulation = Self {
            origin: Origin {
                bodies: members.len(),
                container: world.walls().map(|(wall, _)| wall).collect(),
                ..Origin::default()
            },
            members,
            ..Self::empty(world)
        };
        Ok((filled, simulation))
    }

    /// What a simulation has from its pack, without what its scene has added.
    pub(super) fn without_entries(&self) -> Result<Self, Error> {
        let mut world = self.world.clone();
        let added = self.members[self.origin.bodies..].iter();
        for member in added.filter(|member| member.id != Member::GONE) {
            world.remove_body(member.id)?;
        }
        let container = &self.origin.container;
        let walls = self.origin.walls.iter().flatten();
        for &wall in walls.filter(|wall| !container.contains(wall)) {
            if world.wall(wall).is_some() {
                world.remove_wall(wall)?;
            }
        }
        Ok(Self {
            members: self.members[..self.origin.bodies].to_vec(),
            origin: Origin {
                bodies: self.origin.bodies,
                container: self.origin.container.clone(),
                ..Origin::default()
            },
            ..Self::empty(world)
        })
    }

    /// A world without entries of a scene.
    pub(crate) fn empty(world: World) -> Self {
        let walls = world.walls().map(|(id, wall)| NamedWall {
            name: wall.name().to_owned(),
            id,
        });
        Self {
            members: Vec::new(),
            walls: walls.collect(),
            supports: Vec::new(),
            controls: Controls::default(),
            centre: Vector3::zeros(),
            flow: Flow::default(),
            loads: BodyLoads::default(),
            penalty: Penalty::default(),
            origin: Origin::default(),
            fidelity: FidelityRecord::default(),
            notes: Vec::new(),
            world,
        }
    }

    /// Whether it started from a pack.
    #[must_use]
    pub fn is_of_pack(&self) -> bool {
        self.origin.bodies > 0
    }

    /// The wall of the pack that an entry without a form of its own names.
    pub(super) fn named_wall(&self, entry: &WallEntry) -> Result<Option<u32>, Error> {
        if entry.kinds() > 0 || !self.is_of_pack() {
            return Ok(None);
        }
        let mut walls = self.world.walls();
        if let Some((wall, _)) = walls.find(|(_, wall)| wall.name() == entry.name) {
            return Ok(Some(wall));
        }
        let names: Vec<&str> = self.world.walls().map(|(_, wall)| wall.name()).collect();
        Err(Error::Unknown {
            name: "name",
            value: entry.name.clone(),
            known: format!(
                "the walls of the pack, {}, or give the wall a form of its own, such as plane or box",
                names.join(", ")
            ),
        })
    }
}
