//! Refusals of a world, and its report of a simulation that has blown up.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{DENSITY, add_floor, at, half_edge, parameters, solid, weightless};
use femdem_contact::Partner;
use femdem_contact::deform::DeformableKernel;
use femdem_contact::kernel::CavityKernel;
use femdem_contact::{GeneralKernel, PairKernel, Wall};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::nalgebra::{Quaternion, Unit, Vector3};
use femdem_mesh::{Point3, Polyhedron, Pose, TetMesh};
use femdem_solve::checkpoint::{checksum, decode, encode, read_file, write_file};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, SolveError, World, WorldParameters,
};

#[test]
fn parameters_out_of_range_are_named() {
    type Change = fn(&mut WorldParameters);
    let cases: [(&str, Change); 20] = [
        ("gravity = NaN", |p| p.gravity.x = f64::NAN),
        ("gravity = inf", |p| p.gravity.z = f64::NEG_INFINITY),
        ("penalty = -1", |p| p.contact.penalty = -1.0),
        ("penalty = NaN", |p| p.contact.penalty = f64::NAN),
        ("friction = -0.5", |p| p.contact.friction = -0.5),
        ("damping_ratio = 0.9", |p| p.contact.damping_ratio = 0.9),
        ("damping_ratio = NaN", |p| {
            p.contact.damping_ratio = f64::NAN
        }),
        ("tangential_ratio = 3", |p| p.contact.tangential_ratio = 3.0),
        ("tangential_damping = 2", |p| {
            p.contact.tangential_damping = 2.0
        }),
        ("time_step.safety = 0", |p| p.time_step.safety = 0.0),
        ("time_step.safety = 1.5", |p| p.time_step.safety = 1.5),
        ("time_step.safety = NaN", |p| p.time_step.safety = f64::NAN),
        ("time_step.largest = 0", |p| p.time_step.largest = Some(0.0)),
        ("time_step.largest = NaN", |p| {
            p.time_step.largest = Some(f64::NAN)
        }),
        ("sleeping.tolerance = 0.5", |p| p.sleeping.tolerance = 0.5),
        ("sleeping.tolerance = NaN", |p| {
            p.sleeping.tolerance = f64::NAN
        }),
        ("sleeping.window = 1", |p| p.sleeping.window = 1),
        ("medium.drag = -1", |p| p.medium.drag = -1.0),
        ("medium.drag = NaN", |p| p.medium.drag = f64::NAN),
        ("medium.local_damping = 1", |p| p.medium.local_damping = 1.0),
    ];
    for (text, change) in cases {
        let mut p = WorldParameters::default();
        change(&mut p);
        let error = World::new(p).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(text), "\"{text}\" is not in \"{error}\"");
        assert!(error.contains("must be"), "{error}");
    }
    World::new(WorldParameters::default()).unwrap();
}

fn cubes() -> (World, u32) {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    (world, shape)
}

#[test]
fn bodies_that_are_nowhere_are_refused() {
    let (mut world, shape) = cubes();
    let good = BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros()));
    let skewed = |w: f64| Unit::new_unchecked(Quaternion::new(w, 0.0, 0.0, 0.1));
    type Change<'a> = &'a dyn Fn(&mut BodySpec);
    let cases: [(&str, Change); 10] = [
        ("density = NaN", &|s| s.density = f64::NAN),
        ("density = 0", &|s| s.density = 0.0),
        ("density = -5", &|s| s.density = -5.0),
        ("density = inf", &|s| s.density = f64::INFINITY),
        ("pose.translation", &|s| {
            s.pose.translation.vector.y = f64::NAN
        }),
        ("velocity", &|s| s.velocity.z = f64::INFINITY),
        ("angular_velocity", &|s| s.angular_velocity.x = f64::NAN),
        ("pose.", &|s| s.pose.rotation = skewed(f64::NAN)),
        ("pose.rotation", &|s| s.pose.rotation = skewed(0.5)),
        (
            "there is no shape 7 (never added, or removed): there are 1",
            &|s| s.shape = 7,
        ),
    ];
    for (text, change) in cases {
        let mut spec = good;
        change(&mut spec);
        let error = world.add_body(spec).unwrap_err().to_string();
        assert!(error.contains(text), "\"{text}\" is not in \"{error}\"");
        let error = world
            .add_driven_body(spec, Drive::Fixed)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(text),
            "driven: \"{text}\" is not in \"{error}\""
        );
    }
    // Nothing refused remains in the world.
    assert_eq!(world.body_count(), 0);
    world.add_body(good).unwrap();
    world.step().unwrap();
}

