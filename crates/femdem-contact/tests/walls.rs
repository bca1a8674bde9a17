//! Walls: half-spaces, boxes and the mantle of a cylinder.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::pack::{placed, shape};
use crate::common::{Stream, solids, wall_oracle};
use femdem_contact::kernel::{CavityKernel, Scratch};
use femdem_contact::{
    ContactBatch, ContactLaw, ContactParameters, Frame, Motion, Partner, Wall, WallPlane,
};
use femdem_mesh::nalgebra::{UnitQuaternion, Vector3};

fn batch(wall: Wall, id: &str) -> ContactBatch {
    let law = ContactLaw::new(ContactParameters::default()).unwrap();
    let mut batch = ContactBatch::new(law);
    batch.add_wall(wall);
    let index = batch.add_shape(shape(id, 1.0));
    batch.add_body(index).unwrap();
    batch
}

/// A cube pushed radially into the mantle of a cylinder, at facet middles, facet joints and between: one
/// contact that pushes it back to the axis, and the wall outwards as much. With many facets its force does
/// not depend on the angle.
#[test]
fn the_mantle_of_a_cylinder_touches_once() {
    let facets = 96;
    let radius = 2.0;
    let half = 0.5 / 3.0_f64.sqrt();
    for upright in [true, false] {
        let mut batch = batch(Wall::cylinder("mantle", radius, facets).unwrap(), "P5");
        let mut forces: Vec<f64> = Vec::new();
        let mut travelled = 0.0;
        for place in 0..40 {
            let angle = f64::from(place) * std::f64::consts::TAU / facets as f64 / 8.0;
            let out = Vector3::new(angle.cos(), angle.sin(), 0.0);
            let around = UnitQuaternion::from_scaled_axis(Vector3::z() * angle);
            // Lying, an edge points outwards and runs along the axis of the cylinder.
            let own = if upright {
                UnitQuaternion::identity()
            } else {
                UnitQuaternion::from_scaled_axis(Vector3::z() * std::f64::consts::FRAC_PI_4)
            };
            let reach = if upright { half } else { half * 2.0_f64.sqrt() };
            // Upright, the two outer edges of the face lead; they lie on a smaller circle.
            let edge = if upright {
                radius - (radius * radius - half * half).sqrt()
            } else {
                0.0
            };
            let position = out * (radius - reach - edge + 0.02) + Vector3::z() * 0.3;
            let rotation = (around * own).to_rotation_matrix().into_inner();
            let mut body = placed(&shape("P5", 1.0), position, rotation);
            travelled += 1.0;
            body.travelled = travelled;
            batch
                .update(&[body], &[Motion::fixed(Frame::identity())], 0.0)
                .unwrap();
            let contacts = batch.rigid_contacts();
            assert_eq!(contacts.len(), 1, "place {place}");
            let c = contacts[0];
            assert_eq!((c.a, c.b), (Partner::Wall(0), 0));
            let force = c.normal * c.elastic_force;
            assert!(
                force.normalize().dot(&-out) > 0.999,
                "pushed along {force:?}"
            );
            assert!(force.z.abs() < 1e-9 * force.norm());
            let wall = batch.wall_loads()[0].total;
            let on_body = batch.loads()[0].total;
            assert_eq!(wall.force, -on_body.force);
            // About the origin of the world, which is that of the wall, all moments cancel.
            let moment = wall.torque + on_body.torque + position.cross(&on_body.force);
            assert!(moment.norm() < 1e-12 * force.norm());
            forces.push(force.norm());
        }
        let mean = forces.iter().sum::<f64>() / forces.len() as f64;
        for f in &forces {
            assert!(
                (f / mean - 1.0).abs() < 0.1,
                "{f} of {mean} on a round wall"
            );
        }
    }
}

#[test]
fn a_wall_of_one_plane_is_a_half_space() {
    let normal = Vector3::new(0.3, -0.2, 1.0);
    let plane = WallPlane {
        normal,
        offset: 0.1,
    };
    let one = Wall::new("floor", vec![plane]).unwrap();
    let half_space = Wall::half_space("floor", normal, 0.1).unwrap();
    assert_eq!(one, half_space);
    // The offset is along the normal as it was given.
    let on_plane = normal * (0.1 / normal.norm_squared());
    assert!(one.clearance(&on_plane).abs() < 1e-15);
    assert!((one.clearance(&(on_plane + normal.normalize() * 0.7)) - 0.7).abs() < 1e-15);
}

