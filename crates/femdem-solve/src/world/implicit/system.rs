//! The linear system of an implicit step, solved by conjugate gradients.

use super::link::{Link, LinkResistance};
use super::twist::Twist;
use femdem_mesh::nalgebra::{Matrix6, Vector6};
use femdem_mesh::{Matrix3, Vector3};

/// Mass (kg/s) and inertia (kg m^2/s, world axes) of a body over the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inertia {
    pub mass: f64,
    pub turning: Matrix3,
    /// Inverse of `turning`.
    pub inverse: Matrix3,
}

impl Inertia {
    /// The change of the velocities due to the contacts and to other forces.
    pub(super) fn response(&self, contacts: &Twist, others: &Twist) -> Twist {
        Twist {
            velocity: (contacts.velocity + others.velocity) / self.mass,
            turning: self.inverse * (contacts.turning + others.turning),
        }
    }

    fn block(&self) -> Matrix6<f64> {
        let mut block = Matrix6::zeros();
        for k in 0..3 {
            block[(k, k)] = self.mass;
        }
        block.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.turning);
        block
    }
}

/// (M/dt + slopes) x = r, x the change of the velocities. The matrix is symmetric and positive definite.
#[derive(Debug)]
pub(super) struct System {
    pub(super) inertias: Vec<Inertia>,
    pub(super) links: Vec<Link>,
}

impl System {
    /// What the contacts add to the matrix in their present states.
    fn resistances(&self) -> Vec<LinkResistance> {
        self.links.iter().filter_map(Link::resistance).collect()
    }

    fn times(&self, resistances: &[LinkResistance], x: &[Twist], out: &mut [Twist]) {
        for ((out, x), inertia) in out.iter_mut().zip(x).zip(&self.inertias) {
            out.velocity = x.velocity * inertia.mass;
            out.turning = inertia.turning * x.turning;
        }
        for resistance in resistances {
            resistance.add_times(x, out);
        }
    }

    /// Inverses of the blocks on the diagonal.
    pub(super) fn inverse_blocks(&self) -> Vec<Matrix6<f64>> {
        let mut blocks: Vec<_> = self.inertias.iter().map(Inertia::block).collect();
        for link in &self.links {
            link.add_blocks(&mut blocks);
        }
        let inverse = |block: Matrix6<f64>| block.cholesky().map(|c| c.inverse());
        let all = blocks.into_iter().map(inverse);
        all.map(Option::unwrap_or_default).collect()
    }

    /// Improves `x` by conjugate gradients (Hestenes & Stiefel 1952) with `inverses` of the diagonal blocks
    /// as preconditioner, until the residual is below `tolerance` times the forces `r`, in the norm of the
    /// preconditioner, and returns the number of iterations. `r` are the forces at the velocities before the
    /// step without those of the contacts, which are added here.
    pub(super) fn solve(
        &self,
        inverses: &[Matrix6<f64>],
        mut r: Vec<Twist>,
        x: &mut [Twist],
        tolerance: f64,
        rounds: u32,
    ) -> u32 {
        for link in &self.links {
            link.add_start(&mut r);
        }
        let mut z = r.clone();
        precondition(inverses, &r, &mut z);
        let enough = tolerance * tolerance * dot(&r, &z);
        let resistances = self.resistances();
        let mut product = vec![Twist::default(); r.len()];
        self.times(&resistances, x, &mut product);
        add_scaled(&mut r, &product, -1.0);
        precondition(inverses, &r, &mut z);
        let mut direction = z.clone();
        let mut size = dot(&r, &z);
        for round in 0..rounds {
            if size <= enough {
                return round;
            }
            self.times(&resistances, &direction, &mut product);
            let curvature = dot(&direction, &product);
            if curvature <= 0.0 {
                return round;
            }
            let length = size / curvature;
            add_scaled(x, &direction, length);
            add_scaled(&mut r, &product, -length);
            precondition(inverses, &r, &mut z);
            let before = std::mem::replace(&mut size, dot(&r, &z));
            for (direction, z) in direction.iter_mut().zip(&z) {
                let old = std::mem::replace(direction, *z);
                direction.add_scaled(&old, size / before);
            }
        }
        rounds
    }
}

fn precondition(inverses: &[Matrix6<f64>], r: &[Twist], z: &mut [Twist]) {
    for ((inverse, r), z) in inverses.iter().zip(r).zip(z) {
        let (f, m) = (&r.velocity, &r.turning);
        let x = inverse * Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z);
        z.velocity = Vector3::new(x[0], x[1], x[2]);
        z.turning = Vector3::new(x[3], x[4], x[5]);
    }
}

fn add_scaled(x: &mut [Twist], y: &[Twist], scale: f64) {
    for (x, y) in x.iter_mut().zip(y) {
        x.add_scaled(y, scale);
    }
}

