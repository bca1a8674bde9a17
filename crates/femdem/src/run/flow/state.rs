//! What comes, goes and is counted, as plain data.

use femdem_contact::MaterialId;
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Pose, Rotation, Vector3};
use femdem_pack::{body_stream, random_rotation, uniform};
use femdem_solve::ShapeId;
use serde::{Deserialize, Serialize};

/// A whole number of bodies is not lost to rounding.
pub(super) const WHOLE: f64 = 1e-9;

/// What comes, goes and is counted in a simulation, and which walls open.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    pub(super) openings: Vec<Opening>,
    pub(super) gates: Vec<Gate>,
    pub(in crate::run) supplies: Vec<Supply>,
}

/// A wall that is taken away at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Opening {
    /// Number in the world.
    pub(super) wall: u32,
    /// s.
    pub(super) time: f64,
}

/// A place that bodies pass, in one direction or in the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gate {
    pub(super) name: String,
    /// Whether bodies leave there.
    pub(super) takes: bool,
    /// Unit normals and offsets \[m\]; what is below any of these is beyond.
    pub(super) planes: Vec<([f64; 3], f64)>,
    pub(super) passed: Count,
    /// Of each member, whether it is beyond.
    pub(super) beyond: Vec<bool>,
}

/// What has passed so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Count {
    pub(super) bodies: i64,
    /// kg.
    pub(super) mass: f64,
    /// Mass \[kg\] and time \[s\] of the last row.
    pub(super) last: [f64; 2],
    /// Time of the first passage \[s\] and the mass of its step \[kg\].
    first: Option<[f64; 2]>,
    /// Time of the latest passage \[s\].
    latest: f64,
}

impl Count {
    /// Counts bodies of a mass \[kg\] that pass at a time \[s\].
    pub(super) fn add(&mut self, bodies: i64, mass: f64, time: f64) {
        let passed = bodies as f64 * mass;
        self.bodies += bodies;
        self.mass += passed;
        self.latest = time;
        let [first, at_first] = self.first.get_or_insert([time, 0.0]);
        if *first == time {
            *at_first += passed;
        }
    }

    /// Mass over time from the first passage to the latest \[kg/s\]; `None` while there are no two.
    pub(super) fn mean_rate(&self) -> Option<f64> {
        let [first, at_first] = self.first?;
        let time = self.latest - first;
        (time > 0.0).then(|| (self.mass - at_first) / time)
    }
}

impl Gate {
    pub(super) fn is_beyond(&self, x: &Vector3) -> bool {
        let below = |(normal, offset): &([f64; 3], f64)| Vector3::from(*normal).dot(x) < *offset;
        self.planes.iter().any(below)
    }
}

impl Flow {
    /// How many members a gate knows of, if they are not as many as there are.
    pub(in crate::run) fn misfit(&self, members: usize) -> Option<usize> {
        let mut known = self.gates.iter().map(|gate| gate.beyond.len());
        known.find(|known| *known != members)
    }

    /// The number of a source without a kind of bodies or with a shape that is none of so many.
    pub(in crate::run) fn misfit_source(&self, shapes: usize) -> Option<usize> {
        let mut supplies = self.supplies.iter();
        let unknown = |kind: &Kind| kind.shape as usize >= shapes;
        supplies.position(|supply| supply.kinds.is_empty() || supply.kinds.iter().any(unknown))
    }

    /// Corners of all boxes in which bodies come \[m\].
    pub(in crate::run) fn all_boxes(&self) -> impl Iterator<Item = [Vector3; 2]> {
        let boxes = self.supplies.iter();
        boxes.map(|supply| [supply.lower.into(), supply.upper.into()])
    }

    /// Whether there is anything to be counted.
    pub(in crate::run) fn is_counted(&self) -> bool {
        !(self.gates.is_empty() && self.supplies.is_empty())
    }

    /// Whether bodies pass anything.
    pub(super) fn has_gates(&self) -> bool {
        !self.gates.is_empty()
    }

    /// Mass of the bodies that are still to come \[kg\].
    pub(in crate::run) fn mass_to_come(&self) -> f64 {
        self.supplies.iter().map(Supply::mass_to_come).sum()
    }

    /// Bodies that sources have brought.
    pub(in crate::run) fn come(&self) -> u64 {
        let come = self.supplies.iter();
        come.map(|supply| supply.come.bodies as u64).sum()
    }

    /// Bodies that sources will have brought by a time \[s\], if there is room.
    pub(in crate::run) fn due(&self, time: f64) -> u64 {
        self.supplies.iter().map(|supply| supply.due(time)).sum()
    }

    /// Corners of the boxes in which bodies are still to come \[m\].
    pub(in crate::run) fn boxes(&self) -> impl Iterator<Item = [Vector3; 2]> {
        let open = self.supplies.iter().filter(|s| s.mass_to_come() > 0.0);
        open.map(|supply| [supply.lower.into(), supply.upper.into()])
    }

    /// What has passed each gate and come from each source so far.
    fn counts(&mut self) -> impl Iterator<Item = &mut Count> {
        let gates = self.gates.iter_mut().map(|gate| &mut gate.passed);
        gates.chain(self.supplies.iter_mut().map(|supply| &mut supply.come))
    }

