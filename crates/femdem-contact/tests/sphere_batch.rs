//! Exact spheres in a batch: among polyhedra, meshes and walls.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::pack::shape;
use crate::common::tets::{body, cube};
use femdem_contact::{
    BodyShape, ContactBatch, ContactLaw, ContactParameters, Field, Frame, MeshWall, Motion,
    Overlap, Partner, Sphere, SphereKernel, Wall,
};
use femdem_mesh::nalgebra::{Matrix3, UnitQuaternion, Vector3};

const PENALTY: f64 = 1e3;

/// Spheres of several sizes and polyhedra, drifting about in a box.
struct Pack {
    batch: ContactBatch,
    bodies: Vec<Motion>,
    walls: Vec<Motion>,
}

impl Pack {
    fn new(count: usize) -> Self {
        let law = ContactLaw::new(ContactParameters {
            penalty: PENALTY,
            ..ContactParameters::default()
        });
        let mut batch = ContactBatch::new(law.unwrap());
        let side = 1.1 * (count as f64).cbrt();
        for wall in Wall::closed_box(Vector3::zeros(), Vector3::repeat(side)).unwrap() {
            batch.add_wall(wall);
        }
        batch.add_wall(Wall::cylinder("mantle", 0.5 * side, 24).unwrap());
        let walls = vec![Motion::fixed(Frame::identity()); 7];
        for radius in [0.5, 0.7, 0.9] {
            batch.add_shape(Sphere::new(radius).unwrap());
        }
        batch.add_shape(shape("P5", 1.4));
        let mut stream = Stream(9);
        let mut bodies = Vec::new();
        for i in 0..count {
            batch.add_body((i % 4) as u32).unwrap();
            let frame = Frame {
                position: (stream.vector() + Vector3::repeat(0.5)) * side,
                rotation: stream.rotation(),
            };
            bodies.push(Motion {
                inverse_mass: 1.0,
                inverse_inertia: Matrix3::identity() * 4.0,
                inverse_inertia_max: 4.0,
                velocity: stream.vector() * 0.1,
                angular_velocity: stream.vector() * 0.1,
                ..Motion::fixed(frame)
            });
        }
        Self {
            batch,
            bodies,
            walls,
        }
    }

    fn step(&mut self) {
        let dt = 0.1;
        for (i, motion) in self.bodies.iter_mut().enumerate() {
            motion.frame.position += motion.velocity * dt;
            let turn = UnitQuaternion::from_scaled_axis(motion.angular_velocity * dt);
            let turn = turn.to_rotation_matrix().into_inner();
            motion.frame.rotation = turn * motion.frame.rotation;
            let radius = self.batch.shapes()[i % 4].radius();
            let speed = motion.velocity.norm() + motion.angular_velocity.norm() * radius;
            motion.travelled += speed * dt;
        }
        self.batch.update(&self.bodies, &self.walls, dt).unwrap();
    }

    /// The contact of a pair by the kernel.
    fn overlap(&self, a: Partner, b: usize) -> Option<Overlap> {
        let kernel = SphereKernel::new(PENALTY).unwrap();
        let frame_b = &self.bodies[b].frame;
        let own = &self.batch.shapes()[b % 4];
        let Partner::Body(i) = a else {
            let Partner::Wall(w) = a else { unreachable!() };
            let wall = self.batch.wall(w).unwrap().planes().unwrap();
            let at = &Frame::identity();
            return kernel.evaluate_wall(wall, at, own.sphere()?, &frame_b.position);
        };
        let frame_a = &self.bodies[i as usize].frame;
        match (&self.batch.shapes()[i as usize % 4], own) {
            (BodyShape::Sphere(one), BodyShape::Sphere(two)) => {
                kernel.evaluate(one, two, &(frame_b.position - frame_a.position))
            }
            (BodyShape::Convex(one), BodyShape::Sphere(two)) => {
                kernel.evaluate_convex(one, frame_a, two, &frame_b.position)
            }
            (BodyShape::Sphere(one), BodyShape::Convex(two)) => {
                let found = kernel.evaluate_convex(two, frame_b, one, &frame_a.position);
                found.map(|overlap| overlap.reversed())
            }
            _ => None,
        }
    }
}

/// Every contact of a sphere that the kernel finds is on record with its force, and no other; and the contacts of sleeping
/// or separate pairs cost nothing that changes this.
#[test]
fn the_batch_finds_what_the_kernel_finds() {
    let mut pack = Pack::new(60);
    let mut kinds = [0; 3];
    for _ in 0..30 {
        pack.step();
        let contacts = pack.batch.rigid_contacts();
        let found = |a: Partner, b: usize| {
            let mut all = contacts.iter();
            all.find(|c| (c.a, c.b as usize) == (a, b))
        };
        for b in 0..60 {
            let bodies = (0..b).map(|a| Partner::Body(a as u32));
            for a in bodies.chain((0..7).map(Partner::Wall)) {
                let convex = |i: usize| i % 4 == 3;
                let other = match a {
                    Partner::Body(i) => convex(i as usize),
                    Partner::Wall(_) => true,
                };
                if convex(b) && other {
                    continue;
                }
                let (want, got) = (pack.overlap(a, b), found(a, b));
                assert_eq!(want.is_some(), got.is_some(), "{a:?} {b}");
                if let (Some(want), Some(got)) = (want, got) {
                    let error = want.force - got.normal * got.elastic_force;
                    assert!(error.norm() < 1e-12 * want.force.norm());
                    assert_eq!(want.arm_b, got.arm_b);
                    let kind = match a {
                        Partner::Wall(_) => 0,
                        Partner::Body(_) if other || convex(b) => 1,
                        Partner::Body(_) => 2,
                    };
                    kinds[kind] += 1;
                }
            }
        }
    }
    assert!(kinds.iter().all(|&n| n > 100), "{kinds:?}");
}

