//! Walls that are moved, and a periodic cell that is deformed, so that a force, a stress or a rate of strain has a wanted value.
//!
//! A wall with a force, and the walls of a box with a stress, are moved by a [`Servo`]; two opposite walls of a box by
//! the same way, under the mean of their forces, so that the box stays where it is.

mod begin;
mod cell;
mod entry;
mod host;
mod periodic;

use femdem_contact::{Partner, WallShape};
use femdem_fem::Curve;
use femdem_mesh::Vector3;
use femdem_solve::{Alone, Driven, Halo, Resistance, Servo, SolveError, World};
use serde::{Deserialize, Serialize};

pub use cell::{Cell, CellState};
pub use entry::{AxisEntry, ControlEntry, ShearEntry, Sides};

use super::WallEntry;
use crate::Error;
use crate::error::wrong;
pub(super) use cell::BoxWalls;
use cell::inwards;
use periodic::ControlledCell;

/// The controlled walls of a simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Controls {
    cells: Vec<Cell>,
    groups: Vec<Group>,
    periodic: Option<ControlledCell>,
}

/// Walls that move alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Group {
    /// Number of the cell and its axis.
    cell: Option<(usize, usize)>,
    walls: Vec<Sliding>,
    /// Whether the goal is a stress, on the present area.
    by_area: bool,
    /// The force \[N\], the stress of the cell \[Pa\] or its rate of strain \[1/s\] over time.
    goal: Curve,
    /// `None`: a rate of strain.
    servo: Option<Servo>,
    /// Along the directions of the walls, from where they were when the control began \[m\].
    moved: f64,
    /// m/s.
    velocity: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Sliding {
    wall: u32,
    direction: Vector3,
}

impl Group {
    /// What the group is to reach at a time: a force \[N\] or a rate.
    fn wanted(&self, sides: &[[f64; 3]], time: f64) -> f64 {
        let area = match self.cell {
            Some((cell, axis)) if self.by_area => Cell::area(sides[cell], axis),
            _ => 1.0,
        };
        self.goal.at(time) * area
    }

    /// The velocity for the next step, from what its walls meet.
    fn plan(&mut self, world: &World, sides: &[[f64; 3]], met: &[Resistance]) {
        let wanted = self.wanted(sides, world.time());
        let count = self.walls.len() as f64;
        let mean = |of: fn(&Resistance) -> f64| met.iter().map(of).sum::<f64>() / count;
        self.velocity = match (&mut self.servo, self.cell) {
            (Some(servo), _) => {
                let met = Resistance {
                    force: mean(|met| met.force),
                    stiffness: mean(|met| met.stiffness),
                    energy: mean(|met| met.energy),
                };
                servo.velocity(&met, wanted, world.time_step())
            }
            (None, Some((cell, axis))) => wanted * sides[cell][axis] / count,
            (None, None) => 0.0,
        };
    }

    /// Whether it moves the wall, and where that is `ahead` from now.
    fn place(&self, wall: u32, ahead: f64) -> Option<Driven> {
        let sliding = self.walls.iter().find(|sliding| sliding.wall == wall)?;
        Some(Driven {
            displacement: sliding.direction * (self.moved + self.velocity * ahead),
            velocity: sliding.direction * self.velocity,
            ..Driven::default()
        })
    }
}

