//! The pair kernel of deformable bodies.

use super::add_up::{Way, run};
use super::near::{Candidates, Failure, Near, Sides, Tree};
use super::operand::{Inverted, Operand};
use super::scratch::DeformableScratch;
use super::shape::Modulus;
use crate::contact::Wrench;
use crate::error::ContactError;
use crate::law::WallResponse;
use femdem_mesh::Vector3;
use femdem_mesh::bvh::{Aabb, Bvh};
use serde::{Deserialize, Serialize};

/// Action of a contact on a node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeForce {
    /// The node.
    pub node: u32,
    /// Force on it, N.
    pub force: Vector3,
    /// Contact stiffness at the node, N/m: the integral of the stiffness per area times the shape function
    /// over the skin in contact.
    pub stiffness: f64,
}

/// The contact of a pair.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DeformableOverlap {
    /// Contact energy U, J.
    pub energy: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Area of the contact, m^2.
    pub area: f64,
    /// Elastic force on A and on B, with torques about the world's origin.
    pub wrenches: [Wrench; 2],
    /// Centre of pressure, m.
    pub centre: Vector3,
    /// Normal stiffness, N/m.
    pub stiffness: f64,
    /// Forces on the nodes of A and of B, by ascending node; none for a rigid side.
    pub nodes: [Vec<NodeForce>; 2],
}

/// The penalty law of deformable bodies; walls act as mirror images unless another response is chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DeformableKernel {
    walls: WallResponse,
}

impl DeformableKernel {
    /// The same with another response of walls.
    pub fn with_walls(self, walls: WallResponse) -> Self {
        Self { walls }
    }

    /// The contact of A with B, a deformable body; `None` if they are apart. The moduli are the stiffnesses
    /// of the fields (that of a wall is ignored).
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if B is not deformable, [`ContactError::NodeCount`] or
    /// [`ContactError::NodeState`] for positions of the wrong number or that are not finite, and
    /// [`ContactError::InvertedTet`] if a tetrahedron in the contact is inverted. The `body` in these is the
    /// side: 0 (A) or 1 (B).
    pub fn evaluate(
        &self,
        a: (Operand, Modulus),
        b: (Operand, Modulus),
        scratch: &mut DeformableScratch,
    ) -> Result<Option<DeformableOverlap>, ContactError> {
        self.evaluate_by(Way::Skins, a, b, scratch)
    }

    /// As [`evaluate`](Self::evaluate), with sums over the common parts of tetrahedra only: slower, and an
    /// oracle, as it shares no arithmetic with sums over skins.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn evaluate_pieces(
        &self,
        a: (Operand, Modulus),
        b: (Operand, Modulus),
        scratch: &mut DeformableScratch,
    ) -> Result<Option<DeformableOverlap>, ContactError> {
        self.evaluate_by(Way::Pieces, a, b, scratch)
    }

    /// The contact of a deformable body with itself; `None` if no parts of it touch. A and B are the parts on both sides,
    /// and a node may belong to both. The energy is p ∫ φ (m - 1) dV over the body, where m parts of it lie at the same
    /// place.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn evaluate_itself(
        &self,
        body: (Operand, Modulus),
        scratch: &mut DeformableScratch,
    ) -> Result<Option<DeformableOverlap>, ContactError> {
        self.evaluate_by(Way::Itself, body, body, scratch)
    }

    fn evaluate_by(
        &self,
        way: Way,
        a: (Operand, Modulus),
        b: (Operand, Modulus),
        scratch: &mut DeformableScratch,
    ) -> Result<Option<DeformableOverlap>, ContactError> {
        if !matches!(b.0, Operand::Deformable(..)) {
            return Err(ContactError::NoSuch {
                what: "deformable side",
                index: 1,
                count: 0,
            });
        }
        a.0.check(0)?;
        b.0.check(1)?;
        a.1.check()?;
        b.1.check()?;
        let own = [OwnTree::new(&a.0), OwnTree::new(&b.0)];
        let sides = Sides {
            operands: [a.0, b.0],
            trees: [own[0].tree(&a.0), own[1].tree(&b.0)],
        };
        let pressures = self.pressures(&sides, [a.1, b.1]);
        let mut candidates = Candidates::default();
        let failed = |(side, Inverted { tet }): Failure| ContactError::InvertedTet {
            body: side,
            tet: tet as usize,
        };
        let touches = run(&sides, pressures, way, &mut candidates, 0.0, scratch).map_err(failed)?;
        Ok(match candidates.near() {
            Some(near) if touches => Some(scratch.overlap(near)),
            _ => None,
        })
    }

    /// Pressures of the fields of two sides, Pa.
    pub(crate) fn pressures(&self, sides: &Sides, moduli: [Modulus; 2]) -> [f64; 2] {
        let lengths = sides.operands.map(|o| o.length());
        match sides.operands[0] {
            Operand::Wall(..) => {
                let factor = match self.walls {
                    WallResponse::Mirror => 4.0,
                    WallResponse::Rigid => 2.0,
                };
                [0.0, factor * moduli[1].penalty(lengths[1])]
            }
            _ => Modulus::combine(moduli, lengths),
        }
    }
}

