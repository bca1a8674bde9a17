//! A run that starts from the state of another one.

use std::path::Path;

use super::changes::changes;
use super::saved::RUN_CHECKPOINT;
use super::{Controls, Run, Scenario, Simulation};
use crate::Error;

/// Most that the mass of a body may differ, relative, between two readings of the same shape.
const SAME: f64 = 1e-9;

impl Simulation {
    /// The state in the checkpoint of another run under the settings, motions and boundary conditions of `scene`, whose own
    /// beginning `self` is. Time, steps and ledger are 0; what moves as prescribed counts from where it is.
    pub(super) fn started_from(self, folder: &Path, scene: &Scenario) -> Result<Self, Error> {
        if !folder.join(RUN_CHECKPOINT).is_file() {
            return Err(Error::Option {
                name: "from",
                value: format!("\"{}\"", folder.display()),
                allowed: "the folder of a run of a scene, with its run.ckpt",
            });
        }
        let (before, mut simulation) = Run::read(folder)?.0.into_parts();
        let refused = |key: String, advice| Error::Fixed {
            scene: "the scene",
            key,
            state: format!("the checkpoint in {}", folder.display()),
            advice,
        };
        let changes = changes(&before, scene)?;
        if let Some(fixed) = changes.iter().find(|key| !key.can_be_started(scene)) {
            return Err(refused(
                fixed.name.clone(),
                "a run that starts `from` another one has its materials, walls and bodies",
            ));
        }
        if let Some(other) = simulation.first_other(&self) {
            return Err(refused(
                format!("the shape of \"{other}\""),
                "its file is another one than that run had: give that one, or leave `from` out",
            ));
        }
        simulation.controls = Controls::default();
        // Before motions begin anew: what has come to rest stays so.
        simulation.set_free(&before, scene)?;
        simulation.world.restart_clock();
        simulation.change(&before, scene)?;
        for (_, member, body) in self.deformables() {
            let id = member.id;
            let Some(present) = simulation.world.deformable(id) else {
                continue;
            };
            let placed = body.boundary().placed(present.positions())?;
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
    fn first_other(&self, other: &Self) -> Option<&str> {
        let walls = self.world.walls().zip(other.world.walls());
        let walls = walls.map(|((_, a), (_, b))| (a, b));
        let mut walls = walls.filter(|(a, b)| a.name() != b.name());
        let size = |of: &Self, id| {
            let body = of.world.deformable(id);
            let nodes = body.map_or(0, |body| body.model().nodes().len());
            of.world.mass(id).map(|mass| (mass, nodes))
        };
        let same = |id| match (size(self, id), size(other, id)) {
            (Some((a, n)), Some((b, m))) => n == m && (a - b).abs() <= SAME * a.abs(),
            _ => false,
        };
        let mut members = self.members.iter().filter(|member| !same(member.id));
        let member = members.next().map(|member| member.name.as_str());
        member.or_else(|| walls.next().map(|(wall, _)| wall.name()))
    }
}
