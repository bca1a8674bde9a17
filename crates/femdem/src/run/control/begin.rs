//! The beginning of control.

use super::host::volume_within;
use super::periodic::ControlledCell;
use super::{BoxWalls, Controls};
use crate::Error;
use crate::run::words::in_entry;
use crate::run::{Scenario, Simulation};

impl Simulation {
    /// Begins to control the walls and the periodic cell of a scene, from where they are. Cells that were controlled before keep
    /// the sides from which their strains count.
    pub(in crate::run) fn control(&mut self, scene: &Scenario) -> Result<(), Error> {
        let mut controls = Controls::default();
        let origin = self.origin.walls.iter();
        for ((number, entry), walls) in (1..).zip(&scene.wall).zip(origin) {
            let name = match entry.name.as_str() {
                "" => format!("wall {number}"),
                name => name.to_owned(),
            };
            let solid = match &entry.r#box {
                Some(space) => {
                    let now = BoxWalls::new(space, walls, &self.world);
                    let members = self.members.iter().map(|member| member.id);
                    volume_within(&self.world, members, now.corners(&self.world))
                }
                None => 0.0,
            };
            let added = controls.add(entry, &name, walls, solid, &mut self.world);
            added.map_err(in_entry(format!("wall \"{name}\"")))?;
        }
        let entry = scene.cell.as_ref().and_then(|cell| cell.control.as_ref());
        controls.periodic = ControlledCell::new(entry, &self.world)?;
        if let (Some(cell), Some(known)) = (&mut controls.periodic, &self.controls.periodic) {
            cell.start = known.start;
        }
        for cell in &mut controls.cells {
            let before = self.controls.cells.iter();
            if let Some(known) = before.into_iter().find(|known| known.name == cell.name) {
                (cell.start, cell.solid) = (known.start, known.solid);
            }
        }
        self.controls = controls;
        Ok(())
    }
}
