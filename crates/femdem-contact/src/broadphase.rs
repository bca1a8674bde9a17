//! Candidate pairs: grids over inflated bounding boxes, refreshed body by body.
//!
//! Each body, rigid or deformable, keeps its bounding box of the time when it was last entered, inflated by half a skin. It is
//! entered again once the bound of the travel of its points exceeds that half skin; bodies that do not
//! move cost nothing.
//!
//! Bodies whose sizes differ by less than four to one share a grid, whose cell size is set by the largest of
//! them. So a drum around ten thousand pellets does not put them all into one cell.
//!
//! In periodic space an entry is the image in the cell at the origin. The path of the edges that lead to it, and the strain of
//! space over the way to the images beside it, count as travel of the body.

use crate::body_shape::BodyShape;
use crate::periodic::Space;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Skin over bounding radius.
const SKIN: f64 = 0.1;

/// Relative widening of the half-width of a range of cells, so that rounding leaves no cell out.
const SLACK: f64 = 1e-9;

type Cell = [i32; 3];

/// Index of a size class; sizes within a class differ by less than four to one.
type Level = u16;

/// The place and the size of a body.
#[derive(Debug, Clone)]
pub(crate) struct Extent {
    /// Corners of its box, m.
    pub low: Vector3,
    pub high: Vector3,
    /// No point is farther than `radius` (m) from here, m.
    pub centre: Vector3,
    pub radius: f64,
    /// Half of the gap over which it may attract others, m.
    pub margin: f64,
    /// Running bound of the travel of its points, m.
    pub travelled: f64,
}

/// Where a body is looked for.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Entry {
    low: Vector3,
    high: Vector3,
    centre: Vector3,
    /// Bounding radius plus half the skin and the margin, m.
    reach: f64,
    level: Level,
    cell: Cell,
    /// In periodic space: by how many edges this is away from the place of the body.
    image: [i32; 3],
    /// Largest distance between images that may meet, m.
    lever: f64,
    /// [Travel](Self::travel) at which the entry expires, m.
    expires: f64,
}

/// Images that may meet are at most this many diagonals of the cell apart, until the entry expires.
const DIAGONALS: f64 = 2.0;

impl Entry {
    /// How far a body has travelled, against the images that may meet it, m.
    fn travel(&self, travelled: f64, space: Option<&Space>) -> f64 {
        let carried = space.map_or(0.0, |space| {
            space.path(self.image) + self.lever * space.strain
        });
        travelled + carried
    }
}

/// The bodies of a level, by cell.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Grid {
    /// Side of a cell, m: twice the largest reach.
    size: f64,
    cells: BTreeMap<Cell, Vec<u32>>,
}

/// The grids and the entries.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Broadphase {
    entries: Vec<Option<Entry>>,
    grids: BTreeMap<Level, Grid>,
    /// Half of the gap over which balls may attract each other, m.
    margin: f64,
}

impl Broadphase {
    /// Whether the body must be entered (again) at the travel `travelled`, m.
    pub(crate) fn is_expired(&self, body: usize, travelled: f64, space: Option<&Space>) -> bool {
        match self.entries.get(body) {
            Some(Some(entry)) => entry.travel(travelled, space) >= entry.expires,
            _ => true,
        }
    }

    /// Whether a body has ever been entered.
    pub(crate) fn knows(&self, body: usize) -> bool {
        matches!(self.entries.get(body), Some(Some(_)))
    }

    /// Whether a body was never entered, or must be entered again wherever it is.
    pub(crate) fn is_out_of_date(&self, body: usize) -> bool {
        self.is_expired(body, f64::NEG_INFINITY, None)
    }

    /// Balls may attract each other over a gap up to `range`, m. Returns whether all bodies must be entered again.
    pub(crate) fn set_range(&mut self, range: f64) -> bool {
        let margin = 0.5 * range;
        if margin == self.margin {
            return false;
        }
        self.margin = margin;
        for entry in self.entries.iter_mut().flatten() {
            entry.expires = f64::NEG_INFINITY;
        }
        true
    }

