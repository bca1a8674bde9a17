//! What is done to a body from outside: nodes held or driven, pressure, traction, gravity.

use super::loads::{Load, LoadKind};
use super::{Curve, DeformableModel, NodeSets, Selection};
use crate::drive::Drive;
use crate::error::{FemError, check};
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Pose, Rotation, Vector3, checked_pose};
use serde::{Deserialize, Serialize};

/// Boundary conditions of one body.
///
/// ```
/// use femdem_mesh::{TetMesh, Vector3};
/// use femdem_fem::{Boundary, Curve, DeformableModel, MaterialRegion, Selection};
/// use femdem_fem::element::Element;
/// use femdem_fem::material::NeoHookean;
///
/// let mesh = TetMesh::block([4, 1, 1], &Vector3::new(0.4, 0.1, 0.1))?;
/// let steel = MaterialRegion { material: NeoHookean::new(2e11, 0.3)?.into(), density: 7800.0 };
/// let model = DeformableModel::new(&mesh, Element::T4, vec![steel], None)?;
/// let end = |offset| Selection::Plane { normal: Vector3::x(), offset, tolerance: 1e-9 };
///
/// let mut boundary = Boundary::new(Vector3::new(0.0, 0.0, -9.81))?;
/// boundary.fix(&model, &end(0.0), [true; 3])?;
/// boundary.press(&model, &end(0.4), Curve::Ramp { value: 1e6, rise: 1e-3 })?;
/// assert_eq!(boundary.held().count(), 4 * 3);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Boundary {
    pub(super) gravity: Vector3,
    pub(super) sets: NodeSets,
    pub(super) drives: Vec<Drive>,
    /// Sorted by node and component.
    pub(super) holds: Vec<Hold>,
    pub(super) loads: Vec<Load>,
}

/// A boundary as read, before its numbers are checked.
#[derive(Deserialize)]
struct Stored {
    gravity: Vector3,
    sets: NodeSets,
    drives: Vec<Drive>,
    holds: Vec<Hold>,
    loads: Vec<Load>,
}

impl TryFrom<Stored> for Boundary {
    type Error = FemError;

    fn try_from(stored: Stored) -> Result<Self, FemError> {
        let Stored {
            gravity,
            sets,
            drives,
            holds,
            loads,
        } = stored;
        for hold in &holds {
            if hold.drive as usize >= drives.len() {
                return Err(FemError::NoSuch {
                    what: "drive",
                    index: hold.drive as usize,
                    count: drives.len(),
                });
            }
            let component = f64::from(hold.component);
            check("component", component, component < 3.0, "0 to 2")?;
            let place = hold.place.norm();
            check(
                "place of a held node",
                place,
                true,
                "finite in every component, in m",
            )?;
        }
        for drive in &drives {
            drive.validate()?;
        }
        for load in &loads {
            load.validate()?;
        }
        Ok(Self {
            sets,
            drives,
            holds: in_order(holds),
            loads,
            ..Self::new(gravity)?
        })
    }
}

/// A component of a node's position that is prescribed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Hold {
    pub node: u32,
    pub component: u8,
    pub drive: u32,
    /// Where the node's motion counts from, m.
    pub place: Vector3,
}

/// Sorted by node and component, where the last of equal ones counts.
pub(super) fn in_order(mut holds: Vec<Hold>) -> Vec<Hold> {
    let key = |hold: &Hold| (hold.node, hold.component);
    // Stable: of equal keys the last is the newest.
    holds.sort_by_key(key);
    let mut kept: Vec<Hold> = Vec::with_capacity(holds.len());
    for hold in holds {
        match kept.last_mut() {
            Some(last) if key(last) == key(&hold) => *last = hold,
            _ => kept.push(hold),
        }
    }
    kept
}

impl Boundary {
    /// Gravity alone, m/s^2.
    ///
    /// # Errors
    ///
    /// If it is not finite.
    pub fn new(gravity: Vector3) -> Result<Self, FemError> {
        check("gravity", gravity.norm(), true, "finite, in m/s^2")?;
        Ok(Self {
            gravity,
            ..Self::default()
        })
    }

    /// The same conditions with another gravity, m/s^2.
    ///
    /// # Errors
    ///
    /// If it is not finite.
    pub fn with_gravity(self, gravity: Vector3) -> Result<Self, FemError> {
        Ok(Self {
            gravity: Self::new(gravity)?.gravity,
            ..self
        })
    }

    /// Gravity, m/s^2.
    #[must_use]
    pub fn gravity(&self) -> Vector3 {
        self.gravity
    }

    /// Gives a set of nodes a name, for [`Selection::Named`]; an older set of that name is replaced.
    ///
    /// # Errors
    ///
    /// As [`DeformableModel::select`].
    pub fn name_set(
        &mut self,
        name: &str,
        model: &DeformableModel,
        selection: &Selection,
    ) -> Result<(), FemError> {
        let nodes = model.select(selection, &self.sets)?;
        self.sets.insert(name.to_owned(), nodes);
        Ok(())
    }

