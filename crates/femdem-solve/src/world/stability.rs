//! Measured stability: the highest frequency of the present contacts, by power iteration on differences of
//! the forces.

use super::World;
use crate::error::SolveError;
use crate::parameters::Medium;
use femdem_mesh::{Rotation, Vector3};
use serde::Serialize;

/// The step against the measured stability limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stability {
    /// Highest angular frequency of the contacts, friction springs included, and of the bonds, 1/s.
    pub frequency: f64,
    /// Limit of the step for that mode, with the largest damping ratio of the laws and of the bonds, s.
    pub limit: f64,
    /// The present step, s.
    pub step: f64,
}

impl Stability {
    /// The present step over its limit: below 1 is stable.
    pub fn used(&self) -> f64 {
        self.step / self.limit
    }
}

/// A motion of all bodies: translation (m) and rotation (rad) of each.
type Mode = Vec<[Vector3; 2]>;

impl World {
    /// Measures the highest frequency at the present state by power iteration. Sleeping bodies stay fixed.
    ///
    /// It works on a copy of the world; the cost is about 60 evaluations of all contacts. `None` if no body
    /// that can move has a contact or a bond.
    ///
    /// # Errors
    /// [`SolveError`] if the contacts of the displaced state cannot be evaluated.
    pub fn stability(&self) -> Result<Option<Stability>, SolveError> {
        /// The estimate grows towards the true value; 30 rounds come within a few percent.
        const ROUNDS: usize = 30;
        let mut still = self.clone();
        still.parameters.medium = Medium::default();
        still
            .batch
            .set_laws(self.batch.laws().clone().without_dashpots());
        // A bond at its strength would soften on one side of the differences.
        still.batch.hold_bonds();
        let free = |i: usize| {
            let id = i as u32;
            self.batch.is_rigid(id) && self.bodies[i].driven.is_none() && self.batch.is_awake(id)
        };
        let held: Vec<usize> = (0..self.bodies.len()).filter(|&i| !free(i)).collect();
        let hold = |mode: &mut Mode| {
            for &i in &held {
                mode[i] = [Vector3::zeros(); 2];
            }
        };
        still.set_sleeping(false);
        for body in &mut still.bodies {
            body.velocity = Vector3::zeros();
            body.momentum = Vector3::zeros();
        }
        let mut mode = still.first_mode();
        hold(&mut mode);
        let mut square = 0.0;
        for _ in 0..ROUNDS {
            let size = still.norm(&mode);
            if size == 0.0 {
                return Ok(None);
            }
            for part in mode.iter_mut().flatten() {
                *part /= size;
            }
            mode = still.stiffness_times(&mode)?;
            hold(&mut mode);
            square = still.norm(&mode);
        }
        if square <= 0.0 {
            return Ok(None);
        }
        let frequency = square.sqrt();
        let ratios = self.batch.laws().all().map(|law| law.damping_ratio);
        let zeta = ratios.fold(self.batch.damping_of_bonds(), f64::max);
        Ok(Some(Stability {
            frequency,
            limit: 2.0 / frequency * ((1.0 + zeta * zeta).sqrt() - zeta),
            step: self.step_control.current(),
        }))
    }

    /// A start without symmetry.
    fn first_mode(&self) -> Mode {
        let part = |i: usize, k: f64| {
            let x = i as f64 + 0.37 * k;
            Vector3::new(
                (1.3 * x).sin(),
                (2.1 * x + 1.0).sin(),
                (3.7 * x + 2.0).sin(),
            )
        };
        self.bodies
            .iter()
            .enumerate()
            .map(|(i, b)| [part(i, 0.0), part(i, 1.0) / b.radius])
            .collect()
    }

    /// Square root of the sum of m |x|^2 + theta.I theta.
    fn norm(&self, mode: &Mode) -> f64 {
        let square = |(b, [x, turn]): (&crate::body::Body, &[Vector3; 2])| {
            let local = b.orientation.inverse_transform_vector(turn);
            b.mass * x.norm_squared() + b.moments.component_mul(&local).dot(&local)
        };
        self.bodies.iter().zip(mode).map(square).sum::<f64>().sqrt()
    }

