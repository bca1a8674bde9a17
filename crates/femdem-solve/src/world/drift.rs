//! The drift of a step: bodies move with their velocities, and what is driven as prescribed.

use super::World;
use super::time_step::LARGEST_MOVE;
use crate::error::SolveError;
use crate::guide::Guide;
use crate::halo::Halo;
use crate::rotation;
use femdem_contact::Frame;
use femdem_fem::Driven;
use femdem_mesh::{Pose, Vector3};

impl World {
    /// Moves the awake bodies, the walls and the periodic cell from the present time by `dt`, s.
    pub(super) fn drift(&mut self, dt: f64, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let end = self.time + dt;
        let guests = self.driven_guests();
        for k in 0..self.awake.len() + guests.len() {
            let own = self.awake.get(k);
            let i = *own.unwrap_or_else(|| &guests[k - self.awake.len()]) as usize;
            let body = &mut self.bodies[i];
            let mut seen = None;
            let moved = if let Some((guide, base)) = body.driven.as_deref().copied() {
                let (from, driven) = (guide.now(self.time), guide.then(end));
                let reach = (body.position - driven.point).norm() + body.radius;
                let to = driven.place(&base);
                // The contact stage gets the velocities of all bodies at the half step.
                seen = Some([
                    (to.translation.vector - body.position) / dt,
                    driven.axis * ((driven.angle - from.angle) / dt),
                ]);
                body.follow(&driven, &to);
                driven.way_from(&from, reach)
            } else {
                let fastest = body.fastest();
                body.position += body.velocity * dt;
                rotation::drift(&mut body.orientation, &mut body.momentum, &body.moments, dt);
                fastest * dt
            };
            body.travelled += moved;
            let sound =
                moved.is_finite() && (moved <= LARGEST_MOVE * body.radius || body.driven.is_some());
            if !sound {
                return Err(self.blow_up(i));
            }
            if seen.is_some() {
                self.check_way(i, moved)?;
            }
            self.motions[i] = self.bodies[i].motion();
            if let Some([velocity, angular_velocity]) = seen {
                self.motions[i].velocity = velocity;
                self.motions[i].angular_velocity = angular_velocity;
            }
        }
        self.drift_walls(dt, halo)?;
        self.drift_cell(dt)
    }

    /// Moves the driven walls from the present time by `dt`.
    fn drift_walls(&mut self, dt: f64, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let reaches = self.reaches(dt, halo)?;
        let walls = self.wall_drives.iter().zip(reaches);
        for (motion, ((guide, base), reach)) in self.wall_motions.iter_mut().zip(walls) {
            let (from, driven) = (guide.now(self.time), guide.then(self.time + dt));
            if guide.is_fixed() {
                motion.velocity = Vector3::zeros();
                motion.angular_velocity = Vector3::zeros();
                continue;
            }
            let to = driven.place(base);
            let turn = driven.angle - from.angle;
            let at = to.translation.vector;
            motion.travelled += driven.way_from(&from, reach);
            // Velocity at the origin from the mean rotation about the axis. The chord of the path of an
            // origin far from the axis deviates from its tangent by more than bodies near the axis move.
            let mean = Driven {
                velocity: (driven.displacement - from.displacement) / dt,
                rate: turn / dt,
                ..driven
            };
            motion.velocity = mean.velocity_at(&at);
            motion.angular_velocity = mean.angular_velocity();
            motion.frame.position = at;
            if turn != 0.0 {
                motion.frame = Frame::from(&to);
            }
        }
        Ok(())
    }

    /// How far bodies of all ranks are from the points about which walls turn within the step, m; 0 for walls that do not. A wall
    /// is unbounded: its travel is that of its points where bodies are.
    fn reaches(&self, dt: f64, halo: &mut dyn Halo) -> Result<Vec<f64>, SolveError> {
        let deformables = self.deformables.as_deref();
        let soft = deformables.map_or(&[][..], |d| &d.bodies);
        let mut turns = false;
        let reach = |(guide, _): &(Guide, Pose)| {
            let (from, driven) = (guide.now(self.time), guide.then(self.time + dt));
            if guide.is_fixed() || driven.angle == from.angle {
                return 0.0;
            }
            turns = true;
            let rigid = self.live_bodies();
            let rigid = rigid.map(|(_, b)| (b.position - driven.point).norm() + b.radius);
            let nodes = soft.iter().flat_map(|b| &b.positions);
            let far = rigid.chain(nodes.map(|x| (x - driven.point).norm()));
            -1.1 * far.fold(0.0, f64::max)
        };
        let mut least: Vec<f64> = self.wall_drives.iter().map(reach).collect();
        if turns {
            halo.least(&mut least)?;
        }
        Ok(least.into_iter().map(|reach| -reach).collect())
    }
}
