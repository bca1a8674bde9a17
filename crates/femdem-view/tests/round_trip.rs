//! A pack that is written to tables and read back.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::path::Path;

use femdem_view::analysis::{ContactClass, Region};
use femdem_view::input::{InputOptions, read_folder};
use femdem_view::mesh::catalogue::CatalogueShape;
use femdem_view::mesh::{Point3, Pose, Rotation, Vector3};
use femdem_view::output::{csv, surface, write_file};
use femdem_view::{Body, ContactRow, NamedShape, Partner, Snapshot, ViewError};
use tempfile::tempdir;

/// A cube on the floor and a truncated dodecahedron on it, with names that do not suit files.
fn pack() -> Snapshot {
    let shape = |name: &str, id: &str| NamedShape {
        name: name.to_owned(),
        polyhedron: id
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(0.1)
            .unwrap(),
    };
    let body = |shape, z| Body {
        shape,
        pose: Pose::from_parts(
            Vector3::new(0.01, -0.02, z).into(),
            Rotation::from_scaled_axis(Vector3::new(0.1, 0.2, 0.3) * f64::from(shape)),
        ),
        sequence: shape,
        sleeping: shape == 0,
    };
    let contact = |partner, z, up: f64| ContactRow {
        body: 0,
        partner,
        point: Point3::new(0.01, -0.02, z),
        normal: Vector3::z() * up,
        normal_force: 1.0 / 3.0,
        friction: Vector3::new(0.01, 0.02, 0.0),
        moment: Vector3::new(0.0, 1e-5, 1e-7),
        area: 1e-3,
        volume: 1e-9,
        class: ContactClass::FaceFace,
        patch: 0,
    };
    Snapshot {
        shapes: vec![shape("cube, small", "P5"), shape("a/b", "A10")],
        bodies: vec![body(0, 0.03), body(1, 0.1)],
        contacts: vec![
            contact(Partner::Body(1), 0.06, 1.0),
            contact(Partner::Wall("the \"floor\"".to_owned()), 0.0, -1.0),
        ],
        container: Some(Region::Box {
            min: Point3::new(-0.1, -0.1, 0.0),
            max: Point3::new(0.1, 0.1, 0.3),
        }),
        masses: vec![0.2, 0.3],
        velocities: vec![Vector3::new(0.25, -1.0 / 3.0, 0.0), Vector3::zeros()],
        gravity: 9.81,
        ..Snapshot::default()
    }
}

fn write(pack: &Snapshot, folder: &Path) {
    write_file(folder.join("bodies.csv"), |w| csv::write_bodies(pack, w)).unwrap();
    write_file(folder.join("contacts.csv"), |w| {
        csv::write_contacts(pack, w)
    })
    .unwrap();
    let names: Vec<&str> = pack.shapes.iter().map(|s| s.name.as_str()).collect();
    for (shape, file) in pack.shapes.iter().zip(surface::shape_file_names(&names)) {
        write_file(folder.join(file), |w| {
            surface::write_shape_obj(&shape.polyhedron, w)
        })
        .unwrap();
    }
}

#[test]
fn a_pack_comes_back_from_its_tables() {
    let folder = tempdir().unwrap();
    let written = pack();
    write(&written, folder.path());
    let options = InputOptions {
        container: written.container,
        gravity: written.gravity,
        ..InputOptions::default()
    };
    let read = read_folder(folder.path(), &options).unwrap();
    assert_eq!(read.shapes, written.shapes);
    assert_eq!(read.contacts, written.contacts);
    for (read, written) in read.bodies.iter().zip(&written.bodies) {
        let off = written.pose.inverse() * read.pose;
        assert!(off.rotation.angle() < 1e-15 && off.translation.vector.norm() < 1e-15);
        assert_eq!(
            (read.shape, read.sequence),
            (written.shape, written.sequence)
        );
        assert_eq!(read.sleeping, written.sleeping);
    }
    assert_eq!(read.velocities, written.velocities);
    assert_eq!(
        (read.masses, read.gravity, read.container, read.gaps),
        (
            written.masses,
            written.gravity,
            written.container,
            written.gaps
        )
    );
}

#[test]
fn a_fault_of_a_table_has_its_file_and_line() {
    let folder = tempdir().unwrap();
    write(&pack(), folder.path());
    let path = folder.path().join("bodies.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("0.1,", "much,")).unwrap();
    let error = read_folder(folder.path(), &InputOptions::default()).unwrap_err();
    assert!(
        matches!(&error, ViewError::Table { line: 3, .. }),
        "{error:?}"
    );
    assert!(error.to_string().contains("z = `much`"), "{error}");
    // A body without the velocity that the other has.
    std::fs::write(&path, text.replace(",0,0,0\n", ",,,\n")).unwrap();
    let error = read_folder(folder.path(), &InputOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("1 velocities for 2 bodies"),
        "{error}"
    );
    let none = read_folder(folder.path().join("none"), &InputOptions::default()).unwrap_err();
    assert!(matches!(none, ViewError::Read { .. }), "{none:?}");
}
