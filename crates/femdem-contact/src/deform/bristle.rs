//! Friction of one triangle of the skin: a spring between points of both bodies.
//!
//! The spring is stretched between a point of A and a point of B, given in a tetrahedron's
//! barycentric coordinates or in a rigid body's axes, so that a common rigid motion leaves it
//! unchanged.
//!
//! In every step the points are put around the place where the pressure is, as far apart as the spring
//! is stretched across the normal, and so walk from tetrahedron to tetrahedron. While the triangle
//! sticks, the energy of the spring then changes by the work of its force, whatever way the pressure and
//! the normal move when bodies roll or rock on each other: the force acts where the stretch is measured, and
//! what is left out of the stretch, its part along the normal, can only take energy. Points
//! that stayed behind made a force that was the gradient of nothing, on which bodies rocked for ever.

use super::current::{Current, Operand};
use crate::law::ContactParameters;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A spring keeps its stiffness until there is less than this part of it left, so that a contact
/// that is shaken does not lose its force little by little.
const HOLDS: f64 = 0.5;

/// A point of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) enum Anchor {
    /// In a tetrahedron, by barycentric coordinates (it may lie outside).
    Tet(u32, [f64; 4]),
    /// In the axes of a rigid body, m.
    Point(Vector3),
}

/// The spring of one triangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bristle {
    pub triangle: u32,
    pub anchors: [Anchor; 2],
    /// N/m.
    pub stiffness: f64,
    /// Across which it is stretched.
    pub normal: Vector3,
}

/// What presses on a triangle, and how the bodies move there. Points are about the pair's origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch<'a> {
    pub point: Vector3,
    pub normal: Vector3,
    /// Normal force with damping, N.
    pub force: f64,
    /// Tangential stiffness, N/m.
    pub stiffness: f64,
    /// Velocity of B less that of A, m/s.
    pub slip: Vector3,
    /// Of A and of B at the point.
    pub mobilities: [Mobility; 2],
    /// 1/sqrt(K w) of the whole contact, s, with the stiffness K of its springs and its inverse mass w along
    /// the normal force: a spring k has the part 2 zeta k/sqrt(K w) of its dashpot.
    pub period: f64,
    /// The tetrahedra around, by number and as they are.
    pub hosts: [(u32, &'a Current); 2],
    /// Their places on the lists, and their shape functions at the point.
    pub places: [u32; 2],
    pub weights: [[f64; 4]; 2],
    pub origin: Vector3,
}

/// How easily a point of a side moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Mobility {
    /// 1/kg.
    pub inverse_mass: f64,
    /// By corner w_b^2/m_b, with the weights w_b of the point, 1/kg; zero of rigid sides. They add up to the
    /// inverse mass.
    pub corners: [f64; 4],
}

/// A corner whose part of the inverse mass is below this one of the largest takes part in the rate in
/// proportion.
const SMALL: f64 = 1.0 / 16.0;

impl Mobility {
    fn full(&self) -> f64 {
        SMALL * self.corners.iter().copied().fold(0.0, f64::max)
    }

    /// S of [`Touch::rates`].
    fn sum(&self) -> f64 {
        let full = self.full();
        let moving = self.corners.iter().filter(|g| **g > 0.0);
        let sum: f64 = moving.map(|g| g.max(full)).sum();
        if full > 0.0 { sum } else { self.inverse_mass }
    }
}

impl Touch<'_> {
    /// Of both, 1/kg.
    fn inverse_mass(&self) -> f64 {
        let [a, b] = self.mobilities;
        a.inverse_mass + b.inverse_mass
    }

    /// Rates of the corners of A and of B by a dashpot eta between the points, 1/s, and what counts of it for
    /// a rigid A, N s/m.
    ///
    /// With the weights w_b of a point and any shares s_b > 0, by Cauchy, |sum w_b v_b|^2 <= S sum m_b s_b |v_b|^2,
    /// S = sum w_b^2/(m_b s_b); and |v_B - v_A|^2 <= (S_A + S_B) (|v_A|^2/S_A + |v_B|^2/S_B). So both sides have the
    /// rate eta (S_A + S_B) s_b. The shares are 1 but for corners that hardly matter.
    pub fn rates(&self, eta: f64) -> ([[f64; 4]; 2], f64) {
        let [of_a, of_b] = self.mobilities.map(|m| m.sum());
        let rate = eta * (of_a + of_b);
        let rates = self.mobilities.map(|mobility| {
            let full = mobility.full();
            let share = |g: f64| if g > 0.0 { (g / full).min(1.0) } else { 0.0 };
            mobility.corners.map(|g| rate * share(g))
        });
        (rates, if of_a > 0.0 { rate / of_a } else { 0.0 })
    }
}