#[test]
fn drives_that_lead_nowhere_are_refused() {
    let (mut world, shape) = cubes();
    let floor = add_floor(&mut world, Drive::Fixed);
    let nan = f64::NAN;
    let stroke = Vector3::z();
    let cases = [
        (
            "drive.velocity",
            Drive::Linear {
                velocity: stroke * nan,
                start: 0.0,
                end: 1.0,
            },
        ),
        (
            "drive.start",
            Drive::Linear {
                velocity: stroke,
                start: nan,
                end: 1.0,
            },
        ),
        (
            "drive.end = 1",
            Drive::Linear {
                velocity: stroke,
                start: 2.0,
                end: 1.0,
            },
        ),
        (
            "drive.stroke",
            Drive::Shake {
                stroke: stroke * nan,
                frequency: 1.0,
                start: 0.0,
                periods: 1,
            },
        ),
        (
            "drive.frequency = 0",
            Drive::Shake {
                stroke,
                frequency: 0.0,
                start: 0.0,
                periods: 1,
            },
        ),
        (
            "drive.frequency = NaN",
            Drive::Tap {
                stroke,
                frequency: nan,
                start: 0.0,
                interval: 1.0,
                taps: 1,
            },
        ),
        (
            "drive.interval = 0.1",
            Drive::Tap {
                stroke,
                frequency: 1.0,
                start: 0.0,
                interval: 0.1,
                taps: 1,
            },
        ),
    ];
    for (text, drive) in cases {
        let error = world.drive_wall(floor, drive).unwrap_err().to_string();
        assert!(error.contains(text), "\"{text}\" is not in \"{error}\"");
        let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros()));
        assert!(world.add_driven_body(spec, drive).is_err(), "{text}");
    }
    let error = world.drive_wall(3, Drive::Fixed).unwrap_err().to_string();
    assert!(
        error.contains("there is no wall 3 (never added, or removed): there are 1"),
        "{error}"
    );
}

#[test]
fn shapes_without_a_gauge_are_refused_with_advice() {
    let (mut world, _) = cubes();
    // A cube with a pyramid-shaped dent in one face.
    let cube = solid("P5");
    let mut vertices = cube.vertices().to_vec();
    let mut faces: Vec<Vec<u32>> = cube.faces().map(<[u32]>::to_vec).collect();
    let face = faces.pop().unwrap();
    let middle = face
        .iter()
        .map(|&v| vertices[v as usize].coords)
        .sum::<Vector3<f64>>()
        / 4.0;
    vertices.push(Point3::from(middle * 0.5));
    let tip = vertices.len() as u32 - 1;
    faces.extend((0..4).map(|k| vec![face[k], face[(k + 1) % 4], tip]));
    let dented = Polyhedron::new(vertices, faces).unwrap();
    let error = world.add_shape("dented", &dented).unwrap_err().to_string();
    assert!(
        error.contains("not convex") && error.contains("convex hull"),
        "{error}"
    );
    assert_eq!(world.shapes().len(), 1);
}

/// Steps until the world fails; it must not panic on the way.
fn failure(world: &mut World, most: u32) -> SolveError {
    for _ in 0..most {
        if let Err(error) = world.step() {
            return error;
        }
    }
    panic!("nothing failed in {most} steps");
}

/// The step adapts to the speed a body is added with.
#[test]
fn a_body_launched_fast_takes_short_steps() {
    let (mut world, shape) = cubes();
    let mut fast = BodySpec::at_rest(shape, DENSITY, at(Vector3::x() * 3.0));
    fast.velocity.x = 1e4;
    let body = world.add_body(fast).unwrap();
    for _ in 0..10 {
        world.step().unwrap();
    }
    let want = 3.0 + 1e4 * world.time();
    assert!((world.position(body).unwrap().x - want).abs() < 1e-9 * want);
}

