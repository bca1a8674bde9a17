//! Control for hosts that step a world themselves.

use femdem_contact::BodyId;
use femdem_mesh::Matrix3;
use femdem_solve::{Drive, SolveError, World};

use super::periodic::ControlledCell;
use super::{BoxWalls, ControlEntry, Controls};
use crate::Error;
use crate::run::WallEntry;

impl Controls {
    /// Begins to control the `walls` of a world that an entry is, from where they stand, if it has a control; `name` is that of
    /// the entry. From then on [`step`](Self::step) takes the steps of the world.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key at fault, and those of the world; nothing is controlled anew then.
    pub fn control_walls(
        &mut self,
        entry: &WallEntry,
        name: &str,
        walls: &[u32],
        world: &mut World,
    ) -> Result<(), Error> {
        let solid = match &entry.r#box {
            Some(space) => {
                let corners = BoxWalls::new(space, walls, world).corners(world);
                volume_within(world, world.body_ids(), corners)
            }
            None => 0.0,
        };
        let mut more = self.clone();
        more.add(entry, name, walls, solid, world)?;
        *self = more;
        Ok(())
    }

    /// Begins to control the periodic cell of a world, or ends that: the cell keeps its edges then.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key at fault, also for a world without such a cell.
    pub fn control_cell(
        &mut self,
        entry: Option<&ControlEntry>,
        world: &mut World,
    ) -> Result<(), Error> {
        let cell = entry.map(|entry| ControlledCell::new(Some(entry), world));
        let cell = cell.transpose()?.flatten();
        if self.periodic.is_some() && cell.is_none() {
            world.deform_cell(Matrix3::zeros())?;
        }
        self.periodic = cell;
        Ok(())
    }

    /// Ends the control of a wall and of those that move with it, which stand still then.
    ///
    /// # Errors
    ///
    /// Those of [`World::drive_wall`].
    pub fn release(&mut self, wall: u32, world: &mut World) -> Result<(), SolveError> {
        let has = |group: &super::Group| group.walls.iter().any(|sliding| sliding.wall == wall);
        let groups = std::mem::take(&mut self.groups).into_iter();
        let (ended, kept): (Vec<_>, Vec<_>) = groups.partition(has);
        self.groups = kept;
        for sliding in ended.iter().flat_map(|group| &group.walls) {
            world.drive_wall(sliding.wall, Drive::Fixed)?;
        }
        Ok(())
    }
}

/// Volume of bodies, undeformed, whose centroids lie in a box \[m³\].
pub(super) fn volume_within(
    world: &World,
    bodies: impl Iterator<Item = BodyId>,
    [lower, upper]: [[f64; 3]; 2],
) -> f64 {
    let volumes = bodies.filter_map(|id| {
        let x = world.position(id)?;
        let inside = (0..3).all(|k| x[k] >= lower[k] && x[k] <= upper[k]);
        let rigid = world.shape_of(id);
        let rigid = rigid.and_then(|shape| Some(world.shape(shape)?.volume));
        let volume = rigid.or_else(|| {
            let body = world.deformable(id)?;
            Some(body.model().volumes().iter().sum())
        });
        volume.filter(|_| inside)
    });
    volumes.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_contact::MaterialId;
    use femdem_mesh::Pose;
    use femdem_solve::{BodySpec, WorldParameters};

    /// A lid that presses a ball, which lies on a floor, without gravity.
    fn pressed() -> (World, Controls, u32) {
        let parameters = WorldParameters {
            gravity: femdem_mesh::Vector3::zeros(),
            ..WorldParameters::default()
        };
        let mut world = World::new(parameters).unwrap();
        let ball = world.add_sphere("ball", 0.05).unwrap();
        let place = Pose::translation(0.0, 0.0, 0.05);
        world
            .add_body(BodySpec::at_rest(ball, 2000.0, place))
            .unwrap();
        let mut controls = Controls::default();
        for text in [
            "plane = { normal = [0, 0, 1] }",
            "plane = { normal = [0, 0, -1], offset = -0.1 }\ncontrol = { force = 20, speed = 0.05 }",
        ] {
            let entry: WallEntry = toml::from_str(text).unwrap();
            let before: Vec<u32> = world.walls().map(|(id, _)| id).collect();
            entry
                .add_to("wall", MaterialId::default(), &mut world)
                .unwrap();
            let new = world
                .walls()
                .map(|(id, _)| id)
                .filter(|id| !before.contains(id));
            let walls: Vec<u32> = new.collect();
            controls
                .control_walls(&entry, "wall", &walls, &mut world)
                .unwrap();
        }
        (world, controls, 1)
    }

    #[test]
    fn a_wall_presses_with_its_force_until_it_is_released() {
        let (mut world, mut controls, lid) = pressed();
        while world.time() < 6.0 {
            controls.step(&mut world).unwrap();
        }
        let force = |world: &World, wall| world.wall_load(wall).unwrap().total.force.z;
        // A ball stiffens as it is pressed, and the last hundredth of the force takes the servo a thousand steps.
        let [above, below] = [force(&world, lid), force(&world, 0)];
        assert!((above / 20.0 - 1.0).abs() < 2e-3, "{above} {below}");
        assert!((below / -above - 1.0).abs() < 1e-5, "{above} {below}");
        controls.release(lid, &mut world).unwrap();
        assert!(controls.is_empty());
        let place = world.wall_pose(lid).unwrap();
        for _ in 0..200 {
            world.step().unwrap();
        }
        assert_eq!(world.wall_pose(lid).unwrap(), place);
    }

    #[test]
    fn a_control_that_is_refused_changes_nothing() {
        let (mut world, mut controls, _) = pressed();
        let entry: WallEntry =
            toml::from_str("plane = { normal = [1, 0, 0] }\ncontrol = { force = -1, speed = 1 }")
                .unwrap();
        let before = controls.clone();
        let refused = controls.control_walls(&entry, "wall", &[0], &mut world);
        assert!(refused.unwrap_err().to_string().contains("control.force"));
        let cell = ControlEntry::default();
        let refused = controls.control_cell(Some(&cell), &mut world);
        assert!(refused.unwrap_err().to_string().contains("cell.control"));
        assert_eq!(controls, before);
    }
}