    /// The named sets.
    #[must_use]
    pub fn sets(&self) -> &NodeSets {
        &self.sets
    }

    /// Holds the chosen components (x, y, z) of nodes where they are in the reference state. Later
    /// conditions on the same component of a node replace earlier ones. Returns the number of nodes.
    ///
    /// # Errors
    ///
    /// As [`DeformableModel::select`].
    pub fn fix(
        &mut self,
        model: &DeformableModel,
        selection: &Selection,
        components: [bool; 3],
    ) -> Result<usize, FemError> {
        self.drive(model, selection, components, Drive::Fixed)
    }

    /// Prescribes the chosen components of nodes: where `drive` takes their reference places.
    /// Returns the number of nodes.
    ///
    /// # Errors
    ///
    /// As [`DeformableModel::select`], and if a number of the drive is out of its range.
    pub fn drive(
        &mut self,
        model: &DeformableModel,
        selection: &Selection,
        components: [bool; 3],
        drive: Drive,
    ) -> Result<usize, FemError> {
        let places = model.nodes().to_vec();
        self.drive_from(model, selection, components, drive, &places)
    }

    /// As [`Boundary::drive`], with the motion counted from `places` (m, per node of the model)
    /// instead of the reference places, for a body that was moved before.
    ///
    /// # Errors
    ///
    /// As [`Boundary::drive`], and if `places` has another length than the model's nodes.
    pub fn drive_from(
        &mut self,
        model: &DeformableModel,
        selection: &Selection,
        components: [bool; 3],
        drive: Drive,
        places: &[Vector3],
    ) -> Result<usize, FemError> {
        drive.validate()?;
        check(
            "number of places",
            places.len() as f64,
            places.len() == model.nodes().len(),
            "the number of nodes",
        )?;
        let nodes = model.select(selection, &self.sets)?;
        let index = self.drives.len() as u32;
        self.drives.push(drive);
        for &node in &nodes {
            for component in (0..3_u8).filter(|&c| components[usize::from(c)]) {
                self.holds.push(Hold {
                    node,
                    component,
                    drive: index,
                    place: places[node as usize],
                });
            }
        }
        self.holds = in_order(std::mem::take(&mut self.holds));
        Ok(nodes.len())
    }

    /// Pressure, Pa, against the faces of the skin whose nodes are all selected; it follows the
    /// faces as they move. Returns the number of faces.
    ///
    /// # Errors
    ///
    /// As [`DeformableModel::select`]; if no face is selected; if the curve means nothing.
    pub fn press(
        &mut self,
        model: &DeformableModel,
        selection: &Selection,
        pressure: impl Into<Curve>,
    ) -> Result<usize, FemError> {
        self.load(model, selection, LoadKind::Pressure, pressure.into())
    }

    /// Traction on the faces of the skin whose nodes are all selected: `traction` (Pa, per area of the
    /// reference state) times a curve, in a direction that stays. Returns the number of faces.
    ///
    /// # Errors
    ///
    /// As [`Boundary::press`], and if the traction is not finite.
    pub fn pull(
        &mut self,
        model: &DeformableModel,
        selection: &Selection,
        traction: Vector3,
        curve: impl Into<Curve>,
    ) -> Result<usize, FemError> {
        self.load(model, selection, LoadKind::Traction(traction), curve.into())
    }

    fn load(
        &mut self,
        model: &DeformableModel,
        selection: &Selection,
        kind: LoadKind,
        curve: Curve,
    ) -> Result<usize, FemError> {
        let faces = model.faces_of(&model.select(selection, &self.sets)?);
        if faces.is_empty() {
            return Err(FemError::NothingSelected {
                selection: format!("{selection:?}, of which no face of the skin has all nodes"),
            });
        }
        let count = faces.len();
        let load = Load { kind, curve, faces };
        load.validate()?;
        self.loads.push(load);
        Ok(count)
    }

    /// The same with the places that motions count from moved by a pose. Directions stay: components
    /// are those of the world.
    ///
    /// # Errors
    ///
    /// For a pose that is not finite or no rotation.
    pub fn posed(&self, pose: &Pose) -> Result<Self, FemError> {
        let pose = checked_pose(pose)?;
        let mut posed = self.clone();
        for hold in &mut posed.holds {
            hold.place = pose.rotation * hold.place + pose.translation.vector;
        }
        Ok(posed)
    }