#[test]
fn a_body_that_becomes_too_fast_is_named() {
    let parameters = WorldParameters {
        gravity: Vector3::x() * 1e9,
        ..WorldParameters::default()
    };
    let mut world = World::new(parameters).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros())))
        .unwrap();
    let error = failure(&mut world, 10);
    assert!(
        matches!(error, SolveError::BlowUp { body: 0, .. }),
        "{error}"
    );
    let text = error.to_string();
    for part in [
        "blew up at step",
        "body 0",
        "time_step.largest",
        "quarter of its radius",
    ] {
        assert!(text.contains(part), "\"{part}\" is not in \"{text}\"");
    }
}

/// A soft block that falls fast moves through a thin plate in one of its long steps: that is said.
#[test]
fn a_deformable_body_that_becomes_too_fast_is_named() {
    let parameters = WorldParameters {
        gravity: Vector3::x() * 1e5,
        ..WorldParameters::default()
    };
    let mut world = World::new(parameters).unwrap();
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(0.1)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1.0, 0.3).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let stiffness = ContactStiffness::default();
    let model = world.add_model("soft", model, stiffness).unwrap();
    world
        .add_deformable(DeformableSpec::at_rest(model, at(Vector3::zeros())))
        .unwrap();
    let error = failure(&mut world, 1000);
    assert!(
        matches!(error, SolveError::BodyFailed { body: 0, .. }),
        "{error}"
    );
    let text = error.to_string();
    for part in ["body 0", "of its depth", "time_step.largest"] {
        assert!(text.contains(part), "\"{part}\" is not in \"{text}\"");
    }
}

/// Bodies added overlapping, with a penalty that makes them explode.
#[test]
fn bodies_added_into_each_other_are_named() {
    let mut p = weightless(1e12, 0.0, 0.0);
    p.time_step.safety = 1.0;
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    for k in 0..4 {
        let place = Vector3::new(0.13, 0.21, 0.4) * (f64::from(k) * half_edge());
        world
            .add_body(BodySpec::at_rest(shape, DENSITY, at(place)))
            .unwrap();
    }
    let error = failure(&mut world, 2000);
    let SolveError::BlowUp { body, cause, .. } = &error else {
        panic!("{error}");
    };
    assert!(*body < 4);
    assert!(
        cause.contains("overlapped when they were added") && cause.contains("penalty"),
        "{cause}"
    );
}

/// A law that is made a million times stiffer under load: either the step follows it, or the failure is
/// reported; no number becomes non-finite silently.
#[test]
fn a_law_changed_under_load() {
    let (mut world, shape) = cubes();
    add_floor(&mut world, Drive::Fixed);
    world
        .add_body(BodySpec::at_rest(
            shape,
            DENSITY,
            at(Vector3::z() * half_edge()),
        ))
        .unwrap();
    for _ in 0..200 {
        world.step().unwrap();
    }
    let soft = world.time_step();
    let mut law = world.parameters().contact;
    law.penalty *= 1e6;
    world.set_contact(law).unwrap();
    for _ in 0..2000 {
        match world.step() {
            Ok(()) => assert!(world.position(0).unwrap().iter().all(|x| x.is_finite())),
            Err(error) => {
                assert!(matches!(error, SolveError::BlowUp { .. }), "{error}");
                break;
            }
        }
    }
    assert!(world.time_step() < 0.1 * soft);
    law.friction = -1.0;
    assert!(
        world
            .set_contact(law)
            .unwrap_err()
            .to_string()
            .contains("friction = -1")
    );
}

#[test]
fn bytes_that_hold_no_world_are_refused() {
    let (world, _) = cubes();
    let bytes = world.to_bytes().unwrap();
    assert_eq!(
        World::from_bytes(&bytes).unwrap().state_hash().unwrap(),
        world.state_hash().unwrap()
    );
    for cut in [0, 1, bytes.len() / 2, bytes.len() - 1] {
        let error = World::from_bytes(&bytes[..cut]).map(|_| ()).unwrap_err();
        assert!(
            error.to_string().contains("could not be decoded"),
            "{error}"
        );
    }
    for at in (0..bytes.len()).step_by(7) {
        let mut altered = bytes.clone();
        altered[at] ^= 1 << (at % 8);
        assert!(World::from_bytes(&altered).is_err(), "{at}");
    }
    let mut long = bytes;
    long.push(0);
    assert!(World::from_bytes(&long).is_err());
}

