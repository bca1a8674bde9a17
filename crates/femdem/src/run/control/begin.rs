//! The beginning of control.

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
                    self.volume_within(now.corners(&self.world))
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

    /// Volume of the bodies whose centroids lie in a box \[m³\].
    fn volume_within(&self, [lower, upper]: [[f64; 3]; 2]) -> f64 {
        let volumes = self.members.iter().filter_map(|member| {
            let x = self.world.position(member.id)?;
            let inside = (0..3).all(|k| x[k] >= lower[k] && x[k] <= upper[k]);
            let rigid = self.world.shape_of(member.id);
            let rigid = rigid.and_then(|shape| Some(self.world.shape(shape)?.volume));
            let volume = rigid.or_else(|| {
                let body = self.world.deformable(member.id)?;
                Some(body.model().volumes().iter().sum())
            });
            volume.filter(|_| inside)
        });
        volumes.sum()
    }
}
