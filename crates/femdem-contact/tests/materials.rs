//! Laws of pairs of materials: the penalty of a pair scales its energy, and its force is still minus the gradient.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::meshes::block;
use crate::common::soft::Soft;
use crate::common::{Stream, solids, turned};
use femdem_contact::deform::{Modulus, NodalState};
use femdem_contact::{
    BodyShape, ContactBatch, ContactError, ContactLaw, ContactLaws, ContactParameters, Field,
    FieldMesh, Frame, MaterialId, MeshWall, Motion, Partner, Sphere, Wall, WallShape,
};
use femdem_mesh::nalgebra::Vector3;

const PENALTY: f64 = 1e6;
const STIFF: f64 = 7e6;
const STEEL: MaterialId = MaterialId(1);
const STONE: MaterialId = MaterialId(2);

fn law(penalty: f64, friction: f64) -> ContactLaw {
    ContactLaw::new(ContactParameters {
        penalty,
        friction,
        wall_friction: Some(2.0 * friction),
        ..ContactParameters::default()
    })
    .unwrap()
}

/// A default law, and another of steel on stone.
fn laws() -> ContactLaws {
    let mut laws = ContactLaws::from(law(PENALTY, 0.3));
    laws.set([STONE, STEEL], Some(law(STIFF, 0.1)));
    laws
}

/// What a body B at a frame meets: a body at the origin, or a wall.
#[derive(Clone)]
enum Other {
    Body(BodyShape),
    Wall(WallShape),
}

/// Every kind of pair.
fn pairs() -> Vec<(Other, BodyShape)> {
    let mesh = block(Vector3::repeat(-0.4), Vector3::repeat(0.4), 2);
    let field = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body).unwrap();
    let round: BodyShape = Sphere::new(0.5).unwrap().into();
    let convex: BodyShape = solids()[5].2.clone().into();
    let meshed: BodyShape = field.into();
    let shapes = [convex, round, meshed];
    // Walls above which B hangs with its centre 0.35 higher than the origin.
    let floor = || Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    let plate = block(
        Vector3::new(-3.0, -3.0, -1.0),
        Vector3::new(3.0, 3.0, 0.0),
        2,
    );
    let mut all = Vec::new();
    for (i, own) in shapes.iter().enumerate() {
        let bodies = shapes[..=i].iter().cloned().map(Other::Body);
        let walls = [floor().into(), MeshWall::solid("plate", &plate).into()];
        let others = bodies.chain(walls.map(Other::Wall));
        all.extend(others.map(|other| (other, own.clone())));
    }
    all
}

/// Energy, and force and torque on B, of a pair of steel and stone, or of two of material 0.
fn evaluate(
    laws: ContactLaws,
    (other, own): &(Other, BodyShape),
    own_at: Frame,
    materials: [MaterialId; 2],
) -> (f64, Vector3<f64>, Vector3<f64>) {
    let mut batch = ContactBatch::new(laws);
    let mut motions = Vec::new();
    let mut walls = Vec::new();
    match other {
        Other::Body(shape) => {
            let shape = batch.add_shape(shape.clone());
            let body = batch.add_body(shape).unwrap();
            batch.set_material(body, materials[0]).unwrap();
            motions.push(Motion::fixed(Frame::identity()));
        }
        Other::Wall(shape) => {
            let wall = batch.add_wall(shape.clone());
            batch.set_wall_material(wall, materials[0]).unwrap();
            walls.push(Motion::fixed(Frame::identity()));
        }
    }
    let shape = batch.add_shape(own.clone());
    let body = batch.add_body(shape).unwrap();
    batch.set_material(body, materials[1]).unwrap();
    motions.push(Motion::fixed(own_at));
    batch.update(&motions, &walls, 0.0).unwrap();
    let load = batch.load_of(body).total;
    (batch.totals().energy, load.force, load.torque)
}

