//! Affine and rigid motion.

use super::*;

/// Inner nodes have no force in a homogeneous deformation, and the stress is that of the law.
#[test]
fn patch_test() {
    let mesh = TetMesh::block([3, 3, 3], &Vector3::repeat(0.3)).unwrap();
    let points = mesh.points().iter().enumerate().map(|(i, p)| {
        let inside = !mesh.is_skin_point(i);
        p + noisy(i, 5) * if inside { 0.02 } else { 0.0 }
    });
    let mesh = TetMesh::new(points.collect(), mesh.tets().to_vec()).unwrap();
    for element in ELEMENTS {
        for law in laws() {
            let model = model(&mesh, element, law.clone());
            let x = placed(&model, &strained(), 0.0);
            let (state, f) = forces(&model, &x);
            let point = law
                .respond(&Deformation::at_rest(strained()), &[], &mut [])
                .unwrap();
            let volume = 0.027;
            assert!((state.energy / (point.energy * volume) - 1.0).abs() < 1e-12);
            // In units of E times the face of a cell.
            let on_skin = |k: usize| match k.checked_sub(mesh.points().len()) {
                None => mesh.is_skin_point(k),
                Some(k) => model.mid_edges()[k]
                    .iter()
                    .all(|&i| mesh.is_skin_point(i as usize)),
            };
            let inside: Vec<Vector3> = (0..x.len())
                .filter(|&k| !on_skin(k))
                .map(|k| f[k])
                .collect();
            assert!(!inside.is_empty());
            let residual = largest(&inside) / (1e6 * 0.01);
            assert!(residual < 1e-12, "{element:?}: {residual:e}");
            let cauchy = point.piola * strained().transpose() / strained().determinant();
            for stress in model.stresses(&x, &[]).unwrap() {
                assert!((stress.cauchy - cauchy).norm() < 1e-12 * 1e6, "{element:?}");
                assert!((stress.volume_ratio - strained().determinant()).abs() < 1e-13);
            }
        }
    }
}

/// Turned by 1 rad, and put 3 m (ten body lengths) away.
#[test]
fn rigid_motion_is_free_of_stress() {
    for element in ELEMENTS {
        for law in laws() {
            let model = model(&crooked(), element, law);
            let shift = Vector3::new(3.0, -1.0, 2.0);
            let x: Vec<Vector3> = placed(&model, &turned(), 0.0)
                .iter()
                .map(|x| x + shift)
                .collect();
            let (state, f) = forces(&model, &x);
            assert!(
                largest(&f) < 1e-12 * 1e6 * 0.1,
                "{element:?} {:e}",
                largest(&f)
            );
            assert!(state.energy.abs() < 1e-12 * 1e6 * 0.03);
            let stresses = model.stresses(&x, &[]).unwrap();
            for stress in stresses {
                assert!(
                    stress.cauchy.norm() < 2e-12 * 1e6 * 3.0,
                    "{:e}",
                    stress.cauchy.norm()
                );
            }
        }
    }
}

/// A rotation of a strained body rotates its forces and does not change its energy.
#[test]
fn forces_turn_with_the_body() {
    for element in ELEMENTS {
        let model = two_regions(&crooked(), element);
        let x = placed(&model, &strained(), 0.01);
        let x_turned: Vec<Vector3> = x.iter().map(|x| turned() * x).collect();
        let (state, f) = forces(&model, &x);
        let (state_turned, f_turned) = forces(&model, &x_turned);
        assert!((state.energy / state_turned.energy - 1.0).abs() < 1e-12);
        for (f, g) in f.iter().zip(&f_turned) {
            assert!((turned() * f - g).norm() < 1e-12 * largest(&f_turned) * 10.0);
        }
    }
}

/// Resultant force and moment of a body's internal forces vanish, and the stresses balance the nodal forces.
#[test]
fn stresses_balance_the_forces() {
    for element in ELEMENTS {
        let model = two_regions(&crooked(), element);
        let x = placed(&model, &strained(), 0.01);
        let (_, f) = forces(&model, &x);
        let scale = largest(&f);
        let sum: Vector3 = f.iter().sum();
        assert!(sum.norm() < 1e-13 * scale * 10.0);
        let moment: Vector3 = x.iter().zip(&f).map(|(x, f)| x.cross(f)).sum();
        assert!(moment.norm() < 1e-12 * scale);
        let virial = x
            .iter()
            .zip(&f)
            .fold(Matrix3::zeros(), |s, (x, f)| s - f * x.transpose());
        let stresses = model.stresses(&x, &[]).unwrap();
        let mean = stresses.iter().zip(model.volumes());
        let mean = mean.fold(Matrix3::zeros(), |s, (stress, volume)| {
            s + stress.cauchy * (volume * stress.volume_ratio)
        });
        assert!(
            (virial - mean).norm() < 1e-12 * virial.norm(),
            "{element:?}"
        );
    }
}

/// HRZ lumping: a positive mass for every node, and the total mass of the material.
#[test]
fn masses_sum_to_the_body() {
    let mesh = crooked();
    for element in ELEMENTS {
        let model = two_regions(&mesh, element);
        let half = mesh.tets().len() / 2;
        let volumes = model.volumes();
        let expected = 1000.0 * volumes[..half].iter().sum::<f64>()
            + 3000.0 * volumes[half..].iter().sum::<f64>();
        let sum: f64 = model.masses().iter().sum();
        assert!((sum / expected - 1.0).abs() < 1e-14);
        assert!(model.masses().iter().all(|&m| m > 0.0));
        assert_eq!(model.added_mass(), 0.0);
    }
}
