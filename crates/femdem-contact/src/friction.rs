//! Friction of a contact patch: anchors in both bodies, a torsion spring, and the limit surface
//! ([`crate::limit_surface`]).
//!
//! The patch is a bristle foundation: its tangential modulus is `r` times the normal one, so k_t = r K and
//! k_theta = r J. The spring is stretched between two anchor points that are fixed in the two bodies; a rigid
//! motion of the pair leaves it unchanged. As the patch moves, the anchors are placed around its new contact
//! point with the stretch unchanged. The stretch still grows by the motion of the material at the patch, on
//! which the force does work; otherwise bodies that roll and turn alternately would gain energy.

use crate::damping::{Birth, against_lag};
use crate::kernel::Overlap;
use crate::law::ContactParameters;
use crate::limit_surface::LimitSurface;
use crate::motion::Motion;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// The anchors follow the patch once it has moved by this fraction of the arm of B. The stored stiffness, by
/// which the stretch is scaled, follows the present one once it has changed by this fraction. Smaller changes
/// are rounding, by which bodies at rest far from the origin of a wall would creep.
pub(crate) const FOLLOW: f64 = 1e-9;

/// Friction history of one patch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrictionState {
    /// Anchor in A's axes, m from A's origin.
    anchor_a: Vector3,
    /// Anchor in B's axes, m from B's origin.
    anchor_b: Vector3,
    /// Torsion angle about the normal, rad.
    torsion: f64,
    /// Stiffnesses of the springs in the last step, N/m and N m/rad.
    stiffness: f64,
    torsion_stiffness: f64,
}

/// Settings of the friction of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pace {
    /// Time since the last call, s.
    pub dt: f64,
    /// Whether the dashpots beside the springs act. If not, the springs of a sliding patch carry what the
    /// dashpots would leave of the bound, and the viscosities are returned all the same.
    pub dashpots: bool,
    /// Factor of the patch's dashpots over those that it would have alone.
    pub share: f64,
    /// Correction for a new patch.
    pub birth: Option<Birth>,
}

impl Pace {
    /// The viscosity applied in this step, corrected for the velocity lag ([`against_lag`]) and for a new
    /// patch ([`Birth`]). Without `dashpots` it is not corrected: an implicit host applies the dashpots
    /// itself.
    fn acting(&self, viscosity: f64, inverse_mass: f64) -> f64 {
        let weight = self.birth.map_or(1.0, |birth| birth.weight);
        if self.dashpots {
            viscosity * weight * against_lag(viscosity * inverse_mass, self.dt, 1.0)
        } else {
            viscosity
        }
    }
}

/// Friction of one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Friction {
    /// Force on B at the contact point, N.
    pub force: Vector3,
    /// Moment on B about the normal, N m.
    pub torsion: f64,
    /// The parts of both due to dashpots.
    pub drag: Vector3,
    pub drag_torsion: f64,
    /// Energy stored in both springs, J.
    pub energy: f64,
    /// Springs and dashpots, for the step bound: N/m, N s/m.
    pub stiffness: f64,
    pub viscosity: f64,
    /// N m s.
    pub torsion_viscosity: f64,
    /// Largest inverse masses of A and B for a tangential force, 1/kg.
    pub inverse_mass: [f64; 2],
    /// Whether the patch slides.
    pub slides: bool,
}

/// The present springs of a patch, or a part of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Springs {
    /// The patch's point from A's origin, world axes, m.
    pub point: Vector3,
    /// x_B(X_B) - x_A(X_A), m.
    pub stretch: Vector3,
    /// Torsion angle, rad.
    pub torsion: f64,
    /// N/m.
    pub stiffness: f64,
    /// N m/rad.
    pub torsion_stiffness: f64,
}

impl Springs {
    /// The springs of a fraction `part` of the bristles.
    pub fn share(&self, part: f64) -> Self {
        Self {
            stiffness: self.stiffness * part,
            torsion_stiffness: self.torsion_stiffness * part,
            ..*self
        }
    }

