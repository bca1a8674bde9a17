//! What of a contact the iterations of a solution need.

use super::Twist;
use femdem_mesh::{Matrix3, Vector3};

/// Relative velocity and angular velocity of B against A from those of the bodies, of which `sides` are two. This and the
/// next function are inlined into the product of every iteration: as calls they pass vectors through memory,
/// which costs a tenth of the time of a step.
#[inline(always)]
pub(super) fn relative(sides: &[Option<u32>; 2], arms: &[Vector3; 2], x: &[Twist]) -> Twist {
    let mut apart = Twist::default();
    if let Some(b) = sides[1] {
        let x = &x[b as usize];
        apart.velocity += x.velocity + x.turning.cross(&arms[1]);
        apart.turning += x.turning;
    }
    if let Some(a) = sides[0] {
        let x = &x[a as usize];
        apart.velocity -= x.velocity + x.turning.cross(&arms[0]);
        apart.turning -= x.turning;
    }
    apart
}

/// Adds a force and a moment on B, and the opposite ones on A.
#[inline(always)]
pub(super) fn add(
    sides: &[Option<u32>; 2],
    arms: &[Vector3; 2],
    [force, moment]: [&Vector3; 2],
    out: &mut [Twist],
) {
    if let Some(b) = sides[1] {
        let out = &mut out[b as usize];
        out.velocity += force;
        out.turning += moment + arms[1].cross(force);
    }
    if let Some(a) = sides[0] {
        let out = &mut out[a as usize];
        out.velocity -= force;
        out.turning -= moment + arms[0].cross(force);
    }
}

/// The part of a link that every iteration of a solution reads: how its forces decrease with the velocities gained.
#[derive(Debug)]
pub(in crate::world::implicit) struct LinkResistance {
    pub(super) sides: [Option<u32>; 2],
    pub(super) arms: [Vector3; 2],
    pub(super) normal: Vector3,
    /// Lever of the normal force about the contact point, m.
    pub(super) lever: Vector3,
    /// Decrease per unit of velocity gained of the normal force and of friction, N s/m, of torsion and of the moment against
    /// rocking, N m s.
    pub(super) pressed: f64,
    pub(super) held: f64,
    pub(super) torsion: f64,
    pub(super) rocking: Matrix3,
}

impl LinkResistance {
    /// Adds the product of the slopes with a change of the velocities.
    #[inline(always)]
    pub(in crate::world::implicit) fn add_times(&self, x: &[Twist], out: &mut [Twist]) {
        let (n, lever) = (&self.normal, &self.lever);
        let x = relative(&self.sides, &self.arms, x);
        let (along, spin) = (n.dot(&x.velocity), n.dot(&x.turning));
        let pressed = self.pressed * (along + lever.dot(&x.turning));
        let force = n * (pressed - self.held * along) + x.velocity * self.held;
        let moment = lever * pressed + self.rocking * x.turning + n * (spin * self.torsion);
        add(&self.sides, &self.arms, [&force, &moment], out);
    }
}
