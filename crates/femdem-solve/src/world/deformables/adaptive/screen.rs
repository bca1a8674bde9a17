//! What has changed in the contact forces of a rigid body since its last static solve.
//!
//! Stress is linear in the forces, and the ratio of stress to strength is convex and grows in proportion: if r is used by the forces F now and
//! c is what a unit force uses, forces F' use about r + c Σ (|F' − F| + |M' − M|/d + |F| s), over the patches of contact, with their moments M
//! and the inscribed diameter d; s is by how much the patch has moved, in d, and its area has shrunk, in itself. It is an estimate: c is
//! found at some of the skin's nodes, and a force is spread otherwise than on one node.

use femdem_contact::{BodyId, Contact, Partner};
use femdem_mesh::{Point3, Pose, Vector3};
use serde::{Deserialize, Serialize};

/// Stresses are found again once the forces have changed by this part of what they were at the last solve.
const GROWN: f64 = 0.05;

/// The force of a patch is another one if its point has moved by more than this part of the inscribed diameter.
const MOVED: f64 = 0.05;

/// The last static solve of a rigid body. Without one nothing acted on it.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Screen {
    /// The part of its strength that its stresses used.
    ratio: f64,
    /// The forces of its patches then.
    forces: Vec<Pressed>,
}

/// The force of a patch, in the coordinates of the body.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Pressed {
    by: Partner,
    /// N.
    force: Vector3,
    /// N m.
    moment: Vector3,
    /// m.
    point: Vector3,
    /// m^2.
    area: f64,
}

impl Screen {
    pub fn new(ratio: f64, forces: Vec<Pressed>) -> Self {
        Self { ratio, forces }
    }

    /// Whether the stresses under these forces may use `limit` of the strength and are not known from the last solve, for a body of which a
    /// unit force uses `unit` (1/N) and with the inscribed diameter `reach` (m).
    pub fn is_due(&self, [unit, reach]: [f64; 2], now: &[Pressed], limit: f64) -> bool {
        let change = self.change(now, reach);
        let known: f64 = self.forces.iter().map(|old| old.size(reach)).sum();
        change >= GROWN * known && self.ratio + unit * change >= limit
    }

    /// Sum of the changes of the forces, N: each patch of a partner is the nearest one that this had. `reach` is the inscribed diameter, m.
    fn change(&self, now: &[Pressed], reach: f64) -> f64 {
        let mut is_met = vec![false; self.forces.len()];
        let mut change = 0.0;
        for new in now {
            let way = |old: &Pressed| (old.point - new.point).norm();
            let own = (0..self.forces.len()).filter(|i| {
                let old = &self.forces[*i];
                !is_met[*i] && old.by == new.by && way(old) <= MOVED * reach
            });
            let nearest =
                own.min_by(|i, j| way(&self.forces[*i]).total_cmp(&way(&self.forces[*j])));
            change += match nearest {
                Some(i) => {
                    is_met[i] = true;
                    new.change_from(&self.forces[i], reach)
                }
                None => new.size(reach),
            };
        }
        let gone = self.forces.iter().zip(&is_met).filter(|(_, met)| !**met);
        change + gone.map(|(old, _)| old.size(reach)).sum::<f64>()
    }
}

impl Pressed {
    fn size(&self, reach: f64) -> f64 {
        self.force.norm() + self.moment.norm() / reach
    }

    fn change_from(&self, old: &Self, reach: f64) -> f64 {
        let other = (self.force - old.force).norm() + (self.moment - old.moment).norm() / reach;
        let moved = (self.point - old.point).norm() / reach;
        let shrunk = if self.area < old.area {
            1.0 - self.area / old.area
        } else {
            0.0
        };
        other + self.force.norm() * (moved + shrunk)
    }
}

/// The forces of the contacts of body `id`, whose coordinates `pose` maps to the world.
pub(super) fn pressed<'a>(
    id: BodyId,
    pose: &Pose,
    contacts: impl Iterator<Item = &'a Contact>,
) -> Vec<Pressed> {
    let back = pose.inverse();
    let own = |contact: &Contact| {
        let (sign, by) = match contact.a {
            a if contact.b == id => (1.0, a),
            _ => (-1.0, Partner::Body(contact.b)),
        };
        Pressed {
            by,
            force: back * contact.force_on_b() * sign,
            moment: back * (contact.rocking + contact.rolling) * sign,
            point: (back * Point3::from(contact.point)).coords,
            area: contact.area,
        }
    };
    contacts.map(own).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed(by: Partner, x: f64, force: f64) -> Pressed {
        Pressed {
            by,
            force: Vector3::x() * force,
            moment: Vector3::zeros(),
            point: Vector3::x() * x,
            area: 1e-6,
        }
    }

    /// A body of 1 cm that is jammed in a wall which goes round it: the forces on its sides are opposite, and their sum is none.
    #[test]
    fn opposite_forces_of_one_partner_are_a_change() {
        let wall = Partner::Wall(0);
        let jam = |force: f64| [pressed(wall, -0.005, force), pressed(wall, 0.005, -force)];
        let screen = Screen {
            ratio: 0.0,
            forces: jam(10.0).to_vec(),
        };
        assert_eq!(screen.change(&jam(10.0), 0.01), 0.0);
        assert!((screen.change(&jam(35.0), 0.01) - 50.0).abs() < 1e-9);
        assert!((screen.change(&[], 0.01) - 20.0).abs() < 1e-9);
        // The other order of the same patches is no change.
        let [one, two] = jam(10.0);
        assert_eq!(screen.change(&[two, one], 0.01), 0.0);
    }

    /// A solve that found 0.69 is not made again each time that forces creep: only once they have changed by a twentieth.
    #[test]
    fn stresses_are_found_again_once_forces_have_grown() {
        let wall = Partner::Wall(0);
        let jam = |force: f64| [pressed(wall, -0.005, force), pressed(wall, 0.005, -force)];
        let screen = Screen::new(0.69, jam(10.0).to_vec());
        let is_due = |force: f64, unit: f64| screen.is_due([unit, 0.01], &jam(force), 0.7);
        assert!(!is_due(10.4, 1.0));
        assert!(is_due(10.6, 1.0));
        assert!(is_due(9.4, 1.0));
        // The estimate is 0.69 + 1.2 × 0.008.
        assert!(!is_due(10.6, 0.008));
        let unloaded = Screen::default();
        assert!(!unloaded.is_due([1.0, 0.01], &[], 0.7));
        assert!(unloaded.is_due([0.5, 0.01], &jam(0.8), 0.7));
        assert!(!unloaded.is_due([0.5, 0.01], &jam(0.6), 0.7));
    }

    #[test]
    fn moments_and_smaller_areas_are_changes() {
        let screen = Screen {
            ratio: 0.0,
            forces: vec![pressed(Partner::Wall(0), 0.0, 10.0)],
        };
        let mut now = screen.forces.clone();
        now[0].moment = Vector3::y() * 0.02;
        assert!((screen.change(&now, 0.01) - 2.0).abs() < 1e-12);
        let mut now = screen.forces.clone();
        now[0].area /= 4.0;
        assert!((screen.change(&now, 0.01) - 7.5).abs() < 1e-12);
    }
}
