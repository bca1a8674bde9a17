//! Selections, supports, loads, mass scaling.

use super::*;
use femdem_fem::{Boundary, Curve, DeformableBody, Selection};
use femdem_fem::{Drive, FemError};

fn plane(axis: usize, offset: f64) -> Selection {
    let mut normal = Vector3::zeros();
    normal[axis] = 2.0;
    Selection::Plane {
        normal,
        offset,
        tolerance: 1e-9,
    }
}

fn block(element: Element) -> Arc<DeformableModel> {
    let mesh = TetMesh::block([4, 2, 2], &Vector3::new(0.4, 0.2, 0.2)).unwrap();
    Arc::new(model(&mesh, element, neo_hookean(1e6, 0.3)))
}

#[test]
fn nodes_are_picked_by_place_and_name() {
    let model = block(Element::T10);
    let mut boundary = Boundary::default();
    let none = Default::default();
    let count = |s: &Selection| model.select(s, &none).unwrap().len();
    // A grid of 9 x 5 x 5 nodes, all middles included.
    assert_eq!(count(&Selection::All), 225);
    assert_eq!(count(&Selection::Skin), 225 - 7 * 3 * 3);
    assert_eq!(count(&plane(0, 0.4)), 25);
    let corner = Selection::Box {
        lower: Vector3::repeat(-1.0),
        upper: Vector3::repeat(0.1),
    };
    assert_eq!(count(&corner), 27);
    let ball = Selection::Sphere {
        centre: Vector3::zeros(),
        radius: 0.051,
    };
    assert_eq!(count(&ball), 4);
    assert_eq!(count(&Selection::Nodes(vec![7, 3, 7])), 2);
    assert_eq!(model.select_by(|x| x.y > 0.19).len(), 45);
    boundary.name_set("end", &model, &plane(0, 0.0)).unwrap();
    let named = Selection::Named("end".into());
    assert_eq!(
        boundary.fix(&model, &named, [true, false, true]).unwrap(),
        25
    );
    assert_eq!(boundary.held().count(), 50);
    // The same component again is not counted twice.
    boundary.fix(&model, &corner, [true; 3]).unwrap();
    assert_eq!(boundary.held().count(), 50 + 27 * 3 - 9 * 2);

    assert!(matches!(
        boundary.fix(&model, &Selection::Named("front".into()), [true; 3]),
        Err(FemError::NoSuchSet { .. })
    ));
    assert!(matches!(
        boundary.press(&model, &plane(0, 0.123), 1.0),
        Err(FemError::NothingSelected { .. })
    ));
    assert!(matches!(
        boundary.fix(&model, &Selection::Nodes(vec![225]), [true; 3]),
        Err(FemError::NoSuch { .. })
    ));
    assert!(boundary.press(&model, &Selection::Skin, f64::NAN).is_err());
    let unsorted = Curve::Table(vec![[1.0, 0.0], [1.0, 1.0]]);
    assert!(boundary.press(&model, &Selection::Skin, unsorted).is_err());
}

#[test]
fn curves() {
    let ramp = Curve::Ramp {
        value: 4.0,
        rise: 2.0,
    };
    assert_eq!(
        [-1.0, 0.0, 0.5, 2.0, 9.0].map(|t| ramp.at(t)),
        [0.0, 0.0, 1.0, 4.0, 4.0]
    );
    let table = Curve::Table(vec![[0.0, 1.0], [1.0, 3.0], [3.0, -1.0]]);
    assert_eq!(
        [-1.0, 0.5, 1.0, 2.0, 3.0, 4.0].map(|t| table.at(t)),
        [1.0, 2.0, 3.0, 1.0, -1.0, -1.0]
    );
}

fn volume(model: &DeformableModel, x: &[Vector3]) -> f64 {
    let stresses = model.stresses(x, &[]).unwrap();
    stresses
        .iter()
        .zip(model.volumes())
        .map(|(s, v)| s.volume_ratio * v)
        .sum()
}

