//! Parts of a body that has broken.

use femdem_fem::element::Element;
use femdem_fem::material::J2;
use femdem_fem::{Boundary, DeformableModel, Drive, MaterialRegion, Selection, Workspace};
use femdem_mesh::tet::CrackedMesh;
use femdem_mesh::{TetMesh, Vector3};

fn plane(offset: f64) -> Selection {
    Selection::Plane {
        normal: Vector3::x(),
        offset,
        tolerance: 1e-9,
    }
}

/// The halves of a bar that has yielded have the masses, the forces inside and from outside, and the supports that they had in the whole.
#[test]
fn parts_have_what_they_had() {
    let mesh = TetMesh::block([4, 2, 2], &Vector3::new(4.0, 2.0, 2.0)).unwrap();
    let region = |density| MaterialRegion {
        material: J2::new(1e9, 0.3, 1e6, 1e7).unwrap().into(),
        density,
    };
    let regions = (0..mesh.tets().len() as u32).map(|t| t % 2).collect();
    let all = vec![region(1000.0), region(3000.0)];
    let whole = DeformableModel::new(&mesh, Element::T4, all, Some(regions)).unwrap();
    let mut cracked = CrackedMesh::new(&mesh);
    let facets = cracked.facets().all().iter().zip(0..);
    let middle = |i: u32| mesh.points()[i as usize].x == 2.0;
    let cuts: Vec<u32> = facets
        .filter(|(f, _)| f.points.into_iter().all(middle))
        .map(|(_, i)| i)
        .collect();
    cracked.cut(&cuts).unwrap();
    let whole = whole.cracked(cracked.mesh(mesh.points()).unwrap()).unwrap();
    let mut boundary = Boundary::default();
    let drive = Drive::Linear {
        velocity: Vector3::x(),
        start: 0.0,
        end: 1.0,
    };
    boundary.fix(&whole, &plane(0.0), [true; 3]).unwrap();
    boundary
        .drive(&whole, &plane(4.0), [true, false, false], drive)
        .unwrap();
    boundary.press(&whole, &plane(4.0), 1e5).unwrap();

    let forces = |model: &DeformableModel, boundary: &Boundary, x: &[Vector3], old: &[f64]| {
        let mut history = old.to_vec();
        let mut forces = vec![Vector3::zeros(); x.len()];
        let still = vec![Vector3::zeros(); x.len()];
        let mut work = Workspace::default();
        model
            .forces_without_energy(x, &still, old, &mut history, &mut forces, &mut work)
            .unwrap();
        boundary.add_forces(model, 0.0, x, &mut forces).unwrap();
        (forces, history)
    };
    let stretched = |x: &Vector3| Vector3::new(x.x * (1.0 + 0.01 * x.y), x.y, x.z);
    let x: Vec<Vector3> = whole.nodes().iter().map(stretched).collect();
    let none = vec![0.0; whole.history_len()];
    let (_, history) = forces(&whole, &boundary, &x, &none);
    assert!(history.iter().any(|value| *value != 0.0));
    let (wanted, _) = forces(&whole, &boundary, &x, &history);
    let largest = wanted.iter().map(Vector3::norm).fold(0.0, f64::max);
    let hanging = cracked.hanging(&[]);
    for number in 0..2 {
        let own = (0_u32..).zip(&hanging).filter(|(_, part)| **part == number);
        let tets: Vec<u32> = own.map(|(t, _)| t).collect();
        let part = cracked.part(&tets).unwrap();
        let mesh = part
            .nodes
            .iter()
            .map(|node| whole.mesh().points()[*node as usize]);
        let mesh = TetMesh::new(mesh.collect(), part.mesh.tets().to_vec()).unwrap();
        let model = whole.part(&tets, mesh).unwrap();
        let of_node = |node: u32| {
            let place = part.nodes.iter().position(|own| *own == node);
            place.map(|place| place as u32)
        };
        let conditions = boundary.part(of_node);
        assert_eq!(conditions.held().count(), [27, 9][number as usize]);
        assert_eq!(conditions.is_driven(0.0, 0.1), number == 1);
        let own: Vec<Vector3> = part.nodes.iter().map(|node| x[*node as usize]).collect();
        let history = whole.part_of_history(&history, &tets);
        assert_eq!(history.len(), model.history_len());
        let (found, _) = forces(&model, &conditions, &own, &history);
        for ((force, mass), node) in found.iter().zip(model.masses()).zip(&part.nodes) {
            let node = *node as usize;
            assert!((force - wanted[node]).norm() <= 1e-12 * largest);
            assert_eq!(*mass, whole.masses()[node]);
        }
        assert!(whole.part(&[9999], model.mesh().clone()).is_err());
        assert!(whole.part(&tets[1..], model.mesh().clone()).is_err());
    }
}

/// The pressure on a face is on the part that has its element, also where another part has all its corners.
#[test]
fn pressure_goes_with_the_element() {
    let mesh = TetMesh::block([2; 3], &Vector3::repeat(2.0)).unwrap();
    let region = || MaterialRegion {
        material: J2::new(1e9, 0.3, 1e6, 1e7).unwrap().into(),
        density: 1000.0,
    };
    let model =
        |mesh: &TetMesh| DeformableModel::new(mesh, Element::T4, vec![region()], None).unwrap();
    let whole = model(&mesh);
    let mut boundary = Boundary::default();
    for offset in [0.0, 2.0] {
        boundary.press(&whole, &plane(offset), 1e5).unwrap();
    }
    let forces = |model: &DeformableModel, boundary: &Boundary| {
        let mut forces = vec![Vector3::zeros(); model.nodes().len()];
        let x = model.nodes();
        boundary.add_forces(model, 0.0, x, &mut forces).unwrap();
        forces
    };
    let mut left = forces(&whole, &boundary);
    let on_skin = |tet: &[u32; 4]| {
        let x = tet.map(|i| mesh.points()[i as usize].x);
        x.iter().filter(|x| **x == 0.0).count() == 3
    };
    let (one, rest): (Vec<_>, Vec<_>) = (mesh.tets().iter().enumerate())
        .partition(|(i, _)| mesh.tets().iter().position(on_skin) == Some(*i));
    for tets in [one, rest] {
        let mut points: Vec<u32> = tets.iter().flat_map(|(_, tet)| **tet).collect();
        points.sort_unstable();
        points.dedup();
        let number = |point: u32| points.binary_search(&point).ok().map(|i| i as u32);
        let own = |(_, tet): &(usize, &[u32; 4])| tet.map(|i| number(i).unwrap());
        let tets: Vec<[u32; 4]> = tets.iter().map(own).collect();
        let places = points.iter().map(|i| mesh.points()[*i as usize]);
        let part = model(&TetMesh::new(places.collect(), tets).unwrap());
        let mut conditions = boundary.part(number);
        conditions.follow(&[], part.mesh().tets(), &points);
        for (force, point) in forces(&part, &conditions).iter().zip(&points) {
            left[*point as usize] -= force;
        }
    }
    assert!(left.iter().all(|force| force.norm() < 1e-6), "{left:?}");
}
