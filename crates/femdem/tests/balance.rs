//! The rows of a settled pack carry the weight of every body: directions, signs and sides of the
//! forces are those of the documentation.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::analysis::{TableOptions, Tables};
use femdem::mesh::Vector3;
use femdem::pack::Packing;
use femdem::{ContactRow, Partner, Scene, Snapshot, results};

fn settled() -> (Packing, Snapshot) {
    let scene = "shape = \"A10\"\ncount = 8\nbox = \"2.2x2.2\"\npenetration = 0.02\n";
    let mut packing = Packing::new(Scene::from_toml(scene).unwrap().spec().unwrap()).unwrap();
    let report = packing.run().unwrap();
    assert!(report.settled);
    let snapshot = results::snapshot(&packing);
    (packing, snapshot)
}

#[test]
fn forces_on_every_body_balance_its_weight() {
    let (packing, snapshot) = settled();
    let gravity = Vector3::new(0.0, 0.0, -packing.spec().gravity);
    let mass = |id| packing.world().mass(id).unwrap();
    let mut net: Vec<Vector3> = (0..8).map(|id| gravity * mass(id)).collect();
    let (mut with_walls, mut with_bodies) = (0, 0);
    for row in &snapshot.contacts {
        let on_partner = row.normal * row.normal_force + row.friction;
        net[row.body as usize] -= on_partner;
        match &row.partner {
            Partner::Body(partner) => {
                net[*partner as usize] += on_partner;
                with_bodies += 1;
            }
            Partner::Wall(_) => with_walls += 1,
        }
    }
    assert!(
        with_walls >= 3 && with_bodies >= 3,
        "{with_walls} {with_bodies}"
    );
    for (id, force) in (0..).zip(&net) {
        let weight = mass(id) * packing.spec().gravity;
        assert!(
            force.norm() < 0.05 * weight,
            "body {id}: {} N of {weight} N",
            force.norm()
        );
    }
}

#[test]
fn normals_point_from_the_body_to_its_partner() {
    let (_, snapshot) = settled();
    let centre = |body: u32| {
        let body = &snapshot.bodies[body as usize];
        body.pose
            * snapshot.shapes[body.shape as usize]
                .polyhedron
                .mass_properties()
                .centroid
    };
    for row in &snapshot.contacts {
        assert!((row.normal.norm() - 1.0).abs() < 1e-12);
        assert!(row.normal.dot(&(row.point - centre(row.body))) > 0.0);
        match &row.partner {
            Partner::Body(partner) => {
                assert!(row.normal.dot(&(centre(*partner) - row.point)) > 0.0);
            }
            Partner::Wall(name) => {
                let outward = match name.as_str() {
                    "floor" => -Vector3::z(),
                    "x-" => -Vector3::x(),
                    "x+" => Vector3::x(),
                    "y-" => -Vector3::y(),
                    "y+" => Vector3::y(),
                    other => panic!("a wall called {other}"),
                };
                assert!((row.normal - outward).norm() < 1e-9, "{name}");
            }
        }
    }
}

/// Forces through cuts carry the weight above to 1e-3, and with the moments of the patches the stress of
/// every body is nearly symmetric: statics of the whole record.
#[test]
fn cuts_carry_the_weight_and_stresses_are_symmetric() {
    let (packing, snapshot) = settled();
    let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
    let balance = tables.vertical_balance.unwrap();
    assert!(balance.worst < 1e-3, "{}", balance.worst);
    assert_eq!(balance.cuts.len(), 20);
    let weight = 8.0 * packing.world().mass(0).unwrap() * packing.spec().gravity;
    // Some of the eight lie lowest; all others are above the first cut.
    let above = balance.cuts[0].weight_above / (weight / 8.0);
    assert!(
        (above - above.round()).abs() < 1e-9 && (3.0..7.5).contains(&above),
        "{above}"
    );
    let floor = snapshot
        .contacts
        .iter()
        .filter_map(|row| match &row.partner {
            Partner::Wall(name) if name == "floor" => Some(row.normal_force),
            _ => None,
        });
    let floor: f64 = floor.sum();
    let number = tables.walls.iter().position(|w| w == "floor").unwrap();
    let on_floor = tables.wall_forces.unwrap().walls;
    let found = on_floor.iter().find(|w| w.wall as usize == number).unwrap();
    assert!((found.force[2] + floor).abs() < 1e-9 * floor);
    let without_moments = Snapshot {
        contacts: snapshot
            .contacts
            .iter()
            .map(|row| ContactRow {
                moment: Vector3::zeros(),
                ..row.clone()
            })
            .collect(),
        ..snapshot.clone()
    };
    let asymmetry = |snapshot: &Snapshot| {
        let tables = Tables::compute(snapshot, &TableOptions::default()).unwrap();
        let bodies = tables.body_stresses.unwrap().bodies;
        bodies.iter().map(|b| b.stress.asymmetry()).sum::<f64>() / bodies.len() as f64
    };
    let [with, without] = [asymmetry(&snapshot), asymmetry(&without_moments)];
    assert!(with < 2e-3 && without > 3.0 * with, "{with} {without}");
}
