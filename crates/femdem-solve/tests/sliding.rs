//! Bodies that slide and spin stop as Coulomb's law says.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{DENSITY, G, add_floor, parameters, pose};
use femdem_mesh::Rotation;
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::shapes::{Cylinder, Shape};
use femdem_solve::{BodySpec, Drive, World};
use std::f64::consts::{PI, TAU};

const FRICTION: f64 = 0.3;
const RADIUS: f64 = 0.05;

/// The motions end at this fraction of the first speed.
const END: f64 = 1e-3;

/// A disc that slides and spins.
#[derive(Debug, Clone, Copy)]
struct Slide {
    /// Speeds of the centre and of the rim against it, m/s.
    speed: f64,
    rim: f64,
    /// Distance, m, and turned angle, rad.
    distance: f64,
    angle: f64,
}

impl Slide {
    fn from(speed: f64, rim: f64) -> Self {
        Self {
            speed,
            rim,
            distance: 0.0,
            angle: 0.0,
        }
    }

    fn ratio(&self) -> f64 {
        self.speed / self.rim
    }
}

/// Friction over mu N and torsion over mu N R of Coulomb's law, integrated over a disc under uniform pressure.
fn coulomb(speed: f64, rim: f64) -> [f64; 2] {
    const N: u32 = 24;
    let (mut force, mut moment) = (0.0, 0.0);
    let weight = 1.0 / f64::from(N * N);
    for i in 0..N {
        let r = ((f64::from(i) + 0.5) / f64::from(N)).sqrt();
        for k in 0..N {
            let (sin, cos) = ((f64::from(k) + 0.5) * PI / f64::from(N)).sin_cos();
            let v = [speed - rim * r * cos, rim * r * sin];
            let norm = v[0].hypot(v[1]);
            force += weight * v[0] / norm;
            moment += weight * r * (v[1] * sin - v[0] * cos) / norm;
        }
    }
    [force, moment]
}

/// The motion until the speed has fallen below a fraction `end` of the first.
fn expected(speed: f64, rim: f64, end: f64) -> Slide {
    let mut slide = Slide::from(speed, rim);
    while slide.speed > end * speed {
        let dt = 2e-4 * slide.speed.max(slide.rim);
        let [force, moment] = coulomb(slide.speed, slide.rim);
        let before = slide;
        slide.speed -= FRICTION * G * force * dt;
        slide.rim -= 2.0 * FRICTION * G * moment * dt;
        slide.distance += 0.5 * (before.speed + slide.speed) * dt;
        slide.angle += 0.5 * (before.rim + slide.rim) / RADIUS * dt;
    }
    slide
}

fn simulated(speed: f64, rim: f64, end: f64) -> Slide {
    let mut world = World::new(parameters(1e6, FRICTION, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    // A regular polygon whose area is that of the circle.
    const SIDES: u32 = 128;
    let part = TAU / f64::from(SIDES);
    let radius = RADIUS * (part / part.sin()).sqrt();
    let aspect = 0.02;
    let shape = Shape::from(Cylinder {
        aspect,
        sides: SIDES,
    });
    let body = shape.polyhedron(1.0).unwrap();
    let widest = body.vertices().iter().map(|x| x.x).fold(0.0, f64::max);
    let size = radius / widest;
    let body = shape.polyhedron(size).unwrap();
    let thickness = 2.0 * body.vertices().iter().map(|x| x.z).fold(0.0, f64::max);
    let shape = world.add_shape("disc", &body).unwrap();
    let depth = DENSITY * G * thickness * thickness * 0.5 / (2.0 * 1e6);
    let place = Vector3::z() * (0.5 * thickness - depth);
    let spec = BodySpec {
        velocity: Vector3::x() * speed,
        angular_velocity: Vector3::z() * (rim / RADIUS),
        ..BodySpec::at_rest(shape, DENSITY, pose(place, Rotation::identity()))
    };
    world.add_body(spec).unwrap();
    let mut slide = Slide::from(speed, rim);
    while slide.speed > end * speed {
        let before = world.time();
        world.step().unwrap();
        slide.speed = world.velocity(0).unwrap().norm();
        let spin = world.angular_velocity(0).unwrap().z;
        slide.rim = spin * RADIUS;
        slide.distance = world.position(0).unwrap().xy().norm();
        slide.angle += spin * (world.time() - before);
    }
    slide
}

/// A disc stops sliding and spinning together, with v/(R w) = 0.653 (Voyenli and Eriksen 1985, Am. J. Phys. 53, 1149).
#[test]
fn a_disc_slides_and_spins() {
    for (speed, rim) in [(0.5, 0.5), (0.5, 0.2), (0.3, 0.9)] {
        let (got, want) = (simulated(speed, rim, END), expected(speed, rim, END));
        assert!((want.ratio() - 0.653).abs() < 0.02, "{}", want.ratio());
        let off = |of: fn(&Slide) -> f64| (of(&got) / of(&want) - 1.0).abs();
        assert!(off(|s| s.ratio()) < 0.02, "{got:?} {want:?}");
        assert!(off(|s| s.distance) < 0.02, "{got:?} {want:?}");
        assert!(off(|s| s.angle) < 0.02, "{got:?} {want:?}");
    }
}
