//! Linear neo-Hookean tetrahedra, four at a time, in structure-of-arrays blocks.
//!
//! With the edges D = [x_1 - x_0, x_2 - x_0, x_3 - x_0] and those of the reference state D_0, so that
//! F = D D_0^-1, the forces on corners 1 to 3 are the columns of
//!
//! -V P D_0^-T = -V mu D (D_0^T D_0)^-1 + (mu - lambda ln J)/(6 J) cof D,  J = det D/det D_0,
//!
//! since V cof(D_0^-1) D_0^-T = V det(D_0^-1) = 1/6: neither F nor P is needed. The energy is computed on
//! demand from F as in [`NeoHookean`], accurate at small strain.

mod energy;
mod forces;
mod strain;

use super::lanes::{LANES, Lanes, Plain, Row};
use crate::material::NeoHookean;
use energy::Energy;
use femdem_mesh::{Matrix3, Vector3};
use forces::Forces;
#[cfg(feature = "parallel")]
use forces::Slots;
use std::ops::Range;
use strain::Strains;

/// A node of a body: its position, m, and the sum of its forces, N; the last number of each is 0.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(crate) struct Node {
    place: Row,
    force: Row,
}

impl Node {
    pub fn at(x: &Vector3) -> Self {
        Self {
            place: Row([x.x, x.y, x.z, 0.0]),
            force: Row::default(),
        }
    }

    pub fn force(&self) -> Vector3 {
        let [x, y, z, _] = self.force.0;
        Vector3::new(x, y, z)
    }
}

/// Four elements. Unused places repeat the last element with no stiffness.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
struct Block {
    /// -V mu (D_0^T D_0)^-1: 11, 22, 33, 12, 13, 23.
    metric: [Row; 6],
    /// 1/det D_0.
    inverse_determinant: Row,
    /// lambda/6 and mu/6.
    lambda: Row,
    shear: Row,
    /// By corners.
    nodes: [[u32; LANES]; 4],
}

/// Additional data for the energy.
#[derive(Debug, Clone, PartialEq)]
struct Reference {
    /// D_0^-1 by rows.
    inverse: [Row; 9],
    /// 6 V; 0 beyond the last element.
    volume: Row,
    material: [NeoHookean; LANES],
}

/// An element as input of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BatchElement<'a> {
    pub nodes: [u32; 4],
    pub inverse: &'a Matrix3,
    pub volume: f64,
    pub material: &'a NeoHookean,
}

/// Elements of a body, all of them neo-Hookean.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Batch {
    blocks: Vec<Block>,
    references: Vec<Reference>,
}

impl Batch {
    pub fn new(elements: &[BatchElement]) -> Self {
        let (blocks, references) = elements.chunks(LANES).filter_map(block).unzip();
        Self { blocks, references }
    }

    /// Adds the forces of all elements to the nodes, in the order of the elements. `false` if an element is
    /// inverted or not finite.
    pub fn add_forces(&self, nodes: &mut [Node]) -> bool {
        dispatch(Forces {
            blocks: &self.blocks,
            target: nodes,
        })
    }

    /// The forces of some elements, starting at a multiple of four, corner by corner into `slots`.
    #[cfg(feature = "parallel")]
    pub fn forces_of(&self, range: Range<usize>, nodes: &[Node], slots: &mut [Vector3]) -> bool {
        dispatch(Forces {
            blocks: &self.blocks[blocks_of(range)],
            target: &mut Slots { nodes, slots },
        })
    }

    /// Stored energy of some elements, starting at a multiple of four, J; NaN if one is inverted.
    pub fn energy(&self, range: Range<usize>, x: &[Vector3]) -> f64 {
        let blocks = blocks_of(range);
        dispatch(Energy {
            blocks: &self.blocks[blocks.clone()],
            references: &self.references[blocks],
            x,
        })
    }

    /// |F^T F - I|^2 of the elements in their order, four to a row; NaN where one of a row is inverted.
    pub fn squared_strains(&self, x: &[Vector3]) -> Vec<Row> {
        dispatch(Strains {
            blocks: &self.blocks,
            references: &self.references,
            x,
        })
    }
}

fn blocks_of(elements: Range<usize>) -> Range<usize> {
    elements.start / LANES..elements.end.div_ceil(LANES)
}

