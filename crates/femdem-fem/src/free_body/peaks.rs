//! The largest stresses of a free body, and an estimate of its tension from its forces alone.

use super::{FreeBody, PatchLoad, Solved};
use crate::model::ElementStress;
use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

/// Tension over F/d² in the middle of a ball of diameter d between two opposite forces F. By Y. Hiramatsu and Y. Oka, Int. J.
/// Rock Mech. Min. Sci. 3 (1966) 89-90 it fits bodies of any shape, d between the forces. The exact value for point forces is
/// 21/(pi (7 + 5 nu)): 0.95 to 0.70.
pub const SPLITTING: f64 = 0.9;

/// Nodes nearer to a contact than this part of the inscribed diameter do not count as away from it: as far as the middle of a ball
/// counts. There the tension beside a point force on a half-space, (1 - 2 nu) F/(2 pi r^2), is 0.4 F/d² for nu = 0.22.
const NEAR: f64 = 0.48;

/// Contacts whose force is at most this part of the largest are none: the stress beside them is that of the others.
const NEGLIGIBLE: f64 = 1e-6;

/// Largest stresses at the nodes of a body, Pa.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Largest principal stress away from contacts: farther from the place of each on the skin than 0.48 inscribed diameters.
    /// `None` if all nodes are near one. Contacts of at most 1e-6 of the largest force do not count.
    pub tension: Option<f64>,
    /// Largest von Mises stress there.
    pub von_mises: Option<f64>,
    /// Largest principal stress of all nodes.
    pub tension_anywhere: f64,
    /// Largest von Mises stress of all nodes.
    pub von_mises_anywhere: f64,
}

impl FreeBody {
    /// The largest stresses, away from the contacts `loads` and anywhere.
    #[must_use]
    pub fn peaks(&self, solved: &Solved, loads: &[PatchLoad]) -> Peaks {
        let mut peaks = Peaks {
            tension: None,
            von_mises: None,
            tension_anywhere: f64::NEG_INFINITY,
            von_mises_anywhere: 0.0,
        };
        let reach = NEAR * self.inscribed;
        let sizes = loads.iter().map(|load| load.force.norm());
        let least = NEGLIGIBLE * sizes.fold(0.0, f64::max);
        let pressing = loads.iter().filter(|load| load.force.norm() > least);
        let on_skin = |load: &PatchLoad| Some(self.places.on_skin(&load.point)?.1);
        let contacts: Vec<Point3> = pressing.filter_map(on_skin).collect();
        for (point, cauchy) in self.model.mesh().points().iter().zip(solved.corners()) {
            let stress = ElementStress {
                cauchy: *cauchy,
                volume_ratio: 1.0,
            };
            let ([tension, ..], von_mises) = (stress.principal(), stress.von_mises());
            peaks.tension_anywhere = peaks.tension_anywhere.max(tension);
            peaks.von_mises_anywhere = peaks.von_mises_anywhere.max(von_mises);
            if contacts
                .iter()
                .all(|contact| (point - contact).norm() > reach)
            {
                let larger = |old: Option<f64>, new: f64| Some(old.map_or(new, |old| old.max(new)));
                peaks.tension = larger(peaks.tension, tension);
                peaks.von_mises = larger(peaks.von_mises, von_mises);
            }
        }
        peaks
    }

    /// About the tension (Pa) by which two opposite forces of the size `force` (N) split the body, without a solve: 0.9 F/d² with
    /// the inscribed diameter d. It is no bound: bodies that bend have more.
    #[must_use]
    pub fn splitting_estimate(&self, force: f64) -> f64 {
        SPLITTING * force / self.inscribed.powi(2)
    }
}
