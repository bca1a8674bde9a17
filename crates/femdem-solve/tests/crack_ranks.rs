//! Worlds with bodies that break shared out over ranks: the same bits as one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::ranks::Threads;
use crate::fracture::{model, rock, shaken};
use crate::ranks::parts_for;
use femdem_contact::{BodyId, Wall};
use femdem_fem::element::Element;
use femdem_fem::fracture::{Strength, Weibull};
use femdem_fem::material::{AnyMaterial, Deformation, Material, NeoHookean, Response, Tangent};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{
    Alone, BodySpec, ContactStiffness, DeformableSpec, Drive, Fracture, Fragments, Halo,
    SleepParameters, TimeStepParameters, World, WorldParameters,
};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Edge of a cube, m.
const EDGE: f64 = 0.02;

/// Steps in all, and before a checkpoint.
const LAST: u32 = 630;
const STOP: u32 = 583;

/// Cubes beside each other are thrown on a floor, with balls behind them, past one that is held at a side. The pieces of one of them
/// stay one body. All fall at once, so that
/// several crack in the same step. Two numbers are free.
fn thrown() -> World {
    let mut world = World::new(WorldParameters {
        gravity: Vector3::zeros(),
        sleeping: SleepParameters {
            deformables: true,
            window: 20,
            ..SleepParameters::default()
        },
        time_step: TimeStepParameters {
            safety: 0.5,
            ..TimeStepParameters::default()
        },
        ..WorldParameters::default()
    })
    .unwrap();
    let (low, high) = (Vector3::zeros(), Vector3::new(7.0, 3.0, 40.0) * EDGE);
    for wall in Wall::closed_box(low, high).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let mesh = model(&shaken([2; 3], &Vector3::repeat(EDGE)));
    let side = Selection::Plane {
        normal: Vector3::x(),
        offset: EDGE,
        tolerance: 1e-9,
    };
    let mut boundary = Boundary::default();
    boundary.fix(&mesh, &side, [true; 3]).unwrap();
    let cube = world
        .add_model("cube", mesh, ContactStiffness::default())
        .unwrap();
    let ball = world.add_sphere("ball", 0.3 * EDGE).unwrap();
    let fracture = Fracture {
        coarse: true,
        scatter: Some(Weibull::new(20.0, 1e-9, 7).unwrap()),
        strength: Strength::new(4e6, 16e6, 0.8_f64.atan()).unwrap(),
        ..rock([5.0, 25.0])
    };
    let fall = Vector3::new(3.0, 0.0, -40.0);
    let mut gone = Vec::new();
    for k in 0..5_u32 {
        let x = 1.15 * f64::from((3 * k) % 5) + 0.6;
        let place = Pose::new(
            Vector3::new(x, 1.0, 0.6) * EDGE,
            Vector3::new(0.6, 0.2, 0.0),
        );
        let held = k == 3;
        let spec = DeformableSpec {
            velocity: if held { Vector3::zeros() } else { fall },
            boundary: if held {
                boundary.clone()
            } else {
                Boundary::default()
            },
            fracture: Some(Fracture {
                fragments: if k == 1 {
                    Fragments::Pieces
                } else {
                    Fragments::Bodies
                },
                ..fracture
            }),
            ..DeformableSpec::at_rest(cube, place)
        };
        world.add_deformable(spec).unwrap();
        let at = Vector3::new(x + 0.4, 1.5, 2.2) * EDGE;
        let spec = BodySpec::at_rest(ball, 2500.0, Pose::translation(at.x, at.y, at.z));
        let velocity = fall;
        let spec = BodySpec { velocity, ..spec };
        gone.push(world.add_body(spec).unwrap());
    }
    for id in [gone[1], gone[3]] {
        world.remove_body(id).unwrap();
    }
    world
}

fn steps(world: &mut World, halo: &mut dyn Halo, count: u32) -> Vec<(u64, BodyId, Vec<BodyId>)> {
    let mut all = Vec::new();
    for _ in 0..count {
        world.step_on(halo).unwrap();
        for parts in world.fragment_bodies_on(halo).unwrap() {
            all.push((world.steps(), parts.body, parts.fragments));
        }
    }
    all
}

/// A piece and a body that has lost pieces leave, and balls come under their numbers.
fn change(world: &mut World, halo: &mut dyn Halo) {
    world.remove_bodies_on(&[13, 8], halo).unwrap();
    for (k, number) in [8, 13].into_iter().enumerate() {
        let at = Vector3::new(2.0 + 3.0 * k as f64, 1.5, 6.0) * EDGE;
        let spec = BodySpec::at_rest(0, 2500.0, Pose::translation(at.x, at.y, at.z));
        let velocity = Vector3::new(0.0, 0.0, -40.0);
        let added = world.add_body(BodySpec { velocity, ..spec }).unwrap();
        assert_eq!(added, number);
    }
}