    /// Merges several foundations into one. Its stretch and torsion are the rigid motion about `normal` that
    /// fits the stretched bristles by least squares, weighted with their stiffness. It carries the same force
    /// and torsion and stores no more energy.
    pub fn merged(parts: &[Self], normal: &Vector3) -> Option<Self> {
        let stiffness: f64 = parts.iter().map(|p| p.stiffness).sum();
        if stiffness <= 0.0 {
            return None;
        }
        let mean = |f: fn(&Self) -> Vector3| {
            parts.iter().map(|p| f(p) * p.stiffness).sum::<Vector3>() / stiffness
        };
        let (point, stretch) = (mean(|p| p.point), mean(|p| p.stretch));
        let (mut torsion_stiffness, mut moment) = (0.0, 0.0);
        for p in parts {
            let arm = p.point - point;
            let lever = normal.cross(&arm);
            torsion_stiffness += p.torsion_stiffness + p.stiffness * lever.norm_squared();
            moment +=
                p.torsion_stiffness * p.torsion + p.stiffness * lever.dot(&(p.stretch - stretch));
        }
        Some(Self {
            point,
            stretch,
            torsion: if torsion_stiffness > 0.0 {
                moment / torsion_stiffness
            } else {
                0.0
            },
            stiffness,
            torsion_stiffness,
        })
    }

    /// The stretch of the bristles at another point of the patch's plane.
    pub fn stretch_at(&self, point: &Vector3, normal: &Vector3) -> Vector3 {
        self.stretch + normal.cross(&(point - self.point)) * self.torsion
    }

    /// Energy in the plane across `normal`, J.
    pub fn energy(&self, normal: &Vector3) -> f64 {
        let along = normal.dot(&self.stretch);
        let square = self.stretch.norm_squared() - along * along;
        0.5 * (self.stiffness * square.max(0.0)
            + self.torsion_stiffness * self.torsion * self.torsion)
    }
}

impl FrictionState {
    /// The springs at the present poses of the bodies.
    pub(crate) fn springs(&self, a: &Motion, b: &Motion) -> Springs {
        let between = b.frame.position - a.frame.position;
        let on_a = a.frame.rotation * self.anchor_a;
        let on_b = between + b.frame.rotation * self.anchor_b;
        Springs {
            point: (on_a + on_b) * 0.5,
            stretch: on_b - on_a,
            torsion: self.torsion,
            stiffness: self.stiffness,
            torsion_stiffness: self.torsion_stiffness,
        }
    }

    /// A patch that takes over the given springs, at its own contact point.
    pub(crate) fn with_springs(
        overlap: &Overlap,
        a: &Motion,
        b: &Motion,
        springs: &Springs,
    ) -> Self {
        let n = &overlap.normal;
        let stretch = springs.stretch_at(&overlap.arm_a, n);
        let mut state = Self {
            torsion: springs.torsion,
            stiffness: springs.stiffness,
            torsion_stiffness: springs.torsion_stiffness,
            ..Self::new(overlap, a, b)
        };
        state.place(overlap, a, b, &(stretch - n * n.dot(&stretch)));
        state
    }

    /// A patch between places on A and B (m from their origins, world axes) whose springs carry a tangential force on B (N) and a
    /// moment on B about the normal (N m). `stiffness` are those of the springs, N/m and N m/rad.
    pub(crate) fn carrying(
        [on_a, on_b]: [Vector3; 2],
        [a, b]: [&Motion; 2],
        force: &Vector3,
        torsion: f64,
        [stiffness, torsion_stiffness]: [f64; 2],
    ) -> Self {
        let over = |load: f64, k: f64| if k > 0.0 { load / k } else { 0.0 };
        let half = force * over(-0.5, stiffness);
        Self {
            anchor_a: a.frame.rotation.tr_mul(&(on_a - half)),
            anchor_b: b.frame.rotation.tr_mul(&(on_b + half)),
            torsion: over(-torsion, torsion_stiffness),
            stiffness,
            torsion_stiffness,
        }
    }

    /// Shrinks stretch and torsion by a factor.
    pub(crate) fn relax(&mut self, overlap: &Overlap, a: &Motion, b: &Motion, scale: f64) {
        let stretch = self.stretch(overlap, a, b) * scale;
        self.torsion *= scale;
        self.place(overlap, a, b, &stretch);
    }