/// A block of one to four elements; `None` of none.
fn block(elements: &[BatchElement]) -> Option<(Block, Reference)> {
    let last = elements.last()?;
    let at = |lane: usize| elements.get(lane).unwrap_or(last);
    // Of the real elements only.
    let own = |f: &dyn Fn(&BatchElement) -> f64| {
        Row(std::array::from_fn(|lane| {
            elements.get(lane).map_or(0.0, f)
        }))
    };
    let metric = |i: usize, j: usize| {
        own(&|e| {
            let g = e.inverse.row(i).dot(&e.inverse.row(j));
            -e.volume * e.material.moduli().shear * g
        })
    };
    let block = Block {
        metric: [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|(i, j)| metric(i, j)),
        inverse_determinant: Row(std::array::from_fn(|l| at(l).inverse.determinant())),
        lambda: own(&|e| e.material.moduli().lambda / 6.0),
        shear: own(&|e| e.material.moduli().shear / 6.0),
        nodes: std::array::from_fn(|corner| std::array::from_fn(|l| at(l).nodes[corner])),
    };
    let reference = Reference {
        inverse: std::array::from_fn(|k| {
            Row(std::array::from_fn(|l| at(l).inverse[(k / 3, k % 3)]))
        }),
        volume: own(&|e| 6.0 * e.volume),
        material: std::array::from_fn(|l| *at(l).material),
    };
    Some((block, reference))
}

/// A task to run with the best instructions that the machine has.
trait Task {
    type Output;
    fn run<S: Lanes>(self, l: S) -> Self::Output;
}

#[inline]
fn dispatch<T: Task>(task: T) -> T::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = super::lanes::V3::try_new() {
        return simd.vectorize(WithAvx2 { simd, task });
    }
    task.run(Plain)
}

#[cfg(target_arch = "x86_64")]
struct WithAvx2<T> {
    simd: super::lanes::V3,
    task: T,
}

#[cfg(target_arch = "x86_64")]
impl<T: Task> pulp::NullaryFnOnce for WithAvx2<T> {
    type Output = T::Output;

    #[inline(always)]
    fn call(self) -> T::Output {
        self.task.run(self.simd)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Seven tetrahedra round the origin, their corners displaced.
    fn batch(law: &NeoHookean) -> (Batch, Vec<Vector3>) {
        let places: Vec<Vector3> = (0..10)
            .map(|k| {
                let t = f64::from(k);
                Vector3::new((1.3 * t).cos(), (2.1 * t).sin(), 0.4 * (0.7 * t).cos()) * 0.1
            })
            .collect();
        let tets: Vec<[u32; 4]> = (0..7).map(|k| [k, k + 1, k + 2, k + 3]).collect();
        let inverses: Vec<(f64, Matrix3)> = tets
            .iter()
            .map(|t| {
                let [a, b, c, d] = t.map(|i| places[i as usize]);
                let edges = Matrix3::from_columns(&[b - a, c - a, d - a]);
                (edges.determinant() / 6.0, edges.try_inverse().unwrap())
            })
            .collect();
        let elements: Vec<BatchElement> = tets
            .iter()
            .zip(&inverses)
            .map(|(nodes, (volume, inverse))| BatchElement {
                nodes: *nodes,
                inverse,
                volume: volume.abs(),
                material: law,
            })
            .collect();
        (Batch::new(&elements), places)
    }

    fn run<S: Lanes>(l: S, batch: &Batch, x: &[Vector3]) -> (bool, Vec<Vector3>, f64) {
        let mut nodes: Vec<Node> = x.iter().map(Node::at).collect();
        let forces = Forces {
            blocks: &batch.blocks,
            target: &mut nodes[..],
        };
        let sound = forces.run(l);
        let energy = Energy {
            blocks: &batch.blocks,
            references: &batch.references,
            x,
        };
        (
            sound,
            nodes.iter().map(Node::force).collect(),
            energy.run(l),
        )
    }

    proptest! {
        /// Arrays and AVX2 give the same bits, near the reference state and far from it.
        #[test]
        fn every_instruction_set_gives_the_same_bits(
            moves in prop::collection::vec(prop::array::uniform3(-1.0..1.0), 10),
            size in prop::sample::select(vec![1e-9, 1e-3, 0.1]),
        ) {
            let law = NeoHookean::new(1e6, 0.3).unwrap();
            let (batch, mut x) = batch(&law);
            for (x, by) in x.iter_mut().zip(&moves) {
                *x += Vector3::from(*by) * (0.1 * size);
            }
            let plain = run(Plain, &batch, &x);
            #[cfg(target_arch = "x86_64")]
            if let Some(simd) = crate::element::lanes::V3::try_new() {
                let other = run(simd, &batch, &x);
                prop_assert_eq!(plain.0, other.0);
                prop_assert_eq!(plain.2.to_bits(), other.2.to_bits());
                for (a, b) in plain.1.iter().zip(&other.1).filter(|_| plain.0) {
                    prop_assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
                }
            }
            prop_assert_eq!(plain.0, plain.2.is_finite());
            // Small displacements invert nothing, so that numbers are compared and not NaN.
            prop_assert!(plain.0 || size > 1e-9);
        }
    }
}
