//! Cohesion over the contact area, and the adhesion of round bodies.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::pack::shape;
use crate::common::tets::{body, cube, cube as cube_mesh, differences, dolos, l_block, tube};
use femdem_contact::deform::{DeformableShape, Modulus};
use femdem_contact::{
    BodyShape, ContactBatch, ContactLaw, ContactLaws, ContactParameters, Field, Frame, MaterialId,
    MeshWall, Motion, Sphere, Wall, WallShape,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

const PENALTY: f64 = 3.0;
const COHESION: f64 = 0.7;

fn law(cohesion: f64, adhesion_energy: f64) -> ContactParameters {
    ContactParameters {
        penalty: PENALTY,
        friction: 0.0,
        damping_ratio: 0.0,
        tangential_damping: 0.0,
        cohesion,
        adhesion_energy,
        ..ContactParameters::default()
    }
}

fn moving(frame: &Frame) -> Motion {
    Motion {
        inverse_mass: 1.0,
        inverse_inertia: Matrix3::identity(),
        inverse_inertia_max: 1.0,
        ..Motion::fixed(*frame)
    }
}

/// What touches a body: another body or a wall.
#[derive(Clone)]
enum Other {
    Body(BodyShape),
    Wall(WallShape),
}

/// A batch of a body and what it touches, both at their frames, after one update.
fn touched(
    law: ContactParameters,
    other: &Other,
    body: &BodyShape,
    at: [&Frame; 2],
) -> ContactBatch {
    let mut batch = ContactBatch::new(ContactLaw::new(law).unwrap());
    let mut bodies = Vec::new();
    let mut walls = Vec::new();
    match other {
        Other::Body(shape) => {
            let shape = batch.add_shape(shape.clone());
            batch.add_body(shape).unwrap();
            bodies.push(moving(at[0]));
        }
        Other::Wall(wall) => {
            batch.add_wall(wall.clone());
            walls.push(Motion::fixed(*at[0]));
        }
    }
    let shape = batch.add_shape(body.clone());
    batch.add_body(shape).unwrap();
    bodies.push(moving(at[1]));
    batch.update(&bodies, &walls, 0.0).unwrap();
    batch
}

fn shapes() -> Vec<(&'static str, BodyShape)> {
    let meshed = |mesh| BodyShape::from(body(&mesh, Field::Body));
    vec![
        ("cube", shape("P5", 1.7).into()),
        ("dodecahedron", shape("P4", 1.2).into()),
        ("ball", Sphere::new(0.6).unwrap().into()),
        ("L", meshed(l_block())),
        ("tube", meshed(tube())),
        ("dolos", meshed(dolos())),
        ("meshed cube", meshed(cube(2))),
    ]
}

fn walls() -> Vec<(&'static str, WallShape)> {
    let corner = Wall::closed_box(Vector3::repeat(-0.55), Vector3::repeat(5.0)).unwrap();
    let mantle = Wall::cylinder("mantle", 1.6, 12).unwrap();
    vec![
        (
            "floor",
            Wall::half_space("floor", Vector3::z(), -0.4)
                .unwrap()
                .into(),
        ),
        ("side", corner.into_iter().next().unwrap().into()),
        ("mantle", mantle.into()),
        ("solid", MeshWall::solid("solid", &cube(2)).into()),
    ]
}

/// The wrenches on both sides are minus the gradient of the energy, and the attraction has its part of them, for shapes of all
/// kinds with each other and with walls of both kinds.
#[test]
fn attraction_is_minus_the_gradient() {
    let mut stream = Stream(5);
    let mut attracted = 0;
    let bodies = shapes();
    let others: Vec<(&str, Other)> = bodies
        .iter()
        .map(|(name, shape)| (*name, Other::Body(shape.clone())))
        .chain(
            walls()
                .into_iter()
                .map(|(name, wall)| (name, Other::Wall(wall))),
        )
        .collect();
    for (name, other) in &others {
        for (with, body) in &bodies {
            let mut touching = 0;
            for _ in 0..300 {
                if touching == 2 {
                    break;
                }
                let of_a = Frame {
                    position: stream.vector(),
                    rotation: stream.rotation(),
                };
                let of_b = Frame {
                    position: of_a.position + stream.vector() * 2.2,
                    rotation: stream.rotation(),
                };
                let both = |a: &Frame, b: &Frame| touched(law(COHESION, 0.0), other, body, [a, b]);
                let batch = both(&of_a, &of_b);
                let contacts = batch.contacts();
                // Deep overlaps, which no run has, are of little interest.
                let depth = contacts.iter().map(|c| c.penetration()).fold(0.0, f64::max);
                if contacts.is_empty() || depth > 0.2 {
                    continue;
                }
                touching += 1;
                let volume: f64 = contacts.iter().map(|c| c.volume).sum();
                let energy = batch.totals().energy;
                let elastic: f64 = contacts.iter().map(|c| c.energy).sum();
                assert!((energy - elastic + COHESION * volume).abs() < 1e-12);
                let id = batch.body_ids().last().unwrap();
                let got = batch.load_of(id).total;
                let h = 1e-5;
                let [force, torque] =
                    differences(|frame| both(&of_a, frame).totals().energy, &of_b, h);
                let size = got.force.norm() + COHESION * volume.powf(2.0 / 3.0);
                let error = (got.force - force).norm().max((got.torque - torque).norm());
                assert!(
                    error < 1e-6 * size,
                    "{name} with {with}: {error:e} of {size}"
                );
                // What acts on the other side is the opposite about the same point.
                let on_other = match other {
                    Other::Body(_) => batch.load_of(0).total,
                    Other::Wall(_) => batch.wall_load_of(0).total,
                };
                let arm = of_b.position - of_a.position;
                let about_a = got.torque + arm.cross(&got.force);
                assert!((on_other.force + got.force).norm() < 1e-12 * size);
                assert!((on_other.torque + about_a).norm() < 1e-11 * size);
                attracted += usize::from(contacts[0].adhesion.force.norm() > 0.1 * size);
            }
            assert!(touching > 0, "{name} with {with}");
        }
    }
    assert!(attracted > 50, "{attracted}");
}

/// Faces of the area A that hardly touch are held by c A, from a body as from a wall, and faces that are pressed are pressed by
/// what is left.
#[test]
fn faces_pull_off_at_the_cohesion_times_their_area() {
    let cube = BodyShape::from(shape("P5", 3_f64.sqrt()));
    let meshed = BodyShape::from(body(&tube_less_cube(), Field::Body));
    let floor = Wall::half_space("floor", Vector3::z(), 0.5).unwrap();
    for other in [
        Other::Body(cube.clone()),
        Other::Body(meshed),
        Other::Wall(floor.into()),
    ] {
        for depth in [1e-9, 1e-3] {
            let above = Frame {
                position: Vector3::new(0.2, 0.0, 1.0 - depth),
                ..Frame::identity()
            };
            let at = [&Frame::identity(), &above];
            let area = match other {
                Other::Body(_) => 0.8,
                Other::Wall(_) => 1.0,
            };
            let [with, without] = [COHESION, 0.0].map(|c| {
                let batch = touched(law(c, 0.0), &other, &cube, at);
                batch
                    .load_of(batch.body_ids().last().unwrap())
                    .total
                    .force
                    .z
            });
            let pull = without - with;
            assert!((pull / (COHESION * area) - 1.0).abs() < 1e-6, "{pull}");
            assert!(depth > 1e-6 || with < -0.999_999 * COHESION * area);
        }
    }
}

/// A cube of side 1 m about the origin, of tetrahedra.
fn tube_less_cube() -> femdem_mesh::TetMesh {
    let mesh = cube(2);
    let low = mesh
        .points()
        .iter()
        .fold(Vector3::repeat(f64::INFINITY), |m, p| m.inf(&p.coords));
    let high = mesh
        .points()
        .iter()
        .fold(Vector3::repeat(-f64::INFINITY), |m, p| m.sup(&p.coords));
    let (middle, size) = ((low + high) * 0.5, (high - low).x);
    let points = mesh
        .points()
        .iter()
        .map(|p| ((p.coords - middle) / size).into());
    femdem_mesh::TetMesh::new(points.collect(), mesh.tets().to_vec()).unwrap()
}

/// Balls pull off from each other and from planes at 3/2 pi w R of the reduced radius, and the force is the gradient of its
/// energy; in a corner each wall has its own.
#[test]
fn balls_pull_off_as_johnson_kendall_and_roberts_have_it() {
    let w = 0.05;
    let ball = |radius| BodyShape::from(Sphere::new(radius).unwrap());
    let floor = Wall::half_space("floor", Vector3::x(), 0.0).unwrap();
    let cases = [
        (Other::Body(ball(0.4)), 0.4, 0.24),
        (Other::Body(ball(0.6)), 0.6, 0.3),
        (Other::Wall(floor.into()), 0.0, 0.6),
    ];
    for (other, own, reduced) in cases {
        for depth in [1e-9, 1e-2] {
            let at = |x: f64| Frame {
                position: Vector3::new(x, 0.0, 0.0),
                ..Frame::identity()
            };
            let place = at(own + 0.6 - depth);
            let both = |frame: &Frame, w| {
                touched(law(0.0, w), &other, &ball(0.6), [&Frame::identity(), frame])
            };
            let force = |w| {
                let batch = both(&place, w);
                batch.load_of(batch.body_ids().last().unwrap()).total
            };
            let pull = force(0.0).force.x - force(w).force.x;
            assert!(
                (pull / (1.5 * PI * w * reduced) - 1.0).abs() < 1e-9,
                "{pull}"
            );
            assert!(force(w).torque.norm() < 1e-15);
            if depth > 1e-3 {
                let [gradient, _] = differences(|f| both(f, w).totals().energy, &place, 1e-5);
                assert!((force(w).force - gradient).norm() < 1e-8 * pull);
            }
        }
    }
}

/// Pairs of materials have their own cohesion; others have none.
#[test]
fn pairs_of_materials_have_their_own_cohesion() {
    let [wet, dry] = [1, 2].map(MaterialId);
    let mut laws = ContactLaws::from(ContactLaw::new(law(0.0, 0.0)).unwrap());
    laws.set(
        [wet, wet],
        Some(ContactLaw::new(law(COHESION, 0.0)).unwrap()),
    );
    let mut batch = ContactBatch::new(laws);
    let cube = batch.add_shape(shape("P5", 3_f64.sqrt()));
    let mut motions = Vec::new();
    for (k, material) in [wet, wet, dry].into_iter().enumerate() {
        let id = batch.add_body(cube).unwrap();
        batch.set_material(id, material).unwrap();
        let position = Vector3::z() * (k as f64 * (1.0 - 1e-6));
        motions.push(moving(&Frame {
            position,
            ..Frame::identity()
        }));
    }
    batch.update(&motions, &[], 0.0).unwrap();
    let contacts = batch.contacts();
    let pulls: Vec<f64> = contacts.iter().map(|c| -c.adhesion.force.z).collect();
    assert!(
        (pulls[0] - COHESION).abs() < 1e-6 && pulls[1] == 0.0,
        "{pulls:?}"
    );
}

/// The same bits for any number of threads, of many bodies with cohesion.
#[cfg(feature = "parallel")]
#[test]
fn the_same_bits_for_any_number_of_threads() {
    let forces = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut batch = ContactBatch::new(ContactLaw::new(law(COHESION, 0.0)).unwrap());
            let kinds = [shape("P5", 1.5), shape("A10", 1.5)].map(|s| batch.add_shape(s));
            let mut stream = Stream(3);
            let mut motions = Vec::new();
            for i in 0..200 {
                batch.add_body(kinds[i % 2]).unwrap();
                motions.push(moving(&Frame {
                    position: (stream.vector() + Vector3::repeat(0.5)) * 6.0,
                    rotation: stream.rotation(),
                }));
            }
            batch.update(&motions, &[], 1e-3).unwrap();
            let ids: Vec<_> = batch.body_ids().collect();
            ids.iter()
                .map(|&id| batch.load_of(id).total)
                .collect::<Vec<_>>()
        })
    };
    assert_eq!(forces(1), forces(3));
}

