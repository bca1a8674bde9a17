//! A body that falls into parts: its contacts go on as those of several bodies.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::Stream;
use femdem_contact::deform::{DeformableShape, FragmentShape, Modulus, NodalState};
use femdem_contact::{
    BodyId, ContactBatch, ContactLaw, ContactParameters, Frame, Motion, Partner, Wall,
};
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::tet::CrackedMesh;
use femdem_mesh::{Point3, TetMesh};

const DEPTH: f64 = 0.01;

/// A block of height 3 that cracks have cut at 1 and at 2, with its mesh before.
fn cut() -> (TetMesh, CrackedMesh) {
    let mut stream = Stream(4);
    let block = TetMesh::block([2, 2, 6], &Vector3::new(1.0, 1.0, 3.0)).unwrap();
    // So that each tetrahedron has one triangle of the skin that is nearest; faces stay plane.
    let mut shake = |p: &Point3| match p.z % 1.0 == 0.0 {
        true => *p,
        false => Point3::new(p.x, p.y, p.z + 0.1 * (stream.unit() - 0.5)),
    };
    let points: Vec<Point3> = block.points().iter().map(&mut shake).collect();
    let mesh = TetMesh::new(points, block.tets().to_vec()).unwrap();
    let mut cracked = CrackedMesh::new(&mesh);
    let flat = |points: [u32; 3]| {
        let z = points.map(|i| mesh.points()[i as usize].z);
        z == [1.0; 3] || z == [2.0; 3]
    };
    let facets = cracked.facets().all().iter().zip(0..);
    let cuts: Vec<u32> = facets
        .filter(|(f, _)| flat(f.points))
        .map(|(_, i)| i)
        .collect();
    cracked.cut(&cuts).unwrap();
    (mesh, cracked)
}

/// Forces on the nodes of bodies, and the energies of the contacts and of their springs.
struct Found {
    forces: Vec<Vec<Vector3<f64>>>,
    energies: [f64; 2],
}

fn update(batch: &mut ContactBatch, bodies: &[Vec<Vector3<f64>>], dt: f64) -> Found {
    let rest = bodies.iter().map(|x| vec![Vector3::zeros(); x.len()]);
    let (rest, masses): (Vec<_>, Vec<_>) = rest.map(|v| (v.clone(), vec![1.0; v.len()])).unzip();
    let states: Vec<NodalState> = (0..bodies.len())
        .map(|i| NodalState {
            positions: &bodies[i],
            velocities: &rest[i],
            inverse_masses: &masses[i],
        })
        .collect();
    let still = vec![Motion::fixed(Frame::identity()); bodies.len()];
    batch
        .update_deformables(&states, &still, &still[..1], dt)
        .unwrap();
    let totals = batch.deformable_totals().unwrap();
    let of = |i| batch.nodal_loads(i as BodyId).forces.to_vec();
    Found {
        forces: (0..bodies.len()).map(of).collect(),
        energies: [totals.energy, totals.spring_energy],
    }
}

/// Three slabs press on each other and on a floor, and hold by friction. As bodies of their own they have the forces and the
/// energies that they had as parts of one, also in springs, whichever of them becomes which body.
#[test]
fn parts_press_and_hold_on_as_before() {
    let (mesh, cracked) = cut();
    let edge = DeformableShape::new(&mesh).unwrap().edge();
    let whole = cracked.mesh(mesh.points()).unwrap();
    let hanging = cracked.hanging(&[]);
    assert_eq!(hanging.iter().max(), Some(&2));
    let part_of = |node: u32| hanging[cracked.around(node)[0] as usize];
    let place = |shift: f64, node: usize| {
        let part = f64::from(part_of(node as u32));
        let away = Vector3::new(shift, -2.0 * shift * (part % 2.0), -DEPTH * (part + 1.0));
        whole.points()[node].coords + away
    };
    let at = |shift: f64| -> Vec<Vector3<f64>> {
        (0..whole.points().len())
            .map(|node| place(shift, node))
            .collect()
    };
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
        let law = ContactParameters {
            friction: 0.5,
            damping_ratio: 0.0,
            ..ContactParameters::default()
        };
        let mut batch = ContactBatch::new(ContactLaw::new(law).unwrap());
        batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
        let shape = DeformableShape::cracked(&whole, edge).unwrap();
        let shape = batch.add_deformable_shape(shape);
        let modulus = Modulus::Foundation(20.0);
        let body = batch.add_deformable(shape, modulus).unwrap();
        batch.set_self_contact(body, true).unwrap();
        update(&mut batch, &[at(0.0)], 1e-3);
        let before = update(&mut batch, &[at(0.1 * DEPTH)], 1e-3);
        assert!(before.energies.iter().all(|energy| *energy > 0.0));

        let mut nodes = Vec::new();
        let parts: Vec<FragmentShape> = order
            .iter()
            .map(|number| {
                let own = (0_u32..).zip(&hanging).filter(|(_, part)| *part == number);
                let tets: Vec<u32> = own.map(|(t, _)| t).collect();
                let part = cracked.part(&tets).unwrap();
                let point = |node: &u32| whole.points()[*node as usize];
                let points = part.nodes.iter().map(point).collect();
                let own = TetMesh::new(points, part.mesh.tets().to_vec()).unwrap();
                nodes.push(part.nodes);
                let shape = DeformableShape::cracked(&own, edge).unwrap();
                FragmentShape {
                    shape: shape.into(),
                    tets,
                }
            })
            .collect();
        let mut wrong = parts.clone();
        wrong.pop();
        assert!(batch.fragment_deformable(body, wrong).is_err());
        assert_eq!(batch.fragment_deformable(body, parts).unwrap(), [0, 1, 2]);
        let x = at(0.1 * DEPTH);
        let bodies: Vec<Vec<Vector3<f64>>> = nodes
            .iter()
            .map(|own| own.iter().map(|node| x[*node as usize]).collect())
            .collect();
        let after = update(&mut batch, &bodies, 0.0);
        let largest = before.forces[0]
            .iter()
            .map(Vector3::norm)
            .fold(0.0, f64::max);
        for (forces, own) in after.forces.iter().zip(&nodes) {
            for (force, node) in forces.iter().zip(own) {
                let wanted = before.forces[0][*node as usize];
                assert!(
                    (force - wanted).norm() < 1e-11 * largest,
                    "{force} {wanted}"
                );
            }
        }
        for (found, wanted) in after.energies.iter().zip(before.energies) {
            assert!((found / wanted - 1.0).abs() < 1e-11, "{found} {wanted}");
        }
        let found: Vec<_> = batch.deformable_contacts().map(|c| (c.a, c.b)).collect();
        let place = |part: u32| order.iter().position(|own| *own == part).unwrap() as u32;
        let [low, middle, high] = [0, 1, 2].map(place);
        let pair = |a: u32, b: u32| (Partner::Body(a.min(b)), a.max(b));
        let mut wanted = vec![pair(low, middle), pair(middle, high)];
        wanted.sort_unstable();
        wanted.push((Partner::Wall(0), low));
        assert_eq!(found, wanted);
    }
}
