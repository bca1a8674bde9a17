//! Whole packing jobs of a few bodies.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::{Contact, MaterialId, Partner};
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::MeshOptions;
use femdem_mesh::{Polyhedron, Vector3};
use femdem_pack::{
    Container, PackError, PackReport, PackShape, PackSpec, Packing, PairLaw, Penalty, Pour,
    Protocol, Release, Sequential, Stage,
};
use femdem_solve::{ImplicitStep, Medium, checkpoint};

const D: f64 = 0.02;

fn solid(solid: Solid) -> Polyhedron {
    CatalogueShape::from(solid).polyhedron(D).unwrap()
}

/// A few cubes in a narrow box.
fn cubes(count: u32) -> PackSpec {
    PackSpec {
        shapes: vec![PackShape::new("cube", solid(Solid::P5))],
        count,
        container: Container::Box {
            width: 2.5 * D,
            depth: 2.5 * D,
        },
        penalty: Penalty::Given { pressure: 1e6 },
        ..PackSpec::default()
    }
}

/// Every vertex of every body is inside the walls and above the floor, to within a slack.
fn assert_inside(packing: &Packing, slack: f64) {
    let world = packing.world();
    for body in world.body_ids() {
        let pose = world.pose(body).unwrap();
        let shape = world.shape(world.shape_of(body).unwrap()).unwrap();
        for vertex in shape.polyhedron.vertices() {
            let p = pose * vertex;
            assert!(p.z > -slack, "body {body} at {p}");
            let inside = packing.spec().container.contains(p.x, p.y, -slack);
            assert!(inside, "body {body} at {p}");
        }
    }
}

/// A settled pack satisfies the limits of the rule; floor and walls carry its weight.
fn assert_settled(packing: &Packing, report: &PackReport) {
    assert!(report.settled, "{report:?}");
    assert_eq!(report.bodies, packing.spec().count);
    assert!(report.residual_max_over_load <= 0.02, "{report:?}");
    assert!(report.kinetic_energy_over_mgd <= 1e-6, "{report:?}");
    assert_eq!(report.relaxation.unwrap().bodies, report.bodies);
    let verification = report.verification.unwrap();
    assert!(verification.max_displacement_over_d <= 1e-3, "{report:?}");
    // A vertex under a few weights sinks in by (F d/(16 p))^(1/3), here about 0.025 d.
    assert_inside(packing, 0.04 * D);
    assert_walls_carry_the_weight(packing);
}

/// In equilibrium the forces of the walls on the bodies sum to the weight of the bodies.
fn assert_walls_carry_the_weight(packing: &Packing) {
    let world = packing.world();
    let masses = world.body_ids().map(|b| world.mass(b).unwrap());
    let weight = masses.sum::<f64>() * packing.spec().gravity;
    let walls = |c: &femdem_contact::Contact| matches!(c.a, femdem_contact::Partner::Wall(_));
    let forces = world.contacts().into_iter().filter(walls);
    let sum: Vector3 = forces.map(|c| c.force_on_b()).sum();
    let error = (sum - Vector3::z() * weight).norm() / weight;
    assert!(error < 0.01, "the walls carry {sum} of {weight} N");
}

/// What implicit steps do not have is stepped explicitly throughout: rolling friction and attraction, of all or of a pair of
/// materials.
#[test]
fn packs_that_implicit_steps_refuse_settle_explicitly() {
    let stone = MaterialId(1);
    let mut of_stone = cubes(9);
    of_stone.shapes[0].material = stone;
    for spec in [
        PackSpec {
            rolling_friction: 0.1,
            ..cubes(9)
        },
        PackSpec {
            materials: vec!["stone".to_owned()],
            pairs: vec![PairLaw {
                materials: [stone; 2],
                cohesion: Some(300.0),
                ..PairLaw::default()
            }],
            ..of_stone
        },
    ] {
        let attracts = !spec.pairs.is_empty();
        let mut packing = Packing::new(spec).unwrap();
        let report = packing.run().unwrap();
        assert_settled(&packing, &report);
        let contacts = packing.world().contacts();
        let is_wall = |c: &&Contact| matches!(c.a, Partner::Wall(_));
        let (with_walls, others): (Vec<&Contact>, Vec<&Contact>) =
            contacts.iter().partition(is_wall);
        assert!(with_walls.iter().all(|c| c.adhesion.energy == 0.0));
        assert!(!others.is_empty());
        assert!(others.iter().all(|c| (c.adhesion.energy < 0.0) == attracts));
    }
}