/// A cavity of three planes meets a body in its corner once: volume and energy are those of
/// the part outside the cavity, and less than the sum over three half-spaces.
#[test]
fn a_corner_is_not_counted_twice() {
    let kernel = CavityKernel::new(1.0).unwrap();
    let mut scratch = Scratch::default();
    let mut stream = Stream(21);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let corner = |normals: &[Vector3<f64>]| {
        let planes = normals.iter().map(|&normal| WallPlane {
            normal,
            offset: 0.0,
        });
        Wall::new("corner", planes.collect()).unwrap()
    };
    let mut overcounted = 0;
    for (name, solid, shape) in solids() {
        let frame = Frame {
            position: Vector3::repeat(0.6 * shape.inradius()),
            rotation: stream.rotation(),
        };
        let mut evaluate = |normals: &[Vector3<f64>]| {
            let wall = corner(normals);
            kernel
                .evaluate(&wall, &Frame::identity(), &shape, &frame, &mut scratch)
                .map_or((0.0, 0.0), |x| (x.volume, x.energy))
        };
        let (_, energy) = evaluate(&axes);
        let want = 2.0 * wall_oracle(&solid, &frame, &axes.map(|n| (n, 0.0))).1;
        assert!(
            (energy / want - 1.0).abs() < 1e-9,
            "{name}: {energy} instead of {want}"
        );
        let apart: f64 = axes.iter().map(|n| evaluate(&[*n]).1).sum();
        assert!(energy < apart * (1.0 + 1e-12), "{name}");
        overcounted += usize::from(energy < 0.999 * apart);
    }
    assert!(
        overcounted > 10,
        "only {overcounted} bodies reach the edges"
    );
}

/// The cross-section of a faceted mantle, as its documentation states it.
#[test]
fn facets_widen_the_cylinder_by_the_stated_share() {
    let wall = Wall::cylinder("mantle", 1.0, 96).unwrap();
    let free = |x: f64, y: f64| wall.clearance(&Vector3::new(x, y, 5.0));
    assert!(free(0.999_999, 0.0) > 0.0);
    let joint = std::f64::consts::PI / 96.0;
    let corner = 1.0 / joint.cos();
    assert!(free((corner - 1e-9) * joint.cos(), (corner - 1e-9) * joint.sin()) > 0.0);
    assert!(free((corner + 1e-9) * joint.cos(), (corner + 1e-9) * joint.sin()) < 0.0);
    // Area of the polygon over that of the circle, from its corners.
    let polygon = 0.5 * 96.0 * corner * corner * (2.0 * joint).sin();
    assert!((polygon / std::f64::consts::PI - 1.000_357).abs() < 1e-6);
}

/// A wall that has moved and rotated acts like the same wall there.
#[test]
fn walls_follow_their_frames() {
    let place = Frame {
        position: Vector3::new(1.0, 2.0, -3.0),
        rotation: UnitQuaternion::from_scaled_axis(Vector3::x() * 0.4)
            .to_rotation_matrix()
            .into_inner(),
    };
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    let mut batch = batch(floor, "P5");
    let up = place.rotation * Vector3::z();
    let half = 0.5 / 3.0_f64.sqrt();
    let body = placed(
        &shape("P5", 1.0),
        place.position + up * (half - 1e-3),
        place.rotation,
    );
    batch.update(&[body], &[Motion::fixed(place)], 0.0).unwrap();
    let c = batch.rigid_contacts()[0];
    assert!((c.normal - up).norm() < 1e-9);
    assert!((c.volume / (4.0 * half * half * 1e-3) - 1.0).abs() < 1e-9);
    assert!((c.penetration() / 1e-3 - 1.0).abs() < 1e-6);
}

/// The way of a wall that turns is at least that of its points at the farthest side of a body, and hardly more; of one that moves
/// along, it is its path, wherever bodies are.
#[test]
fn the_way_of_a_wall_reaches_as_far_as_bodies() {
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    let batch = batch(floor, "P5");
    let bodies = [Motion::fixed(Frame {
        position: Vector3::new(10.0, 0.0, 0.0),
        ..Frame::identity()
    })];
    let still = Motion::fixed(Frame::identity());
    let turned = Motion::fixed(Frame {
        rotation: UnitQuaternion::from_scaled_axis(Vector3::y() * 0.1)
            .to_rotation_matrix()
            .into_inner(),
        ..Frame::identity()
    });
    let chord = 2.0 * 10.5 * 0.05_f64.sin();
    let way = batch.wall_way(&still, &turned, &bodies);
    assert!(way >= chord && way < 1.2 * chord, "{way} {chord}");
    let moved = Motion::fixed(Frame {
        position: Vector3::new(0.0, 3.0, 4.0),
        ..Frame::identity()
    });
    assert_eq!(batch.wall_way(&still, &moved, &bodies), 5.0);
}