/// Pressure all around is minus p times the gradient of the volume, curved faces included (the volume is
/// computed inside the elements, by another rule). Traction sums to itself times the area, weight to mass
/// times g.
#[test]
fn loads_are_what_they_say() {
    for element in [Element::T4, Element::T10] {
        let model = block(element);
        let x = placed(&model, &strained(), 0.004);
        let mut boundary = Boundary::default();
        boundary.press(&model, &Selection::Skin, 50.0).unwrap();
        let mut f = vec![Vector3::zeros(); x.len()];
        boundary.add_forces(&model, 0.0, &x, &mut f).unwrap();
        let along: Vec<Vector3> = (0..x.len()).map(|i| noisy(i, 70)).collect();
        let moved =
            |h: f64| -> Vec<Vector3> { x.iter().zip(&along).map(|(x, d)| x + d * h).collect() };
        let slope = (volume(&model, &moved(1e-6)) - volume(&model, &moved(-1e-6))) / 2e-6;
        let work: f64 = f.iter().zip(&along).map(|(f, d)| f.dot(d)).sum();
        // The four-point rule of the volume is exact only for straight edges.
        let allowed = if element == Element::T4 { 1e-8 } else { 0.02 };
        assert!(
            (work / (-50.0 * slope) - 1.0).abs() < allowed,
            "{element:?}: {work} {slope}"
        );
        // A closed surface under pressure has no resultant, however curved: exact.
        let sum: Vector3 = f.iter().sum();
        assert!(sum.norm() < 1e-13 * largest(&f) * f.len() as f64);
        let moment: Vector3 = x.iter().zip(&f).map(|(x, f)| x.cross(f)).sum();
        assert!(moment.norm() < 1e-12 * largest(&f));

        let mut boundary = Boundary::new(Vector3::new(0.0, 0.0, -10.0)).unwrap();
        let pull = Vector3::new(3.0, 0.0, 1.0);
        assert_eq!(boundary.pull(&model, &plane(0, 0.4), pull, 2.0).unwrap(), 8);
        let mut f = vec![Vector3::zeros(); x.len()];
        boundary.add_forces(&model, 0.0, &x, &mut f).unwrap();
        let sum: Vector3 = f.iter().sum();
        let expected = pull * (2.0 * 0.04) + Vector3::new(0.0, 0.0, -10.0 * 16.0);
        assert!((sum - expected).norm() < 1e-10, "{sum}");
    }
}

/// A block pulled apart at its ends at a slow rate: the supports' work is the stored energy, which is that of
/// uniaxial stress, E e^2 V / 2, to the order of the strain.
#[test]
fn supports_do_work() {
    for element in ELEMENTS {
        let model = block(element);
        let mut boundary = Boundary::default();
        boundary
            .fix(&model, &plane(0, 0.0), [true, false, false])
            .unwrap();
        boundary
            .fix(&model, &plane(1, 0.0), [false, true, false])
            .unwrap();
        boundary
            .fix(&model, &plane(2, 0.0), [false, false, true])
            .unwrap();
        let (strain, duration) = (0.002, 0.4);
        let draw = Drive::Linear {
            velocity: Vector3::new(0.4 * strain / duration, 0.0, 0.0),
            start: 0.0,
            end: duration,
        };
        boundary
            .drive(&model, &plane(0, 0.4), [true, false, false], draw)
            .unwrap();
        let mut body = DeformableBody::new(model.clone(), boundary).unwrap();
        let dt = 0.8 * body.critical_step().unwrap();
        while body.time() < duration {
            body.step(dt).unwrap();
        }
        let ledger = body.ledger();
        let expected = 0.5 * 1e6 * strain * strain * 0.016;
        assert!(
            (ledger.support_work / expected - 1.0).abs() < 0.02,
            "{element:?}: {ledger:?}"
        );
        assert!(
            (ledger.elastic / expected - 1.0).abs() < 0.02,
            "{element:?}: {ledger:?}"
        );
        assert!(
            ledger.error_relative().abs() < 2e-3,
            "{element:?}: {ledger:?}"
        );
        // The sides have contracted by Poisson's ratio.
        let corner = model.select_by(|x| (x - Vector3::new(0.4, 0.2, 0.2)).norm() < 1e-9);
        let moved = body.state().x[corner[0] as usize];
        assert!((moved.x - 0.4 * (1.0 + strain)).abs() < 1e-9);
        assert!(
            ((0.2 - moved.y) / (0.2 * 0.3 * strain) - 1.0).abs() < 0.05,
            "{moved}"
        );
    }
}