/// Bodies that attract each other rest about as deep as the job asks for: the chosen penalty foresees it. A pair with a penalty of
/// its own asks for none.
#[test]
fn the_chosen_penalty_foresees_attraction() {
    let penetration = 0.0035;
    let sticky = |count: u32, shape: PackShape, cohesion: f64, adhesion_energy: f64| PackSpec {
        shapes: vec![shape],
        cohesion,
        adhesion_energy,
        penalty: Penalty::Automatic { penetration },
        ..cubes(count)
    };
    let ball = || PackShape::ball("ball", D).unwrap();
    let cube = || PackShape::new("cube", solid(Solid::P5));
    for spec in [
        sticky(12, ball(), 3e5, 0.0),
        sticky(12, ball(), 0.0, 50.0),
        sticky(6, cube(), 3e5, 0.0),
    ] {
        let plain = PackSpec {
            cohesion: 0.0,
            adhesion_energy: 0.0,
            ..spec.clone()
        };
        assert!(spec.resolved_penalty().unwrap() > 5.0 * plain.resolved_penalty().unwrap());
        let mut packing = Packing::new(spec).unwrap();
        let report = packing.run().unwrap();
        let over = report.penetration_mean_over_d / penetration;
        assert!((0.4..1.3).contains(&over), "{over}: {report:?}");
    }
    let [ice, wood] = [1, 2].map(MaterialId);
    let mut of_pairs = sticky(12, ball(), 0.0, 0.0);
    let plain = of_pairs.resolved_penalty().unwrap();
    of_pairs.shapes[0].material = ice;
    of_pairs.materials = ["ice", "wood"].map(str::to_owned).to_vec();
    let law = PairLaw {
        materials: [ice, ice],
        cohesion: Some(3e5),
        ..PairLaw::default()
    };
    let penalty = |law: PairLaw| {
        let pairs = vec![law];
        let spec = PackSpec {
            pairs,
            ..of_pairs.clone()
        };
        spec.resolved_penalty().unwrap()
    };
    assert!(penalty(law) > 5.0 * plain);
    let own = Some(1e8);
    assert_eq!(
        penalty(PairLaw {
            penalty: own,
            ..law
        }),
        plain
    );
    let strangers = PairLaw {
        materials: [wood, ice],
        ..law
    };
    assert_eq!(penalty(strangers), plain);
}

#[test]
fn cubes_deposited_in_sequence_settle() {
    let mut packing = Packing::new(cubes(8)).unwrap();
    let report = packing.run().unwrap();
    assert_settled(&packing, &report);
    // A box 2.5 d wide takes one body at a time.
    assert_eq!(report.batches, 8);
    let sequence: Vec<_> = (0..9).map(|b| packing.sequence(b)).collect();
    let expected: Vec<_> = (0..8).map(Some).chain([None]).collect();
    assert_eq!(sequence, expected);
    assert!(report.top > 0.5 * D && report.top < 8.0 * D);
    assert!(report.mean_top <= report.top);
}

