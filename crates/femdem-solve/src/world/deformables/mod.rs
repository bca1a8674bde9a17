//! The deformable bodies of a world: their state, their half of the step, and their contacts.

mod adaptive;
mod add;
mod each;
mod fracture;
mod hand;
mod kick;
mod nodal_bound;
mod query;
mod ranks;
mod rest;
mod single;
mod space;
mod step;

use crate::error::SolveError;
use crate::fracture::Fracture;
use femdem_contact::deform::{DeformableShape, Modulus};
use femdem_contact::{ContactLaws, Field, MaterialId, stable_step};
use femdem_fem::{Boundary, DeformableModel, FrequencyBound, InternalState, Workspace};
use femdem_mesh::{Pose, Vector3};
use fracture::Breakable;
pub(crate) use fracture::CrackFlows;
pub(super) use fracture::{Fragment, GuestFragment};
use nodal_bound::NodalBound;
use serde::{Deserialize, Serialize};

pub(crate) use adaptive::Adaptives;
pub(super) use adaptive::check_laws;
pub use adaptive::{Adaptive, Fidelity, FidelityChange};
pub(super) use add::{centroid, inertia};
pub use fracture::{CrackFacet, Cracks, Fragmentation};
pub use query::Deformable;
pub(super) use ranks::Soft;
use rest::Rest;

/// Index of a model of deformable bodies, by order of addition.
pub type ModelId = u32;

/// The frequency bound of the elements is renewed every so many steps.
const RENEW: u64 = 10;

/// A deformable body to add.
///
/// ```
/// use femdem_contact::Wall;
/// use femdem_fem::element::Element;
/// use femdem_fem::material::NeoHookean;
/// use femdem_fem::{DeformableModel, MaterialRegion};
/// use femdem_mesh::{Pose, TetMesh, Vector3};
/// use femdem_solve::{ContactStiffness, DeformableSpec, Drive, World, WorldParameters, WorldRelaxation};
///
/// // A rubber cube of 0.1 m on a floor, brought to rest.
/// let mut world = World::new(WorldParameters::default())?;
/// world.add_wall(Wall::half_space("floor", Vector3::z(), 0.0)?, Drive::Fixed)?;
/// let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(0.1))?;
/// let rubber = MaterialRegion { material: NeoHookean::new(1e6, 0.3)?.into(), density: 1000.0 };
/// let model = DeformableModel::new(&mesh, Element::T4, vec![rubber], None)?;
/// let model = world.add_model("cube", model, ContactStiffness::default())?;
/// let body = world.add_deformable(DeformableSpec::at_rest(model, Pose::translation(0.0, 0.0, 0.001)))?;
/// world.relax(&WorldRelaxation::default())?;
/// let borne: f64 = world.deformable_contacts().map(|contact| contact.normal_force).sum();
/// assert!((borne / 9.81 - 1.0).abs() < 1e-3);
/// assert!(world.deformable(body).is_some_and(|body| body.kinetic_energy() == 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeformableSpec {
    /// Its model.
    pub model: ModelId,
    /// Reference coordinates of the model -> world.
    pub pose: Pose,
    /// Velocity of the centroid, m/s.
    pub velocity: Vector3,
    /// Angular velocity about the centroid, world axes, rad/s.
    pub angular_velocity: Vector3,
    /// Conditions at its nodes and on its skin.
    pub boundary: Boundary,
    /// Material of its skin, by which its contacts find [their laws](crate::World::set_law).
    #[serde(default)]
    pub material: MaterialId,
    /// How it breaks, if it may.
    #[serde(default)]
    pub fracture: Option<Fracture>,
}

impl DeformableSpec {
    /// A body at rest and free.
    #[must_use]
    pub fn at_rest(model: ModelId, pose: Pose) -> Self {
        Self {
            model,
            pose,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            boundary: Boundary::default(),
            material: MaterialId::default(),
            fracture: None,
        }
    }
}

/// Stiffness of the contact field of a deformable body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ContactStiffness {
    /// The penalty of the world's contact law between two bodies of its material.
    Law,
    /// A penalty p, Pa.
    Penalty(f64),
    /// A foundation of modulus kappa = r E/h per depth, with the stiffest Young's modulus E of the
    /// body and the mean edge h of its skin: r = 1 costs 5 % of the force of a Hertz contact whose
    /// radius is 3 h, 1 to 3 % at 4 h to 6 h.
    Ratio(f64),
}

impl Default for ContactStiffness {
    fn default() -> Self {
        Self::Ratio(1.0)
    }
}

/// A model with its contact shape.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Model {
    pub name: String,
    pub model: DeformableModel,
    pub stiffness: ContactStiffness,
    pub field: Field,
    /// Young's modulus of the stiffest material, Pa.
    pub young: f64,
    /// Of a body that has cracked, or has broken off another, and has this model alone: the edge of the skin of the body that was
    /// whole, m.
    pub edge: Option<f64>,
}

