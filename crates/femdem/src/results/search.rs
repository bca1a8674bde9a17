//! Contacts found from poses and shapes alone.

use femdem_analysis::Region;
use femdem_contact::{ContactParameters, Field, Wall, WallShape};
use femdem_mesh::Vector3;
use femdem_mesh::tet::{self, MeshOptions};
use femdem_solve::{BodySpec, Drive, SleepParameters, TimeStepParameters, World, WorldParameters};

use super::row;
use crate::{Error, Partner, Snapshot};

/// Nominal penalty \[Pa\] and density \[kg/m³\]: neither the places nor the classes of contacts depend on them.
const PENALTY: f64 = 1e6;
const DENSITY: f64 = 1e3;

/// A step in which nothing moves \[s\].
const STEP: f64 = 1e-15;

/// Planes of the mantle of a cylinder.
const FACETS: usize = 96;

/// Finds the contacts of a snapshot that has none from the overlaps of its bodies, and of these with the walls of its
/// container: "floor" and "x-", "x+", "y-", "y+", or "mantle", without a lid.
///
/// Points, normals, areas, overlap volumes, classes and patches are those that a simulation of these bodies has. Forces are not
/// known from overlaps: those of the rows belong to a nominal penalty without friction, and the
/// [`gaps`](Snapshot::gaps) say so. A body that is not convex is filled with tetrahedra of the default size.
///
/// ```
/// use femdem::mesh::{Pose, catalogue::CatalogueShape};
/// use femdem::{Body, Gaps, NamedShape, Snapshot, results};
///
/// // Two cubes with edges of 1 m, one on the other.
/// let polyhedron = "P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?;
/// let at = |z: f64| Body { shape: 0, pose: Pose::translation(0.0, 0.0, z), sequence: 0, sleeping: false };
/// let mut snapshot = Snapshot {
///     shapes: vec![NamedShape { name: "cube".to_owned(), polyhedron }],
///     bodies: vec![at(0.5), at(1.499)],
///     gaps: Gaps { contacts: true, ..Gaps::default() },
///     ..Snapshot::default()
/// };
/// results::find_contacts(&mut snapshot)?;
/// assert_eq!(snapshot.contacts.len(), 1);
/// assert!((snapshot.contacts[0].area - 1.0).abs() < 1e-9 && snapshot.gaps.forces);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`Error::Mesh`] for a body that cannot be meshed, [`Error::Solve`] for one that is too thin for contacts, and what
/// [`Snapshot::check`] refuses. The snapshot is then unchanged.
pub fn find_contacts(snapshot: &mut Snapshot) -> Result<(), Error> {
    snapshot.check()?;
    let mut world = World::new(WorldParameters {
        gravity: Vector3::zeros(),
        contact: ContactParameters {
            penalty: PENALTY,
            friction: 0.0,
            damping_ratio: 0.0,
            ..ContactParameters::default()
        },
        time_step: TimeStepParameters {
            largest: Some(STEP),
            ..TimeStepParameters::default()
        },
        sleeping: SleepParameters {
            enabled: false,
            ..SleepParameters::default()
        },
        ..WorldParameters::default()
    })?;
    for shape in &snapshot.shapes {
        let surface = &shape.polyhedron;
        if surface.is_convex() {
            world.add_shape(&shape.name, surface)?;
        } else {
            let (mesh, _) = tet::mesh(surface, &MeshOptions::default())?;
            world.add_mesh_shape(&shape.name, surface, &mesh, Field::Body)?;
        }
    }
    for body in &snapshot.bodies {
        world.add_body(BodySpec::at_rest(body.shape, DENSITY, body.pose))?;
    }
    if let Some(container) = &snapshot.container {
        for wall in walls(container)? {
            world.add_wall(wall, Drive::Fixed)?;
        }
    }
    world.step()?;
    let contacts = world.rigid_contacts().into_iter();
    snapshot.contacts = contacts.map(|contact| row(&world, contact)).collect();
    debug_assert!(snapshot.contacts.iter().all(|row| match row.partner {
        Partner::Body(other) => (other as usize) < snapshot.bodies.len(),
        Partner::Wall(_) => true,
    }));
    snapshot.gaps.contacts = false;
    snapshot.gaps.forces = true;
    snapshot.gaps.friction = true;
    Ok(())
}

/// The floor and the upright walls of a region; none of a sphere.
fn walls(region: &Region) -> Result<Vec<WallShape>, Error> {
    let plane = |name: &str, normal: Vector3, offset: f64| -> Result<WallShape, Error> {
        Ok(Wall::half_space(name, normal, offset)?.into())
    };
    match region {
        Region::Sphere { .. } => Ok(Vec::new()),
        Region::Box { min, max } => Ok(vec![
            plane("floor", Vector3::z(), min.z)?,
            plane("x-", Vector3::x(), min.x)?,
            plane("x+", -Vector3::x(), -max.x)?,
            plane("y-", Vector3::y(), min.y)?,
            plane("y+", -Vector3::y(), -max.y)?,
        ]),
        Region::Cylinder {
            centre,
            radius,
            z_min,
            ..
        } => {
            let mantle = Wall::cylinder("mantle", *radius, FACETS)?;
            let [x, y] = *centre;
            let mut planes = mantle.planes().to_vec();
            for plane in &mut planes {
                plane.offset += plane.normal.x * x + plane.normal.y * y;
            }
            Ok(vec![
                plane("floor", Vector3::z(), *z_min)?,
                Wall::new("mantle", planes)?.into(),
            ])
        }
    }
}
