//! Friction and damping of deformable bodies under prescribed motion.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::soft::Soft;
use crate::common::tets::{block, body, cube, cubes};
use femdem_contact::deform::{Modulus, NodalState};
use femdem_contact::{
    BodyShape, Contact, ContactBatch, ContactLaw, ContactParameters, Field, Frame, Motion, Partner,
    SpringLoad, Wall, restitution,
};
use femdem_mesh::nalgebra::{UnitQuaternion, Vector3};

const MU: f64 = 0.5;
const DEPTH: f64 = 1e-3;

fn law() -> ContactParameters {
    ContactParameters {
        penalty: 1e6,
        friction: MU,
        damping_ratio: 0.0,
        tangential_damping: 0.0,
        ..ContactParameters::default()
    }
}

/// The support of the upper body.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ground {
    Floor,
    Rigid,
    Soft,
}

const GROUNDS: [Ground; 3] = [Ground::Floor, Ground::Rigid, Ground::Soft];

/// A deformable body on a support whose top is the plane z = 0.
#[derive(Clone)]
struct Rig {
    batch: ContactBatch,
    ground: Option<Soft>,
    rigid: Vec<Motion>,
    walls: Vec<Motion>,
    upper: Soft,
    masses: Vec<f64>,
    velocity: Vec<Vector3<f64>>,
}

impl Rig {
    /// A cube of side 1, `DEPTH` deep in the ground.
    fn new(law: ContactParameters, ground: Ground) -> Self {
        let mut at = Frame::identity();
        at.position.z = 0.5 - DEPTH;
        let upper = Soft::linear(&cube(2)).posed(&at);
        Self::of(law, ground, &cubes(&block([4, 4, 2], |_| true), 0.5), upper)
    }

    /// Bodies on a slab of the given mesh.
    fn of(
        law: ContactParameters,
        ground: Ground,
        slab: &femdem_mesh::TetMesh,
        upper: Soft,
    ) -> Self {
        let law = ContactLaw::new(law).unwrap();
        let mut batch = ContactBatch::new(law);
        let mut rig = Self {
            ground: None,
            rigid: Vec::new(),
            walls: Vec::new(),
            masses: vec![1.0; upper.x.len()],
            velocity: vec![Vector3::zeros(); upper.x.len()],
            upper,
            batch: batch.clone(),
        };
        let mut below = Frame::identity();
        match ground {
            Ground::Floor => {
                batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
                rig.walls.push(Motion::fixed(below));
            }
            Ground::Rigid => {
                let mesh = body(slab, Field::Body);
                below.position.z = -0.5 * height(slab);
                batch.add_shape(BodyShape::from(mesh));
                batch.add_body(0).unwrap();
                rig.rigid.push(Motion::fixed(below));
            }
            Ground::Soft => {
                below.position.z = -0.5 * height(slab);
                let soft = Soft::linear(slab).posed(&below);
                let shape = batch.add_deformable_shape(soft.shape.clone());
                batch.add_deformable(shape, Modulus::Penalty(1e6)).unwrap();
                rig.ground = Some(soft);
            }
        }
        let shape = batch.add_deformable_shape(rig.upper.shape.clone());
        batch.add_deformable(shape, Modulus::Penalty(1e6)).unwrap();
        rig.batch = batch;
        rig
    }

    /// The one contact after an update.
    fn update(&mut self) -> Contact {
        self.update_after(0.0)
    }

    /// The same, a time after the last, s.
    fn update_after(&mut self, dt: f64) -> Contact {
        let zeros = |soft: &Soft| {
            (
                vec![Vector3::zeros(); soft.x.len()],
                vec![0.0; soft.x.len()],
            )
        };
        let still = self.ground.as_ref().map(zeros);
        let mut states = Vec::new();
        if !self.rigid.is_empty() {
            states.push(NodalState {
                positions: &[],
                velocities: &[],
                inverse_masses: &[],
            });
        }
        if let (Some(soft), Some((v, w))) = (&self.ground, &still) {
            states.push(NodalState {
                positions: &soft.x,
                velocities: v,
                inverse_masses: w,
            });
        }
        states.push(NodalState {
            positions: &self.upper.x,
            velocities: &self.velocity,
            inverse_masses: &self.masses,
        });
        let mut motions = self.rigid.clone();
        motions.resize(states.len(), Motion::fixed(Frame::identity()));
        self.batch
            .update_deformables(&states, &motions, &self.walls, dt)
            .unwrap();
        let contacts: Vec<_> = self.batch.deformable_contacts().collect();
        assert_eq!(contacts.len(), 1);
        *contacts[0]
    }