/// Driven nodes follow a rotation, and the body follows them.
#[test]
fn driven_nodes_turn() {
    let model = block(Element::T4);
    let mut boundary = Boundary::default();
    let turn = Drive::Turn {
        axis: Vector3::z(),
        point: Vector3::zeros(),
        rate: 1.0,
        start: 0.0,
        end: 1.0,
    };
    boundary
        .drive(&model, &Selection::All, [true; 3], turn)
        .unwrap();
    let mut body = DeformableBody::new(model.clone(), boundary).unwrap();
    for _ in 0..100 {
        body.step(0.01).unwrap();
    }
    let (s, c) = 1.0_f64.sin_cos();
    for (x, reference) in body.state().x.iter().zip(model.nodes()) {
        let place = Vector3::new(
            c * reference.x - s * reference.y,
            s * reference.x + c * reference.y,
            reference.z,
        );
        assert!((x - place).norm() < 1e-12);
    }
    assert!(body.ledger().elastic.abs() < 1e-12);
    assert!(body.ledger().error_relative().abs() < 1e-9);
}

/// Scaling adds the stated mass where elements are small, and the step becomes the requested one.
#[test]
fn mass_scaling_reaches_the_step() {
    let mesh = crooked();
    for element in ELEMENTS {
        let plain = model(&mesh, element, neo_hookean(1e6, 0.3));
        let x = plain.nodes().to_vec();
        let own = plain.stable_frequency2(&x, &[]).unwrap().critical_step();
        let mass: f64 = plain.masses().iter().sum();
        let scaled = plain.clone().with_mass_scaling(1.5 * own).unwrap();
        let step = scaled.stable_frequency2(&x, &[]).unwrap().critical_step();
        assert!((step / (1.5 * own) - 1.0).abs() < 1e-12);
        let scaled_mass: f64 = scaled.masses().iter().sum();
        assert!(scaled.added_mass() > 0.0 && scaled.added_mass() < 1.25 * mass);
        assert!((scaled_mass - mass - scaled.added_mass()).abs() < 1e-12 * mass);
        // A step below the critical one: nothing is added.
        let same = plain.clone().with_mass_scaling(0.9 * own).unwrap();
        assert_eq!(same.masses(), plain.masses());
        assert_eq!(same.added_mass(), 0.0);
        assert!(plain.clone().with_mass_scaling(1e200).is_err());
        assert!(plain.with_mass_scaling(0.0).is_err());
    }
}

/// Models and boundaries survive being written and read.
#[test]
fn models_and_boundaries_are_serialised() {
    let model = two_regions(&crooked(), Element::T10Fbar)
        .with_mass_scaling(1e-3)
        .unwrap();
    let mut boundary = Boundary::new(Vector3::new(0.0, 0.0, -9.81)).unwrap();
    boundary
        .fix(&model, &Selection::Skin, [true, false, true])
        .unwrap();
    boundary
        .press(
            &model,
            &Selection::Skin,
            Curve::Ramp {
                value: 1.0,
                rise: 0.1,
            },
        )
        .unwrap();
    let layout = bincode::config::standard();
    let bytes = bincode::serde::encode_to_vec((&model, &boundary), layout).unwrap();
    let (both, _) = bincode::serde::decode_from_slice(&bytes, layout).unwrap();
    let (mut read, back): (DeformableModel, Boundary) = both;
    assert_eq!(boundary, back);
    // The second law is known by name alone until it is bound.
    let law: Arc<dyn Material> = Arc::new(Split {
        shear: 4e5,
        bulk: 2e6,
        viscosity: 0.0,
    });
    let x = placed(&model, &strained(), 0.01);
    let unbound = read.stresses(&x, &[]).unwrap_err().to_string();
    assert!(unbound.contains("split"), "{unbound}");
    read.bind(&[law]).unwrap();
    assert_eq!(forces(&model, &x), forces(&read, &x));
    assert_eq!(model.masses(), read.masses());
    let text = serde_json::to_string(&model).unwrap();
    assert!(serde_json::from_str::<DeformableModel>(&text).is_ok());
    let broken = text.replacen("\"density\":1000.0", "\"density\":-1.0", 1);
    assert!(serde_json::from_str::<DeformableModel>(&broken).is_err());
    // Indices of drives and directions that do not exist.
    let text = serde_json::to_string(&boundary).unwrap();
    assert!(serde_json::from_str::<Boundary>(&text).is_ok());
    for (good, bad) in [
        ("\"drive\":0", "\"drive\":9"),
        ("\"component\":0", "\"component\":3"),
        ("\"rise\":0.1", "\"rise\":0.0"),
        ("\"ramp\":{\"value\":1.0,\"rise\":0.1}", "\"table\":[]"),
        ("\"faces\":[[", "\"faces\":[[0],["),
        ("-9.81", "1e999"),
    ] {
        let broken = text.replacen(good, bad, 1);
        assert_ne!(broken, text);
        assert!(serde_json::from_str::<Boundary>(&broken).is_err(), "{bad}");
    }
}
