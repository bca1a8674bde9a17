//! Numbers of face-face, edge-face and point contacts.

use serde::{Deserialize, Serialize};

use crate::class::ContactClass;
use crate::coordination::Partner;
use crate::network::ForceNetwork;
use crate::table::{Cell, Table};

/// Contacts of one class.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClassCount {
    /// Number of contacts.
    pub contacts: u64,
    /// Their share of all contacts of the kind, 0 to 1.
    pub share: f64,
    /// Mean size of their normal forces, pressing or pulling (N); 0 without contacts.
    pub mean_force: f64,
    /// Their share of the sum of these, 0 to 1.
    pub force_share: f64,
}

/// Contacts by class: face-face, edge-face, point, and last those of unknown class.
///
/// Every patch counts, so that a pair may count in two classes. Contacts of pairs below the network's threshold
/// are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactClasses {
    /// Between bodies.
    pub bodies: [ClassCount; 4],
    /// With walls.
    pub walls: [ClassCount; 4],
}

/// Counts contacts by class, those with walls apart.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let body = |x| ForceBody { centre: Point3::new(x, 0.0, 0.0), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let contact = |second, class, normal_force| ForceContact {
///     first: 0, second, point: Point3::origin(), normal: Vector3::x(), normal_force,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: Some(class),
/// };
/// let bodies = [body(0.0), body(1.0), body(2.0)];
/// let contacts = [
///     contact(Partner::Body(1), ContactClass::Point, 1.0),
///     contact(Partner::Body(2), ContactClass::EdgeFace, 3.0),
///     contact(Partner::Wall(0), ContactClass::FaceFace, 2.0),
/// ];
/// let classes = contact_classes(&ForceNetwork::new(&bodies, &contacts, 0.0)?);
/// assert_eq!(classes.bodies.map(|c| c.contacts), [0, 1, 1, 0]);
/// assert_eq!(classes.bodies[1].force_share, 0.75);
/// assert_eq!(classes.walls[0].share, 1.0);
/// # Ok::<(), AnalysisError>(())
/// ```
#[must_use]
pub fn contact_classes(network: &ForceNetwork) -> ContactClasses {
    let mut classes = ContactClasses::default();
    for contact in network.touching_contacts() {
        let side = match contact.second {
            Partner::Body(_) => &mut classes.bodies,
            Partner::Wall(_) => &mut classes.walls,
        };
        let known = |class| ContactClass::ALL.iter().position(|c| *c == class);
        let entry = &mut side[contact.class.and_then(known).unwrap_or(3)];
        entry.contacts += 1;
        // A sum until all are counted.
        entry.mean_force += contact.normal_force.abs();
    }
    finish(&mut classes.bodies);
    finish(&mut classes.walls);
    classes
}

fn finish(side: &mut [ClassCount; 4]) {
    let contacts: u64 = side.iter().map(|c| c.contacts).sum();
    let force: f64 = side.iter().map(|c| c.mean_force).sum();
    for class in side {
        if class.contacts == 0 {
            continue;
        }
        class.share = class.contacts as f64 / contacts as f64;
        class.force_share = if force > 0.0 {
            class.mean_force / force
        } else {
            0.0
        };
        class.mean_force /= class.contacts as f64;
    }
}

impl Table for ContactClasses {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "partner",
            "class",
            "contacts",
            "share",
            "mean_force_n",
            "force_share",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let names = ContactClass::ALL.map(ContactClass::name);
        let rows = [("body", &self.bodies), ("wall", &self.walls)];
        Box::new(rows.into_iter().flat_map(move |(partner, side)| {
            let names = names.into_iter().chain(["unknown"]);
            names.zip(side).map(move |(name, class)| {
                vec![
                    partner.into(),
                    name.into(),
                    class.contacts.into(),
                    class.share.into(),
                    class.mean_force.into(),
                    class.force_share.into(),
                ]
            })
        }))
    }
}
