//! Stresses inside the bodies of a rigid pack, body by body: a linear static solve each, under the forces of the contacts as
//! they stand, on a factorisation that is made once for each shape.
//!
//! [`resolve`](crate::resolve) instead deforms the whole pack until it is at rest again: minutes where this takes seconds.
//!
//! ```
//! use femdem::mesh::catalogue::{CatalogueShape, Solid};
//! use femdem::pack::{Container, PackShape, PackSpec, Packing};
//! use femdem::stresses::{StressOptions, stresses};
//!
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(0.02)?;
//! let mut packing = Packing::new(PackSpec {
//!     shapes: vec![PackShape::new("cube", cube)],
//!     count: 4,
//!     container: Container::Box { width: 0.05, depth: 0.05 },
//!     ..PackSpec::default()
//! })?;
//! packing.run()?;
//! let snapshot = femdem::results::snapshot(&packing);
//! let options = StressOptions { mesh_size: 0.4, ..StressOptions::default() };
//! let gravity = packing.world().parameters().gravity;
//! let found = stresses(&snapshot, &[], Some(gravity), &options)?;
//! assert!(found.bodies.iter().all(|body| body.residual < 1e-6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod files;
mod loads;
mod summary;

use std::sync::Arc;

use femdem_fem::element::Element;
use femdem_fem::free_body::{FreeBody, PatchLoad, Peaks, Solved};
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Matrix3, Polyhedron, TetMesh, Vector3, tet};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::meshing::options_of;
use crate::resolve::ResolveOptions;
use crate::{Error, Snapshot};

use loads::Loads;
pub use summary::{Quantiles, StressSummary};

/// The material of the bodies, their meshes, and what is kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressOptions {
    /// Young's modulus \[Pa\]. It scales the displacements alone.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Target edge length of the tetrahedra, in circumscribed diameters of the body.
    pub mesh_size: f64,
    /// Elements: T4 or T10.
    pub element: Element,
    /// Tensile strength \[Pa\], if cracks are asked for.
    pub strength: Option<f64>,
    /// Most bodies of which displacements and stresses of the elements are kept; none of more.
    pub most_fields: usize,
}

impl Default for StressOptions {
    /// Stone as [`ResolveOptions`] has it, in quadratic elements.
    fn default() -> Self {
        let ResolveOptions { young, poisson, .. } = ResolveOptions::default();
        Self {
            young,
            poisson,
            mesh_size: 0.2,
            element: Element::T10,
            strength: None,
            most_fields: 1000,
        }
    }
}

/// The stresses of a body. Tensors are in the axes of the world, tension positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyStress {
    /// Index of its shape in the snapshot.
    pub shape: u32,
    /// Volume of its surface \[m³\].
    pub volume: f64,
    /// Number of its contacts.
    pub contacts: u32,
    /// [`FreeBody::splitting_estimate`] of the largest force of a partner \[Pa\].
    pub splitting: f64,
    /// The largest stresses.
    pub peaks: Peaks,
    /// Mean stress of the elements \[Pa\].
    pub elements: Matrix3,
    /// Love-Weber with one force at the point of each contact \[Pa\]: symmetric part of (1/V) Σ f ⊗ (x − c).
    pub contacts_mean: Matrix3,
    /// Net force, weight included, over the sum of the sizes of the contact forces: 0 at rest. `None` without contact forces, and if
    /// gravity, or a mass that it acts on, is not known.
    pub net_force: Option<f64>,
    /// [`Solved::residual`].
    pub residual: f64,
}

/// The elements of a body, and their stresses in its own axes.
type Field = (Arc<DeformableModel>, Solved);

/// The stresses of a pack.
#[derive(Debug)]
pub struct Stresses {
    /// By body of the snapshot.
    pub bodies: Vec<BodyStress>,
    /// Tetrahedra of all bodies together.
    pub tetrahedra: usize,
    /// Fields by body; empty if there are more than [`StressOptions::most_fields`].
    fields: Vec<Field>,
}

