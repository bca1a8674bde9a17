//! Bodies from files on disk, by the ending of their names.

use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
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
