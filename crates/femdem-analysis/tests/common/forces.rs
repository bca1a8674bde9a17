//! Bodies and contacts of force networks for the tests.

use femdem_analysis::{ContactClass, ForceBody, ForceContact, Partner};
use femdem_mesh::{Point3, Vector3};

use super::Random;

/// A body of volume 1 m³ and weight 1 N.
pub fn body(x: f64, y: f64, z: f64) -> ForceBody {
    ForceBody {
        centre: Point3::new(x, y, z),
        volume: 1.0,
        diameter: 1.0,
        weight: 1.0,
    }
}

/// A frictionless contact of two bodies, half way between their centres, along the line between them.
pub fn between(bodies: &[ForceBody], i: u32, j: u32, normal_force: f64) -> ForceContact {
    let [a, b] = [i, j].map(|k| bodies[k as usize].centre);
    ForceContact {
        first: i,
        second: Partner::Body(j),
        point: a + (b - a) * 0.5,
        normal: (b - a).normalize(),
        normal_force,
        tangential: Vector3::zeros(),
        moment: Vector3::zeros(),
        class: None,
    }
}

/// A contact of body `i` with a wall on which it exerts `force`, in any split of normal and friction.
pub fn on_wall(i: u32, wall: u32, point: Point3, normal: Vector3, force: Vector3) -> ForceContact {
    let normal_force = force.dot(&normal);
    ForceContact {
        first: i,
        second: Partner::Wall(wall),
        point,
        normal,
        normal_force,
        tangential: force - normal * normal_force,
        moment: Vector3::zeros(),
        class: Some(ContactClass::Point),
    }
}

/// A random network: bodies in a box of side 4 m, contacts with forces of any direction.
pub fn random_network(random: &mut Random, count: u32) -> (Vec<ForceBody>, Vec<ForceContact>) {
    let mut vector = |size: f64| {
        Vector3::new(
            random.uniform(-size, size),
            random.uniform(-size, size),
            random.uniform(-size, size),
        )
    };
    let bodies: Vec<ForceBody> = (0..count)
        .map(|_| {
            let at = vector(2.0);
            body(at.x, at.y, at.z)
        })
        .collect();
    let mut contacts = Vec::new();
    for i in 0..count {
        for step in 1..4 {
            let j = (i + step * step) % count;
            let second = if step == 3 || j == i {
                Partner::Wall(i % 3)
            } else {
                Partner::Body(j)
            };
            contacts.push(ForceContact {
                first: i,
                second,
                point: bodies[i as usize].centre + vector(0.7),
                normal: vector(1.0).normalize(),
                normal_force: vector(1.0).x + 1.0,
                tangential: vector(0.5),
                moment: vector(0.2),
                class: None,
            });
        }
    }
    (bodies, contacts)
}
