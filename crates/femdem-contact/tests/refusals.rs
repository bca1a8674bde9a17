//! Bodies, walls and updates that are refused, and the error messages.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::{
    BodyShape, ContactBatch, ContactError, ContactLaw, ContactParameters, ConvexShape, Field,
    FieldMesh, Frame, Motion, PairKernel, Wall, WallPlane,
};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::{Point3, Polyhedron, TetMesh};
use std::sync::Arc;

/// A prism over a polygon in the xy plane, counter-clockwise, from z = 0 to `height`.
fn prism(outline: &[[f64; 2]], height: f64) -> Polyhedron {
    let n = outline.len() as u32;
    let level = |z: f64| outline.iter().map(move |p| Point3::new(p[0], p[1], z));
    let vertices = level(0.0).chain(level(height)).collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    Polyhedron::new(vertices, faces).unwrap()
}

#[test]
fn a_body_with_a_notch_is_refused_with_advice() {
    let notched = prism(
        &[
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ],
        1.0,
    );
    let error = ConvexShape::new(&notched).unwrap_err();
    assert_eq!(error, ContactError::NotConvex);
    let text = error.to_string();
    assert!(
        text.contains("not convex") && text.contains("convex hull"),
        "{text}"
    );
}

#[test]
fn a_sheet_is_refused_with_its_face() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    ConvexShape::new(&prism(&square, 1e-5)).unwrap();
    let text = ConvexShape::new(&prism(&square, 1e-7))
        .unwrap_err()
        .to_string();
    assert!(
        text.contains("too thin") && text.contains("5e-8 m"),
        "{text}"
    );
}

#[test]
fn an_inside_out_body_never_becomes_a_shape() {
    let cube = "P5"
        .parse::<CatalogueShape>()
        .unwrap()
        .polyhedron(1.0)
        .unwrap();
    let reversed = cube
        .faces()
        .map(|f| f.iter().rev().copied().collect())
        .collect();
    let text = Polyhedron::new(cube.vertices().to_vec(), reversed)
        .unwrap_err()
        .to_string();
    assert!(text.contains("inside out"), "{text}");
}

#[test]
fn walls_that_mean_nothing_are_refused_by_name() {
    let nan = f64::NAN;
    let refused = |wall: Result<Wall, ContactError>| wall.unwrap_err().to_string();
    let text = refused(Wall::new("mantle", vec![]));
    assert!(
        text.contains("\"mantle\"") && text.contains("0 planes"),
        "{text}"
    );
    for normal in [
        Vector3::zeros(),
        Vector3::new(nan, 0.0, 1.0),
        Vector3::repeat(f64::INFINITY),
    ] {
        let text = refused(Wall::half_space("floor", normal, 0.0));
        assert!(
            text.contains("\"floor\"") && text.contains("plane 0"),
            "{text}"
        );
    }
    assert!(refused(Wall::half_space("floor", Vector3::z(), nan)).contains("offset NaN"));
    // The offset of the plane overflows.
    let short = Vector3::x() * 1e-150;
    assert!(refused(Wall::half_space("floor", short, 1e200)).contains("plane 0"));
    let many = vec![
        WallPlane {
            normal: Vector3::z(),
            offset: 0.0
        };
        65_536
    ];
    assert!(refused(Wall::new("many", many)).contains("65536 planes"));
    for (radius, facets) in [
        (0.0, 96),
        (-1.0, 96),
        (nan, 96),
        (1.0, 2),
        (1.0, usize::MAX),
    ] {
        let text = refused(Wall::cylinder("mantle", radius, facets));
        assert!(
            text.contains("\"mantle\"") && text.contains("3 to 65535 facets"),
            "{text}"
        );
    }
    for high in [
        Vector3::new(1.0, 0.0, 1.0),
        Vector3::new(1.0, -1.0, 1.0),
        Vector3::new(1.0, nan, 1.0),
    ] {
        let text = Wall::closed_box(Vector3::zeros(), high)
            .unwrap_err()
            .to_string();
        assert!(text.contains("box y"), "{text}");
    }
}

#[test]
fn a_penalty_that_is_no_stiffness_is_refused() {
    for penalty in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e308, 1e-300] {
        let text = PairKernel::new(penalty).unwrap_err().to_string();
        assert!(text.contains(&format!("penalty = {penalty}")), "{text}");
    }
}

