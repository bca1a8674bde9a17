//! Deformable bodies that crack and break.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::{PeriodicCell, Wall};
use femdem_fem::element::Element;
use femdem_fem::fracture::{Strength, Weibull};
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, Drive, MaterialRegion, Selection};
use femdem_mesh::{Point3, Pose, TetMesh, Vector3};
use femdem_solve::{
    ContactStiffness, DeformableSpec, Fracture, SleepParameters, TimeStepParameters, World,
    WorldParameters,
};

const YOUNG: f64 = 20e9;
const TENSILE: f64 = 5e6;

/// Rock: f = 5 MPa, c = 20 MPa, tan φ = 0.8.
pub fn rock(energies: [f64; 2]) -> Fracture {
    Fracture::new(
        Strength::new(TENSILE, 20e6, 0.8_f64.atan()).unwrap(),
        energies,
    )
}

/// A block whose points are moved by up to a fifth of an edge, on the skin along it.
pub fn shaken(cells: [u32; 3], size: &Vector3) -> TetMesh {
    let block = TetMesh::block(cells, size).unwrap();
    let edge = size.component_div(&Vector3::from(cells.map(f64::from)));
    let noise = |i: usize, k: f64| (12.9898 * i as f64 + 78.233 * k).sin();
    let moved = |(i, p): (usize, &Point3)| {
        let mut p = *p;
        for k in 0..3 {
            let inside = p[k] > 1e-9 * size[k] && p[k] < (1.0 - 1e-9) * size[k];
            if inside {
                p[k] += 0.2 * edge[k] * noise(i, k as f64);
            }
        }
        p
    };
    let points = block.points().iter().enumerate().map(moved).collect();
    TetMesh::new(points, block.tets().to_vec()).unwrap()
}

pub fn model(mesh: &TetMesh) -> DeformableModel {
    let region = MaterialRegion {
        material: NeoHookean::new(YOUNG, 0.2).unwrap().into(),
        density: 2500.0,
    };
    DeformableModel::new(mesh, Element::T4, vec![region], None).unwrap()
}

fn still() -> World {
    World::new(WorldParameters {
        gravity: Vector3::zeros(),
        sleeping: SleepParameters {
            enabled: false,
            ..SleepParameters::default()
        },
        time_step: TimeStepParameters {
            safety: 0.5,
            ..TimeStepParameters::default()
        },
        ..WorldParameters::default()
    })
    .unwrap()
}

/// Bar of 40 x 10 x 10 mm whose ends go apart at `speed` each, m/s.
fn bar(cells: [u32; 3], speed: f64, fracture: Option<Fracture>) -> World {
    let size = Vector3::new(0.04, 0.01, 0.01);
    let mut world = still();
    let model = model(&shaken(cells, &size));
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, -1.0), (size.x, 1.0)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (way * speed),
            start: 0.0,
            end: 1.0,
        };
        boundary
            .drive(&model, &end, [true, false, false], drive)
            .unwrap();
    }
    // Along the bar, no wave comes from the ends.
    let start: Vec<Vector3> = model.nodes().to_vec();
    let velocity = |x: &Vector3| Vector3::x() * (speed * (2.0 * x.x / size.x - 1.0));
    let velocities: Vec<Vector3> = start.iter().map(velocity).collect();
    let id = world
        .add_model("bar", model, ContactStiffness::default())
        .unwrap();
    let body = world
        .add_deformable(DeformableSpec {
            boundary,
            fracture,
            ..DeformableSpec::at_rest(id, Pose::identity())
        })
        .unwrap();
    world.set_nodes(body, &start, &velocities).unwrap();
    world
}

/// Mean tension at its middle, Pa.
fn tension(world: &World) -> f64 {
    let body = world.deformable(0).unwrap();
    let stresses = body.stresses().unwrap();
    let volumes = body.model().volumes();
    let sum: f64 = stresses
        .iter()
        .zip(volumes)
        .map(|(s, v)| s.cauchy[(0, 0)] * v)
        .sum();
    sum / volumes.iter().sum::<f64>()
}

