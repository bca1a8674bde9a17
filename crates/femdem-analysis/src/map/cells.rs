//! Contributions of each body and each overlap to the cells of a grid.

use femdem_mesh::{Point3, Vector3};

use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::clip::Clipper;
use crate::neighbours::neighbour_pairs;
use crate::ordered::ordered_map;
use crate::overlap::{Pair, Scratch, load_shared, measure_pairs, shared_volume};
use crate::pack::Pack;
use crate::region::{Region, Relation};

/// Solid volume (m³) in a cell.
type Deposit = (usize, f64);

/// A surface, its slices by x, their parts by y, and theirs by z.
type Stack = [Clipper; 4];

/// The cells of a grid over the box around a region.
pub(super) struct Cells {
    pub(super) region: Region,
    pub(super) axes: [Axis; 3],
}

impl Cells {
    fn len(&self) -> usize {
        self.axes.iter().map(|a| a.count).product()
    }

    fn index(&self, at: [usize; 3]) -> usize {
        let [x, y, _] = &self.axes;
        (at[2] * y.count + at[1]) * x.count + at[0]
    }

    fn place(&self, i: usize) -> [usize; 3] {
        let [x, y, _] = &self.axes;
        [i % x.count, i / x.count % y.count, i / (x.count * y.count)]
    }

    fn bounds(&self, at: [usize; 3]) -> Bounds {
        let corner = |step| Point3::from([0, 1, 2].map(|k| self.axes[k].edge(at[k] + step)));
        Bounds {
            min: corner(0),
            max: corner(1),
        }
    }

    /// The bootstrap's block that contains cell `i`: at most 8 along each axis, of width `side` or more.
    pub(super) fn block_of(&self, i: usize, side: f64) -> usize {
        let at = self.place(i);
        let along = |k: usize| {
            let axis = &self.axes[k];
            let extent = axis.step * axis.count as f64;
            let blocks = (extent / side + 1e-9).floor().clamp(1.0, 8.0) as usize;
            at[k] * blocks / axis.count
        };
        (along(2) * 8 + along(1)) * 8 + along(0)
    }

    /// Volume of every cell's part inside the region.
    pub(super) fn volumes(&self) -> Vec<f64> {
        ordered_map(self.len(), Clipper::default, |clipper, i| {
            let bounds = self.bounds(self.place(i));
            match self.region.relation(&bounds) {
                Relation::Inside => (bounds.max - bounds.min).product(),
                Relation::Outside => 0.0,
                Relation::Crosses => {
                    clipper.load_box(&bounds);
                    clipper.volume_in(&self.region)
                }
            }
        })
    }

    /// All deposits, in the order of the bodies and then of the overlaps, which are negative.
    pub(super) fn deposits(&self, pack: &Pack) -> Vec<Vec<Deposit>> {
        let members: Vec<usize> = (0..pack.len())
            .filter(|&i| self.region.relation(pack.bounds(i)) != Relation::Outside)
            .collect();
        let mut deposits = ordered_map(members.len(), Stack::default, |stack, k| {
            let body = members[k];
            stack[0].load(pack.shape(body), pack.pose(body));
            self.split(stack)
        });
        let pairs = measure_pairs(pack, &neighbour_pairs(pack, &members), Some(&self.region));
        let memory = || (Scratch::default(), Stack::default());
        deposits.extend(ordered_map(pairs.len(), memory, |(scratch, stack), k| {
            let mut shared = match load_shared(scratch, pack, pairs[k].0) {
                Some(surface) => {
                    stack[0].copy_from(surface);
                    self.split(stack)
                }
                None => self.shared_in_cells(scratch, pack, pairs[k].0),
            };
            shared.iter_mut().for_each(|(_, volume)| *volume = -*volume);
            shared
        }));
        deposits
    }

    /// Cuts the surface in `stack[0]` by the cells.
    fn split(&self, stack: &mut Stack) -> Vec<Deposit> {
        let mut found = Vec::new();
        self.split_along(0, [0; 3], stack, &mut found);
        found
    }

    fn split_along(
        &self,
        k: usize,
        mut at: [usize; 3],
        stack: &mut [Clipper],
        found: &mut Vec<Deposit>,
    ) {
        let Some((rest, slices)) = stack.split_first_mut() else {
            return;
        };
        if rest.is_empty() {
            return;
        }
        let Some(axis) = self.axes.get(k) else {
            let volume = match self.region.relation(&self.bounds(at)) {
                Relation::Inside => rest.volume(),
                Relation::Outside => 0.0,
                Relation::Crosses => rest.volume_in(&self.region),
            };
            found.push((self.index(at), volume));
            return;
        };
        let mut up = Vector3::zeros();
        up[k] = 1.0;
        let bounds = rest.bounds();
        let cells = axis.meeting(bounds.min[k], bounds.max[k]);
        rest.clip(&-up, -axis.edge(cells.start));
        for i in cells {
            at[k] = i;
            let edge = axis.edge(i + 1);
            if let Some(slice) = slices.first_mut() {
                slice.copy_from(rest);
                slice.clip(&up, edge);
            }
            rest.clip(&-up, -edge);
            self.split_along(k + 1, at, slices, found);
        }
    }

    /// For a pair of which neither body is handled by its planes.
    fn shared_in_cells(&self, scratch: &mut Scratch, pack: &Pack, pair: Pair) -> Vec<Deposit> {
        let common = pack.bounds(pair.0).clamped_to(pack.bounds(pair.1));
        let middle = common.middle_and_half().0;
        let is_round = !matches!(self.region, Region::Box { .. });
        if is_round && !self.region.contains(&middle) {
            return Vec::new();
        }
        let [x, y, z] = [0, 1, 2].map(|k| self.axes[k].meeting(common.min[k], common.max[k]));
        let mut found = Vec::new();
        for at in z.flat_map(|c| {
            let x = x.clone();
            y.clone()
                .flat_map(move |b| x.clone().map(move |a| [a, b, c]))
        }) {
            let Bounds { min, max } = self.bounds(at);
            let cell = Region::Box { min, max };
            let volume = shared_volume(scratch, pack, pair, Some(&cell));
            found.push((self.index(at), volume));
        }
        found
    }
}