    fn upper_index(&self) -> u32 {
        u32::from(self.ground.is_some() || !self.rigid.is_empty())
    }

    fn shift(&mut self, by: Vector3<f64>) {
        self.upper.x.iter_mut().for_each(|x| *x += by);
    }

    /// Moves everything except walls by a rigid motion from `start`.
    fn carry(&mut self, start: &Self, turn: &UnitQuaternion<f64>, by: &Vector3<f64>) {
        let soft = |to: &mut Soft, from: &Soft| {
            for (x, from) in to.x.iter_mut().zip(&from.x) {
                *x = turn * from + by;
            }
        };
        soft(&mut self.upper, &start.upper);
        if let (Some(to), Some(from)) = (&mut self.ground, &start.ground) {
            soft(to, from);
        }
        for (motion, from) in self.rigid.iter_mut().zip(&start.rigid) {
            let before = motion.frame.position;
            motion.frame.rotation = turn.to_rotation_matrix().into_inner() * from.frame.rotation;
            motion.frame.position = turn * from.frame.position + by;
            motion.travelled += 0.1 + (motion.frame.position - before).norm();
        }
    }
}

fn height(mesh: &femdem_mesh::TetMesh) -> f64 {
    mesh.points().iter().map(|p| p.z).fold(0.0, f64::max)
}

/// A sheared pair under a rigid motion keeps its friction force, rotated with it.
#[test]
fn a_common_motion_keeps_the_force() {
    for ground in [Ground::Rigid, Ground::Soft] {
        let mut rig = Rig::new(law(), ground);
        rig.update();
        rig.shift(Vector3::new(2e-4, 1e-4, 0.0));
        let start = rig.update();
        let all = rig
            .batch
            .nodal_loads(rig.batch.len() as u32 - 1)
            .forces
            .to_vec();
        assert!(start.friction.norm() > 0.1 * start.normal_force && !start.slides);
        let (begin, mut total) = (rig.clone(), UnitQuaternion::identity());
        for i in 0..2000 {
            let s = f64::from(i);
            total = UnitQuaternion::from_scaled_axis(Vector3::new(1e-3, -2e-3, 1.5e-3) * s);
            let by = Vector3::new((3e-3 * s).sin(), 0.0, (2e-3 * s).cos());
            rig.carry(&begin, &total, &by);
            rig.update();
        }
        let end = *rig.batch.deformable_contacts().next().unwrap();
        let error = (end.friction - total * start.friction).norm() / start.friction.norm();
        assert!(error < 1e-10, "{ground:?}: {error:e}");
        let now = rig.batch.nodal_loads(rig.batch.len() as u32 - 1).forces;
        for (x, y) in all.iter().zip(now) {
            assert!((total * x - y).norm() < 1e-10 * start.normal_force);
        }
    }
}

/// A body that turns about an axis in the contact plane is resisted by the moment mu_r N r, with the rolling radius of
/// the pair; nothing resists without the coefficient.
#[test]
fn rolling_friction_reaches_its_bound() {
    for (ground, radius) in [
        (Ground::Floor, 0.5),
        (Ground::Rigid, 0.25),
        (Ground::Soft, 0.25),
    ] {
        for rolling_friction in [0.0, 0.1] {
            let parameters = ContactParameters {
                rolling_friction,
                ..law()
            };
            let mut rig = Rig::new(parameters, ground);
            let centre = Vector3::z() * (0.5 - DEPTH);
            let turning = Vector3::y() * 1e-3;
            rig.velocity = rig
                .upper
                .x
                .iter()
                .map(|x| turning.cross(&(x - centre)))
                .collect();
            let mut contact = rig.update();
            for _ in 0..50 {
                contact = rig.update_after(0.1);
            }
            let want = turning.normalize() * (-rolling_friction * contact.normal_force * radius);
            let off = (contact.rolling - want).norm();
            assert!(
                off < 0.01 * want.norm() + 1e-12,
                "{ground:?}: {:?} {want:?}",
                contact.rolling
            );
        }
    }
}

