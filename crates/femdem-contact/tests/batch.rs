//! The batch finds the same contacts as the kernels called on every pair, sums them to the loads, keeps the
//! contacts of sleeping pairs, and gives the same bits for any number of threads.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::pack::{advance, placed, shape, stir};
use femdem_contact::kernel::{CavityKernel, Scratch};
use femdem_contact::{
    ContactBatch, ContactLaw, ContactParameters, ConvexShape, Frame, Motion, Overlap, PairKernel,
    Partner, RigidContact, Wall, WallShape,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

const PENALTY: f64 = 1e3;

/// Bodies of five shapes and sizes 1 to 3 that drift about between moving walls.
struct Pack {
    batch: ContactBatch,
    shapes: Vec<Arc<ConvexShape>>,
    bodies: Vec<Motion>,
    wall_motions: Vec<Motion>,
    stream: Stream,
    step: u32,
}

impl Pack {
    fn new(count: usize, seed: u64) -> Self {
        // The largest come late, so that the grid has to grow.
        Self::sized(count, seed, |part| 1.0 + 2.0 * part)
    }

    /// Bodies whose diameters are a function of their relative position in the order, 0 to 1.
    fn sized(count: usize, seed: u64, diameter: impl Fn(f64) -> f64) -> Self {
        let law = ContactLaw::new(ContactParameters {
            penalty: PENALTY,
            ..ContactParameters::default()
        });
        let mut batch = ContactBatch::new(law.unwrap());
        let mut stream = Stream(seed);
        let side = 1.35 * (count as f64).cbrt();
        let mut walls = Wall::closed_box(Vector3::zeros(), Vector3::repeat(side)).unwrap();
        walls.push(Wall::cylinder("mantle", 0.8 * side, 24).unwrap());
        let mut wall_motions = vec![Motion::fixed(Frame::identity()); walls.len()];
        wall_motions[6].frame.position = Vector3::new(0.5 * side, 0.5 * side, 0.0);
        for wall in &walls {
            batch.add_wall(wall.clone());
        }
        let ids = ["P1", "A10", "P5", "A1", "P3"];
        let (mut shapes, mut bodies) = (Vec::new(), Vec::new());
        for i in 0..count {
            let d = diameter(i as f64 / count as f64);
            shapes.push(shape(ids[i % ids.len()], d));
            let id = batch.add_shape(shapes[i].clone());
            batch.add_body(id).unwrap();
            let position = (stream.vector() + Vector3::repeat(0.5)) * side;
            let mut motion = placed(&shapes[i], position, stream.rotation());
            stir(&mut motion, &shapes[i], &mut stream);
            bodies.push(motion);
        }
        Self {
            batch,
            shapes,
            bodies,
            wall_motions,
            stream,
            step: 0,
        }
    }

    /// Moves everything that is awake and updates the batch.
    fn advance(&mut self) {
        for (i, (motion, shape)) in self.bodies.iter_mut().zip(&self.shapes).enumerate() {
            if self.step % 40 == 39 {
                stir(motion, shape, &mut self.stream);
            }
            if self.batch.is_awake(i as u32) {
                advance(motion, shape, 1.0);
            }
        }
        for (w, motion) in self.wall_motions.iter_mut().enumerate() {
            let phase = f64::from(self.step) * 0.05 + w as f64;
            motion.velocity = Vector3::new(phase.sin(), phase.cos(), 0.5) * 0.01;
            motion.frame.position += motion.velocity;
            motion.travelled += motion.velocity.norm();
        }
        self.step += 1;
        self.batch
            .update(&self.bodies, &self.wall_motions, 1.0)
            .unwrap();
    }

    /// All overlaps with at least one awake body, from the kernels without caches.
    fn brute_force(&self) -> Vec<(Partner, u32, Overlap)> {
        let pair = PairKernel::new(PENALTY).unwrap();
        let cavity = CavityKernel::new(PENALTY).unwrap();
        let mut scratch = Scratch::default();
        let mut found = Vec::new();
        let frame = |i: usize| &self.bodies[i].frame;
        let awake = |i: usize| self.batch.is_awake(i as u32);
        let there: Vec<usize> = self.batch.body_ids().map(|i| i as usize).collect();
        for (rank, &i) in there.iter().enumerate() {
            for &j in &there[rank + 1..] {
                if (awake(i) || awake(j))
                    && let Some(x) = pair.evaluate(
                        &self.shapes[i],
                        frame(i),
                        &self.shapes[j],
                        frame(j),
                        &mut scratch,
                    )
                {
                    found.push((Partner::Body(i as u32), j as u32, x));
                }
            }
            for (w, wall) in self.batch.walls() {
                let (w, wall) = (w as usize, wall.planes().unwrap());
                let at = &self.wall_motions[w].frame;
                if awake(i)
                    && let Some(x) =
                        cavity.evaluate(wall, at, &self.shapes[i], frame(i), &mut scratch)
                {
                    found.push((Partner::Wall(w as u32), i as u32, x));
                }
            }
        }
        found.sort_by_key(|x| (x.0, x.1));
        found
    }

    /// Contacts on record with at least one awake body, sorted like `brute_force`.
    fn evaluated(&self) -> Vec<RigidContact> {
        let mut list: Vec<RigidContact> = self
            .batch
            .rigid_contacts()
            .into_iter()
            .copied()
            .filter(|c| {
                self.batch.is_awake(c.b)
                    || matches!(c.a, Partner::Body(a) if self.batch.is_awake(a))
            })
            .collect();
        list.sort_by_key(|c| (c.a, c.b));
        list
    }

    /// Compares contacts with brute force; returns how many there were. An overlap so slight that its force
    /// is lost in rounding may be found by only one of the two.
    fn check_contacts(&self) -> usize {
        let slight = 1e-12 * PENALTY;
        let mut want = self.brute_force();
        let mut got = self.evaluated();
        let known: Vec<_> = want.iter().map(|w| (w.0, w.1)).collect();
        let seen: Vec<_> = got.iter().map(|c| (c.a, c.b)).collect();
        got.retain(|c| c.elastic_force > slight || known.contains(&(c.a, c.b)));
        want.retain(|w| w.2.force.norm() > slight || seen.contains(&(w.0, w.1)));
        let pairs = |x: &[RigidContact]| x.iter().map(|c| (c.a, c.b)).collect::<Vec<_>>();
        let wanted: Vec<_> = want.iter().map(|w| (w.0, w.1)).collect();
        assert_eq!(pairs(&got), wanted, "pairs at step {}", self.step);
        for (c, (a, b, x)) in got.iter().zip(&want) {
            let force = x.force.norm();
            let off = (c.normal * c.elastic_force - x.force).norm();
            let least = 1e-9 * force + slight;
            assert!(off <= least, "{a:?}-{b}: force off by {off:e} of {force:e}");
            let off =
                (c.arm_b.cross(&(c.normal * c.elastic_force)) + c.moment - x.torque_b()).norm();
            assert!(off <= 3.0 * least, "{a:?}-{b}: torque off by {off:e}");
        }
        got.len()
    }

    /// Sums the contacts to loads about each body's origin, from the fields of each contact.
    fn check_loads(&self) {
        let mut sums = vec![[Vector3::zeros(); 2]; self.bodies.len()];
        let mut on_walls = vec![[Vector3::zeros(); 2]; self.wall_motions.len()];
        let mut size = 0.0_f64;
        for c in self.evaluated() {
            let force = c.force_on_b();
            let couple =
                c.moment * (c.normal_force / c.elastic_force) + c.rocking + c.normal * c.torsion;
            size = size.max(force.norm()).max(couple.norm());
            let at = |position: &Vector3<f64>| couple + (c.point - position).cross(&force);
            let b = c.b as usize;
            sums[b][0] += force;
            sums[b][1] += at(&self.bodies[b].frame.position);
            let (sum, origin) = match c.a {
                Partner::Body(a) => (&mut sums[a as usize], &self.bodies[a as usize]),
                Partner::Wall(w) => (&mut on_walls[w as usize], &self.wall_motions[w as usize]),
            };
            sum[0] -= force;
            sum[1] -= at(&origin.frame.position);
        }
        let close = |got: &Vector3<f64>, want: &Vector3<f64>, what: &str| {
            let off = (got - want).norm();
            assert!(off <= 1e-10 * size, "{what}: off by {off:e} of {size:e}");
        };
        for (w, (load, sum)) in self.batch.wall_loads().iter().zip(&on_walls).enumerate() {
            close(&load.total.force, &sum[0], &format!("force on wall {w}"));
            close(&load.total.torque, &sum[1], &format!("torque on wall {w}"));
        }
        for (i, (load, sum)) in self.batch.loads().iter().zip(&sums).enumerate() {
            if self.batch.is_awake(i as u32) {
                close(&load.total.force, &sum[0], &format!("force on {i}"));
                close(&load.total.torque, &sum[1], &format!("torque on {i}"));
                let count = self.batch.rigid_contacts_of(i as u32).count();
                assert_eq!(load.contacts as usize, count);
            }
        }
    }

    /// A step that the batch allows is allowed by the springs and dashpots of all contacts, to the last bit
    /// and for any limit.
    fn check_steps(&self) {
        for (body, motion) in (0..).zip(&self.bodies) {
            let resistance = self.batch.resistance_of(body);
            let own = resistance.largest_step(motion, f64::INFINITY);
            for most in [0.1 * own, 0.6 * own, 0.99 * own, 2.0 * own, f64::INFINITY] {
                let step = self.batch.largest_step(body, motion, most);
                let wanted = resistance.largest_step(motion, most);
                assert_eq!(step, wanted, "{body} with at most {most:e} of {own:e}");
            }
        }
        // Every body that is awake allows the stable step of all, and one of them not twice that.
        let stable = self.batch.stable_step(&self.bodies);
        let allow = |step: f64| {
            let mut bodies = (0..).zip(&self.bodies);
            bodies.all(|(body, motion)| {
                let resistance = self.batch.resistance_of(body);
                !self.batch.is_awake(body) || resistance.largest_step(motion, step) >= step
            })
        };
        assert!(allow(stable), "{stable}");
        assert!(stable == f64::INFINITY || !allow(2.0 * stable), "{stable}");
    }
}

#[test]
fn the_same_contacts_as_brute_force() {
    for seed in [1, 2] {
        let mut pack = Pack::new(40, seed);
        let mut seen = 0;
        for step in 0..300 {
            pack.advance();
            if step % 7 == 0 {
                seen += pack.check_contacts();
                pack.check_loads();
                pack.check_steps();
            }
        }
        assert!(seen > 2000, "only {seen} contacts were compared");
    }
}

/// Between the steps bodies and walls are removed and others added, reshaped and put elsewhere, some of them asleep. What
/// is left of removed ones is not read: it is not a number.
#[test]
fn bodies_and_walls_come_and_go() {
    let mut pack = Pack::new(40, 11);
    let boxed = pack.batch.walls().map(|(_, wall)| wall.clone());
    let boxed: Vec<WallShape> = boxed.collect();
    let side = 1.35 * 40_f64.cbrt();
    let (mut seen, mut changes) = (0, [0; 4]);
    for step in 0..400 {
        let pick = (pack.stream.unit() * 40.0) as usize;
        let body = pick as u32;
        let kind = (pack.stream.unit() * 4.0) as usize;
        let position = (pack.stream.vector() + Vector3::repeat(0.5)) * side;
        let touched: Vec<u32> = pack
            .batch
            .rigid_contacts_of(body)
            .filter_map(|c| match c.a {
                Partner::Body(a) => Some(if a == body { c.b } else { a }),
                Partner::Wall(_) => None,
            })
            .collect();
        let there = pack.batch.contains(body);
        let found = match kind {
            0 => pack.batch.remove_body(body),
            1 => pack.batch.moved_by_hand(body),
            2 => pack.batch.reshape(body, ((pick + step) % 40) as u32),
            _ if pack.batch.len() < 40 => {
                let free = (0..40).find(|i| !pack.batch.contains(*i)).unwrap();
                let id = (pick + step) % 40;
                assert_eq!(pack.batch.add_body(id as u32).unwrap(), free);
                let free = free as usize;
                pack.shapes[free] = pack.batch.shapes()[id].convex().unwrap().clone().into();
                let turn = pack.stream.rotation();
                pack.bodies[free] = placed(&pack.shapes[free], position, turn);
                changes[3] += 1;
                Ok(Vec::new())
            }
            _ => Ok(Vec::new()),
        };
        if kind < 3 {
            assert_eq!(found.is_ok(), there);
            if let Ok(found) = found {
                assert_eq!(found, touched);
                assert_eq!(pack.batch.rigid_contacts_of(body).count(), 0);
                changes[kind] += 1;
                match kind {
                    0 => pack.bodies[pick].frame.position.x = f64::NAN,
                    1 => pack.bodies[pick].frame.position = position,
                    _ => {
                        let shape = pack.batch.shapes()[(pick + step) % 40].convex();
                        pack.shapes[pick] = shape.unwrap().clone().into();
                    }
                }
            }
        }
        let wall = step as u32 / 50 % 7;
        if step % 50 == 10 {
            pack.batch.remove_wall(wall).unwrap();
            assert!(pack.batch.remove_wall(wall).is_err());
            pack.wall_motions[wall as usize].frame.position.x = f64::NAN;
        } else if step % 50 == 40 {
            assert_eq!(pack.batch.add_wall(boxed[wall as usize].clone()), wall);
            pack.wall_motions[wall as usize].frame.position = Vector3::zeros();
        }
        let sleeper = (7 * step as u32) % 40;
        pack.batch.set_awake(sleeper, step % 3 == 0);
        pack.advance();
        if step % 3 == 0 {
            seen += pack.check_contacts();
            pack.check_loads();
        }
    }
    assert!(seen > 2000, "only {seen} contacts were compared");
    assert!(changes.iter().all(|n| *n > 30), "{changes:?}");
}

/// Sizes of one to a hundred and fifty, growing or shrinking in the order of the bodies.
#[test]
fn sizes_that_differ_much() {
    for (seed, low, high) in [(3, 0.05_f64, 7.5_f64), (4, 7.5, 0.05)] {
        let mut pack = Pack::sized(60, seed, |part| low * (high / low).powf(part));
        let mut seen = 0;
        for step in 0..120 {
            pack.advance();
            if step % 7 == 0 {
                seen += pack.check_contacts();
            }
        }
        assert!(seen > 2000, "only {seen} contacts were compared");
    }
}

#[test]
fn sleeping_pairs_stay_on_record() {
    let mut pack = Pack::new(40, 5);
    let mut kept = 0;
    for round in 0..12 {
        for _ in 0..10 {
            pack.advance();
        }
        for i in 0..40_u32 {
            pack.batch.set_awake(i, true);
        }
        pack.advance();
        let both = |c: &RigidContact, set: &[u32]| match c.a {
            Partner::Body(a) => set.contains(&a) && set.contains(&c.b),
            Partner::Wall(_) => set.contains(&c.b),
        };
        let sleepers: Vec<u32> = (0..40).filter(|_| pack.stream.unit() < 0.6).collect();
        let on_record = |pack: &Pack| -> Vec<RigidContact> {
            let all = pack.batch.rigid_contacts();
            all.into_iter()
                .copied()
                .filter(|c| both(c, &sleepers))
                .collect()
        };
        let before = on_record(&pack);
        for &i in &sleepers {
            pack.batch.set_awake(i, false);
        }
        for _ in 0..10 {
            pack.advance();
            pack.check_contacts();
            pack.check_loads();
            assert_eq!(on_record(&pack), before, "round {round}");
        }
        for &i in &sleepers {
            let load = pack.batch.load_of(i);
            assert_eq!(
                load.contacts as usize,
                pack.batch.rigid_contacts_of(i).count()
            );
        }
        let neighbours = pack.batch.sleeping_neighbours();
        assert!(neighbours.iter().all(|i| sleepers.contains(i)));
        kept += before.len();
    }
    assert!(kept > 100, "only {kept} sleeping contacts");
}

/// Two equal bodies that oscillate against each other have sqrt(2) times the frequency of one that oscillates
/// against the other asleep, which does not move.
#[test]
fn a_sleeping_partner_allows_a_larger_step() {
    let law = ContactLaw::new(ContactParameters {
        penalty: PENALTY,
        damping_ratio: 0.0,
        tangential_damping: 0.0,
        ..ContactParameters::default()
    });
    let mut batch = ContactBatch::new(law.unwrap());
    let cube = shape("P5", 1.0);
    let id = batch.add_shape(cube.clone());
    let edge = 1.0 / 3.0_f64.sqrt();
    let bodies = [0.0, 0.99 * edge].map(|x| {
        batch.add_body(id).unwrap();
        placed(&cube, Vector3::new(x, 0.0, 0.0), Matrix3::identity())
    });
    let step_of = |batch: &mut ContactBatch| {
        batch.update(&bodies, &[], 0.0).unwrap();
        assert_eq!(batch.rigid_contacts().len(), 1);
        batch.largest_step(0, &bodies[0], f64::INFINITY)
    };
    let both = step_of(&mut batch);
    batch.set_awake(1, false);
    let alone = step_of(&mut batch);
    assert!(
        (alone / both / 2.0_f64.sqrt() - 1.0).abs() < 1e-9,
        "{both} {alone}"
    );
    batch.set_awake(1, true);
    assert_eq!(step_of(&mut batch), both);
}

/// Contacts and loads as bits.
#[cfg(feature = "parallel")]
fn fingerprint(batch: &ContactBatch) -> Vec<u64> {
    let bits = |v: &Vector3<f64>| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let mut all: Vec<u64> = Vec::new();
    for c in batch.rigid_contacts() {
        all.push(u64::from(c.b));
        for v in [&c.point, &c.normal, &c.friction, &c.moment, &c.rocking] {
            all.extend(bits(v));
        }
        for x in [
            c.normal_force,
            c.energy,
            c.spring_energy,
            c.torsion,
            c.foundation.stiffness,
        ] {
            all.push(x.to_bits());
        }
    }
    for load in batch.loads().iter().chain(batch.wall_loads()) {
        all.extend(bits(&load.total.force));
        all.extend(bits(&load.total.torque));
        all.push(load.normal_sum.to_bits());
    }
    for body in 0..batch.len() as u32 {
        let resistance = batch.resistance_of(body);
        for m in [&resistance.stiffness, &resistance.viscosity] {
            let blocks = [m.translation, m.coupling, m.turning];
            all.extend(blocks.iter().flatten().map(|x| x.to_bits()));
        }
    }
    all
}

#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut pack = Pack::new(150, 9);
            let mut all = Vec::new();
            let mut most = 0;
            for _ in 0..60 {
                pack.advance();
                most = most.max(pack.batch.candidate_count());
                all.extend(fingerprint(&pack.batch));
            }
            assert!(most > 512, "{most} pairs are too few to be handed out");
            all
        })
    };
    let one = run(1);
    assert!(one.len() > 10_000);
    assert!(one == run(2), "two threads change the bits");
    assert!(one == run(3), "three threads change the bits");
}