fn fragments(world: &World) -> usize {
    let fragments = world.deformable(0).unwrap().cracks().unwrap().fragments();
    fragments.iter().max().map_or(1, |most| *most as usize + 1)
}

/// No calibration: the strength is that of the material, the energy at least that of the section (a bar under the same tension
/// everywhere cracks in several places before it breaks), and all of it is on the books. Then the pieces are pushed together again and bear pressure, as the whole bar does.
#[test]
fn a_bar_in_tension_breaks_at_its_strength_and_closes_again() {
    let mut world = bar([12, 3, 3], 0.2, Some(rock([20.0, 100.0])));
    let mut peak = 0.0_f64;
    while fragments(&world) < 2 {
        world.step().unwrap();
        peak = peak.max(tension(&world));
        assert!(world.time() < 1e-3, "it does not break: {peak:e}");
    }
    for _ in 0..500 {
        world.step().unwrap();
    }
    assert!((peak / TENSILE - 1.0).abs() < 0.05, "{peak:e}");
    let ledger = world.ledger();
    let taken = (ledger.dissipated_fracture - ledger.lent) / (20.0 * 1e-4);
    assert!(taken > 1.0 && taken < 4.0, "{taken}");
    assert!(ledger.error_relative().abs() < 1e-3, "{ledger:?}");
    let body = world.deformable(0).unwrap();
    let mass = 2500.0 * 0.04 * 1e-4;
    assert!((body.mass() / mass - 1.0).abs() < 1e-12);
    // Back at ten times the speed, until the pieces have met and press each other.
    let model = body.model().clone();
    let places = body.positions().to_vec();
    let mut boundary = Boundary::default();
    for (offset, way) in [(0.0, 1.0), (0.04, -1.0)] {
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset,
            tolerance: 1e-9,
        };
        let drive = Drive::Linear {
            velocity: Vector3::x() * (2.0 * way),
            start: world.time(),
            end: 1.0,
        };
        boundary
            .drive_from(&model, &end, [true, false, false], drive, &places)
            .unwrap();
    }
    world.set_boundary(0, boundary).unwrap();
    let pulled = 0.4 * world.time();
    let until = world.time() + (pulled + 1e-5) / 4.0;
    while world.time() < until {
        world.step().unwrap();
    }
    assert!(tension(&world) < -0.2 * YOUNG * 1e-5 / 0.04);
    assert!(
        world.ledger().error_relative().abs() < 2e-3,
        "{:?}",
        world.ledger()
    );
}

/// A block with a weak plane of facets is torn along it, one edge first, so that the corners of facets split one after another, the late
/// ones when the others have let go: each facet in that plane takes G times its area, whatever was left there.
#[test]
fn facets_in_the_plane_of_a_crack_take_their_energy() {
    let size = Vector3::new(0.02, 0.005, 0.02);
    let mut world = still();
    let mesh = TetMesh::block([8, 2, 8], &size).unwrap();
    let nodes: Vec<Vector3> = mesh.points().iter().map(|p| p.coords).collect();
    let id = world
        .add_model("block", model(&mesh), ContactStiffness::default())
        .unwrap();
    let body = world
        .add_deformable(DeformableSpec {
            fracture: Some(rock([10.0, 50.0])),
            ..DeformableSpec::at_rest(id, Pose::identity())
        })
        .unwrap();
    let is_seam = |x: &Vector3| (x.x - 0.5 * size.x).abs() < 1e-9;
    let factor = |x: &Vector3| if is_seam(x) { 1.0 } else { 100.0 };
    let factors: Vec<f64> = nodes.iter().map(factor).collect();
    world.scale_strength(body, &factors).unwrap();
    let apart = |x: &Vector3| Vector3::x() * ((x.x / size.x - 0.5) * (0.3 + 9.0 * x.z / size.z));
    let velocities: Vec<Vector3> = nodes.iter().map(apart).collect();
    world.set_nodes(body, &nodes, &velocities).unwrap();
    while fragments(&world) < 2 {
        world.step().unwrap();
        assert!(world.time() < 1e-4, "it does not break");
    }
    let body = world.deformable(body).unwrap();
    let cracks = body.cracks().unwrap();
    let all = cracks.spent().iter().copied().chain(cracks.facets());
    let (mut count, mut births) = (0, Vec::new());
    for facet in all.filter(|facet| facet.end.is_some()) {
        let [a, b, c] = facet.place;
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        // At the cut facets are tilted by strains of f/E, which count squared.
        let taken = facet.taken / (10.0 * area);
        let tilt = (TENSILE / YOUNG).powi(2);
        assert!((taken - 1.0).abs() < tilt, "{taken} {facet:?}");
        births.push(facet.birth);
        count += 1;
    }
    births.sort_by(f64::total_cmp);
    births.dedup();
    assert!(count == 32 && births.len() > 2, "{count} {births:?}");
    assert!(world.ledger().error_relative().abs() < 1e-3);
}

