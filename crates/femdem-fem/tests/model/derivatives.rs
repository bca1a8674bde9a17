//! Forces against differences of the energy, tangents against differences of the forces.

use super::*;

/// A direction of unit size for every node.
fn direction(count: usize, seed: u64) -> Vec<Vector3> {
    (0..count).map(|i| noisy(i, seed)).collect()
}

fn moved(x: &[Vector3], along: &[Vector3], by: f64) -> Vec<Vector3> {
    x.iter().zip(along).map(|(x, d)| x + d * by).collect()
}

fn dot(a: &[Vector3], b: &[Vector3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn models() -> impl Iterator<Item = (String, DeformableModel)> {
    let mesh = crooked();
    ELEMENTS.into_iter().flat_map(move |element| {
        let [first, second] = laws();
        [
            (
                format!("{element:?} neo-Hookean"),
                model(&mesh, element, first),
            ),
            (format!("{element:?} split"), model(&mesh, element, second)),
            (format!("{element:?} both"), two_regions(&mesh, element)),
        ]
    })
}

#[test]
fn forces_are_minus_the_gradient_of_the_energy() {
    for (name, model) in models() {
        let x = placed(&model, &(turned() * strained()), 0.012);
        let (_, f) = forces(&model, &x);
        let energy = |x: &[Vector3]| forces(&model, x).0.energy;
        for seed in 20..24 {
            let along = direction(x.len(), seed);
            let h = 2e-7;
            let slope =
                (energy(&moved(&x, &along, h)) - energy(&moved(&x, &along, -h))) / (2.0 * h);
            let expected = -dot(&f, &along);
            let scale = largest(&f) * largest(&along);
            let error = (slope - expected).abs() / scale;
            assert!(
                error < 1e-7,
                "{name}: {slope} against {expected}, {error:e}"
            );
        }
    }
}

#[test]
fn tangents_are_the_derivatives_of_the_forces() {
    for (name, model) in models() {
        let x = placed(&model, &(turned() * strained()), 0.012);
        let mut found = vec![Vector3::zeros(); x.len()];
        for seed in 30..33 {
            let along = direction(x.len(), seed);
            model.tangent_apply(&x, &[], &along, &mut found).unwrap();
            let h = 1e-7;
            let (_, ahead) = forces(&model, &moved(&x, &along, h));
            let (_, behind) = forces(&model, &moved(&x, &along, -h));
            let expected: Vec<Vector3> = behind
                .iter()
                .zip(&ahead)
                .map(|(b, a)| (b - a) / (2.0 * h))
                .collect();
            let errors: Vec<Vector3> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
            let error = largest(&errors) / largest(&expected);
            assert!(error < 1e-7, "{name}: {error:e}");
        }
    }
}

/// The sum of the matrices is the operator, and symmetric, as second derivatives of an energy are.
#[test]
fn element_tangents_sum_to_the_operator() {
    for (name, model) in models() {
        let x = placed(&model, &(turned() * strained()), 0.012);
        let size = 3 * x.len();
        let mut full = vec![0.0; size * size];
        model
            .for_element_tangents(&x, &[], |nodes, matrix| {
                let width = 3 * nodes.len();
                assert_eq!(matrix.len(), width * width);
                for (row, entries) in matrix.chunks_exact(width).enumerate() {
                    let global = |k: usize| 3 * nodes[k / 3] as usize + k % 3;
                    for (column, entry) in entries.iter().enumerate() {
                        full[global(row) * size + global(column)] += entry;
                    }
                }
            })
            .unwrap();
        let scale = full.iter().fold(0.0_f64, |s, k| s.max(k.abs()));
        for i in 0..size {
            for j in 0..i {
                let skew = (full[i * size + j] - full[j * size + i]).abs();
                assert!(skew < 1e-7 * scale, "{name}: {skew:e}");
            }
        }
        let along = direction(x.len(), 40);
        let mut found = vec![Vector3::zeros(); x.len()];
        model.tangent_apply(&x, &[], &along, &mut found).unwrap();
        for (i, row) in full.chunks_exact(size).enumerate() {
            let product: f64 = row
                .iter()
                .enumerate()
                .map(|(k, entry)| entry * along[k / 3][k % 3])
                .sum();
            let error = (product - found[i / 3][i % 3]).abs();
            assert!(error < 1e-11 * scale, "{name}: {error:e}");
        }
    }
}

/// The power that viscous forces take from the motion is the viscous power.
#[test]
fn viscous_forces_take_the_viscous_power() {
    for element in ELEMENTS {
        let model = model(&crooked(), element, split(4e5, 2e6, 300.0));
        let x = placed(&model, &strained(), 0.012);
        let v = direction(x.len(), 50);
        let (still, elastic) = forces(&model, &x);
        let (moving, all) = forces_moving(&model, &x, &v);
        assert_eq!(still.energy, moving.energy);
        assert_eq!(still.viscous_power, 0.0);
        let taken = dot(&elastic, &v) - dot(&all, &v);
        assert!(moving.viscous_power > 0.0);
        assert!(
            (taken / moving.viscous_power - 1.0).abs() < 1e-9,
            "{element:?}"
        );
        // A rigid rotation dissipates nothing.
        let spin = Vector3::new(0.4, -2.0, 1.0);
        let v: Vec<Vector3> = x.iter().map(|x| spin.cross(x)).collect();
        let (spun, all) = forces_moving(&model, &x, &v);
        assert!(spun.viscous_power.abs() < 1e-20 * moving.viscous_power + 1e-20);
        for (a, b) in all.iter().zip(&elastic) {
            assert!((a - b).norm() < 1e-11 * largest(&elastic));
        }
    }
}
