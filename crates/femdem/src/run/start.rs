//! A run that starts from the state of another one.

use std::collections::BTreeMap;
use std::path::Path;

use femdem_contact::BodyId;
use femdem_fem::Boundary;
use femdem_mesh::tet::Split;
use femdem_solve::{Deformable, World, WorldParameters};

use super::changes::{Change, changes};
use super::saved::RUN_CHECKPOINT;
use super::support::first_points;
use super::words::KEYS;
use super::{Controls, Member, Run, Scenario, Simulation};
use crate::Error;
use crate::results::PACK_CHECKPOINT;

/// Most that the mass of a body may differ, relative, between two readings of the same shape.
const SAME: f64 = 1e-9;

/// Whether a folder is that of a pack, and not of a run.
pub(super) fn is_pack(folder: &Path) -> bool {
    folder.join(PACK_CHECKPOINT).is_file() && !folder.join(RUN_CHECKPOINT).is_file()
}

impl Scenario {
    /// The scene and the state in the checkpoint of another run under its settings, motions and boundary conditions.
    pub(super) fn start_from(&self, folder: &Path) -> Result<(Self, Simulation), Error> {
        if !folder.join(RUN_CHECKPOINT).is_file() {
            return Err(Error::Option {
                name: "from",
                value: format!("\"{}\"", folder.display()),
                allowed: "the folder of a run of a scene, with its run.ckpt, or of a pack, with its pack.ckpt",
            });
        }
        let (before, simulation) = Run::read(folder)?.0.into_parts();
        self.start_after(
            &before,
            simulation,
            &format!("the checkpoint in {}", folder.display()),
        )
    }

    /// The same from the state of a run of the scene `before`, for which errors have the word `state`.
    pub(super) fn start_after(
        &self,
        before: &Self,
        simulation: Simulation,
        state: &str,
    ) -> Result<(Self, Simulation), Error> {
        let of_pack = simulation.is_of_pack();
        self.check_origin(of_pack)?;
        let (scene, base) = if of_pack {
            let scene = self.filled(simulation.world.parameters(), true);
            let scene = scene.with_pairs_of(before);
            (scene, simulation.without_entries()?)
        } else {
            let scene = self.filled(&WorldParameters::default(), false);
            let world = World::new(scene.parameters());
            let world = world.map_err(|error| Error::from(error).by_keys(&KEYS))?;
            (scene, Simulation::empty(world))
        };
        let changes = changes(before, &scene)?;
        let refused = |key: String, advice| Error::Fixed {
            scene: "the scene",
            key,
            state: state.to_owned(),
            advice,
        };
        let can_start = |change: &&Change| !change.can_be_started(&scene);
        if let Some(fixed) = changes.iter().find(can_start) {
            return Err(refused(
                fixed.name.clone(),
                "a run that starts `from` another one has its materials, walls and bodies",
            ));
        }
        let placed = scene.build_on(base)?;
        if let Some(other) = simulation.first_other(&placed) {
            return Err(refused(
                format!("the shape of \"{other}\""),
                "its file is another one than that run had: give that one, or leave `from` out",
            ));
        }
        let simulation = placed.started_from(simulation, before, &scene)?;
        Ok((scene, simulation))
    }
}

impl Simulation {
    /// The state of another run under the settings, motions and boundary conditions of `scene`, whose own beginning `self` is.
    /// Time, steps and ledger are 0; what moves as prescribed counts from where it is.
    fn started_from(
        self,
        mut simulation: Self,
        before: &Scenario,
        scene: &Scenario,
    ) -> Result<Self, Error> {
        simulation.controls = Controls::default();
        // Before motions begin anew: what has come to rest stays so.
        simulation.set_free(before, scene)?;
        simulation.world.restart_clock();
        // Steps and penalties take into account what is to come.
        simulation.set_flow(scene)?;
        simulation.change(before, scene)?;
        simulation.set_loads(scene)?;
        for number in 0..simulation.members.len() {
            let Member { id, of, .. } = simulation.members[number];
            let first = of.map_or(number, |first| first as usize);
            let body = self.members.get(first).map(|member| member.id);
            let body = body.and_then(|id| self.world.deformable(id));
            let Some((body, present)) = body.zip(simulation.world.deformable(id)) else {
                continue;
            };
            let boundary = boundary_now(body.boundary(), &present);
            let placed = boundary.placed(present.positions())?;
            let boundary = placed.counted_from(0.0);
            if boundary != *present.boundary() {
                simulation.world.set_boundary(id, boundary)?;
            }
        }
        simulation.world.restart_ledger();
        Ok(Self {
            supports: self.supports,
            fidelity: self.fidelity,
            ..simulation
        })
    }

