//! Nothing within reach of a body is missed: planes of a wall that lie apart, bodies that stretch or sleep.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::pack::{placed, shape};
use crate::common::soft::Soft;
use crate::common::tets::{body, cube};
use femdem_contact::deform::{Modulus, NodalState};
use femdem_contact::{
    ContactBatch, ContactLaw, ContactParameters, Field, Frame, Motion, Partner, Wall, WallPlane,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};

fn law() -> ContactLaw {
    ContactLaw::new(ContactParameters {
        penalty: 1e3,
        ..ContactParameters::default()
    })
    .unwrap()
}

/// One wall of two planes across x, at 0 and at `width`.
fn slot(width: f64) -> Wall {
    let plane = |x: f64, offset: f64| WallPlane {
        normal: Vector3::x() * x,
        offset,
    };
    Wall::new("slot", vec![plane(1.0, 0.0), plane(-1.0, -width)]).unwrap()
}

fn at(x: f64, travelled: f64) -> Motion {
    let frame = Frame {
        position: Vector3::x() * x,
        rotation: Matrix3::identity(),
    };
    Motion {
        inverse_mass: 1.0,
        travelled,
        ..Motion::fixed(frame)
    }
}

/// The force along x on a meshed cube of side 1 that has moved through `places` between the planes.
fn pushed(width: f64, places: &[f64]) -> f64 {
    let mut batch = ContactBatch::new(law());
    let shape = batch.add_shape(body(&cube(2), Field::Body));
    batch.add_body(shape).unwrap();
    batch.add_wall(slot(width));
    let still = Motion::fixed(Frame::identity());
    let mut travelled = 0.0;
    let mut last = places[0];
    for &x in places {
        travelled += (x - last).abs();
        last = x;
        batch.update(&[at(x, travelled)], &[still], 1e-3).unwrap();
    }
    batch.loads()[0].total.force.x
}

/// A cube in a slot slightly wider than itself contacts either side alike.
#[test]
fn both_sides_of_a_slot() {
    let (near, far) = (pushed(1.1, &[0.49]), pushed(1.1, &[0.61]));
    assert!(near > 1.0, "{near}");
    assert!((far / near + 1.0).abs() < 1e-6, "{near} {far}");
    // In one too narrow for it both sides push alike.
    let both = pushed(0.98, &[0.49]);
    assert!(both.abs() < 1e-9 * near, "{both}");
}

/// A body that flies from one plane to another, which was out of reach, lands there.
#[test]
fn the_far_side_of_a_wide_slot() {
    for start in [1.0, 1.9, 2.4] {
        let steps = 400;
        let end = 11.49;
        let way = |k: usize| start + (end - start) * k as f64 / steps as f64;
        let places: Vec<f64> = (0..=steps).map(way).collect();
        let force = pushed(11.98, &places);
        let near = pushed(1e3, &[0.49]);
        assert!((force / near + 1.0).abs() < 1e-6, "{start}: {force} {near}");
    }
}

fn states<'a>(x: &'a [Vector3<f64>], v: &'a [Vector3<f64>], w: &'a [f64]) -> NodalState<'a> {
    NodalState {
        positions: x,
        velocities: v,
        inverse_masses: w,
    }
}

/// A bar drawn out to eight times its length between two planes touches both.
#[test]
fn a_body_that_stretches() {
    let mut soft = Soft::linear(&cube(2));
    let mut batch = ContactBatch::new(law());
    let shape = batch.add_deformable_shape(soft.shape.clone());
    batch.add_deformable(shape, Modulus::Penalty(1e3)).unwrap();
    batch.add_wall(slot(7.99));
    let rest = soft.x.clone();
    let (v, w) = (vec![Vector3::zeros(); rest.len()], vec![1.0; rest.len()]);
    let still = [Motion::fixed(Frame::identity())];
    for k in 0..=100 {
        let stretch = 1.0 + 7.0 * f64::from(k) / 100.0;
        for (x, rest) in soft.x.iter_mut().zip(&rest) {
            *x = Vector3::new(3.995 + stretch * rest.x, rest.y, rest.z);
        }
        batch
            .update_deformables(&[states(&soft.x, &v, &w)], &still, &still, 0.0)
            .unwrap();
    }
    let sum = |sign: f64| {
        let nodes = rest.iter().zip(batch.nodal_loads(0).forces);
        let side = nodes.filter(|(x, _)| x.x * sign > 0.4);
        side.map(|(_, f)| f.x).sum::<f64>()
    };
    let (low, high) = (sum(-1.0), sum(1.0));
    assert!(low > 0.1 && (high / low + 1.0).abs() < 1e-3, "{low} {high}");
}

/// Initial friction of a pair takes effect in the next update or never.
#[test]
fn a_start_of_friction_does_not_wait() {
    let force = |before: bool| {
        let mut soft = Soft::linear(&cube(2));
        let mut batch = ContactBatch::new(law());
        let shape = batch.add_deformable_shape(soft.shape.clone());
        batch.add_deformable(shape, Modulus::Penalty(1e3)).unwrap();
        batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
        let (v, w) = (
            vec![Vector3::zeros(); soft.x.len()],
            vec![1.0; soft.x.len()],
        );
        let still = [Motion::fixed(Frame::identity())];
        let rest = soft.x.clone();
        for (k, height) in [0.51, 0.49].into_iter().enumerate() {
            for (x, rest) in soft.x.iter_mut().zip(&rest) {
                *x = rest + Vector3::z() * height;
            }
            if before == (k == 0) {
                let floor = Partner::Wall(0);
                batch
                    .begin_friction(floor, 0, Vector3::x() * 1e-3, 0.0)
                    .unwrap();
            }
            batch
                .update_deformables(&[states(&soft.x, &v, &w)], &still, &still, 0.0)
                .unwrap();
        }
        batch.nodal_loads(0).friction.iter().sum::<Vector3<f64>>().x
    };
    assert!((force(false) / 1e-3 - 1.0).abs() < 1e-9, "{}", force(false));
    assert!(force(true).abs() < 1e-15, "{}", force(true));
}

/// A body that slept from the start is found by others.
#[test]
fn a_body_that_was_never_awake() {
    let mut batch = ContactBatch::new(law());
    let a10 = shape("A10", 1.0);
    let id = batch.add_shape(a10.clone());
    for _ in 0..2 {
        batch.add_body(id).unwrap();
    }
    batch.set_awake(0, false);
    let place = |x: f64| placed(&a10, Vector3::x() * x, Matrix3::identity());
    let bodies = [place(0.0), place(0.9)];
    batch.update(&bodies, &[], 1e-3).unwrap();
    assert_eq!(batch.contacts().len(), 1);
    assert!(batch.loads()[1].total.force.x > 0.0);
}