/// Finds the stresses of all bodies of a snapshot. `meshes` are tetrahedra for its shapes, by index, where the shape has its own;
/// others are meshed. `gravity` \[m/s²\], if it is known, is for the net forces alone. Forces other than those of contacts and gravity
/// are not known here: inertia balances what they leave. The work is done on the caller's rayon pool, a shape after the other, with
/// one factorisation in memory; results and errors are the same with any number of threads.
///
/// # Errors
///
/// [`Error::NoForces`] if the contacts or their forces are not known, [`Error::View`] as from [`Snapshot::check`],
/// [`Error::Mesh`] if a body cannot be meshed, and [`Error::Fem`] for options out of their range.
pub fn stresses(
    snapshot: &Snapshot,
    meshes: &[Option<TetMesh>],
    gravity: Option<Vector3>,
    options: &StressOptions,
) -> Result<Stresses, Error> {
    snapshot.check()?;
    check(options)?;
    let loads = loads::of_bodies(snapshot)?;
    let keep = snapshot.bodies.len() <= options.most_fields;
    let of_shape = |shape: usize| -> Result<Vec<Found>, Error> {
        let own = snapshot.bodies.iter().enumerate();
        let own: Vec<usize> = own
            .filter(|(_, body)| body.shape as usize == shape)
            .map(|(i, _)| i)
            .collect();
        if own.is_empty() {
            return Ok(Vec::new());
        }
        let surface = &snapshot.shapes[shape].polyhedron;
        let body = free_body(surface, meshes.get(shape).and_then(Option::as_ref), options)?;
        let solve = |&i: &usize| {
            let (stress, solved) = of_body(snapshot, i, gravity, &body, &loads[i])?;
            Ok(Found {
                body: i,
                stress,
                tetrahedra: body.model().volumes().len(),
                field: keep.then(|| (Arc::clone(body.model()), solved)),
            })
        };
        // All first, then the first error in their order.
        let all: Vec<Result<Found, Error>> = own.par_iter().map(solve).collect();
        all.into_iter().collect()
    };
    let mut found = Vec::new();
    for shape in 0..snapshot.shapes.len() {
        found.extend(of_shape(shape)?);
    }
    found.sort_by_key(|found| found.body);
    Ok(Stresses {
        bodies: found.iter().map(|found| found.stress).collect(),
        tetrahedra: found.iter().map(|found| found.tetrahedra).sum(),
        fields: found.into_iter().filter_map(|found| found.field).collect(),
    })
}

/// The result of a body.
struct Found {
    body: usize,
    stress: BodyStress,
    tetrahedra: usize,
    field: Option<Field>,
}

fn check(options: &StressOptions) -> Result<(), Error> {
    let refuse = |name, value: f64, allowed| {
        Err(Error::Option {
            name,
            value: value.to_string(),
            allowed,
        })
    };
    let size = options.mesh_size;
    if !(size > 0.0 && size.is_finite()) {
        return refuse("mesh-size", size, "give a length in d, above 0");
    }
    match options.strength {
        Some(strength) if !(strength > 0.0 && strength.is_finite()) => {
            refuse("strength", strength, "give a stress in Pa, above 0")
        }
        _ => Ok(()),
    }
}

fn free_body(
    surface: &Polyhedron,
    own: Option<&TetMesh>,
    options: &StressOptions,
) -> Result<FreeBody, Error> {
    let meshed = match own {
        Some(mesh) => mesh.clone(),
        None => tet::mesh(surface, &options_of(surface, options.mesh_size))?.0,
    };
    let region = MaterialRegion {
        material: NeoHookean::new(options.young, options.poisson)?.into(),
        // The balance of a homogeneous body does not depend on its density.
        density: 1.0,
    };
    let model = DeformableModel::new(&meshed, options.element, vec![region], None)?;
    Ok(FreeBody::new(Arc::new(model))?)
}

fn of_body(
    snapshot: &Snapshot,
    i: usize,
    gravity: Option<Vector3>,
    free: &FreeBody,
    loads: &Loads<'_>,
) -> Result<(BodyStress, Solved), Error> {
    let body = snapshot.bodies[i];
    let properties = snapshot.shapes[body.shape as usize]
        .polyhedron
        .mass_properties();
    let largest = loads.largest();
    let loads = &loads.patches;
    let solved = free.solve_patches(loads)?;
    let first = |load: &PatchLoad| load.force * (load.point - properties.centroid).transpose();
    let first: Matrix3 = loads.iter().map(first).sum();
    let turn = body.pose.rotation.to_rotation_matrix();
    let in_world = |stress: &Matrix3| {
        turn.matrix() * crate::means::symmetric(stress) * turn.matrix().transpose()
    };
    let sizes: f64 = loads.iter().map(|load| load.force.norm()).sum();
    let weight = gravity.and_then(|gravity| {
        if gravity == Vector3::zeros() {
            return Some(gravity);
        }
        Some(gravity * *snapshot.masses.get(i)?)
    });
    let net = weight.filter(|_| sizes > 0.0).map(|weight| {
        let sum: Vector3 = loads.iter().map(|load| load.force).sum();
        (body.pose.rotation * sum + weight).norm() / sizes
    });
    let stress = BodyStress {
        shape: body.shape,
        volume: properties.volume,
        contacts: loads.len() as u32,
        splitting: free.splitting_estimate(largest),
        peaks: free.peaks(&solved, loads),
        elements: in_world(solved.mean()),
        contacts_mean: in_world(&(first / properties.volume)),
        net_force: net,
        residual: solved.residual(),
    };
    Ok((stress, solved))
}
