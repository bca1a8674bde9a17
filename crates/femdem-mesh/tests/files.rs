//! Bodies from files on disk, by the ending of their names.

use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::{MeshError, io};
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