#[test]
fn stages_follow_one_another_and_bodies_arrive_in_batches() {
    let mut spec = cubes(5);
    spec.container = Container::Box {
        width: 6.0 * D,
        depth: 6.0 * D,
    };
    spec.protocol = Protocol::Sequential(Sequential {
        batch: Some(2),
        ..Sequential::default()
    });
    let mut packing = Packing::new(spec).unwrap();
    let mut last = packing.progress();
    assert_eq!(
        (last.stage, last.placed, last.batches),
        (Stage::Depositing, 2, 1)
    );
    while !packing.is_done() {
        let now = packing.advance(100).unwrap();
        assert!(now.stage >= last.stage && now.placed >= last.placed);
        assert!(now.steps - last.steps <= 100);
        last = now;
    }
    assert_eq!((last.placed, last.batches), (5, 3));
    let sequence: Vec<_> = (0..5).filter_map(|b| packing.sequence(b)).collect();
    assert_eq!(sequence, [0, 0, 1, 1, 2]);
    assert_eq!(packing.advance(100).unwrap().steps, last.steps);
}

#[test]
fn mixtures_settle_in_a_cylinder() {
    let mut spec = cubes(10);
    spec.shapes
        .push(PackShape::new("octahedron", solid(Solid::P4)));
    spec.container = Container::Cylinder { diameter: 3.0 * D };
    let mut packing = Packing::new(spec).unwrap();
    let report = packing.run().unwrap();
    assert_settled(&packing, &report);
    let shapes = (0..10).map(|b| packing.world().shape_of(b).unwrap());
    assert_ne!(shapes.sum::<u32>() % 10, 0, "one of the shapes is missing");
}

/// Bodies that are not convex: rings on each other settle, and the walls carry them.
#[test]
fn rings_settle() {
    let ring: Shape = "hollow_cylinder:sides=8,aspect=0.5".parse().unwrap();
    let ring = ring.polyhedron(0.8 * D).unwrap();
    let options = MeshOptions::default();
    let (shape, report) = PackShape::of_surface("ring", ring, &options).unwrap();
    assert!(report.unwrap().tets > 10);
    let without_mesh = PackShape {
        mesh: None,
        ..shape.clone()
    };
    let spec = PackSpec {
        shapes: vec![shape],
        penalty: Penalty::Automatic { penetration: 0.005 },
        ..cubes(4)
    };
    let mut packing = Packing::new(spec.clone()).unwrap();
    let report = packing.run().unwrap();
    assert!(report.settled, "{report:?}");
    assert!(report.penetration_mean_over_d < 0.01, "{report:?}");
    assert_walls_carry_the_weight(&packing);
    let refused = Packing::new(PackSpec {
        shapes: vec![without_mesh],
        ..spec
    });
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("ring is not convex")
    );
}

/// Exact balls among cubes, which weigh what they are.
#[test]
fn balls_settle() {
    let mut spec = cubes(10);
    spec.shapes.push(PackShape::ball("ball", D).unwrap());
    let of_ball = spec.shapes[1].volume();
    assert!((of_ball / (std::f64::consts::FRAC_PI_6 * D.powi(3)) - 1.0).abs() < 1e-12);
    let mut packing = Packing::new(spec).unwrap();
    let report = packing.run().unwrap();
    assert_settled(&packing, &report);
    assert_walls_carry_the_weight(&packing);
    let world = packing.world();
    let ball = (0..10).find(|&b| world.shape_of(b) == Some(1)).unwrap();
    let mass = packing.spec().density * of_ball;
    assert!((world.mass(ball).unwrap() / mass - 1.0).abs() < 1e-12);
}

#[test]
fn all_protocols_end_settled() {
    let pour = Protocol::Pour(Pour {
        rate: 100.0,
        layer: Some(2),
        ..Pour::default()
    });
    let release = Protocol::Release(Release::default());
    for (protocol, batches) in [(pour, 4), (release, 1)] {
        let mut spec = cubes(8);
        spec.container = Container::Box {
            width: 4.0 * D,
            depth: 4.0 * D,
        };
        spec.protocol = protocol;
        let mut packing = Packing::new(spec).unwrap();
        let report = packing.run().unwrap();
        assert_settled(&packing, &report);
        assert_eq!(report.batches, batches, "{protocol:?}");
    }
}