/// For bodies and walls of every kind: the energy of a pair with a law of its own is that of another pair times the ratio of
/// the penalties, to the last digits, and its force and torque are minus the gradient of that energy.
#[test]
fn forces_of_pairs_are_gradients() {
    let mut stream = Stream(3);
    for (k, pair) in pairs().iter().enumerate() {
        let at = |shift: Vector3<f64>, turn: Vector3<f64>, frame: &Frame| {
            let moved = Frame {
                position: frame.position + shift,
                ..*frame
            };
            turned(&moved, &turn, 1.0)
        };
        let height = match pair.0 {
            Other::Body(_) => 0.75,
            Other::Wall(_) => 0.35,
        };
        let frame = Frame {
            position: Vector3::new(0.05, -0.03, height),
            rotation: stream.rotation(),
        };
        let energy = |f: &Frame| evaluate(laws(), pair, *f, [STEEL, STONE]).0;
        let (u, force, torque) = evaluate(laws(), pair, frame, [STEEL, STONE]);
        let (usual, _, _) = evaluate(laws(), pair, frame, [STEEL, STEEL]);
        assert!(usual > 0.0, "{k} apart");
        assert!(
            (u / usual * PENALTY / STIFF - 1.0).abs() < 1e-12,
            "{k}: {u}"
        );
        let step = 1e-5;
        for axis in 0..3 {
            let e = Vector3::ith(axis, step);
            let zero = Vector3::zeros();
            let slope = |plus: Frame, minus: Frame| (energy(&plus) - energy(&minus)) / (2.0 * step);
            let got = -slope(at(e, zero, &frame), at(-e, zero, &frame));
            let turn = -slope(at(zero, e, &frame), at(zero, -e, &frame));
            let scale = force.norm();
            assert!(
                (got - force[axis]).abs() < 1e-5 * scale,
                "{k} {axis}: {got} {force}"
            );
            assert!(
                (turn - torque[axis]).abs() < 1e-5 * scale,
                "{k} {axis}: {turn} {torque}"
            );
        }
    }
}

/// A deformable body on rigid ones and walls: its own modulus, with the penalty of the pair for a rigid body, as two
/// foundations one behind the other. Walls are as stiff as the body alone makes them.
#[test]
fn deformable_bodies_meet_the_penalty_of_the_pair() {
    let mesh = block(Vector3::repeat(-0.5), Vector3::repeat(0.5), 2);
    let soft = Soft::linear(&mesh);
    let own = 2e6;
    let energy = |materials: [MaterialId; 2], on_wall: bool, lift: f64| {
        let mut batch = ContactBatch::new(laws());
        let shape = batch.add_deformable_shape(soft.shape.clone());
        let body = batch.add_deformable(shape, Modulus::Penalty(own)).unwrap();
        batch.set_material(body, materials[1]).unwrap();
        let fixed = Motion::fixed(Frame::identity());
        let none = NodalState {
            positions: &[],
            velocities: &[],
            inverse_masses: &[],
        };
        let shift = Vector3::new(0.1, 0.2, lift + if on_wall { 0.49 } else { 0.99 });
        let x: Vec<_> = soft.x.iter().map(|x| x + shift).collect();
        let (still, masses) = (vec![Vector3::zeros(); x.len()], vec![1.0; x.len()]);
        let state = NodalState {
            positions: &x,
            velocities: &still,
            inverse_masses: &masses,
        };
        if on_wall {
            let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
            let wall = batch.add_wall(floor);
            batch.set_wall_material(wall, materials[0]).unwrap();
            batch
                .update_deformables(&[state], &[fixed], &[fixed], 0.0)
                .unwrap();
        } else {
            let block = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body).unwrap();
            let shape = batch.add_shape(block);
            let rigid = batch.add_body(shape).unwrap();
            batch.set_material(rigid, materials[0]).unwrap();
            batch
                .update_deformables(&[state, none], &[fixed; 2], &[], 0.0)
                .unwrap();
        }
        let force: Vector3<f64> = batch.nodal_loads(body).forces.iter().sum();
        (batch.deformable_totals().unwrap().energy, force.z)
    };
    let usual = energy([STEEL, STEEL], false, 0.0).0;
    let stiff = energy([STONE, STEEL], false, 0.0).0;
    // Springs in a row: 1/k = 1/k_A + 1/k_B.
    let together = |p: f64| 1.0 / (1.0 / p + 1.0 / own);
    let want = together(STIFF) / together(PENALTY);
    assert!(
        (stiff / usual / want - 1.0).abs() < 1e-9,
        "{}",
        stiff / usual
    );
    let on_wall = energy([STEEL, STEEL], true, 0.0).0;
    assert_eq!(energy([STONE, STEEL], true, 0.0).0, on_wall);
    let step = 1e-6;
    let up = energy([STONE, STEEL], false, step).0;
    let down = energy([STONE, STEEL], false, -step).0;
    let force = energy([STONE, STEEL], false, 0.0).1;
    assert!(((down - up) / (2.0 * step) / force - 1.0).abs() < 1e-5);
}

