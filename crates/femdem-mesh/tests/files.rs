//! Bodies from files on disk, by the ending of their names.

use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
use femdem_mesh::tet::{MeshOptions, mesh};
use femdem_mesh::{MeshError, Pose, io};
use std::fs;
use std::path::{Path, PathBuf};

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn the_ending_tells_the_format() {
    let body = CatalogueShape::from(Solid::A1).polyhedron(0.01).unwrap();
    let (obj, stl) = (scratch("ending.OBJ"), scratch("ending.stl"));
    io::obj::write(&body, fs::File::create(&obj).unwrap()).unwrap();
    io::stl::write_binary(&body, fs::File::create(&stl).unwrap()).unwrap();
    assert_eq!(io::read_file(&obj).unwrap(), body);
    let read = io::read_file(&stl).unwrap();
    assert_eq!((read.vertices().len(), read.face_count()), (12, 8));
}

#[test]
fn errors_name_the_file() {
    let broken = scratch("broken.obj");
    fs::write(&broken, "v 0 0 zero\n").unwrap();
    let message = io::read_file(&broken).unwrap_err().to_string();
    assert!(message.contains("broken.obj: line 1"), "{message}");
    assert!(
        message.contains("\"zero\" is not a finite number"),
        "{message}"
    );

    let message = io::read_file(scratch("missing.stl"))
        .unwrap_err()
        .to_string();
    assert!(message.contains("missing.stl"), "{message}");
    for name in ["body.step", "body", ".obj"] {
        let error = io::read_file(scratch(name)).unwrap_err();
        assert!(matches!(error, MeshError::UnknownFormat { .. }), "{error}");
    }
}

#[test]
fn a_folder_is_an_error() {
    let folder = scratch("folder.obj");
    fs::create_dir_all(&folder).unwrap();
    assert!(matches!(
        io::read_file(&folder),
        Err(MeshError::InFile { .. })
    ));
}

/// A quaternion from elsewhere that is not quite of unit length does not stretch a body; one that is not a
/// rotation is refused.
#[test]
fn bodies_are_written_as_they_are_whatever_the_length_of_the_quaternion() {
    let body = CatalogueShape::from(Solid::P5).polyhedron(1.0).unwrap();
    let pose = |length: f64| {
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5);
        let mut pose = Pose::translation(0.1, 0.2, 0.3);
        pose.rotation = UnitQuaternion::new_unchecked(Quaternion::from(turn.coords * length));
        pose
    };
    let volume = body.mass_properties().volume;
    for length in [1.0, 1.0 + 9e-7, 1.0 - 9e-7] {
        let mut file = Vec::new();
        io::obj::write_posed([(&body, &pose(length))], &mut file).unwrap();
        let read = io::obj::read(&file[..]).unwrap();
        let moved = body.transformed(&pose(length)).unwrap();
        for found in [read, moved] {
            let error = found.mass_properties().volume / volume - 1.0;
            assert!(error.abs() < 1e-13, "{length}: {error:e}");
        }
    }
    for length in [0.0, 0.5, 1.1, f64::NAN] {
        let refused = io::obj::write_posed([(&body, &pose(length))], Vec::new()).unwrap_err();
        assert!(refused.to_string().contains("quaternion"), "{refused}");
    }
}

/// A file beside the tests.
fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

/// Cubes of 20 mm, each with one fault.
#[test]
fn small_faults_are_mended_on_request_and_reported() {
    for (name, done) in [
        ("inside_out.obj", "the surface was inside out"),
        ("facets_twice.obj", "2 facets given twice dropped"),
        ("loose_vertices.obj", "28 vertices joined to another"),
        ("seam.obj", "1 vertices on edges of other facets joined"),
    ] {
        let refused = io::read_file(kept(name)).unwrap_err().to_string();
        assert!(refused.contains(name), "{refused}");
        assert!(refused.contains("repair"), "{refused}");
        let (body, report) = io::read_file_with(kept(name), &io::Options::REPAIR).unwrap();
        let volume = body.mass_properties().volume;
        assert!((volume - 8e-6).abs() < 1e-12, "{name}: {volume:e}");
        assert!(report.to_string().contains(done), "{name}: {report}");
    }
}

/// A cube with a smaller one in its middle; two that share a face; two apart.
#[test]
fn several_shells_are_counted_and_refused_with_advice() {
    for options in [io::Options::default(), io::Options::REPAIR] {
        for (name, words) in [
            ("hollow.obj", ["hollow", "2 closed shells", "density"]),
            ("shared_face.obj", ["2 closed shells", "touch", "a union"]),
            (
                "two_cubes.obj",
                ["2 separate closed shells", "body", "a union"],
            ),
        ] {
            let error = io::read_file_with(kept(name), &options).unwrap_err();
            let message = error.to_string();
            for word in [name].iter().chain(&words) {
                assert!(message.contains(word), "{word}: {message}");
            }
            let MeshError::InFile { problem, .. } = error else {
                panic!("{message}");
            };
            match *problem {
                // The smaller cube has facets 6 to 11.
                MeshError::Hollow { shells, face } => {
                    assert_eq!((name, shells, face), ("hollow.obj", 2, 6));
                }
                MeshError::Touching { shells, .. } => {
                    assert_eq!((name, shells), ("shared_face.obj", 2));
                }
                MeshError::Disconnected { components } => {
                    assert_eq!((name, components), ("two_cubes.obj", 2));
                }
                other => panic!("{other}"),
            }
        }
    }
}

/// Walls of 5 mm on a bucket of 1 m: no lattice of allowed size resolves them.
#[test]
fn a_body_too_thin_for_a_lattice_is_refused_with_advice() {
    let bucket = io::read_file(kept("bucket.obj")).unwrap();
    let error = mesh(&bucket, &MeshOptions::default()).unwrap_err();
    let MeshError::TooThin { length, nodes } = error else {
        panic!("{error}");
    };
    assert!((0.0049..0.0051).contains(&length), "{length}");
    assert!(nodes > 2e7, "{nodes}");
    let message = error.to_string();
    for word in [
        "too thin",
        "thicker",
        "several bodies",
        "tetrahedra of your own",
    ] {
        assert!(message.contains(word), "{message}");
    }
}