impl Model {
    fn shape(&self) -> Result<DeformableShape, SolveError> {
        let (mesh, edges) = (self.model.mesh(), self.model.mid_edges());
        Ok(match self.edge {
            Some(edge) => DeformableShape::cracked(mesh, edge)?,
            None => DeformableShape::with_field(mesh, edges, self.field)?,
        })
    }

    /// The step that is stable for any node with its whole share of the skin in contact, s. The stiffest
    /// partner is a wall that acts as a mirror image, four times as stiff as the foundation.
    fn contact_step(&self, shape: &DeformableShape, modulus: Modulus) -> f64 {
        let masses = self.model.masses();
        let mut areas = vec![0.0; masses.len()];
        for (triangle, area) in self.skin_areas(shape) {
            for &i in triangle {
                areas[i as usize] += area / 3.0;
            }
        }
        let lightest = areas.iter().zip(masses).map(|(area, m)| area / m);
        // A stiffness k on a node of mass m counts as 2 k/m in the step.
        stable_step(
            8.0 * foundation(shape, modulus) * lightest.fold(0.0, f64::max),
            0.0,
        )
    }

    /// The slowest elastic oscillation of a free body, rad/s: that of a bar as long as it, π c/L with c = √(E/ρ).
    fn frequency(&self, shape: &DeformableShape) -> f64 {
        let mass: f64 = self.model.masses().iter().sum();
        let volume: f64 = self.model.volumes().iter().sum();
        let speed = (self.young * volume / mass).sqrt();
        std::f64::consts::PI * speed / (2.0 * shape.radius())
    }

    /// The triangles of the skin and their areas in the reference state, m^2.
    fn skin_areas<'a>(
        &'a self,
        shape: &'a DeformableShape,
    ) -> impl Iterator<Item = (&'a [u32; 3], f64)> {
        let nodes = self.model.nodes();
        shape.skin().iter().filter_map(move |triangle| {
            let corners = triangle.map(|i| nodes.get(i as usize).copied());
            let [Some(a), Some(b), Some(c)] = corners else {
                return None;
            };
            Some((triangle, 0.5 * (b - a).cross(&(c - a)).norm()))
        })
    }

    /// Area of the skin in the reference state, m^2.
    pub(in crate::world) fn skin_area(&self, shape: &DeformableShape) -> f64 {
        self.skin_areas(shape).map(|(_, area)| area).sum()
    }

    /// The stiffness of the contact field of a body of a material under these laws.
    fn modulus(
        &self,
        shape: &DeformableShape,
        laws: &ContactLaws,
        material: MaterialId,
    ) -> Modulus {
        match self.stiffness {
            ContactStiffness::Law => Modulus::Penalty(laws.between([material; 2]).penalty),
            ContactStiffness::Penalty(p) => Modulus::Penalty(p),
            ContactStiffness::Ratio(r) => Modulus::of_material(self.young, r, shape),
        }
    }
}

/// Stiffness per area of a contact field, Pa/m.
pub(super) fn foundation(shape: &DeformableShape, modulus: Modulus) -> f64 {
    modulus.penalty(shape.inradius()) / shape.inradius()
}

/// The present state of a deformable body; without nodes where a number stands for a rigid body, or for none.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct State {
    pub model: ModelId,
    pub boundary: Boundary,
    /// m.
    pub positions: Vec<Vector3>,
    /// m/s.
    pub velocities: Vec<Vector3>,
    /// 1/kg; 0 where a node is prescribed in all directions.
    pub inverse_masses: Vec<f64>,
    pub history: Vec<f64>,
    /// Acceleration by the external load, m/s^2.
    pub pull: Vector3,
    /// Forces of the elements, and the loads of the boundary, at the present positions, N.
    pub strain_forces: Vec<Vector3>,
    pub loads: Vec<Vector3>,
    /// Kinetic energy of prescribed nodes at the end of the last step, J.
    pub held_energy: f64,
    /// Largest speed of a node in the last step, m/s.
    pub fastest: f64,
    /// Energies at the present positions; the energy of a batch of elements is computed on demand.
    pub internal: InternalState,
    /// Frequency bound of the elements as of its last renewal, for the body and by nodes.
    pub bound: FrequencyBound,
    /// The step that contacts alone allow, for any part of the skin, s.
    pub contact_step: f64,
    pub nodal: NodalBound,
    pub rest: Rest,
    /// Of a body that may break.
    pub breakable: Option<Box<Breakable>>,
}

/// Buffers for one body at a time.
#[derive(Debug, Clone, Default)]
struct Scratch {
    history: Vec<f64>,
    work: Workspace,
}

/// All deformable bodies.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Deformables {
    pub models: Vec<Model>,
    /// By number of the bodies, rigid ones included.
    pub bodies: Vec<State>,
    /// The largest stable step under the present forces, s, once it has been computed.
    #[serde(skip)]
    bound: Option<f64>,
}