/// A pack made in a viscous medium, or with local damping, is verified without it, and stays in place.
/// An endless bed: without side walls the floor carries all of the weight, no body meets an edge, and a job goes on from a
/// checkpoint with the same bits.
#[test]
fn periodic_beds_settle() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pack.ckpt");
    let protocols = [
        Protocol::Sequential(Sequential::default()),
        Protocol::Pour(Pour::default()),
        Protocol::Release(Release::default()),
    ];
    for protocol in protocols {
        let spec = PackSpec {
            container: Container::Periodic {
                width: 2.5 * D,
                depth: 2.3 * D,
            },
            protocol,
            ..cubes(14)
        };
        let mut whole = Packing::new(spec).unwrap();
        let mut parts = whole.clone();
        let report = whole.run().unwrap();
        assert_settled(&whole, &report);
        let walls = whole.world().walls().map(|(_, wall)| wall.name());
        assert_eq!(walls.collect::<Vec<_>>(), ["floor"]);
        // 14 cubes of 0.1925 d3 on 5.75 d2: 0.47 d of solid.
        assert!(
            report.mean_top > 0.47 * D && report.mean_top < 1.6 * D,
            "{report:?}"
        );
        let world = whole.world();
        let crosses = |contact: &femdem_contact::Contact| match contact.a {
            Partner::Body(a) => {
                let way = world.position(contact.b).unwrap() - world.position(a).unwrap();
                way.norm() > 1.1 * D
            }
            Partner::Wall(_) => false,
        };
        assert!(
            world.contacts().iter().any(crosses),
            "contacts over the edges"
        );
        while !parts.is_done() {
            parts.advance(997).unwrap();
            checkpoint::write_file(&path, "packing", &parts).unwrap();
            parts = checkpoint::read_file(&path, "packing").unwrap();
        }
        let hash = |packing: &Packing| packing.world().state_hash().unwrap();
        assert_eq!(hash(&parts), hash(&whole), "{protocol:?}");
    }
}

#[test]
fn a_pack_made_in_a_medium_rests_without_it() {
    let mut spec = cubes(5);
    let drag = Medium {
        drag: 0.6 * (spec.gravity / D).sqrt(),
        ..Medium::default()
    };
    let local = Medium {
        local_damping: 0.6,
        ..Medium::default()
    };
    for medium in [drag, local] {
        spec.medium = medium;
        let mut packing = Packing::new(spec.clone()).unwrap();
        assert_eq!(packing.world().parameters().medium, medium);
        let report = packing.run().unwrap();
        assert_settled(&packing, &report);
        assert_eq!(packing.world().parameters().medium, Medium::default());
        assert!(!packing.world().parameters().sleeping.enabled);
        assert_eq!(packing.world().awake_count(), 5);
    }
}

/// Smooth elastic bodies in a medium that damps locally.
fn elastic(seed: u64) -> PackSpec {
    let mut spec = PackSpec {
        shapes: vec![PackShape::new("A10", solid(Solid::A10))],
        friction: 0.0,
        damping_ratio: 0.0,
        seed,
        ..cubes(20)
    };
    spec.container = Container::Box {
        width: 3.0 * D,
        depth: 3.0 * D,
    };
    spec.medium.local_damping = 0.6;
    spec
}

/// Elastic bodies never come to rest without a medium: what begins to move in the verification does so in the
/// job's medium.
#[test]
fn what_the_verification_sets_in_motion_rests_in_the_medium() {
    for seed in [2, 3] {
        let mut packing = Packing::new(elastic(seed)).unwrap();
        let report = packing.run().unwrap();
        assert_settled(&packing, &report);
        assert_eq!(packing.world().parameters().medium, Medium::default());
    }
}

/// The same if no body ever sleeps.
#[test]
fn a_pack_made_awake_rests_in_the_medium_too() {
    for seed in [9, 11] {
        let mut spec = elastic(seed);
        spec.sleeping.enabled = false;
        let mut packing = Packing::new(spec).unwrap();
        let report = packing.run().unwrap();
        assert!(report.settled, "{report:?}");
        assert!(report.verification.unwrap().tries > 1, "{report:?}");
        assert_eq!(packing.world().parameters().medium, Medium::default());
    }
}

