//! The contacts of a snapshot as loads on its bodies.

use femdem_fem::free_body::PatchLoad;
use femdem_mesh::Vector3;

use crate::{Error, Partner, Snapshot};

/// The other side of a contact.
#[derive(Clone, Copy, PartialEq)]
enum Side<'a> {
    Body(u32),
    Wall(&'a str),
}

/// The patches of a body's contacts, with whom they are.
#[derive(Clone, Default)]
pub(super) struct Loads<'a> {
    /// In the coordinates of its shape; normals point into the body.
    pub patches: Vec<PatchLoad>,
    sides: Vec<Side<'a>>,
}

impl Loads<'_> {
    /// Largest force of a partner \[N\]: that of its patches together that press from the same side, as those of a face on a body
    /// that is not convex do.
    pub fn largest(&self) -> f64 {
        let all = || self.patches.iter().zip(&self.sides);
        let together = |(patch, side): (&PatchLoad, &Side)| {
            let alike = all().filter(|(p, s)| *s == side && p.normal.dot(&patch.normal) > 0.0);
            alike.map(|(p, _)| p.force).sum::<Vector3>().norm()
        };
        all().map(together).fold(0.0, f64::max)
    }
}

/// The loads on every body.
///
/// # Errors
///
/// [`Error::NoForces`] if the contacts or their forces are not known.
pub(super) fn of_bodies(snapshot: &Snapshot) -> Result<Vec<Loads<'_>>, Error> {
    let gaps = snapshot.gaps;
    let missing = [
        (
            gaps.contacts,
            "the contacts are not known: add a contacts.csv",
        ),
        (
            gaps.forces,
            "the contacts were found from overlaps, without forces: add a contacts.csv with forces",
        ),
        (
            gaps.friction,
            "the contacts have no friction forces as vectors: add the columns tx, ty, tz to contacts.csv",
        ),
    ];
    if let Some((_, what)) = missing.into_iter().find(|(is_missing, _)| *is_missing) {
        return Err(Error::NoForces { what });
    }
    let mut loads = vec![Loads::default(); snapshot.bodies.len()];
    for row in &snapshot.contacts {
        let on_partner = row.normal * row.normal_force + row.friction;
        let mut add = |i: u32, sign: f64, side| {
            let body = &snapshot.bodies[i as usize];
            let shape = &snapshot.shapes[body.shape as usize].polyhedron;
            let centre = body.pose * shape.mass_properties().centroid;
            // In periodic space the image of the contact nearest to the body.
            let way = row.point - centre;
            let way = snapshot
                .space
                .map_or(way, |space| space.cell.shortest(&way));
            let own = &mut loads[i as usize];
            own.sides.push(side);
            let patch = PatchLoad {
                point: centre + way,
                normal: row.normal * sign,
                area: row.area,
                force: on_partner * sign,
                moment: row.moment * sign,
            };
            own.patches.push(patch.seen_from(&body.pose));
        };
        match &row.partner {
            Partner::Body(other) => {
                add(row.body, -1.0, Side::Body(*other));
                add(*other, 1.0, Side::Body(row.body));
            }
            Partner::Wall(wall) => add(row.body, -1.0, Side::Wall(wall)),
        }
    }
    Ok(loads)
}
