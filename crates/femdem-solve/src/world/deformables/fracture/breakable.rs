//! Bodies that may break, and which cannot.

use super::{CrackFacet, CrackState};
use crate::error::{SolveError, check};
use crate::fracture::Fracture;
use crate::world::World;
use crate::world::deformables::{ContactStiffness, Model};
use femdem_contact::{BodyId, Field};
use femdem_fem::element::Element;
use femdem_fem::fracture::{Decision, NodalDecision, Strength};
use femdem_fem::material::{Deformation, Material};
use femdem_fem::{DeformableModel, ElementStress, MaterialRegion};
use femdem_mesh::tet::{CrackedMesh, Facets};
use femdem_mesh::{Matrix3, TetMesh, Vector3};
use serde::{Deserialize, Serialize};

/// Strains this far below the smallest that is harmful are harmless: bounds of stress are those of small strain, and of a few
/// steps before.
const MARGIN: f64 = 0.8;

/// What a deformable body that may break has beside others.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Breakable {
    pub fracture: Fracture,
    /// By point of the mesh, the factor of the strength there.
    pub factors: Vec<f64>,
    /// By point, that of the mesh of the body that broke first.
    pub points: Vec<u32>,
    /// No element whose strain |FᵀF − I| is below this fails.
    pub harmless: f64,
    /// Largest stress over strength at the last look.
    pub highest: f64,
    /// Facets that are spent, as they were then.
    pub spent: Vec<CrackFacet>,
    /// `None` as long as it is whole.
    pub cracks: Option<Box<CrackState>>,
    /// The mesh of a whole body, once its stresses are looked at.
    #[serde(skip)]
    pub(super) whole: Option<Box<CrackedMesh>>,
}

impl Breakable {
    /// A body of number `id`, by which the scatter of its strength is drawn.
    pub fn new(model: &Model, fracture: Fracture, id: BodyId) -> Self {
        let mesh = model.model.mesh();
        let factors = Self::factors(mesh, &fracture, id);
        Self {
            harmless: harmless(model, &fracture, &factors),
            fracture,
            points: (0..factors.len() as u32).collect(),
            factors,
            highest: 0.0,
            spent: Vec::new(),
            cracks: None,
            whole: None,
        }
    }

    /// By node, the factor of the strength of a body of number `id`.
    pub fn factors(mesh: &TetMesh, fracture: &Fracture, id: BodyId) -> Vec<f64> {
        match fracture.scatter {
            None => vec![1.0; mesh.points().len()],
            Some(scatter) => scatter.factors(u64::from(id), mesh),
        }
    }

    /// Decides where it cracks now. A body that was whole then has no joints yet.
    pub fn decide(
        &mut self,
        model: &DeformableModel,
        positions: &[Vector3],
        stresses: &[ElementStress],
    ) -> Result<Decision, SolveError> {
        let decision = NodalDecision {
            strengths: &[self.fracture.strength],
            regions: &vec![0; stresses.len()],
            factors: &self.factors,
            positions,
            stresses,
        };
        let found = match &mut self.cracks {
            Some(cracks) => decision.decide(&mut cracks.mesh)?,
            None => {
                let new = || Box::new(CrackedMesh::new(model.mesh()));
                let mut mesh = self.whole.take().unwrap_or_else(new);
                let found = decision.decide(&mut mesh)?;
                if !found.splits.is_empty() {
                    let whole = CrackedMesh::new(model.mesh());
                    self.cracks = Some(Box::new(CrackState::new(*mesh, whole)));
                } else if found.cuts.is_empty() {
                    self.whole = Some(mesh);
                }
                // Facets that are cut and split no node yet are found again.
                found
            }
        };
        self.highest = found.highest;
        Ok(found)
    }

    pub fn cracks(&self) -> Option<&CrackState> {
        self.cracks.as_deref()
    }
}

/// The strain |FᵀF − I| below which no element fails.
fn harmless(model: &Model, fracture: &Fracture, factors: &[f64]) -> f64 {
    let weakest = factors.iter().copied().fold(f64::INFINITY, f64::min);
    MARGIN * 2.0 * weakest * least(&fracture.strength) / model.stiffest()
}

