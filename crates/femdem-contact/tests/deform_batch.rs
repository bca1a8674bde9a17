//! Deformable bodies in a batch: its contacts, the balance of its forces, and the same bits for any number
//! of threads.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::soft::Soft;
use crate::common::tets::{body, cube, dolos};
use femdem_contact::deform::{Modulus, NodalState};
use femdem_contact::{
    BodyShape, ContactBatch, ContactError, ContactLaw, ContactParameters, Field, Frame, MeshWall,
    Motion, Partner, Wall,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};

/// Deformable bodies, then rigid ones, and walls, with their motions.
#[derive(Clone)]
struct Scene {
    batch: ContactBatch,
    bodies: Vec<Soft>,
    velocities: Vec<Vec<Vector3<f64>>>,
    masses: Vec<Vec<f64>>,
    rigid: Vec<Motion>,
    walls: Vec<Motion>,
}

fn law(change: impl Fn(&mut ContactParameters)) -> ContactLaw {
    let mut parameters = ContactParameters {
        penalty: 1e5,
        ..ContactParameters::default()
    };
    change(&mut parameters);
    ContactLaw::new(parameters).unwrap()
}

fn moving(frame: Frame, velocity: Vector3<f64>, turn: Vector3<f64>) -> Motion {
    Motion {
        velocity,
        angular_velocity: turn,
        inverse_mass: 0.01,
        inverse_inertia: Matrix3::from_diagonal_element(0.05),
        inverse_inertia_max: 0.05,
        ..Motion::fixed(frame)
    }
}

impl Scene {
    fn new(law: ContactLaw) -> Self {
        Self {
            batch: ContactBatch::new(law),
            bodies: Vec::new(),
            velocities: Vec::new(),
            masses: Vec::new(),
            rigid: Vec::new(),
            walls: Vec::new(),
        }
    }

    fn add(&mut self, soft: Soft, modulus: Modulus) {
        let shape = self.batch.add_deformable_shape(soft.shape.clone());
        self.batch.add_deformable(shape, modulus).unwrap();
        self.velocities.push(vec![Vector3::zeros(); soft.x.len()]);
        self.masses.push(vec![0.5; soft.x.len()]);
        self.bodies.push(soft);
    }

    /// All motions, by number.
    fn motions(&self) -> Vec<Motion> {
        let mut motions = vec![Motion::fixed(Frame::identity()); self.bodies.len()];
        motions.extend(&self.rigid);
        motions
    }

    fn update(&mut self) -> Result<(), ContactError> {
        let motions = self.motions();
        let mut nodes: Vec<NodalState> = (0..self.bodies.len())
            .map(|i| NodalState {
                positions: &self.bodies[i].x,
                velocities: &self.velocities[i],
                inverse_masses: &self.masses[i],
            })
            .collect();
        nodes.resize(
            motions.len(),
            NodalState {
                positions: &[],
                velocities: &[],
                inverse_masses: &[],
            },
        );
        self.batch
            .update_deformables(&nodes, &motions, &self.walls, 0.0)
    }

    /// Moves everything by its velocity.
    fn drift(&mut self, dt: f64) {
        for (soft, v) in self.bodies.iter_mut().zip(&self.velocities) {
            for (x, v) in soft.x.iter_mut().zip(v) {
                *x += v * dt;
            }
        }
        for motion in self.rigid.iter_mut().chain(&mut self.walls) {
            let turn = motion.angular_velocity * dt;
            motion.frame = crate::common::turned(&motion.frame, &turn, 1.0);
            motion.frame.position += motion.velocity * dt;
            motion.travelled += motion.velocity.norm() * dt + 2.0 * turn.norm();
        }
    }

