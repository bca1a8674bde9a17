//! Forces of the pack on each wall.

use serde::{Deserialize, Serialize};

use crate::coordination::Partner;
use crate::network::ForceNetwork;
use crate::table::{Cell, Table};

/// Force of the pack on one wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallForce {
    /// Number of the wall.
    pub wall: u32,
    /// Number of contacts.
    pub contacts: u64,
    /// Force on the wall (N), friction included.
    pub force: [f64; 3],
    /// Sum of the normal forces (N).
    pub normal_force: f64,
    /// Sum of the magnitudes of the friction forces over that of the normal ones: the mobilised friction.
    pub mobilised_friction: f64,
}

/// Force of the pack on each wall that it touches, by number.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallForces {
    /// The walls.
    pub walls: Vec<WallForce>,
}

/// Sums the contacts with each wall.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let bodies = [ForceBody { centre: Point3::origin(), volume: 1.0, diameter: 1.0, weight: 4.0 }];
/// let contacts = [ForceContact {
///     first: 0, second: Partner::Wall(7), point: Point3::origin(), normal: -Vector3::z(), normal_force: 4.0,
///     tangential: Vector3::x(), moment: Vector3::zeros(), class: None,
/// }];
/// let walls = wall_forces(&ForceNetwork::new(&bodies, &contacts, 0.0)?).walls;
/// assert_eq!((walls[0].wall, walls[0].force), (7, [1.0, 0.0, -4.0]));
/// assert_eq!(walls[0].mobilised_friction, 0.25);
/// # Ok::<(), AnalysisError>(())
/// ```
#[must_use]
pub fn wall_forces(network: &ForceNetwork) -> WallForces {
    let mut on_walls: Vec<_> = network
        .contacts()
        .iter()
        .filter_map(|contact| match contact.second {
            Partner::Wall(wall) => Some((wall, contact)),
            Partner::Body(_) => None,
        })
        .collect();
    on_walls.sort_by_key(|(wall, _)| *wall);
    let groups = on_walls.chunk_by(|a, b| a.0 == b.0);
    let wall = |group: &[(u32, &crate::ForceContact)]| {
        let (wall, _) = *group.first()?;
        let contacts = || group.iter().map(|(_, contact)| contact);
        let normal: f64 = contacts().map(|c| c.normal_force).sum();
        let friction: f64 = contacts().map(|c| c.tangential.norm()).sum();
        Some(WallForce {
            wall,
            contacts: group.len() as u64,
            force: contacts()
                .map(|c| c.force())
                .sum::<femdem_mesh::Vector3>()
                .into(),
            normal_force: normal,
            mobilised_friction: if normal > 0.0 { friction / normal } else { 0.0 },
        })
    };
    WallForces {
        walls: groups.filter_map(wall).collect(),
    }
}

impl Table for WallForces {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "wall",
            "contacts",
            "force_x_n",
            "force_y_n",
            "force_z_n",
            "normal_force_n",
            "mobilised_friction",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.walls.iter().map(|w| {
            let [x, y, z] = w.force;
            vec![
                w.wall.into(),
                w.contacts.into(),
                x.into(),
                y.into(),
                z.into(),
                w.normal_force.into(),
                w.mobilised_friction.into(),
            ]
        }))
    }
}