#[test]
fn a_batch_refuses_what_does_not_fit_it() {
    let mut batch = ContactBatch::new(ContactLaw::new(ContactParameters::default()).unwrap());
    assert!(
        batch
            .add_body(0)
            .unwrap_err()
            .to_string()
            .contains("there is no shape 0")
    );
    let cube = "P5"
        .parse::<CatalogueShape>()
        .unwrap()
        .polyhedron(1.0)
        .unwrap();
    let shape = batch.add_shape(Arc::new(ConvexShape::new(&cube).unwrap()));
    for _ in 0..2 {
        batch.add_body(shape).unwrap();
    }
    let still = Motion::fixed(Frame::identity());
    let count = batch.update(&[still], &[], 1e-4).unwrap_err();
    assert_eq!(
        count,
        ContactError::StateCount {
            what: "body",
            given: 1,
            expected: 2
        }
    );
    let says = |batch: &mut ContactBatch, bodies: [Motion; 2], walls: &[Motion], dt: f64| {
        batch.update(&bodies, walls, dt).unwrap_err().to_string()
    };
    let spoilt: [fn(&mut Motion); 6] = [
        |m| m.frame.position.y = f64::NAN,
        |m| m.inverse_mass = f64::NAN,
        |m| m.inverse_mass = -1.0,
        |m| m.inverse_inertia[(0, 1)] = f64::INFINITY,
        |m| m.inverse_inertia_max = f64::NAN,
        |m| m.travelled = f64::NAN,
    ];
    for spoil in spoilt {
        let mut lost = still;
        spoil(&mut lost);
        let text = says(&mut batch, [still, lost], &[], 1e-4);
        assert!(text.contains("body 1 is not finite"), "{text}");
    }
    for dt in [f64::NAN, f64::INFINITY, -1e-4] {
        assert!(says(&mut batch, [still; 2], &[], dt).contains("dt = "));
    }
    let text = says(&mut batch, [still; 2], &[still], 1e-4);
    assert!(text.contains("1 wall states"), "{text}");
    // The batch can still be used.
    let mut apart = still;
    apart.frame.position.x = 5.0;
    batch.update(&[still, apart], &[], 1e-4).unwrap();
    assert!(batch.rigid_contacts().is_empty());
    assert!(
        batch
            .restore_shapes(vec![], vec![])
            .unwrap_err()
            .to_string()
            .contains("shape 0")
    );
}

/// A batch that was read takes its own shapes and no others.
#[test]
fn a_batch_that_was_read_wants_its_own_shapes() {
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let convex = ConvexShape::new(&cube.polyhedron(1.0).unwrap()).unwrap();
    let convex = BodyShape::from(convex);
    let mesh = TetMesh::block([1, 1, 1], &Vector3::repeat(1.0)).unwrap();
    let mesh = FieldMesh::new(&mesh, Vector3::repeat(0.5), Field::Body).unwrap();
    let mesh = BodyShape::from(mesh);
    let law = ContactLaw::new(ContactParameters::default()).unwrap();
    let mut batch = ContactBatch::new(law);
    for k in 0..3 {
        batch.add_shape(convex.clone());
        batch.add_body(k).unwrap();
    }
    let motions = [0.0, 0.57, 2.5].map(|x| {
        let mut motion = Motion::fixed(Frame::identity());
        motion.frame.position.x = x;
        motion
    });
    batch.update(&motions, &[], 1e-4).unwrap();
    assert_eq!(batch.rigid_contacts().len(), 1);
    let config = bincode::config::standard();
    let bytes = bincode::serde::encode_to_vec(&batch, config).unwrap();
    let read = || -> ContactBatch { bincode::serde::decode_from_slice(&bytes, config).unwrap().0 };

    let mut again = read();
    again.add_shape(convex.clone());
    let error = again.update(&motions, &[], 1e-4).unwrap_err();
    assert!(matches!(error, ContactError::NoSuch { what: "shape", .. }));
    let shapes = |last: &BodyShape| vec![convex.clone(), convex.clone(), last.clone()];
    let error = again.restore_shapes(shapes(&mesh), vec![]).unwrap_err();
    assert!(error.to_string().contains("shape of body 2"), "{error}");
    again.restore_shapes(shapes(&convex), vec![]).unwrap();
    again.update(&motions, &[], 1e-4).unwrap();
    assert_eq!(again.rigid_contacts().len(), 1);
}
