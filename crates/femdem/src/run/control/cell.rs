//! A box whose walls are controlled: a test cell.

use femdem_contact::WallShape;
use femdem_mesh::Vector3;
use femdem_solve::World;
use serde::{Deserialize, Serialize};

use crate::run::wall::BoxEntry;

/// A box around bodies with a wall on every side but, perhaps, the top.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the wall in the scenario.
    pub name: String,
    pub(super) walls: BoxWalls,
    /// Sides when the control began \[m\].
    pub(super) start: [f64; 3],
    /// Volume of the bodies when the control began \[m³\].
    pub(super) solid: f64,
}

/// The walls of a box, by which it is known where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::run) struct BoxWalls {
    /// Numbers of the lower and the upper wall across each axis; the last may have none.
    pub(super) numbers: [[Option<u32>; 2]; 3],
    /// Lowest and highest corner where the scenario places it \[m\].
    corners: [[f64; 3]; 2],
}

/// The state of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellState {
    /// Name of the wall in the scenario, or "cell" for the periodic cell.
    pub name: String,
    /// Sides \[m\].
    pub sides: [f64; 3],
    /// Mean of the normal stresses of the two walls across each axis, or in the periodic cell, without dashpots, positive in
    /// compression \[Pa\].
    pub stress: [f64; 3],
    /// Logarithmic strains since the control began, positive in compression.
    pub strain: [f64; 3],
    /// Shear stress on a plane across z along x, in a periodic cell; positive where it resists a growing shear strain \[Pa\].
    pub shear_stress: Option<f64>,
    /// Way along x over height along z since the control began, in a periodic cell.
    pub shear_strain: Option<f64>,
    /// Volume of the bodies over that of the cell.
    pub solid_fraction: f64,
    /// By how much a stress that is controlled misses the wanted one, over that.
    pub errors: [Option<f64>; 3],
}

impl CellState {
    /// Sum of the strains, positive in compression.
    #[must_use]
    pub fn volumetric_strain(&self) -> f64 {
        self.strain.iter().sum()
    }

    /// Volume of the cell \[m³\].
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.sides.iter().product()
    }
}

/// The direction into a box of its lower (0) or upper (1) wall across an axis.
pub(super) fn inwards(axis: usize, side: usize) -> Vector3 {
    let mut direction = Vector3::zeros();
    direction[axis] = if side == 0 { 1.0 } else { -1.0 };
    direction
}

impl BoxWalls {
    /// Those of the box of a scenario, which are these walls of the world.
    pub(in crate::run) fn new(space: &BoxEntry, walls: &[u32], world: &World) -> Self {
        let mut numbers = [[None; 2]; 3];
        for &wall in walls {
            let (axis, side) = side_of(world, wall);
            numbers[axis][side] = Some(wall);
        }
        Self {
            numbers,
            corners: [space.lower, space.upper],
        }
    }

    /// Lowest and highest corner now \[m\]; without a lid the top is that of the scenario.
    pub(in crate::run) fn corners(&self, world: &World) -> [[f64; 3]; 2] {
        [0, 1].map(|side| {
            [0, 1, 2].map(|axis| {
                let wall = self.numbers[axis][side];
                let pose = wall.and_then(|wall| world.wall_pose(wall));
                self.corners[side][axis] + pose.map_or(0.0, |pose| pose.translation.vector[axis])
            })
        })
    }

    /// Sides now \[m\]; without a lid the height is that of the scenario.
    pub(super) fn sides(&self, world: &World) -> [f64; 3] {
        let [lower, upper] = self.corners(world);
        [0, 1, 2].map(|axis| upper[axis] - lower[axis])
    }
}

impl Cell {
    /// Area of the walls across an axis \[m²\].
    pub(super) fn area(sides: [f64; 3], axis: usize) -> f64 {
        sides[(axis + 1) % 3] * sides[(axis + 2) % 3]
    }

    /// Its walls, by axis, with the directions into it.
    pub(super) fn inwards(&self) -> impl Iterator<Item = (u32, Vector3)> {
        let pairs = (0..).zip(&self.walls.numbers);
        pairs.flat_map(|(axis, pair)| {
            let each = (0..).zip(pair);
            each.filter_map(move |(side, wall)| Some(((*wall)?, inwards(axis, side))))
        })
    }

    /// The state now, without the errors of controlled stresses; `pushes` are the forces on its walls along these directions \[N\].
    pub(super) fn state(&self, world: &World, mut pushes: impl Iterator<Item = f64>) -> CellState {
        let sides = self.walls.sides(world);
        let stress = [0, 1, 2].map(|axis| {
            let count = self.walls.numbers[axis].iter().flatten().count();
            let sum: f64 = pushes.by_ref().take(count).sum();
            sum / count as f64 / Self::area(sides, axis)
        });
        CellState {
            name: self.name.clone(),
            sides,
            stress,
            strain: [0, 1, 2].map(|axis| (self.start[axis] / sides[axis]).ln()),
            shear_stress: None,
            shear_strain: None,
            solid_fraction: self.solid / sides.iter().product::<f64>(),
            errors: [None; 3],
        }
    }
}

/// The axis across which a wall of a box lies, and whether it is the lower (0) or the upper (1) one.
fn side_of(world: &World, wall: u32) -> (usize, usize) {
    let planes = world.wall(wall).and_then(|shape| match shape {
        WallShape::Planes(planes) => planes.planes().first(),
        WallShape::Mesh(_) => None,
    });
    let normal = planes.map_or(Vector3::zeros(), |plane| plane.normal);
    let axis = normal.iamax();
    (axis, usize::from(normal[axis] < 0.0))
}