    /// M^-1 K times a mode, by central differences of the contact loads.
    fn stiffness_times(&self, mode: &Mode) -> Result<Mode, SolveError> {
        let longest = mode
            .iter()
            .zip(&self.bodies)
            .map(|([x, turn], b)| x.norm() + turn.norm() * b.radius)
            .fold(0.0, f64::max);
        let radii = self.live_bodies().map(|(_, b)| b.radius);
        let shortest = radii.fold(f64::INFINITY, f64::min);
        let step = 1e-7 * shortest / longest;
        let [ahead, behind] = [self.displaced(mode, step)?, self.displaced(mode, -step)?];
        Ok(ahead
            .iter()
            .zip(&behind)
            .map(|(a, b)| [0, 1].map(|k| (b[k] - a[k]) / (2.0 * step)))
            .collect())
    }

    /// Accelerations due to the contacts after a displacement.
    fn displaced(&self, mode: &Mode, step: f64) -> Result<Mode, SolveError> {
        let mut world = self.clone();
        for (i, [x, turn]) in mode.iter().enumerate() {
            let body = &mut world.bodies[i];
            body.position += x * step;
            body.orientation = Rotation::from_scaled_axis(turn * step) * body.orientation;
            body.travelled += (x.norm() + turn.norm() * body.radius) * step.abs();
            world.motions[i] = body.motion();
        }
        world.evaluate(0.0)?;
        let acceleration = |(i, load): (usize, &femdem_contact::Load)| {
            let motion = &world.motions[i];
            [
                load.total.force * motion.inverse_mass,
                motion.inverse_inertia * load.total.torque,
            ]
        };
        Ok(world
            .batch
            .loads()
            .iter()
            .enumerate()
            .map(acceleration)
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use crate::{BodySpec, Drive, World, WorldParameters};
    use femdem_contact::Wall;
    use femdem_mesh::catalogue::CatalogueShape;
    use femdem_mesh::{Pose, Rotation, Vector3};

    /// A frictionless cube flat on a floor: the heave frequency is that of the spring
    /// F = 2 p A delta/h, at small depth; rocking is a little slower (I/m = a^2/6 against
    /// the foundation's a^2/12).
    #[test]
    fn the_frequency_of_a_cube_on_a_floor() {
        let mut p = WorldParameters::default();
        p.contact.friction = 0.0;
        let (d, density) = (0.1, 2560.0);
        let mut world = World::new(p).unwrap();
        let cube = "P5"
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(d)
            .unwrap();
        let shape = world.add_shape("P5", &cube).unwrap();
        let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
        world.add_wall(floor, Drive::Fixed).unwrap();
        let a = d / 3.0_f64.sqrt();
        let depth = 1e-4 * a;
        let pose = Pose::translation(0.0, 0.0, 0.5 * a - depth);
        world
            .add_body(BodySpec::at_rest(shape, density, pose))
            .unwrap();
        world.step().unwrap();
        let got = world.stability().unwrap().unwrap();
        let stiffness = 2.0 * p.contact.penalty * a * a / (0.5 * a);
        let expected = (stiffness / (density * a.powi(3))).sqrt();
        assert!(
            (got.frequency / expected - 1.0).abs() < 0.01,
            "{got:?} {expected}"
        );
        assert!(got.used() < 1.0);
    }
    /// Cubes that come to rest one after another: their steps are below the limit while some sleep and the
    /// others do not, and not far below.
    #[test]
    fn steps_among_sleepers_are_below_the_limit() {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let d = 0.1;
        let cube = "P5".parse::<CatalogueShape>().unwrap();
        let cube = cube.polyhedron(d).unwrap();
        let shape = world.add_shape("P5", &cube).unwrap();
        for wall in Wall::closed_box(Vector3::zeros(), Vector3::new(0.2, 0.2, 2.0)).unwrap() {
            world.add_wall(wall, Drive::Fixed).unwrap();
        }
        for k in 0..12 {
            let k = f64::from(k);
            let turn = Vector3::new(k.sin(), (2.0 * k).sin(), (3.0 * k).sin());
            let place = Vector3::new(0.1 + 0.03 * k.cos(), 0.1, 0.06 + 1.1 * d * k);
            let pose = Pose::from_parts(place.into(), Rotation::from_scaled_axis(turn));
            world
                .add_body(BodySpec::at_rest(shape, 2560.0, pose))
                .unwrap();
        }
        let mut used = Vec::new();
        while used.len() < 10 {
            for _ in 0..10 {
                world.step().unwrap();
            }
            assert!(world.time() < 3.0, "{} samples", used.len());
            if (1..12).contains(&world.awake_count()) {
                used.extend(world.stability().unwrap().map(|s| s.used()));
            }
        }
        let most = used.iter().copied().fold(0.0, f64::max);
        assert!((0.3..0.95).contains(&most), "{used:?}");
    }
}