    /// Cubes, dolosse, a rigid dolos, a floor and a wall of tetrahedra in one heap.
    fn heap(stream: &mut Stream) -> Self {
        let mut scene = Self::new(law(|_| ()));
        let mut frame = Frame::identity();
        for (k, mesh) in [cube(2), dolos(), cube(2), cube(1), dolos()]
            .iter()
            .enumerate()
        {
            frame.position = Vector3::new(0.7 * (k % 3) as f64, 0.8 * (k / 3) as f64, 0.48);
            frame.rotation = stream.rotation();
            let soft = if k == 3 {
                Soft::quadratic(mesh)
            } else {
                Soft::linear(mesh)
            };
            let modulus = if k % 2 == 0 {
                Modulus::Penalty(1e5)
            } else {
                Modulus::Foundation(5e5)
            };
            scene.add(soft.posed(&frame).shaken(stream, 0.01), modulus);
        }
        for v in scene.velocities.iter_mut().flatten() {
            *v = stream.vector() * 0.3;
        }
        let shape = BodyShape::from(body(&dolos(), Field::Body));
        scene.batch.add_shape(shape);
        scene.batch.add_body(0).unwrap();
        frame.position = Vector3::new(0.7, 0.4, 1.1);
        let rigid = moving(frame, -Vector3::z() * 0.5, Vector3::new(0.3, 0.4, 0.0));
        scene.rigid.push(rigid);
        let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
        scene.batch.add_wall(floor);
        scene.batch.add_wall(MeshWall::solid("block", &cube(1)));
        scene.walls.push(Motion::fixed(Frame::identity()));
        frame.position = Vector3::new(-1.2, -0.3, 0.1);
        frame.rotation = Matrix3::identity();
        scene
            .walls
            .push(moving(frame, Vector3::x() * 0.1, Vector3::zeros()));
        scene
    }

    fn forces(&self) -> Vec<Vector3<f64>> {
        let all = 0..self.bodies.len() as u32;
        all.flat_map(|i| self.batch.nodal_loads(i).forces.to_vec())
            .collect()
    }
}

/// Lists and trees kept from step to step give the same contacts as fresh ones, and all forces together, with
/// friction and damping, balance.
#[test]
fn kept_lists_find_what_fresh_ones_find() {
    let mut stream = Stream(3);
    let mut kept = Scene::heap(&mut stream);
    let start = kept.clone();
    let mut seen = [false; 3];
    for step in 0..60 {
        kept.update().unwrap();
        // Friction has a history: only the elastic parts are compared.
        let mut fresh = kept.clone();
        fresh.batch = start.batch.clone();
        let mut without = kept.clone();
        let none = law(|p| p.friction = 0.0);
        fresh.batch.set_laws(none);
        without.batch.set_laws(none);
        fresh.update().unwrap();
        without.update().unwrap();
        let size = fresh.forces().iter().map(Vector3::norm).fold(0.0, f64::max);
        for (x, y) in without.forces().iter().zip(fresh.forces()) {
            assert!((x - y).norm() < 1e-9 * size, "step {step}: {x} {y}");
        }
        assert!(kept.batch.deformable_totals().unwrap().pieces > 0);
        let mut total = [Vector3::zeros(); 2];
        for (i, soft) in kept.bodies.iter().enumerate() {
            for (x, f) in soft.x.iter().zip(kept.batch.nodal_loads(i as u32).forces) {
                total[0] += f;
                total[1] += x.cross(f);
            }
        }
        let loads = kept.batch.loads()[5..].iter().zip(&kept.rigid);
        let walls = kept.batch.wall_loads().iter().zip(&kept.walls);
        for (load, motion) in loads.chain(walls) {
            total[0] += load.total.force;
            total[1] += load.total.torque + motion.frame.position.cross(&load.total.force);
        }
        assert!(total[0].norm() < 1e-12 * size, "{}", total[0]);
        assert!(total[1].norm() < 1e-11 * size, "{}", total[1]);
        for contact in kept.batch.deformable_contacts() {
            match contact.a {
                Partner::Body(a) => seen[usize::from(!kept.batch.is_deformable(a))] = true,
                Partner::Wall(_) => seen[2] = true,
            }
        }
        kept.drift(2e-3);
    }
    assert_eq!(seen, [true; 3]);
}

