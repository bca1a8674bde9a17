//! A run that starts from the state of another one.

use std::path::Path;

use femdem_mesh::tet::Split;
use femdem_solve::{World, WorldParameters};

use super::changes::{Change, changes};
use super::saved::RUN_CHECKPOINT;
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
        let of_pack = simulation.is_of_pack();
        self.check_origin(of_pack)?;
        let (scene, base) = if of_pack {
            let scene = self.filled(simulation.world.parameters(), true);
            let scene = scene.with_pairs_of(&before);
            (scene, simulation.without_entries()?)
        } else {
            let scene = self.filled(&WorldParameters::default(), false);
            let world = World::new(scene.parameters());
            let world = world.map_err(|error| Error::from(error).by_keys(&KEYS))?;
            (scene, Simulation::empty(world))
        };
        let changes = changes(&before, &scene)?;
        let refused = |key: String, advice| Error::Fixed {
            scene: "the scene",
            key,
            state: format!("the checkpoint in {}", folder.display()),
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
        let simulation = placed.started_from(simulation, &before, &scene)?;
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
        for (number, _, body) in self.deformables() {
            let id = simulation.members[number].id;
            let Some(present) = simulation.world.deformable(id) else {
                continue;
            };
            let mut boundary = body.boundary().clone();
            if let Some(mesh) = present.cracks().and_then(|cracks| cracks.mesh()) {
                let whole = body.model().nodes().len();
                let nodes = mesh.points().iter().zip(0..).skip(whole);
                let splits: Vec<Split> = nodes.map(|(&node, new)| Split { node, new }).collect();
                boundary.follow(&splits, mesh.tets(), mesh.points());
            }
            let placed = boundary.placed(present.positions())?;
            let boundary = placed.counted_from(0.0);
            if boundary != *present.boundary() {
                simulation.world.set_boundary(id, boundary)?;
            }
        }
        simulation.world.restart_ledger();
        Ok(Self {
            supports: self.supports,
            ..simulation
        })
    }

    /// Name of the first body or wall that is not the same in another simulation of equal entries: files can change.
    fn first_other<'a>(&'a self, other: &'a Self) -> Option<&'a str> {
        let size = |of: &Self, id| {
            let body = of.world.deformable(id);
            // Cracks make more nodes, but no tetrahedra.
            let tets = body.map_or(0, |body| body.model().volumes().len());
            of.world.mass(id).map(|mass| (mass, tets))
        };
        let same = |a, b| match (size(self, a), size(other, b)) {
            // It has left.
            _ if b == Member::GONE => true,
            (Some((a, n)), Some((b, m))) => n == m && (a - b).abs() <= SAME * a.abs(),
            _ => false,
        };
        let mut members = self.members.iter().zip(&other.members);
        let member = members.find(|(a, b)| !same(a.id, b.id));
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
        let member = member.map(|(member, _)| member.name.as_str());
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
