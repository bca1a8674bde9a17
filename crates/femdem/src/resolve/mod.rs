//! Stresses inside the bodies of a rigid pack: the bodies are made deformable in place and brought to
//! equilibrium again.
//!
//! Every body keeps its place, its contact field and the friction of its contacts, so that contacts begin with
//! the forces that they had; then [`World::relax`] finds the deformed equilibrium. The mean stress of each body
//! is checked against that of its contact forces (Love-Weber).
//!
//! ```
//! use femdem::pack::{Container, PackShape, PackSpec, Packing};
//! use femdem::resolve::{ResolveOptions, resolve};
//! use femdem::mesh::catalogue::{CatalogueShape, Solid};
//!
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(0.02)?;
//! let mut packing = Packing::new(PackSpec {
//!     shapes: vec![PackShape::new("cube", cube)],
//!     count: 4,
//!     container: Container::Box { width: 0.05, depth: 0.05 },
//!     ..PackSpec::default()
//! })?;
//! packing.run()?;
//! let resolved = resolve(packing.world(), &ResolveOptions::default())?;
//! assert!(resolved.relaxed.residual <= 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod files;

use std::collections::BTreeMap;

use femdem_contact::{BodyId, Field, Partner, WallResponse};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::tet::{self, MeshOptions, Method};
use femdem_mesh::{Matrix3, TetMesh, Vector3};
use femdem_solve::{
    ContactStiffness, DeformableSpec, Drive, ModelId, Shape, SolveError, World, WorldRelaxation,
    WorldRelaxed,
};
use femdem_view::ViewError;
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::means::{difference, symmetric};
use crate::meshing::options_of;
use crate::results::surface_of;
use crate::run::{Member, Penalty, Simulation};

pub use files::ResolveSummary;

/// The material of the bodies, and how closely they are brought to equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResolveOptions {
    /// Young's modulus \[Pa\].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Target edge length of the tetrahedra, in circumscribed diameters of the body.
    pub mesh_size: f64,
    /// Elements.
    pub element: Element,
    /// When the world is at rest.
    pub relaxation: WorldRelaxation,
}

impl Default for ResolveOptions {
    /// Stone: 60 GPa, 0.22.
    fn default() -> Self {
        Self {
            young: 60e9,
            poisson: 0.22,
            mesh_size: 0.3,
            element: Element::T4,
            relaxation: WorldRelaxation::default(),
        }
    }
}

/// Mean stress of a body, from its elements and from the forces on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyMean {
    /// Mean Cauchy stress over the elements \[Pa\], tension positive.
    pub elements: Matrix3,
    /// Love-Weber with the contact forces f on the nodes at x, (1/V) Σ f ⊗ (x − c), its symmetric part
    /// \[Pa\].
    pub nodes: Matrix3,
    /// The same with one force at the point of each contact. It neglects that a contact extends over an
    /// overlap, whose pressure adds about its energy over V.
    pub contacts: Matrix3,
    /// Largest von Mises stress of an element \[Pa\].
    pub largest_von_mises: f64,
    /// Volume \[m³\].
    pub volume: f64,
}

impl BodyMean {
    /// Difference of Love-Weber from the elements, with forces on nodes and with forces at points: norm of the
    /// difference over that of the elements; 0 without stress.
    #[must_use]
    pub fn differences(&self) -> [f64; 2] {
        [self.nodes, self.contacts].map(|other| difference(&self.elements, &other))
    }
}

/// A pack with stresses.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// The world of deformable bodies, in the order of the pack's bodies.
    pub simulation: Simulation,
    /// How it came to rest.
    pub relaxed: WorldRelaxed,
    /// Mean stresses by body.
    pub bodies: Vec<BodyMean>,
    /// Mean and largest displacement of the bodies' centroids by the relaxation \[m\].
    pub moves: [f64; 2],
}

/// Makes the bodies of a rigid world deformable in place, and finds their equilibrium.
///
/// Walls stay where they were added, and act on the bodies as on rigid ones ([`WallResponse::Rigid`]). Friction
/// starts with its recorded values, patch by patch.
///
/// # Errors
///
/// [`Error::Mesh`] if a body cannot be meshed, [`Error::Solve`] for a material out of its range or if
/// the world does not come to rest.
pub fn resolve(rigid: &World, options: &ResolveOptions) -> Result<Resolved, Error> {
    let mut parameters = *rigid.parameters();
    parameters.contact.wall_response = WallResponse::Rigid;
    let mut world = World::new(parameters)?;
    for (_, wall) in rigid.walls() {
        world.add_wall(wall.clone(), Drive::Fixed)?;
    }
    let mut models = Models::default();
    let mut members = Vec::new();
    for id in rigid.body_ids() {
        let (Some(pose), Some(shape), Some(mass)) =
            (rigid.pose(id), rigid.shape_of(id), rigid.mass(id))
        else {
            continue;
        };
        let model = models.of(rigid, shape, mass, options, &mut world)?;
        let id = world.add_deformable(DeformableSpec::at_rest(model, pose))?;
        let name = rigid.shape(shape).map(|s| s.name.clone());
        members.push(Member {
            name: name.unwrap_or_default(),
            placed: pose,
            id,
            of: None,
        });
    }
    for ((a, b), start) in starts(rigid) {
        world.begin_friction(a, b, start.0, start.1)?;
    }
    let before: Vec<Vector3> = world.deformables().map(|d| d.centroid()).collect();
    let relaxed = world.relax(&options.relaxation)?;
    let bodies = means(&world)?;
    let ways = world.deformables().zip(&before);
    let ways: Vec<f64> = ways.map(|(d, x)| (d.centroid() - x).norm()).collect();
    let moves = [
        ways.iter().sum::<f64>() / ways.len().max(1) as f64,
        ways.iter().copied().fold(0.0, f64::max),
    ];
    let penalty = Penalty {
        value: world.parameters().contact.penalty,
        reason: "that of the pack".to_owned(),
    };
    Ok(Resolved {
        simulation: Simulation {
            penalty,
            members,
            ..Simulation::empty(world)
        },
        relaxed,
        bodies,
        moves,
    })
}

