//! Forces of blocks.

use super::super::lanes::{LANES, Lanes, Row, cross, dot};
use super::super::log::ln;
use super::{Block, Node, Task};
#[cfg(feature = "parallel")]
use femdem_mesh::Vector3;

/// Destination of forces.
pub(super) trait Target {
    fn place(&self, node: u32) -> &Row;
    fn add<S: Lanes>(&mut self, l: S, slot: usize, node: u32, force: S::F);
}

/// To the nodes.
impl Target for [Node] {
    #[inline(always)]
    fn place(&self, node: u32) -> &Row {
        &self[node as usize].place
    }

    #[inline(always)]
    fn add<S: Lanes>(&mut self, l: S, _slot: usize, node: u32, force: S::F) {
        let sum = &mut self[node as usize].force;
        *sum = l.store(l.add(l.load(sum), force));
    }
}

/// To a slot per corner of each element, for nodes that other threads add to as well.
#[cfg(feature = "parallel")]
pub(super) struct Slots<'a> {
    pub nodes: &'a [Node],
    pub slots: &'a mut [Vector3],
}

#[cfg(feature = "parallel")]
impl Target for Slots<'_> {
    #[inline(always)]
    fn place(&self, node: u32) -> &Row {
        &self.nodes[node as usize].place
    }

    #[inline(always)]
    fn add<S: Lanes>(&mut self, l: S, slot: usize, _node: u32, force: S::F) {
        let Row([x, y, z, _]) = l.store(force);
        if let Some(place) = self.slots.get_mut(slot) {
            *place = Vector3::new(x, y, z);
        }
    }
}

/// Adds forces to a target.
pub(super) struct Forces<'a, T: Target + ?Sized> {
    pub blocks: &'a [Block],
    pub target: &'a mut T,
}

impl<T: Target + ?Sized> Task for Forces<'_, T> {
    type Output = bool;

    /// Processes two blocks at a time, so that one computes while the other waits for its divisions.
    #[inline(always)]
    fn run<S: Lanes>(self, l: S) -> bool {
        let target = self.target;
        let mut check = l.all(0.0);
        let (pairs, rest) = self.blocks.as_chunks::<2>();
        for (k, [a, b]) in pairs.iter().enumerate() {
            let (in_a, in_b) = (a.shape(l, target), b.shape(l, target));
            let (of_a, of_b) = (a.volumetric(l, in_a.j), b.volumetric(l, in_b.j));
            check = l.add(check, l.mul(l.add(of_a, of_b), l.all(0.0)));
            a.spread(l, &in_a, of_a, 8 * LANES * k, target);
            b.spread(l, &in_b, of_b, 8 * LANES * k + 4 * LANES, target);
        }
        for a in rest {
            let shape = a.shape(l, target);
            let volumetric = a.volumetric(l, shape.j);
            check = l.add(check, l.mul(volumetric, l.all(0.0)));
            a.spread(l, &shape, volumetric, 8 * LANES * pairs.len(), target);
        }
        l.store(check).0 == [0.0; LANES]
    }
}

/// Edges at corner 0, by columns, their cofactors, and the volume ratio.
struct Shape<F> {
    edges: [[F; 3]; 3],
    cofactor: [[F; 3]; 3],
    j: F,
}

impl Block {
    #[inline(always)]
    fn shape<S: Lanes>(&self, l: S, target: &(impl Target + ?Sized)) -> Shape<S::F> {
        let origin = corner(l, target, &self.nodes[0]);
        let a = difference(l, &corner(l, target, &self.nodes[1]), &origin);
        let b = difference(l, &corner(l, target, &self.nodes[2]), &origin);
        let c = difference(l, &corner(l, target, &self.nodes[3]), &origin);
        let first = cross(l, &b, &c);
        let j = l.mul(dot(l, &a, &first), l.load(&self.inverse_determinant));
        Shape {
            cofactor: [first, cross(l, &c, &a), cross(l, &a, &b)],
            edges: [a, b, c],
            j,
        }
    }