/// Friction of one triangle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct TriangleFriction {
    /// Force on B, N.
    pub force: Vector3,
    /// In the spring, J.
    pub energy: f64,
    /// Of the spring, N/m, and of its dashpot, N s/m.
    pub stiffness: f64,
    pub viscosity: f64,
    pub slides: bool,
}

impl Operand<'_> {
    /// Where a point of the body is about an origin, m.
    fn anchored(&self, anchor: &Anchor, origin: &Vector3) -> Option<Vector3> {
        match (self, anchor) {
            (Self::Deformable(shape, x), Anchor::Tet(tet, weights)) => {
                let corners = shape.corners(*tet, x)?;
                let term = |(x, w): (&Vector3, &f64)| (x - origin) * *w;
                Some(corners.iter().zip(weights).map(term).sum())
            }
            (Self::Rigid(_, frame) | Self::Wall(_, frame), Anchor::Point(x)) => {
                Some(frame.position - origin + frame.rotation * x)
            }
            _ => None,
        }
    }

    /// The point of the body that is at `x` about an origin.
    fn anchor(&self, (tet, current): (u32, &Current), x: &Vector3, origin: &Vector3) -> Anchor {
        match self {
            Self::Deformable(..) => Anchor::Tet(tet, current.weights(x)),
            Self::Rigid(_, frame) | Self::Wall(_, frame) => {
                Anchor::Point(frame.rotation.tr_mul(&(x + origin - frame.position)))
            }
        }
    }
}

fn across(x: &Vector3, normal: &Vector3) -> Vector3 {
    x - normal * normal.dot(x)
}

impl Bristle {
    /// A spring that has just formed, with a given stretch.
    pub fn new(sides: &[Operand; 2], triangle: u32, touch: &Touch, stretch: &Vector3) -> Self {
        let mut bristle = Self {
            triangle,
            anchors: [Anchor::Point(Vector3::zeros()); 2],
            stiffness: 0.0,
            normal: touch.normal,
        };
        bristle.place(sides, touch, &across(stretch, &touch.normal));
        bristle
    }

    /// Way from the point of A to that of B, m; zero if there are no such points.
    pub fn stretch(&self, sides: &[Operand; 2], origin: &Vector3) -> Vector3 {
        let [a, b] = &self.anchors;
        match (sides[0].anchored(a, origin), sides[1].anchored(b, origin)) {
            (Some(a), Some(b)) => b - a,
            _ => Vector3::zeros(),
        }
    }

    /// Energy of the spring as it stands, J.
    pub fn energy(&self, sides: &[Operand; 2], origin: &Vector3) -> f64 {
        let stretch = across(&self.stretch(sides, origin), &self.normal);
        0.5 * self.stiffness * stretch.norm_squared()
    }

    /// Puts the points around the centre of pressure so that the stretch is `stretch`.
    fn place(&mut self, sides: &[Operand; 2], touch: &Touch, stretch: &Vector3) {
        let half = stretch * 0.5;
        let ends = [touch.point - half, touch.point + half];
        self.anchors = [0, 1].map(|i| sides[i].anchor(touch.hosts[i], &ends[i], &touch.origin));
    }

    /// Advances the spring and returns its friction.
    pub fn update(
        &mut self,
        law: &ContactParameters,
        sides: &[Operand; 2],
        touch: &Touch,
    ) -> TriangleFriction {
        let normal = &touch.normal;
        let mut k = touch.stiffness;
        let mut stretch = across(&self.stretch(sides, &touch.origin), normal);
        let slip = across(&touch.slip, normal);
        // A stiffer spring keeps its force, a softer one its stretch: neither makes energy.
        if k > self.stiffness && self.stiffness > 0.0 {
            stretch *= self.stiffness / k;
        } else if k >= HOLDS * self.stiffness {
            k = k.max(self.stiffness);
        }
        let inverse_mass = touch.inverse_mass();
        let eta = if inverse_mass > 0.0 {
            // The contact's own, but not more than for a spring that were alone.
            let alone = (k / inverse_mass).sqrt();
            2.0 * law.tangential_damping * alone.min(k * touch.period)
        } else {
            0.0
        };
        let mut force = -stretch * k - slip * eta;
        let most = law.friction * touch.force;
        let size_of_force = force.norm();
        let slides = size_of_force > most;
        if slides {
            force *= most / size_of_force;
            k = touch.stiffness;
            // The spring carries what the dashpot leaves of the bound; it never pushes along the
            // slip.
            let spring = force + slip * eta;
            stretch = if spring.dot(&force) > 0.0 && k > 0.0 {
                -spring / k
            } else {
                Vector3::zeros()
            };
        }
        self.place(sides, touch, &stretch);
        self.stiffness = k;
        self.normal = *normal;
        TriangleFriction {
            force,
            energy: 0.5 * k * stretch.norm_squared(),
            stiffness: k,
            viscosity: eta,
            slides,
        }
    }
}