    /// Becomes a later state of itself, in which there were no rows since.
    pub(super) fn go_on_as(&mut self, later: &Self) {
        let mut before = std::mem::replace(self, later.clone());
        for (count, before) in self.counts().zip(before.counts()) {
            count.last = before.last;
        }
    }

    /// Whether a wall is still to open after a time \[s\], or a body to come.
    pub(in crate::run) fn is_to_come(&self, time: f64) -> bool {
        let closed = self.openings.iter().any(|opening| opening.time > time);
        closed || !self.supplies.iter().all(Supply::is_done)
    }
}

/// A source in progress.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Supply {
    pub name: String,
    /// By rising size; at least one.
    pub kinds: Vec<Kind>,
    pub density: f64,
    pub material: MaterialId,
    /// Corners of the box for the centroids \[m\].
    pub lower: [f64; 3],
    pub upper: [f64; 3],
    /// Places of the bodies one after another \[m\], instead of any in the box.
    pub(super) places: Vec<[f64; 3]>,
    /// m/s.
    pub velocity: [f64; 3],
    /// 1/s.
    pub(super) rate: f64,
    /// Bodies in all.
    pub most: u64,
    /// Mass that they do not exceed \[kg\].
    pub(super) largest_mass: f64,
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) seed: u64,
    /// Places tried so far.
    pub(super) tried: u32,
    pub(super) come: Count,
}

/// Bodies of one size of a source.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kind {
    pub shape: ShapeId,
    /// Mass of one \[kg\].
    pub mass: f64,
    /// Distance of the farthest point from the centroid \[m\].
    pub radius: f64,
    /// Part of the bodies that are of this size.
    pub part: f64,
    /// Bodies of this size that have come.
    pub come: u64,
}

impl Supply {
    /// The number of the kind of the next body: that whose bodies lag most behind their part of all. At any time each kind is
    /// within a body of its part, however many are still to come.
    pub(super) fn next_kind(&self) -> usize {
        let all = self.come.bodies as f64 + 1.0;
        let lag = |kind: &Kind| all * kind.part - kind.come as f64;
        let mut next = 0;
        for (k, kind) in self.kinds.iter().enumerate() {
            if lag(kind) > lag(&self.kinds[next]) {
                next = k;
            }
        }
        next
    }

    /// Mean mass of its bodies \[kg\].
    pub(super) fn mean_mass(&self) -> f64 {
        self.kinds.iter().map(|kind| kind.part * kind.mass).sum()
    }

    /// Mass that may still come \[kg\].
    fn mass_left(&self) -> f64 {
        self.largest_mass - self.come.mass
    }

    /// Number of bodies that should have come by a time \[s\].
    pub(super) fn due(&self, time: f64) -> u64 {
        if self.is_done() {
            return self.come.bodies as u64;
        }
        let due = self.rate * (time.min(self.end) - self.start) + WHOLE;
        // A negative number becomes 0.
        (due as u64).min(self.most)
    }

    /// Whether all its bodies have come.
    pub fn is_done(&self) -> bool {
        let next = self.kinds[self.next_kind()].mass;
        self.come.bodies as u64 >= self.most || next > self.mass_left() + WHOLE * next
    }

    /// Mass of the bodies that are still to come \[kg\].
    pub fn mass_to_come(&self) -> f64 {
        if self.is_done() {
            return 0.0;
        }
        let left = self.most.saturating_sub(self.come.bodies as u64);
        (left as f64 * self.mean_mass()).min(self.mass_left())
    }

    /// The next place to be tried: a centroid and an orientation.
    pub(super) fn next_place(&mut self) -> Pose {
        let (drawn, turn) = self.drawn(self.tried);
        self.tried = self.tried.wrapping_add(1);
        let place = self.places.get(self.come.bodies as usize).copied();
        Pose::from_parts(Translation3::from(place.unwrap_or(drawn)), turn)
    }

    /// The place in the box \[m\] and the orientation that are drawn after so many.
    fn drawn(&self, tried: u32) -> ([f64; 3], Rotation) {
        let mut stream = body_stream(self.seed, tried);
        let share = [0, 1, 2].map(|_| uniform(&mut stream));
        let within = |k: usize| self.lower[k] + share[k] * (self.upper[k] - self.lower[k]);
        ([0, 1, 2].map(within), random_rotation(&mut stream))
    }

    /// All places that may be [tried](Self::next_place) in so many tries \[m\].
    pub(super) fn places_ahead(&self, tries: u32) -> Vec<Vector3> {
        let drawn = (0..tries).map(|k| self.drawn(self.tried.wrapping_add(k)).0);
        let listed = self.places.iter().skip(self.come.bodies as usize);
        let listed = listed.take(tries as usize).copied();
        drawn.chain(listed).map(Vector3::from).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bodies at once, one a second later that goes back, and one after another second.
    #[test]
    fn the_mean_rate_is_that_after_the_first_passage() {
        let mut count = Count::default();
        count.add(1, 2.0, 3.0);
        count.add(1, 2.0, 3.0);
        assert_eq!(count.mean_rate(), None);
        count.add(-1, 2.0, 4.0);
        count.add(1, 5.0, 5.0);
        assert_eq!((count.bodies, count.mass), (2, 7.0));
        assert_eq!(count.mean_rate(), Some(1.5));
    }
}
