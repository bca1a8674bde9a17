//! Stored energy of blocks.

use super::super::lanes::{LANES, Lanes, Row, cross, dot};
use super::super::log::twice_artanh;
use super::{Block, Reference, Task};
use crate::material::{Deformation, Material};
use femdem_mesh::{Matrix3, Vector3};

/// Sums energies, J; NaN if an element is inverted.
pub(super) struct Energy<'a> {
    pub blocks: &'a [Block],
    pub references: &'a [Reference],
    pub x: &'a [Vector3],
}

impl Task for Energy<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Lanes>(self, l: S) -> f64 {
        let mut sum = l.all(0.0);
        for (block, reference) in self.blocks.iter().zip(self.references) {
            sum = l.add(sum, reference.energy(l, block, self.x));
        }
        l.store(sum).0.iter().sum()
    }
}

/// The edges at corner 0 of four elements, as rows of the matrices of which they are the columns.
#[inline(always)]
pub(super) fn edges(block: &Block, x: &[Vector3]) -> [Row; 9] {
    let mut edges = [Row::default(); 9];
    for lane in 0..LANES {
        let [a, b, c, d] = block.nodes.map(|of_corner| x[of_corner[lane] as usize]);
        for i in 0..3 {
            edges[3 * i].0[lane] = b[i] - a[i];
            edges[3 * i + 1].0[lane] = c[i] - a[i];
            edges[3 * i + 2].0[lane] = d[i] - a[i];
        }
    }
    edges
}

impl Reference {
    /// V (mu (tr E - ln J) + lambda/2 ln^2 J), with J^2 - 1 from the invariants of F^T F - I.
    #[inline(always)]
    fn energy<S: Lanes>(&self, l: S, block: &Block, x: &[Vector3]) -> S::F {
        let edges = edges(block, x);
        let [a, b, c] = [
            self.column(l, &edges, 0),
            self.column(l, &edges, 1),
            self.column(l, &edges, 2),
        ];
        let one = l.all(1.0);
        let (x, y, z) = (
            l.sub(dot(l, &a, &a), one),
            l.sub(dot(l, &b, &b), one),
            l.sub(dot(l, &c, &c), one),
        );
        let off = [dot(l, &b, &c), dot(l, &a, &c), dot(l, &a, &b)];
        let [yz, xz, xy] = off;
        let trace = l.add(l.add(x, y), z);
        let products = l.add(l.add(l.mul(x, y), l.mul(y, z)), l.mul(z, x));
        let minors = l.sub(products, dot(l, &off, &off));
        let determinant = dot(
            l,
            &[x, xy, xz],
            &[
                l.sub(l.mul(y, z), l.mul(yz, yz)),
                l.sub(l.mul(yz, xz), l.mul(xy, z)),
                l.sub(l.mul(xy, yz), l.mul(y, xz)),
            ],
        );
        let change = l.add(l.add(trace, minors), determinant);
        let volume = l.load(&self.volume);
        // ln (1 + q) = 2 artanh (q/(2 + q)) within the range of the series. q = J^2 - 1 does not show whether F
        // is inverted, so that det F is tested too.
        let f = dot(l, &a, &cross(l, &b, &c));
        if !(l.all_within(change, -0.29, 0.41) && l.all_within(f, 0.0, f64::INFINITY)) {
            return l.load(&self.one_by_one(&edges));
        }
        let half = l.all(0.5);
        let log = l.mul(
            half,
            twice_artanh(l, l.div(change, l.add(l.all(2.0), change))),
        );
        let isochoric = l.mul(l.load(&block.shear), l.sub(l.mul(half, trace), log));
        let volumetric = l.mul(l.mul(half, l.load(&block.lambda)), l.mul(log, log));
        l.mul(l.add(isochoric, volumetric), volume)
    }

    /// A column of F.
    #[inline(always)]
    pub(super) fn column<S: Lanes>(&self, l: S, edges: &[Row; 9], j: usize) -> [S::F; 3] {
        let g = [
            l.load(&self.inverse[j]),
            l.load(&self.inverse[3 + j]),
            l.load(&self.inverse[6 + j]),
        ];
        let row = |i: usize| -> [&Row; 3] { [&edges[3 * i], &edges[3 * i + 1], &edges[3 * i + 2]] };
        let [p, q, r] = [row(0), row(1), row(2)];
        [
            dot(l, &[l.load(p[0]), l.load(p[1]), l.load(p[2])], &g),
            dot(l, &[l.load(q[0]), l.load(q[1]), l.load(q[2])], &g),
            dot(l, &[l.load(r[0]), l.load(r[1]), l.load(r[2])], &g),
        ]
    }

    /// The energies of the elements from the material itself.
    #[cold]
    #[inline(never)]
    fn one_by_one(&self, edges: &[Row; 9]) -> Row {
        Row(std::array::from_fn(|lane| {
            if self.volume.0[lane] == 0.0 {
                return 0.0;
            }
            let at = |rows: &[Row; 9]| Matrix3::from_fn(|i, j| rows[3 * i + j].0[lane]);
            let felt = Deformation::at_rest(at(edges) * at(&self.inverse));
            let response = self.material[lane].respond(&felt, &[], &mut []);
            response.map_or(f64::NAN, |r| r.energy * self.volume.0[lane] / 6.0)
        }))
    }
}