/// The report of a pack whose time is over between two attempts is computed without the medium, too.
#[test]
fn a_pack_out_of_time_is_reported_without_the_medium() {
    for longest in [1.5, 2.0, 3.0] {
        let mut spec = elastic(1);
        spec.settling.longest = longest;
        let mut packing = Packing::new(spec).unwrap();
        let report = packing.run().unwrap();
        assert!(!report.settled, "{longest}");
        assert_eq!(packing.world().parameters().medium, Medium::default());
    }
}

/// Packs of 150 cubes, which are relaxed once during growth.
fn relaxed_once() -> PackSpec {
    let mut spec = cubes(150);
    spec.container = Container::Box {
        width: 5.0 * D,
        depth: 5.0 * D,
    };
    spec
}

/// After a relaxation with implicit steps the step control is as before, with its limit for falling bodies.
/// Within it steps are at most six times the explicit limit, whatever is specified.
#[test]
fn a_relaxation_leaves_the_step_control_as_it_was() {
    let long = ImplicitStep {
        multiple: 12.0,
        ..ImplicitStep::default()
    };
    for implicit in [None, Some(long)] {
        let mut spec = relaxed_once();
        spec.time_step.implicit = implicit;
        let mut packing = Packing::new(spec).unwrap();
        let first = packing.world().parameters().time_step;
        assert!(first.largest.is_some());
        let (mut relaxed, mut last) = (false, first);
        while packing.advance(1).unwrap().stage == Stage::Depositing {
            let now = packing.world().parameters().time_step;
            last = now;
            if now != first {
                relaxed = true;
                assert!(now.implicit.unwrap().multiple <= 6.0, "{now:?}");
            }
        }
        assert!(relaxed && last == first, "{last:?}");
    }
}

/// Implicit steps pour, relax and settle, and begin the verification; explicit ones end it, after at least
/// three checks.
#[test]
fn a_pack_made_with_implicit_steps_is_verified_with_explicit_ones() {
    let mut spec = relaxed_once();
    spec.penalty = Penalty::Given { pressure: 1e7 };
    spec.time_step.implicit = Some(ImplicitStep::default());
    let unit = (spec.diameter() / spec.gravity).sqrt();
    for protocol in [
        Protocol::Sequential(Sequential::default()),
        Protocol::Release(Release::default()),
    ] {
        spec.protocol = protocol;
        let mut packing = Packing::new(spec.clone()).unwrap();
        let mut since = None;
        while !packing.is_done() {
            let at = packing.advance(1).unwrap();
            let is_explicit = packing.world().parameters().time_step.implicit.is_none();
            assert!(!is_explicit || at.stage == Stage::Verifying || at.stage == Stage::Done);
            let now = packing.world().time();
            since = is_explicit.then(|| since.unwrap_or(now));
        }
        let report = packing.report().unwrap();
        assert_settled(&packing, &report);
        let explicit = (packing.world().time() - since.unwrap()) / unit;
        assert!(explicit > 0.29, "{explicit}");
        // Ten passes in a row are nine intervals apart.
        let all = report.verification.unwrap().time / unit;
        assert!(all > 0.89 && all > 2.0 * explicit, "{all} {explicit}");
        assert_eq!(packing.world().awake_count(), 150);
    }
}

/// Sums over the contacts with walls, then over those of bodies: friction, normal force and both
/// stiffnesses.
fn forces(packing: &Packing) -> [[f64; 4]; 2] {
    let mut sums = [[0.0; 4]; 2];
    for contact in packing.world().contacts() {
        let kind = usize::from(matches!(contact.a, Partner::Body(_)));
        let of_contact = [
            contact.friction.norm(),
            contact.normal_force,
            contact.tangential_stiffness,
            contact.stiffness,
        ];
        for (sum, part) in sums[kind].iter_mut().zip(of_contact) {
            *sum += part;
        }
    }
    sums
}

