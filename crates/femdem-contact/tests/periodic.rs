//! Periodic space against a batch in which the images are bodies.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use crate::common::pack::{advance, placed, shape, stir};
use crate::common::tets::{block, body, cubes};
use femdem_contact::{
    BodyShape, ContactBatch, ContactError, ContactLaw, ContactParameters, ConvexShape, Field,
    Frame, Motion, PeriodicCell, Sphere, Wall,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

const COUNT: usize = 14;

fn law(friction: f64, damping: f64) -> ContactLaw {
    ContactLaw::new(ContactParameters {
        penalty: 1e3,
        friction,
        damping_ratio: damping,
        ..ContactParameters::default()
    })
    .unwrap()
}

/// A cell that leans, by more than half a side, and one that changes its form.
fn leaning() -> PeriodicCell {
    let cell = PeriodicCell::new([Some(2.6), Some(2.5), Some(2.7)]).unwrap();
    let edges = Matrix3::new(2.6, 0.4, 1.9, 0.0, 2.5, -0.7, 0.0, 0.0, 2.7);
    let rates = Matrix3::new(-0.002, 0.003, 0.01, 0.0, 0.001, -0.002, 0.0, 0.0, -0.001);
    cell.with_edges(edges).unwrap().with_rates(rates).unwrap()
}

fn later(cell: &PeriodicCell, dt: f64) -> PeriodicCell {
    cell.with_edges(cell.edges() + cell.rates() * dt).unwrap()
}

/// Spheres, cubes, a solid with many faces and a mesh, each with the convex shape by which it is moved.
fn shapes() -> Vec<(BodyShape, Arc<ConvexShape>)> {
    let outer = shape("P5", 0.9);
    let mesh = body(&cubes(&block([2; 3], |_| true), 0.25), Field::Body);
    vec![
        (Sphere::new(0.45).unwrap().into(), outer.clone()),
        (outer.clone().into(), outer.clone()),
        (shape("A10", 1.0).into(), shape("A10", 1.0)),
        (mesh.into(), outer),
    ]
}

/// Bodies at random places, some of them a cell or two away.
fn bodies(cell: &PeriodicCell, stream: &mut Stream) -> Vec<Motion> {
    let shapes = shapes();
    let one = |i: usize| {
        let within = cell.edges() * (stream.vector() + Vector3::repeat(0.5));
        let away = cell.offset([
            (i % 3) as i32 - 1,
            i32::from(i.is_multiple_of(5)),
            -i32::from(i.is_multiple_of(4)),
        ]);
        placed(&shapes[i % 4].1, within + away, stream.rotation())
    };
    (0..COUNT).map(one).collect()
}

fn batch(law: ContactLaw, cell: Option<PeriodicCell>, kinds: &[usize]) -> ContactBatch {
    let mut batch = ContactBatch::new(law);
    if let Some(cell) = cell {
        batch.set_cell(cell).unwrap();
    }
    for (shape, _) in shapes() {
        batch.add_shape(shape);
    }
    for &kind in kinds {
        batch.add_body(kind as u32).unwrap();
    }
    batch
}

/// An image of a body, as it moves; its travel is that of the body and of the edges.
fn image(motion: &Motion, cell: &PeriodicCell, number: [i32; 3], paths: &[f64; 3]) -> Motion {
    let mut seen = *motion;
    seen.frame.position += cell.offset(number);
    seen.velocity += cell.velocity_of(number);
    for (n, path) in number.iter().zip(paths) {
        seen.travelled += f64::from(n.abs()) * path;
    }
    seen
}

/// Every load of the periodic batch is that of a batch with all images that may meet a body, at every step of a motion in which
/// bodies tumble, with friction and damping, while the cell is sheared and compressed.
#[test]
fn loads_are_those_among_images() {
    let mut cell = leaning();
    let mut stream = Stream(5);
    let mut motions = bodies(&cell, &mut stream);
    let kinds: Vec<usize> = (0..COUNT).map(|i| i % 4).collect();
    let mut images = Vec::new();
    for (a, motion) in motions.iter().enumerate() {
        for number in (0..11 * 11 * 11).map(|k| [k % 11 - 5, k / 11 % 11 - 5, k / 121 - 5]) {
            let place = motion.frame.position + cell.offset(number);
            let near = |b: &Motion| (b.frame.position - place).norm() < 1.8;
            if number != [0; 3] && motions.iter().any(near) {
                images.push((a, number));
            }
        }
    }
    let with_images: Vec<usize> = kinds
        .iter()
        .copied()
        .chain(images.iter().map(|(a, _)| kinds[*a]))
        .collect();
    let mut periodic = batch(law(0.5, 0.4), Some(cell), &kinds);
    let mut explicit = batch(law(0.5, 0.4), None, &with_images);
    let shapes = shapes();
    let (mut paths, mut largest, dt) = ([0.0; 3], 0.0_f64, 1.0);
    let mut over_edges = 0;
    for step in 0..60 {
        let mut all = motions.clone();
        let others = images.iter();
        all.extend(others.map(|(a, number)| image(&motions[*a], &cell, *number, &paths)));
        periodic.update(&motions, &[], dt).unwrap();
        explicit.update(&all, &[], dt).unwrap();
        let scale = periodic.loads().iter().map(|l| l.total.force.norm());
        let scale = scale.fold(0.0, f64::max);
        for (i, (one, other)) in periodic.loads().iter().zip(explicit.loads()).enumerate() {
            let off = (one.total.force - other.total.force).norm()
                + (one.total.torque - other.total.torque).norm()
                + (one.friction.force - other.friction.force).norm()
                + (one.viscous.force - other.viscous.force).norm();
            assert!(
                off < 1e-9 * scale,
                "step {step}, body {i}: {off} of {scale}"
            );
        }
        largest = largest.max(scale);
        over_edges += usize::from(periodic.edge_loads()[2].total.norm() > 0.0);
        let gradient = cell.velocity_gradient();
        for (i, motion) in motions.iter_mut().enumerate() {
            stir(motion, &shapes[kinds[i]].1, &mut stream);
            motion.velocity += gradient * motion.frame.position;
            advance(motion, &shapes[kinds[i]].1, dt);
        }
        let next = later(&cell, dt);
        for (k, path) in paths.iter_mut().enumerate() {
            *path += (next.edges() - cell.edges()).column(k).norm();
        }
        cell = next;
        periodic.set_cell(cell).unwrap();
    }
    assert!(largest > 1.0 && over_edges > 50, "{largest} {over_edges}");
}

/// Central differences of the energy: moving an edge does the work of its load, and straining space with all bodies that of the
/// virial.
#[test]
fn forces_over_edges_and_the_virial_are_gradients() {
    let cell = leaning();
    let mut stream = Stream(3);
    let motions = bodies(&cell, &mut stream);
    let kinds: Vec<usize> = (0..COUNT).map(|i| i % 4).collect();
    let energy = |edges: Matrix3<f64>, strain: &Matrix3<f64>| {
        let cell = cell.with_edges(edges).unwrap();
        let moved: Vec<Motion> = motions
            .iter()
            .map(|motion| {
                let mut moved = *motion;
                moved.frame.position += strain * motion.frame.position;
                moved
            })
            .collect();
        let mut batch = batch(law(0.0, 0.0), Some(cell), &kinds);
        batch.update(&moved, &[], 0.0).unwrap();
        batch.totals().energy
    };
    let mut batch = batch(law(0.0, 0.0), Some(cell), &kinds);
    batch.update(&motions, &[], 0.0).unwrap();
    let (virial, h) = (batch.virial(), 1e-6);
    let scale = virial.norm();
    assert!(scale > 1.0);
    for k in 0..3 {
        for i in 0..=k {
            let mut one = Matrix3::zeros();
            one[(i, k)] = h;
            let by_edge = |sign: f64| energy(cell.edges() + one * sign, &Matrix3::zeros());
            let slope = (by_edge(1.0) - by_edge(-1.0)) / (2.0 * h);
            let load = batch.edge_loads()[k].total[i];
            assert!(
                (slope + load).abs() < 1e-5 * scale,
                "{i} {k}: {slope} {load}"
            );
            let strained = |sign: f64| {
                let strain = one * sign;
                energy(cell.edges() + strain * cell.edges(), &strain)
            };
            let slope = (strained(1.0) - strained(-1.0)) / (2.0 * h);
            let stress = virial[(i, k)];
            assert!(
                (slope + stress).abs() < 1e-5 * scale,
                "{i} {k}: {slope} {stress}"
            );
        }
    }
}

/// All bodies moved by whole edges, each by others: the same forces.
#[test]
fn whole_edges_change_nothing() {
    let cell = leaning();
    let mut stream = Stream(8);
    let motions = bodies(&cell, &mut stream);
    let kinds: Vec<usize> = (0..COUNT).map(|i| i % 4).collect();
    let loads = |motions: &[Motion]| {
        let mut batch = batch(law(0.5, 0.4), Some(cell), &kinds);
        batch.update(motions, &[], 0.0).unwrap();
        batch.loads().to_vec()
    };
    let here = loads(&motions);
    let mut moved = motions.clone();
    for (i, motion) in moved.iter_mut().enumerate() {
        let number = [i as i32 - 5, 3 - i as i32, (i as i32 * 7) % 4];
        *motion = image(motion, &cell, number, &[0.0; 3]);
    }
    let scale = here
        .iter()
        .map(|l| l.total.force.norm())
        .fold(0.0, f64::max);
    for (one, other) in here.iter().zip(loads(&moved)) {
        assert!((one.total.force - other.total.force).norm() < 1e-10 * scale);
    }
}

#[test]
fn cells_that_cannot_be_are_refused() {
    assert!(PeriodicCell::new([None; 3]).is_err());
    assert!(PeriodicCell::new([Some(0.0), None, None]).is_err());
    assert!(PeriodicCell::new([Some(f64::NAN), None, None]).is_err());
    let cell = PeriodicCell::new([Some(3.0), None, Some(3.0)]).unwrap();
    let mut edges = *cell.edges();
    edges[(2, 0)] = 0.1;
    assert!(cell.with_edges(edges).is_err(), "edge x leans");
    assert!(cell.with_rates(Matrix3::identity()).is_err(), "y moves");

    // Too small for its bodies.
    let mut batch = batch(law(0.5, 0.4), None, &[]);
    batch
        .set_cell(PeriodicCell::new([Some(2.0), None, None]).unwrap())
        .unwrap();
    batch.add_body(0).unwrap();
    let motion = Motion::fixed(Frame::identity());
    let refused = batch.update(&[motion], &[], 0.0).unwrap_err();
    assert!(refused.to_string().contains("periodic cell"), "{refused}");

    // Other axes, once there are bodies.
    assert!(batch.set_cell(cell).is_err());
    batch
        .set_cell(PeriodicCell::new([Some(3.0), None, None]).unwrap())
        .unwrap();
    batch.update(&[motion], &[], 0.0).unwrap();

    // Walls must repeat themselves.
    batch.add_wall(Wall::half_space("floor", Vector3::z(), -5.0).unwrap());
    let wall = Motion::fixed(Frame::identity());
    batch.update(&[motion], &[wall], 0.0).unwrap();
    batch.add_wall(Wall::half_space("side", Vector3::x(), -5.0).unwrap());
    match batch.update(&[motion], &[wall, wall], 0.0) {
        Err(ContactError::Wall { name, .. }) => assert_eq!(name, "side"),
        other => panic!("{other:?}"),
    }
}