/// Attraction that would have no effect is refused by name.
#[test]
fn attraction_without_effect_is_refused() {
    let bad = |parameters| ContactLaw::new(parameters).unwrap_err().to_string();
    assert!(bad(law(-1.0, 0.0)).contains("cohesion = -1"));
    assert!(bad(law(0.0, f64::NAN)).contains("adhesion_energy = NaN"));
    let cube = BodyShape::from(shape("P5", 1.0));
    let mut batch = ContactBatch::new(ContactLaw::new(law(0.0, 1.0)).unwrap());
    let shape = batch.add_shape(cube);
    batch.add_body(shape).unwrap();
    let motion = moving(&Frame::identity());
    let message = batch.update(&[motion], &[], 0.0).unwrap_err().to_string();
    assert!(
        message.contains("adhesion_energy = 1") && message.contains("spheres"),
        "{message}"
    );
    batch.set_laws(ContactLaw::new(law(1.0, 0.0)).unwrap());
    batch.update(&[motion], &[], 0.0).unwrap();
    let soft = DeformableShape::new(&cube_mesh(1)).unwrap();
    let soft = batch.add_deformable_shape(soft);
    batch.add_deformable(soft, Modulus::Penalty(1.0)).unwrap();
    let motions = [motion, Motion::fixed(Frame::identity())];
    let message = batch.update(&motions, &[], 0.0).unwrap_err().to_string();
    assert!(message.contains("deformable"), "{message}");
}