fn dot(a: &[Twist], b: &[Twist]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;
    use crate::{BodySpec, Drive, WorldParameters};
    use femdem_contact::Wall;
    use femdem_mesh::catalogue::CatalogueShape;
    use femdem_mesh::{Pose, Rotation};

    /// Three cubes that lean on each other over a floor, with the contacts of some steps later.
    fn leaning() -> System {
        let mut p = WorldParameters::default();
        p.contact.penalty = 1e7;
        let mut world = World::new(p).unwrap();
        let cube = "P5".parse::<CatalogueShape>().unwrap();
        let cube = cube.polyhedron(0.1).unwrap();
        let shape = world.add_shape("P5", &cube).unwrap();
        let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
        world.add_wall(floor, Drive::Fixed).unwrap();
        for k in 0..3 {
            let turn = Vector3::new(0.1, 0.05, 0.2) * f64::from(k);
            let place = Vector3::new(0.0575 * f64::from(k), 0.01 * f64::from(k), 0.0285);
            let pose = Pose::from_parts(place.into(), Rotation::from_scaled_axis(turn));
            let mut spec = BodySpec::at_rest(shape, 2560.0, pose);
            spec.velocity = Vector3::new(0.3 - 0.3 * f64::from(k), 0.1, -0.4);
            world.add_body(spec).unwrap();
        }
        let members = [0, 1, 2];
        while world.contacts().len() < 4 {
            world.step().unwrap();
            assert!(world.time() < 0.1, "they do not meet");
        }
        world.ahead = world.motions.clone();
        let links = world.rigid_contacts().into_iter();
        let inertia = Inertia {
            mass: 30.0,
            turning: Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.05)),
            inverse: Matrix3::from_diagonal(&Vector3::new(50.0, 1.0 / 0.03, 20.0)),
        };
        System {
            inertias: vec![inertia; 3],
            links: links.map(|c| world.link(c, &members, 1e-3)).collect(),
        }
    }

    fn unit(k: usize) -> Vec<Twist> {
        let mut x = vec![Twist::default(); 3];
        let of = &mut x[k / 6];
        match k % 6 {
            axis @ 0..3 => of.velocity[axis] = 1.0,
            axis => of.turning[axis - 3] = 1.0,
        }
        x
    }

    fn entry(x: &[Twist], k: usize) -> f64 {
        dot(x, &unit(k))
    }

    /// The whole matrix is symmetric and positive definite, and its diagonal blocks are those that the
    /// preconditioner inverts.
    #[test]
    fn the_matrix_is_symmetric_and_its_blocks_are_known() {
        let system = leaning();
        let columns: Vec<Vec<Twist>> = (0..18)
            .map(|k| {
                let mut column = vec![Twist::default(); 3];
                system.times(&system.resistances(), &unit(k), &mut column);
                column
            })
            .collect();
        let largest = (0..18).map(|k| entry(&columns[k], k)).fold(0.0, f64::max);
        let inverses = system.inverse_blocks();
        let mut coupled = 0;
        for body in 0..3 {
            let at = |i: usize, j: usize| entry(&columns[6 * body + j], 6 * body + i);
            let block = Matrix6::from_fn(at);
            let off = block * inverses[body] - Matrix6::identity();
            assert!(off.norm() < 1e-9, "{off}");
        }
        for (i, column) in columns.iter().enumerate() {
            for (j, other) in columns.iter().enumerate() {
                let (a, b) = (entry(column, j), entry(other, i));
                assert!((a - b).abs() < 1e-12 * largest, "{i} {j}: {a} {b}");
                coupled += u32::from(i / 6 < j / 6 && a != 0.0);
            }
        }
        assert!(coupled > 10);
        let mut x = unit(4);
        x[2].velocity = Vector3::new(0.3, -2.0, 1.0);
        let mut product = vec![Twist::default(); 3];
        system.times(&system.resistances(), &x, &mut product);
        assert!(dot(&x, &product) > 0.0);
    }

    /// The solution fulfils the system to the tolerance.
    #[test]
    fn conjugate_gradients_solve_it() {
        let system = leaning();
        let others: Vec<Twist> = unit(2);
        let inverses = system.inverse_blocks();
        let mut x = vec![Twist::default(); 3];
        let rounds = system.solve(&inverses, others.clone(), &mut x, 1e-12, 100);
        assert!((1..60).contains(&rounds), "{rounds}");
        let mut r = others;
        for link in &system.links {
            link.add_start(&mut r);
        }
        let size = dot(&r, &r);
        let mut product = vec![Twist::default(); 3];
        system.times(&system.resistances(), &x, &mut product);
        add_scaled(&mut r, &product, -1.0);
        assert!(dot(&r, &r) < 1e-16 * size);
    }
}
