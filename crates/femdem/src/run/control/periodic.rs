//! A periodic cell that follows a stress, a rate of strain or a rate of shear.

use femdem_fem::Curve;
use femdem_mesh::{Matrix3, Vector3};
use femdem_solve::{Halo, Resistance, Servo, SolveError, World};
use serde::{Deserialize, Serialize};

use super::{CellState, ControlEntry};
use crate::Error;
use crate::error::wrong;

/// Name of the periodic cell in the results.
pub(super) const NAME: &str = "cell";

/// A periodic cell, what it is to do, and what it was when that began.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlledCell {
    /// Stresses \[Pa\] or rates of strain \[1/s\] along the axes over time.
    goals: [Option<Goal>; 3],
    /// Rate of shear over time \[1/s\].
    shear: Option<Curve>,
    /// Sides and lean of edge z when the control began \[m\].
    pub(super) start: [f64; 4],
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Goal {
    curve: Curve,
    /// `None`: a rate of strain.
    servo: Option<Servo>,
}

impl ControlledCell {
    /// The cell of a world under an entry, or without one.
    pub(super) fn new(entry: Option<&ControlEntry>, world: &World) -> Result<Option<Self>, Error> {
        let Some(cell) = world.cell().filter(|cell| cell.volume().is_some()) else {
            if entry.is_some() {
                let allowed = "given to a cell that repeats itself along x, y and z";
                return Err(wrong("cell.control", "given", allowed));
            }
            return Ok(None);
        };
        let mut goals = [None, None, None];
        let mut shear = None;
        if let Some(entry) = entry {
            entry.check_cell()?;
            for (axis, wanted) in entry.axes() {
                let (curve, limit) = wanted.goal()?;
                let servo = limit.map(Servo::new).transpose()?;
                goals[axis] = Some(Goal { curve, servo });
            }
            shear = entry.shear.as_ref().map(|shear| shear.rate()).transpose()?;
        }
        let edges = cell.edges();
        Ok(Some(Self {
            goals,
            shear,
            start: [edges.m11, edges.m22, edges.m33, edges.m13],
        }))
    }

    /// Sets the velocities of the edges for the next step.
    pub(super) fn plan(
        &mut self,
        world: &mut World,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        let moves = self.shear.is_some() || self.goals.iter().any(Option::is_some);
        let Some(cell) = world.cell().filter(|_| moves) else {
            // A run that begins from another one stops what moved there.
            return world.deform_cell_on(Matrix3::zeros(), halo);
        };
        let edges = *cell.edges();
        let presses = self.goals.iter().flatten().any(|goal| goal.servo.is_some());
        let met = match presses {
            true => world.cell_resistance(halo)?,
            false => None,
        };
        let (time, step) = (world.time(), world.time_step());
        let mut gradient = Matrix3::zeros();
        for (axis, goal) in self.goals.iter_mut().enumerate() {
            let Some(Goal { curve, servo }) = goal else {
                continue;
            };
            let side = edges[(axis, axis)];
            gradient[(axis, axis)] = match (servo, &met) {
                (Some(servo), Some(met)) => {
                    let area = edges.diagonal().product() / side;
                    let resistance = Resistance {
                        force: met.stress[(axis, axis)] * area,
                        stiffness: met.stiffness[axis],
                        energy: met.energy,
                    };
                    -servo.velocity(&resistance, curve.at(time) * area, step) / side
                }
                _ => -curve.at(time),
            };
        }
        gradient.m13 = self.shear.as_ref().map_or(0.0, |rate| rate.at(time));
        world.deform_cell_on(gradient * edges, halo)
    }

    /// The state now, by what the bodies of all ranks do; `None` if the world has no such cell.
    pub(super) fn state(
        &self,
        world: &World,
        halo: &mut dyn Halo,
    ) -> Result<Option<CellState>, SolveError> {
        let Some((cell, met)) = world.cell().zip(world.cell_resistance(halo)?) else {
            return Ok(None);
        };
        let (edges, stress) = (cell.edges(), met.stress);
        let solid = solid(world, halo)?;
        let sides: [f64; 3] = edges.diagonal().into();
        let errors = [0, 1, 2].map(|axis| {
            let goal = self.goals[axis]
                .as_ref()
                .filter(|goal| goal.servo.is_some())?;
            let wanted = goal.curve.at(world.time());
            (wanted > 0.0).then(|| stress[(axis, axis)] / wanted - 1.0)
        });
        let [x, y, z, lean] = self.start;
        let lengths = Vector3::new(x, y, z);
        Ok(Some(CellState {
            name: NAME.to_owned(),
            sides,
            stress: stress.diagonal().into(),
            strain: [0, 1, 2].map(|axis| (lengths[axis] / sides[axis]).ln()),
            shear_stress: Some(-stress.m13),
            shear_strain: Some(edges.m13 / edges.m33 - lean / z),
            solid_fraction: solid / edges.diagonal().product(),
            errors,
        }))
    }
}

/// Volume of the bodies of all ranks, undeformed, with those that sources have brought \[m³\].
fn solid(world: &World, halo: &mut dyn Halo) -> Result<f64, SolveError> {
    let volume = |id| Some(world.shape(world.shape_of(id)?)?.volume);
    let rigid = world.own_bodies(0).filter_map(volume);
    let soft = world.deformables();
    let soft = soft.flat_map(|body| body.model().volumes()).copied();
    let sums = world.sums_on(vec![rigid.chain(soft).collect()], halo)?;
    Ok(sums[0])
}
