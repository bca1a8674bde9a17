//! Friction of one triangle of the skin: a spring between points of both bodies.
//!
//! The spring is stretched between a point of A and a point of B, given in a tetrahedron's
//! barycentric coordinates or in a rigid body's axes, so that a common rigid motion leaves it
//! unchanged.
//! In every step the points are placed around the centre of pressure, apart by the stretch of the spring
//! across the normal, and so move from tetrahedron to tetrahedron. While the triangle sticks, the energy of
//! the spring then changes by the work of its force, however pressure and normal move when bodies roll or
//! rock on each other: the force acts where the stretch is measured, and the removed part of the stretch,
//! along the normal, can only lower the energy. With points that stay behind, the force is not the gradient
//! of an energy, and bodies rock forever.

use super::operand::Operand;
use crate::law::ContactParameters;
use crate::tets::current::Current;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A spring keeps its stiffness until the present one is below this fraction of it, so that a contact that is
/// shaken does not gradually lose its force.
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
    /// Normal of the plane in which it is stretched.
    pub normal: Vector3,
}

/// Normal load and motion of a triangle. Points are about the pair's origin.
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
    /// Of A and of B at the point: see [`Mobility`].
    pub mobilities: [Mobility; 2],
    /// 1/sqrt(K w), s, of the whole contact, with the stiffness K of its springs and its inverse mass w along
    /// the normal force. The dashpot of a spring k is 2 zeta k/sqrt(K w).
    pub period: f64,
    /// The tetrahedra that contain the point: index and current shape.
    pub hosts: [(u32, &'a Current); 2],
    /// Their indices in the lists, and their shape functions at the point.
    pub places: [u32; 2],
    pub weights: [[f64; 4]; 2],
    pub origin: Vector3,
}

/// Inverse mass of a point of a side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Mobility {
    /// 1/kg.
    pub inverse_mass: f64,
    /// w_b^2/m_b by corner, with the weights w_b of the point, 1/kg; zero for rigid sides. Their sum is the
    /// inverse mass.
    pub corners: [f64; 4],
}

/// A corner whose part of the inverse mass is below this fraction of the largest gets a rate reduced in
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
    /// Sum of both sides, 1/kg.
    fn inverse_mass(&self) -> f64 {
        let [a, b] = self.mobilities;
        a.inverse_mass + b.inverse_mass
    }

    /// Rates of the corners of A and of B by a dashpot eta between the points, 1/s, and its effective
    /// viscosity for a rigid A, N s/m.
    ///
    /// With the weights w_b of a point and any shares s_b > 0, by Cauchy, |sum w_b v_b|^2 <= S sum m_b s_b
    /// |v_b|^2, S = sum w_b^2/(m_b s_b); and |v_B - v_A|^2 <= (S_A + S_B) (|v_A|^2/S_A + |v_B|^2/S_B). So
    /// both sides have the rate eta (S_A + S_B) s_b. The shares are 1 except for corners with a negligible
    /// part.
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
    /// Force on B, N, and the part of it due to the dashpot.
    pub force: Vector3,
    pub drag: Vector3,
    /// Energy stored in the spring, J.
    pub energy: f64,
    /// Stiffness of the spring, N/m, and viscosity of its dashpot, N s/m.
    pub stiffness: f64,
    pub viscosity: f64,
    pub slides: bool,
}

impl Operand<'_> {
    /// Position of an anchor about an origin, m.
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

    /// The anchor of the body at the position `x` about an origin.
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

    /// Vector from the point of A to that of B, m; zero if there are no such points.
    pub fn stretch(&self, sides: &[Operand; 2], origin: &Vector3) -> Vector3 {
        let [a, b] = &self.anchors;
        match (sides[0].anchored(a, origin), sides[1].anchored(b, origin)) {
            (Some(a), Some(b)) => b - a,
            _ => Vector3::zeros(),
        }
    }

    /// Present energy of the spring, J.
    pub fn energy(&self, sides: &[Operand; 2], origin: &Vector3) -> f64 {
        let stretch = across(&self.stretch(sides, origin), &self.normal);
        0.5 * self.stiffness * stretch.norm_squared()
    }

    /// Places the points around the centre of pressure such that the stretch is `stretch`.
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
        // A stiffer spring keeps its force, a softer one its stretch: neither gains energy.
        if k > self.stiffness && self.stiffness > 0.0 {
            stretch *= self.stiffness / k;
        } else if k >= HOLDS * self.stiffness {
            k = k.max(self.stiffness);
        }
        let inverse_mass = touch.inverse_mass();
        let eta = if inverse_mass > 0.0 {
            // The contact's damping, but not more than for this spring alone.
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
            // The spring carries what the dashpot leaves of the bound; it never pushes along the slip.
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
            drag: force + stretch * k,
            energy: 0.5 * k * stretch.norm_squared(),
            stiffness: k,
            viscosity: eta,
            slides,
        }
    }
}