/// A bar that is weaker in one plane breaks there at the strength of that plane; what means nothing is refused.
#[test]
fn a_bar_with_a_seam_breaks_at_the_seam() {
    let mut world = bar([12, 3, 3], 0.2, Some(rock([20.0, 100.0])));
    let nodes = world.deformable(0).unwrap().model().nodes().to_vec();
    let is_seam = |x: &Vector3| (x.x - 0.03).abs() < 0.002;
    let factor = |x: &Vector3| if is_seam(x) { 0.5 } else { 1.0 };
    let factors: Vec<f64> = nodes.iter().map(factor).collect();
    let cases = [&factors[1..], &[&[0.0], &factors[1..]].concat()[..]];
    for wrong in cases {
        assert!(world.scale_strength(0, wrong).is_err());
    }
    assert!(world.scale_strength(1, &factors).is_err());
    assert!(
        bar([4, 1, 1], 0.2, None)
            .scale_strength(0, &[1.0; 20])
            .is_err()
    );
    world.scale_strength(0, &factors).unwrap();
    let mut peak = 0.0_f64;
    while fragments(&world) < 2 {
        world.step().unwrap();
        peak = peak.max(tension(&world));
        assert!(world.time() < 1e-3, "it does not break: {peak:e}");
    }
    // Nodes beside those that failed wait, while the tension rises.
    assert!(peak > 0.5 * TENSILE && peak < 0.7 * TENSILE, "{peak:e}");
    let body = world.deformable(0).unwrap();
    for facet in body.cracks().unwrap().facets() {
        let centre = facet.place.iter().sum::<Vector3>() / 3.0;
        assert!((centre.x - 0.03).abs() < 0.005, "{centre:?}");
    }
    let count = body.model().nodes().len();
    let refused = world.scale_strength(0, &vec![1.0; count]).unwrap_err();
    assert!(refused.to_string().contains("cracks"), "{refused}");
}

/// As long as nothing cracks, a body that may break moves with the same bits as one that cannot.
#[test]
fn before_it_cracks_a_body_has_the_same_bits() {
    let [mut may, mut cannot] = [Some(rock([20.0, 100.0])), None].map(|f| bar([8, 2, 2], 0.05, f));
    for _ in 0..300 {
        may.step().unwrap();
        cannot.step().unwrap();
    }
    let stressed = tension(&may) / TENSILE;
    assert!(stressed > 0.5 && stressed < 1.0, "{stressed}");
    assert!(
        may.deformable(0)
            .unwrap()
            .cracks()
            .unwrap()
            .mesh()
            .is_none()
    );
    assert_eq!(
        may.deformable(0).unwrap().positions(),
        cannot.deformable(0).unwrap().positions()
    );
    assert_eq!(may.time(), cannot.time());
}

/// A cube that falls on its edge, fast enough to break.
fn dropped() -> World {
    dropped_of(4)
}