/// A tree over the current tetrahedra of a deformable body.
struct OwnTree(Option<(Bvh, Vec<Aabb>)>);

impl OwnTree {
    fn new(operand: &Operand) -> Self {
        let Operand::Deformable(shape, _) = operand else {
            return Self(None);
        };
        let mut boxes = Vec::with_capacity(shape.tet_count());
        operand.boxes(&mut boxes);
        let mut tree = shape.tree().clone();
        tree.refit(&boxes);
        Self(Some((tree, boxes)))
    }

    fn tree<'a>(&'a self, operand: &Operand<'a>) -> Tree<'a> {
        match (&self.0, operand) {
            (Some((tree, boxes)), _) => Tree::here(tree, boxes),
            (None, Operand::Rigid(mesh, _)) => mesh.cells.tree(),
            (None, Operand::Wall(wall, _)) => wall.cells.tree(),
            (None, Operand::Deformable(shape, _)) => Tree::here(shape.tree(), &[]),
        }
    }
}

impl crate::tets::cells::Cells {
    /// The tree of a rigid side, in its own axes.
    pub(crate) fn tree(&self) -> Tree<'_> {
        Tree::here(&self.tree, &self.boxes)
    }
}

impl DeformableScratch {
    /// The pair's contact from the sums.
    fn overlap(&self, near: &Near) -> DeformableOverlap {
        let sums = &self.sums;
        let wrench = |[force, torque]: [Vector3; 2]| Wrench {
            force,
            torque: torque + near.origin.cross(&force),
        };
        let pressure: f64 = sums.loads.iter().map(|l| l.pressure).sum();
        let moment: Vector3 = sums.loads.iter().map(|l| l.moment).sum();
        let force = sums.wrench[1][0];
        DeformableOverlap {
            energy: sums.energy,
            volume: sums.volume,
            area: 0.5 * sums.area.dot(&force) / force.norm().max(f64::MIN_POSITIVE),
            wrenches: sums.wrench.map(wrench),
            centre: near.origin + moment / pressure.max(f64::MIN_POSITIVE),
            stiffness: sums.loads.iter().map(|l| l.stiffness.total).sum(),
            nodes: [0, 1].map(|side| self.nodes(near, side)),
        }
    }

    /// Forces on the nodes of the finite elements.
    fn nodes(&self, near: &Near, side: usize) -> Vec<NodeForce> {
        let slave = |at: u32| {
            let slaves = &near.sides[side].slaves;
            slaves.binary_search_by_key(&at, |s| s.0).is_ok()
        };
        let nodes = near.sides[side].nodes.iter().enumerate();
        let loads = self.sums.forces[side]
            .iter()
            .zip(&self.sums.stiffness[side]);
        nodes
            .zip(loads)
            .filter(|((at, _), _)| !slave(*at as u32))
            .map(|((_, &node), (&force, &stiffness))| NodeForce {
                node,
                force,
                stiffness,
            })
            .collect()
    }
}