/// A deformable and a rigid body that fly past a row of others, over many times the skins of the search, and a wall that follows
/// them, meet what they would meet if all were looked for anew.
#[test]
fn bodies_from_afar_are_found() {
    let mut scene = Scene::new(law(|p| p.friction = 0.0));
    let at = |x: f64, y: f64, z: f64| Frame {
        position: Vector3::new(x, y, z),
        ..Frame::identity()
    };
    for k in 0..5 {
        let resting = Soft::linear(&cube(1)).posed(&at(1.5 * f64::from(k), 0.0, 0.0));
        scene.add(resting, Modulus::Penalty(1e5));
    }
    // On its way it also overtakes the rigid body, and the wall overtakes both.
    scene.add(
        Soft::linear(&cube(1)).posed(&at(-3.0, 0.95, 0.0)),
        Modulus::Penalty(1e5),
    );
    scene.velocities[5].fill(Vector3::x() * 1.4);
    let shape = BodyShape::from(body(&cube(1), Field::Body));
    scene.batch.add_shape(shape);
    scene.batch.add_body(0).unwrap();
    let turn = Vector3::zeros();
    scene
        .rigid
        .push(moving(at(-1.0, 0.5, 0.95), Vector3::x(), turn));
    let wall = Wall::half_space("behind", Vector3::x(), 0.0).unwrap();
    scene.batch.add_wall(wall);
    scene
        .walls
        .push(moving(at(-6.0, 0.0, 0.0), Vector3::x() * 1.8, turn));
    let start = scene.batch.clone();
    let touching = |scene: &Scene| -> Vec<_> {
        let contacts = scene.batch.deformable_contacts();
        contacts.map(|c| (c.a, c.b)).collect()
    };
    let mut met = std::collections::BTreeSet::new();
    for step in 0..440 {
        // A rigid body may be looked up again in an update of its own kind, long before the deformable ones are.
        if step % 3 > 0 {
            let motions = scene.motions();
            scene.batch.update(&motions, &scene.walls, 0.0).unwrap();
        }
        if step % 3 == 1 {
            scene.drift(0.02);
            continue;
        }
        scene.update().unwrap();
        let mut fresh = scene.clone();
        fresh.batch = start.clone();
        fresh.update().unwrap();
        let found = touching(&scene);
        assert_eq!(found, touching(&fresh), "step {step}");
        met.extend(found);
        scene.drift(0.02);
    }
    // Each of the two meets the five; they meet each other, and the wall meets the six.
    assert_eq!(met.len(), 5 + 5 + 1 + 6, "{met:?}");
}