/// The same with cells of a number along each edge.
fn dropped_of(cells: u32) -> World {
    let mut world = still();
    world
        .add_wall(
            Wall::half_space("floor", Vector3::z(), 0.0).unwrap(),
            femdem_solve::Drive::Fixed,
        )
        .unwrap();
    let id = world
        .add_model(
            "cube",
            model(&shaken([cells; 3], &Vector3::repeat(0.02))),
            ContactStiffness::default(),
        )
        .unwrap();
    let place = Pose::new(Vector3::new(0.0, 0.0, 0.012), Vector3::new(0.6, 0.2, 0.0));
    world
        .add_deformable(DeformableSpec {
            velocity: Vector3::new(0.0, 0.0, -40.0),
            fracture: Some(Fracture {
                coarse: true,
                ..rock([5.0, 25.0])
            }),
            ..DeformableSpec::at_rest(id, place)
        })
        .unwrap();
    world
}

/// The pieces of a cube thrown on the floor: mass, momentum and energy are right, and the bits are the same with threads and
/// through checkpoints in the midst of it.
#[test]
fn a_thrown_cube_breaks() {
    let mut world = dropped();
    let mut restarted = dropped();
    let mut worst = 0.0_f64;
    for step in 0..2400 {
        world.step().unwrap();
        restarted.step().unwrap();
        if step % 400 == 399 {
            let bytes = restarted.to_bytes().unwrap();
            restarted = World::from_bytes(&bytes).unwrap();
        }
        worst = worst.max(world.ledger().error_relative().abs());
    }
    let cracks = world.deformable(0).unwrap();
    let cracks = cracks.cracks().unwrap();
    println!(
        "frag {} spent {} joints {} worst {worst:.1e} rel {:.2e}",
        fragments(&world),
        cracks.spent().len(),
        cracks.facets().count(),
        world.ledger().dissipated_release
    );
    assert!(fragments(&world) > 3);
    assert!(!cracks.spent().is_empty());
    assert_eq!(world.to_bytes().unwrap(), restarted.to_bytes().unwrap());
    // No other body can have its model.
    let own = world.deformable(0).unwrap().model_id();
    assert!(own > 0);
    let refused = world.add_deformable(DeformableSpec::at_rest(own, Pose::identity()));
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("has this one alone"), "{refused}");
}

#[test]
fn what_cannot_break_is_refused_by_name() {
    let mut world = still();
    let mesh = shaken([2; 3], &Vector3::repeat(0.02));
    let of = |world: &mut World, element, stiffness, fracture| {
        let region = MaterialRegion {
            material: NeoHookean::new(YOUNG, 0.2).unwrap().into(),
            density: 2500.0,
        };
        let model = DeformableModel::new(&mesh, element, vec![region], None).unwrap();
        let id = world.add_model("cube", model, stiffness).unwrap();
        let spec = DeformableSpec {
            fracture: Some(fracture),
            ..DeformableSpec::at_rest(id, Pose::identity())
        };
        world.add_deformable(spec).unwrap_err().to_string()
    };
    let ratio = ContactStiffness::Ratio(1.0);
    let good = Fracture {
        coarse: true,
        ..rock([20.0, 100.0])
    };
    let coarse = of(&mut world, Element::T4, ratio, rock([2.0, 10.0]));
    assert!(
        coarse.contains("use a mesh with edges of about"),
        "{coarse}"
    );
    // Fine enough to open, but the glue would store more than half of its energy before it slides: h > 2 E G/c².
    let sheared = of(&mut world, Element::T4, ratio, rock([20.0, 20.0]));
    assert!(sheared.contains("needs 2.000e-3 m or less"), "{sheared}");
    let quadratic = of(&mut world, Element::T10, ratio, good);
    assert!(quadratic.contains("linear elements (T4)"), "{quadratic}");
    let penalty = of(
        &mut world,
        Element::T4,
        ContactStiffness::Penalty(1e9),
        good,
    );
    assert!(
        penalty.contains("contact stiffness over depth"),
        "{penalty}"
    );
    let eager = of(
        &mut world,
        Element::T4,
        ratio,
        Fracture { every: 0, ..good },
    );
    assert!(eager.contains("steps between looks"), "{eager}");
    let slippery = of(&mut world, Element::T4, ratio, rock([20.0, 10.0]));
    assert!(
        slippery.contains("energy of fracture by sliding = 10"),
        "{slippery}"
    );
    assert_eq!(world.deformable_count(), 0);
}