/// A pack between walls without friction rests on the floor alone; between rough walls bodies without friction
/// lean on them. The friction springs have the specified stiffness. The shaft is so narrow that the cubes are
/// stacked: a single layer on a floor without friction slides about for long, as it should.
#[test]
fn friction_of_walls_and_stiffness_of_springs_are_those_asked_for() {
    for (friction, wall_friction, tangential_ratio) in [(0.6, 0.0, 0.4), (0.0, 0.6, 1.6)] {
        let mut packing = Packing::new(PackSpec {
            friction,
            wall_friction: Some(wall_friction),
            tangential_ratio,
            container: Container::Box {
                width: 1.6 * D,
                depth: 1.6 * D,
            },
            ..cubes(12)
        })
        .unwrap();
        let report = packing.run().unwrap();
        assert_settled(&packing, &report);
        let [walls, bodies] = forces(&packing);
        for (sums, mu) in [(walls, wall_friction), (bodies, friction)] {
            assert!(sums[0] <= mu * sums[1] && (mu == 0.0 || sums[0] > 1e-3 * sums[1]));
            assert!((sums[2] / sums[3] - tangential_ratio).abs() < 1e-12);
        }
    }
}

/// The last relaxation takes a few quarters of the slowest oscillation, with implicit steps. The verification
/// that follows, with explicit ones, moves next to nothing, in a world without any medium.
#[test]
fn the_last_relaxation_is_short_and_leaves_nothing_to_the_verification() {
    let mut packing = Packing::new(cubes(24)).unwrap();
    let mut took = 0.0;
    while !packing.is_done() {
        let (stage, before) = (packing.progress().stage, packing.world().time());
        packing.advance(1).unwrap();
        let parameters = packing.world().parameters();
        assert_eq!(parameters.medium, Medium::default());
        if stage == Stage::Settling && parameters.time_step.implicit.is_some() {
            took += packing.world().time() - before;
        }
    }
    let report = packing.report().unwrap();
    assert_settled(&packing, &report);
    assert_eq!(packing.world().parameters().time_step.implicit, None);
    // A few layers that sink in by a few hundredths of D each: the period is that of a pendulum as long
    // as the sag, 0.3 D at most.
    let period = 2.0 * std::f64::consts::PI * (0.3 * D / 9.81).sqrt();
    assert!(report.relaxation.is_some());
    assert!(took > 0.0 && took < 3.0 * period, "{took} s, {period} s");
    let verification = report.verification.unwrap();
    assert!(verification.passed && verification.tries >= 1);
    assert!(verification.max_displacement_over_d <= 1e-3, "{report:?}");
}

/// Where sleep is forbidden no body needs to be woken.
#[test]
fn a_pack_made_awake_needs_no_relaxation() {
    let mut spec = cubes(5);
    spec.sleeping.enabled = false;
    let report = Packing::new(spec).unwrap().run().unwrap();
    assert!(report.settled, "{report:?}");
    assert_eq!(report.relaxation, None);
}

/// A pour has the specified rate: 8 bodies in layers of 2 at 20 bodies per second start at 0, 0.1, 0.2 and 0.3
/// s.
#[test]
fn a_pour_keeps_its_rate() {
    let mut spec = cubes(8);
    spec.container = Container::Box {
        width: 6.0 * D,
        depth: 6.0 * D,
    };
    spec.protocol = Protocol::Pour(Pour {
        rate: 20.0,
        layer: Some(2),
        ..Pour::default()
    });
    let mut packing = Packing::new(spec).unwrap();
    let mut starts = vec![0.0];
    while packing.progress().stage == Stage::Depositing {
        let now = packing.advance(1).unwrap();
        if now.batches as usize > starts.len() {
            starts.push(now.time);
        }
    }
    assert_eq!(starts.len(), 4);
    for (k, start) in starts.iter().enumerate() {
        assert!((start - 0.1 * k as f64).abs() < 2e-3, "{starts:?}");
    }
}