    /// Whether the patch has not been advanced by any step yet.
    pub(crate) fn is_new(&self) -> bool {
        self.stiffness == 0.0 && self.torsion_stiffness == 0.0
    }

    /// A patch that has just formed, unstretched.
    pub(crate) fn new(overlap: &Overlap, a: &Motion, b: &Motion) -> Self {
        Self {
            anchor_a: a.frame.rotation.tr_mul(&overlap.arm_a),
            anchor_b: b.frame.rotation.tr_mul(&overlap.arm_b),
            torsion: 0.0,
            stiffness: 0.0,
            torsion_stiffness: 0.0,
        }
    }

    /// Stretch of the spring, the tangential part of x_B(X_B) - x_A(X_A), m.
    fn stretch(&self, overlap: &Overlap, a: &Motion, b: &Motion) -> Vector3 {
        let between = overlap.arm_a - overlap.arm_b;
        let apart = between + b.frame.rotation * self.anchor_b - a.frame.rotation * self.anchor_a;
        apart - overlap.normal * overlap.normal.dot(&apart)
    }

    /// Puts the anchors around the contact point so that the stretch is `stretch`.
    fn place(&mut self, overlap: &Overlap, a: &Motion, b: &Motion, stretch: &Vector3) {
        let half = stretch * 0.5;
        self.anchor_a = a.frame.rotation.tr_mul(&(overlap.arm_a - half));
        self.anchor_b = b.frame.rotation.tr_mul(&(overlap.arm_b + half));
    }

    /// The stretch (m) for the present tangential stiffness `k` (N/m). A stiffer patch keeps its force, a
    /// softer one its stretch, so that neither gains energy. A patch without stiffness keeps nothing and
    /// starts unstretched once it has some.
    fn carried(&self, stretch: Vector3, k: f64) -> Vector3 {
        if k == 0.0 {
            Vector3::zeros()
        } else if k > self.stiffness * (1.0 + FOLLOW) && self.stiffness > 0.0 {
            stretch * (self.stiffness / k)
        } else {
            stretch
        }
    }

    /// As [`carried`](Self::carried), for the torsion (rad) and its stiffness (N m/rad).
    fn carried_torsion(&self, torsion: f64, k: f64) -> f64 {
        if k == 0.0 {
            0.0
        } else if k > self.torsion_stiffness && self.torsion_stiffness > 0.0 {
            torsion * (self.torsion_stiffness / k)
        } else {
            torsion
        }
    }

    /// Advances the patch by one step and returns its friction.
    ///
    /// `normal_force` is the total normal force, N.
    pub(crate) fn update(
        &mut self,
        law: &ContactParameters,
        overlap: &Overlap,
        normal_force: f64,
        a: &Motion,
        b: &Motion,
        pace: Pace,
    ) -> Friction {
        let n = overlap.normal;
        let spin = n.dot(&(b.angular_velocity - a.angular_velocity));
        let slip = {
            let v = b.velocity_at(&overlap.arm_b) - a.velocity_at(&overlap.arm_a);
            v - n * n.dot(&v)
        };
        let k = law.tangential_ratio * overlap.foundation.stiffness;
        let k_theta = law.tangential_ratio * overlap.foundation.polar();
        let before = self.stretch(overlap, a, b);
        let (mut stretch, mut torsion) = match pace.birth {
            Some(birth) => (slip * birth.since, spin * birth.since),
            None => (before, self.torsion + spin * pace.dt),
        };
        stretch = self.carried(stretch, k);
        torsion = self.carried_torsion(torsion, k_theta);
        let inverse_mass = [
            a.inverse_mass_at(&overlap.arm_a),
            b.inverse_mass_at(&overlap.arm_b),
        ];
        let inverse_inertia = n.dot(&(a.inverse_inertia * n)) + n.dot(&(b.inverse_inertia * n));
        let zeta = law.tangential_damping * pace.share;
        let viscosity = dashpot(zeta, k, inverse_mass[0] + inverse_mass[1]);
        let torsion_viscosity = dashpot(zeta, k_theta, inverse_inertia);
        let drag = slip * pace.acting(viscosity, inverse_mass[0] + inverse_mass[1]);
        let twist_drag = spin * pace.acting(torsion_viscosity, inverse_inertia);
        let mut force = -stretch * k - drag;
        let mut moment = -k_theta * torsion - twist_drag;
        let most = law.friction * normal_force;
        let bounds = LimitSurface {
            force: most,
            moment: most * overlap.torsion_radius,
        };
        let within = bounds.within(force.norm(), moment.abs(), k, k_theta);
        let slides = within != [1.0; 2];
        if slides {
            force *= within[0];
            moment *= within[1];
            stretch = sliding_stretch(&force, &drag, k);
            torsion = sliding_torsion(moment, twist_drag, k_theta);
        }
        let drift = overlap.arm_b + stretch * 0.5 - b.frame.rotation * self.anchor_b;
        let drift = drift - n * n.dot(&drift);
        let reach = FOLLOW * overlap.arm_b.norm();
        if stretch != before || drift.norm_squared() > reach * reach {
            self.place(overlap, a, b, &stretch);
        }
        self.torsion = torsion;
        if (k - self.stiffness).abs() > FOLLOW * self.stiffness {
            self.stiffness = k;
        }
        self.torsion_stiffness = k_theta;
        let springs = (-stretch * k, -k_theta * torsion);
        if !pace.dashpots {
            (force, moment) = springs;
        }
        Friction {
            force,
            torsion: moment,
            drag: force - springs.0,
            drag_torsion: moment - springs.1,
            energy: 0.5 * (k * stretch.norm_squared() + k_theta * torsion * torsion),
            stiffness: k,
            viscosity,
            torsion_viscosity,
            inverse_mass,
            slides,
        }
    }
}