/// Mass, momentum and angular momentum about the origin of all bodies, and their energies in motion, strain and cracks.
fn sums(world: &World) -> (f64, [Vector3; 2], [f64; 3]) {
    let (mut mass, mut momenta, mut energies) = (0.0, [Vector3::zeros(); 2], [0.0; 3]);
    for body in world.deformables() {
        mass += body.mass();
        momenta[0] += body.momentum();
        momenta[1] += body.angular_momentum(&Vector3::zeros());
        energies[0] += body.kinetic_energy();
        energies[1] += body.internal().energy;
        energies[2] += body.cracks().map_or(0.0, |cracks| cracks.stored());
    }
    (mass, momenta, energies)
}

/// Whether what was before is now, to round-off.
fn assert_same(before: &World, after: &World) {
    let ((m, p, e), (n, q, f)) = (sums(before), sums(after));
    assert!((m / n - 1.0).abs() < 1e-13, "{m} {n}");
    let speed = (2.0 * e[0] / m).sqrt();
    let near = |x: &Vector3, y: &Vector3, size: f64| (x - y).norm() < 1e-12 * size;
    assert!(near(&p[0], &q[0], m * speed), "{p:?} {q:?}");
    assert!(near(&p[1], &q[1], 0.1 * m * speed), "{p:?} {q:?}");
    let all: f64 = e.iter().sum();
    for (x, y) in e.iter().zip(f) {
        assert!((x - y).abs() < 1e-10 * all, "{e:?} {f:?}");
    }
    let (a, b) = (before.ledger(), after.ledger());
    assert!((a.error() - b.error()).abs() < 1e-10 * all, "{a:?} {b:?}");
    assert!((a.elastic - b.elastic).abs() < 1e-10 * all);
    assert!((a.dissipated_release - b.dissipated_release).abs() < 1e-10 * all);
    // Springs on the skin of both of two parts end on one, never the other way.
    let lost = a.friction_springs - b.friction_springs;
    assert!(lost > -1e-10 * all && lost < 0.01 * all, "{a:?} {b:?}");
}

/// A bar that is pulled apart is two bodies, each with one of the ends and what holds it, and with the strengths that it had.
#[test]
fn halves_of_a_bar_fly_apart_as_two_bodies() {
    let fracture = Fracture {
        scatter: Some(Weibull::new(20.0, 1e-9, 7).unwrap()),
        ..rock([20.0, 100.0])
    };
    let mut world = bar([12, 3, 3], 0.5, Some(fracture));
    let tets = world.deformable(0).unwrap().model().mesh().tets().len();
    // A body that has been there before leaves its number.
    let place = Pose::translation(1.0, 0.0, 0.0);
    let other = world.add_deformable(DeformableSpec::at_rest(0, place));
    let other = other.unwrap();
    world.remove_body(other).unwrap();
    let before = loop {
        world.step().unwrap();
        let before = world.clone();
        let fragmentations = world.fragment_bodies().unwrap();
        if !fragmentations.is_empty() {
            assert!(fragmentations[0].body == 0 && fragmentations[0].fragments[0] == other);
            break before;
        }
        assert!(world.time() < 1e-3);
    };
    assert_same(&before, &world);
    let whole = before.deformable(0).unwrap();
    let stresses = whole.stresses().unwrap();
    let mut volumes: Vec<f64> = Vec::new();
    let mut spent = 0;
    for body in world.deformables() {
        let cracks = body.cracks().unwrap();
        volumes.push(body.model().volumes().iter().sum());
        // Its stresses are those that were there.
        for stress in body.stresses().unwrap() {
            let same = |other: &femdem_fem::ElementStress| stress.cauchy == other.cauchy;
            assert!(stresses.iter().any(same));
        }
        assert_eq!(cracks.points().len(), {
            let points = cracks
                .mesh()
                .map(|mesh| mesh.points().iter().max().unwrap() + 1);
            points.map_or(body.positions().len(), |count| count as usize)
        });
        spent += cracks
            .spent()
            .iter()
            .filter(|f| f.tets[0].is_some())
            .count();
        assert_eq!(body.name(), "bar");
    }
    assert_eq!(spent, whole.cracks().unwrap().spent().len());
    assert!(volumes.iter().all(|volume| *volume <= volumes[0]));
    let count: usize = world.deformables().map(|b| b.model().volumes().len()).sum();
    assert_eq!(count, tets);
    // Each end is held as it was.
    let held: Vec<usize> = world
        .deformables()
        .map(|b| b.boundary().held().count())
        .collect();
    assert_eq!(held.iter().sum::<usize>(), whole.boundary().held().count());
    assert_eq!(held.iter().filter(|count| **count > 0).count(), 2);
    for _ in 0..300 {
        world.step().unwrap();
        world.fragment_bodies().unwrap();
    }
    let speeds: Vec<f64> = world
        .deformables()
        .filter(|body| body.boundary().held().count() > 0)
        .map(|body| body.momentum().x / body.mass())
        .collect();
    assert!(speeds[0] * speeds[1] < 0.0, "{speeds:?}");
    assert!(
        world.ledger().error_relative().abs() < 1e-3,
        "{:?}",
        world.ledger()
    );
}

