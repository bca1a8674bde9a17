//! A pack for the browser: bodies on a jittered lattice, with made-up contacts between neighbours.

use femdem_view::analysis::{ContactClass, Region};
use femdem_view::mesh::catalogue::{CatalogueShape, Solid};
use femdem_view::mesh::nalgebra::{Quaternion, Translation3};
use femdem_view::mesh::{Point3, Pose, Rotation, Vector3};
use femdem_view::{Body, ContactRow, NamedShape, Partner, Snapshot};

const DIAMETER: f64 = 0.05;
const SPACING: f64 = 0.9 * DIAMETER;

/// Numbers from 0 to 1 by a linear congruence (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }

    fn rotation(&mut self) -> Rotation {
        let q = Quaternion::new(
            self.signed(),
            self.signed(),
            self.signed(),
            self.signed() + 1e-3,
        );
        Rotation::from_quaternion(q)
    }
}

/// Truncated dodecahedra, `nodes` along each axis.
pub fn jittered(nodes: [u32; 3]) -> Snapshot {
    let mut random = Random(7);
    let [nx, ny, nz] = nodes;
    let polyhedron = CatalogueShape::from(Solid::A10)
        .polyhedron(DIAMETER)
        .unwrap();
    let mut bodies = Vec::new();
    for i in 0..nx * ny * nz {
        let place = [i % nx, i / nx % ny, i / (nx * ny)];
        let along =
            place.map(|k| (f64::from(k) + 0.5) * SPACING + 0.06 * DIAMETER * random.signed());
        let pose = Pose::from_parts(Translation3::from(along), random.rotation());
        bodies.push(Body {
            shape: 0,
            pose,
            sequence: i,
            sleeping: false,
        });
    }
    let mut contacts = Vec::new();
    for (i, body) in (0..).zip(&bodies) {
        let centre = Point3::from(body.pose.translation.vector);
        let last = [
            i % nx == nx - 1,
            i / nx % ny == ny - 1,
            i / (nx * ny) == nz - 1,
        ];
        for (step, end) in [1, nx, nx * ny].into_iter().zip(last) {
            if !end && random.next() < 0.85 {
                let other = Point3::from(bodies[(i + step) as usize].pose.translation.vector);
                let point = femdem_view::mesh::nalgebra::center(&centre, &other);
                let depth = f64::from(nz - i / (nx * ny));
                let row = contact(
                    i,
                    Partner::Body(i + step),
                    point,
                    (other - centre).normalize(),
                );
                let normal_force = -0.4 * depth * random.next().max(1e-9).ln();
                contacts.push(ContactRow {
                    normal_force,
                    ..row
                });
            }
        }
        if i < nx * ny {
            let point = Point3::new(centre.x, centre.y, 0.0);
            let row = contact(i, Partner::Wall("floor".to_owned()), point, -Vector3::z());
            contacts.push(ContactRow {
                normal_force: 0.5 * f64::from(nz),
                ..row
            });
        }
    }
    let [x, y, z] = nodes.map(|n| f64::from(n) * SPACING);
    Snapshot {
        masses: vec![0.13; bodies.len()],
        gravity: 9.81,
        shapes: vec![NamedShape {
            name: "A10".to_owned(),
            polyhedron,
        }],
        bodies,
        contacts,
        container: Some(Region::Box {
            min: Point3::origin(),
            max: Point3::new(x, y, z + DIAMETER),
        }),
        ..Snapshot::default()
    }
}

fn contact(body: u32, partner: Partner, point: Point3, normal: Vector3) -> ContactRow {
    ContactRow {
        body,
        partner,
        point,
        normal,
        normal_force: 0.0,
        friction: Vector3::zeros(),
        moment: Vector3::zeros(),
        area: 1e-5,
        volume: 1e-10,
        class: ContactClass::FaceFace,
        patch: 0,
    }
}