/// Work of friction along a closed path of the upper body, by the trapezoidal rule, and the largest
/// friction force.
fn work(rig: &mut Rig, path: impl Fn(f64) -> Vector3<f64>, steps: u32) -> (f64, f64) {
    let (mut work, mut largest) = (0.0, 0.0_f64);
    let mut before = (path(0.0), rig.update().friction);
    for i in 1..=steps {
        let at = path(f64::from(i) / f64::from(steps));
        rig.shift(at - before.0);
        let contact = rig.update();
        let friction = contact.friction;
        work += 0.5 * (friction + before.1).dot(&(at - before.0));
        largest = largest.max(friction.norm());
        before = (at, friction);
    }
    (work, largest)
}

#[test]
fn a_closed_loop_of_stick_does_no_work() {
    for ground in GROUNDS {
        let mut rig = Rig::new(law(), ground);
        rig.update();
        let turn = std::f64::consts::TAU;
        let circle = |s: f64| Vector3::new((turn * s).cos() - 1.0, (turn * s).sin(), 0.0) * 2e-5;
        let (work, largest) = work(&mut rig, circle, 200);
        let spring = rig
            .batch
            .deformable_contacts()
            .next()
            .unwrap()
            .spring_energy;
        assert!(largest > 0.0 && !rig.batch.deformable_contacts().next().unwrap().slides);
        // On a mesh the stiffness at the rim varies slightly with position, which dissipates energy.
        let lost = -work / (largest * 2e-5);
        let most = if ground == Ground::Floor { 1e-11 } else { 5e-5 };
        assert!(lost > -1e-11 && lost < most, "{ground:?}: {lost:e}");
        assert!(spring < most * largest * 2e-5, "{ground:?}: {spring:e}");
    }
}

/// The work of friction on the nodes of the upper body from one update to the next, by the trapezoidal rule.
fn nodal_work(rig: &Rig, before: &(Vec<Vector3<f64>>, Vec<Vector3<f64>>)) -> f64 {
    let now = rig.batch.nodal_loads(rig.upper_index()).friction;
    let forces = now.iter().zip(&before.1).map(|(f, g)| (f + g) * 0.5);
    let ways = rig.upper.x.iter().zip(&before.0).map(|(x, y)| x - y);
    forces.zip(ways).map(|(f, way)| f.dot(&way)).sum()
}

/// A cube that stands on an edge rolls to and fro and is pressed and pushed out of phase with that, so that
/// the pressure, its direction and the stretch of the springs go through a cycle. As long as nothing slides
/// friction may dissipate, but in either sense of the cycle it never gives more energy than its springs hold.
#[test]
fn friction_feeds_no_rolling() {
    for ground in GROUNDS {
        for direction in [1.0, -1.0] {
            let sticky = ContactParameters {
                friction: 20.0,
                ..law()
            };
            let mut rig = Rig::new(sticky, ground);
            let start = rig.upper.x.clone();
            let centre: Vector3<f64> = start.iter().sum::<Vector3<f64>>() / start.len() as f64;
            let place = |rig: &mut Rig, s: f64| {
                let (sin, cos) = (std::f64::consts::TAU * s * direction).sin_cos();
                let angle = std::f64::consts::FRAC_PI_4 + 0.03 * sin;
                let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle);
                // The lowest corners roll on the ground, 2 mm deep and 0.1 mm more and less.
                let depth = 2e-3 + 1e-4 * cos;
                let up = 0.5 * (angle.sin() + angle.cos()) - depth;
                let along = 0.5 * (angle.sin() - angle.cos()) + 1e-4 * (2.0 + 0.3 * cos);
                let to = Vector3::new(along, 0.0, up);
                for (x, from) in rig.upper.x.iter_mut().zip(&start) {
                    *x = turn * (from - centre) + to;
                }
            };
            let (mut work, mut largest, mut first) = (0.0, 0.0_f64, 0.0);
            let mut before = (Vec::new(), Vec::new());
            // The first cycle brings the springs into a periodic state.
            for i in 0..=1200 {
                place(&mut rig, f64::from(i) / 400.0);
                let contact = rig.update();
                assert!(!contact.slides, "{ground:?}");
                if i == 400 {
                    first = contact.spring_energy;
                } else if i > 400 {
                    work += nodal_work(&rig, &before);
                    largest = largest.max(contact.spring_energy);
                }
                let forces = rig.batch.nodal_loads(rig.upper_index()).friction;
                before = (rig.upper.x.clone(), forces.to_vec());
            }
            let last = rig
                .batch
                .deformable_contacts()
                .next()
                .unwrap()
                .spring_energy;
            let dissipated = (first - last - work) / largest;
            assert!(dissipated > -1e-3, "{ground:?} {direction}: {dissipated:e}");
        }
    }
}