impl World {
    /// Multiplies the strength of a body that may break at each of its nodes, beside the scatter that it has: seams that are weaker,
    /// grips that hold. A crack begins where a node fails; its energy stays that of the [`Fracture`], but is more where the strength is so high
    /// that the crack would let go more steeply than it rises.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::CannotBreak`] for one that may not break or is
    /// cracked already, [`SolveError::CannotAdapt`] for an [adaptive](crate::Adaptive) one,
    /// [`SolveError::Parameter`] unless there is one factor for each node, positive and finite.
    pub fn scale_strength(&mut self, id: BodyId, factors: &[f64]) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        self.not_shared("changing the strength of bodies")?;
        self.refuse_adaptive(Some(id), "the strength of its material", "factors of it")?;
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let (model, state) = deformables.parts(id);
        let refused = |found: &str| SolveError::CannotBreak {
            needs: "a fracture and no crack yet to have its strength changed",
            found: found.to_owned(),
        };
        let breakable = state.breakable.as_deref_mut();
        let breakable = breakable.ok_or_else(|| refused("none"))?;
        if breakable.cracks.is_some() {
            return Err(refused("cracks"));
        }
        let (given, nodes) = (factors.len(), breakable.factors.len());
        check(
            "number of factors",
            given as f64,
            given == nodes,
            "one for each node",
        )?;
        for &factor in factors {
            check(
                "factor of strength",
                factor,
                factor > 0.0,
                "positive and finite",
            )?;
        }
        for (own, factor) in breakable.factors.iter_mut().zip(factors) {
            *own *= factor;
        }
        breakable.harmless = harmless(model, &breakable.fracture, &breakable.factors);
        // Facets cut before are found again, where the strength is as low.
        breakable.whole = None;
        Ok(())
    }
}

/// The smallest |stress| at which a material fails, Pa: f of tension; of shear, with n·σ = (1 + sin φ) σ_1 − (1 − sin φ) σ_3 =
/// 2 c cos φ, the distance of that plane.
fn least(strength: &Strength) -> f64 {
    let (sin, cos) = strength.friction_angle().sin_cos();
    let shear = 2.0 * strength.cohesion() * cos / (1.0 + sin).hypot(1.0 - sin);
    strength.tensile().min(shear)
}

impl Model {
    /// Refuses a fracture that means nothing, or that a body of this model cannot follow.
    pub(in crate::world::deformables) fn may_break(
        &self,
        fracture: &Fracture,
    ) -> Result<(), SolveError> {
        if !matches!(self.stiffness, ContactStiffness::Ratio(_)) {
            return Err(SolveError::CannotBreak {
                needs: "a contact stiffness over depth (ratio)",
                found: format!("{:?}", self.stiffness),
            });
        }
        self.may_crack(fracture)
    }

    /// The same, whatever its contact stiffness: that over depth stays once it has cracked.
    pub(in crate::world::deformables) fn may_crack(
        &self,
        fracture: &Fracture,
    ) -> Result<(), SolveError> {
        fracture.validate()?;
        let refused =
            |needs: &'static str, found: String| Err(SolveError::CannotBreak { needs, found });
        if self.model.element() != Element::T4 {
            return refused(
                "linear elements (T4)",
                format!("{:?}", self.model.element()),
            );
        }
        if self.field != Field::Body {
            return refused("the contact field of a body", format!("{:?}", self.field));
        }
        let (height, edge) = self.sizes();
        let largest = fracture.largest_height(self.young);
        if height > largest && !fracture.coarse {
            return Err(SolveError::TooCoarse {
                height,
                largest,
                edge: edge * largest / height,
            });
        }
        Ok(())
    }

    /// Largest |stress| over |strain| at no strain, Pa.
    fn stiffest(&self) -> f64 {
        let rest = Deformation::at_rest(Matrix3::identity());
        let of = |region: &MaterialRegion| {
            let old = vec![0.0; region.material.history_len()];
            let tangent = region.material.tangent(&rest, &old);
            tangent.map_or(f64::INFINITY, |tangent| {
                tangent.symmetric_eigenvalues().max()
            })
        };
        self.model.regions().iter().map(of).fold(0.0, f64::max)
    }

    /// Mean height of the pairs of elements beside inner facets, weighted by area, and mean edge of the elements, m.
    pub(super) fn sizes(&self) -> (f64, f64) {
        let (mesh, nodes) = (self.model.mesh(), self.model.nodes());
        let (mut volume, mut area) = (0.0, 0.0);
        for facet in Facets::new(mesh).all() {
            let [a, b, c] = facet.points.map(|i| nodes[i as usize]);
            area += 0.5 * (b - a).cross(&(c - a)).norm();
            volume += facet
                .tets
                .iter()
                .map(|t| self.model.volumes()[*t as usize])
                .sum::<f64>();
        }
        let edges = |tet: &[u32; 4]| {
            let x: [Vector3; 4] = tet.map(|i| nodes[i as usize]);
            let of = |(i, j): (usize, usize)| (x[i] - x[j]).norm();
            [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
                .map(of)
                .iter()
                .sum::<f64>()
                / 6.0
        };
        let mean = mesh.tets().iter().map(edges).sum::<f64>() / mesh.tets().len() as f64;
        // A body of one element has no facet inside, and cannot break.
        (if area > 0.0 { 1.5 * volume / area } else { 0.0 }, mean)
    }
}