/// A material is told, changed and refused by number; whoever comes after something that was removed is of material 0; the law
/// of a contact is that of its pair, at walls with the friction of walls.
#[test]
fn materials_belong_to_what_is_there() {
    let mut batch = ContactBatch::new(laws());
    let shape = batch.add_shape(solids()[5].2.clone());
    let ids = [0, 1].map(|_| batch.add_body(shape).unwrap());
    let wall = batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
    batch.set_material(ids[0], STEEL).unwrap();
    batch.set_material(ids[1], STONE).unwrap();
    batch.set_wall_material(wall, STONE).unwrap();
    let place = |z: f64| {
        Motion::fixed(Frame {
            position: Vector3::z() * z,
            ..Frame::identity()
        })
    };
    let still = [place(0.2), place(0.6)];
    batch.update(&still, &[place(0.0)], 0.0).unwrap();
    let mut seen: Vec<_> = batch
        .contacts()
        .into_iter()
        .map(|c| (c.a, c.b, batch.law_of(c.a, c.b).unwrap().friction))
        .collect();
    seen.sort_unstable_by_key(|x| (x.0, x.1));
    // Steel on stone; the floor of stone under steel and, if it is that low, under stone.
    assert_eq!(seen[0], (Partner::Body(0), 1, 0.1));
    assert_eq!(seen[1], (Partner::Wall(0), 0, 0.2));
    assert_eq!(batch.set_material(ids[0], STONE).unwrap(), [ids[1]]);
    assert_eq!(batch.set_wall_material(wall, STEEL).unwrap()[0], ids[0]);
    assert_eq!(batch.material(ids[0]), Some(STONE));
    assert_eq!(batch.wall_material(wall), Some(STEEL));
    batch.remove_body(ids[0]).unwrap();
    batch.remove_wall(wall).unwrap();
    assert_eq!(
        (batch.material(ids[0]), batch.wall_material(wall)),
        (None, None)
    );
    for refused in [
        batch.set_material(0, STEEL),
        batch.set_wall_material(0, STEEL),
    ] {
        assert!(matches!(
            refused,
            Err(ContactError::NoSuch { index: 0, .. })
        ));
    }
    assert_eq!(batch.add_body(shape).unwrap(), ids[0]);
    batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
    assert_eq!(batch.material(ids[0]), Some(MaterialId::default()));
    assert_eq!(batch.wall_material(wall), Some(MaterialId::default()));
    let soft = Soft::linear(&block(Vector3::repeat(-0.5), Vector3::repeat(0.5), 1));
    let shape = batch.add_deformable_shape(soft.shape.clone());
    let soft = batch.add_deformable(shape, Modulus::Penalty(1.0)).unwrap();
    assert_eq!(batch.material(soft), Some(MaterialId::default()));
    batch.set_material(soft, STONE).unwrap();
    assert_eq!(
        [ids[1], soft].map(|body| batch.material(body)),
        [Some(STONE); 2]
    );
}