/// Slip to and fro by A dissipates 4 mu F (A - mu F/k_t) in a cycle.
#[test]
fn cyclic_slip_dissipates_what_coulomb_says() {
    for ground in GROUNDS {
        let mut rig = Rig::new(law(), ground);
        let contact = rig.update();
        let normal = contact.normal_force;
        let tangential = contact.tangential_stiffness;
        let amplitude = 4.0 * MU * normal / tangential;
        let triangle = |s: f64| {
            let x = match s {
                s if s < 0.25 => 4.0 * s,
                s if s < 0.75 => 2.0 - 4.0 * s,
                s => 4.0 * s - 4.0,
            };
            Vector3::new(0.6, 0.8, 0.0) * (amplitude * x)
        };
        work(&mut rig, triangle, 4000);
        let (work, largest) = work(&mut rig, triangle, 4000);
        let want = 4.0 * MU * normal * (amplitude - MU * normal / tangential);
        assert!(
            (-work / want - 1.0).abs() < 2e-3,
            "{ground:?}: {work} {want}"
        );
        assert!((largest / (MU * normal) - 1.0).abs() < 1e-3, "{ground:?}");
    }
}

/// A body on one corner, shared by several triangles of its skin, has the tangential damping of its springs
/// together: the fraction zeta of critical for the mass that the contact's force moves, and not the sum over
/// triangles, each damped as if alone.
#[test]
fn a_contact_of_several_triangles_has_one_dashpot() {
    let zeta = 0.4;
    let damped = ContactParameters {
        tangential_damping: zeta,
        friction: 1e3,
        ..law()
    };
    let mut rig = Rig::new(damped, Ground::Floor);
    let diagonal = Vector3::new(1.0, 1.0, 1.0);
    let turn = UnitQuaternion::rotation_between(&diagonal, &Vector3::z()).unwrap();
    let lowest = |x: &[Vector3<f64>]| x.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    rig.upper.x.iter_mut().for_each(|x| *x = turn * *x);
    let up = Vector3::z() * (-5e-3 - lowest(&rig.upper.x));
    rig.upper.x.iter_mut().for_each(|x| *x += up);
    let slip = Vector3::new(0.6, -0.8, 0.0) * 1e-6;
    rig.velocity.fill(slip);
    let contact = rig.update();
    let body = rig.upper_index();
    let (all, friction) = (
        rig.batch.nodal_loads(body).forces,
        rig.batch.nodal_loads(body).friction,
    );
    let elastic: Vec<Vector3<f64>> = all.iter().zip(friction).map(|(f, t)| f - t).collect();
    let total: Vector3<f64> = elastic.iter().sum();
    let responses = elastic.iter().zip(&rig.masses);
    let response: f64 = responses.map(|(f, m)| f.norm_squared() / m).sum();
    let mass = total.norm_squared() / response;
    let critical = 2.0 * (contact.tangential_stiffness * mass).sqrt();
    let share = -contact.friction.dot(&slip) / slip.norm_squared() / critical;
    assert!(
        (0.9 * zeta..zeta * (1.0 + 1e-9)).contains(&share),
        "{share}"
    );
}

/// Only contacts with walls have the friction of walls; contacts of deformable bodies with others, rigid or
/// not, have that of bodies.
#[test]
fn walls_have_their_own_friction() {
    for wall in [0.0, 0.2] {
        for ground in GROUNDS {
            let law = ContactParameters {
                wall_friction: Some(wall),
                ..law()
            };
            let mut rig = Rig::new(law, ground);
            rig.update();
            for _ in 0..20 {
                rig.shift(Vector3::new(1e-3, 2e-3, 0.0));
                rig.update();
            }
            let contact = rig.update();
            let want = if ground == Ground::Floor { wall } else { MU };
            let got = contact.friction.norm() / contact.normal_force;
            assert!((got - want).abs() < 2e-3, "{ground:?}: {got} {want}");
        }
    }
}

