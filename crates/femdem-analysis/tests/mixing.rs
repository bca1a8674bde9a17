//! Mixing of classes of bodies.

use crate::common::{Random, at, cube};
use femdem_analysis::*;
use femdem_mesh::Vector3;

fn names(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("class {k}")).collect()
}

/// 8 x 8 x 8 unit cubes; cells of 2 x 2 x 2 of them.
fn lattice() -> Vec<PosedBody> {
    let node = |i: i32| f64::from(i);
    at((0..512).map(|i| Vector3::new(node(i % 8), node(i / 8 % 8), node(i / 64))))
}

fn options() -> MixingOptions {
    MixingOptions {
        cell_over_d: 1.75 / 3_f64.sqrt(),
    }
}

#[test]
fn apart_is_0_and_random_labels_are_1_on_average() {
    let (shapes, bodies) = ([cube(1.0)], lattice());
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let measure = |class_of: &[u32], n| mixing(&pack, class_of, &names(n), &options()).unwrap();
    let apart: Vec<u32> = (0..512).map(|i| u32::from(i >= 256)).collect();
    let found = measure(&apart, 2);
    assert_eq!((found.cells, found.bodies_per_cell), (64, 8.0));
    assert!(found.lacey_index.unwrap().abs() < 1e-12);
    assert_eq!(found.classes[0].height_difference, Some(-4.0));

    // Three classes drawn at random, unequal in number: 1 on average, within three errors of the mean.
    let mut random = Random(6);
    let mut labels: Vec<u32> = (0..512)
        .map(|i| u32::from(i >= 100) + u32::from(i >= 200))
        .collect();
    let (mut all, mut first, mut heights) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..200 {
        for i in (1..labels.len()).rev() {
            let j = random.uniform(0.0, (i + 1) as f64) as usize;
            labels.swap(i, j.min(i));
        }
        let found = measure(&labels, 3);
        all.push(found.lacey_index.unwrap());
        first.push(found.classes[0].lacey_index.unwrap());
        let class = &found.classes[0];
        heights.push(class.height_difference.unwrap() / class.height_difference_random.unwrap());
    }
    let mean_and_deviation = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        (
            mean,
            (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt(),
        )
    };
    for values in [&all, &first] {
        let (mean, deviation) = mean_and_deviation(values);
        assert!(
            (mean - 1.0).abs() < 3.0 * deviation / 200_f64.sqrt(),
            "{mean} {deviation}"
        );
    }
    let (mean, deviation) = mean_and_deviation(&heights);
    assert!(
        mean.abs() < 0.25 && (0.8..1.2).contains(&deviation),
        "{mean} {deviation}"
    );
}

#[test]
fn a_single_class_has_no_index_and_lists_must_fit() {
    let (shapes, bodies) = ([cube(1.0)], lattice());
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = mixing(&pack, &[1; 512], &names(2), &options()).unwrap();
    // Classes without a body are left out.
    assert_eq!((found.lacey_index, found.classes.len()), (None, 1));
    assert!(found.classes[0].height_difference.is_none());
    // In one cell nothing can be apart.
    let halves: Vec<u32> = (0..512).map(|i| u32::from(i >= 256)).collect();
    let wide = MixingOptions { cell_over_d: 9.0 };
    let found = mixing(&pack, &halves, &names(2), &wide).unwrap();
    assert_eq!(
        (found.cells, found.lacey_index, found.classes[1].lacey_index),
        (1, None, None)
    );
    let says = |class_of: &[u32], cell_over_d| {
        let refused = mixing(&pack, class_of, &names(2), &MixingOptions { cell_over_d });
        refused.unwrap_err().to_string()
    };
    assert!(says(&[0; 3], 1.0).contains("3 classes for 512 bodies"));
    assert!(says(&[2; 512], 1.0).contains("class_of = 2"));
    assert!(says(&[0; 512], -1.0).contains("cell_over_d = -1"));
}