/// What is removed acts no more than what is a kilometre away, at once and in the next update, in which its state is not
/// read. What touched it is named, and its number is given out again.
#[test]
fn what_is_removed_acts_no_more() {
    let mut stream = Stream(3);
    let mut kept = Scene::heap(&mut stream);
    let start = kept.clone();
    let none = law(|p| p.friction = 0.0);
    let mut named = [0; 3];
    for step in 0..60 {
        kept.update().unwrap();
        for (kind, thing) in [Partner::Body(1), Partner::Body(5), Partner::Wall(0)]
            .into_iter()
            .enumerate()
            .filter(|_| step % 10 == 9)
        {
            let (mut left, mut far) = (kept.clone(), kept.clone());
            far.batch = start.batch.clone();
            far.batch.set_laws(none);
            left.batch.set_laws(none);
            left.update().unwrap();
            let contacts = left.batch.deformable_contacts();
            let own = contacts.filter(|c| c.a == thing || Partner::Body(c.b) == thing);
            let others = own.flat_map(|c| [c.a, Partner::Body(c.b)]);
            let body = |p: Partner| match p {
                Partner::Body(body) if p != thing => Some(body),
                _ => None,
            };
            let mut expected: Vec<_> = others.filter_map(body).collect();
            expected.sort_unstable();
            expected.dedup();
            let touched = match kind {
                0 => left.batch.remove_body(1),
                1 => left.batch.remove_body(5),
                _ => left.batch.remove_wall(0),
            };
            assert_eq!(touched.unwrap(), expected);
            named[kind] += expected.len();
            let away = Vector3::z() * 1e3;
            match kind {
                0 => far.bodies[1].x.iter_mut().for_each(|x| *x += away),
                1 => far.rigid[0].frame.position += away,
                _ => far.walls[0].frame.position -= Vector3::z() * 1e3,
            }
            far.update().unwrap();
            let size = far.forces().iter().map(Vector3::norm).fold(0.0, f64::max);
            let compare = |left: &Scene| {
                for i in (0..5).filter(|i| (kind, *i) != (0, 1)) {
                    for (x, y) in left
                        .batch
                        .nodal_loads(i)
                        .forces
                        .iter()
                        .zip(far.batch.nodal_loads(i).forces)
                    {
                        assert!((x - y).norm() < 1e-9 * size, "{kind} at {step}: {x} {y}");
                    }
                }
                let loads = |scene: &Scene| {
                    let batch = &scene.batch;
                    let all = batch.loads().iter().chain(batch.wall_loads());
                    all.map(|load| load.total.force).collect::<Vec<_>>()
                };
                for (x, y) in loads(left).iter().zip(loads(&far)) {
                    assert!((x - y).norm() < 1e-9 * size, "{kind} at {step}: {x} {y}");
                }
            };
            compare(&left);
            match kind {
                0 => {
                    left.bodies[1].x.clear();
                    left.velocities[1].clear();
                    left.masses[1].clear();
                }
                1 => left.rigid[0].frame.position.x = f64::NAN,
                _ => left.walls[0].frame.position.x = f64::NAN,
            }
            left.update().unwrap();
            compare(&left);
            let again = match kind {
                0 => left.batch.add_deformable(0, Modulus::Penalty(1e5)).unwrap(),
                1 => left.batch.add_body(0).unwrap(),
                _ => left.batch.add_wall(MeshWall::solid("block", &cube(1))),
            };
            assert_eq!(again, [1, 5, 0][kind]);
            assert!(left.batch.remove_body(7).is_err() && left.batch.remove_wall(7).is_err());
        }
        kept.drift(2e-3);
    }
    assert!(named.iter().all(|n| *n > 2), "{named:?}");
}

/// Between a sleeping rigid body and sleeping deformable ones nothing is evaluated. One that wakes meets those that sleep on.
#[test]
fn sleepers_of_both_kinds_rest_together() {
    let mut scene = Scene::heap(&mut Stream(3));
    scene
        .velocities
        .iter_mut()
        .for_each(|v| v.fill(Vector3::zeros()));
    for motion in scene.rigid.iter_mut().chain(&mut scene.walls) {
        *motion = Motion::fixed(motion.frame);
    }
    let lower = |scene: &mut Scene, by: f64| {
        scene.rigid[0].frame.position.z -= by;
        scene.rigid[0].travelled += by;
        scene.update().unwrap();
        scene.batch.loads()[5]
    };
    assert!(lower(&mut scene, 0.3).contacts > 0);
    (0..6).for_each(|body| scene.batch.set_awake(body, false));
    (0..3).for_each(|_| scene.update().unwrap());
    assert!((0..5).all(|body| !scene.batch.is_stirred(body)));
    let asleep = scene.batch.loads()[5];
    scene.batch.set_awake(5, true);
    let awake = lower(&mut scene, 0.02);
    assert!(awake.normal_sum > 1.05 * asleep.normal_sum && asleep.normal_sum > 0.0);
    assert!((0..5).any(|body| scene.batch.is_stirred(body)));
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut scene = Scene::heap(&mut Stream(4));
            let mut trace = Vec::new();
            for _ in 0..40 {
                advance(&mut scene, &mut trace);
            }
            trace
        })
    };
    let one = run(1);
    assert!(one.iter().any(|f| f.norm() > 0.0));
    for threads in [2, 4] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// One step of motion under the contact forces.
