//! Deformable bodies that come into a world, and what moves their nodes.

use std::mem::MaybeUninit;

use femdem_solve::fem::{Boundary, DeformableModel, Selection};
use femdem_solve::mesh::nalgebra::Translation3;
use femdem_solve::mesh::tet::{self, MeshOptions};
use femdem_solve::mesh::{Pose, Rotation, TetMesh, Vector3};
use femdem_solve::{ContactStiffness, Deformable, DeformableSpec, ModelId};

use super::query::no_such;
use super::{FemdemDrive, Hosted};
use crate::border::{Failure, FemdemStatus, border, given, list, place, points};
use crate::handles::{FemdemShape, FemdemWorld};
use crate::law::material;
use crate::matter::{FemdemFracture, FemdemMatter};
use crate::plain::FemdemMotion;

/// Size of the tetrahedra in diameters of the shape, as in scenes.
const MESH_SIZE: f64 = 0.2;

/// Volumes that differ by less are equal to rounding.
const EXACT: f64 = 1e-9;

/// Axes of femdem_world_drive_nodes: x.
pub const FEMDEM_AXIS_X: u32 = 1;
/// Axes of femdem_world_drive_nodes: y.
pub const FEMDEM_AXIS_Y: u32 = 2;
/// Axes of femdem_world_drive_nodes: z.
pub const FEMDEM_AXIS_Z: u32 = 4;

impl Hosted {
    /// Bodies of tetrahedra that have the mass of a `volume`: a mesh that is not exact cuts off what is convex.
    fn add_model(
        &mut self,
        name: &str,
        mesh: &TetMesh,
        volume: f64,
        matter: &FemdemMatter,
    ) -> Result<ModelId, Failure> {
        let mut region = matter.region()?;
        let factor = volume / mesh.volume();
        if (factor - 1.0).abs() > EXACT {
            region.density *= factor;
        }
        let model = DeformableModel::new(mesh, matter.element()?, vec![region], None)?;
        let stiffness = ContactStiffness::Ratio(matter.contact_ratio);
        let world = &mut self.world;
        Ok(self
            .threads
            .run(|| world.add_model(name, model, stiffness))?)
    }

    /// A deformable body by its number.
    pub(super) fn deformable(&self, body: u32) -> Result<Deformable<'_>, Failure> {
        let count = self.world.deformable_count();
        let found = self.world.deformable(body);
        found.ok_or_else(|| no_such("deformable body", body, count))
    }
}

/// Makes a model of deformable bodies from tetrahedra: `point_count` points, three coordinates in m each, and `tet_count`
/// tetrahedra, four numbers of points each, the last on the side from which the first three are clockwise. Its points are its
/// first nodes, in the coordinates that are given; quadratic elements add those in the middle of edges. Bodies of one shape and
/// matter share a model, which stays as long as the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_add_model(
    world: FemdemWorld,
    points: *const f64,
    point_count: usize,
    tets: *const u32,
    tet_count: usize,
    matter: Option<&FemdemMatter>,
    model: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let (to, matter) = (place("model", model)?, given("matter", matter)?);
        // SAFETY: as the caller promises.
        let points = unsafe { self::points("points", points, point_count)? };
        // SAFETY: an array of four numbers has the layout of four numbers; the rest the caller promises.
        let tets = unsafe { list("tets", tets.cast::<[u32; 4]>(), tet_count)? };
        let mesh = TetMesh::new(points, tets.to_vec())?;
        world.with(|own| {
            to.write(own.add_model("tetrahedra", &mesh, mesh.volume(), matter)?);
            Ok(())
        })
    })
}