/// The same bits for any number of threads, and by way of bytes.
#[cfg(feature = "parallel")]
#[test]
fn spheres_give_the_same_bits() {
    let run = |threads: usize, stored: bool| -> Vec<femdem_contact::Load> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut pack = Pack::new(200);
            for step in 0..12 {
                pack.step();
                if stored && step == 5 {
                    let config = bincode::config::standard();
                    let bytes = bincode::serde::encode_to_vec(&pack.batch, config).unwrap();
                    let shapes = pack.batch.shapes().to_vec();
                    let mut read: ContactBatch =
                        bincode::serde::decode_from_slice(&bytes, config).unwrap().0;
                    let mut wrong = shapes.clone();
                    wrong[0] = shapes[3].clone();
                    let error = read.restore_shapes(wrong, vec![]).unwrap_err().to_string();
                    assert!(error.contains("shape of body 0"), "{error}");
                    read.restore_shapes(shapes, vec![]).unwrap();
                    pack.batch = read;
                }
            }
            pack.batch.loads().to_vec()
        })
    };
    let first = run(1, false);
    assert!(first.iter().any(|load| load.contacts > 2));
    assert_eq!(first, run(3, false));
    assert_eq!(first, run(2, true));
}

/// A contact that can begin within the next step is announced, and none that cannot.
#[test]
fn an_approach_is_seen_ahead() {
    let law = ContactLaw::new(ContactParameters::default()).unwrap();
    let ball = Sphere::new(0.5).unwrap();
    let cube = shape("P5", 3.0_f64.sqrt());
    let others: [(Option<BodyShape>, f64); 3] = [
        (Some(ball.into()), 1.0),
        (Some(cube.into()), 1.0),
        (None, 0.5),
    ];
    for (other, distance) in others {
        let mut batch = ContactBatch::new(law);
        let own = batch.add_shape(ball);
        let mut bodies = Vec::new();
        let mut walls = Vec::new();
        match other {
            Some(shape) => {
                let id = batch.add_shape(shape);
                batch.add_body(id).unwrap();
                bodies.push(Motion::fixed(Frame::identity()));
            }
            None => {
                batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
                walls.push(Motion::fixed(Frame::identity()));
            }
        }
        let body = batch.add_body(own).unwrap();
        let mut motion = Motion::fixed(Frame::identity());
        motion.frame.position.z = distance + 0.01;
        motion.velocity.z = -1.0;
        bodies.push(motion);
        batch.update(&bodies, &walls, 0.0).unwrap();
        assert!(batch.rigid_contacts().is_empty());
        assert!(batch.may_touch(body, &bodies, &walls, 0.011));
        assert!(!batch.may_touch(body, &bodies, &walls, 0.009));
        bodies.last_mut().unwrap().velocity.z = 1.0;
        assert!(!batch.may_touch(body, &bodies, &walls, 0.011));
    }
}

/// A body of tetrahedra beside a ball, in either order, and a ball on a wall of tetrahedra.
#[test]
fn solids_of_tetrahedra_meet_the_exact_ball() {
    let (radius, depth) = (0.5, 0.05);
    let mesh = body(&cube(2), Field::Body);
    let top = mesh.support(&Vector3::z());
    let law = ContactLaw::new(ContactParameters::default()).unwrap();
    let ball = Sphere::new(radius).unwrap();
    let kernel = SphereKernel::new(law.parameters().penalty).unwrap();
    let mut above = Motion::fixed(Frame::identity());
    above.frame.position.z = top + radius - depth;
    let below = Motion::fixed(Frame::identity());
    let at = above.frame.position;
    let want = kernel.evaluate_mesh(&mesh, &below.frame, &ball, &at);
    let force = want[0].overlap.force_magnitude();
    for ball_first in [false, true] {
        let mut batch = ContactBatch::new(law);
        let shapes: [BodyShape; 2] = [mesh.clone().into(), ball.into()];
        let mut things = [(shapes[0].clone(), below), (shapes[1].clone(), above)];
        if ball_first {
            things.reverse();
        }
        for (shape, _) in &things {
            let id = batch.add_shape(shape.clone());
            batch.add_body(id).unwrap();
        }
        let bodies = things.map(|(_, motion)| motion);
        batch.update(&bodies, &[], 0.0).unwrap();
        let contacts = batch.rigid_contacts();
        assert_eq!(contacts.len(), 1);
        assert_eq!(contacts[0].elastic_force, force);
        let up = if ball_first { -1.0 } else { 1.0 };
        let normal = want[0].overlap.normal * up;
        assert!((contacts[0].normal - normal).norm() < 1e-12);
    }
    let mut batch = ContactBatch::new(law);
    let wall = MeshWall::solid("block", &cube(2));
    let on_wall = kernel.evaluate_solid_wall(wall.solid_wall(), &below.frame, &ball, &at);
    batch.add_wall(wall);
    let id = batch.add_shape(ball);
    batch.add_body(id).unwrap();
    let mut far = above;
    far.frame.position.z += 1.0;
    far.travelled = 0.0;
    batch.update(&[far], &[below], 0.0).unwrap();
    assert!(batch.rigid_contacts().is_empty());
    above.travelled = 1.0;
    batch.update(&[above], &[below], 0.0).unwrap();
    let contacts = batch.rigid_contacts();
    assert_eq!(contacts.len(), on_wall.len());
    let patch = on_wall.first().map(|p| p.overlap.force_magnitude());
    assert_eq!(contacts.first().map(|c| c.elastic_force), patch);
}