    /// (mu - lambda ln J)/(6 J); NaN where an element is inverted.
    #[inline(always)]
    fn volumetric<S: Lanes>(&self, l: S, j: S::F) -> S::F {
        let inverse = l.div(l.all(1.0), j);
        let by_log = l.mul(l.load(&self.lambda), ln(l, j));
        l.mul(l.sub(l.load(&self.shear), by_log), inverse)
    }

    /// Adds the forces to the target, element by element, in slots from `slot` on.
    #[inline(always)]
    fn spread<S: Lanes, T: Target + ?Sized>(
        &self,
        l: S,
        shape: &Shape<S::F>,
        volumetric: S::F,
        slot: usize,
        target: &mut T,
    ) {
        let [xx, yy, zz, xy, xz, yz] = &self.metric;
        let a = force(l, shape, [xx, xy, xz], 0, volumetric);
        let b = force(l, shape, [xy, yy, yz], 1, volumetric);
        let c = force(l, shape, [xz, yz, zz], 2, volumetric);
        let zero = l.all(0.0);
        let on_origin = [
            l.sub(zero, l.add(l.add(a[0], b[0]), c[0])),
            l.sub(zero, l.add(l.add(a[1], b[1]), c[1])),
            l.sub(zero, l.add(l.add(a[2], b[2]), c[2])),
        ];
        let forces = [
            by_element(l, on_origin),
            by_element(l, a),
            by_element(l, b),
            by_element(l, c),
        ];
        for lane in 0..LANES {
            give(l, &self.nodes, &forces, lane, slot + 4 * lane, target);
        }
    }
}

/// Adds the forces on one element.
#[inline(always)]
fn give<S: Lanes, T: Target + ?Sized>(
    l: S,
    nodes: &[[u32; LANES]; 4],
    forces: &[[S::F; LANES]; 4],
    lane: usize,
    slot: usize,
    target: &mut T,
) {
    target.add(l, slot, nodes[0][lane], forces[0][lane]);
    target.add(l, slot + 1, nodes[1][lane], forces[1][lane]);
    target.add(l, slot + 2, nodes[2][lane], forces[2][lane]);
    target.add(l, slot + 3, nodes[3][lane], forces[3][lane]);
}

/// Coordinates of one corner of four elements.
#[inline(always)]
fn corner<S: Lanes>(l: S, target: &(impl Target + ?Sized), nodes: &[u32; LANES]) -> [S::F; 4] {
    l.transpose([
        l.load(target.place(nodes[0])),
        l.load(target.place(nodes[1])),
        l.load(target.place(nodes[2])),
        l.load(target.place(nodes[3])),
    ])
}

#[inline(always)]
fn difference<S: Lanes>(l: S, a: &[S::F; 4], b: &[S::F; 4]) -> [S::F; 3] {
    [l.sub(a[0], b[0]), l.sub(a[1], b[1]), l.sub(a[2], b[2])]
}

/// Force on corner `k` + 1.
#[inline(always)]
fn force<S: Lanes>(
    l: S,
    shape: &Shape<S::F>,
    metric: [&Row; 3],
    k: usize,
    volumetric: S::F,
) -> [S::F; 3] {
    let [a, b, c] = &shape.edges;
    let (g, cofactor) = (
        [l.load(metric[0]), l.load(metric[1]), l.load(metric[2])],
        &shape.cofactor[k],
    );
    [
        l.add(
            dot(l, &[a[0], b[0], c[0]], &g),
            l.mul(volumetric, cofactor[0]),
        ),
        l.add(
            dot(l, &[a[1], b[1], c[1]], &g),
            l.mul(volumetric, cofactor[1]),
        ),
        l.add(
            dot(l, &[a[2], b[2], c[2]], &g),
            l.mul(volumetric, cofactor[2]),
        ),
    ]
}

#[inline(always)]
fn by_element<S: Lanes>(l: S, force: [S::F; 3]) -> [S::F; 4] {
    l.transpose([force[0], force[1], force[2], l.all(0.0)])
}