/// A block slides over a slab of many elements, and a slab over a block: the friction force stays constant
/// except for the triangles that enter and leave at the rim.
#[test]
fn sliding_over_many_elements_is_steady() {
    let slab = cubes(&block([14, 4, 2], |_| true), 0.25);
    let small = cubes(&block([2, 2, 2], |_| true), 0.3);
    for ground in GROUNDS {
        for fine_above in [false, true] {
            let (below, above) = if fine_above {
                (&small, &slab)
            } else {
                (&slab, &small)
            };
            let mut at = Frame::identity();
            at.position = Vector3::new(-0.8, 0.03, 0.5 * height(above) - DEPTH);
            let mut rig = Rig::of(law(), ground, below, Soft::linear(above).posed(&at));
            let step = Vector3::x() * 4e-3;
            rig.velocity.fill(step);
            let mut ratios = Vec::new();
            for i in 0..400 {
                rig.shift(step);
                let contact = rig.update();
                if i > 20 {
                    assert!(contact.friction.x < 0.0);
                    ratios.push(contact.friction.norm() / (MU * contact.normal_force));
                    let aside = contact.friction.y.abs() / contact.friction.norm();
                    assert!(aside < 2e-2, "{ground:?} {fine_above}: {aside}");
                }
            }
            let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
            let most = ratios.iter().copied().fold(0.0, f64::max);
            assert!(least > 0.97 && most < 1.002, "{ground:?}: {least} {most}");
        }
    }
}

/// A block falls on its face, with masses in proportion to the nodes' forces, so that it moves as one: its
/// restitution is that of its damping ratio.
#[test]
fn impacts_have_the_restitution_of_their_damping_ratio() {
    for ground in GROUNDS {
        for zeta in [0.1, 0.3, 0.6] {
            let parameters = ContactParameters {
                damping_ratio: zeta,
                friction: 0.0,
                ..law()
            };
            let mut rig = Rig::new(parameters, ground);
            rig.update();
            let top = rig.batch.len() as u32 - 1;
            let share: Vec<f64> = rig
                .batch
                .nodal_loads(top)
                .forces
                .iter()
                .map(|f| f.z)
                .collect();
            let total: f64 = share.iter().sum();
            for (w, f) in rig.masses.iter_mut().zip(&share) {
                *w = if *f > 1e-2 * total { total / f } else { 0.0 };
            }
            let mass: f64 = rig
                .masses
                .iter()
                .filter(|w| **w > 0.0)
                .map(|w| 1.0 / w)
                .sum();
            rig.shift(Vector3::z() * DEPTH);
            let (mut speed, mut height, dt) = (-0.1, 0.0, 5e-6);
            for _ in 0..200_000 {
                height += speed * dt;
                rig.shift(Vector3::z() * (speed * dt));
                if height > 0.0 {
                    break;
                }
                rig.velocity.fill(Vector3::z() * speed);
                rig.update();
                let force: f64 = rig.batch.nodal_loads(top).forces.iter().map(|f| f.z).sum();
                speed += force / mass * dt;
            }
            let e = speed / 0.1;
            let want = restitution(zeta);
            assert!(
                (e / want - 1.0).abs() < 0.02,
                "{ground:?} {zeta}: {e} {want}"
            );
        }
    }
}

/// A cube of side a that rocks on its face is opposed by the moment 2 ζ √(k_θ/w) ω, with k_θ = K a²/12 of a
/// square, bounded by the moment that moves the pressure to the rim. The nodes carry this moment and no net
/// force. If the elastic moment does not change, as when a body rolls, nothing opposes the rotation.
#[test]
fn rocking_is_damped_by_the_stiffness_of_the_face() {
    let zeta = 0.3;
    let still = ContactParameters {
        friction: 0.0,
        damping_ratio: zeta,
        ..law()
    };
    for ground in GROUNDS {
        let mut start = Rig::new(still, ground);
        let at = start.update();
        let centre: Vector3<f64> =
            start.upper.x.iter().sum::<Vector3<f64>>() / start.upper.x.len() as f64;
        // All nodes of the cube have the mass 1: the inertia is the same about any axis.
        let square = |x: &Vector3<f64>| (x - centre).xy().norm_squared();
        let inertia: f64 = start.upper.x.iter().map(square).sum();
        let axis = Vector3::new(0.6, 0.8, 0.0);
        let foot = Vector3::zeros();
        let moment = |speed: f64, angle: f64, dt: f64| {
            let mut rig = start.clone();
            let turn = UnitQuaternion::from_scaled_axis(axis * angle);
            for (v, x) in rig.velocity.iter_mut().zip(&mut rig.upper.x) {
                *x = foot + turn * (*x - foot);
                *v = (axis * speed).cross(&(*x - foot));
            }
            let contact = rig.update_after(dt);
            let forces = rig.batch.nodal_loads(rig.upper_index()).damping;
            let total: Vector3<f64> = forces.iter().sum();
            let nodes = rig.upper.x.iter().zip(forces);
            let torque: Vector3<f64> = nodes.map(|(x, f)| (x - centre).cross(f)).sum();
            let normal = contact.normal * (contact.normal_force - contact.elastic_force);
            assert!((total - normal).norm() < 1e-9 * contact.elastic_force);
            let rest = torque - contact.rocking - (contact.point - centre).cross(&normal);
            assert!(rest.norm() < 1e-6 * contact.rocking.norm() + 1e-9 * contact.elastic_force);
            contact.rocking
        };
        let expected = 2.0 * zeta * (at.stiffness / 12.0 * inertia).sqrt();
        let slow = moment(1e-3, 1e-7, 1e-4);
        let ratio = -slow.dot(&axis) / (expected * 1e-3);
        assert!((ratio - 1.0).abs() < 0.01, "{ground:?}: {ratio}");
        assert!((slow + axis * slow.norm()).norm() < 0.01 * slow.norm());
        let fast = moment(100.0, 1e-7, 1e-9);
        let arm = fast.norm() / at.elastic_force;
        assert!(arm > 0.45 && arm < 0.75, "{ground:?}: {arm}");
        assert!(moment(1e-3, 0.0, 1e-4).norm() < 1e-9 * slow.norm());
        assert_eq!(moment(1e-3, -1e-7, 1e-4), Vector3::zeros());
    }
}