/// Models by shape and density.
#[derive(Default)]
struct Models {
    by_shape: BTreeMap<(u32, u64), ModelId>,
}

impl Models {
    fn of(
        &mut self,
        rigid: &World,
        id: u32,
        mass: f64,
        options: &ResolveOptions,
        world: &mut World,
    ) -> Result<ModelId, Error> {
        let Some(shape) = rigid.shape(id) else {
            return Err(ViewError::ShapeIndex {
                body: 0,
                shape: id,
                shapes: rigid.shapes().len(),
            }
            .into());
        };
        let density = mass / shape.volume;
        if let Some(&model) = self.by_shape.get(&(id, density.to_bits())) {
            return Ok(model);
        }
        let (mesh, field) = mesh_of(shape, options.mesh_size)?;
        // The mass is that of the surface, which the mesh may cut off in places.
        let region = MaterialRegion {
            material: NeoHookean::new(options.young, options.poisson)?.into(),
            density: mass / mesh.volume(),
        };
        let model = DeformableModel::new(&mesh, options.element, vec![region], None)?;
        let stiffness = ContactStiffness::Law;
        let model = world.add_model_with_field(&shape.name, model, stiffness, field)?;
        self.by_shape.insert((id, density.to_bits()), model);
        Ok(model)
    }
}

/// Tetrahedra of a shape, and the contact field that it has as a rigid body.
fn mesh_of(shape: &Shape, size: f64) -> Result<(TetMesh, Field), Error> {
    if let Some((mesh, field)) = &shape.mesh {
        return Ok((mesh.clone(), *field));
    }
    let surface = surface_of(shape);
    let options = options_of(&surface, size);
    let (mesh, report) = tet::mesh(&surface, &options)?;
    if report.method == Method::CentroidFan || mesh.surface()?.is_convex() {
        return Ok((mesh, Field::Gauge));
    }
    // A lattice fitted to a round body or to many faces is not convex, as the gauge requires. A fan about the
    // centroid has the body's own skin, whatever the shapes of the tetrahedra.
    let fan = MeshOptions {
        method: Some(Method::CentroidFan),
        min_dihedral: 0.0,
        ..options
    };
    let (mesh, _) = tet::mesh(&surface, &fan)?;
    Ok((mesh, Field::Gauge))
}

/// Friction force on B and torsion of each pair.
fn starts(rigid: &World) -> BTreeMap<(Partner, BodyId), (Vector3, f64)> {
    let mut starts = BTreeMap::new();
    for contact in rigid.rigid_contacts() {
        let start = starts
            .entry((contact.a, contact.b))
            .or_insert((Vector3::zeros(), 0.0));
        start.0 += contact.friction;
        start.1 += contact.torsion;
    }
    starts
}

/// Mean stresses of the bodies, from their elements and from their contacts.
fn means(world: &World) -> Result<Vec<BodyMean>, Error> {
    let mut bodies = Vec::new();
    for body in world.deformables() {
        let stresses = body.stresses().map_err(SolveError::from)?;
        let (mut sum, mut volume, mut largest) = (Matrix3::zeros(), 0.0, 0.0_f64);
        for (stress, reference) in stresses.iter().zip(body.model().volumes()) {
            let v = reference * stress.volume_ratio;
            sum += stress.cauchy * v;
            volume += v;
            largest = largest.max(stress.von_mises());
        }
        let centre = body.centroid();
        let forces = body.positions().iter().zip(body.contact_forces());
        let nodes: Matrix3 = forces.map(|(x, f)| f * (x - centre).transpose()).sum();
        bodies.push(BodyMean {
            elements: sum / volume,
            nodes: symmetric(&nodes) / volume,
            contacts: Matrix3::zeros(),
            largest_von_mises: largest,
            volume,
        });
    }
    let centres: Vec<Vector3> = world.deformables().map(|d| d.centroid()).collect();
    for contact in world.contacts() {
        let mut add = |i: u32, force: Vector3| {
            if let (Some(body), Some(centre)) =
                (bodies.get_mut(i as usize), centres.get(i as usize))
            {
                let product = force * (contact.point - centre).transpose();
                body.contacts += symmetric(&product) / body.volume;
            }
        };
        let force = contact.force_on_b();
        add(contact.b, force);
        if let Partner::Body(a) = contact.a {
            add(a, -force);
        }
    }
    Ok(bodies)
}
