//! Love-Weber stress of each body.

use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::{Stress, stress_columns};
use crate::network::{ForceNetwork, Load};
use crate::table::{Cell, Table};

/// Mean stress in a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyStress {
    /// The stress (Pa).
    pub stress: Stress,
    /// Net contact force on the body (N): minus its weight in equilibrium.
    pub net_force: [f64; 3],
    /// Net moment about its centre (N m): zero in equilibrium.
    pub net_moment: [f64; 3],
}

/// Mean stress in each body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyStresses {
    /// By body.
    pub bodies: Vec<BodyStress>,
}

/// Love-Weber stress of each body, from its contacts, walls included:
///
/// σ_ij = −(1/V) Σ_c [ f_i r_j − ½ ε_ijk m_k ],
///
/// with the force f on the body, its lever r from the body's centre of mass to the contact point, the moment m
/// about that point, and the body's own volume V. The minus sign makes compression positive. With the centre of
/// mass as the origin, the weight and any acceleration drop out of the sum. The single tractions of a patch are
/// not known. The moment gives the antisymmetric part of their first moment about the contact point. The
/// symmetric part is neglected; it is zero if the tractions have one direction and are proportional to the
/// pressure, and the point is the centre of pressure.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// // A cube of side 2 m, squeezed along x by 8 N between two walls.
/// let bodies = [ForceBody { centre: Point3::origin(), volume: 8.0, diameter: 3.5, weight: 0.0 }];
/// let contact = |x: f64, wall| ForceContact {
///     first: 0, second: Partner::Wall(wall), point: Point3::new(x, 0.0, 0.0), normal: Vector3::x() * x,
///     normal_force: 8.0, tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// let contacts = [contact(1.0, 0), contact(-1.0, 1)];
/// let found = body_stresses(&ForceNetwork::new(&bodies, &contacts, 0.0)?);
/// // Force over area: 8 N over 4 m².
/// assert_eq!(found.bodies[0].stress.tensor[0][0], 2.0);
/// assert_eq!(found.bodies[0].stress.deviator, 2.0);
/// # Ok::<(), AnalysisError>(())
/// ```
#[must_use]
pub fn body_stresses(network: &ForceNetwork) -> BodyStresses {
    let count = network.bodies().len();
    let mut moments = vec![Matrix3::zeros(); count];
    let mut net = vec![(Vector3::zeros(), Vector3::zeros()); count];
    for load in network.loads() {
        let body = load.body as usize;
        let lever = network.lever(&load);
        moments[body] += first_moment(&load, &lever);
        net[body].0 += load.force;
        net[body].1 += lever.cross(&load.force) + load.moment;
    }
    let sums = moments.iter().zip(&net).zip(network.bodies());
    let body = sums.map(|((moment, (force, couple)), body)| BodyStress {
        stress: Stress::of(&(-moment / body.volume)),
        net_force: (*force).into(),
        net_moment: (*couple).into(),
    });
    BodyStresses {
        bodies: body.collect(),
    }
}

/// f_i r_j − ½ ε_ijk m_k (N m): the first moment of the tractions of a contact.
fn first_moment(load: &Load, lever: &Vector3) -> Matrix3 {
    load.force * lever.transpose() - load.moment.cross_matrix().transpose() * 0.5
}

impl Table for BodyStresses {
    fn columns(&self) -> &'static [&'static str] {
        stress_columns!["body"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let rows = (0_u32..).zip(&self.bodies);
        Box::new(rows.map(|(body, b)| {
            std::iter::once(body.into())
                .chain(b.stress.cells())
                .collect()
        }))
    }
}