/// A job saved, read back and continued in other portions ends in the same bits as an uninterrupted one, at
/// whatever stage it was interrupted.
#[test]
fn a_job_continues_from_a_checkpoint_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pack.ckpt");
    let spec = PackSpec {
        wall_friction: Some(0.3),
        tangential_ratio: 1.2,
        ..cubes(4)
    };
    let mut whole = Packing::new(spec).unwrap();
    let mut parts = whole.clone();
    let report = whole.run().unwrap();
    while !parts.is_done() {
        parts.advance(97).unwrap();
        checkpoint::write_file(&path, "packing", &parts).unwrap();
        parts = checkpoint::read_file(&path, "packing").unwrap();
    }
    assert_eq!(parts.report().unwrap(), report);
    assert_eq!(parts.world().parameters().contact.wall_friction, Some(0.3));
    assert_eq!(
        parts.world().state_hash().unwrap(),
        whole.world().state_hash().unwrap()
    );
}

#[test]
fn thread_counts_give_the_same_bits() {
    let mut spec = cubes(40);
    spec.container = Container::Box {
        width: 4.0 * D,
        depth: 4.0 * D,
    };
    spec.protocol = Protocol::Release(Release::default());
    let hash = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| {
            let mut packing = Packing::new(spec.clone()).unwrap();
            packing.advance(1500).unwrap();
            packing.world().state_hash().unwrap()
        })
    };
    let one = hash(1);
    assert_eq!(one, hash(2));
    assert_eq!(one, hash(3));
}

#[test]
fn seeds_make_different_packs() {
    let position = |seed: u64| {
        let mut packing = Packing::new(PackSpec { seed, ..cubes(1) }).unwrap();
        packing.advance(1).unwrap();
        packing.world().position(0).unwrap()
    };
    assert_eq!(position(1), position(1));
    assert_ne!(position(1), position(2));
}

/// With next to no time to come to rest the job ends and says so.
#[test]
fn a_pack_that_has_not_settled_is_not_called_settled() {
    let mut spec = cubes(3);
    spec.settling.longest = 0.5;
    // Slower than any body can be.
    spec.settling.kinetic_energy = 1e-300;
    let mut packing = Packing::new(spec).unwrap();
    let report = packing.run().unwrap();
    assert!(!report.settled);
    assert!(!report.verification.unwrap().passed);
}

/// A penalty far too low for the weight lets the bodies sink through the floor.
#[test]
fn a_body_that_leaves_the_container_is_named() {
    let mut spec = cubes(1);
    spec.penalty = Penalty::Given { pressure: 50.0 };
    let error = Packing::new(spec).unwrap().run().unwrap_err();
    let message = error.to_string();
    match error {
        PackError::Escaped { body, through, .. } => {
            assert_eq!((body, through.as_str()), (0, "floor"));
        }
        PackError::Solve(_) => {}
        _ => panic!("{message}"),
    }
    assert!(message.contains("body 0"), "{message}");
    assert!(message.contains("penalty"), "{message}");
}

#[test]
fn specs_that_cannot_be_packed_are_refused_by_name() {
    let says = |spec: PackSpec| Packing::new(spec).unwrap_err().to_string();
    let mut narrow = cubes(3);
    narrow.container = Container::Cylinder { diameter: 0.5 * D };
    assert!(says(narrow).contains("container's diameter is 0.01 m"));
    let mut slippery = cubes(3);
    slippery.friction = -1.0;
    assert!(says(slippery).contains("friction = -1"));
    let mut walls = cubes(3);
    walls.wall_friction = Some(f64::NAN);
    assert!(says(walls).contains("wall_friction = NaN"));
    let mut stiff = cubes(3);
    stiff.tangential_ratio = 2.5;
    assert!(says(stiff).contains("tangential_ratio = 2.5"));
    let mut wide = cubes(3);
    wide.protocol = Protocol::Release(Release {
        per_layer: Some([9, 1]),
        ..Release::default()
    });
    assert!(says(wide).contains("at most 2"));
}
