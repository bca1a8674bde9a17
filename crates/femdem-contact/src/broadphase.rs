//! Candidate pairs: a grid over inflated bounding boxes, refreshed body by body.
//!
//! Each body keeps the box it had when it was last entered, inflated by half a skin. It is
//! entered again once the bound of its travel, rotation included, exceeds that half skin;
//! bodies that do not move cost nothing.

use crate::motion::Motion;
use crate::shape::BodyShape;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Skin over bounding radius.
const SKIN: f64 = 0.1;

type Cell = [i32; 3];

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Entry {
    low: Vector3,
    high: Vector3,
    centre: Vector3,
    /// Bounding radius plus half the skin, m.
    reach: f64,
    cell: Cell,
    /// `Motion::travelled` at which the entry expires, m.
    expires: f64,
}

/// The grid and the entries.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Broadphase {
    size: f64,
    entries: Vec<Option<Entry>>,
    cells: BTreeMap<Cell, Vec<u32>>,
}

impl Broadphase {
    /// Whether the body must be entered (again).
    pub(crate) fn is_expired(&self, body: usize, motion: &Motion) -> bool {
        match self.entries.get(body) {
            Some(Some(entry)) => motion.travelled >= entry.expires,
            _ => true,
        }
    }

    /// Whether a body was ever entered.
    pub(crate) fn knows(&self, body: usize) -> bool {
        matches!(self.entries.get(body), Some(Some(_)))
    }

    /// Half skin of a shape, m: how far a body may travel before it is entered again.
    pub(crate) fn half_skin(shape: &BodyShape) -> f64 {
        0.5 * SKIN * shape.radius()
    }

    /// Enters a body at its current place.
    pub(crate) fn enter(&mut self, body: usize, shape: &BodyShape, motion: &Motion) {
        let half_skin = Self::half_skin(shape);
        let reach = shape.radius() + half_skin;
        if 2.0 * reach > self.size {
            self.resize(2.0 * reach);
        }
        if self.entries.len() <= body {
            self.entries.resize(body + 1, None);
        }
        let centre = motion.frame.position;
        let (low, high) = shape.bounds(&motion.frame.rotation);
        let cell = cell_of(&centre, self.size);
        if let Some(old) = self.entries[body].as_ref().map(|e| e.cell)
            && old != cell
        {
            remove(&mut self.cells, &old, body as u32);
        }
        let members = self.cells.entry(cell).or_default();
        if !members.contains(&(body as u32)) {
            members.push(body as u32);
        }
        self.entries[body] = Some(Entry {
            low: (low + centre).add_scalar(-half_skin),
            high: (high + centre).add_scalar(half_skin),
            centre,
            reach,
            cell,
            expires: motion.travelled + half_skin,
        });
    }

    /// Bodies whose inflated boxes and spheres meet those of `body`, sorted.
    pub(crate) fn neighbours(&self, body: usize, out: &mut Vec<u32>) {
        out.clear();
        let Some(Some(entry)) = self.entries.get(body) else {
            return;
        };
        let [x, y, z] = entry.cell;
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let cell = [
                        x.saturating_add(dx),
                        y.saturating_add(dy),
                        z.saturating_add(dz),
                    ];
                    if let Some(members) = self.cells.get(&cell) {
                        out.extend(members.iter().filter(|&&j| self.meet(entry, body, j)));
                    }
                }
            }
        }
        out.sort_unstable();
        out.dedup();
    }

    fn meet(&self, entry: &Entry, body: usize, other: u32) -> bool {
        let Some(Some(e)) = self.entries.get(other as usize) else {
            return false;
        };
        let reach = entry.reach + e.reach;
        other as usize != body
            && (0..3).all(|k| entry.low[k] <= e.high[k] && e.low[k] <= entry.high[k])
            && (entry.centre - e.centre).norm_squared() <= reach * reach
    }

    /// Changes the cell size; only when a larger body than any before comes.
    fn resize(&mut self, size: f64) {
        self.size = size;
        self.cells.clear();
        for (i, entry) in self.entries.iter_mut().enumerate() {
            if let Some(e) = entry {
                e.cell = cell_of(&e.centre, size);
                self.cells.entry(e.cell).or_default().push(i as u32);
            }
        }
    }
}

/// The grid cell of a point. Far points share the outermost cells (the cast saturates).
fn cell_of(x: &Vector3, size: f64) -> Cell {
    [0, 1, 2].map(|k| (x[k] / size).floor() as i32)
}

fn remove(cells: &mut BTreeMap<Cell, Vec<u32>>, cell: &Cell, body: u32) {
    if let Some(members) = cells.get_mut(cell) {
        members.retain(|&j| j != body);
        if members.is_empty() {
            cells.remove(cell);
        }
    }
}