/// Bytes that were altered and given a right checksum make a world that can be stepped, or none: lengths and indices fit
/// together, if not the numbers.
#[test]
fn altered_bytes_with_a_right_checksum_do_not_panic() {
    let (mut world, shape) = cubes();
    let stroke = Vector3::z() * 1e-4;
    let shake = Drive::Shake {
        stroke,
        frequency: 50.0,
        start: 0.0,
        periods: 2,
    };
    add_floor(&mut world, shake);
    let side = half_edge();
    for z in [0.999 * side, 2.998 * side] {
        let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * z));
        world.add_body(spec).unwrap();
    }
    for _ in 0..5 {
        world.step().unwrap();
    }
    let bytes = world.to_bytes().unwrap();
    let (state, _) = bytes.split_last_chunk::<8>().unwrap();
    let mut refused = 0;
    for place in 0..state.len() {
        let mut altered = state.to_vec();
        altered[place] ^= 1 << (place % 8);
        let sum = checksum(&altered).to_le_bytes();
        altered.extend_from_slice(&sum);
        match World::from_bytes(&altered) {
            // Whether it is a good step is another matter.
            Ok(mut world) => drop(world.step()),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 600, "{refused} of {}", state.len());
}

/// A world that was read as a part of something else and not restored reports this from every method.
#[test]
fn a_world_that_was_not_restored_is_refused() {
    let (mut world, shape) = cubes();
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, Pose::identity()))
        .unwrap();
    add_floor(&mut world, Drive::Fixed);
    let mesh = TetMesh::block([1, 1, 1], &Vector3::repeat(0.1)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e6, 0.0).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let soft = ContactStiffness::Law;
    let id = world.add_model("soft", model.clone(), soft).unwrap();
    let far = DeformableSpec::at_rest(id, at(Vector3::x() * 5.0));
    world.add_deformable(far.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part");
    write_file(&path, "part", &world).unwrap();
    let read = || read_file::<World>(&path, "part").unwrap();
    let (contact, medium) = (world.parameters().contact, world.parameters().medium);
    type Ask<'a> = &'a dyn Fn(&mut World) -> Result<(), SolveError>;
    let asked: [Ask; 10] = [
        &|w| w.set_load(0, femdem_contact::Wrench::default()),
        &|w| w.set_load(1, femdem_contact::Wrench::default()),
        &|w| w.drive_wall(0, Drive::Fixed),
        &|w| w.remove_body(0),
        &|w| w.step(),
        &|w| w.set_medium(medium),
        &|w| w.set_contact(contact),
        &|w| w.add_shape("P1", &solid("P1")).map(|_| ()),
        &|w| w.add_model("soft", model.clone(), soft).map(|_| ()),
        &|w| w.add_deformable(far.clone()).map(|_| ()),
    ];
    for ask in asked {
        let error = ask(&mut read()).unwrap_err().to_string();
        assert!(error.contains("shape"), "{error}");
        let mut whole = read();
        whole.restore().unwrap();
        ask(&mut whole).unwrap();
    }
}

/// A misspelt key in a text with parameters is an error that names it, not a default.
#[test]
fn keys_that_mean_nothing_are_refused() {
    let known = serde_json::to_value(WorldParameters::default()).unwrap();
    assert!(serde_json::from_value::<WorldParameters>(known.clone()).is_ok());
    for part in ["", "/contact", "/time_step", "/sleeping", "/medium"] {
        let mut misspelt = known.clone();
        misspelt.pointer_mut(part).unwrap()["largets"] = 1e-3.into();
        let error = serde_json::from_value::<WorldParameters>(misspelt).unwrap_err();
        assert!(error.to_string().contains("largets"), "{part}: {error}");
    }
    let drive = r#"{"turn": {"axis": [0, 0, 1], "point": [0, 0, 0], "rate": 1, "start": 0, "end": 1, "speed": 2}}"#;
    let error = serde_json::from_str::<Drive>(drive).unwrap_err();
    assert!(error.to_string().contains("speed"), "{error}");
}

