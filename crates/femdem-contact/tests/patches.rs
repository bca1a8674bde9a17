//! Meshed bodies and walls in the batch: the same contacts as the convex kernel's where both apply, several
//! patches to a pair, and friction that is kept through their splits and merges.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::meshes::{block, boxes, dolos};
use crate::common::pack::{advance, placed, shape, stir};
use crate::common::{Stream, turned};
use femdem_contact::{
    BodyShape, ContactBatch, ContactLaw, ContactParameters, ConvexShape, Field, FieldMesh, Frame,
    MeshWall, Motion, Partner, RigidContact, Wall, WallShape,
};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::{Matrix3, Point3, UnitQuaternion, Vector3};
use femdem_mesh::tet::RevolvedShell;
use std::sync::Arc;

fn batch(parameters: ContactParameters) -> ContactBatch {
    ContactBatch::new(ContactLaw::new(parameters).unwrap())
}

/// Largest difference of two contacts over the larger force, in force and moment about B.
fn difference(x: &RigidContact, y: &RigidContact) -> f64 {
    let size = x.elastic_force.max(y.elastic_force);
    let force = (x.force_on_b() - y.force_on_b()).norm();
    let torque = |c: &RigidContact| {
        let scale = c.normal_force / c.elastic_force;
        c.moment * scale + c.normal * c.torsion + c.arm_b.cross(&c.force_on_b())
    };
    force.max((torque(x) - torque(y)).norm()) / size
}

/// Contacts with a force that is not lost in rounding.
fn firm(batch: &ContactBatch) -> Vec<RigidContact> {
    let all = batch.rigid_contacts().into_iter().copied();
    all.filter(|c| c.elastic_force > 1e-9).collect()
}

/// Convex bodies, and the same with every second one, or all, as a mesh: the same contacts, damping and
/// friction while they drift about between walls.
#[test]
fn fans_touch_as_convex_bodies_do() {
    let count = 24;
    let side = 1.35 * f64::from(count).cbrt();
    let mut walls: Vec<WallShape> = Wall::closed_box(Vector3::zeros(), Vector3::repeat(side))
        .unwrap()
        .into_iter()
        .map(WallShape::from)
        .collect();
    walls.push(Wall::cylinder("mantle", 0.6 * side, 20).unwrap().into());
    let mut wall_motions = vec![Motion::fixed(Frame::identity()); walls.len()];
    wall_motions[6].frame.position = Vector3::new(0.5 * side, 0.5 * side, 0.0);
    let parameters = ContactParameters {
        penalty: 1e3,
        damping_ratio: 0.0,
        ..ContactParameters::default()
    };
    let mut stream = Stream(11);
    let shapes: Vec<Arc<ConvexShape>> = (0..count)
        .map(|i| {
            let id = ["P1", "A10", "P5", "A1", "P3"][i as usize % 5];
            shape(id, 1.0 + 0.03 * f64::from(i))
        })
        .collect();
    let mut batches = [0, 2, 1].map(|every| {
        let mut batch = batch(parameters);
        for wall in &walls {
            batch.add_wall(wall.clone());
        }
        for (i, s) in shapes.iter().enumerate() {
            let is_mesh = every > 0 && i % every == 0;
            let shape: BodyShape = if is_mesh {
                s.fan().unwrap().into()
            } else {
                s.clone().into()
            };
            let id = batch.add_shape(shape);
            batch.add_body(id).unwrap();
        }
        batch
    });
    let mut bodies: Vec<Motion> = shapes
        .iter()
        .map(|s| {
            let position = (stream.vector() + Vector3::repeat(0.5)) * (0.8 * side);
            placed(s, position.add_scalar(0.1 * side), stream.rotation())
        })
        .collect();
    let mut compared = 0;
    let mut worst = 0.0_f64;
    for step in 0..120 {
        for (body, s) in bodies.iter_mut().zip(&shapes) {
            if step % 40 == 0 {
                stir(body, s, &mut stream);
            }
            advance(body, s, 0.2);
        }
        for batch in &mut batches {
            batch.update(&bodies, &wall_motions, 0.2).unwrap();
        }
        let [convex, mixed, meshed] = [0, 1, 2].map(|k| firm(&batches[k]));
        for other in [&mixed, &meshed] {
            let pairs =
                |x: &[RigidContact]| x.iter().map(|c| (c.a, c.b, c.patch)).collect::<Vec<_>>();
            assert_eq!(pairs(&convex), pairs(other), "step {step}");
            // For the slightest contacts the kernels' energies agree to fewer digits.
            let firm = |c: &&RigidContact| c.elastic_force > 1e-5;
            let other = other.iter().filter(firm);
            for (x, y) in convex.iter().filter(firm).zip(other) {
                let off = difference(x, y);
                worst = worst.max(off);
                assert!(off < 1e-6, "step {step}: {off:e} between {x:?} and {y:?}");
                compared += 1;
            }
        }
    }
    assert!(compared > 3000, "only {compared} contacts were compared");
    assert!(worst < 1e-7, "{worst:e}");
}

