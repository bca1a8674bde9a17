//! The contacts of a snapshot as loads on its bodies.

use femdem_fem::free_body::PatchLoad;

use crate::{Error, Partner, Snapshot};

/// The loads on every body, in the coordinates of its shape.
///
/// # Errors
///
/// [`Error::NoForces`] if the contacts or their forces are not known.
pub(super) fn of_bodies(snapshot: &Snapshot) -> Result<Vec<Vec<PatchLoad>>, Error> {
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
    let mut loads = vec![Vec::new(); snapshot.bodies.len()];
    for row in &snapshot.contacts {
        let on_partner = row.normal * row.normal_force + row.friction;
        let mut add = |i: u32, sign: f64| {
            let body = &snapshot.bodies[i as usize];
            let shape = &snapshot.shapes[body.shape as usize].polyhedron;
            let centre = body.pose * shape.mass_properties().centroid;
            // In periodic space the image of the contact nearest to the body.
            let way = row.point - centre;
            let way = snapshot
                .space
                .map_or(way, |space| space.cell.shortest(&way));
            let back = body.pose.inverse();
            loads[i as usize].push(PatchLoad {
                point: back * (centre + way),
                normal: back * row.normal,
                area: row.area,
                force: back * (on_partner * sign),
                moment: back * (row.moment * sign),
            });
        };
        add(row.body, -1.0);
        if let Partner::Body(other) = row.partner {
            add(other, 1.0);
        }
    }
    Ok(loads)
}