    /// The same with motions counted from time `t` (s). At time `t` driven nodes are at the places given to
    /// the boundary; only the part of their motion after `t` is still to come.
    #[must_use]
    pub fn counted_from(&self, t: f64) -> Self {
        let mut counted = self.clone();
        let driven: Vec<_> = self.drives.iter().map(|drive| drive.at(t)).collect();
        for hold in &mut counted.holds {
            let here = Pose::from_parts(Translation3::from(hold.place), Rotation::identity());
            hold.place = driven[hold.drive as usize]
                .base_of(&here)
                .translation
                .vector;
        }
        counted
    }

    /// The same with motions counted from other places (m, per node of the model), such as those where the nodes
    /// of a body are after another motion. Held components stay there.
    ///
    /// # Errors
    ///
    /// If `places` is too short, or holds a number that is not finite.
    pub fn placed(&self, places: &[Vector3]) -> Result<Self, FemError> {
        let mut placed = self.clone();
        for hold in &mut placed.holds {
            let Some(place) = places.get(hold.node as usize) else {
                return Err(FemError::NoSuch {
                    what: "place of a node",
                    index: hold.node as usize,
                    count: places.len(),
                });
            };
            check("place of a held node", place.norm(), true, "finite, in m")?;
            hold.place = *place;
        }
        Ok(placed)
    }

    /// The same with motions that begin anew, at time 0, from where they are at time `t` (s).
    pub fn restarted(&self, t: f64) -> Self {
        let mut begun = self.clone();
        let driven: Vec<_> = self.drives.iter().map(|drive| drive.at(t)).collect();
        for hold in &mut begun.holds {
            let base = Pose::from_parts(Translation3::from(hold.place), Rotation::identity());
            hold.place = driven[hold.drive as usize].place(&base).translation.vector;
        }
        begun.counted_from(0.0)
    }

    /// Refuses conditions on nodes that a model has not.
    pub fn check(&self, model: &DeformableModel) -> Result<(), FemError> {
        let count = model.nodes().len();
        match self.largest_node() {
            Some(node) if node as usize >= count => Err(FemError::NoSuch {
                what: "node",
                index: node as usize,
                count,
            }),
            _ => Ok(()),
        }
    }

    /// The node and component (0 to 2) of everything that is held or driven, ascending.
    pub fn held(&self) -> impl Iterator<Item = (u32, usize)> {
        let each = self.holds.iter();
        each.map(|hold| (hold.node, usize::from(hold.component)))
    }

    /// Whether nothing is prescribed: no gravity of its own, no load, no node held or driven.
    pub fn is_free(&self) -> bool {
        self.gravity == Vector3::zeros() && self.loads.is_empty() && self.holds.is_empty()
    }

    /// Whether nodes move as prescribed at time `t` or within `ahead` after it (s).
    pub fn is_driven(&self, t: f64, ahead: f64) -> bool {
        self.drives.iter().any(|drive| drive.is_active(t, ahead))
    }

    /// Whether a pressure, which turns with its faces, is among the loads.
    pub fn has_pressure(&self) -> bool {
        let mut kinds = self.loads.iter().map(|load| load.kind);
        kinds.any(|kind| kind == LoadKind::Pressure)
    }

    /// Largest node that anything is done to.
    fn largest_node(&self) -> Option<u32> {
        let held = self.holds.last().map(|hold| hold.node);
        let loaded = self
            .loads
            .iter()
            .flat_map(|load| load.faces.iter().flatten());
        loaded.copied().chain(held).max()
    }

    /// Calls `f` with node, component, position (m) and velocity (m/s) at time `t` (s) of everything
    /// that is held or driven.
    pub fn for_held(&self, t: f64, mut f: impl FnMut(usize, usize, f64, f64)) {
        let driven: Vec<_> = self.drives.iter().map(|drive| drive.at(t)).collect();
        for hold in &self.holds {
            let driven = &driven[hold.drive as usize];
            let base = Pose::from_parts(Translation3::from(hold.place), Rotation::identity());
            let place = driven.place(&base).translation.vector;
            let component = usize::from(hold.component);
            let velocity = driven.velocity_at(&place)[component];
            f(hold.node as usize, component, place[component], velocity);
        }
    }

    /// Adds loads and weight at time `t` (s) and positions `x` (m) to `forces` (N).
    ///
    /// # Errors
    ///
    /// If `x` or `forces` has another length than the model's nodes, or the conditions are on nodes that the model has
    /// not.
    pub fn add_forces(
        &self,
        model: &DeformableModel,
        t: f64,
        x: &[Vector3],
        forces: &mut [Vector3],
    ) -> Result<(), FemError> {
        self.check(model)?;
        let count = model.nodes().len();
        for (name, length) in [("length of x", x.len()), ("length of forces", forces.len())] {
            check(name, length as f64, length == count, "the number of nodes")?;
        }
        if self.gravity != Vector3::zeros() {
            for (force, mass) in forces.iter_mut().zip(model.masses()) {
                *force += self.gravity * *mass;
            }
        }
        for load in &self.loads {
            load.add(model, t, x, forces);
        }
        Ok(())
    }
}
