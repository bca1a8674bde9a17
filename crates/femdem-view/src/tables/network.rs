//! A snapshot in the form that the analysis of forces takes.

use femdem_analysis::{ForceBody, ForceContact, Partner};

use crate::{Body, Partner as Other, Snapshot};

/// Bodies and contacts as plain data, and the names of the walls by their numbers.
pub(super) struct Data {
    pub(super) bodies: Vec<ForceBody>,
    pub(super) contacts: Vec<ForceContact>,
    pub(super) walls: Vec<String>,
}

impl Data {
    /// From a snapshot that has passed [`Snapshot::check`].
    pub(super) fn of(snapshot: &Snapshot) -> Self {
        let body = |(k, body): (usize, &Body)| {
            let polyhedron = &snapshot.shape_of(body).polyhedron;
            let properties = polyhedron.mass_properties();
            ForceBody {
                centre: body.pose * properties.centroid,
                volume: properties.volume,
                diameter: 2.0 * polyhedron.bounding_radius(),
                weight: snapshot.masses.get(k).map_or(0.0, |m| m * snapshot.gravity),
            }
        };
        let mut walls: Vec<String> = Vec::new();
        let mut number = |name: &String| {
            let known = walls.iter().position(|wall| wall == name);
            known.unwrap_or_else(|| {
                walls.push(name.clone());
                walls.len() - 1
            }) as u32
        };
        let contacts = snapshot.contacts.iter().map(|row| ForceContact {
            first: row.body,
            second: match &row.partner {
                Other::Body(other) => Partner::Body(*other),
                Other::Wall(name) => Partner::Wall(number(name)),
            },
            point: row.point,
            normal: row.normal,
            normal_force: row.normal_force,
            tangential: row.friction,
            moment: row.moment,
            class: (!snapshot.gaps.classes).then_some(row.class),
        });
        Self {
            contacts: contacts.collect(),
            bodies: snapshot.bodies.iter().enumerate().map(body).collect(),
            walls,
        }
    }
}
