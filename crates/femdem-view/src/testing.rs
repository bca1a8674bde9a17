//! A small pack for the tests of this crate.

use femdem_analysis::{ContactClass, Region};
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::{Point3, Pose, Vector3};

use crate::{
    Body, BodyValues, Colouring, ContactRow, CrackFacet, CrackMode, NamedShape, Partner, Snapshot,
};

/// Two cubes of side 1 m, one on the other, on a floor.
pub(crate) fn two_cubes() -> Snapshot {
    let cube = CatalogueShape::from(Solid::P5)
        .polyhedron(3.0_f64.sqrt())
        .unwrap();
    let body = |sequence: u32| Body {
        shape: 0,
        pose: Pose::translation(0.25, 0.0, 0.5 + f64::from(sequence)),
        sequence,
        sleeping: sequence == 1,
    };
    let contact = |partner, z, up: f64, normal_force, friction| ContactRow {
        body: 0,
        partner,
        point: Point3::new(0.25, 0.0, z),
        normal: Vector3::z() * up,
        normal_force,
        friction: Vector3::x() * friction,
        moment: Vector3::zeros(),
        area: 1.0,
        volume: 0.001,
        class: ContactClass::FaceFace,
        patch: 0,
    };
    Snapshot {
        shapes: vec![NamedShape {
            name: "P5".to_owned(),
            polyhedron: cube,
        }],
        bodies: vec![body(0), body(1)],
        contacts: vec![
            contact(Partner::Body(1), 1.0, 1.0, 10.0, 0.0),
            contact(Partner::Wall("floor".to_owned()), 0.0, -1.0, 20.0, 5.0),
        ],
        container: Some(Region::Box {
            min: Point3::new(-1.0, -1.0, 0.0),
            max: Point3::new(1.5, 1.0, 3.0),
        }),
        ..Snapshot::default()
    }
}

/// The values of the usual picture.
pub(crate) fn by_sequence(snapshot: &Snapshot) -> BodyValues {
    Colouring::Sequence.values(snapshot, None).unwrap().unwrap()
}

/// A facet at a height z.
pub(crate) fn crack(z: f64) -> CrackFacet {
    CrackFacet {
        body: 1,
        points: [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]].map(Point3::from),
        opening: 1e-4,
        slip: 2e-5,
        damage: 1.0,
        mode: CrackMode::Tension,
        birth: 1e-3,
        dissipated: 0.5,
    }
}
