//! From a packing job to its results: the snapshot, the summary, and the files in a folder.

mod container;
mod display;
mod facts;
mod parts;
mod saved;
mod search;
mod summary;

use std::path::Path;

use femdem_analysis::{PeriodicSpace, Table};
use femdem_contact::{BodyId, Contact, RigidContact};
use femdem_mesh::{Point3, Polyhedron, Vector3};
use femdem_pack::Packing;
use femdem_solve::{Shape, World};

pub(crate) use display::percent;
pub use facts::run_facts;
pub use parts::{ContainerSummary, ShapeSummary};
pub use saved::{PACK_CHECKPOINT, PackPart, SavedPack, save};
pub use search::find_contacts;
pub use summary::{
    ContactLawSummary, CoordinationSummary, Core, DensitySummary, EnergySummary,
    PenetrationSummary, ResidualSummary, SCHEMA, Summary, Usage,
};

use crate::{Body, ContactClass, ContactRow, Error, Gaps, NamedShape, Partner, Patch, Snapshot};
use femdem_view::output::{csv, surface, vtp, vtu, write_file};
use femdem_view::picture::{PictureOptions, draw};

/// The present state of a job's pack, as plain data.
#[must_use]
pub fn snapshot(packing: &Packing) -> Snapshot {
    let world = packing.world();
    let shapes = world.shapes().iter().map(|shape| NamedShape {
        name: shape.name.clone(),
        polyhedron: surface_of(shape),
    });
    // A packing removes no body: their numbers are those of the rows.
    let bodies = world.body_ids().filter_map(|id| {
        Some(Body {
            shape: world.shape_of(id)?,
            pose: world.pose(id)?,
            sequence: packing.sequence(id)?,
            sleeping: world.is_asleep(id),
        })
    });
    let space = world.cell().map(|cell| PeriodicSpace {
        cell: *cell,
        lower: Point3::from(-0.5 * cell.edges().diagonal()),
    });
    let mut snapshot = Snapshot {
        shapes: shapes.collect(),
        bodies: bodies.collect(),
        contacts: world
            .rigid_contacts()
            .into_iter()
            .map(|contact| row(world, contact))
            .collect(),
        drawing: container::drawing(packing),
        container: container::inside(packing),
        space,
        vessel: container::vessel(packing),
        masses: world.body_ids().filter_map(|id| world.mass(id)).collect(),
        velocities: world
            .body_ids()
            .filter_map(|id| world.velocity(id))
            .collect(),
        gravity: packing.spec().gravity,
        gaps: Gaps::default(),
    };
    snapshot.wrap();
    snapshot
}

/// The surface with which a shape is drawn and measured: that of a sphere is a polyhedron of the same volume, so that
/// densities are those of the sphere.
pub(crate) fn surface_of(shape: &Shape) -> Polyhedron {
    let own = &shape.polyhedron;
    let larger = shape.sphere.and_then(|_| {
        let ratio = shape.volume / own.mass_properties().volume;
        own.scaled(ratio.cbrt()).ok()
    });
    larger.unwrap_or_else(|| own.clone())
}

/// Radius of each shape of a world that is an exact ball \[m\], for what measures bodies as they are:
/// [`Solids::with_balls`](femdem_analysis::pores::Solids::with_balls). Their surfaces in a [`Snapshot`] are polyhedra
/// of the same volume.
#[must_use]
pub fn ball_radii(world: &World) -> Vec<Option<f64>> {
    world.shapes().iter().map(|shape| shape.sphere).collect()
}

/// The sides of a contact of `a` and `b` as those of a row, which starts from a body: this, its partner, and the sign of
/// what acts on `b` as it acts on the partner.
pub(crate) fn from_a_body(
    world: &World,
    a: femdem_contact::Partner,
    b: BodyId,
) -> (BodyId, Partner, f64) {
    match a {
        femdem_contact::Partner::Body(a) => (a, Partner::Body(b), 1.0),
        femdem_contact::Partner::Wall(wall) => {
            let name = world.wall(wall).map_or("wall", |w| w.name());
            (b, Partner::Wall(name.to_owned()), -1.0)
        }
    }
}