#[test]
fn broken_bodies_have_the_same_bits_on_any_ranks() {
    let world = thrown();
    let mut alone = world.clone();
    let mut parted = steps(&mut alone, &mut Alone, STOP);
    change(&mut alone, &mut Alone);
    parted.extend(steps(&mut alone, &mut Alone, LAST - STOP));
    let at: BTreeSet<u64> = parted.iter().map(|parts| parts.0).collect();
    let pieces = alone.deformable(2).unwrap().cracks().unwrap().fragments();
    assert!(pieces.iter().max() > Some(&2), "{pieces:?}");
    let several = |step: &&u64| parted.iter().filter(|parts| parts.0 == **step).count() > 2;
    assert!(
        at.len() > 2 && at.iter().filter(several).count() > 1,
        "{parted:?}"
    );
    let expected = alone.checksum_of_motion().unwrap();
    for size in [1, 2, 3, 4] {
        let run = |world: &mut World, halo: &mut dyn Halo, count: u32| {
            let first = world.steps();
            let found = steps(world, halo, count);
            let then = first + 1..=first + u64::from(count);
            let expected = parted.iter().filter(|parts| then.contains(&parts.0));
            assert!(found.iter().eq(expected), "{size} ranks: {found:?}");
        };
        let stopped = Threads::each(size, |halo| {
            let mut world = world.clone();
            world.share_out(halo).unwrap();
            run(&mut world, halo, STOP);
            world.to_bytes().unwrap()
        });
        // Checkpoints of their shares amid the cracks, from which others go on, which each have one on the way.
        let parts = Threads::each(1 + size % 4, |halo| {
            let mut world = World::share_parts(parts_for(&stopped, halo), halo).unwrap();
            change(&mut world, halo);
            run(&mut world, halo, 1);
            world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
            run(&mut world, halo, LAST - STOP - 1);
            let own = world.own_bodies(0);
            let own: Vec<_> = own.map(|id| world.number_in_whole(id)).collect();
            (own, world.gather(halo).unwrap())
        });
        // Pieces of a body are on different ranks.
        let rank = |id: &BodyId| parts.iter().position(|part| part.0.contains(&Some(*id)));
        let mut apart = parted
            .iter()
            .map(|(_, body, pieces)| pieces.iter().any(|piece| rank(piece) != rank(body)));
        assert_eq!(apart.any(|apart| apart), parts.len() > 1, "{size} ranks");
        let whole = parts.into_iter().next().unwrap().1.unwrap();
        let found = whole.checksum_of_motion().unwrap();
        assert_eq!(found, expected, "{size} ranks");
        let books = [&alone, &whole].map(World::ledger);
        let scale = books[0].exchanged;
        for (a, b) in [
            (books[0].error(), books[1].error()),
            (books[0].cracks, books[1].cracks),
            (books[0].lent, books[1].lent),
            (books[0].dissipated_fracture, books[1].dissipated_fracture),
            (books[0].dissipated_release, books[1].dissipated_release),
        ] {
            assert!((a - b).abs() < 1e-9 * scale, "{a:e} {b:e}");
        }
    }
}

/// A law of a host.
#[derive(Debug)]
struct Glass(NeoHookean);

impl Material for Glass {
    fn name(&self) -> &'static str {
        "glass of a host"
    }

    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        self.0.respond(d, old, new)
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        self.0.tangent(d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.0.wave_modulus()
    }

    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        self.0.stiffness_bound(d, old)
    }
}

/// Models of bodies that have cracked travel, and laws of a host do not.
#[test]
fn bodies_that_break_under_laws_of_a_host_are_not_shared() {
    let law = Arc::new(Glass(NeoHookean::new(20e9, 0.2).unwrap()));
    let material = AnyMaterial::custom(law);
    let density = 2500.0;
    let mesh = shaken([2; 3], &Vector3::repeat(EDGE));
    let region = MaterialRegion { material, density };
    let glass = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    for breaks in [false, true] {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let model = world.add_model("glass", glass.clone(), ContactStiffness::default());
        let spec = DeformableSpec::at_rest(model.unwrap(), Pose::identity());
        let fracture = breaks.then(|| Fracture {
            coarse: true,
            ..rock([5.0, 25.0])
        });
        world
            .add_deformable(DeformableSpec { fracture, ..spec })
            .unwrap();
        let before = world.state_hash().unwrap();
        let shared = world.share_out(&mut Alone);
        assert_eq!(shared.is_err(), breaks);
        if let Err(refused) = shared {
            let refused = refused.to_string();
            assert!(refused.contains("\"glass of a host\""), "{refused}");
            assert_eq!(world.state_hash().unwrap(), before);
        }
    }
}

#[test]
fn one_rank_cannot_make_bodies_of_fragments() {
    let mut world = thrown();
    world.share_out(&mut Alone).unwrap();
    let refused = world.fragment_bodies().unwrap_err().to_string();
    assert!(refused.contains("gather it first"), "{refused}");
}