/// Makes a model of a shape, which is filled with tetrahedra; `mesh_size` is their size over the diameter of the shape, 0: 0.2. Its
/// origin is the centroid, and bodies have the mass that the surface of the shape encloses.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_add_model_of_shape(
    world: FemdemWorld,
    shape: FemdemShape,
    mesh_size: f64,
    matter: Option<&FemdemMatter>,
    model: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let (to, matter) = (place("model", model)?, given("matter", matter)?);
        if !(0.0..=1.0).contains(&mesh_size) {
            let allowed = "above 0 and at most 1, in diameters; 0 for 0.2";
            return Err(Failure::refused("mesh_size", mesh_size, allowed));
        }
        let form = shape.form()?;
        let size = if mesh_size > 0.0 {
            mesh_size
        } else {
            MESH_SIZE
        };
        let options = MeshOptions {
            edge_length: Some(size * 2.0 * form.surface.bounding_radius()),
            ..MeshOptions::default()
        };
        let (mesh, _) = tet::mesh(&form.surface, &options)?;
        let volume = form.surface.mass_properties().volume;
        world.with(|own| {
            to.write(own.add_model(form.name(), &mesh, volume, matter)?);
            Ok(())
        })
    })
}

/// Adds a deformable body of a model. The pose of `motion` takes the coordinates of the model to the world, and its velocities are
/// those of the centroid. With a `fracture` it may break; null: it does not. Its number is the lowest that is free, of rigid
/// bodies and deformable ones together.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_add_deformable(
    world: FemdemWorld,
    model: u32,
    motion: Option<&FemdemMotion>,
    fracture: Option<&FemdemFracture>,
    material_id: u32,
    body: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let (to, motion) = (place("body", body)?, given("motion", motion)?);
        let [velocity, angular_velocity] = motion.velocity.parts();
        let spec = DeformableSpec {
            velocity,
            angular_velocity,
            material: material(material_id)?,
            fracture: fracture.map(FemdemFracture::fracture).transpose()?,
            ..DeformableSpec::at_rest(model, motion.pose.checked()?)
        };
        world.with(|own| {
            let world = &mut own.world;
            let added = own.threads.run(|| world.add_deformable(spec));
            // Nothing is in motion yet that could have left physical bounds.
            to.write(added.map_err(|error| Failure::new(FemdemStatus::Refused, error))?);
            Ok(())
        })
    })
}

/// Moves nodes of a deformable body as prescribed along some axes, the sum of FEMDEM_AXIS constants, counted from where they are;
/// a drive of FEMDEM_DRIVE_FIXED holds them. It replaces an earlier one of the same nodes and axes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_drive_nodes(
    world: FemdemWorld,
    body: u32,
    nodes: *const u32,
    node_count: usize,
    axes: u32,
    drive: Option<&FemdemDrive>,
) -> FemdemStatus {
    border(|| {
        let drive = given("drive", drive)?.drive()?;
        if !(1..=7).contains(&axes) {
            let allowed = "a sum of FEMDEM_AXIS constants";
            return Err(Failure::refused("axes", axes, allowed));
        }
        let components = [FEMDEM_AXIS_X, FEMDEM_AXIS_Y, FEMDEM_AXIS_Z].map(|x| axes & x != 0);
        // SAFETY: as the caller promises.
        let nodes = unsafe { list("nodes", nodes, node_count)? };
        world.with(|own| {
            let (soft, now) = (own.deformable(body)?, own.world.time());
            drive.validate()?;
            let driven = drive.at(now);
            let base = |x: &Vector3| {
                let here = Pose::from_parts(Translation3::from(*x), Rotation::identity());
                driven.base_of(&here).translation.vector
            };
            let places: Vec<Vector3> = soft.positions().iter().map(base).collect();
            let chosen = Selection::Nodes(nodes.to_vec());
            let mut boundary = soft.boundary().clone();
            boundary.drive_from(soft.model(), &chosen, components, drive, &places)?;
            Ok(own.world.set_boundary(body, boundary)?)
        })
    })
}

/// Sets all driven nodes of a deformable body free.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_release(world: FemdemWorld, body: u32) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            own.deformable(body)?;
            Ok(own.world.set_boundary(body, Boundary::default())?)
        })
    })
}