    /// Half of the gap over which a shape may attract others, m.
    pub(crate) fn margin(&self, shape: &BodyShape) -> f64 {
        if shape.sphere().is_some() {
            self.margin
        } else {
            0.0
        }
    }

    /// Whether all entries are of bodies that are there.
    pub(crate) fn fits(&self, is_body: impl Fn(u32) -> bool) -> bool {
        let cells = self.grids.values().flat_map(|grid| grid.cells.values());
        let entries = (0..).zip(&self.entries);
        let mut entered = entries.filter_map(|(i, entry)| entry.as_ref().map(|_| i));
        entered.all(&is_body)
            && cells
                .flatten()
                .all(|&i| is_body(i) && self.knows(i as usize))
    }

    /// Takes a body out: it must be entered before others find it again.
    pub(crate) fn forget(&mut self, body: usize) {
        let Some(entry) = self.entries.get_mut(body).and_then(Option::take) else {
            return;
        };
        if let Some(grid) = self.grids.get_mut(&entry.level) {
            grid.remove(&entry.cell, body as u32);
        }
    }

    /// The entry of a body, without its cell, which is that of this grid.
    pub(crate) fn entry(&self, body: usize) -> Option<Entry> {
        let entry = self.entries.get(body).cloned().flatten();
        let cell = Cell::default();
        entry.map(|entry| Entry { cell, ..entry })
    }

    /// Takes all bodies out.
    pub(crate) fn clear(&mut self) {
        self.entries.clear();
        self.grids.clear();
    }

    /// Enters a body that has no entry as it was entered elsewhere.
    pub(crate) fn adopt(&mut self, body: usize, mut entry: Entry) {
        let grid = self.grids.entry(entry.level).or_default();
        if 2.0 * entry.reach > grid.size {
            grid.resize(2.0 * entry.reach, entry.level, &mut self.entries);
        }
        entry.cell = cell_of(&entry.centre, grid.size);
        grid.cells.entry(entry.cell).or_default().push(body as u32);
        if self.entries.len() <= body {
            self.entries.resize(body + 1, None);
        }
        self.entries[body] = Some(entry);
    }

    /// Half skin of a body of a radius, m: how far its points may travel before it must be entered again.
    pub(crate) fn half_skin(radius: f64) -> f64 {
        0.5 * SKIN * radius
    }

    /// Enters a body at its current place.
    pub(crate) fn enter(&mut self, body: usize, extent: &Extent, space: Option<&Space>) {
        let half_skin = Self::half_skin(extent.radius);
        let level = level_of(2.0 * (extent.radius + half_skin));
        let reach = extent.radius + half_skin + extent.margin;
        let grid = self.grids.entry(level).or_default();
        if 2.0 * reach > grid.size {
            grid.resize(2.0 * reach, level, &mut self.entries);
        }
        let size = grid.size;
        if self.entries.len() <= body {
            self.entries.resize(body + 1, None);
        }
        let place = extent.centre;
        let (image, centre) = space.map_or(([0; 3], place), |space| space.cell.split(&place));
        let (cell, away) = (cell_of(&centre, size), centre - place);
        let old = self.entries[body].as_ref().map(|e| (e.level, e.cell));
        if old != Some((level, cell)) {
            self.forget(body);
            let grid = self.grids.entry(level).or_default();
            grid.cells.entry(cell).or_default().push(body as u32);
        }
        let mut entry = Entry {
            low: (extent.low + away).add_scalar(-half_skin - extent.margin),
            high: (extent.high + away).add_scalar(half_skin + extent.margin),
            centre,
            reach,
            level,
            cell,
            image,
            lever: space.map_or(0.0, |space| DIAGONALS * space.cell.diagonal()),
            expires: 0.0,
        };
        entry.expires = entry.travel(extent.travelled, space) + half_skin;
        self.entries[body] = Some(entry);
    }