/// Sides of cracks that pass through each other would push once they belong to two bodies: such a body stays one until it may touch
/// itself. Space does not come to repeat itself around what may break.
#[test]
fn a_body_that_may_not_touch_itself_stays_one() {
    let mut world = bar([12, 3, 3], 0.5, Some(rock([20.0, 100.0])));
    world.set_self_contact(0, false).unwrap();
    while fragments(&world) < 2 || world.steps() % 20 != 1 {
        world.step().unwrap();
        assert_eq!(world.fragment_bodies().unwrap(), []);
        assert!(world.time() < 1e-3);
    }
    let cell = PeriodicCell::new([Some(1.0); 3]).unwrap();
    let refused = world.set_cell(cell).unwrap_err().to_string();
    assert!(refused.contains("a periodic cell"), "{refused}");
    for _ in 0..300 {
        world.step().unwrap();
    }
    world.set_self_contact(0, true).unwrap();
    assert_eq!(world.fragment_bodies().unwrap().len(), 1);
    assert!(world.deformable_count() > 1);
}

/// A cube thrown on the floor becomes bodies that break on, with the same bits through checkpoints right after fragmentations and with
/// threads; at each of them nothing is lost or gained.
#[test]
fn the_pieces_of_a_thrown_cube_go_on_as_bodies() {
    let mut world = dropped_of(3);
    let mut restarted = dropped_of(3);
    let mut fragmentations = 0;
    let mut last = 0;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
    let pool = pool.unwrap();
    // Some steps beyond the second time.
    while fragmentations < 2 || world.steps() < last + 60 {
        assert!(world.steps() < 3000, "{fragmentations}");
        world.step().unwrap();
        pool.install(|| restarted.step()).unwrap();
        // Nodes are split, and facets spent, at every fifth step.
        let before = world.steps().is_multiple_of(5).then(|| world.clone());
        let parted = world.fragment_bodies().unwrap();
        let again = pool.install(|| restarted.fragment_bodies());
        assert_eq!(again.unwrap(), parted);
        if !parted.is_empty() {
            fragmentations += 1;
            last = world.steps();
            assert_same(&before.unwrap(), &world);
            let bytes = restarted.to_bytes().unwrap();
            restarted = World::from_bytes(&bytes).unwrap();
        }
    }
    let ledger = world.ledger();
    assert!(world.deformable_count() > 2);
    assert!(ledger.error_relative().abs() < 2e-3, "{ledger:?}");
    assert_eq!(world.to_bytes().unwrap(), restarted.to_bytes().unwrap());
}