    /// Number of the tetrahedra of a body that deforms, or may.
    fn tets_of(&self, id: BodyId) -> usize {
        if let Some(body) = self.world.deformable(id) {
            return body.model().volumes().len();
        }
        let mesh = self.adaptive_mesh(id);
        mesh.map_or(0, |mesh| mesh.tets().len())
    }

    /// Name of the first body or wall that is not the same in another simulation of equal entries: files can change.
    fn first_other<'a>(&'a self, other: &'a Self) -> Option<&'a str> {
        // With its fragments. Cracks make more nodes, but no tetrahedra.
        let sizes = |of: &Self| {
            let mut sizes = vec![Some((0.0, 0)); of.members.len()];
            for (number, member) in of.members.iter().enumerate() {
                let tets = of.tets_of(member.id);
                let size = &mut sizes[member.of.map_or(number, |first| first as usize)];
                let both = size.zip(of.world.mass(member.id));
                *size = both.map(|((mass, n), own)| (mass + own, n + tets));
            }
            sizes
        };
        let [own, others] = [self, other].map(sizes);
        let same = |i: usize| match (own[i], others[i]) {
            // It has left.
            _ if other.members[i].id == Member::GONE => true,
            (Some((a, n)), Some((b, m))) => n == m && (a - b).abs() <= SAME * a.abs(),
            _ => false,
        };
        let mut both = 0..self.members.len().min(other.members.len());
        let member = both.find(|i| !same(*i)).map(|i| &self.members[i]);
        // A wall may have been taken away, but keeps its name.
        fn name(of: &Simulation, wall: u32) -> Option<&str> {
            let mut walls = of.walls.iter();
            let known = walls.find(|known| known.id == wall);
            known.map(|known| known.name.as_str())
        }
        let walls = self.origin.walls.iter().zip(&other.origin.walls);
        let mut walls = walls.flat_map(|(a, b)| a.iter().zip(b));
        let wall = walls.find(|&(&a, &b)| name(self, a) != name(other, b));
        let wall = wall.and_then(|(&a, _)| name(self, a));
        let member = member.map(|member| member.name.as_str());
        // A table of poses may have other rows than before.
        let placed = |of: &Self| of.origin.bodies + of.origin.members.iter().sum::<usize>();
        let (more, fewer) = match placed(self) < placed(other) {
            true => (&other.members[..placed(other)], placed(self)),
            false => (&self.members[..placed(self)], placed(other)),
        };
        let added = more.get(fewer).map(|member| member.name.as_str());
        member.or(added).or(wall)
    }
}

/// The conditions on a body, given for its nodes when it was whole, as those on it now, or on a fragment of it.
fn boundary_now(boundary: &Boundary, body: &Deformable) -> Boundary {
    let Some(firsts) = first_points(body) else {
        return boundary.clone();
    };
    let mut numbers = BTreeMap::new();
    let mut splits = Vec::new();
    for (point, new) in firsts.iter().zip(0..) {
        let node = *numbers.entry(*point).or_insert(new);
        if node != new {
            splits.push(Split { node, new });
        }
    }
    let mut now = boundary.part(|node| numbers.get(&node).copied());
    now.follow(&splits, body.model().mesh().tets(), &firsts);
    now
}