/// Stretch (m) of a spring that slides under the bound `force` (N). The spring carries what the dashpot force
/// `drag` (N) leaves of the bound, and never pushes along the slip.
fn sliding_stretch(force: &Vector3, drag: &Vector3, k: f64) -> Vector3 {
    let spring = force + drag;
    if spring.dot(force) > 0.0 {
        -spring / k
    } else {
        Vector3::zeros()
    }
}

/// As [`sliding_stretch`], for the torsion (rad) under a moment (N m).
fn sliding_torsion(moment: f64, drag: f64, k: f64) -> f64 {
    let spring = moment + drag;
    if k > 0.0 && spring * moment > 0.0 {
        -spring / k
    } else {
        0.0
    }
}

/// Viscosity of a fraction `zeta` of critical damping.
pub(crate) fn dashpot(zeta: f64, stiffness: f64, inverse_mass: f64) -> f64 {
    if inverse_mass > 0.0 {
        2.0 * zeta * (stiffness / inverse_mass).sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foundation::Foundation;
    use crate::shape::Frame;

    /// A body around the centre of another overlaps it with zero force and stiffness, up to rounding: the friction stays finite and within its bound.
    #[test]
    fn an_overlap_without_stiffness_gives_finite_friction() {
        let mut body = Motion::fixed(Frame::identity());
        body.inverse_mass = 1.0;
        body.inverse_inertia_max = 1.0;
        let mut moving = body;
        moving.velocity = Vector3::new(0.3, -1.0, 0.2);
        moving.angular_velocity = Vector3::new(1.0, 2.0, 3.0);
        for stiffness in [0.0, 1e-16] {
            let overlap = Overlap {
                force: Vector3::z() * 1e-17,
                moment: Vector3::zeros(),
                arm_a: Vector3::zeros(),
                arm_b: Vector3::zeros(),
                normal: Vector3::z(),
                energy: 0.1,
                volume: 1.0,
                area: 0.0,
                foundation: Foundation::round(Vector3::zeros(), Vector3::x(), stiffness, 0.0),
                torsion_radius: 0.5,
            };
            let mut state = FrictionState::new(&overlap, &body, &moving);
            for _ in 0..3 {
                let law = ContactParameters::default();
                let pace = Pace {
                    dt: 1e-3,
                    dashpots: true,
                    share: 1.0,
                    birth: None,
                };
                let friction = state.update(&law, &overlap, 1e-17, &body, &moving, pace);
                let size = friction.force.norm();
                assert!(
                    size <= 1e-17 * law.friction * (1.0 + 1e-12),
                    "{stiffness}: {size}"
                );
                assert!(friction.torsion.abs() <= 1e-17 && friction.energy.is_finite());
            }
        }
    }

    /// A patch that had no stiffness for a while restarts without stretch, however far the bodies have moved
    /// meanwhile.
    #[test]
    fn springs_without_stiffness_hold_nothing() {
        let overlap = |stiffness: f64| Overlap {
            force: Vector3::z(),
            moment: Vector3::zeros(),
            arm_a: Vector3::zeros(),
            arm_b: Vector3::zeros(),
            normal: Vector3::z(),
            energy: 0.1,
            volume: 1.0,
            area: 1.0,
            foundation: Foundation::round(Vector3::zeros(), Vector3::x(), stiffness, stiffness),
            torsion_radius: 0.5,
        };
        let law = ContactParameters {
            friction: 10.0,
            tangential_damping: 0.0,
            ..ContactParameters::default()
        };
        let pace = Pace {
            dt: 1e-3,
            dashpots: true,
            share: 1.0,
            birth: None,
        };
        let fixed = Motion::fixed(Frame::identity());
        let mut body = fixed;
        let mut state = FrictionState::new(&overlap(1.0), &fixed, &body);
        let mut push = |x: f64, stiffness: f64| {
            body.frame.position.x = x;
            // The patch stays where B's centre is.
            let overlap = Overlap {
                arm_a: Vector3::x() * x,
                ..overlap(stiffness)
            };
            state.update(&law, &overlap, 1.0, &fixed, &body, pace)
        };
        let ratio = law.tangential_ratio;
        assert!((push(0.1, 1.0).force.x / (-0.1 * ratio) - 1.0).abs() < 1e-12);
        assert_eq!(push(0.3, 0.0).force, Vector3::zeros());
        assert_eq!(push(0.4, 0.0).energy, 0.0);
        assert_eq!(push(0.4, 1.0).force, Vector3::zeros());
        assert!((push(0.5, 1.0).force.x / (-0.1 * ratio) - 1.0).abs() < 1e-9);
    }

    /// Bristles stretched by a rigid motion of their plane are split and merged again without loss. Others
    /// lose energy when they are merged into one rigid motion, and keep their force and torsion.
    #[test]
    fn bristles_taken_apart_and_put_together() {
        let normal = Vector3::new(1.0, 2.0, 2.0) / 3.0;
        let whole = Springs {
            point: Vector3::new(0.1, -0.2, 0.3),
            stretch: Vector3::new(2e-3, -1e-3, 0.0),
            torsion: 0.01,
            stiffness: 5.0,
            torsion_stiffness: 0.7,
        };
        let across = Vector3::new(2.0, -1.0, 0.0);
        let part = |share: f64, arm: f64| {
            let mut part = whole.share(share);
            part.point += across * arm;
            part.stretch = whole.stretch_at(&part.point, &normal);
            part
        };
        let parts = [part(0.25, 0.3), part(0.75, -0.1)];
        let lever: f64 = 5.0 * across.norm_squared() * (0.25 * 0.09 + 0.75 * 0.01);
        let merged = Springs::merged(&parts, &normal).unwrap();
        assert!((merged.point - whole.point).norm() < 1e-15);
        assert!((merged.stretch - whole.stretch).norm() < 1e-15);
        assert!((merged.torsion - whole.torsion).abs() < 1e-15);
        assert!((merged.torsion_stiffness - 0.7 - lever).abs() < 1e-14);
        let sum = parts[0].energy(&normal) + parts[1].energy(&normal);
        assert!((merged.energy(&normal) / sum - 1.0).abs() < 1e-12);

        let mut odd = parts;
        odd[0].stretch += across * 1e-3;
        odd[1].torsion *= -1.0;
        let merged = Springs::merged(&odd, &normal).unwrap();
        let sum = odd[0].energy(&normal) + odd[1].energy(&normal);
        assert!(merged.energy(&normal) < 0.9 * sum);
        let force: Vector3 = odd.iter().map(|p| p.stretch * p.stiffness).sum();
        assert!((merged.stretch * merged.stiffness - force).norm() < 1e-15);
        assert_eq!(Springs::merged(&[whole.share(0.0)], &normal), None);
    }
}
