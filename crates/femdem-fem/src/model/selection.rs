//! Nodes and faces of a body, selected by position or by name.

use super::DeformableModel;
use crate::error::{FemError, check};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A selection of nodes, by their reference positions.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Selection {
    /// All nodes.
    #[default]
    All,
    /// The nodes of the skin.
    Skin,
    /// These nodes.
    Nodes(Vec<u32>),
    /// The nodes of a named set.
    Named(String),
    /// Those in a box, its sides included.
    Box {
        /// Smallest coordinates, m.
        lower: Vector3,
        /// Largest coordinates, m.
        upper: Vector3,
    },
    /// Those within `tolerance` of the plane n . x = offset.
    Plane {
        /// Direction n of any length.
        normal: Vector3,
        /// n . x / |n| on the plane, m.
        offset: f64,
        /// Largest distance, m.
        tolerance: f64,
    },
    /// Those in a ball, its surface included.
    Sphere {
        /// Its centre, m.
        centre: Vector3,
        /// Its radius, m.
        radius: f64,
    },
}

/// Sets of nodes by name, ascending.
pub type NodeSets = BTreeMap<String, Vec<u32>>;

impl DeformableModel {
    /// The nodes of a selection, ascending, each once.
    ///
    /// # Errors
    ///
    /// [`FemError`] if a number is not finite or out of its range, a node or a named set does not exist, or
    /// nothing is selected.
    pub fn select(&self, selection: &Selection, sets: &NodeSets) -> Result<Vec<u32>, FemError> {
        let mut nodes = match selection {
            Selection::All => self.select_by(|_| true),
            Selection::Skin => self.faces().concat(),
            Selection::Nodes(nodes) => nodes.clone(),
            Selection::Named(name) => {
                let set = sets.get(name);
                let set = set.ok_or_else(|| FemError::NoSuchSet { name: name.clone() })?;
                set.clone()
            }
            Selection::Box { lower, upper } => {
                let sizes = upper - lower;
                check(
                    "upper - lower of a box",
                    sizes.min(),
                    sizes.min() >= 0.0,
                    "0 or more, in m",
                )?;
                self.select_by(|x| (0..3).all(|i| x[i] >= lower[i] && x[i] <= upper[i]))
            }
            Selection::Plane {
                normal,
                offset,
                tolerance,
            } => {
                let length = normal.norm();
                check(
                    "length of a plane's normal",
                    length,
                    length > 0.0,
                    "above 0",
                )?;
                check("offset of a plane", *offset, true, "finite, in m")?;
                check(
                    "tolerance",
                    *tolerance,
                    *tolerance >= 0.0,
                    "0 or more, in m",
                )?;
                let unit = normal / length;
                self.select_by(|x| (unit.dot(x) - offset).abs() <= *tolerance)
            }
            Selection::Sphere { centre, radius } => {
                check("centre of a sphere", centre.norm(), true, "finite, in m")?;
                check(
                    "radius of a sphere",
                    *radius,
                    *radius >= 0.0,
                    "0 or more, in m",
                )?;
                self.select_by(|x| (x - centre).norm() <= *radius)
            }
        };
        nodes.sort_unstable();
        nodes.dedup();
        let count = self.nodes().len();
        match nodes.last() {
            Some(&node) if node as usize >= count => Err(FemError::NoSuch {
                what: "node",
                index: node as usize,
                count,
            }),
            Some(_) => Ok(nodes),
            None => Err(FemError::NothingSelected {
                selection: format!("{selection:?}"),
            }),
        }
    }

    /// The nodes whose reference place (m) fulfils a condition, ascending.
    pub fn select_by(&self, condition: impl Fn(&Vector3) -> bool) -> Vec<u32> {
        let nodes = self.nodes().iter().enumerate();
        let chosen = nodes.filter(|(_, x)| condition(x));
        chosen.map(|(i, _)| i as u32).collect()
    }

    /// The faces of the skin whose nodes are all among `nodes` (ascending).
    pub(super) fn faces_of(&self, nodes: &[u32]) -> Vec<Vec<u32>> {
        let chosen = |node: &u32| nodes.binary_search(node).is_ok();
        let faces = self.faces().into_iter();
        faces.filter(|face| face.iter().all(chosen)).collect()
    }

    /// The nodes of the skin's faces: three corners, counter-clockwise seen from outside, then the
    /// middles of the sides 0-1, 1-2, 2-0 where the element has nodes there.
    #[must_use]
    pub fn faces(&self) -> Vec<Vec<u32>> {
        let corners = self.mesh().points().len();
        let middle = |a: u32, b: u32| {
            let (edges, edge) = (self.mid_edges(), [a.min(b), a.max(b)]);
            let place = edges.partition_point(|x| *x < edge);
            debug_assert_eq!(edges.get(place), Some(&edge), "an edge of the mesh");
            (corners + place) as u32
        };
        let skin = self.mesh().skin().iter();
        if self.element().is_quadratic() {
            skin.map(|&[a, b, c]| vec![a, b, c, middle(a, b), middle(b, c), middle(c, a)])
                .collect()
        } else {
            skin.map(|face| face.to_vec()).collect()
        }
    }
}