    /// Bodies whose inflated boxes and spheres, or those of their images, meet those of `body`, sorted.
    pub(crate) fn neighbours(&self, body: usize, space: Option<&Space>, out: &mut Vec<u32>) {
        out.clear();
        let Some(Some(entry)) = self.entries.get(body) else {
            return;
        };
        match space {
            Some(space) => {
                let grids = self.grids.values();
                let largest = grids.map(|grid| 0.5 * grid.size).fold(0.0, f64::max);
                space.beside(&entry.centre, entry.reach + largest, |away| {
                    self.around(entry, body, away, out);
                });
            }
            None => self.around(entry, body, &Vector3::zeros(), out),
        }
        out.sort_unstable();
        out.dedup();
    }

    /// Adds the bodies near an image of an entry.
    fn around(&self, entry: &Entry, body: usize, away: &Vector3, out: &mut Vec<u32>) {
        let centre = entry.centre + away;
        for grid in self.grids.values() {
            // No body of the grid reaches farther than half a cell.
            grid.visit(&centre, entry.reach + 0.5 * grid.size, |members| {
                out.extend(members.iter().filter(|&&j| self.meet(entry, away, body, j)));
            });
        }
    }

    fn meet(&self, entry: &Entry, away: &Vector3, body: usize, other: u32) -> bool {
        let Some(Some(e)) = self.entries.get(other as usize) else {
            return false;
        };
        let reach = entry.reach + e.reach;
        other as usize != body
            && (0..3)
                .all(|k| entry.low[k] + away[k] <= e.high[k] && e.low[k] <= entry.high[k] + away[k])
            && (entry.centre + away - e.centre).norm_squared() <= reach * reach
    }
}

impl Grid {
    /// Calls `f` with the bodies of every cell that a box of the half-width `span` (m) about `centre` meets.
    fn visit(&self, centre: &Vector3, span: f64, mut f: impl FnMut(&[u32])) {
        let span = span * (1.0 + SLACK);
        let low = cell_of(&centre.add_scalar(-span), self.size);
        let high = cell_of(&centre.add_scalar(span), self.size);
        let count: f64 = (0..3)
            .map(|k| f64::from(high[k]) - f64::from(low[k]) + 1.0)
            .product();
        // A large body among small ones: its range spans more cells than are in use.
        if count > self.cells.len() as f64 {
            for (cell, members) in &self.cells {
                if (0..3).all(|k| low[k] <= cell[k] && cell[k] <= high[k]) {
                    f(members);
                }
            }
            return;
        }
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                let row = self.cells.range([x, y, low[2]]..=[x, y, high[2]]);
                row.for_each(|(_, members)| f(members));
            }
        }
    }

    /// Changes the cell size. Happens only when a body larger than all earlier ones of the level is entered.
    fn resize(&mut self, size: f64, level: Level, entries: &mut [Option<Entry>]) {
        self.size = size;
        self.cells.clear();
        for (i, entry) in entries.iter_mut().enumerate() {
            if let Some(e) = entry
                && e.level == level
            {
                e.cell = cell_of(&e.centre, size);
                self.cells.entry(e.cell).or_default().push(i as u32);
            }
        }
    }

    fn remove(&mut self, cell: &Cell, body: u32) {
        if let Some(members) = self.cells.get_mut(cell) {
            members.retain(|&j| j != body);
            if members.is_empty() {
                self.cells.remove(cell);
            }
        }
    }
}

/// The level of a size, m: half its binary exponent.
fn level_of(size: f64) -> Level {
    (size.to_bits() >> 53) as Level
}

/// The grid cell of a point. Far points share the outermost cells (the cast saturates).
fn cell_of(x: &Vector3, size: f64) -> Cell {
    [0, 1, 2].map(|k| (x[k] / size).floor() as i32)
}
