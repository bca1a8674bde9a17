//! The force between two halves of the star of a node.

use super::*;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion, Workspace};

/// The centre of the body, where its node is, m.
const CENTRE: f64 = 0.02;

/// A block of cells of a centimetre and the same turned inside out about the middle of one of its sides: the nodes of the second half
/// have the numbers beyond those of the first, but for those of the side.
fn twice() -> (TetMesh, TetMesh) {
    let half = TetMesh::block([2, 4, 4], &Vector3::new(CENTRE, 0.04, 0.04)).unwrap();
    let mut points = half.points().to_vec();
    let other: Vec<u32> = half
        .points()
        .iter()
        .map(|p| {
            let there = Vector3::repeat(2.0 * CENTRE) - p.coords;
            let same = |q: &femdem_mesh::Point3| (q.coords - there).norm() < 1e-9;
            points.iter().position(same).unwrap_or_else(|| {
                points.push(there.into());
                points.len() - 1
            }) as u32
        })
        .collect();
    let turned = half.tets().iter().map(|tet| {
        let [a, b, c, d] = tet.map(|i| other[i as usize]);
        [a, c, b, d]
    });
    let tets = half.tets().iter().copied().chain(turned).collect();
    (TetMesh::new(points, tets).unwrap(), half)
}

fn model(mesh: &TetMesh) -> DeformableModel {
    let region = MaterialRegion {
        material: NeoHookean::new(20e9, 0.2).unwrap().into(),
        density: 2500.0,
    };
    DeformableModel::new(mesh, Element::T4, vec![region], None).unwrap()
}

/// Where a point comes to: the other way at the point across the centre.
fn strained(p: &Vector3, seed: u64, size: f64) -> Vector3 {
    let from = p - Vector3::repeat(CENTRE);
    let mut to = p + Vector3::new(from.x, -0.2 * from.y, -0.2 * from.z) * (2e-4 * size);
    for k in 0..4 {
        let wave = noisy(seed * 100 + k) * 200.0;
        to += noisy(seed * 100 + 50 + k) * (4e-7 * size * wave.dot(&from).sin());
    }
    to
}

/// Against the force on the node of a model of one half alone; the other pulls as much the other way. The node fails by that or by the
/// mean stress, whichever uses up more of the strength.
#[test]
fn a_node_fails_by_the_force_between_its_halves() {
    let (mesh, half) = twice();
    let (whole, alone) = (model(&mesh), model(&half));
    let at = |mesh: &TetMesh, seed, size| -> Vec<Vector3> {
        let points = mesh.points().iter();
        points.map(|p| strained(&p.coords, seed, size)).collect()
    };
    let middle = |p: &femdem_mesh::Point3| (p.coords - Vector3::repeat(CENTRE)).norm() < 1e-9;
    let node = mesh.points().iter().position(middle).unwrap();
    let mut by_force = 0;
    for seed in 0..40 {
        let mut body = Body::new(&mesh, Matrix3::zeros());
        body.factors.fill(f64::INFINITY);
        body.factors[node] = 1.0;
        body.positions = at(&mesh, seed, 1.0);
        body.stresses = whole.stresses(&body.positions, &[]).unwrap();
        // At the front of a crack: one of the facets in the side is cut.
        let place = |i: u32| mesh.points()[i as usize].x;
        let facets = body.cracked.facets().all().iter();
        let in_side = |points: &[u32; 3]| {
            points.contains(&(node as u32))
                && points.iter().all(|&i| (place(i) - CENTRE).abs() < 1e-9)
        };
        let one = facets
            .zip(0..)
            .find(|(facet, _)| in_side(&facet.points))
            .unwrap()
            .1;
        assert!(body.cracked.cut(&[one]).unwrap().is_empty());
        let found = body.state().ratios(&body.cracked).unwrap()[node];
        body.cracked = CrackedMesh::new(&mesh);

        let around = body.cracked.around(node as u32).iter();
        let (mut sum, mut volume) = (Matrix3::zeros(), 0.0);
        for &t in around {
            let own = whole.volumes()[t as usize];
            sum += body.stresses[t as usize].cauchy * own;
            volume += own;
        }
        let mean = rock().ratio(&(sum / volume));
        let places = at(&half, seed, 1.0);
        let mut forces = vec![Vector3::zeros(); places.len()];
        let still = forces.clone();
        let mut work = Workspace::default();
        alone
            .internal_forces(&places, &still, &[], &mut [], &mut forces, &mut work)
            .unwrap();

        // Four times as strained, the node fails in any case: along the side, of flat facets.
        body.positions = at(&mesh, seed, 4.0);
        body.stresses = whole.stresses(&body.positions, &[]).unwrap();
        let cuts = body.decide().cuts;
        let areas = cuts.iter().map(|cut| body.area(cut.facet));
        let area: f64 = areas.map(|area| area.x.abs()).sum();
        assert!(
            cuts.iter().all(|cut| cut.plane.x.abs() > 1.0 - 1e-3),
            "{seed} {cuts:?}"
        );
        let traction = forces[node] * (3.0 / area);
        let (pull, shear) = (-traction.x, traction.yz().norm());
        let force = (pull / TENSILE).max((shear + 0.8 * pull) / 20e6);
        assert!((found / mean.max(force) - 1.0).abs() < 1e-3, "{seed}");
        by_force += usize::from(force > 1.03 * mean);
    }
    assert!(by_force > 5);
}