impl Controls {
    /// Whether no wall is controlled, and no periodic cell is there.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty() && self.periodic.is_none()
    }

    /// Whether there are boxes with controlled walls, or a cell that is periodic along all axes.
    #[must_use]
    pub fn has_cells(&self) -> bool {
        !self.cells.is_empty() || self.periodic.is_some()
    }

    /// The names of these cells, the periodic one last.
    pub(super) fn cell_names(&self) -> impl Iterator<Item = &str> {
        let boxes = self.cells.iter().map(|cell| &*cell.name);
        boxes.chain(self.periodic.as_ref().map(|_| periodic::NAME))
    }

    /// Their states, by what the bodies of all ranks do; [`Alone`] is the halo of a world that has all bodies.
    ///
    /// # Errors
    ///
    /// As [`World::resistances`].
    pub fn cells(&self, world: &World, halo: &mut dyn Halo) -> Result<Vec<CellState>, SolveError> {
        let mut states = Vec::new();
        if !self.cells.is_empty() {
            let of_cells = self.cells.iter().flat_map(Cell::inwards);
            let of_groups = self.groups.iter().flat_map(|group| &group.walls);
            let of_groups = of_groups.map(|sliding| (sliding.wall, sliding.direction));
            let walls: Vec<_> = of_cells.chain(of_groups).collect();
            let met = world.resistances(&walls, halo)?;
            let mut pushes = met.iter().map(|met| met.force);
            for cell in &self.cells {
                let own = pushes.by_ref().take(cell.inwards().count());
                states.push(cell.state(world, own));
            }
            let sides: Vec<_> = states.iter().map(|state| state.sides).collect();
            for group in &self.groups {
                let sum: f64 = pushes.by_ref().take(group.walls.len()).sum();
                let wanted = group.wanted(&sides, world.time());
                if let (Some((cell, axis)), Some(_)) = (group.cell, &group.servo)
                    && wanted > 0.0
                {
                    let mean = sum / group.walls.len() as f64;
                    states[cell].errors[axis] = Some(mean / wanted - 1.0);
                }
            }
        }
        if let Some(cell) = &self.periodic {
            states.extend(cell.state(world, halo)?);
        }
        Ok(states)
    }

    /// Begins to control the `walls` of the world that an entry is, which stand where they are; `name` is that of the
    /// entry, `solid` the volume of the bodies \[m³\].
    pub(super) fn add(
        &mut self,
        entry: &WallEntry,
        name: &str,
        walls: &[u32],
        solid: f64,
        world: &mut World,
    ) -> Result<(), Error> {
        let Some(control) = &entry.control else {
            return Ok(());
        };
        if entry.motion.is_some() {
            let allowed = "give a wall either a motion or a control";
            return Err(wrong("control", "given beside motion", allowed));
        }
        let before = self.groups.len();
        if let Some(space) = &entry.r#box {
            control.check_box()?;
            let turned = |wall: &u32| {
                world
                    .wall_pose(*wall)
                    .is_some_and(|p| p.rotation.angle() > 0.0)
            };
            if walls.iter().any(turned) {
                let allowed =
                    "a box whose walls have not been turned: its axes are those of the world";
                return Err(wrong("control", "given to a box that was turned", allowed));
            }
            let walls = BoxWalls::new(space, walls, world);
            let cell = Cell {
                name: name.to_owned(),
                start: walls.sides(world),
                walls,
                solid,
            };
            let number = self.cells.len();
            for (axis, wanted) in control.axes() {
                let group = group_of(&cell, number, axis, wanted, space.open)?;
                self.groups.push(group);
            }
            self.cells.push(cell);
        } else {
            let (goal, limit) = control.force()?;
            let normal = walls.first().and_then(|&wall| normal(world, wall));
            let direction = control.direction(normal)?;
            let walls = walls.iter().map(|&wall| Sliding { wall, direction });
            self.groups.push(Group {
                cell: None,
                walls: walls.collect(),
                by_area: false,
                goal,
                servo: Some(Servo::new(limit)?),
                moved: 0.0,
                velocity: 0.0,
            });
        }
        for group in &self.groups[before..] {
            for sliding in &group.walls {
                world.drive_wall_by_host(sliding.wall, Driven::default())?;
            }
        }
        Ok(())
    }

    /// The velocities for the next step.
    fn plan(&mut self, world: &World, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let each = self.cells.iter();
        let sides: Vec<[f64; 3]> = each.map(|cell| cell.walls.sides(world)).collect();
        let walls = self.groups.iter().flat_map(|group| &group.walls);
        let walls = walls.map(|sliding| (sliding.wall, sliding.direction));
        let met = world.resistances(&walls.collect::<Vec<_>>(), halo)?;
        let mut rest = &met[..];
        for group in &mut self.groups {
            let (own, others) = rest.split_at(group.walls.len());
            group.plan(world, &sides, own);
            rest = others;
        }
        Ok(())
    }

    /// Takes a step of the world, in which the controlled walls and the cell move.
    ///
    /// # Errors
    ///
    /// Those of [`World::step`].
    pub fn step(&mut self, world: &mut World) -> Result<(), SolveError> {
        self.step_on(world, &mut Alone)
    }

    /// As [`step`](Self::step), of a world that is [shared out](World::share_out), by all ranks, which have the same controls.
    ///
    /// # Errors
    ///
    /// Those of [`World::step_on`].
    pub fn step_on(&mut self, world: &mut World, halo: &mut dyn Halo) -> Result<(), SolveError> {
        if !self.groups.is_empty() {
            self.plan(world, halo)?;
        }
        if let Some(cell) = &mut self.periodic {
            cell.plan(world, halo)?;
        }
        let start = world.time();
        let driven = |thing, end: f64| {
            let Partner::Wall(wall) = thing else {
                return None;
            };
            let mut places = self.groups.iter();
            places.find_map(|group| group.place(wall, end - start))
        };
        world.step_with_on(driven, halo)?;
        let taken = world.time() - start;
        for group in &mut self.groups {
            group.moved += group.velocity * taken;
        }
        Ok(())
    }
}

/// The normal into the space for the bodies of a wall that is a plane.
fn normal(world: &World, wall: u32) -> Option<Vector3> {
    let pose = world.wall_pose(wall)?;
    match world.wall(wall)? {
        WallShape::Planes(planes) if planes.planes().len() == 1 => {
            planes.planes().first().map(|plane| pose * plane.normal)
        }
        _ => None,
    }
}

fn group_of(
    cell: &Cell,
    number: usize,
    axis: usize,
    wanted: &AxisEntry,
    open: bool,
) -> Result<Group, Error> {
    let (goal, limit) = wanted.goal()?;
    if open && wanted.stress.is_some() && axis != 2 {
        return Err(wrong(
            "control",
            "a stress on sides of a box without a lid",
            "a box with a lid (open = false), whose height is known, or a force or strain-rate",
        ));
    }
    let sides: &[usize] = match wanted.sides {
        Sides::Both => &[0, 1],
        Sides::Lower => &[0],
        Sides::Upper => &[1],
    };
    let mut walls = Vec::new();
    for &side in sides {
        let wall = cell.walls.numbers[axis][side].ok_or_else(|| {
            let allowed = "a side that the box has: it is without a lid (open = true)";
            wrong("control.z.sides", "the lid", allowed)
        })?;
        walls.push(Sliding {
            wall,
            direction: inwards(axis, side),
        });
    }
    Ok(Group {
        cell: Some((number, axis)),
        walls,
        by_area: wanted.stress.is_some(),
        goal,
        servo: limit.map(Servo::new).transpose()?,
        moved: 0.0,
        velocity: 0.0,
    })
}