fn advance(scene: &mut Scene, trace: &mut Vec<Vector3<f64>>) {
    scene.update().unwrap();
    for i in 0..scene.bodies.len() {
        let pairs = scene.velocities[i].iter_mut();
        for (v, f) in pairs.zip(scene.batch.nodal_loads(i as u32).forces) {
            *v += f * 2e-5;
        }
    }
    trace.extend(scene.forces());
    trace.push(scene.batch.loads()[5].total.torque);
    scene.drift(1e-3);
}

/// A batch that was written and read continues with the same bits, including lists and springs.
#[test]
fn a_restart_goes_on_with_the_same_bits() {
    let mut scene = Scene::heap(&mut Stream(4));
    let mut trace = Vec::new();
    for _ in 0..25 {
        advance(&mut scene, &mut trace);
    }
    let config = bincode::config::standard();
    let bytes = bincode::serde::encode_to_vec(&scene.batch, config).unwrap();
    let mut again = scene.clone();
    again.batch = bincode::serde::decode_from_slice(&bytes, config).unwrap().0;
    let rigid = vec![BodyShape::from(body(&dolos(), Field::Body))];
    let shapes = scene.batch.deformable_shapes().to_vec();
    assert!(again.update().is_err(), "its shapes are missing");
    again.batch.restore_shapes(rigid, shapes).unwrap();
    let mut traces = [Vec::new(), Vec::new()];
    for _ in 0..25 {
        advance(&mut scene, &mut traces[0]);
        advance(&mut again, &mut traces[1]);
    }
    assert!(
        scene
            .batch
            .deformable_contacts()
            .any(|c| c.spring_energy > 0.0)
    );
    assert!(traces[0] == traces[1]);
}

#[test]
fn unusable_states_are_named() {
    let mut stream = Stream(5);
    let good = Scene::heap(&mut stream);
    let why = |change: &dyn Fn(&mut Scene)| {
        let mut scene = good.clone();
        scene.update().unwrap();
        change(&mut scene);
        scene.update().unwrap_err()
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let node = ContactError::NodeState { body: 1, node: 2 };
        assert_eq!(why(&|s| s.bodies[1].x[2].y = bad), node);
        assert_eq!(why(&|s| s.velocities[1][2].y = bad), node);
        assert_eq!(why(&|s| s.masses[1][2] = bad), node);
        assert!(matches!(
            why(&|s| s.rigid[0].frame.position.x = bad),
            ContactError::NotFinite { body: 5, .. }
        ));
    }
    assert_eq!(
        why(&|s| s.masses[1][2] = -1.0),
        ContactError::NodeState { body: 1, node: 2 }
    );
    assert!(matches!(
        why(&|s| {
            s.velocities[0].pop();
        }),
        ContactError::NodeCount {
            body: 0,
            given: 26,
            expected: 27
        }
    ));
    assert!(matches!(
        why(&|s| {
            s.rigid.clear();
        }),
        ContactError::StateCount {
            what: "body",
            given: 5,
            expected: 6
        }
    ));
    assert!(matches!(
        why(&|s| {
            for x in &mut s.bodies[2].x {
                x.z = 0.9 - x.z;
            }
        }),
        ContactError::InvertedTet { body: 2, .. }
    ));
    let mut empty = Scene::new(law(|_| ()));
    empty.update().unwrap();
    assert!(
        empty
            .batch
            .add_deformable(0, Modulus::Penalty(1.0))
            .is_err()
    );
    assert!(empty.batch.add_body(0).is_err());
    assert!(
        empty.batch.nodal_loads(3).forces.is_empty() && empty.batch.nodal_loads(3).rates.is_empty()
    );
    let mut scene = good.clone();
    for bad in [0.0, f64::NAN, -1.0] {
        assert!(
            scene
                .batch
                .add_deformable(0, Modulus::Foundation(bad))
                .is_err()
        );
    }
    let rigid = scene.batch.shapes().to_vec();
    assert!(scene.batch.restore_shapes(rigid, Vec::new()).is_err());
    assert!(scene.batch.restore_shapes(Vec::new(), Vec::new()).is_err());
}