/// A weightless world and a model of a cube of linear tetrahedra in it.
fn soft_world() -> (World, u32) {
    let mut world = World::new(weightless(1e6, 0.5, 0.0)).unwrap();
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(0.1)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e6, 0.3).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let soft = ContactStiffness::default();
    let id = world.add_model("soft", model, soft).unwrap();
    (world, id)
}

/// Values that are read are checked like those that are constructed: walls, kernels, boundaries.
#[test]
fn what_is_read_is_checked() {
    let wall = Wall::cylinder("mantle", 0.3, 7).unwrap();
    assert_eq!(decode::<Wall>(&encode(&wall).unwrap()).unwrap(), wall);
    let long = r#"{"name":"w","planes":[{"normal":[0,0,2],"offset":1}]}"#;
    let wall: Wall = serde_json::from_str(long).unwrap();
    assert_eq!(wall, Wall::half_space("w", Vector3::z(), 0.5).unwrap());
    let error = |text: &str| serde_json::from_str::<Wall>(text).unwrap_err().to_string();
    assert!(error(r#"{"name":"w","planes":[]}"#).contains("0 planes"));
    assert!(error(r#"{"name":"w","planes":[{"normal":[0,0,0],"offset":1}]}"#).contains("plane 0"));

    let broken = [
        serde_json::from_str::<PairKernel>(r#"{"penalty":-1.0}"#).err(),
        serde_json::from_str::<CavityKernel>(r#"{"penalty":0.0}"#).err(),
        serde_json::from_str::<GeneralKernel>(r#"{"penalty":1e200}"#).err(),
    ];
    for error in broken {
        assert!(error.unwrap().to_string().contains("penalty"));
    }
    let kernel = DeformableKernel::default();
    let text = serde_json::to_string(&kernel).unwrap();
    assert_eq!(
        serde_json::from_str::<DeformableKernel>(&text).unwrap(),
        kernel
    );
    let unknown = text.replace("mirror", "soft");
    assert!(serde_json::from_str::<DeformableKernel>(&unknown).is_err());
}

/// A quaternion whose length is 1 only to 1e-6 stretches nothing.
#[test]
fn nearly_unit_quaternions_stretch_nothing() {
    let (mut world, model) = soft_world();
    let unit = Unit::new_normalize(Quaternion::new(0.0, 0.3, 0.9, 0.2));
    let long = Unit::new_unchecked(unit.into_inner() * (1.0 + 9e-7));
    let pose = Pose::from_parts(Translation3::identity(), long);
    let soft = world
        .add_deformable(DeformableSpec::at_rest(model, pose))
        .unwrap();
    let stresses = world.deformable(soft).unwrap().stresses().unwrap();
    let most = stresses.iter().map(|s| s.von_mises() + s.pressure().abs());
    // Compared with E = 1e6 Pa.
    assert!(most.fold(0.0, f64::max) < 1e-8);
    let shape = world.add_shape("cube", &solid("P5")).unwrap();
    let rigid = world
        .add_body(BodySpec::at_rest(shape, DENSITY, pose))
        .unwrap();
    let length = world.pose(rigid).unwrap().rotation.norm();
    assert!((length - 1.0).abs() < 1e-15, "{length}");
}

/// Initial friction is accepted only for existing bodies, and if finite.
#[test]
fn friction_to_begin_with_is_checked() {
    let (mut world, model) = soft_world();
    add_floor(&mut world, Drive::Fixed);
    let body = world.add_deformable(DeformableSpec::at_rest(model, Pose::identity()));
    let body = body.unwrap();
    let floor = Partner::Wall(0);
    let mut begin = |a, b, force: f64, torsion| {
        let begun = world.begin_friction(a, b, Vector3::repeat(force), torsion);
        begun.map_err(|e| e.to_string())
    };
    assert_eq!(begin(floor, body, 1.0, 0.0), Ok(()));
    for (force, torsion) in [(f64::NAN, 0.0), (f64::INFINITY, 0.0), (1.0, f64::NAN)] {
        assert!(begin(floor, body, force, torsion).is_err());
    }
    for (a, b) in [
        (Partner::Wall(7), body),
        (Partner::Body(4), body),
        (floor, 9),
    ] {
        let error = begin(a, b, 1.0, 0.0).unwrap_err();
        assert!(error.contains("body") || error.contains("wall"), "{error}");
    }
}