/// A block under a shear below the friction bound is shaken vertically and sideways: it does not creep.
#[test]
fn shaken_stick_does_not_creep() {
    let mut stream = Stream(2);
    for ground in GROUNDS {
        let mut rig = Rig::new(law(), ground);
        rig.update();
        rig.shift(Vector3::x() * 1.5e-4);
        let start = rig.update();
        assert!(!start.slides);
        for _ in 0..200 {
            let lift = 0.2 * DEPTH * stream.unit();
            let offset = stream.vector().component_mul(&Vector3::new(1.0, 1.0, 0.0)) * 1e-5;
            rig.shift(Vector3::z() * lift + offset);
            rig.update();
            rig.shift(-Vector3::z() * lift - offset);
        }
        let end = rig.update();
        let kept = end.friction.norm() / start.friction.norm();
        assert!(kept > 0.99, "{ground:?}: {kept}");
    }
}

/// A contact taken over from elsewhere begins with the given load of its springs, and gives it back.
#[test]
fn contacts_begin_with_the_friction_they_are_given() {
    let parameters = ContactParameters {
        rolling_friction: 0.1,
        ..law()
    };
    for ground in GROUNDS {
        let mut rig = Rig::new(parameters, ground);
        let load = rig.clone().update().normal_force;
        let a = match ground {
            Ground::Floor => Partner::Wall(0),
            Ground::Rigid | Ground::Soft => Partner::Body(0),
        };
        let b = rig.batch.len() as u32 - 1;
        let force = Vector3::new(0.2, -0.1, 0.0) * load;
        let torsion = 0.03 * load;
        let given = SpringLoad {
            force,
            torsion,
            rolling: Vector3::new(0.004, 0.002, 0.0) * load,
        };
        rig.batch.begin_springs(a, b, given).unwrap();
        rig.update();
        let contact = rig.update();
        assert!(
            (contact.rolling - given.rolling).norm() < 1e-6 * load,
            "{ground:?}"
        );
        let all = rig.batch.springs_of(b);
        let held = all[&(contact.a, contact.b)];
        assert!(
            (held.force - force).norm() < 1e-7 * load,
            "{ground:?} {held:?}"
        );
        assert!(
            (held.torsion - torsion).abs() < 1e-3 * torsion,
            "{ground:?} {held:?}"
        );
        assert!(
            (held.rolling - given.rolling).norm() < 1e-6 * load,
            "{ground:?} {held:?}"
        );
        assert!(
            (contact.friction - force).norm() < 1e-7 * load,
            "{ground:?} {}",
            (contact.friction - force) / load
        );
        let nodes = rig.upper.x.iter().zip(rig.batch.nodal_loads(b).friction);
        let moment: Vector3<f64> = nodes.map(|(x, f)| (x - contact.point).cross(f)).sum();
        assert!(
            (moment.z - torsion).abs() < 1e-3 * torsion,
            "{ground:?} {moment}"
        );
    }
}