/// Contacts between sleepers stay as they are, and the forces of sleepers on awake bodies are as if they were
/// awake.
#[test]
fn sleepers_at_rest_have_the_forces_of_awake_bodies() {
    let mut awake = Scene::heap(&mut Stream(5));
    let mut trace = Vec::new();
    for _ in 0..10 {
        advance(&mut awake, &mut trace);
    }
    for v in awake.velocities.iter_mut().flatten() {
        *v = Vector3::zeros();
    }
    for motion in awake.rigid.iter_mut().chain(&mut awake.walls) {
        *motion = Motion::fixed(motion.frame);
    }
    // Pairs that may touch a rigid body are evaluated; move it away.
    awake.rigid[0].frame.position.z += 50.0;
    awake.rigid[0].travelled += 50.0;
    let mut asleep = awake.clone();
    let count = asleep.bodies.len() as u32;
    (0..count).for_each(|i| asleep.batch.set_awake(i, false));
    let both = |scenes: [&mut Scene; 2]| {
        let [a, b] = scenes.map(|scene| {
            scene.update().unwrap();
            scene.forces()
        });
        assert!(a.iter().any(|f| f.norm() > 0.0));
        let largest = a.iter().map(Vector3::norm).fold(0.0, f64::max);
        // Springs that are updated without motion change in their last bits.
        let alike = |(x, y): (&Vector3<f64>, &Vector3<f64>)| (x - y).norm() < 1e-12 * largest;
        assert!(largest > 0.0 && a.iter().zip(&b).all(alike));
    };
    for _ in 0..3 {
        both([&mut awake, &mut asleep]);
    }
    assert!((0..count).any(|i| !asleep.batch.is_stirred(i) && asleep.batch.touches(i)));
    // One body moves through the others.
    asleep.batch.set_awake(0, true);
    assert!(asleep.batch.is_awake(0) && !asleep.batch.is_awake(1));
    for _ in 0..20 {
        for scene in [&mut awake, &mut asleep] {
            scene.velocities[0].fill(Vector3::new(0.3, 0.2, 0.1));
            scene.drift(0.02);
        }
        both([&mut awake, &mut asleep]);
    }
    // A wall is added amid the sleepers.
    let place = asleep.bodies[1].x[0];
    for scene in [&mut awake, &mut asleep] {
        let touching = scene.batch.deformable_totals().unwrap().touching;
        let lid = Wall::half_space("lid", Vector3::y(), place.y + 0.05).unwrap();
        scene.batch.add_wall(lid);
        scene.walls.push(Motion::fixed(Frame::identity()));
        scene.update().unwrap();
        assert!(scene.batch.deformable_totals().unwrap().touching > touching);
    }
    both([&mut awake, &mut asleep]);
    let stiffer = law(|p| p.penalty *= 2.0);
    awake.batch.set_laws(stiffer);
    asleep.batch.set_laws(stiffer);
    both([&mut awake, &mut asleep]);
    asleep.velocities[1].pop();
    let node_count = ContactError::NodeCount {
        body: 1,
        given: asleep.velocities[1].len(),
        expected: asleep.bodies[1].x.len(),
    };
    assert_eq!(asleep.update(), Err(node_count));
}