/// A contact record as a row that starts from a body.
pub(crate) fn row(world: &World, contact: &RigidContact) -> ContactRow {
    let (body, partner, sign) = from_a_body(world, contact.a, contact.b);
    let (normal_force, friction) = Contact::from(contact).parts();
    ContactRow {
        body,
        partner,
        point: Point3::from(contact.point),
        normal: contact.normal * sign,
        normal_force,
        friction: friction * sign,
        moment: moment(contact) * sign,
        area: contact.area,
        volume: contact.volume,
        class: ContactClass::of_patch(&Patch {
            area: contact.area,
            volume: contact.volume,
            energy: contact.energy,
            force: contact.elastic_force,
            stiffness: contact.foundation.stiffness,
            diameter: mean_diameter(world, contact),
        }),
        patch: contact.patch,
    }
}

/// Moment on side B about the contact point \[N m\]: the elastic one, scaled by damping like the normal force,
/// that of the dashpot of the rattle, rolling friction, torsion, and that of attraction.
fn moment(contact: &RigidContact) -> Vector3 {
    let scale = if contact.elastic_force > 0.0 {
        contact.normal_force / contact.elastic_force
    } else {
        0.0
    };
    let springs = contact.moment * scale + contact.normal * contact.torsion;
    springs + contact.rocking + contact.rolling + contact.adhesion.moment
}

/// Mean circumscribed diameter of the bodies of a contact \[m\].
fn mean_diameter(world: &World, contact: &RigidContact) -> f64 {
    let diameter = |body| {
        let shape = world.shape(world.shape_of(body)?)?;
        Some(2.0 * shape.polyhedron.bounding_radius())
    };
    let of_b = diameter(contact.b).unwrap_or_default();
    match contact.a {
        femdem_contact::Partner::Body(a) => 0.5 * (diameter(a).unwrap_or_default() + of_b),
        femdem_contact::Partner::Wall(_) => of_b,
    }
}

/// Measures a pack and writes every file except the checkpoint; `summary.json` is written last, so that it
/// exists only if all others do.
///
/// # Errors
///
/// [`Error::View`] with the file that could not be written, [`Error::Analysis`] if the pack cannot
/// be measured.
pub fn write(folder: &Path, packing: &Packing, usage: &Usage) -> Result<Summary, Error> {
    let mut snapshot = snapshot(packing);
    let summary = Summary::of(packing, &snapshot, usage)?;
    write_file(folder.join("bodies.csv"), |w| {
        csv::write_bodies(&snapshot, w)
    })?;
    write_file(folder.join("contacts.csv"), |w| {
        csv::write_contacts(&snapshot, w)
    })?;
    write_file(folder.join("sieve.csv"), |w| summary.sieve.write_csv(w))?;
    write_file(folder.join("pack.vtu"), |w| vtu::write(&snapshot, w))?;
    write_file(folder.join("contacts.vtp"), |w| vtp::write(&snapshot, w))?;
    write_file(folder.join("pack.stl"), |w| {
        surface::write_pack_stl(&snapshot, w)
    })?;
    let names: Vec<&str> = snapshot.shapes.iter().map(|s| s.name.as_str()).collect();
    for (shape, file) in snapshot
        .shapes
        .iter()
        .zip(surface::shape_file_names(&names))
    {
        write_file(folder.join(file), |w| {
            surface::write_shape_obj(&shape.polyhedron, w)
        })?;
    }
    // The picture takes the most memory of all, and shows no contacts.
    snapshot.contacts = Vec::new();
    let picture = draw(&snapshot, &PictureOptions::default())?;
    write_file(folder.join("pack.png"), |w| picture.write_png(w))?;
    write_file(folder.join("summary.json"), |w| summary.write_json(w))?;
    Ok(summary)
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_solve::WorldParameters;

    /// A sphere is measured with its volume, other bodies as they are.
    #[test]
    fn surfaces_have_the_volume_of_their_bodies() {
        let mut world = World::new(WorldParameters::default()).unwrap();
        world.add_sphere("ball", 0.3).unwrap();
        let own = world.shapes()[0].polyhedron.clone();
        world.add_shape("facets", &own).unwrap();
        for shape in world.shapes() {
            let volume = surface_of(shape).mass_properties().volume;
            assert!((volume / shape.volume - 1.0).abs() < 1e-12);
        }
        assert_eq!(surface_of(&world.shapes()[1]), own);
    }
}
