//! The largest stresses of a free body, and a bound of them from its forces alone.

use super::{FreeBody, PatchLoad, Solved};
use crate::model::ElementStress;
use serde::{Deserialize, Serialize};

/// Tension over F/d² in the middle of a ball of diameter d between two opposite forces F. By Y. Hiramatsu and Y. Oka, Int. J.
/// Rock Mech. Min. Sci. 3 (1966) 89-90 it fits bodies of any shape, d between the forces. The exact value for point forces is
/// 21/(pi (7 + 5 nu)): 0.95 to 0.70.
pub const SPLITTING: f64 = 0.9;

/// Nodes nearer to a contact than this part of the inscribed diameter do not count as away from it. There the tension beside a
/// point force on a half-space, (1 - 2 nu) F/(2 pi r^2), is 0.6 F/d² for nu = 0.22, below that in the middle of a ball.
const NEAR: f64 = 0.4;
/// The same in radii of the contact's disc.
const NEAR_IN_RADII: f64 = 2.0;

/// Largest stresses at the nodes of a body, Pa.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Largest principal stress away from contacts: farther from each than 0.4 inscribed diameters, and than twice its radius.
    /// `None` if all nodes are near one.
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
        let reach = |load: &PatchLoad| (NEAR * self.inscribed).max(NEAR_IN_RADII * load.radius());
        for (point, cauchy) in self.model.mesh().points().iter().zip(solved.corners()) {
            let stress = ElementStress {
                cauchy: *cauchy,
                volume_ratio: 1.0,
            };
            let ([tension, ..], von_mises) = (stress.principal(), stress.von_mises());
            peaks.tension_anywhere = peaks.tension_anywhere.max(tension);
            peaks.von_mises_anywhere = peaks.von_mises_anywhere.max(von_mises);
            if loads
                .iter()
                .all(|load| (point - load.point).norm() > reach(load))
            {
                let larger = |old: Option<f64>, new: f64| Some(old.map_or(new, |old| old.max(new)));
                peaks.tension = larger(peaks.tension, tension);
                peaks.von_mises = larger(peaks.von_mises, von_mises);
            }
        }
        peaks
    }

    /// About the largest tension by which opposing forces split the body, without a solve: 0.9 F/d² (Pa) with the inscribed
    /// diameter d and the largest F with which two loads press towards each other along the line between their points. 0
    /// if none do.
    #[must_use]
    pub fn splitting_bound(&self, loads: &[PatchLoad]) -> f64 {
        let mut most = 0.0_f64;
        for (i, a) in loads.iter().enumerate() {
            for b in &loads[i + 1..] {
                if let Some(line) = (b.point - a.point).try_normalize(0.0) {
                    most = most.max(a.force.dot(&line).min(-b.force.dot(&line)));
                }
            }
        }
        SPLITTING * most / self.inscribed.powi(2)
    }
}