/// A floor as a half-space, as a block and as a sheet, under a convex body and under a meshed one, at many
/// positions and orientations: the same contact to 1e-10.
#[test]
fn a_plane_given_as_planes_and_as_a_mesh() {
    let plane = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    let solid = block(
        Vector3::new(-3.0, -3.0, -2.0),
        Vector3::new(3.0, 3.0, 0.0),
        2,
    );
    let slab = MeshWall::solid("floor", &solid);
    let corners = [[-4.0, -3.0], [4.0, -3.5], [3.0, 4.0], [-3.0, 3.0]];
    let corners = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let sheet = MeshWall::sheet("floor", corners, vec![[0, 1, 2], [0, 2, 3]], 2.0).unwrap();
    let mut stream = Stream(5);
    let mut compared = 0;
    for id in ["P1", "P5", "A1", "A10"] {
        let convex = shape(id, 1.0);
        let walls: [WallShape; 3] = [
            plane.clone().into(),
            slab.clone().into(),
            sheet.clone().into(),
        ];
        for _ in 0..40 {
            let height = convex.inradius() * (0.7 + 0.6 * stream.unit());
            let place = stream.vector() * 2.0;
            let mut body = placed(
                &convex,
                Vector3::new(place.x, place.y, height),
                stream.rotation(),
            );
            stir(&mut body, &convex, &mut stream);
            let mut found: Vec<Vec<RigidContact>> = Vec::new();
            for wall in &walls {
                for is_mesh in [false, true] {
                    let mut batch = batch(ContactParameters::default());
                    batch.add_wall(wall.clone());
                    let id = if is_mesh {
                        batch.add_shape(convex.fan().unwrap())
                    } else {
                        batch.add_shape(convex.clone())
                    };
                    batch.add_body(id).unwrap();
                    let still = Motion::fixed(Frame::identity());
                    batch.update(&[body], &[still], 1e-3).unwrap();
                    found.push(firm(&batch));
                }
            }
            let counts: Vec<usize> = found.iter().map(Vec::len).collect();
            assert_eq!(counts, vec![counts[0]; 6], "{id}");
            for other in &found[1..] {
                for (x, y) in found[0].iter().zip(other) {
                    let off = difference(x, y);
                    assert!(off < 1e-10, "{id}: {off:e} between {x:?} and {y:?}");
                    let close = |x: f64, y: f64| (x / y - 1.0).abs() < 1e-9;
                    assert!(close(x.energy, y.energy) && close(x.volume, y.volume));
                    assert!(
                        close(x.foundation.stiffness, y.foundation.stiffness),
                        "{x:?} {y:?}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 300, "only {compared}");
}

/// A dolos on the floor that overlaps it by `depth` with an edge of one bar and the end of the other.
fn on_two_patches(mesh: &TetMesh, depth: f64) -> Motion {
    // The line from one edge to the other is level.
    let from = Vector3::new(1.0, 0.0, -0.5).normalize();
    let tilt = UnitQuaternion::rotation_between(&from, &-Vector3::z()).unwrap();
    let rotation = tilt.to_rotation_matrix().into_inner();
    let heights = mesh.points().iter().map(|p| (rotation * p.coords).z);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    let mut body = Motion::fixed(Frame {
        position: Vector3::z() * (-lowest - depth),
        rotation,
    });
    body.inverse_mass = 1.0;
    body.inverse_inertia = Matrix3::identity();
    body.inverse_inertia_max = 1.0;
    body.travelled = depth;
    body
}

/// A dolos lies on an edge of one bar and the end of the other: two patches. Their sum is the whole wrench,
/// and the pair counts once.
#[test]
fn several_patches_are_one_partner() {
    let mesh = dolos(0.5);
    let field = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body).unwrap();
    let mut batch = batch(ContactParameters::default());
    let id = batch.add_shape(field);
    batch.add_body(id).unwrap();
    batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
    let mut found = 0;
    for depth in [0.01, 0.05, 0.1, 0.2] {
        let body = on_two_patches(&mesh, depth);
        let still = Motion::fixed(Frame::identity());
        batch.update(&[body], &[still], 1e-3).unwrap();
        let contacts = batch.rigid_contacts();
        found = found.max(contacts.len());
        for (rank, c) in contacts.iter().enumerate() {
            assert_eq!((c.a, c.b, c.patch), (Partner::Wall(0), 0, rank as u32));
            assert!((c.normal - Vector3::z()).norm() < 0.9);
        }
        let load = batch.loads()[0];
        assert_eq!(load.contacts, 1);
        assert_eq!(batch.totals().touching, 1);
        let sum: Vector3<f64> = contacts.iter().map(|c| c.force_on_b()).sum();
        assert!((sum - load.total.force).norm() <= 1e-12 * sum.norm());
    }
    assert!(found >= 2, "{found} patches");
}

/// Two patches together have the friction dashpot of their springs together. If each had that of a separate
/// contact, the sum would be larger by the square root of two.
#[test]
fn several_patches_share_the_friction_dashpot() {
    let mesh = dolos(0.5);
    let field = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body).unwrap();
    let zeta = 0.3;
    let mut batch = batch(ContactParameters {
        tangential_damping: zeta,
        ..ContactParameters::default()
    });
    let id = batch.add_shape(field);
    batch.add_body(id).unwrap();
    batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
    let mut body = on_two_patches(&mesh, 0.05);
    // No rotation: the effective mass of a patch is that of the body.
    body.inverse_inertia = Matrix3::zeros();
    body.inverse_inertia_max = 0.0;
    let still = Motion::fixed(Frame::identity());
    batch.update(&[body], &[still], 1e-3).unwrap();
    let contacts = batch.rigid_contacts();
    assert!(contacts.len() >= 2);
    let stiffness: f64 = contacts.iter().map(|c| c.tangential_stiffness).sum();
    let viscosity: f64 = contacts.iter().map(|c| c.dashpots().tangential).sum();
    let want = 2.0 * zeta * (stiffness / body.inverse_mass).sqrt();
    assert!((viscosity / want - 1.0).abs() < 1e-12, "{viscosity} {want}");
}

/// A fixed block under a block on two feet, whose middle touches too when it is pressed deeper: then there is
/// one patch, otherwise there are two.
struct Press {
    batch: ContactBatch,
    travelled: f64,
    last: Vector3<f64>,
}

const CHANNEL: f64 = 0.02;

impl Press {
    fn new() -> Self {
        let mut batch = batch(ContactParameters {
            penalty: 1e6,
            friction: 10.0,
            damping_ratio: 0.0,
            tangential_damping: 0.0,
            ..ContactParameters::default()
        });
        let x = [-0.5, -0.2, 0.2, 0.5];
        let y = [-0.5, 0.0, 0.5];
        let z = [0.0, CHANNEL, 0.5, 1.0];
        let mut cells = Vec::new();
        for k in 0..3 {
            for j in 0..2 {
                for i in 0..3 {
                    if !(k == 0 && i == 1) {
                        cells.push([i, j, k]);
                    }
                }
            }
        }
        let feet = boxes(&cells, &x, &y, &z);
        let table = block(
            Vector3::new(-1.0, -1.0, -1.0),
            Vector3::new(1.0, 1.0, 0.0),
            2,
        );
        for mesh in [&table, &feet] {
            let shape = FieldMesh::new(mesh, Vector3::zeros(), Field::Body).unwrap();
            let id = batch.add_shape(shape);
            batch.add_body(id).unwrap();
        }
        Self {
            batch,
            travelled: 0.0,
            last: Vector3::zeros(),
        }
    }

    /// Moves the feet by `aside`, `depth` deep and rotated by `twist`; returns the contacts.
    fn update(
        &mut self,
        aside: Vector3<f64>,
        depth: f64,
        twist: f64,
        dt: f64,
    ) -> Vec<RigidContact> {
        let to = Vector3::new(aside.x, aside.y, -depth);
        let table = Motion::fixed(Frame::identity());
        let mut feet = Motion::fixed(turned(&Frame::identity(), &Vector3::z(), twist));
        feet.frame.position = to;
        self.travelled += (to - self.last).norm() + 0.1;
        self.last = to;
        feet.travelled = self.travelled;
        feet.inverse_mass = 1.0;
        feet.inverse_inertia = Matrix3::identity();
        feet.inverse_inertia_max = 1.0;
        self.batch.update(&[table, feet], &[], dt).unwrap();
        self.batch.rigid_contacts().into_iter().copied().collect()
    }
}

/// Friction on B, energy in the springs and number of patches.
fn held(contacts: &[RigidContact]) -> (Vector3<f64>, f64, usize) {
    (
        contacts.iter().map(|c| c.friction).sum(),
        contacts.iter().map(|c| c.spring_energy).sum(),
        contacts.len(),
    )
}

/// Held aside, the feet are pressed deeper and released again, many times: the patch merges and splits.
/// Throughout, the springs keep their force when they become stiffer and their stretch when they become
/// softer, never gain energy, and keep sticking.
#[test]
fn splits_and_merges_keep_the_stick() {
    let mut press = Press::new();
    let aside = Vector3::new(4e-4, -3e-4, 0.0);
    let (low, high) = (0.9 * CHANNEL, 1.1 * CHANNEL);
    press.update(Vector3::zeros(), low, 0.0, 1e-3);
    let start = press.update(aside, low, 0.0, 1e-3);
    let springs =
        |list: &[RigidContact]| -> f64 { list.iter().map(|c| c.tangential_stiffness).sum() };
    let (first, mut energy, mut patches) = held(&start);
    assert_eq!(patches, 2);
    assert!((first + aside * springs(&start)).norm() < 1e-9 * first.norm());
    let steps = 400;
    let (mut merged, mut split) = (0, 0);
    let (mut last, mut stiffness) = (first, springs(&start));
    for step in 1..=3 * steps {
        let phase = std::f64::consts::TAU * (f64::from(step) + 0.3) / f64::from(steps);
        let depth = low + (high - low) * 0.5 * (1.0 - phase.cos());
        let now = press.update(aside, depth, 0.0, 1e-3);
        let (force, stored, count) = held(&now);
        let k = springs(&now);
        merged += u32::from(count < patches);
        split += u32::from(count > patches);
        let expected = last * (k / stiffness).min(1.0);
        let off = (force - expected).norm() / expected.norm();
        assert!(
            off < 1e-3,
            "step {step}: {off:e} from {patches} to {count} patches"
        );
        assert!(
            stored <= energy * (1.0 + 1e-9),
            "step {step}: {stored} J after {energy} J"
        );
        (last, energy, patches, stiffness) = (force, stored, count, k);
    }
    assert_eq!((merged, split), (3, 3));
    assert!(last.dot(&first) > 0.999 * last.norm() * first.norm() && last.norm() > 1.0);
}

/// Closed paths with splits and merges on the way, tangential, deep and twisting: friction dissipates energy
/// and never adds any.
#[test]
fn closed_paths_with_splits_gain_nothing() {
    let mut stream = Stream(3);
    for trial in 0..6 {
        let mut press = Press::new();
        let waves: Vec<[f64; 4]> = (0..4)
            .map(|_| [0, 1, 2, 3].map(|_| stream.unit() - 0.5))
            .collect();
        let steps = 600;
        let path = |step: u32| {
            let phase = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
            let wave = |k: usize, m: f64| {
                waves[k][0] * (m * phase).sin() + waves[k][1] * (1.0 - (m * phase).cos())
            };
            (
                Vector3::new(wave(0, 1.0), wave(1, 2.0), 0.0) * 2e-3,
                CHANNEL * (1.0 + 0.2 * (3.0 * phase).sin()),
                2e-3 * wave(2, 1.0),
            )
        };
        let (x, depth, twist) = path(0);
        let mut last = press.update(x, depth, twist, 0.0);
        let mut changes = 0;
        let (mut work, mut stored_most) = (0.0, 0.0_f64);
        let mut before = (x, twist);
        for step in 1..=3 * steps {
            let (x, depth, twist) = path(step);
            // Torsion advances by the angular velocity, so the motion is given one.
            let now = press.update_turning(x, depth, twist, twist - before.1);
            changes += u32::from(now.len() != last.len());
            let power = |list: &[RigidContact]| -> f64 {
                list.iter()
                    .map(|c| {
                        let moment = c.torsion + c.arm_b.cross(&c.friction).z;
                        c.friction.dot(&(x - before.0)) + moment * (twist - before.1)
                    })
                    .sum()
            };
            work += 0.5 * (power(&now) + power(&last));
            let stored: f64 = now.iter().map(|c| c.spring_energy).sum();
            stored_most = stored_most.max(stored);
            assert!(
                work + stored <= 0.02 * stored_most + 1e-12,
                "trial {trial}, step {step}: {work} J with {stored} J stored"
            );
            last = now;
            before = (x, twist);
        }
        assert!(changes >= 6 && stored_most > 0.0, "{changes}");
    }
}

impl Press {
    /// As `update` with unit time step and the corresponding angular velocity.
    fn update_turning(
        &mut self,
        aside: Vector3<f64>,
        depth: f64,
        twist: f64,
        rate: f64,
    ) -> Vec<RigidContact> {
        let to = Vector3::new(aside.x, aside.y, -depth);
        let table = Motion::fixed(Frame::identity());
        let mut feet = Motion::fixed(turned(&Frame::identity(), &Vector3::z(), twist));
        feet.velocity = to - self.last;
        feet.angular_velocity = Vector3::z() * rate;
        feet.frame.position = to;
        self.travelled += (to - self.last).norm() + rate.abs() + 1e-6;
        self.last = to;
        feet.travelled = self.travelled;
        feet.inverse_mass = 1.0;
        feet.inverse_inertia = Matrix3::identity();
        feet.inverse_inertia_max = 1.0;
        self.batch.update(&[table, feet], &[], 1.0).unwrap();
        self.batch.rigid_contacts().into_iter().copied().collect()
    }
}

/// A ball-like body lies in a drum: the plates below carry its weight on the inside, and a body outside
/// touches nothing.
#[test]
fn a_drum_holds_what_is_inside() {
    let upright = RevolvedShell {
        profile: vec![[0.0, -1.5], [2.0, -1.5], [2.0, 1.5], [0.0, 1.5]],
        thickness: 0.5,
        facets: 24,
    };
    let upright = upright.mesh().unwrap();
    let lying = upright.points().iter().map(|p| Point3::new(p.y, p.z, p.x));
    let drum = TetMesh::new(lying.collect(), upright.tets().to_vec()).unwrap();
    let ball = shape("A10", 1.0);
    let mut batch = batch(ContactParameters::default());
    batch.add_wall(MeshWall::solid("drum", &drum));
    let id = batch.add_shape(ball.clone());
    batch.add_body(id).unwrap();
    let still = Motion::fixed(Frame::identity());
    let mut at = |x: f64, y: f64, z: f64, travelled: f64| {
        let mut body = placed(&ball, Vector3::new(x, y, z), Matrix3::identity());
        body.travelled = travelled;
        batch.update(&[body], &[still], 0.0).unwrap();
        batch
            .rigid_contacts()
            .into_iter()
            .copied()
            .collect::<Vec<_>>()
    };
    assert!(at(0.0, 0.0, 0.0, 0.0).is_empty());
    for (n, direction) in [-Vector3::z(), Vector3::x(), Vector3::y(), -Vector3::y()]
        .into_iter()
        .enumerate()
    {
        let wall = if direction.y == 0.0 { 2.0 } else { 1.5 };
        let place = direction * (wall - ball.support(&direction) + 0.01);
        let found = at(place.x, place.y, place.z, 10.0 * (n + 1) as f64);
        assert_eq!(found.len(), 1, "{direction:?}");
        assert!(found[0].normal.dot(&direction) < -0.99, "{:?}", found[0]);
    }
    assert!(at(0.0, 0.0, -3.1, 100.0).is_empty());
}
